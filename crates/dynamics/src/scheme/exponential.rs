//! Krogstad's fourth-order exponential Runge–Kutta (ETD-RK4): the modes' own motion exactly, the rest by four stages.
//!
//! With φ_k of hL and, where marked (½), of hL/2:
//!
//! ```text
//! a21 = ½φ1(½)     a31 = ½φ1(½) − φ2(½),  a32 = φ2(½)     a41 = φ1 − 2φ2,  a43 = 2φ2
//! b1 = φ1 − 3φ2 + 4φ3     b2 = b3 = 2φ2 − 4φ3     b4 = 4φ3 − φ2
//! ```

use nalgebra::Matrix2;
use pulp::{Arch, Simd, WithSimd};

use crate::matrix::four::{Four, Group, WIDTH};
use crate::scheme::phi::{Phis, oscillator_phis};

/// A 2×2 block for each mode: what (q, p) of the mode give q and p. For each four modes, what q gives q, p gives q, q gives
/// p and p gives p.
#[derive(Debug, Clone)]
pub(crate) struct Blocks(Vec<[Group; 4]>);

impl Blocks {
    fn new(modes: &[Matrix2<f64>]) -> Self {
        let of_four = |modes: &[Matrix2<f64>]| {
            let entry = |lane: usize, at: (usize, usize)| modes.get(lane).map_or(0.0, |block| block[at]);
            [(0, 0), (0, 1), (1, 0), (1, 1)].map(|at| std::array::from_fn(|lane| entry(lane, at)))
        };
        Self(modes.chunks(WIDTH).map(of_four).collect())
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

/// q and p, a list in groups each.
pub(crate) type Pairs<'a> = [&'a [Group]; 2];

/// The sum of blocks times (q, p), mode by mode.
pub(crate) fn sum_of_blocks<const N: usize>(terms: [(&Blocks, Pairs<'_>); N], out: [&mut [Group]; 2]) {
    Arch::new().dispatch(SumOfBlocks { terms, out });
}

/// Such a sum, in the widest vectors that the processor has.
struct SumOfBlocks<'a, const N: usize> {
    terms: [(&'a Blocks, Pairs<'a>); N],
    out: [&'a mut [Group]; 2],
}

impl<const N: usize> WithSimd for SumOfBlocks<'_, N> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let Self { terms, out: [q_out, p_out] } = self;
        let groups = q_out.len();
        let p_out = &mut p_out[..groups];
        let mut lists = [([].as_slice(), [].as_slice(), [].as_slice()); N];
        for (list, (Blocks(blocks), [q, p])) in lists.iter_mut().zip(terms) {
            *list = (&blocks[..groups], &q[..groups], &p[..groups]);
        }
        for i in 0..groups {
            let [mut q_sum, mut p_sum] = [Four::splat(simd, 0.0); 2];
            for (blocks, q, p) in lists {
                let [q, p] = [Four::load(simd, &q[i]), Four::load(simd, &p[i])];
                let [q_of_q, q_of_p, p_of_q, p_of_p] = &blocks[i];
                q_sum = Four::load(simd, q_of_q).mul_add(simd, q, q_sum);
                q_sum = Four::load(simd, q_of_p).mul_add(simd, p, q_sum);
                p_sum = Four::load(simd, p_of_q).mul_add(simd, q, p_sum);
                p_sum = Four::load(simd, p_of_p).mul_add(simd, p, p_sum);
            }
            q_sum.store(&mut q_out[i]);
            p_sum.store(&mut p_out[i]);
        }
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
