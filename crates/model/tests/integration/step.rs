//! Estimated errors of the steps, against true ones.

use dynamics::{Effect, Observation, Reached, Rows, StepControl};
use model::Model;
use scene::{Body, Choice};

pub(super) fn example(name: &str) -> Body {
    Body::read(format!("{}/../../examples/{name}.toml", env!("CARGO_MANIFEST_DIR"))).unwrap()
}

fn motion(model: &Model, body: &Body, step: f64, interval: f64) -> Vec<Observation> {
    let (method, control) = (*body.method(), StepControl::Fixed(step));
    let mut simulation = model.start_with(body, method, control, Rows::Interval(interval)).unwrap();
    let mut rows = Vec::new();
    loop {
        match simulation.advance(u64::MAX) {
            Ok(Reached::Row) => {
                let Ok(row) = simulation.observation() else { return rows };
                rows.push(row);
            }
            Ok(Reached::End) | Err(_) => return rows,
            Ok(_) => {}
        }
    }
}

/// Errors of the attitude and of each modal coordinate, relative to the largest.
fn errors(rows: &[Observation], reference: &[Observation]) -> (f64, Vec<f64>) {
    let largest = |of: &dyn Fn(&Observation, &Observation) -> f64| {
        rows.iter().zip(reference).map(|(a, b)| of(a, b)).fold(0.0, f64::max)
    };
    let attitude = largest(&|a, b| a.attitude.angle_to(&b.attitude));
    let q = |o: &Observation, k: usize| o.modal_displacement[k];
    let nf = reference[0].modal_displacement.len();
    let peak = (0..nf).map(|k| largest(&|_, b| q(b, k).abs())).fold(0.0, f64::max);
    (attitude, (0..nf).map(|k| largest(&|a, b| (q(a, k) - q(b, k)).abs()) / peak).collect())
}

/// The estimates for some steps, against a run in steps of `reference`: at least a third of the true errors, and at most
/// `above` times as much.
fn check(body: &mut Body, steps: &[f64], reference: f64, above: f64) -> Vec<f64> {
    let model = Model::build(body, |_| ()).unwrap();
    let check = |step: &f64| {
        body.time.control = StepControl::Fixed(*step);
        body.rows = scene::Rows::EverySteps(1);
        let interval = step * (body.time.end / step / 200.0).ceil();
        let truth = motion(&model, body, reference, interval);
        let (attitude, modes) = errors(&motion(&model, body, *step, interval), &truth);
        let estimate = model.step_estimate(body).unwrap().unwrap();
        println!(
            "{step:e}: {} true {attitude:e} {:e}, estimated {:e} {:e} seen {} finer {}",
            body.title,
            modes.iter().copied().fold(0.0, f64::max),
            estimate.attitude,
            estimate.deformation(),
            estimate.seen,
            estimate.finer,
        );
        println!("   {}", estimate.in_words(1e-3));
        if estimate.failure.is_some() {
            assert!(motion(&model, body, *step, interval).len() < truth.len());
            return estimate.largest();
        }
        // What is off by more than 1 is lost, and by how much means nothing.
        let close =
            |estimated: f64, truth: f64| estimated >= truth.min(1.0) / 3.0 && estimated <= above * truth + 1e-10;
        assert!(close(estimate.attitude, attitude), "{step:e}: {:e} for {attitude:e}", estimate.attitude);
        for (k, (mode, truth)) in estimate.modes.iter().zip(&modes).enumerate() {
            let estimated = mode.error * mode.share;
            assert!(
                truth.max(estimated) < 1e-7 || close(estimated, *truth),
                "{step:e} {k}: {estimated:e} for {truth:e}"
            );
        }
        estimate.largest()
    };
    steps.iter().map(check).collect()
}

/// Independent reference: a run in short steps. The modes follow their own motion exactly at any step; their coupling
/// by the spin they do not.
#[test]
fn of_an_undamped_plate_that_tumbles() {
    let mut body = example("tumbling_plate");
    body.effects.choices[Effect::Damping] = Choice::Off;
    let found = check(&mut body, &[5e-3, 2e-3, 1e-3, 5e-4, 1e-4], 2.5e-5, 3.0);
    assert!(found[0] > 0.1 && found[2] > 0.1 && found[4] < 1e-2, "{found:?}");
    let found = check(&mut example("accuracy/tumbling"), &[5e-3, 1e-3, 5e-4], 2.5e-5, 3.0);
    assert!(found[0] > 1e-2 && found[1] < 1e-2, "{found:?}");
}

/// Independent reference: a run in short steps. A mode that turns by many radians in a step is as wrong in half of
/// it.
#[test]
fn of_modes_far_faster_than_the_steps() {
    let found = check(&mut example("accuracy/spin"), &[5e-3, 2.5e-3, 5e-4], 2.5e-5, 3.0);
    assert!(found[0] > 0.1 && found[2] < 1e-2, "{found:?}");
    let mut pendulum = example("bar/pendulum");
    pendulum.effects.choices[Effect::Flexibility] = Choice::On;
    let found = check(&mut pendulum, &[2e-2, 5e-3, 1e-3], 1e-4, 3.0);
    assert!(found[0] > 1e-2 && found[2] < 1e-2, "{found:?}");
}

/// Independent reference: a run in short steps.
#[test]
fn of_a_ring_that_spins_and_is_struck_and_of_a_rigid_pendulum() {
    let mut ring = example("ring");
    ring.initial.angular_velocity = [10.0, 50.0, 30.0];
    ring.time.end = 0.02;
    check(&mut ring, &[1e-3, 2e-4, 5e-5], 1e-6, 3.0);
    check(&mut example("pendulum"), &[1e-1, 2e-2, 5e-3], 1e-4, 3.0);
}

/// Independent reference: a run in short steps. Long runs: only the beginning is compared.
#[test]
fn of_a_run_too_long_to_be_made_three_times() {
    let mut body = example("accuracy/spin");
    body.time.end = 30.0;
    let found = check(&mut body, &[5e-4], 1.25e-4, 30.0);
    assert!(found[0] > 1e-2, "{found:?}");
    assert!(model_sees_less_than_all(&mut body));
}

fn model_sees_less_than_all(body: &mut Body) -> bool {
    let model = Model::build(body, |_| ()).unwrap();
    let estimate = model.step_estimate(body).unwrap().unwrap();
    estimate.seen < 1.0 && estimate.in_words(1e-3).contains("carried on")
}

/// A load at 50 kHz asks for steps of a microsecond, eight hundred million of them.
#[test]
fn of_a_load_far_faster_than_the_steps_only_the_beginning_is_compared() {
    let mut body = example("ring");
    body.modes.flexible = scene::Flexible::Count(1);
    (body.time.end, body.time.control) = (1000.0, StepControl::Fixed(0.01));
    body.rows = scene::Rows::Interval(1.0);
    body.loads[0].history = scene::History::Sine { frequency: 5e4, phase: 0.0, start: 0.0, duration: None };
    let model = Model::build(&body, |_| ()).unwrap();
    let seen = model.step_estimate(&body).unwrap().map_or(0.0, |estimate| estimate.seen);
    assert!(seen < 0.01, "{seen}");
}
