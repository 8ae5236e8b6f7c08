//! The class Body.

use std::sync::Arc;

use flexframe::faer::{ColRef, MatRef};
use flexframe::report::BodyReport;
use flexframe::scene::{Meshed, Model};
use numpy::ndarray::ArrayView1;
use numpy::{IntoPyArray, PyArray1, PyArray2, PyArray3, PyArrayMethods};
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::arrays::{fields, table, view};
use crate::constants::constants;
use crate::errors::{exception, wrong_input};
use crate::interrupt::{Stop, interruptible};
use crate::numbers::numbers;
use crate::scene::Scene;

/// A body that can move: its mesh, its modes and the constants of its motion.
#[pyclass(frozen, module = "flexframe")]
pub(crate) struct Body {
    scene: Py<Scene>,
    model: Arc<Model>,
}

impl Body {
    pub(crate) fn model(&self) -> &Arc<Model> {
        &self.model
    }

    pub(crate) fn scene_of(&self) -> &Arc<flexframe::scene::Scene> {
        self.scene.get().scene()
    }

    fn meshed(&self, py: Python<'_>) -> PyResult<&Meshed> {
        self.model.meshed.as_ref().ok_or_else(|| {
            let cure = "ask for what needs a mesh of a body that has one";
            wrong_input(py, "body", "a rigid body", "a body with a mesh", cure)
        })
    }

    /// Fields over the nodes of the mesh.
    fn of_nodes<'py>(
        &self,
        py: Python<'py>,
        select: fn(&Meshed) -> MatRef<'_, f64>,
    ) -> PyResult<Bound<'py, PyArray3<f64>>> {
        self.meshed(py)?;
        view(py, &self.model, |model| match &model.meshed {
            Some(meshed) => fields(select(meshed), meshed.mesh.positions().len()),
            None => fields(MatRef::from_column_major_slice(&[], 0, 0), 0),
        })
    }
}

#[pymethods]
impl Body {
    #[new]
    fn new(py: Python<'_>, scene: Py<Scene>) -> PyResult<Self> {
        let stop = Stop::default();
        let (told, of_thread) = (stop.clone(), scene.get().scene().clone());
        let build = move || Model::build(&of_thread, |_| told.check());
        // A factorization cannot be stopped in its midst, and nobody is to wait for it.
        let (model, raised) = interruptible(py, &stop, || false, build)?;
        match (raised, model) {
            (Some(error), _) => Err(error),
            (None, Ok(model)) => Ok(Self { scene, model: Arc::new(model) }),
            (None, Err(error)) => Err(exception(py, &error)),
        }
    }

    #[getter]
    fn scene(&self, py: Python<'_>) -> Py<Scene> {
        self.scene.clone_ref(py)
    }

    #[getter]
    fn mass(&self) -> f64 {
        self.model.body.mass
    }

    #[getter]
    fn center_of_mass<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray1<f64>>> {
        view(py, &self.model, |model| ArrayView1::from(model.body.center_of_mass.as_slice()))
    }

    #[getter]
    fn inertia<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray2<f64>> {
        let inertia = BodyReport::new(&self.model).inertia;
        PyArray2::from_array(py, &table(&inertia))
    }

    #[getter]
    fn origin<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray1<f64>>> {
        view(py, &self.model, |model| ArrayView1::from(model.body.origin.as_slice()))
    }

    #[getter]
    fn frequencies<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        self.model.natural_frequencies().into_pyarray(py)
    }

    #[getter]
    fn damping_ratios<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray1<f64>>> {
        view(py, &self.model, |model| ArrayView1::from(model.damping_ratios()))
    }

    #[getter]
    fn kinds(&self) -> Vec<&'static str> {
        BodyReport::new(&self.model).kinds
    }

    #[getter]
    fn positions<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        view(py, &self.model, |model| table(model.meshed.as_ref().map_or(&[], |meshed| meshed.mesh.positions())))
    }

    #[getter]
    fn tetrahedra<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<u32>>> {
        view(py, &self.model, |model| table(model.meshed.as_ref().map_or(&[], |meshed| meshed.mesh.elements())))
    }

    #[getter]
    fn surface_triangles<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<u32>>> {
        let faces = self.meshed(py)?.mesh.outer_faces();
        let count = faces.len();
        faces.into_flattened().into_pyarray(py).reshape([count, 6])
    }

    #[getter]
    fn shapes<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray3<f64>>> {
        self.of_nodes(py, |meshed| meshed.modes.shapes.as_ref())
    }

    #[getter]
    fn rigid_shapes<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray3<f64>>> {
        self.of_nodes(py, |meshed| meshed.modes.rigid.shapes.as_ref())
    }

    #[getter]
    fn constants<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        constants(py, &self.model)
    }

    #[getter]
    fn points<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let points = PyDict::new(py);
        for (name, point) in &self.model.points {
            let position = self.model.body.origin + point.position_body();
            points.set_item(name, position.as_slice().to_vec().into_pyarray(py))?;
        }
        Ok(points)
    }

    fn displacements<'py>(&self, modal_displacement: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let py = modal_displacement.py();
        let Meshed { modes, following, mesh, .. } = self.meshed(py)?;
        let q = numbers(modal_displacement, self.model.body.flexible(), "modal_displacement")?;
        let coordinates = self.model.coordinates(&q);
        let (of_modes, of_following) = coordinates.split_at(modes.shapes.ncols().min(coordinates.len()));
        let mut u = &modes.shapes * ColRef::from_slice(of_modes);
        if following.ncols() > 0 {
            u += following * ColRef::from_slice(of_following);
        }
        let u: Vec<f64> = u.iter().copied().collect();
        let nodes = mesh.positions().len();
        let each = u.len().checked_div(nodes).unwrap_or(0);
        u.into_pyarray(py).reshape([nodes, each])
    }

    fn __repr__(&self) -> String {
        let Model { body, meshed, .. } = &*self.model;
        let nodes = meshed.as_ref().map_or(0, |meshed| meshed.mesh.positions().len());
        format!("Body(mass {}, {} flexible modes and static shapes, {nodes} nodes)", body.mass, body.flexible())
    }
}
