//! The body as it is drawn: its surface, and how it moves and is stressed in each modal coordinate.

pub(crate) mod stored;

use crate::FileError;
use crate::error::check_length;
use sealed::{Format, SealedError};
use std::path::Path;

/// The surface of a body, and its shapes there: from these and the modal coordinates of a row follow its deformation and its
/// stress. Body axes, which are those of the mesh; lengths and stresses in the units of the run.
///
/// ```text
/// ξ = (q, 0) + Σ_jk q_j q_k T_jk        u = Σ_a ξ_a ψ_a        σ = Σ_a ξ_a σ_a + Σ_jk q_j q_k σ_jk
/// ```
///
/// The q are the coordinates of the flexible modes and static shapes, as in a row. The sums over j ≤ k are those of the large
/// modes, with the shapes that only follow them; without large deflection, ξ = q.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Shapes {
    /// Number of each node in the mesh, from 0 (N).
    pub nodes: Vec<u32>,
    /// Position of each node in the undeformed body, mesh axes (N).
    pub positions: Vec<[f64; 3]>,
    /// Faces of the surface, seen from outside, by places in the list of nodes: corners, then mid-edges 01 12 20. None of a
    /// body without elements.
    pub faces: Vec<[u32; 6]>,
    /// Displacement ψ of each node in a unit of each coordinate ξ (c lists of N).
    pub displacements: Vec<Vec<[f64; 3]>>,
    /// Factors of each product of modes that bend the body, by their places among the coordinates q, from 0; one more than
    /// there are stands for a factor of 1 (p).
    pub factors: Vec<[u32; 3]>,
    /// Part that a unit of each product adds to each coordinate (p lists of c).
    pub products: Vec<Vec<f64>>,
    /// Stress, where the elements are known.
    pub stress: Option<StressShapes>,
}

/// The stress of a body in each coordinate. A node between materials is there once for each.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct StressShapes {
    /// Node of each stress, by its place in the list of nodes, ascending (s).
    pub nodes: Vec<u32>,
    /// Stress xx, yy, zz, xy, yz, zx in a unit of each coordinate ξ, and then of each product (c + p lists of s).
    pub shapes: Vec<Vec<[f64; 6]>>,
}

impl Shapes {
    /// The coordinates ξ of all shapes, from those of the flexible modes and static shapes.
    pub fn coordinates(&self, q: &[f64]) -> Vec<f64> {
        let mut xi = q.to_vec();
        xi.resize(self.displacements.len(), 0.0);
        for (product, adds) in self.products_of(q).zip(&self.products) {
            xi.iter_mut().zip(adds).for_each(|(xi, adds)| *xi += adds * product);
        }
        xi
    }

    /// The coordinates of the stress: ξ, and then the products.
    pub fn stress_coordinates(&self, q: &[f64]) -> Vec<f64> {
        let mut coordinates = self.coordinates(q);
        coordinates.extend(self.products_of(q));
        coordinates
    }

    /// Displacement of each node by deformation, body axes, in these coordinates ξ; those that are not given are zero.
    pub fn displaced(&self, xi: &[f64]) -> Vec<[f64; 3]> {
        combined(&self.displacements, xi, self.nodes.len())
    }

    /// Bytes of all numbers.
    pub fn bytes(&self) -> u64 {
        let numbers = |lists: usize, count: usize, each: usize| (lists as u64) * (count as u64) * (each as u64);
        let (n, c, p) = (self.nodes.len(), self.displacements.len(), self.factors.len());
        let stress =
            self.stress.as_ref().map_or(0, |s| 4 * s.nodes.len() as u64 + 8 * numbers(c + p, s.nodes.len(), 6));
        28 * n as u64
            + 24 * self.faces.len() as u64
            + 8 * numbers(c, n, 3)
            + 12 * p as u64
            + 8 * numbers(p, c, 1)
            + stress
    }

    /// True if its lists fit together and its numbers are finite.
    pub fn fits(&self) -> bool {
        self.check(Path::new("")).is_ok()
    }

    fn products_of<'a>(&'a self, q: &'a [f64]) -> impl Iterator<Item = f64> + 'a {
        let factor = |k: &u32| q.get(*k as usize).copied().unwrap_or(1.0);
        self.factors.iter().map(move |factors| factors.iter().map(factor).product())
    }

    /// Refuses lists that do not fit together, and numbers that are not finite.
    pub(crate) fn check(&self, path: &Path) -> Result<(), FileError> {
        let Self { nodes, positions, faces, displacements, factors, products, stress } = self;
        let (count, coordinates) = (nodes.len(), displacements.len());
        check_length(path, "model/mesh/positions", count, positions.len())?;
        check_length(path, "model/large_deflection/products", factors.len(), products.len())?;
        lists(path, "model/shapes", displacements, count)?;
        lists(path, "model/large_deflection/products", products, coordinates)?;
        below(path, "model/mesh/surface_triangles", faces.as_flattened(), count)?;
        below(path, "model/large_deflection/factors", factors.as_flattened(), coordinates + 1)?;
        let finite = |quantity: &str, values: &[f64]| match values.iter().find(|value| !value.is_finite()) {
            Some(&value) => {
                Err(FileError::ConstantNotFinite { path: path.to_path_buf(), quantity: quantity.to_owned(), value })
            }
            None => Ok(()),
        };
        finite("model/mesh/positions", positions.as_flattened())?;
        displacements.iter().try_for_each(|shape| finite("model/shapes", shape.as_flattened()))?;
        products.iter().try_for_each(|adds| finite("model/large_deflection/products", adds))?;
        if let Some(StressShapes { nodes, shapes }) = stress {
            check_length(path, "model/stress/shapes", coordinates + factors.len(), shapes.len())?;
            lists(path, "model/stress/shapes", shapes, nodes.len())?;
            below(path, "model/stress/nodes", nodes, count)?;
            shapes.iter().try_for_each(|shape| finite("model/stress/shapes", shape.as_flattened()))?;
        }
        Ok(())
    }
}

impl StressShapes {
    /// The stress at each of its places, in these coordinates ([`Shapes::stress_coordinates`]); those that are not given are
    /// zero.
    pub fn combined(&self, coordinates: &[f64]) -> Vec<[f64; 6]> {
        combined(&self.shapes, coordinates, self.nodes.len())
    }
}

/// The sum of shapes times their coordinates, at each of a number of places.
fn combined<const N: usize>(shapes: &[Vec<[f64; N]>], coordinates: &[f64], places: usize) -> Vec<[f64; N]> {
    let mut sums = vec![[0.0; N]; places];
    for (shape, coordinate) in shapes.iter().zip(coordinates) {
        for (sum, value) in sums.iter_mut().zip(shape) {
            sum.iter_mut().zip(value).for_each(|(sum, value)| *sum += value * coordinate);
        }
    }
    sums
}

/// Refuses lists of other lengths.
fn lists<T>(path: &Path, quantity: &str, lists: &[Vec<T>], expected: usize) -> Result<(), FileError> {
    lists.iter().try_for_each(|list| check_length(path, quantity, expected, list.len()))
}

/// Refuses places beyond the end of a list.
fn below(path: &Path, quantity: &'static str, places: &[u32], end: usize) -> Result<(), FileError> {
    match places.iter().find(|place| **place as usize >= end) {
        Some(place) => {
            let what = format!("{quantity} names the place {place} in a list of {end}");
            Err(SealedError::Damaged { path: path.to_path_buf(), format: Format::RESULTS, what }.into())
        }
        None => Ok(()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Two nodes, a mode that is large and a shape that follows it.
    fn shapes() -> Shapes {
        Shapes {
            nodes: vec![0, 4],
            positions: vec![[0.0; 3], [1.0, 0.0, 0.0]],
            faces: vec![[0, 1, 0, 1, 0, 1]],
            displacements: vec![vec![[0.0; 3], [0.0, 2.0, 0.0]], vec![[0.0; 3], [-1.0, 0.0, 0.0]]],
            factors: vec![[0, 0, 1]],
            products: vec![vec![0.0, 0.5]],
            stress: Some(StressShapes {
                nodes: vec![0, 0],
                shapes: vec![vec![[1.0; 6], [2.0; 6]], vec![[0.0; 6]; 2], vec![[0.5; 6], [0.25; 6]]],
            }),
        }
    }

    /// Closed form: q² times the drawing in, by hand.
    #[test]
    fn a_body_that_bends_far_is_drawn_in() {
        let shapes = shapes();
        shapes.check(Path::new("a.h5")).unwrap();
        assert_eq!(shapes.coordinates(&[3.0]), [3.0, 4.5]);
        assert_eq!(shapes.displaced(&shapes.coordinates(&[3.0])), [[0.0; 3], [-4.5, 6.0, 0.0]]);
        assert_eq!(shapes.stress_coordinates(&[2.0]), [2.0, 2.0, 4.0]);
        let stress = shapes.stress.as_ref().unwrap().combined(&shapes.stress_coordinates(&[2.0]));
        assert_eq!(stress, [[4.0; 6], [5.0; 6]]);
    }

    #[test]
    fn lists_that_do_not_fit_together_are_refused() {
        let refused = |change: fn(&mut Shapes), words: &str| {
            let mut shapes = shapes();
            change(&mut shapes);
            let error = shapes.check(Path::new("a.h5")).unwrap_err().to_string();
            assert!(error.contains(words), "{error}");
        };
        refused(|s| s.nodes.push(7), "model/mesh/positions has 2 values where 3 are expected");
        refused(|s| s.faces[0][5] = 2, "model/mesh/surface_triangles names the place 2 in a list of 2");
        refused(|s| s.factors[0][1] = 3, "model/large_deflection/factors names the place 3");
        refused(|s| s.factors.clear(), "model/large_deflection/products");
        refused(|s| s.displacements[1].truncate(1), "model/shapes has 1 values where 2 are expected");
        refused(|s| s.displacements[0][1][2] = f64::NAN, "model/shapes is NaN");
        refused(|s| s.positions[1][0] = f64::INFINITY, "model/mesh/positions is inf");
        refused(|s| s.stress.as_mut().unwrap().nodes[1] = 9, "model/stress/nodes names the place 9");
        refused(|s| s.stress.as_mut().unwrap().shapes.truncate(2), "model/stress/shapes has 2 values where 3");
    }

    #[test]
    fn its_bytes_are_those_of_its_numbers() {
        let shapes = shapes();
        let lists = shapes.stored();
        let stored: usize = lists
            .iter()
            .map(|(_, _, lists)| {
                lists.whole().map_or(0, size_of_val)
                    + lists.numbers().iter().map(|list| size_of_val(*list)).sum::<usize>()
            })
            .sum();
        assert_eq!(shapes.bytes(), stored as u64);
    }
}
