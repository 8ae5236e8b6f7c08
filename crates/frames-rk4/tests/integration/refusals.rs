//! A run that cannot start or go on is refused with what was found, and the state before it is kept.

use dynamics::{Initial, Motion, Physics, Rows, Setup, SetupError, Simulation, StepControl, StepError};
use frames_rk4::{ModalModel, Paper, PaperScheme};
use nalgebra::Vector3;

use crate::common::Synthesis as _;
use crate::common::ring;

const STEP: f64 = 5e-5;

fn start(initial: &Initial) -> Result<PaperScheme, SetupError> {
    let model = ModalModel::new(&ring().body, &[0.0; 10], vec![]).unwrap();
    PaperScheme::new(&ring().body, model, ring().reference_points_body(), initial)
}

/// Begins a run in steps of `step`.
fn run(initial: &Initial, step: f64) -> Result<Simulation, SetupError> {
    Simulation::new(&Setup {
        body: &ring().body,
        damping_ratios: &[0.0; 10],
        loads: &[],
        physics: &Physics::default(),
        initial,
        method: &Paper { reference_points: ring().reference_points_body() },
        control: StepControl::Fixed(step),
        end: 1.0,
        rows: Rows::EverySteps(1),
        points: &[],
    })
}

#[test]
fn lists_of_the_wrong_length() {
    let wrong = |error: SetupError, length: usize| {
        let SetupError::Length { expected, found, .. } = error else { panic!("{error}") };
        assert_eq!((expected, found), (10, length));
    };
    wrong(ModalModel::new(&ring().body, &[0.0; 9], vec![]).unwrap_err(), 9);
    let at_rest = Initial::at_rest(10);
    wrong(start(&Initial { modal_displacement: vec![0.0; 11], ..at_rest.clone() }).unwrap_err(), 11);
    wrong(start(&Initial { modal_velocity: vec![], ..at_rest }).unwrap_err(), 0);
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
            refused(start(&initial).unwrap_err(), value);
        }
        refused(run(&at_rest, value).unwrap_err(), value);
    }
    for step in [0.0, -1e-4] {
        refused(run(&Initial::at_rest(10), step).unwrap_err(), step);
    }
    for duration in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        let load = ring().half_sine([-100.0, 0.0, 0.0], [0.0, 1.0, 0.0], duration);
        refused(ModalModel::new(&ring().body, &[0.0; 10], vec![load]).unwrap_err(), duration);
    }
    let load = ring().pulse([-100.0, 0.0, 0.0], [0.0, 1.0, 0.0], f64::NAN, 1.0);
    refused(ModalModel::new(&ring().body, &[0.0; 10], vec![load]).unwrap_err(), f64::NAN);
}

#[test]
fn reference_points_on_a_line() {
    let model = ModalModel::new(&ring().body, &[0.0; 10], vec![]).unwrap();
    let line = [0.0, 1.0, 2.0].map(|s| Vector3::new(s, 2.0 * s, -s));
    let error = PaperScheme::new(&ring().body, model, line, &Initial::at_rest(10)).unwrap_err();
    assert!(matches!(error, SetupError::CollinearPoints(points) if points.sine < 1e-6), "{error}");
}

#[test]
fn a_model_or_a_load_of_another_body() {
    let smaller = ring().truncated(4);
    let model = ModalModel::new(&smaller.body, &[0.0; 4], vec![]).unwrap();
    let points = ring().reference_points_body();
    let error = PaperScheme::new(&ring().body, model, points, &Initial::at_rest(10)).unwrap_err();
    assert!(matches!(error, SetupError::Length { expected: 10, found: 4, .. }), "{error}");
    let load = smaller.half_sine([-100.0, 0.0, 0.0], [0.0, 1.0, 0.0], 1.0);
    let error = ModalModel::new(&ring().body, &[0.0; 10], vec![load]).unwrap_err();
    assert!(matches!(error, SetupError::Length { expected: 10, found: 4, .. }), "{error}");
}

#[test]
fn a_turn_beyond_2_pi_in_a_step_ends_the_motion_and_keeps_the_state() {
    let omega = Vector3::new(0.0, 2e5, 0.0);
    let mut scheme = start(&ring().spinning(omega)).unwrap();
    let before = scheme.state().clone();
    let error = scheme.step(STEP, STEP).unwrap_err();
    let StepError::TurnTooLarge { time, step, angle } = error else { panic!("{error}") };
    assert_eq!((time, step), (0.0, STEP));
    assert!(angle > std::f64::consts::TAU, "{angle}");
    assert!(error.to_string().starts_with("at time 0: the body turns by"), "{error}");
    assert_eq!(scheme.state(), &before);
}

#[test]
fn a_motion_that_blows_up_says_when() {
    // 2.5 rad a step: far beyond what a first-order scheme follows, but within a turn.
    let mut scheme = ring().scheme(0.0, vec![], &ring().spinning(Vector3::new(3e4, -3e4, 3e4)), STEP);
    let mut last = scheme.state().clone();
    let error = loop {
        match scheme.step() {
            Ok(state) => last.clone_from(state),
            Err(error) => break error,
        }
    };
    // The attitude may be found lost before a number overflows.
    let (StepError::TurnTooLarge { time, .. } | StepError::NotFinite { time, .. } | StepError::Attitude { time, .. }) =
        error
    else {
        panic!("{error:?}")
    };
    assert_eq!(time, last.time);
    assert_eq!(scheme.state(), &last);
    assert!(last.modal_velocity.iter().all(|y| y.is_finite()));
}
