//! Joints that lock: their rows hold each other, and no motion of the bodies satisfies them.
//!
//! Where joints lock, forces y of their rows are in balance on rigid bodies, G M⁻¹ Gᵀ y ≈ 0, though no row is implied by others
//! at the beginning. The row with the smallest pivot of that matrix gives y; the joints that y loads are those that lock.

use crate::system::elimination::joint_matrix::JointMatrix;
use crate::system::radau::SystemMotion;
use crate::system::relaxed::rigid_inverses;

/// A pivot below this part of its diagonal entry locks. Of a link at an angle α to where it locks it is about α².
const LOCKED: f64 = 1e-2;
/// A joint with less than this part of the largest share is not named.
const SHARE: f64 = 0.01;

impl SystemMotion {
    /// Names of the joints and couplings that lock where the system is; empty where none do. `is_implied`: the rows that others
    /// imply at the beginning.
    pub(super) fn locked_joints(&mut self, is_implied: &[bool]) -> Vec<String> {
        self.begin();
        if self.evaluate_first(self.time).is_err() {
            return Vec::new();
        }
        let Self { first, system, patterns, .. } = self;
        let Some(inverses) = rigid_inverses(&first.inertia) else { return Vec::new() };
        let mut of_rigid = JointMatrix::new(&patterns.rows, system.coordinates());
        of_rigid.assemble(&patterns.rows, &first.constraints, &inverses);
        of_rigid.factor(&patterns.rows, &mut is_implied.to_vec(), false);
        let pivots = (0..is_implied.len()).filter(|row| !is_implied[*row]).map(|row| (row, of_rigid.pivot_part(row)));
        let Some((row, _)) = pivots.filter(|(_, part)| *part < LOCKED).min_by(|a, b| a.1.total_cmp(&b.1)) else {
            return Vec::new();
        };
        let mut y = vec![0.0; is_implied.len()];
        y[row] = 1.0;
        of_rigid.solve(&patterns.rows, &mut y);
        let shares = system.connections.sums(y.iter().enumerate().map(|(row, y)| y * y * of_rigid.diagonal(row)));
        let largest = shares.iter().map(|(_, share)| *share).fold(0.0, f64::max);
        shares.into_iter().filter(|(_, share)| *share >= SHARE * largest).map(|(name, _)| name.to_owned()).collect()
    }
}
