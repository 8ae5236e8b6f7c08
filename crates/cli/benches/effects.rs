//! Cost of each effect, per step and in set-up: the plate of `examples/effects` with forty modes, each effect taken
//! off in turn.
//!
//! The last rows are the plate with ten modes, without large ones, and with two of them large, which three follow: both in the
//! same steps, with their ratio.
//!
//! `cargo bench -p flexframe-cli --bench effects`. The time of a step is that of the loop alone on one core, the shortest of
//! several runs; set-up is what comes after mesh and matrices.

use std::path::Path;
use std::time::{Duration, Instant};

use flexframe::dynamics::{ConservativeBody, Reached, Rows, StepControl};
use flexframe::model::Model;
use flexframe::scene::{Body, Choice, Effect, Flexible, Large};

const STEP: f64 = 1e-4;
const RUNS: usize = 15;

fn main() {
    let read = |name: &str| {
        let file = format!("examples/effects/{name}.toml");
        Body::read(Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../..")).join(file)).expect("the scene is there")
    };
    let full = read("full");
    let without = |effect: Effect| {
        let mut given = full.clone();
        given.effects.choices[effect] = Choice::Off;
        given
    };
    let mut uncorrected = full.clone();
    uncorrected.modes.static_correction = Choice::Off;
    let mut ten = full.clone();
    ten.modes.flexible = Flexible::Count(10);
    ten.modes.static_correction = Choice::Off;
    let mut large = ten.clone();
    large.modes.large = Some(Large::Count(2));
    large.modes.following = 3;
    large.effects.choices[Effect::LargeDeflection] = Choice::On;
    let rows = [
        ("everything", full.clone()),
        ("without damping", without(Effect::Damping)),
        ("without gravity", without(Effect::Gravity)),
        ("without deformed inertia", without(Effect::DeformedInertia)),
        ("without Coriolis", without(Effect::Coriolis)),
        ("without geometric stiffening", without(Effect::GeometricStiffening)),
        ("without static correction", uncorrected),
        ("without translation", without(Effect::Translation)),
        ("without rotation", read("translation")),
        ("without flexibility", read("rigid")),
        ("ten modes", ten),
        ("ten modes, two large, three after", large),
    ];
    println!("what each effect costs per step and in set-up, best of {RUNS} runs of 1000 steps\n");
    println!(
        "{:<34}{:>8}{:>10}{:>14}{:>10}{:>12}{:>14}{:>16}",
        "", "shapes", "entries", "evaluations", "step, us", "modes, ms", "statics, ms", "reduction, ms"
    );
    let (mut of_full, mut of_ten) = (None, None);
    for (name, given) in rows {
        let model = Model::build(&given, |_| ()).expect("the model is built");
        let loads = model.loads().to_vec();
        let body = ConservativeBody::new(&model.body, model.damping_ratios(), loads, &model.physics);
        let entries = body.expect("the body is made").matrix_entries();
        let (step, evaluations) = measure(&model, &given);
        let whole = *of_full.get_or_insert(step);
        if name == "ten modes" {
            of_ten = Some(step);
        }
        let ms = |time: Duration| 1e3 * time.as_secs_f64();
        println!(
            "{name:<34}{:>8}{entries:>10}{evaluations:>14.1}{step:>10.3}{:>12.1}{:>14.1}{:>16.1}   {:.1} x cheaper a step",
            model.body.flexible(),
            ms(model.times.modes),
            ms(model.times.statics),
            ms(model.times.reduction),
            whole / step,
        );
        if let Some(ten) = of_ten {
            println!("{:<34}{:.2} times the step of ten modes without large ones", "", step / ten);
        }
    }
}

/// Microseconds a step, and evaluations a step.
fn measure(model: &Model, body: &Body) -> (f64, f64) {
    let method = *body.method();
    let simulation = model
        .start_with(body, method, StepControl::Fixed(STEP), Rows::EverySteps(u64::MAX))
        .expect("the motion starts");
    let mut shortest = Duration::MAX;
    let mut stats = simulation.stats();
    for _ in 0..RUNS {
        let mut simulation = simulation.clone();
        let started = Instant::now();
        while simulation.advance(u64::MAX).expect("every step succeeds") != Reached::End {}
        shortest = shortest.min(started.elapsed());
        stats = simulation.stats();
    }
    let steps = stats.accepted as f64;
    (1e6 * shortest.as_secs_f64() / steps, stats.evaluations as f64 / steps)
}
