//! The class System.

use std::sync::Arc;

use flexframe::model::{BuildProgress, Model};
use flexframe::plausible::doubts_of_scene;
use pyo3::prelude::*;
use pyo3::types::PyType;

use crate::body::built;
use crate::errors::warn;
use crate::scene::Scene;

/// All bodies of a scene with the joints between them: their meshes are read, their modes are found, and they are reduced.
///
/// Results that take long are kept in the user's cache, as for Body. A Simulation of it steps all bodies together.
#[pyclass(frozen, module = "flexframe")]
pub(crate) struct System {
    scene: Py<Scene>,
    models: Vec<Arc<Model>>,
}

impl System {
    /// Its bodies with what ties them together.
    pub(crate) fn whole(&self) -> &Arc<flexframe::scene::Scene> {
        self.scene.get().whole()
    }

    pub(crate) fn models(&self) -> &[Arc<Model>] {
        &self.models
    }
}

#[pymethods]
impl System {
    #[new]
    fn new(py: Python<'_>, scene: Py<Scene>) -> PyResult<Self> {
        let (whole, builder) = (scene.get().whole().clone(), scene.get().builder().clone());
        warn(py, doubts_of_scene(&whole))?;
        let build = move |told: &mut dyn FnMut(BuildProgress)| {
            whole.bodies.iter().map(|of| builder.build(of, &mut *told).map(Arc::new)).collect()
        };
        let models = built(py, &scene, build)?;
        Ok(Self { scene, models })
    }

    fn __reduce__<'py>(&self, py: Python<'py>) -> (Bound<'py, PyType>, (Py<Scene>,)) {
        (py.get_type::<Self>(), (self.scene.clone_ref(py),))
    }

    /// The scene that it was made for.
    #[getter]
    fn scene(&self, py: Python<'_>) -> Py<Scene> {
        self.scene.clone_ref(py)
    }

    /// Names of its bodies.
    #[getter]
    fn bodies(&self) -> Vec<String> {
        let name = |body: &flexframe::scene::Body| body.name.clone().unwrap_or_else(|| "body".to_owned());
        self.whole().bodies.iter().map(name).collect()
    }

    /// Names of its joints.
    #[getter]
    fn joints(&self) -> Vec<String> {
        self.whole().joints.iter().map(|joint| joint.name.clone()).collect()
    }

    fn __repr__(&self) -> String {
        format!("System(bodies {}; joints {})", self.bodies().join(", "), self.joints().join(", "))
    }
}
