//! The rows of all outputs, in the order in which responses are summed.

use crate::second_order::{Rate, SecondOrder};

/// The rows of all outputs, by coordinate.
pub(crate) struct Rows {
    /// Number of outputs.
    pub outputs: usize,
    /// True if an output sees velocities.
    pub see_velocity: bool,
    /// D₀, outputs of an input one after another.
    pub direct: Vec<f64>,
    /// R₀, R₁ and R₂, outputs of a coordinate one after another.
    by_coordinate: [Vec<f64>; 3],
}

impl Rows {
    pub fn new(equations: &SecondOrder) -> Self {
        let (n, m, outputs) = (equations.size(), equations.inputs.len(), &equations.outputs);
        let of = |rate: Rate| (0..n).flat_map(|k| outputs.iter().map(move |output| output.at(rate, k))).collect();
        let direct = |j: usize| outputs.iter().map(move |output| output.direct.get(j).copied().unwrap_or(0.0));
        Self {
            outputs: outputs.len(),
            see_velocity: outputs.iter().any(|output| !output.rows[Rate::Velocity as usize].is_empty()),
            direct: (0..m).flat_map(direct).collect(),
            by_coordinate: [Rate::Place, Rate::Velocity, Rate::Acceleration].map(of),
        }
    }

    /// Entries of R₀, R₁ and R₂ of all outputs in a coordinate.
    pub fn of_coordinate(&self, k: usize) -> [&[f64]; 3] {
        let own = k * self.outputs..(k + 1) * self.outputs;
        self.by_coordinate.each_ref().map(|rows| &rows[own.clone()])
    }
}
