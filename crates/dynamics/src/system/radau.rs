//! Steps of a system by collocation, with stabilised constraints of index 2 and a structured Newton.
//!
//! Eqs. (J5)–(J8) of `docs/method/systems.md`: increments x and y at the stages, multipliers λ of the rows and μ of their
//! rates, and
//!
//! ```text
//! x' = v + M⁻¹Gᵀμ,     y' = forces + Gᵀλ,     g = 0,     G v = 0        at each stage
//! ```

use nalgebra::{Complex, Vector3};

use crate::body::motion_state::MotionState;
use crate::conservative::{ConservativeBody, get, part};
use crate::equations::Equations;
use crate::error::{RateError, SetupError, StepError};
use crate::state::{State, attitude_at};
use crate::system::System;
use crate::system::collocation::{Collocation, STAGES};
use crate::system::inverse::{Inverse, Number};
use crate::system::joint_matrix::{JointMatrix, Pattern, Times};
use crate::system::stage::{BodyStart, Stage, Start, about_body_origin, about_global_origin, put, vector};

/// Error of Newton's method over the tolerance. The velocities that it leaves add up over the steps: ten times as much costs
/// a sixth less work, and up to a hundred times the error (Andrews' squeezer).
const EXACTNESS: f64 = 5e-3;
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
#[derive(Debug, Clone, Copy, PartialEq)]
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

/// A system on its way.
#[derive(Debug, Clone)]
pub struct SystemMotion {
    system: System,
    scheme: Collocation,
    pattern: Pattern,
    time: f64,
    /// The list of each body, as in a [`State`] of it.
    bodies: Vec<State>,
    start: Start,
    first: Stage,
    stages: [Stage; STAGES],
    /// λ and μ at the stages.
    multipliers: [Vec<f64>; STAGES],
    velocity_multipliers: [Vec<f64>; STAGES],
    /// Increments of the stages of the last step, and its length; zero before the first.
    last: [[Vec<f64>; 2]; STAGES],
    last_length: f64,
    matrices: Matrices,
    room: Room,
    evaluations: u64,
}

/// Factors of a step.
#[derive(Debug, Clone)]
struct Matrices {
    is_left_out: Vec<bool>,
    mass: Vec<Inverse<f64>>,
    real: Vec<Inverse<f64>>,
    complex: Vec<Inverse<Complex<f64>>>,
    of_mass: JointMatrix<f64>,
    of_real: JointMatrix<f64>,
    of_complex: JointMatrix<Complex<f64>>,
}

/// Room for one solution of the Newton system.
#[derive(Debug, Clone)]
struct Room {
    real: Solution<f64>,
    complex: Solution<Complex<f64>>,
    y_rates: [Vec<f64>; STAGES],
}

/// Right-hand sides, which become changes.
#[derive(Debug, Clone)]
struct Solution<T> {
    x: Vec<T>,
    y: Vec<T>,
    lambda: Vec<T>,
    mu: Vec<T>,
    /// dV, and a list of the same length.
    velocity: Vec<T>,
    of_mu: Vec<T>,
}

impl<T: Number> Solution<T> {
    fn new(coordinates: usize, rows: usize) -> Self {
        let zeros = |n| vec![T::from_real(0.0); n];
        Self {
            x: zeros(coordinates),
            y: zeros(coordinates),
            lambda: zeros(rows),
            mu: zeros(rows),
            velocity: zeros(coordinates),
            of_mu: zeros(coordinates),
        }
    }
}

impl SystemMotion {
    /// A system with one state for each body, at the time of the first. Positions and velocities are to fit the joints: see
    /// [`Self::assemble`].
    ///
    /// # Errors
    /// [`SetupError`] for another number of states than of bodies, and for states that do not fit their bodies.
    pub fn new(system: System, states: &[MotionState]) -> Result<Self, SetupError> {
        let (expected, found) = (system.bodies.len(), states.len());
        if found != expected {
            return Err(SetupError::Length { what: "the list of states", expected, found });
        }
        let bodies: Vec<State> =
            system.bodies.iter().zip(states).map(|(body, state)| body.state_of(state)).collect::<Result<_, _>>()?;
        let time = states.first().map_or(0.0, |state| state.time);
        let stage = Stage::new(&system);
        let (coordinates, rows) = (system.coordinates(), system.rows());
        let of_joints: Vec<usize> = system.joints.iter().map(|joint| joint.rows.len()).collect();
        let pattern = Pattern::new(&of_joints, &stage.constraints, system.bodies.len());
        let flexible: Vec<usize> = system.bodies.iter().map(Equations::flexible).collect();
        let multipliers = std::array::from_fn(|_| vec![0.0; rows]);
        let zeros = || vec![0.0; coordinates];
        Ok(Self {
            scheme: Collocation::radau(),
            time,
            start: Start { time, bodies: Vec::with_capacity(flexible.len()), q: zeros(), p: zeros() },
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
            },
            pattern,
            bodies,
            system,
            evaluations: 0,
        })
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
        let mut sum = 0.0;
        for (body, state) in self.system.bodies.iter().zip(&self.bodies) {
            let mut e = body.evaluation();
            body.evaluate_at(state, state.time, &mut e)?;
            let energies = body.energies(state.time, &e);
            sum += energies.map_or(0.0, |energies| energies.internal + energies.translation);
        }
        Ok(sum)
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
        self.evaluate_first()?;
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

    /// Multipliers of the rows at the end of the last step: the reactions.
    pub fn multipliers(&self) -> &[f64] {
        &self.multipliers[STAGES - 1]
    }

    /// Moves the bodies, and changes their velocities, so that the joints hold. Returns the largest residual and the largest
    /// rate that are left.
    ///
    /// # Errors
    /// [`Failed`] where the inertia of a body is singular.
    pub fn assemble(&mut self) -> Result<[f64; 2], Failed> {
        self.begin();
        self.evaluate_first()?;
        if !self.factor(None, ASSEMBLY) {
            return Err(Failed::Newton);
        }
        let [x, y] = [self.first.x.clone(), self.first.y.clone()];
        self.stages[STAGES - 1].x.copy_from_slice(&x);
        self.stages[STAGES - 1].y.copy_from_slice(&y);
        let left = self.end(self.time)?;
        Ok(left)
    }

    /// Tries a step of length `h` that ends at `end`, with Newton's method as exact as `exactness`, and goes on where
    /// its error is at most `tolerance`.
    ///
    /// # Errors
    /// [`Failed`]; the state stays.
    pub fn try_step(&mut self, h: f64, end: f64, exactness: f64, tolerance: f64) -> Result<Tried, Failed> {
        self.begin();
        self.evaluate_first()?;
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
            self.end(end)?;
        }
        Ok(Tried { error, passes })
    }

    /// Goes to `end` with steps whose estimated error is at most `tolerance`; `h` is the first try, and the next one after.
    /// Returns the number of steps.
    ///
    /// # Errors
    /// [`StepError`] where no step is short enough.
    pub fn advance(&mut self, end: f64, tolerance: f64, h: &mut f64) -> Result<u64, StepError> {
        let mut steps = 0;
        while self.time < end {
            let left = end - self.time;
            let parts = (left / *h).ceil().max(1.0);
            let length = if *h * 1.01 >= left { left } else { left / parts };
            let to = if length == left { end } else { self.time + length };
            match self.try_step(length, to, EXACTNESS * tolerance, tolerance) {
                Ok(Tried { error, passes }) => {
                    let mut factor = (0.9 * (tolerance / error.max(1e-300)).powf(0.25)).clamp(0.2, 4.0);
                    if error <= tolerance {
                        steps += 1;
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
        }
        Ok(steps)
    }

    /// Takes the state as the start of a step.
    fn begin(&mut self) {
        self.start.time = self.time;
        self.start.bodies.clear();
        for (b, (body, state)) in self.system.bodies.iter().zip(&self.bodies).enumerate() {
            let list = body.list(state);
            let slow = list.slow();
            let body_from_global = list.attitude().global_to_body();
            let [position, momentum, pi] =
                [part::POSITION, part::MOMENTUM, part::PI].map(|part| get(slow, part));
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

    fn evaluate_first(&mut self) -> Result<(), RateError> {
        let Self { first, system, start, .. } = self;
        first.x.fill(0.0);
        first.y.fill(0.0);
        first.evaluate(system, start, [start.time, start.time])?;
        first.x_rates.copy_from_slice(&first.velocities);
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
        let last = self.multipliers[STAGES - 1].clone();
        self.multipliers.iter_mut().for_each(|lambda| lambda.copy_from_slice(&last));
        self.velocity_multipliers.iter_mut().for_each(|mu| mu.fill(0.0));
    }

    /// Factors of the Newton matrix with the geometry of stage `of`, or of the start.
    fn factor(&mut self, of: Option<usize>, h: f64) -> bool {
        let Self { matrices, system, stages, first, scheme, pattern, .. } = self;
        let stage = of.map_or(&*first, |of| &stages[of]);
        let Matrices { is_left_out, mass, real, complex, of_mass, of_real, of_complex } = matrices;
        let mut is_regular = true;
        for (b, body) in system.bodies.iter().enumerate() {
            let inertia = &stage.inertia[b];
            let oscillators = || {
                body.circular_frequencies
                    .iter()
                    .zip(&body.damping_ratios)
                    .map(|(omega, zeta)| [omega * omega, 2.0 * zeta * omega])
            };
            is_regular &= mass[b].find(1.0, inertia, oscillators().map(|_| [0.0; 2]));
            is_regular &= real[b].find(scheme.real / h, inertia, oscillators());
            is_regular &= complex[b].find(scheme.complex / h, inertia, oscillators());
        }
        if !is_regular {
            return false;
        }
        of_mass.assemble(pattern, &stage.constraints, mass);
        of_mass.factor(pattern, is_left_out, true);
        of_real.assemble(pattern, &stage.constraints, real);
        of_real.factor(pattern, is_left_out, false);
        of_complex.assemble(pattern, &stage.constraints, complex);
        of_complex.factor(pattern, is_left_out, false);
        true
    }

    /// Newton's method for the stages. Returns the number of passes.
    fn newton(&mut self, h: f64, exactness: f64) -> Result<usize, Failed> {
        let mut last = f64::INFINITY;
        for pass in 1..=MAX_PASSES {
            self.evaluate_stages(h)?;
            if pass == 1 && !self.factor(Some(1), h) {
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
        let Self { stages, scheme, system, room, matrices, pattern, multipliers, velocity_multipliers, .. } = self;
        let Room { real, complex, y_rates } = room;
        // Residuals, transformed.
        for k in 0..system.coordinates() {
            let (mut of_real, mut of_complex) = ([0.0; 2], [Complex::new(0.0, 0.0); 2]);
            for i in 0..STAGES {
                let sum = |of: fn(&Stage) -> &Vec<f64>| -> f64 {
                    (0..STAGES).map(|j| scheme.inverse[(i, j)] * of(&stages[j])[k]).sum::<f64>() / h
                };
                let residuals = [stages[i].x_rates[k] - sum(|stage| &stage.x), y_rates[i][k] - sum(|stage| &stage.y)];
                for (which, residual) in residuals.into_iter().enumerate() {
                    of_real[which] += scheme.to_real[i] * residual;
                    of_complex[which] += scheme.to_complex[i] * residual;
                }
            }
            [real.x[k], real.y[k]] = of_real;
            [complex.x[k], complex.y[k]] = of_complex;
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
            let Stage { x, y, .. } = &mut stages[i];
            for k in 0..x.len() {
                real.velocity[k] = change(real.x[k], complex.x[k]);
                x[k] += real.velocity[k];
                y[k] += change(real.y[k], complex.y[k]);
            }
            largest = largest.max(size(system, &real.velocity));
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
                let rate =
                    (0..STAGES).map(|j| scheme.inverse[(i, j)] * stages[j].x[k]).sum::<f64>() / h;
                difference[0] -= scheme.at_start[i] * rate;
                difference[1] -= scheme.at_start[i] * stages[i].y_rates[k];
            }
            [real.x[k], real.y[k]] = difference;
        }
        real.lambda.fill(0.0);
        real.mu.fill(0.0);
        let frozen = Frozen { system, stage: &stages[1], pattern, of_mass: &matrices.of_mass };
        frozen.solve(real, scheme.real / h, &matrices.real, &matrices.of_real);
        size(system, &real.x)
    }

    /// Adds the integrals over a step: works, impulses, dissipation.
    fn add_work(&mut self, h: f64) {
        for (b, state) in self.bodies.iter_mut().enumerate() {
            let body = &self.system.bodies[b];
            let mut slow = *body.list(state).slow();
            for (stage, weight) in self.stages.iter().zip(self.scheme.weights) {
                let rates = stage.evaluations[b].rates.slow();
                for k in part::WORK..slow.len() {
                    slow[k] += h * weight * rates[k];
                }
            }
            body.list_mut(state).set_slow(&slow);
        }
    }

    /// Projects the end of a step, and takes it for the state. Returns the largest residual and rate that are left.
    fn end(&mut self, end: f64) -> Result<[f64; 2], Failed> {
        let Self { stages: [.., last], system, start, matrices, pattern, room, .. } = self;
        // Positions.
        let (mut left, real) = (f64::INFINITY, &mut room.real);
        for _ in 0..MAX_PROJECTIONS {
            last.place(system, start);
            last.find_constraints(system, true);
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
            last.x.iter_mut().zip(&real.x).for_each(|(x, change)| *x += change);
        }
        // Velocities.
        last.evaluate(system, start, [end, end])?;
        self.evaluations += 1;
        real.y.fill(0.0);
        let rates = last.project_velocities(system, &mut real.y, |rates| matrices.of_mass.solve(pattern, rates));
        for (b, state) in self.bodies.iter_mut().enumerate() {
            let body = &system.bodies[b];
            let (first, end_of_body) = (system.first[b], system.first[b + 1]);
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
            list.set_slow(&slow);
            let [q, p] = list.modes_mut();
            for k in 0..q.len() {
                let at = first + 6 + k;
                q[k] = start.q[at] + last.x[at];
                p[k] = start.p[at] + last.y[at] + real.y[at];
            }
            state.time = end;
        }
        self.time = end;
        Ok([left, rates])
    }
}

/// What both solutions of a Newton pass share.
#[derive(Clone, Copy)]
struct Frozen<'a> {
    system: &'a System,
    stage: &'a Stage,
    pattern: &'a Pattern,
    of_mass: &'a JointMatrix<f64>,
}

impl Frozen<'_> {
    /// The Newton system of one κ, Eqs. (J8): right-hand sides become changes.
    fn solve<T: Number>(self, solution: &mut Solution<T>, kappa: T, inverses: &[Inverse<T>], of_z: &JointMatrix<T>)
    where
        T: Times<T>,
    {
        let Self { system, stage: Stage { constraints, inertia, positions, attitudes, .. }, pattern, of_mass } = self;
        let Solution { x, y, lambda, mu, velocity, of_mu } = solution;
        let bodies = || (0..system.bodies.len()).map(|b| (b, system.first[b]..system.first[b + 1]));
        // t = κ Rg − G RX, and A μ = t − Rv
        lambda.iter_mut().for_each(|lambda| *lambda *= kappa);
        constraints.add_rates(-1.0, x, lambda);
        mu.iter_mut().zip(&*lambda).for_each(|(mu, t)| *mu = *t - *mu);
        of_mass.solve(pattern, mu);
        // b = RY − Λ RX/κ + D (M⁻¹Gᵀμ)
        of_mu.fill(T::from_real(0.0));
        constraints.add_forces(mu, of_mu);
        velocity.copy_from_slice(of_mu);
        for (b, own) in bodies() {
            let body = &system.bodies[b];
            about_body_origin(&mut y[own.clone()], &positions[b], &attitudes[b]);
            inertia[b].solve(&mut velocity[own.clone()]);
            for (k, at) in own.skip(6).enumerate() {
                let (omega, zeta) = (body.circular_frequencies[k], body.damping_ratios[k]);
                let forces = velocity[at].scale(2.0 * zeta * omega) - x[at].scale(omega * omega) / kappa;
                y[at] += forces;
            }
        }
        // (G Z⁻¹ Gᵀ) λ' = t − G Z⁻¹ b
        velocity.copy_from_slice(y);
        bodies().for_each(|(b, own)| inverses[b].apply(&mut velocity[own]));
        constraints.add_rates(-1.0, velocity, lambda);
        of_z.solve(pattern, lambda);
        // dV = Z⁻¹ (b + Gᵀλ'), dX = (RX + dV)/κ, dY = M dV − Gᵀμ
        constraints.add_forces(lambda, y);
        for (b, own) in bodies() {
            inverses[b].apply(&mut y[own.clone()]);
            own.clone().for_each(|k| x[k] = (x[k] + y[k]) / kappa);
            inertia[b].multiply(&mut y[own.clone()]);
            own.clone().for_each(|k| y[k] -= of_mu[k]);
            about_global_origin(&mut y[own], &positions[b], &attitudes[b]);
        }
        lambda.iter_mut().zip(&*mu).for_each(|(lambda, mu)| *lambda -= kappa * *mu);
    }
}

/// Size of a change of positions: the largest root mean square of a body, with its mass, relative to its radius of gyration.
fn size(system: &System, x: &[f64]) -> f64 {
    let of_body = |(b, body): (usize, &ConservativeBody)| {
        let own = &x[system.first[b]..system.first[b + 1]];
        let [moved, turned] = [0, 3].map(|first| vector(own, first));
        let inertia = body.undeformed_inertia();
        let square = body.mass() * moved.norm_squared()
            + turned.dot(&(inertia * turned))
            + own[6..].iter().map(|q| q * q).sum::<f64>();
        (square / (0.5 * inertia.trace())).sqrt()
    };
    // A NaN stays one.
    system.bodies.iter().enumerate().map(of_body).fold(0.0, |most, size| if size <= most { most } else { size })
}
