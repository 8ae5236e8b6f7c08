//! First stage: what is known of a body with all the modes that were searched for.

use advice::{Advice, Backbone, Case, advise, screen};
use dynamics::Effect;
use faer::Mat;
use modal::Modes;
use scene::Choice;

use crate::building::progress::BuildProgress;
use crate::error::BuildError;
use crate::reduction::bent::backbones::backbones;
use crate::reduction::mesh_model::MeshModel;
use crate::reduction::modal_model::ModalModel;
use crate::reduction::physics;
use crate::structure::StaticForces;
use crate::structure::statics::{Asked, Statics};
use crate::tie::mesh_marker::unit_forces;

/// Properties of a body with all the modes that were searched for. Those that cannot matter are not computed.
pub(crate) struct Survey {
    pub modes: Modes,
    /// With the stress stiffness of the spin where it may matter.
    pub modal: ModalModel,
    /// The stress stiffness of the spin.
    pub spin: Option<[Mat<f64>; 6]>,
    pub statics: Statics,
    /// Static responses to unit forces and moments on the markers (3n×k).
    pub of_markers: Option<Mat<f64>>,
    /// The backbone of each natural mode that linear strain may get wrong by the bounds of the advice.
    pub backbones: Vec<Option<Backbone>>,
    /// On all of the modes.
    pub advice: Advice,
}

impl Survey {
    pub fn new(
        model: &MeshModel<'_, '_>,
        modes: Modes,
        modal: ModalModel,
        progress: &mut dyn FnMut(BuildProgress),
    ) -> Result<Self, BuildError> {
        let tolerance = model.scene.effects.tolerance;
        let stiffens = may_stiffen(model, &modal)?;
        let flexible = modal.body.flexible();
        let has_shapes = physics::static_correction(model.scene, flexible) != Choice::Off;
        let may_stress = flexible > 0 && physics::may_stress(model.scene);
        // To tell what the modes leave out of it.
        let has_stress = flexible > 0 && model.scene.any_stress();
        // For static shapes, or to tell that they are missing.
        let may_lack = flexible > 0 && model.scene.modes.static_correction != Choice::Off;
        let asked = Asked {
            loads: (has_shapes || may_stress || has_stress) && !model.loads.is_empty(),
            // The spin of a rest that the body may leave is a load that it has had, too.
            spin: stiffens
                || may_stretch(model, &modal)?
                || (model.scene.modes.static_correction == Choice::On && rests_in_a_spin(model)),
            drive: model.drive.is_some() && (may_stress || may_lack),
        };
        let has_markers = flexible > 0 && !model.markers.is_empty();
        if asked.any() || has_markers {
            progress(BuildProgress::Statics);
        }
        let statics = Statics::new(model, &modes, &modal.body.origin, asked)?;
        let of_markers = if has_markers { Some(to_markers(model, &modes, &modal)?) } else { None };
        let spin = if stiffens { statics.stress_stiffness(model, &modes, &[])? } else { None };
        let modal = modal.with_stress_stiffness(model, spin.as_ref())?;

        let case = Case {
            static_compliances: statics.compliances(),
            centrifugal_remainders: &statics.remainders.of_spin,
            drive_remainder: statics.remainders.of_drive,
            ..modal.case(model)
        };
        let first = advise(&case, tolerance)?;
        let backbones = backbones(model, &modes, &first)?;
        let advice = if backbones.iter().any(Option::is_some) {
            advise(&Case { backbones: &backbones, ..case }, tolerance)?
        } else {
            first
        };
        let advice = physics::in_joints(model.scene, advice);
        Ok(Self { modes, modal, spin, statics, of_markers, backbones, advice })
    }
}

/// The static responses to unit forces and moments on the markers.
fn to_markers(model: &MeshModel<'_, '_>, modes: &Modes, modal: &ModalModel) -> Result<Mat<f64>, BuildError> {
    let forces = unit_forces(&model.markers, model.dofs * model.mesh.positions().len());
    let forces = StaticForces { of_loads: forces.as_ref(), spin: false, drive: None, origin: modal.body.origin };
    Ok(model.structure.static_responses(modes, &forces)?.fields)
}

/// True if the stress of the spin may matter, and is to be computed.
fn may_stiffen(model: &MeshModel<'_, '_>, modal: &ModalModel) -> Result<bool, BuildError> {
    let &MeshModel { scene, support, .. } = model;
    let has_none = modal.body.flexible() == 0 || !scene.source.has_elements();
    if has_none || scene.effects.choices[Effect::DeformedInertia] == Choice::Off {
        return Ok(false);
    }
    Ok(match scene.effects.choices[Effect::GeometricStiffening] {
        Choice::On => true,
        Choice::Off => false,
        Choice::Auto => {
            scene.method().abilities.geometric_stiffening
                && physics::may_spin(scene, support.motion, model.drive.as_ref())
                // How fast joints let it turn is not known.
                && (!model.markers.is_empty() || screen(&modal.case(model), scene.effects.tolerance)?.on)
        }
    })
}

/// True if the modes are about the rest of the body in a spin.
fn rests_in_a_spin(model: &MeshModel<'_, '_>) -> bool {
    model.reference.is_some_and(|reference| reference.steady.omega_body.norm() > 0.0)
}

/// True if the modes may leave out something of the static response to the spin that matters, which is to be computed:
/// for static shapes, or to tell that they are missing.
fn may_stretch(model: &MeshModel<'_, '_>, modal: &ModalModel) -> Result<bool, BuildError> {
    let &MeshModel { scene, support, .. } = model;
    let acts = modal.body.flexible() > 0
        && scene.effects.choices[Effect::DeformedInertia] != Choice::Off
        && physics::may_spin(scene, support.motion, model.drive.as_ref());
    Ok(acts
        && match scene.modes.static_correction {
            Choice::On => true,
            Choice::Off => false,
            Choice::Auto => {
                let tolerance = scene.effects.tolerance;
                advise(&modal.case(model), tolerance)?.stretch >= tolerance
            }
        })
}
