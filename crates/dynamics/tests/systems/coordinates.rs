//! Coordinates of joints, the forces along them, and couplings.

use std::f64::consts::PI;
use std::sync::Arc;

use dynamics::{
    ConservativeBody, Coordinate, Coupling, Expression, Friction, History, Joint, JointDrive, JointForce, JointLawFn,
    Marker, MotionState, Observation, Physics, PointSpring, Reached, Rows, Simulation, Start, StepControl, StepError,
    Stops, System, SystemMotion, SystemScheme, SystemSetup,
};
use nalgebra::{Matrix3, Vector3};
use reduced_body::{ReducedBody, RigidMotion};
use rigid_kin::Attitude;

/// Mass and moment of inertia about z of each body.
const MASS: f64 = 2.0;
const INERTIA: f64 = 0.4;

fn bodies(count: usize) -> Vec<ConservativeBody> {
    let inertia = Matrix3::from_diagonal(&Vector3::new(0.2, 0.3, INERTIA));
    let reduced = ReducedBody::rigid(MASS, Vector3::zeros(), inertia, RigidMotion::free()).unwrap();
    vec![ConservativeBody::new(&reduced, &[], Vec::new(), &Physics::default()).unwrap(); count]
}

/// A body at x with a velocity along z and an angular velocity about it.
fn at(x: f64, velocity: f64, omega: f64) -> MotionState {
    MotionState {
        time: 0.0,
        attitude: Attitude::identity(),
        origin_global: Vector3::new(x, 0.0, 0.0),
        velocity_global: Vector3::new(0.0, 0.0, velocity),
        omega_body: Vector3::new(0.0, 0.0, omega),
        modal_displacement: Vec::new(),
        modal_velocity: Vec::new(),
    }
}

fn ground(x: f64) -> Marker {
    Marker::on_ground(Vector3::new(x, 0.0, 0.0), Matrix3::identity())
}

fn on(body: usize, x: f64) -> Marker {
    Marker::on_rigid(body, Vector3::new(x, 0.0, 0.0), Matrix3::identity())
}

/// One body on a hinge or a slide to the ground.
fn lone(
    joint: fn(&str, [Marker; 2]) -> Joint,
    along: Coordinate,
    force: JointForce,
    state: MotionState,
) -> SystemMotion {
    let joint = joint("joint", [ground(0.0), on(0, 0.0)]).with_force(along, force);
    SystemMotion::new(System::new(bodies(1), vec![joint]).unwrap(), &[state]).unwrap()
}

fn constant(amplitude: f64) -> JointDrive {
    JointDrive { amplitude, history: History::Constant }
}

/// Energy less all work.
fn imbalance(motion: &SystemMotion, energy: f64) -> f64 {
    (motion.energy().unwrap() - energy - motion.element_work() - motion.drive_work()).abs()
}

/// Closed form: a free rotor turns evenly, and its full turns are counted, whatever the step.
#[test]
fn full_turns_are_counted() {
    let mut motion = lone(Joint::revolute, Coordinate::Turn, JointForce::default(), at(0.0, 0.0, -9.0));
    assert!((motion.joint_coordinates(0).turn_rate + 9.0).abs() < 1e-14);
    motion.advance(5.0, 1e-6, &mut 1e-2).unwrap();
    let found = motion.joint_coordinates(0);
    assert!((found.turn + 45.0).abs() < 1e-10 && (found.turn_rate + 9.0).abs() < 1e-11, "{found:?}");
}

/// Closed form: a motor turns a rotor from rest by more than half a turn within one step, by each scheme.
#[test]
fn a_step_that_begins_at_rest_loses_no_turn() {
    for scheme in [SystemScheme::Radau, SystemScheme::Gauss, SystemScheme::Rkmk4] {
        let force = JointForce { motor: Some(constant(8.0 * INERTIA)), ..JointForce::default() };
        let motion = lone(Joint::revolute, Coordinate::Turn, force, at(0.0, 0.0, 0.0));
        let mut motion = motion.with_scheme(scheme);
        motion.try_step(1.0, 1.0, 1e-9, f64::INFINITY).unwrap();
        let found = motion.joint_coordinates(0);
        assert!((found.turn - 4.0).abs() < 1e-9 && (motion.time() - 1.0).abs() < 1e-12, "{scheme:?}: {found:?}");
    }
}

/// Closed form: motors turn a carrier about y, and a rotor of equal moments of inertia about the axis z of the carrier. The body
/// of the carrier is as round, so each axis turns alone: by 20 and 28 rad from rest.
#[test]
fn turns_about_two_axes_at_once_are_counted() {
    let round = Matrix3::identity() * INERTIA;
    let reduced = ReducedBody::rigid(MASS, Vector3::zeros(), round, RigidMotion::free()).unwrap();
    let bodies = vec![ConservativeBody::new(&reduced, &[], Vec::new(), &Physics::default()).unwrap(); 2];
    let y = Matrix3::new(0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 1.0, 0.0, 0.0);
    let motor = |moment: f64| JointForce { motor: Some(constant(moment)), ..JointForce::default() };
    let carrier =
        Joint::revolute("carrier", [Marker::on_ground(Vector3::zeros(), y), Marker::on_rigid(0, Vector3::zeros(), y)]);
    let joints = vec![
        carrier.with_force(Coordinate::Turn, motor(10.0 * 2.0 * INERTIA)),
        Joint::revolute("rotor", [on(0, 0.0), on(1, 0.0)]).with_force(Coordinate::Turn, motor(14.0 * INERTIA)),
    ];
    let mut motion =
        SystemMotion::new(System::new(bodies, joints).unwrap(), &[at(0.0, 0.0, 0.0), at(0.0, 0.0, 0.0)]).unwrap();
    motion.advance(2.0, 1e-6, &mut 0.5).unwrap();
    let found = [0, 1].map(|joint| motion.joint_coordinates(joint).turn);
    assert!((found[0] - 20.0).abs() < 1e-4 && (found[1] - 28.0).abs() < 1e-4, "{found:?}");
}

/// Closed form: a torsion spring swings by more than half a turn to both sides, with √(k/J).
#[test]
fn a_torsion_spring_knows_full_turns() {
    let force = JointForce { stiffness: 3.0, ..JointForce::default() };
    let omega = f64::sqrt(3.0 / INERTIA);
    let mut motion = lone(Joint::revolute, Coordinate::Turn, force, at(0.0, 0.0, 5.0 * omega));
    for end in [0.3, 0.55, 1.2, 2.1] {
        motion.advance(end, 1e-9, &mut 1e-3).unwrap();
        let found = motion.joint_coordinates(0).turn;
        assert!((found - 5.0 * (omega * end).sin()).abs() < 1e-7, "{end}: {found}");
    }
}

/// Closed form: a mass slides on a damped spring about the length at which the preload holds the spring.
#[test]
fn a_slide_spring_with_a_preload_and_a_damper_swings_in_closed_form() {
    let (k, c, preload) = (50.0, 1.5, 4.0);
    let force = JointForce { stiffness: k, damping: c, preload, free: 0.3, ..JointForce::default() };
    let mut motion = lone(Joint::prismatic, Coordinate::Slide, force, at(0.0, 0.0, 0.0));
    let (end, mean) = (1.7, 0.3 + preload / k);
    motion.advance(end, 1e-9, &mut 1e-3).unwrap();
    let delta = 0.5 * c / MASS;
    let omega = f64::sqrt(k / MASS - delta * delta);
    let expected = mean * (1.0 - (-delta * end).exp() * ((omega * end).cos() + delta / omega * (omega * end).sin()));
    let found = motion.joint_coordinates(0);
    assert!((found.slide - expected).abs() < 1e-8, "{found:?} {expected}");
    let work = motion.joint_work(0);
    let spring = preload * found.slide - 0.5 * k * ((found.slide - 0.3).powi(2) - 0.09);
    assert!((work.spring - spring).abs() < 1e-6 && work.loss > 0.1, "{work:?} {spring}");
    assert!(imbalance(&motion, 0.0) < 1e-7);
}

/// Closed form: between stops a hinge and a slide move evenly, and stops without damping throw them back as fast as they came.
#[test]
fn stops_throw_back() {
    for (joint, along, state, inertia) in [
        (Joint::revolute as fn(&str, [Marker; 2]) -> Joint, Coordinate::Turn, at(0.0, 0.0, 2.0), INERTIA),
        (Joint::prismatic, Coordinate::Slide, at(0.0, 2.0, 0.0), MASS),
    ] {
        let stops = Stops { limits: [-0.5, 0.5], stiffness: 1e4 * inertia, damping: 0.0 };
        let mut motion = lone(joint, along, JointForce { stops: Some(stops), ..JointForce::default() }, state);
        // Half a period of the spring of the stop.
        let touch = PI * 1e-2;
        motion.advance(0.25 + touch + 0.25, 1e-7, &mut 1e-3).unwrap();
        let found = motion.joint_coordinates(0);
        let [coordinate, rate] = match along {
            Coordinate::Turn => [found.turn, found.turn_rate],
            Coordinate::Slide => [found.slide, found.slide_rate],
        };
        assert!(coordinate.abs() < 5e-4 && (rate + 2.0).abs() < 5e-4, "{found:?}");
        assert!(motion.element_work().abs() < 1e-3 * motion.energy().unwrap(), "{}", motion.element_work());
    }
}

/// Conserved: the energy of a rotor that bounces fifteen times between stops without damping, by each scheme at a rough tolerance. What is
/// missing is told by the works: that of the springs is what their energy has changed by, which is nothing between the stops.
#[test]
fn bouncing_between_stops_keeps_the_energy() {
    for scheme in SystemScheme::ALL {
        let stops = Stops { limits: [-1.0, 1.0], stiffness: 1e6, damping: 0.0 };
        let force = JointForce { stops: Some(stops), ..JointForce::default() };
        let motion = lone(Joint::revolute, Coordinate::Turn, force, at(0.0, 0.0, 3.0));
        let (mut motion, energy) = (motion.with_scheme(scheme), 0.5 * INERTIA * 9.0);
        let steps = motion.advance(10.0, 1e-4, &mut 1e-2).unwrap();
        let (now, work) = (motion.energy().unwrap(), motion.element_work());
        println!(
            "{scheme:?}: {:.1e} of the energy in {steps} steps, {} evaluations",
            now / energy - 1.0,
            motion.evaluations()
        );
        assert!((now / energy - 1.0).abs() < 5e-3, "{scheme:?}: {now} of {energy}");
        assert!(work.abs() < 1e-12 * energy && motion.joint_coordinates(0).turn.abs() < 1.0, "{scheme:?}: {work}");
    }
}

/// Conserved: the energy of the same rotor with a characteristic −20 x³ beside its stops, by each scheme. What the characteristic holds is
/// added in closed form.
#[test]
fn bouncing_with_a_characteristic_keeps_the_energy() {
    for scheme in SystemScheme::ALL {
        let stops = Stops { limits: [-1.0, 1.0], stiffness: 1e6, damping: 0.0 };
        let history = History::Expression(Expression::new("-t^3", Vec::new()).unwrap());
        let characteristic = Some(JointDrive { amplitude: 0.2, history });
        let force = JointForce { stops: Some(stops), characteristic, ..JointForce::default() };
        let motion = lone(Joint::revolute, Coordinate::Turn, force, at(0.0, 0.0, 3.0));
        let (mut motion, energy) = (motion.with_scheme(scheme), 0.5 * INERTIA * 9.0);
        let steps = motion.advance(10.0, 1e-4, &mut 1e-2).unwrap();
        let found = motion.joint_coordinates(0);
        let now = motion.energy().unwrap() + 0.05 * found.turn.powi(4);
        println!("{scheme:?}: {:.1e} of the energy in {steps} steps", now / energy - 1.0);
        assert!((now / energy - 1.0).abs() < 5e-3, "{scheme:?}: {now} of {energy}");
        // What the bounces have made or lost is in the balance.
        let open = imbalance(&motion, energy);
        assert!((open - (now - energy).abs()).abs() < 3e-4 * energy, "{scheme:?}: {open}");
    }
}

/// Closed form: a fixed step of about the touch, π √(J/k), cannot be solved; the message names the joint and says how long a touch lasts, and
/// a quarter of that works.
#[test]
fn a_fixed_step_longer_than_a_touch_says_so() {
    let stops = Stops { limits: [-1.0, 1.0], stiffness: 1e6, damping: 0.0 };
    let force = JointForce { stops: Some(stops), ..JointForce::default() };
    let joint = Joint::revolute("door", [ground(0.0), on(0, 0.0)]).with_force(Coordinate::Turn, force);
    let system = System::new(bodies(1), vec![joint]).unwrap();
    let run = |step: f64| {
        let mut simulation = Simulation::of_system(SystemSetup {
            system: system.clone(),
            states: vec![at(0.0, 0.0, 3.0)],
            start: Start::AsPlaced,
            scheme: SystemScheme::Radau,
            control: StepControl::Fixed(step),
            end: 1.0,
            rows: Rows::EverySteps(1),
            points: vec![Vec::new()],
        })
        .unwrap();
        while simulation.advance(1000)? != Reached::End {}
        Ok::<_, StepError>(())
    };
    let touch = PI * f64::sqrt(INERTIA / 1e6);
    let failed = run(2.0 * touch).unwrap_err();
    let StepError::Stops { joints, contact, .. } = &failed else { panic!("{failed}") };
    assert!(&**joints == "\"door\"" && (contact / touch - 1.0).abs() < 1e-9, "{failed}");
    run(0.25 * touch).unwrap();
}

/// Closed form: a wheel at rest on which nothing acts begins to turn as its drive does, however gently that begins.
#[test]
fn a_drive_begins_from_rest() {
    for (formula, angle, rate) in
        [("t^2", 2.25, 3.0), ("t^3", 3.375, 6.75), ("t - sin(t)", 1.5 - f64::sin(1.5), 1.0 - f64::cos(1.5))]
    {
        let history = History::Expression(Expression::new(formula, Vec::new()).unwrap());
        for (scheme, tolerance) in
            [(SystemScheme::Radau, 1e-3), (SystemScheme::Radau, 1e-8), (SystemScheme::Gauss, 1e-6)]
        {
            let drive = JointDrive { amplitude: 1.0, history: history.clone() };
            let joint = Joint::revolute("hinge", [ground(0.0), on(0, 0.0)]).turned_by(drive);
            let system = System::new(bodies(1), vec![joint]).unwrap();
            let mut motion = SystemMotion::new(system, &[at(0.0, 0.0, 0.0)]).unwrap().with_scheme(scheme);
            let steps = motion.advance(1.5, tolerance, &mut 1e-4).unwrap();
            let found = motion.joint_coordinates(0);
            assert!(
                (found.turn - angle).abs() < 1e-10 && (found.turn_rate - rate).abs() < 1e-9,
                "{formula}: {found:?}"
            );
            assert!(steps < 500, "{formula}: {steps} steps");
        }
    }
}

/// Closed form: dry friction takes v²/2a and all of the energy.
#[test]
fn friction_brings_to_rest() {
    let (force, speed) = (6.0, 3.0);
    let friction = Some(Friction { force, rate_scale: 1e-4 });
    let start = at(0.0, speed, 0.0);
    let mut motion = lone(Joint::prismatic, Coordinate::Slide, JointForce { friction, ..JointForce::default() }, start);
    let energy = motion.energy().unwrap();
    motion.advance(2.0, 1e-7, &mut 1e-3).unwrap();
    let found = motion.joint_coordinates(0);
    let expected = 0.5 * MASS * speed * speed / force;
    assert!((found.slide - expected).abs() < 1e-4 && found.slide_rate.abs() < 1e-4, "{found:?} {expected}");
    let loss = motion.joint_work(0).loss;
    assert!((loss / energy - 1.0).abs() < 1e-5, "{loss} {energy}");
}

/// Closed form: a motor gives M/J and its work.
#[test]
fn a_motor_turns_a_rotor() {
    let moment = 1.4;
    let force = JointForce { motor: Some(constant(moment)), ..JointForce::default() };
    let mut motion = lone(Joint::revolute, Coordinate::Turn, force, at(0.0, 0.0, 0.0));
    motion.advance(2.0, 1e-7, &mut 1e-3).unwrap();
    let found = motion.joint_coordinates(0);
    assert!((found.turn - 2.0 * moment / INERTIA).abs() < 1e-9, "{found:?}");
    assert!((motion.joint_work(0).drive - moment * found.turn).abs() < 1e-9);
    motion.find_reactions().unwrap();
    assert!((motion.drive_power(0) - moment * found.turn_rate).abs() < 1e-9);
    assert!(imbalance(&motion, 0.0) < 1e-9);
}

/// Closed form: the power of a drive that swings a rotor, J φ'' φ'.
#[test]
fn a_drive_has_the_power_of_its_rotor() {
    let history = History::Sine { frequency: 0.5, phase: 0.0, start: -1.0, duration: None };
    let drive = JointDrive { amplitude: 0.7, history };
    let joint = Joint::revolute("joint", [ground(0.0), on(0, 0.0)]).turned_by(drive);
    let system = System::new(bodies(1), vec![joint]).unwrap();
    let mut motion = SystemMotion::new(system, &[at(0.0, 0.0, -0.7 * PI)]).unwrap();
    motion.assemble().unwrap();
    motion.advance(0.3, 1e-9, &mut 1e-3).unwrap();
    motion.find_reactions().unwrap();
    let (sine, cosine) = (PI * 1.3).sin_cos();
    let expected = -INERTIA * 0.49 * PI.powi(3) * sine * cosine;
    assert!((motion.drive_power(0) / expected - 1.0).abs() < 1e-5, "{} {expected}", motion.drive_power(0));
}

/// Conserved: the energy of a mass on a spring whose force is a formula, −20 x³.
#[test]
fn a_formula_is_a_spring() {
    let history = History::Expression(Expression::new("-t^3", Vec::new()).unwrap());
    let characteristic = Some(JointDrive { amplitude: 20.0, history });
    let force = JointForce { characteristic, ..JointForce::default() };
    let mut motion = lone(Joint::prismatic, Coordinate::Slide, force, at(0.0, 1.5, 0.0));
    motion.advance(1.9, 1e-8, &mut 1e-3).unwrap();
    let found = motion.joint_coordinates(0);
    let energy = 0.5 * MASS * found.slide_rate.powi(2) + 5.0 * found.slide.powi(4);
    assert!((energy - 0.5 * MASS * 2.25).abs() < 1e-6 && found.slide.abs() > 0.1, "{found:?}");
}

/// Two bodies on joints to the ground, a metre apart.
fn pair(joints: [fn(&str, [Marker; 2]) -> Joint; 2], coupling: Coupling) -> SystemMotion {
    let motor = JointForce { motor: Some(constant(1.4)), ..JointForce::default() };
    let joints = vec![
        joints[0]("first", [ground(0.0), on(0, 0.0)]).with_force(Coordinate::Turn, motor),
        joints[1]("second", [ground(1.0), on(1, 0.0)]),
    ];
    let system = System::new(bodies(2), joints).unwrap().with_couplings(vec![coupling]).unwrap();
    SystemMotion::new(system, &[at(0.0, 0.0, 0.0), at(1.0, 0.0, 0.0)]).unwrap()
}

/// Closed form: of two geared wheels the second has J r² at the first; turns by many full turns.
#[test]
fn gears_turn_together() {
    let ratio = -2.5;
    let mut motion = pair([Joint::revolute, Joint::revolute], Coupling::gear("gear", [1, 0], ratio));
    motion.advance(6.0, 1e-7, &mut 1e-3).unwrap();
    let [first, second] = [0, 1].map(|joint| motion.joint_coordinates(joint).turn);
    let expected = 0.5 * 36.0 * 1.4 / (INERTIA * (1.0 + ratio * ratio));
    assert!((first / expected - 1.0).abs() < 1e-9 && expected > 8.0, "{first} {expected}");
    assert!((second - ratio * first).abs() < 1e-11, "{second} {first}");
    // What the gear puts on the second wheel.
    motion.find_reactions().unwrap();
    let moment = INERTIA * ratio * 1.4 / (INERTIA * (1.0 + ratio * ratio));
    assert!((motion.coupling_force(0) / moment - 1.0).abs() < 1e-9, "{} {moment}", motion.coupling_force(0));
    let seen = motion.observe_joint(1).turn_effort;
    assert!((seen / moment - 1.0).abs() < 1e-9, "{seen} {moment}");
    assert_eq!(motion.dependent_rows(), 0);
}

/// Closed form: the mass that a wheel moves by a rack is m r² at the wheel.
#[test]
fn a_rack_slides_with_its_wheel() {
    let radius = 0.3;
    let mut motion = pair([Joint::revolute, Joint::prismatic], Coupling::rack("rack", [0, 1], radius));
    motion.advance(3.0, 1e-7, &mut 1e-3).unwrap();
    let turn = motion.joint_coordinates(0).turn;
    let expected = 0.5 * 9.0 * 1.4 / (INERTIA + MASS * radius * radius);
    assert!((turn / expected - 1.0).abs() < 1e-9, "{turn} {expected}");
    assert!((motion.joint_coordinates(1).slide - radius * turn).abs() < 1e-11);
}

/// Closed form: a nut that is thrown along its screw turns with it, and keeps its energy.
#[test]
fn a_screw_turns_as_it_slides() {
    let lead = 0.2;
    let joint = Joint::cylindrical("screw", [ground(0.0), on(0, 0.0)]);
    let system = System::new(bodies(1), vec![joint]).unwrap();
    let system = system.with_couplings(vec![Coupling::screw("thread", 0, lead)]).unwrap();
    let spin = 2.0 * PI / lead * 1.5;
    let mut motion = SystemMotion::new(system, &[at(0.0, 1.5, spin)]).unwrap();
    motion.advance(1.0, 1e-7, &mut 1e-3).unwrap();
    let found = motion.joint_coordinates(0);
    assert!((found.slide - 1.5).abs() < 1e-10 && (found.turn - spin).abs() < 1e-9, "{found:?}");
}

/// Conserved: the momenta of a free gear of three bodies to rounding, its energy to the tolerance.
#[test]
fn a_free_gear_keeps_its_momenta() {
    // The first carries the others.
    let joints =
        vec![Joint::revolute("first", [on(0, -1.0), on(1, 0.0)]), Joint::revolute("second", [on(0, 1.0), on(2, 0.0)])];
    let system = System::new(bodies(3), joints).unwrap();
    let system = system.with_couplings(vec![Coupling::gear("gear", [0, 1], -2.0)]).unwrap();
    let tumbling = MotionState { omega_body: Vector3::new(0.5, -0.4, 1.0), ..at(0.0, 0.1, 0.0) };
    let mut motion = SystemMotion::new(system, &[tumbling, at(-1.0, 0.0, 6.0), at(1.0, 0.0, 0.0)]).unwrap();
    motion.assemble().unwrap();
    let (momenta, energy) = (motion.momenta(), motion.energy().unwrap());
    motion.advance(3.0, 1e-7, &mut 1e-3).unwrap();
    let drift: Vec<f64> = motion.momenta().iter().zip(momenta).map(|(now, start)| (now - start).norm()).collect();
    assert!(drift.iter().all(|drift| *drift < 1e-13), "{drift:?}");
    assert!((motion.energy().unwrap() / energy - 1.0).abs() < 1e-6);
    assert!(motion.joint_coordinates(0).turn.abs() > PI);
}

/// Closed form: what is not locked moves: a body that is held along x and about x only.
#[test]
fn a_joint_locks_what_it_is_told() {
    let joint = Joint::locked("rail", [ground(0.0), on(0, 0.0)], [true, false, false], [true, false, false]);
    let system = System::new(bodies(1), vec![joint]).unwrap();
    let state = MotionState {
        velocity_global: Vector3::new(3.0, 2.0, 1.0),
        omega_body: Vector3::new(0.7, 0.0, 0.9),
        ..at(0.0, 0.0, 0.0)
    };
    let mut motion = SystemMotion::new(system, &[state]).unwrap();
    motion.assemble().unwrap();
    motion.advance(1.0, 1e-8, &mut 1e-3).unwrap();
    let now = motion.state(0).unwrap();
    assert!((now.origin_global - Vector3::new(0.0, 2.0, 1.0)).norm() < 1e-12, "{now:?}");
    assert!((now.omega_body - Vector3::new(0.0, 0.0, 0.9)).norm() < 1e-9, "{now:?}");
}

/// Closed form: a PD controller from a closure is a spring and a damper about the angle that it holds, however stiff; the work of the
/// controller closes the balance.
#[test]
fn a_controller_from_outside_moves_a_joint_in_closed_form() {
    for (k, c) in [(3.0, 0.4), (3e5, 40.0)] {
        let bodies = bodies(1);
        let system = System::new(bodies, vec![Joint::revolute("hinge", [ground(0.0), on(0, 0.0)])]).unwrap();
        let law = JointLawFn::new("PD", move |_, angle, rate| k * (0.5 - angle) - c * rate);
        assert!(
            system.clone().with_law(1, Coordinate::Turn, Arc::new(JointLawFn::new("none", |_, _, _| 0.0))).is_err()
        );
        let system = system.with_law(0, Coordinate::Turn, Arc::new(law)).unwrap();
        let mut motion = SystemMotion::new(system, &[at(0.0, 0.0, 0.0)]).unwrap();
        let delta = 0.5 * c / INERTIA;
        let omega = f64::sqrt(k / INERTIA - delta * delta);
        let end = 5.0 / omega;
        let steps = motion.advance(end, 1e-8, &mut 1e-4).unwrap();
        let expected = 0.5 * (1.0 - (-delta * end).exp() * ((omega * end).cos() + delta / omega * (omega * end).sin()));
        let found = motion.joint_coordinates(0).turn;
        assert!((found - expected).abs() < 1e-6 && steps < 200, "{found} {expected} in {steps} steps");
        assert!(motion.joint_work(0).drive > 0.0 && imbalance(&motion, 0.0) < 1e-6 * k);
    }
}

/// Conserved: the forces on all markers of a body add up to its mass times its acceleration, and their moments to the rate of its spin: of
/// wheels on hinges with a wound-up spring, a gear between them, and a spring from one to the other.
#[test]
fn forces_on_markers_move_their_bodies() {
    let (stiffness, ratio) = (3.0, -2.0);
    let wound_up = JointForce { stiffness, ..JointForce::default() };
    let joints = vec![
        Joint::revolute("first", [ground(0.0), on(0, 0.0)]).with_force(Coordinate::Turn, wound_up),
        Joint::revolute("second", [ground(2.0), on(1, 0.0)]),
    ];
    let across = PointSpring { markers: [on(0, 0.0), on(1, 0.0)], stiffness: 40.0, damping: 1.0, free_length: 1.0 };
    let system = System::new(bodies(2), joints).unwrap();
    let system = system.with_couplings(vec![Coupling::gear("gear", [0, 1], ratio)]).unwrap();
    let system = system.with_elements(vec![Arc::new(across)]).unwrap();
    let states = [at(0.0, 0.0, 1.0), at(2.0, 0.0, 1.0 / ratio)];
    for turn in [0.0, 2.0 * PI, -6.0 * PI] {
        let mut motion = SystemMotion::new(system.clone(), &states).unwrap().with_turns(&[turn, 0.0]);
        motion.find_reactions().unwrap();
        let mut sums = [[Vector3::<f64>::zeros(); 2]; 2];
        let (mut count, mut largest) = (0, 0.0_f64);
        motion.each_wrench(|marker, wrench| {
            count += 1;
            largest = largest.max(wrench.force_global.norm());
            let [force, moment] = &mut sums[marker.body().unwrap()];
            *force += wrench.force_global;
            *moment += wrench.moment_global;
        });
        // Five rows of each hinge, the gear on both wheels, the spring of the hinge, both ends of the spring.
        assert_eq!(count, 5 + 5 + 2 + 1 + 2);
        assert!((largest - 40.0).abs() < 1e-9, "{largest}");
        for (body, [force, moment]) in sums.iter().enumerate() {
            let mut seen = Observation::new(0, 0);
            motion.observe(body, &[], &mut seen).unwrap();
            assert!((force - seen.origin_acceleration_global * MASS).norm() < 1e-7, "{force} {seen:?}");
            assert!((moment.z - INERTIA * seen.alpha_body.z).abs() < 1e-7, "{moment} {seen:?}");
        }
        // Closed form: J (1 + 1/r²) at the first wheel. With θ1 = r θ2, the gear takes J θ2'' / r of the spring's moment.
        let expected = -stiffness * turn / (1.0 + 1.0 / (ratio * ratio));
        assert!((sums[0][1].z - expected).abs() < 1e-6, "{turn}: {sums:?} {expected}");
    }
}
