//! Accelerations of the base of a held body as inputs, Eq. (F10).

use linear::Channel;
use scene::Body;

use crate::commands::linear::linearize::channels::along_axes;
use crate::rows::units::UnitLabels;

/// The motions of a base: translations along the axes of the body, then turns about them through its origin.
pub(super) fn base_channels(body: &Body) -> Vec<Channel> {
    let UnitLabels { length, time, .. } = (&body.units).into();
    let translations = along_axes("base.acceleration", &format!("{length}/{time}²"));
    translations.into_iter().chain(along_axes("base.angular_acceleration", &format!("rad/{time}²"))).collect()
}
