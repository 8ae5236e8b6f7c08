//! Bodies whose held part is driven.

use dynamics::{Drive, DrivenMotion, DrivenSpeed, Effect, History, Rows, StepControl};
use nalgebra::Vector3;
use reduced_body::RigidMotion;

use crate::sample::{EXPONENTIAL, RKMK4, Run, body};

fn clamped() -> reduced_body::ReducedBody {
    body(RigidMotion::clamp(Vector3::zeros()), &[5.0, 8.0, 13.0])
}

fn drive(motion: DrivenMotion) -> Drive {
    let history = History::HalfSine { start: -0.3, duration: 4.0 };
    Drive { motion, speed: DrivenSpeed { amplitude: 1.2, history }, added: None }
}

fn motions() -> [DrivenMotion; 2] {
    let unit = Vector3::new(2.0, -1.0, 2.0) / 3.0;
    [DrivenMotion::Turn { axis: unit }, DrivenMotion::Slide { direction: unit }]
}

/// Conserved: the balance of energy; order 4.
#[test]
fn the_work_of_the_drive_closes_the_balance_of_energy_with_fourth_order() {
    for motion in motions() {
        let body = clamped();
        let mut run = Run::new(&body, 3.0);
        run.physics.drive = Some(drive(motion));
        run.damping_ratio = 0.02;
        for method in [EXPONENTIAL, RKMK4] {
            let gaps = [0.04, 0.02, 0.01].map(|step| run.energy_gap(method, step));
            // Measured: 1.6e-8 (exponential), 3.4e-6 (RKMK4, whose modes turn by 0.13 rad in the last of the steps).
            assert!(gaps[2] < 1e-5, "{motion:?} {method:?}: {gaps:?}");
            let order = (gaps[0] / gaps[2]).log2() / 2.0;
            assert!(order > 3.5, "{motion:?} {method:?}: {gaps:?}");
        }
    }
}

/// Closed form: ∫v dt.
#[test]
fn a_driven_part_is_where_its_speed_has_taken_it() {
    let [turn, slide] = motions();
    // ∫ 1.2 sin(π (t + 0.3)/4) dt from 0 to 3.
    let at = |t: f64| -1.2 * 4.0 / std::f64::consts::PI * (std::f64::consts::PI * (t + 0.3) / 4.0).cos();
    let way = at(3.0) - at(0.0);
    let body = clamped();
    let mut run = Run::new(&body, 3.0);
    run.initial.modal_displacement.fill(0.0);
    run.physics.drive = Some(drive(turn));
    let [first, last] = run.ends(EXPONENTIAL, 1e-2);
    assert!((last.attitude.angle_to(&first.attitude) - way).abs() < 1e-9);
    run.physics.drive = Some(drive(slide));
    let mut simulation = run.start(EXPONENTIAL, StepControl::Fixed(1e-2), Rows::Interval(3.0));
    let last = simulation.nth(1).unwrap().unwrap();
    let DrivenMotion::Slide { direction } = slide else { unreachable!() };
    let center = body.center_of_mass
        + Vector3::from_fn(|i, _| {
            body.translation_first[i].iter().zip(&last.modal_displacement).map(|(t, q)| t * q).sum::<f64>() / body.mass
        });
    assert!((last.position_global - center - direction * way).norm() < 1e-9);
}

/// Conserved: a slide by v(t) is, for the modes, a load −b v': the same motion as of a clamped body under a base
/// acceleration.
#[test]
fn a_driven_slide_is_a_base_acceleration() {
    let [_, slide] = motions();
    let DrivenMotion::Slide { direction } = slide else { unreachable!() };
    let body = clamped();
    let mut run = Run::new(&body, 2.0);
    run.initial.modal_velocity.fill(0.0);
    run.initial.modal_displacement.fill(0.0);
    // v = a sin(π (t)/4): v' = a π/4 cos(π t/4) = a π/4 sin(π (t + 2)/4).
    let history = History::HalfSine { start: 0.0, duration: 4.0 };
    run.physics.drive = Some(Drive { motion: slide, speed: DrivenSpeed { amplitude: 1.2, history }, added: None });
    let [_, driven] = run.ends(EXPONENTIAL, 5e-3);
    run.physics.drive = None;
    let center = dynamics::PointShapes::new(
        &body,
        &reduced_body::BodyPoint {
            position_body: body.center_of_mass,
            shapes: faer::Mat::from_fn(3, 3, |i, k| body.translation_first[i][k] / body.mass),
        },
    );
    let acceleration = 1.2 * std::f64::consts::PI / 4.0;
    run.loads = vec![crate::sample::dead_force(
        center,
        -direction * body.mass * acceleration,
        History::HalfSine { start: -2.0, duration: 4.0 },
    )];
    let [_, shaken] = run.ends(EXPONENTIAL, 5e-3);
    for (a, b) in driven.modal_displacement.iter().zip(&shaken.modal_displacement) {
        // Measured: 1.5e-13 of 4e-3.
        assert!((a - b).abs() < 1e-9, "{a} {b}");
    }
}

/// Conserved: the same motion without effects that it does not need.
#[test]
fn what_is_driven_moves_whatever_is_off() {
    let body = clamped();
    for motion in motions() {
        let mut run = Run::new(&body, 1.0);
        run.physics.drive = Some(drive(motion));
        let [_, expected] = run.ends(EXPONENTIAL, 1e-2);
        run.physics.effects[Effect::Translation] = false;
        run.physics.effects[Effect::Rotation] = false;
        let [_, last] = run.ends(EXPONENTIAL, 1e-2);
        assert_eq!(last.modal_displacement, expected.modal_displacement);
        assert_eq!(last.position_global, expected.position_global);
    }
}

/// Conserved: the balance of energy; order 4.
#[test]
fn a_jump_of_the_driven_speed_does_its_work_at_once() {
    for motion in motions() {
        let body = clamped();
        let mut run = Run::new(&body, 3.0);
        run.physics.drive = Some(Drive {
            motion,
            speed: DrivenSpeed { amplitude: 1.2, history: History::Step { at: 1.25 } },
            added: None,
        });
        let gaps = [0.02, 0.01].map(|step| run.energy_gap(EXPONENTIAL, step));
        // Measured: 2.3e-9 (turn), 7.6e-9 (slide), and 15 times as much at twice the step.
        assert!(gaps[1] < 1e-6 && gaps[0] > 8.0 * gaps[1], "{motion:?}: {gaps:?}");
        // The row of the jump itself has what it did.
        let mut rows = run.start(EXPONENTIAL, StepControl::Fixed(1e-2), Rows::Interval(1.25));
        let start = rows.next().unwrap().unwrap();
        let jump = rows.next().unwrap().unwrap();
        assert!((jump.energy_balance() - start.energy_balance()).abs() < 1e-6 * jump.energy(), "{motion:?}");
    }
}
