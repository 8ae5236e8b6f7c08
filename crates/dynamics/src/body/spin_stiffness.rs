//! The stiffness by the stress of the spin, by what it acts on.

use faer::Mat;

use crate::conservative::manifold::Manifold;

/// The K_ij of [`ReducedBody::PAIRS`](modal::ReducedBody::PAIRS) of a body.
pub(crate) struct SpinStiffness {
    /// Stiffness on the coordinates of the shapes (nf × nf): all, but on a manifold the parts between a large mode and
    /// another.
    pub on_shapes: [Mat<f64>; 6],
    /// Stiffness on the modal coordinates themselves: on a manifold, the parts between modes that are not large.
    pub on_modes: Option<[Mat<f64>; 6]>,
}

impl SpinStiffness {
    pub fn new(stiffness: &[Mat<f64>; 6], manifold: Option<&Manifold>) -> Self {
        let Some(manifold) = manifold else { return Self { on_shapes: stiffness.clone(), on_modes: None } };
        let is_large = |i: usize, j: usize| [i, j].iter().any(|k| manifold.large().contains(k));
        let part = |size: usize, of_large: bool| {
            let entry = |k: &Mat<f64>, i, j| if is_large(i, j) == of_large { k[(i, j)] } else { 0.0 };
            stiffness.each_ref().map(|k| Mat::from_fn(size, size, |i, j| entry(k, i, j)))
        };
        Self { on_shapes: part(manifold.body().flexible(), true), on_modes: Some(part(manifold.modes(), false)) }
    }
}
