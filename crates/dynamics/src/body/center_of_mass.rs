//! The centre of mass of a body that deforms.

use nalgebra::Vector3;
use reduced_body::ReducedBody;

/// Where the centre of mass of a body is, seen from its origin.
#[derive(Debug, Clone)]
pub struct CenterOfMass {
    /// In the undeformed body.
    pub undeformed_body: Vector3<f64>,
    /// t_i/m: what each flexible mode adds (nf); empty for a free body, whose modes leave it where it is.
    columns: Vec<Vector3<f64>>,
}

impl CenterOfMass {
    /// The constants of a body.
    pub fn new(body: &ReducedBody) -> Self {
        let added = |k: usize| Vector3::from_fn(|i, _| body.translation_first[i][k] / body.mass);
        let columns = if body.motion.is_free() { Vec::new() } else { (0..body.flexible()).map(added).collect() };
        Self { undeformed_body: body.center_of_mass - body.origin, columns }
    }

    /// Part of each flexible mode; none for a free body.
    pub(crate) fn columns(&self) -> &[Vector3<f64>] {
        &self.columns
    }

    /// Part of flexible modal coordinates, or of their rates.
    pub fn deformation(&self, flexible: &[f64]) -> Vector3<f64> {
        self.columns.iter().zip(flexible).map(|(column, q)| column * *q).sum()
    }

    /// Position from the origin, body components.
    pub fn position_body(&self, flexible: &[f64]) -> Vector3<f64> {
        self.undeformed_body + self.deformation(flexible)
    }
}
