//! A body without flexible modes against rigid-body motion in closed form.

use dynamics::{Initial, Rows, StepControl};
use nalgebra::{Matrix3, Vector3};
use reduced_body::{ReducedBody, RigidMotion};
use rigid_kin::{Attitude, Inertia, TorqueFreeMotion};

use crate::run::{EXPONENTIAL, RKMK4, Run};

/// Mass 1 and the inertia of the closed-form cases.
fn body() -> ReducedBody {
    let inertia = Matrix3::from_diagonal(&Vector3::new(1.0, 2.0, 3.0));
    ReducedBody::rigid(1.0, Vector3::zeros(), inertia, RigidMotion::free()).unwrap()
}

/// Closed form: the torque-free motion in elliptic functions.
#[test]
fn periods_are_those_of_the_closed_form() {
    let body = body();
    for (omega, published, steps, most) in [
        // Late by 7e-15 s.
        (Vector3::new(1.0, 2.0, 3.0), 2.041_488_040_54, [1e-4, 1e-12], 1e-9),
        // Near the separatrix: late by 8e-8 and 3e-8 s. The start is 1e-4 off an unstable axis, so that rounding alone
        // makes 1e-6 s with ten times as many steps.
        (Vector3::new(1e-4, 1.0, 1e-4), 71.014_506_079_317, [2e-3, 1e-10], 1e-6),
    ] {
        let inertia = Inertia::new(body.inertia).unwrap();
        let exact = TorqueFreeMotion::new(&inertia, Attitude::identity(), omega).unwrap();
        let period = exact.period().unwrap();
        assert!((period - published).abs() < 1e-11, "{period}");
        let run = Run {
            body: &body,
            reference_points: [Vector3::x(), Vector3::y(), Vector3::z()],
            damping_ratio: 0.0,
            loads: vec![],
            initial: Initial { omega, ..Initial::at_rest(0) },
            end: period,
            points: vec![],
        };
        // Lateness at the end, along the rate that ω has there.
        let rate = run.beginning().alpha_body;
        let [step, tolerance] = steps;
        for (method, control) in [
            (EXPONENTIAL, StepControl::Fixed(step)),
            (RKMK4, StepControl::Fixed(step)),
            (EXPONENTIAL, StepControl::Tolerance(tolerance)),
            (RKMK4, StepControl::Tolerance(tolerance)),
        ] {
            let end = run.start(method, control, Rows::Interval(period)).last().unwrap().unwrap();
            let late = (end.omega_body - omega).dot(&rate) / rate.norm_squared();
            assert!(late.abs() < most, "{method:?} {control:?}: {late:e}");
            // Measured: 6e-14 and 5e-11 rad.
            let turn = end.attitude.angle_to(&exact.at(period).unwrap().attitude);
            assert!(turn < 1e-9, "{method:?} {control:?}: {turn:e}");
        }
    }
}
