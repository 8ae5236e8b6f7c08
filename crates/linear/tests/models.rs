//! Linear models of oscillators against closed forms.

use std::f64::consts::TAU;

use linear::faer::{Mat, c64};
use linear::{Channel, Damping, LinearError, Output, RandomInput, Rate, SecondOrder};

fn channels(count: usize) -> Vec<Channel> {
    (1..=count).map(|k| Channel::new(format!("c{k}"), "")).collect()
}

/// Oscillators of unit mass by ω and ζ, each with all inputs and seen by each output as `rows` say.
fn oscillators(omega_zeta: &[[f64; 2]], forces: &[&[f64]], rows: &[(Rate, &[f64])]) -> SecondOrder {
    let n = omega_zeta.len();
    let diagonal =
        |of: &dyn Fn(&[f64; 2]) -> f64| Mat::from_fn(n, n, |i, j| if i == j { of(&omega_zeta[i]) } else { 0.0 });
    let output =
        |(rate, row): &(Rate, &[f64])| Output { channel: Channel::new("y", ""), rate: *rate, row: row.to_vec() };
    SecondOrder {
        stiffness: diagonal(&|[omega, _]| omega * omega),
        damping: diagonal(&|[omega, zeta]| 2.0 * zeta * omega),
        forces: Mat::from_fn(n, forces[0].len(), |i, j| forces[i][j]),
        inputs: channels(forces[0].len()),
        outputs: rows.iter().map(output).collect(),
        coordinates: channels(n),
    }
}

/// A small pseudo-random number in (−1, 1).
fn noise(seed: &mut u64) -> f64 {
    *seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
    (*seed >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
}

/// A model of coupled, damped oscillators.
fn random_model(n: usize, m: usize, p: usize, seed: &mut u64) -> SecondOrder {
    let omega_zeta: Vec<[f64; 2]> =
        (0..n).map(|_| [10.0_f64.powf(1.0 + noise(seed)), 0.05 + 0.045 * noise(seed)]).collect();
    let forces: Vec<Vec<f64>> = (0..n).map(|_| (0..m).map(|_| noise(seed)).collect()).collect();
    let rows: Vec<Vec<f64>> = (0..p).map(|_| (0..n).map(|_| noise(seed)).collect()).collect();
    let rates = [Rate::Place, Rate::Velocity, Rate::Acceleration];
    let mut model = oscillators(
        &omega_zeta,
        &forces.iter().map(Vec::as_slice).collect::<Vec<_>>(),
        &rows.iter().enumerate().map(|(k, row)| (rates[k % 3], row.as_slice())).collect::<Vec<_>>(),
    );
    // Gyroscopic forces take and give no energy.
    for i in 0..n {
        for j in 0..i {
            let g = noise(seed);
            model.damping[(i, j)] += g;
            model.damping[(j, i)] -= g;
        }
    }
    model
}

/// Closed form: 1/(ω₀² − ω² + 2iζω₀ω), times iω and −ω²; and K(1 + ig) of structural damping.
#[test]
fn an_oscillator_responds_as_its_closed_form() {
    let (omega, zeta) = (3.0, 0.02);
    let rows: [(Rate, &[f64]); 3] = [(Rate::Place, &[2.0]), (Rate::Velocity, &[2.0]), (Rate::Acceleration, &[2.0])];
    let model = oscillators(&[[omega, zeta]], &[&[5.0]], &rows);
    let frequencies = [0.0, 0.1, omega / TAU, 2.0];
    let found = model.frequency_response(&frequencies, Damping::OfEquations).unwrap();
    for (f, values) in frequencies.iter().zip(&found.values) {
        let w = TAU * f;
        let place = c64::new(10.0, 0.0) / c64::new(omega * omega - w * w, 2.0 * zeta * omega * w);
        let expected = [place, place * c64::new(0.0, w), place * -(w * w)];
        for (i, expected) in expected.into_iter().enumerate() {
            assert!((values[(i, 0)] - expected).norm() <= 1e-13 * expected.norm(), "{f} {i}");
        }
        let through_states = model.state_space().unwrap().response(w).unwrap();
        assert!((&through_states - values).norm_l2() <= 1e-12 * values.norm_l2());
    }
    let structural = model.frequency_response(&[0.7], Damping::Structural(0.1)).unwrap();
    let w = TAU * 0.7;
    let expected = c64::new(10.0, 0.0) / c64::new(omega * omega - w * w, 0.1 * omega * omega);
    assert!((structural.values[0][(0, 0)] - expected).norm() <= 1e-13 * expected.norm());
}

/// Independent reference: the state space solved as a whole, of coupled coordinates.
#[test]
fn coupled_coordinates_respond_as_their_state_space() {
    let model = random_model(7, 2, 5, &mut 3);
    let space = model.state_space().unwrap();
    let frequencies: Vec<f64> = (0..50).map(|k| 0.3 * f64::from(k)).collect();
    let found = model.frequency_response(&frequencies, Damping::OfEquations).unwrap();
    for (f, values) in frequencies.iter().zip(&found.values) {
        let expected = space.response(TAU * f).unwrap();
        assert!((&expected - values).norm_l2() <= 1e-11 * expected.norm_l2(), "{f}");
    }
}

/// Closed form: poles −ζω ± iω√(1−ζ²).
#[test]
fn poles_are_those_of_the_oscillators() {
    let model = oscillators(&[[2.0, 0.1], [5.0, 0.01]], &[&[1.0], &[1.0]], &[(Rate::Place, &[1.0, 1.0])]);
    let poles = model.state_space().unwrap().poles().unwrap();
    for (pole, (omega, zeta)) in poles.chunks(2).zip([(2.0_f64, 0.1_f64), (5.0, 0.01)]) {
        let expected = c64::new(-zeta * omega, omega * (1.0 - zeta * zeta).sqrt());
        assert!(pole.iter().any(|pole| (pole - expected).norm() < 1e-12), "{pole:?} {expected}");
    }
}

/// Closed form: the variance of an oscillator under white noise of one-sided density S is π² S f₀ ... in rad, S/(8 ζ ω³).
#[test]
fn white_noise_gives_the_variance_of_its_closed_form() {
    let (omega, zeta, density) = (TAU * 5.0, 0.02, 0.3);
    let model = oscillators(&[[omega, zeta]], &[&[1.0]], &[(Rate::Place, &[1.0])]);
    let frequencies: Vec<f64> = (0..200_001).map(|k| 5e-4 * f64::from(k)).collect();
    let response = model.frequency_response(&frequencies, Damping::OfEquations).unwrap();
    let input = RandomInput::Independent(vec![vec![density]; frequencies.len()]);
    let found = &response.random(&input).unwrap()[0];
    // E[x²] = ∫₀^∞ S |H|² df = S / (8 ζ ω³), and of the rate ω² times that.
    let expected = (density / (8.0 * zeta * omega.powi(3))).sqrt();
    assert!((found.rms / expected - 1.0).abs() < 1e-4, "{} {expected}", found.rms);
    // The tail of the rate beyond 100 Hz is left out: ∫ S/(2πf)² df = S/(4π² · 100).
    let tail = density / (TAU * TAU * 100.0);
    let rate = ((expected * omega).powi(2) - tail).sqrt();
    assert!((found.rate_rms / rate - 1.0).abs() < 1e-4, "{} {rate}", found.rate_rms);
    assert!((found.crossings(0.0) - rate / (TAU * expected)).abs() < 1e-3);
}

#[test]
fn spectra_that_are_none_are_refused() {
    let model = oscillators(&[[1.0, 0.1]], &[&[1.0]], &[(Rate::Place, &[1.0])]);
    let response = model.frequency_response(&[0.1, 0.2], Damping::OfEquations).unwrap();
    for wrong in [vec![vec![-1.0]; 2], vec![vec![f64::NAN]; 2], vec![vec![1.0, 1.0]; 2]] {
        let error = response.random(&RandomInput::Independent(wrong)).unwrap_err();
        assert!(matches!(error, LinearError::Spectrum { frequency: 0.1, .. }), "{error}");
    }
    assert!(matches!(response.random(&RandomInput::Independent(vec![])), Err(LinearError::Size { .. })));
}

/// Closed form: inputs in step and of one density are one input; against each other they cancel.
#[test]
fn correlated_inputs_add_or_cancel() {
    let model = oscillators(&[[1.0, 0.1]], &[&[1.0, 1.0]], &[(Rate::Place, &[1.0])]);
    let frequencies = [0.1, 0.2, 0.3];
    let response = model.frequency_response(&frequencies, Damping::OfEquations).unwrap();
    let with = |coherence: f64| {
        let matrix = Mat::from_fn(2, 2, |i, j| c64::new(if i == j { 1.0 } else { coherence }, 0.0));
        response.random(&RandomInput::Correlated(vec![matrix; 3])).unwrap()[0].rms
    };
    let apart = response.random(&RandomInput::Independent(vec![vec![1.0; 2]; 3])).unwrap()[0].rms;
    assert!((with(1.0) / apart - 2.0_f64.sqrt()).abs() < 1e-12);
    assert!(with(-1.0) < 1e-12 * apart && (with(0.0) / apart - 1.0).abs() < 1e-12);
}

/// Independent reference: the largest singular value of the difference at 400 frequencies, of 100 models of all orders, against the bound.
#[test]
fn balanced_truncation_is_within_its_bound() {
    let mut seed = 7;
    let mut closest = 0.0_f64;
    for _ in 0..100 {
        let model = random_model(6, 2, 3, &mut seed);
        let space = model.state_space().unwrap();
        let order = 2 + (noise(&mut seed).abs() * 9.0) as usize;
        let reduced = space.balanced(order).unwrap();
        assert!(reduced.model.poles().unwrap().iter().all(|pole| pole.re < 0.0));
        let mut largest = 0.0_f64;
        for k in 0..400 {
            let w = 10.0_f64.powf(-1.0 + 0.0085 * f64::from(k));
            let difference = space.response(w).unwrap() - reduced.model.response(w).unwrap();
            largest = largest.max(difference.singular_values().unwrap()[0]);
        }
        let rounding = 1e-9 * reduced.hankel_values[0];
        assert!(largest <= reduced.error_bound + rounding, "{largest:e} {:e}", reduced.error_bound);
        closest = closest.max(largest / reduced.error_bound.max(rounding));
    }
    // It is a bound that is nearly reached, not any large number.
    assert!(closest > 0.3, "{closest}");
}

#[test]
fn what_cannot_be_balanced_is_refused() {
    let undamped = oscillators(&[[1.0, 0.0]], &[&[1.0]], &[(Rate::Place, &[1.0])]).state_space().unwrap();
    assert!(matches!(undamped.balanced(1), Err(LinearError::NotStable { .. })));
    let unseen = oscillators(&[[1.0, 0.1]], &[&[1.0]], &[(Rate::Place, &[0.0])]).state_space().unwrap();
    assert!(matches!(unseen.balanced(1), Err(LinearError::Unconnected)));
    assert!(matches!(unseen.balanced(3), Err(LinearError::Order { found: 3, most: 2 })));
    let free = oscillators(&[[0.0, 0.0]], &[&[1.0]], &[(Rate::Place, &[1.0])]);
    let resonant = free.frequency_response(&[0.0], Damping::OfEquations);
    assert!(matches!(resonant, Err(LinearError::Resonance { frequency: 0.0 })));
}
