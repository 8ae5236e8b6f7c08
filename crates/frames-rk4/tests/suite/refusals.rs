//! What cannot start or go on is refused with what was found, and the state before it is kept.

use frames_rk4::{History, Initial, ModalModel, PaperScheme, SetupError, StepError};
use nalgebra::Vector3;

use crate::common::ring;

const STEP: f64 = 5e-5;

fn start(initial: &Initial, step: f64) -> Result<PaperScheme, SetupError> {
    let model = ModalModel::new(&ring().body, &[0.0; 10], vec![]).unwrap();
    PaperScheme::new(&ring().body, model, ring().reference_points_body(), initial, step)
}

#[test]
fn lists_of_the_wrong_length() {
    let wrong = |error: SetupError, length: usize| {
        let SetupError::Length { expected, found, .. } = error else { panic!("{error}") };
        assert_eq!((expected, found), (10, length));
    };
    wrong(ModalModel::new(&ring().body, &[0.0; 9], vec![]).unwrap_err(), 9);
    let at_rest = Initial::at_rest(10);
    wrong(start(&Initial { modal_displacement: vec![0.0; 11], ..at_rest.clone() }, STEP).unwrap_err(), 11);
    wrong(start(&Initial { modal_velocity: vec![], ..at_rest }, STEP).unwrap_err(), 0);
}

#[test]
fn numbers_out_of_range() {
    let refused = |error: SetupError, value: f64| {
        let SetupError::Value { found, .. } = error else { panic!("{error}") };
        assert_eq!(found.to_bits(), value.to_bits(), "{found}");
    };
    for value in [-0.01, f64::NAN, f64::INFINITY] {
        let mut ratios = [0.0; 10];
        ratios[3] = value;
        refused(ModalModel::new(&ring().body, &ratios, vec![]).unwrap_err(), value);
    }
    for value in [f64::NAN, f64::INFINITY] {
        let load = ring().half_sine([-100.0, 0.0, 0.0], [0.0, value, 0.0], 1.0);
        refused(ModalModel::new(&ring().body, &[0.0; 10], vec![load]).unwrap_err(), value);
        let at_rest = Initial::at_rest(10);
        let mut vibrating = at_rest.clone();
        vibrating.modal_velocity[2] = value;
        let moving = [
            Initial { velocity: Vector3::new(0.0, value, 0.0), ..at_rest.clone() },
            Initial { omega: Vector3::new(0.0, value, 0.0), ..at_rest.clone() },
            vibrating,
        ];
        for initial in moving {
            refused(start(&initial, STEP).unwrap_err(), value);
        }
        refused(start(&at_rest, value).unwrap_err(), value);
    }
    for step in [0.0, -1e-4] {
        refused(start(&Initial::at_rest(10), step).unwrap_err(), step);
    }
    for duration in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        let load = ring().half_sine([-100.0, 0.0, 0.0], [0.0, 1.0, 0.0], duration);
        refused(ModalModel::new(&ring().body, &[0.0; 10], vec![load]).unwrap_err(), duration);
    }
    let mut load = ring().half_sine([-100.0, 0.0, 0.0], [0.0, 1.0, 0.0], 1.0);
    load.history = History::HalfSine { start: f64::NAN, duration: 1.0 };
    refused(ModalModel::new(&ring().body, &[0.0; 10], vec![load]).unwrap_err(), f64::NAN);
}

#[test]
fn reference_points_on_a_line() {
    let model = ModalModel::new(&ring().body, &[0.0; 10], vec![]).unwrap();
    let line = [0.0, 1.0, 2.0].map(|s| Vector3::new(s, 2.0 * s, -s));
    let error = PaperScheme::new(&ring().body, model, line, &Initial::at_rest(10), STEP).unwrap_err();
    assert!(matches!(error, SetupError::CollinearPoints(points) if points.sine < 1e-6), "{error}");
}

#[test]
fn a_model_or_a_load_of_another_body() {
    let smaller = ring().truncated(4);
    let model = ModalModel::new(&smaller.body, &[0.0; 4], vec![]).unwrap();
    let points = ring().reference_points_body();
    let error = PaperScheme::new(&ring().body, model, points, &Initial::at_rest(10), STEP).unwrap_err();
    assert!(matches!(error, SetupError::Length { expected: 10, found: 4, .. }), "{error}");
    let load = smaller.half_sine([-100.0, 0.0, 0.0], [0.0, 1.0, 0.0], 1.0);
    let error = ModalModel::new(&ring().body, &[0.0; 10], vec![load]).unwrap_err();
    assert!(matches!(error, SetupError::Length { expected: 10, found: 4, .. }), "{error}");
}

#[test]
fn a_turn_beyond_2_pi_in_a_step_ends_the_motion_and_keeps_the_state() {
    let omega = Vector3::new(0.0, 2e5, 0.0);
    let mut scheme = start(&ring().spinning(omega), STEP).unwrap();
    let before = scheme.state().clone();
    let error = scheme.next().unwrap().unwrap_err();
    let StepError::TurnTooLarge { time, step, angle } = error else { panic!("{error}") };
    assert_eq!((time, step), (0.0, STEP));
    assert!(angle > std::f64::consts::TAU, "{angle}");
    assert!(error.to_string().starts_with("at time 0: the body turns by"), "{error}");
    assert_eq!(scheme.state(), &before);
    assert!(scheme.next().is_none());
}

#[test]
fn a_motion_that_blows_up_says_when() {
    // 2.5 rad a step: far beyond what a first-order scheme follows, but within a turn.
    let mut scheme = start(&ring().spinning(Vector3::new(3e4, -3e4, 3e4)), STEP).unwrap();
    let mut last = scheme.state().clone();
    let mut error = None;
    for state in scheme.by_ref().take(100_000) {
        match state {
            Ok(state) => last = state,
            Err(e) => error = Some(e),
        }
    }
    let Some(StepError::TurnTooLarge { time, .. } | StepError::NotFinite { time, .. }) = error else {
        panic!("{error:?}")
    };
    assert_eq!(time, last.time);
    assert_eq!(scheme.state(), &last);
    assert!(last.modal_velocity.iter().all(|y| y.is_finite()));
}
