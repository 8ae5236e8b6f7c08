//! The solid that a rigid body without a mesh is drawn as: the box of its mass and inertia, smaller where it would reach far beyond
//! all points and markers, and a bar from its centre of mass to each of these outside of the box.

use std::collections::HashMap;

use model::Model;
use nalgebra::{Matrix3, Vector3};
use results::Shapes;

/// Largest edge of a box over the distance of the farthest point or marker: a rod reaches to both its ends.
const MAX_LENGTH: f64 = 2.0;
/// Least width of a box over the size of the picture: a plate or a rod without thickness is seen.
const LEAST_WIDTH: f64 = 0.03;
/// Width of a bar over the size of the picture.
const BAR_WIDTH: f64 = 0.02;
/// A place so near to the box, over the size of the picture, needs no bar.
const NEAR: f64 = 0.01;

/// The triangles of a brick, seen from outside. Bits 0, 1, 2 of a corner's number are its sides along the three axes.
const BRICK: [[usize; 3]; 12] = [
    [0, 2, 1],
    [1, 2, 3],
    [4, 5, 6],
    [5, 7, 6],
    [0, 1, 4],
    [1, 5, 4],
    [2, 6, 3],
    [3, 6, 7],
    [0, 4, 2],
    [2, 4, 6],
    [1, 3, 5],
    [3, 7, 5],
];

/// The surface of the solid, in mesh axes. It has no shapes to deform in.
pub(super) fn solid(model: &Model) -> Shapes {
    let body = &model.body;
    let center = body.center_of_mass;
    let (axes, edges) = box_of_inertia(body.mass, &body.inertia_about_center());
    let points = model.points.iter().map(|(_, point)| point.position_body());
    let markers = model.markers.iter().map(|marker| marker.point.position_body());
    let arms: Vec<Vector3<f64>> = points.chain(markers).map(|at| at + body.origin - center).collect();
    let farthest = arms.iter().map(Vector3::norm).fold(0.0, f64::max);
    // A mass that is far from the places of a mechanism would hide it.
    let longest = if farthest > 0.0 { edges.max().min(MAX_LENGTH * farthest) } else { edges.max() };
    let size = longest.max(farthest);
    let half = (edges * (longest / edges.max())).map(|edge| 0.5 * edge.max(LEAST_WIDTH * size));

    let mut drawn = SurfaceSoFar::default();
    drawn.brick(&center, &(axes * Matrix3::from_diagonal(&half)));
    for arm in &arms {
        let within = axes.transpose() * arm;
        if (0..3).any(|i| within[i].abs() > half[i] + NEAR * size) {
            drawn.bar(&center, arm, 0.5 * BAR_WIDTH * size);
        }
    }
    Shapes {
        nodes: (0..drawn.positions.len() as u32).collect(),
        positions: drawn.positions,
        faces: drawn.faces,
        ..Shapes::default()
    }
}

/// Principal axes, as columns of a rotation, and edges of the uniform box with a mass and an inertia about its centre:
/// J₁ = m (b² + c²) / 12 and so on.
fn box_of_inertia(mass: f64, inertia: &Matrix3<f64>) -> (Matrix3<f64>, Vector3<f64>) {
    let principal = inertia.symmetric_eigen();
    let mut axes = principal.eigenvectors;
    if axes.determinant() < 0.0 {
        axes.set_column(2, &-axes.column(2));
    }
    let sum = principal.eigenvalues.sum();
    let edge = |moment: f64| (6.0 * (sum - 2.0 * moment) / mass).max(0.0).sqrt();
    (axes, principal.eigenvalues.map(edge))
}

/// The surface so far.
#[derive(Default)]
struct SurfaceSoFar {
    positions: Vec<[f64; 3]>,
    faces: Vec<[u32; 6]>,
}

impl SurfaceSoFar {
    /// A brick about a centre, with its half edges as columns.
    fn brick(&mut self, center: &Vector3<f64>, half_edges: &Matrix3<f64>) {
        let first = self.positions.len();
        let side = |corner: usize, axis: usize| if corner >> axis & 1 == 1 { 1.0 } else { -1.0 };
        for corner in 0..8 {
            let sides = Vector3::from_fn(|axis, _| side(corner, axis));
            self.positions.push((center + half_edges * sides).into());
        }
        let mut middles = HashMap::new();
        for triangle in BRICK {
            let [a, b, c] = triangle.map(|corner| first + corner);
            let [ab, bc, ca] = [[a, b], [b, c], [c, a]].map(|ends| self.middle(ends, &mut middles));
            self.faces.push([a, b, c, ab, bc, ca].map(|place| place as u32));
        }
    }

    /// The place in the middle of an edge.
    fn middle(&mut self, [a, b]: [usize; 2], middles: &mut HashMap<[usize; 2], usize>) -> usize {
        *middles.entry([a.min(b), a.max(b)]).or_insert_with(|| {
            let between = (Vector3::from(self.positions[a]) + Vector3::from(self.positions[b])) / 2.0;
            self.positions.push(between.into());
            self.positions.len() - 1
        })
    }

    /// A square bar from a centre along an arm.
    fn bar(&mut self, center: &Vector3<f64>, arm: &Vector3<f64>, half_width: f64) {
        let along = arm.normalize();
        let across = along.cross(&Vector3::ith(along.iamin(), 1.0)).normalize();
        let third = along.cross(&across);
        self.brick(
            &(center + arm / 2.0),
            &Matrix3::from_columns(&[arm / 2.0, across * half_width, third * half_width]),
        );
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_box_of_its_inertia_is_the_box() {
        // Closed form: edges 3, 2 and 0.5 of a uniform box, turned.
        let (mass, edges) = (7.0, Vector3::new(3.0, 2.0, 0.5));
        let square = edges.component_mul(&edges);
        let moments = (Vector3::repeat(square.sum()) - square) * (mass / 12.0);
        let turn = *nalgebra::Rotation3::from_euler_angles(0.3, -0.8, 1.1).matrix();
        let (axes, found) = box_of_inertia(mass, &(turn * Matrix3::from_diagonal(&moments) * turn.transpose()));
        assert!((axes.determinant() - 1.0).abs() < 1e-12);
        for (axis, edge) in edges.iter().enumerate() {
            let along = (0..3).find(|i| turn.column(axis).dot(&axes.column(*i)).abs() > 1.0 - 1e-9).unwrap();
            assert!((found[along] - edge).abs() < 1e-9, "{found:?}");
        }
    }

    #[test]
    fn a_bar_is_closed_and_seen_from_outside() {
        let mut drawn = SurfaceSoFar::default();
        let [center, arm] = [Vector3::new(1.0, 2.0, 3.0), Vector3::new(0.6, -0.8, 2.0)];
        drawn.bar(&center, &arm, 0.05);
        let corner = |place: u32| Vector3::from(drawn.positions[place as usize]) - center;
        let volume: f64 =
            drawn.faces.iter().map(|[a, b, c, ..]| corner(*a).cross(&corner(*b)).dot(&corner(*c)) / 6.0).sum();
        // Closed form: length times width squared, by the divergence theorem; negative if seen from inside.
        assert!((volume - arm.norm() * 0.01).abs() < 1e-12, "{volume}");
        // Eight corners, and a middle on each of 18 edges.
        assert_eq!(drawn.positions.len(), 26);
    }
}
