//! The mean rotation of a patch, and the forces of a moment.

use fem_tet10::{AssemblyError, AssemblyFault, MeanRotation, Mesh};
use nalgebra::Vector3;

use crate::fixtures::{Random, data_mesh, workspace_mesh};

fn position(mesh: &Mesh, node: u32) -> Vector3<f64> {
    mesh.positions()[node as usize].into()
}

fn rotation(patch: &MeanRotation, mut displacement: impl FnMut(u32) -> Vector3<f64>) -> Vector3<f64> {
    patch.nodes.iter().zip(&patch.rotation_per_displacement).map(|(node, r)| r * displacement(*node)).sum()
}

/// Patches all around a point, on one face only, and in a plane (the end of the plate).
fn patches() -> Vec<(Mesh, MeanRotation)> {
    let cases = [
        ("ring.msh", [0.0, 90.0, 10.0], 15.0),
        ("plate.msh", [0.0, 0.0, 10.0], 8.0),
        ("plate.msh", [-506.0, 0.0, 5.0], 8.0),
    ];
    cases
        .map(|(name, at, radius)| {
            let mesh = workspace_mesh(name);
            let patch = mesh.mean_rotation(at, Some(radius)).unwrap();
            assert_eq!(patch.nodes, mesh.nodes_within(at, radius));
            (mesh, patch)
        })
        .into()
}

/// Closed form: the rotation of a rigid motion.
#[test]
fn a_rigid_motion_has_its_rotation() {
    let (turn, shift) = (Vector3::new(0.3, -0.7, 1.1), Vector3::new(5.0, -3.0, 2.0));
    let mut worst = 0.0_f64;
    for (mesh, patch) in patches() {
        let found = rotation(&patch, |node| shift + turn.cross(&position(&mesh, node)));
        worst = worst.max((found - turn).norm());
    }
    // Measured: 1.1e-15.
    assert!(worst < 1e-12, "{worst:e}");
}

/// Conserved: resultant 0, and the moment.
#[test]
fn a_moment_becomes_forces_without_resultant_and_with_its_moment() {
    let (mut worst_force, mut worst_moment) = (0.0_f64, 0.0_f64);
    for (mesh, patch) in patches() {
        for moment in [Vector3::x(), Vector3::y(), Vector3::z()] {
            let forces = || patch.rotation_per_displacement.iter().map(|r| r.tr_mul(&moment));
            let sum: f64 = forces().map(|f| f.norm()).sum();
            worst_force = worst_force.max(forces().sum::<Vector3<f64>>().norm() / sum);
            let found: Vector3<f64> =
                patch.nodes.iter().zip(forces()).map(|(n, f)| position(&mesh, *n).cross(&f)).sum();
            worst_moment = worst_moment.max((found - moment).norm());
        }
    }
    // Measured: 6.8e-17 and 1.8e-15.
    assert!(worst_force < 1e-13 && worst_moment < 1e-12, "{worst_force:e} {worst_moment:e}");
}

/// Conserved: the sum of squares rises on either side.
#[test]
fn no_other_rotation_fits_better() {
    let mut random = Random(3);
    for (mesh, patch) in patches() {
        let displacements: Vec<Vector3<f64>> =
            patch.nodes.iter().map(|_| Vector3::from([0; 3].map(|_| random.unit() - 0.5))).collect();
        let count = displacements.len() as f64;
        let mean_of = |values: &[Vector3<f64>]| values.iter().sum::<Vector3<f64>>() / count;
        let positions: Vec<_> = patch.nodes.iter().map(|node| position(&mesh, *node)).collect();
        let (middle, shift) = (mean_of(&positions), mean_of(&displacements));
        // What is left of the displacements after the motion that turns by `turn` and fits best.
        let left = |turn: Vector3<f64>| -> f64 {
            positions
                .iter()
                .zip(&displacements)
                .map(|(x, u)| (u - shift - turn.cross(&(x - middle))).norm_squared())
                .sum()
        };
        let mut next = displacements.iter();
        let best = rotation(&patch, |_| *next.next().unwrap());
        for axis in [Vector3::x(), Vector3::y(), Vector3::z()] {
            for step in [1e-3, -1e-3] {
                assert!(left(best + axis * step) > left(best));
            }
        }
    }
}

#[test]
fn patches_without_a_rotation_are_refused() {
    let cube = data_mesh("cube.msh");
    // One node, none, and the three of an edge.
    for (at, radius, count) in [([0.0; 3], 1.0, 1), ([50.0, 0.0, 0.0], 1.0, 0), ([5.0, -9.0, -9.0], 13.7, 3)] {
        let error = cube.mean_rotation(at, Some(radius)).unwrap_err();
        let AssemblyError { fault: AssemblyFault::Patch { count: found, .. }, .. } = error else { panic!("{error:?}") };
        assert_eq!(found, count, "{:?}", cube.nodes_within(at, radius));
        assert!(error.to_string().contains("use a larger radius"), "{error}");
    }
    for radius in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        let error = cube.mean_rotation([0.0; 3], Some(radius)).unwrap_err();
        assert!(matches!(error, AssemblyError { fault: AssemblyFault::PatchRadius { .. }, .. }), "{error:?}");
    }
    assert!(cube.mean_rotation([f64::NAN; 3], Some(1.0)).is_err());
}
