//! Krogstad's fourth-order exponential Runge–Kutta (ETD-RK4): the modes' own motion exactly, the rest by four stages.
//!
//! With φ_k of hL and, where marked (½), of hL/2:
//!
//! ```text
//! a21 = ½φ1(½)     a31 = ½φ1(½) − φ2(½),  a32 = φ2(½)     a41 = φ1 − 2φ2,  a43 = 2φ2
//! b1 = φ1 − 3φ2 + 4φ3     b2 = b3 = 2φ2 − 4φ3     b4 = 4φ3 − φ2
//! ```

use nalgebra::{Matrix2, Vector2};

use crate::phi::{Phis, oscillator_phis};

/// The 2×2 blocks of one mode for one step, h included.
#[derive(Debug, Clone, Copy)]
pub(crate) struct ModeBlocks {
    pub half: Matrix2<f64>,
    pub full: Matrix2<f64>,
    pub a21: Matrix2<f64>,
    pub a31: Matrix2<f64>,
    pub a32: Matrix2<f64>,
    pub a41: Matrix2<f64>,
    pub a43: Matrix2<f64>,
    pub b1: Matrix2<f64>,
    pub b2: Matrix2<f64>,
    pub b4: Matrix2<f64>,
}

/// The blocks of all modes for one step.
#[derive(Debug, Clone)]
pub(crate) struct StepBlocks {
    pub step: f64,
    pub modes: Vec<ModeBlocks>,
}

impl StepBlocks {
    pub(crate) fn new(circular_frequencies: &[f64], damping_ratios: &[f64], h: f64) -> Self {
        let blocks = |omega: f64, zeta: f64| {
            let [half, half_1, half_2, _]: Phis = oscillator_phis(omega, zeta, 0.5 * h);
            let [full, phi_1, phi_2, phi_3]: Phis = oscillator_phis(omega, zeta, h);
            ModeBlocks {
                half,
                full,
                a21: half_1 * (0.5 * h),
                a31: (half_1 * 0.5 - half_2) * h,
                a32: half_2 * h,
                a41: (phi_1 - phi_2 * 2.0) * h,
                a43: phi_2 * (2.0 * h),
                b1: (phi_1 - phi_2 * 3.0 + phi_3 * 4.0) * h,
                b2: (phi_2 * 2.0 - phi_3 * 4.0) * h,
                b4: (phi_3 * 4.0 - phi_2) * h,
            }
        };
        let modes =
            circular_frequencies.iter().zip(damping_ratios).map(|(omega, zeta)| blocks(*omega, *zeta)).collect();
        Self { step: h, modes }
    }
}

/// Blocks of the steps that have been taken lately, so that a step that comes back costs nothing.
#[derive(Debug, Clone, Default)]
pub(crate) struct BlockStore {
    stored: Vec<StepBlocks>,
}

impl BlockStore {
    /// More different steps than this are rare even under step control, which halves and doubles.
    const MOST: usize = 64;

    /// The blocks for step `h`.
    pub(crate) fn get(&mut self, circular_frequencies: &[f64], damping_ratios: &[f64], h: f64) -> &StepBlocks {
        match self.stored.iter().position(|blocks| blocks.step == h) {
            Some(0) => {}
            Some(place) => self.stored[..=place].rotate_right(1),
            None => {
                self.stored.truncate(Self::MOST - 1);
                self.stored.insert(0, StepBlocks::new(circular_frequencies, damping_ratios, h));
            }
        }
        &self.stored[0]
    }
}

/// Applies a block to the pair (q, p) of a mode.
pub(crate) fn apply(block: &Matrix2<f64>, pair: Vector2<f64>) -> Vector2<f64> {
    block * pair
}
