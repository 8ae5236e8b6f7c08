//! Hard cases: fast spins with loose parts, loops near their limits, bodies of hardly any mass, jumps and strikes.

use std::f64::consts::PI;
use std::sync::Arc;

use dynamics::{
    ConservativeBody, Coordinate, History, Joint, JointDrive, JointForce, Marker, MotionState, Physics, PointForce,
    PointShapes, Rows, Simulation, Start, StepControl, StepError, Stops, System, SystemMotion, SystemScheme,
    SystemSetup,
};
use nalgebra::{Matrix3, Vector3};
use reduced_body::{BodyPoint, ReducedBody, RigidMotion};
use rigid_kin::Attitude;

const GRAVITY: f64 = 9.81;

/// A body with its weight along −z.
fn body(mass: f64, inertia: Vector3<f64>, gravity: f64) -> ConservativeBody {
    let inertia = Matrix3::from_diagonal(&inertia);
    let reduced = ReducedBody::rigid(mass, Vector3::zeros(), inertia, RigidMotion::free()).unwrap();
    let center = PointShapes::new(&reduced, &BodyPoint::rigid(Vector3::zeros()));
    let weight = PointForce::dead(center, Vector3::new(0.0, 0.0, -mass * gravity), History::Constant);
    ConservativeBody::new(&reduced, &[], vec![Arc::new(weight)], &Physics::default()).unwrap()
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

fn at(body: usize, x: f64, y: f64, z: f64, axes: Matrix3<f64>) -> Marker {
    Marker::on_rigid(body, Vector3::new(x, y, z), axes)
}

fn ground(x: f64, y: f64, z: f64, axes: Matrix3<f64>) -> Marker {
    Marker::on_ground(Vector3::new(x, y, z), axes)
}

/// Axes whose z axis is along y.
fn about_y() -> Matrix3<f64> {
    Matrix3::new(1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, -1.0, 0.0)
}

/// Conserved: a fast top on a ball, with a panel that flaps freely on it: its energy, and its spin about the vertical.
#[test]
fn a_top_with_a_loose_panel_keeps_energy_and_spin() {
    let (spin, masses) = (300.0, [1.0, 0.05]);
    let top = body(masses[0], Vector3::new(2e-3, 2e-3, 3e-3), GRAVITY);
    let panel = body(masses[1], Vector3::new(1e-6, 5e-5, 5e-5), GRAVITY);
    let axes = Matrix3::identity();
    let joints = vec![
        Joint::spherical("tip", [ground(0.0, 0.0, 0.0, axes), at(0, 0.0, 0.0, -0.1, axes)]),
        Joint::revolute("flap", [at(0, 0.05, 0.0, 0.0, about_y()), at(1, -0.06, 0.0, 0.0, about_y())]),
    ];
    let omega = Vector3::new(3.0, 0.0, spin);
    let positions = [Vector3::new(0.0, 0.0, 0.1), Vector3::new(0.11, 0.0, 0.1)];
    let states =
        positions.map(|r| state(r, omega.cross(&r), omega + Vector3::y() * if r.x > 0.0 { 20.0 } else { 0.0 }));
    let mut motion = SystemMotion::new(System::new(vec![top, panel], joints).unwrap(), &states).unwrap();
    motion.assemble().unwrap();
    let energy = |motion: &SystemMotion| {
        let potential = (0..2).map(|b| masses[b] * GRAVITY * motion.state(b).unwrap().origin_global.z).sum::<f64>();
        motion.energy().unwrap() + potential
    };
    let before = (energy(&motion), motion.momenta()[1].z);
    let steps = motion.advance(0.5, 1e-7, &mut 1e-4).unwrap();
    let drifts = [energy(&motion) / before.0 - 1.0, motion.momenta()[1].z / before.1 - 1.0];
    println!("{steps} steps for 24 turns, energy and spin {drifts:?}");
    assert!(drifts.iter().all(|drift| drift.abs() < 1e-6), "{drifts:?}");
    assert!(motion.joint_coordinates(1).turn.abs() < 1.0);
}

/// Conserved: a four-bar that is two millimetres from a parallelogram passes its flat positions, which are near those of a fold.
#[test]
fn a_loop_near_its_fold_keeps_its_energy() {
    let axes = Matrix3::identity();
    let (crank, rocker, length) = (1.0, 1.002, 2.0);
    let bar = |length: f64| body(length, Vector3::new(1e-3, length.powi(3) / 12.0, length.powi(3) / 12.0), 0.0);
    // The cranks stand along y; markers at their ends.
    let joints = vec![
        Joint::revolute("a", [ground(0.0, 0.0, 0.0, axes), at(0, 0.0, -0.5 * crank, 0.0, axes)]),
        Joint::revolute("b", [at(0, 0.0, 0.5 * crank, 0.0, axes), at(1, -0.5 * length, 0.0, 0.0, axes)]),
        Joint::revolute("c", [at(1, 0.5 * length, 0.0, 0.0, axes), at(2, 0.0, 0.5 * rocker, 0.0, axes)]),
        Joint::revolute("d", [ground(length, 0.0, 0.0, axes), at(2, 0.0, -0.5 * rocker, 0.0, axes)]),
    ];
    let omega = Vector3::z() * -3.0;
    let states = [
        state(Vector3::y() * 0.5 * crank, omega.cross(&(Vector3::y() * 0.5)), omega),
        state(Vector3::new(0.5 * length, crank, 0.0), omega.cross(&Vector3::y()), Vector3::zeros()),
        state(Vector3::new(length, 0.5 * rocker, 0.0), omega.cross(&(Vector3::y() * 0.5)), omega),
    ];
    let system = System::new(vec![bar(crank), bar(length), bar(rocker)], joints).unwrap();
    let mut motion = SystemMotion::new(system, &states).unwrap();
    motion.assemble().unwrap();
    let energy = motion.energy().unwrap();
    let steps = motion.advance(5.0, 1e-7, &mut 1e-3).unwrap();
    let drift = motion.energy().unwrap() / energy - 1.0;
    let turns = motion.joint_coordinates(0).turn / (2.0 * PI);
    println!("{steps} steps for {turns} turns, energy {drift:e}");
    assert!(drift.abs() < 1e-5 && turns.abs() > 1.0, "{drift:e} {turns}");
}

/// Conserved: a body that tumbles on a ball at its centre of mass keeps its energy and its angular momentum.
#[test]
fn a_joint_at_the_centre_of_mass_does_nothing() {
    let axes = Matrix3::identity();
    let ball = Joint::spherical("ball", [ground(0.0, 0.0, 0.0, axes), at(0, 0.0, 0.0, 0.0, axes)]);
    let tumbling = state(Vector3::zeros(), Vector3::zeros(), Vector3::new(0.1, 8.0, 0.2));
    let system = System::new(vec![body(2.0, Vector3::new(0.2, 0.3, 0.4), GRAVITY)], vec![ball]).unwrap();
    let mut motion = SystemMotion::new(system, &[tumbling]).unwrap();
    let before = (motion.energy().unwrap(), motion.momenta()[1]);
    motion.advance(5.0, 1e-8, &mut 1e-3).unwrap();
    assert!((motion.energy().unwrap() / before.0 - 1.0).abs() < 1e-7);
    assert!((motion.momenta()[1] - before.1).norm() < 1e-12 * before.1.norm());
    motion.find_reactions().unwrap();
    assert!((motion.reaction(0).force_global.z - 2.0 * GRAVITY).abs() < 1e-9);
}

/// A payload of 1 kg on hinged links, each of this part of its mass, straight and 45° from the vertical.
fn taut_chain(links: usize, part: f64) -> SystemMotion {
    let (length, mass) = (0.1, part);
    let mut bodies =
        vec![body(mass, Vector3::new(1e-5, 1.0 / 12.0, 1.0 / 12.0) * mass * length * length, GRAVITY); links];
    bodies.push(body(1.0, Vector3::repeat(1e-3), GRAVITY));
    let along = Vector3::new(1.0, 0.0, -1.0).normalize();
    let tilt = Attitude::identity().advanced_by(&(Vector3::y() * 0.25 * PI));
    let mut joints =
        vec![Joint::revolute("0", [ground(0.0, 0.0, 0.0, about_y()), at(0, -0.5 * length, 0.0, 0.0, about_y())])];
    for link in 0..links {
        let next = if link + 1 < links { -0.5 * length } else { 0.0 };
        let markers = [at(link, 0.5 * length, 0.0, 0.0, about_y()), at(link + 1, next, 0.0, 0.0, about_y())];
        joints.push(Joint::revolute(&format!("{}", link + 1), markers));
    }
    let states: Vec<MotionState> = (0..=links)
        .map(|k| {
            let from_root = if k < links { k as f64 + 0.5 } else { links as f64 };
            MotionState { attitude: tilt, ..state(along * (from_root * length), Vector3::zeros(), Vector3::zeros()) }
        })
        .collect();
    SystemMotion::new(System::new(bodies, joints).unwrap(), &states).unwrap()
}

/// Counted: a taut chain does not pay for the lightness of its links. Conserved: its length is that of the string that it becomes.
#[test]
fn a_taut_chain_of_light_links_does_not_pay_for_its_ratio() {
    for links in [3, 12] {
        let steps = [1.0, 1e3, 1e6, 1e8].map(|ratio| {
            let mut motion = taut_chain(links, 1.0 / ratio);
            motion.assemble().unwrap();
            let steps = motion.advance(1.0, 1e-6, &mut 1e-3).unwrap();
            let at = motion.state(links).unwrap().origin_global;
            let shorter = 1.0 - at.norm() / (0.1 * links as f64);
            println!(
                "{links} links {ratio:e}: {steps} steps, {} evaluations, {shorter:e} shorter",
                motion.evaluations()
            );
            assert!(shorter.abs() < 1.0 / ratio + 1e-12, "{shorter}");
            steps
        });
        // By the frequencies of the links it would be a thousand times as many for a ratio of 1e6.
        let [heavy, .., lightest] = steps;
        assert!(lightest < 4 * heavy && steps.iter().all(|of| *of < 15 * heavy), "{links} links: {steps:?}");
    }
}

/// Closed form: a bob on a rod of 1e-9 of its mass, between two hinges, has the period of a point on a string, by the
/// arithmetic-geometric mean.
#[test]
fn a_rod_of_no_mass_is_a_string() {
    let bob = body(1.0, Vector3::repeat(1e-2), GRAVITY);
    let rod = body(1e-9, Vector3::repeat(1e-10), GRAVITY);
    let joints = vec![
        Joint::revolute("above", [ground(0.0, 0.0, 0.0, about_y()), at(0, -0.5, 0.0, 0.0, about_y())]),
        Joint::revolute("below", [at(0, 0.5, 0.0, 0.0, about_y()), at(1, 0.0, 0.0, 0.0, about_y())]),
    ];
    let states = [0.5, 1.0].map(|x| state(Vector3::x() * x, Vector3::zeros(), Vector3::zeros()));
    let mut motion = SystemMotion::new(System::new(vec![rod, bob], joints).unwrap(), &states).unwrap();
    let (mut a, mut g) = (1.0, f64::cos(0.25 * PI));
    while f64::abs(a - g) > 1e-15 {
        (a, g) = (0.5 * (a + g), f64::sqrt(a * g));
    }
    let period = 2.0 * PI * f64::sqrt(1.0 / GRAVITY) / a;
    let steps = motion.advance(period, 1e-8, &mut 1e-3).unwrap();
    let back = motion.state(1).unwrap().origin_global - Vector3::x();
    println!("{steps} steps, {:e} off", back.norm());
    assert!(back.norm() < 1e-6, "{back}");
}

/// Closed form: a motor that is switched on in the middle of a run.
#[test]
fn a_motor_that_jumps_turns_from_there_on() {
    let axes = Matrix3::identity();
    let motor = Some(JointDrive { amplitude: 0.8, history: History::Step { at: 0.5 } });
    let hinge = Joint::revolute("hinge", [ground(0.0, 0.0, 0.0, axes), at(0, 0.0, 0.0, 0.0, axes)])
        .with_force(Coordinate::Turn, JointForce { motor, ..JointForce::default() });
    let still = state(Vector3::zeros(), Vector3::zeros(), Vector3::zeros());
    let system = System::new(vec![body(2.0, Vector3::repeat(0.4), 0.0)], vec![hinge]).unwrap();
    let mut motion = SystemMotion::new(system, &[still]).unwrap();
    for end in [0.5, 1.5] {
        motion.advance(end, 1e-8, &mut 1e-2).unwrap();
    }
    assert!((motion.joint_coordinates(0).turn - 1.0).abs() < 1e-9, "{:?}", motion.joint_coordinates(0));
}

/// Closed form: a bar that falls on a stop comes to rest as deep in it as its weight says, and has lost what it fell.
#[test]
fn a_bar_strikes_a_stop_and_comes_to_rest() {
    let (stiffness, limit) = (500.0, 0.5);
    let stops = Some(Stops { limits: [-1.0, limit], stiffness, damping: 20.0 });
    let hinge = Joint::revolute("hinge", [ground(0.0, 0.0, 0.0, about_y()), at(0, -0.5, 0.0, 0.0, about_y())])
        .with_force(Coordinate::Turn, JointForce { stops, ..JointForce::default() });
    let bar = body(1.0, Vector3::new(1e-3, 1.0 / 12.0, 1.0 / 12.0), GRAVITY);
    let start = state(Vector3::x() * 0.5, Vector3::zeros(), Vector3::zeros());
    let mut motion = SystemMotion::new(System::new(vec![bar], vec![hinge]).unwrap(), &[start]).unwrap();
    let mut last = 0.0;
    for row in 1..=40 {
        motion.advance(0.1 * f64::from(row), 1e-6, &mut 1e-3).unwrap();
        let loss = motion.joint_work(0).loss;
        assert!(loss >= last - 1e-9, "{loss} {last}");
        last = loss;
    }
    let now = motion.joint_coordinates(0);
    let depth = now.turn - limit;
    let weight = 0.5 * GRAVITY * now.turn.cos();
    assert!((stiffness * depth - weight).abs() < 1e-3 * weight && now.turn_rate.abs() < 1e-5, "{now:?}");
    let fallen = 0.5 * GRAVITY * now.turn.sin() - 0.5 * stiffness * depth * depth;
    assert!((last / fallen - 1.0).abs() < 2e-3, "{last} {fallen}");
}

/// Closed form: an arm of two links of 1, whose end a rail moves from 1.8 to 2.8, is stretched after a fifth of the time; the pin of
/// another body, which bears nothing there, is not named.
#[test]
fn an_arm_that_is_driven_beyond_its_reach_names_the_joints_that_lock() {
    let path = JointDrive { amplitude: 1.0, history: History::Ramp { start: 0.0, duration: 1.0 } };
    let along_x = Matrix3::new(0.0, 0.0, 1.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0);
    let hinge = |name: &str, markers: [Marker; 2]| Joint::revolute(name, markers);
    let on = |body: usize, x: f64| at(body, x, 0.0, 0.0, about_y());
    let joints = vec![
        hinge("pin", [ground(0.0, 5.0, 0.0, about_y()), on(3, 0.0)]),
        hinge("shoulder", [ground(0.0, 0.0, 0.0, about_y()), on(0, -0.5)]),
        hinge("elbow", [on(0, 0.5), on(1, -0.5)]),
        hinge("wrist", [on(1, 0.5), on(2, 0.0)]),
        Joint::prismatic("rail", [ground(1.8, 0.0, 0.0, along_x), at(2, 0.0, 0.0, 0.0, along_x)]).moved_by(path),
    ];
    let bar = || body(1.0, Vector3::new(1e-3, 1.0, 1.0) / 12.0, 0.0);
    let small = || body(0.1, Vector3::repeat(1e-3), 0.0);
    let x: f64 = 0.9;
    let z = f64::sqrt(1.0 - x * x);
    let tilted = |angle: f64, at: Vector3<f64>| MotionState {
        attitude: Attitude::identity().advanced_by(&(Vector3::y() * angle)),
        ..state(at, Vector3::zeros(), Vector3::zeros())
    };
    let angle = f64::asin(z);
    let states = vec![
        tilted(-angle, Vector3::new(0.5 * x, 0.0, 0.5 * z)),
        tilted(angle, Vector3::new(1.5 * x, 0.0, 0.5 * z)),
        tilted(0.0, Vector3::x() * 1.8),
        tilted(0.0, Vector3::y() * 5.0),
    ];
    for control in [StepControl::Tolerance(1e-6), StepControl::Fixed(1e-3)] {
        let setup = SystemSetup {
            system: System::new(vec![bar(), bar(), small(), small()], joints.clone()).unwrap(),
            states: states.clone(),
            start: Start::AsPlaced,
            scheme: SystemScheme::default(),
            control,
            end: 1.0,
            rows: Rows::EverySteps(1),
            points: vec![Vec::new(); 4],
        };
        let mut simulation = Simulation::of_system(setup).unwrap();
        let failed = loop {
            match simulation.advance(100) {
                Ok(reached) => assert_ne!(reached, dynamics::Reached::End),
                Err(error) => break error,
            }
        };
        let StepError::Locked { time, joints } = failed else { panic!("{failed}") };
        assert_eq!(&*joints, "\"shoulder\", \"elbow\", \"wrist\", \"rail\"");
        assert!((time - 0.2).abs() < 2e-3, "{time}");
    }
}
