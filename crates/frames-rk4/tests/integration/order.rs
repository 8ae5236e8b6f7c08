//! The paper's scheme converges with first order to the limit equation, which is solved here on its own.

use dynamics::{Initial, Motion, SharedLoad};
use frames_rk4::{ModalModel, PaperLimit};
use nalgebra::{DVector, Matrix3, Vector3};

use crate::common::Synthesis as _;
use crate::common::{Specimen, advance, plate};
use crate::limit_equation::LimitEquation;

const END: f64 = 0.2;

/// Tumbling at 10 rad/s with vibration.
fn start() -> Initial {
    Initial {
        attitude: rigid_kin::Attitude::identity(),
        origin: None,
        velocity: Vector3::zeros(),
        omega: Vector3::new(5.0, 5.0, 7.0),
        modal_displacement: vec![0.1, 0.02, 0.02, 0.01],
        modal_velocity: vec![10.0, 5.0, -5.0, 3.0],
    }
}

fn load(specimen: &Specimen) -> SharedLoad {
    specimen.half_sine([-500.0, 0.0, 10.0], [20.0, 10.0, 30.0], 0.5)
}

/// Ψᵀ of the load, from the shapes at its node.
fn modal_force(specimen: &Specimen) -> impl Fn(f64, &Matrix3<f64>) -> DVector<f64> {
    let at = Vector3::new(-500.0, 0.0, 10.0) - specimen.body.center_of_mass;
    let node = specimen.nearest_node([-500.0, 0.0, 10.0]);
    let rigid = specimen.body.rigid_shapes(&at);
    let shapes = &specimen.modes.shapes;
    let columns: Vec<Vector3<f64>> = (0..6)
        .map(|k| rigid.column(k).into())
        .chain((0..shapes.ncols()).map(|k| Vector3::from_fn(|axis, _| shapes[(3 * node + axis, k)])))
        .collect();
    move |t, global_to_body| {
        let force = global_to_body * Vector3::new(20.0, 10.0, 30.0) * (std::f64::consts::PI * t / 0.5).sin();
        DVector::from_iterator(columns.len(), columns.iter().map(|shape| shape.dot(&force)))
    }
}

/// Independent reference: the limit equation, written down a second time; order 1.
#[test]
fn converges_with_first_order_to_the_limit_equation() {
    let plate = plate().truncated(4);
    let first = plate.scheme(0.0, vec![load(&plate)], &start(), 1e-4);
    let (q, y) = (&first.state().modal_displacement, &first.state().modal_velocity);
    let mut limit = LimitEquation::new(&plate, 0.0, modal_force(&plate), q, y);
    let steps = 2000;
    for n in 0..steps {
        limit.step(f64::from(n) * END / f64::from(steps), END / f64::from(steps));
    }

    let model = ModalModel::new(&plate.body, &[0.0; 4], vec![load(&plate)]).unwrap();
    let mut rkmk4 = PaperLimit::new(&plate.body, model, &start()).unwrap();
    for n in 1..=steps {
        let step = END / f64::from(steps);
        rkmk4.step(step, f64::from(n) * step).unwrap();
    }
    // Measured: 2.7e-15 rad.
    assert!(rkmk4.state().attitude.angle_to(&limit.attitude) < 1e-13);

    let errors = [8e-4, 4e-4, 2e-4, 1e-4].map(|step| {
        let mut scheme = plate.scheme(0.0, vec![load(&plate)], &start(), step);
        advance(&mut scheme, (END / step).round() as usize);
        let state = scheme.state();
        let modal = DVector::from_column_slice(&state.modal_displacement[6..]) - limit.displacement.rows(6, 4);
        (state.attitude.angle_to(&limit.attitude), modal.norm() / limit.displacement.rows(6, 4).norm())
    });
    // Measured: attitude 5.26e-3, 2.64e-3, 1.32e-3, 6.61e-4 rad, orders 0.995, 0.997, 0.999. Modal displacements
    // 3.8e-2, 2.9e-3, 8.7e-4, 4.3e-4: at the large steps RK4's own damping of the modes, then order 1.02.
    let order = |coarse: f64, fine: f64| (coarse / fine).log2();
    for pair in errors.windows(2) {
        let attitude = order(pair[0].0, pair[1].0);
        assert!((attitude - 1.0).abs() < 0.02, "{attitude} of {errors:?}");
    }
    let modal = order(errors[2].1, errors[3].1);
    assert!((modal - 1.0).abs() < 0.05, "{modal} of {errors:?}");
}
