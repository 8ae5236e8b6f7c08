//! The class Motion: what a law sees.

use std::sync::Arc;

use flexframe::dynamics::{Kinematics, PointShapes};
use flexframe::nalgebra::{Matrix3, Vector3};
use numpy::{PyArray1, PyArray2};
use pyo3::prelude::*;

use crate::errors::wrong_input;
use crate::values::arrays::matrix;

/// The points of a run, by name.
pub(crate) type Points = Arc<Vec<(String, PointShapes)>>;

/// The number of a point by its name.
pub(crate) fn point_number(py: Python<'_>, points: &Points, name: &str) -> PyResult<usize> {
    points.iter().position(|(known, _)| known == name).ok_or_else(|| {
        let names: Vec<String> = points.iter().map(|(name, _)| format!("`{name}`")).collect();
        let known = if names.is_empty() { "none, since the scene names none".to_owned() } else { names.join(", ") };
        let help = "name the point under [output.points] of the scene";
        wrong_input(py, "point", &format!("`{name}`"), &format!("a point of the scene ({known})"), help)
    })
}

/// The motion of the body at one time, as a law sees it. Arrays are copies.
#[pyclass(frozen, module = "flexframe")]
pub(crate) struct Motion {
    /// Time.
    #[pyo3(get)]
    time: f64,
    body_from_global: Matrix3<f64>,
    origin: Vector3<f64>,
    origin_velocity: Vector3<f64>,
    omega_body: Vector3<f64>,
    modal_displacement: Vec<f64>,
    modal_velocity: Vec<f64>,
    points: Points,
    /// The point that the law is for.
    point: Option<usize>,
    /// Position and velocity of each point, global components.
    of_points: Vec<[Vector3<f64>; 2]>,
}

impl Motion {
    pub(crate) fn new(now: &Kinematics<'_>, points: &Points, point: Option<usize>) -> Self {
        let of_point = |(_, shapes): &(String, PointShapes)| [now.position_global(shapes), now.velocity_global(shapes)];
        Self {
            time: now.time,
            body_from_global: *now.body_from_global,
            origin: now.origin_global,
            origin_velocity: now.origin_velocity_global,
            omega_body: now.omega_body,
            modal_displacement: now.modal_displacement().to_vec(),
            modal_velocity: now.modal_velocity().to_vec(),
            points: points.clone(),
            point,
            of_points: points.iter().map(of_point).collect(),
        }
    }

    fn of_point<'py>(&self, py: Python<'py>, name: Option<&str>, which: usize) -> PyResult<Bound<'py, PyArray1<f64>>> {
        let point = match (name, self.point) {
            (Some(name), _) => point_number(py, &self.points, name)?,
            (None, Some(point)) => point,
            (None, None) => {
                let help = "name a point under [output.points] of the scene";
                return Err(wrong_input(py, "point", "no name", "the name of a point, for this law is at none", help));
            }
        };
        Ok(PyArray1::from_slice(py, self.of_points[point][which].as_slice()))
    }
}

#[pymethods]
impl Motion {
    /// Matrix that takes body components to global ones (3x3).
    #[getter]
    fn rotation<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray2<f64>> {
        matrix(py, &self.body_from_global.transpose())
    }

    /// Position of the origin of the body frame, global (3).
    #[getter]
    fn origin<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        PyArray1::from_slice(py, self.origin.as_slice())
    }

    /// Its velocity, global (3).
    #[getter]
    fn origin_velocity<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        PyArray1::from_slice(py, self.origin_velocity.as_slice())
    }

    /// Angular velocity of the body frame, body axes (3).
    #[getter]
    fn angular_velocity<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        PyArray1::from_slice(py, self.omega_body.as_slice())
    }

    /// Coordinates of the flexible modes and static shapes (nf).
    #[getter]
    fn modal_displacement<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        PyArray1::from_slice(py, &self.modal_displacement)
    }

    /// Their rates (nf).
    #[getter]
    fn modal_velocity<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        PyArray1::from_slice(py, &self.modal_velocity)
    }

    /// Position of a point of the scene, global (3); of that of the force, if none is named.
    #[pyo3(signature = (point=None))]
    fn position<'py>(&self, py: Python<'py>, point: Option<&str>) -> PyResult<Bound<'py, PyArray1<f64>>> {
        self.of_point(py, point, 0)
    }

    /// Velocity of a point of the scene, global (3); of that of the force, if none is named.
    #[pyo3(signature = (point=None))]
    fn velocity<'py>(&self, py: Python<'py>, point: Option<&str>) -> PyResult<Bound<'py, PyArray1<f64>>> {
        self.of_point(py, point, 1)
    }

    fn __repr__(&self) -> String {
        format!("Motion(time {})", self.time)
    }
}
