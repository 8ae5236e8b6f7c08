//! A block of ten-node tetrahedra for the tests.

use std::array::from_fn;
use std::collections::HashMap;

/// A block with edges along the axes and its middle at the origin.
pub(crate) struct Block {
    pub(crate) points: Vec<[f64; 3]>,
    /// In gmsh's node order.
    pub(crate) tetrahedra: Vec<[u32; 10]>,
}

impl Block {
    /// `cells` boxes along each axis, each cut into six tetrahedra along one diagonal.
    pub(crate) fn new(size: [f64; 3], cells: [usize; 3]) -> Self {
        // Corners lie at even places of a lattice, the middles of edges at the others.
        let places: [usize; 3] = from_fn(|axis| 2 * cells[axis] + 1);
        let mut points = Vec::new();
        for k in 0..places[2] {
            for j in 0..places[1] {
                for i in 0..places[0] {
                    let place = [i, j, k];
                    points.push(from_fn(|axis| size[axis] * (place[axis] as f64 / (places[axis] - 1) as f64 - 0.5)));
                }
            }
        }
        let node = |p: [usize; 3]| (p[0] + places[0] * (p[1] + places[1] * p[2])) as u32;
        let mut tetrahedra = Vec::new();
        for cell in 0..cells.iter().product() {
            let origin = [cell % cells[0], cell / cells[0] % cells[1], cell / cells[0] / cells[1]].map(|i| 2 * i);
            for axes in [[0, 1, 2], [1, 2, 0], [2, 0, 1], [1, 0, 2], [0, 2, 1], [2, 1, 0]] {
                let mut corners = [origin; 4];
                for (step, axis) in axes.into_iter().enumerate() {
                    for corner in &mut corners[step + 1..] {
                        corner[axis] += 2;
                    }
                }
                if (axes[1] + 3 - axes[0]) % 3 != 1 {
                    corners.swap(2, 3); // an odd order of the axes turns the element inside out
                }
                let middle = |a: usize, b: usize| from_fn(|axis| (corners[a][axis] + corners[b][axis]) / 2);
                let [c0, c1, c2, c3] = corners;
                let middles = [(0, 1), (1, 2), (0, 2), (0, 3), (2, 3), (1, 3)].map(|(a, b)| middle(a, b));
                let [m0, m1, m2, m3, m4, m5] = middles;
                tetrahedra.push([c0, c1, c2, c3, m0, m1, m2, m3, m4, m5].map(node));
            }
        }
        Self { points, tetrahedra }
    }

    /// The faces that one element alone has, seen from outside: corners, then the middles of their edges.
    pub(crate) fn outer_faces(&self) -> Vec<[u32; 6]> {
        let of_element = [[0, 2, 1, 6, 5, 4], [0, 1, 3, 4, 9, 7], [1, 2, 3, 5, 8, 9], [0, 3, 2, 7, 8, 6]];
        let faces = || self.tetrahedra.iter().flat_map(|nodes| of_element.map(|face| face.map(|i| nodes[i])));
        let corners = |face: &[u32; 6]| {
            let mut corners = [face[0], face[1], face[2]];
            corners.sort_unstable();
            corners
        };
        let mut elements_of_face = HashMap::new();
        for face in faces() {
            *elements_of_face.entry(corners(&face)).or_insert(0_u32) += 1;
        }
        faces().filter(|face| elements_of_face[&corners(face)] == 1).collect()
    }
}
