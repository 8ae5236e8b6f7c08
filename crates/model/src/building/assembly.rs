//! The base that all models of a body share, whatever effects and modes they have: its mesh and its matrices.

use std::sync::{Arc, OnceLock};
use std::time::Duration;

use advice::RestOfBody;
use dynamics::{Drive, Effect};
use fem_tet10::{Materials, Matrices, Mesh};
use matrix_import::MatrixFiles;
use mesh_import::Imported;
use modal::{ModalError, Solver, Support};
use scene::{About, Body, BodySource, Choice, Constraint, Flexible, Initial, Load, MeshedBody, RigidBody};

use crate::body::given::read_body_file;
use crate::building::builder::Builder;
use crate::building::progress::{BuildProgress, BuildTimes, timed};
use crate::cache::store::Store;
use crate::error::{BuildError, modal};
use crate::mesh::doubt::doubts;
use crate::mesh::fe_matrices::FeMatrices;
use crate::mesh::given::{Given, MatrixChecks};
use crate::mesh::others::{other_masses, other_materials, other_ties};
use crate::mesh::read::{matrices, mesh_file, mesh_in, tied_points};
use crate::needs::{Needed, Needs};
use crate::reduction::reference::Reference;
use crate::reduction::reference::found::Asked;
use crate::support::support;

/// The mesh and the matrices of the body of a scene, and what holds it.
pub struct Assembly(pub(crate) Assembled);

pub(crate) enum Assembled {
    Meshed(Box<AssembledMesh>),
    Rigid(RigidBody),
}

/// The data of a scene that an [`Assembly`] follows from: scenes with equal data may share it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct AssemblyInput<'a> {
    source: &'a BodySource,
    constraint: Option<&'a Constraint>,
    flexible: Flexible,
    flexibility: Choice,
    initial: Option<&'a Initial>,
    about: Option<Rest<'a>>,
}

/// The rest that modes are about: with the loads, the attitude at the start and the end of the run.
type Rest<'a> = (About, &'a [Load], Option<[f64; 4]>, f64);

/// Source of the matrices of a body.
pub(crate) enum MadeOf {
    Elements(MeshedBody),
    Files(MatrixFiles),
}

pub(crate) struct AssembledMesh {
    pub builder: Builder,
    /// For messages.
    pub scene: Body,
    pub body: MadeOf,
    pub mesh: Arc<Mesh>,
    /// Notes about the parts of the mesh file that were left out.
    pub mesh_notes: Vec<String>,
    /// The matrices, where they are needed: where values are known, none are.
    matrices: OnceLock<(FeMatrices, Duration)>,
    /// The bent body that the modes are about, if the scene asks for one, and its matrices.
    reference: OnceLock<Option<Reference>>,
    tangent: OnceLock<FeMatrices>,
    /// Checks of matrices from another program.
    pub checks: Option<MatrixChecks>,
    pub support: Support,
    pub drive: Option<Drive>,
    /// Where values are kept from run to run.
    pub store: Option<Store>,
    pub times: BuildTimes,
}

impl Builder {
    /// Reads the mesh of a scene, and assembles its matrices, for models that differ in their effects and modes.
    ///
    /// # Errors
    /// [`BuildError`]: what the mesh, the materials or the supports refuse.
    pub fn assemble(&self, body: &Body, mut progress: impl FnMut(BuildProgress)) -> Result<Assembly, BuildError> {
        let (meshed, given) = match &body.source {
            BodySource::Meshed(meshed) => (meshed.clone(), None),
            BodySource::File(given) => {
                let (file, meshed) = read_body_file(self, body, given)?;
                (meshed, Some(file))
            }
            BodySource::Matrices(files) => return self.assemble_matrices(body, files, progress),
            BodySource::Rigid(meshed) => return Ok(Assembly(Assembled::Rigid(*meshed))),
        };
        let mut times = BuildTimes::default();
        progress(BuildProgress::Mesh);
        let read = || {
            // It is read once: the values that are kept and the mesh are of the same bytes.
            let file = if given.is_none() { Some(mesh_file(self, body, &meshed)?) } else { None };
            let store = Store::open(&self.cache, &meshed, given, file.as_ref())?;
            let made = || match &file {
                Some(file) => mesh_in(self, body, file),
                None => mesh_in(self, body, &mesh_file(self, body, &meshed)?),
            };
            let imported = match &store {
                Some(store) => store.mesh(body, &meshed, made)?,
                None => made()?,
            };
            Ok::<_, BuildError>((store, imported))
        };
        let (store, Imported { mesh, notes: mut mesh_notes, materials, beside }) = timed(&mut times.mesh, read)?;
        mesh_notes.extend(other_materials(&mesh, &materials, &meshed.materials));
        mesh_notes.extend(other_masses(&mesh, &beside, &meshed));
        mesh_notes.extend(other_ties(&beside, &body.markers, &meshed));
        let mesh = Arc::new(mesh);
        doubts(body, self.needed(body).loads, &meshed, &mesh)
            .into_iter()
            .for_each(|doubt| progress(BuildProgress::Doubt(doubt)));
        let (support, drive) = support(body, Some((&mesh, 3)))?;
        let assembled = AssembledMesh {
            builder: self.clone(),
            scene: body.clone(),
            body: MadeOf::Elements(meshed),
            mesh,
            mesh_notes,
            matrices: OnceLock::new(),
            reference: OnceLock::new(),
            tangent: OnceLock::new(),
            checks: None,
            support,
            drive,
            store,
            times,
        };
        if assembled.store.is_none() {
            progress(BuildProgress::Assembly);
            assembled.matrices()?;
        }
        Ok(Assembly(Assembled::Meshed(Box::new(assembled))))
    }

    /// The same of matrices from another program, which are read each time.
    fn assemble_matrices(
        &self,
        body: &Body,
        files: &MatrixFiles,
        mut progress: impl FnMut(BuildProgress),
    ) -> Result<Assembly, BuildError> {
        let mut times = BuildTimes::default();
        progress(BuildProgress::Mesh);
        let given = timed(&mut times.mesh, || Given::read(body, files))?;
        let Given { nodes, hash, notes: mesh_notes, matrices, checks } = given;
        let mesh = Arc::new(nodes);
        let store = Store::of_matrices(&self.cache, hash);
        let (support, drive) = support(body, Some((&mesh, checks.dofs)))?;
        let assembled = AssembledMesh {
            builder: self.clone(),
            scene: body.clone(),
            body: MadeOf::Files(files.clone()),
            mesh,
            mesh_notes,
            matrices: OnceLock::from((matrices, Duration::ZERO)),
            reference: OnceLock::from(None),
            tangent: OnceLock::new(),
            checks: Some(checks),
            support,
            drive,
            store,
            times,
        };
        Ok(Assembly(Assembled::Meshed(Box::new(assembled))))
    }
}

impl Assembly {
    /// The data that the assembly of a body follows from with these needs.
    pub fn input<'a>(body: &'a Body, needs: &Needs) -> AssemblyInput<'a> {
        let Needed { modes, effects, loads, .. } = Needed::new(body, needs);
        let constraint = body.reduced_constraint();
        AssemblyInput {
            source: &body.source,
            constraint,
            flexible: modes.flexible,
            flexibility: effects.choices[Effect::Flexibility],
            // Such a support is checked against the state that the body begins with.
            initial: matches!(constraint, Some(Constraint::Support { .. })).then_some(&body.initial),
            // So is the rest that modes are about.
            about: modes.about.map(|about| (about, loads, body.initial.attitude, body.time.end)),
        }
    }

    /// The same without the matrices, which are assembled again where they are needed, for who keeps it for long.
    pub fn without_matrices(mut self) -> Self {
        if let Assembled::Meshed(assembled) = &mut self.0
            && let MadeOf::Elements(_) = assembled.body
        {
            assembled.matrices.take();
            assembled.tangent.take();
        }
        self
    }
}

impl AssembledMesh {
    /// Mass and stiffness, assembled at the first call.
    pub fn matrices(&self) -> Result<&FeMatrices, BuildError> {
        if let Some((found, _)) = self.matrices.get() {
            return Ok(found);
        }
        let mut time = Duration::ZERO;
        let MadeOf::Elements(body) = &self.body else { return Err(self.without_elements()) };
        let assembled = timed(&mut time, || {
            let points = tied_points(&self.scene, body, &self.mesh)?;
            FeMatrices::new(matrices(&self.scene, body, &self.mesh)?, points).map_err(modal(&self.scene))
        })?;
        self.builder.cache.note(|notes| notes.assembled += 1);
        Ok(&self.matrices.get_or_init(|| (assembled, time)).0)
    }

    /// The bent body that the modes are about, found at the first call; none of modes about the undeformed one.
    pub fn reference(&self) -> Result<Option<&Reference>, BuildError> {
        if let Some(found) = self.reference.get() {
            return Ok(found.as_ref());
        }
        let found = match self.needed().modes.about {
            Some(about) => self.asked()?.reference(about, || self.assembled_matrices())?,
            None => None,
        };
        Ok(self.reference.get_or_init(|| found).as_ref())
    }

    /// The rest of the full body in the spin and under the steady loads of the scene; not asked where none is made of such a body.
    pub fn rest_of_body(&self) -> Result<RestOfBody, BuildError> {
        match &self.body {
            MadeOf::Elements(body) if body.tied_masses.is_empty() => {
                self.asked()?.rest_of_body(|| self.assembled_matrices())
            }
            MadeOf::Elements(_) | MadeOf::Files(_) => Ok(RestOfBody::NotAsked),
        }
    }

    /// The solver of modes and statics of matrices on this mesh, with the engine of the builder.
    pub fn solver<'a>(&self, matrices: &'a FeMatrices, positions: &'a [[f64; 3]]) -> Result<Solver<'a>, ModalError> {
        let Self { mesh, support, builder, .. } = self;
        let mut solver = matrices.solver(positions, support)?;
        if let Some(edge_ends) = mesh.has_elements().then(|| mesh.edge_ends()).flatten() {
            solver = solver.with_edge_ends(edge_ends)?;
        }
        if let Some(slepc) = &builder.solver {
            solver = solver.with_engine(slepc.engine());
        }
        Ok(solver)
    }

    /// Mass and stiffness about the reference: of the undeformed body without one.
    pub fn tangent(&self) -> Result<&FeMatrices, BuildError> {
        let Some(reference) = self.reference()? else { return self.matrices() };
        if let Some(found) = self.tangent.get() {
            return Ok(found);
        }
        let found = FeMatrices::Assembled(self.asked()?.tangent(reference, self.assembled_matrices()?)?);
        Ok(self.tangent.get_or_init(|| found))
    }

    /// The part of the tangent stiffness by the stress of the reference that [`Self::tangent`] is without; none of a body that cannot turn,
    /// and without a reference.
    pub fn stress_tangent(&self) -> Result<Option<Matrices>, BuildError> {
        let Some(reference) = self.reference()? else { return Ok(None) };
        self.asked()?.stress_tangent(reference, self.assembled_matrices()?)
    }

    /// The body with the needs of its builder.
    pub fn needed(&self) -> Needed<'_> {
        self.builder.needed(&self.scene)
    }

    /// The body as a bent rest of it is asked for.
    fn asked(&self) -> Result<Asked<'_>, BuildError> {
        let Self { mesh, support, drive, store, .. } = self;
        let (drive, store) = (drive.as_ref(), store.as_ref());
        Ok(Asked { scene: self.needed(), mesh, materials: self.materials()?, support, drive, store })
    }

    fn assembled_matrices(&self) -> Result<&Matrices, BuildError> {
        match self.matrices()? {
            FeMatrices::Assembled(matrices) => Ok(matrices),
            FeMatrices::Tied { .. } | FeMatrices::Given { .. } => Err(self.without_elements()),
        }
    }

    /// The nodes of the reference: of the undeformed body without one.
    pub fn positions(&self) -> Result<&[[f64; 3]], BuildError> {
        Ok(self.reference()?.map_or(self.mesh.positions(), |reference| &reference.positions))
    }

    /// Degrees of freedom of a node.
    pub fn dofs(&self) -> usize {
        self.checks.map_or(3, |checks| checks.dofs)
    }

    /// The mesh file, the materials and the point masses of its elements.
    pub fn elements(&self) -> Option<&MeshedBody> {
        match &self.body {
            MadeOf::Elements(body) => Some(body),
            MadeOf::Files(_) => None,
        }
    }

    /// Materials of the elements.
    pub fn materials(&self) -> Result<&Materials, BuildError> {
        self.elements().map(|body| &body.materials).ok_or_else(|| self.without_elements())
    }

    /// The refusal of what needs elements.
    fn without_elements(&self) -> BuildError {
        let found = "a body of matrices, whose elements are not known";
        self.scene.refuse("body.matrices", found, "a body with elements", "give the body a mesh and a material").into()
    }

    /// How long the assembly took.
    pub fn assembly_time(&self) -> Duration {
        self.matrices.get().map_or(Duration::ZERO, |(_, time)| *time)
    }
}
