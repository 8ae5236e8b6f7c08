//! Sizes and spectra against closed forms.

use std::f64::consts::{FRAC_2_PI, PI, TAU};

use dynamics::History;

use crate::{formula, table};

/// Boxcar from 0.3 to 1.1.
fn boxcar() -> History {
    History::Sine { frequency: 1e-9, phase: 0.5 * PI, start: 0.3, duration: Some(0.8) }
}

fn sinc(x: f64) -> f64 {
    if x == 0.0 { 1.0 } else { (PI * x).sin() / (PI * x) }
}

/// Closed form: ∫|h| dt.
#[test]
fn magnitudes_integrate_to_their_closed_forms() {
    let sine = History::Sine { frequency: 7.0, phase: 0.4, start: 0.0, duration: None };
    let cases = [
        (History::Constant, 3.0, 3.0),
        (History::Step { at: 1.0 }, 3.0, 2.0),
        (History::Step { at: 5.0 }, 3.0, 0.0),
        (History::Ramp { start: 1.0, duration: 4.0 }, 3.0, 0.5),
        (History::Ramp { start: 1.0, duration: 1.0 }, 3.0, 1.5),
        (History::HalfSine { start: 1.0, duration: 0.5 }, 3.0, 0.5 * FRAC_2_PI),
        (History::HalfSine { start: -0.25, duration: 0.5 }, 3.0, 0.25 * FRAC_2_PI),
        (sine, 100.0, 100.0 * FRAC_2_PI),
        (table(&[0.0, 1.0, 2.0], &[1.0, -1.0, -1.0]), 3.0, 2.5),
        (formula("exp(-t)"), 10.0, 1.0),
        (formula("sin(2*pi*50*t)"), 10.0, 10.0 * FRAC_2_PI),
        (History::Product { factors: vec![History::Step { at: 1.0 }, formula("-t")] }, 3.0, 4.0),
    ];
    for (history, end, expected) in cases {
        let found = history.magnitude_integral(end);
        assert!((found - expected).abs() <= 2e-4 * expected, "{history:?}: {found} {expected}");
    }
}

/// Closed form: max |h|.
#[test]
fn the_largest_magnitude_is_found_between_discontinuities() {
    let cases = [
        (History::Constant, 1.0, 1.0),
        (History::Step { at: 2.0 }, 1.0, 0.0),
        (History::Ramp { start: 0.0, duration: 4.0 }, 1.0, 0.25),
        (History::HalfSine { start: 0.1, duration: 0.77 }, 1.0, 1.0),
        (History::Sine { frequency: 333.3, phase: 0.1, start: 0.0, duration: None }, 1.0, 1.0),
        (History::Sweep { from: 0.0, to: 90.0, start: 0.0, duration: 1.0 }, 1.0, 1.0),
        (table(&[0.0, 0.2, 0.9], &[0.0, -5.0, 3.0]), 1.0, 5.0),
        (formula("5*t*exp(-5*t)"), 1.0, (-1.0_f64).exp()),
        (formula("exp(-((t - 0.3331)/1e-3)^2)"), 1.0, 1.0),
    ];
    for (history, end, expected) in cases {
        let found = history.largest(end);
        assert!((found - expected).abs() <= 1e-3 * expected, "{history:?}: {found} {expected}");
    }
}

const FREQUENCIES: [f64; 7] = [0.0, 0.013, 0.5, 1.0, 3.7, 55.0, 1234.5];

fn same(history: &History, end: f64, expected: impl Fn(f64) -> f64, bound: f64) {
    let scale = history.magnitude_integral(end);
    for f in FREQUENCIES {
        let (found, expected) = (history.amplitude_at(f, end), expected(f));
        assert!((found - expected).abs() <= bound * scale, "{history:?} at {f}: {found:e} {expected:e}");
    }
}

/// Closed form: |H| = 2T/π |cos πfT| / |1 − (2fT)²|.
#[test]
fn the_spectrum_of_a_half_sine() {
    let duration = 0.8;
    let pulse = History::HalfSine { start: 0.3, duration };
    let closed = |f: f64| {
        let ft: f64 = f * duration;
        duration * FRAC_2_PI * ((PI * ft).cos() / (1.0 - 4.0 * ft * ft)).abs()
    };
    same(&pulse, 2.0, closed, 1e-6);
    same(&formula("max(sin(pi*(t - 0.3)/0.8), 0)*min(max(ceil(1.1 - t), 0), 1)"), 1.1, closed, 1e-5);
    // At f = 1/2T both parts vanish: T/2.
    let found = pulse.amplitude_at(0.5 / duration, 2.0);
    assert!((found - 0.5 * duration).abs() < 1e-6, "{found}");
}

/// Closed form: |H| = T |sinc fT| of a boxcar, and of one that the end cuts off.
#[test]
fn the_spectrum_of_a_boxcar() {
    same(&boxcar(), 2.0, |f| 0.8 * sinc(0.8 * f).abs(), 1e-6);
    same(&History::Constant, 2.0, |f| 2.0 * sinc(2.0 * f).abs(), 1e-6);
    same(&History::Step { at: 1.2 }, 2.0, |f| 0.8 * sinc(0.8 * f).abs(), 1e-6);
    // The triangle of lines is that of a boxcar twice.
    same(&table(&[0.0, 0.8, 1.6], &[0.0, 1.0, 0.0]), 2.0, |f| 0.8 * sinc(0.8 * f).powi(2), 1e-6);
}

/// Closed form: T/2 of a sine at its own frequency over whole cycles, at others e.g. by the difference of two sincs.
#[test]
fn the_spectrum_of_a_sine_peaks_at_half_its_length() {
    let (frequency, end) = (12.5, 4.0);
    let sine = History::Sine { frequency, phase: 0.0, start: 0.0, duration: None };
    for history in [sine, formula("sin(2*pi*12.5*t)")] {
        let found = history.amplitude_at(frequency, end);
        assert!((found - 0.5 * end).abs() < 1e-5, "{found}");
        assert!(history.amplitude_at(frequency + 1.0 / end, end) < 1e-5);
        // ∫ sin(at) e^(−ibt) over whole cycles of a: a (1 − e^(−ibT)) / (a² − b²)
        for f in [3.3, 11.1, 77.7] {
            let (a, b) = (TAU * frequency, TAU * f);
            let closed = (2.0 * a * (0.5 * b * end).sin() / (a * a - b * b)).abs();
            assert!((history.amplitude_at(f, end) - closed).abs() < 1e-5, "{f}");
        }
    }
}

/// Closed form: a table finer than the sine it follows, and a product that shifts a spectrum: ½ (H(f − g) − H(f +
/// g)).
#[test]
fn spectra_of_tables_and_products() {
    let times: Vec<f64> = (0..=10_000).map(|k| f64::from(k) * 4e-4).collect();
    let values: Vec<f64> = times.iter().map(|t| (TAU * 12.5 * t).sin()).collect();
    let found = table(&times, &values).amplitude_at(12.5, 4.0);
    // Interpolation takes (2π 12.5 · 4e-4)²/12 = 8.2e-5 of it.
    assert!((found / 2.0 - 1.0 + 8.2e-5).abs() < 1e-6, "{found}");
    let burst = History::Product {
        factors: vec![
            History::Sine { frequency: 40.0, phase: 0.0, start: 0.0, duration: None },
            History::HalfSine { start: 0.0, duration: 1.0 },
        ],
    };
    // At its own frequency: half of the pulse's 2T/π, but for the mirrored part at 80, below 3e-5.
    assert!((burst.amplitude_at(40.0, 1.0) - 1.0 / PI).abs() < 3e-5);
}

#[test]
fn nothing_is_walked_without_a_length() {
    for end in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        assert_eq!((History::Constant.largest(end), History::Constant.amplitude_at(1.0, end)), (0.0, 0.0));
    }
}

/// Closed form: bounds of a sine of ten billion cycles: a walk with 1e6 panels steps from zero to zero, and with
/// sixteen panels a cycle for each of a thousand stretches it would not end.
#[test]
fn what_is_too_fast_to_be_walked_along_has_a_bound() {
    let sine = |frequency: f64| History::Sine { frequency, phase: 0.0, start: 0.0, duration: None };
    for frequency in [1e10, 1e12, 1e300] {
        assert_eq!((sine(frequency).largest(2.0), sine(frequency).magnitude_integral(2.0)), (1.0, 2.0));
    }
    let times: Vec<f64> = (0..1000).map(|k| 2e-3 * f64::from(k)).collect();
    let values: Vec<f64> = (0..1000).map(|k| f64::from(k % 7) - 4.0).collect();
    let product = History::Product { factors: vec![table(&times, &values), sine(1e300), formula("3*exp(-t)")] };
    product.check_over(2.0).unwrap();
    assert!((product.largest(2.0) - 12.0).abs() < 0.01, "{}", product.largest(2.0));
}

/// Independent reference: central differences.
#[test]
fn the_rate_of_a_product_is_that_of_differences() {
    let factors: Vec<History> = (1..=5).map(|k| History::Ramp { start: -0.2 * f64::from(k), duration: 3.0 }).collect();
    let product = History::Product {
        factors: vec![History::Product { factors: factors.clone() }, formula("cos(3*t)"), History::Constant],
    };
    for t in [0.1, 0.7, 1.3] {
        let h = 1e-4;
        let difference = (product.at(t + h, t) - product.at(t - h, t)) / (2.0 * h);
        let off = (product.rate(t, t) - difference).abs();
        // Measured: 3e-10.
        assert!(off < 1e-7, "{off:e}");
    }
}
