//! The class Scene.

use std::path::PathBuf;
use std::sync::Arc;

use flexframe::scene::{AssignError, assign};
use pyo3::exceptions::PyTypeError;
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::dict::{to_text, to_toml};
use crate::errors::{exception, wrong_input};
use crate::threads::detached;

/// What a dict is called where it gets no name.
const NAME: &str = "scene";

/// A scene: what the scene file says about a run, read and checked.
#[pyclass(frozen, module = "flexframe")]
pub(crate) struct Scene(Arc<flexframe::scene::Scene>);

impl Scene {
    pub(crate) fn scene(&self) -> &Arc<flexframe::scene::Scene> {
        &self.0
    }

    fn parsed(py: Python<'_>, text: &str, path: PathBuf) -> PyResult<Self> {
        // Tables of histories are read, too.
        let scene = detached(py, || flexframe::scene::Scene::parse(text, path))?;
        scene.map(|scene| Self(Arc::new(scene))).map_err(|error| exception(py, &error))
    }
}

#[pymethods]
impl Scene {
    #[new]
    #[pyo3(signature = (source, *, base=None, name=None))]
    fn new(source: &Bound<'_, PyAny>, base: Option<PathBuf>, name: Option<String>) -> PyResult<Self> {
        let py = source.py();
        if let Ok(dict) = source.cast::<PyDict>() {
            let name = name.as_deref().unwrap_or(NAME);
            let text = to_text(dict, name)?;
            return Self::parsed(py, &text, base.unwrap_or_default().join(name));
        }
        let Ok(path) = source.extract::<PathBuf>() else {
            let found = source.get_type().name()?;
            return Err(PyTypeError::new_err(format!("a scene is the path of a scene file, or a dict; found {found}")));
        };
        if base.is_some() || name.is_some() {
            let message =
                "`base` and `name` are those of a scene from a dict; a scene file has its own folder and name";
            return Err(PyTypeError::new_err(message));
        }
        let text = py.detach(|| flexframe::scene::text_of(&path)).map_err(|error| exception(py, &error))?;
        Self::parsed(py, &text, path)
    }

    fn with_values(&self, py: Python<'_>, values: &Bound<'_, PyDict>) -> PyResult<Self> {
        let mut assigned = Vec::new();
        for (key, value) in values {
            let key: String = key.extract()?;
            let value = to_toml(&value, NAME, &key)?;
            assigned.push((key, value));
        }
        let refused = |AssignError { key, found, expected }| {
            let cure = "name the key as messages about the scene do; docs/scene.md lists them";
            wrong_input(py, &format!("`{key}`"), &found, &expected, cure)
        };
        let text = assign(&self.0.source, &assigned).map_err(refused)?;
        Self::parsed(py, &text, self.0.path.clone())
    }

    #[getter]
    fn title(&self) -> &str {
        &self.0.title
    }

    #[getter]
    fn text(&self) -> &str {
        &self.0.source
    }

    #[getter]
    fn path(&self) -> &PathBuf {
        &self.0.path
    }

    #[getter]
    fn end(&self) -> f64 {
        self.0.time.end
    }

    #[getter]
    fn units<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        units(py, &self.0.units.length, &self.0.units.mass, &self.0.units.time)
    }

    fn __repr__(&self) -> String {
        format!("Scene({:?}, {:?})", self.0.path.display().to_string(), self.0.title)
    }
}

/// The labels of the units.
pub(crate) fn units<'py>(py: Python<'py>, length: &str, mass: &str, time: &str) -> PyResult<Bound<'py, PyDict>> {
    let units = PyDict::new(py);
    units.set_item("length", length)?;
    units.set_item("mass", mass)?;
    units.set_item("time", time)?;
    Ok(units)
}
