//! Point masses keep mass, first and second moments, wherever they sit and whatever carries them.

use fem_tet10::{AssemblyError, AssemblyFault, Material, Materials, Mesh, PointMass, assemble};

use crate::fixtures::{ALUMINIUM, Random, assert_close, data_mesh, form, moments, single, workspace_mesh};

/// A body so light that M is the point mass alone, to the last digit.
fn weightless() -> Materials {
    Materials::Uniform(Material { density: 1e-40, ..ALUMINIUM })
}

/// Mass, first and second moments, relative to the mass and the mesh's size. Measured: 7e-16 at worst inside an
/// element, 2e-14 where spread.
#[track_caller]
fn assert_moments(mesh: &Mesh, point: PointMass, tolerance: f64) {
    let matrices = assemble(mesh, &weightless(), &[point]).unwrap();
    for axis in 0..3 {
        let found = moments(mesh, matrices.mass(), axis);
        assert_close("mass", found.zeroth, point.mass, tolerance);
        for j in 0..3 {
            let off = (found.first[j] - point.mass * point.at[j]).abs() / (point.mass * mesh.diagonal());
            assert!(off < tolerance, "first moment {j} off by {off:e}");
            for k in 0..3 {
                let exact = point.mass * point.at[j] * point.at[k];
                let off = (found.second[j][k] - exact).abs() / (point.mass * mesh.diagonal().powi(2));
                assert!(off < tolerance, "second moment {j}{k} off by {off:e}");
            }
        }
    }
    let mut random = Random(11);
    for _ in 0..5 {
        let v: Vec<f64> = (0..3 * mesh.positions().len()).map(|_| random.unit() - 0.5).collect();
        assert!(form(&v, matrices.mass(), &v) >= 0.0, "M must have no negative energy");
    }
}

/// Conserved: mass, first and second moments of the point mass.
#[test]
fn on_a_node_the_mass_is_on_the_diagonal_alone() {
    let mesh = data_mesh("two_materials.msh");
    let point = PointMass { at: [28.0, 10.0, 10.0], mass: 0.3, spread: None };
    assert_moments(&mesh, point, 1e-14);
    let bare = assemble(&mesh, &weightless(), &[]).unwrap();
    let laden = assemble(&mesh, &weightless(), &[point]).unwrap();
    assert_eq!(bare.mass().val().len(), laden.mass().val().len(), "the pattern is unchanged");
    let changed = bare.mass().val().iter().zip(laden.mass().val()).filter(|(a, b)| a != b).count();
    assert_eq!(changed, 3);
}

/// Conserved: mass, first and second moments of the point mass.
#[test]
fn inside_an_element() {
    for at in [[3.3, 4.1, 2.9], [21.7, 9.3, 0.4], [20.0, 5.5, 5.2], [11.0, 0.0, 3.0]] {
        assert_moments(&data_mesh("two_materials.msh"), PointMass { at, mass: 0.3, spread: None }, 1e-12);
    }
}

/// Conserved: mass, first and second moments of the point mass.
#[test]
fn inside_a_curved_element() {
    assert_moments(&workspace_mesh("ring.msh"), PointMass { at: [0.0, -91.0, 7.0], mass: 2.0, spread: None }, 1e-12);
}

/// Conserved: mass, first and second moments of the point mass.
#[test]
fn on_a_curved_surface_just_outside_of_the_elements() {
    for angle in [0.7_f64, 1.9, 3.3, 5.0] {
        let at = [100.0 * angle.cos(), 100.0 * angle.sin(), 7.0];
        assert_moments(&workspace_mesh("ring.msh"), PointMass { at, mass: 2.0, spread: None }, 1e-12);
    }
}

/// Conserved: mass, first and second moments of the point mass.
#[test]
fn spread_on_a_corner_an_edge_a_face_and_inside() {
    let plate = workspace_mesh("plate.msh");
    assert_moments(&plate, PointMass { at: [-500.0, -25.0, 0.0], mass: 0.001, spread: Some(20.0) }, 1e-10);
    assert_moments(&plate, PointMass { at: [3.0, 4.0, 10.0], mass: 0.001, spread: Some(20.0) }, 1e-10);
    let block = data_mesh("two_materials.msh");
    for at in [[0.0, 0.0, 0.0], [28.0, 5.0, 10.0], [13.0, 4.0, 10.0], [14.5, 3.0, 4.0]] {
        for radius in [6.0, 8.5, 13.0] {
            assert_moments(&block, PointMass { at, mass: 0.001, spread: Some(radius) }, 1e-10);
        }
    }
}

/// Conserved: mass, first and second moments of the point mass.
#[test]
fn spread_over_one_node_on_it() {
    let point = PointMass { at: [28.0, 10.0, 10.0], mass: 0.001, spread: Some(1e-3) };
    assert_moments(&data_mesh("two_materials.msh"), point, 1e-14);
}

/// Conserved: mass, first and second moments of the point mass.
#[test]
fn spread_over_nodes_in_one_plane_serves_points_of_that_plane_only() {
    // Within 5 of these points are four nodes, all with z = 0.
    let mesh = Mesh::new(single([[0.0, 0.0, 0.0], [10.0, 0.0, 0.0], [0.0, 10.0, 0.0], [0.0, 0.0, 10.0]])).unwrap();
    assert_moments(&mesh, PointMass { at: [3.3, 3.3, 0.0], mass: 0.2, spread: Some(5.0) }, 1e-10);
    let error = assemble(&mesh, &weightless(), &[PointMass { at: [3.3, 3.3, 0.5], mass: 0.2, spread: Some(5.0) }]);
    assert!(matches!(error, Err(AssemblyError { fault: AssemblyFault::Spread { count: 4, .. }, .. })), "{error:?}");
}

/// Conserved: mass, first and second moments of the point mass.
#[test]
fn spread_over_more_than_the_whole_body() {
    for radius in [100.0, 1e6, 1e12] {
        let point = PointMass { at: [13.0, 4.0, 7.0], mass: 5.0, spread: Some(radius) };
        assert_moments(&data_mesh("two_materials.msh"), point, 1e-10);
    }
}

/// Conserved: mass, first and second moments of the point mass.
#[test]
fn the_unit_of_length_does_not_matter() {
    let mut parts = crate::fixtures::parts(&data_mesh("two_materials.msh"));
    parts.positions.iter_mut().flatten().for_each(|c| *c *= 1e-6);
    let mesh = Mesh::new(parts).unwrap();
    let at = [3.3e-6, 4.1e-6, 2.9e-6];
    assert_moments(&mesh, PointMass { at, mass: 0.3, spread: None }, 1e-12);
    assert_moments(&mesh, PointMass { at, mass: 0.3, spread: Some(9e-6) }, 1e-10);
}

/// Conserved: one mass and its parts at one place give the same M.
#[test]
fn masses_at_one_place_add_up() {
    let mesh = data_mesh("two_materials.msh");
    let point = |mass, spread| PointMass { at: [3.3, 4.1, 2.9], mass, spread };
    let apart = assemble(&mesh, &weightless(), &[point(0.25, None), point(0.5, Some(9.0)), point(0.25, None)]).unwrap();
    let together = assemble(&mesh, &weightless(), &[point(0.5, None), point(0.5, Some(9.0))]).unwrap();
    for (a, b) in apart.mass().val().iter().zip(together.mass().val()) {
        assert!((a - b).abs() < 1e-15);
    }
}
