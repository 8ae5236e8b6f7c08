//! A run that is taken up again from a checkpoint goes on as if it had not stopped.

use frames_rk4::{Method, Observation, Reached, RestoreError, Rows, Simulation, StepControl};
use nalgebra::Vector3;

use crate::common::plate;
use crate::run::{EXPONENTIAL, RKMK4, Run};

/// The first `most` rows that follow, and the checkpoint at the last of them.
fn rows(simulation: &mut Simulation, most: usize) -> (Vec<Observation>, Vec<u64>) {
    let (mut rows, mut checkpoint) = (Vec::new(), Vec::new());
    while rows.len() < most {
        match simulation.advance(7).unwrap() {
            Reached::End => break,
            Reached::Between => {}
            Reached::Row => {
                rows.push(simulation.observation().unwrap());
            }
            other => panic!("{other:?}"),
        }
    }
    simulation.checkpoint(&mut checkpoint);
    (rows, checkpoint)
}

fn run() -> Run<'static> {
    let plate = plate();
    let initial = plate.spinning(Vector3::new(3.0, -2.0, 5.0));
    // A pulse with a corner inside the run, between two rows.
    let loads = vec![plate.half_sine([-500.0, 0.0, 10.0], [20.0, 10.0, 30.0], 0.0123)];
    let points = vec![plate.point([500.0, 0.0, 10.0])];
    Run { damping_ratio: 0.02, loads, points, ..Run::free(plate, initial, 0.03) }
}

#[test]
fn every_method_goes_on_bit_for_bit() {
    let fixed = StepControl::Fixed(1e-5);
    let controlled = StepControl::Tolerance(1e-7);
    for (method, control) in [
        (Method::PAPER, fixed),
        (Method::PAPER_RKMK4, fixed),
        (RKMK4, fixed),
        (EXPONENTIAL, fixed),
        (RKMK4, controlled),
        (EXPONENTIAL, controlled),
    ] {
        for every in [Rows::Interval(0.001), Rows::EverySteps(12)] {
            let start = || run().start(method, control, every);
            let mut whole = start();
            let (expected, end) = rows(&mut whole, usize::MAX);
            assert!(expected.len() > 5, "{}", expected.len());
            for stop in [0, 1, 11, 13, expected.len() / 2, expected.len()] {
                let (_, checkpoint) = rows(&mut start(), stop);
                let mut resumed = start().restored(&checkpoint).unwrap();
                let (found, checkpoint) = rows(&mut resumed, usize::MAX);
                // PartialEq of numbers; the states of the end are compared by their bits.
                assert_eq!(found, expected[stop.min(expected.len())..], "{method:?} {control:?} {every:?} {stop}");
                assert_eq!(checkpoint, end);
                assert_eq!(resumed.stats(), whole.stats());
            }
        }
    }
}

#[test]
fn a_checkpoint_of_another_run_is_refused() {
    let fixed = StepControl::Fixed(1e-5);
    let start = || run().start(EXPONENTIAL, fixed, Rows::Interval(0.001));
    let (_, checkpoint) = rows(&mut start(), 5);
    let words = checkpoint.len();
    assert!(start().restored(&checkpoint).is_ok());
    for other in [&checkpoint[..words - 1], &[], &[checkpoint.as_slice(), &[0]].concat()] {
        let found = other.len();
        let error = start().restored(other).unwrap_err();
        assert!(matches!(error, RestoreError::Length { found: f, .. } if f == found), "{error}");
    }
    let (_, of_paper) = rows(&mut run().start(Method::PAPER, fixed, Rows::Interval(0.001)), 5);
    assert!(matches!(start().restored(&of_paper), Err(RestoreError::Length { .. })));
    // The first word is the time, the next four are the attitude.
    for (word, value, what) in [(0, f64::NAN, "the time"), (1, 7.0, "the attitude"), (2, f64::NAN, "the attitude")] {
        let mut spoilt = checkpoint.clone();
        spoilt[word] = value.to_bits();
        assert_eq!(start().restored(&spoilt).unwrap_err(), RestoreError::Value { what });
    }
}

/// Whatever the words are, there is an error or a run that can be stepped: no panic, no hang.
#[test]
fn no_word_of_a_checkpoint_can_do_harm() {
    for control in [StepControl::Fixed(1e-5), StepControl::Tolerance(1e-7)] {
        let start = || run().start(EXPONENTIAL, control, Rows::Interval(0.001));
        let (_, checkpoint) = rows(&mut start(), 5);
        for word in 0..checkpoint.len() {
            for value in [0, 1, 63, 64, u64::MAX, f64::INFINITY.to_bits(), 1e300_f64.to_bits(), (-1.0_f64).to_bits()] {
                let mut spoilt = checkpoint.clone();
                spoilt[word] = value;
                if let Ok(mut simulation) = start().restored(&spoilt) {
                    for _ in 0..3 {
                        let _ = simulation.advance(20).and_then(|_| simulation.observation());
                    }
                }
            }
        }
    }
}
