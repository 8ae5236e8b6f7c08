//! The peaks of modes, and their sums for each output.

use std::f64::consts::TAU;

use linear::{Output, RealModes, SecondOrder};
use rayon::prelude::*;
use shock::{BaseMotion, Following, ModalPeak, Peaks, ShockError, Sum};

/// The largest value of an output, in three sums.
#[derive(Debug, Clone)]
pub(super) struct ShockOutput {
    /// Its name.
    pub output: String,
    /// Its unit.
    pub unit: String,
    /// Σ of magnitudes: an upper bound.
    pub absolute: f64,
    /// Root of the sum of squares.
    pub srss: f64,
    /// Complete quadratic combination.
    pub cqc: f64,
    /// The part that goes with the input: that which no mode of the model has, and of each mode the part that follows. It is in SRSS and CQC.
    pub rigid: f64,
    /// Number of the mode with the largest peak, from 1; none where the rigid part is larger.
    pub largest_mode: Option<usize>,
}

/// True where an output goes with places, velocities or accelerations.
fn sees(output: &Output, which: usize) -> bool {
    output.rows[which].iter().any(|entry| *entry != 0.0)
}

/// Names of the outputs that go with velocities beside places and accelerations.
pub(super) fn mixed(equations: &SecondOrder) -> Vec<String> {
    let mixed = equations.outputs.iter().filter(|output| sees(output, 1) && (sees(output, 0) || sees(output, 2)));
    mixed.map(|output| output.channel.name.clone()).collect()
}

/// The peaks of each mode.
pub(super) struct ModePeaks {
    /// Frequencies, cycles per time.
    pub frequencies: Vec<f64>,
    /// Damping ratios.
    pub damping_ratios: Vec<f64>,
    /// Factors b of the input, −Γ of a base.
    pub factors: Vec<f64>,
    /// Peaks of an oscillator of that frequency and damping on a base that follows the table, and how it follows.
    pub following: Vec<Following>,
    /// Shapes over the coordinates, a list a mode.
    shapes: Vec<Vec<f64>>,
}

impl ModePeaks {
    pub fn new(equations: &SecondOrder, modes: &RealModes, motion: &BaseMotion) -> Result<Self, ShockError> {
        let shapes: Vec<Vec<f64>> = modes.shapes.col_iter().map(|shape| shape.iter().copied().collect()).collect();
        let factor = |shape: &Vec<f64>| (0..shape.len()).map(|i| shape[i] * equations.forces[(i, 0)]).sum();
        let frequencies: Vec<f64> = modes.circular_frequencies.iter().map(|omega| omega / TAU).collect();
        let damping_ratios = modes.damping_ratios.clone();
        let each = frequencies.par_iter().zip(&damping_ratios);
        let following = each.map(|(frequency, ratio)| motion.following(*frequency, *ratio));
        let following = following.collect::<Result<_, _>>()?;
        Ok(Self { frequencies, damping_ratios, factors: shapes.iter().map(factor).collect(), following, shapes })
    }

    /// The sums of each output that sees places or accelerations, Eqs. (R6) to (R9); velocities have no spectrum. `largest`: the
    /// largest magnitude of the table.
    pub fn outputs(&self, equations: &SecondOrder, largest: f64) -> Result<Vec<ShockOutput>, ShockError> {
        let seen = equations.outputs.iter().filter(|output| !sees(output, 1));
        seen.map(|output| self.output(output, largest)).collect()
    }

    fn output(&self, output: &Output, largest: f64) -> Result<ShockOutput, ShockError> {
        let [of_place, _, of_acceleration] = &output.rows;
        let along = |row: &[f64], shape: &[f64]| -> f64 { row.iter().zip(shape).map(|(r, v)| r * v).sum() };
        let direct = output.direct.first().copied().unwrap_or(0.0);
        // η = −b z and η̈ = −b (w − a): with the modes goes what they have of the input itself, and the rest is rigid. In phase with the
        // input are z = −Z and w = W.
        let mut rigid = direct;
        let mut in_phase = 0.0;
        let (mut followed, mut beside) = (direct, 0.0);
        let mut peaks = Vec::with_capacity(self.following.len());
        let mut periodic = Vec::with_capacity(self.following.len());
        for (k, shape) in self.shapes.iter().enumerate() {
            let [r, s] = [of_place, of_acceleration].map(|row| along(row, shape));
            let (b, following) = (self.factors[k], &self.following[k]);
            rigid += s * b;
            let of = |peaks: &Peaks| -b * (r * peaks.displacement - s * peaks.acceleration());
            let peak =
                |value: f64| ModalPeak { frequency: self.frequencies[k], damping_ratio: self.damping_ratios[k], value };
            let (value, alpha) = (of(&following.peaks), following.correlation);
            in_phase -= alpha * value;
            peaks.push(peak(value));
            periodic.push(peak((1.0 - alpha * alpha).sqrt() * value));
            let stiffness = (TAU * self.frequencies[k]).powi(2);
            followed += b * (r * following.part / stiffness + s * (1.0 - following.part));
            beside += of(&following.rest).abs();
        }
        let bound = (rigid * largest).abs() + Sum::Absolute.of(&peaks)?;
        let rigid = (rigid * largest + in_phase).abs();
        let most = peaks.iter().enumerate().max_by(|a, b| a.1.value.abs().total_cmp(&b.1.value.abs()));
        let largest_mode = most.filter(|(_, peak)| peak.value.abs() > rigid).map(|(k, _)| k + 1);
        let of_modes = |sum: Sum| sum.of(&periodic);
        Ok(ShockOutput {
            output: output.channel.name.clone(),
            unit: output.channel.unit.clone(),
            absolute: bound.min((followed * largest).abs() + beside),
            srss: of_modes(Sum::Srss)?.hypot(rigid),
            cqc: of_modes(Sum::Cqc)?.hypot(rigid),
            rigid,
            largest_mode,
        })
    }
}
