//! A pressure that follows its surface, on any displacements.

use fem_tet10::quadrature;
use nalgebra::Vector3;

use crate::nonlinear::solid::Solid;

/// Corners of the faces of an element, and its mid-edge nodes, seen from outside.
const FACES: [[usize; 6]; 4] = [[0, 2, 1, 6, 5, 4], [0, 1, 3, 4, 9, 7], [1, 2, 3, 5, 8, 9], [0, 3, 2, 7, 8, 6]];

impl Solid {
    /// The faces of elements whose six nodes lie where `is_on` says, each with its nodes.
    pub fn faces(&self, is_on: impl Fn(Vector3<f64>) -> bool) -> Vec<[u32; 6]> {
        let all = self.mesh().elements().iter().flat_map(|nodes| FACES.map(|face| face.map(|i| nodes[i])));
        let sorted = |face: &[u32; 6]| {
            let mut face = *face;
            face.sort_unstable();
            face
        };
        let mut seen = std::collections::HashMap::new();
        all.clone().for_each(|face| *seen.entry(sorted(&face)).or_insert(0) += 1);
        let on = |node: u32| is_on(Vector3::from(self.mesh().positions()[node as usize]));
        all.filter(|face| seen[&sorted(face)] == 1 && face.iter().all(|node| on(*node))).collect()
    }

    /// The forces `−∫ N n dA` of a unit pressure on faces, displaced by `u`.
    pub fn pressure(&self, faces: &[[u32; 6]], u: &[f64]) -> Vec<f64> {
        let mut forces = vec![0.0; u.len()];
        let rule = quadrature::triangle_degree_6();
        for face in faces {
            let at = face.map(|node| {
                let i = node as usize;
                Vector3::from(self.mesh().positions()[i]) + Vector3::from_column_slice(&u[3 * i..3 * i + 3])
            });
            for ([a, b, c], weight) in &rule {
                let shapes = [
                    a * (2.0 * a - 1.0),
                    b * (2.0 * b - 1.0),
                    c * (2.0 * c - 1.0),
                    4.0 * a * b,
                    4.0 * b * c,
                    4.0 * c * a,
                ];
                // c = 1 − a − b.
                let by_a = [4.0 * a - 1.0, 0.0, 1.0 - 4.0 * c, 4.0 * b, -4.0 * b, 4.0 * (c - a)];
                let by_b = [0.0, 4.0 * b - 1.0, 1.0 - 4.0 * c, 4.0 * a, 4.0 * (c - b), -4.0 * a];
                let along = |slopes: &[f64; 6]| at.iter().zip(slopes).map(|(x, s)| x * *s).sum::<Vector3<f64>>();
                // The triangle has half of its Jacobian's area, and the weights sum to a half.
                let normal = along(&by_a).cross(&along(&by_b)) * *weight;
                for (node, shape) in face.iter().zip(shapes) {
                    for axis in 0..3 {
                        forces[3 * *node as usize + axis] -= shape * normal[axis];
                    }
                }
            }
        }
        forces
    }
}
