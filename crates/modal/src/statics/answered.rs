//! The place of a static answer among shapes, and what K couples it to.

use faer::Mat;

/// A static answer among shapes, the one of them that is not K-orthogonal to the others.
#[derive(Debug, Clone)]
pub struct StaticAnswer {
    /// Its place, numbered from 0.
    pub place: usize,
    /// Its stiffness with each shape, beside that with itself (nf).
    pub coupling: Vec<f64>,
    /// Number of shapes in the places of natural modes.
    pub natural: usize,
}

impl StaticAnswer {
    /// Among the first shapes only; `None` where it is none of them.
    pub(crate) fn truncated(&self, shapes: usize) -> Option<Self> {
        let Self { place, coupling, natural } = self;
        let coupling = coupling.iter().copied().take(shapes).collect();
        (*place < shapes).then_some(Self { place: *place, coupling, natural: shapes.min(*natural) })
    }

    /// ΨᵀKΨ beside its diagonal (nf×nf).
    pub fn stiffness(&self) -> Mat<f64> {
        let size = self.coupling.len();
        let mut stiffness = Mat::zeros(size, size);
        for (k, value) in self.coupling.iter().enumerate() {
            (stiffness[(self.place, k)], stiffness[(k, self.place)]) = (*value, *value);
        }
        stiffness
    }
}
