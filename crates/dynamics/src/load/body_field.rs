//! A field of forces in modal coordinates.

use keys::{Key, Keyed};
use nalgebra::Vector3;

use crate::body::second_order::SecondOrder;

/// Forces f_i on nodes, body components, in modal coordinates.
#[derive(Debug, Clone, serde::Serialize, serde::Deserialize)]
pub struct BodyField {
    /// Σ f_i.
    pub force_body: Vector3<f64>,
    /// Σ X_i × f_i.
    pub moment_body: Vector3<f64>,
    /// Ψᵀ f, rigid and flexible modes (6+nf).
    pub modal: Vec<f64>,
    /// Part of each flexible mode in the resultant: of a pressure that turns with its surface (nf, or none).
    pub force_change: Vec<Vector3<f64>>,
    /// Part of each flexible mode in the moment, Σ Φ_k,i × f_i + X_i × ∂f_i/∂q_k (nf).
    pub moment_change: Vec<Vector3<f64>>,
    /// L = Ψᵀ ∂f/∂q of a field that follows the deformation, column by column (nf×nf, or none).
    pub load_stiffness: Vec<f64>,
    /// The geometric stiffness of the field's own stress, along x.
    pub second_order: Option<SecondOrder>,
}

impl Keyed for BodyField {
    fn key(&self, key: Key) -> Key {
        let Self { force_body, moment_body, modal, force_change, moment_change, load_stiffness, second_order } = self;
        key.of("body field", 1)
            .with("force", force_body)
            .with("moment", moment_body)
            .with("modal", modal)
            .with("force change", force_change.as_slice())
            .with("moment change", moment_change.as_slice())
            .with("load stiffness", load_stiffness)
            .with("second order", second_order)
    }
}
