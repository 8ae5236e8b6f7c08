//! Steps of a system by collocation, with stabilised constraints of index 2 and a structured Newton.
//!
//! Eqs. (J5)–(J8) of `docs/method/systems.md`: increments x and y at the stages, multipliers λ of the rows and μ of their
//! rates, and
//!
//! ```text
//! x' = v + M⁻¹Gᵀμ,     y' = forces + Gᵀλ,     g = 0,     G v = 0        at each stage
//! ```

use nalgebra::{Complex, Vector3};
use serde::{Deserialize, Serialize};

use crate::body::motion_state::MotionState;
use crate::conservative::{get, part};
use crate::equations::Equations;
use crate::error::{RateError, SetupError, StepError};
use crate::state::{State, attitude_at};
use crate::system::collocation::{Collocation, STAGES};
use crate::system::description::System;
use crate::system::elimination::inverse::Inverse;
use crate::system::elimination::joint_matrix::{JointMatrix, Pattern};
use crate::system::elimination::matrices::{Matrices, oscillators};
use crate::system::elimination::newton::{Frozen, Solution, sizes};
use crate::system::joint::coordinate::{Coordinate, JointCoordinates};
use crate::system::joint::coupling::CoupledCoordinate;
use crate::system::stage::{BodyStart, Stage, Start, about_global_origin, put, vector};

/// Error of Newton's method over the tolerance: of positions relative to the bodies, and in the norm of the energy. Ten times as
/// much costs a fifth less work, but the multipliers of stiff bodies, and the work of drives, are then off by per cents.
const EXACTNESS: f64 = 1e-3;
/// A change of positions that is rounding.
const ROUNDING: f64 = 1e-13;
/// Passes of Newton's method before a step is given up.
const MAX_PASSES: usize = 20;
/// The step whose Newton matrix is the metric in which a system is assembled, as a part of the shortest period.
const ASSEMBLY: f64 = 1.0;
/// Passes of the projection of positions.
const MAX_PROJECTIONS: usize = 20;

/// The cost of a step and its estimated error.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Tried {
    /// Estimated error, relative to the size of the bodies.
    pub error: f64,
    /// Passes of Newton's method.
    pub passes: usize,
}

/// A step that was not done.
#[derive(Debug, Clone, PartialEq)]
pub enum Failed {
    /// Newton's method does not converge.
    Newton,
    /// The rates cannot be found.
    Rates(RateError),
}

impl From<RateError> for Failed {
    fn from(error: RateError) -> Self {
        Self::Rates(error)
    }
}

/// Works at a joint since the beginning.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
pub struct JointWork {
    /// What its drive and its motors have put in.
    pub drive: f64,
    /// What its springs, stops and preload have given back; negative for what they hold.
    pub spring: f64,
    /// What friction and dampers have taken out.
    pub loss: f64,
}

/// A system on its way.
#[derive(Debug, Clone)]
pub struct SystemMotion {
    pub(super) system: System,
    scheme: Collocation,
    pub(super) pattern: Pattern,
    pub(super) time: f64,
    /// The list of each body, as in a [`State`] of it.
    pub(super) bodies: Vec<State>,
    pub(super) start: Start,
    pub(super) first: Stage,
    pub(super) stages: [Stage; STAGES],
    /// λ and μ at the stages.
    pub(super) multipliers: [Vec<f64>; STAGES],
    velocity_multipliers: [Vec<f64>; STAGES],
    /// Increments of the stages of the last step, and its length; zero before the first.
    pub(super) last: [[Vec<f64>; 2]; STAGES],
    pub(super) last_length: f64,
    pub(super) matrices: Matrices,
    room: Room,
    /// The largest energy so far.
    pub(super) largest_energy: f64,
    /// Work of the drives of joints where their rates jumped.
    pub(super) jump_work: f64,
    /// Works of the drives and forces of joints since the beginning.
    pub(super) joint_works: Vec<JointWork>,
    /// Work of the force elements since the beginning.
    pub(super) element_work: f64,
    pub(super) evaluations: u64,
    /// λ of index 1, where they were last asked for.
    pub(super) reactions: Vec<f64>,
}

/// Room for one solution of the Newton system.
#[derive(Debug, Clone)]
struct Room {
    real: Solution<f64>,
    complex: Solution<Complex<f64>>,
    y_rates: [Vec<f64>; STAGES],
    /// Residuals or changes of a stage.
    change: [Vec<f64>; 2],
}

impl SystemMotion {
    /// A system with one state for each body, at the time of the first. Positions and velocities are to fit the joints: see
    /// [`Self::assemble`].
    ///
    /// # Errors
    /// [`SetupError`] for another number of states than of bodies, and for states that do not fit their bodies.
    pub fn new(mut system: System, states: &[MotionState]) -> Result<Self, SetupError> {
        let (expected, found) = (system.bodies.len(), states.len());
        if found != expected {
            return Err(SetupError::Length { what: "the list of states", expected, found });
        }
        for (body, state) in system.bodies.iter_mut().zip(states) {
            body.begin_at(state.attitude, state.origin_global);
        }
        let bodies: Vec<State> =
            system.bodies.iter().zip(states).map(|(body, state)| body.state_of(state)).collect::<Result<_, _>>()?;
        let time = states.first().map_or(0.0, |state| state.time);
        let stage = Stage::new(&system);
        let (coordinates, rows) = (system.coordinates(), system.rows());
        let joints = system.connections.joints.len();
        let groups: Vec<usize> = system.connections.groups().collect();
        let pattern = Pattern::new(&groups, &stage.constraints, system.bodies.len());
        let flexible: Vec<usize> = system.bodies.iter().map(Equations::flexible).collect();
        let multipliers = std::array::from_fn(|_| vec![0.0; rows]);
        let zeros = || vec![0.0; coordinates];
        let coordinates_of_joints = vec![JointCoordinates::default(); joints];
        let mut motion = Self {
            scheme: Collocation::radau(),
            time,
            start: Start {
                time,
                bodies: Vec::with_capacity(flexible.len()),
                q: zeros(),
                p: zeros(),
                joints: coordinates_of_joints,
            },
            first: stage.clone(),
            stages: std::array::from_fn(|_| stage.clone()),
            velocity_multipliers: multipliers.clone(),
            multipliers,
            last: std::array::from_fn(|_| [zeros(), zeros()]),
            last_length: 0.0,
            matrices: Matrices {
                is_left_out: vec![false; rows],
                mass: flexible.iter().map(|nf| Inverse::new(*nf)).collect(),
                real: flexible.iter().map(|nf| Inverse::new(*nf)).collect(),
                complex: flexible.iter().map(|nf| Inverse::new(*nf)).collect(),
                of_mass: JointMatrix::new(&pattern, coordinates),
                of_real: JointMatrix::new(&pattern, coordinates),
                of_complex: JointMatrix::new(&pattern, coordinates),
            },
            room: Room {
                real: Solution::new(coordinates, rows),
                complex: Solution::new(coordinates, rows),
                y_rates: std::array::from_fn(|_| zeros()),
                change: [zeros(), zeros()],
            },
            pattern,
            bodies,
            system,
            largest_energy: 0.0,
            jump_work: 0.0,
            joint_works: vec![JointWork::default(); joints],
            element_work: 0.0,
            evaluations: 0,
            reactions: vec![0.0; rows],
        };
        motion.find_joint_coordinates();
        Ok(motion)
    }

    /// Finds the coordinates of the joints, and the sums of the couplings that have none, where the system is at first.
    fn find_joint_coordinates(&mut self) {
        self.begin();
        let Self { first, system, start, .. } = self;
        first.place(system, start);
        for joint in 0..start.joints.len() {
            start.joints[joint] = first.joint_coordinates(system, joint, 0.0);
        }
        for coupling in &mut system.connections.couplings {
            let of_term = |term: &CoupledCoordinate| {
                let JointCoordinates { turn, slide, .. } = start.joints[term.joint];
                term.factor * if term.coordinate == Coordinate::Turn { turn } else { slide }
            };
            let sum = coupling.terms.iter().map(of_term).sum();
            coupling.sum.get_or_insert(sum);
        }
        // With rates, if bodies that are as they should not be have any: steps tell of those that have none.
        if self.evaluate_first(self.time).is_ok() {
            for joint in 0..self.start.joints.len() {
                self.start.joints[joint] = self.first.joint_coordinates(&self.system, joint, 0.0);
            }
        }
        self.evaluations = 0;
    }

    /// The time that has been reached.
    pub fn time(&self) -> f64 {
        self.time
    }

    /// The state of a body.
    ///
    /// # Errors
    /// [`RateError`] where its velocities cannot be found.
    pub fn state(&self, body: usize) -> Result<MotionState, RateError> {
        self.system.bodies[body].motion_state(&self.bodies[body])
    }

    /// Kinetic and strain energy of all bodies.
    ///
    /// # Errors
    /// [`RateError`] where a body's velocities cannot be found.
    pub fn energy(&self) -> Result<f64, RateError> {
        (0..self.bodies.len()).map(|body| self.energy_of(body)).sum()
    }

    fn energy_of(&self, body: usize) -> Result<f64, RateError> {
        let (body, state) = (&self.system.bodies[body], &self.bodies[body]);
        let mut e = body.evaluation();
        body.evaluate_at(state, state.time, &mut e)?;
        Ok(body.energies(state.time, &e).map_or(0.0, |energies| energies.internal + energies.translation))
    }

    /// The turn and the slide of a joint, with their rates. Turns are counted from the beginning on.
    pub fn joint_coordinates(&self, joint: usize) -> JointCoordinates {
        self.start.joints[joint]
    }

    /// Works at a joint since the beginning.
    pub fn joint_work(&self, joint: usize) -> JointWork {
        self.joint_works[joint]
    }

    /// Work of the drives and motors of joints since the beginning.
    pub fn drive_work(&self) -> f64 {
        self.jump_work + self.joint_works.iter().map(|work| work.drive).sum::<f64>()
    }

    /// Work of the force elements, and of springs, dampers, stops and friction of joints, since the beginning.
    pub fn element_work(&self) -> f64 {
        self.element_work + self.joint_works.iter().map(|work| work.spring - work.loss).sum::<f64>()
    }

    /// Linear momentum, and angular momentum about the global origin, of all bodies, global.
    pub fn momenta(&self) -> [Vector3<f64>; 2] {
        let mut sums = [Vector3::zeros(); 2];
        for (body, state) in self.system.bodies.iter().zip(&self.bodies) {
            let list = body.list(state);
            let [position, momentum, pi] =
                [part::POSITION, part::MOMENTUM, part::PI].map(|part| get(list.slow(), part));
            sums[0] += momentum;
            sums[1] += position.cross(&momentum) + list.attitude().to_global(&pi);
        }
        sums
    }

    /// Residuals of the rows, and their rates, where the system is.
    ///
    /// # Errors
    /// [`RateError`] where a body's velocities cannot be found.
    pub fn residuals(&mut self) -> Result<[&[f64]; 2], RateError> {
        self.begin();
        self.evaluate_first(self.time)?;
        Ok([&self.first.constraints.residuals, &self.first.constraint_rates])
    }

    /// The system.
    pub fn system(&self) -> &System {
        &self.system
    }

    /// Evaluations of the rates of all bodies so far.
    pub fn evaluations(&self) -> u64 {
        self.evaluations
    }

    /// Number of rows that others imply, where the system is.
    pub fn dependent_rows(&self) -> usize {
        self.matrices.is_left_out.iter().filter(|is_left_out| **is_left_out).count()
    }

    /// Moves the bodies, and changes their velocities, so that the joints hold. Returns the largest residual and the largest
    /// rate that are left.
    ///
    /// # Errors
    /// [`Failed`] where the inertia of a body is singular.
    pub fn assemble(&mut self) -> Result<[f64; 2], Failed> {
        self.assemble_by(self.time)
    }

    /// The same with the branches of drives that hold at a time.
    fn assemble_by(&mut self, branch_time: f64) -> Result<[f64; 2], Failed> {
        self.begin();
        self.evaluate_first(branch_time)?;
        let [.., last] = &mut self.stages;
        last.x.copy_from_slice(&self.first.x);
        last.y.copy_from_slice(&self.first.y);
        last.inertia.clone_from(&self.first.inertia);
        self.end([self.time, branch_time], ASSEMBLY)
    }

    /// Tries a step of length `h` that ends at `end`, with Newton's method as exact as `exactness`, and goes on where
    /// its error is at most `tolerance`.
    ///
    /// # Errors
    /// [`Failed`]; the state stays.
    pub fn try_step(&mut self, h: f64, end: f64, exactness: f64, tolerance: f64) -> Result<Tried, Failed> {
        self.begin();
        let branch_time = self.time + 0.5 * h;
        self.evaluate_first(branch_time)?;
        self.predict(h);
        let passes = self.newton(h, exactness)?;
        let error = self.error(h);
        if error <= tolerance {
            for (last, stage) in self.last.iter_mut().zip(&self.stages) {
                last[0].copy_from_slice(&stage.x);
                last[1].copy_from_slice(&stage.y);
            }
            self.last_length = h;
            self.add_work(h);
            self.sum_momenta(h);
            self.end([end, branch_time], h)?;
        }
        Ok(Tried { error, passes })
    }

    /// Goes to `end` with steps whose estimated error is at most `tolerance`; `h` is the first try, and the next one after.
    /// Returns the number of steps. Where a load or a drive jumps, end a call there.
    ///
    /// # Errors
    /// [`StepError`] where no step is short enough.
    pub fn advance(&mut self, end: f64, tolerance: f64, h: &mut f64) -> Result<u64, StepError> {
        let mut steps = 0;
        while self.time < end {
            steps += u64::from(self.try_towards(end, tolerance, h)?.is_some());
        }
        Ok(steps)
    }

    /// Tries one step towards `end` with an estimated error of at most `tolerance`, about as long as `h`, which becomes the
    /// length of the next try. Returns the length of the step where it was taken.
    ///
    /// # Errors
    /// [`StepError`] where no step is short enough.
    pub(super) fn try_towards(&mut self, end: f64, tolerance: f64, h: &mut f64) -> Result<Option<f64>, StepError> {
        let left = end - self.time;
        let parts = (left / *h).ceil().max(1.0);
        let length = if *h * 1.01 >= left { left } else { left / parts };
        let to = if length == left { end } else { self.time + length };
        let mut taken = None;
        match self.try_step(length, to, EXACTNESS * tolerance, tolerance) {
            Ok(Tried { error, passes }) => {
                let mut factor = (0.9 * (tolerance / error.max(1e-300)).powf(0.25)).clamp(0.2, 4.0);
                if error <= tolerance {
                    taken = Some(length);
                    if passes > 7 {
                        factor = factor.min(0.7);
                    } else if passes > 5 {
                        factor = factor.min(1.0);
                    }
                    // A last step that was cut short says little of the next.
                    *h = if factor >= 1.0 { h.max(length * factor) } else { length * factor };
                } else {
                    *h = length * factor.min(0.9);
                }
            }
            Err(Failed::Newton) => *h = 0.4 * length,
            Err(Failed::Rates(error)) if length < 1e-12 * end => return Err(error.in_step(self.time, length)),
            Err(Failed::Rates(_)) => *h = 0.25 * length,
        }
        if *h < 1e-13 * end {
            return Err(StepError::Tolerance { time: self.time, step: *h, tolerance });
        }
        Ok(taken)
    }

    /// Takes the motion past a jump of a load or a drive at its time: where the rate of a drive jumps, so do the velocities. The
    /// energy that this takes is work of the drives.
    ///
    /// # Errors
    /// [`RateError`] where the inertia of a body is singular.
    pub(super) fn pass_discontinuity(&mut self) -> Result<(), RateError> {
        self.last_length = 0.0;
        if self.system.connections.joints.iter().all(|joint| joint.drive.is_none()) {
            return Ok(());
        }
        // The discontinuity itself is where it is but for rounding.
        let branch_time = self.time + 1e-12 * self.time.abs();
        let energies = |motion: &Self| {
            (0..motion.bodies.len()).map(|body| motion.energy_of(body)).collect::<Result<Vec<f64>, _>>()
        };
        let before = energies(self)?;
        match self.assemble_by(branch_time) {
            Ok(_) => {}
            Err(Failed::Rates(error)) => return Err(error),
            Err(Failed::Newton) => return Err(RateError::Inertia),
        }
        let after = energies(self)?;
        for (body, (before, after)) in before.into_iter().zip(after).enumerate() {
            let mut list = self.system.bodies[body].list_mut(&mut self.bodies[body]);
            let mut slow = *list.slow();
            slow[part::WORK] += after - before;
            list.set_slow(&slow);
            self.jump_work += after - before;
        }
        Ok(())
    }

    /// Takes the state as the start of a step.
    pub(super) fn begin(&mut self) {
        self.start.time = self.time;
        self.start.bodies.clear();
        for (b, (body, state)) in self.system.bodies.iter().zip(&self.bodies).enumerate() {
            let list = body.list(state);
            let slow = list.slow();
            let body_from_global = list.attitude().global_to_body();
            let [position, momentum, pi] = [part::POSITION, part::MOMENTUM, part::PI].map(|part| get(slow, part));
            let angular_momentum = position.cross(&momentum) + body_from_global.tr_mul(&pi);
            self.start.bodies.push(BodyStart { position, body_from_global, momentum, angular_momentum });
            let modes = self.system.first[b] + 6..self.system.first[b + 1];
            self.start.q[modes.clone()].copy_from_slice(list.q());
            self.start.p[modes].copy_from_slice(list.p());
            for stage in self.stages.iter_mut().chain([&mut self.first]) {
                stage.evaluations[b].at.set_attitude(list.attitude());
            }
        }
    }

    /// Finds the rates where the system is, by the branches of loads and drives that hold at a time.
    pub(super) fn evaluate_first(&mut self, branch_time: f64) -> Result<(), RateError> {
        let Self { first, system, start, .. } = self;
        first.x.fill(0.0);
        first.y.fill(0.0);
        first.evaluate(system, start, [start.time, branch_time])?;
        self.velocity_multipliers[0].fill(0.0);
        first.find_x_rates(system, &self.velocity_multipliers[0])?;
        self.evaluations += 1;
        Ok(())
    }

    /// First values of the stages: the polynomials of the last step, continued.
    fn predict(&mut self, h: f64) {
        for (i, stage) in self.stages.iter_mut().enumerate() {
            let c = self.scheme.times[i];
            if self.last_length > 0.0 {
                let factors = self.scheme.continued(1.0 + c * h / self.last_length);
                for (which, list) in [&mut stage.x, &mut stage.y].into_iter().enumerate() {
                    for (k, value) in list.iter_mut().enumerate() {
                        *value = factors.iter().zip(&self.last).map(|(factor, last)| factor * last[which][k]).sum();
                    }
                }
            } else {
                stage.x.iter_mut().zip(&self.first.x_rates).for_each(|(x, rate)| *x = c * h * rate);
                stage.y.iter_mut().zip(&self.first.y_rates).for_each(|(y, rate)| *y = c * h * rate);
            }
        }
        self.largest_energy = self.largest_energy.max(self.first.energy(&self.system, h));
        let [others @ .., last] = &mut self.multipliers;
        others.iter_mut().for_each(|lambda| lambda.copy_from_slice(last));
        self.velocity_multipliers.iter_mut().for_each(|mu| mu.fill(0.0));
    }

    /// Factors of the Newton matrix with the geometry of a stage.
    fn factor(&mut self, of: usize, h: f64) -> bool {
        let Self { matrices, system, stages, scheme, pattern, .. } = self;
        if !matrices.factor_real(system, pattern, &stages[of], scheme.real / h) {
            return false;
        }
        let Matrices { is_left_out, complex, of_complex, .. } = matrices;
        let stage = &stages[of];
        for ((body, inertia), inverse) in system.bodies.iter().zip(&stage.inertia).zip(&mut *complex) {
            if !inverse.find(scheme.complex / h, inertia, oscillators(body)) {
                return false;
            }
        }
        of_complex.assemble(pattern, &stage.constraints, complex);
        of_complex.factor(pattern, is_left_out, false);
        true
    }

    /// Newton's method for the stages. Returns the number of passes.
    fn newton(&mut self, h: f64, exactness: f64) -> Result<usize, Failed> {
        let mut last = f64::INFINITY;
        for pass in 1..=MAX_PASSES {
            self.evaluate_stages(h)?;
            if pass == 1 && !self.factor(1, h) {
                return Err(Failed::Newton);
            }
            let change = self.improve(h);
            if !change.is_finite() {
                return Err(Failed::Newton);
            }
            let rate = if pass == 1 { 0.5 } else { change / last };
            if rate > 2.0 || (rate > 0.9 && pass > 3 && change > ROUNDING) {
                return Err(Failed::Newton);
            }
            last = change;
            // The error that is left, by the rate of convergence.
            let left = change * rate / (1.0 - rate.min(0.9));
            if left <= exactness || change <= ROUNDING {
                return Ok(pass);
            }
        }
        Err(Failed::Newton)
    }

    fn evaluate_stages(&mut self, h: f64) -> Result<(), RateError> {
        let Self { stages, scheme, system, start, multipliers, velocity_multipliers, room, .. } = self;
        for (i, stage) in stages.iter_mut().enumerate() {
            let time = start.time + scheme.times[i] * h;
            stage.evaluate(system, start, [time, start.time + 0.5 * h])?;
            stage.find_x_rates(system, &velocity_multipliers[i])?;
            stage.find_y_rates(system, &multipliers[i], &mut room.y_rates[i]);
        }
        self.evaluations += STAGES as u64;
        Ok(())
    }

    /// One pass. Returns the size of the change of positions.
    fn improve(&mut self, h: f64) -> f64 {
        let Self {
            stages,
            scheme,
            system,
            room,
            matrices,
            pattern,
            multipliers,
            velocity_multipliers,
            largest_energy,
            ..
        } = self;
        let Room { real, complex, y_rates, change: residuals } = room;
        // Residuals in the axes of the bodies at each stage, transformed.
        real.clear();
        complex.clear();
        for i in 0..STAGES {
            let [x, y] = residuals;
            for k in 0..system.coordinates() {
                let sum = |of: fn(&Stage) -> &Vec<f64>| -> f64 {
                    (0..STAGES).map(|j| scheme.inverse[(i, j)] * of(&stages[j])[k]).sum::<f64>() / h
                };
                x[k] = stages[i].x_rates[k] - sum(|stage| &stage.x);
                y[k] = y_rates[i][k] - sum(|stage| &stage.y);
            }
            stages[i].to_body_axes(system, x, y);
            for k in 0..x.len() {
                for (residual, of_real, of_complex) in
                    [(x[k], &mut real.x[k], &mut complex.x[k]), (y[k], &mut real.y[k], &mut complex.y[k])]
                {
                    *of_real += scheme.to_real[i] * residual;
                    *of_complex += scheme.to_complex[i] * residual;
                }
            }
        }
        for row in 0..pattern.len() {
            let (mut of_real, mut of_complex) = ([0.0; 2], [Complex::new(0.0, 0.0); 2]);
            for (i, stage) in stages.iter().enumerate() {
                let residuals = [-stage.constraints.residuals[row], -stage.constraint_rates[row]];
                for (which, residual) in residuals.into_iter().enumerate() {
                    of_real[which] += scheme.to_real[i] * residual;
                    of_complex[which] += scheme.to_complex[i] * residual;
                }
            }
            [real.lambda[row], real.mu[row]] = of_real;
            [complex.lambda[row], complex.mu[row]] = of_complex;
        }
        let frozen = Frozen { system, stage: &stages[1], pattern, of_mass: &matrices.of_mass };
        frozen.solve(real, scheme.real / h, &matrices.real, &matrices.of_real);
        frozen.solve(complex, scheme.complex / h, &matrices.complex, &matrices.of_complex);
        let mut largest = 0.0_f64;
        for i in 0..STAGES {
            let change = |real: f64, complex: Complex<f64>| {
                scheme.from_real[i] * real + 2.0 * (scheme.from_complex[i] * complex).re
            };
            let [dx, dy] = residuals;
            for k in 0..dx.len() {
                (dx[k], dy[k]) = (change(real.x[k], complex.x[k]), change(real.y[k], complex.y[k]));
            }
            let [position, energy] = sizes(system, dx, h);
            largest = largest.max(position).max((energy / *largest_energy).sqrt());
            stages[i].add_in_body_axes(system, dx, dy);
            for row in 0..multipliers[i].len() {
                multipliers[i][row] += change(real.lambda[row], complex.lambda[row]);
                velocity_multipliers[i][row] += change(real.mu[row], complex.mu[row]);
            }
        }
        largest
    }

    /// The estimated error of a step whose stages are known.
    fn error(&mut self, h: f64) -> f64 {
        let Self { stages, scheme, system, room, matrices, pattern, first, .. } = self;
        let real = &mut room.real;
        for k in 0..system.coordinates() {
            let mut difference = [first.x_rates[k], first.y_rates[k]];
            for i in 0..STAGES {
                let rate = (0..STAGES).map(|j| scheme.inverse[(i, j)] * stages[j].x[k]).sum::<f64>() / h;
                difference[0] -= scheme.at_start[i] * rate;
                difference[1] -= scheme.at_start[i] * stages[i].y_rates[k];
            }
            [real.x[k], real.y[k]] = difference;
        }
        stages[1].to_body_axes(system, &mut real.x, &mut real.y);
        real.lambda.fill(0.0);
        real.mu.fill(0.0);
        let frozen = Frozen { system, stage: &stages[1], pattern, of_mass: &matrices.of_mass };
        frozen.solve(real, scheme.real / h, &matrices.real, &matrices.of_real);
        sizes(system, &real.x, h)[0]
    }

    /// Gives what flies freely the momenta that the loads have given it.
    fn sum_momenta(&mut self, h: f64) {
        let Self { stages, system, multipliers, scheme, room, .. } = self;
        for (i, stage) in stages.iter_mut().enumerate() {
            stage.find_y_rates(system, &multipliers[i], &mut room.y_rates[i]);
        }
        let [.., last] = stages;
        let rates = &room.y_rates;
        last.correct_momenta(system, |k| {
            h * rates.iter().zip(scheme.weights).map(|(rates, weight)| weight * rates[k]).sum::<f64>()
        });
    }

    /// Adds the integrals over a step: works, impulses, dissipation. What joints and elements do to a body counts as its loads do,
    /// so that its balances close.
    fn add_work(&mut self, h: f64) {
        let Self { stages, multipliers, scheme, bodies, system, joint_works, .. } = self;
        for ((stage, lambda), weight) in stages.iter_mut().zip(&*multipliers).zip(scheme.weights) {
            let mut of_rows = lambda.iter().zip(&stage.constraints.own_rates);
            for (joint, work) in system.connections.joints.iter().zip(&mut *joint_works) {
                let power: f64 = of_rows.by_ref().take(joint.rows.len()).map(|(lambda, rate)| -lambda * rate).sum();
                work.drive += h * weight * power;
            }
            for ((joint, ..), power) in system.connections.joint_forces().zip(&stage.joint_powers) {
                let work = &mut joint_works[joint];
                work.drive += h * weight * power.motor;
                work.spring += h * weight * power.spring;
                work.loss -= h * weight * power.friction;
            }
            self.element_work += h * weight * stage.element_power;
            stage.find_joint_forces(lambda);
            for (b, state) in bodies.iter_mut().enumerate() {
                let mut list = system.bodies[b].list_mut(state);
                let mut slow = *list.slow();
                let mut rates = *stage.evaluations[b].rates.slow();
                stage.add_joint_exchange(system, b, &mut rates);
                for k in part::WORK..slow.len() {
                    slow[k] += h * weight * rates[k];
                }
                list.set_slow(&slow);
            }
        }
    }

    /// Projects the end of a step, and takes it for the state. Returns the largest residual and rate that are left.
    /// The second time says which branches of the drives hold.
    fn end(&mut self, times: [f64; 2], h: f64) -> Result<[f64; 2], Failed> {
        let Self { stages: [.., last], system, start, matrices, pattern, room, scheme, .. } = self;
        last.place(system, start);
        last.find_constraints(system, start, times);
        if !matrices.factor_real(system, pattern, last, scheme.real / h) {
            return Err(Failed::Rates(RateError::Inertia));
        }
        // Positions.
        let (mut left, real) = (f64::INFINITY, &mut room.real);
        for _ in 0..MAX_PROJECTIONS {
            last.place(system, start);
            last.find_constraints(system, start, times);
            let largest = last.constraints.residuals.iter().fold(0.0_f64, |most, g| most.max(g.abs()));
            if largest >= 0.5 * left || largest == 0.0 {
                left = largest.min(left);
                break;
            }
            left = largest;
            real.lambda.iter_mut().zip(&last.constraints.residuals).for_each(|(lambda, g)| *lambda = -g);
            matrices.of_real.solve(pattern, &mut real.lambda);
            real.x.fill(0.0);
            last.constraints.add_forces(&real.lambda, &mut real.x);
            for (b, inverse) in matrices.real.iter().enumerate() {
                let (first, end) = (system.first[b], system.first[b + 1]);
                inverse.apply(&mut real.x[first..end]);
            }
            real.y.fill(0.0);
            last.add_in_body_axes(system, &mut real.x, &mut real.y);
        }
        // Velocities.
        last.evaluate(system, start, times)?;
        self.evaluations += 1;
        real.y.fill(0.0);
        let rates = last.project_velocities(system, &mut real.y, |rates| matrices.of_mass.solve(pattern, rates));
        for (b, state) in self.bodies.iter_mut().enumerate() {
            let body = &system.bodies[b];
            let (first, end_of_body) = (system.first[b], system.first[b + 1]);
            let [impulse, angular_impulse] =
                [0, 3].map(|part| last.attitudes[b].tr_mul(&vector(&real.y, first + part)));
            about_global_origin(&mut real.y[first..end_of_body], &last.positions[b], &last.attitudes[b]);
            let turned = attitude_at(&state.values, 0).advanced_by(&vector(&last.x, first + 3));
            let momentum = start.bodies[b].momentum + vector(&last.y, first) + vector(&real.y, first);
            let angular_momentum =
                start.bodies[b].angular_momentum + vector(&last.y, first + 3) + vector(&real.y, first + 3);
            let position = last.positions[b];
            let pi = turned.to_body(&(angular_momentum - position.cross(&momentum)));
            let mut list = body.list_mut(state);
            list.set_attitude(turned);
            let mut slow = *list.slow();
            put(&mut slow, part::THETA, &Vector3::zeros());
            put(&mut slow, part::POSITION, &position);
            put(&mut slow, part::MOMENTUM, &momentum);
            put(&mut slow, part::PI, &pi);
            let impulse = impulse + get(&slow, part::IMPULSE);
            put(&mut slow, part::IMPULSE, &impulse);
            let angular_impulse = angular_impulse + get(&slow, part::ANGULAR_IMPULSE);
            put(&mut slow, part::ANGULAR_IMPULSE, &angular_impulse);
            list.set_slow(&slow);
            let [q, p] = list.modes_mut();
            for k in 0..q.len() {
                let at = first + 6 + k;
                q[k] = start.q[at] + last.x[at];
                p[k] = start.p[at] + last.y[at] + real.y[at];
            }
            state.time = times[0];
        }
        for joint in 0..start.joints.len() {
            start.joints[joint] = last.joint_coordinates(system, joint, start.turn(joint, times[0]));
        }
        self.time = times[0];
        Ok([left, rates])
    }
}
