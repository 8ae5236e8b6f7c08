//! Where the ends of joints are at the start.

use dynamics::{Marker, MotionState};
use nalgebra::{Matrix3, Vector3};
use rigid_kin::transformation_matrix;
use scene::{End, GroundMarker, MarkerAxes};

use crate::tie::body_marker::{BodyMarker, UnknownTurns};

/// An end of a joint, a spring or a bushing, at the start.
pub(crate) struct EndAtStart<'a> {
    on: Carrier<'a>,
    /// Global.
    pub position: Vector3<f64>,
    /// Columns are the axes of the body there, turned with the material, global.
    pub carrier_axes: Matrix3<f64>,
    /// Its own axis z and x, global.
    pub own_axes: Option<(Vector3<f64>, Option<Vector3<f64>>)>,
}

/// The carrier of an end.
enum Carrier<'a> {
    Ground,
    /// With the number of the body in its system.
    Body(usize, &'a BodyMarker),
}

impl<'a> EndAtStart<'a> {
    /// On a body, by its number in its system and its state.
    pub fn on_body(number: usize, marker: &'a BodyMarker, axes: Option<&MarkerAxes>, state: &MotionState) -> Self {
        let q = &state.modal_displacement;
        let arm = marker.point.position_body() + marker.point.deformation(q);
        let turned: Vector3<f64> = marker.turning.columns()[6..].iter().zip(q).map(|(turn, q)| turn * *q).sum();
        let global_from_body =
            Matrix3::from_columns(&[0, 1, 2].map(|k| state.attitude.to_global(&Vector3::ith(k, 1.0))));
        let carrier_axes = global_from_body * transformation_matrix(&-turned);
        let to_global = |axis: [f64; 3]| carrier_axes * Vector3::from(axis);
        Self {
            on: Carrier::Body(number, marker),
            position: state.origin_global + state.attitude.to_global(&arm),
            carrier_axes,
            own_axes: axes.map(|MarkerAxes { z, x }| (to_global(*z), x.map(to_global))),
        }
    }

    /// On the ground.
    pub fn on_ground(marker: &GroundMarker) -> Self {
        let axes = marker.axes.map(|MarkerAxes { z, x }| (z.into(), x.map(Into::into)));
        Self { own_axes: axes, ..Self::on_ground_at(marker.at.into()) }
    }

    /// On the ground, at a place.
    pub fn on_ground_at(position: Vector3<f64>) -> Self {
        Self { on: Carrier::Ground, position, carrier_axes: Matrix3::identity(), own_axes: None }
    }

    /// True on a body.
    pub fn is_on_body(&self) -> bool {
        matches!(self.on, Carrier::Body(..))
    }

    /// The marker with these axes, global at the start.
    pub fn marker(&self, axes: Matrix3<f64>) -> Marker {
        match self.on {
            Carrier::Ground => Marker::on_ground(self.position, axes),
            Carrier::Body(number, marker) => {
                Marker::on_flexible(number, &marker.point, &marker.turning, self.carrier_axes.transpose() * axes)
            }
        }
    }

    /// Turns that the modes do not know, with a line in global axes.
    pub fn unknown_turns(&self) -> UnknownTurns {
        match self.on {
            Carrier::Ground => UnknownTurns::None,
            Carrier::Body(_, marker) => match marker.unknown_turns {
                UnknownTurns::About(line) => UnknownTurns::About(self.carrier_axes * line),
                unknown => unknown,
            },
        }
    }
}

/// The two ends at the start, by what `body` gives of a body and a marker of it. The ground without a marker is where the other
/// end is.
pub(crate) fn both<'a>(
    between: [End; 2],
    ground: &[GroundMarker],
    body: impl Fn(usize, usize) -> EndAtStart<'a>,
) -> [EndAtStart<'a>; 2] {
    let at = |end: End, other: End| match (end, other) {
        (End::Body { body: number, marker }, _) => body(number, marker),
        (End::Ground { marker: Some(marker) }, _) => EndAtStart::on_ground(&ground[marker]),
        (End::Ground { marker: None }, End::Body { body: number, marker }) => {
            EndAtStart::on_ground_at(body(number, marker).position)
        }
        (End::Ground { marker: None }, End::Ground { .. }) => EndAtStart::on_ground_at(Vector3::zeros()),
    };
    let [first, second] = between;
    [at(first, second), at(second, first)]
}
