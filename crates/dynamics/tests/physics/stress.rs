//! Stress stiffens a body: loads and drives that do their work on displacements of second order.

use dynamics::{Drive, DrivenMotion, DrivenSpeed, History, PointShapes, SecondOrder};
use faer::Mat;
use nalgebra::Vector3;
use reduced_body::{ReducedBody, RigidMotion};

use crate::sample::{EXPONENTIAL, RKMK4, Run, body, dead_force, point};

/// A made-up K_i (nf×nf), symmetric.
fn stiffness(i: usize, nf: usize) -> Mat<f64> {
    Mat::from_fn(nf, nf, |k, l| (1.3 * (k + l) as f64 + (k * l) as f64 + 2.1 * i as f64).sin())
}

/// Displacements of second order by made-up stiffnesses in three directions.
pub fn second_order(nf: usize) -> SecondOrder {
    let axes = [Vector3::x(), Vector3::y(), Vector3::z()];
    SecondOrder::new(axes.into_iter().enumerate().map(|(i, axis)| (axis, stiffness(i, nf))).collect()).unwrap()
}

/// u₂ of [`second_order`].
fn displacement(q: &[f64]) -> Vector3<f64> {
    Vector3::from_fn(|i, _| {
        let k = stiffness(i, q.len());
        -0.5 * (0..q.len())
            .flat_map(|a| (0..q.len()).map(move |b| (a, b)))
            .map(|(a, b)| q[a] * k[(a, b)] * q[b])
            .sum::<f64>()
    })
}

/// X + Ψq + u₂ of the point of [`point`].
fn arm(body: &ReducedBody, at: [f64; 3], q: &[f64]) -> Vector3<f64> {
    let shapes = point(body, at);
    let modal: Vector3<f64> = shapes.columns()[6..].iter().zip(q).map(|(shape, q)| shape * *q).sum();
    Vector3::from(at) + modal + displacement(q)
}

/// Conserved: energy less the force times the way.
#[test]
fn a_constant_dead_force_has_a_potential() {
    let at = [0.5, -0.2, 0.4];
    let force = Vector3::new(0.5, 1.0, -0.7);
    for motion in [RigidMotion::free(), RigidMotion::pin(Vector3::zeros()), RigidMotion::clamp(Vector3::zeros())] {
        let body = body(motion, &[5.0, 8.0, 13.0]);
        let mut run = Run::new(&body, 3.0);
        run.loads = vec![dead_force(point(&body, at).with_second_order(second_order(3)), force, History::Constant)];
        for (method, step) in [(EXPONENTIAL, 5e-3), (RKMK4, 2e-3)] {
            let [first, last] = run.ends(method, step);
            let position = |o: &dynamics::Observation| {
                o.origin_global + o.attitude.to_global(&arm(&body, at, &o.modal_displacement))
            };
            let way = force.dot(&(position(&last) - position(&first)));
            let gained = last.kinetic_energy + last.strain_energy - first.kinetic_energy - first.strain_energy;
            // Measured: 3e-9 of the energy at worst.
            assert!((gained - way).abs() < 1e-7 * first.energy(), "{motion:?} {method:?}: {gained} {way}");
            assert!(way.abs() > 0.01 * first.energy(), "the force does something");
        }
    }
}

fn clamped() -> ReducedBody {
    body(RigidMotion::clamp(Vector3::zeros()), &[5.0, 8.0, 13.0])
}

fn drive(motion: DrivenMotion) -> Drive {
    let history = History::HalfSine { start: 0.0, duration: 4.0 };
    Drive { motion, speed: DrivenSpeed { amplitude: 1.2, history }, added: None }
}

/// Conserved: the balance of energy; order 4.
#[test]
fn the_stress_of_a_driven_motion_closes_the_balance_of_energy() {
    let unit = Vector3::new(2.0, -1.0, 2.0) / 3.0;
    for motion in [DrivenMotion::Turn { axis: unit }, DrivenMotion::Slide { direction: unit }] {
        let body = clamped();
        let mut run = Run::new(&body, 2.0);
        run.physics.drive = Some(drive(motion));
        run.damping_ratio = 0.02;
        let gap = |run: &Run<'_>, step: f64| run.energy_gap(EXPONENTIAL, step);
        let [_, without] = run.ends(EXPONENTIAL, 5e-3);
        run.physics.drive_stiffness = Some(stiffness(0, 3));
        let [_, with] = run.ends(EXPONENTIAL, 5e-3);
        let change = with.modal_displacement[0] - without.modal_displacement[0];
        assert!(change.abs() > 1e-4, "the stress does something: {change:e}");
        let gaps = [gap(&run, 0.04), gap(&run, 0.01)];
        // Fourth order; measured: 2e-9 at 0.01.
        assert!(gaps[1] < 1e-6 && gaps[0] / gaps[1] > 100.0, "{motion:?}: {gaps:?}");
    }
}

/// Conserved: in the frame of a slide the body meets the inertia of its acceleration, which has the same stress as a
/// weight.
#[test]
fn a_driven_slide_stiffens_as_a_base_acceleration_does() {
    let direction = Vector3::new(2.0, -1.0, 2.0) / 3.0;
    let body = clamped();
    let mut run = Run::new(&body, 2.0);
    run.initial.modal_velocity.fill(0.0);
    run.physics.drive = Some(drive(DrivenMotion::Slide { direction }));
    let k = stiffness(0, 3);
    run.physics.drive_stiffness = Some(k.clone());
    let [_, driven] = run.ends(EXPONENTIAL, 5e-3);

    // v' = a π/4 cos(π t/4) = a π/4 sin(π (t + 2)/4). The momentum p = q̇ + v b holds none at the start: v is zero.
    run.physics = dynamics::Physics::default();
    let shapes = Mat::from_fn(3, 3, |i, k| body.translation_first[i][k] / body.mass);
    let center = PointShapes::new(&body, &reduced_body::BodyPoint { position_body: body.center_of_mass, shapes });
    let per_mass = Mat::from_fn(3, 3, |i, j| k[(i, j)] / body.mass);
    let center = center.with_second_order(SecondOrder::new(vec![(direction, per_mass)]).unwrap());
    let acceleration = 1.2 * std::f64::consts::PI / 4.0;
    let history = History::HalfSine { start: -2.0, duration: 4.0 };
    run.loads = vec![dead_force(center, -direction * body.mass * acceleration, history)];
    let [_, shaken] = run.ends(EXPONENTIAL, 5e-3);
    for (a, b) in driven.modal_displacement.iter().zip(&shaken.modal_displacement) {
        // Measured: 2e-9, and a sixteenth at half the step.
        assert!((a - b).abs() < 1e-7, "{a} {b}");
    }
    let with_stress = shaken.modal_displacement;
    run.loads.clear();
    let [_, free] = run.ends(EXPONENTIAL, 5e-3);
    assert!((with_stress[0] - free.modal_displacement[0]).abs() > 1e-3);
}

/// Closed form: a body under a constant load of one direction vibrates at the frequencies of Λ + a K about its new
/// rest.
#[test]
fn a_steady_load_moves_the_frequencies_as_its_stiffness_says() {
    let body = body(RigidMotion::clamp(Vector3::zeros()), &[5.0]);
    let mut run = Run::new(&body, 4.0);
    run.initial.modal_velocity.fill(0.0);
    let k = Mat::from_fn(1, 1, |_, _| 2.0);
    let shapes = Mat::zeros(3, 1);
    let point = PointShapes::new(&body, &reduced_body::BodyPoint { position_body: Vector3::zeros(), shapes });
    let point = point.with_second_order(SecondOrder::new(vec![(Vector3::x(), k)]).unwrap());
    for force in [4.0, -4.0] {
        run.loads = vec![dead_force(point.clone(), Vector3::x() * force, History::Constant)];
        let [first, last] = run.ends(EXPONENTIAL, 2e-3);
        let omega = (25.0_f64 + 2.0 * force).sqrt();
        let expected = first.modal_displacement[0] * (omega * 4.0).cos();
        // Measured: 3e-11.
        assert!((last.modal_displacement[0] - expected).abs() < 1e-9, "{force}");
    }
}

/// Conserved: where the speed of a drive jumps, the body goes on as after a rise that is ever steeper.
#[test]
fn a_jump_of_a_driven_speed_is_the_limit_of_steep_rises() {
    let unit = Vector3::new(2.0, -1.0, 2.0) / 3.0;
    for motion in [DrivenMotion::Turn { axis: unit }, DrivenMotion::Slide { direction: unit }] {
        let body = clamped();
        let mut run = Run::new(&body, 2.0);
        run.physics.drive_stiffness = Some(stiffness(0, 3));
        let mut end = |history: History| {
            run.physics.drive = Some(Drive { motion, speed: DrivenSpeed { amplitude: 1.2, history }, added: None });
            let gap = run.energy_gap(EXPONENTIAL, 1e-3);

            assert!(gap < 1e-8, "{motion:?}: {gap:e}");
            let [_, last] = run.ends(EXPONENTIAL, 1e-3);
            last.modal_displacement
        };
        let jump = end(History::Step { at: 1.25 });
        let off = [0.01, 0.005].map(|duration| {
            let rise = end(History::Ramp { start: 1.25 - 0.5 * duration, duration });
            rise.iter().zip(&jump).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
        });
        // The way within the rise is another: first order in its duration, at least.
        assert!(off[1] < 1e-4 && off[0] / off[1] > 1.8, "{motion:?}: {off:?}");
    }
}
