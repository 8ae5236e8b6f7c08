//! Quantities that step control keeps within its tolerance.

use dynamics::{Effect, Observation, Rows, StepControl};
use model::Model;
use scene::{Body, Choice};

use super::step::example;

/// Largest errors of the attitude, of the modal coordinates and of the points' accelerations, the latter two relative to
/// the largest values, in a hundred rows, between which step control goes as far as it likes.
fn errors(model: &Model, scene: &Body, tolerance: f64, reference: f64) -> [f64; 3] {
    let method = *scene.method();
    let interval = scene.time.end / 100.0;
    let follow = |control| -> (Vec<Observation>, u64) {
        let mut simulation = model.start_with(scene, method, control, Rows::Interval(interval)).unwrap();
        let rows = simulation.by_ref().collect::<Result<Vec<_>, _>>().unwrap();
        (rows, simulation.stats().evaluations)
    };
    let (rows, evaluations) = follow(StepControl::Tolerance(tolerance));
    let (truth, _) = follow(StepControl::Fixed(reference));
    let largest = |of: &dyn Fn(&Observation, &Observation) -> f64| {
        rows.iter().zip(&truth).map(|(a, b)| of(a, b)).fold(0.0, f64::max)
    };
    let modal = |difference: bool| {
        largest(&|a, b| {
            let (a, b) = (&a.modal_displacement, &b.modal_displacement);
            a.iter().zip(b).map(|(a, b)| if difference { (a - b).abs() } else { b.abs() }).fold(0.0, f64::max)
        })
    };
    let acceleration = |difference: bool| {
        largest(&|a, b| {
            let of = |(a, b): (&dynamics::PointMotion, &dynamics::PointMotion)| {
                if difference { (a.acceleration - b.acceleration).norm() } else { b.acceleration.norm() }
            };
            a.points.iter().zip(&b.points).map(of).fold(0.0, f64::max)
        })
    };
    let found = [
        largest(&|a, b| a.attitude.angle_to(&b.attitude)),
        modal(true) / modal(false),
        acceleration(true) / acceleration(false),
    ];
    println!("{}: {tolerance:e}: {found:?} in {evaluations} evaluations", scene.title);
    found
}

/// Check of attitude and modal coordinates; accelerations of points, where many modes meet, may be off by `points` times the
/// tolerance.
fn check(body: &Body, tolerances: &[f64], reference: f64, points: f64) {
    let model = Model::build(body, |_| ()).unwrap();
    for &tolerance in tolerances {
        let [attitude, modal, acceleration] = errors(&model, body, tolerance, reference);
        assert!(attitude.max(modal) < tolerance, "{tolerance:e}: {attitude:e} {modal:e}");
        assert!(acceleration < points * tolerance, "{tolerance:e}: {acceleration:e}");
    }
}

/// Conserved: the same motion in steps of 1e-5 s.
#[test]
fn a_small_vibration_of_a_fast_spin_is_right_too() {
    check(&example("accuracy/spin"), &[1e-3, 1e-5, 1e-7], 1e-5, 3.0);
}

/// Conserved: the same motion in steps of 1e-5 s.
#[test]
fn of_a_plate_that_tumbles() {
    check(&example("accuracy/tumbling"), &[1e-3, 1e-5], 1e-5, 3.0);
}

/// Conserved: the same motion in steps of 1e-5 s.
#[test]
fn high_modes_that_a_load_strikes_are_right_in_a_pendulum() {
    let mut body = example("bar/pendulum");
    body.effects.choices[Effect::Flexibility] = Choice::On;
    body.time.end = 1.0;
    body.output.points = [("middle".into(), [200.0, 0.0, 0.0]), ("tip".into(), [400.0, 0.0, 0.0])].into();
    check(&body, &[1e-3, 1e-5], 1e-5, 3.0);
}
