//! Advice that only the body of a run can give.

use std::sync::Arc;

use advice::{Advice, AdviceError, Findings, Row, StressField, StressSource, advise, stress, stress_row};
use dynamics::{BodyField, Effect, FieldLoad, History, Initial, SharedLoad};
use faer::Mat;
use nalgebra::Vector3;

use crate::plate::{plate, spinning};

const TOLERANCE: f64 = 1e-3;

/// Advice on the plate that spins about y at `speed`.
fn spun(speed: f64) -> Advice {
    advise(&plate().case(&[0.0; 10], &[], &spinning([0.0, speed, 0.0]), 0.5), TOLERANCE).unwrap()
}

fn found(advice: &Advice) -> Findings {
    Findings { deflection: advice.deflection, stress: None, lacks_stretch: false, has_large_modes: false }
}

fn stiffening(influence: f64) -> Row {
    let why = "The stress of steady loads.".into();
    Row { value: 0.5, influence, on: influence >= TOLERANCE, why }
}

#[test]
fn nothing_found_changes_nothing_and_a_deflection_that_is_found_is_taken() {
    let advice = spun(10.0);
    assert_eq!(advice.clone().completed(found(&advice)), advice);
    let bent = advice.clone().completed(Findings { deflection: 0.3, ..found(&advice) });
    assert_eq!(bent, Advice { deflection: 0.3, ..advice });
}

#[test]
fn the_larger_of_two_reasons_for_stiffening_has_the_row() {
    let (still, fast) = (spun(0.0), spun(10.0));
    let row = |advice: &Advice, steady: Row| {
        let complete = advice.clone().completed(Findings { stress: Some(steady), ..found(advice) });
        complete.effects[Effect::GeometricStiffening].clone()
    };
    assert_eq!(row(&still, stiffening(0.2)), stiffening(0.2));
    let by_spin = &fast.effects[Effect::GeometricStiffening];
    assert!(by_spin.influence > 1e-6, "{by_spin:?}");
    assert_eq!(&row(&fast, stiffening(0.5 * by_spin.influence)), by_spin);
}

#[test]
fn a_stretch_that_is_lacking_is_said_only_where_it_matters() {
    let why = |speed: f64, lacks_stretch: bool| {
        let advice = spun(speed);
        let complete = advice.clone().completed(Findings { lacks_stretch, ..found(&advice) });
        (advice.stretch, complete.static_correction.why.contains("The answer lacks"))
    };
    let (fast, still) = (why(100.0, true), why(0.0, true));
    println!("{fast:?} {still:?}");
    assert!(fast.0 >= TOLERANCE && fast.1);
    assert!(still.0 < TOLERANCE && !still.1);
    assert!(!why(100.0, false).1);
}

/// A load with a history, which does nothing.
fn load(history: History) -> SharedLoad {
    let field = BodyField {
        force_body: Vector3::zeros(),
        moment_body: Vector3::zeros(),
        modal: vec![0.0; 16],
        force_change: Vec::new(),
        moment_change: vec![Vector3::zeros(); 10],
        load_stiffness: Vec::new(),
        second_order: None,
    };
    Arc::new(FieldLoad { field, history })
}

/// The row of a load whose stiffness is −`ratio` ω² in mode 3.
fn stressed(ratio: f64, zeta: f64, history: History) -> Row {
    let (initial, end) = (Initial::at_rest(10), 0.5);
    let omega = plate().body.circular_frequencies[2];
    let mut stiffness = Mat::zeros(10, 10);
    stiffness[(2, 2)] = -ratio * omega * omega;
    let (zeta, loads) = ([zeta; 10], [load(history)]);
    let field = StressField { name: "a test", source: StressSource::Load(0), stiffness: stiffness.as_ref() };
    let case = plate().case(&zeta, &loads, &initial, end);
    let found = stress(&case, &[field], TOLERANCE).unwrap();
    stress_row(&[field], &found, TOLERANCE).unwrap()
}

/// Closed form: a single mode: |K|/ω² is twice the shift of its frequency, which adds up for as long as it rings.
#[test]
fn the_stress_of_a_load_counts_as_the_phase_it_shifts() {
    let ratio = 1e-6;
    let omega = plate().body.circular_frequencies[2];
    let free = stressed(ratio, 0.0, History::Constant);
    let phase = 0.5 * ratio * omega * 0.5;
    assert!((free.value / ratio - 1.0).abs() < 1e-12 && (free.influence / phase - 1.0).abs() < 1e-12, "{free:?}");
    assert_eq!(free.on, phase >= TOLERANCE);
    assert!(free.why.contains("The stress of a test"), "{free:?}");
    let damped = stressed(ratio, 0.1, History::Constant);
    assert!((damped.influence / (0.5 * ratio / 0.1) - 1.0).abs() < 1e-12, "{damped:?}");
    // Of a load that acts for a tenth of the run, with a mean of 2/π.
    let pulse = stressed(ratio, 0.0, History::HalfSine { start: 0.1, duration: 0.05 });
    let expected = phase * 0.1 * 2.0 / std::f64::consts::PI;
    assert!((pulse.influence / expected - 1.0).abs() < 1e-3 && pulse.value == free.value, "{pulse:?}");
}

#[test]
fn a_stiffness_of_another_size_is_refused() {
    let (zeta, initial) = ([0.0; 10], Initial::at_rest(10));
    let small = Mat::zeros(9, 9);
    let field = StressField { name: "a test", source: StressSource::Drive, stiffness: small.as_ref() };
    let refused = stress(&plate().case(&zeta, &[], &initial, 1.0), &[field], TOLERANCE);
    assert!(matches!(refused, Err(AdviceError::Length { found: 9, expected: 10, .. })), "{refused:?}");
}
