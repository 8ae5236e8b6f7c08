//! Formulas in t against the same in Rust.

use std::f64::consts::{E, PI};

use dynamics::{Expression, History};

use crate::{at, formula, sides};

/// Independent reference: the same formulas in Rust.
#[test]
fn formulas_mean_what_they_mean_in_mathematics() {
    type Law = fn(f64) -> f64;
    let cases: [(&str, Law); 33] = [
        ("2", |_| 2.0),
        ("t", |t| t),
        ("-t^2", |t| -(t * t)),
        ("(-t)^2", |t| t * t),
        ("exp(-t^2)", |t| (-t * t).exp()),
        ("2^-t", |t| 2f64.powf(-t)),
        ("t^(2^2)", |t| t.powi(4)),
        ("(t^2)^3 - t^2*t^2", |t| t.powi(6) - t.powi(4)),
        ("1 - t - 2", |t| 1.0 - t - 2.0),
        ("1 - t + 2", |t| 1.0 - t + 2.0),
        ("8 / t / 2 * 3", |t| 8.0 / t / 2.0 * 3.0),
        ("1e-3*t + 2.5E+1", |t| 1e-3 * t + 25.0),
        ("2 t (t + 1)", |t| 2.0 * t * (t + 1.0)),
        ("5 % t", |t| 5.0 % t),
        ("sin(2*pi*3*t)*cos(t)", |t| (6.0 * PI * t).sin() * t.cos()),
        ("tan(t) + sinh(t) + cosh(t) + tanh(t)", |t| t.tan() + t.sinh() + t.cosh() + t.tanh()),
        ("asin(t/9) + acos(t/9) + atan(t)", |t| (t / 9.0).asin() + (t / 9.0).acos() + t.atan()),
        ("atan2(t, -2)", |t| t.atan2(-2.0)),
        ("sqrt(t) + cbrt(t)", |t| t.sqrt() + t.cbrt()),
        ("abs(1 - t)", |t| (1.0 - t).abs()),
        ("min(t, 1) + max(t, 1, 2)", |t| t.min(1.0) + t.max(2.0)),
        ("ln(t) + log2(t) + log10(t)", |t| t.ln() + t.log2() + t.log10()),
        ("e^t", |t| E.powf(t)),
        ("sign(1 - t)*hypot(t, 1)", |t| (1.0 - t).signum() * t.hypot(1.0)),
        ("floor(t) + ceil(t) + round(t) + trunc(t) + fract(t)", |t| {
            t.floor() + t.ceil() + t.round() + t.trunc() + t.fract()
        }),
        ("-sin(t)^2 * -1", |t| t.sin().powi(2)),
        ("t^2 t^3", |t| t.powi(5)),
        ("1/2 t", |t| 0.5 * t),
        (".5e-1t+2e+t sin(t)(t)", |t| 0.05 * t + 2.0 * E + t * t.sin() * t),
        ("-2 t + +--t", |t| -t),
        ("max(2) + min(3, t, 1, t)", |t| 2.0 + t.min(1.0)),
        ("2 pi t e", |t| 2.0 * PI * t * E),
        ("\tt\n* 2^-(t+1)", |t| t * 2f64.powf(-t - 1.0)),
    ];
    for (text, law) in cases {
        let history = formula(text);
        for t in [0.3, 1.7, 4.25] {
            let (found, expected) = (at(&history, t), law(t));
            assert!((found - expected).abs() <= 4e-15 * expected.abs().max(1.0), "{text} at {t}: {found} {expected}");
        }
        assert!(history.discontinuities().is_empty());
    }
}

#[test]
fn the_sign_of_zero_is_one_whatever_its_sign() {
    for text in ["sign(t)", "sign(-t)", "sign(0*t)"] {
        assert_eq!(at(&formula(text), 0.0), 1.0, "{text}");
    }
}

/// Closed form: the saw at its jumps.
#[test]
fn discontinuities_that_are_named_split_the_law() {
    let saw = Expression::new("10*t - floor(10*t)", vec![0.3, 0.2, 0.1, 0.2]).unwrap();
    assert_eq!((saw.text(), saw.discontinuities()), ("10*t - floor(10*t)", &[0.1, 0.2, 0.3][..]));
    let saw = History::Expression(saw);
    assert_eq!(saw.discontinuities(), [0.1, 0.2, 0.3]);
    for discontinuity in saw.discontinuities() {
        let [before, after] = sides(&saw, discontinuity);
        assert!((before - 1.0).abs() < 1e-14 && after.abs() < 1e-14, "{discontinuity}: {before} {after}");
    }
    assert!((saw.at(0.15, 0.15) - 0.5).abs() < 1e-15);
}

#[test]
fn expressions_are_equal_when_written_alike_and_go_to_other_threads() {
    let [a, b, c] = ["sin(t)", "sin(t)", "sin( t)"].map(formula);
    assert!(a == b && a != c && a.clone() == a);
    assert!(format!("{a:?}").contains("sin(t)"));
    let there = std::thread::spawn(move || at(&a, 2.0)).join().unwrap();
    assert_eq!(there, 2f64.sin());
}

/// Closed form: the derivatives.
#[test]
fn rates_are_the_closed_forms() {
    type Law = fn(f64) -> f64;
    let cases: [(&str, Law); 33] = [
        ("2", |_| 0.0),
        ("3 t - t/4 + 1", |_| 2.75),
        ("-t^2", |t| -2.0 * t),
        ("(t - 2)^3", |t| 3.0 * (t - 2.0).powi(2)),
        ("2^-t", |t| -2f64.ln() * 2f64.powf(-t)),
        ("t^t", |t| t.powf(t) * (t.ln() + 1.0)),
        ("e^(2 t)", |t| 2.0 * (2.0 * t).exp()),
        ("(1 + t)/(2 - t)", |t| 3.0 / (2.0 - t).powi(2)),
        ("5 % t", |t| -(5.0 / t).trunc()),
        ("(7 t) % 2", |_| 7.0),
        ("sin(2*pi*3*t)*cos(t)", |t| {
            let f = 6.0 * PI;
            f * (f * t).cos() * t.cos() - (f * t).sin() * t.sin()
        }),
        ("exp(-t/0.02)*sin(50 t)", |t| (-t / 0.02).exp() * (50.0 * (50.0 * t).cos() - 50.0 * (50.0 * t).sin())),
        ("tan(t)", |t| 1.0 + t.tan().powi(2)),
        ("asin(t/9)", |t| 1.0 / (81.0 - t * t).sqrt()),
        ("acos(t/9)", |t| -1.0 / (81.0 - t * t).sqrt()),
        ("atan(t^2)", |t| 2.0 * t / (1.0 + t.powi(4))),
        ("atan2(t, -2)", |t| -2.0 / (4.0 + t * t)),
        ("atan2(3, t)", |t| -3.0 / (9.0 + t * t)),
        ("sinh(t) + 2 cosh(t)", |t| t.cosh() + 2.0 * t.sinh()),
        ("tanh(3 t)", |t| 3.0 / (3.0 * t).cosh().powi(2)),
        ("ln(3 t)", |t| 1.0 / t),
        ("log2(t)", |t| 1.0 / (t * 2f64.ln())),
        ("log10(t)", |t| 1.0 / (t * 10f64.ln())),
        ("sqrt(t)", |t| 0.5 / t.sqrt()),
        ("cbrt(t)", |t| t.powf(-2.0 / 3.0) / 3.0),
        ("abs(1 - t^2)", |t| 2.0 * t * (t - 1.0).signum()),
        ("sign(1 - t) t", |t| (1.0 - t).signum()),
        ("hypot(t, 3)", |t| t / t.hypot(3.0)),
        ("min(t^2, 4)", |t| if t < 2.0 { 2.0 * t } else { 0.0 }),
        ("max(t, 2 t - 1, 3)", |t| if 2.0 * t - 1.0 > 3.0 { 2.0 } else { 0.0 }),
        ("floor(9 t) + ceil(9 t) + round(9 t) + trunc(9 t)", |_| 0.0),
        ("fract(t^2)", |t| 2.0 * t),
        ("sqrt(max(0, t - 2))", |t| if t < 2.0 { 0.0 } else { 0.5 / (t - 2.0).sqrt() }),
    ];
    for (text, law) in cases {
        let history = formula(text);
        for t in [0.3, 1.7, 4.25] {
            let (found, expected) = (history.rate(t, t), law(t));
            assert!((found - expected).abs() <= 1e-12 * expected.abs(), "{text} at {t}: {found} {expected}");
        }
    }
}

/// Closed form: ω cos ωt, however many cycles there are: differences over a part of the run would see nothing of
/// them.
#[test]
fn the_rate_of_a_fast_formula_is_as_exact() {
    let history = formula("sin(1e9*t)");
    for t in [1e-9_f64, 0.1, 7.3] {
        let expected = 1e9 * (1e9 * t).cos();
        assert!((history.rate(t, t) - expected).abs() <= 1e-12 * 1e9, "{t}");
    }
}

/// Closed form: the mean of both derivatives.
#[test]
fn at_a_kink_without_a_discontinuity_the_rate_is_the_mean_of_both_sides() {
    let cases = [("abs(t - 1)", 0.0), ("min(t, 1)", 0.5), ("max(3 t, t + 2)", 2.0), ("hypot(t - 1, 0)", 0.0)];
    for (text, mean) in cases {
        assert_eq!(formula(text).rate(1.0, 1.0), mean, "{text}");
    }
    // What stands still has no rate, whatever it passes through; a power of zero has that of the polynomial.
    for (text, t, rate) in [("sqrt(0 t)", 1.0, 0.0), ("t^2", 0.0, 0.0), ("t^1", 0.0, 1.0), ("t^0", 0.0, 0.0)] {
        assert_eq!(formula(text).rate(t, t), rate, "{text}");
    }
}
