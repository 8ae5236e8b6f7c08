//! Modes of a bulky body without the factor of K + sM.

use std::time::Instant;

use faer::Mat;

use crate::constraints::Constraints;
use crate::davidson;
use crate::error::ModalError;
use crate::foretold::Foretold;
use crate::lanczos::{FIXED, largest_pairs};
use crate::mass_matrix::MassMatrix;
use crate::multigrid::Multigrid;
use crate::progress::Progress;
use crate::ritz::{RitzPairs, rayleigh_ritz};
use crate::shifted::Shifted;
use crate::solve::{Modes, SolveStats, Solver};
use crate::stiffness::StiffnessMatrix;
use crate::support::Support;

impl Solver<'_> {
    /// Modes by the multigrid cycle; none where the body is not for it.
    pub(crate) fn modes_without_factor(
        &self,
        flexible: usize,
        progress: &mut dyn FnMut(Progress),
    ) -> Result<Option<Modes>, ModalError> {
        let (Some(corners), StiffnessMatrix::Nodal(stiffness), MassMatrix::Nodal(mass)) =
            (&self.corners, self.stiffness, &self.mass)
        else {
            return Ok(None);
        };
        if !self.constraints.is_empty() || std::env::var("MG").is_err() {
            return Ok(None);
        }
        let t = Instant::now();
        let matrices = corners.matrices(stiffness, mass);
        eprintln!("rap {:?}", t.elapsed());
        let positions: Vec<[f64; 3]> = corners.nodes.iter().map(|node| self.positions()[*node as usize]).collect();
        let coarse_stiffness = StiffnessMatrix::Nodal(matrices.stiffness());
        let coarse_mass = MassMatrix::Nodal(matrices.mass());
        let constraints = Constraints::new(&Support::free(), &positions, 3)?;
        let foretold = Foretold::new(coarse_stiffness, matrices.bytes(), FIXED);
        let shift = self.shift()?;
        let factor =
            Shifted::factor(coarse_stiffness, &coarse_mass, shift, &constraints, foretold, |_| 0, |_| ())?;
        eprintln!("factor {:?} shift {shift:e}", t.elapsed());
        let rigid = corners.at_corners(self.rigid.shapes.as_ref());
        let begin = flexible + flexible / 2 + 8;
        let pairs = largest_pairs(&factor, &coarse_mass, rigid.as_ref(), begin, 3 * corners.count() - 6, |_| ())?;
        eprintln!("coarse modes {:?}", t.elapsed());
        let start = corners.prolonged(pairs.vectors.as_ref());
        let Some(mut multigrid) = Multigrid::new(stiffness, corners, &factor)? else { return Ok(None) };
        eprintln!("multigrid {:?}", t.elapsed());
        let rigid = self.rigid.shapes.as_ref();
        let pairs = davidson::lowest_pairs(self.stiffness, &self.mass, rigid, &mut multigrid, start, flexible, |converged| {
            eprintln!("{:?} converged {converged}", t.elapsed());
            progress(Progress::Lanczos { converged, requested: flexible });
        })?;
        let Some(pairs) = pairs else { return Ok(None) };
        let RitzPairs { eigenvalues, shapes, force_residuals } =
            rayleigh_ritz(self.stiffness, &self.mass, &self.constraints, &pairs.vectors)?;
        eprintln!("{:?} {eigenvalues:?} {force_residuals:?} basis {}", t.elapsed(), pairs.basis_size);
        let stats = SolveStats { shift, unknowns: shapes.nrows(), factor_entries: factor.entries(), ..SolveStats::default() };
        let _ = Mat::<f64>::new();
        Ok(Some(Modes { rigid: self.rigid.clone(), eigenvalues, shapes, residuals: pairs.residuals, force_residuals, stats }))
    }
}
