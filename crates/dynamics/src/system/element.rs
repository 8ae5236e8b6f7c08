//! Forces between markers: laws from outside, and those that are here.

pub(crate) mod springs;

use std::fmt;

use crate::system::marker::Marker;
use crate::system::motion::{MarkerMotion, MarkerWrench};

/// A law that puts forces on some markers by their motion.
///
/// Where the wrenches sum to no force and no moment, momenta are kept. What it does is its work, in
/// [`SystemMotion::element_work`](crate::SystemMotion::element_work).
pub trait ForceElement: fmt::Debug + Send + Sync {
    /// Its markers.
    fn markers(&self) -> &[Marker];

    /// Finds the wrench on each of its markers at a time; laws with branches are taken as they are at the time `times[1]`.
    /// `wrenches` are zero before.
    fn apply(&self, times: [f64; 2], motions: &[MarkerMotion], wrenches: &mut [MarkerWrench]);
}
