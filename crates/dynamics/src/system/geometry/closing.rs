//! Closes the joints by small motions of the bodies, without their masses: Eq. (J35) of `docs/method/systems.md`.

use nalgebra::{Matrix3, Vector3, Vector6};

use crate::conservative::ConservativeBody;
use crate::system::description::System;
use crate::system::elimination::inverse::{Inertia, Inverse};
use crate::system::elimination::joint_matrix::{JointMatrix, Pattern};
use crate::system::geometry::tree::size_of;
use crate::system::joint::coordinate::Coordinate;
use crate::system::stage::{Stage, Start, vector};

/// Passes of the method of Levenberg and Marquardt.
const MAX_PASSES: usize = 80;
/// Its factor at first, and the least: below that the factor of dependent rows is rounding.
const DAMPING: f64 = 1e-6;
const LEAST_DAMPING: f64 = 1e-13;
/// Largest turn (rad) and shift (sizes of the system) of a body in a pass.
const MAX_TURN: f64 = 0.7;
const MAX_SHIFT: f64 = 2.0;
/// Turn of a body since the start, rad, at which increments are to be counted from where it is.
const FAR: f64 = 2.0;
/// Gaps over the size of the system that are rounding.
const ROUNDING: f64 = 1e-14;
/// Arms of markers over the largest, below which a body still counts as this long.
const SHORTEST: f64 = 1e-3;

/// The end of a search for places where the joints close.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Closing {
    /// Largest residual, as a length.
    pub gap: f64,
    /// True if bodies have moved.
    pub has_moved: bool,
    /// True if a body has turned so far that the search is to go on from there.
    pub is_far: bool,
}

impl Stage {
    /// Moves the bodies so that the joints close, from where they have been placed; their shapes stay. `turns` are the turns of the joints,
    /// and go on; `size` is that of the system.
    pub fn close(
        &mut self,
        (system, start): (&System, &Start),
        pattern: &Pattern,
        turns: &mut [f64],
        (times, size): ([f64; 2], f64),
    ) -> Closing {
        self.place(system, start);
        self.find_far_constraints(system, turns, times);
        let sizes = self.row_sizes(system, size);
        let gap_of = |stage: &Self| -> f64 {
            let gaps = stage.constraints.residuals.iter().zip(&sizes).map(|(g, size)| (g / size).abs());
            gaps.fold(0.0, |most, gap| if gap <= most { most } else { gap })
        };
        let cost_of = |stage: &Self| -> f64 {
            stage.constraints.residuals.iter().zip(&sizes).map(|(g, size)| (g / size).powi(2)).sum()
        };
        let (mut gap, mut cost, mut damping) = (gap_of(self), cost_of(self), DAMPING);
        let mut closing = Closing { gap, has_moved: false, is_far: false };
        if gap.is_nan() || gap <= ROUNDING * size {
            return closing;
        }
        let inverses = self.inverses(system);
        let mut matrix = JointMatrix::new(pattern, system.coordinates());
        let none = vec![false; pattern.len()];
        for _ in 0..MAX_PASSES {
            matrix.assemble(pattern, &self.constraints, &inverses);
            sizes.iter().enumerate().for_each(|(row, size)| matrix.add_compliance(pattern, row, damping * size * size));
            matrix.factor(pattern, &none);
            let mut multipliers: Vec<f64> = self.constraints.residuals.iter().map(|g| -g).collect();
            matrix.solve(pattern, &mut multipliers);
            let mut change = vec![0.0; system.coordinates()];
            self.constraints.add_forces(&multipliers, &mut change);
            let mut part = 1.0_f64;
            for (b, inverse) in inverses.iter().enumerate() {
                let own = &mut change[system.first[b]..system.first[b + 1]];
                inverse.apply(own);
                let [moved, turned] = [0, 3].map(|first| vector(own, first).norm());
                part = part.min(MAX_TURN / turned.max(MAX_TURN)).min(MAX_SHIFT * size / moved.max(MAX_SHIFT * size));
            }
            change.iter_mut().for_each(|x| *x *= part);
            let (before, turns_before) = (self.x.clone(), turns.to_vec());
            let mut momenta = vec![0.0; change.len()];
            self.add_in_body_axes(system, &mut change, &mut momenta);
            self.place(system, start);
            self.find_far_constraints(system, turns, times);
            let now = cost_of(self);
            if now < cost {
                let is_slow = now > 0.25 * cost;
                (cost, gap, damping) = (now, gap_of(self), (0.1 * damping).max(LEAST_DAMPING));
                closing = Closing { gap, has_moved: true, is_far: false };
                let bodies = system.first[..system.bodies.len()].iter();
                if bodies.map(|first| vector(&self.x, first + 3).norm()).fold(0.0, f64::max) > FAR {
                    return Closing { is_far: true, ..closing };
                }
                if gap <= ROUNDING * size || is_slow && gap <= 1e-12 * size {
                    break;
                }
            } else {
                self.x.copy_from_slice(&before);
                turns.copy_from_slice(&turns_before);
                self.place(system, start);
                self.find_far_constraints(system, turns, times);
                damping *= 10.0;
                if gap <= 1e-12 * size || damping > 1e6 {
                    break;
                }
            }
        }
        closing
    }

    /// Size of each row: its residual over it is a length, with angles times that of the system.
    pub fn row_sizes(&self, system: &System, size: f64) -> Vec<f64> {
        self.wrenches_of_rows(system, size).iter().map(size_of).collect()
    }

    /// Force on the second marker of each row, and moment there over the size of the system; of a coupling, the largest of each.
    pub fn wrenches_of_rows(&self, system: &System, size: f64) -> Vec<Vector6<f64>> {
        let joints = &system.connections.joints;
        let of = |force: &Vector3<f64>, moment: &Vector3<f64>| {
            Vector6::from_fn(|i, _| if i < 3 { force[i] } else { moment[i - 3] / size })
        };
        let mut wrenches = Vec::with_capacity(system.rows());
        for joint in joints {
            for (markers, rows) in joint.groups().filter(|(_, rows)| !rows.is_empty()) {
                let places = self.places(system, markers);
                for row in rows {
                    let wrench = row.wrench(places.each_ref(), [0.0; 2]);
                    // A turn that is held, by an angle, has a moment of one where it is closed.
                    let moment = wrench.moments[1];
                    let length = moment.norm();
                    let is_turn = wrench.force == Vector3::zeros() && row.outside().is_none() && length > 0.0;
                    wrenches.push(of(&wrench.force, &if is_turn { moment / length } else { moment }));
                }
            }
        }
        for coupling in &system.connections.couplings {
            let most = |of: Coordinate| {
                let terms = coupling.terms.iter().filter(|term| term.coordinate == of);
                terms.map(|term| term.factor.abs()).fold(0.0, f64::max)
            };
            let [turn, slide] = [Coordinate::Turn, Coordinate::Slide].map(most);
            wrenches.push(of(&(Vector3::z() * slide), &(Vector3::z() * turn)));
        }
        wrenches
    }

    /// Inverses of the metric of each body: a shift counts as a turn by which the farthest marker moves as much.
    fn inverses(&self, system: &System) -> Vec<Inverse<f64>> {
        let mut arms = vec![0.0_f64; system.bodies.len()];
        for marker in system.connections.joints.iter().flat_map(|joint| joint.groups().flat_map(|(of, _)| of)) {
            let Some(body) = marker.body() else { continue };
            let place = marker.place(Some(&self.body_place(system, body)));
            arms[body] = arms[body].max((place.position - self.positions[body]).norm());
        }
        let longest = arms.iter().copied().fold(0.0, f64::max);
        let longest = if longest > 0.0 { longest } else { 1.0 };
        let of_body = |(arm, body): (f64, &ConservativeBody)| {
            let arm = arm.max(SHORTEST * longest);
            let flexible = body.flexible();
            let inertia = Inertia { locked: Matrix3::identity() * (arm * arm), ..Inertia::new(flexible) };
            let mut inverse = Inverse::new(flexible);
            inverse.find(1.0, &inertia, |_| [f64::INFINITY, 0.0]);
            inverse
        };
        arms.into_iter().zip(&system.bodies).map(of_body).collect()
    }
}
