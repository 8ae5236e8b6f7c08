//! The forces of rigid motions on the nodes.

use faer::Mat;
use modal::{ModalError, Support, acceleration_fields, centrifugal_fields, turning_field};
use nalgebra::Vector3;
use reduced_body::ReducedBody;

use crate::bodies::STEEL;
use crate::held::supports::{body, supports};
use crate::statics::responses::{Bar, work};

/// Σ ω_iω_j f_ij over all nine ij.
fn of_spin(fields: &Mat<f64>, omega: &Vector3<f64>) -> Mat<f64> {
    let weight = |pair: usize| {
        let (i, j) = ReducedBody::PAIRS[pair];
        omega[i] * omega[j] * if i == j { 1.0 } else { 2.0 }
    };
    fields * Mat::from_fn(6, 1, |pair, _| weight(pair))
}

/// Independent reference: M a with −ω×(ω×x) at each node.
#[test]
fn centrifugal_fields_make_the_centrifugal_force_of_any_spin() {
    let body = body();
    let solver = body.held(&Support::free());
    let origin = Vector3::new(3.0, -8.0, 2.0);
    let omega = Vector3::new(0.7, -1.1, 2.3);
    let fields = centrifugal_fields(solver.mass(), &body.positions, &origin).unwrap();
    let acceleration = Mat::from_fn(3 * body.positions.len(), 1, |i, _| {
        -omega.cross(&omega.cross(&(Vector3::from(body.positions[i / 3]) - origin)))[i % 3]
    });
    let expected = body.matrices.mass() * acceleration;
    let off = (of_spin(&fields, &omega) - &expected).norm_max() / expected.norm_max();
    // 3.5e-16.
    assert!(off < 1e-13, "{off:e}");

    // The resultant is that of the mass at its centre.
    let rigid = solver.rigid();
    let resultant = acceleration_fields(solver.mass());
    let mass = Mat::from_fn(3, 3, |i, j| (i..resultant.nrows()).step_by(3).map(|row| resultant[(row, j)]).sum::<f64>());
    assert!((mass - Mat::<f64>::identity(3, 3) * faer::Scale(rigid.mass)).norm_max() < 1e-13 * rigid.mass);
    let force = of_spin(&fields, &omega);
    let pull = Vector3::from_fn(|axis, _| (axis..force.nrows()).step_by(3).map(|i| force[(i, 0)]).sum::<f64>());
    let at_center = -omega.cross(&omega.cross(&(rigid.center_of_mass - origin))) * rigid.mass;
    assert!((pull - at_center).norm() < 1e-12 * at_center.norm());
}

/// Conserved: Φᵀf_ij = c_ij.
#[test]
fn the_modes_meet_centrifugal_fields_as_c_ij() {
    let body = body();
    for (support, _) in supports(&body.positions) {
        let solver = body.held(&support);
        let modes = solver.modes(6, |_| ()).unwrap();
        let reduced = modes.reduced(body.matrices.mass(), &body.positions).unwrap();
        let fields = centrifugal_fields(solver.mass(), &body.positions, &reduced.origin).unwrap();
        let found = modes.shapes.transpose() * fields;
        let scale = reduced.inertia.norm().sqrt();
        for (pair, expected) in reduced.inertia_first.iter().enumerate() {
            for (k, expected) in expected.iter().enumerate() {
                let off = (found[(k, pair)] - expected).abs() / scale;
                assert!(off < 1e-12, "{:?}: {off:e}", support.motion);
            }
        }
    }
}

/// Closed form: u = ρω²/E (L²x/2 − x³/6).
#[test]
fn a_spinning_rod_stretches_as_the_closed_form_says() {
    let bar = Bar::new(100.0);
    let (length, spin) = (bar.length, 200.0_f64);
    let omega = Vector3::z() * spin;
    let pull = STEEL.density * spin.powi(2) / STEEL.young_modulus;
    // Clamped to a shaft at its end; free, about its middle.
    for (support, origin) in [(bar.clamp(), -0.5 * length), (Support::free(), 0.0)] {
        let reach = 0.5 * length - origin;
        let expected = |x: f64| pull * (reach.powi(2) * x / 2.0 - x.powi(3) / 6.0);
        let origin = Vector3::new(origin, 0.0, 0.0);
        let solver = bar.body.held(&support);
        let fields = centrifugal_fields(solver.mass(), &bar.body.positions, &origin).unwrap();
        let answers = solver.static_response(fields.as_ref()).unwrap();
        let stretch = of_spin(&answers, &omega);
        let tip = bar.traction(1.0, 0);
        let off = work(&tip, &stretch) / expected(reach) - 1.0;
        // 4.9e-14: quadratic elements are exact at the ends here.
        assert!(off.abs() < 1e-10, "{off:e}");
        let worst = bar
            .body
            .positions
            .iter()
            .enumerate()
            .map(|(node, x)| (stretch[(3 * node, 0)] - expected(x[0] - origin.x)).abs() / expected(reach));
        let worst = worst.fold(0.0, f64::max);
        // 9.7e-6 and 7.7e-5, at the middles of elements.
        assert!(worst < 2e-4, "{worst:e}");
    }
}

/// Closed form: u = ρg/E (Ls − s²/2).
#[test]
fn a_hanging_rod_stretches_exactly() {
    let bar = Bar::new(100.0);
    let solver = bar.body.held(&bar.clamp());
    let answers = solver.static_response(acceleration_fields(solver.mass()).as_ref()).unwrap();
    let weight = STEEL.density / STEEL.young_modulus;
    for (node, x) in bar.body.positions.iter().enumerate() {
        let s = x[0] + 0.5 * bar.length;
        let expected = weight * (bar.length * s - 0.5 * s * s);
        let off = (answers[(3 * node, 0)] - expected).abs() / (0.5 * weight * bar.length.powi(2));
        // 9.1e-13 at most.
        assert!(off < 1e-9, "{off:e}");
    }
}

#[test]
fn positions_for_other_nodes_are_refused() {
    let body = body();
    let solver = body.held(&Support::free());
    let (few, origin) = (&body.positions[1..], Vector3::zeros());
    let is_refused =
        |found: Result<Mat<f64>, ModalError>| matches!(found, Err(ModalError::Size { what: "positions", .. }));
    assert!(is_refused(centrifugal_fields(solver.mass(), few, &origin)));
    assert!(is_refused(turning_field(solver.mass(), few, &origin, &Vector3::z())));
}
