//! A St. Venant–Kirchhoff body whose displacement is a polynomial of a few coordinates q.
//!
//! ```text
//! u(q) = Σ_α u_α q^α      F = F₀ + Σ ∇u_α q^α      E = E₀ + Σ E_α q^α      S = S₀ + Σ C:E_α q^α
//!
//! E_α = sym(F₀ᵀ∇u_α) + E_α'      E_α' = ½ Σ_{β+γ=α} sym(∇u_βᵀ∇u_γ)
//! v·g_α = ∫ ∇v : (F₀ C:E_α' + Σ_{β+γ=α} ∇u_β C:E_γ) dV
//! V_α = ∫ S₀:E_α' + ½ Σ_{β+γ=α} E_β:C:E_γ dV
//! ```
//!
//! α are products of coordinates. F₀ = 1 + ∇u₀ and S₀ belong to a reference u₀; without one they are 1 and 0. K_T u_α + g_α
//! are all internal forces of the product α, and V_α is its strain energy without the work `f_int(u₀)·u_α`.

use std::collections::BTreeMap;

use faer::{Mat, MatRef};
use rayon::prelude::*;

use crate::element::deformation::{OTHERS, check_field};
use crate::element::integration::Rules;
use crate::element::lanes::{Group, GroupPoint, LANES, Lame, Lanes, PARTS, Rows, Tensors};
use crate::element::vectorized::vectorized;
use crate::error::AssemblyError;
use crate::material::{Material, Materials};
use crate::mesh::checked::Mesh;
use crate::nonlinear::element_sums::sum_of_forces;

/// A displacement that is a polynomial of coordinates.
#[derive(Debug, Clone, Copy)]
pub struct Expansion<'a> {
    /// The products of coordinates, each by the numbers of its factors, ascending: `[0, 0, 1]` is q₀² q₁.
    pub products: &'a [Vec<usize>],
    /// The field of each product (N × products).
    pub fields: MatRef<'a, f64>,
    /// The displacement u₀ that it is counted from (N × 1); none of a body at rest.
    pub reference: Option<MatRef<'a, f64>>,
}

impl Expansion<'_> {
    /// The forces g_α (N × wanted) of the products `wanted`: those of lower products, without the linear ones of u_α itself.
    ///
    /// # Errors
    /// Materials that do not fit the mesh; fields whose rows are not the degrees of freedom, or with an entry that is not
    /// finite.
    ///
    /// # Panics
    /// Where there are not as many fields as products.
    pub fn forces(&self, mesh: &Mesh, materials: &Materials, wanted: &[Vec<usize>]) -> Result<Mat<f64>, AssemblyError> {
        let materials = self.checked(mesh, materials)?;
        let is_part = |strain: &Vec<usize>| wanted.iter().any(|w| strain.len() <= w.len() && divides(strain, w));
        let strains = Strains::new(self.products, is_part);
        let terms: Vec<ForceTerms> = wanted.iter().map(|wanted| strains.force_terms(self.products, wanted)).collect();
        let (rules, fields, groups) = (Rules::new(), self.rows(), Group::all(mesh));
        // Products of ∇v with two gradients are cubic at most.
        let is_cubic = self.reference.is_none() && wanted.iter().all(|wanted| wanted.len() <= 2);
        let of_group = |group: &Group| -> Vec<[[Lanes; 3]; OTHERS]> {
            let mut sums = vec![[[[0.0; LANES]; 3]; OTHERS]; wanted.len()];
            vectorized(
                #[inline(always)]
                || {
                    let (lame, positions) = (group.lame(&materials), group.positions(mesh));
                    let (mut relative, mut at) = (Vec::new(), AtPoint::default());
                    fields.relative(mesh, group, &mut relative);
                    for rule in if is_cubic { group.cubic_points(&rules) } else { rules.fine() } {
                        let point = GroupPoint::new(&positions, rule, group.count);
                        at.find(&point, &relative, &strains, &lame, self.reference.is_some());
                        for (terms, sums) in terms.iter().zip(&mut sums) {
                            let mut force = Tensors::ZERO;
                            for [field, strain] in &terms.of_pairs {
                                force = force.plus(&at.gradients[*field].times(&at.stresses[*strain]));
                            }
                            if let Some(own) = terms.own {
                                let stress = at.beyond[own].stress(&lame);
                                let turned = if self.reference.is_some() { at.f.times(&stress) } else { stress };
                                force = force.plus(&turned);
                            }
                            point.add_forces(&force.scaled(&point.volume), sums);
                        }
                    }
                },
            );
            sums
        };
        Ok(sum_of_forces(mesh, &groups, wanted.len(), of_group))
    }

    /// The energies V_α of the products `wanted`, of at least two factors each.
    ///
    /// # Errors
    /// As [`Self::forces`].
    ///
    /// # Panics
    /// As [`Self::forces`].
    pub fn energies(
        &self,
        mesh: &Mesh,
        materials: &Materials,
        wanted: &[Vec<usize>],
    ) -> Result<Vec<f64>, AssemblyError> {
        let materials = self.checked(mesh, materials)?;
        let has_reference = self.reference.is_some();
        let is_part = |strain: &Vec<usize>| {
            let least = usize::from(!has_reference);
            wanted.iter().any(|w| strain.len() + least <= w.len() && divides(strain, w))
        };
        let strains = Strains::new(self.products, is_part);
        // The strains of each pair, and the product that they are part of.
        let mut pairs: Vec<[usize; 3]> = Vec::new();
        for (place, wanted) in wanted.iter().enumerate() {
            for (i, first) in strains.products.iter().enumerate().filter(|(_, first)| divides(first, wanted)) {
                let rest = rest(wanted, first);
                if let Ok(j) = strains.products.binary_search(&rest)
                    && i <= j
                {
                    pairs.push([place, i, j]);
                }
            }
        }
        let own: Vec<Option<usize>> =
            wanted.iter().map(|wanted| strains.products.binary_search(wanted).ok().filter(|_| has_reference)).collect();
        let (rules, fields, groups) = (Rules::new(), self.rows(), Group::all(mesh));
        let of_part = |part: &[Group]| -> Vec<f64> {
            let mut sums = vec![[0.0; LANES]; wanted.len()];
            let (mut relative, mut at) = (Vec::new(), AtPoint::default());
            let (mut upper, mut weighted) = (Vec::new(), Vec::new());
            for group in part {
                vectorized(
                    #[inline(always)]
                    || {
                        let (lame, positions) = (group.lame(&materials), group.positions(mesh));
                        fields.relative(mesh, group, &mut relative);
                        for rule in rules.fine() {
                            let point = GroupPoint::new(&positions, rule, group.count);
                            at.find(&point, &relative, &strains, &lame, has_reference);
                            upper.clear();
                            weighted.clear();
                            for (strain, stress) in at.strains.iter().zip(&at.stresses) {
                                upper.push(strain.upper(1.0));
                                weighted.push(stress.scaled(&point.volume).upper(2.0));
                            }
                            for [place, i, j] in &pairs {
                                let factor = if i == j { 0.5 } else { 1.0 };
                                add_product(&upper[*i], &weighted[*j], factor, &mut sums[*place]);
                            }
                            if has_reference {
                                let stress = at.stress.scaled(&point.volume).upper(2.0);
                                for (own, sum) in own.iter().zip(&mut sums) {
                                    if let Some(own) = own {
                                        add_product(&at.beyond[*own].upper(1.0), &stress, 1.0, sum);
                                    }
                                }
                            }
                        }
                    },
                );
            }
            sums.iter().map(|sum| sum.iter().sum()).collect()
        };
        let parts: Vec<Vec<f64>> = groups.par_chunks(groups.len().div_ceil(PARTS)).map(of_part).collect();
        let mut sums = vec![0.0; wanted.len()];
        for part in parts {
            sums.iter_mut().zip(part).for_each(|(sum, part)| *sum += part);
        }
        Ok(sums)
    }

    fn checked(&self, mesh: &Mesh, materials: &Materials) -> Result<Vec<Material>, AssemblyError> {
        assert_eq!(self.products.len(), self.fields.ncols(), "a field for each product");
        check_field(mesh, "fields", self.fields)?;
        if let Some(reference) = self.reference {
            check_field(mesh, "the reference", reference)?;
        }
        materials.of_elements(mesh)
    }

    /// The fields, and after them the reference.
    fn rows(&self) -> Rows {
        let Some(reference) = self.reference else { return Rows::new(self.fields) };
        let count = self.fields.ncols();
        let entry = |i: usize, j: usize| if j < count { self.fields[(i, j)] } else { reference[(i, 0)] };
        Rows::new(Mat::from_fn(self.fields.nrows(), count + 1, entry).as_ref())
    }
}

/// Adds `factor` times the scalar product of two symmetric matrices, of which one has its three last numbers twice.
#[inline(always)]
fn add_product(a: &[Lanes; 6], b: &[Lanes; 6], factor: f64, sum: &mut Lanes) {
    for (a, b) in a.iter().zip(b) {
        for lane in 0..LANES {
            sum[lane] += factor * a[lane] * b[lane];
        }
    }
}

/// True if all factors of a product are in another, as often.
fn divides(part: &[usize], whole: &[usize]) -> bool {
    let mut rest = whole.iter();
    part.iter().all(|factor| rest.any(|other| other == factor))
}

/// The product without the factors of a part of it.
fn rest(whole: &[usize], part: &[usize]) -> Vec<usize> {
    let mut left = part.iter().peekable();
    whole.iter().copied().filter(|factor| left.next_if_eq(&factor).is_none()).collect()
}

/// The product of two products.
fn times(a: &[usize], b: &[usize]) -> Vec<usize> {
    let mut product = [a, b].concat();
    product.sort_unstable();
    product
}

/// The strains of products that some fields have.
struct Strains {
    /// Sorted.
    products: Vec<Vec<usize>>,
    /// Field of each, if it has one of its own.
    field: Vec<Option<usize>>,
    /// Pairs of fields that make each, each pair once.
    pairs: Vec<Vec<[usize; 2]>>,
}

/// The force of a product.
struct ForceTerms {
    /// A field and a strain.
    of_pairs: Vec<[usize; 2]>,
    /// Its own strain beyond the linear one.
    own: Option<usize>,
}

/// The field of a product, if it has one of its own, and the pairs of fields that make it.
type Makers = (Option<usize>, Vec<[usize; 2]>);

impl Strains {
    fn new(fields: &[Vec<usize>], is_wanted: impl Fn(&Vec<usize>) -> bool) -> Self {
        let mut found: BTreeMap<Vec<usize>, Makers> = BTreeMap::new();
        for (k, product) in fields.iter().enumerate() {
            if is_wanted(product) {
                found.entry(product.clone()).or_default().0 = Some(k);
            }
            for (l, other) in fields.iter().enumerate().take(k + 1) {
                let product = times(product, other);
                if is_wanted(&product) {
                    found.entry(product).or_default().1.push([k, l]);
                }
            }
        }
        let mut strains = Self { products: Vec::new(), field: Vec::new(), pairs: Vec::new() };
        for (product, (field, pairs)) in found {
            strains.products.push(product);
            strains.field.push(field);
            strains.pairs.push(pairs);
        }
        strains
    }

    fn force_terms(&self, fields: &[Vec<usize>], wanted: &[usize]) -> ForceTerms {
        let of_field = |(k, field): (usize, &Vec<usize>)| {
            let strain = divides(field, wanted).then(|| self.products.binary_search(&rest(wanted, field)).ok());
            Some([k, strain.flatten()?])
        };
        ForceTerms {
            of_pairs: fields.iter().enumerate().filter_map(of_field).collect(),
            own: self.products.iter().position(|product| product == wanted),
        }
    }
}

/// The fields at a point.
struct AtPoint {
    /// F₀ and S₀.
    f: Tensors,
    stress: Tensors,
    /// Gradient of each field.
    gradients: Vec<Tensors>,
    /// E_α, E_α' and C:E_α.
    strains: Vec<Tensors>,
    beyond: Vec<Tensors>,
    stresses: Vec<Tensors>,
}

impl Default for AtPoint {
    fn default() -> Self {
        let lists = [(); 4].map(|()| Vec::new());
        let [gradients, strains, beyond, stresses] = lists;
        Self { f: Tensors::ZERO, stress: Tensors::ZERO, gradients, strains, beyond, stresses }
    }
}

impl AtPoint {
    #[inline(always)]
    fn find(
        &mut self,
        point: &GroupPoint,
        relative: &[[[Lanes; 3]; OTHERS]],
        strains: &Strains,
        lame: &Lame,
        has_reference: bool,
    ) {
        self.gradients.clear();
        for relative in relative {
            self.gradients.push(point.gradient(relative));
        }
        if has_reference {
            // ε(u₀) + ½ sym(∇u₀ᵀ∇u₀)
            self.f = self.gradients.pop().unwrap_or(Tensors::ZERO);
            let second = self.f.second_strain(&self.f).scaled(&[0.5; LANES]);
            self.stress = self.f.strain().plus(&second).stress(lame);
            for i in 0..3 {
                for lane in 0..LANES {
                    self.f.0[i][i][lane] += 1.0;
                }
            }
        }
        for list in [&mut self.strains, &mut self.beyond, &mut self.stresses] {
            list.clear();
        }
        for (field, pairs) in strains.field.iter().zip(&strains.pairs) {
            let mut beyond = Tensors::ZERO;
            for [k, l] in pairs {
                let second = self.gradients[*k].second_strain(&self.gradients[*l]);
                beyond = beyond.plus(&if k == l { second.scaled(&[0.5; LANES]) } else { second });
            }
            let mut strain = beyond;
            if let Some(field) = field {
                let gradient = &self.gradients[*field];
                let linear = if has_reference { self.f.second_strain(gradient) } else { gradient.strain() };
                strain = strain.plus(&linear);
            }
            self.beyond.push(beyond);
            self.stresses.push(strain.stress(lame));
            self.strains.push(strain);
        }
    }
}
