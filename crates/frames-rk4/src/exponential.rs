//! Krogstad's fourth-order exponential Runge–Kutta (ETD-RK4): the modes' own motion exactly, the rest by four stages.
//!
//! With φ_k of hL and, where marked (½), of hL/2:
//!
//! ```text
//! a21 = ½φ1(½)     a31 = ½φ1(½) − φ2(½),  a32 = φ2(½)     a41 = φ1 − 2φ2,  a43 = 2φ2
//! b1 = φ1 − 3φ2 + 4φ3     b2 = b3 = 2φ2 − 4φ3     b4 = 4φ3 − φ2
//! ```

use nalgebra::Matrix2;
use pulp::{Arch, Simd, WithSimd, bytemuck};

use crate::phi::{Phis, oscillator_phis};

/// A 2×2 block for each mode, entry by entry: what (q, p) of the mode give q and p.
#[derive(Debug, Clone)]
pub(crate) struct Blocks {
    q_of_q: Vec<f64>,
    q_of_p: Vec<f64>,
    p_of_q: Vec<f64>,
    p_of_p: Vec<f64>,
}

impl Blocks {
    fn new(modes: &[Matrix2<f64>]) -> Self {
        let [q_of_q, q_of_p, p_of_q, p_of_p] =
            [(0, 0), (0, 1), (1, 0), (1, 1)].map(|entry| modes.iter().map(|block| block[entry]).collect());
        Self { q_of_q, q_of_p, p_of_q, p_of_p }
    }
}

/// The blocks of all modes for one step, h included.
#[derive(Debug, Clone)]
pub(crate) struct StepBlocks {
    pub step: f64,
    pub half: Blocks,
    pub full: Blocks,
    pub a21: Blocks,
    pub a31: Blocks,
    pub a32: Blocks,
    pub a41: Blocks,
    pub a43: Blocks,
    pub b1: Blocks,
    pub b2: Blocks,
    pub b4: Blocks,
}

impl StepBlocks {
    pub(crate) fn new(circular_frequencies: &[f64], damping_ratios: &[f64], h: f64) -> Self {
        let phis = |h: f64| -> Vec<Phis> {
            let modes = circular_frequencies.iter().zip(damping_ratios);
            modes.map(|(omega, zeta)| oscillator_phis(*omega, *zeta, h)).collect()
        };
        let (of_half, of_full) = (phis(0.5 * h), phis(h));
        let from = |phis: &[Phis], block: fn(&Phis) -> Matrix2<f64>, factor: f64| {
            Blocks::new(&phis.iter().map(|phis| block(phis) * factor).collect::<Vec<_>>())
        };
        Self {
            step: h,
            half: from(&of_half, |phi| phi[0], 1.0),
            full: from(&of_full, |phi| phi[0], 1.0),
            a21: from(&of_half, |phi| phi[1], 0.5 * h),
            a31: from(&of_half, |phi| phi[1] * 0.5 - phi[2], h),
            a32: from(&of_half, |phi| phi[2], h),
            a41: from(&of_full, |phi| phi[1] - phi[2] * 2.0, h),
            a43: from(&of_full, |phi| phi[2], 2.0 * h),
            b1: from(&of_full, |phi| phi[1] - phi[2] * 3.0 + phi[3] * 4.0, h),
            b2: from(&of_full, |phi| phi[2] * 2.0 - phi[3] * 4.0, h),
            b4: from(&of_full, |phi| phi[3] * 4.0 - phi[2], h),
        }
    }
}

/// q and p, a list each.
pub(crate) type Pairs<'a> = [&'a [f64]; 2];

/// The sum of blocks times (q, p), mode by mode.
pub(crate) fn sum_of_blocks<const N: usize>(terms: [(&Blocks, Pairs<'_>); N], out: [&mut [f64]; 2]) {
    Arch::new().dispatch(SumOfBlocks { terms, out });
}

/// Such a sum, in the widest vectors that the processor has.
struct SumOfBlocks<'a, const N: usize> {
    terms: [(&'a Blocks, Pairs<'a>); N],
    out: [&'a mut [f64]; 2],
}

impl<const N: usize> WithSimd for SumOfBlocks<'_, N> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let Self { terms, out: [q, p] } = self;
        let length = q.len();
        let Some(last) = length.checked_sub(S::F64_LANES) else {
            for k in 0..length {
                let sums = sum_at(simd, &terms, |list| simd.splat_f64s(list[k]));
                [q[k], p[k]] = sums.map(|sum| bytemuck::cast_slice(&[sum])[0]);
            }
            return;
        };
        // The last vector ends with the last mode, and has modes of the one before once more.
        let mut first = 0;
        while first < length {
            let at = first.min(last)..first.min(last) + S::F64_LANES;
            let sums = sum_at(simd, &terms, |list| S::as_simd_f64s(&list[at.clone()]).0[0]);
            S::as_mut_simd_f64s(&mut q[at.clone()]).0[0] = sums[0];
            S::as_mut_simd_f64s(&mut p[at]).0[0] = sums[1];
            first += S::F64_LANES;
        }
    }
}

/// The sum for the modes that are loaded.
#[inline(always)]
fn sum_at<S: Simd>(simd: S, terms: &[(&Blocks, Pairs<'_>)], load: impl Fn(&[f64]) -> S::f64s) -> [S::f64s; 2] {
    let [mut q_sum, mut p_sum] = [simd.splat_f64s(0.0); 2];
    for (block, [q, p]) in terms {
        let (q, p) = (load(q), load(p));
        q_sum = simd.mul_add_e_f64s(load(&block.q_of_q), q, q_sum);
        q_sum = simd.mul_add_e_f64s(load(&block.q_of_p), p, q_sum);
        p_sum = simd.mul_add_e_f64s(load(&block.p_of_q), q, p_sum);
        p_sum = simd.mul_add_e_f64s(load(&block.p_of_p), p, p_sum);
    }
    [q_sum, p_sum]
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
