//! The columns of the matrices of an element, all ten rows of nodes side by side.
//!
//! ```text
//! K_ab = λ G + μ Gᵀ + μ tr(G) I,   G_ij = ∫ ∂N_a/∂x_i ∂N_b/∂x_j dV
//! ```
//!
//! At each point of integration the gradients are kept times √dV: a product of two of them is the same number whichever comes
//! first, so K is symmetric to the last bit.

use rayon::prelude::*;

use crate::element::integration::{Rules, is_straight, jacobian};
use crate::element::lanes::LANES;
use crate::element::quadrature;
use crate::element::shape::shape_functions;
use crate::material::Material;
use crate::mesh::checked::Mesh;

/// Nodes of an element and two more, which are zero: whole vectors of numbers.
const ROWS: usize = 12;
/// Elements whose points one task computes.
const PART: usize = 512;
/// Points of a straight and of a curved element.
const POINTS: [usize; 2] = [4, 14];

/// A number for each node.
pub(crate) type Nodes = [f64; ROWS];

/// √dV ∂N_a/∂x_i of one integration point: axis, node.
type Gradients = [Nodes; 3];

/// The integration points of all elements.
pub(crate) struct ElementPoints {
    /// Where those of each element begin.
    start: Vec<usize>,
    gradients: Vec<Gradients>,
    /// The volumes dV that the points stand for.
    volumes: Vec<f64>,
}

impl ElementPoints {
    /// Bytes that they take at the most for each element.
    pub const BYTES: usize = 14 * (size_of::<Gradients>() + 8) + 8;

    pub fn new(mesh: &Mesh, rules: &Rules) -> Self {
        let count = mesh.elements().len();
        let straight: Vec<bool> = (0..count).into_par_iter().map(|e| is_straight(&mesh.element_positions(e))).collect();
        let mut start = Vec::with_capacity(count + 1);
        let mut end = 0;
        start.push(0);
        start.extend(straight.iter().map(|is_straight| {
            end += POINTS[usize::from(!is_straight)];
            end
        }));
        let mut gradients = vec![[[0.0; ROWS]; 3]; end];
        let mut volumes = vec![0.0; end];
        let (mut left, mut left_volumes) = (&mut gradients[..], &mut volumes[..]);
        let mut tasks = Vec::new();
        for first in (0..count).step_by(PART) {
            let elements = first..count.min(first + PART);
            let points = start[elements.end] - start[elements.start];
            let (own, rest) = left.split_at_mut(points);
            let (own_volumes, rest_volumes) = left_volumes.split_at_mut(points);
            (left, left_volumes) = (rest, rest_volumes);
            tasks.push((elements, own, own_volumes));
        }
        tasks.into_par_iter().for_each(|(elements, mut gradients, mut volumes)| {
            for e in elements {
                let positions = mesh.element_positions(e);
                let rule = rules.quadratic(straight[e]);
                let (own, rest) = std::mem::take(&mut gradients).split_at_mut(rule.len());
                let (own_volumes, rest_volumes) = std::mem::take(&mut volumes).split_at_mut(rule.len());
                (gradients, volumes) = (rest, rest_volumes);
                // The Jacobian of a straight element is the same everywhere.
                let mut known = None;
                for ((rule, gradients), volume) in rule.iter().zip(own).zip(own_volumes) {
                    let jacobian = match known {
                        Some(jacobian) if straight[e] => jacobian,
                        _ => *known.insert(jacobian(&positions, &rule.gradients)),
                    };
                    // A mesh that has been checked has no singular or negative Jacobian at these points.
                    let inverse = jacobian.try_inverse().unwrap_or_default();
                    *volume = rule.point.weight * jacobian.determinant();
                    let root = volume.max(0.0).sqrt();
                    for (a, dn) in rule.gradients.iter().enumerate() {
                        for (i, row) in gradients.iter_mut().enumerate() {
                            let slope = inverse[(0, i)] * dn[0] + inverse[(1, i)] * dn[1] + inverse[(2, i)] * dn[2];
                            row[a] = root * slope;
                        }
                    }
                }
            }
        });
        Self { start, gradients, volumes }
    }

    /// The blocks `K_ab` of column b: axis of the column, axis of the row, row a.
    #[inline(always)]
    pub fn stiffness(&self, element: usize, material: &Material, b: usize) -> [[Nodes; 3]; 3] {
        let (lambda, mu) = material.lame();
        let points = &self.gradients[self.start[element]..self.start[element + 1]];
        let mut column = [[[0.0; ROWS]; 3]; 3];
        // Four rows at a time: their sums stay in registers.
        for first in (0..ROWS).step_by(LANES) {
            // Axis of b, axis of a.
            let mut sums = [[[0.0; LANES]; 3]; 3];
            for point in points {
                let mut of_a = [[0.0; LANES]; 3];
                for (of_a, point) in of_a.iter_mut().zip(point) {
                    of_a.copy_from_slice(&point[first..first + LANES]);
                }
                for (sums, point) in sums.iter_mut().zip(point) {
                    let of_b = point[b];
                    for (sums, of_a) in sums.iter_mut().zip(&of_a) {
                        for lane in 0..LANES {
                            sums[lane] += of_a[lane] * of_b;
                        }
                    }
                }
            }
            let mut shear = [0.0; LANES];
            for lane in 0..LANES {
                shear[lane] = mu * (sums[0][0][lane] + sums[1][1][lane] + sums[2][2][lane]);
            }
            for j in 0..3 {
                for i in 0..3 {
                    let mut block = [0.0; LANES];
                    for lane in 0..LANES {
                        block[lane] = lambda * sums[j][i][lane] + mu * sums[i][j][lane];
                    }
                    if i == j {
                        for lane in 0..LANES {
                            block[lane] += shear[lane];
                        }
                    }
                    column[j][i][first..first + LANES].copy_from_slice(&block);
                }
            }
        }
        column
    }

    /// `∫ ρ N_a N_b dV` for all a.
    #[inline(always)]
    pub fn mass(&self, element: usize, material: &Material, products: &MassProducts, b: usize) -> Nodes {
        let volumes = &self.volumes[self.start[element]..self.start[element + 1]];
        let mut column = [0.0; ROWS];
        let mut add = |volume: f64, products: &[Nodes; 10]| {
            for a in 0..ROWS {
                column[a] += material.density * volume * products[b][a];
            }
        };
        if volumes.len() == products.at_points.len() {
            volumes.iter().zip(&products.at_points).for_each(|(volume, products)| add(*volume, products));
        } else {
            add(volumes.iter().sum(), &products.straight);
        }
        column
    }
}

/// ∫ N_a N_b over an element.
pub(crate) struct MassProducts {
    /// N_a N_b at the points of the degree-5 rule.
    at_points: Vec<[Nodes; 10]>,
    /// ∫ N_a N_b over a straight element of volume one.
    straight: [Nodes; 10],
}

impl MassProducts {
    pub fn new() -> Self {
        let rule = quadrature::degree_5();
        let at_points: Vec<[Nodes; 10]> = rule
            .iter()
            .map(|p| {
                let n = shape_functions(p.at);
                n.map(|nb| std::array::from_fn(|a| n.get(a).map_or(0.0, |na| na * nb)))
            })
            .collect();
        let mut straight = [[0.0; ROWS]; 10];
        for (p, products) in rule.iter().zip(&at_points) {
            for (sums, products) in straight.iter_mut().zip(products) {
                for (sum, product) in sums.iter_mut().zip(products) {
                    *sum += 6.0 * p.weight * product;
                }
            }
        }
        Self { at_points, straight }
    }
}
