//! Where the ends of joints are at the start.

use dynamics::{Manifold, Marker, MotionState, PointShapes};
use nalgebra::{Matrix3, Vector3};
use scene::{End, GroundMarker, MarkerAxes};

use crate::model::Model;
use crate::tie::body_marker::{BodyMarker, MarkerPart, UnknownTurns, carried};

/// An end of a joint, a spring or a bushing, at the start.
pub(crate) struct EndAtStart<'a> {
    on: Carrier<'a>,
    /// Global.
    pub position: Vector3<f64>,
    /// Columns are the axes of the body there, turned with the material, global.
    pub carrier_axes: Matrix3<f64>,
    /// Its own axis z and x, global.
    pub own_axes: Option<(Vector3<f64>, Option<Vector3<f64>>)>,
    /// Columns are the axes of the body, global.
    global_from_body: Matrix3<f64>,
    /// Displacements of the shapes of the body.
    xi: Vec<f64>,
}

/// The carrier of an end.
enum Carrier<'a> {
    Ground,
    /// With the number of the body in its system, and its manifold with large modes.
    Body(usize, &'a BodyMarker, Option<&'a Manifold>),
}

impl<'a> EndAtStart<'a> {
    /// At a marker of a body, by the numbers of both, of the body in its system, and its state.
    pub fn on_body(
        (number, model): (usize, &'a Model),
        marker: usize,
        axes: Option<&MarkerAxes>,
        state: &MotionState,
    ) -> Self {
        let marker = &model.markers[marker];
        let xi = model.coordinates(&state.modal_displacement);
        let arm = marker.point.position_body() + marker.point.deformation(&xi);
        let global_from_body =
            Matrix3::from_columns(&[0, 1, 2].map(|k| state.attitude.to_global(&Vector3::ith(k, 1.0))));
        let carrier_axes = global_from_body * marker.turning.rotation(&xi);
        let to_global = |axis: [f64; 3]| carrier_axes * Vector3::from(axis);
        Self {
            on: Carrier::Body(number, marker, model.physics.large_deflection.as_ref()),
            position: state.origin_global + state.attitude.to_global(&arm),
            carrier_axes,
            own_axes: axes.map(|MarkerAxes { z, x }| (to_global(*z), x.map(to_global))),
            global_from_body,
            xi,
        }
    }

    /// On the ground.
    pub fn on_ground(marker: &GroundMarker) -> Self {
        let axes = marker.axes.map(|MarkerAxes { z, x }| (z.into(), x.map(Into::into)));
        Self { own_axes: axes, ..Self::on_ground_at(marker.at.into()) }
    }

    /// On the ground, at a place.
    pub fn on_ground_at(position: Vector3<f64>) -> Self {
        let axes = Matrix3::identity();
        let (own_axes, xi) = (None, Vec::new());
        Self { on: Carrier::Ground, position, carrier_axes: axes, own_axes, global_from_body: axes, xi }
    }

    /// True on a body.
    pub fn is_on_body(&self) -> bool {
        matches!(self.on, Carrier::Body(..))
    }

    /// The marker with these axes, global at the start.
    pub fn marker(&self, axes: Matrix3<f64>) -> Marker {
        match self.on {
            Carrier::Ground => Marker::on_ground(self.position, axes),
            Carrier::Body(number, BodyMarker { point, turning, .. }, manifold) => {
                carried(number, manifold, (point, turning), self.carrier_axes.transpose() * axes)
            }
        }
    }

    /// The places of its parts, global; none where it is one place.
    pub fn part_positions(&self) -> Vec<Vector3<f64>> {
        let Carrier::Body(_, marker, _) = self.on else { return Vec::new() };
        let here = self.arm_of(&marker.point);
        let of_part = |part: &MarkerPart| self.position + self.global_from_body * (self.arm_of(&part.point) - here);
        marker.parts.iter().map(of_part).collect()
    }

    /// The marker of a part, with these axes, global at the start.
    pub fn part_marker(&self, part: usize, axes: Matrix3<f64>) -> Option<Marker> {
        let Carrier::Body(number, marker, manifold) = self.on else { return None };
        let MarkerPart { point, turning } = marker.parts.get(part)?;
        let axes_there = self.global_from_body * turning.rotation(&self.xi);
        Some(carried(number, manifold, (point, turning), axes_there.transpose() * axes))
    }

    /// The marker with these axes at another place, both global at the start, of the ground or a body that does not deform.
    pub fn rigid_marker(&self, at: Vector3<f64>, axes: Matrix3<f64>) -> Option<Marker> {
        match self.on {
            Carrier::Ground => Some(Marker::on_ground(at, axes)),
            Carrier::Body(number, marker, _) if self.xi.is_empty() => {
                let arm = marker.point.position_body() + self.global_from_body.tr_mul(&(at - self.position));
                Some(Marker::on_rigid(number, arm, self.global_from_body.transpose() * axes))
            }
            Carrier::Body(..) => None,
        }
    }

    /// True if its parts are nodes.
    pub fn is_by_nodes(&self) -> bool {
        matches!(self.on, Carrier::Body(_, marker, _) if marker.by_nodes)
    }

    fn arm_of(&self, point: &PointShapes) -> Vector3<f64> {
        point.position_body() + point.deformation(&self.xi)
    }

    /// Turns that the modes do not know, with a line in global axes.
    pub fn unknown_turns(&self) -> UnknownTurns {
        match self.on {
            Carrier::Ground => UnknownTurns::None,
            Carrier::Body(_, marker, _) => match marker.unknown_turns {
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
