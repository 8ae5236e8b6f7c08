//! Bodies whose held part is driven.

use dynamics::{
    ConservativeBody, Drive, DrivenMotion, DrivenSpeed, Effect, Equations, History, Initial, MotionState, Physics,
    Rows, Signal, StepControl,
};
use faer::Mat;
use nalgebra::Vector3;
use reduced_body::RigidMotion;

use crate::sample::{EXPONENTIAL, RKMK4, Run, body, dead_force, point, start};

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

/// Independent reference: differences of the accelerations and the reaction in the motion, over modes, their rates and the speed and the acceleration of
/// the drive, about a rest that a drive which gains speed bends: the laws are of second degree.
#[test]
fn the_first_order_of_a_driven_body_is_that_of_differences() {
    let body = clamped();
    let (nf, time, size) = (body.flexible(), 0.7, 1e-2);
    let added = Signal::held(0.0);
    let initial = Initial { attitude: start(nf).attitude, ..Initial::at_rest(nf) };
    for motion in motions() {
        let physics = Physics {
            drive: Some(Drive { added: Some(added.clone()), ..drive(motion) }),
            drive_stiffness: Some(Mat::from_fn(nf, nf, |i, j| 0.1 * (1 + i + j) as f64)),
            ..Physics::default()
        };
        let push = dead_force(point(&body, [0.3, 0.2, 0.1]), Vector3::new(1.0, -2.0, 0.5), History::Constant);
        let body = ConservativeBody::new(&body, &[0.03; 3], vec![push], &physics).unwrap();
        let rest = body.at_rest(&initial, &[size; 3], time).unwrap();
        let at = |place: &[f64], rates: &[f64]| -> Vec<f64> {
            let motion = MotionState {
                time,
                modal_displacement: rest.modal_displacement.iter().zip(place).map(|(q, by)| q + by).collect(),
                modal_velocity: rates.to_vec(),
                ..body.motion_state(&body.start(&initial).unwrap()).unwrap()
            };
            let seen = body.observed_at(&motion, &[]).unwrap();
            let reaction = seen.reaction.force_body.iter().chain(&seen.reaction.moment_body).copied();
            reaction.chain(seen.modal_acceleration.iter().copied()).collect()
        };
        let zeros = vec![0.0; nf];
        let still = at(&zeros, &zeros);
        assert!(still[6..].iter().all(|x| x.abs() < 1e-9), "{still:?}");
        assert!(rest.modal_displacement.iter().any(|q| q.abs() > 1e-2));
        let unit = |k: usize, by: f64| (0..nf).map(|i| if i == k { by } else { 0.0 }).collect::<Vec<f64>>();
        let slope = |ahead: Vec<f64>, back: Vec<f64>, size: f64| -> Vec<f64> {
            ahead.iter().zip(&back).map(|(ahead, back)| (ahead - back) / (2.0 * size)).collect()
        };
        // M ξ̈ + C ξ̇ + K ξ of the frame is the reaction, of the modes zero.
        let check = |slope: &[f64], column: &dyn Fn(usize) -> f64| {
            for i in 0..6 + nf {
                let by_modes: f64 = (0..nf).map(|k| rest.mass[(i, 6 + k)] * slope[6 + k]).sum();
                let found = by_modes + column(i);
                let expected = if i < 6 { slope[i] } else { 0.0 };
                assert!((found - expected).abs() < 1e-8 * (1.0 + expected.abs()), "{motion:?} {i}: {found} {expected}");
            }
        };
        for k in 0..nf {
            let by_place = slope(at(&unit(k, size), &zeros), at(&unit(k, -size), &zeros), size);
            check(&by_place, &|i| rest.stiffness[(i, 6 + k)]);
            let by_rate = slope(at(&zeros, &unit(k, size)), at(&zeros, &unit(k, -size)), size);
            check(&by_rate, &|i| rest.damping[(i, 6 + k)]);
        }
        let along = rest.driven.unwrap();
        let of_drive = |matrix: &Mat<f64>, i: usize| (0..6).map(|k| matrix[(i, k)] * along[k]).sum::<f64>();
        let by = |set: &dyn Fn(f64)| {
            let [ahead, back] = [size, -size].map(|by| {
                set(by);
                at(&zeros, &zeros)
            });
            added.hold(0.0);
            slope(ahead, back, size)
        };
        check(&by(&|by| added.hold(by)), &|i| of_drive(&rest.damping, i));
        check(&by(&|by| added.ramp(time, 0.0, by)), &|i| of_drive(&rest.mass, i));
    }
}
