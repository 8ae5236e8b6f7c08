//! The numbers of a body in the conservative form, in a list of a state, of a place or of rates.

use nalgebra::Vector3;
use rigid_kin::Attitude;

use crate::matrix::four::{Group, WIDTH};
use crate::state::{Layout, Rotation, attitude_at};

/// Numbers beside the attitude and the modes: see [`part`].
pub(crate) type Slow = [f64; 20];

/// First entries of the parts of [`Slow`].
pub(crate) mod part {
    /// Rotation vector since the start of the step, body axes.
    pub const THETA: usize = 0;
    /// Position of the origin, global.
    pub const POSITION: usize = 3;
    /// Linear momentum P of the motion of the origin, global: of a free body, that of the body.
    pub const MOMENTUM: usize = 6;
    /// Angular momentum π about the origin, one component for each axis of rotation: the three body axes, or the axis of a
    /// hinge first.
    pub const PI: usize = 9;
    /// Work of the loads, and of what drives the body.
    pub const WORK: usize = 12;
    /// Energy that damping has taken.
    pub const DISSIPATION: usize = 13;
    /// Angular impulse of the loads about the origin, global.
    pub const ANGULAR_IMPULSE: usize = 14;
    /// Impulse of the loads, global.
    pub const IMPULSE: usize = 17;
}

pub(crate) fn get(slow: &Slow, first: usize) -> Vector3<f64> {
    Vector3::new(slow[first], slow[first + 1], slow[first + 2])
}

pub(crate) fn set(slow: &mut Slow, first: usize, value: &Vector3<f64>) {
    slow[first..first + 3].copy_from_slice(value.as_slice());
}

const ATTITUDE: usize = 0;
const ANGLE: usize = WIDTH;
/// First place of [`Slow`].
pub(crate) const SLOW: usize = 2 * WIDTH;
const MODES: usize = SLOW + 20;

/// The layout of a body with these axes of rotation.
pub(super) fn layout(axes: &[Vector3<f64>], flexible: usize) -> Layout {
    let mut layout = Layout::default();
    let attitude = layout.add("the attitude", 4);
    let angle = layout.add("the hinge angle", 1);
    let slow = layout.add("a momentum, the position or the work", 20);
    let q = layout.add("a modal coordinate", flexible);
    layout.add("a modal coordinate", flexible);
    debug_assert_eq!([attitude, angle, slow, q], [ATTITUDE, ANGLE, SLOW, MODES]);
    let angle = match axes {
        [axis] => Some((angle, *axis)),
        _ => None,
    };
    layout.rotate(Rotation { attitude, vector: slow + part::THETA, angle });
    layout
}

/// First places of q and p.
pub(super) fn first_modes(flexible: usize) -> [usize; 2] {
    [MODES, MODES + flexible.next_multiple_of(WIDTH)]
}

/// The list of a body: [w, x, y, z] of the attitude, the hinge angle, [`Slow`], q and p.
#[derive(Debug, Clone, Copy)]
pub(crate) struct BodyList<V> {
    pub values: V,
    pub flexible: usize,
}

impl<V: AsRef<[f64]>> BodyList<V> {
    /// Attitude of the body frame.
    pub fn attitude(&self) -> Attitude {
        attitude_at(self.values.as_ref(), ATTITUDE)
    }

    /// Angle about the axis of a hinge since the beginning, rad.
    pub fn hinge_angle(&self) -> f64 {
        self.values.as_ref()[ANGLE]
    }

    #[inline(always)]
    pub fn slow(&self) -> &Slow {
        // The length of the list is that of its layout.
        self.values.as_ref()[SLOW..].first_chunk().unwrap_or(&[0.0; 20])
    }

    /// Modal displacements q (nf).
    #[inline(always)]
    pub fn q(&self) -> &[f64] {
        &self.values.as_ref()[MODES..MODES + self.flexible]
    }

    /// Modal momenta p (nf).
    #[inline(always)]
    pub fn p(&self) -> &[f64] {
        let first = MODES + self.flexible.next_multiple_of(WIDTH);
        &self.values.as_ref()[first..first + self.flexible]
    }

    /// q and p in groups.
    #[inline(always)]
    pub fn groups(&self) -> [&[Group]; 2] {
        let (groups, _) = self.values.as_ref()[MODES..].as_chunks();
        let (q, p) = groups.split_at(self.flexible.div_ceil(WIDTH));
        [q, p]
    }
}

impl<V: AsMut<[f64]>> BodyList<V> {
    pub fn set_attitude(&mut self, attitude: Attitude) {
        self.values.as_mut()[ATTITUDE..ATTITUDE + 4].copy_from_slice(&attitude.wxyz());
    }

    /// Changes the numbers beside the attitude and the modes.
    #[inline(always)]
    pub fn set_slow(&mut self, slow: &Slow) {
        self.values.as_mut()[SLOW..MODES].copy_from_slice(slow);
    }

    /// q and p (nf).
    pub fn set_modes(&mut self, q: &[f64], p: &[f64]) {
        let [own_q, own_p] = self.modes_mut();
        own_q.copy_from_slice(q);
        own_p.copy_from_slice(p);
    }

    /// q and p (nf).
    #[inline(always)]
    pub fn modes_mut(&mut self) -> [&mut [f64]; 2] {
        let (q, p) = self.values.as_mut()[MODES..].split_at_mut(self.flexible.next_multiple_of(WIDTH));
        [&mut q[..self.flexible], &mut p[..self.flexible]]
    }

    /// q and p in groups. What is written after the end has to be zero.
    #[inline(always)]
    pub fn groups_mut(&mut self) -> [&mut [Group]; 2] {
        let (groups, _) = self.values.as_mut()[MODES..].as_chunks_mut();
        let (q, p) = groups.split_at_mut(self.flexible.div_ceil(WIDTH));
        [q, p]
    }
}
