//! The modes of a free body without the factor of K + sM.

use std::time::Instant;

use crate::eigen::lanczos::{LanczosPairs, largest_pairs};
use crate::eigen::ritz::{RitzPairs, rayleigh_ritz};
use crate::error::ModalError;
use crate::matrix::columns::Columns;
use crate::matrix::mass_matrix::MassMatrix;
use crate::matrix::stiffness::StiffnessMatrix;
use crate::multigrid::davidson;
use crate::multigrid::levels::{Levels, modes_beside};
use crate::progress::Progress;
use crate::solve::{Modes, SolveStats, Solver};

impl Solver<'_> {
    /// The modes by multigrid cycles, or none where these do not find them.
    pub(crate) fn modes_by_cycles(
        &self,
        levels: &Levels,
        flexible: usize,
        progress: &mut dyn FnMut(Progress),
    ) -> Result<Option<Modes>, ModalError> {
        let started = Instant::now();
        let Levels { order, factor, corners, .. } = levels;
        // What ends the search is no reason to refuse the body: the factor may find its modes.
        let Some(mut pairs) = self.pairs_by_cycles(levels, flexible, progress).ok().flatten() else { return Ok(None) };
        order.restore(&mut pairs.vectors);
        let lanczos_time = started.elapsed();

        let started = Instant::now();
        let RitzPairs { eigenvalues, shapes, force_residuals } =
            rayleigh_ritz(self.stiffness, &self.mass, &self.constraints, pairs.vectors)?;
        self.refuse_soft(&eigenvalues, &shapes, factor.shift)?;
        let stats = SolveStats {
            shift: factor.shift,
            unknowns: self.stiffness.ncols(),
            factor_entries: factor.entries(),
            peak_bytes: factor.memory.peak(modes_beside(flexible, corners)),
            block_solves: pairs.block_solves,
            basis_size: pairs.basis_size,
            cycles: pairs.block_solves,
            preparation_time: self.preparation_time(),
            ordering_time: levels.ordering_time,
            factor_time: levels.time,
            lanczos_time,
            ritz_time: started.elapsed(),
            engine: None,
        };
        let (rigid, residuals) = (self.rigid.clone(), pairs.residuals);
        Ok(Some(Modes { rigid, eigenvalues, shapes, residuals, force_residuals, stats }))
    }

    fn pairs_by_cycles(
        &self,
        levels: &Levels,
        flexible: usize,
        progress: &mut dyn FnMut(Progress),
    ) -> Result<Option<LanczosPairs>, ModalError> {
        let Levels { order, matrices, corners, coarse, factor, .. } = levels;
        let rigid = order.rows(self.rigid.shapes.as_ref());
        let at_corners = corners.at_corners(rigid.as_ref());
        let (wanted, available) = (davidson::start(flexible), 3 * corners.count() - rigid.ncols());
        if !corners.are_enough_for(wanted) {
            return Ok(None);
        }
        let mass = MassMatrix::Nodal(coarse.mass());
        let on_corners = largest_pairs(factor, &mass, at_corners.as_ref(), wanted, available, |_| ())?.vectors;
        let guess = corners.prolonged(on_corners.as_ref());
        drop((at_corners, on_corners));
        let (stiffness, mass) = (StiffnessMatrix::Nodal(matrices.stiffness()), MassMatrix::Nodal(matrices.mass()));
        let mut multigrid = levels.multigrid()?;
        davidson::lowest_pairs(stiffness, &mass, rigid.as_ref(), &mut multigrid, guess, flexible, |converged| {
            progress(Progress::Lanczos { converged, requested: flexible });
        })
    }
}
