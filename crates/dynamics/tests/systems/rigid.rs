//! Rigid bodies in hinges, against closed forms and conserved quantities.

use std::f64::consts::PI;
use std::sync::Arc;

use dynamics::{LoadFn, PointShapes, SharedLoad, SystemMotion};
use modal::{BodyPoint, ReducedBody, RigidMotion};
use nalgebra::{Matrix3, Vector3};

use crate::mechanism::{Link, Mechanism, angle};

const GRAVITY: f64 = 9.81;

fn weight(mass: f64) -> SharedLoad {
    let body = ReducedBody::rigid(1.0, Vector3::zeros(), Matrix3::identity(), RigidMotion::free()).unwrap();
    let center = PointShapes::new(&body, &BodyPoint::rigid(Vector3::zeros()));
    Arc::new(LoadFn::new("weight", move |motion, applied| {
        applied.force(&center, &(motion.body_from_global * Vector3::new(0.0, -mass * GRAVITY, 0.0)));
    }))
}

/// A bar of 1 m and 1 kg, hung by its end at an angle from below.
fn pendulum(amplitude: f64) -> SystemMotion {
    let mut mechanism = Mechanism::default();
    let center = [0.5 * amplitude.sin(), -0.5 * amplitude.cos()];
    let link = mechanism.link(Link {
        mass: 1.0,
        inertia: Vector3::new(1.0 / 12.0, 1e-3, 1.0 / 12.0),
        center,
        angle: amplitude,
        loads: vec![weight(1.0)],
    });
    mechanism.hinge([None, Some(link)], [0.0; 2]);
    mechanism.starts(&[([0.0; 2], 0.0)])
}

/// Closed form: the period of a pendulum of length 2/3 by the arithmetic-geometric mean.
#[test]
fn a_pendulum_has_its_period() {
    let amplitude: f64 = 2.0;
    let (mut a, mut g) = (1.0, (0.5 * amplitude).cos());
    while f64::abs(a - g) > 1e-15 {
        (a, g) = (0.5 * (a + g), f64::sqrt(a * g));
    }
    let period = 2.0 * PI * f64::sqrt(2.0 / 3.0 / GRAVITY) / a;
    let mut last = f64::INFINITY;
    for tolerance in [1e-5, 1e-7, 1e-9] {
        let mut motion = pendulum(amplitude);
        let steps = motion.advance(period, tolerance, &mut 1e-3).unwrap();
        let error = (angle(&motion, 0) - amplitude).abs() + motion.state(0).unwrap().omega_body.norm();
        let [residuals, rates] =
            motion.residuals().unwrap().map(|list| list.iter().fold(0.0_f64, |a, b| a.max(b.abs())));
        println!("{tolerance:e}: {steps} steps, error {error:e}, residual {residuals:e}, rate {rates:e}");
        assert!(error < 30.0 * tolerance && error < 0.3 * last);
        assert!(residuals < 1e-14 && rates < 1e-12);
        last = error;
    }
}

/// Conserved: two bars that a hinge joins fly and turn: momenta stay to rounding at any tolerance, energy at the
/// tolerance.
#[test]
fn a_free_pair_keeps_its_momenta() {
    let bar = |x: f64| Link {
        mass: 1.0,
        inertia: Vector3::new(1e-3, 1.0 / 12.0, 1.0 / 12.0),
        center: [x, 0.0],
        angle: 0.0,
        loads: Vec::new(),
    };
    let start = || {
        let mut mechanism = Mechanism::default();
        let [a, b] = [-0.5, 0.5].map(|x| mechanism.link(bar(x)));
        mechanism.hinge([Some(a), Some(b)], [0.0; 2]);
        mechanism.starts(&[([1.0, -1.5], 3.0), ([1.0, 1.0], 2.0)])
    };
    let mut drifts = Vec::new();
    for tolerance in [1e-3, 1e-6, 1e-9] {
        let mut motion = start();
        let (momenta, energy) = (motion.momenta(), motion.energy().unwrap());
        let steps = motion.advance(5.0, tolerance, &mut 1e-2).unwrap();
        let now = motion.momenta();
        let drift = (motion.energy().unwrap() / energy - 1.0).abs();
        let of_momenta = [0, 1].map(|k: usize| (now[k] - momenta[k]).norm());
        println!("{tolerance:e}: {steps} steps, momenta {of_momenta:?}, energy {drift:e}");
        assert!(of_momenta.iter().all(|error| *error < 1e-12));
        drifts.push(drift);
    }
    assert!(drifts[2] < 1e-8 && drifts[2] < 1e-3 * drifts[0].max(1e-7));
}

/// Conserved: order 5, by halving a fixed step.
#[test]
fn the_error_falls_with_the_fifth_power_of_the_step() {
    let end = |steps: usize| {
        let mut motion = pendulum(1.5);
        let h = 1.0 / steps as f64;
        for k in 0..steps {
            motion.try_step(h, (k + 1) as f64 * h, 1e-13, f64::INFINITY).unwrap();
        }
        angle(&motion, 0)
    };
    let exact = end(400);
    let errors = [20, 40, 80].map(|steps| (end(steps) - exact).abs());
    let orders = [0, 1].map(|k| (errors[k] / errors[k + 1]).log2());
    println!("{errors:?} {orders:?}");
    assert!(orders.iter().all(|order| *order > 4.5));
}
