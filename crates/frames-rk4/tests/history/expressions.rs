//! Formulas in t against the same in Rust.

use std::f64::consts::{E, PI};

use frames_rk4::{Expression, History};

use crate::{at, formula, sides};

#[test]
fn formulas_mean_what_they_mean_in_mathematics() {
    type Law = fn(f64) -> f64;
    let cases: [(&str, Law); 26] = [
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
    ];
    for (text, law) in cases {
        let history = formula(text);
        for t in [0.3, 1.7, 4.25] {
            let (found, expected) = (at(&history, t), law(t));
            assert!((found - expected).abs() <= 4e-15 * expected.abs().max(1.0), "{text} at {t}: {found} {expected}");
        }
        assert!(history.corners().is_empty());
    }
}

#[test]
fn corners_that_are_named_split_the_law() {
    let saw = Expression::new("10*t - floor(10*t)", vec![0.3, 0.2, 0.1, 0.2]).unwrap();
    assert_eq!((saw.text(), saw.corners()), ("10*t - floor(10*t)", &[0.1, 0.2, 0.3][..]));
    let saw = History::Expression(saw);
    assert_eq!(saw.corners(), [0.1, 0.2, 0.3]);
    for corner in saw.corners() {
        let [before, after] = sides(&saw, corner);
        assert!((before - 1.0).abs() < 1e-14 && after.abs() < 1e-14, "{corner}: {before} {after}");
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
