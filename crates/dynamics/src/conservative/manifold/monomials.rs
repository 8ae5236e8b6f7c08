//! Monomials of a few coordinates, and polynomials in them.

use std::collections::BTreeMap;

use faer::Mat;
use reduced_body::LargeProducts;

use crate::matrix::blocked_matrix::BlockedMatrix;
use crate::matrix::triangle::entry;

/// Monomials of the first to the fifth degree, those of a lower degree first. Of each, but for the coordinates
/// themselves, a coordinate times one before it.
#[derive(Debug)]
pub(super) struct Monomials {
    factors: Vec<Vec<usize>>,
    /// Place of the one before and the coordinate, from the second degree on.
    steps: Vec<[u32; 2]>,
    places: BTreeMap<Vec<usize>, usize>,
    /// Where those of each degree end; the first entry is zero.
    ends: [usize; 6],
}

impl Monomials {
    /// With at most two factors of following modes.
    pub fn new(products: LargeProducts) -> Self {
        let mut factors: Vec<Vec<usize>> = (0..products.coordinates()).map(|k| vec![k]).collect();
        let mut ends = [0, factors.len(), 0, 0, 0, 0];
        factors.extend(products.second());
        ends[2] = factors.len();
        let mut of_energy = products.of_energy();
        of_energy.sort_by_key(Vec::len);
        factors.extend(of_energy);
        for (degree, end) in ends.iter_mut().enumerate().skip(3) {
            *end = factors.partition_point(|product| product.len() <= degree);
        }
        let places: BTreeMap<_, _> =
            factors.iter().cloned().enumerate().map(|(place, product)| (product, place)).collect();
        let step = |product: &Vec<usize>| {
            let (last, before) = product.split_last()?;
            Some([*places.get(before)? as u32, *last as u32])
        };
        let steps = factors[ends[1]..].iter().filter_map(step).collect();
        Self { factors, steps, places, ends }
    }

    /// Number of those up to a degree.
    pub fn count(&self, degree: usize) -> usize {
        self.ends[degree]
    }

    /// Place of a product.
    pub fn place(&self, product: &[usize]) -> usize {
        self.places.get(product).copied().unwrap_or_default()
    }

    /// The values of as many as there is room for, of the second degree or higher, at the coordinates x.
    pub fn find(&self, x: &[f64], values: &mut [f64]) {
        let first = self.ends[1];
        values[..first].copy_from_slice(&x[..first]);
        for (k, [before, coordinate]) in self.steps.iter().enumerate().take(values.len() - first) {
            values[first + k] = values[*before as usize] * x[*coordinate as usize];
        }
    }

    /// Products of the derivative of a product: number of times that a coordinate is in it, and what is left without it.
    pub fn derivative(product: &[usize], coordinate: usize) -> Option<(f64, Vec<usize>)> {
        let place = product.iter().position(|k| *k == coordinate)?;
        let times = product.iter().filter(|k| **k == coordinate).count();
        let mut rest = product.to_vec();
        rest.remove(place);
        Some((times as f64, rest))
    }
}

/// Polynomials without a constant part, side by side.
#[derive(Debug)]
pub(super) struct Polynomials {
    matrix: BlockedMatrix,
    /// Degree of the lowest monomials, less one; number of the monomials up to there, and up to the highest.
    range: [usize; 2],
}

impl Polynomials {
    /// `rows` of them, with monomials between two degrees; `fill` adds to the entries of row and product.
    pub fn new(
        monomials: &Monomials,
        rows: usize,
        [lowest, highest]: [usize; 2],
        fill: impl FnOnce(&mut dyn FnMut(usize, &[usize], f64)),
    ) -> Self {
        let range = [monomials.count(lowest - 1), monomials.count(highest)];
        let mut entries = Mat::zeros(rows, range[1] - range[0]);
        fill(&mut |row, product, value| entries[(row, monomials.place(product) - range[0])] += value);
        Self { matrix: BlockedMatrix::new(entries.as_ref()), range }
    }

    /// Their values by those of the monomials.
    pub fn find(&self, monomials: &[f64], values: &mut [f64]) {
        self.matrix.multiply(&monomials[self.range[0]..self.range[1]], values);
    }
}

/// Σ coefficient × monomial, from the third degree on.
#[derive(Debug)]
pub(super) struct Energy {
    coefficients: Vec<f64>,
    /// Factors of each monomial; a one where there are less than five.
    factors: Vec<[u8; 5]>,
    /// Where those of the third, fourth and fifth degree end.
    ends: [usize; 3],
}

impl Energy {
    /// By the coefficient of each product of [`LargeProducts::of_energy`].
    pub fn new(monomials: &Monomials, products: &[Vec<usize>], energies: &[f64]) -> Self {
        let (first, one) = (monomials.count(2), monomials.count(1) as u8);
        let mut coefficients = vec![0.0; monomials.count(5) - first];
        for (product, energy) in products.iter().zip(energies) {
            coefficients[monomials.place(product) - first] += energy;
        }
        let factors = monomials.factors[first..]
            .iter()
            .map(|product| [0, 1, 2, 3, 4].map(|i| product.get(i).map_or(one, |k| *k as u8)));
        Self { coefficients, factors: factors.collect(), ends: [3, 4, 5].map(|degree| monomials.count(degree) - first) }
    }

    /// The sums of each degree from the third on, at coordinates x with a one after them.
    pub fn by_degree(&self, x: &[f64]) -> [f64; 3] {
        let mut first = 0;
        self.ends.map(|end| {
            let range = first..end;
            first = end;
            let terms = self.coefficients[range.clone()].iter().zip(&self.factors[range]);
            terms.map(|(coefficient, factors)| factors.iter().fold(*coefficient, |term, k| term * x[*k as usize])).sum()
        })
    }

    /// The derivatives by the coordinates.
    pub fn forces(&self, monomials: &Monomials) -> Polynomials {
        let (first, coordinates) = (monomials.count(2), monomials.count(1));
        Polynomials::new(monomials, coordinates, [2, 4], |add| {
            for (coefficient, product) in self.coefficients.iter().zip(&monomials.factors[first..]) {
                for k in 0..coordinates {
                    if let Some((times, rest)) = Monomials::derivative(product, k) {
                        add(k, &rest, times * coefficient);
                    }
                }
            }
        })
    }

    /// The second derivatives by the coordinates: entries i ≥ j, row by row.
    pub fn stiffness(&self, monomials: &Monomials) -> Polynomials {
        let (first, coordinates) = (monomials.count(2), monomials.count(1));
        Polynomials::new(monomials, coordinates * (coordinates + 1) / 2, [1, 3], |add| {
            for (coefficient, product) in self.coefficients.iter().zip(&monomials.factors[first..]) {
                for i in 0..coordinates {
                    let Some((times, rest)) = Monomials::derivative(product, i) else { continue };
                    for j in 0..=i {
                        if let Some((again, rest)) = Monomials::derivative(&rest, j) {
                            add(entry(i, j), &rest, times * again * coefficient);
                        }
                    }
                }
            }
        })
    }
}
