//! Rows that others imply, where the system is; and the residuals of all rows, which every step watches.

use std::f64::consts::TAU;

use crate::conservative::part;
use crate::error::RateError;
use crate::system::geometry::loops::Loops;
use crate::system::geometry::rank::{Judgement, Rank};
use crate::system::geometry::tree::size_of_system;
use crate::system::joint::coordinate::Coordinate;
use crate::system::radau::{Failed, SystemMotion};
use crate::system::stage::vector;

/// Residuals over the length of their loops that are rounding.
const CLOSED: f64 = 1e-9;
/// The largest residual, over the length of its loop, of a row that begins to hold within a step.
const LATE: f64 = 1e-7;
/// The largest residual, over the size of the system, of rows that cannot all be closed: the clearance of joints.
const CLEARANCE: f64 = 1e-6;
/// Smallest part of a row below which a position is near a singular one: what the row bore in the last step, which grows beyond all bounds there,
/// says nothing about the next.
pub(super) const NEAR_SINGULAR: f64 = 1e-3;
/// A joint with less than this part of the largest share is not named.
const SHARE: f64 = 0.01;
/// Closings from where the last one has left the bodies.
const MAX_CLOSINGS: usize = 20;

impl SystemMotion {
    /// Judges which rows others imply, where the first stage has been evaluated and the joints are closed.
    pub(in crate::system) fn judge(&mut self) {
        let Self { first, system, matrices, judgement, judged_at, time, .. } = self;
        if *judged_at == Some(*time) {
            return;
        }
        *judged_at = Some(*time);
        // The steps of a tree allocate nothing.
        match judgement {
            Some(known) if known.tree.is_all() || !known.is_of_now() => return,
            Some(known) => known.again(system, &first.posture(system)),
            None => *judgement = Some(Judgement::first(system, &first.posture(system), true)),
        }
        if let Some(known) = judgement {
            matrices.is_left_out[..system.rows()].copy_from_slice(&known.rank.is_implied);
        }
    }

    /// True if the last step began so near a singular position that the rounding of places of the ground decides how the linkage goes on.
    pub(in crate::system) fn is_undecided(&self) -> bool {
        self.judgement.as_ref().is_some_and(|known| known.rank.is_undecided)
    }

    /// The smallest part of a row beside others that is kept, at most 1: small near a singular position.
    pub(super) fn weakest_row(&self) -> f64 {
        self.judgement.as_ref().map_or(1.0, |known| known.rank.smallest.min(1.0))
    }

    /// The largest residual of all rows at the end of the last step, as a length over the size of the system.
    pub(in crate::system) fn residual_of_last_step(&self) -> f64 {
        let (Some(known), [.., last]) = (&self.judgement, &self.stages) else { return 0.0 };
        let rows = last.constraints.residuals.iter().zip(&known.loops.sizes);
        rows.map(|(g, size)| (g / size).abs()).fold(0.0, f64::max) / known.tree.size
    }

    /// Judges the rows anew wherever the system is next.
    pub(in crate::system) fn forget_judgement(&mut self) {
        self.judged_at = None;
    }

    /// Looks at the residuals of all rows at the end of a step, after its projection by the rows that are kept: where others have
    /// opened, all of them are closed by geometry, and those that hold from there on are found.
    pub(super) fn watch(&mut self, times: [f64; 2]) -> Result<(), Failed> {
        let Self { stages: [.., last], system, start, patterns, judgement, matrices, is_controlled, .. } = self;
        let Some(known) = judgement else { return Ok(()) };
        let Judgement { tree, loops, rank } = &*known;
        let open = |residuals: &[f64]| -> f64 {
            let rows = residuals.iter().zip(&loops.sizes).zip(&loops.lengths);
            let gap = |g: f64| if g.is_nan() { g } else { (g.abs() - system.rounding).max(0.0) };
            rows.map(|((g, size), length)| gap(g / size) / length).fold(0.0, f64::max)
        };
        let gap = open(&last.constraints.residuals);
        if gap <= CLOSED {
            return Ok(());
        }
        if !rank.is_implied.contains(&true) && known.is_of_now() {
            // What is kept has not been closed.
            return if gap > CLEARANCE { Err(Failed::Newton) } else { Ok(()) };
        }
        let residuals = last.constraints.residuals.clone();
        let x = last.x.clone();
        let joints = 0..start.joints.len();
        let mut turns: Vec<f64> = joints.map(|joint| last.joint_coordinates(system, start, joint).turn).collect();
        let size = tree.size;
        last.close((system, start), &patterns.rows, &mut turns, (times, size));
        last.place(system, start);
        last.find_constraints(system, start, times);
        let left = open(&last.constraints.residuals);
        if left <= CLOSED {
            let held: Vec<bool> = rank.is_implied.iter().map(|is_implied| !is_implied).collect();
            let loops = Loops::new(system, &last.posture(system), tree, true);
            let now = Rank::new(&loops, &held, system.rounding);
            let has_risen = now.is_implied.iter().zip(&rank.is_implied).any(|(now, then)| *then && !*now);
            if has_risen && gap > LATE && *is_controlled {
                return Err(Failed::Newton);
            }
            matrices.is_left_out[..system.rows()].copy_from_slice(&now.is_implied);
            (known.loops, known.rank) = (loops, now);
            // The velocities then fit them, too.
            return if matrices.factor_mass(patterns, last) { Ok(()) } else { Err(Failed::Newton) };
        }
        if left > CLEARANCE {
            let rows = rank.idle_part(&residuals);
            let joints =
                names(&system.connections.sums(rows.iter().zip(&loops.sizes).map(|(u, size)| (u * size).powi(2))));
            let most = residuals.iter().zip(&loops.sizes).map(|(g, size)| (g / size).abs()).fold(0.0, f64::max);
            return Err(Failed::Open { joints: joints.into(), gap: most });
        }
        // Kept as they are.
        last.x.copy_from_slice(&x);
        last.place(system, start);
        last.find_constraints(system, start, times);
        Ok(())
    }

    /// Moves the bodies as they are shaped so that the joints close, by geometry alone. They keep the velocities of their origins and
    /// their angular velocities. Returns the largest residual that is left, as a length over the size of the system.
    pub(super) fn close_joints(&mut self) -> Result<f64, Failed> {
        let mut gap = 0.0;
        for _ in 0..MAX_CLOSINGS {
            self.begin();
            let Self { stages: [.., last], system, start, patterns, .. } = self;
            last.x.fill(0.0);
            last.y.fill(0.0);
            last.place(system, start);
            last.find_constraints(system, start, [start.time; 2]);
            let size = size_of_system(system, &last.posture(system));
            let mut turns: Vec<f64> = start.joints.iter().map(|joint| joint.turn).collect();
            let closing = last.close((system, start), &patterns.rows, &mut turns, ([start.time; 2], size));
            gap = closing.gap / size;
            if !closing.has_moved {
                break;
            }
            start.joints.iter_mut().zip(turns).for_each(|(joint, turn)| joint.turn = turn);
            self.take_places()?;
            if !closing.is_far {
                break;
            }
        }
        self.count_driven_turns();
        Ok(gap)
    }

    /// Takes the places of the bodies in the last stage, with their velocities as they were.
    fn take_places(&mut self) -> Result<(), Failed> {
        let [.., last] = &self.stages;
        for (b, body) in self.system.bodies.iter().enumerate() {
            let first = self.system.first[b];
            let mut state = body.motion_in_frame(&self.bodies[b])?;
            // Nothing has moved on.
            state.origin_global = last.positions[b];
            state.attitude = state.attitude.advanced_by(&vector(&last.x, first + 3));
            let before = *body.list(&self.bodies[b]).slow();
            let mut moved = body.state_in_frame(&state).map_err(|_| Failed::Newton)?;
            let mut list = body.list_mut(&mut moved);
            let mut slow = *list.slow();
            let works = part::WORK..slow.len();
            slow[works.clone()].copy_from_slice(&before[works]);
            list.set_slow(&slow);
            self.bodies[b] = moved;
        }
        Ok(())
    }

    /// Counts the turns of joints that drives turn by the value of the drive; sums of couplings go along.
    fn count_driven_turns(&mut self) {
        let Self { system, start, time, .. } = self;
        for (number, joint) in
            system.connections.joints.iter().enumerate().filter(|(_, joint)| joint.is_turned_by_drive())
        {
            let off = joint.driven_at([*time; 2])[0] - start.joints[number].turn;
            let turns = (off / TAU).round() * TAU;
            if turns != 0.0 {
                start.joints[number].turn += turns;
                for coupling in &mut system.connections.couplings {
                    let terms = coupling.terms.iter();
                    let of_joint = terms.filter(|term| term.joint == number && term.coordinate == Coordinate::Turn);
                    let shift: f64 = of_joint.map(|term| term.factor * turns).sum();
                    coupling.sum = coupling.sum.map(|sum| sum + shift);
                }
            }
        }
    }

    /// The largest residual of all rows where the system is, as a length over the size of the system.
    ///
    /// # Errors
    /// [`RateError`] where a body's velocities cannot be found.
    pub fn largest_residual(&mut self) -> Result<f64, RateError> {
        self.begin();
        self.evaluate_first(self.time)?;
        let size = size_of_system(&self.system, &self.first.posture(&self.system));
        let sizes = self.first.row_sizes(&self.system, size);
        let rows = self.first.constraints.residuals.iter().zip(sizes);
        Ok(rows.map(|(g, row)| (g / row).abs()).fold(0.0, f64::max) / size)
    }
}

/// Names of joints and couplings with a share of the largest worth naming, in quotes.
pub(in crate::system) fn names(shares: &[(&str, f64)]) -> String {
    let largest = shares.iter().map(|(_, share)| *share).fold(0.0, f64::max);
    let named = shares.iter().filter(|(_, share)| *share >= SHARE * largest && *share > 0.0);
    named.map(|(name, _)| format!("\"{name}\"")).collect::<Vec<_>>().join(", ")
}
