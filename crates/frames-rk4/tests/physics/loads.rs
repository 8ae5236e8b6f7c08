//! Loads beside dead forces.

use faer::Mat;
use frames_rk4::{Action, BodyField, History, Load, LoadFrame, RotationShapes};
use modal::RigidMotion;
use nalgebra::Vector3;

use crate::sample::{EXPONENTIAL, RKMK4, Run, body, point};

const PULSE: History = History::HalfSine { start: 0.2, duration: 1.5 };

fn force(frame: LoadFrame) -> Action {
    let body = body(RigidMotion::Free, &[5.0, 8.0, 13.0]);
    Action::Force { point: point(&body, [0.5, -0.2, 0.4]), force: Vector3::new(0.5, 1.0, -0.7), frame }
}

fn moment(frame: LoadFrame) -> Action {
    let body = body(RigidMotion::Free, &[5.0, 8.0, 13.0]);
    let rotation = RotationShapes::new(&body, Mat::from_fn(3, 3, |i, k| 0.1 * (i as f64 - k as f64)).as_ref());
    Action::Moment { rotation, moment: Vector3::new(0.4, -0.9, 0.3), frame }
}

fn field() -> Action {
    Action::Field(BodyField {
        force_body: Vector3::new(0.2, 0.5, -0.4),
        moment_body: Vector3::new(-0.3, 0.2, 0.6),
        modal: vec![0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.3, -0.2, 0.4],
        lever: (0..3).map(|k| Vector3::new(0.1, 0.05 * k as f64, -0.1)).collect(),
    })
}

#[test]
fn work_and_impulses_of_every_load_close_the_balances() {
    let body = body(RigidMotion::Free, &[5.0, 8.0, 13.0]);
    let [global, follower] = [LoadFrame::Global, LoadFrame::Body];
    for action in [force(global), force(follower), moment(global), moment(follower), field()] {
        let mut run = Run::new(&body, 3.0);
        run.loads = vec![Load { action: action.clone(), history: PULSE }];
        for method in [EXPONENTIAL, RKMK4] {
            let gap = |step: f64| {
                let [first, last] = run.ends(method, step);
                let angular = last.angular_balance_global() - first.angular_balance_global();
                let energy = (last.energy_balance() - first.energy_balance()).abs() / first.energy();
                assert!((last.linear_balance_global() - first.linear_balance_global()).norm() < 1e-13);
                assert!((last.work.work / first.energy()).abs() > 1e-3, "{action:?} does nothing");
                [energy, angular.norm() / first.angular_momentum_global.norm()]
            };
            let (coarse, fine) = (gap(2e-2), gap(5e-3));
            for (coarse, fine) in coarse.into_iter().zip(fine) {
                assert!(fine < 1e-6 && (coarse / fine > 100.0 || fine < 1e-11), "{action:?}: {coarse:e} {fine:e}");
            }
        }
    }
}

/// A follower couple about a body axis of a rigid body spins it up as θ'' = M/J whatever its attitude, and a dead force
/// and a follower force agree while the body does not turn.
#[test]
fn followers_follow() {
    let mut rigid = body(RigidMotion::Free, &[]);
    rigid.inertia = nalgebra::Matrix3::from_diagonal(&Vector3::new(2.0, 3.0, 4.0));
    let mut run = Run::new(&rigid, 2.0);
    run.initial.omega = Vector3::zeros();
    let rotation = RotationShapes::new(&rigid, Mat::zeros(3, 0).as_ref());
    let action = Action::Moment { rotation, moment: Vector3::new(0.0, 0.0, 6.0), frame: LoadFrame::Body };
    run.loads = vec![Load { action, history: History::Constant }];
    let [_, last] = run.ends(EXPONENTIAL, 1e-2);
    assert!((last.omega_body - Vector3::new(0.0, 0.0, 3.0)).norm() < 1e-12);

    // A follower force through the centre of a body that spins about the normal n: the velocity is the integral of a
    // turning force, F/(m Ω) (sin Ωt, 1 − cos Ωt).
    run.initial.velocity = Vector3::zeros();
    run.initial.omega = Vector3::new(0.0, 0.0, 1.5);
    let action = Action::Force { point: point(&rigid, [0.0; 3]), force: Vector3::x(), frame: LoadFrame::Body };
    run.loads = vec![Load { action, history: History::Constant }];
    let [_, last] = run.ends(EXPONENTIAL, 5e-3);
    let (omega, t) = (1.5, 2.0);
    let expected = Vector3::new((omega * t).sin(), 1.0 - (omega * t).cos(), 0.0) / (rigid.mass * omega);
    // Measured: 2e-12.
    assert!((last.velocity_global - expected).norm() < 1e-10, "{}", last.velocity_global);
}

/// A load that jumps: steps end at the jump and see one law each, so nothing of the order is lost.
#[test]
fn a_jump_costs_no_accuracy() {
    let body = body(RigidMotion::Clamp { origin: Vector3::zeros() }, &[5.0, 8.0, 13.0]);
    let mut run = Run::new(&body, 2.0);
    run.initial.modal_displacement.fill(0.0);
    run.initial.modal_velocity.fill(0.0);
    let load = point(&body, [0.0; 3]);
    run.loads = vec![Load::dead_force(load, Vector3::new(1.0, 2.0, 3.0), History::Step { at: 0.7 })];
    let [_, last] = run.ends(EXPONENTIAL, 0.3);
    // q = f/ω² (1 − cos ω(t − 0.7)): the exponential scheme has a constant load exactly.
    for (k, omega) in [5.0_f64, 8.0, 13.0].into_iter().enumerate() {
        let mut force = vec![0.0; 3];
        let shape = modal_force(&body, &mut force)[k];
        let expected = shape / (omega * omega) * (1.0 - (omega * 1.3).cos());
        assert!((last.modal_displacement[k] - expected).abs() < 1e-14, "{k}");
    }
}

/// Φᵀ F of the load above: the shapes of [`point`] once more.
fn modal_force(body: &modal::ReducedBody, force: &mut Vec<f64>) -> Vec<f64> {
    let unit = |axis: usize| {
        let mut run = Run::new(body, 1e-6);
        run.initial.modal_displacement.fill(0.0);
        run.initial.modal_velocity.fill(0.0);
        let mut direction = Vector3::zeros();
        direction[axis] = 1.0;
        run.loads = vec![Load::dead_force(point(body, [0.0; 3]), direction, History::Constant)];
        let [first, _] = run.ends(EXPONENTIAL, 1e-6);
        first.modal_acceleration
    };
    let columns = [unit(0), unit(1), unit(2)];
    for (k, f) in force.iter_mut().enumerate() {
        *f = columns[0][k] + 2.0 * columns[1][k] + 3.0 * columns[2][k];
    }
    force.clone()
}
