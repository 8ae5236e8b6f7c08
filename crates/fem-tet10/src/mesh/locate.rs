//! From a point in space to the nodes of the body that carry it.

use nalgebra::{Matrix3, Vector3};

use crate::element::integration::jacobian;
use crate::element::shape::{EDGES, barycentric, shape_functions, shape_gradients};
use crate::error::{AssemblyError, AssemblyFault};
use crate::mesh::checked::Mesh;

/// Within this fraction of the mesh's diagonal, a point is at a node.
const AT_NODE: f64 = 1e-7;
/// Newton's method has converged once its step, in reference coordinates, is below this.
const CONVERGED: f64 = 1e-9;
/// How far outside of an element, in its barycentric coordinates, a point is still inside but for rounding.
const ROUNDING: f64 = 1e-6;
/// How far outside of a straight element, in its barycentric coordinates, a point may be that lies in none.
const OUTSIDE: f64 = 1e-3;
/// The same for a curved element, as a fraction of its bulge, if that is more: a quadratic face misses the surface that
/// its nodes are on by far less than it bulges (at eight elements round a cylinder by 0.07 of it at most).
const OUTSIDE_OF_BULGE: f64 = 0.1;

/// A point of the body: `u(point) = Σ weights_i u(nodes_i)`.
#[derive(Debug, Clone, PartialEq)]
pub struct Location {
    /// Node indices.
    pub nodes: Vec<u32>,
    /// Their weights; they sum to one.
    pub weights: Vec<f64>,
}

impl Location {
    /// The value at the point of a field that is known on the nodes.
    pub fn mean(&self, at: impl Fn(u32) -> Vector3<f64>) -> Vector3<f64> {
        self.nodes.iter().zip(&self.weights).map(|(node, weight)| at(*node) * *weight).sum()
    }
}

impl Mesh {
    /// The node at `point`, or the ten nodes of the element that contains it with their shape functions.
    ///
    /// Quadratic elements follow a curved surface only so far, and points on the true surface may lie just outside
    /// of them. So a point in no element is given to the one that it is least outside of, by up to a thousandth of
    /// the element's height (1e-3 in its barycentric coordinates), or a tenth of what the element's edges bulge if that
    /// is more. Its shape functions are then extrapolated: the weights still sum to one and reproduce linear fields
    /// exactly at `point`.
    ///
    /// # Errors
    /// [`AssemblyFault::OffBody`] with the nearest node and its distance, for a point farther outside.
    pub fn locate(&self, point: [f64; 3]) -> Result<Location, AssemblyError> {
        let (nearest, distance) = self.nearest_node(point);
        if distance <= AT_NODE * self.diagonal() {
            return Ok(Location { nodes: vec![nearest], weights: vec![1.0] });
        }
        // The element found so far whose smallest barycentric coordinate at the point is largest.
        let mut smallest = f64::NEG_INFINITY;
        let mut found = None;
        for e in 0..self.elements().len() {
            let Some(at) = reference_coordinates(&self.element_positions(e), point) else { continue };
            let here = barycentric(at).into_iter().fold(f64::INFINITY, f64::min);
            if here > smallest {
                (smallest, found) = (here, Some((e, at)));
            }
            if smallest >= -ROUNDING {
                break;
            }
        }
        match found {
            Some((e, at)) if smallest >= -OUTSIDE.max(OUTSIDE_OF_BULGE * bulge(&self.element_positions(e))) => {
                Ok(Location { nodes: self.elements()[e].to_vec(), weights: shape_functions(at).to_vec() })
            }
            _ => Err(AssemblyFault::OffBody {
                at: point,
                node: self.node_tags()[nearest as usize],
                position: self.positions()[nearest as usize],
                distance,
            }
            .of(self.source())),
        }
    }
}

/// How far mid-edge nodes are off the middles of their edges at most, in the barycentric coordinates of the corners.
fn bulge(positions: &[[f64; 3]; 10]) -> f64 {
    let corners: [Vector3<f64>; 4] = std::array::from_fn(|a| positions[a].into());
    let edges = Matrix3::from_columns(&[corners[1] - corners[0], corners[2] - corners[0], corners[3] - corners[0]]);
    // The corners of a very curved element may be in a plane; it then has no such coordinates, and no bulge.
    let Some(inverse) = edges.try_inverse() else { return 0.0 };
    let offsets = EDGES.into_iter().zip(&positions[4..]).map(|([a, b], x)| {
        let off = inverse * (Vector3::from(*x) - 0.5 * (corners[a] + corners[b]));
        off.amax().max(off.sum().abs())
    });
    // Nor is anything but nearly flat corners behind one beyond their whole height.
    offsets.fold(0.0, f64::max).min(1.0)
}

/// The (ξ, η, ζ) at which an element's map reaches `point`, by Newton's method; `None` where the point is far from it.
fn reference_coordinates(positions: &[[f64; 3]; 10], point: [f64; 3]) -> Option<[f64; 3]> {
    for axis in 0..3 {
        let (low, high) =
            positions.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), x| (l.min(x[axis]), h.max(x[axis])));
        // A curved element bulges beyond its nodes' box by half of it at most.
        let margin = 0.5 * (high - low);
        if point[axis] < low - margin || point[axis] > high + margin {
            return None;
        }
    }
    let mut at = Vector3::repeat(0.25);
    let mut last_step = f64::INFINITY;
    for _ in 0..20 {
        let n = shape_functions(at.into());
        let mapped: Vector3<f64> = positions.iter().zip(n).map(|(x, n)| Vector3::from(*x) * n).sum();
        let jacobian = jacobian(positions, &shape_gradients(at.into()));
        let step = jacobian.lu().solve(&(Vector3::from(point) - mapped))?;
        at += step;
        last_step = step.amax();
        // Rounding may keep the steps of an element far from the origin above this; then all twenty are made.
        if last_step < 1e-13 {
            break;
        }
    }
    (last_step < CONVERGED && at.iter().all(|c| c.is_finite())).then(|| at.into())
}
