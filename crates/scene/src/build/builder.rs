//! Models of one body that differ in their effects and modes.

use std::path::{Path, PathBuf};
use std::time::Duration;

use dynamics::Effect;
use modal::Modes;

use super::assembly::{Assembled, AssembledMesh, Assembly};
use super::error::BuildError;
use super::model::Model;
use super::progress::{BuildProgress, BuildTimes, BuildWork, timed};
use super::solved::Solved;
use super::structure::Structure;
use super::{meshed, rigid};
use crate::effects::Choice;
use crate::scene::{RigidBody, Scene};

/// Makes models of an [`Assembly`] that differ in their effects and modes. The matrices are factored once, and modes are
/// searched again only where more of them are asked for.
pub struct ModelBuilder<'a>(Builder<'a>);

enum Builder<'a> {
    Meshed(Box<MeshedBuilder<'a>>),
    Rigid(&'a RigidBody),
}

struct MeshedBuilder<'a> {
    assembled: &'a AssembledMesh,
    solved: Solved<'a>,
    /// The most that have been searched so far.
    modes: Option<Modes>,
}

impl Assembly {
    /// The builder of models of it.
    ///
    /// # Errors
    /// [`BuildError`]: what the modal analysis refuses in the matrices and the support.
    pub fn builder(&self) -> Result<ModelBuilder<'_>, BuildError> {
        Ok(ModelBuilder(match &self.0 {
            Assembled::Meshed(assembled) => {
                let solved = Solved::new(assembled)?;
                Builder::Meshed(Box::new(MeshedBuilder { assembled, solved, modes: None }))
            }
            Assembled::Rigid(body) => Builder::Rigid(body),
        }))
    }
}

impl<'a> ModelBuilder<'a> {
    /// The model of a scene, which may differ from that of the assembly in its effects and modes.
    ///
    /// # Errors
    /// As [`Model::build`].
    pub fn build(&mut self, scene: &Scene, mut progress: impl FnMut(BuildProgress)) -> Result<Model, BuildError> {
        match &mut self.0 {
            Builder::Meshed(builder) => builder.build(scene, &mut progress),
            Builder::Rigid(body) => rigid::build(scene, body),
        }
    }

    /// Writes the problem of the modes that a scene asks for into a folder, to be solved elsewhere by SLEPc on a number of ranks
    /// ([`slepc::write_folder`]). Returns the files.
    ///
    /// # Errors
    /// As [`Assembly::builder`], and of a body without modes.
    pub fn write_problem(&self, scene: &Scene, folder: &Path, ranks: usize) -> Result<Vec<PathBuf>, BuildError> {
        match (self.solved(), requested(scene)) {
            (Some(solved), modes @ 1..) => solved.write_problem(modes, folder, ranks),
            (None, _) => {
                let help = "run the scene as it is: a rigid body has no modes";
                Err(scene.refuse("body.rigid", "a rigid body", "a body with a mesh, or with matrices", help).into())
            }
            (_, 0) => Err(scene.refuse("modes.flexible", "no modes", "one or more", "ask for modes").into()),
        }
    }

    /// Work of the mesh's size that was done up to now; none without a mesh.
    pub fn work(&self) -> BuildWork {
        self.solved().map_or_else(BuildWork::default, Solved::work)
    }

    /// The finite-element model, of a body with a mesh.
    pub(super) fn solved(&self) -> Option<&Solved<'a>> {
        match &self.0 {
            Builder::Meshed(builder) => Some(&builder.solved),
            Builder::Rigid(_) => None,
        }
    }

    /// The same, by a builder that is not needed any longer: it keeps no modes for others.
    pub(super) fn into_model(
        self,
        scene: &Scene,
        mut progress: impl FnMut(BuildProgress),
    ) -> Result<Model, BuildError> {
        match self.0 {
            Builder::Meshed(builder) => {
                let (modes, time) = builder.search(scene, &mut progress)?;
                builder.reduce(scene, modes, time, &mut progress)
            }
            Builder::Rigid(body) => rigid::build(scene, body),
        }
    }

    /// Number of flexible modes that there are.
    ///
    /// # Errors
    /// As [`Assembly::builder`].
    pub fn available(&self) -> Result<usize, BuildError> {
        match &self.0 {
            Builder::Meshed(builder) => builder.solved.available(),
            Builder::Rigid(_) => Ok(0),
        }
    }
}

impl MeshedBuilder<'_> {
    fn build(&mut self, scene: &Scene, progress: &mut dyn FnMut(BuildProgress)) -> Result<Model, BuildError> {
        let requested = requested(scene);
        let (modes, time) = match self.modes.take().filter(|modes| modes.natural() >= requested) {
            Some(modes) => (modes, Duration::ZERO),
            None => self.search(scene, progress)?,
        };
        let model = self.reduce(scene, modes.truncated(requested), time, progress);
        self.modes = Some(modes);
        model
    }

    /// The modes that a scene asks for, and how long that took.
    fn search(&self, scene: &Scene, progress: &mut dyn FnMut(BuildProgress)) -> Result<(Modes, Duration), BuildError> {
        let mut time = Duration::ZERO;
        let modes = timed(&mut time, || self.solved.modes(requested(scene), progress))?;
        Ok((modes, time))
    }

    fn reduce(
        &self,
        scene: &Scene,
        modes: Modes,
        search: Duration,
        progress: &mut dyn FnMut(BuildProgress),
    ) -> Result<Model, BuildError> {
        let times = BuildTimes { modes: search, assembly: self.assembled.assembly_time(), ..self.assembled.times };
        meshed::reduce(scene, self.assembled, &self.solved, modes, times, progress)
    }
}

/// How many modes a scene asks for.
pub(super) fn requested(scene: &Scene) -> usize {
    match scene.effects.choices[Effect::Flexibility] {
        Choice::Off => 0,
        Choice::On | Choice::Auto => scene.modes.flexible.most(),
    }
}
