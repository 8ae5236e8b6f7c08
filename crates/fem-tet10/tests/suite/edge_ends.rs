//! The two corners that each node in the middle of an edge lies between.

use std::collections::HashSet;

use fem_tet10::Mesh;

use crate::fixtures::{data_mesh, workspace_mesh};

/// The nodes that are the corner of an element.
fn corners(mesh: &Mesh) -> HashSet<u32> {
    mesh.elements().iter().flat_map(|nodes| nodes[..4].to_vec()).collect()
}

#[test]
fn corners_have_themselves_and_other_nodes_two_corners_of_their_own() {
    // Straight, of two materials, and curved.
    for mesh in [workspace_mesh("plate.msh"), data_mesh("two_materials.msh"), workspace_mesh("ring.msh")] {
        let (corners, ends) = (corners(&mesh), mesh.edge_ends());
        assert_eq!(ends.len(), mesh.positions().len());
        assert!(!corners.is_empty() && corners.len() < ends.len());
        let mut edges = HashSet::new();
        for (node, [a, b]) in (0..).zip(&ends) {
            if corners.contains(&node) {
                assert_eq!([*a, *b], [node; 2]);
            } else {
                assert!(a != b && corners.contains(a) && corners.contains(b), "node {node}: {a} {b}");
                assert!(edges.insert([a.min(b), a.max(b)]), "node {node} and another are between {a} and {b}");
            }
        }
    }
}

#[test]
fn nodes_of_a_straight_mesh_lie_in_the_middle_of_their_ends() {
    for mesh in [workspace_mesh("plate.msh"), data_mesh("two_materials.msh")] {
        let x = mesh.positions();
        for (node, [a, b]) in mesh.edge_ends().into_iter().enumerate() {
            for axis in 0..3 {
                let middle = 0.5 * (x[a as usize][axis] + x[b as usize][axis]);
                let off = (x[node][axis] - middle).abs() / mesh.diagonal();
                // Measured: 2.3e-16 at worst.
                assert!(off < 1e-14, "node {node} is off the middle of {a} and {b} by {off:e} of the body");
            }
        }
    }
}

#[test]
fn nodes_without_elements_have_themselves() {
    let positions = vec![[0.0; 3], [1.0, 0.0, 0.0], [0.5, 0.0, 0.0]];
    let mesh = Mesh::of_nodes("nodes".to_owned(), vec![4, 5, 6], positions, vec![]).unwrap();
    assert_eq!(mesh.edge_ends(), [[0, 0], [1, 1], [2, 2]]);
}
