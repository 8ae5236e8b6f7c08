//! The two corners that each node in the middle of an edge lies between.

use std::collections::HashSet;

use fem_tet10::{Mesh, MeshParts};

use crate::fixtures::{data_mesh, workspace_mesh};

/// The nodes that are the corner of an element.
fn corners(mesh: &Mesh) -> HashSet<u32> {
    mesh.elements().iter().flat_map(|nodes| nodes[..4].to_vec()).collect()
}

#[test]
fn corners_have_themselves_and_other_nodes_two_corners_of_their_own() {
    // Straight, of two materials, and curved.
    for mesh in [workspace_mesh("plate.msh"), data_mesh("two_materials.msh"), workspace_mesh("ring.msh")] {
        let (corners, ends) = (corners(&mesh), mesh.edge_ends().unwrap());
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

/// Closed form: the middle of two corners.
#[test]
fn nodes_of_a_straight_mesh_lie_in_the_middle_of_their_ends() {
    for mesh in [workspace_mesh("plate.msh"), data_mesh("two_materials.msh")] {
        let x = mesh.positions();
        for (node, [a, b]) in mesh.edge_ends().unwrap().into_iter().enumerate() {
            let [here, a_at, b_at] = [node, a as usize, b as usize].map(|node| x[node]);
            for ((here, a_at), b_at) in here.iter().zip(a_at).zip(b_at) {
                let off = (here - 0.5 * (a_at + b_at)).abs() / mesh.diagonal();
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
    assert_eq!(mesh.edge_ends().unwrap(), [[0, 0], [1, 1], [2, 2]]);
}

#[test]
fn a_corner_in_the_middle_of_an_edge_of_another_element_is_told() {
    // Corners of two elements, and the nodes in the middle of their edges. The second one begins at a corner of the first, or in
    // the middle of an edge of it.
    let mesh = |first: u64| {
        let first_at = [[0.0; 3], [1.0, 0.0, 0.0]][usize::from(first > 0)];
        let corners = [[0.0; 3], [2.0, 0.0, 0.0], [0.0, 2.0, 0.0], [0.0, 0.0, 2.0]];
        let below = [first_at, [2.0, -2.0, 0.0], [0.0, -2.0, 0.0], [0.0, -2.0, -2.0]];
        let (mut positions, mut elements) = (Vec::new(), Vec::new());
        for (corners, shared) in [(corners, None), (below, Some(first))] {
            let own = shared.iter().count();
            let mut nodes: [u64; 10] = std::array::from_fn(|k| (positions.len() + k).wrapping_sub(own) as u64);
            positions.extend(&corners[own..]);
            for [a, b] in [[0, 1], [1, 2], [0, 2], [0, 3], [2, 3], [1, 3]] {
                let ends: [[f64; 3]; 2] = [corners[a], corners[b]];
                positions.push(std::array::from_fn(|axis| 0.5 * (ends[0][axis] + ends[1][axis])));
            }
            nodes[0] = shared.unwrap_or(nodes[0]);
            elements.push(nodes);
        }
        Mesh::new(MeshParts {
            source: "made by a test".to_owned(),
            node_tags: (0..positions.len() as u64).collect(),
            positions,
            element_tags: vec![1, 2],
            regions: vec![vec![]],
            element_regions: vec![0; 2],
            elements,
            ..MeshParts::default()
        })
        .unwrap()
    };
    assert!(mesh(0).edge_ends().is_some());
    assert!(mesh(4).edge_ends().is_none());
}
