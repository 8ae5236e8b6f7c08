//! Bodies that are held.

use dynamics::{History, Rows, StepControl};
use nalgebra::Vector3;
use reduced_body::RigidMotion;

use crate::sample::{EXPONENTIAL, MASS, RKMK4, Run, body, dead_force, point};

fn axis() -> Vector3<f64> {
    Vector3::new(1.0, 2.0, -2.0) / 3.0
}

fn motions() -> [RigidMotion; 5] {
    let point = Vector3::zeros();
    [
        RigidMotion::free(),
        RigidMotion::pin(point),
        RigidMotion::hinge(point, axis()),
        RigidMotion::slider(axis()),
        RigidMotion::clamp(point),
    ]
}

/// Conserved: energy and momenta.
#[test]
fn energy_and_what_is_left_of_the_momenta_are_conserved() {
    for motion in motions() {
        let body = body(motion, &[5.0, 8.0, 13.0]);
        let run = Run::new(&body, 10.0);
        // Measured: at most 8.2e-13 and 4.2e-10 (energy; RKMK4 damps the modes by so much), 1.7e-13 (momenta).
        for (method, bound) in [(EXPONENTIAL, 1e-11), (RKMK4, 2e-9)] {
            let [first, last] = run.ends(method, 1e-3);
            assert!((last.energy() / first.energy() - 1.0).abs() < bound, "{motion:?}: {}", last.energy());
            let turned = last.angular_momentum_global - first.angular_momentum_global;
            assert!(turned.norm() < 1e-11 * first.angular_momentum_global.norm().max(1.0), "{motion:?}: {turned}");
        }
    }
}

/// Conserved: no motion that the support forbids.
#[test]
fn a_held_body_keeps_to_the_motions_that_it_has_left() {
    for motion in motions() {
        let body = body(motion, &[5.0, 8.0, 13.0]);
        let [first, last] = Run::new(&body, 2.0).ends(EXPONENTIAL, 1e-2);
        let turned = last.attitude.angle_to(&first.attitude);
        let omega = last.omega_body;
        match motion.rotations() {
            [_, _, _] => assert!(turned > 0.1 && omega.cross(&axis()).norm() > 0.1),
            [axis] => assert!(turned > 0.1 && omega.cross(axis).norm() < 1e-14),
            _ => {
                assert!(turned == 0.0 && omega == Vector3::zeros());
            }
        }
        let moved: Vector3<f64> = last.position_global - first.position_global;
        let along = 2.0 * axis().dot(&Vector3::new(0.3, -0.2, 0.5));
        match motion.translations() {
            [_, _, _] => {
                assert!(Vector3::norm(&(moved - 2.0 * Vector3::<f64>::new(0.3, -0.2, 0.5))) < 1e-13_f64)
            }
            // The modes of the made-up body move its centre by something like 0.3 q.
            [_] => assert!((moved.dot(&axis()) - along).abs() < 0.3),
            _ => assert!(moved.norm() < 2.0),
        }
    }
}

/// Period of a pendulum that swings to the angle θ₀: 2π/Ω₀ / AGM(1, cos ½θ₀), Ω₀² = m g d/J.
fn pendulum_period(inertia: f64, weight_arm: f64, largest: f64) -> f64 {
    let (mut a, mut b) = (1.0_f64, (0.5 * largest).cos());
    while (a - b).abs() > 1e-15 {
        (a, b) = (0.5 * (a + b), (a * b).sqrt());
    }
    std::f64::consts::TAU * (inertia / weight_arm).sqrt() / a
}

/// Closed form: the period by the elliptic integral.
#[test]
fn a_compound_pendulum_has_the_period_of_the_elliptic_integral() {
    let hinge = RigidMotion::hinge(Vector3::zeros(), Vector3::z());
    let center = Vector3::new(0.7, 0.0, 0.2);
    let pendulum = crate::sample::changed(body(hinge, &[]), |body| body.center_of_mass = center);
    let (gravity, largest) = (9.81, 2.0_f64);
    // The centre hangs along +x; gravity is turned by the largest angle about the hinge, so that it starts there.
    let down = Vector3::new(largest.cos(), largest.sin(), 0.0);
    let mut run = Run::new(&pendulum, 1.0);
    let weight = point(&pendulum, pendulum.center_of_mass.into());
    run.loads = vec![dead_force(weight, down * MASS * gravity, History::Constant)];
    run.initial.omega = Vector3::zeros();
    let period = pendulum_period(pendulum.inertia[(2, 2)], MASS * gravity * 0.7, largest);
    run.end = period;
    // After a whole period it is back at rest where it began; after half of one it is at the other side.
    let mut rows = run.start(EXPONENTIAL, StepControl::Fixed(1e-4), Rows::Interval(0.5 * period));
    let half = rows.nth(1).unwrap().unwrap();
    let whole = rows.next().unwrap().unwrap();
    let angle = |o: &dynamics::Observation| o.attitude.angle_to(&rigid_kin::Attitude::identity());
    // The other side is 4 rad away, so 2π − 4 the other way round. Measured: below 1e-13.
    assert!((angle(&half) - (std::f64::consts::TAU - 2.0 * largest)).abs() < 1e-9, "{}", angle(&half));
    assert!(angle(&whole) < 1e-9 && whole.omega_body.norm() < 1e-9 && half.omega_body.norm() < 1e-9);
    // A difference of period would show as a spin of this rate times the difference.
    let rate = MASS * gravity * 0.7 * largest.sin() / pendulum.inertia[(2, 2)];
    assert!(whole.omega_body.norm() / rate < 1e-6 * period);
}

/// Conserved: energy and two momenta of the heavy symmetrical top of Simo and Wong: M g l = 20, J = diag(5, 5, 1)
/// about the fixed point, 50 rad/s.
#[test]
fn a_heavy_top_keeps_its_energy_and_the_momenta_that_gravity_leaves() {
    let top = crate::sample::changed(body(RigidMotion::pin(Vector3::zeros()), &[]), |top| {
        top.mass = 20.0;
        top.center_of_mass = Vector3::z();
        top.inertia = nalgebra::Matrix3::from_diagonal(&Vector3::new(5.0, 5.0, 1.0));
    });
    let tilt = 0.05_f64;
    // The body axes begin as the global ones: the vertical is tilted instead.
    let up = Vector3::new(0.0, tilt.sin(), tilt.cos());
    let mut run = Run::new(&top, 10.0);
    run.loads = vec![dead_force(point(&top, [0.0, 0.0, 1.0]), -20.0 * up, History::Constant)];
    run.initial.omega = Vector3::new(0.0, 0.0, 50.0);
    let [first, last] = run.ends(EXPONENTIAL, 1e-3);
    let energy = |o: &dynamics::Observation| o.energy() + 20.0 * up.dot(&o.position_global);
    // Published: about 1269.975. Measured: 2.1e-12 off after 10 s.
    assert!((energy(&first) - 1269.975).abs() < 1e-3, "{}", energy(&first));
    assert!((energy(&last) / energy(&first) - 1.0).abs() < 1e-9, "{}", energy(&last));
    // Gravity has no moment about the vertical nor about the top's own axis.
    let vertical = |o: &dynamics::Observation| o.angular_momentum_global.dot(&up);
    assert!((vertical(&last) / vertical(&first) - 1.0).abs() < 1e-9);
    assert!((last.omega_body.z / 50.0 - 1.0).abs() < 1e-12);
    // It precesses without nutation worth the name: the axis stays near its tilt.
    let axis = last.attitude.to_global(&Vector3::z());
    assert!((axis.dot(&up).acos() - tilt).abs() < 0.02);
}
