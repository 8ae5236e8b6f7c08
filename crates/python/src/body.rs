//! The class Body.

use std::sync::Arc;

use diagnostic::Failure;
use flexframe::faer::{ColRef, MatRef};
use flexframe::model::{Assembly, BuildError, BuildProgress, Meshed, Model, Needs};
use flexframe::modes::frequency_unit;
use flexframe::plausible::doubts_of_body;
use flexframe::report::{BodyReport, quantity};
use numpy::ndarray::ArrayView1;
use numpy::{IntoPyArray, PyArray1, PyArray2, PyArray3, PyArrayMethods};
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyType};

use crate::errors::{exception, warn, wrong_input};
use crate::interrupt::{Stop, interruptible};
use crate::scene::Scene;
use crate::values::arrays::{fields, table, view};
use crate::values::constants::constants;
use crate::values::html::{heading, table as html_table};
use crate::values::numbers::numbers;

/// The body of a scene of one: its mesh is read, its modes are found, and it is reduced.
///
/// Results of a mesh are kept in the user's cache, as by the program: the same body is there at once the next
/// time, also in another process. So a body that is pickled is its scene, and is made again from the cache where it is
/// unpickled.
///
/// Ctrl-C raises KeyboardInterrupt at once; a factorization that is under way goes on in its thread until it is done.
/// A view is memory of the body: read-only, not copied, and valid as long as the array is (it keeps
/// the body). nf is the number of flexible modes plus that of the static shapes, which come after them.
#[pyclass(frozen, module = "flexframe")]
pub(crate) struct Body {
    scene: Py<Scene>,
    /// The scene of this body.
    of: Arc<flexframe::scene::Body>,
    model: Arc<Model>,
    /// The assembly that other scenes of the same body share with it.
    assembly: Arc<Assembly>,
}

impl Body {
    pub(crate) fn model(&self) -> &Arc<Model> {
        &self.model
    }

    pub(crate) fn scene_of(&self) -> &Arc<flexframe::scene::Body> {
        &self.of
    }

    /// The same body in another scene.
    pub(crate) fn of_scene(&self, py: Python<'_>, scene: Py<Scene>) -> PyResult<Self> {
        let of = scene.get().only_body(py)?.clone();
        let needs = Needs::default();
        if Assembly::input(&of, &needs) != Assembly::input(self.scene_of(), &needs) {
            let expected = "one with the same [body], constraints and modes.flexible";
            let help = "make another body: Simulation(Body(scene))";
            return Err(wrong_input(py, "scene", "a scene of another body", expected, help));
        }
        let (assembly, of_thread) = (self.assembly.clone(), of.clone());
        let build = move |told: &mut dyn FnMut(BuildProgress)| assembly.variants()?.build(&of_thread, &needs, told);
        let model = Arc::new(built(py, &scene, build)?);
        Ok(Self { scene, of, model, assembly: self.assembly.clone() })
    }

    fn meshed(&self, py: Python<'_>) -> PyResult<&Meshed> {
        self.model.meshed.as_ref().ok_or_else(|| {
            let help = "ask for what needs a mesh of a body that has one";
            wrong_input(py, "body", "a rigid body", "a body with a mesh", help)
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
        let of = scene.get().only_body(py)?.clone();
        warn(py, doubts_of_body(&of))?;
        let (of_thread, builder) = (of.clone(), scene.get().builder().clone());
        let build = move |told: &mut dyn FnMut(BuildProgress)| {
            let assembly = builder.assemble(&of_thread, &mut *told)?;
            let model = assembly.variants()?.build(&of_thread, &builder.needs, told)?;
            Ok::<_, BuildError>((model, assembly.without_matrices()))
        };
        let (model, assembly) = built(py, &scene, build)?;
        Ok(Self { scene, of, model: Arc::new(model), assembly: Arc::new(assembly) })
    }

    fn __reduce__<'py>(&self, py: Python<'py>) -> (Bound<'py, PyType>, (Py<Scene>,)) {
        (py.get_type::<Self>(), (self.scene.clone_ref(py),))
    }

    /// The scene that it was made for.
    #[getter]
    fn scene(&self, py: Python<'_>) -> Py<Scene> {
        self.scene.clone_ref(py)
    }

    /// Mass, point masses among it.
    #[getter]
    fn mass(&self) -> f64 {
        self.model.body.mass
    }

    /// Centre of mass, mesh axes (3; view).
    #[getter]
    fn center_of_mass<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray1<f64>>> {
        view(py, &self.model, |model| ArrayView1::from(model.body.center_of_mass.as_slice()))
    }

    /// Inertia of the undeformed body about its centre of mass (3x3).
    #[getter]
    fn inertia<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray2<f64>> {
        let inertia = BodyReport::new(&self.model).inertia;
        PyArray2::from_array(py, &table(&inertia))
    }

    /// Origin of the body frame, mesh axes (3; view): the centre of mass of a free body.
    #[getter]
    fn origin<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray1<f64>>> {
        view(py, &self.model, |model| ArrayView1::from(model.body.origin.as_slice()))
    }

    /// Natural frequencies, cycles per time (nf); after them those of the static shapes, which are none.
    #[getter]
    fn frequencies<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        self.model.natural_frequencies().into_pyarray(py)
    }

    /// Damping ratio of each of them (nf; view); zero where the scene alone calls for no damping. Under laws it is that
    /// of the scene: see Results.
    #[getter]
    fn damping_ratios<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray1<f64>>> {
        view(py, &self.model, |model| ArrayView1::from(model.damping_ratios()))
    }

    /// Kind of each: "natural mode" or "static shape"; beside the "static answer" to moments, "combination of modes".
    #[getter]
    fn kinds(&self) -> Vec<&'static str> {
        BodyReport::new(&self.model).kinds
    }

    /// Nodes of the mesh (n x 3; view); none of a rigid body.
    #[getter]
    fn positions<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        view(py, &self.model, |model| table(model.meshed.as_ref().map_or(&[], |meshed| meshed.mesh.positions())))
    }

    /// Nodes of the elements, from 0: corners, then mid-edges 01 12 02 03 23 13 (m x 10; view).
    #[getter]
    fn tetrahedra<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<u32>>> {
        view(py, &self.model, |model| table(model.meshed.as_ref().map_or(&[], |meshed| meshed.mesh.elements())))
    }

    /// Nodes of the faces on the surface, seen from outside: corners, then mid-edges 01 12 20 (t x 6).
    #[getter]
    fn surface_triangles<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<u32>>> {
        let faces = self.meshed(py)?.mesh.outer_faces();
        let count = faces.len();
        faces.into_flattened().into_pyarray(py).reshape([count, 6])
    }

    /// Mass-normalised modes, then static shapes: displacements of the nodes, mesh axes (nf x n x 3, or 6 with the
    /// rotations of the nodes; view).
    #[getter]
    fn shapes<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray3<f64>>> {
        self.of_nodes(py, |meshed| meshed.modes.shapes.as_ref())
    }

    /// Rigid modes, zero where the body has less (6 x n x 3, or 6 with the rotations of the nodes; view).
    #[getter]
    fn rigid_shapes<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray3<f64>>> {
        self.of_nodes(py, |meshed| meshed.modes.rigid.shapes.as_ref())
    }

    /// Constants of the reduced body, by the names in docs/reference/body.md: "mass" is a number, the others are read-only arrays
    /// with the shapes given there. Those without an index of their own are views.
    #[getter]
    fn constants<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        constants(py, &self.model)
    }

    /// Where the points of the scene are in the undeformed body, mesh axes.
    #[getter]
    fn points<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let points = PyDict::new(py);
        for (name, point) in &self.model.points {
            let position = self.model.body.origin + point.position_body() - point.of_reference();
            points.set_item(name, position.as_slice().to_vec().into_pyarray(py))?;
        }
        Ok(points)
    }

    /// Elastic displacement of each node, body axes (n x 3, or 6 with the rotations of the nodes), with what follows
    /// large modes, and that of a bent reference.
    fn displacements<'py>(&self, modal_displacement: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let py = modal_displacement.py();
        let Meshed { modes, following, mesh, reference, .. } = self.meshed(py)?;
        let q = numbers(modal_displacement, self.model.body.flexible(), "modal_displacement")?;
        let coordinates = self.model.coordinates(&q);
        let (of_modes, of_following) = coordinates.split_at(modes.shapes.ncols().min(coordinates.len()));
        let mut u = &modes.shapes * ColRef::from_slice(of_modes);
        if following.ncols() > 0 {
            u += following * ColRef::from_slice(of_following);
        }
        if let Some(reference) = reference {
            u += reference.col(0);
        }
        let u: Vec<f64> = u.iter().copied().collect();
        let nodes = mesh.positions().len();
        let each = u.len().checked_div(nodes).unwrap_or(0);
        u.into_pyarray(py).reshape([nodes, each])
    }

    fn __repr__(&self) -> String {
        format!("Body({:?}: {})", self.scene_of().title, self.in_words())
    }

    /// The title, the mass, and a table of the modes.
    fn _repr_html_(&self) -> String {
        let BodyReport { natural_frequencies, kinds, damping_ratios, .. } = BodyReport::new(&self.model);
        let modes = (1..).zip(kinds).zip(natural_frequencies.iter().zip(damping_ratios)).map(
            |((number, kind), (frequency, damping_ratio))| {
                let frequency = if kind == "natural mode" { format!("{frequency:.5}") } else { "–".to_owned() };
                [number.to_string(), kind.to_owned(), frequency, format!("{damping_ratio:.4}")]
            },
        );
        let frequency = format!("frequency, {}", frequency_unit(&self.scene_of().units.time));
        let modes = html_table(["mode", "kind", &frequency, "damping ratio"], modes);
        heading(&self.scene_of().title, &self.in_words()) + &modes
    }
}

impl Body {
    /// Its mass, modes and nodes.
    fn in_words(&self) -> String {
        let units = &self.scene_of().units;
        let modes = BodyReport::new(&self.model).modes_in_words(&frequency_unit(&units.time));
        let nodes = self.model.meshed.as_ref().map(|meshed| format!(", {} nodes", meshed.mesh.positions().len()));
        format!("mass {} {}, {modes}{}", quantity(self.model.body.mass), units.mass, nodes.unwrap_or_default())
    }
}

/// Does the work of building for a scene in a thread, and tells as warnings what is doubtful.
pub(crate) fn built<T: Send + 'static, E: Into<Failure> + Send + 'static>(
    py: Python<'_>,
    scene: &Py<Scene>,
    build: impl FnOnce(&mut dyn FnMut(BuildProgress)) -> Result<T, E> + Send + 'static,
) -> PyResult<T> {
    let stop = Stop::default();
    let told = stop.clone();
    let work = move || {
        let mut doubts = Vec::new();
        let result = build(&mut |progress| {
            told.check();
            if let BuildProgress::Doubt(doubt) = progress {
                doubts.push(doubt.to_string());
            }
        });
        (result, doubts)
    };
    // A factorization cannot be stopped in its midst, and nobody is to wait for it.
    let ((result, doubts), raised) = interruptible(py, &stop, || false, work)?;
    if let Some(error) = raised {
        return Err(error);
    }
    warn(py, doubts.into_iter().chain(scene.get().builder().cache.notes().warnings))?;
    result.map_err(|error| exception(py, &*error.into()))
}
