//! Error of the mesh: the recovered stress against that of the elements (Zienkiewicz and Zhu 1987).

use faer::{ColRef, Mat, MatRef};
use nalgebra::Matrix3;
use rayon::prelude::*;

use super::{COMPONENTS, StressRecovery};
use crate::element::deformation::{
    check_field, displacement_gradients, relative_displacements, second_strain, strain, stress,
};
use crate::element::shape::shape_functions;
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
    /// The estimate for each element: of a displacement field (N, length) and its
    /// [`nodal_stress`](Self::nodal_stress) (6m, force per area), Eq. (S3) of `docs/method/stress.md`. That of the body is their sum.
    ///
    /// # Errors
    /// Lists of another length, or with an entry that is not finite.
    pub fn error_estimate(
        &self,
        displacement: ColRef<'_, f64>,
        nodal_stress: ColRef<'_, f64>,
    ) -> Result<Vec<StressError>, AssemblyError> {
        self.estimate(displacement.as_mat(), nodal_stress)
    }

    /// The estimate for each element of a displacement field u whose strain has the product of two others in it, sym(∇u) + sym(∇aᵀ∇b): about a
    /// body that is bent by a, b is u.
    ///
    /// # Errors
    /// As [`error_estimate`](Self::error_estimate).
    pub fn error_estimate_of_product(
        &self,
        displacement: ColRef<'_, f64>,
        [a, b]: [ColRef<'_, f64>; 2],
        nodal_stress: ColRef<'_, f64>,
    ) -> Result<Vec<StressError>, AssemblyError> {
        for field in [displacement, a, b] {
            check_field(self.mesh, "fields", field.as_mat())?;
        }
        let fields = [displacement, a, b];
        let fields = Mat::from_fn(displacement.nrows(), fields.len(), |i, k| fields[k][i]);
        self.estimate(fields.as_ref(), nodal_stress)
    }

    /// The estimate of one field, or of one and the two of a product.
    fn estimate(
        &self,
        fields: MatRef<'_, f64>,
        nodal_stress: ColRef<'_, f64>,
    ) -> Result<Vec<StressError>, AssemblyError> {
        check_field(self.mesh, "displacements", fields)?;
        let (expected, found) = (6 * self.sites.len(), nodal_stress.nrows());
        if found != expected {
            return Err(AssemblyFault::FieldRows { what: "nodal stress", expected, found }.into());
        }
        let of = |e: usize| self.of_element(e, fields, nodal_stress);
        Ok((0..self.mesh.elements().len()).into_par_iter().map(of).collect())
    }

    fn of_element(&self, e: usize, fields: MatRef<'_, f64>, nodal: ColRef<'_, f64>) -> StressError {
        let count = fields.ncols();
        let relative = relative_displacements(fields, &self.mesh.elements()[e]);
        let mut gradients = Vec::with_capacity(count);
        let points = self.rules.fine_points(&self.mesh.element_positions(e));
        let shapes = self.rules.fine().iter().map(|rule| shape_functions(rule.point.at));
        let of_point = |(point, shapes): (&_, [f64; 10])| {
            displacement_gradients(&relative, point, count, &mut gradients);
            let strains = match &gradients[..] {
                [of_field, a, b] => strain(of_field) + second_strain(a, b),
                gradients => strain(&gradients[0]),
            };
            let raw = stress(&self.materials[e], &strains);
            let mut recovered = Matrix3::zeros();
            for (site, shape) in self.sites.of_element(e).iter().zip(shapes) {
                for (c, (i, j)) in COMPONENTS.into_iter().enumerate() {
                    recovered[(i, j)] += shape * nodal[6 * *site as usize + c];
                }
            }
            for (i, j) in COMPONENTS {
                recovered[(j, i)] = recovered[(i, j)];
            }
            let half: f64 = 0.5 * point.volume;
            let energy = |s: &Matrix3<f64>| half * complementary(&self.materials[e], s);
            StressError { energy: energy(&raw), error: energy(&(recovered - raw)) }
        };
        points.iter().zip(shapes).map(of_point).sum()
    }
}

/// σ:C⁻¹:σ.
fn complementary(material: &Material, stress: &Matrix3<f64>) -> f64 {
    let nu = material.poisson_ratio;
    ((1.0 + nu) * stress.norm_squared() - nu * stress.trace().powi(2)) / material.young_modulus
}
