//! Systems far from the origin, and that fly fast, against the same near it and at rest as a whole.

use std::sync::{Arc, Mutex};

use dynamics::{
    ConservativeBody, ForceElement, History, Initial, Joint, LoadFn, Marker, MarkerMotion, MarkerWrench, MotionState,
    Observation, Physics, PointForce, PointShapes, Reached, Rows, SharedLoad, Simulation, Start, StepControl, System,
    SystemMotion, SystemScheme, SystemSetup,
};
use nalgebra::{Matrix3, Vector3, Vector6};
use reduced_body::{BodyPoint, ReducedBody, RigidMotion};
use rigid_kin::Attitude;

use crate::mechanism::{Link, Mechanism, at_rest};

/// Three bars in a row that turn against each other, moved and in motion as a whole.
fn chain(away: [f64; 2], velocity: [f64; 2]) -> SystemMotion {
    let bar = |x: f64| Link {
        mass: 1.0,
        inertia: Vector3::new(1e-3, 1.0 / 12.0, 1.0 / 12.0),
        center: [away[0] + x, away[1]],
        angle: 0.0,
        loads: Vec::new(),
    };
    let mut mechanism = Mechanism::default();
    let [a, b, c] = [-1.0, 0.0, 1.0].map(|x| mechanism.link(bar(x)));
    mechanism.hinge([Some(a), Some(b)], [away[0] - 0.5, away[1]]);
    mechanism.hinge([Some(b), Some(c)], [away[0] + 0.5, away[1]]);
    // The middle one turns with 1 rad/s, the others with 3 and −2, about a centre of mass that goes along.
    let own =
        [[0.0, -0.5 - 1.5], [0.0, 0.0], [0.0, 0.5 - 1.0]].map(|[x, y]| [x + velocity[0], y + velocity[1] + 2.5 / 3.0]);
    mechanism.starts(&[(own[0], 3.0), (own[1], 1.0), (own[2], -2.0)])
}

/// Steps to two seconds, places and attitudes of the bodies from the way of the whole, and momenta that have changed, over their size.
fn run(
    away: [f64; 2],
    velocity: [f64; 2],
    (scheme, tolerance): (SystemScheme, f64),
) -> (u64, Vec<Vector6<f64>>, [f64; 2]) {
    let mut motion = chain(away, velocity).with_scheme(scheme);
    motion.assemble().unwrap();
    let before = motion.momenta();
    let steps = motion.advance(2.0, tolerance, &mut 1e-2).unwrap();
    let after = motion.momenta();
    let changed = [0, 1].map(|k: usize| (after[k] - before[k]).norm() / before[k].norm().max(1.0));
    let way = Vector3::new(away[0] + 2.0 * velocity[0], away[1] + 2.0 * velocity[1], 0.0);
    let of_body = |body: usize| {
        let state = motion.state(body).unwrap();
        let (place, turned) = (state.origin_global - way, state.attitude.to_global(&Vector3::x()));
        Vector6::new(place.x, place.y, place.z, turned.x, turned.y, turned.z)
    };
    (steps, (0..3).map(of_body).collect(), changed)
}

/// Conserved: what a system does does not depend on where it is and how it flies as a whole, nor do the steps that it takes.
#[test]
fn a_free_chain_does_far_away_and_in_orbit_what_it_does_at_the_origin() {
    let schemes = [(SystemScheme::Radau, 1e-4), (SystemScheme::Radau, 1e-8), (SystemScheme::Rkmk4, 1e-7)];
    for how in schemes {
        let (steps, here, _) = run([0.0; 2], [0.0; 2], how);
        // What places are rounded to at the end, and momenta about the origin; velocities are given with the digits of the whole.
        for (away, velocity, rounding, digits) in [
            ([0.0; 2], [300.0, 0.0], 1e-11, 1e-12),
            ([1e7, 3e6], [0.0; 2], 1e-8, 1e-12),
            ([7e6, 0.0], [0.0, 7500.0], 1e-8, 1e-11),
        ] {
            let (count, there, changed) = run(away, velocity, how);
            let off = |of: std::ops::Range<usize>| {
                let bodies = here.iter().zip(&there);
                bodies.flat_map(|(a, b)| of.clone().map(move |i| (a[i] - b[i]).abs())).fold(0.0, f64::max)
            };
            let [place, turn] = [off(0..3), off(3..6)];
            println!(
                "{how:?} {away:?} {velocity:?}: {count} of {steps} steps, off by {place:e} and {turn:e}, momenta {changed:?}"
            );
            assert_eq!(count, steps);
            assert!(place < rounding && turn < digits, "{place:e} {turn:e}");
            assert!(changed.iter().all(|changed| *changed < 10.0 * rounding), "{changed:?}");
        }
    }
}

/// A door of 1 m on two hinges along a skew line, which turns by 2 rad/s: the hinges imply each other, but for what places far away are rounded
/// by. Closed form: its turn.
#[test]
fn hinges_on_ground_far_away_hold_a_door_as_they_do_at_the_origin() {
    let axis = Vector3::new(0.3, -0.5, 0.8).normalize();
    let across = axis.cross(&Vector3::x()).normalize();
    let axes = Matrix3::from_columns(&[across, axis.cross(&across), axis]);
    let steps = [Vector3::zeros(), Vector3::new(1.0e7, -3.1e6, 2.7e6)].map(|away| {
        let reduced =
            ReducedBody::rigid(2.0, Vector3::zeros(), Matrix3::identity() * 0.1, RigidMotion::free()).unwrap();
        let door = ConservativeBody::new(&reduced, &[], Vec::new(), &Physics::default()).unwrap();
        let hinge = |name: &str, along: f64| {
            let ends = [
                Marker::on_ground(away + axis * along, axes),
                Marker::on_rigid(0, axis * (along - 0.4) - across * 0.7, axes),
            ];
            Joint::revolute(name, ends)
        };
        let system = System::new(vec![door], vec![hinge("lower", 0.0), hinge("upper", 0.9)]).unwrap();
        let arm = across * 0.7;
        let state = MotionState {
            velocity_global: axis.cross(&arm) * 2.0,
            omega_body: axis * 2.0,
            ..at_rest(away + axis * 0.4 + arm)
        };
        let mut simulation = simulation(system, vec![state], 1e-7, 1.0);
        let assembled = simulation.system().unwrap().assembled()[0];
        assert!(assembled.velocity < 1e-8 && assembled.angular_velocity < 1e-8, "{assembled:?}");
        assert_eq!(simulation.system().unwrap().rigid_dofs(), 1);
        while simulation.advance(1000).unwrap() != Reached::End {}
        let turn = simulation.observe_joint(0).coordinates.turn;
        println!("{away:?}: {turn}, {:?}", simulation.stats());
        assert!((turn - 2.0).abs() < 1e-7, "{turn}");
        simulation.stats().accepted
    });
    assert_eq!(steps[0], steps[1]);
}

fn simulation(system: System, states: Vec<MotionState>, tolerance: f64, end: f64) -> Simulation {
    let points = vec![Vec::new(); states.len()];
    Simulation::of_system(SystemSetup {
        system,
        states,
        start: Start::AsPlaced,
        scheme: SystemScheme::Radau,
        control: StepControl::Tolerance(tolerance),
        end,
        rows: Rows::Interval(0.1 * end),
        points,
    })
    .unwrap()
}

/// A pair of bars on a hinge that a uniform force takes away.
fn pushed(acceleration: f64) -> Simulation {
    let inertia = Matrix3::from_diagonal(&Vector3::new(1e-3, 1.0 / 12.0, 1.0 / 12.0));
    let reduced = ReducedBody::rigid(1.0, Vector3::zeros(), inertia, RigidMotion::free()).unwrap();
    let center = PointShapes::new(&reduced, &BodyPoint::rigid(Vector3::zeros()));
    let push: SharedLoad =
        Arc::new(PointForce::dead(center, Vector3::new(0.0, 0.6, 0.8) * acceleration, History::Constant));
    let bar = ConservativeBody::new(&reduced, &[], vec![push], &Physics::default()).unwrap();
    let axes = Matrix3::identity();
    let ends = [Marker::on_rigid(0, Vector3::x() * 0.5, axes), Marker::on_rigid(1, Vector3::x() * -0.5, axes)];
    let system = System::new(vec![bar.clone(), bar], vec![Joint::revolute("hinge", ends)]).unwrap();
    let state = |x: f64, vy: f64, spin: f64| MotionState {
        velocity_global: Vector3::y() * vy,
        omega_body: Vector3::z() * spin,
        ..at_rest(Vector3::x() * x)
    };
    simulation(system, vec![state(-0.5, -0.5, 1.0), state(0.5, -1.0, -2.0)], 1e-6, 7.0)
}

fn rows(simulation: &mut Simulation) -> Vec<Vec<Observation>> {
    let mut rows = Vec::new();
    loop {
        match simulation.advance(1000).unwrap() {
            Reached::Row => rows.push(simulation.system_observation().unwrap().bodies),
            Reached::End => return rows,
            _ => {}
        }
    }
}

/// Conserved: a uniform acceleration takes a free system hundreds of lengths away and changes nothing of what its bodies do to each
/// other; its balances close. And a checkpoint on the way goes on with the same bits.
#[test]
fn what_is_accelerated_far_away_keeps_its_digits() {
    let [still, fast] = [0.0, 25.0].map(|acceleration| {
        let mut simulation = pushed(acceleration);
        (rows(&mut simulation), simulation.stats().accepted)
    });
    println!("{} and {} steps", still.1, fast.1);
    assert!(fast.1 <= 3 * still.1, "{} {}", still.1, fast.1);
    let start = 0.5 * (0.25 + 1.0) + 0.5 * (1.0 + 4.0) / 12.0;
    for (still, fast) in still.0.iter().zip(&fast.0) {
        let turned = [0, 1].map(|b: usize| still[b].attitude.angle_to(&fast[b].attitude));
        let apart = [still, fast].map(|row| row[1].origin_global - row[0].origin_global);
        let open: f64 = fast.iter().map(Observation::energy_balance).sum();
        let energy: f64 = fast.iter().map(Observation::energy).sum();
        let time = fast[0].time;
        println!("{time}: {turned:?} {:e} balance {open:e} of {energy:e}", (apart[0] - apart[1]).norm());
        assert!(turned.iter().all(|turned| *turned < 3e-6), "{turned:?}");
        assert!((apart[0] - apart[1]).norm() < 3e-6);
        let expected = Vector3::new(0.0, 0.6, 0.8) * 12.5 * time * time - Vector3::y() * 0.75 * time;
        let middle = (fast[0].origin_global + fast[1].origin_global) * 0.5;
        assert!((middle - expected).norm() < 1e-9 * expected.norm().max(1e3), "{middle:?} {expected:?}");
        assert!((open - start).abs() < 1e-7, "{open} {energy}");
    }
    let mut cut = pushed(25.0);
    while cut.time() < 5.1 {
        cut.advance(1).unwrap();
    }
    let checkpoint = cut.checkpoint().unwrap();
    let mut resumed = pushed(25.0).restored(&checkpoint).unwrap();
    let rest = rows(&mut resumed);
    assert!(!rest.is_empty());
    assert_eq!(rest[..], fast.0[fast.0.len() - rest.len()..]);
}

/// An element that pulls its marker to a place, and remembers where it was seen.
#[derive(Debug)]
struct Pull {
    markers: Vec<Marker>,
    seen: Arc<Mutex<Vec<[Vector3<f64>; 2]>>>,
}

impl ForceElement for Pull {
    fn markers(&self) -> &[Marker] {
        &self.markers
    }

    fn apply(&self, _: [f64; 2], motions: &[MarkerMotion], wrenches: &mut [MarkerWrench]) {
        let MarkerMotion { position_global, velocity_global, .. } = motions[0];
        self.seen.lock().unwrap().push([position_global, velocity_global]);
        wrenches[0].force_global = -1e-3 * (position_global - Vector3::x() * 7e6);
    }

    /// None, so that it sees no differences.
    fn directions(&self) -> usize {
        0
    }
}

/// Laws from outside see global places and velocities, wherever steps count from.
#[test]
fn laws_from_outside_see_global_places_and_velocities() {
    let seen = Arc::new(Mutex::new(Vec::new()));
    let (of_load, of_element) = (Arc::clone(&seen), Arc::clone(&seen));
    let reduced = ReducedBody::rigid(1.0, Vector3::zeros(), Matrix3::identity() * 0.1, RigidMotion::free()).unwrap();
    let load: SharedLoad = Arc::new(LoadFn::new("look", move |motion, _| {
        of_load.lock().unwrap().push([motion.origin_global, motion.origin_velocity_global]);
    }));
    let body = ConservativeBody::new(&reduced, &[], vec![load], &Physics::default()).unwrap();
    let markers = vec![Marker::on_rigid(0, Vector3::zeros(), Matrix3::identity())];
    let system = System::new(vec![body], Vec::new()).unwrap();
    let system = system.with_elements(vec![Arc::new(Pull { markers, seen: of_element })]).unwrap();
    let state = MotionState { velocity_global: Vector3::y() * 7500.0, ..at_rest(Vector3::x() * 7e6) };
    let mut motion = SystemMotion::new(system, &[state]).unwrap();
    motion.assemble().unwrap();
    motion.advance(0.1, 1e-6, &mut 1e-3).unwrap();
    let y = 7500.0 * (1e-3_f64.sqrt() * 0.1).sin() / 1e-3_f64.sqrt();
    let end = motion.state(0).unwrap().origin_global;
    assert!((end - Vector3::new(7e6, y, 0.0)).norm() < 1e-6 * y, "{end:?} {y}");
    let seen = seen.lock().unwrap();
    assert!(seen.len() > 20);
    for [place, velocity] in seen.iter() {
        assert!(
            (place.x - 7e6).abs() < 1e-6 && place.y < 800.0 && (velocity.y - 7500.0).abs() < 1.0,
            "{place:?} {velocity:?}"
        );
    }
}

/// Conserved: a body alone that hardly turns takes the same steps at rest as a whole, and in orbit, and ends in the same attitude.
#[test]
fn a_body_alone_turns_in_orbit_as_at_rest() {
    let inertia = Matrix3::from_diagonal(&Vector3::new(0.04, 0.05, 0.07));
    let reduced = ReducedBody::rigid(3.0, Vector3::zeros(), inertia, RigidMotion::free()).unwrap();
    let run = |origin: Vector3<f64>, velocity: Vector3<f64>| {
        let omega = Vector3::new(1e-3, 2e-3, -1e-3);
        let initial = Initial { omega, velocity, origin: Some(origin), ..Initial::at_rest(0) };
        let run = Simulation::builder(&reduced, StepControl::Tolerance(1e-8), 1000.0).initial(initial);
        let mut simulation = run.rows(Rows::Interval(1000.0)).build().unwrap();
        let last = simulation.by_ref().last().unwrap().unwrap();
        (simulation.stats().accepted, last)
    };
    let (steps, here) = run(Vector3::zeros(), Vector3::zeros());
    let (count, there) = run(Vector3::x() * 7e6, Vector3::y() * 7500.0);
    println!("{steps} {count} {:e}", here.attitude.angle_to(&there.attitude));
    assert_eq!(steps, count);
    assert!(here.attitude.angle_to(&there.attitude) < 1e-12);
    assert_eq!(there.position_global, Vector3::new(7e6, 7.5e6, 0.0));
    let energy = 0.5 * 3.0 * 7500.0 * 7500.0;
    assert!((there.kinetic_energy / energy - 1.0).abs() < 1e-12 && there.attitude != Attitude::identity());
}
