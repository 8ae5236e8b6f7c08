//! Quantities that are read off a state, against sums over the nodes.

use frames_rk4::{BodyMotion, State};
use nalgebra::{DVector, Vector3};
use rigid_kin::{Attitude, RigidBody};

use crate::common::{Specimen, ring};
use crate::literal::Csc;

/// A state with every entry different from zero, of a body that turns and vibrates by several mm.
fn state(specimen: &Specimen) -> State {
    // sin(k²) has no pattern.
    let list = |seed: f64, size: f64| {
        (0..6 + specimen.body.flexible()).map(|k| size * (seed + (k * k) as f64).sin()).collect::<Vec<f64>>()
    };
    State {
        time: 0.7,
        attitude: Attitude::from_wxyz([0.5, -0.1, 0.7, 0.3]).unwrap(),
        origin_global: Vector3::new(120.0, -40.0, 33.0),
        modal_displacement: list(1.0, 0.05),
        modal_velocity: list(2.0, 30.0),
        modal_acceleration: list(3.0, 1e4),
        omega_body: Vector3::new(4.0, -6.0, 7.0),
        alpha_body: Vector3::new(40.0, 60.0, -70.0),
    }
}

/// A field over the nodes from modal coordinates, body components.
fn field(specimen: &Specimen, modal: &[f64]) -> DVector<f64> {
    let (rigid, flexible) = (&specimen.modes.rigid.shapes, &specimen.modes.shapes);
    let shape = |i: usize, k: usize| if k < 6 { rigid[(i, k)] } else { flexible[(i, k - 6)] };
    DVector::from_fn(rigid.nrows(), |i, _| modal.iter().enumerate().map(|(k, q)| shape(i, k) * q).sum())
}

fn at(field: &DVector<f64>, node: usize) -> Vector3<f64> {
    field.fixed_rows::<3>(3 * node).into()
}

/// Independent reference: sums over the nodes.
#[test]
fn energy_and_momenta_are_the_sums_over_the_nodes() {
    let ring = ring();
    let (state, motion) = (state(ring), BodyMotion::new(&ring.body).unwrap());
    let (u, v) = (field(ring, &state.modal_displacement), field(ring, &state.modal_velocity));
    let mass = Csc::new(ring.matrices.mass());
    let momentum = mass.times_vector(&v);
    let nodes = 0..ring.mesh.positions().len();

    let kinetic = 0.5 * v.dot(&momentum);
    let strain = 0.5 * u.dot(&Csc::new(ring.matrices.stiffness()).times_vector(&u));
    let linear = state.attitude.to_global(&nodes.clone().map(|n| at(&momentum, n)).sum::<Vector3<f64>>());
    // Σ M x is the mass times the mean of x, so the centre of mass comes from M u.
    let mean_u = nodes.clone().map(|n| at(&mass.times_vector(&u), n)).sum::<Vector3<f64>>() / ring.body.mass;
    let center = state.origin_global + state.attitude.to_global(&mean_u);
    let angular: Vector3<f64> = nodes
        .map(|n| {
            let x = Vector3::from(ring.mesh.positions()[n]) - ring.body.center_of_mass + at(&u, n) - mean_u;
            x.cross(&at(&momentum, n))
        })
        .sum();
    let angular = state.attitude.to_global(&angular);

    let relative = |found: f64, expected: f64| (found / expected - 1.0).abs();
    let relative_3 = |found: Vector3<f64>, expected: Vector3<f64>| (found - expected).norm() / expected.norm();
    let errors = [
        relative(motion.kinetic_energy(&state), kinetic),
        relative(motion.strain_energy(&state), strain),
        relative_3(motion.linear_momentum_global(&state), linear),
        relative_3(motion.velocity_global(&state), linear / ring.body.mass),
        relative_3(motion.position_global(&state), center),
        relative_3(motion.angular_momentum_global(&state), angular),
    ];
    // Measured: 3.1e-13 for the strain energy, where K is rounded; 1e-15 for the others.
    assert!(errors.iter().all(|e| *e < 1e-11), "{errors:?}");
}

/// Independent reference: the fields at the node.
#[test]
fn a_point_moves_as_its_node() {
    let ring = ring();
    let (state, motion) = (state(ring), BodyMotion::new(&ring.body).unwrap());
    let fields = [&state.modal_displacement, &state.modal_velocity, &state.modal_acceleration].map(|c| field(ring, c));
    for node in [0, 77, 1500] {
        let x = Vector3::from(ring.mesh.positions()[node]);
        let from_center = x - ring.body.center_of_mass;
        let found = motion.point(&state, &ring.point(x.into()));
        let [u, v, a] = [0, 1, 2].map(|i| at(&fields[i], node));
        let now = state.origin_global + state.attitude.to_global(&(from_center + u));
        let errors = [
            (found.displacement - (now - x)).norm() / (now - x).norm(),
            (found.velocity - state.attitude.to_global(&v)).norm() / v.norm(),
            (found.acceleration - state.attitude.to_global(&a)).norm() / a.norm(),
        ];
        assert!(errors.iter().all(|e| *e < 1e-13), "{errors:?}");
    }
}

/// Independent reference: central differences: `a + α×X + ω×(ω×X)` is the second derivative of the path of a point
/// that turns at ω and α.
#[test]
fn rigid_accelerations_are_those_of_the_embedded_rigid_motion() {
    let ring = ring();
    let motion = BodyMotion::new(&ring.body).unwrap();
    let mut state = state(ring);
    let rigid = RigidBody::new(ring.body.mass, ring.body.inertia).unwrap();
    let alpha_modal = ring.body.rotation_basis * Vector3::from_column_slice(&state.modal_acceleration[3..6]);
    let moment = ring.body.inertia * alpha_modal;
    let expected = rigid.angular_acceleration_body(&state.omega_body, &moment);
    state.alpha_body = motion.euler_alpha_body(&state);
    assert!((state.alpha_body - expected).norm() < 1e-12 * expected.norm());

    let x = Vector3::new(-100.0, 0.0, 0.0);
    let from_center = x - ring.body.center_of_mass;
    let (omega, alpha) = (state.omega_body, state.alpha_body);
    // Second derivative of exp([θ×]) X at θ = ωt + αt²/2, by central differences of fourth order.
    let s = 1e-3;
    let turned = |t: f64| nalgebra::Rotation3::new(omega * t + alpha * (0.5 * t * t)) * from_center;
    let second = (-turned(2.0 * s) + 16.0 * turned(s) - 30.0 * from_center + 16.0 * turned(-s) - turned(-2.0 * s))
        / (12.0 * s * s);
    let of_origin = Vector3::from_column_slice(&state.modal_acceleration[..3]) / ring.body.mass.sqrt();
    let expected = state.attitude.to_global(&(of_origin + second));
    let found = motion.point(&state, &ring.point(x.into())).rigid_acceleration;
    let part = (found - expected).norm() / second.norm();
    // Measured: 2.3e-6, of the differences.
    assert!(part < 1e-5, "{part:e}");
}
