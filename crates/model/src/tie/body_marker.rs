//! Places with axes on a reduced body.

use dynamics::{Manifold, PointShapes, RotationShapes};
use faer::Mat;
use nalgebra::{Matrix3, Vector3};
use reduced_body::{BodyPoint, ReducedBody};
use scene::{Body, Constraint, Marker, MarkerAxes, MarkerPlace};

use crate::error::BuildError;
use crate::tie::warp::Warp;

/// A place with axes on a reduced body.
#[derive(Debug, Clone)]
pub struct BodyMarker {
    /// Its name among the markers of its body.
    pub name: String,
    /// How the modes move it.
    pub point: PointShapes,
    /// How the modes turn it.
    pub turning: RotationShapes,
    /// Where the ends of its joints are several places: these. The marker is then their mean.
    pub parts: Vec<MarkerPart>,
    /// True if each part is a node, which has no turn.
    pub by_nodes: bool,
    /// How its faces warp, where it is their mean on a body that deforms.
    pub warp: Option<Warp>,
    /// Its axes as columns, body axes: those of the body where it names none.
    pub axes: Matrix3<f64>,
    /// Turns of the material there that the modes do not know.
    pub unknown_turns: UnknownTurns,
}

/// One of the places of a marker.
#[derive(Debug, Clone)]
pub struct MarkerPart {
    /// How the modes move it.
    pub point: PointShapes,
    /// How the modes turn it; not at all where it is a node.
    pub turning: RotationShapes,
}

/// The marker of a system at a place of a body, by its number there, with these axes as columns, body axes.
pub(crate) fn carried(
    number: usize,
    manifold: Option<&Manifold>,
    (point, turning): (&PointShapes, &RotationShapes),
    axes: Matrix3<f64>,
) -> dynamics::Marker {
    match manifold {
        Some(manifold) => dynamics::Marker::on_bent(number, manifold, point, turning, axes),
        None => dynamics::Marker::on_flexible(number, point, turning, axes),
    }
}

/// Turns at a marker that its nodes do not tell.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum UnknownTurns {
    /// None: its nodes span a surface, or its body is rigid.
    None,
    /// Turns about the line that its nodes are on: a unit vector, body axes.
    About(Vector3<f64>),
    /// All: it is one node that has no rotation.
    All,
}

/// The axes of a marker as columns, mesh axes, with `x` at right angles to z where it names none; the axes of the body
/// without any.
pub(crate) fn axes(axes: Option<&MarkerAxes>) -> Matrix3<f64> {
    let Some(MarkerAxes { z, x }) = axes else { return Matrix3::identity() };
    let z = Vector3::from(*z);
    let x = x.map_or_else(|| perpendicular(&z), Vector3::from);
    Matrix3::from_columns(&[x, z.cross(&x), z])
}

/// A unit vector at right angles to another: the nearest to the coordinate axis that is the farthest from it.
pub(crate) fn perpendicular(z: &Vector3<f64>) -> Vector3<f64> {
    let axis = Vector3::ith(z.iamin(), 1.0);
    (axis - z * z.dot(&axis)).normalize()
}

/// The markers of a rigid body without a mesh.
pub(crate) fn on_rigid(body: &Body, reduced: &ReducedBody) -> Result<Vec<BodyMarker>, BuildError> {
    let on_body = |marker: &Marker| {
        let at = match &marker.place {
            MarkerPlace::Point(at) => *at,
            MarkerPlace::Held { constraint: Constraint::Pin { at, .. }, .. } => *at,
            MarkerPlace::Held { constraint: Constraint::Hinge { line, .. }, .. } => line.at(),
            MarkerPlace::Held { constraint: Constraint::Slider { .. }, .. } => reduced.center_of_mass.into(),
            MarkerPlace::Held { .. } | MarkerPlace::Region(_) => {
                let help = "give it a point, `at = [x, y, z]`";
                let (found, expected) = ("a part of a mesh", "none, since the body has no mesh");
                return Err(body.refuse(&marker.key(), found, expected, help).into());
            }
        };
        let point = BodyPoint { position_body: Vector3::from(at) - reduced.origin, shapes: Mat::zeros(3, 0) };
        Ok(BodyMarker {
            name: marker.name.clone(),
            point: PointShapes::new(reduced, &point),
            turning: RotationShapes::new(reduced, Mat::zeros(3, 0).as_ref()),
            parts: Vec::new(),
            by_nodes: false,
            warp: None,
            axes: axes(marker.axes.as_ref()),
            unknown_turns: UnknownTurns::None,
        })
    };
    body.markers.iter().map(on_body).collect()
}
