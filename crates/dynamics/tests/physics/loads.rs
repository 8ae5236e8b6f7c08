//! Loads beside dead forces.

use std::sync::Arc;

use dynamics::{BodyField, FieldLoad, History, LoadFrame, PointForce, PointMoment, RotationShapes, SharedLoad};
use faer::Mat;
use nalgebra::Vector3;
use reduced_body::RigidMotion;

use crate::sample::{EXPONENTIAL, RKMK4, Run, body, dead_force, point};

const PULSE: History = History::HalfSine { start: 0.2, duration: 1.5 };

fn force(frame: LoadFrame) -> SharedLoad {
    let body = body(RigidMotion::free(), &[5.0, 8.0, 13.0]);
    let (point, force) = (point(&body, [0.5, -0.2, 0.4]), Vector3::new(0.5, 1.0, -0.7));
    Arc::new(PointForce { point, force, frame, turning: None, history: PULSE })
}

fn moment(frame: LoadFrame) -> SharedLoad {
    let body = body(RigidMotion::free(), &[5.0, 8.0, 13.0]);
    let rotation = RotationShapes::new(&body, Mat::from_fn(3, 3, |i, k| 0.1 * (i as f64 - k as f64)).as_ref());
    Arc::new(PointMoment { rotation, moment: Vector3::new(0.4, -0.9, 0.3), frame, history: PULSE })
}

fn field() -> SharedLoad {
    let field = BodyField {
        force_body: Vector3::new(0.2, 0.5, -0.4),
        moment_body: Vector3::new(-0.3, 0.2, 0.6),
        modal: vec![0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.3, -0.2, 0.4],
        force_change: Vec::new(),
        load_stiffness: Vec::new(),
        second_order: None,
        moment_change: (0..3).map(|k| Vector3::new(0.1, 0.05 * k as f64, -0.1)).collect(),
    };
    Arc::new(FieldLoad { field, history: PULSE })
}

/// A field that follows the deformation, such as a pressure: its modal forces are not symmetric in the modes.
fn following_field() -> SharedLoad {
    let field = BodyField {
        force_body: Vector3::new(0.2, 0.5, -0.4),
        moment_body: Vector3::new(-0.3, 0.2, 0.6),
        modal: vec![0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.3, -0.2, 0.4],
        force_change: (0..3).map(|k| Vector3::new(0.3 - 0.1 * k as f64, 0.2, -0.1)).collect(),
        moment_change: (0..3).map(|k| Vector3::new(0.1, 0.05 * k as f64, -0.1)).collect(),
        load_stiffness: (0..9).map(|k| 0.4 * (1.7 * f64::from(k)).sin()).collect(),
        second_order: Some(crate::stress::second_order(3)),
    };
    Arc::new(FieldLoad { field, history: PULSE })
}

/// A force and a moment that stiffen the body.
fn stiffening(frame: LoadFrame) -> [SharedLoad; 2] {
    let body = body(RigidMotion::free(), &[5.0, 8.0, 13.0]);
    let vector = Vector3::new(0.5, 1.0, -0.7);
    let point = point(&body, [0.5, -0.2, 0.4]).with_second_order(crate::stress::second_order(3));
    let rotation = RotationShapes::new(&body, Mat::from_fn(3, 3, |i, k| 0.1 * (i as f64 - k as f64)).as_ref())
        .with_second_order(crate::stress::second_order(3));
    [
        Arc::new(PointForce { point, force: vector, frame, turning: None, history: PULSE }),
        Arc::new(PointMoment { rotation, moment: vector, frame, history: PULSE }),
    ]
}

/// A load of every kind.
pub fn every_kind() -> Vec<SharedLoad> {
    let [global, follower] = [LoadFrame::Global, LoadFrame::Body];
    let others = [force(global), force(follower), moment(global), moment(follower), field(), following_field()];
    others.into_iter().chain(stiffening(global)).chain(stiffening(follower)).collect()
}

/// Conserved: the balances of energy and momenta; order 4.
#[test]
fn work_and_impulses_of_every_load_close_the_balances() {
    let body = body(RigidMotion::free(), &[5.0, 8.0, 13.0]);
    for load in every_kind() {
        let mut run = Run::new(&body, 3.0);
        run.loads = vec![load.clone()];
        for method in [EXPONENTIAL, RKMK4] {
            let gap = |step: f64| {
                let [first, last] = run.ends(method, step);
                let angular = last.angular_balance_global() - first.angular_balance_global();
                let energy = (last.energy_balance() - first.energy_balance()).abs() / first.energy();
                assert!((last.linear_balance_global() - first.linear_balance_global()).norm() < 1e-13);
                assert!((last.work.work / first.energy()).abs() > 1e-3, "{load:?} does nothing");
                [energy, angular.norm() / first.angular_momentum_global.norm()]
            };
            let (coarse, fine) = (gap(2e-2), gap(5e-3));
            for (coarse, fine) in coarse.into_iter().zip(fine) {
                assert!(fine < 1e-6 && (coarse / fine > 100.0 || fine < 1e-11), "{load:?}: {coarse:e} {fine:e}");
            }
        }
    }
}

/// Closed form: a follower couple about a body axis of a rigid body spins it up as θ'' = M/J whatever its attitude; a
/// follower force on a spinning body gives F/(mΩ) (sin Ωt, 1 − cos Ωt).
#[test]
fn followers_follow() {
    let inertia = nalgebra::Matrix3::from_diagonal(&Vector3::new(2.0, 3.0, 4.0));
    let rigid = crate::sample::changed(body(RigidMotion::free(), &[]), |body| body.inertia = inertia);
    let mut run = Run::new(&rigid, 2.0);
    run.initial.omega = Vector3::zeros();
    let rotation = RotationShapes::new(&rigid, Mat::zeros(3, 0).as_ref());
    let (moment, frame, history) = (Vector3::new(0.0, 0.0, 6.0), LoadFrame::Body, History::Constant);
    run.loads = vec![Arc::new(PointMoment { rotation, moment, frame, history })];
    let [_, last] = run.ends(EXPONENTIAL, 1e-2);
    assert!((last.omega_body - Vector3::new(0.0, 0.0, 3.0)).norm() < 1e-12);

    // A follower force through the centre of a body that spins about the normal n: the velocity is the integral of a
    // turning force, F/(m Ω) (sin Ωt, 1 − cos Ωt).
    run.initial.velocity = Vector3::zeros();
    run.initial.omega = Vector3::new(0.0, 0.0, 1.5);
    let (point, force, history) = (point(&rigid, [0.0; 3]), Vector3::x(), History::Constant);
    run.loads = vec![Arc::new(PointForce { point, force, frame: LoadFrame::Body, turning: None, history })];
    let [_, last] = run.ends(EXPONENTIAL, 5e-3);
    let (omega, t) = (1.5_f64, 2.0);
    let expected = Vector3::new((omega * t).sin(), 1.0 - (omega * t).cos(), 0.0) / (rigid.mass * omega);
    // Measured: 1e-12.
    assert!((last.velocity_global - expected).norm() < 1e-10, "{}", last.velocity_global);
}

/// Closed form: q = f/ω² (1 − cos ωt) after a load that jumps: steps end at the jump and see one law each, so nothing
/// of the order is lost.
#[test]
fn a_jump_costs_no_accuracy() {
    let body = body(RigidMotion::clamp(Vector3::zeros()), &[5.0, 8.0, 13.0]);
    let mut run = Run::new(&body, 2.0);
    run.initial.modal_displacement.fill(0.0);
    run.initial.modal_velocity.fill(0.0);
    let (load, force) = (point(&body, [0.0; 3]), Vector3::new(1.0, 2.0, 3.0));
    run.loads = vec![dead_force(load, force, History::Step { at: 0.7 })];
    let modal_force = modal_force(&body, force);
    let [_, last] = run.ends(EXPONENTIAL, 0.3);
    // q = f/ω² (1 − cos ω(t − 0.7)): the exponential scheme has a constant load exactly.
    for (k, omega) in [5.0_f64, 8.0, 13.0].into_iter().enumerate() {
        let expected = modal_force[k] / (omega * omega) * (1.0 - (omega * 1.3).cos());
        assert!((last.modal_displacement[k] - expected).abs() < 1e-14, "{k}");
    }
}

/// Φᵀ F of a load at the point of [`point`], as the modal accelerations at rest.
fn modal_force(body: &reduced_body::ReducedBody, force: Vector3<f64>) -> Vec<f64> {
    let mut run = Run::new(body, 1e-6);
    run.initial.modal_displacement.fill(0.0);
    run.initial.modal_velocity.fill(0.0);
    run.loads = vec![dead_force(point(body, [0.0; 3]), force, History::Constant)];
    let [first, _] = run.ends(EXPONENTIAL, 1e-6);
    first.modal_acceleration
}
