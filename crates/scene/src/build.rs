//! From a scene to a body that can move.

mod answer;
mod answers;
mod assembly;
mod backbones;
mod body_writer;
mod builder;
mod damping;
mod decide;
mod directed;
mod doubt;
mod error;
mod fe_matrices;
mod given;
mod history;
mod initial;
mod loads;
mod manifold;
mod mesh;
mod mesh_arrays;
mod mesh_model;
mod meshed;
mod modal_model;
mod model;
mod other_materials;
mod physics;
mod point_rotations;
mod points;
mod progress;
mod reduce;
mod rigid;
mod site_stress;
mod solved;
mod spin_stress;
mod statics;
mod store;
mod stress;
mod stress_left_out;
mod stress_shapes;
mod structure;
mod support;
mod support_reactions;
mod survey;
mod turning;

use fem_tet10::Mesh;

use crate::scene::{Body, Scene};

pub use assembly::Assembly;
pub use builder::ModelBuilder;
pub use doubt::{Doubt, doubts};
pub use error::{BuildError, StartError};
pub use given::MatrixChecks;
pub use model::{Meshed, Model};
pub use progress::{BuildProgress, BuildTimes, BuildWork};
pub use stress_shapes::{BodyStress, StressPeak};
pub use support_reactions::SupportRows;

impl Model {
    /// Reads the mesh of a scene, finds its modes and reduces the body. `progress` hears what is being done.
    ///
    /// # Errors
    /// [`BuildError`]: what the mesh, the materials or the modes refuse, with the place in the scene file where
    /// there is one.
    pub fn build(scene: &Scene, mut progress: impl FnMut(BuildProgress)) -> Result<Self, BuildError> {
        Assembly::new(scene, &mut progress)?.builder()?.into_model(scene, progress)
    }
}

impl Scene {
    /// Mass properties with each element's mass at its centroid, as the paper prints them.
    ///
    /// # Errors
    /// As [`Model::build`], for materials and point masses.
    pub fn centroid_lumped_inertia(&self, mesh: &Mesh) -> Result<Option<fem_tet10::LumpedInertia>, BuildError> {
        match &self.body {
            Body::Meshed(body) => {
                Ok(Some(fem_tet10::centroid_lumped_inertia(mesh, &body.materials, &body.point_masses)?))
            }
            Body::Matrices(_) | Body::Rigid(_) => Ok(None),
        }
    }
}
