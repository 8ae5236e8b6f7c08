//! The finite-element side of a body: all that depends on its mesh and takes long.
//!
//! Each value follows from the body, its support and what it is asked with, and is kept under a key of these. So matrices are
//! assembled and factored only where a value is not known. The functions of `modal` and `fem_tet10` with these names say more.

pub(crate) mod kept;
pub(crate) mod remainders;
mod rigid_patch;
mod second_order;
pub(crate) mod statics;
mod stress;

use std::cell::{Cell, OnceCell, RefCell};
use std::path::{Path, PathBuf};

use dynamics::DrivenMotion;
use faer::{ColRef, Mat, MatRef, Scale};
use fem_tet10::StressRecovery;
use keys::{Key, Keyed};
use modal::{
    ModalError, Modes, NoCycles, Solver, StaticAccuracy, acceleration_fields, centrifugal_fields, mass_left_out,
    turning_field,
};
use nalgebra::Vector3;
use reduced_body::ReducedBody;
use slepc::write_folder;

use crate::body::origin::Origin;
use crate::building::assembly::{AssembledMesh, MadeOf};
use crate::building::progress::{BuildProgress, BuildWork};
use crate::cache::Computing;
use crate::cache::kept::Keep;
use crate::cache::store::Store;
use crate::error::{BuildError, modal, too_many_modes};
use crate::mesh::fe_matrices::FeMatrices;
use crate::mesh::given::{MatrixChecks, refuse_matrix};
use crate::reduction::reference::Reference;
use crate::structure::kept::{Basis, Found, StaticResponses};
use crate::structure::rigid_patch::rigid_rows;

/// The finite-element side of a body.
pub(crate) struct Structure<'a> {
    assembled: &'a AssembledMesh,
    solver: OnceCell<Solver<'a>>,
    recovery: OnceCell<StressRecovery<'a>>,
    element_passes: Cell<usize>,
    /// Held from the first value that has to be computed on, until a model is done.
    computing: RefCell<Option<Computing>>,
}

/// Forces that static responses are asked for, side by side.
pub(crate) struct StaticForces<'a> {
    /// Forces of the loads (3n×k).
    pub of_loads: MatRef<'a, f64>,
    /// True if the centrifugal fields of the pairs of spins follow.
    pub spin: bool,
    /// The driven motion whose inertia comes last.
    pub drive: Option<DrivenMotion>,
    /// The point that positions are measured from.
    pub origin: Vector3<f64>,
}

impl StaticForces<'_> {
    /// How many there are.
    pub fn count(&self) -> usize {
        self.of_loads.ncols() + if self.spin { 6 } else { 0 } + usize::from(self.drive.is_some())
    }
}

/// The key of a value; none where nothing is kept.
struct Asked(Option<Key>);

impl Asked {
    fn with<T: Keyed + ?Sized>(self, name: &str, part: &T) -> Self {
        Self(self.0.map(|key| key.with(name, part)))
    }

    /// With modes; the rigid ones follow from the body and its support.
    fn with_modes(self, modes: &Modes) -> Self {
        self.with("eigenvalues", &modes.eigenvalues).with("modes", &modes.shapes)
    }

    /// With the natural ones of some modes.
    fn with_natural(self, modes: &Modes) -> Self {
        let natural = modes.natural();
        self.with("eigenvalues", &modes.eigenvalues[..natural]).with("modes", &modes.shapes.get(.., ..natural))
    }
}

impl<'a> Structure<'a> {
    /// Errors of the matrices come at once where nothing is kept.
    pub fn new(assembled: &'a AssembledMesh) -> Result<Self, BuildError> {
        let structure = Self {
            assembled,
            solver: OnceCell::new(),
            recovery: OnceCell::new(),
            element_passes: Cell::default(),
            computing: RefCell::default(),
        };
        assembled.reference()?;
        if assembled.store.is_none() {
            structure.solver()?;
        }
        Ok(structure)
    }

    /// Lets other threads compute, and other bodies of this one.
    pub fn rest(&self) {
        self.computing.replace(None);
    }

    /// The key of a value of the body whatever holds it.
    fn of_body(&self, what: &str) -> Asked {
        let start = self.assembled.store.as_ref().map(|store| store.key().of(what, 1));
        match self.reference() {
            Some(reference) => Asked(start).with("reference", &reference.hash),
            None => Asked(start),
        }
    }

    /// The key of a value of the body with its support.
    fn of_held_body(&self, what: &str) -> Asked {
        self.of_body(what).with("support", &self.assembled.support)
    }

    /// The value that was asked for: it is read where it is kept, and else computed and kept.
    fn ask<T: Keep>(
        &self,
        Asked(key): Asked,
        known: T::Known<'_>,
        compute: impl FnOnce() -> Result<T, BuildError>,
    ) -> Result<T, BuildError> {
        let (Some(store), Some(key)) = (&self.assembled.store, key.map(Key::finish)) else { return compute() };
        if let Some(value) = store.recall(&key, known)? {
            return Ok(value);
        }
        if self.computing.borrow().is_none() {
            *self.computing.borrow_mut() = Some(self.assembled.builder.cache.computing());
            // Another thread may have computed it in the meantime.
            if let Some(value) = store.recall(&key, known)? {
                return Ok(value);
            }
        }
        let value = compute()?;
        store.keep(&key, &value);
        Ok(value)
    }

    fn ask_number(&self, asked: Asked, compute: impl FnOnce() -> Result<f64, BuildError>) -> Result<f64, BuildError> {
        Ok(self.ask(asked, 1, || Ok(vec![compute()?]))?.first().copied().unwrap_or_default())
    }

    fn solver(&self) -> Result<&Solver<'a>, BuildError> {
        if let Some(found) = self.solver.get() {
            return Ok(found);
        }
        let solver = self.assembled.solver(self.matrices()?, self.positions()?);
        let solver = solver.map_err(|error| self.refuse(error))?;
        Ok(self.solver.get_or_init(|| solver))
    }

    /// About the reference.
    fn matrices(&self) -> Result<&'a FeMatrices, BuildError> {
        self.assembled.tangent()
    }

    /// The nodes of the reference.
    fn positions(&self) -> Result<&'a [[f64; 3]], BuildError> {
        self.assembled.positions()
    }

    /// The bent body that the modes are about.
    pub fn reference(&self) -> Option<&'a Reference> {
        // It was found when this was made.
        self.assembled.reference().ok().flatten()
    }

    fn recovery(&self) -> Result<&StressRecovery<'a>, BuildError> {
        if let Some(found) = self.recovery.get() {
            return Ok(found);
        }
        let recovery = StressRecovery::new(&self.assembled.mesh, self.assembled.materials()?)?;
        Ok(self.recovery.get_or_init(|| recovery))
    }

    fn pass_elements(&self) {
        self.element_passes.set(self.element_passes.get() + 1);
    }

    /// Error of the modal analysis, in words of the files where the matrices come from files.
    fn refuse(&self, error: ModalError) -> BuildError {
        let AssembledMesh { scene, body, mesh, .. } = self.assembled;
        match body {
            MadeOf::Elements(_) => modal(scene)(error),
            MadeOf::Files(files) => refuse_matrix(scene, files, mesh, error),
        }
    }

    /// Static responses to forces (3n×k), from the natural ones of the modes on.
    fn solve(&self, modes: &Modes, forces: MatRef<'_, f64>, accuracy: StaticAccuracy) -> Result<Mat<f64>, BuildError> {
        self.solver()?.static_response_from(modes, forces, accuracy).map_err(|error| self.modal(error))
    }

    /// The body in the coordinates of its modes.
    fn reduced(&self, modes: &Modes) -> Result<ReducedBody, BuildError> {
        let positions = self.positions()?;
        modes.reduced_by(self.solver()?.mass(), positions).map_err(|error| self.modal(error))
    }

    /// The body in the coordinates of modes with a static answer among them.
    pub fn with_answer(&self, modes: &Modes) -> Result<ReducedBody, BuildError> {
        let asked = self.of_held_body("body with an answer").with_modes(modes).with("natural", &modes.natural());
        self.ask(asked, modes, || self.reduced(modes))
    }

    fn modal(&self, error: ModalError) -> BuildError {
        modal(&self.assembled.scene)(error)
    }

    fn rows(&self) -> usize {
        self.assembled.dofs() * self.assembled.mesh.positions().len()
    }

    /// Hash of the support, in hexadecimal digits.
    pub fn support_hash(&self) -> String {
        self.assembled.support.key(Key::new()).finish().to_string()
    }

    /// Work of the mesh's size that was done up to now.
    pub fn work(&self) -> BuildWork {
        let [blocks, columns] = self.solver.get().map_or([0; 2], Solver::solved);
        BuildWork { blocks, columns, element_passes: self.element_passes.get() }
    }

    /// The reason that a factor that takes long was made, where multigrid cycles could not take its place.
    pub fn no_cycles(&self) -> Option<&NoCycles> {
        self.solver.get().and_then(Solver::no_cycles)
    }

    /// Number of flexible modes that there are.
    pub fn available(&self) -> Result<usize, BuildError> {
        Ok(self.solver()?.available())
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
            .map_err(|source| self.modal(ModalError::Engine(source)))
    }

    /// Refuses a body file that was made for other modes or another support: these are what takes long.
    fn refuse_other_body(&self, flexible: usize) -> Result<(), BuildError> {
        let Some(file) = self.assembled.store.as_ref().and_then(Store::given) else { return Ok(()) };
        let origin = Origin::read(file)?;
        let help = "give the scene what the file was made for, or make the file again: flexframe reduce SCENE -o FILE, from a \
                    scene without `file`";
        let (found, expected) = if origin.support != self.support_hash() {
            (
                "a body file of a body that is held otherwise".to_owned(),
                "one with the constraints of the scene".to_owned(),
            )
        } else if origin.reference != self.reference().map(|reference| reference.hash.to_string()) {
            let found = match origin.reference {
                Some(_) => "a body file with modes about a bent body that is not that of the scene",
                None => "a body file with modes about the undeformed body",
            };
            (found.to_owned(), "one with the modes of `about` in [modes]".to_owned())
        } else {
            (format!("a body file with {} modes", origin.modes), format!("one with {flexible}, as [modes] asks"))
        };
        Err(self.assembled.scene.refuse("body.file", found, expected, help).into())
    }
}

/// The values.
impl Structure<'_> {
    /// The rigid and the `flexible` lowest other modes, the body in them, and what else is known once the matrices are there.
    pub fn modes(&self, flexible: usize, progress: &mut dyn FnMut(BuildProgress)) -> Result<Found, BuildError> {
        let AssembledMesh { support, mesh, body, .. } = self.assembled;
        let weights = match body {
            MadeOf::Elements(body) if body.tied_masses.is_empty() => [mesh.positions().len(), 1],
            MadeOf::Elements(_) | MadeOf::Files(_) => [self.rows(), 3],
        };
        let asked = self.of_held_body("modes").with("flexible", &flexible);
        self.ask(asked, (self.rows(), flexible, support.motion, weights), || {
            self.refuse_other_body(flexible)?;
            if self.solver.get().is_none() {
                progress(BuildProgress::Assembly);
            }
            let solver = self.solver()?;
            let modes = solver.modes(flexible, |p| progress(BuildProgress::Modes(p))).map_err(|error| match error {
                ModalError::TooManyModes { .. } => too_many_modes(&self.assembled.scene, error),
                other => self.refuse(other),
            })?;
            let weights = match body {
                MadeOf::Elements(body) if body.tied_masses.is_empty() => {
                    let masses = solver.mass().row_sums();
                    MatRef::from_column_major_slice(&masses, masses.len(), 1).to_owned()
                }
                MadeOf::Elements(_) | MadeOf::Files(_) => acceleration_fields(solver.mass()),
            };
            let (body, matrix_bytes) = (self.reduced(&modes)?, self.matrices()?.bytes());
            Ok(Found { modes, body, weights, available: solver.available(), matrix_bytes })
        })
    }

    /// Checks of the matrices, of a body of matrices from another program, with the part of the mass that the motion in these
    /// modes leaves out of the mass.
    pub fn checks(&self, modes: &Modes) -> Result<Option<MatrixChecks>, BuildError> {
        let Some(checks) = self.assembled.checks else { return Ok(None) };
        if checks.is_scalar_mass || modes.shapes.ncols() == 0 {
            return Ok(Some(checks));
        }
        let asked = self.of_body("mass left out").with_modes(modes);
        let left_out = self.ask_number(asked, || Ok(mass_left_out(self.solver()?.mass(), modes)))?;
        Ok(Some(MatrixChecks { left_out, ..checks }))
    }

    /// Static responses to forces, from the natural ones of the modes on (3n×count).
    pub fn static_responses(&self, modes: &Modes, forces: &StaticForces<'_>) -> Result<StaticResponses, BuildError> {
        let StaticForces { of_loads, spin, drive, origin } = forces;
        let asked = self.of_held_body("static responses").with_natural(modes);
        let asked = asked.with("loads", of_loads).with("spin", spin).with("drive", drive).with("origin", origin);
        // Of the spins and of the drive.
        let of_inertia = forces.count() - of_loads.ncols();
        let asked = asked.with("remainders", &of_inertia);
        self.ask(asked, [self.rows(), forces.count(), of_inertia], || {
            let solver = self.solver()?;
            let solve = |forces| self.solve(modes, forces, StaticAccuracy::Full);
            if forces.count() == of_loads.ncols() {
                return Ok(StaticResponses { fields: solve(*of_loads)?, remainders: Vec::new() });
            }
            let (mass, positions) = (solver.mass(), self.positions()?);
            let mut all = Mat::zeros(of_loads.nrows(), forces.count());
            all.as_mut().subcols_mut(0, of_loads.ncols()).copy_from(of_loads);
            let mut next = of_loads.ncols();
            let mut add = |fields: Mat<f64>| {
                all.as_mut().subcols_mut(next, fields.ncols()).copy_from(&fields);
                next += fields.ncols();
            };
            if *spin {
                add(centrifugal_fields(mass, positions, origin).map_err(|error| self.modal(error))?);
            }
            match drive {
                Some(DrivenMotion::Slide { direction }) => {
                    add(acceleration_fields(mass) * Mat::from_fn(3, 1, |i, _| direction[i]));
                }
                Some(DrivenMotion::Turn { axis }) => {
                    add(turning_field(mass, positions, origin, axis).map_err(|error| self.modal(error))?);
                }
                None => {}
            }
            let fields = solve(all.as_ref())?;
            let of_inertia = fields.subcols(of_loads.ncols(), of_inertia);
            let momenta = mass.product(of_inertia);
            let natural = modes.shapes.get(.., ..modes.natural());
            let remainder = |(u, mu): (ColRef<'_, f64>, ColRef<'_, f64>)| {
                let carried: f64 = natural.col_iter().map(|shape| (shape.transpose() * mu).powi(2)).sum();
                (u.transpose() * mu - carried).max(0.0).sqrt()
            };
            let remainders = of_inertia.col_iter().zip(momenta.as_ref().col_iter()).map(remainder).collect();
            Ok(StaticResponses { fields, remainders })
        })
    }

    /// Natural modes with shapes after them that make them span static responses (3n×k each), and the body in these.
    pub fn basis(&self, natural: &Modes, responses: &[&Mat<f64>]) -> Result<Basis, BuildError> {
        let asked = self.of_held_body("basis").with_modes(natural).with("lists", &responses.len());
        let asked = responses.iter().fold(asked, |asked, responses| asked.with("responses", *responses));
        self.ask(asked, natural, || {
            let modes = responses.iter().try_fold(natural.clone(), |modes, responses| {
                self.solver()?.with_static_shapes(modes, responses.as_ref()).map_err(|error| self.modal(error))
            })?;
            Ok(Basis { body: self.reduced(&modes)?, modes })
        })
    }

    /// The modes and static shapes in which each of these patches of nodes moves as a rigid body, and the body in them.
    pub fn with_rigid_patches(&self, modes: &Modes, dofs: usize, patches: &[&[u32]]) -> Result<Basis, BuildError> {
        let positions = self.positions()?;
        let of_patches: Vec<Mat<f64>> = patches.iter().map(|nodes| rigid_rows(modes, dofs, positions, nodes)).collect();
        let count = of_patches.iter().map(Mat::nrows).sum();
        let mut rows = Mat::zeros(count, modes.shapes.ncols());
        let mut first = 0;
        for of_patch in &of_patches {
            rows.as_mut().subrows_mut(first, of_patch.nrows()).copy_from(of_patch);
            first += of_patch.nrows();
        }
        let modes = modes.restricted(rows.as_ref()).map_err(|error| self.modal(error))?;
        Ok(Basis { body: self.reduced(&modes)?, modes })
    }

    /// The modes with motions of the support after them, which the rest of the body follows, and the body in these.
    pub fn with_motions(&self, modes: &Modes, motions: MatRef<'_, f64>) -> Result<Basis, BuildError> {
        let asked = self.of_held_body("motions of supports").with_modes(modes).with("natural", &modes.natural());
        self.ask(asked.with("motions", &motions), modes, || {
            let forces = self.matrices()?.stiffness() * motions * Scale(-1.0);
            let motions = motions + self.solve(modes, forces.as_ref(), StaticAccuracy::Full)?;
            let (size, shapes) = (modes.shapes.nrows(), modes.shapes.ncols());
            let mut extended = modes.clone();
            let all = Mat::from_fn(size, shapes + motions.ncols(), |i, j| {
                if j < shapes { modes.shapes[(i, j)] } else { motions[(i, j - shapes)] }
            });
            // They have no frequency; the equations of motion do not meet them.
            extended.append(vec![1.0; motions.ncols()], all);
            Ok(Basis { body: self.reduced(&extended)?, modes: extended })
        })
    }

    /// Fields (3n×k) without their parts along some modes.
    pub fn without_parts(
        &self,
        modes: &Modes,
        list: &[usize],
        fields: MatRef<'_, f64>,
    ) -> Result<Mat<f64>, BuildError> {
        let asked = self.of_body("fields without parts").with_modes(modes).with("list", list).with("fields", &fields);
        self.ask(asked, [fields.nrows(), fields.ncols()], || {
            let shapes = shapes_of(modes, list);
            self.solver()?.freed(fields, shapes.as_ref(), shapes.as_ref()).map_err(|error| self.modal(error))
        })
    }
}

/// The shapes (3n×k) of some modes, numbered from 0.
pub(crate) fn shapes_of(modes: &Modes, list: &[usize]) -> Mat<f64> {
    Mat::from_fn(modes.shapes.nrows(), list.len(), |i, j| modes.shapes[(i, list[j])])
}
