//! A rigid body without a mesh is the body of a mesh without flexible modes.

use faer::Mat;

use nalgebra::{Matrix3, Vector3};
use reduced_body::{BodyError, ReducedBody, RigidMotion};

use crate::held::supports::{body, supports};

/// Conserved: the same constants from a mesh and from a rigid body.
#[test]
fn constants_equal_those_of_a_mesh_whatever_holds_it() {
    let body = body();
    for (support, rigid) in supports(&body.positions) {
        let modes = body.held(&support).modes(0, |_| ()).unwrap();
        let expected = modes.reduced(body.matrices.mass(), &body.positions).unwrap();
        let found =
            ReducedBody::rigid(expected.mass, expected.center_of_mass, expected.inertia, support.motion).unwrap();
        assert_eq!((found.flexible(), found.motion.count()), (0, rigid));
        assert_eq!(found.motion, expected.motion);
        assert!((found.origin - expected.origin).norm() < 1e-12);
        let close = |a: &Matrix3<f64>, b: &Matrix3<f64>| (a - b).norm() <= 1e-12 * b.norm();
        assert!(close(&found.translation_basis, &expected.translation_basis));
        assert!(close(&found.rotation_basis, &expected.rotation_basis));
        let (mut worst, mut largest): (f64, f64) = (0.0, 0.0);
        for (a, b) in (0..3).flat_map(|a| (0..3).map(move |b| (a, b))) {
            let (product, expected_product) = (&found.rotation_products[a][b], &expected.rotation_products[a][b]);
            assert_eq!(product.shape(), (6, 6));
            worst = worst.max((product - expected_product).norm_max());
            largest = largest.max(product.norm_max());
            let with_x = |body: &ReducedBody| Mat::from_fn(6, 1, |k, _| body.position_products[a][b][k]);
            // ∫ρ X_a X_b / √∫ρX² is no larger than √J.
            let scale = found.inertia.norm().sqrt();
            worst = worst.max((with_x(&found) - with_x(&expected)).norm_max() / scale);
        }
        // 6.7e-16 at most.
        assert!(worst < 1e-13, "{:?}: {worst:e}", support.motion);
        assert!(rigid == 0 || largest > 0.1, "{:?}: {largest:e}", support.motion);
        for k in 0..3 {
            assert!(found.translation_first[k].is_empty() && found.rotation_first[k].is_empty());
            assert_eq!(found.gyroscopic[k].shape(), (0, 0));
        }
        assert!(found.inertia_first.iter().all(Vec::is_empty));
        assert!(found.inertia_second.iter().all(|n| n.shape() == (0, 0)));
        assert!(found.stress_stiffness.is_none());
        assert_eq!(found.truncated(3).flexible(), 0);
    }
}

/// Conserved: the rigid modes are orthonormal in the mass metric.
#[test]
fn energy_of_rigid_modal_velocities_is_half_their_square() {
    let inertia = Matrix3::new(5.0, 0.3, -0.2, 0.3, 4.0, 0.5, -0.2, 0.5, 3.0);
    let (mass, center) = (2.5, Vector3::new(0.1, -0.2, 0.3));
    let point = Vector3::new(1.0, 2.0, -1.0);
    let axis = Vector3::new(1.0, 2.0, 2.0) / 3.0;
    // A mass at the centre gives as much of the inertia as it must have about the point.
    let arm = center - point;
    let about_point = inertia + (Matrix3::identity() * arm.norm_squared() - arm * arm.transpose()) * mass;
    for (motion, inertia) in [
        (RigidMotion::free(), inertia),
        (RigidMotion::pin(point), about_point),
        (RigidMotion::hinge(point, axis), about_point),
        (RigidMotion::slider(axis), inertia),
        (RigidMotion::clamp(point), about_point),
    ] {
        let body = ReducedBody::rigid(mass, center, inertia, motion).unwrap();
        assert_eq!(body.origin, motion.fixed_point().unwrap_or(center));
        let metric = [
            (body.translation_basis.transpose() * body.translation_basis) * mass,
            body.rotation_basis.transpose() * inertia * body.rotation_basis,
        ];
        let kept = metric.iter().map(|m| m.trace()).sum::<f64>();
        assert!((kept - motion.count() as f64).abs() < 1e-14);
        // Without a deformation the velocities at one attitude are those at another: Σ_a E_aa is the metric.
        let trace = &body.rotation_products[0][0] + &body.rotation_products[1][1] + &body.rotation_products[2][2];
        for (block, metric) in metric.iter().enumerate() {
            let found = Matrix3::from_fn(|i, j| trace[(3 * block + i, 3 * block + j)]);
            assert!((found - metric).norm() < 1e-14, "{found} {metric}");
        }
    }
}

#[test]
fn what_is_no_rigid_body_is_refused() {
    let refused = |mass: f64, inertia: Matrix3<f64>, motion: RigidMotion| {
        ReducedBody::rigid(mass, Vector3::zeros(), inertia, motion).unwrap_err()
    };
    let unit = Matrix3::identity();
    for mass in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        assert!(matches!(refused(mass, unit, RigidMotion::free()), BodyError::NoInertia { .. }));
    }
    for inertia in [Matrix3::zeros(), -unit, Matrix3::from_diagonal(&Vector3::new(1.0, 1.0, 0.0))] {
        assert!(matches!(refused(1.0, inertia, RigidMotion::free()), BodyError::NoInertia { .. }));
    }
    let nan = Matrix3::from_diagonal(&Vector3::new(1.0, f64::NAN, 1.0));
    assert!(matches!(refused(1.0, nan, RigidMotion::free()), BodyError::NotFinite { .. }));
    let skewed = Matrix3::new(1.0, 0.1, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0);
    let error = refused(1.0, skewed, RigidMotion::free());
    assert!(matches!(error, BodyError::NotSymmetric { row: 1, column: 0, .. }), "{error}");
    let slanted = RigidMotion::slider(Vector3::new(1.0, 1.0, 0.0));
    assert!(matches!(refused(1.0, unit, slanted), BodyError::NotUnit { .. }));
    // Inertia about the hinge only is all that a hinge needs.
    let about_z = Matrix3::from_diagonal(&Vector3::new(0.0, 0.0, 2.0));
    let hinge = |axis| RigidMotion::hinge(Vector3::zeros(), axis);
    assert!(ReducedBody::rigid(1.0, Vector3::zeros(), about_z, hinge(Vector3::z())).is_ok());
    assert!(matches!(refused(1.0, about_z, hinge(Vector3::x())), BodyError::NoInertia { .. }));
}
