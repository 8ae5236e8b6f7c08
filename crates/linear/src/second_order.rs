//! Equations of second order with inputs and outputs, Eqs. (F1) and (F2).

use faer::{Mat, c64};

use crate::channel::Channel;
use crate::error::LinearError;
use crate::state_space::StateSpace;

/// Damping of a frequency response beside that of the equations.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Damping {
    /// The damping of the equations alone.
    OfEquations,
    /// Structural damping in the place of that of the equations: K (1 + i g) with a loss factor g.
    Structural(f64),
}

/// A rate of the coordinates, by its number among the rows of an output.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Rate {
    /// η.
    Place,
    /// η̇.
    Velocity,
    /// η̈.
    Acceleration,
}

/// An output: its rows of Eq. (F2), of which an empty one is zero.
#[derive(Debug, Clone, PartialEq)]
pub struct Output {
    /// Its name and unit.
    pub channel: Channel,
    /// Rows of R₀, R₁ and R₂ (n each): of η, η̇ and η̈.
    pub rows: [Vec<f64>; 3],
    /// Row of D₀ (m): what it sees of the inputs themselves.
    pub direct: Vec<f64>,
}

impl Output {
    /// An output that sees one rate of the coordinates.
    pub fn new(channel: Channel, rate: Rate, row: Vec<f64>) -> Self {
        let mut rows = [Vec::new(), Vec::new(), Vec::new()];
        rows[rate as usize] = row;
        Self { channel, rows, direct: Vec::new() }
    }

    /// An entry of one of its rows.
    pub(crate) fn at(&self, rate: Rate, k: usize) -> f64 {
        self.rows[rate as usize].get(k).copied().unwrap_or(0.0)
    }
}

/// Equations of second order over coordinates of unit mass.
#[derive(Debug, Clone)]
pub struct SecondOrder {
    /// K (n×n).
    pub stiffness: Mat<f64>,
    /// C (n×n).
    pub damping: Mat<f64>,
    /// B (n×m): forces of unit inputs on the coordinates.
    pub forces: Mat<f64>,
    /// Inputs (m).
    pub inputs: Vec<Channel>,
    /// Outputs (p).
    pub outputs: Vec<Output>,
    /// Coordinates (n), their units that of η.
    pub coordinates: Vec<Channel>,
}

impl SecondOrder {
    /// Number of coordinates.
    pub fn size(&self) -> usize {
        self.stiffness.nrows()
    }

    /// Refuses matrices of other sizes, and numbers that are not finite.
    ///
    /// # Errors
    /// [`LinearError::Size`], [`LinearError::Value`].
    pub fn check(&self) -> Result<(), LinearError> {
        let n = self.size();
        let expected = [("K", &self.stiffness, [n, n]), ("C", &self.damping, [n, n])];
        let forces = [("B", &self.forces, [n, self.inputs.len()])];
        for (what, matrix, expected) in expected.into_iter().chain(forces) {
            let found = [matrix.nrows(), matrix.ncols()];
            if found != expected {
                return Err(LinearError::Size { what, found, expected });
            }
            if let Some(found) = matrix.col_iter().flat_map(|c| c.iter().copied()).find(|x| !x.is_finite()) {
                return Err(LinearError::Value { what, found, expected: "finite numbers" });
            }
        }
        for output in &self.outputs {
            let rows = output.rows.iter().map(|row| ("R", row, n)).chain([("D", &output.direct, self.inputs.len())]);
            for (what, row, expected) in rows.filter(|(_, row, _)| !row.is_empty()) {
                if row.len() != expected {
                    return Err(LinearError::Size { what, found: [1, row.len()], expected: [1, expected] });
                }
                if let Some(found) = row.iter().copied().find(|x| !x.is_finite()) {
                    return Err(LinearError::Value { what, found, expected: "finite numbers" });
                }
            }
        }
        Ok(())
    }

    /// The state space, Eq. (F3): states are the coordinates and their rates.
    ///
    /// # Errors
    /// As [`Self::check`].
    pub fn state_space(&self) -> Result<StateSpace, LinearError> {
        self.check()?;
        let (n, m, p) = (self.size(), self.inputs.len(), self.outputs.len());
        let delta = |i: usize, j: usize| f64::from(u8::from(i == j));
        let a = Mat::from_fn(2 * n, 2 * n, |i, j| match (i < n, j < n) {
            (true, true) => 0.0,
            (true, false) => delta(i, j - n),
            (false, true) => -self.stiffness[(i - n, j)],
            (false, false) => -self.damping[(i - n, j - n)],
        });
        let b = Mat::from_fn(2 * n, m, |i, j| if i < n { 0.0 } else { self.forces[(i - n, j)] });
        let times = |row: &[f64], matrix: &Mat<f64>, j: usize| -> f64 {
            row.iter().enumerate().map(|(i, r)| r * matrix[(i, j)]).sum()
        };
        // η̈ = −K η − C η̇ + B u.
        let c = Mat::from_fn(p, 2 * n, |i, j| {
            let output = &self.outputs[i];
            let [.., of_acceleration] = &output.rows;
            match j < n {
                true => output.at(Rate::Place, j) - times(of_acceleration, &self.stiffness, j),
                false => output.at(Rate::Velocity, j - n) - times(of_acceleration, &self.damping, j - n),
            }
        });
        let d = Mat::from_fn(p, m, |i, j| {
            let Output { rows: [.., of_acceleration], direct, .. } = &self.outputs[i];
            times(of_acceleration, &self.forces, j) + direct.get(j).copied().unwrap_or(0.0)
        });
        let rates =
            self.coordinates.iter().map(|c| Channel::new(format!("{}.rate", c.name), format!("{}/time", c.unit)));
        Ok(StateSpace {
            a,
            b,
            c,
            d,
            states: self.coordinates.iter().cloned().chain(rates).collect(),
            inputs: self.inputs.clone(),
            outputs: self.outputs.iter().map(|output| output.channel.clone()).collect(),
        })
    }

    /// Poles, rad per time; with structural damping those of each frequency's own equations, ω (−g/2 + i) for small g.
    ///
    /// # Errors
    /// As [`Self::state_space`], [`LinearError::Eigen`].
    pub fn poles(&self, damping: Damping) -> Result<Vec<c64>, LinearError> {
        let Damping::Structural(loss) = damping else { return self.state_space()?.poles() };
        let size = self.size();
        let squares: Vec<c64> = self.stiffness.eigenvalues().map_err(|_| LinearError::Eigen { size })?;
        // K (1 + i g) = ω²: the root that decays with time.
        Ok(squares.into_iter().map(|square| c64::new(0.0, 1.0) * (square * c64::new(1.0, loss)).sqrt()).collect())
    }

    /// The same without some of the coordinates, whose motion is then not in any output.
    #[must_use]
    pub fn without(&self, left_out: &[usize]) -> Self {
        let kept: Vec<usize> = (0..self.size()).filter(|k| !left_out.contains(k)).collect();
        let square = |matrix: &Mat<f64>| Mat::from_fn(kept.len(), kept.len(), |i, j| matrix[(kept[i], kept[j])]);
        let row =
            |output: &Output| Output { rows: output.rows.each_ref().map(|row| picked(row, &kept)), ..output.clone() };
        Self {
            stiffness: square(&self.stiffness),
            damping: square(&self.damping),
            forces: Mat::from_fn(kept.len(), self.inputs.len(), |i, j| self.forces[(kept[i], j)]),
            inputs: self.inputs.clone(),
            outputs: self.outputs.iter().map(row).collect(),
            coordinates: kept.iter().map(|k| self.coordinates[*k].clone()).collect(),
        }
    }

    /// The same with some of the inputs and outputs, by their numbers.
    #[must_use]
    pub fn with_channels(&self, inputs: &[usize], outputs: &[usize]) -> Self {
        let output = |i: &usize| {
            let output = &self.outputs[*i];
            Output { direct: picked(&output.direct, inputs), ..output.clone() }
        };
        Self {
            forces: Mat::from_fn(self.size(), inputs.len(), |i, j| self.forces[(i, inputs[j])]),
            inputs: inputs.iter().map(|j| self.inputs[*j].clone()).collect(),
            outputs: outputs.iter().map(output).collect(),
            ..self.clone()
        }
    }

    /// The dynamic stiffness K − ω² + i ω C between two coordinates.
    pub(crate) fn dynamic_stiffness(&self, [i, j]: [usize; 2], omega: f64, damping: Damping) -> c64 {
        let own = if i == j { omega * omega } else { 0.0 };
        let stiffness = self.stiffness[(i, j)];
        match damping {
            Damping::OfEquations => c64::new(stiffness - own, omega * self.damping[(i, j)]),
            Damping::Structural(loss) => c64::new(stiffness - own, loss * stiffness),
        }
    }
}

/// Entries of a row by their numbers; an empty row, which is zero, stays empty.
fn picked(row: &[f64], numbers: &[usize]) -> Vec<f64> {
    if row.is_empty() { Vec::new() } else { numbers.iter().map(|k| row[*k]).collect() }
}
