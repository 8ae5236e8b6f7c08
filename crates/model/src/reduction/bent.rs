//! The modes by which a body bends far.

pub(crate) mod answer;
pub(crate) mod backbones;
pub(crate) mod manifold;

/// The modes that bend the body far, numbered from 0, and those that follow them.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub(crate) struct Bent {
    pub large: Vec<usize>,
    pub following: Vec<usize>,
}

impl Bent {
    /// All of them: the large ones first.
    pub fn all(&self) -> Vec<usize> {
        [&self.large[..], &self.following].concat()
    }
}
