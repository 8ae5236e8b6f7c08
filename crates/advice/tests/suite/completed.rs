//! What only the body that a run is made with tells.

use advice::{Advice, AdviceError, Findings, Row, advise, steady_stress};
use faer::Mat;
use frames_rk4::{Effect, Initial};

use crate::plate::{plate, spinning};

const TOLERANCE: f64 = 1e-3;

/// Of the plate that spins about y at `speed`.
fn spun(speed: f64) -> Advice {
    advise(&plate().case(&[0.0; 10], &[], &spinning([0.0, speed, 0.0]), 0.5), TOLERANCE).unwrap()
}

fn found(advice: &Advice) -> Findings {
    Findings { deflection: advice.deflection, steady_stress: None, lacks_stretch: false }
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
        let complete = advice.clone().completed(Findings { steady_stress: Some(steady), ..found(advice) });
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
        (advice.stretch, complete.static_correction.why.contains("lacks what the spin stretches"))
    };
    let (fast, still) = (why(100.0, true), why(0.0, true));
    println!("{fast:?} {still:?}");
    assert!(fast.0 >= TOLERANCE && fast.1);
    assert!(still.0 < TOLERANCE && !still.1);
    assert!(!why(100.0, false).1);
}

/// Of one mode: |K|/ω² is twice the shift of its frequency, which adds up for as long as it rings.
#[test]
fn the_stress_of_steady_loads_counts_as_the_phase_it_shifts() {
    let (initial, end) = (Initial::at_rest(10), 0.5);
    let omega = plate().body.circular_frequencies[2];
    let ratio = 1e-6;
    let mut stiffness = Mat::zeros(10, 10);
    stiffness[(2, 2)] = -ratio * omega * omega;
    let row = |zeta: f64| {
        let zeta = [zeta; 10];
        steady_stress(&plate().case(&zeta, &[], &initial, end), stiffness.as_ref(), TOLERANCE).unwrap()
    };
    let free = row(0.0);
    let phase = 0.5 * ratio * omega * end;
    println!("{free:?} {phase}");
    assert!((free.value / ratio - 1.0).abs() < 1e-12 && (free.influence / phase - 1.0).abs() < 1e-12, "{free:?}");
    assert_eq!(free.on, phase >= TOLERANCE);
    assert!((row(0.1).influence / (0.5 * ratio / 0.1) - 1.0).abs() < 1e-12, "{:?}", row(0.1));
}

#[test]
fn a_stiffness_of_another_size_is_refused() {
    let (zeta, initial) = ([0.0; 10], Initial::at_rest(10));
    let small = Mat::zeros(9, 9);
    let refused = steady_stress(&plate().case(&zeta, &[], &initial, 1.0), small.as_ref(), TOLERANCE);
    assert!(matches!(refused, Err(AdviceError::Length { found: 9, expected: 10, .. })), "{refused:?}");
}
