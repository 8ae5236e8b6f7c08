//! The finite-element model of a body, which is assembled and solved where an answer is not known.

use std::cell::{Cell, OnceCell, RefCell};
use std::path::{Path, PathBuf};

use body_file::BodyFileError;
use dynamics::DrivenMotion;
use faer::{ColRef, Mat, MatRef};
use fem_tet10::{
    AssemblyError, GeometricTerms, StressRecovery, StressSites, extended_geometric_stiffness,
    geometric_stiffness_product, second_order_energies, second_order_forces,
};
use keys::{Key, Keyed};
use modal::{
    BucklingAccuracy, ModalError, Modes, ReducedBody, SecondOrderShapes, Solver, StaticAccuracy, acceleration_fields,
    centrifugal_fields, mass_left_out, turning_field,
};
use slepc::write_folder;

use crate::assembly::{AssembledMesh, MadeOf};
use crate::body::origin::Origin;
use crate::cache::Computing;
use crate::cache::answer::{Answer, Kept};
use crate::cache::answers;
use crate::cache::store::Store;
use crate::error::{BuildError, modal, too_many_modes};
use crate::load::mesh_load::UnitWeight;
use crate::mesh::fe_matrices::FeMatrices;
use crate::mesh::given::{MatrixChecks, refuse_matrix};
use crate::progress::{BuildProgress, BuildWork};
use crate::structure::{StaticForces, Structure};

/// The finite-element model of a scene's body.
pub(crate) struct Solved<'a> {
    assembled: &'a AssembledMesh,
    solver: OnceCell<Solver<'a>>,
    recovery: OnceCell<StressRecovery<'a>>,
    element_passes: Cell<usize>,
    /// Held from the first answer that has to be computed on.
    computing: RefCell<Option<Computing>>,
}

impl<'a> Solved<'a> {
    /// Errors of the matrices come at once where no answers are kept.
    pub fn new(assembled: &'a AssembledMesh) -> Result<Self, BuildError> {
        let solved = Self {
            assembled,
            solver: OnceCell::new(),
            recovery: OnceCell::new(),
            element_passes: Cell::default(),
            computing: RefCell::default(),
        };
        if assembled.store.is_none() {
            solved.solver()?;
        }
        Ok(solved)
    }

    /// Bytes of the mass and stiffness matrices.
    pub fn matrix_bytes(&self) -> Result<usize, BuildError> {
        self.ask_count(|| self.about_the_body("matrix bytes"), || Ok(self.matrices()?.bytes()))
    }

    /// Checks of the matrices, of a body of matrices from another program, with the part of the mass that the motion in
    /// these modes
    /// leaves out of the mass.
    pub fn checks(&self, modes: &Modes) -> Result<Option<MatrixChecks>, BuildError> {
        let Some(checks) = self.assembled.checks else { return Ok(None) };
        if checks.is_scalar_mass || modes.shapes.ncols() == 0 {
            return Ok(Some(checks));
        }
        let question = || with_modes(self.about_the_body("mass left out"), modes);
        let found = self.ask_list(question, 1, || Ok(vec![mass_left_out(self.solver()?.mass(), modes)]))?;
        Ok(Some(MatrixChecks { left_out: found.first().copied().unwrap_or_default(), ..checks }))
    }

    /// Number of flexible modes that there are.
    pub fn available(&self) -> Result<usize, BuildError> {
        self.ask_count(|| self.about_the_held_body("number of modes"), || Ok(self.solver()?.available()))
    }

    /// Writes the problem of a number of modes into a folder, to be solved elsewhere on a number of ranks. Returns the files.
    pub fn write_problem(&self, modes: usize, folder: &Path, ranks: usize) -> Result<Vec<PathBuf>, BuildError> {
        let (scene, solver) = (&self.assembled.scene, self.solver()?);
        let available = solver.available();
        if modes > available {
            return Err(too_many_modes(scene, ModalError::TooManyModes { requested: modes, available }));
        }
        let problem = solver.held_problem().map_err(|error| self.refuse(error))?;
        write_folder(&problem, modes, folder, ranks, &scene.path)
            .map_err(|source| modal(scene)(ModalError::Engine(source.into())))
    }

    /// Work of the mesh's size that was done up to now.
    pub fn work(&self) -> BuildWork {
        let [blocks, columns] = self.solver.get().map_or([0; 2], Solver::solved);
        BuildWork { blocks, columns, element_passes: self.element_passes.get() }
    }

    fn pass_elements(&self) {
        self.element_passes.set(self.element_passes.get() + 1);
    }

    fn matrices(&self) -> Result<&'a FeMatrices, BuildError> {
        self.assembled.matrices()
    }

    fn solver(&self) -> Result<&Solver<'a>, BuildError> {
        if let Some(found) = self.solver.get() {
            return Ok(found);
        }
        let AssembledMesh { mesh, support, .. } = self.assembled;
        let matrices = self.matrices()?;
        let solver = matrices.solver(mesh.positions(), support).map_err(|error| self.refuse(error))?;
        let edge_ends = if mesh.has_elements() { mesh.edge_ends() } else { None };
        let solver = match edge_ends {
            Some(edge_ends) => solver.with_edge_ends(edge_ends).map_err(|error| self.refuse(error))?,
            None => solver,
        };
        let solver = match &self.assembled.builder.solver {
            Some(slepc) => solver.with_engine(slepc.engine()),
            None => solver,
        };
        Ok(self.solver.get_or_init(|| solver))
    }

    /// Error of the modal analysis, in words of the files where the matrices come from files.
    fn refuse(&self, error: ModalError) -> BuildError {
        let AssembledMesh { scene, body, mesh, .. } = self.assembled;
        match body {
            MadeOf::Elements(_) => modal(scene)(error),
            MadeOf::Files(files) => refuse_matrix(scene, files, mesh, error),
        }
    }

    fn recovery(&self) -> Result<&StressRecovery<'a>, BuildError> {
        if let Some(found) = self.recovery.get() {
            return Ok(found);
        }
        let recovery = StressRecovery::new(&self.assembled.mesh, self.assembled.materials()?)?;
        Ok(self.recovery.get_or_init(|| recovery))
    }

    /// Answer to a question, which is written out only where something is kept.
    fn ask<T>(
        &self,
        question: impl FnOnce() -> Key,
        recall: impl Fn(&Kept<'_>) -> Result<T, BodyFileError>,
        compute: impl FnOnce() -> Result<T, BuildError>,
        keep: impl FnOnce(&T) -> Answer,
    ) -> Result<T, BuildError> {
        let Some(store) = &self.assembled.store else { return compute() };
        let question = store.question().with("question", &question().finish()).finish();
        if let Some(answer) = store.recall(&question, &recall)? {
            return Ok(answer);
        }
        if self.computing.borrow().is_none() {
            *self.computing.borrow_mut() = Some(self.assembled.builder.cache.computing());
            // Another thread may have computed it in the meantime.
            if let Some(answer) = store.recall(&question, &recall)? {
                return Ok(answer);
            }
        }
        let answer = compute()?;
        store.keep(&question, || keep(&answer));
        Ok(answer)
    }

    fn ask_fields(
        &self,
        question: impl FnOnce() -> Key,
        columns: usize,
        compute: impl FnOnce() -> Result<Mat<f64>, BuildError>,
    ) -> Result<Mat<f64>, BuildError> {
        let recall = |kept: &Kept<'_>| answers::fields(kept, self.rows(), columns);
        self.ask(question, recall, compute, |fields| answers::of_fields(fields.as_ref()))
    }

    fn ask_stress(
        &self,
        question: impl FnOnce() -> Key,
        columns: usize,
        compute: impl FnOnce(&StressRecovery<'a>) -> Result<Mat<f64>, AssemblyError>,
    ) -> Result<Mat<f64>, BuildError> {
        let recovery = self.recovery()?;
        let recall = |kept: &Kept<'_>| answers::stress(kept, recovery.sites().len(), columns);
        self.ask(question, recall, || Ok(compute(recovery)?), |stress| answers::of_stress(stress.as_ref()))
    }

    fn ask_list(
        &self,
        question: impl FnOnce() -> Key,
        length: usize,
        compute: impl FnOnce() -> Result<Vec<f64>, BuildError>,
    ) -> Result<Vec<f64>, BuildError> {
        let recall = |kept: &Kept<'_>| kept.list("values", Some(length));
        self.ask(question, recall, compute, |values| Answer::default().with_list("values", values))
    }

    fn ask_count(
        &self,
        question: impl FnOnce() -> Key,
        compute: impl FnOnce() -> Result<usize, BuildError>,
    ) -> Result<usize, BuildError> {
        let recall = |kept: &Kept<'_>| Ok(kept.counts::<1>("count")?[0] as usize);
        self.ask(question, recall, compute, |count| Answer::default().with_counts("count", &[*count as u64]))
    }

    /// Refuses a body file that was made for other modes or another support: these are what takes long.
    fn refuse_other_body(&self, flexible: usize) -> Result<(), BuildError> {
        let Some(file) = self.assembled.store.as_ref().and_then(Store::given) else { return Ok(()) };
        let origin = Origin::read(file)?;
        let help = "give the scene what the file was made for, or make the file again: flexframe reduce SCENE -o FILE, from a \
                    scene without `file`";
        let support = self.support_hash();
        let (found, expected) = if origin.support != support {
            (
                "a body file of a body that is held otherwise".to_owned(),
                "one with the constraints of the scene".to_owned(),
            )
        } else {
            (format!("a body file with {} modes", origin.modes), format!("one with {flexible}, as [modes] asks"))
        };
        Err(self.assembled.scene.refuse("body.file", found, expected, help).into())
    }

    /// Hash of the support, in hexadecimal digits.
    pub fn support_hash(&self) -> String {
        self.assembled.support.key(Key::new()).finish().to_string()
    }

    /// A question about the body whatever holds it.
    fn about_the_body(&self, what: &str) -> Key {
        Key::new().of(what, 1)
    }

    /// A question about the body with its support.
    fn about_the_held_body(&self, what: &str) -> Key {
        self.about_the_body(what).with("support", &self.assembled.support)
    }

    fn rows(&self) -> usize {
        self.assembled.dofs() * self.assembled.mesh.positions().len()
    }
}

impl Structure for Solved<'_> {
    fn modes(&self, flexible: usize, progress: &mut dyn FnMut(BuildProgress)) -> Result<Modes, BuildError> {
        self.ask(
            || self.about_the_held_body("modes").with("flexible", &flexible),
            |kept| answers::modes(kept, self.rows(), self.assembled.support.motion),
            || {
                self.refuse_other_body(flexible)?;
                if self.solver.get().is_none() {
                    progress(BuildProgress::Assembly);
                }
                let modes = self.solver()?.modes(flexible, |p| progress(BuildProgress::Modes(p)));
                modes.map_err(|error| match error {
                    ModalError::TooManyModes { .. } => too_many_modes(&self.assembled.scene, error),
                    other => self.refuse(other),
                })
            },
            answers::of_modes,
        )
    }

    fn unit_weight(&self) -> Result<UnitWeight, BuildError> {
        let count = self.assembled.mesh.positions().len();
        if let MadeOf::Files(_) = self.assembled.body {
            let fields = || Ok(acceleration_fields(self.solver()?.mass()));
            let forces = self.ask_fields(|| self.about_the_body("unit weight"), 3, fields)?;
            let dofs = self.assembled.dofs();
            let mass = (0..count).map(|node| forces[(dofs * node, 0)]).sum();
            return Ok(UnitWeight { forces, mass });
        }
        // Elements have a scalar mass for each pair of nodes, and one number for each node is kept.
        let masses = || Ok(self.solver()?.mass().row_sums());
        let masses = self.ask_list(|| self.about_the_body("nodal masses"), count, masses)?;
        let forces = Mat::from_fn(3 * count, 3, |row, axis| if row % 3 == axis { masses[row / 3] } else { 0.0 });
        Ok(UnitWeight { forces, mass: masses.iter().sum() })
    }

    fn mass_product(&self, fields: MatRef<'_, f64>) -> Result<Mat<f64>, BuildError> {
        let question = || self.about_the_body("mass product").with("fields", &fields);
        self.ask_fields(question, fields.ncols(), || Ok(self.solver()?.mass().product(fields)))
    }

    fn stiffness_product(&self, fields: MatRef<'_, f64>) -> Result<Mat<f64>, BuildError> {
        let question = || self.about_the_body("stiffness product").with("fields", &fields);
        self.ask_fields(question, fields.ncols(), || Ok(self.matrices()?.stiffness() * fields))
    }

    fn static_response(
        &self,
        modes: &Modes,
        forces: MatRef<'_, f64>,
        accuracy: StaticAccuracy,
    ) -> Result<Mat<f64>, BuildError> {
        let question = || {
            let accuracy = match accuracy {
                StaticAccuracy::Full => "full",
                StaticAccuracy::Shapes => "shapes",
            };
            let question = self.about_the_held_body("static response").with("accuracy", accuracy);
            with_natural(question, modes).with("forces", &forces)
        };
        self.ask_fields(question, forces.ncols(), || {
            self.solver()?.static_response_from(modes, forces, accuracy).map_err(modal(&self.assembled.scene))
        })
    }

    fn static_responses(&self, modes: &Modes, forces: &StaticForces) -> Result<Mat<f64>, BuildError> {
        let StaticForces { of_loads, spin, drive, origin } = forces;
        let question = || {
            let question = with_natural(self.about_the_held_body("static responses"), modes);
            question.with("loads", of_loads).with("spin", spin).with("drive", drive).with("origin", origin)
        };
        self.ask_fields(question, forces.count(), || {
            let solver = self.solver()?;
            let (mass, positions) = (solver.mass(), self.assembled.mesh.positions());
            let refused = |error| modal(&self.assembled.scene)(error);
            let mut all = Mat::zeros(of_loads.nrows(), forces.count());
            all.as_mut().subcols_mut(0, of_loads.ncols()).copy_from(of_loads);
            let mut next = of_loads.ncols();
            let mut add = |fields: Mat<f64>| {
                all.as_mut().subcols_mut(next, fields.ncols()).copy_from(&fields);
                next += fields.ncols();
            };
            if *spin {
                add(centrifugal_fields(mass, positions, origin).map_err(refused)?);
            }
            match drive {
                Some(DrivenMotion::Slide { direction }) => {
                    add(acceleration_fields(mass) * Mat::from_fn(3, 1, |i, _| direction[i]));
                }
                Some(DrivenMotion::Turn { axis }) => {
                    add(turning_field(mass, positions, origin, axis).map_err(refused)?);
                }
                None => {}
            }
            solver.static_response_from(modes, all.as_ref(), StaticAccuracy::Full).map_err(refused)
        })
    }

    fn with_static_shapes(&self, modes: Modes, responses: MatRef<'_, f64>) -> Result<Modes, BuildError> {
        let natural = modes.natural();
        let question = || {
            let question = with_modes(self.about_the_held_body("static shapes"), &modes);
            question.with("natural", &natural).with("responses", &responses)
        };
        self.ask(
            question,
            |kept| answers::with_added_shapes(kept, modes.clone(), natural),
            || self.solver()?.with_static_shapes(modes.clone(), responses).map_err(modal(&self.assembled.scene)),
            |modes| answers::of_added_shapes(modes, natural),
        )
    }

    fn second_order_shapes(
        &self,
        modes: Modes,
        large: &[usize],
        forces: MatRef<'_, f64>,
        responses: MatRef<'_, f64>,
    ) -> Result<SecondOrderShapes, BuildError> {
        let question = || {
            let question = with_modes(self.about_the_held_body("shapes of second order"), &modes);
            // The last bits of the responses depend on those that were computed with them.
            question.with("large", large).with("forces", &forces).with("responses", &responses)
        };
        self.ask(
            question,
            |kept| answers::second_order_shapes(kept, modes.clone(), large),
            || {
                let shapes = self.solver()?.second_order_shapes(modes.clone(), large, forces, responses);
                shapes.map_err(modal(&self.assembled.scene))
            },
            answers::of_second_order_shapes,
        )
    }

    fn reduced_body(&self, modes: &Modes) -> Result<ReducedBody, BuildError> {
        self.ask(
            || with_modes(self.about_the_held_body("reduced body"), modes),
            |kept| answers::reduced_body(kept, modes),
            || {
                ReducedBody::of_mass(modes, self.solver()?.mass(), self.assembled.mesh.positions())
                    .map_err(modal(&self.assembled.scene))
            },
            answers::of_reduced_body,
        )
    }

    fn remainders(&self, modes: &Modes, responses: MatRef<'_, f64>) -> Result<Vec<f64>, BuildError> {
        let question = || with_modes(self.about_the_body("remainders"), modes).with("responses", &responses);
        self.ask_list(question, responses.ncols(), || {
            let momenta = self.solver()?.mass().product(responses);
            let of = |(u, mu): (ColRef<'_, f64>, ColRef<'_, f64>)| {
                let carried: f64 = modes.shapes.as_ref().col_iter().map(|shape| (shape.transpose() * mu).powi(2)).sum();
                (u.transpose() * mu - carried).max(0.0).sqrt()
            };
            Ok(responses.col_iter().zip(momenta.as_ref().col_iter()).map(of).collect())
        })
    }

    fn stress_stiffness(
        &self,
        displacements: MatRef<'_, f64>,
        modes: &Modes,
        terms: GeometricTerms,
        known: &[Mat<f64>],
    ) -> Result<Vec<Mat<f64>>, BuildError> {
        let shapes = modes.shapes.as_ref();
        let question = || {
            let terms = match terms {
                GeometricTerms::All => "all",
                GeometricTerms::InitialStress => "initial stress",
            };
            let question = self.about_the_body("stress stiffness").with("displacements", &displacements);
            question.with("shapes", &shapes).with("terms", terms).with("known", known)
        };
        self.ask(
            question,
            |kept| kept.matrices("stiffness", displacements.ncols(), shapes.ncols()),
            || {
                self.pass_elements();
                Ok(extended_geometric_stiffness(
                    &self.assembled.mesh,
                    self.assembled.materials()?,
                    displacements,
                    shapes,
                    terms,
                    known,
                )?)
            },
            |stiffness| Answer::default().with_matrices("stiffness", stiffness),
        )
    }

    fn second_order_forces(&self, fields: MatRef<'_, f64>, pairs: &[[usize; 2]]) -> Result<Mat<f64>, BuildError> {
        let question = || self.about_the_body("forces of second order").with("fields", &fields).with("pairs", pairs);
        self.ask_fields(question, pairs.len(), || {
            self.pass_elements();
            Ok(second_order_forces(&self.assembled.mesh, self.assembled.materials()?, fields, pairs)?)
        })
    }

    fn second_order_energies(
        &self,
        fields: MatRef<'_, f64>,
        quadruples: &[[usize; 4]],
    ) -> Result<Vec<f64>, BuildError> {
        let question =
            || self.about_the_body("energies of second order").with("fields", &fields).with("quadruples", quadruples);
        self.ask_list(question, quadruples.len(), || {
            self.pass_elements();
            Ok(second_order_energies(&self.assembled.mesh, self.assembled.materials()?, fields, quadruples)?)
        })
    }

    fn stress_sites(&self) -> Result<&StressSites, BuildError> {
        Ok(self.recovery()?.sites())
    }

    fn nodal_stress(&self, displacements: MatRef<'_, f64>) -> Result<Mat<f64>, BuildError> {
        let question = || self.about_the_body("nodal stress").with("displacements", &displacements);
        self.ask_stress(question, displacements.ncols(), |recovery| recovery.nodal_stress(displacements))
    }

    fn second_order_nodal_stress(&self, fields: MatRef<'_, f64>, pairs: &[[usize; 2]]) -> Result<Mat<f64>, BuildError> {
        let question =
            || self.about_the_body("nodal stress of second order").with("fields", &fields).with("pairs", pairs);
        self.ask_stress(question, pairs.len(), |recovery| recovery.second_order_nodal_stress(fields, pairs))
    }

    fn lowest_buckling_ratio(
        &self,
        response: MatRef<'_, f64>,
        modes: &Modes,
        accuracy: BucklingAccuracy,
    ) -> Result<f64, BuildError> {
        let shapes = modes.shapes.as_ref();
        let question = || {
            let accuracy = match accuracy {
                BucklingAccuracy::Estimate => "estimate",
                BucklingAccuracy::Full => "full",
            };
            let question = self.about_the_held_body("buckling").with("accuracy", accuracy);
            question.with("response", &response).with("shapes", &shapes)
        };
        let found = self.ask_list(question, 1, || {
            let materials = self.assembled.materials()?;
            let product = |fields: MatRef<'_, f64>| -> Result<Mat<f64>, BucklingError> {
                self.pass_elements();
                Ok(geometric_stiffness_product(&self.assembled.mesh, materials, response, fields)?)
            };
            match self.solver()?.lowest_buckling_ratio(shapes, accuracy, product) {
                Ok(lowest) => Ok(vec![lowest]),
                Err(BucklingError::Modal(error)) => Err(modal(&self.assembled.scene)(error)),
                Err(BucklingError::Assembly(error)) => Err(error.into()),
            }
        })?;
        Ok(found.first().copied().unwrap_or_default())
    }
}

/// Errors in the search for the buckling load.
#[derive(Debug, thiserror::Error)]
enum BucklingError {
    #[error(transparent)]
    Modal(#[from] ModalError),
    #[error(transparent)]
    Assembly(#[from] AssemblyError),
}

/// A question with modes; the rigid ones follow from the body and its support.
fn with_modes(question: Key, modes: &Modes) -> Key {
    question.with("eigenvalues", &modes.eigenvalues).with("modes", &modes.shapes)
}

/// A question with the natural ones of some modes.
fn with_natural(question: Key, modes: &Modes) -> Key {
    let natural = modes.natural();
    question.with("eigenvalues", &modes.eigenvalues[..natural]).with("modes", &modes.shapes.get(.., ..natural))
}
