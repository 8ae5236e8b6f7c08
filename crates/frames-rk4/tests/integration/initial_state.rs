//! The state at the beginning is (30) and (31) of the velocity field `V + ω×(X + u) + Ψ_f q̇`.

use dynamics::{Initial, Observation, Physics, Rows, Setup, Simulation, StepControl};
use nalgebra::{DMatrix, DVector, Vector3};
use rigid_kin::Attitude;

use crate::common::Synthesis as _;
use crate::common::ring;
use crate::literal::Csc;

/// Independent reference: the projection ΨᵀM at the nodes.
#[test]
fn the_initial_state_is_the_projected_velocity_field() {
    let ring = ring();
    let initial = Initial {
        attitude: rigid_kin::Attitude::identity(),
        origin: None,
        velocity: Vector3::new(300.0, -100.0, 50.0),
        omega: Vector3::new(4.0, -6.0, 7.0),
        modal_displacement: (0..10).map(|k| 0.02 - 0.003 * f64::from(k)).collect(),
        modal_velocity: (0..10).map(|k| 10.0 - 3.0 * f64::from(k)).collect(),
    };
    let mass = Csc::new(ring.matrices.mass());
    let positions = ring.mesh.positions();
    let mut displacement = DVector::zeros(3 * positions.len());
    let mut field = displacement.clone();
    let psi = DMatrix::from_fn(displacement.len(), 16, |i, k| {
        if k < 6 { ring.modes.rigid.shapes[(i, k)] } else { ring.modes.shapes[(i, k - 6)] }
    });
    for (node, x) in positions.iter().enumerate() {
        let shapes = ring.modes.point(positions, &[node as u32], &[1.0]).unwrap().shapes;
        let sum = |coordinates: &[f64]| -> Vector3<f64> {
            Vector3::from_fn(|axis, _| coordinates.iter().enumerate().map(|(k, q)| shapes[(axis, k)] * q).sum())
        };
        let u = sum(&initial.modal_displacement);
        let at = Vector3::from(*x) - ring.body.center_of_mass + u;
        let v = initial.velocity + initial.omega.cross(&at) + sum(&initial.modal_velocity);
        displacement.fixed_rows_mut::<3>(3 * node).copy_from(&u);
        field.fixed_rows_mut::<3>(3 * node).copy_from(&v);
    }
    let [q, y] = [displacement, field].map(|x| psi.tr_mul(&mass.times_vector(&x)));

    let scheme = ring.scheme(0.0, vec![], &initial, 5e-5);
    let state = scheme.state();
    let error = |found: &[f64], expected: &DVector<f64>| {
        (DVector::from_column_slice(found) - expected).amax() / expected.amax()
    };
    // Measured: 6e-16, 7e-16.
    assert!(error(&state.modal_displacement, &q) < 1e-12);
    assert!(error(&state.modal_velocity, &y) < 1e-12);
    // The dummy body's ω is that of the rigid modes: the given one, and a part of the order of the deformation.
    // Measured: 4.4e-3 for a deformation of about 1 mm.
    let shift = (state.omega_body - initial.omega).norm() / initial.omega.norm();
    assert!(shift > 1e-3 && shift < 1e-2, "{shift}");
}

/// Conserved: the states of the paper's formulation are of an inertial frame; read as a motion of the body they are
/// what was given, and a run that begins turned is the same run, turned.
#[test]
fn states_of_the_paper_s_formulation_are_what_was_given_in_any_attitude() {
    let ring = ring();
    let turn = Attitude::from_wxyz([0.8, -0.2, 0.4, 0.3]).unwrap();
    for method in [frames_rk4::PAPER, frames_rk4::LIMIT] {
        let run = |attitude: Attitude| {
            let mut initial = ring.spinning(Vector3::new(4.0, -6.0, 7.0));
            initial.attitude = attitude;
            initial.velocity = attitude.to_global(&Vector3::new(300.0, -100.0, 50.0));
            initial.modal_displacement.fill(0.005);
            initial.modal_velocity.fill(10.0);
            let force = attitude.to_global(&Vector3::new(2.0, -1.0, 3.0));
            let simulation = Simulation::new(&Setup {
                body: &ring.body,
                damping_ratios: &[0.02; 10],
                loads: &[ring.half_sine([-100.0, 0.0, 0.0], force.into(), 0.01)],
                physics: &Physics::default(),
                initial: &initial,
                method: frames_rk4::Paper { reference_points: ring.reference_points_body() }.or(&method),
                control: StepControl::Fixed(1e-5),
                end: 2e-3,
                rows: Rows::Interval(2e-3),
                points: &[],
            })
            .unwrap();
            let state = simulation.states().unwrap().remove(0);
            assert!((state.omega_body - initial.omega).norm() < 1e-10, "{}", state.omega_body);
            assert!((state.velocity_global - initial.velocity).norm() < 1e-9, "{}", state.velocity_global);
            let off = state.modal_velocity.iter().map(|v| (v - 10.0).abs()).fold(0.0, f64::max);
            assert!(off < 1e-9, "{off:e}");
            simulation.last().unwrap().unwrap()
        };
        let (straight, turned) = (run(Attitude::identity()), run(turn));
        assert!((straight.omega_body - turned.omega_body).norm() < 1e-9);
        let moved = |row: &Observation| row.velocity_global;
        assert!((turn.to_global(&moved(&straight)) - moved(&turned)).norm() < 1e-7);
        for (a, b) in straight.modal_displacement.iter().zip(&turned.modal_displacement) {
            assert!((a - b).abs() < 1e-11, "{a} {b}");
        }
    }
}
