//! Small vibrations about a state that is taken for steady, and the motion there.
//!
//! ```text
//! δy' = (∂y'/∂y) δy,      y = (π, q, p)
//! ```
//!
//! The attitude, the time and a drive stay as they are. Of a body that turns freely, its spin vibrates along.

use faer::{Mat, c64};

use crate::body::motion_state::MotionState;
use crate::body::shapes::PointShapes;
use crate::conservative::{ConservativeBody, SLOW, part};

use crate::equations::{Equations, Evaluation, Oscillators};
use crate::error::StepError;
use crate::observation::Observation;
use crate::state::State;
use crate::vibration::loaded::{LoadedError, LoadedMode};
use crate::vibration::system::error::SteadyError;

impl ConservativeBody {
    /// The motion at a state, and that of `points`: its accelerations, its reaction.
    ///
    /// # Errors
    /// [`LoadedError::Setup`] for a state of another body; [`LoadedError::Rates`] where the inertia is singular.
    pub fn observed_at(&self, motion: &MotionState, points: &[PointShapes]) -> Result<Observation, LoadedError> {
        let state = self.state_of(motion)?;
        let mut e = self.evaluation();
        let in_step = |error: crate::RateError| LoadedError::Rates(error.in_step(state.time, 0.0));
        e.place_mut().copy_from_slice(&state.values);
        self.rates([state.time; 2], &self.frame(&state), &mut e).map_err(in_step)?;
        let mut out = Observation::new(self.flexible(), points.len());
        self.observe(&state, &mut e, points, &mut out).map_err(in_step)?;
        Ok(out)
    }

    /// The vibrations about a state, slowest first, by central differences over ±`amplitudes` (nf) of the modal displacements.
    ///
    /// # Errors
    /// [`LoadedError`].
    pub fn vibrations_at(&self, motion: &MotionState, amplitudes: &[f64]) -> Result<Vec<LoadedMode>, LoadedError> {
        let state = self.state_of(motion)?;
        let [first_q, first_p] = self.first_modes();
        let omega = self.circular_frequencies();
        let size = self.undeformed_inertia().trace() * omega.iter().copied().fold(f64::INFINITY, f64::min);
        let turning = self.free_turns().map(|k| (SLOW + part::PI + k, 1e-3 * size));
        let of_q = amplitudes.iter().enumerate().map(|(k, amplitude)| (first_q + k, *amplitude));
        let of_p =
            amplitudes.iter().zip(omega).enumerate().map(|(k, (amplitude, omega))| (first_p + k, amplitude * omega));
        let places: Vec<(usize, f64)> = turning.chain(of_q).chain(of_p).collect();
        let mut jacobian = Mat::zeros(places.len(), places.len());
        for (column, (place, amplitude)) in places.iter().enumerate() {
            let moved = |sign: f64| {
                let mut moved = state.clone();
                moved.values[*place] += sign * amplitude;
                self.all_rates(&moved)
            };
            let (after, before) = (moved(1.0)?, moved(-1.0)?);
            // In units of the amplitudes, so that all entries are frequencies.
            for (row, (at, size)) in places.iter().enumerate() {
                jacobian[(row, column)] = (after[*at] - before[*at]) / (2.0 * size);
            }
        }
        let eigenvalues: Vec<c64> = jacobian.eigenvalues().map_err(|_| SteadyError::Numbers)?;
        let mut modes: Vec<LoadedMode> = eigenvalues
            .into_iter()
            .filter(|root| root.im > 0.0 || (root.im == 0.0 && root.re >= 0.0))
            .map(|root| LoadedMode { circular_frequency: root.im, growth: root.re })
            .collect();
        modes.sort_by(|a, b| a.circular_frequency.total_cmp(&b.circular_frequency));
        Ok(modes)
    }

    /// All rates at a state.
    fn all_rates(&self, state: &State) -> Result<Vec<f64>, StepError> {
        let mut e = self.evaluation();
        e.place_mut().copy_from_slice(&state.values);
        self.rates([state.time; 2], &self.frame(state), &mut e).map_err(|error| error.in_step(state.time, 0.0))?;
        self.add_linear(&mut e);
        Ok(e.rates().to_vec())
    }
}
