//! The responses at one frequency, while they are summed.

use faer::{Mat, c64};

use crate::error::LinearError;
use crate::rows::Rows;

/// The responses at one frequency while they are summed: real and imaginary parts apart, outputs of an input one after another.
pub(crate) struct Values {
    outputs: usize,
    real: Vec<f64>,
    imaginary: Vec<f64>,
    /// R₀ − ω² R₂ and ω R₁ of the outputs in one coordinate.
    row: [Vec<f64>; 2],
}

impl Values {
    pub fn new(rows: &Rows, inputs: usize) -> Self {
        let (p, size) = (rows.outputs, rows.outputs * inputs);
        Self { outputs: p, real: vec![0.0; size], imaginary: vec![0.0; size], row: [vec![0.0; p], vec![0.0; p]] }
    }

    /// Adds a coordinate, which moves by so much under each unit input.
    pub fn add_coordinate(&mut self, rows: &Rows, k: usize, omega: f64, motion: impl Fn(usize) -> c64) {
        let [place, velocity, acceleration] = rows.of_coordinate(k);
        let [real_row, imaginary_row] = &mut self.row;
        let of_place = place.iter().zip(acceleration);
        real_row.iter_mut().zip(of_place).for_each(|(row, (place, rate))| *row = place - omega * omega * rate);
        imaginary_row.iter_mut().zip(velocity).for_each(|(row, velocity)| *row = omega * velocity);
        let inputs = self.real.chunks_exact_mut(self.outputs).zip(self.imaginary.chunks_exact_mut(self.outputs));
        for (j, (real, imaginary)) in inputs.enumerate() {
            let motion = motion(j);
            // An output that sees nothing of an infinite motion stays as it is.
            if !(motion.re.is_finite() && motion.im.is_finite()) {
                for i in (0..real.len()).filter(|i| real_row[*i] != 0.0 || imaginary_row[*i] != 0.0) {
                    real[i] = f64::INFINITY;
                }
                continue;
            }
            let sums = real.iter_mut().zip(imaginary);
            if rows.see_velocity {
                for ((real, imaginary), (a, b)) in sums.zip(real_row.iter().zip(imaginary_row.iter())) {
                    *real += a * motion.re - b * motion.im;
                    *imaginary += a * motion.im + b * motion.re;
                }
            } else {
                for ((real, imaginary), a) in sums.zip(real_row.iter()) {
                    *real += a * motion.re;
                    *imaginary += a * motion.im;
                }
            }
        }
    }

    /// Adds a complex mode: the outputs of a unit of it, real and imaginary, and its motion under each unit input.
    pub fn add_mode(&mut self, seen: [&[f64]; 2], motion: impl Fn(usize) -> c64) {
        let inputs = self.real.chunks_exact_mut(self.outputs).zip(self.imaginary.chunks_exact_mut(self.outputs));
        for (j, (real, imaginary)) in inputs.enumerate() {
            let motion = motion(j);
            for ((real, imaginary), (a, b)) in real.iter_mut().zip(imaginary).zip(seen[0].iter().zip(seen[1])) {
                *real += a * motion.re - b * motion.im;
                *imaginary += a * motion.im + b * motion.re;
            }
        }
    }

    /// Adds what outputs see of the inputs themselves.
    pub fn add_direct(&mut self, direct: &[f64]) {
        self.real.iter_mut().zip(direct).for_each(|(sum, direct)| *sum += direct);
    }

    /// The matrix (p×m), where it is finite.
    pub fn finished(mut self, rows: &Rows, frequency: f64) -> Result<Mat<c64>, LinearError> {
        self.add_direct(&rows.direct);
        if self.real.iter().chain(&self.imaginary).any(|x| !x.is_finite()) {
            return Err(LinearError::Resonance { frequency });
        }
        let p = self.outputs;
        let inputs = self.real.len().checked_div(p).unwrap_or(0);
        Ok(Mat::from_fn(p, inputs, |i, j| c64::new(self.real[j * p + i], self.imaginary[j * p + i])))
    }
}
