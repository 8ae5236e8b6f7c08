//! Models of one body that differ in their effects and modes.

use std::path::{Path, PathBuf};
use std::time::Duration;

use dynamics::Effect;
use modal::Modes;
use scene::{Choice, RigidBody, Scene};

use crate::assembly::{Assembled, AssembledMesh, Assembly};
use crate::builder::Builder;
use crate::error::BuildError;
use crate::model::Model;
use crate::progress::{BuildProgress, BuildTimes, BuildWork, timed};
use crate::reduction::meshed;
use crate::reduction::rigid;
use crate::structure::Structure;
use crate::structure::solved::Solved;

/// Models of an [`Assembly`] that differ in their effects and modes. The matrices are factored once, and modes are
/// searched again only where more of them are asked for.
pub struct Variants<'a>(Of<'a>);

enum Of<'a> {
    Meshed(Box<MeshedVariants<'a>>),
    Rigid(&'a RigidBody),
}

struct MeshedVariants<'a> {
    assembled: &'a AssembledMesh,
    solved: Solved<'a>,
    /// The most that have been searched so far.
    modes: Option<Modes>,
}

impl Builder {
    /// Reads the mesh of a scene, finds its modes and reduces the body. `progress` hears what is being done.
    ///
    /// # Errors
    /// [`BuildError`]: what the mesh, the materials or the modes refuse, with the place in the scene file where
    /// there is one.
    pub fn build(&self, scene: &Scene, mut progress: impl FnMut(BuildProgress)) -> Result<Model, BuildError> {
        self.assemble(scene, &mut progress)?.variants()?.into_model(scene, progress)
    }
}

impl Model {
    /// The model of a scene by a [`Builder`] that keeps nothing.
    ///
    /// # Errors
    /// As [`Builder::build`].
    pub fn build(scene: &Scene, progress: impl FnMut(BuildProgress)) -> Result<Self, BuildError> {
        Builder::default().build(scene, progress)
    }
}

impl Assembly {
    /// Models of it.
    ///
    /// # Errors
    /// [`BuildError`]: what the modal analysis refuses in the matrices and the support.
    pub fn variants(&self) -> Result<Variants<'_>, BuildError> {
        Ok(Variants(match &self.0 {
            Assembled::Meshed(assembled) => {
                let solved = Solved::new(assembled)?;
                Of::Meshed(Box::new(MeshedVariants { assembled, solved, modes: None }))
            }
            Assembled::Rigid(body) => Of::Rigid(body),
        }))
    }
}

impl<'a> Variants<'a> {
    /// The model of a scene, which may differ from that of the assembly in its effects and modes.
    ///
    /// # Errors
    /// As [`Builder::build`].
    pub fn build(&mut self, scene: &Scene, mut progress: impl FnMut(BuildProgress)) -> Result<Model, BuildError> {
        match &mut self.0 {
            Of::Meshed(variants) => variants.build(scene, &mut progress),
            Of::Rigid(body) => rigid::build(scene, body),
        }
    }

    /// Writes the problem of the modes that a scene asks for into a folder, to be solved elsewhere by SLEPc on a number of ranks
    /// ([`slepc::write_folder`]). Returns the files.
    ///
    /// # Errors
    /// As [`Assembly::variants`], and of a body without modes.
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
    pub(crate) fn solved(&self) -> Option<&Solved<'a>> {
        match &self.0 {
            Of::Meshed(variants) => Some(&variants.solved),
            Of::Rigid(_) => None,
        }
    }

    /// The same, where no others are wanted: it keeps no modes for them.
    pub(crate) fn into_model(
        self,
        scene: &Scene,
        mut progress: impl FnMut(BuildProgress),
    ) -> Result<Model, BuildError> {
        match self.0 {
            Of::Meshed(variants) => {
                let (modes, time) = variants.search(scene, &mut progress)?;
                variants.reduce(scene, modes, time, &mut progress)
            }
            Of::Rigid(body) => rigid::build(scene, body),
        }
    }

    /// Number of flexible modes that there are.
    ///
    /// # Errors
    /// As [`Assembly::variants`].
    pub fn available(&self) -> Result<usize, BuildError> {
        match &self.0 {
            Of::Meshed(variants) => variants.solved.available(),
            Of::Rigid(_) => Ok(0),
        }
    }
}

impl MeshedVariants<'_> {
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
pub(crate) fn requested(scene: &Scene) -> usize {
    match scene.effects.choices[Effect::Flexibility] {
        Choice::Off => 0,
        Choice::On | Choice::Auto => scene.modes.flexible.most(),
    }
}
