//! Systems of bodies in joints: loose, stiff, near-singular, massless, struck, locked.

use std::f64::consts::TAU;
use std::sync::Arc;

use dynamics::{
    ConservativeBody, Coordinate, History, Joint, JointDrive, JointForce, Marker, MotionState, Physics, PointForce,
    PointShapes, RateError, Reached, Rows, Simulation, Start, StepControl, Stops, System, SystemMotion, SystemScheme,
    SystemSetup,
};
use nalgebra::{Matrix3, Vector3};
use reduced_body::{BodyPoint, ReducedBody, RigidMotion};
use rigid_kin::Attitude;

use crate::stability::Bound::{Refused, Within};
use crate::stability::{Bound, Extent, TrialOutcome};

const GRAVITY: f64 = 9.81;
const TOLERANCE: f64 = 1e-7;

/// A hard case of a system.
#[derive(Debug, Clone, Copy)]
pub struct SystemCase {
    /// Its name.
    pub name: &'static str,
    /// Reason of the difficulty.
    pub why: &'static str,
    /// Name of the figure.
    pub measure: &'static str,
    /// Runs it.
    pub run: fn(SystemScheme, Extent) -> Result<f64, String>,
    /// Bounds of Radau and of Gauss.
    pub expected: [Bound; 2],
}

impl SystemCase {
    /// Runs it by one of [`SCHEMES`].
    pub fn outcome(&self, scheme: usize, extent: Extent) -> TrialOutcome {
        let (_, scheme) = SCHEMES[scheme];
        (self.run)(scheme, extent).map_or_else(TrialOutcome::Refused, TrialOutcome::Ran)
    }
}

/// The schemes of systems, with their names.
pub const SCHEMES: [(&str, SystemScheme); 2] = [("radau", SystemScheme::Radau), ("gauss", SystemScheme::Gauss)];

/// The cases.
pub fn cases() -> Vec<SystemCase> {
    vec![
        SystemCase {
            name: "top at 300 rad/s with a loose panel",
            why: "the spin throws the panel out; the hinge feels 30 000 times what the panel weighs",
            measure: "drift of the energy and of the spin about the vertical",
            run: loose_panel,
            expected: [Within(1e-6), Within(1e-6)],
        },
        SystemCase {
            name: "stiff panels on soft hinges, 1e6 apart in frequency",
            why: "a step that sees the hinge has ten thousand periods of the panel in it",
            measure: "angle of the hinge against one panel without a joint in it (rad)",
            run: stiff_panels,
            expected: [Within(1e-4), Within(1e-4)],
        },
        SystemCase {
            name: "four-bar 1e-4 from a parallelogram, through its flat positions",
            why: "near a fold the rows are nearly alike, and another branch is near",
            measure: "drift of the energy",
            run: |scheme, extent| near_fold(scheme, extent, 1e-4),
            expected: [Within(1e-4), Within(1e-4)],
        },
        SystemCase {
            name: "joint at the centre of mass",
            why: "the joint's force has no moment; the body tumbles through its unstable axis",
            measure: "drift of the energy and of the angular momentum",
            run: at_center,
            expected: [Within(1e-6), Within(1e-6)],
        },
        SystemCase {
            name: "bob on a rod of 1e-9 of its mass",
            why: "accelerations of the rod are 1e9 times those of the bob for the same force",
            measure: "distance from the start after a period of a point on a string (m)",
            run: |scheme, _| massless_rod(scheme, 1e-9),
            expected: [Within(1e-6), Within(1e-6)],
        },
        SystemCase {
            name: "bob on a rod of 1e-12 of its mass",
            why: "accelerations of the rod are 1e12 times those of the bob for the same force",
            measure: "distance from the start after a period of a point on a string (m)",
            run: |scheme, _| massless_rod(scheme, 1e-12),
            expected: [Within(1e-6), Within(1e-6)],
        },
        SystemCase {
            name: "motor that jumps",
            why: "before the jump nothing moves, and steps are as long as they like",
            measure: "angle at the end (rad)",
            run: jump,
            expected: [Within(1e-9), Within(1e-9)],
        },
        SystemCase {
            name: "bar that falls on a stiff stop, again and again",
            why: "the stop is 1e5 times as stiff as what the step saw before, on one side only",
            measure: "drift of the energy after 5 s, relative to the fall",
            run: strikes,
            expected: [Within(1e-3), Within(1e-3)],
        },
        SystemCase {
            name: "a million steps of a free pair",
            why: "rounding adds up",
            measure: "drift of both momenta",
            run: million,
            expected: [Within(1e-8), Within(1e-8)],
        },
        SystemCase {
            name: "arm of two links that is driven beyond its reach",
            why: "stretched, the arm locks: no velocity satisfies the joints",
            measure: "–",
            run: locked_arm,
            expected: [Refused("the joints lock"), Refused("the joints lock")],
        },
    ]
}

/// A rigid body with its weight along −z.
fn body(mass: f64, moments: [f64; 3], gravity: f64) -> Result<ConservativeBody, String> {
    let inertia = Matrix3::from_diagonal(&moments.into());
    let reduced = ReducedBody::rigid(mass, Vector3::zeros(), inertia, RigidMotion::free()).map_err(words)?;
    let center = PointShapes::new(&reduced, &BodyPoint::rigid(Vector3::zeros()));
    let weight = PointForce::dead(center, Vector3::new(0.0, 0.0, -mass * gravity), History::Constant);
    ConservativeBody::new(&reduced, &[], vec![Arc::new(weight)], &Physics::default()).map_err(words)
}

/// A thin bar along x.
fn bar(mass: f64, length: f64, gravity: f64) -> Result<ConservativeBody, String> {
    let moment = mass * length * length / 12.0;
    body(mass, [1e-3 * moment, moment, moment], gravity)
}

fn words(error: impl std::fmt::Display) -> String {
    error.to_string()
}

fn of_rates(error: RateError) -> String {
    format!("{error:?}")
}

fn state(origin: Vector3<f64>, velocity: Vector3<f64>, omega: Vector3<f64>) -> MotionState {
    MotionState {
        time: 0.0,
        attitude: Attitude::identity(),
        origin_global: origin,
        velocity_global: velocity,
        omega_body: omega,
        modal_displacement: Vec::new(),
        modal_velocity: Vec::new(),
    }
}

/// A body that turns about a place.
fn turning(at: Vector3<f64>, about: Vector3<f64>, omega: Vector3<f64>) -> MotionState {
    state(at, omega.cross(&(at - about)), omega)
}

/// Axes whose z is along y.
fn about_y() -> Matrix3<f64> {
    Matrix3::new(1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, -1.0, 0.0)
}

fn on(body: usize, x: f64) -> Marker {
    Marker::on_rigid(body, Vector3::new(x, 0.0, 0.0), about_y())
}

fn ground(x: f64) -> Marker {
    Marker::on_ground(Vector3::new(x, 0.0, 0.0), about_y())
}

/// The system in motion, put together.
fn start(
    scheme: SystemScheme,
    bodies: Vec<ConservativeBody>,
    joints: Vec<Joint>,
    states: &[MotionState],
) -> Result<SystemMotion, String> {
    let system = System::new(bodies, joints).map_err(words)?;
    let mut motion = SystemMotion::new(system, states).map_err(words)?.with_scheme(scheme);
    motion.assemble().map_err(|error| format!("{error:?}"))?;
    Ok(motion)
}

/// Potential energy of bodies of these masses.
fn potential(motion: &SystemMotion, masses: &[f64]) -> Result<f64, String> {
    let of =
        |(number, mass): (usize, &f64)| Ok(mass * GRAVITY * motion.state(number).map_err(of_rates)?.origin_global.z);
    masses.iter().enumerate().map(of).sum()
}

fn loose_panel(scheme: SystemScheme, extent: Extent) -> Result<f64, String> {
    let masses = [1.0, 0.05];
    let bodies = vec![body(masses[0], [2e-3, 2e-3, 3e-3], GRAVITY)?, body(masses[1], [1e-6, 5e-5, 5e-5], GRAVITY)?];
    let axes = Matrix3::identity();
    let joints = vec![
        Joint::spherical(
            "tip",
            [Marker::on_ground(Vector3::zeros(), axes), Marker::on_rigid(0, Vector3::new(0.0, 0.0, -0.1), axes)],
        ),
        Joint::revolute("flap", [on(0, 0.05), on(1, -0.06)]),
    ];
    let omega = Vector3::new(3.0, 0.0, 300.0);
    let states = [0.0, 0.11].map(|x| turning(Vector3::new(x, 0.0, 0.1), Vector3::zeros(), omega));
    let mut motion = start(scheme, bodies, joints, &states)?;
    let energy =
        |motion: &SystemMotion| Ok::<f64, String>(motion.energy().map_err(of_rates)? + potential(motion, &masses)?);
    let (before, spin) = (energy(&motion)?, motion.momenta()[1].z);
    let end = if extent == Extent::Test { 0.2 } else { 5.0 };
    motion.advance(end, TOLERANCE, &mut 1e-4).map_err(words)?;
    Ok((energy(&motion)? / before - 1.0).abs().max((motion.momenta()[1].z / spin - 1.0).abs()))
}

/// A panel of two halves with a stiff spring between them, on a soft one, and one panel without a joint in it.
fn stiff_panels(scheme: SystemScheme, extent: Extent) -> Result<f64, String> {
    let soft = 4.0 / 3.0; // a rod of 1 kg and 2 m at 1 rad/s
    let spring = |stiffness: f64| JointForce { stiffness, ..JointForce::default() };
    let omega = Vector3::y() * 0.5;
    let hinge = |body: usize, x: f64, stiffness: f64| {
        Joint::revolute("hinge", [ground(0.0), on(body, x)]).with_force(Coordinate::Turn, spring(stiffness))
    };
    let middle =
        Joint::revolute("middle", [on(0, 0.5), on(1, -0.5)]).with_force(Coordinate::Turn, spring(0.5 / 24.0 * 1e12));
    let halves = vec![bar(0.5, 1.0, 0.0)?, bar(0.5, 1.0, 0.0)?];
    let states = [0.5, 1.5].map(|x| turning(Vector3::x() * x, Vector3::zeros(), omega));
    let mut motion = start(scheme, halves, vec![hinge(0, -0.5, soft), middle], &states)?;
    let whole = [turning(Vector3::x(), Vector3::zeros(), omega)];
    let mut expected = start(scheme, vec![bar(1.0, 2.0, 0.0)?], vec![hinge(0, -1.0, soft)], &whole)?;
    let end = if extent == Extent::Test { 2.0 } else { 20.0 };
    motion.advance(end, TOLERANCE, &mut 1e-3).map_err(words)?;
    expected.advance(end, TOLERANCE, &mut 1e-3).map_err(words)?;
    Ok((motion.joint_coordinates(0).turn - expected.joint_coordinates(0).turn).abs())
}

fn near_fold(scheme: SystemScheme, extent: Extent, gap: f64) -> Result<f64, String> {
    let (crank, rocker, length) = (1.0, 1.0 + gap, 2.0);
    let axes = Matrix3::identity();
    let upright = |length: f64| body(length, [length.powi(3) / 12.0, 1e-3, length.powi(3) / 12.0], 0.0);
    let at = |body: usize, x: f64, y: f64| Marker::on_rigid(body, Vector3::new(x, y, 0.0), axes);
    let fixed = |x: f64| Marker::on_ground(Vector3::new(x, 0.0, 0.0), axes);
    let joints = vec![
        Joint::revolute("a", [fixed(0.0), at(0, 0.0, -0.5 * crank)]),
        Joint::revolute("b", [at(0, 0.0, 0.5 * crank), at(1, -0.5 * length, 0.0)]),
        Joint::revolute("c", [at(1, 0.5 * length, 0.0), at(2, 0.0, 0.5 * rocker)]),
        Joint::revolute("d", [fixed(length), at(2, 0.0, -0.5 * rocker)]),
    ];
    let omega = Vector3::z() * -3.0;
    let states = [
        turning(Vector3::y() * 0.5 * crank, Vector3::zeros(), omega),
        state(Vector3::new(0.5 * length, crank, 0.0), omega.cross(&Vector3::y()), Vector3::zeros()),
        turning(Vector3::new(length, 0.5 * rocker, 0.0), Vector3::x() * length, omega),
    ];
    let bodies = vec![upright(crank)?, bar(length, length, 0.0)?, upright(rocker)?];
    let mut motion = start(scheme, bodies, joints, &states)?;
    let energy = motion.energy().map_err(of_rates)?;
    let end = if extent == Extent::Test { 3.0 } else { 30.0 };
    motion.advance(end, TOLERANCE, &mut 1e-3).map_err(words)?;
    Ok((motion.energy().map_err(of_rates)? / energy - 1.0).abs())
}

fn at_center(scheme: SystemScheme, extent: Extent) -> Result<f64, String> {
    let ball = Joint::spherical("ball", [ground(0.0), on(0, 0.0)]);
    let tumbling = state(Vector3::zeros(), Vector3::zeros(), Vector3::new(0.1, 8.0, 0.2));
    let mut motion = start(scheme, vec![body(2.0, [0.2, 0.3, 0.4], GRAVITY)?], vec![ball], &[tumbling])?;
    let (energy, momentum) = (motion.energy().map_err(of_rates)?, motion.momenta()[1]);
    let end = if extent == Extent::Test { 5.0 } else { 100.0 };
    motion.advance(end, TOLERANCE, &mut 1e-3).map_err(words)?;
    let turned = (motion.momenta()[1] - momentum).norm() / momentum.norm();
    Ok((motion.energy().map_err(of_rates)? / energy - 1.0).abs().max(turned))
}

fn massless_rod(scheme: SystemScheme, mass: f64) -> Result<f64, String> {
    let bodies = vec![body(mass, [0.1 * mass; 3], GRAVITY)?, body(1.0, [1e-2; 3], GRAVITY)?];
    let joints =
        vec![Joint::revolute("above", [ground(0.0), on(0, -0.5)]), Joint::revolute("below", [on(0, 0.5), on(1, 0.0)])];
    let states = [0.5, 1.0].map(|x| state(Vector3::x() * x, Vector3::zeros(), Vector3::zeros()));
    let mut motion = start(scheme, bodies, joints, &states)?;
    // The period from the horizontal, by the arithmetic-geometric mean.
    let (mut a, mut g) = (1.0, (0.125 * TAU).cos());
    while f64::abs(a - g) > 1e-15 {
        (a, g) = (0.5 * (a + g), f64::sqrt(a * g));
    }
    motion.advance(TAU / GRAVITY.sqrt() / a, 1e-8, &mut 1e-3).map_err(words)?;
    Ok((motion.state(1).map_err(of_rates)?.origin_global - Vector3::x()).norm())
}

fn jump(scheme: SystemScheme, _: Extent) -> Result<f64, String> {
    let motor = Some(JointDrive { amplitude: 0.8, history: History::Step { at: 0.5 } });
    let hinge = Joint::revolute("hinge", [ground(0.0), on(0, 0.0)])
        .with_force(Coordinate::Turn, JointForce { motor, ..JointForce::default() });
    let still = state(Vector3::zeros(), Vector3::zeros(), Vector3::zeros());
    let mut simulation = Simulation::of_system(SystemSetup {
        system: System::new(vec![body(2.0, [0.4; 3], 0.0)?], vec![hinge]).map_err(words)?,
        states: vec![still],
        start: Start::AsPlaced,
        scheme,
        control: StepControl::Tolerance(TOLERANCE),
        end: 1.5,
        rows: Rows::Interval(1.5),
        points: vec![Vec::new()],
    })
    .map_err(words)?;
    while simulation.advance_watched(1000, |_, _| ()).map_err(words)? != Reached::End {}
    Ok((simulation.observe_joint(0).coordinates.turn - 1.0).abs())
}

fn strikes(scheme: SystemScheme, extent: Extent) -> Result<f64, String> {
    let stops = Some(Stops { limits: [-1.0, 0.5], stiffness: 1e6, damping: 0.0 });
    let hinge = Joint::revolute("hinge", [ground(0.0), on(0, -0.5)])
        .with_force(Coordinate::Turn, JointForce { stops, ..JointForce::default() });
    let still = [state(Vector3::x() * 0.5, Vector3::zeros(), Vector3::zeros())];
    let mut motion = start(scheme, vec![bar(1.0, 1.0, GRAVITY)?], vec![hinge], &still)?;
    let end = if extent == Extent::Test { 1.0 } else { 5.0 };
    motion.advance(end, TOLERANCE, &mut 1e-3).map_err(words)?;
    // What the stop holds at the end is its work on the bar, with the other sign.
    let held = -motion.joint_work(0).spring;
    let energy = motion.energy().map_err(of_rates)? + potential(&motion, &[1.0])? + held;
    Ok(energy.abs() / (0.5 * GRAVITY * f64::sin(0.5)))
}

fn million(scheme: SystemScheme, extent: Extent) -> Result<f64, String> {
    let bodies = vec![body(2.0, [0.2, 0.3, 0.4], 0.0)?, body(1.0, [0.1, 0.2, 0.15], 0.0)?];
    let ball = Joint::spherical("ball", [on(0, 0.5), on(1, -0.5)]);
    let omega = Vector3::new(0.3, 2.0, 0.5);
    let states =
        [turning(Vector3::zeros(), Vector3::x() * 0.5, omega), turning(Vector3::x(), Vector3::x() * 0.5, -omega)];
    let mut motion = start(scheme, bodies, vec![ball], &states)?;
    let [linear, angular] = motion.momenta();
    let steps: u32 = if extent == Extent::Test { 10_000 } else { 1_000_000 };
    let h = 0.02;
    for step in 1..=steps {
        motion.try_step(h, h * f64::from(step), 1e-3, f64::INFINITY).map_err(|error| format!("{error:?}"))?;
    }
    let [p, l] = motion.momenta();
    // About the origin: what the centre has gone times the momentum is nothing.
    Ok(((p - linear).norm() / linear.norm().max(1.0)).max((l - angular).norm() / angular.norm()))
}

fn locked_arm(scheme: SystemScheme, _: Extent) -> Result<f64, String> {
    let path = JointDrive { amplitude: 1.0, history: History::Ramp { start: 0.0, duration: 1.0 } };
    // A slide along x takes the end of the arm from 1.8 to 2.8; the arm is 2 long.
    let along_x = Matrix3::new(0.0, 0.0, 1.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0);
    let x = 0.9;
    let z = f64::sqrt(1.0 - x * x);
    let joints = vec![
        Joint::revolute("shoulder", [ground(0.0), on(0, -0.5)]),
        Joint::revolute("elbow", [on(0, 0.5), on(1, -0.5)]),
        Joint::revolute("wrist", [on(1, 0.5), on(2, 0.0)]),
        Joint::prismatic(
            "rail",
            [Marker::on_ground(Vector3::x() * 1.8, along_x), Marker::on_rigid(2, Vector3::zeros(), along_x)],
        )
        .moved_by(path),
    ];
    let tilted = |angle: f64, at: Vector3<f64>| MotionState {
        attitude: Attitude::identity().advanced_by(&(Vector3::y() * angle)),
        ..state(at, Vector3::zeros(), Vector3::zeros())
    };
    let angle = f64::asin(z);
    let states = [
        tilted(-angle, Vector3::new(0.5 * x, 0.0, 0.5 * z)),
        tilted(angle, Vector3::new(1.5 * x, 0.0, 0.5 * z)),
        tilted(0.0, Vector3::x() * 1.8),
    ];
    let bodies = vec![bar(1.0, 1.0, 0.0)?, bar(1.0, 1.0, 0.0)?, body(0.1, [1e-3; 3], 0.0)?];
    let mut motion = start(scheme, bodies, joints, &states)?;
    motion.advance(1.0, 1e-6, &mut 1e-3).map_err(words)?;
    Ok(f64::NAN)
}
