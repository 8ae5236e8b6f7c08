//! Each way to say how the modes are damped.

use std::f64::consts::TAU;

use crate::{CLAMPED, Model, bar, build, close, observations};

const TIME: &str = "end = 1e-2\nstep = 1e-4";
/// Without [effects] a mode that nothing moves would lose its damping as one that is not worth it.
const KEPT: &str = "[effects]\ndamping = true\n";

fn model(damping: &str) -> Model {
    build(&bar(&format!("flexible = 5\n{damping}"), &format!("{KEPT}{CLAMPED}"), TIME))
}

/// Closed form: the formulas of each kind of damping.
#[test]
fn ratios_are_those_of_the_formulas() {
    assert_eq!(model("").damping_ratios(), [0.0; 5]);
    assert_eq!(model("damping_ratio = 0.02").damping_ratios(), [0.02; 5]);
    assert_eq!(model("damping_ratio = [0.01, 0.02, 0.03]").damping_ratios(), [0.01, 0.02, 0.03, 0.03, 0.03]);

    let rayleigh = model("rayleigh = { alpha = 20.0, beta = 1e-6 }");
    for (ratio, omega) in rayleigh.damping_ratios().iter().zip(&rayleigh.body.circular_frequencies) {
        close(*ratio, 20.0 / (2.0 * omega) + 1e-6 * omega / 2.0, 1e-14);
    }

    // The first two frequencies are alike, near 205; the last lies beyond the table.
    let table = model("damping_table = [[100.0, 0.01], [300.0, 0.05], [2000.0, 0.02]]");
    let expected = |frequency: f64| match frequency {
        f if f < 300.0 => 0.01 + 0.04 * (f - 100.0) / 200.0,
        f if f < 2000.0 => 0.05 - 0.03 * (f - 300.0) / 1700.0,
        _ => 0.02,
    };
    let frequencies = table.natural_frequencies();
    assert!(frequencies[0] < 300.0 && frequencies[2] > 300.0 && frequencies[2] < 2000.0 && frequencies[4] > 2000.0);
    for (ratio, frequency) in table.damping_ratios().iter().zip(frequencies) {
        close(*ratio, expected(frequency), 1e-12);
    }
}

#[test]
fn effects_switch_it_off() {
    let off = bar("flexible = 3\ndamping_ratio = 0.02", &format!("[effects]\ndamping = false\n{CLAMPED}"), TIME);
    assert_eq!(build(&off).damping_ratios(), [0.0; 3]);
}

/// Closed form: e^(−ζωt) cos(ω√(1−ζ²) t) of a mode that is let go.
#[test]
fn a_mode_decays_as_its_ratio_says() {
    let zeta: f64 = 0.05;
    let rest = format!("{KEPT}geometric_stiffening = false\n[initial]\nmodal_displacement = [1e-3]\n{CLAMPED}");
    let scene = bar(&format!("flexible = 2\ndamping_ratio = {zeta}"), &rest, "end = 0.02\nstep = 1e-4");
    let model = build(&scene);
    let omega = model.natural_frequencies()[0] * TAU;
    let damped = omega * (1.0 - zeta * zeta).sqrt();
    for row in observations(&scene, &model) {
        let t = row.time;
        let expected = 1e-3
            * (-zeta * omega * t).exp()
            * ((damped * t).cos() + zeta / (1.0 - zeta * zeta).sqrt() * (damped * t).sin());
        // Measured: 2e-17.
        assert!((row.modal_displacement[0] - expected).abs() < 1e-14, "{} at {t}", row.modal_displacement[0]);
    }
}
