//! Laws of the motion under step control, on a body that hardly turns or vibrates.

use std::sync::Arc;

use dynamics::{Initial, LoadFn, PointShapes, Rows, SharedLoad, StepControl};
use nalgebra::{Matrix3, Vector3};
use reduced_body::{BodyPoint, ReducedBody, RigidMotion};

use crate::run::{EXPONENTIAL, RKMK4, Run};

const MASS: f64 = 0.2;

fn ball() -> ReducedBody {
    ReducedBody::rigid(MASS, Vector3::zeros(), Matrix3::identity() * 1e-4, RigidMotion::free()).unwrap()
}

/// A force at the centre of mass by its place and velocity, global.
fn law(
    body: &ReducedBody,
    force: impl Fn(Vector3<f64>, Vector3<f64>) -> Vector3<f64> + Send + Sync + 'static,
) -> SharedLoad {
    let center = PointShapes::new(body, &BodyPoint::rigid(Vector3::zeros()));
    Arc::new(LoadFn::new("law", move |motion, applied| {
        let force_global = force(motion.position_global(&center), motion.velocity_global(&center));
        applied.force(&center, &(motion.body_from_global * force_global));
    }))
}

/// Place and velocity after 3 s of a ball that a law pushes, thrown by `velocity`, by both schemes at each tolerance, and evaluations.
fn check(
    force: impl Fn(Vector3<f64>, Vector3<f64>) -> Vector3<f64> + Send + Sync + Clone + 'static,
    velocity: Vector3<f64>,
    expected: [Vector3<f64>; 2],
) {
    let body = ball();
    for method in [EXPONENTIAL, RKMK4] {
        for (tolerance, most) in [(1e-4, 1500), (1e-6, 3000), (1e-8, 12_000)] {
            let run = Run {
                body: &body,
                reference_points: [Vector3::x(), Vector3::y(), Vector3::z()],
                damping_ratio: 0.0,
                loads: vec![law(&body, force.clone())],
                initial: Initial { velocity, ..Initial::at_rest(0) },
                end: 3.0,
                points: vec![],
            };
            let mut simulation = run.start(method, StepControl::Tolerance(tolerance), Rows::Interval(3.0));
            let last = simulation.by_ref().last().unwrap().unwrap();
            let found = [last.origin_global, last.velocity_global];
            let evaluations = simulation.stats().evaluations;
            let off = found.iter().zip(expected).map(|(found, expected)| (found - expected).norm()).fold(0.0, f64::max);
            let size = expected[1].norm().max(velocity.norm()).max(0.1);
            println!("{method:?} {tolerance:e}: {off:.1e} off, {evaluations} evaluations");
            assert!(off <= 3.0 * tolerance * size, "{tolerance}: {off:e} {size}");
            assert!(evaluations <= most, "{tolerance}: {evaluations}");
        }
    }
}

/// Closed form: v₀ exp(−ct/m).
#[test]
fn drag_slows_a_thrown_ball() {
    let (c, velocity) = (0.1, Vector3::new(20.0, 5.0, -3.0));
    let decay = f64::exp(-c * 3.0 / MASS);
    check(move |_, v| v * -c, velocity, [velocity * (MASS / c * (1.0 - decay)), velocity * decay]);
}

/// Closed form: Ft²/2m.
#[test]
fn a_push_through_the_centre_moves_a_ball_from_rest() {
    let force = Vector3::new(0.1, 0.0, 0.2);
    check(move |_, _| force, Vector3::zeros(), [force * (4.5 / MASS), force * (3.0 / MASS)]);
}

/// Closed form: v₀/ω sin ωt.
#[test]
fn a_ball_swings_on_a_spring() {
    let (k, velocity) = (5.0, Vector3::new(0.0, 0.3, 0.0));
    let omega = f64::sqrt(k / MASS);
    let expected = [velocity * ((3.0 * omega).sin() / omega), velocity * (3.0 * omega).cos()];
    check(move |x, _| x * -k, velocity, expected);
}

/// Counted: a load of 1e-9 N on a ball that flies takes the steps of one without.
#[test]
fn a_load_that_hardly_moves_a_ball_costs_nothing() {
    let (force, velocity) = (Vector3::new(0.0, 0.0, 1e-9), Vector3::new(20.0, 5.0, -3.0));
    check(move |_, v| force * (1.0 + v.x), velocity, [velocity * 3.0, velocity]);
}

/// Conserved: the energy of a ball that bounces on a ground of its own law, and the balance of it.
#[test]
fn a_ball_bounces_on_a_law_of_its_own() {
    let body = ball();
    let (stiffness, height) = (2e3, 0.5);
    let weight = Vector3::new(0.0, 0.0, -9.81 * MASS);
    let push = move |x: Vector3<f64>, _| weight + Vector3::z() * (stiffness * (-x.z).max(0.0));
    let whole = 9.81 * MASS * height;
    for method in [EXPONENTIAL, RKMK4] {
        for tolerance in [1e-4, 1e-6] {
            let run = Run {
                body: &body,
                reference_points: [Vector3::x(), Vector3::y(), Vector3::z()],
                damping_ratio: 0.0,
                loads: vec![law(&body, push)],
                initial: Initial { origin: Some(Vector3::z() * height), ..Initial::at_rest(0) },
                end: 3.0,
                points: vec![],
            };
            let mut simulation = run.start(method, StepControl::Tolerance(tolerance), Rows::Interval(3.0));
            let last = simulation.by_ref().last().unwrap().unwrap();
            let depth = (-last.origin_global.z).max(0.0);
            let potential = 9.81 * MASS * last.origin_global.z + 0.5 * stiffness * depth * depth;
            let made = (last.kinetic_energy + potential) / whole - 1.0;
            let open = last.energy_balance() / whole;
            let evaluations = simulation.stats().evaluations;
            println!("{method:?} {tolerance:e}: made {made:.1e}, open {open:.1e}, {evaluations} evaluations");
            assert!(made.abs() < tolerance, "{method:?} {tolerance}: {made:e}");
            assert!((open - made).abs() < tolerance, "{method:?} {tolerance}: {open:e} {made:e}");
        }
    }
}
