//! Error of the mesh: the recovered stress against that of the elements (Zienkiewicz and Zhu 1987).

use faer::{ColRef, MatRef};
use nalgebra::Matrix3;
use rayon::prelude::*;

use super::{COMPONENTS, StressRecovery};
use crate::element::deformation::{
    check_field, displacement_gradients, relative_displacements, second_strain, strain, stress,
};
use crate::element::integration::{IntegrationPoint, RulePoint, is_straight};
use crate::element::shape::{EDGES, NODES, shape_functions, shape_gradients};
use crate::error::{AssemblyError, AssemblyFault};
use crate::material::Material;

/// Strain energies of an element, or of a body: of its stress, and of the difference between its stress and the
/// recovered one.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct StressError {
    /// ½ ∫ σ:C⁻¹:σ dV.
    pub energy: f64,
    /// ½ ∫ (σ* − σ):C⁻¹:(σ* − σ) dV.
    pub error: f64,
}

impl StressError {
    /// The error of the stress in the norm of the energy, relative to the stress; 0 without any.
    pub fn relative(&self) -> f64 {
        if self.energy + self.error > 0.0 { (self.error / (self.energy + self.error)).sqrt() } else { 0.0 }
    }
}

impl std::iter::Sum for StressError {
    fn sum<I: Iterator<Item = Self>>(all: I) -> Self {
        all.fold(Self::default(), |sum, one| Self { energy: sum.energy + one.energy, error: sum.error + one.error })
    }
}

impl StressRecovery<'_> {
    /// The estimate by element, then by field: of displacement fields (N×k, length) and their
    /// [`nodal_stress`](Self::nodal_stress) (6m×k, force per area), Eq. (S3) of `docs/method/stress.md`. The estimate of the body is
    /// the sum over its elements.
    ///
    /// # Errors
    /// Fields of other lengths, or with an entry that is not finite; not enough memory.
    pub fn error_estimate(
        &self,
        displacements: MatRef<'_, f64>,
        nodal_stress: MatRef<'_, f64>,
    ) -> Result<Vec<StressError>, AssemblyError> {
        self.estimate(displacements, None, nodal_stress)
    }

    /// The same of displacement fields u whose strain has a product in it, sym(∇u) + sym(∇aᵀ∇b) with a field b (N×k) for each u: about
    /// a body that is bent by a, b is u.
    ///
    /// # Errors
    /// As [`error_estimate`](Self::error_estimate).
    pub fn error_estimate_of_product(
        &self,
        displacements: MatRef<'_, f64>,
        (a, b): (ColRef<'_, f64>, MatRef<'_, f64>),
        nodal_stress: MatRef<'_, f64>,
    ) -> Result<Vec<StressError>, AssemblyError> {
        self.estimate(displacements, Some((a, b)), nodal_stress)
    }

    fn estimate(
        &self,
        displacements: MatRef<'_, f64>,
        product: Option<(ColRef<'_, f64>, MatRef<'_, f64>)>,
        nodal_stress: MatRef<'_, f64>,
    ) -> Result<Vec<StressError>, AssemblyError> {
        check_field(self.mesh, "displacements", displacements)?;
        if let Some((a, b)) = product {
            check_field(self.mesh, "fields", a.as_mat())?;
            check_field(self.mesh, "fields", b)?;
        }
        let (expected, found) = (6 * self.sites.len(), nodal_stress.nrows());
        if found != expected {
            return Err(AssemblyFault::FieldRows { what: "nodal stress", expected, found }.into());
        }
        let (elements, count) = (self.mesh.elements().len(), displacements.ncols());
        let mut errors = memory::with_capacity("the error of each element", elements * count)?;
        errors.resize(elements * count, StressError::default());
        if count == 0 {
            return Ok(errors);
        }
        let products = products_of_shapes(self.rules.fine());
        errors.par_chunks_mut(count).enumerate().for_each_init(Room::default, |room, (e, errors)| {
            let nodes = &self.mesh.elements()[e];
            room.fields.clear();
            room.fields.push(relative_displacements(displacements, nodes));
            if let Some((a, b)) = product {
                room.fields.extend([relative_displacements(a.as_mat(), nodes), relative_displacements(b, nodes)]);
            }
            let positions = self.mesh.element_positions(e);
            if is_straight(&positions) {
                self.of_straight(e, &positions, &products, nodal_stress, room, errors);
            } else {
                self.of_curved(e, &positions, nodal_stress, room, errors);
            }
        });
        Ok(errors)
    }

    /// On a straight element both stresses are quadratic in space: their energies are forms of their values at the ten nodes.
    fn of_straight(
        &self,
        e: usize,
        positions: &[[f64; 3]; 10],
        products: &[[f64; 10]; 10],
        nodal: MatRef<'_, f64>,
        room: &mut Room,
        errors: &mut [StressError],
    ) {
        let count = errors.len();
        let corners: [IntegrationPoint; 4] =
            std::array::from_fn(|corner| IntegrationPoint::new(positions, &shape_gradients(NODES[corner]), 1.0));
        room.place(&corners, count);
        // A sixth of the determinant.
        let volume = corners[0].volume / 6.0;
        let sites = self.sites.of_element(e);
        for (k, error) in errors.iter_mut().enumerate() {
            let raw: [Matrix3<f64>; 10] = std::array::from_fn(|node| {
                // Gradients are linear in space.
                let mean = |field: usize, k: usize| match node {
                    0..4 => room.gradients[node][field][k],
                    _ => {
                        let [a, b] = EDGES[node - 4];
                        0.5 * (room.gradients[a][field][k] + room.gradients[b][field][k])
                    }
                };
                let of_product = (room.fields.len() > 1).then(|| second_strain(&mean(1, 0), &mean(2, k)));
                stress(&self.materials[e], &(strain(&mean(0, k)) + of_product.unwrap_or_default()))
            });
            let raw = raw.map(|tensor| COMPONENTS.map(|at| tensor[at]));
            let off: [[f64; 6]; 10] = std::array::from_fn(|node| {
                std::array::from_fn(|c| nodal[(6 * sites[node] as usize + c, k)] - raw[node][c])
            });
            let half = 0.5 * volume;
            let energy = |tensors: &[[f64; 6]; 10]| half * complementary_form(&self.materials[e], products, tensors);
            *error = StressError { energy: energy(&raw), error: energy(&off) };
        }
    }

    fn of_curved(
        &self,
        e: usize,
        positions: &[[f64; 3]; 10],
        nodal: MatRef<'_, f64>,
        room: &mut Room,
        errors: &mut [StressError],
    ) {
        errors.fill(StressError::default());
        let points = self.rules.fine_points(positions);
        let sites = self.sites.of_element(e);
        for (point, rule) in points.iter().zip(self.rules.fine()) {
            let shapes = shape_functions(rule.point.at);
            room.place(std::slice::from_ref(point), errors.len());
            let half: f64 = 0.5 * point.volume;
            for (k, error) in errors.iter_mut().enumerate() {
                let [of_fields, product @ ..] = &room.gradients[0][..] else { continue };
                let mut strains = strain(&of_fields[k]);
                if let [a, b] = product {
                    strains += second_strain(&a[0], &b[k]);
                }
                let raw = COMPONENTS.map(|at| stress(&self.materials[e], &strains)[at]);
                let off: [f64; 6] = std::array::from_fn(|c| {
                    let recovered = |(site, shape): (&u32, f64)| shape * nodal[(6 * *site as usize + c, k)];
                    sites.iter().zip(shapes).map(recovered).sum::<f64>() - raw[c]
                });
                let energy = |tensor: &[f64; 6]| half * complementary(&self.materials[e], tensor, tensor);
                error.energy += energy(&raw);
                error.error += energy(&off);
            }
        }
    }
}

/// Room of one thread for the fields in an element: the displacements, and those of a product.
#[derive(Default)]
struct Room {
    /// Displacements of the nodes 1 to 9 against node 0.
    fields: Vec<Vec<f64>>,
    /// Gradients by place, then field, then column.
    gradients: Vec<Vec<Vec<Matrix3<f64>>>>,
}

impl Room {
    /// Finds the gradients of all fields at some places; the second field has one column.
    fn place(&mut self, places: &[IntegrationPoint], count: usize) {
        self.gradients.resize_with(places.len(), Vec::new);
        for (place, gradients) in places.iter().zip(&mut self.gradients) {
            gradients.resize_with(self.fields.len(), Vec::new);
            for (field, (relative, gradients)) in self.fields.iter().zip(gradients).enumerate() {
                displacement_gradients(relative, place, if field == 1 { 1 } else { count }, gradients);
            }
        }
    }
}

/// ∫ N_a N_b dV over the volume, of a straight element.
fn products_of_shapes(rule: &[RulePoint]) -> [[f64; 10]; 10] {
    let mut products = [[0.0; 10]; 10];
    let total: f64 = rule.iter().map(|rule| rule.point.weight).sum();
    for rule in rule {
        let shapes = shape_functions(rule.point.at);
        for (row, a) in products.iter_mut().zip(shapes) {
            row.iter_mut().zip(shapes).for_each(|(entry, b)| *entry += rule.point.weight / total * a * b);
        }
    }
    products
}

/// The mean of σ:C⁻¹:σ over an element, by its values at the nodes.
fn complementary_form(material: &Material, products: &[[f64; 10]; 10], tensors: &[[f64; 6]; 10]) -> f64 {
    let of_node = |(row, tensor): (&[f64; 10], &[f64; 6])| {
        let mut sum = [0.0; 6];
        for (product, other) in row.iter().zip(tensors) {
            sum.iter_mut().zip(other).for_each(|(sum, entry)| *sum += product * entry);
        }
        complementary(material, tensor, &sum)
    };
    products.iter().zip(tensors).map(of_node).sum()
}

/// σ:C⁻¹:τ, in the order of [`COMPONENTS`].
fn complementary(material: &Material, sigma: &[f64; 6], tau: &[f64; 6]) -> f64 {
    let nu = material.poisson_ratio;
    let trace = |t: &[f64; 6]| t[0] + t[1] + t[2];
    let product = |range: std::ops::Range<usize>| -> f64 {
        sigma[range.clone()].iter().zip(&tau[range]).map(|(s, t)| s * t).sum()
    };
    ((1.0 + nu) * (product(0..3) + 2.0 * product(3..6)) - nu * trace(sigma) * trace(tau)) / material.young_modulus
}
