//! The bent body that modes are about: the rest of the full body in a steady spin and under steady loads.
//!
//! ```text
//! f_int(u₀) = f + M W (X + u₀)        K → K_T(u₀),   X → X + u₀
//! ```
//!
//! Eqs. (B1)–(B4) of `docs/method/reference.md`. It takes the place of the undeformed body in all that follows: modes, static
//! responses, large and following modes, constants of the motion.

pub(crate) mod found;

use faer::Mat;
use keys::Hash;
use modal::Modes;
use nalgebra::Vector3;

/// A spin and loads that stay as they are.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Steady {
    /// Body axes.
    pub omega_body: Vector3<f64>,
    /// True if the steady loads act.
    pub loads: bool,
}

/// The bent body.
#[derive(Debug)]
pub(crate) struct Reference {
    pub steady: Steady,
    /// u₀ (3n×1).
    pub displacement: Mat<f64>,
    /// f_int(u₀) (3n×1).
    pub forces: Mat<f64>,
    /// X + u₀ of each node.
    pub positions: Vec<[f64; 3]>,
    pub hash: Hash,
}

impl Reference {
    /// By u₀, f_int(u₀) and the spin, one after the other.
    fn new(loads: bool, positions: &[[f64; 3]], found: &[f64]) -> Self {
        let rows = 3 * positions.len();
        let (displacement, rest) = found.split_at(rows);
        let (forces, omega) = rest.split_at(rows);
        let steady = Steady { omega_body: Vector3::from_column_slice(omega), loads };
        let moved = |(x, u): (&[f64; 3], &[f64])| [x[0] + u[0], x[1] + u[1], x[2] + u[2]];
        Self {
            steady,
            positions: positions.iter().zip(displacement.chunks_exact(3)).map(moved).collect(),
            hash: Hash::of(displacement),
            displacement: Mat::from_fn(rows, 1, |row, _| displacement[row]),
            forces: Mat::from_fn(rows, 1, |row, _| forces[row]),
        }
    }

    /// Largest displacement of a node.
    fn largest(&self) -> f64 {
        let size = |node: usize| Vector3::from_fn(|axis, _| self.displacement[(3 * node + axis, 0)]).norm();
        (0..self.positions.len()).map(size).fold(0.0, f64::max)
    }

    /// Ψᵀ f_int(u₀) of some shapes.
    pub fn modal_forces(&self, modes: &Modes) -> Vec<f64> {
        let forces = modes.shapes.transpose() * &self.forces;
        forces.col(0).iter().copied().collect()
    }

    /// The displacement of a point that moves with the weighted mean of nodes.
    pub fn displacement_at(&self, nodes: &[u32], weights: &[f64]) -> Vector3<f64> {
        let of_node = |node: u32| Vector3::from_fn(|axis, _| self.displacement[(3 * node as usize + axis, 0)]);
        nodes.iter().zip(weights).map(|(node, weight)| of_node(*node) * *weight).sum()
    }
}
