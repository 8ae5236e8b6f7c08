//! Springs, dampers and bushings between bodies.

use std::sync::Arc;

use dynamics::{
    Bushing, ConservativeBody, ForceElement, Joint, Marker, MotionState, Physics, PointSpring, System, SystemMotion,
};
use modal::{ReducedBody, RigidMotion};
use nalgebra::{Matrix3, Vector3};
use rigid_kin::Attitude;

fn bodies(count: usize) -> Vec<ConservativeBody> {
    let inertia = Matrix3::from_diagonal(&Vector3::new(0.2, 0.3, 0.4));
    let reduced = ReducedBody::rigid(2.0, Vector3::zeros(), inertia, RigidMotion::free()).unwrap();
    vec![ConservativeBody::new(&reduced, &[], Vec::new(), &Physics::default()).unwrap(); count]
}

fn at(x: f64, omega: f64) -> MotionState {
    MotionState {
        time: 0.0,
        attitude: Attitude::identity(),
        origin_global: Vector3::new(x, 0.0, 0.0),
        velocity_global: Vector3::zeros(),
        omega_body: Vector3::new(0.0, 0.0, omega),
        modal_displacement: Vec::new(),
        modal_velocity: Vec::new(),
    }
}

fn marker(body: Option<usize>, x: f64) -> Marker {
    match body {
        Some(body) => Marker::on_rigid(body, Vector3::new(x, 0.0, 0.0), Matrix3::identity()),
        None => Marker::on_ground(Vector3::new(x, 0.0, 0.0), Matrix3::identity()),
    }
}

fn system(
    count: usize,
    joints: Vec<Joint>,
    element: impl ForceElement + 'static,
    states: &[MotionState],
) -> SystemMotion {
    let system = System::new(bodies(count), joints).unwrap().with_elements(vec![Arc::new(element)]).unwrap();
    SystemMotion::new(system, states).unwrap()
}

/// Energy less all work, relative to the work of the elements.
fn imbalance(motion: &SystemMotion, energy: f64) -> f64 {
    ((motion.energy().unwrap() - energy - motion.element_work()) / motion.element_work().abs().max(energy)).abs()
}

/// Closed form: two masses on a spring swing with √(k/μ), here with damping δ = c/2μ.
#[test]
fn two_masses_on_a_damped_spring_swing_in_closed_form() {
    let (k, c) = (50.0, 1.5);
    let spring = PointSpring {
        markers: [marker(Some(0), 0.0), marker(Some(1), 0.0)],
        stiffness: k,
        damping: c,
        free_length: 1.0,
    };
    let mut motion = system(2, Vec::new(), spring, &[at(0.0, 0.0), at(1.2, 0.0)]);
    let momenta = motion.momenta();
    let end = 1.3;
    motion.advance(end, 1e-9, &mut 1e-3).unwrap();
    let delta = c / 2.0;
    let omega = f64::sqrt(k - delta * delta);
    let expected = 1.0 + 0.2 * (-delta * end).exp() * ((omega * end).cos() + delta / omega * (omega * end).sin());
    let [a, b] = [0, 1].map(|body| motion.state(body).unwrap().origin_global.x);
    assert!((b - a - expected).abs() < 1e-8, "{} {expected}", b - a);
    assert!(motion.momenta().iter().zip(momenta).all(|(now, start)| (now - start).norm() < 1e-14));
    assert!(imbalance(&motion, 0.0) < 1e-6);
}

/// Closed form: a body on a bushing to the ground turns with √(k/J) and slides with √(k/m).
#[test]
fn a_bushing_has_its_frequencies() {
    let bushing = Bushing {
        markers: [marker(None, 0.0), marker(Some(0), 0.0)],
        stiffness: [Vector3::new(80.0, 90.0, 100.0), Vector3::new(5.0, 6.0, 7.0)],
        damping: [Vector3::zeros(); 2],
    };
    let mut motion = system(1, Vec::new(), bushing, &[at(0.1, 0.05)]);
    let end = 0.9;
    motion.advance(end, 1e-9, &mut 1e-3).unwrap();
    let now = motion.state(0).unwrap();
    let omega = f64::sqrt(7.0 / 0.4);
    let expected = [0.1 * (f64::sqrt(40.0) * end).cos(), 0.05 * (omega * end).cos()];
    assert!((now.origin_global.x - expected[0]).abs() < 1e-8, "{now:?}");
    assert!((now.omega_body.z - expected[1]).abs() < 1e-8, "{now:?} {expected:?}");
}

/// Conserved: momenta of a pair with a bushing that is turned and stretched at once; energy by the work of the bushing.
#[test]
fn a_bushing_between_free_bodies_keeps_their_momenta() {
    let bushing = Bushing {
        markers: [marker(Some(0), 0.5), marker(Some(1), -0.5)],
        stiffness: [Vector3::new(80.0, 90.0, 100.0), Vector3::new(5.0, 6.0, 7.0)],
        damping: [Vector3::repeat(0.5), Vector3::repeat(0.1)],
    };
    let tumbling = MotionState {
        omega_body: Vector3::new(0.5, -0.4, 1.0),
        velocity_global: Vector3::new(0.1, 0.2, 0.3),
        ..at(1.3, 0.0)
    };
    let mut motion = system(2, Vec::new(), bushing, &[at(0.0, 0.7), tumbling]);
    let (momenta, energy) = (motion.momenta(), motion.energy().unwrap());
    motion.advance(2.0, 1e-7, &mut 1e-3).unwrap();
    let drift: Vec<f64> = motion.momenta().iter().zip(momenta).map(|(now, start)| (now - start).norm()).collect();
    assert!(drift.iter().all(|drift| *drift < 1e-13), "{drift:?}");
    assert!(motion.element_work().abs() > 0.1);
    assert!(imbalance(&motion, energy) < 1e-6, "{}", imbalance(&motion, energy));
}
