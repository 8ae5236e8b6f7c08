//! Motions that are known exactly.

use dynamics::{Initial, SharedLoad};
use frames_rk4::BodyMotion;
use nalgebra::Vector3;
use rigid_kin::{Attitude, RigidBody, RigidState, Wrench};

use crate::common::Synthesis as _;
use crate::common::{Specimen, advance, plate, ring};

fn tumbling() -> Initial {
    Initial {
        attitude: rigid_kin::Attitude::identity(),
        origin: None,
        velocity: Vector3::new(300.0, -100.0, 50.0),
        omega: Vector3::new(4.0, -6.0, 7.0),
        modal_displacement: vec![0.005; 10],
        modal_velocity: vec![10.0; 10],
    }
}

/// Conserved: a body at rest.
#[test]
fn at_rest_it_stays_exactly_at_rest() {
    let mut scheme = ring().scheme(0.05, vec![], &Initial::at_rest(10), 5e-5);
    let before = scheme.state().clone();
    advance(&mut scheme, 500);
    let mut after = scheme.state().clone();
    assert_eq!(after.time, 500.0 * 5e-5);
    after.time = 0.0;
    assert_eq!(after, before);
}

/// Closed form: X + V t.
#[test]
fn a_body_that_flies_without_spin_goes_straight() {
    let velocity = Vector3::new(3.0, -4.0, 12.0) * 100.0;
    let initial = Initial { velocity, ..Initial::at_rest(10) };
    let mut scheme = ring().scheme(0.05, vec![], &initial, 5e-5);
    advance(&mut scheme, 2000);
    let state = scheme.state();
    let expected = ring().body.center_of_mass + velocity * 0.1;
    // Measured: 3.5e-12 mm of 130 after 2000 sums, and no spin or vibration at all.
    assert!((state.origin_global - expected).norm() < 1e-11);
    assert!(state.omega_body.norm() < 1e-12);
    assert!(state.modal_displacement.iter().all(|q| q.abs() < 1e-12));
}

/// Closed form: the sums of RK4 for a force with the mean of both ends in the middle: v by the trapezoidal rule, and
/// `Δx = v Δt + (2 f_n + f_n+1) Δt²/6m`.
#[test]
fn a_force_at_the_centre_of_mass_gives_the_sums_of_rk4() {
    let plate = plate().truncated(0);
    let center = plate.body.center_of_mass;
    let force = Vector3::new(3.0, -2.0, 5.0);
    let load = plate.half_sine(center.into(), force.into(), 0.1);
    let (history, h) = (load.history().unwrap().clone(), 1e-3);
    let mut scheme = plate.scheme(0.0, vec![load], &Initial::at_rest(0), h);
    let motion = BodyMotion::new(&plate.body).unwrap();
    let (mut position, mut velocity) = (center, Vector3::zeros());
    for n in 0..150 {
        let [a, b] = [n, n + 1].map(|k| force * history.at(f64::from(k) * h, f64::from(k) * h) / plate.body.mass);
        position += h * velocity + h * h / 6.0 * (2.0 * a + b);
        velocity += 0.5 * h * (a + b);
        scheme.step().unwrap();
        let found = (motion.position_global(scheme.state()), motion.velocity_global(scheme.state()));
        assert!((found.0 - position).norm() < 1e-12 * position.norm(), "{:e}", (found.0 - position).norm());
        assert!((found.1 - velocity).norm() < 1e-11 * velocity.norm(), "{:e}", (found.1 - velocity).norm());
    }
}

/// Conserved: the impulse is the momentum gained, to first order. Momentum comes by the mean of the stages' forces in
/// frame n, where their components are those of frames that have turned by half a step on the average: the impulse
/// lags by ωΔt/2.
#[test]
fn the_impulse_of_a_load_is_the_momentum_gained_to_first_order() {
    let ring = ring();
    let motion = BodyMotion::new(&ring.body).unwrap();
    let (force, duration) = (Vector3::new(20.0, -10.0, 30.0), 0.02);
    let initial = tumbling();
    let impulse = force * duration * std::f64::consts::FRAC_2_PI;
    let errors = [400, 800].map(|steps| {
        let load = ring.half_sine([-100.0, 0.0, 0.0], force.into(), duration);
        let mut scheme = ring.scheme(0.02, vec![load], &initial, duration / f64::from(steps));
        let before = motion.linear_momentum_global(scheme.state());
        advance(&mut scheme, steps as usize + 100);
        let gained = motion.linear_momentum_global(scheme.state()) - before;
        (gained - impulse).norm() / impulse.norm()
    });
    // Measured: 1.035e-4, 5.18e-5.
    assert!(errors[0] < 1.1e-4 && (errors[0] / errors[1] - 2.0).abs() < 0.01, "{errors:?}");
}

/// Conserved: linear momentum. The centre of mass leaves its line: velocities of stages that have turned are added in
/// frame n, which turns the path by −ωΔt/2.
#[test]
fn without_loads_linear_momentum_is_kept_to_rounding_and_the_path_leans() {
    let ring = ring();
    let motion = BodyMotion::new(&ring.body).unwrap();
    let initial = tumbling();
    for step in [5e-5, 2.5e-5] {
        let mut scheme = ring.scheme(0.02, vec![], &initial, step);
        let before = motion.linear_momentum_global(scheme.state());
        let velocity = before / ring.body.mass;
        let mut turned = Vector3::zeros();
        for _ in 0..(0.2 / step).round() as usize {
            turned += step * scheme.state().attitude.to_global(&scheme.state().omega_body);
            scheme.step().unwrap();
        }
        // Measured: 1.1e-14.
        let after = motion.linear_momentum_global(scheme.state());
        assert!((after - before).norm() < 1e-12 * before.norm());
        // Measured: 1.23e-2 and 6.1e-3 mm of 64, 2e-4 of it not as said.
        let off = motion.position_global(scheme.state()) - ring.body.center_of_mass - 0.2 * velocity;
        let expected = -0.5 * step * turned.cross(&velocity);
        assert!((off - expected).norm() < 1e-3 * off.norm(), "{off:?} {expected:?}");
    }
}

const FORCE: Vector3<f64> = Vector3::new(2.0, 0.0, 5.0);

/// A rigid ring that turns about the normal of its plane of symmetry, driven by a force in this plane.
fn turning_in_plane(reference_points: [[f64; 3]; 3]) -> (Specimen, SharedLoad, Initial) {
    let mut ring = ring().truncated(0);
    ring.reference_points = reference_points;
    let load = ring.half_sine([-100.0, 0.0, 0.0], FORCE.into(), 0.1);
    let spin = ring.spinning(Vector3::new(0.0, 3.0, 0.0));
    (ring, load, spin)
}

/// Independent reference: the rigid body of rigid-kin by its own RK4.
#[test]
fn plane_motion_under_a_dead_force_tends_to_that_of_a_rigid_body() {
    let (ring, load, initial) = turning_in_plane([[-100.0, 0.0, 0.0], [-100.0, 0.0, 20.0], [-80.0, 0.0, 0.0]]);
    let rigid = RigidBody::new(ring.body.mass, ring.body.inertia).unwrap();
    let motion = BodyMotion::new(&ring.body).unwrap();
    let at = ring.point([-100.0, 0.0, 0.0]).position_body();
    let wrench =
        |t: f64, attitude: &Attitude| Wrench::dead_force(attitude, &at, &(FORCE * load.history().unwrap().at(t, t)));
    let mut expected = RigidState {
        attitude: Attitude::identity(),
        omega_body: initial.omega,
        position_global: ring.body.center_of_mass,
        velocity_global: Vector3::zeros(),
    };
    for n in 0..2000 {
        expected = rigid.step(&expected, f64::from(n) * 1e-4, 1e-4, wrench).unwrap();
    }
    let errors = [2e-4, 1e-4].map(|step| {
        let mut scheme = ring.scheme(0.0, vec![load.clone()], &initial, step);
        for _ in 0..(0.2 / step).round() as usize {
            let state = scheme.step().unwrap();
            let moment = wrench(state.time, &state.attitude).moment_body;
            let euler = rigid.angular_acceleration_body(&state.omega_body, &moment);
            for alpha in [state.alpha_body, motion.euler_alpha_body(state)] {
                assert!((alpha - euler).norm() < 1e-6, "{alpha:?} {euler:?}");
            }
        }
        let state = scheme.state();
        [
            state.attitude.angle_to(&expected.attitude),
            (state.omega_body - expected.omega_body).norm() / expected.omega_body.norm(),
            (state.origin_global - expected.position_global).norm() / expected.position_global.norm(),
        ]
    });
    // Measured after 2 rad, at 16 rad/s: attitude 4.1e-3, 2.0e-3; ω 3.6e-3, 1.8e-3; position 2.2e-3, 1.1e-3.
    for (coarse, fine) in errors[0].iter().zip(&errors[1]) {
        assert!((coarse / fine - 2.0).abs() < 0.05, "{errors:?}");
    }
}

/// Closed form: the lamina through R, P, Q that h of (37) takes the body for. Even in plane motion it is Euler's
/// equation only if the axis is e1, e3 or e3×e1 of the reference points; the scheme does not use it.
#[test]
fn h_is_off_in_plane_motion_when_the_reference_points_are_oblique_to_the_axis() {
    let (ring, load, initial) = turning_in_plane(ring().reference_points);
    let motion = BodyMotion::new(&ring.body).unwrap();
    let mut scheme = ring.scheme(0.0, vec![load], &initial, 1e-4);
    advance(&mut scheme, 500);
    let [r, p, q] = ring.reference_points_body();
    let e1 = (p - r).normalize();
    let e3 = e1.cross(&(q - r)).normalize();
    let e2 = e3.cross(&e1);
    let state = scheme.state();
    let [w1, w2, w3] = [e1, e2, e3].map(|e| e.dot(&state.omega_body));
    let lamina = w2 * w3 * e1 - w1 * w3 * e2 + w1 * w2 * e3;
    let difference = motion.euler_alpha_body(state) - state.alpha_body;
    // Measured: |lamina| 15.7 rad/s² beside an α of 212; 2e-5 of it is the gyroscopic term of the true body, which the
    // stages' ω has tipped a little.
    assert!(lamina.norm() > 0.01 * state.alpha_body.norm());
    assert!((difference - lamina).norm() < 1e-4 * lamina.norm(), "{difference:?} {lamina:?}");
}
