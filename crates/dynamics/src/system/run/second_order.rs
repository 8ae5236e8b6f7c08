//! The start of a run, to second order: rows that others imply there have accelerations that may not fit, Eq. (J33) of
//! `docs/method/systems.md`.
//!
//! With u the multipliers of rows that do nothing to the bodies, u·(Ġv + ġ_t) has to be zero. Where it is not and one motion n is free,
//! the system branches: u·(Ġv + ġ_t) of v + s n is a quadratic in s, and its roots are the branches.

use crate::error::SetupError;
use crate::system::geometry::rank::Judgement;
use crate::system::radau::rows::names;
use crate::system::radau::{Failed, SystemMotion};
use crate::system::reactions::{Passing, find_row_accelerations, short_time};
use crate::system::stage::{put, vector};

/// Part of the accelerations of rows that is rounding of their differences.
const ROUNDING: f64 = 1e-6;

/// A position from which a system can go on in two ways.
#[derive(Debug, Clone, PartialEq)]
pub struct Branching {
    /// Joints whose rates differ: the name, the rate of its turn or slide on the branch that is taken, and on the other.
    pub joints: Vec<(String, [f64; 2])>,
}

/// The accelerations of the rows in a motion.
struct Accelerations {
    /// u·(Ġv + ġ_t), as lengths, for each u.
    idle: Vec<f64>,
    /// Below this they are rounding.
    rounding: f64,
}

impl SystemMotion {
    /// Looks at the start to second order, and takes the branch next to the velocities where it branches.
    ///
    /// # Errors
    /// [`SetupError::Contradiction`] where no motion fits the rows.
    pub(super) fn test_start(&mut self) -> Result<Option<Branching>, SetupError> {
        self.begin();
        self.evaluate_first(self.time).map_err(|_| SetupError::SINGULAR)?;
        let judged = Judgement::first(&self.system, &self.first.posture(&self.system), true);
        if judged.rank.idle.is_empty() {
            return Ok(None);
        }
        let given = self.first.velocities.clone();
        let now = self.accelerations(&judged, &given);
        let Some(worst) = (0..now.idle.len()).max_by(|a, b| now.idle[*a].abs().total_cmp(&now.idle[*b].abs())) else {
            return Ok(None);
        };
        if now.idle[worst].abs() <= now.rounding {
            return Ok(None);
        }
        let free = self.system.coordinates() + judged.rank.idle.len() - self.system.rows();
        let contradiction = |motion: &Self| {
            let mut shares = vec![0.0; motion.system.rows()];
            for (idle, q) in judged.rank.idle.iter().zip(&now.idle) {
                for ((share, u), size) in shares.iter_mut().zip(idle).zip(&judged.loops.sizes) {
                    *share += (q * u * size).powi(2);
                }
            }
            let joints = names(&motion.system.connections.sums(shares.into_iter())).into();
            SetupError::Contradiction { joints, acceleration: now.idle[worst].abs() }
        };
        let direction = match &judged.rank.free {
            Some(direction) if free == 1 => direction,
            // Of several motions nothing is known before they begin.
            _ if free > 0 => return Ok(None),
            _ => return Err(contradiction(self)),
        };
        let direction = judged.loops.motion(&self.system, &self.first.posture(&self.system), &judged.tree, direction);
        let length = |list: &[f64]| list.iter().fold(0.0_f64, |most, x| most.max(x.abs()));
        let step = length(&given) / length(&direction);
        let along = |s: f64| -> Vec<f64> { given.iter().zip(&direction).map(|(v, n)| v + s * n).collect() };
        let [ahead, back] = [step, -step].map(|s| self.accelerations(&judged, &along(s)).idle[worst]);
        let (a, b, c) = (0.5 * (ahead + back) - now.idle[worst], 0.5 * (ahead - back), now.idle[worst]);
        let mut roots: Vec<f64> = Vec::new();
        if a.abs() <= now.rounding {
            if b.abs() > now.rounding {
                roots.push(-c / b);
            }
        } else {
            let square = b * b - 4.0 * a * c;
            if square > ROUNDING * (b * b + (4.0 * a * c).abs()) {
                let sum = -0.5 * (b + b.signum() * square.sqrt());
                roots.extend([sum / a, c / sum]);
            }
        }
        let fits = |motion: &mut Self, root: f64| {
            let there = motion.accelerations(&judged, &along(root * step));
            there.idle.iter().all(|q| q.abs() <= 1e2 * there.rounding.max(now.rounding))
        };
        roots.retain(|root| fits(self, *root));
        roots.sort_by(|a, b| a.abs().total_cmp(&b.abs()));
        let Some(taken) = roots.first() else { return Err(contradiction(self)) };
        let other = roots.get(1).copied();
        let rates = |motion: &mut Self, root: f64| -> Vec<f64> {
            motion.first.velocities.copy_from_slice(&along(root * step));
            let joints = 0..motion.system.connections.joints.len();
            let of_joint = |joint: usize| {
                let found = motion.first.joint_coordinates(&motion.system, &motion.start, joint);
                if found.turn_rate == 0.0 { found.slide_rate } else { found.turn_rate }
            };
            joints.map(of_joint).collect()
        };
        let of_taken = rates(self, *taken);
        let of_other = other.map(|root| rates(self, root));
        self.take_velocities(&along(taken * step)).map_err(|_| SetupError::SINGULAR)?;
        let Some(of_other) = of_other else { return Ok(None) };
        let most = of_taken.iter().chain(&of_other).fold(0.0_f64, |most, rate| most.max(rate.abs()));
        let joints = self.system.connections.joints.iter().zip(of_taken.into_iter().zip(of_other));
        let differ = joints.filter(|(_, (taken, other))| (taken - other).abs() > 1e-6 * most);
        Ok(Some(Branching {
            joints: differ.map(|(joint, (taken, other))| (joint.name.clone(), [taken, other])).collect(),
        }))
    }

    fn accelerations(&mut self, judged: &Judgement, velocities: &[f64]) -> Accelerations {
        let Self { first, stages: [scratch, ..], system, start, .. } = self;
        let mut x_rates = velocities.to_vec();
        for (b, from) in system.first[..system.bodies.len()].iter().enumerate() {
            let velocity = first.attitudes[b].tr_mul(&vector(velocities, *from));
            put(&mut x_rates, *from, &velocity);
        }
        let passing = Passing { x: &first.x, x_rates: &x_rates, velocities };
        let times = [start.time, start.time + short_time(system, velocities)];
        let mut out = Vec::new();
        find_row_accelerations((system, start), scratch, passing, times, &mut out);
        let sums = |of: fn(f64) -> f64| -> Vec<f64> {
            let of_idle = |idle: &Vec<f64>| idle.iter().zip(&out).map(|(u, a)| of(u * a)).sum();
            judged.rank.idle.iter().map(of_idle).collect()
        };
        let (mut fastest, size) = (0.0_f64, judged.tree.size);
        for from in &system.first[..system.bodies.len()] {
            let [velocity, omega] = [0, 3].map(|part| vector(velocities, from + part).norm());
            fastest = fastest.max(velocity).max(size * omega);
        }
        let most = sums(f64::abs).into_iter().fold(fastest * fastest / size, f64::max);
        Accelerations { idle: sums(|x| x), rounding: ROUNDING * most }
    }

    /// Gives the bodies other velocities.
    fn take_velocities(&mut self, velocities: &[f64]) -> Result<(), Failed> {
        let mut states = Vec::new();
        for (b, first) in self.system.first[..self.system.bodies.len()].iter().enumerate() {
            let mut state = self.state_in_frame(b)?;
            state.velocity_global = self.first.attitudes[b].tr_mul(&vector(velocities, *first));
            state.omega_body = vector(velocities, first + 3);
            let modes = first + 6..self.system.first[b + 1];
            state.modal_velocity.copy_from_slice(&velocities[modes]);
            states.push(state);
        }
        let turns: Vec<_> = self.start.joints.clone();
        self.set_states_in_frame(&states).map_err(|_| Failed::Newton)?;
        self.start.joints = turns;
        self.assemble_here()?;
        Ok(())
    }
}
