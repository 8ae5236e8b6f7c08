//! Four numbers side by side, in the vectors of any processor, and lists in groups of four.

use std::ops::{Deref, DerefMut};

use pulp::{Simd, bytemuck};

/// Numbers in a group.
pub(crate) const WIDTH: usize = 4;

/// Numbers that are taken side by side.
pub(crate) type Group = [f64; WIDTH];

/// A group in registers.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Four<S: Simd>([S::f64s; WIDTH]);

impl<S: Simd> Four<S> {
    /// Vectors that hold a group; the others of the array are never looked at.
    const VECTORS: usize = {
        assert!(S::F64_LANES <= WIDTH, "vectors that are wider than a group");
        WIDTH / S::F64_LANES
    };

    #[inline(always)]
    pub(crate) fn splat(simd: S, x: f64) -> Self {
        Self([simd.splat_f64s(x); WIDTH])
    }

    #[inline(always)]
    #[expect(clippy::manual_memcpy, reason = "a copy of slices would leave the registers")]
    pub(crate) fn load(simd: S, from: &Group) -> Self {
        let mut group = Self::splat(simd, 0.0);
        let (vectors, _) = S::as_simd_f64s(from);
        for i in 0..Self::VECTORS {
            group.0[i] = vectors[i];
        }
        group
    }

    #[inline(always)]
    #[expect(clippy::manual_memcpy, reason = "a copy of slices would leave the registers")]
    pub(crate) fn store(self, to: &mut Group) {
        let (vectors, _) = S::as_mut_simd_f64s(to);
        for i in 0..Self::VECTORS {
            vectors[i] = self.0[i];
        }
    }

    /// self · by + plus
    #[inline(always)]
    pub(crate) fn mul_add(self, simd: S, by: Self, plus: Self) -> Self {
        let mut out = plus;
        for i in 0..Self::VECTORS {
            out.0[i] = simd.mul_add_e_f64s(self.0[i], by.0[i], plus.0[i]);
        }
        out
    }

    #[inline(always)]
    pub(crate) fn add(self, simd: S, other: Self) -> Self {
        let mut out = self;
        for i in 0..Self::VECTORS {
            out.0[i] = simd.add_f64s(self.0[i], other.0[i]);
        }
        out
    }

    #[inline(always)]
    pub(crate) fn sub(self, simd: S, other: Self) -> Self {
        let mut out = self;
        for i in 0..Self::VECTORS {
            out.0[i] = simd.sub_f64s(self.0[i], other.0[i]);
        }
        out
    }

    #[inline(always)]
    pub(crate) fn mul(self, simd: S, other: Self) -> Self {
        let mut out = self;
        for i in 0..Self::VECTORS {
            out.0[i] = simd.mul_f64s(self.0[i], other.0[i]);
        }
        out
    }

    /// The sum of the four.
    #[inline(always)]
    pub(crate) fn sum(self) -> f64 {
        let x: &[f64] = bytemuck::cast_slice(&self.0[..Self::VECTORS]);
        (x[0] + x[2]) + (x[1] + x[3])
    }
}

/// A list in groups, the last one with zeros after the end.
#[derive(Debug, Clone, Default)]
pub(crate) struct Padded {
    groups: Vec<Group>,
    length: usize,
}

impl Padded {
    pub(crate) fn zeros(length: usize) -> Self {
        Self { groups: vec![[0.0; WIDTH]; length.div_ceil(WIDTH)], length }
    }

    pub(crate) fn from_slice(list: &[f64]) -> Self {
        let mut padded = Self::zeros(list.len());
        padded.copy_from_slice(list);
        padded
    }

    pub(crate) fn groups(&self) -> &[Group] {
        &self.groups
    }

    /// Numbers after the end have to be zero.
    pub(crate) fn groups_mut(&mut self) -> &mut [Group] {
        &mut self.groups
    }
}

impl Deref for Padded {
    type Target = [f64];

    #[inline(always)]
    fn deref(&self) -> &[f64] {
        &self.groups.as_flattened()[..self.length]
    }
}

impl DerefMut for Padded {
    #[inline(always)]
    fn deref_mut(&mut self) -> &mut [f64] {
        &mut self.groups.as_flattened_mut()[..self.length]
    }
}

/// True if all are finite numbers.
pub(crate) fn all_finite(list: &[f64]) -> bool {
    let (groups, rest) = list.as_chunks::<8>();
    let mut zeros = [0.0; 8];
    for group in groups {
        for (zero, x) in zeros.iter_mut().zip(group) {
            // 0·x = 0 only for finite x.
            *zero += x * 0.0;
        }
    }
    zeros.iter().all(|zero| *zero == 0.0) && rest.iter().all(|x| x.is_finite())
}
