//! Models of one body that differ in their effects and modes.

use std::path::{Path, PathBuf};
use std::time::Duration;

use dynamics::Effect;
use scene::{Body, Choice, RigidBody, Scene};

use crate::building::assembly::{Assembled, AssembledMesh, Assembly};
use crate::building::builder::Builder;
use crate::building::progress::{BuildProgress, BuildTimes, BuildWork, timed};
use crate::error::BuildError;
use crate::model::Model;
use crate::needs::{Needed, Needs};
use crate::reduction::meshed;
use crate::reduction::rigid;
use crate::structure::Structure;
use crate::structure::kept::{Basis, Found};

/// Models of an [`Assembly`] that differ in their effects and modes. The matrices are factored once, and modes are
/// searched again only where more of them are asked for.
pub struct Variants<'a>(Of<'a>);

enum Of<'a> {
    Meshed(Box<MeshedVariants<'a>>),
    Rigid(&'a RigidBody),
}

struct MeshedVariants<'a> {
    assembled: &'a AssembledMesh,
    structure: Structure<'a>,
    /// The most that have been searched so far.
    found: Option<Found>,
}

impl Builder {
    /// Reads the mesh of a scene, finds its modes and reduces the body. `progress` hears what is being done.
    ///
    /// # Errors
    /// [`BuildError`]: what the mesh, the materials or the modes refuse, with the place in the scene file where
    /// there is one.
    pub fn build(&self, body: &Body, mut progress: impl FnMut(BuildProgress)) -> Result<Model, BuildError> {
        self.assemble(body, &mut progress)?.variants()?.into_model(&self.needed(body), progress)
    }

    /// The models of all bodies of a scene.
    ///
    /// # Errors
    /// As [`Builder::build`].
    pub fn models(&self, scene: &Scene, mut progress: impl FnMut(BuildProgress)) -> Result<Vec<Model>, BuildError> {
        scene.bodies.iter().map(|body| self.build(body, &mut progress)).collect()
    }
}

impl Model {
    /// The model of a scene by a [`Builder`] that keeps nothing.
    ///
    /// # Errors
    /// As [`Builder::build`].
    pub fn build(body: &Body, progress: impl FnMut(BuildProgress)) -> Result<Self, BuildError> {
        Builder::default().build(body, progress)
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
                let structure = Structure::new(assembled)?;
                Of::Meshed(Box::new(MeshedVariants { assembled, structure, found: None }))
            }
            Assembled::Rigid(body) => Of::Rigid(body),
        }))
    }
}

impl<'a> Variants<'a> {
    /// The model of a scene. Scene and needs may differ from those of the assembly in effects and modes.
    ///
    /// # Errors
    /// As [`Builder::build`].
    pub fn build(
        &mut self,
        given: &Body,
        needs: &Needs,
        mut progress: impl FnMut(BuildProgress),
    ) -> Result<Model, BuildError> {
        let given = &Needed::new(given, needs);
        match &mut self.0 {
            Of::Meshed(variants) => {
                let model = variants.build(given, &mut progress);
                variants.structure.rest();
                model
            }
            Of::Rigid(body) => rigid::build(given, body),
        }
    }

    /// Writes the problem of the modes that a scene asks for into a folder, to be solved elsewhere by SLEPc on a number of ranks
    /// ([`slepc::write_folder`]). Returns the files.
    ///
    /// # Errors
    /// As [`Assembly::variants`], and of a body without modes.
    pub fn write_problem(&self, body: &Body, folder: &Path, ranks: usize) -> Result<Vec<PathBuf>, BuildError> {
        let Of::Meshed(variants) = &self.0 else {
            let help = "run the scene as it is: a rigid body has no modes";
            return Err(body.refuse("body.rigid", "a rigid body", "a body with a mesh, or with matrices", help).into());
        };
        match requested(&variants.assembled.builder.needed(body)) {
            0 => Err(body.refuse("modes.flexible", "no modes", "one or more", "ask for modes").into()),
            modes => variants.structure.write_problem(modes, folder, ranks),
        }
    }

    /// Work of the mesh's size that was done up to now; none without a mesh.
    pub fn work(&self) -> BuildWork {
        self.structure().map_or_else(BuildWork::default, Structure::work)
    }

    /// The finite-element side, of a body with a mesh.
    pub(crate) fn structure(&self) -> Option<&Structure<'a>> {
        match &self.0 {
            Of::Meshed(variants) => Some(&variants.structure),
            Of::Rigid(_) => None,
        }
    }

    /// The same, where no others are wanted: it keeps no modes for them.
    pub(crate) fn into_model(
        self,
        scene: &Needed<'_>,
        mut progress: impl FnMut(BuildProgress),
    ) -> Result<Model, BuildError> {
        match self.0 {
            Of::Meshed(variants) => {
                let (found, time) = variants.search(scene, &mut progress)?;
                variants.reduce(scene, found, time, &mut progress)
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
            Of::Meshed(variants) => match &variants.found {
                Some(found) => Ok(found.available),
                None => {
                    let available = variants.structure.available();
                    variants.structure.rest();
                    available
                }
            },
            Of::Rigid(_) => Ok(0),
        }
    }
}

impl MeshedVariants<'_> {
    fn build(&mut self, scene: &Needed<'_>, progress: &mut dyn FnMut(BuildProgress)) -> Result<Model, BuildError> {
        let requested = requested(scene);
        let (found, time) = match self.found.take().filter(|found| found.modes.natural() >= requested) {
            Some(found) => (found, Duration::ZERO),
            None => self.search(scene, progress)?,
        };
        let first = if found.modes.natural() == requested {
            found.clone()
        } else {
            let Basis { modes, body } = self.structure.basis(&found.modes.truncated(requested), &[])?;
            Found { modes, body, weights: found.weights.clone(), ..found }
        };
        self.found = Some(found);
        self.reduce(scene, first, time, progress)
    }

    /// The modes that a scene asks for, and how long that took.
    fn search(
        &self,
        scene: &Needed<'_>,
        progress: &mut dyn FnMut(BuildProgress),
    ) -> Result<(Found, Duration), BuildError> {
        let mut time = Duration::ZERO;
        let found = timed(&mut time, || self.structure.modes(requested(scene), progress))?;
        Ok((found, time))
    }

    fn reduce(
        &self,
        scene: &Needed<'_>,
        found: Found,
        search: Duration,
        progress: &mut dyn FnMut(BuildProgress),
    ) -> Result<Model, BuildError> {
        let times = BuildTimes { modes: search, assembly: self.assembled.assembly_time(), ..self.assembled.times };
        meshed::reduce(scene, self.assembled, &self.structure, found, times, progress)
    }
}

/// How many modes a scene asks for.
pub(crate) fn requested(scene: &Needed<'_>) -> usize {
    match scene.effects.choices[Effect::Flexibility] {
        Choice::Off => 0,
        Choice::On | Choice::Auto => scene.modes.flexible.most(),
    }
}
