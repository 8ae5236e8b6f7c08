//! Steps of a system by collocation, with stabilised constraints of index 2 and a structured Newton.
//!
//! Eqs. (J5)–(J8) of `docs/method/systems.md`: increments x and y at the stages, multipliers λ of the rows and μ of their
//! rates, and
//!
//! ```text
//! x' = v + M⁻¹Gᵀμ,     y' = forces + Gᵀλ,     g = 0,     G v = 0        at each stage
//! ```

pub(in crate::system) mod bound;
mod end;
pub(in crate::system) mod estimate;
mod exchange;
mod explicit;
mod law_work;
mod laws;
mod newton;
pub(in crate::system) mod past;
pub(in crate::system) mod rows;
mod springs;
pub(in crate::system) mod stage_rates;
pub(in crate::system) mod stepping;
mod within;

use nalgebra::{Complex, Vector3};

use crate::body::motion_state::MotionState;
use crate::conservative::{ConservativeBody, get, part};
use crate::equations::Equations;
use crate::error::{RateError, SetupError};
use crate::state::State;
use crate::system::collocation::{Collocation, STAGES, SystemScheme};
use crate::system::description::System;
use crate::system::elimination::matrices::Matrices;
use crate::system::elimination::newton::Solution;
use crate::system::elimination::patterns::Patterns;
use crate::system::geometry::rank::Judgement;
use crate::system::joint::coordinate::{Coordinate, JointCoordinates};
use crate::system::joint::coupling::CoupledCoordinate;
use crate::system::joint::force::FrictionSlope;
use crate::system::joint::work::JointWork;
use crate::system::radau::bound::{Bound, Estimate};
use crate::system::radau::law_work::LawWork;
use crate::system::radau::past::Past;
use crate::system::radau::stage_rates::StageRates;
use crate::system::stage::{BodyStart, Stage, Start};
use crate::tolerance::ErrorKinds;

/// The step whose Newton matrix is the metric in which a system is assembled, as a part of the shortest period.
const ASSEMBLY: f64 = 1.0;
/// Assemblies from where the last one has left the bodies, and the part of the size and the speed of bodies below which what is left
/// open is rounding.
const MAX_ASSEMBLIES: usize = 30;
const CLOSED: f64 = 1e-10;

/// The cost of a step and its estimated error.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Tried {
    /// Estimated errors: see [`ErrorKinds`].
    pub errors: ErrorKinds,
    /// Vibration that the step has forgotten beside them, over the largest deformation.
    pub forgotten: f64,
    /// True if the largest of them falls with the order of the scheme, and not with that of its embedded formula.
    pub(super) has_order_of_scheme: bool,
    /// Passes of Newton's method.
    pub passes: usize,
    /// Length of the step to the first kink of a law within it, which such a step ends before. Looked for under a tolerance.
    pub kink: Option<f64>,
}

/// A step that was not done.
#[derive(Debug, Clone, PartialEq)]
pub enum Failed {
    /// Newton's method does not converge.
    Newton,
    /// The rates cannot be found.
    Rates(RateError),
    /// Rows of joints and couplings contradict each other, and stay open by a length.
    Open {
        /// Their names.
        joints: Box<str>,
        /// The largest residual, as a length.
        gap: f64,
    },
}

impl From<RateError> for Failed {
    fn from(error: RateError) -> Self {
        Self::Rates(error)
    }
}

/// A system on its way.
#[derive(Debug, Clone)]
pub struct SystemMotion {
    pub(super) system: System,
    pub(super) scheme: Collocation,
    pub(super) patterns: Patterns,
    pub(super) time: f64,
    /// The list of each body, as in a [`State`] of it.
    pub(crate) bodies: Vec<State>,
    pub(super) start: Start,
    pub(crate) first: Stage,
    pub(super) stages: [Stage; STAGES],
    /// λ and μ at the stages.
    pub(super) multipliers: [Vec<f64>; STAGES],
    velocity_multipliers: [Vec<f64>; STAGES],
    /// Increments of the stages of the last step, and its length; zero before the first.
    pub(super) last: [[Vec<f64>; 2]; STAGES],
    pub(super) last_length: f64,
    /// Factors of the bend of the last step, by which its polynomials begin with the rates at the start.
    pub(super) bend: [Vec<f64>; 2],
    /// Rates at the stages of the last step of what steps sum up.
    pub(super) stage_rates: [StageRates; STAGES],
    pub(super) matrices: Matrices,
    /// Which rows others imply, and the time at which that was last judged.
    pub(super) judgement: Option<Judgement>,
    judged_at: Option<f64>,
    /// True if steps that fail can be shorter.
    is_controlled: bool,
    room: Room,
    law_work: LawWork,
    pub(super) past: Past,
    /// Size of the largest body: what places are measured by.
    size: f64,
    /// The largest energy so far, for Newton's method: also that which forces give within a step.
    pub(super) largest_energy: f64,
    /// The same of the motion alone: kinetic and strain energy where steps began.
    pub(super) largest_moving: f64,
    /// Work of the drives of joints where their rates jumped.
    pub(super) jump_work: f64,
    /// Works of the drives and forces of joints since the beginning.
    pub(super) joint_works: Vec<JointWork>,
    /// Works of the force elements since the beginning.
    pub(super) element_works: Vec<JointWork>,
    /// Time and path for which the friction of each force of a joint has held.
    pub(super) held: Vec<[f64; 2]>,
    pub(super) evaluations: u64,
    /// λ of index 1, where they were last asked for.
    pub(super) reactions: Vec<f64>,
}

/// Room for one solution of the Newton system.
#[derive(Debug, Clone)]
struct Room {
    real: Solution<f64>,
    /// For what drifts.
    held: Solution<f64>,
    complex: Solution<Complex<f64>>,
    y_rates: [Vec<f64>; STAGES],
    /// Rates of an explicit stage.
    stage_rates: StageRates,
    /// Residuals or changes of a stage.
    change: [Vec<f64>; 2],
    /// Impulses of the rows by which velocities were last projected.
    impulses: Vec<f64>,
    /// Coordinates of the forces of joints, with their rates, at the start of a step.
    coordinates: Vec<[f64; 2]>,
    /// Energy of the springs of each joint, then of each element, at the start of a step.
    spring_energies: Vec<f64>,
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
        system.begin_at(states);
        let bodies: Vec<State> =
            system.bodies.iter().zip(states).map(|(body, state)| body.state_of(state)).collect::<Result<_, _>>()?;
        let time = states.first().map_or(0.0, |state| state.time);
        let stage = Stage::new(&system);
        let (coordinates, rows) = (system.coordinates(), system.rows());
        let [joints, elements] = [system.connections.joints.len(), system.connections.elements.len()];
        let patterns = Patterns::new(&system, &stage.constraints);
        let flexible: Vec<usize> = system.bodies.iter().map(Equations::flexible).collect();
        let multipliers = std::array::from_fn(|_| vec![0.0; rows]);
        let zeros = || vec![0.0; coordinates];
        let law_work = LawWork::new(&system, &stage);
        let held = vec![[0.0; 2]; stage.joint_powers.len()];
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
            bend: [zeros(), zeros()],
            stage_rates: std::array::from_fn(|_| StageRates::new(&flexible, [joints, elements])),
            matrices: Matrices::new(&system, &patterns),
            judgement: None,
            judged_at: None,
            is_controlled: false,
            room: Room {
                real: Solution::new(coordinates, &patterns),
                held: Solution::new(coordinates, &patterns),
                complex: Solution::new(coordinates, &patterns),
                y_rates: std::array::from_fn(|_| zeros()),
                stage_rates: StageRates::new(&flexible, [joints, elements]),
                change: [zeros(), zeros()],
                impulses: vec![0.0; rows],
                coordinates: held.clone(),
                spring_energies: vec![0.0; joints + elements],
            },
            law_work,
            past: Past::new(coordinates, flexible.len()),
            size: size_of_bodies(&system, states),
            patterns,
            bodies,
            system,
            largest_energy: 0.0,
            largest_moving: 0.0,
            jump_work: 0.0,
            joint_works: vec![JointWork::default(); joints],
            element_works: vec![JointWork::default(); elements],
            held,
            evaluations: 0,
            reactions: vec![0.0; rows],
        };
        motion.find_joint_coordinates();
        Ok(motion)
    }

    /// The same motion by another scheme.
    #[must_use]
    pub fn with_scheme(self, scheme: SystemScheme) -> Self {
        let scheme = match scheme {
            SystemScheme::Radau => Collocation::radau(),
            SystemScheme::Gauss => Collocation::gauss(),
            SystemScheme::Rkmk4 => Collocation::rkmk4(),
        };
        let mut motion = Self { scheme, ..self };
        motion.forget_last_step();
        motion
    }

    /// Finds the coordinates of the joints, and the sums of the couplings that have none, where the system is at first.
    fn find_joint_coordinates(&mut self) {
        self.begin();
        let Self { first, system, start, .. } = self;
        first.place(system, start);
        for joint in 0..start.joints.len() {
            start.joints[joint] = first.joint_coordinates(system, start, joint);
        }
        for coupling in &mut system.connections.couplings {
            let of_term = |term: &CoupledCoordinate| {
                let JointCoordinates { turn, slide, .. } = start.joints[term.joint];
                term.factor * if term.coordinate == Coordinate::Turn { turn } else { slide }
            };
            let sum = coupling.terms.iter().map(of_term).sum();
            coupling.sum.get_or_insert(sum);
        }
        self.law_work.find_first(&self.system, &self.start);
        // With rates, if bodies that are as they should not be have any: steps tell of those that have none.
        if self.evaluate_first(self.time).is_ok() {
            for joint in 0..self.start.joints.len() {
                self.start.joints[joint] = self.first.joint_coordinates(&self.system, &self.start, joint);
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

    /// The same with the position and the velocity of its origin in its frame.
    pub(in crate::system) fn state_in_frame(&self, body: usize) -> Result<MotionState, RateError> {
        self.system.bodies[body].motion_in_frame(&self.bodies[body])
    }

    /// Kinetic and strain energy of all bodies.
    ///
    /// # Errors
    /// [`RateError`] where a body's velocities cannot be found.
    pub fn energy(&self) -> Result<f64, RateError> {
        let of_frame = |b: usize| {
            let body = &self.system.bodies[b];
            body.energy_of_frame(&get(body.list(&self.bodies[b]).slow(), part::MOMENTUM))
        };
        (0..self.bodies.len()).map(|body| Ok(self.energy_of(body)? + of_frame(body))).sum()
    }

    /// The same of one body in its frame.
    fn energy_of(&self, body: usize) -> Result<f64, RateError> {
        let (body, state) = (&self.system.bodies[body], &self.bodies[body]);
        let mut e = body.evaluation();
        body.evaluate_at(state, state.time, &mut e)?;
        Ok(body.energies(state.time, &e).map_or(0.0, |energies| energies.internal + energies.translation))
    }

    /// Size of the largest body: errors of places are counted over it.
    pub(crate) fn size(&self) -> f64 {
        self.size
    }

    /// The largest rounding of the place of a body over its radius of gyration, by which changes of places are measured.
    pub(super) fn rounding_over_gyration(&self) -> f64 {
        let bodies = self.distances().zip(&self.system.radii).filter(|(_, radius)| **radius > 0.0);
        bodies.map(|(distance, radius)| f64::EPSILON * distance / radius).fold(0.0, f64::max)
    }

    /// Rounding of the places of bodies in their frames, over the size of the largest.
    pub(super) fn rounding_of_places(&self) -> f64 {
        f64::EPSILON * self.distances().fold(0.0, f64::max) / self.size
    }

    /// Distances of the bodies from the origins of their frames.
    fn distances(&self) -> impl Iterator<Item = f64> {
        let place = |(body, state): (&ConservativeBody, &State)| get(body.list(state).slow(), part::POSITION).norm();
        self.system.bodies.iter().zip(&self.bodies).map(place)
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

    /// Joints whose friction has held, each with the time for which it has, and the path by which it has crept in that time (rad, or a
    /// length): friction holds by a small rate.
    pub fn held(&self) -> impl Iterator<Item = (usize, [f64; 2])> {
        let forces = self.system.connections.joint_forces().zip(&self.held);
        forces.filter(|(_, [time, _])| *time > 0.0).map(|((joint, ..), held)| (joint, *held))
    }

    /// Works of a force element since the beginning.
    pub fn work_of_element(&self, element: usize) -> JointWork {
        self.element_works[element]
    }

    /// Work of the force elements, and of springs, dampers, stops and friction of joints, since the beginning.
    pub fn element_work(&self) -> f64 {
        let of_elements = self.element_works.iter().map(|work| work.drive + work.spring - work.loss);
        of_elements.chain(self.joint_works.iter().map(|work| work.spring - work.loss)).sum()
    }

    /// Linear momentum, and angular momentum about the global origin, of all bodies, global.
    pub fn momenta(&self) -> [Vector3<f64>; 2] {
        let mut sums = [Vector3::zeros(); 2];
        for (body, state) in self.system.bodies.iter().zip(&self.bodies) {
            let list = body.list(state);
            let [position, momentum, pi] =
                [part::POSITION, part::MOMENTUM, part::PI].map(|part| get(list.slow(), part));
            let position = body.frame.global_place(&position, self.time);
            let momentum = momentum + body.frame.velocity() * body.mass();
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
        self.matrices.is_left_out[..self.system.rows()].iter().filter(|is_left_out| **is_left_out).count()
    }

    /// Moves the bodies, and changes their velocities, so that the joints hold. Returns the largest residual and the largest
    /// rate that are left.
    ///
    /// # Errors
    /// [`Failed`] where the inertia of a body is singular.
    pub fn assemble(&mut self) -> Result<[f64; 2], Failed> {
        self.close_joints()?;
        self.assemble_here()
    }

    /// The same from where the joints are all but closed.
    pub(super) fn assemble_here(&mut self) -> Result<[f64; 2], Failed> {
        self.forget_judgement();
        let mut left = self.assemble_by(self.time)?;
        for _ in 0..MAX_ASSEMBLIES {
            if self.is_closed(left) {
                break;
            }
            // After a large move, the matrices were those of where the bodies had been.
            self.forget_judgement();
            left = self.assemble_by(self.time)?;
        }
        Ok(left)
    }

    /// True if the residual and the rate that are left where the system has been put together are rounding.
    fn is_closed(&self, [residual, rate]: [f64; 2]) -> bool {
        let [.., last] = &self.stages;
        let largest = self.system.radii.iter().copied().fold(0.0, f64::max);
        let size = if largest > 0.0 { largest } else { self.size };
        let speed = last.velocities.iter().fold(0.0_f64, |most, velocity| most.max(velocity.abs()));
        let rounding = self.system.rounding;
        residual <= CLOSED * size + rounding && rate <= (CLOSED + rounding / size) * speed
    }

    /// The same with the branches of drives that hold at a time.
    fn assemble_by(&mut self, branch_time: f64) -> Result<[f64; 2], Failed> {
        self.begin();
        self.evaluate_first(branch_time)?;
        self.judge();
        let [.., last] = &mut self.stages;
        last.x.copy_from_slice(&self.first.x);
        last.y.copy_from_slice(&self.first.y);
        last.inertia.clone_from(&self.first.inertia);
        self.end([self.time, branch_time], ASSEMBLY)
    }

    /// Tries a step of length `h` that ends at `end`, with Newton's method as exact as `exactness`, and goes on where
    /// its error is at most `allowed`. The error is measured as in a run that is as long as this step.
    ///
    /// # Errors
    /// [`Failed`]; the state stays.
    pub fn try_step(&mut self, h: f64, end: f64, exactness: f64, allowed: f64) -> Result<Tried, Failed> {
        self.try_step_of(h, end, &Bound::of_one_step(exactness, allowed), false)
    }

    /// The same in a run; a step over a kink that a law tells is not taken under a tolerance, unless it is to be.
    pub(super) fn try_step_of(&mut self, h: f64, end: f64, bound: &Bound, over_kinks: bool) -> Result<Tried, Failed> {
        let over_kinks = over_kinks || !bound.allowed.is_finite();
        self.begin();
        let branch_time = self.time + 0.5 * h;
        self.evaluate_first(branch_time)?;
        self.judge();
        self.is_controlled = bound.allowed.is_finite();
        if self.scheme.is_explicit {
            return self.try_explicit_step(h, [end, branch_time], bound, over_kinks);
        }
        self.predict(h);
        let energy = self.largest_energy;
        let mut passes = self.newton(h, bound, FrictionSlope::Tangent);
        if passes == Err(Failed::Newton) && self.law_work.has_friction {
            self.predict(h);
            passes = self.newton(h, bound, FrictionSlope::Secant);
        }
        let tried = passes.and_then(|passes| {
            let mut estimate = self.errors(h, bound.span);
            estimate.errors.energy = self.energy_error(h);
            let forgotten = estimate.forget(bound);
            let Estimate { errors, has_order_of_scheme, .. } = estimate;
            let has_order_of_scheme = has_order_of_scheme && errors.energy < errors.largest();
            let kink = if over_kinks { None } else { self.length_to_kink(h)? };
            Ok(Tried { errors, forgotten, has_order_of_scheme, passes, kink })
        });
        let is_taken = tried.as_ref().is_ok_and(|tried| bound.ratio(&tried.errors) <= 1.0 && tried.kink.is_none());
        if !is_taken {
            // That of a step that is too long says nothing about a shorter one.
            self.largest_energy = energy;
        }
        let tried = tried?;
        if tried.errors.largest().is_nan() {
            return Err(Failed::Newton);
        }
        if is_taken {
            for (last, stage) in self.last.iter_mut().zip(&self.stages) {
                last[0].copy_from_slice(&stage.x);
                last[1].copy_from_slice(&stage.y);
            }
            self.last_length = h;
            self.find_bend();
            self.find_stage_rates();
            self.keep_past();
            self.reach_end();
            let weights = self.scheme.weights.map(|weight| h * weight);
            let Self { stages: [.., stage], system, start, scheme, stage_rates, .. } = self;
            // Σ_i b_i a_ij = b_j (1 − c_j).
            let forces = |k: usize| {
                let parts = stage_rates.iter().zip(weights.iter().zip(scheme.times));
                parts.map(|(rates, (weight, time))| weight * (1.0 - time) * rates.y[k]).sum::<f64>()
            };
            stage.correct_centers((system, start), h, forces);
            self.land([end, branch_time], h, weights)?;
        }
        Ok(tried)
    }

    /// The next step begins without the polynomials of the last.
    pub(in crate::system) fn forget_last_step(&mut self) {
        (self.last_length, self.past.steps) = (0.0, 0);
    }

    /// Takes the state as the start of a step.
    pub(super) fn begin(&mut self) {
        self.start.time = self.time;
        self.start.bodies.clear();
        for (b, (body, state)) in self.system.bodies.iter().zip(&self.bodies).enumerate() {
            let list = body.list(state);
            self.start.bodies.push(BodyStart::new(body, state, self.system.spins_apart[b]));
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
}

/// The size of the largest body: its radius of gyration, or the distance of a marker from its origin. Of points alone, that between them and
/// from what holds them.
fn size_of_bodies(system: &System, states: &[MotionState]) -> f64 {
    let size = system.sizes.iter().copied().fold(0.0, f64::max);
    if size > 0.0 {
        return size;
    }
    system.spread_of_points(states.iter().map(|state| state.origin_global))
}
