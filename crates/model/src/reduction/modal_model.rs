//! A body and its loads in the coordinates of some modes.

use advice::Case;
use dynamics::Initial;
use faer::{ColRef, Mat};
use modal::Modes;
use nalgebra::Vector3;
use reduced_body::ReducedBody;

use crate::error::{BuildError, modal};
use crate::load::directed::Directed;
use crate::load::mesh_load::{BodyLoads, MeshLoad};
use crate::model::Size;
use crate::model::initial::initial;
use crate::reduction::damping::damping_ratios;
use crate::reduction::mesh_model::MeshModel;

/// A body and its loads in the coordinates of some modes.
pub(crate) struct ModalModel {
    pub body: ReducedBody,
    pub loads: BodyLoads,
    pub size: Size,
    pub damping_ratios: Vec<f64>,
    pub initial: Initial,
}

impl ModalModel {
    /// Without the stress stiffness of the spin.
    pub fn new(model: &MeshModel<'_, '_>, body: ReducedBody, modes: &Modes) -> Result<Self, BuildError> {
        let &MeshModel { scene, mesh, .. } = model;
        let loads = loads(model, &body, modes, &[])?;
        let peaks = modes.shapes.as_ref().col_iter().map(|shape| peak(shape, model.dofs)).collect();
        Ok(Self {
            loads,
            size: Size { length: mesh.diagonal(), peaks },
            damping_ratios: damping_ratios(scene, &body),
            initial: initial(scene, &body),
            body,
        })
    }

    /// The same model with a stress stiffness of the spin, or without any.
    pub fn with_stress_stiffness(
        self,
        model: &MeshModel<'_, '_>,
        spin: Option<&[Mat<f64>; 6]>,
    ) -> Result<Self, BuildError> {
        let body = self.body.with_stress_stiffness(spin.cloned()).map_err(modal(model.scene))?;
        Ok(Self { body, ..self })
    }

    /// The same model with loads in the modes of `body`, which may be the extended shapes of large modes, that stiffen it by
    /// the stress of each.
    pub fn with_stress(
        self,
        model: &MeshModel<'_, '_>,
        body: Option<&ReducedBody>,
        modes: &Modes,
        stress: &[Vec<Directed>],
    ) -> Result<Self, BuildError> {
        Ok(Self { loads: loads(model, body.unwrap_or(&self.body), modes, stress)?, ..self })
    }

    /// The run of the scene as [`advice`] sees it, where nothing is known of static responses and backbones.
    pub fn case<'a>(&'a self, model: &'a MeshModel<'_, '_>) -> Case<'a> {
        Case {
            body: &self.body,
            damping_ratios: &self.damping_ratios,
            loads: &self.loads.loads,
            is_gravity: &self.loads.is_gravity,
            drive: model.drive.as_ref(),
            initial: &self.initial,
            end: model.scene.time.end,
            length: self.size.length,
            length_unit: &model.scene.units.length,
            peaks: &self.size.peaks,
            static_compliances: &[],
            centrifugal_remainders: &[],
            drive_remainder: None,
            backbones: &[],
            manifold: None,
            coupling: None,
        }
    }
}

/// The loads on the modes of a body.
fn loads(
    model: &MeshModel<'_, '_>,
    body: &ReducedBody,
    modes: &Modes,
    stress: &[Vec<Directed>],
) -> Result<BodyLoads, BuildError> {
    let reduced = |(i, load): (usize, &MeshLoad)| {
        let of_load = stress.get(i).map_or(&[][..], |of_load| of_load);
        let has_load_stiffness = !of_load.is_empty();
        Ok((
            load.reduced(model.scene, (model.mesh, model.positions), body, modes, of_load, has_load_stiffness)?,
            load.is_gravity(),
        ))
    };
    model.loads.iter().enumerate().map(reduced).collect()
}

/// The largest displacement of a node in a shape, with its number of degrees of freedom a node.
pub(crate) fn peak(shape: ColRef<'_, f64>, dofs: usize) -> f64 {
    let at = |node: usize| Vector3::from_fn(|axis, _| shape[dofs * node + axis]).norm();
    (0..shape.nrows() / dofs).map(at).fold(0.0, f64::max)
}
