//! Questions to the finite-element model of a body.

pub(crate) mod solved;
pub(crate) mod statics;

use dynamics::DrivenMotion;
use faer::{Mat, MatRef};
use fem_tet10::{GeometricTerms, StressSites};
use modal::{BucklingAccuracy, Modes, ReducedBody, SecondOrderShapes, StaticAccuracy};
use nalgebra::Vector3;

use crate::error::BuildError;
use crate::load::mesh_load::UnitWeight;
use crate::progress::BuildProgress;

/// The finite-element model of a body: all that depends on its mesh and takes long. The functions of `modal` and `fem_tet10`
/// with these names say more.
pub(crate) trait Structure {
    /// The rigid and the `flexible` lowest other modes.
    fn modes(&self, flexible: usize, progress: &mut dyn FnMut(BuildProgress)) -> Result<Modes, BuildError>;

    /// Forces of a unit acceleration of the whole body.
    fn unit_weight(&self) -> Result<UnitWeight, BuildError>;

    /// M times fields (3n×k).
    fn mass_product(&self, fields: MatRef<'_, f64>) -> Result<Mat<f64>, BuildError>;

    /// K times fields (3n×k).
    fn stiffness_product(&self, fields: MatRef<'_, f64>) -> Result<Mat<f64>, BuildError>;

    /// Static responses to forces (3n×k), from the natural ones of the modes on.
    fn static_response(
        &self,
        modes: &Modes,
        forces: MatRef<'_, f64>,
        accuracy: StaticAccuracy,
    ) -> Result<Mat<f64>, BuildError>;

    /// Static responses to the forces of loads (3n×k), to the centrifugal field of each pair of spins, and to the inertia of a
    /// driven motion, side by side, from the natural ones of the modes on.
    fn static_responses(&self, modes: &Modes, forces: &StaticForces) -> Result<Mat<f64>, BuildError>;

    /// The modes, with shapes appended that make them span static responses (3n×k).
    fn with_static_shapes(&self, modes: Modes, responses: MatRef<'_, f64>) -> Result<Modes, BuildError>;

    /// The shapes that follow large modes, by the forces of second order and the static responses to them.
    fn second_order_shapes(
        &self,
        modes: Modes,
        large: &[usize],
        forces: MatRef<'_, f64>,
        responses: MatRef<'_, f64>,
    ) -> Result<SecondOrderShapes, BuildError>;

    /// The body in the coordinates of its modes.
    fn reduced_body(&self, modes: &Modes) -> Result<ReducedBody, BuildError>;

    /// Remainder of each of the static responses (6) beside the modes: √(uᵀMu − Σ(Φ_kᵀMu)²).
    fn remainders(&self, modes: &Modes, responses: MatRef<'_, f64>) -> Result<Vec<f64>, BuildError>;

    /// Stiffness in the modes (nf×nf) by the stress of each displacement field (3n×k). `known` are those in the first of the
    /// modes, one for each field, or none.
    fn stress_stiffness(
        &self,
        displacements: MatRef<'_, f64>,
        modes: &Modes,
        terms: GeometricTerms,
        known: &[Mat<f64>],
    ) -> Result<Vec<Mat<f64>>, BuildError>;

    /// The forces of second order (3n×p) of pairs of fields (3n×k).
    fn second_order_forces(&self, fields: MatRef<'_, f64>, pairs: &[[usize; 2]]) -> Result<Mat<f64>, BuildError>;

    /// The energies of second order of quadruples of fields (3n×k).
    fn second_order_energies(&self, fields: MatRef<'_, f64>, quadruples: &[[usize; 4]])
    -> Result<Vec<f64>, BuildError>;

    /// Where nodal stress is known.
    fn stress_sites(&self) -> Result<&StressSites, BuildError>;

    /// The stress (6m×k) of displacement fields (3n×k).
    fn nodal_stress(&self, displacements: MatRef<'_, f64>) -> Result<Mat<f64>, BuildError>;

    /// The stress of second order (6m×p) of pairs of fields (3n×k).
    fn second_order_nodal_stress(&self, fields: MatRef<'_, f64>, pairs: &[[usize; 2]]) -> Result<Mat<f64>, BuildError>;

    /// The lowest buckling ratio by the stress of a static response (3n×1), from the modes on.
    fn lowest_buckling_ratio(
        &self,
        response: MatRef<'_, f64>,
        modes: &Modes,
        accuracy: BucklingAccuracy,
    ) -> Result<f64, BuildError>;
}

/// Forces that static responses are asked for.
pub(crate) struct StaticForces {
    /// Forces of the loads (3n×k).
    pub of_loads: Mat<f64>,
    /// True if the centrifugal fields of the pairs of spins follow.
    pub spin: bool,
    /// The driven motion whose inertia comes last.
    pub drive: Option<DrivenMotion>,
    /// The point that positions are measured from.
    pub origin: Vector3<f64>,
}

impl StaticForces {
    /// How many there are.
    pub fn count(&self) -> usize {
        self.of_loads.ncols() + if self.spin { 6 } else { 0 } + usize::from(self.drive.is_some())
    }
}
