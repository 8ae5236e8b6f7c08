//! Rows and events within steps.

use std::f64::consts::{FRAC_PI_2, PI};
use std::sync::{Arc, OnceLock};

use dynamics::{
    Applied, ConservativeBody, Coordinate, Crossing, Event, Friction, History, Joint, JointForce, Kinematics, LoadFn,
    Marker, MotionState, Observation, Physics, PointForce, PointShapes, Reached, Rows, Signal, Simulation, Start,
    Stats, StepControl, StepError, System, SystemObservation, SystemScheme, SystemSetup,
};
use fem_tet10::Material;
use nalgebra::{Matrix3, Vector3};
use reduced_body::{BodyPoint, ReducedBody, RigidMotion};
use rigid_kin::Attitude;

use crate::flexible::Jointed;

const END: f64 = 0.02;

/// Two halves of a bar (mm, t, s) that tumble freely, with a hinge and a spring between them.
fn pair(scheme: SystemScheme, tolerance: f64, rows: Rows) -> Simulation {
    static HALVES: OnceLock<[Jointed; 2]> = OnceLock::new();
    let aluminium = Material { young_modulus: 70_000.0, poisson_ratio: 0.33, density: 2.7e-9 };
    let [left, right] =
        HALVES.get_or_init(|| ["right", "left"].map(|patch| Jointed::new("half_bar", aluminium, 4, &[patch])));
    let friction = Some(Friction { force: 20.0, rate_scale: 5.0 });
    let spring = JointForce { stiffness: 3e3, damping: 2.0, friction, ..JointForce::default() };
    let hinge = Joint::revolute("hinge", [left.marker(0, 0), right.marker(1, 0)]).with_force(Coordinate::Turn, spring);
    let system = System::new(vec![left.conservative(), right.conservative()], vec![hinge]).unwrap();
    let omega = Vector3::new(30.0, 20.0, 50.0);
    let start = |x: f64, spin: f64, body: &Jointed| MotionState {
        velocity_global: omega.cross(&Vector3::new(x, 0.0, 0.0)),
        omega_body: omega + Vector3::z() * spin,
        ..body.at_rest(Vector3::new(200.0 + x, 0.0, 0.0), Attitude::identity())
    };
    Simulation::of_system(SystemSetup {
        system,
        states: vec![start(-100.0, 60.0, left), start(100.0, -60.0, right)],
        start: Start::Relaxed,
        scheme,
        control: StepControl::Tolerance(tolerance),
        end: END,
        rows,
        points: vec![Vec::new(), Vec::new()],
    })
    .unwrap()
}

/// The rows of a run, and its cost; with a stop at each row, steps end there.
fn rows(mut simulation: Simulation, stops: bool) -> (Vec<SystemObservation>, Stats) {
    let mut rows = vec![simulation.system_observation().unwrap()];
    loop {
        if stops {
            let next = rows.len() as f64 * INTERVAL;
            simulation.set_stop_time((next < 0.999 * END).then_some(next));
        }
        match simulation.advance_watched(u64::MAX, |_, _| ()).unwrap() {
            Reached::End => return (rows, simulation.stats()),
            Reached::Row => {
                let open = simulation.system_motion().unwrap().clone().residuals().unwrap().map(largest);
                assert!(open[0] < 1e-11 && open[1] < 1e-8, "{open:?}");
                rows.push(simulation.system_observation().unwrap());
            }
            _ => {}
        }
    }
}

fn largest(list: &[f64]) -> f64 {
    list.iter().fold(0.0, |most, number| most.max(number.abs()))
}

const INTERVAL: f64 = 1e-4;

/// Largest distance of bodies in two rows, relative to the length of the bars, and of their attitudes, rad.
fn distance(a: &SystemObservation, b: &SystemObservation) -> [f64; 2] {
    let bodies = || a.bodies.iter().zip(&b.bodies);
    let moved = bodies().map(|(a, b)| (a.origin_global - b.origin_global).norm() / 200.0);
    let turned = bodies().map(|(a, b)| a.attitude.angle_to(&b.attitude));
    [moved.fold(0.0, f64::max), turned.fold(0.0, f64::max)]
}

/// Momentum and angular momentum about the global origin of all bodies.
fn momenta(row: &SystemObservation) -> [Vector3<f64>; 2] {
    let linear = row.bodies.iter().map(|body| body.linear_momentum_global).sum();
    let about_origin =
        |body: &Observation| body.angular_momentum_global + body.position_global.cross(&body.linear_momentum_global);
    [linear, row.bodies.iter().map(about_origin).sum()]
}

/// Conserved: momenta; works and impulses, which close the balances of bodies also within steps.
#[test]
fn rows_need_no_steps_and_their_balances_close() {
    for scheme in SystemScheme::ALL {
        for tolerance in [1e-4, 1e-6] {
            let (found, stats) = rows(pair(scheme, tolerance, Rows::Interval(INTERVAL)), false);
            let (_, at_rows) = rows(pair(scheme, tolerance, Rows::Interval(INTERVAL)), true);
            assert_eq!(found.len(), 201);
            assert!((0..201).all(|k| (found[k].time - k as f64 * INTERVAL).abs() < 1e-15));
            let first = momenta(&found[0]);
            let sizes =
                found[0].bodies.iter().map(|body| (body.linear_momentum_global.norm(), body.position_global.norm()));
            let linear: f64 = sizes.clone().map(|(momentum, _)| momentum).sum();
            let scales = [linear, first[1].norm() + sizes.map(|(momentum, arm)| arm * momentum).sum::<f64>()];
            let balance = |row: &SystemObservation| row.bodies.iter().map(Observation::energy_balance).sum::<f64>();
            let [mut drift, mut energy, mut of_body] = [0.0_f64; 3];
            for row in &found {
                for ((now, first), scale) in momenta(row).iter().zip(&first).zip(scales) {
                    drift = drift.max((now - first).norm() / scale);
                }
                energy = energy.max((balance(row) - balance(&found[0])).abs() / found[0].bodies[0].energy());
                for (body, start) in row.bodies.iter().zip(&found[0].bodies) {
                    let linear = body.linear_balance_global() - start.linear_balance_global();
                    let angular = body.angular_balance_global() - start.angular_balance_global();
                    of_body = of_body.max(linear.norm() / scales[0]).max(angular.norm() / scales[1]);
                }
            }
            println!(
                "{} {tolerance:e}: {} steps for {} that end at rows; momenta {drift:e}, of a body {of_body:e}, energy {energy:e}",
                scheme.name(),
                stats.accepted,
                at_rows.accepted
            );
            // The shapes of the bars keep explicit steps shorter than the rows.
            let follows_shapes = scheme == SystemScheme::Rkmk4;
            assert!(follows_shapes || stats.accepted < at_rows.accepted, "{} {}", stats.accepted, at_rows.accepted);
            assert!(drift < 1e-13, "{drift:e}");
            assert!(of_body < tolerance, "{of_body:e}");
            assert!(energy < 100.0 * tolerance, "{energy:e}");
        }
    }
}

/// Conserved: the motion at a row, whether a step ends there or goes on beyond it.
#[test]
fn rows_within_steps_are_those_of_steps_that_end_there() {
    for scheme in SystemScheme::ALL {
        for tolerance in [1e-4, 1e-6] {
            let mut simulation = pair(scheme, tolerance, Rows::Interval(INTERVAL));
            let mut worst = [0.0_f64; 2];
            loop {
                let before = simulation.clone();
                if simulation.advance_watched(u64::MAX, |_, _| ()).unwrap() == Reached::End {
                    break;
                }
                let now = simulation.system_observation().unwrap();
                let mut alone = before;
                alone.set_stop_time(Some(now.time));
                while alone.advance_watched(1, |_, _| ()).unwrap() != Reached::Stop {}
                let apart = distance(&now, &alone.system_observation().unwrap());
                worst = [0, 1].map(|k| worst[k].max(apart[k]));
            }
            println!("{} {tolerance:e}: {worst:?}", scheme.name());
            // The bars ring, and turn about their thin axis by that.
            assert!(worst[0] < 0.1 * tolerance && worst[1] < 10.0 * tolerance, "{worst:?}");
        }
    }
}

/// Regression only: the same bits with and without an interruption between two rows of one step.
#[test]
fn a_run_goes_on_from_a_row_within_a_step_bit_for_bit() {
    let start = || pair(SystemScheme::Radau, 1e-5, Rows::Interval(INTERVAL));
    let (whole, _) = rows(start(), false);
    let mut cut = start();
    while cut.time() < 0.45 * END {
        cut.advance_watched(1, |_, _| ()).unwrap();
    }
    let checkpoint = cut.checkpoint().unwrap();
    assert_eq!(checkpoint.len(), start().checkpoint().unwrap().len());
    let resumed = start().restored(&checkpoint).unwrap();
    assert_eq!(resumed.time().to_bits(), cut.time().to_bits());
    let (rest, _) = rows(resumed, false);
    assert_eq!(rest[..], whole[whole.len() - rest.len()..]);
}

/// A rod of 1 m and 1 kg on a hinge at its end, with a force along the turn of the hinge.
fn rod(omega: f64, force: JointForce, gravity: f64, rows: Rows, end: f64) -> Simulation {
    let inertia = Matrix3::from_diagonal(&Vector3::new(1e-3, 1.0 / 12.0, 1.0 / 12.0));
    let rod = ReducedBody::rigid(1.0, Vector3::zeros(), inertia, RigidMotion::free()).unwrap();
    let center = PointShapes::new(&rod, &BodyPoint::rigid(Vector3::zeros()));
    let weight = PointForce::dead(center, Vector3::new(0.0, -gravity, 0.0), History::Constant);
    let body = ConservativeBody::new(&rod, &[], vec![Arc::new(weight)], &Physics::default()).unwrap();
    let axes = Matrix3::identity();
    let hinge = Joint::revolute(
        "hinge",
        [Marker::on_ground(Vector3::zeros(), axes), Marker::on_rigid(0, -0.5 * Vector3::x(), axes)],
    );
    let system = System::new(vec![body], vec![hinge.with_force(Coordinate::Turn, force)]).unwrap();
    let state = MotionState {
        time: 0.0,
        attitude: Attitude::identity(),
        origin_global: 0.5 * Vector3::x(),
        velocity_global: Vector3::y() * 0.5 * omega,
        omega_body: Vector3::z() * omega,
        modal_displacement: Vec::new(),
        modal_velocity: Vec::new(),
    };
    Simulation::of_system(SystemSetup {
        system,
        states: vec![state],
        start: Start::AsPlaced,
        scheme: SystemScheme::Radau,
        control: StepControl::Tolerance(1e-9),
        end,
        rows,
        points: vec![Vec::new()],
    })
    .unwrap()
}

/// Moment of inertia of the rod about the hinge.
const INERTIA: f64 = 1.0 / 3.0;

/// The rows and events from here to the end, and their times.
fn rest(simulation: &mut Simulation) -> Vec<(Reached, f64)> {
    let mut reached = Vec::new();
    while reached.last().is_none_or(|(what, _)| *what != Reached::End) {
        assert!(reached.len() < 1000, "{reached:?}");
        reached.push((simulation.advance_watched(u64::MAX, |_, _| ()).unwrap(), simulation.time()));
    }
    reached
}

/// K(k) by the arithmetic-geometric mean.
fn elliptic(k: f64) -> f64 {
    let (mut a, mut b) = (1.0, (1.0 - k * k).sqrt());
    for _ in 0..40 {
        (a, b) = (0.5 * (a + b), f64::sqrt(a * b));
    }
    FRAC_PI_2 / a
}

/// Closed form: a pendulum that is let go from the horizontal passes its lowest point after K(sin 45°)/√(g m l/J), and again every two
/// of them.
#[test]
fn a_pendulum_passes_its_lowest_point_at_quarter_periods() {
    let quarter = elliptic((0.25 * PI).sin()) / (9.81 * 0.5 / INERTIA).sqrt();
    let mut simulation = rod(0.0, JointForce::default(), 9.81, Rows::Interval(0.1), 2.0);
    let lowest = |now: &SystemObservation| now.joints[0].coordinates.turn + FRAC_PI_2;
    let number = simulation.add_event(Event::of_system("lowest", Crossing::Any, lowest)).unwrap();
    assert_eq!(simulation.event(number).unwrap().name(), "lowest");
    let reached = rest(&mut simulation);
    let events: Vec<f64> =
        reached.iter().filter(|(what, _)| *what == Reached::Event(0)).map(|(_, time)| *time).collect();
    let rows = reached.iter().filter(|(what, _)| *what == Reached::Row).count();
    assert_eq!((events.len(), rows), (2, 20), "{reached:?}");
    for (k, time) in events.iter().enumerate() {
        let expected = (2 * k + 1) as f64 * quarter;
        println!("{time} {expected} {:e}", time - expected);
        assert!((time - expected).abs() < 1e-8, "{time} {expected}");
    }
    assert!(reached.windows(2).all(|pair| pair[0].1 <= pair[1].1), "{reached:?}");
}

/// Closed form: a panel that a spring drives from 1 rad reaches half of that after a third of a quarter period each way, with the
/// torque and the rate of the spring there.
#[test]
fn a_panel_on_a_spring_reaches_an_angle() {
    let stiffness = 2.0;
    let omega = f64::sqrt(stiffness / INERTIA);
    let spring = JointForce { stiffness, free: 1.0, ..JointForce::default() };
    let mut simulation = rod(0.0, spring, 0.0, Rows::EverySteps(u64::MAX), 2.0);
    let half = |now: &SystemObservation| now.joints[0].coordinates.turn - 0.5;
    let torque = |now: &SystemObservation| now.joints[0].turn_effort;
    simulation.add_event(Event::of_system("half way", Crossing::Rising, half)).unwrap();
    simulation.add_event(Event::of_system("no torque", Crossing::Falling, torque)).unwrap();
    let mut seen = Vec::new();
    loop {
        match simulation.advance_watched(u64::MAX, |_, _| ()).unwrap() {
            Reached::Event(number) => seen.push((number, simulation.system_observation().unwrap())),
            Reached::End => break,
            _ => {}
        }
    }
    let expected = [(0, PI / 3.0), (1, FRAC_PI_2), (0, PI / 3.0 + 2.0 * PI), (1, 2.5 * PI), (0, PI / 3.0 + 4.0 * PI)];
    let expected = expected.map(|(number, phase)| (number, phase / omega));
    let expected: Vec<_> = expected.into_iter().filter(|(_, time)| *time < 2.0).collect();
    assert_eq!(
        seen.iter().map(|(number, _)| *number).collect::<Vec<_>>(),
        expected.iter().map(|(n, _)| *n).collect::<Vec<_>>()
    );
    for ((_, now), (_, time)) in seen.iter().zip(&expected) {
        assert!((now.time - time).abs() < 1e-8, "{} {time}", now.time);
        let rate = omega * (omega * time).sin();
        assert!((now.joints[0].coordinates.turn_rate - rate).abs() < 1e-7);
    }
}

/// Closed form: full turns of a free rotor.
#[test]
fn events_rows_and_stops_at_one_time_come_once_and_in_order() {
    let mut simulation = rod(2.0, JointForce::default(), 0.0, Rows::Interval(0.25), 1.0);
    let angle = |of: f64| move |now: &SystemObservation| now.joints[0].coordinates.turn - of;
    simulation.add_event(Event::of_system("at a row", Crossing::Rising, angle(1.0))).unwrap();
    simulation.add_event(Event::of_system("between", Crossing::Rising, angle(1.2))).unwrap();
    simulation.set_stop_time(Some(0.3));
    let mut reached = rest(&mut simulation);
    assert!(simulation.is_over());
    // The event at the row may come before or after it by rounding.
    reached[2..4].sort_by_key(|(what, _)| *what == Reached::Row);
    let (row, event) = (Reached::Row, Reached::Event);
    let expected = [
        (row, 0.25),
        (Reached::Stop, 0.3),
        (event(0), 0.5),
        (row, 0.5),
        (event(1), 0.6),
        (row, 0.75),
        (row, 1.0),
        (Reached::End, 1.0),
    ];
    assert_eq!(reached.len(), expected.len(), "{reached:?}");
    for ((what, time), (expected, at)) in reached.iter().zip(expected) {
        assert!(*what == expected && (time - at).abs() < 1e-11, "{reached:?}");
    }
}

/// Closed form: a rotor under a torque that is switched on at a row within a step; a stop that is set there, too.
#[test]
fn what_changes_at_a_row_within_a_step_holds_from_there() {
    let signal = Signal::held(0.0);
    let inertia = Matrix3::from_diagonal_element(0.5);
    let wheel = ReducedBody::rigid(1.0, Vector3::zeros(), inertia, RigidMotion::free()).unwrap();
    let own = signal.clone();
    let rim = [1.0, -1.0].map(|x| PointShapes::new(&wheel, &BodyPoint::rigid(Vector3::x() * x)));
    let torque = LoadFn::new("motor", move |motion: &Kinematics<'_>, applied: &mut Applied<'_>| {
        let force = Vector3::y() * 0.5 * own.at(motion.time);
        applied.force(&rim[0], &force);
        applied.force(&rim[1], &-force);
    });
    let body = ConservativeBody::new(&wheel, &[], vec![Arc::new(torque)], &Physics::default()).unwrap();
    let ends = [
        Marker::on_ground(Vector3::zeros(), Matrix3::identity()),
        Marker::on_rigid(0, Vector3::zeros(), Matrix3::identity()),
    ];
    let system = System::new(vec![body], vec![Joint::revolute("axle", ends)]).unwrap();
    let state = MotionState {
        time: 0.0,
        attitude: Attitude::identity(),
        origin_global: Vector3::zeros(),
        velocity_global: Vector3::zeros(),
        omega_body: Vector3::z(),
        modal_displacement: Vec::new(),
        modal_velocity: Vec::new(),
    };
    let mut simulation = Simulation::of_system(SystemSetup {
        system,
        states: vec![state],
        start: Start::AsPlaced,
        scheme: SystemScheme::Radau,
        control: StepControl::Tolerance(1e-9),
        end: 10.0,
        rows: Rows::Interval(0.1),
        points: vec![Vec::new()],
    })
    .unwrap();
    while simulation.time() < 4.05 {
        simulation.advance_watched(u64::MAX, |_, _| ()).unwrap();
    }
    let from = simulation.time();
    signal.hold(0.3);
    simulation.loads_have_changed();
    assert_eq!(simulation.time(), from);
    simulation.set_stop_time(Some(6.03));
    while simulation.advance_watched(u64::MAX, |_, _| ()).unwrap() != Reached::Stop {}
    let found = simulation.system_observation().unwrap();
    assert_eq!(found.time, 6.03);
    let turn = 6.03 + 0.5 * 0.6 * (6.03 - from).powi(2);
    assert!((found.joints[0].coordinates.turn - turn).abs() < 1e-9, "{} {turn}", found.joints[0].coordinates.turn);
    // Back to where it was.
    let mut state = simulation.system_motion().unwrap().state(0).unwrap();
    (state.time, state.omega_body) = (5.0, Vector3::z() * 2.0);
    simulation.set_states(&[state]).unwrap();
    signal.hold(0.0);
    simulation.loads_have_changed();
    assert_eq!(simulation.advance_watched(u64::MAX, |_, _| ()).unwrap(), Reached::Row);
    assert!((simulation.time() - 5.1).abs() < 1e-12);
    let now = simulation.system_observation().unwrap().joints[0].coordinates;
    assert!((now.turn_rate - 2.0).abs() < 1e-10 && (now.turn - turn - 0.2).abs() < 1e-9, "{now:?} {turn}");
}

#[test]
fn the_function_of_an_event_that_gives_no_number_is_told() {
    let mut simulation = rod(2.0, JointForce::default(), 0.0, Rows::Interval(0.25), 1.0);
    let broken = |now: &SystemObservation| if now.time > 0.4 { f64::NAN } else { 1.0 };
    simulation.add_event(Event::of_system("broken", Crossing::Any, broken)).unwrap();
    let failed = loop {
        match simulation.advance_watched(u64::MAX, |_, _| ()) {
            Ok(Reached::End) => panic!("no error"),
            Ok(_) => {}
            Err(error) => break error,
        }
    };
    assert!(matches!(failed, StepError::EventFunction { .. }), "{failed}");
}
