//! The surface of a body of second-order faces: its facets and its sharp edges.
//!
//! A face has six nodes: three corners, counter-clockwise seen from outside, and the middles between the first and second,
//! second and third, third and first.

use std::collections::HashMap;

use nalgebra::Vector3;

/// The faces as triangles, four for each, with the nodes in the middle of the edges.
pub fn facets(faces: &[[u32; 6]]) -> Vec<[u32; 3]> {
    faces.iter().flat_map(|&[a, b, c, ab, bc, ca]| [[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]]).collect()
}

/// The edges at which the surface turns by more than 30°, and those of one face only: what a draughtsman would draw of the
/// body. Pairs of points, the smaller index first, two for each edge.
///
/// The angle is that between the curved faces in the middle of their edge, so that a coarse mesh of a round body shows no
/// edges that the body has not got. Faces that name points beyond `points` are left out.
pub fn sharp_edges(points: &[[f64; 3]], faces: &[[u32; 6]]) -> Vec<[u32; 2]> {
    let least_cosine = 30_f64.to_radians().cos();
    // By its corners: its middle, and the normals of its faces there.
    let mut edges: HashMap<[u32; 2], (u32, Vec<Vector3<f64>>)> = HashMap::new();
    for &[a, b, c, ab, bc, ca] in faces {
        for turned in [[a, b, c, ab, bc, ca], [b, c, a, bc, ca, ab], [c, a, b, ca, ab, bc]] {
            let [start, end, _, middle, ..] = turned;
            let Some(normal) = normal_at_first_edge(points, turned) else { continue };
            let edge = edges.entry([start.min(end), start.max(end)]).or_insert((middle, Vec::new()));
            edge.1.push(normal);
        }
    }
    let is_sharp = |normals: &[Vector3<f64>]| match normals {
        [one, two] => one.dot(two) < least_cosine,
        _ => true,
    };
    let halves = |([start, end], (middle, _)): ([u32; 2], (u32, _))| {
        [start, end].map(|corner| [corner.min(middle), corner.max(middle)])
    };
    let mut sharp: Vec<_> = edges.into_iter().filter(|(_, (_, normals))| is_sharp(normals)).flat_map(halves).collect();
    sharp.sort_unstable();
    sharp
}

/// Outward unit normal of a curved face in the middle of the edge between its first two corners.
fn normal_at_first_edge(points: &[[f64; 3]], face: [u32; 6]) -> Option<Vector3<f64>> {
    let mut places = [Vector3::zeros(); 6];
    for (place, node) in places.iter_mut().zip(face) {
        *place = Vector3::from(*points.get(node as usize)?);
    }
    let [a, b, c, ab, bc, ca] = places;
    // Derivatives of the shape functions there: along the edge, and away from it.
    let inwards = 2.0 * (bc + ca - ab) - 0.5 * (a + b) - c;
    Some((b - a).cross(&inwards).normalize())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::body::test_body::Block;

    fn corners(block: &Block, triangle: &[u32; 3]) -> [Vector3<f64>; 3] {
        triangle.map(|i| block.points[i as usize].into())
    }

    /// Closed form: area and volume of the block.
    #[test]
    fn the_surface_of_a_block_is_closed_and_encloses_its_volume() {
        let block = Block::new([10.0, 4.0, 3.0], [5, 2, 3]);
        let triangles = facets(&block.outer_faces());
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

    /// Closed form: twelve edges.
    #[test]
    fn the_sharp_edges_of_a_block_are_its_twelve() {
        let block = Block::new([10.0, 4.0, 3.0], [5, 2, 3]);
        let edges = sharp_edges(&block.points, &block.outer_faces());
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

    /// The wall of a tube with a number of faces around and two along, with its two open ends.
    fn tube(around: usize, is_curved: bool) -> (Vec<[f64; 3]>, Vec<[u32; 6]>) {
        let (rings, seats) = (5, 2 * around);
        let step = std::f64::consts::TAU / seats as f64;
        let place = |ring: usize, seat: usize| {
            let (sin, cos) = (step * seat as f64).sin_cos();
            let inwards = if is_curved || seat.is_multiple_of(2) { 1.0 } else { step.cos() };
            [inwards * cos, inwards * sin, ring as f64]
        };
        let points = (0..rings).flat_map(|ring| (0..seats).map(move |seat| place(ring, seat))).collect();
        let node = |ring: usize, seat: usize| (ring * seats + seat % seats) as u32;
        let mut faces = Vec::new();
        for (ring, seat) in [0, 2].into_iter().flat_map(|ring| (0..around).map(move |face| (ring, 2 * face))) {
            let at = |up: usize, on: usize| node(ring + up, seat + on);
            faces.push([at(0, 0), at(0, 2), at(2, 2), at(0, 1), at(1, 2), at(1, 1)]);
            faces.push([at(0, 0), at(2, 2), at(2, 0), at(1, 1), at(2, 1), at(1, 0)]);
        }
        (points, faces)
    }

    #[test]
    fn a_coarse_tube_has_no_edges_but_its_rims() {
        for around in [4, 5, 6, 8, 12] {
            let (points, faces) = tube(around, true);
            let edges = sharp_edges(&points, &faces);
            assert_eq!(edges.len(), 2 * 2 * around, "{around} faces around: {edges:?}");
            let is_of_a_rim = |edge: &[u32; 2]| edge.iter().all(|i| [0.0, 4.0].contains(&points[*i as usize][2]));
            assert!(edges.iter().all(is_of_a_rim), "{edges:?}");
        }
        // With straight edges it is a prism, and looks like one.
        let (points, faces) = tube(6, false);
        assert_eq!(sharp_edges(&points, &faces).len(), 2 * (2 * 6 + 2 * 6));
    }
}
