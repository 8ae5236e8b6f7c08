//! The surface of a mesh and its sharp edges.

use nalgebra::Vector3;
use std::collections::HashMap;

/// The faces of a tetrahedron by its nodes in gmsh's order (corners 0 to 3, then the middles of the
/// edges 01, 12, 02, 03, 23, 13): three corners, counter-clockwise seen from outside, and the middles
/// between the first and second, second and third, third and first.
const FACES: [[usize; 6]; 4] = [[0, 2, 1, 6, 5, 4], [0, 1, 3, 4, 9, 7], [1, 2, 3, 5, 8, 9], [0, 3, 2, 7, 8, 6]];

/// The surface of a mesh of ten-node tetrahedra as triangles, oriented outwards.
///
/// Faces that belong to one element only are split into four triangles each with the nodes in the
/// middle of their edges. Elements are in gmsh's node order with a positive Jacobian.
pub fn boundary_triangles(tetrahedra: &[[u32; 10]]) -> Vec<[u32; 3]> {
    let faces = || tetrahedra.iter().flat_map(|nodes| FACES.map(|face| face.map(|i| nodes[i])));
    let corners = |face: &[u32; 6]| {
        let mut corners = [face[0], face[1], face[2]];
        corners.sort_unstable();
        corners
    };
    let mut elements_of_face = HashMap::new();
    for face in faces() {
        *elements_of_face.entry(corners(&face)).or_insert(0_u32) += 1;
    }
    faces()
        .filter(|face| elements_of_face[&corners(face)] == 1)
        .flat_map(|[a, b, c, ab, bc, ca]| [[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]])
        .collect()
}

/// The edges at which the surface turns by more than 30°, and those of one triangle only: what a
/// draughtsman would draw of the body. Pairs of points, the smaller index first.
///
/// Triangles that name points beyond `points` are left out.
pub fn sharp_edges(points: &[[f64; 3]], triangles: &[[u32; 3]]) -> Vec<[u32; 2]> {
    let least_cosine = 30_f64.to_radians().cos();
    let mut edges: HashMap<[u32; 2], Vec<Vector3<f64>>> = HashMap::new();
    for &triangle in triangles {
        let corner = |i: usize| points.get(triangle[i] as usize).copied().map(Vector3::from);
        let (Some(a), Some(b), Some(c)) = (corner(0), corner(1), corner(2)) else { continue };
        let normal = (b - a).cross(&(c - a)).normalize();
        for (i, j) in [(0, 1), (1, 2), (2, 0)] {
            let (i, j) = (triangle[i], triangle[j]);
            edges.entry([i.min(j), i.max(j)]).or_default().push(normal);
        }
    }
    let is_sharp = |normals: &[Vector3<f64>]| match normals {
        [one, two] => one.dot(two) < least_cosine,
        _ => true,
    };
    let mut sharp: Vec<_> = edges.into_iter().filter(|(_, normals)| is_sharp(normals)).map(|edge| edge.0).collect();
    sharp.sort_unstable();
    sharp
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::test_body::Block;

    fn corners(block: &Block, triangle: &[u32; 3]) -> [Vector3<f64>; 3] {
        triangle.map(|i| block.points[i as usize].into())
    }

    #[test]
    fn the_surface_of_a_block_is_closed_and_encloses_its_volume() {
        let block = Block::new([10.0, 4.0, 3.0], [5, 2, 3]);
        let triangles = boundary_triangles(&block.tetrahedra);
        // Two triangles per square of the faces, each split into four.
        assert_eq!(triangles.len(), 2 * 4 * 2 * (5 * 2 + 2 * 3 + 5 * 3));
        let (mut area, mut vector_area, mut volume) = (0.0, Vector3::zeros(), 0.0);
        for triangle in &triangles {
            let [a, b, c] = corners(&block, triangle);
            let normal = 0.5 * (b - a).cross(&(c - a));
            area += normal.norm();
            vector_area += normal;
            volume += normal.dot(&(a + b + c)) / 9.0;
        }
        assert!((area - 2.0 * (40.0 + 12.0 + 30.0)).abs() < 1e-10, "{area}");
        assert!(vector_area.norm() < 1e-12, "{vector_area}");
        // Gauss: a positive volume means that every face looks outwards.
        assert!((volume - 120.0).abs() < 1e-10, "{volume}");
    }

    #[test]
    fn an_element_alone_has_sixteen_triangles_through_all_its_nodes() {
        let triangles = boundary_triangles(&[[0, 1, 2, 3, 4, 5, 6, 7, 8, 9]]);
        let mut nodes: Vec<_> = triangles.iter().flatten().copied().collect();
        nodes.sort_unstable();
        nodes.dedup();
        assert_eq!((triangles.len(), nodes.len()), (16, 10));
        assert!(boundary_triangles(&[]).is_empty());
    }

    #[test]
    fn the_sharp_edges_of_a_block_are_its_twelve() {
        let block = Block::new([10.0, 4.0, 3.0], [5, 2, 3]);
        let edges = sharp_edges(&block.points, &boundary_triangles(&block.tetrahedra));
        let length: f64 = edges
            .iter()
            .map(|edge| {
                let [a, b] = edge.map(|i| Vector3::from(block.points[i as usize]));
                (a - b).norm()
            })
            .sum();
        assert_eq!(edges.len(), 4 * 2 * (5 + 2 + 3));
        assert!((length - 4.0 * (10.0 + 4.0 + 3.0)).abs() < 1e-10, "{length}");
    }
}
