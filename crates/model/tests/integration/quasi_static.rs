//! Steps under step control where most of the body follows its loads: they are as long as the answer allows.

use dynamics::{Observation, Reached, Rows, StepControl};
use model::Model;
use scene::Body;

use crate::{CLAMPED, bar, build, parse};

/// Rows of a run under this control, and the number of its steps.
fn run(model: &Model, body: &Body, control: StepControl) -> (Vec<Observation>, u64) {
    let rows = Rows::Interval(body.time.end / 50.0);
    let mut simulation = model.start_with(body, *body.method(), control, rows).unwrap();
    let mut observations = Vec::new();
    loop {
        match simulation.advance(u64::MAX) {
            Ok(Reached::Row) => observations.push(simulation.observation().unwrap()),
            Ok(Reached::End) => return (observations, simulation.stats().accepted),
            Ok(_) => {}
            Err(error) => panic!("{control:?}: {error}"),
        }
    }
}

/// For each tolerance the largest error of a point by deformation, relative to the largest displacement of it, and the number
/// of steps.
fn errors_and_steps<const N: usize>(
    model: &Model,
    scene: &Body,
    tolerances: [f64; N],
    reference: f64,
) -> [(f64, u64); N] {
    let (truth, _) = run(model, scene, StepControl::Fixed(reference));
    let tip = |o: &Observation| o.points[2].elastic_displacement_body;
    let largest = truth.iter().map(|o| tip(o).norm()).fold(0.0, f64::max);
    tolerances.map(|tolerance| {
        let (found, steps) = run(model, scene, StepControl::Tolerance(tolerance));
        let error = found.iter().zip(&truth).map(|(a, b)| (tip(a) - tip(b)).norm()).fold(0.0, f64::max) / largest;
        println!("{}: {steps} steps, error {error:e}", scene.title);
        (error, steps)
    })
}

fn load(kind: &str, history: &str) -> String {
    format!(
        "[[loads]]\nkind = \"{kind}\"\nat = [200.0, 0.0, 0.0]\ndirection = [0.0, 0.3, 1.0]\namplitude = 2.0\nhistory = {history}\n"
    )
}

/// Conserved: the same motion in steps of 2e-4 s. A satellite that is turned slowly: its static shapes ring at
/// frequencies that no continuum of the body has, and nothing damps them.
#[test]
fn static_shapes_do_not_shorten_the_steps() {
    let slew = |history: &str, rest: &str, correction: bool| {
        parse(&format!(
            r#"
title = "Satellite"
units = {{ length = "m", mass = "kg", time = "s" }}
[body]
mesh = "../data/satellite.msh"
material = {{ young_modulus = 7e9, poisson_ratio = 0.3, density = 500.0 }}
[modes]
flexible = 10
static_correction = {correction}
[[loads]]
kind = "moment"
at = [0.0, 0.0, 0.5]
radius = 0.4
direction = [0.0, 1.0, 0.0]
amplitude = 10.0
history = {history}
{rest}
[time]
end = 10.0
tolerance = 1e-3
[output.points]
hub = [0.0, 0.0, 0.0]
root = [0.5, 0.0, 0.0]
tip = [3.5, 0.0, 0.0]
"#
        ))
    };
    let step = ("{ kind = \"step\", at = 0.0 }", "");
    let spinning = ("{ kind = \"half-sine\", duration = 10.0 }", "[initial]\nangular_velocity = [0.02, 0.1, 0.05]");
    for (history, rest) in [step, spinning] {
        let [with, without] = [true, false].map(|correction| {
            let body = slew(history, rest, correction);
            let model = build(&body);
            assert_eq!(model.static_shapes() > 0, correction);
            let [(error, steps)] = errors_and_steps(&model, &body, [1e-3], 2e-4);
            assert!(error < 1e-3, "{error:e}");
            steps
        });
        assert!(with < 2000 && 2 * with <= 3 * without, "{with} {without}");
    }
}

/// Conserved: the same motion in steps of 2e-5 s. A force rises over two thousand periods of the first mode, and its
/// stress stiffens the bar.
#[test]
fn a_slow_ramp_takes_steps_far_longer_than_the_periods() {
    for (damping, most) in
        [("", 200_000), ("\ndamping_ratio = 0.01", 2000), ("\ndamping_ratio = [30.0, 2.0, 0.01]", 20_000)]
    {
        let modes = format!("flexible = 4\nstatic_correction = true{damping}");
        let rest = format!(
            "[effects]\ngeometric_stiffening = true\n{CLAMPED}{}",
            load("force", "{ kind = \"ramp\", duration = 10.0 }")
        );
        let body = bar(&modes, &rest, "end = 10.0\ntolerance = 1e-6");
        let model = build(&body);
        assert!(model.is_stressed());
        let tolerances = [1e-3, 1e-6];
        for ((error, steps), tolerance) in errors_and_steps(&model, &body, tolerances, 2e-5).into_iter().zip(tolerances)
        {
            assert!(error < 1.5 * tolerance && steps < most, "{damping}: {steps} {error:e}");
        }
    }
}

/// Conserved: the same motion in steps of 1e-4 s. Jumps that the formula does not name as corners, and a corner of a
/// table that all but falls on a row.
#[test]
fn jumps_and_corners_anywhere_are_passed() {
    let at_row = |apart: f64| {
        let corner = 0.3 + apart;
        format!("{{ kind = \"table\", points = [[0.0, 0.0], [{corner:.17}, 1.0], [2.0, 0.5]] }}")
    };
    let formula = |text: &str| format!("{{ kind = \"expression\", formula = \"{text}\" }}");
    let formulas = ["floor(7.395*t+0.329)", "sign(sin(20*t))", "sign(t - 0.3)"].map(formula);
    for history in formulas.into_iter().chain([0.0, 1e-13, -1e-12, 1e-11, 1e-10, -1e-9, 1e-8].map(at_row)) {
        let rest = format!("{CLAMPED}{}", load("force", &history));
        let body =
            bar("flexible = 3\nstatic_correction = true\ndamping_ratio = 0.02", &rest, "end = 1.0\ntolerance = 1e-5");
        let [(error, steps)] = errors_and_steps(&build(&body), &body, [1e-5], 1e-4);
        assert!(error < 1e-4 && steps < 20_000, "{history}: {steps} {error:e}");
    }
}
