//! Joints that lock: no motion of the bodies follows the drives.
//!
//! b are the rates of the rows that close loops by the drives alone, σ and u the weakest singular value of these rows by the free
//! motions of the tree, and its vector. Where a linkage locks,
//!
//! ```text
//! s = |u·b| / (σ |b|)
//! ```
//!
//! grows as 1/σ; where it passes a singular position it stays, Eq. (J34) of `docs/method/systems.md`.

use nalgebra::DMatrix;

use crate::error::StepError;
use crate::system::geometry::rank::Judgement;
use crate::system::radau::SystemMotion;
use crate::system::radau::rows::names;

/// s above which a linkage locks.
const LOCKED: f64 = 1e3;
/// s above which one locks that would be there within a step, and the part of the way there.
const NEAR: f64 = 10.0;
const WITHIN: f64 = 0.3;

impl SystemMotion {
    /// The reason of a step that could not be done where it is found: joints that lock where the motion is, or stops that a fixed step goes
    /// into; otherwise the error as it is.
    pub(in crate::system) fn reason_or(&mut self, error: StepError) -> StepError {
        let time = self.time();
        let step = match error {
            StepError::Open { .. } => return error,
            StepError::Newton { step, .. }
            | StepError::Tolerance { step, .. }
            | StepError::TurnTooLarge { step, .. } => step,
            _ => 0.0,
        };
        if let Some(joints) = self.locked_joints(step) {
            return StepError::Locked { time, joints: joints.into() };
        }
        let StepError::Newton { step, .. } = error else { return error };
        match self.stops_within(step) {
            Some((joints, contact)) => {
                let named = joints.iter().map(|joint| format!("\"{joint}\"")).collect::<Vec<_>>().join(", ");
                StepError::Stops { time, step, joints: named.into(), contact }
            }
            None => error,
        }
    }

    /// Names of the joints and couplings that lock where the system is, or within a step from there; `None` where none do.
    fn locked_joints(&mut self, step: f64) -> Option<String> {
        self.begin();
        self.evaluate_first(self.time).ok()?;
        let Self { first, system, .. } = self;
        let Judgement { loops, rank, .. } = Judgement::first(system, &first.posture(system), true);
        let kept: Vec<usize> = (0..loops.rows.len()).filter(|a| !rank.is_implied[loops.rows[*a]]).collect();
        let rates = &first.constraints.own_rates;
        let b: Vec<f64> = kept
            .iter()
            .map(|a| {
                let row = loops.rows[*a];
                let of_tree = loops.balance[*a].iter().map(|(of_tree, multiplier)| multiplier * rates[*of_tree]);
                (rates[row] + of_tree.sum::<f64>()) / loops.sizes[row]
            })
            .collect();
        let length = b.iter().map(|b| b * b).sum::<f64>().sqrt();
        if kept.is_empty() || length == 0.0 {
            return None;
        }
        let matrix = DMatrix::from_fn(kept.len(), loops.matrix.nrows(), |i, k| loops.matrix[(k, kept[i])]);
        let svd = matrix.try_svd(true, false, 1e-14, 1000)?;
        let weakest = svd.singular_values.imin();
        let (sigma, u) = (svd.singular_values[weakest], svd.u.as_ref()?.column(weakest).into_owned());
        let along = u.iter().zip(&b).map(|(u, b)| u * b).sum::<f64>().abs();
        let s = along / (sigma * length);
        let loop_length = loops.lengths[loops.rows[kept[u.iamax()]]];
        let is_near = s > NEAR && step * along > WITHIN * sigma * sigma * loop_length;
        if s.is_nan() || s <= LOCKED && !is_near {
            return None;
        }
        let parts: Vec<(usize, f64)> = kept.iter().zip(&u).map(|(a, u)| (*a, *u)).collect();
        let idle = loops.idle_row(&parts);
        let shares = idle.iter().zip(&loops.sizes).map(|(u, size)| (u * size).powi(2));
        Some(names(&system.connections.sums(shares)))
    }

    /// For each row of the joints and couplings, true if others imply it where bodies are rigid: what such rows share is not
    /// determined by rigid bodies. The system is where it has been assembled.
    pub(in crate::system) fn implied_rows(&self) -> Vec<bool> {
        Judgement::first(&self.system, &self.first.posture(&self.system), false).rank.is_implied
    }
}
