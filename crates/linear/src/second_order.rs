//! Equations of second order with inputs and outputs, Eqs. (F1) and (F2).

use faer::Mat;

use crate::channel::Channel;
use crate::error::LinearError;
use crate::state_space::StateSpace;

/// The rate of the coordinates that an output sees.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Rate {
    /// η.
    Place,
    /// η̇.
    Velocity,
    /// η̈.
    Acceleration,
}

/// An output.
#[derive(Debug, Clone, PartialEq)]
pub struct Output {
    /// Its name and unit.
    pub channel: Channel,
    /// The rate that it sees.
    pub rate: Rate,
    /// Its row of R (n).
    pub row: Vec<f64>,
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
            if output.row.len() != n {
                return Err(LinearError::Size { what: "R", found: [1, output.row.len()], expected: [1, n] });
            }
            if let Some(found) = output.row.iter().copied().find(|x| !x.is_finite()) {
                return Err(LinearError::Value { what: "R", found, expected: "finite numbers" });
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
        let c = Mat::from_fn(p, 2 * n, |i, j| {
            let Output { rate, row, .. } = &self.outputs[i];
            match (rate, j < n) {
                (Rate::Place, true) => row[j],
                (Rate::Velocity, false) => row[j - n],
                (Rate::Place, false) | (Rate::Velocity, true) => 0.0,
                (Rate::Acceleration, true) => -times(row, &self.stiffness, j),
                (Rate::Acceleration, false) => -times(row, &self.damping, j - n),
            }
        });
        let d = Mat::from_fn(p, m, |i, j| match self.outputs[i].rate {
            Rate::Acceleration => times(&self.outputs[i].row, &self.forces, j),
            _ => 0.0,
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

    /// The same without some of the coordinates, whose motion is then not in any output.
    #[must_use]
    pub fn without(&self, left_out: &[usize]) -> Self {
        let kept: Vec<usize> = (0..self.size()).filter(|k| !left_out.contains(k)).collect();
        let square = |matrix: &Mat<f64>| Mat::from_fn(kept.len(), kept.len(), |i, j| matrix[(kept[i], kept[j])]);
        let row = |output: &Output| Output { row: kept.iter().map(|k| output.row[*k]).collect(), ..output.clone() };
        Self {
            stiffness: square(&self.stiffness),
            damping: square(&self.damping),
            forces: Mat::from_fn(kept.len(), self.inputs.len(), |i, j| self.forces[(kept[i], j)]),
            inputs: self.inputs.clone(),
            outputs: self.outputs.iter().map(row).collect(),
            coordinates: kept.iter().map(|k| self.coordinates[*k].clone()).collect(),
        }
    }
}
