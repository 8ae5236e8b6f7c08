//! Rows that others imply, joints that contradict each other, and linkages through their singular positions.

use std::f64::consts::PI;
use std::sync::Arc;

use dynamics::{
    Bushing, ConservativeBody, Coupling, Expression, History, Joint, JointDrive, Marker, MotionState, Physics,
    PointForce, PointShapes, PointSpring, Reached, Rows, SetupError, Simulation, Start, StepControl, StepError, System,
    SystemMotion, SystemScheme, SystemSetup,
};
use nalgebra::{Matrix3, Vector3};
use reduced_body::{BodyPoint, ReducedBody, RigidMotion};
use rigid_kin::Attitude;

const GRAVITY: f64 = 9.81;

fn body(mass: f64, inertia: f64, gravity: f64) -> ConservativeBody {
    let inertia = Matrix3::identity() * inertia;
    let reduced = ReducedBody::rigid(mass, Vector3::zeros(), inertia, RigidMotion::free()).unwrap();
    let center = PointShapes::new(&reduced, &BodyPoint::rigid(Vector3::zeros()));
    let weight = PointForce::dead(center, Vector3::new(0.0, 0.0, -mass * gravity), History::Constant);
    ConservativeBody::new(&reduced, &[], vec![Arc::new(weight)], &Physics::default()).unwrap()
}

fn state(origin: Vector3<f64>, turn: Vector3<f64>) -> MotionState {
    MotionState {
        time: 0.0,
        attitude: Attitude::identity().advanced_by(&turn),
        origin_global: origin,
        velocity_global: Vector3::zeros(),
        omega_body: Vector3::zeros(),
        modal_displacement: Vec::new(),
        modal_velocity: Vec::new(),
    }
}

/// Axes whose z axis is along y.
fn about_y() -> Matrix3<f64> {
    Matrix3::new(1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, -1.0, 0.0)
}

fn on(body: usize, x: f64, z: f64) -> Marker {
    Marker::on_rigid(body, Vector3::new(x, 0.0, z), about_y())
}

fn ground(x: f64, z: f64) -> Marker {
    Marker::on_ground(Vector3::new(x, 0.0, z), about_y())
}

/// An angle that rises by one radian per time from its value at the start.
fn steady(from: f64) -> JointDrive {
    drive(&format!("{from} + t"))
}

fn drive(formula: &str) -> JointDrive {
    JointDrive { amplitude: 1.0, history: History::Expression(Expression::new(formula, Vec::new()).unwrap()) }
}

pub(crate) fn run(
    system: System,
    states: Vec<MotionState>,
    tolerance: f64,
    end: f64,
) -> Result<Simulation, SetupError> {
    let points = vec![Vec::new(); system.bodies().len()];
    Simulation::of_system(SystemSetup {
        system,
        states,
        start: Start::AsPlaced,
        scheme: SystemScheme::default(),
        control: StepControl::Tolerance(tolerance),
        end,
        rows: Rows::EverySteps(1),
        points,
    })
}

fn to_end(simulation: &mut Simulation) -> Result<(), StepError> {
    loop {
        if simulation.advance(1000)? == Reached::End {
            return Ok(());
        }
    }
}

/// Closed form: an arm welded to a light fitting that is welded to the ground stays where it is, in either order of the joints, and
/// the wall bears its weight.
#[test]
fn a_light_fitting_holds_its_arm_in_any_order_of_the_joints() {
    for inertia in [1e-8, 1e-12] {
        for wall_first in [false, true] {
            let axes = Matrix3::identity();
            let at = |body: usize, x: f64| Marker::on_rigid(body, Vector3::new(x, 0.0, 0.0), axes);
            let mut joints = vec![
                Joint::fixed("weld", [at(0, 0.1), at(1, -1.0)]),
                Joint::fixed("wall", [Marker::on_ground(Vector3::zeros(), axes), at(0, 0.0)]),
            ];
            if wall_first {
                joints.reverse();
            }
            let wall = usize::from(!wall_first);
            let states = vec![state(Vector3::zeros(), Vector3::zeros()), state(Vector3::x() * 1.1, Vector3::zeros())];
            let system = System::new(vec![body(0.01, inertia, 0.0), body(1.0, 0.1, GRAVITY)], joints).unwrap();
            let mut simulation = run(system, states, 1e-6, 1.0).unwrap();
            assert_eq!(simulation.system().unwrap().rigid_dofs(), 0);
            to_end(&mut simulation).unwrap();
            let moved = simulation.system_motion().unwrap().state(1).unwrap().origin_global - Vector3::x() * 1.1;
            assert!(moved.norm() < 1e-12, "{inertia} {wall_first}: {moved}");
            let moment = simulation.system_observation().unwrap().joints[wall].reaction_global.moment_global;
            assert!((moment.norm() - 1.1 * GRAVITY).abs() < 1e-6, "{inertia} {wall_first}: {moment}");
        }
    }
}

/// Conserved: a bob of hardly any inertia stays on its hinge, and has the energy that its weight gives it. With its angular momentum about the
/// hinge the work at its stages was millions of times that.
#[test]
fn a_bob_of_hardly_any_inertia_stays_on_its_hinge() {
    for tolerance in [1e-3, 1e-5] {
        let joints = vec![Joint::revolute("hinge", [ground(0.0, 0.0), on(0, -1.0, 0.0)])];
        let system = System::new(vec![body(1.0, 1e-9, GRAVITY)], joints).unwrap();
        let mut simulation = run(system, vec![state(Vector3::x(), Vector3::zeros())], tolerance, 0.5).unwrap();
        to_end(&mut simulation).unwrap();
        let length = simulation.system_motion().unwrap().state(0).unwrap().origin_global.norm();
        assert!((length - 1.0).abs() < 1e-9, "{length}");
        let now = &simulation.system_observation().unwrap().bodies[0];
        assert!(now.energy_balance().abs() < 1e-6 * now.energy(), "{} of {}", now.energy_balance(), now.energy());
        assert!(now.linear_balance_global().norm() < 1e-5 * now.linear_momentum_global.norm());
    }
}

/// Conserved: a light body that hangs from a pendulum on a very stiff pad rests with it: its velocity was the rounding of the pad's force.
/// What there is of energy is less than counts.
#[test]
fn a_light_body_on_a_stiff_pad_rests() {
    let joints = vec![Joint::revolute("hinge", [ground(0.0, 0.0), on(0, 0.0, 1.0)])];
    let at = |body: usize| Marker::on_rigid(body, Vector3::zeros(), Matrix3::identity());
    let pad = Bushing {
        markers: [at(0), at(1)],
        stiffness: [1e9, 1e3].map(Vector3::from_element),
        damping: [Vector3::zeros(); 2],
    };
    let bodies = vec![body(1.0, 1e-3, GRAVITY), body(1e-4, 1e-10, GRAVITY)];
    let system = System::new(bodies, joints).unwrap().with_elements(vec![Arc::new(pad)]).unwrap();
    let below = state(Vector3::new(0.0, 0.0, -1.0), Vector3::zeros());
    let mut simulation = run(system, vec![below.clone(), below], 1e-6, 1.0).unwrap();
    to_end(&mut simulation).unwrap();
    assert!(simulation.system_motion().unwrap().state(1).unwrap().velocity_global.norm() < 1e-8);
    let now = simulation.system_observation().unwrap();
    for (body, now) in now.bodies.iter().enumerate() {
        let (open, counts) = (now.energy_balance().abs(), simulation.energies(body).at_rest);
        assert!(open < 1e-6 * counts && counts < 1e-4, "{open:e} of {counts:e}");
    }
}

/// Conserved: a bob at rest that a spring draws towards its hinge. Momenta that the first step was guessed to have by the spring alone had work.
#[test]
fn a_spring_that_a_joint_balances_has_no_work() {
    let joints = vec![Joint::revolute("hinge", [ground(0.0, 0.0), on(0, -1.0, 0.0)])];
    let spring =
        PointSpring { markers: [ground(0.0, 0.0), on(0, 0.0, 0.0)], stiffness: 50.0, damping: 0.0, free_length: 0.4 };
    let system =
        System::new(vec![body(1.0, 1e-2, 0.0)], joints).unwrap().with_elements(vec![Arc::new(spring)]).unwrap();
    let mut simulation = run(system, vec![state(Vector3::x(), Vector3::zeros())], 1e-5, 0.5).unwrap();
    to_end(&mut simulation).unwrap();
    let works = simulation.system_motion().unwrap().work_of_element(0);
    assert!(works.spring.abs() < 1e-20, "{works:?}");
}

/// Closed form: a light body on a ball, and a spring that is as long as without force, rest. What rounds in the spring shook it, by less than
/// anybody sees, and steps followed that.
#[test]
fn the_rounding_of_a_spring_moves_nothing() {
    let turn = Vector3::new(0.3, -0.7, 0.4);
    let arm = Vector3::new(0.437, -0.418, -0.116);
    let tip = Attitude::identity().advanced_by(&turn).to_global(&arm);
    let ball = Joint::spherical("ball", [ground(0.0, 0.0), on(0, 0.0, 0.0)]);
    let markers = [
        Marker::on_ground(Vector3::new(0.1, 0.2, 1.3), Matrix3::identity()),
        Marker::on_rigid(0, arm, Matrix3::identity()),
    ];
    let free_length = (tip - Vector3::new(0.1, 0.2, 1.3)).norm();
    let spring = PointSpring { markers, stiffness: 4.4, damping: 0.011, free_length };
    let bodies = vec![body(0.016, 5e-5, 0.0)];
    let system = System::new(bodies, vec![ball]).unwrap().with_elements(vec![Arc::new(spring)]).unwrap();
    let mut simulation = run(system, vec![state(Vector3::zeros(), turn)], 1e-6, 0.2).unwrap();
    to_end(&mut simulation).unwrap();
    assert!(simulation.stats().accepted < 40, "{} steps", simulation.stats().accepted);
}

/// Three cranks on one coupler, the first one driven.
fn cranks(lengths: [f64; 3]) -> (System, Vec<MotionState>) {
    let mut joints = Vec::new();
    let (mut bodies, mut states) = (Vec::new(), Vec::new());
    for (k, length) in lengths.into_iter().enumerate() {
        let x = k as f64;
        let foot = Joint::revolute(&format!("foot{k}"), [ground(x, 1.0 - length), on(k, 0.0, -0.5 * length)]);
        joints.push(if k == 0 { foot.turned_by(steady(0.0)) } else { foot });
        joints.push(Joint::revolute(&format!("head{k}"), [on(k, 0.0, 0.5 * length), on(3, x - 1.0, 0.0)]));
        bodies.push(body(1.0, 0.1, 0.0));
        states.push(state(Vector3::new(x, 0.0, 1.0 - 0.5 * length), Vector3::zeros()));
    }
    bodies.push(body(2.0, 0.7, 0.0));
    states.push(state(Vector3::new(1.0, 0.0, 1.0), Vector3::zeros()));
    (System::new(bodies, joints).unwrap(), states)
}

/// Closed form: cranks of different lengths on one coupler cannot turn, though they could for a moment; equal ones can.
#[test]
fn cranks_of_different_lengths_are_refused_and_equal_ones_turn() {
    let (system, states) = cranks([1.0, 1.0, 1.2]);
    let Err(SetupError::Contradiction { joints, .. }) = run(system, states, 1e-7, 1.0) else { panic!("it starts") };
    assert!(joints.contains("foot0") && joints.contains("head2"), "{joints}");
    let (system, states) = cranks([1.0; 3]);
    let mut simulation = run(system, states, 1e-7, 1.0).unwrap();
    to_end(&mut simulation).unwrap();
    assert!(
        simulation.system().unwrap().largest_residual() < 1e-12,
        "{}",
        simulation.system().unwrap().largest_residual()
    );
    let at = simulation.system_motion().unwrap().state(3).unwrap().origin_global;
    assert!((at - Vector3::new(1.0 + f64::sin(1.0), 0.0, f64::cos(1.0))).norm() < 1e-6, "{at}");
}

/// Drives and gears that contradict others are told by name.
#[test]
fn a_drive_against_a_ball_and_a_gear_against_drives_are_told() {
    let system = System::new(
        vec![body(1.0, 0.1, 0.0)],
        vec![
            Joint::revolute("turn", [ground(0.0, 0.0), on(0, -0.5, 0.0)]).turned_by(drive("1 - cos(2*t)")),
            Joint::spherical("ball", [ground(1.0, 0.0), on(0, 0.5, 0.0)]),
        ],
    );
    let refused = run(system.unwrap(), vec![state(Vector3::x() * 0.5, Vector3::zeros())], 1e-6, 1.0);
    let Err(SetupError::Contradiction { joints, .. }) = refused else { panic!("{:?}", refused.err()) };
    assert_eq!(&*joints, "\"turn\", \"ball\"");
    let shaft = |name: &str, number: usize, from: f64| {
        let by = drive(&format!("{from}*t^3"));
        Joint::revolute(name, [ground(number as f64, 0.0), on(number, 0.0, 0.0)]).turned_by(by)
    };
    let system = System::new(vec![body(1.0, 0.1, 0.0); 2], vec![shaft("first", 0, 1.0), shaft("second", 1, 3.0)]);
    let system = system.unwrap().with_couplings(vec![Coupling::gear("gear", [0, 1], 2.0)]).unwrap();
    let states = [0.0, 1.0].map(|x| state(Vector3::x() * x, Vector3::zeros())).to_vec();
    let failed = to_end(&mut run(system, states, 1e-6, 1.0).unwrap());
    let Err(StepError::Open { joints, .. }) = failed else { panic!("{failed:?}") };
    assert_eq!(&*joints, "\"first\", \"second\", \"gear\"");
}

/// Closed form: an arm whose drive begins at half a turn, or beyond a full one, begins there, and its turn counts it.
#[test]
fn drives_begin_where_they_say() {
    for from in [PI, 7.0, -2.0] {
        let joint = Joint::revolute("hinge", [ground(0.0, 0.0), on(0, -1.0, 0.0)]).turned_by(steady(from));
        let system = System::new(vec![body(1.0, 0.1, 0.0)], vec![joint]).unwrap();
        let mut simulation = run(system, vec![state(Vector3::x(), Vector3::zeros())], 1e-6, 1.0).unwrap();
        let at = simulation.system_motion().unwrap().state(0).unwrap().origin_global;
        assert!((at - Vector3::new(from.cos(), 0.0, -from.sin())).norm() < 1e-12, "{from}: {at}");
        to_end(&mut simulation).unwrap();
        let turn = simulation.system_motion().unwrap().joint_coordinates(0).turn;
        assert!((turn - from - 1.0).abs() < 1e-9, "{from}: {turn}");
    }
}

/// Conserved: markers that are almost opposite to each other meet as they are meant, not turned round.
#[test]
fn markers_that_are_far_from_each_other_meet() {
    let axes = Matrix3::identity();
    let at = Marker::on_rigid(0, Vector3::new(0.3, 0.1, 0.0), axes);
    for turn in [Vector3::new(3.0, 0.0, 0.0), Vector3::new(0.5, 2.4, -1.0), Vector3::new(1.8, -1.8, 0.3)] {
        for joint in [
            Joint::fixed("weld", [Marker::on_ground(Vector3::zeros(), axes), at.clone()]),
            Joint::revolute("hinge", [Marker::on_ground(Vector3::zeros(), axes), at.clone()]),
        ] {
            let is_weld = joint.row_count() == 6;
            let system = System::new(vec![body(1.0, 0.1, 0.0)], vec![joint]).unwrap();
            let mut motion = SystemMotion::new(system, &[state(Vector3::new(2.0, -1.0, 0.5), turn)]).unwrap();
            let left = motion.assemble().unwrap();
            let attitude = motion.state(0).unwrap().attitude.global_to_body();
            assert!(left[0] < 1e-12 && attitude[(2, 2)] > 1.0 - 1e-9, "{left:?} {attitude}");
            assert!(!is_weld || (attitude - axes).norm() < 1e-9, "{attitude}");
        }
    }
}

/// Closed form: a flat parallelogram, driven at one crank, can begin as a parallelogram or as its mirror, ω₂ = 1 or −3.
#[test]
fn a_flat_parallelogram_tells_its_branches() {
    for (omega, on_branch, other) in [(0.0, 1.0, -3.0), (-3.0, -3.0, 1.0)] {
        let joints = vec![
            Joint::revolute("a", [ground(0.0, 0.0), on(0, -0.5, 0.0)]).turned_by(steady(0.0)),
            Joint::revolute("d", [ground(2.0, 0.0), on(1, -0.5, 0.0)]),
            Joint::revolute("b", [on(0, 0.5, 0.0), on(2, -1.0, 0.0)]),
            Joint::revolute("c", [on(1, 0.5, 0.0), on(2, 1.0, 0.0)]),
        ];
        let mut states = [0.5, 2.5, 2.0].map(|x| state(Vector3::x() * x, Vector3::zeros())).to_vec();
        states[1].omega_body = Vector3::y() * omega;
        states[1].velocity_global = -Vector3::z() * (0.5 * omega);
        let system = System::new(vec![body(1.0, 0.1, 0.0), body(1.0, 0.1, 0.0), body(2.0, 0.7, 0.0)], joints).unwrap();
        let mut simulation = run(system, states, 1e-7, 0.5).unwrap();
        let branching = simulation.system().unwrap().branching().expect("two branches");
        let (_, rates) = branching.joints.iter().find(|(joint, _)| joint == "d").expect("the second crank");
        assert!((rates[0] - on_branch).abs() < 1e-4 && (rates[1] - other).abs() < 1e-4, "{rates:?}");
        to_end(&mut simulation).unwrap();
        assert!(simulation.system().unwrap().largest_residual() < 1e-9);
        let turn = simulation.system_motion().unwrap().joint_coordinates(1).turn;
        assert!((turn - 0.5).abs() < 1e-6 || on_branch < 0.0 && turn < 0.0, "{turn}");
    }
}

/// A platform on two legs that fold at right angles to each other (Sarrus), each of two links.
fn folding_platform(gravity: f64) -> (System, Vec<MotionState>) {
    let (length, half_angle) = (0.4, 0.7_f64);
    let bar = Vector3::new(length * half_angle.cos(), 0.0, length * half_angle.sin());
    let height = 2.0 * bar.z;
    let (mut joints, mut bodies, mut states) = (Vec::new(), vec![body(1.0, 0.01, gravity)], Vec::new());
    states.push(state(Vector3::z() * height, Vector3::zeros()));
    for leg in 0..2 {
        let turned = nalgebra::Rotation3::from_axis_angle(&Vector3::z_axis(), 0.5 * PI * leg as f64);
        let axes = turned.matrix() * about_y();
        let place = |radial: f64, z: f64| turned * Vector3::new(radial, 0.0, z);
        let (lower, upper) = (bodies.len(), bodies.len() + 1);
        let [foot, knee, top] = [place(0.3, 0.0), place(0.3 + bar.x, bar.z), place(0.3, height)];
        for (ends, number) in [([foot, knee], lower), ([knee, top], upper)] {
            bodies.push(body(0.5, 0.007, gravity));
            states.push(state((ends[0] + ends[1]) / 2.0, Vector3::zeros()));
            assert_eq!(bodies.len() - 1, number);
        }
        let marker = |body: usize, at: Vector3<f64>| Marker::on_rigid(body, at - states[body].origin_global, axes);
        joints.push(Joint::revolute(&format!("foot{leg}"), [Marker::on_ground(foot, axes), marker(lower, foot)]));
        joints.push(Joint::revolute(&format!("knee{leg}"), [marker(lower, knee), marker(upper, knee)]));
        joints.push(Joint::revolute(&format!("top{leg}"), [marker(upper, top), marker(0, top)]));
    }
    (System::new(bodies, joints).unwrap(), states)
}

/// Conserved: a platform on folding legs falls straight down through its flat position, at any tolerance, and keeps its energy; so does
/// each of its bodies, by what its joints do to it.
#[test]
fn a_platform_falls_through_its_flat_position() {
    let (system, states) = folding_platform(GRAVITY);
    for tolerance in [1e-2, 1e-4, 1e-6, 1e-8] {
        let mut simulation = run(system.clone(), states.clone(), tolerance, 0.6).unwrap();
        assert_eq!(simulation.system().unwrap().rigid_dofs(), 1);
        to_end(&mut simulation).unwrap();
        let at = simulation.system_motion().unwrap().state(0).unwrap().origin_global;
        let steps = simulation.stats().accepted;
        println!(
            "{tolerance:e}: {steps} steps, {at:?}, residual {:e}",
            simulation.system().unwrap().largest_residual()
        );
        // What joints pass from one body to another has no part in the energy of all.
        assert!(
            simulation.energies(0).open_together.unwrap() < 1e-2 * simulation.energies(0).exchanged,
            "{:e}",
            simulation.energies(0).open_together.unwrap()
        );
        assert!(at.z < -0.1 && at.x.abs() < 1e-5 && at.y.abs() < 1e-5, "{tolerance:e}: {at}");
        assert!(steps < 500 && simulation.system().unwrap().largest_residual() < 1e-9, "{steps}");
    }
}

/// Closed form: nothing moves what is at rest without a force, at any tolerance, though its joints round.
#[test]
fn a_platform_without_weight_rests() {
    let (system, states) = folding_platform(0.0);
    for tolerance in [1e-3, 1e-6, 1e-9] {
        let mut simulation = run(system.clone(), states.clone(), tolerance, 0.6).unwrap();
        to_end(&mut simulation).unwrap();
        assert!(simulation.stats().accepted < 30, "{tolerance:e}: {} steps", simulation.stats().accepted);
        for (body, start) in states.iter().enumerate() {
            let moved = simulation.system_motion().unwrap().state(body).unwrap().origin_global - start.origin_global;
            assert!(moved.norm() < 1e-14, "{tolerance:e}: {moved}");
        }
    }
}

/// Conserved and by symmetry: what two hinges of one door bear does not depend on its inertia or on their order, and each bears half of
/// its weight.
#[test]
fn two_hinges_share_a_door_by_geometry() {
    let axes = Matrix3::identity();
    let bears = |inertia: f64, is_upper_first: bool| -> [Vector3<f64>; 2] {
        let hinge = |z: f64| {
            let ends = [
                Marker::on_ground(Vector3::z() * z, axes),
                Marker::on_rigid(0, Vector3::new(-0.5, 0.0, z - 0.5), axes),
            ];
            Joint::revolute(if z > 0.0 { "upper" } else { "lower" }, ends)
        };
        let mut joints = vec![hinge(0.0), hinge(1.0)];
        if is_upper_first {
            joints.reverse();
        }
        let system = System::new(vec![body(2.0, inertia, GRAVITY)], joints).unwrap();
        let mut simulation =
            run(system, vec![state(Vector3::new(0.5, 0.0, 0.5), Vector3::zeros())], 1e-6, 1.0).unwrap();
        assert_eq!((simulation.system().unwrap().rigid_dofs(), simulation.system().unwrap().redundant().len()), (1, 1));
        let seen = simulation.system_observation().unwrap();
        let mut forces: Vec<_> = seen.joints.iter().map(|joint| joint.reaction_global.force_global).collect();
        if is_upper_first {
            forces.reverse();
        }
        [forces[0], forces[1]]
    };
    let first = bears(0.1, false);
    assert!(first.iter().all(|force| (force.z - GRAVITY).abs() < 1e-9), "{first:?}");
    for other in [bears(1.0, false), bears(0.1, true)] {
        let off = [0, 1].map(|k| (other[k] - first[k]).norm());
        assert!(off.iter().all(|off| *off < 1e-9), "{first:?} {other:?}");
    }
}
