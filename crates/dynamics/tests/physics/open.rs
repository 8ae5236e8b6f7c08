//! Doors for programs outside: states, stop times, times between steps, observers, and attitudes to begin at.

use std::sync::{Arc, Mutex};

use dynamics::{
    Applied, Crossing, CustomError, Event, History, Initial, Kinematics, LoadFn, LoadFrame, Method, Observation,
    Observer, PointForce, PointShapes, Reached, Rows, SetupError, SharedLoad, Simulation, StepControl, StepEnd,
    StepError, SystemObservation,
};
use faer::Mat;
use nalgebra::Vector3;
use reduced_body::{BodyPoint, RigidMotion};
use rigid_kin::Attitude;

use crate::sample::{EXPONENTIAL, RKMK4, Run, body, point};

const OMEGA: [f64; 3] = [5.0, 8.0, 13.0];

fn motions() -> [RigidMotion; 5] {
    let (zero, axis) = (Vector3::zeros(), Vector3::new(0.6, 0.0, 0.8));
    [
        RigidMotion::free(),
        RigidMotion::pin(zero),
        RigidMotion::hinge(zero, axis),
        RigidMotion::slider(axis),
        RigidMotion::clamp(zero),
    ]
}

fn largest(a: &[f64], b: &[f64]) -> f64 {
    assert_eq!(a.len(), b.len());
    a.iter().zip(b).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
}

/// Conserved: a state that is put back is the state.
#[test]
fn the_state_is_what_was_given_and_can_be_put_back() {
    for motion in motions() {
        let body = body(motion, &OMEGA);
        let mut run = Run::new(&body, 1.0);
        run.initial.attitude = Attitude::from_wxyz([0.9, 0.1, -0.3, 0.2]).unwrap();
        let Initial { omega, modal_displacement, modal_velocity, .. } = run.initial.clone();
        let spin = motion.rotation_projector() * omega;
        for method in [EXPONENTIAL, RKMK4] {
            let mut simulation = run.start(method, StepControl::Fixed(1e-3), Rows::Interval(0.5));
            let state = simulation.states().unwrap().remove(0);
            let what = format!("{motion:?} {method:?}");
            // Measured: 4e-15.
            assert!((state.omega_body - spin).norm() < 1e-12, "{what}: {} {spin}", state.omega_body);
            assert!(largest(&state.modal_velocity, &modal_velocity) < 1e-12, "{what}");
            assert_eq!(state.modal_displacement, modal_displacement, "{what}");
            assert!(state.attitude.angle_to(&run.initial.attitude) < 1e-15, "{what}");

            simulation.advance(300).unwrap();
            let there = simulation.states().unwrap().remove(0);
            simulation.set_states(std::slice::from_ref(&there)).unwrap();
            let again = simulation.states().unwrap().remove(0);
            assert!(largest(&again.modal_velocity, &there.modal_velocity) < 1e-12, "{what}");
            assert!((again.omega_body - there.omega_body).norm() < 1e-12, "{what}");
            assert!((again.velocity_global - there.velocity_global).norm() < 1e-12, "{what}");
        }
    }
}

/// Conserved: the same motion with and without the state put back.
#[test]
fn a_state_put_back_changes_nothing_of_the_motion() {
    let body = body(RigidMotion::free(), &OMEGA);
    let run = Run::new(&body, 2.0);
    let end = |interrupted: bool| {
        let mut simulation = run.start(EXPONENTIAL, StepControl::Fixed(1e-2), Rows::Interval(2.0));
        if interrupted {
            simulation.advance(70).unwrap();
            let state = simulation.states().unwrap().remove(0);
            simulation.set_states(&[state]).unwrap();
        }
        simulation.last().unwrap().unwrap()
    };
    let (whole, interrupted) = (end(false), end(true));
    // Measured: 2e-14.
    assert!(largest(&whole.modal_displacement, &interrupted.modal_displacement) < 1e-11);
    assert!(whole.attitude.angle_to(&interrupted.attitude) < 1e-11);
}

/// Conserved: a run that begins turned by R under loads that are turned by R is the run without R, turned.
#[test]
fn a_motion_does_not_depend_on_the_attitude_that_it_begins_at() {
    let turn = Attitude::from_wxyz([0.8, -0.2, 0.4, 0.3]).unwrap();
    for motion in motions() {
        let body = body(motion, &OMEGA);
        let ends = |attitude: Attitude, method: Method| -> Observation {
            let mut run = Run::new(&body, 1.0);
            run.initial.velocity = attitude.to_global(&run.initial.velocity);
            run.initial.attitude = attitude;
            let force = attitude.to_global(&Vector3::new(0.5, 1.0, -0.7));
            let history = History::HalfSine { start: 0.1, duration: 0.6 };
            let dead = PointForce::dead(point(&body, [0.5, -0.2, 0.4]), force, history.clone());
            let force = Vector3::new(-0.3, 0.2, 0.4);
            let follower = PointForce {
                force,
                frame: LoadFrame::Body,
                turning: None,
                history,
                point: point(&body, [-0.1, 0.3, 0.2]),
            };
            let loads: [SharedLoad; 2] = [Arc::new(dead), Arc::new(follower)];
            run.loads = loads.into();
            let [first, last] = run.ends(method, 1e-3);
            assert_eq!(first.attitude, attitude);
            last
        };
        for method in [EXPONENTIAL, RKMK4] {
            let (straight, turned) = (ends(Attitude::identity(), method), ends(turn, method));
            let what = format!("{motion:?} {method:?}");
            // Measured: 1e-13.
            assert!(largest(&straight.modal_displacement, &turned.modal_displacement) < 1e-10, "{what}");
            assert!((straight.omega_body - turned.omega_body).norm() < 1e-10, "{what}");
            for (a, b) in [
                (straight.origin_global, turned.origin_global),
                (straight.velocity_global, turned.velocity_global),
                (straight.angular_momentum_global, turned.angular_momentum_global),
                (straight.angular_balance_global(), turned.angular_balance_global()),
            ] {
                assert!((turn.to_global(&a) - b).norm() < 1e-10, "{what}: {a} {b}");
            }
            assert!((straight.energy_balance() - turned.energy_balance()).abs() < 1e-10, "{what}");
        }
    }
}

#[test]
fn a_stop_time_ends_a_step_and_the_run_goes_on() {
    let body = body(RigidMotion::free(), &OMEGA);
    let run = Run::new(&body, 1.0);
    for control in [StepControl::Fixed(1e-2), StepControl::Tolerance(1e-8)] {
        let mut simulation = run.start(EXPONENTIAL, control, Rows::Interval(0.25));
        simulation.set_stop_time(Some(0.4321));
        let mut reached = Vec::new();
        loop {
            let what = simulation.advance(u64::MAX).unwrap();
            reached.push((what, simulation.time()));
            if what == Reached::End {
                break;
            }
        }
        let rows = [0.25, 0.5, 0.75, 1.0].map(|time| (Reached::Row, time));
        let expected = [&rows[..1], &[(Reached::Stop, 0.4321)], &rows[1..], &[(Reached::End, 1.0)]].concat();
        assert_eq!(reached, expected, "{control:?}");
    }
}

#[test]
fn a_row_comes_after_the_stop_or_the_event_that_it_falls_on() {
    let body = body(RigidMotion::free(), &OMEGA);
    let run = Run::new(&body, 1.0);
    let event_at = |time: f64| Event::new("clock", Crossing::Any, move |now: &Observation| now.time - time);
    for control in [StepControl::Fixed(1e-2), StepControl::Tolerance(1e-8)] {
        for (met, is_event) in [(0.5, false), (1.0, false), (0.5, true), (1.0, true)] {
            let mut simulation = run.start(EXPONENTIAL, control, Rows::Interval(0.25));
            let special = if is_event {
                Reached::Event(simulation.add_event(event_at(met)).unwrap())
            } else {
                simulation.set_stop_time(Some(met));
                Reached::Stop
            };
            let mut reached = Vec::new();
            while reached.last().is_none_or(|(what, _)| *what != Reached::End) {
                assert!(reached.len() < 9, "{reached:?}");
                assert!(!simulation.is_over() || reached.len() == 5);
                let what = simulation.advance(u64::MAX).unwrap();
                reached.push((what, simulation.time()));
                if what == special {
                    // The row that is due is part of the state.
                    let saved = simulation.checkpoint().unwrap();
                    let mut again = run.start(EXPONENTIAL, control, Rows::Interval(0.25)).restored(&saved).unwrap();
                    assert_eq!(again.advance(u64::MAX).unwrap(), Reached::Row);
                    assert_eq!(again.time(), simulation.time());
                }
            }
            let mut expected: Vec<_> = [0.25, 0.5, 0.75, 1.0].map(|time| (Reached::Row, time)).into();
            expected.insert((4.0 * met) as usize - 1, (special, met));
            expected.push((Reached::End, 1.0));
            for ((what, time), (expected_what, expected_time)) in reached.iter().zip(&expected) {
                assert!(
                    what == expected_what && (time - expected_time).abs() < 1e-12,
                    "{control:?} {met}: {reached:?}"
                );
            }
            assert_eq!(reached.len(), expected.len(), "{control:?} {met}: {reached:?}");
        }
    }
}

#[test]
fn no_time_after_an_event_is_inside_the_last_step() {
    let body = body(RigidMotion::free(), &OMEGA);
    let mut simulation = Run::new(&body, 1.0).start(EXPONENTIAL, StepControl::Fixed(1e-2), Rows::Interval(1.0));
    simulation.add_event(Event::new("clock", Crossing::Any, |now: &Observation| now.time - 0.503)).unwrap();
    assert_eq!(simulation.advance(u64::MAX).unwrap(), Reached::Event(0));
    let mut out = simulation.observation().unwrap();
    assert!(simulation.interpolate(0.502, [&mut out]).is_ok());
    assert!(matches!(simulation.interpolate(0.508, [&mut out]), Err(StepError::OutsideLastStep { .. })));
}

/// Conserved: order 4.
#[test]
fn a_time_inside_a_step_is_as_accurate_as_the_scheme_and_observers_see_every_step() {
    let body = body(RigidMotion::free(), &OMEGA);
    let run = Run::new(&body, 1.0);
    let between = |step: f64| {
        let mut simulation = run.start(EXPONENTIAL, StepControl::Fixed(step), Rows::Interval(1.0));
        let seen = Arc::new(Mutex::new(Vec::new()));
        let times = Arc::clone(&seen);
        simulation.watch(Arc::new(Mutex::new(move |now: &SystemObservation| times.lock().unwrap().push(now.time))));
        simulation.keep_last_step();
        let mut out = simulation.observation().unwrap();
        while simulation.time() < 0.437 {
            simulation.advance(1).unwrap();
        }
        assert_eq!(seen.lock().unwrap().len() as u64, simulation.stats().accepted);
        let reached = simulation.time();
        simulation.interpolate(0.437, [&mut out]).unwrap();
        assert!(out.time == 0.437 && simulation.time() == reached);
        assert!(simulation.interpolate(0.1, [&mut out.clone()]).is_err());
        out
    };
    let exact = run.start(EXPONENTIAL, StepControl::Fixed(1e-4), Rows::Interval(0.437)).nth(1).unwrap().unwrap();
    let error = |step: f64| largest(&between(step).modal_displacement, &exact.modal_displacement);
    let (coarse, fine) = (error(4e-2), error(2e-2));
    // Fourth order: 16 and somewhat more.
    assert!(fine < 1e-4 && coarse / fine > 12.0, "{coarse:e} {fine:e}");
}

#[test]
fn a_run_can_be_looked_at_before_its_first_step_and_its_rows_begin_at_time_zero() {
    let body = body(RigidMotion::free(), &OMEGA);
    let initial = Run::new(&body, 0.01).initial;
    let builder = Simulation::builder(&body, StepControl::Fixed(1e-3), 0.01).initial(initial);
    let mut simulation = builder.point(point(&body, [0.3, 0.2, 0.1])).build().unwrap();
    let first = simulation.observation().unwrap();
    assert_eq!((first.time, first.points.len(), first.modal_displacement.len()), (0.0, 1, OMEGA.len()));
    assert!(first.points[0].velocity.norm() > 0.0 && first.energy() > 0.0);
    let room = Observation::new(OMEGA.len(), 1);
    assert_eq!((room.points.len(), room.modal_velocity.len()), (1, OMEGA.len()));

    let rows: Vec<Observation> = simulation.clone().map(Result::unwrap).collect();
    assert_eq!((rows.len(), &rows[0]), (11, &first));
    // The start is no row of one that has gone on.
    simulation.advance(1).unwrap();
    assert_eq!(simulation.next().unwrap().unwrap().time, rows[2].time);
}

#[test]
fn a_builder_starts_what_a_setup_does_and_refuses_what_it_refuses() {
    let body = body(RigidMotion::free(), &OMEGA);
    let run = Run::new(&body, 0.2);
    let control = StepControl::Fixed(1e-3);
    let of_setup = run.start(RKMK4, control, Rows::Interval(0.1));
    let builder = Simulation::builder(&body, control, run.end)
        .damping_ratio(run.damping_ratio)
        .loads(run.loads.clone())
        .physics(run.physics.clone())
        .initial(run.initial.clone())
        .method(RKMK4)
        .rows(Rows::Interval(0.1));
    assert!(of_setup.eq(builder.build().unwrap()));
    let refused = builder.clone().damping_ratios(vec![0.1]).build();
    assert!(matches!(refused, Err(SetupError::Length { found: 1, .. })));
    let refused = Simulation::builder(&body, StepControl::Fixed(-1.0), 1.0).build();
    assert!(matches!(refused, Err(SetupError::Value { what: "the step", .. })));
}

/// Conserved: the place and velocity of the point at the origin.
#[test]
fn a_load_sees_the_origin_where_and_as_fast_as_it_is_with_every_scheme() {
    let body = body(RigidMotion::free(), &OMEGA);
    let shapes = BodyPoint { position_body: Vector3::zeros(), shapes: Mat::zeros(3, OMEGA.len()) };
    let origin = PointShapes::new(&body, &shapes);
    for method in [frames_rk4::PAPER, frames_rk4::LIMIT, Method::RKMK4, Method::EXPONENTIAL] {
        let seen = Arc::new(Mutex::new(Vec::new()));
        let (speeds, place) = (Arc::clone(&seen), origin.clone());
        let law = move |motion: &Kinematics, applied: &mut Applied| {
            assert!((motion.origin_global - motion.position_global(&place)).norm() < 1e-14);
            assert!((motion.origin_velocity_global - motion.velocity_global(&place)).norm() < 1e-14);
            speeds.lock().unwrap().push(motion.origin_velocity_global.norm());
            applied.force(&place, &Vector3::new(0.1, 0.0, 0.2));
        };
        let mut run = Run::new(&body, 0.02);
        run.loads = vec![Arc::new(LoadFn::new("look", law))];
        // The paper's schemes turn with products that this body has not got: a step, whatever it comes to, is enough.
        let _ = run.start(method, StepControl::Fixed(1e-3), Rows::Interval(0.02)).advance(1);
        // At a start beside the run it is at rest.
        let moving = seen.lock().unwrap().iter().filter(|speed| **speed > 0.3).count();
        assert!(moving >= 2, "{method:?} {moving}");
    }
}

/// Conserved: the same motion with the jumps as discontinuities, which a closure says nothing of.
#[test]
fn jumps_that_a_closure_does_not_name_are_passed_within_the_tolerance() {
    let body = body(RigidMotion::free(), &OMEGA);
    let mut run = Run::new(&body, 4.0);
    let place = point(&body, [0.3, -0.2, 0.4]);
    let discontinuities = vec![0.7, 1.3, 2.9];
    let load = |named: bool| -> SharedLoad {
        let place = place.clone();
        let jumps = discontinuities.clone();
        let law = move |motion: &Kinematics, applied: &mut Applied| {
            let time = if named { motion.branch_time } else { motion.time };
            let sign = if jumps.iter().filter(|jump| time >= **jump).count() % 2 == 0 { 1.0 } else { -1.0 };
            applied.force(&place, &(Vector3::new(2.0, -1.0, 0.5) * sign));
        };
        let load = LoadFn::new("switch", law);
        Arc::new(if named { load.with_discontinuities(discontinuities.clone()) } else { load })
    };
    let mut end = |named: bool, control: StepControl| {
        run.loads = vec![load(named)];
        let mut simulation = run.start(EXPONENTIAL, control, Rows::Interval(4.0));
        let last = simulation.by_ref().last().unwrap().unwrap();
        (last, simulation.stats().accepted)
    };
    let (truth, _) = end(true, StepControl::Fixed(1e-3));
    for tolerance in [1e-3, 1e-6, 1e-9] {
        let (found, steps) = end(false, StepControl::Tolerance(tolerance));
        let (_, named) = end(true, StepControl::Tolerance(tolerance));
        let error = largest(&found.modal_displacement, &truth.modal_displacement);
        println!("{tolerance:e}: {steps} steps, {named} with discontinuities, {error:e}");
        assert!(error < 2.0 * tolerance && steps < named + 600, "{tolerance:e}: {steps} {named} {error:e}");
    }
}

/// An observer's own error ends the run, keeps its text and its source, and rows end with it.
#[test]
fn an_error_of_an_observer_comes_back_as_it_was() {
    #[derive(Debug, thiserror::Error)]
    #[error("{degrees} degrees are too hot")]
    struct TooHot {
        degrees: f64,
    }

    struct Thermometer;

    impl Observer for Thermometer {
        fn step(&mut self, now: &mut StepEnd<'_>) -> Result<(), StepError> {
            let time = now.motion().time();
            if time < 0.55 {
                return Ok(());
            }
            Err(StepError::Custom { time, error: CustomError::new(TooHot { degrees: 451.0 }) })
        }
    }

    let body = body(RigidMotion::free(), &OMEGA);
    let mut simulation = Run::new(&body, 1.0).start(EXPONENTIAL, StepControl::Fixed(0.1), Rows::Interval(0.1));
    simulation.watch(Arc::new(Mutex::new(Thermometer)));
    let rows: Vec<_> = simulation.collect();
    // The start and five steps; the sixth ends at 0.6.
    assert_eq!(rows.len(), 7);
    let Err(StepError::Custom { time, error }) = rows.last().unwrap() else { panic!("{:?}", rows.last()) };
    assert!((time - 0.6).abs() < 1e-12);
    let TooHot { degrees } = error.get().downcast_ref().unwrap();
    assert_eq!(*degrees, 451.0);
    assert!(rows.last().unwrap().as_ref().unwrap_err().to_string().ends_with("451 degrees are too hot"));
}
