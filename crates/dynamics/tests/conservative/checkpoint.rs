//! A run that is taken up again from a checkpoint goes on as if it had not stopped.

use std::sync::Arc;

use dynamics::{CheckpointError, LoadFn, Observation, Reached, Rows, SharedLoad, Simulation, StepControl};
use nalgebra::Vector3;
use reduced_body::ReducedBody;

use crate::common::plate;
use crate::run::{EXPONENTIAL, RKMK4, Run};

/// The first `most` rows that follow, and the checkpoint at the last of them.
fn rows(simulation: &mut Simulation, most: usize) -> (Vec<Observation>, Vec<u64>) {
    let mut rows = Vec::new();
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
    (rows, simulation.checkpoint().unwrap())
}

fn run() -> Run<'static> {
    let plate = plate();
    let initial = plate.spinning(Vector3::new(3.0, -2.0, 5.0));
    // A pulse with a discontinuity inside the run, between two rows.
    let loads = vec![plate.half_sine([-500.0, 0.0, 10.0], [20.0, 10.0, 30.0], 0.0123)];
    let points = vec![plate.point([500.0, 0.0, 10.0])];
    Run { damping_ratio: 0.02, loads, points, ..Run::free(plate, initial, 0.03) }
}

/// Conserved: the same bits with and without a checkpoint.
#[test]
fn every_method_goes_on_bit_for_bit() {
    let fixed = StepControl::Fixed(1e-5);
    let controlled = StepControl::Tolerance(1e-7);
    for (method, control) in [
        (frames_rk4::PAPER, fixed),
        (frames_rk4::LIMIT, fixed),
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

/// The action of a load of this name.
fn thrust(name: &str) -> SharedLoad {
    let point = plate().point([500.0, 0.0, 10.0]);
    Arc::new(LoadFn::new(name, move |_, applied| applied.force(&point, &Vector3::new(0.1, 0.0, 0.2))))
}

#[test]
fn a_checkpoint_of_another_run_is_refused_and_the_error_names_what_differs() {
    let control = StepControl::Fixed(1e-5);
    let begin = |run: &Run, method| run.start(method, control, Rows::Interval(0.001));
    let mut original = run();
    original.loads.push(thrust("thrust"));
    let (_, checkpoint) = rows(&mut begin(&original, EXPONENTIAL), 5);
    assert!(begin(&original, EXPONENTIAL).restored(&checkpoint).is_ok());
    let refused = |run: &Run, method| match begin(run, method).restored(&checkpoint).unwrap_err() {
        CheckpointError::Changed { what } => what,
        other => panic!("{other}"),
    };
    let changed = |change: &dyn Fn(&mut Run)| {
        let mut run = original.clone();
        change(&mut run);
        refused(&run, EXPONENTIAL)
    };
    let plate = plate();
    assert_eq!(
        changed(&|run| run.loads[0] = plate.half_sine([-500.0, 0.0, 10.0], [20.0, 10.0, 31.0], 0.0123)),
        "load 1"
    );
    assert_eq!(
        changed(&|run| run.loads[0] = plate.half_sine([-500.0, 0.0, 10.0], [20.0, 10.0, 30.0], 0.0124)),
        "load 1"
    );
    assert_eq!(changed(&|run| run.loads[1] = thrust("drag")), "load 2");
    assert_eq!(changed(&|run| run.loads.truncate(1)), "the number of loads");
    assert_eq!(changed(&|run| run.damping_ratio = 0.021), "the damping");
    assert_eq!(changed(&|run| run.initial.omega.x = 3.1), "the start");
    assert_eq!(changed(&|run| run.end = 0.04), "the scheme or its steps");
    assert_eq!(refused(&original, frames_rk4::PAPER), "the scheme or its steps");
    // The last bit of one number of the body.
    let mut constants = (*plate.body).clone();
    let entry = &mut constants.gyroscopic[1][(3, 7)];
    *entry = f64::from_bits(entry.to_bits() ^ 1);
    let other = ReducedBody::from_constants(constants).unwrap();
    assert_eq!(refused(&Run { body: &other, ..original.clone() }, EXPONENTIAL), "the body");
}

#[test]
fn a_checkpoint_that_is_cut_or_too_long_or_holds_no_state_is_refused() {
    let start = || run().start(EXPONENTIAL, StepControl::Fixed(1e-5), Rows::Interval(0.001));
    let (_, checkpoint) = rows(&mut start(), 5);
    let words = checkpoint.len();
    for other in [&checkpoint[..words - 1], &[], &[checkpoint.as_slice(), &[0]].concat()] {
        let error = start().restored(other).unwrap_err();
        assert!(matches!(error, CheckpointError::Encoding(_)), "{error}");
    }
    // A list that claims 2⁶³ entries is refused without asking for the memory.
    let error = start().restored(&[u64::MAX; 100]).unwrap_err();
    assert!(matches!(error, CheckpointError::Encoding(_)), "{error}");
    // The time of the state, wherever it is.
    let time = start_of(&checkpoint, 0.005_f64).unwrap();
    for value in [f64::NAN, f64::INFINITY] {
        let mut bytes = to_bytes(&checkpoint);
        bytes[time..time + 8].copy_from_slice(&value.to_le_bytes());
        let error = start().restored(&to_words(&bytes)).unwrap_err();
        assert!(matches!(error, CheckpointError::State(_)), "{error}");
    }
    // A count of steps near 2⁶⁴ would overflow with the next step.
    let steps = start_of(&checkpoint, f64::from_bits(500)).unwrap();
    let mut bytes = to_bytes(&checkpoint);
    bytes[steps..steps + 8].copy_from_slice(&(u64::MAX - 1).to_le_bytes());
    let error = start().restored(&to_words(&bytes)).unwrap_err();
    assert!(matches!(error, CheckpointError::Value { what: "a count" }), "{error}");
}

fn to_bytes(words: &[u64]) -> Vec<u8> {
    words.iter().flat_map(|word| word.to_le_bytes()).collect()
}

fn to_words(bytes: &[u8]) -> Vec<u64> {
    bytes.as_chunks().0.iter().map(|word| u64::from_le_bytes(*word)).collect()
}

/// Where the bytes of a number are first.
fn start_of(words: &[u64], number: f64) -> Option<usize> {
    to_bytes(words).windows(8).position(|bytes| bytes == number.to_le_bytes())
}

/// Whatever the bytes are, there is an error or a run that can be stepped: no panic, no hang.
#[test]
fn no_byte_of_a_checkpoint_can_do_harm() {
    let patterns = [f64::INFINITY.to_bits(), 1e300_f64.to_bits(), u64::MAX, 63].map(u64::to_le_bytes);
    for control in [StepControl::Fixed(1e-5), StepControl::Tolerance(1e-7)] {
        let start = || run().start(EXPONENTIAL, control, Rows::Interval(0.001));
        let (_, checkpoint) = rows(&mut start(), 5);
        let whole = to_bytes(&checkpoint);
        for at in 0..whole.len() - 8 {
            for pattern in patterns.iter().map(|pattern| &pattern[..]).chain([&[0][..], &[1], &[255]]) {
                let mut spoilt = whole.clone();
                spoilt[at..at + pattern.len()].copy_from_slice(pattern);
                if let Ok(mut simulation) = start().restored(&to_words(&spoilt)) {
                    let _ = simulation.advance(3).and_then(|_| simulation.observation());
                }
            }
        }
    }
}
