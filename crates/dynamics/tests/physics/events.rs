//! Events and stops at the ends of steps, beside discontinuities, rows and each other, and functions of events that fail.

use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex};

use dynamics::{
    Crossing, Drive, DrivenMotion, DrivenSpeed, Event, History, Observation, Observer, Reached, Rows, SetupError,
    Simulation, StepControl, StepEnd, StepError,
};
use nalgebra::Vector3;
use reduced_body::{ReducedBody, RigidMotion};

use crate::sample::{EXPONENTIAL, RKMK4, Run, body};

const CONTROLS: [StepControl; 2] = [StepControl::Fixed(1e-2), StepControl::Tolerance(1e-8)];

fn sample() -> ReducedBody {
    body(RigidMotion::free(), &[5.0, 8.0, 13.0])
}

fn clock(time: f64) -> Event {
    Event::new("clock", Crossing::Any, move |now: &Observation| now.time - time)
}

/// The rows and events from here to the end, and their times.
fn rest(simulation: &mut Simulation) -> Vec<(Reached, f64)> {
    let mut reached = Vec::new();
    while reached.last().is_none_or(|(what, _)| *what != Reached::End) {
        assert!(reached.len() < 1000, "{reached:?}");
        reached.push((simulation.advance(u64::MAX).unwrap(), simulation.time()));
    }
    reached
}

fn assert_reached(found: &[(Reached, f64)], expected: &[(Reached, f64)]) {
    assert_eq!(found.len(), expected.len(), "{found:?}");
    for ((what, time), (expected_what, expected_time)) in found.iter().zip(expected) {
        assert!(what == expected_what && (time - expected_time).abs() < 1e-12, "{found:?}");
    }
}

/// Conserved: the same motion with and without the event.
#[test]
fn a_discontinuity_that_an_event_falls_on_is_passed() {
    let turned = body(RigidMotion::clamp(Vector3::zeros()), &[5.0, 8.0, 13.0]);
    let mut run = Run::new(&turned, 1.0);
    run.physics.drive = Some(Drive {
        motion: DrivenMotion::Turn { axis: Vector3::z() },
        speed: DrivenSpeed { amplitude: 1.2, history: History::Step { at: 0.5 } },
        added: None,
    });
    for method in [EXPONENTIAL, RKMK4] {
        for control in CONTROLS {
            let last = |event: Option<Event>| {
                let mut simulation = run.start(method, control, Rows::Interval(1.0));
                let events = usize::from(event.is_some());
                event.map(|event| simulation.add_event(event).unwrap());
                let reached = rest(&mut simulation);
                assert_eq!(reached.len(), events + 2, "{method:?} {control:?}: {reached:?}");
                simulation.observation().unwrap()
            };
            let jumps = |now: &Observation| now.omega_body.z - 0.6;
            let whole = last(None);
            for event in [clock(0.5 - 1e-15), clock(0.5), Event::new("jump", Crossing::Rising, jumps)] {
                assert_eq!(last(Some(event)), whole, "{method:?} {control:?}");
            }
        }
    }
}

#[test]
fn an_event_at_the_end_of_a_step_comes_once() {
    let body = sample();
    let run = Run::new(&body, 3.0);
    for control in CONTROLS {
        let mut simulation = run.start(EXPONENTIAL, control, Rows::Interval(0.01));
        let mut expected = Vec::new();
        for k in 0..300 {
            let time = (k + 1) as f64 * 0.01;
            let event = simulation.add_event(clock(time)).unwrap();
            expected.extend([(Reached::Event(event), time), (Reached::Row, time)]);
        }
        expected.push((Reached::End, 3.0));
        assert_reached(&rest(&mut simulation), &expected);
    }
}

#[test]
fn events_at_one_time_all_come() {
    let body = sample();
    for time in [0.5, 0.503] {
        for control in CONTROLS {
            let mut simulation = Run::new(&body, 1.0).start(EXPONENTIAL, control, Rows::Interval(1.0));
            let beside = [time, time + 2e-16, time, time - 2e-16];
            let events = beside.map(|time| simulation.add_event(clock(time)).unwrap());
            let reached = rest(&mut simulation);
            let mut seen: Vec<usize> = Vec::new();
            for (what, at) in &reached {
                if let Reached::Event(event) = what {
                    assert!((at - time).abs() < 1e-12, "{control:?}: {reached:?}");
                    seen.push(*event);
                }
            }
            seen.sort_unstable();
            assert_eq!(seen, events, "{control:?} {time}: {reached:?}");
        }
    }
}

#[test]
fn an_event_on_the_stop_time_comes_in_its_place() {
    let body = sample();
    let run = Run::new(&body, 1.0);
    for control in CONTROLS {
        for stop in [0.5, 0.503] {
            let mut simulation = run.start(EXPONENTIAL, control, Rows::Interval(1.0));
            let event = simulation.add_event(clock(stop)).unwrap();
            simulation.set_stop_time(Some(stop));
            let expected = [(Reached::Event(event), stop), (Reached::Row, 1.0), (Reached::End, 1.0)];
            assert_reached(&rest(&mut simulation), &expected);
        }
    }
}

#[test]
fn a_row_at_which_an_event_function_fails_comes_when_it_is_mended() {
    let body = sample();
    let [fixed, tolerance] = CONTROLS;
    let by_time = Rows::Interval(0.25);
    for (control, rows) in [(fixed, by_time), (tolerance, by_time), (fixed, Rows::EverySteps(10))] {
        let start = || Run::new(&body, 1.0).start(EXPONENTIAL, control, rows);
        let whole = rest(&mut start());
        let row = whole[1].1;
        let broken = Arc::new(AtomicBool::new(true));
        let is_broken = Arc::clone(&broken);
        let function = move |now: &Observation| {
            let fails = now.time > row - 1e-9 && is_broken.load(Ordering::Relaxed);
            if fails { f64::NAN } else { 1.0 }
        };
        let mut simulation = start();
        simulation.add_event(Event::new("table", Crossing::Any, function)).unwrap();
        simulation.set_stop_time(Some(row));
        assert_eq!(simulation.advance(u64::MAX).unwrap(), Reached::Row);
        let error = simulation.advance(u64::MAX).unwrap_err();
        assert!(matches!(error, StepError::EventFunction { found, .. } if found.is_nan()), "{error}");
        assert_eq!(simulation.time(), row);
        broken.store(false, Ordering::Relaxed);
        assert_reached(&rest(&mut simulation), &whole[1..]);
    }
}

/// Fails once, at the first step's end beyond a time.
struct FailsOnce {
    at: f64,
    failed: bool,
}

impl Observer for FailsOnce {
    fn step(&mut self, now: &mut StepEnd<'_>) -> Result<(), StepError> {
        let time = now.motion().time();
        if time < self.at || std::mem::replace(&mut self.failed, true) {
            return Ok(());
        }
        Err(StepError::NotFinite { time, what: "what is watched" })
    }
}

#[test]
fn the_steps_begin_at_the_event_though_an_observer_fails_there() {
    let body = sample();
    for control in CONTROLS {
        let run = |fails: bool| {
            let mut simulation = Run::new(&body, 1.0).start(EXPONENTIAL, control, Rows::Interval(0.25));
            simulation.add_event(clock(0.503)).unwrap();
            let failed = !fails;
            simulation.watch(Arc::new(Mutex::new(FailsOnce { at: 0.5025, failed })));
            let mut errors = 0;
            loop {
                match simulation.advance(u64::MAX) {
                    Ok(Reached::End) => break,
                    Ok(_) => {}
                    Err(_) => errors += 1,
                }
            }
            assert_eq!(errors, usize::from(fails));
            simulation.observation().unwrap()
        };
        assert_eq!(run(true), run(false), "{control:?}");
    }
}

#[test]
fn a_state_that_is_refused_leaves_the_row_that_is_due() {
    let body = sample();
    let mut simulation = Run::new(&body, 1.0).start(EXPONENTIAL, CONTROLS[0], Rows::Interval(0.25));
    simulation.set_stop_time(Some(0.25));
    assert_eq!(simulation.advance(u64::MAX).unwrap(), Reached::Stop);
    let mut state = simulation.states().unwrap().remove(0);
    state.time = 0.1;
    state.modal_velocity.pop();
    assert!(matches!(simulation.set_states(&[state]), Err(SetupError::Length { .. })));
    assert_eq!((simulation.advance(u64::MAX).unwrap(), simulation.time()), (Reached::Row, 0.25));
}

#[test]
fn an_event_function_that_is_no_number_ends_the_run_and_is_said_to() {
    let body = sample();
    let start = || Run::new(&body, 1.0).start(EXPONENTIAL, CONTROLS[0], Rows::Interval(1.0));
    let root = |now: &Observation| (0.5 - now.time).sqrt() - 0.1;
    let mut simulation = start();
    simulation.add_event(Event::new("root", Crossing::Rising, root)).unwrap();
    let ended = simulation.advance(u64::MAX);
    assert!(matches!(ended, Err(StepError::EventFunction { time, .. }) if (time - 0.51).abs() < 1e-12));
    for value in [f64::NAN, f64::INFINITY] {
        let added = start().add_event(Event::new("none", Crossing::Any, move |_: &Observation| value));
        let Err(error @ StepError::EventFunction { time: 0.0, .. }) = added else { panic!("{added:?}") };
        assert!(error.to_string().contains(&format!("the function of an event gives {value}")), "{error}");
    }
}
