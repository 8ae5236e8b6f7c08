//! Frequencies and weights of integrals over responses: dense where a response is sharp.
//!
//! The square of a response has poles at the distance of the half width from each peak. On panels that double in length away from a peak,
//! Gauss's rule with eight points is as good as rounding.

use std::f64::consts::TAU;

use faer::c64;

use crate::error::LinearError;

/// Positive points and their weights of Gauss with eight points on −1 … 1.
const GAUSS: [[f64; 2]; 4] = [
    [0.183_434_642_495_649_8, 0.362_683_783_378_362],
    [0.525_532_409_916_329, 0.313_706_645_877_887_3],
    [0.796_666_477_413_626_7, 0.222_381_034_453_374_5],
    [0.960_289_856_497_536_3, 0.101_228_536_290_376_26],
];
/// A growth below this part of the fastest pole is none, or below that of the pole itself: double poles, as rigid motions have in a spin,
/// have the root of rounding.
const NO_GROWTH: [f64; 2] = [1e-8, 1e-6];
/// A decay below this part of the pole is none.
const NO_DECAY: f64 = 1e-6;
/// Panels shorter than this part of the band's end are none.
const LEAST: f64 = 1e-14;

/// Frequencies, cycles per time, with the weights of an integral over them.
#[derive(Debug, Clone, PartialEq)]
pub struct Quadrature {
    /// Frequencies, rising.
    pub frequencies: Vec<f64>,
    /// Weights.
    pub weights: Vec<f64>,
}

impl Quadrature {
    /// The trapezoidal rule over given frequencies.
    pub fn trapezoidal(frequencies: &[f64]) -> Self {
        let n = frequencies.len();
        let at = |k: usize| frequencies[k.min(n - 1)];
        let weights = (0..n).map(|k| 0.5 * (at(k + 1) - at(k.saturating_sub(1)))).collect();
        Self { frequencies: frequencies.to_vec(), weights }
    }

    /// Over a band, for responses with these poles (rad per time) to densities that are smooth between `breaks`.
    ///
    /// # Errors
    /// [`LinearError::NotStable`] for a pole that grows, or that does not decay and is in the band.
    pub fn of_poles([start, end]: [f64; 2], breaks: &[f64], poles: &[c64]) -> Result<Self, LinearError> {
        let fastest = poles.iter().map(|pole| pole.norm()).fold(0.0, f64::max);
        for pole in poles {
            let grows = pole.re > NO_GROWTH[0] * fastest && pole.re > NO_GROWTH[1] * pole.norm();
            let lasts = pole.re > -NO_DECAY * pole.norm() || pole.norm() == 0.0;
            if grows || pole.re.is_nan() || (lasts && (start..=end).contains(&(pole.im.abs() / TAU))) {
                return Err(LinearError::NotStable { real: pole.re, imaginary: pole.im.abs() });
            }
        }
        let mut ends = vec![start, end];
        ends.extend(breaks.iter().copied().filter(|f| (start..=end).contains(f)));
        // A density by powers of the frequency is smooth on panels that are no longer than their distance from 0.
        let lowest = ends.iter().copied().filter(|f| *f > 0.0).fold(f64::INFINITY, f64::min);
        ends.extend(std::iter::successors(Some(lowest), |f| Some(2.0 * f)).take_while(|f| *f < end));
        for pole in poles {
            let (peak, half_width) = (pole.im.abs() / TAU, pole.re.abs() / TAU);
            let nearest = peak.clamp(start, end);
            let distance = half_width.hypot(peak - nearest).max(LEAST * end);
            ends.push(nearest);
            let steps = std::iter::successors(Some(distance), |step| Some(2.0 * step));
            for step in steps.take_while(|step| *step < end - start) {
                ends.extend([nearest - step, nearest + step].into_iter().filter(|f| (start..=end).contains(f)));
            }
        }
        ends.sort_by(f64::total_cmp);
        ends.dedup_by(|next, before| *next - *before <= LEAST * end);
        let (mut frequencies, mut weights) = (Vec::new(), Vec::new());
        for panel in ends.windows(2) {
            let (middle, half) = (0.5 * (panel[0] + panel[1]), 0.5 * (panel[1] - panel[0]));
            let below = GAUSS.iter().rev().map(|[x, weight]| (-x, weight));
            for (x, weight) in below.chain(GAUSS.iter().map(|[x, weight]| (*x, weight))) {
                frequencies.push(middle + half * x);
                weights.push(half * weight);
            }
        }
        Ok(Self { frequencies, weights })
    }
}
