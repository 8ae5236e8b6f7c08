//! A start without ringing: each body is deformed as the forces of its motion and of its joints ask.
//!
//! With accelerations and multipliers of the bodies as if they were rigid,
//!
//! ```text
//! G M⁻¹ (f + Gᵀλ) = −Ġ v − ġ_t      over the rows with a rigid meaning
//! q = Λ⁻¹ (forces + G_qᵀ λ),        q̇ = 0
//! ```
//!
//! Eqs. (J9) of `docs/method/systems.md`; with large modes (L7) and (L11).

use crate::body::motion_state::MotionState;
use crate::conservative::{get, part};
use crate::system::elimination::inverse::{Inertia, Inverse};
use crate::system::elimination::joint_matrix::JointMatrix;
use crate::system::geometry::rank::Judgement;
use crate::system::radau::{Failed, SystemMotion};
use crate::system::reactions::{Passing, find_row_accelerations, short_time};
use crate::system::stage::{put, vector};
use crate::vibration::system::Stability;
use crate::vibration::system::error::SteadyError;

/// Passes: the deformation changes the forces a little.
const PASSES: usize = 6;

/// A start without ringing, or at rest, that was not found.
#[derive(Debug, Clone, PartialEq)]
pub enum RelaxError {
    /// The bodies are not assembled, or the inertia of one is singular.
    Failed(Failed),
    /// Bodies with large modes find no shape.
    Rest(SteadyError),
    /// The forces balance nowhere.
    NoEquilibrium(SteadyError),
    /// A joint of the equilibrium is turned by more than half a turn.
    Wound {
        /// Its name.
        joint: Box<str>,
        /// The angle, rad.
        turn: f64,
    },
}

impl From<Failed> for RelaxError {
    fn from(error: Failed) -> Self {
        Self::Failed(error)
    }
}

impl From<SteadyError> for RelaxError {
    fn from(error: SteadyError) -> Self {
        Self::Rest(error)
    }
}

impl SystemMotion {
    /// Deforms the bodies so that an undeformed start does not ring, and assembles them again. Returns the largest residual and
    /// the largest rate that are left.
    ///
    /// # Errors
    /// [`RelaxError`].
    pub fn relax(&mut self) -> Result<[f64; 2], RelaxError> {
        let mut left = self.assemble()?;
        let given = self.states_in_frame()?;
        let is_bent = self.system.bodies.iter().any(|body| body.manifold.is_some());
        for _ in 0..PASSES {
            if is_bent {
                self.bend()?;
            } else {
                let (multipliers, _) = self.rigid_forces()?;
                self.deform(&multipliers);
            }
            self.give_velocities(&given)?;
            left = self.assemble()?;
        }
        Ok(left)
    }

    /// Puts the bodies where the forces on them balance, and assembles them again; they keep their velocities. Returns the largest residual
    /// and the largest rate that are left.
    pub(crate) fn put_at_equilibrium(&mut self) -> Result<([f64; 2], Stability), RelaxError> {
        self.assemble()?;
        let given = self.states_in_frame()?;
        let found = self.equilibrium().map_err(RelaxError::NoEquilibrium)?;
        if let Some((joint, turn)) = found.wound() {
            return Err(RelaxError::Wound { joint: joint.into(), turn });
        }
        self.set_states_in_frame(&found.steady.states_in_frame()).map_err(|_| SteadyError::Numbers)?;
        self.give_velocities(&given)?;
        Ok((self.assemble()?, found.stability))
    }

    /// The states of all bodies, in the frames of the bodies.
    fn states_in_frame(&mut self) -> Result<Vec<MotionState>, Failed> {
        (0..self.bodies.len()).map(|body| self.state_in_frame(body)).collect::<Result<_, _>>().map_err(Failed::Rates)
    }

    /// Gives the origins of the bodies the velocities, and the bodies the angular velocities, of other states: a body that deforms keeps
    /// its momenta, not these.
    fn give_velocities(&mut self, given: &[MotionState]) -> Result<(), Failed> {
        for (b, given) in given.iter().enumerate() {
            let mut state = self.state_in_frame(b)?;
            (state.velocity_global, state.omega_body) = (given.velocity_global, given.omega_body);
            self.bodies[b] = self.system.bodies[b].state_in_frame(&state).map_err(|_| Failed::Newton)?;
        }
        Ok(())
    }

    /// With large modes forces change as the bodies bend, so the shapes come from Newton's method with their tangent: (L7) with the
    /// accelerations of (L11).
    fn bend(&mut self) -> Result<(), SteadyError> {
        let state = self.moving_state()?;
        // They are of the right length; numbers alone can be wrong.
        self.set_states_in_frame(&state.states_in_frame()).map_err(|_| SteadyError::Numbers)
    }

    /// V' and ω' of rigid bodies where the system is, in body axes, over the coordinates of all bodies.
    ///
    /// # Errors
    /// [`Failed`] where the inertia of a body is singular.
    pub(crate) fn rigid_accelerations(&mut self) -> Result<Vec<f64>, Failed> {
        self.begin();
        self.evaluate_first(self.time)?;
        Ok(self.rigid_forces()?.1)
    }

    /// λ of rigid bodies where the first stage is, and their V' and ω'.
    fn rigid_forces(&mut self) -> Result<(Vec<f64>, Vec<f64>), Failed> {
        let mut velocities = self.first.velocities.clone();
        let mut x_rates = self.first.x_rates.clone();
        for (b, first) in self.system.first[..self.system.bodies.len()].iter().enumerate() {
            let modes = first + 6..self.system.first[b + 1];
            velocities[modes.clone()].fill(0.0);
            x_rates[modes].fill(0.0);
        }
        let mut change = Vec::new();
        let Self { first, stages: [scratch, ..], system, start, patterns, .. } = self;
        let passing = Passing { x: &first.x, x_rates: &x_rates, velocities: &velocities };
        let times = [start.time, start.time + short_time(system, &velocities)];
        find_row_accelerations((system, start), scratch, passing, times, &mut change);
        let mut acceleration = vec![0.0; system.coordinates()];
        let inverses = rigid_inverses(&first.inertia).ok_or(Failed::Newton)?;
        for (b, inverse) in inverses.iter().enumerate() {
            let own = system.first[b]..system.first[b + 1];
            let rates = &first.evaluations[b].rates;
            let force = first.attitudes[b] * get(rates.slow(), part::MOMENTUM);
            let [velocity, omega] = [0, 3].map(|at| vector(&first.velocities, own.start + at));
            // With π × ω.
            let moment = get(rates.slow(), part::PI);
            let acceleration = &mut acceleration[own];
            put(acceleration, 0, &force);
            put(acceleration, 3, &moment);
            inverse.apply(acceleration);
            // V has the axes of the body, which turn.
            let turned = vector(acceleration, 0) - omega.cross(&velocity);
            put(acceleration, 0, &turned);
        }
        first.constraints.add_rates(1.0, &acceleration, &mut change);
        change.iter_mut().for_each(|sum| *sum = -*sum);
        let mut of_rigid = JointMatrix::new(&patterns.rows, system.coordinates());
        of_rigid.assemble(&patterns.rows, &first.constraints, &inverses);
        let is_implied = Judgement::first(system, &first.posture(system), false).rank.is_implied;
        of_rigid.factor(&patterns.rows, &is_implied);
        of_rigid.solve(&patterns.rows, &mut change);
        let mut by_joints = vec![0.0; system.coordinates()];
        first.constraints.add_forces(&change, &mut by_joints);
        for (b, inverse) in inverses.iter().enumerate() {
            inverse.apply(&mut by_joints[system.first[b]..system.first[b + 1]]);
        }
        acceleration.iter_mut().zip(&by_joints).for_each(|(sum, part)| *sum += part);
        Ok((change, acceleration))
    }

    /// Sets q by these multipliers, and p so that q̇ is zero.
    fn deform(&mut self, multipliers: &[f64]) {
        let Self { first, system, bodies, .. } = self;
        let mut forces = vec![0.0; system.coordinates()];
        first.constraints.add_forces(multipliers, &mut forces);
        for (b, (body, state)) in system.bodies.iter().zip(bodies).enumerate() {
            let modes = system.first[b] + 6..system.first[b + 1];
            let omega = vector(&first.velocities, system.first[b] + 3);
            let inertia = &first.inertia[b];
            let mut list = body.list_mut(state);
            let [q, p] = list.modes_mut();
            for (k, at) in modes.enumerate() {
                let stiffness = body.circular_frequencies[k] * body.circular_frequencies[k];
                q[k] += (first.y_rates[at] + forces[at]) / stiffness;
                p[k] = inertia.coupling.iter().zip(omega.iter()).map(|(s, w)| s[k] * w).sum();
            }
        }
    }
}

/// Inverses of the inertia of bodies without their modes, where the system is; `None` where one is singular.
pub(crate) fn rigid_inverses(inertias: &[Inertia]) -> Option<Vec<Inverse<f64>>> {
    let of_body = |inertia: &Inertia| {
        let flexible = inertia.coupling[0].len();
        // J of the body as it is deformed, without its modes.
        let mut rigid = Inertia { locked: inertia.whole(), bent: None, ..inertia.clone() };
        rigid.coupling.iter_mut().for_each(|s| s.fill(0.0));
        let mut inverse = Inverse::new(flexible);
        inverse.find(1.0, &rigid, |_| [f64::INFINITY, 0.0]).then_some(inverse)
    };
    inertias.iter().map(of_body).collect()
}
