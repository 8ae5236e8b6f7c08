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

use crate::equations::{Evaluation, Oscillators};
use crate::error::StepError;
use crate::matrix::four::{Four, Group, WIDTH};
use crate::scheme::phi::{Phis, oscillator_phis};
use crate::scheme::{Scheme, Step};

/// Krogstad's ETD-RK4: the oscillators exactly, the rest by four stages; order 4, no limit from the oscillators.
#[derive(Debug, Clone)]
pub struct Exponential<E: Oscillators> {
    /// The stages after the first.
    stages: [E::Evaluation; 3],
    blocks: BlockStore,
}

impl<E: Oscillators> Exponential<E> {
    /// Room for its stages.
    pub fn new(equations: &E) -> Self {
        Self { stages: std::array::from_fn(|_| equations.evaluation()), blocks: BlockStore::default() }
    }
}

impl<E: Oscillators> Scheme<E> for Exponential<E> {
    const ORDER: u32 = 4;
    const LINEAR_PART_IS_EXACT: bool = true;

    fn step(&mut self, step: &mut Step<'_, E>, next: &mut [f64]) -> Result<(), StepError> {
        let Self { stages: [second, third, fourth], blocks } = self;
        let Step { equations, from, first, length: h, .. } = *step;
        let first_modes = equations.first_modes();
        let others = ..first_modes[0];
        let groups = |list| groups_of(list, first_modes);
        let block = blocks.get(equations.circular_frequencies(), equations.damping_ratios(), h);
        let (start, of_first) = (groups(&from.values), groups(first.rates()));

        add(&from.values[others], 0.5 * h, &first.rates()[others], &mut second.place_mut()[others]);
        let out = groups_of_mut(second.place_mut(), first_modes);
        sum_of_blocks([(&block.half, start), (&block.a21, of_first)], out);
        step.evaluate(from.time + 0.5 * h, second)?;

        add(&from.values[others], 0.5 * h, &second.rates()[others], &mut third.place_mut()[others]);
        let out = groups_of_mut(third.place_mut(), first_modes);
        let of_second = groups(second.rates());
        sum_of_blocks([(&block.half, start), (&block.a31, of_first), (&block.a32, of_second)], out);
        step.evaluate(from.time + 0.5 * h, third)?;

        add(&from.values[others], h, &third.rates()[others], &mut fourth.place_mut()[others]);
        let out = groups_of_mut(fourth.place_mut(), first_modes);
        let of_third = groups(third.rates());
        sum_of_blocks([(&block.full, start), (&block.a41, of_first), (&block.a43, of_third)], out);
        step.evaluate(from.time + h, fourth)?;

        let rates = [first.rates(), second.rates(), third.rates(), fourth.rates()];
        let [k1, k2, k3, k4] = rates.map(|rates| &rates[others]);
        for (i, (next, from)) in next[others].iter_mut().zip(&from.values).enumerate() {
            *next = from + (k1[i] + (k2[i] + k3[i]) * 2.0 + k4[i]) * (h / 6.0);
        }
        let [n1, n2, n3, n4] = rates.map(groups);
        let terms = [(&block.full, start), (&block.b1, n1), (&block.b2, n2), (&block.b2, n3), (&block.b4, n4)];
        sum_of_blocks(terms, groups_of_mut(next, first_modes));
        Ok(())
    }
}

/// q and p of a list, in groups.
fn groups_of(list: &[f64], [q, p]: [usize; 2]) -> Pairs<'_> {
    [list[q..p].as_chunks().0, list[p..].as_chunks().0]
}

fn groups_of_mut(list: &mut [f64], [first_q, first_p]: [usize; 2]) -> [&mut [Group]; 2] {
    let (q, p) = list.split_at_mut(first_p);
    [q[first_q..].as_chunks_mut().0, p.as_chunks_mut().0]
}

/// out = x + c·y
fn add(x: &[f64], c: f64, y: &[f64], out: &mut [f64]) {
    for ((out, x), y) in out.iter_mut().zip(x).zip(y) {
        *out = x + y * c;
    }
}

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
