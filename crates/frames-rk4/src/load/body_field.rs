//! A field of forces in modal coordinates.

use nalgebra::Vector3;

/// Forces f_i on nodes, body components, in modal coordinates.
#[derive(Debug, Clone)]
pub struct BodyField {
    /// Σ f_i.
    pub force_body: Vector3<f64>,
    /// Σ X_i × f_i.
    pub moment_body: Vector3<f64>,
    /// Ψᵀ f, rigid and flexible modes (6+nf).
    pub modal: Vec<f64>,
    /// Σ Φ_k,i × f_i for each flexible mode: what a deformation adds to the moment (nf).
    pub lever: Vec<Vector3<f64>>,
}
