//! Faces of a surface cut into strips of equal width, each a patch.
//!
//! ```text
//! w_n = ∫ N_n dA over the part of the faces in the strip
//! ```
//!
//! Faces are cut where the strips meet. So the place of a strip does not depend on the mesh: strips of two bodies that share a
//! surface have the same places.

use std::collections::BTreeMap;

use nalgebra::{Matrix3, SymmetricEigen, Vector3};

use crate::assembly::patch::Patch;
use crate::assembly::surface::{shapes, tangent};
use crate::error::MeshError;
use crate::mesh::checked::Mesh;

/// Largest part of the square of the longest extent that the next may have for the longest to be one.
const ALIKE: f64 = 0.98;

/// A strip of a surface.
#[derive(Debug, Clone, PartialEq)]
pub struct Strip {
    /// Its part of the area of the surface.
    pub part: f64,
    /// It, as a place with axes.
    pub patch: Patch,
}

impl Mesh {
    /// The faces of a physical surface, six nodes each, each face once.
    ///
    /// # Errors
    /// [`MeshFault::NoGroup`](crate::MeshFault::NoGroup) with the names of the surfaces there are.
    pub fn surface_faces(&self, group: &str) -> Result<Vec<[u32; 6]>, MeshError> {
        Ok(self.surface(group)?.faces.iter().map(|face| face.nodes).collect())
    }

    /// The direction along which faces extend the farthest (a unit vector, axes of the mesh); `None` where there are two.
    pub fn longest(&self, faces: &[[u32; 6]]) -> Option<Vector3<f64>> {
        let (nodes, areas) = self.weights_of_faces(faces.iter().copied());
        let at = |node: &u32| Vector3::from(self.positions()[*node as usize]);
        let area: f64 = areas.iter().sum();
        let center: Vector3<f64> = nodes.iter().zip(&areas).map(|(node, w)| at(node) * (*w / area)).sum();
        let of_node = |(node, w): (&u32, &f64)| (at(node) - center) * (at(node) - center).transpose() * *w;
        let spread: Matrix3<f64> = nodes.iter().zip(&areas).map(of_node).sum();
        let SymmetricEigen { eigenvectors, eigenvalues } = SymmetricEigen::new(spread);
        let longest = eigenvalues.imax();
        let next = (0..3).filter(|k| *k != longest).map(|k| eigenvalues[k]).fold(0.0, f64::max);
        (next < ALIKE * eigenvalues[longest]).then(|| eigenvectors.column(longest).into())
    }

    /// Two directions at right angles in the plane of faces (unit vectors, axes of the mesh): the first is the nearest to an axis of the
    /// mesh. None of faces without area.
    pub fn directions(&self, faces: &[[u32; 6]]) -> Vec<Vector3<f64>> {
        let at = |node: u32| Vector3::from(self.positions()[node as usize]);
        // The sum of the areas would vanish over a closed surface.
        let normals = faces.iter().map(|face| (at(face[1]) - at(face[0])).cross(&(at(face[2]) - at(face[0]))));
        let spread: Matrix3<f64> = normals.map(|normal| normal * normal.transpose()).sum();
        let SymmetricEigen { eigenvectors, eigenvalues } = SymmetricEigen::new(spread);
        let normal: Vector3<f64> = eigenvectors.column(eigenvalues.imax()).into();
        let axis = Vector3::ith(normal.iamin(), 1.0);
        let first = (axis - normal * normal.dot(&axis)).try_normalize(f64::MIN_POSITIVE);
        first.map_or_else(Vec::new, |first| vec![first, normal.cross(&first)])
    }

    /// Faces in `count` strips of equal width side by side along a direction.
    pub fn strips(&self, faces: &[[u32; 6]], along: &Vector3<f64>, count: usize) -> Vec<Strip> {
        let place = |node: u32| Vector3::from(self.positions()[node as usize]).dot(along);
        let nodes = || faces.iter().flatten().map(|node| place(*node));
        let (low, high) = nodes().fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), s| (l.min(s), h.max(s)));
        let width = (high - low) / count as f64;
        let weights = (0..count).map(|strip| {
            let limits = [low + width * strip as f64, low + width * (strip + 1) as f64];
            let mut weights: BTreeMap<u32, f64> = BTreeMap::new();
            for face in faces {
                let corners = [face[0], face[1], face[2]].map(place);
                self.integrate_piece(face, &cut(corners, limits), &mut weights);
            }
            weights
        });
        let weights: Vec<BTreeMap<u32, f64>> = weights.collect();
        let area: f64 = weights.iter().flat_map(|strip| strip.values()).sum();
        let strip = |weights: BTreeMap<u32, f64>| {
            let own: f64 = weights.values().sum();
            let (nodes, weights) = weights.into_iter().map(|(node, w)| (node, w / own)).unzip();
            Strip { part: own / area, patch: Patch::new(nodes, weights, self.positions()) }
        };
        weights.into_iter().map(strip).collect()
    }

    /// Adds `∫ N_n dA` over a convex piece of a face, whose corners are barycentric.
    fn integrate_piece(&self, face: &[u32; 6], piece: &[[f64; 3]], weights: &mut BTreeMap<u32, f64>) {
        let Some((first, rest)) = piece.split_first() else { return };
        let position = face.map(|node| Vector3::from(self.positions()[node as usize]));
        for pair in rest.windows(2) {
            let corners = [*first, pair[0], pair[1]];
            let [a, b] = [1, 2].map(|k| [0, 1].map(|i| corners[k][i] - corners[0][i]));
            let size = (a[0] * b[1] - a[1] * b[0]).abs() / 2.0;
            // The three middles of the edges integrate what is of degree two.
            for [i, j] in [[0, 1], [1, 2], [2, 0]] {
                let (n, slopes) = shapes([0, 1, 2].map(|k| 0.5 * (corners[i][k] + corners[j][k])));
                let area = tangent(&position, &slopes, 0).cross(&tangent(&position, &slopes, 1)).norm();
                for (node, n) in face.iter().zip(n) {
                    *weights.entry(*node).or_default() += n * area * size / 3.0;
                }
            }
        }
    }
}

/// The part of a triangle (barycentric corners) where a coordinate that is linear in it lies between limits.
fn cut(corners: [f64; 3], [low, high]: [f64; 2]) -> Vec<[f64; 3]> {
    let whole = vec![[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    let at = |l: &[f64; 3]| l.iter().zip(&corners).map(|(l, s)| l * s).sum::<f64>();
    let above = keep(whole, |l| at(l) - low);
    keep(above, |l| high - at(l))
}

/// The part of a convex piece where a linear function is not negative.
fn keep(piece: Vec<[f64; 3]>, value: impl Fn(&[f64; 3]) -> f64) -> Vec<[f64; 3]> {
    let mut kept = Vec::new();
    for (i, corner) in piece.iter().enumerate() {
        let next = &piece[(i + 1) % piece.len()];
        let [here, there] = [value(corner), value(next)];
        if here >= 0.0 {
            kept.push(*corner);
        }
        if (here < 0.0) != (there < 0.0) {
            let part = here / (here - there);
            kept.push([0, 1, 2].map(|k| corner[k] + part * (next[k] - corner[k])));
        }
    }
    kept
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::read_msh;

    /// Closed form: strips of a face of a unit cube have equal areas, and their middles are where they are; all together they have
    /// the weights of the face.
    #[test]
    fn strips_are_where_they_are_whatever_the_mesh() {
        let mesh = read_msh(concat!(env!("CARGO_MANIFEST_DIR"), "/tests/data/cube.msh")).unwrap();
        let low = mesh.positions().iter().map(|x| x[0]).fold(f64::INFINITY, f64::min);
        let is_in =
            |nodes: &[u32; 6]| nodes.iter().all(|node| (mesh.positions()[*node as usize][0] - low).abs() < 1e-9);
        let faces: Vec<[u32; 6]> = mesh.outer_faces().into_iter().filter(is_in).collect();
        let [_, size, height] = mesh.size();
        let whole = mesh.outer_patch(|x| (x.x - low).abs() < 1e-9).unwrap();
        let start = whole.position - Vector3::new(0.0, 0.5 * size, 0.5 * height);
        let strips = mesh.strips(&faces, &Vector3::y(), 3);
        let mut sums = BTreeMap::new();
        for (k, Strip { part, patch }) in strips.iter().enumerate() {
            assert!((part - 1.0 / 3.0).abs() < 1e-12, "{part}");
            let expected = start + Vector3::new(0.0, size * (k as f64 + 0.5) / 3.0, 0.5 * height);
            assert!((patch.position - expected).norm() < 1e-12, "{} {expected}", patch.position);
            patch.nodes.iter().zip(&patch.weights).for_each(|(n, w)| *sums.entry(*n).or_insert(0.0) += w * part);
        }
        for (node, weight) in whole.nodes.iter().zip(&whole.weights) {
            assert!((sums[node] - weight).abs() < 1e-12);
        }
        assert_eq!(mesh.longest(&faces), None, "a square has no longest direction");
    }
}
