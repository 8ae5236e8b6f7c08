//! The stress of products of large modes and of those that follow them.

use dynamics::Manifold;
use faer::{Mat, MatRef};

/// Fields whose products strain the body, and which pairs of these belong to each product of modes: the strain of a product
/// beyond that of its displacement, `½ Σ ε₂(a, b)` over both orders of the pairs.
#[derive(Debug)]
pub struct ProductStrains {
    /// The modes that bend the body, then the displacements of products of two of these (N × …).
    pub fields: Mat<f64>,
    /// Pairs of fields.
    pub pairs: Vec<[usize; 2]>,
    /// For each of [`Manifold::products`] its pairs, by their places, with a factor on `½ ε₂` of each.
    pub of_products: Vec<Vec<(usize, f64)>>,
}

impl ProductStrains {
    /// By the extended `shapes` of a manifold (N × shapes).
    pub fn new(manifold: &Manifold, shapes: MatRef<'_, f64>) -> Self {
        let (bent, products) = (manifold.bent(), manifold.products());
        let second: Vec<&Vec<usize>> = products.iter().filter(|product| product.len() == 2).collect();
        let coefficients = MatRef::from_column_major_slice(manifold.of_products(), shapes.ncols(), products.len());
        let of_second = shapes * coefficients.get(.., ..second.len());
        let fields = Mat::from_fn(shapes.nrows(), bent.len() + second.len(), |i, j| match j.checked_sub(bent.len()) {
            None => shapes[(i, bent[j])],
            Some(product) => of_second[(i, product)],
        });
        let mode = |k: &usize| bent.iter().position(|other| other == k).unwrap_or_default();
        let mut pairs: Vec<[usize; 2]> = Vec::new();
        let mut place = |pair: [usize; 2]| {
            pairs.iter().position(|other| *other == pair).unwrap_or_else(|| {
                pairs.push(pair);
                pairs.len() - 1
            })
        };
        let mut of_products = Vec::new();
        for product in &products {
            of_products.push(match &product[..] {
                [j, k] => vec![(place([mode(j), mode(k)]), if j == k { 1.0 } else { 2.0 })],
                factors => {
                    let mut distinct = factors.to_vec();
                    distinct.dedup();
                    let of = |single: &usize| {
                        let mut rest = factors.to_vec();
                        rest.remove(rest.iter().position(|k| k == single)?);
                        let other = second.iter().position(|pair| **pair == rest)?;
                        Some((place([mode(single), bent.len() + other]), 2.0))
                    };
                    distinct.iter().filter_map(of).collect()
                }
            });
        }
        Self { fields, pairs, of_products }
    }

    /// The stress of each product (rows × products), by that of `½ ε₂` of each pair (rows × pairs).
    pub fn stress(&self, of_pairs: MatRef<'_, f64>) -> Mat<f64> {
        let entry = |i: usize, product: usize| -> f64 {
            self.of_products[product].iter().map(|(pair, factor)| factor * of_pairs[(i, *pair)]).sum()
        };
        Mat::from_fn(of_pairs.nrows(), self.of_products.len(), entry)
    }
}
