//! Integration points of the elements: gradients of the shape functions in space, and weights.

use nalgebra::{Matrix3, Vector3};
use rayon::prelude::*;

use crate::element::quadrature::{self, Point};
use crate::element::shape::{EDGES, NODES, shape_gradients};

/// A mid-edge node this close to the middle of its edge, as a fraction of the edge, makes no curved element.
const STRAIGHT: f64 = 1e-9;
/// A determinant this small against that of a regular element of the same size is taken for zero: what is left of
/// a flat element is rounding, about 1e-16 × (distance from the origin / size of the element).
const DEGENERATE: f64 = 1e-10;

/// One integration point in space.
pub(crate) struct IntegrationPoint {
    /// ∂N_a/∂x for the ten nodes, per length.
    pub gradients: [[f64; 3]; 10],
    /// Weight × determinant of the Jacobian: the volume that the point stands for.
    pub volume: f64,
}

/// A point of a rule in the reference element.
#[derive(Debug)]
pub(crate) struct RulePoint {
    pub point: Point,
    /// Gradients of the ten shape functions there.
    pub gradients: [[f64; 3]; 10],
}

/// The rules that all elements share.
#[derive(Debug)]
pub(crate) struct Rules {
    straight: Vec<RulePoint>,
    straight_cubic: Vec<RulePoint>,
    curved: Vec<RulePoint>,
}

impl Rules {
    pub(crate) fn new() -> Self {
        let with_gradients = |rule: Vec<Point>| {
            rule.into_iter().map(|point| RulePoint { point, gradients: shape_gradients(point.at) }).collect()
        };
        Self {
            straight: with_gradients(quadrature::degree_2()),
            straight_cubic: with_gradients(quadrature::degree_3()),
            curved: with_gradients(quadrature::degree_5()),
        }
    }

    /// Integration points of an element: four where it is straight (K is then exact), fourteen where it is curved.
    pub(crate) fn points(&self, positions: &[[f64; 3]; 10]) -> Vec<IntegrationPoint> {
        in_space(self.quadratic(is_straight(positions)), positions)
    }

    /// The rule for products of two gradients.
    pub(crate) fn quadratic(&self, is_straight: bool) -> &[RulePoint] {
        if is_straight { &self.straight } else { &self.curved }
    }

    /// The rule for products of three gradients: five points where the element is straight, which are exact then, fourteen
    /// where it is curved.
    pub(crate) fn cubic(&self, is_straight: bool) -> &[RulePoint] {
        if is_straight { &self.straight_cubic } else { &self.curved }
    }

    /// The rule of fourteen points whatever the element: exact to degree 5 where it is straight.
    pub(crate) fn fine(&self) -> &[RulePoint] {
        &self.curved
    }

    /// The integration points of [`fine`](Self::fine).
    pub(crate) fn fine_points(&self, positions: &[[f64; 3]; 10]) -> Vec<IntegrationPoint> {
        in_space(&self.curved, positions)
    }
}

fn in_space(rule: &[RulePoint], positions: &[[f64; 3]; 10]) -> Vec<IntegrationPoint> {
    rule.iter().map(|rule| IntegrationPoint::new(positions, &rule.gradients, rule.point.weight)).collect()
}

impl IntegrationPoint {
    /// By the gradients of the shape functions in the reference element.
    pub(crate) fn new(positions: &[[f64; 3]; 10], dn: &[[f64; 3]; 10], weight: f64) -> Self {
        let jacobian = jacobian(positions, dn);
        // ∂N/∂x = J⁻ᵀ ∂N/∂ξ; a mesh that has been checked has no singular Jacobian at these points.
        let inverse = jacobian.try_inverse().unwrap_or_else(Matrix3::zeros);
        let gradients = dn.map(|d| {
            let g = inverse.transpose() * Vector3::from(d);
            [g.x, g.y, g.z]
        });
        Self { gradients, volume: weight * jacobian.determinant() }
    }
}

/// True if all mid-edge nodes lie in the middle of their edges.
pub(crate) fn is_straight(positions: &[[f64; 3]; 10]) -> bool {
    EDGES.into_iter().enumerate().all(|(edge, [a, b])| {
        let (a, b) = (Vector3::from(positions[a]), Vector3::from(positions[b]));
        let off = Vector3::from(positions[4 + edge]) - 0.5 * (a + b);
        off.norm() <= STRAIGHT * (b - a).norm()
    })
}

/// J_ij = ∂x_i/∂ξ_j.
pub(crate) fn jacobian(positions: &[[f64; 3]; 10], dn: &[[f64; 3]; 10]) -> Matrix3<f64> {
    let mut jacobian = Matrix3::zeros();
    for (x, d) in positions.iter().zip(dn) {
        for i in 0..3 {
            for j in 0..3 {
                jacobian[(i, j)] += x[i] * d[j];
            }
        }
    }
    jacobian
}

/// An element that is inverted or has no volume somewhere.
pub(crate) struct BadJacobian {
    /// Its index.
    pub element: usize,
    /// "inverted" or "degenerate".
    pub what: &'static str,
    /// The smallest determinant.
    pub jacobian: f64,
    /// The determinant of a regular tetrahedron of its size.
    pub expected: f64,
}

/// The determinants of the Jacobian at the nodes and the integration points of an element.
struct Determinants {
    at_nodes: [[[f64; 3]; 10]; 10],
    inside: Vec<[[f64; 3]; 10]>,
}

impl Determinants {
    fn new() -> Self {
        let inside = quadrature::degree_5().iter().map(|p| shape_gradients(p.at)).collect();
        Self { at_nodes: NODES.map(shape_gradients), inside }
    }

    /// The smallest of them.
    fn least(&self, positions: &[[f64; 3]; 10]) -> f64 {
        if is_straight(positions) {
            return jacobian(positions, &self.at_nodes[0]).determinant();
        }
        self.at_nodes
            .iter()
            .chain(&self.inside)
            .map(|dn| jacobian(positions, dn).determinant())
            // NaN, from coordinates near the end of the range, is kept, where `f64::min` would drop it.
            .fold(f64::INFINITY, |least, det| if least.is_nan() || least <= det { least } else { det })
    }
}

/// The first of `count` elements that is inverted or has no volume at a node or at an integration point.
pub(crate) fn first_bad_jacobian(
    count: usize,
    positions: impl Fn(usize) -> [[f64; 3]; 10] + Sync,
) -> Option<BadJacobian> {
    let determinants = Determinants::new();
    (0..count).into_par_iter().find_map_first(|e| {
        let positions = positions(e);
        let (regular, smallest) = (regular_determinant(&positions), determinants.least(&positions));
        let good = smallest > DEGENERATE * regular;
        (!good).then_some(BadJacobian {
            element: e,
            what: if smallest < -DEGENERATE * regular { "inverted" } else { "degenerate" },
            jacobian: smallest,
            expected: regular,
        })
    })
}

/// The smallest determinant of each of `count` elements over that of the straight element with the same corners: of all,
/// the smallest.
pub(crate) fn least_scaled_jacobian(count: usize, positions: impl Fn(usize) -> [[f64; 3]; 10] + Sync) -> f64 {
    let determinants = Determinants::new();
    let of_element = |e: usize| {
        let positions = positions(e);
        let [a, b, c, d] = std::array::from_fn(|corner| Vector3::from(positions[corner]));
        determinants.least(&positions) / Matrix3::from_columns(&[b - a, c - a, d - a]).determinant()
    };
    (0..count).into_par_iter().map(of_element).reduce(|| 1.0, f64::min)
}

/// Determinant of the Jacobian of a regular tetrahedron with the longest edge of this one: h³/√2.
fn regular_determinant(positions: &[[f64; 3]; 10]) -> f64 {
    let longest = EDGES
        .into_iter()
        .map(|[a, b]| (Vector3::from(positions[a]) - Vector3::from(positions[b])).norm())
        .fold(0.0, f64::max);
    longest.powi(3) / 2.0_f64.sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Closed form: the node on the edge from corner 0 to corner 1 moves along it by δ: there J = I − 4δ e_x (1, 1,
    /// 1)ᵀ at corner 1.
    #[test]
    fn a_node_that_slides_along_its_edge_scales_the_jacobian_as_in_closed_form() {
        let straight = NODES;
        assert_eq!(least_scaled_jacobian(1, |_| straight), 1.0);
        for shift in [0.1, 0.2, 0.3] {
            let slid = |element: usize| {
                let mut positions = straight.map(|x| [3.0 * x[0], 2.0 * x[1], x[2]]);
                positions[4][0] += 3.0 * shift * element as f64;
                positions
            };
            let found = least_scaled_jacobian(2, slid);
            assert!((found - (1.0 - 4.0 * shift)).abs() < 1e-12, "{shift}: {found}");
        }
    }
}
