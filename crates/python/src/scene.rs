//! The class Scene.

use std::path::PathBuf;
use std::sync::Arc;

use flexframe::model::Builder;
use flexframe::scene::{AssignError, SceneError, assign};
use pyo3::exceptions::PyTypeError;
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyTuple};

use crate::builder::{MODULE, builder};
use crate::errors::{exception, wrong_input};
use crate::threads::detached;
use crate::values::dict::{to_text, to_toml};
use crate::values::html::{escaped, heading};

/// Name of a dict that gets none.
const NAME: &str = "scene";

/// A scene: what a scene file says about a run, read and checked.
///
/// From the path of a scene file; or from a dict with the sections and keys of one, such as `{"title": "Bar", "units":
/// {...}, "body": {"mesh": "bar.msh", ...}, ...}`. Its lists may be arrays of numpy. Paths in a dict are relative to
/// `base` (default: the current folder); `name` stands for it in messages and names its results file (default:
/// "scene"). In a scene of several bodies, `body` names one, to take it alone; `run` takes all of them. With
/// `trust_geometry`, gmsh may do all that a `.geo` file says which the scene names; otherwise one that runs other
/// programs or writes files is refused.
///
/// A scene can be pickled and copied. The files that it names are read where it is unpickled.
#[pyclass(frozen, module = "flexframe")]
pub(crate) struct Scene {
    /// One for each body.
    whole: Arc<flexframe::scene::Scene>,
    bodies: Vec<Arc<flexframe::scene::Body>>,
    /// The body that was named.
    body: Option<String>,
    builder: Builder,
}

/// The function that unpickles scenes.
const UNPICKLE: &str = "_scene";

impl Scene {
    /// The scene of its only body.
    pub(crate) fn only_body(&self, py: Python<'_>) -> PyResult<&Arc<flexframe::scene::Body>> {
        match &self.bodies[..] {
            [body] => Ok(body),
            several => {
                let found = format!("{} bodies", several.len());
                let help = "name one: Scene(…, body=\"NAME\"); run takes all";
                Err(wrong_input(py, "scene", &found, &format!("one of {}", self.bodies().join(", ")), help))
            }
        }
    }

    /// Its bodies with what ties them together.
    pub(crate) fn whole(&self) -> &Arc<flexframe::scene::Scene> {
        &self.whole
    }

    /// The builder of its bodies.
    pub(crate) fn builder(&self) -> &Builder {
        &self.builder
    }

    fn parsed(py: Python<'_>, text: &str, path: PathBuf, body: Option<String>, builder: Builder) -> PyResult<Self> {
        // Tables of histories are read, too.
        let whole = detached(py, || match &body {
            Some(body) => Ok(flexframe::scene::Body::parse_body(text, path, Some(body))?.into()),
            None => flexframe::scene::Scene::parse(text, path),
        })?;
        let whole = Arc::new(whole.map_err(|error: SceneError| exception(py, &error))?);
        let bodies = whole.bodies.iter().cloned().map(Arc::new).collect();
        Ok(Self { whole, bodies, body, builder })
    }
}

#[pymethods]
impl Scene {
    #[new]
    #[pyo3(signature = (source, *, base=None, name=None, body=None, trust_geometry=false))]
    fn new(
        source: &Bound<'_, PyAny>,
        base: Option<PathBuf>,
        name: Option<String>,
        body: Option<String>,
        trust_geometry: bool,
    ) -> PyResult<Self> {
        let py = source.py();
        let builder = builder(py, trust_geometry)?;
        if let Ok(dict) = source.cast::<PyDict>() {
            let name = name.as_deref().unwrap_or(NAME);
            let text = to_text(dict, name)?;
            return Self::parsed(py, &text, base.unwrap_or_default().join(name), body, builder);
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
        Self::parsed(py, &text, path, body, builder)
    }

    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<(Bound<'py, PyAny>, Bound<'py, PyTuple>)> {
        let unpickle = py.import(MODULE)?.getattr(UNPICKLE)?;
        let state = (self.text(), self.path(), &self.body, self.builder.trust_geometry);
        Ok((unpickle, state.into_pyobject(py)?))
    }

    /// The scene with other values of some keys: `{"time.end": 0.5, "loads[0].amplitude": 20.0}`, as with `--set`.
    fn with_values(&self, py: Python<'_>, values: &Bound<'_, PyDict>) -> PyResult<Self> {
        let mut assigned = Vec::new();
        for (key, value) in values {
            let key: String = key.extract()?;
            let value = to_toml(&value, NAME, &key)?;
            assigned.push((key, value));
        }
        let refused = |AssignError { key, found, expected }| {
            let help = "name the key as messages about the scene do; docs/reference/scene.md lists them";
            wrong_input(py, &format!("`{key}`"), &found, &expected, help)
        };
        let text = assign(self.text(), &assigned).map_err(refused)?;
        Self::parsed(py, &text, self.path().clone(), self.body.clone(), self.builder.clone())
    }

    /// The title of the run.
    #[getter]
    fn title(&self) -> &str {
        &self.whole.title
    }

    /// The text of the scene, TOML; with all bodies, where it has several.
    #[getter]
    fn text(&self) -> &str {
        &self.whole.text
    }

    /// Names of its bodies; "body" is that of a single one.
    #[getter]
    fn bodies(&self) -> Vec<&str> {
        self.bodies.iter().map(|body| body.name.as_deref().unwrap_or("body")).collect()
    }

    /// The scene file, or `base` and `name` of a dict.
    #[getter]
    fn path(&self) -> &PathBuf {
        &self.whole.path
    }

    /// Time at the end of the run.
    #[getter]
    fn end(&self) -> f64 {
        self.whole.time.end
    }

    /// Labels of "length", "mass" and "time".
    #[getter]
    fn units<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        units(py, &self.whole.units.length, &self.whole.units.mass, &self.whole.units.time)
    }

    fn __repr__(&self) -> String {
        format!("Scene({:?}, {:?})", self.path().display().to_string(), self.whole.title)
    }

    /// The title and the text.
    fn _repr_html_(&self) -> String {
        let file = self.path().display().to_string();
        heading(&self.whole.title, &file) + &format!("<pre>{}</pre>", escaped(self.text()))
    }
}

/// The scene that was pickled.
#[pyfunction(name = "_scene")]
pub(crate) fn unpickled(
    py: Python<'_>,
    text: &str,
    path: PathBuf,
    body: Option<String>,
    trust_geometry: bool,
) -> PyResult<Scene> {
    Scene::parsed(py, text, path, body, builder(py, trust_geometry)?)
}

/// The labels of the units.
pub(crate) fn units<'py>(py: Python<'py>, length: &str, mass: &str, time: &str) -> PyResult<Bound<'py, PyDict>> {
    let units = PyDict::new(py);
    units.set_item("length", length)?;
    units.set_item("mass", mass)?;
    units.set_item("time", time)?;
    Ok(units)
}
