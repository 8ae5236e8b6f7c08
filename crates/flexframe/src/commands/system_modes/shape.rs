//! The shapes of the vibrations of a system on the surfaces of its bodies, for pictures.

use std::borrow::Cow;
use std::ops::Range;

use dynamics::MotionState;
use faer::c64;
use model::{BuildError, Model};
use nalgebra::Vector3;
use scene::Scene;

use super::report::SystemModes;
use crate::commands::modes::require_surface;
use crate::surface::Surface;

/// The surfaces of the bodies of a system where it stands.
pub(crate) struct SystemSurface<'a> {
    parts: Vec<Part<'a>>,
    pub(crate) triangles: Vec<[u32; 3]>,
    pub(crate) edges: Vec<[u32; 2]>,
    /// Where the points are, deformed as the loads ask.
    pub(crate) points: Vec<[f64; 3]>,
}

struct Part<'a> {
    /// Number of the body in the scene.
    number: usize,
    surface: Surface,
    /// Origin of the body frame, mesh axes.
    origin: Vector3<f64>,
    state: &'a MotionState,
    /// Displacements of its points in that state, body axes.
    bent: Vec<Vector3<f64>>,
    /// Coordinates of its shapes by its modes, where these are not the same.
    slopes: Option<Vec<Vec<f64>>>,
    /// Its place in the motion of a vibration.
    range: Range<usize>,
}

impl<'a> SystemSurface<'a> {
    /// Surfaces of the bodies of a system, with their stress if it is asked for.
    ///
    /// # Errors
    /// [`BuildError`] of a body whose surface is not known, and where the stress cannot be computed.
    pub(crate) fn new(
        scene: &Scene,
        models: &[Model],
        modes: &'a SystemModes,
        stress: bool,
    ) -> Result<Self, BuildError> {
        let mut first = 0;
        let mut made = Self { parts: Vec::new(), triangles: Vec::new(), edges: Vec::new(), points: Vec::new() };
        for (number, state) in modes.bodies.iter().zip(&modes.states) {
            let (given, model) = (&scene.bodies[*number], &models[*number]);
            let range = first..first + 6 + state.modal_displacement.len();
            first = range.end;
            if model.meshed.is_some() {
                require_surface(given)?;
            }
            let surface = if stress { Surface::with_stress(model)? } else { Surface::of_model(model) };
            let origin = Vector3::from(model.body.origin);
            let offset = u32::try_from(made.points.len()).unwrap_or(u32::MAX);
            made.triangles.extend(surface.triangles.iter().map(|corners| corners.map(|corner| corner + offset)));
            made.edges.extend(surface.edges.iter().map(|ends| ends.map(|end| end + offset)));
            let bent = surface.displacements(&model.coordinates(&state.modal_displacement));
            made.points.extend(surface.placed(&origin, &state.origin_global, &state.attitude, &bent));
            let slopes = model.coordinate_slopes(&state.modal_displacement);
            made.parts.push(Part { number: *number, surface, origin, state, bent, slopes, range });
        }
        Ok(made)
    }

    /// Number in the scene, triangles and number of points of each body that has a surface, in the order of the points.
    pub(super) fn bodies(&self) -> impl Iterator<Item = (usize, &[[u32; 3]], usize)> {
        let of_part = |part| {
            let Part { number, surface, .. }: &Part<'_> = part;
            (*number, &surface.triangles[..], surface.shapes.positions.len())
        };
        self.parts.iter().map(of_part)
    }

    /// Length of the diagonal of the box around it.
    pub(crate) fn diagonal(&self) -> f64 {
        let bound =
            |axis: usize, pick: fn(f64, f64) -> f64| self.points.iter().map(|x| x[axis]).reduce(pick).unwrap_or(0.0);
        (0..3).map(|axis| (bound(axis, f64::max) - bound(axis, f64::min)).powi(2)).sum::<f64>().sqrt()
    }

    /// Displacements of the points in a vibration, in space, when it has gone through so much of a period, as an angle.
    pub(crate) fn displacements(&self, motion: &[c64], phase: f64) -> Vec<Vector3<f64>> {
        let of_part = |part: &Part<'_>| {
            let own = part.motion(motion, phase);
            let [moved, turned] = [0, 3].map(|at| Vector3::new(own[at], own[at + 1], own[at + 2]));
            let flexible = part.surface.displacements(&part.of_shapes(&own[6..]));
            let points = part.surface.shapes.positions.iter().zip(&part.bent).zip(flexible);
            let displaced =
                points.map(|((x, bent), u)| moved + turned.cross(&(Vector3::from(*x) - part.origin + bent)) + u);
            displaced.map(|u| part.state.attitude.to_global(&u)).collect::<Vec<_>>()
        };
        self.parts.iter().flat_map(of_part).collect()
    }

    /// Von Mises stress of the vibration alone at the points.
    pub(crate) fn stress(&self, motion: &[c64], phase: f64) -> Vec<f64> {
        let of_part = |part: &Part<'_>| part.surface.von_mises(&part.of_shapes(&part.motion(motion, phase)[6..]));
        self.parts.iter().flat_map(of_part).collect()
    }
}

impl Part<'_> {
    /// The coordinates of all shapes, and of the products of large modes, by those of the modes.
    fn of_shapes<'m>(&self, modes: &'m [f64]) -> Cow<'m, [f64]> {
        let Some(slopes) = &self.slopes else { return Cow::Borrowed(modes) };
        let count = slopes.first().map_or(0, Vec::len);
        let of_shape = |i: usize| slopes.iter().zip(modes).map(|(slope, q)| slope[i] * q).sum();
        Cow::Owned((0..count).map(of_shape).collect())
    }

    /// Displacement and rotation of its frame in body axes, then its modal coordinates.
    fn motion(&self, motion: &[c64], phase: f64) -> Vec<f64> {
        let (sin, cos) = phase.sin_cos();
        motion[self.range.clone()].iter().map(|x| x.re * cos - x.im * sin).collect()
    }
}
