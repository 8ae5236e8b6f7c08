//! The two levels of the cycles that take the place of the factor of K + sM.

use std::time::Duration;

use crate::eigen::lanczos::FIXED;
use crate::error::ModalError;
use crate::factor::shifted::Shifted;
use crate::memory_estimate::of_vectors;
use crate::multigrid::coarse::{CoarseMatrices, Corners};
use crate::multigrid::cycle::Multigrid;
use crate::multigrid::davidson;
use crate::multigrid::renumbering::{Renumbering, Reordered};
use crate::multigrid::smoother::Smoother;

/// Both levels, with the nodes in spatial order.
pub(crate) struct Levels {
    pub order: Renumbering,
    /// K and M.
    pub matrices: Reordered,
    pub smoother: Smoother,
    pub corners: Corners,
    /// K_c and M_c of the corners.
    pub coarse: CoarseMatrices,
    /// The factor of K_c + sM_c.
    pub factor: Shifted,
    /// Time of the orderings, of K + sM as well.
    pub ordering_time: Duration,
    /// Time of the rest of them.
    pub time: Duration,
}

impl Levels {
    /// The cycle.
    pub(crate) fn multigrid(&self) -> Result<Multigrid<'_>, ModalError> {
        Multigrid::new(&self.smoother, &self.corners, &self.factor)
    }
}

/// Bytes of the search for `modes` modes, beside the levels.
pub(crate) fn modes_beside(modes: usize, corners: &Corners) -> usize {
    // The rigid modes twice: in the basis, and in the order of the levels.
    let vectors = 2 * FIXED + davidson::room(modes) + davidson::beside(modes);
    Multigrid::bytes(corners) + of_vectors(3 * corners.nodes_in_all(), vectors)
}
