//! Third stage: the body that has what was decided.

use advice::{Advice, Backbone, Findings, advise};
use dynamics::{Effect, ReferenceForces};
use faer::{Mat, Scale};
use modal::{Modes, StaticAnswer};

use crate::error::BuildError;
use crate::reduction::bent::answer::WithAnswer;
use crate::reduction::bent::manifold::LargeDeflection;
use crate::reduction::decide::Decision;
use crate::reduction::mesh_model::MeshModel;
use crate::reduction::modal_model::ModalModel;
use crate::reduction::physics;
use crate::reduction::survey::Survey;
use crate::stress::{Stress, beside, in_shapes};
use crate::structure::kept::Basis;
use crate::tie::mesh_marker::{MeshMarker, warps};
use crate::tie::warp::Warp;

/// Sentence about effects that may matter but need elements.
const WITHOUT_ELEMENTS: &str =
    "By a bound it may matter; it cannot be computed, since the elements of a body of matrices are not known.";

/// A body in the modes that it keeps and its static shapes.
pub(crate) struct Reduction {
    pub modes: Modes,
    pub modal: ModalModel,
    /// Backbones of the modes that are kept.
    pub backbones: Vec<Option<Backbone>>,
    pub stress: Stress,
    /// Forces of the bent body that the modes are about.
    pub forces: Option<ReferenceForces>,
    /// Stiffness between coordinates that are coupled.
    pub coupling: Option<Mat<f64>>,
    /// Stiffness by the stress of unit forces and moments on the markers (nf×nf each); none where it is left out.
    pub of_markers: Vec<Mat<f64>>,
    /// How the faces of the markers warp; none where the body does not deform.
    pub warps: Vec<Option<Warp>>,
    /// The manifold of the large modes, if any are.
    pub large: Option<LargeDeflection>,
    /// With what only this body tells.
    pub advice: Advice,
}

impl Reduction {
    pub fn new(model: &MeshModel<'_, '_>, survey: Survey, decision: &Decision) -> Result<Self, BuildError> {
        let Survey { modes, modal, spin, statics, of_markers, backbones, advice } = survey;
        // Large modes are those of the body without the rigid part.
        if let (false, Some(marker)) =
            (decision.bent.large.is_empty(), model.markers.iter().find(|of| of.rigid_nodes().is_some()))
        {
            let help =
                "tie its `\"nodes\"` to a rigid body by a fixed joint, or give `large_deflection = false` in [effects]";
            let found = "a rigid part of a body with large modes";
            return Err(model
                .scene
                .refuse(marker.key_of_tie(), found, "`\"mean\"` or `\"nodes\"`, whose shapes large modes know", help)
                .into());
        }
        let of_markers = of_markers.filter(|_| decision.keep > 0);
        let warps = of_markers.as_ref().map_or_else(Vec::new, |of| warps(&model.markers, model.mesh, of.as_ref()));
        let mut backbones = backbones;
        let tolerance = model.scene.effects.tolerance;
        backbones.truncate(decision.keep);
        let stiffens = decision.effects[Effect::GeometricStiffening];
        let has_all = decision.keep == modal.body.flexible() && !decision.has_static_shapes && of_markers.is_none();
        let (modes, modal, spin, deflection) = if has_all {
            (modes, modal, spin.filter(|_| stiffens), advice.deflection)
        } else {
            let of_others = statics.responses().filter(|_| decision.has_static_shapes);
            let responses = of_markers.iter().chain(of_others).collect::<Vec<_>>();
            let Basis { mut modes, mut body } = model.structure.basis(&modes.truncated(decision.keep), &responses)?;
            let rigid: Vec<&[u32]> = model.markers.iter().filter_map(MeshMarker::rigid_nodes).collect();
            let has_rigid = !rigid.is_empty() && of_markers.is_some();
            if has_rigid {
                Basis { modes, body } = model.structure.with_rigid_patches(&modes, model.dofs, &rigid)?;
            }
            let modal = ModalModel::new(model, body, &modes)?;
            let deflection = advise(&modal.case(model), tolerance)?.deflection;
            let keep = decision.keep;
            let first = |spin: [Mat<f64>; 6]| spin.map(|k| k.get(..keep, ..keep).to_owned()).to_vec();
            // Modes of which something moves as a rigid body are others.
            let known = spin.filter(|_| !has_rigid).map_or_else(Vec::new, first);
            let spin = if stiffens { statics.stress_stiffness(model, &modes, &known)? } else { None };
            (modes, modal, spin, deflection)
        };
        let modal = modal.with_stress_stiffness(model, spin.as_ref())?;
        let bent = decision.bent.clone().settled(model, &modes)?;
        let (modes, modal, bent) = match WithAnswer::new(model, &modes, &bent, &advice)? {
            Some(WithAnswer { modes, bent }) => {
                let body = model.structure.with_answer(&modes)?;
                let spin = if stiffens { statics.stress_stiffness(model, &modes, &[])? } else { None };
                let modal = ModalModel::new(model, body, &modes)?.with_stress_stiffness(model, spin.as_ref())?;
                // A backbone is that of a mode.
                backbones.iter_mut().for_each(|backbone| *backbone = None);
                (modes, modal, bent)
            }
            None => (modes, modal, bent),
        };
        let (modal, stress, large, of_spin) = if !bent.large.is_empty() {
            let all = bent.all();
            let stressing = statics.without_parts(model, &modes, &all)?;
            let stress = Stress::new(model, &stressing, &modes, &modal, &all)?;
            let of_spin = if stiffens { stressing.stress_stiffness(model, &modes, &[])? } else { None };
            let of_spin = of_spin.map(|of_spin| of_spin.map(|k| beside(k, &all)));
            let large = LargeDeflection::new(model, &modes, &bent, of_spin.as_ref())?;
            // The frequencies of these follow their amplitudes.
            for k in large.manifold.bent() {
                if let Some(backbone) = backbones.get_mut(*k) {
                    *backbone = None;
                }
            }
            let stress = large.stressed(stress);
            let modal = modal.with_stress(model, Some(large.manifold.body()), large.modes(), &stress.of_loads)?;
            (modal, stress, Some(large), of_spin)
        } else {
            let stress = Stress::new(model, &statics, &modes, &modal, &[])?;
            let modal = if stress.any() { modal.with_stress(model, None, &modes, &stress.of_loads)? } else { modal };
            (modal, stress, None, spin)
        };
        let forces = match model.reference {
            Some(reference) => {
                let nf = modes.shapes.ncols();
                let mut stiffness =
                    reference.stress_stiffness(model, of_spin.as_ref(), &stress.of_loads, nf) * Scale(-1.0);
                if let Some(work) = large.as_ref().and_then(|large| large.reference_work.as_ref()) {
                    stiffness += work;
                }
                if let Some(by_stress) = model.structure.reference_stiffness(&modes)? {
                    stiffness += by_stress;
                }
                Some(ReferenceForces { force: reference.modal_forces(&modes), stiffness })
            }
            None => None,
        };
        let coupling = modes.answer.as_ref().map(StaticAnswer::stiffness);
        let of_markers = match &of_markers {
            Some(responses) if physics::may_stress(model.scene) => match &large {
                // As of loads: the manifold has the stress along the modes that bend the body, and between them.
                Some(large) => {
                    let bent = large.manifold.bent();
                    let stressing = model.structure.without_parts(&modes, bent, responses.as_ref())?;
                    let found = model.structure.stress_stiffness(stressing.as_ref(), &modes, &[])?;
                    let shapes = large.manifold.body().flexible();
                    found.into_iter().map(|k| in_shapes(&beside(k, bent), shapes)).collect()
                }
                None => model.structure.stress_stiffness(responses.as_ref(), &modes, &[])?,
            },
            _ => Vec::new(),
        };
        let findings = Findings {
            deflection,
            stress: stress.row.clone(),
            lacks_stretch: decision.lacks.is_some(),
            has_large_modes: large.is_some(),
        };
        let mut advice = advice.completed(findings);
        if !model.scene.source.has_elements() {
            for effect in [Effect::GeometricStiffening, Effect::LargeDeflection] {
                let row = &mut advice.effects[effect];
                if row.on {
                    row.why = WITHOUT_ELEMENTS.to_owned();
                }
            }
        }
        Ok(Self { modes, modal, large, backbones, stress, forces, coupling, of_markers, warps, advice })
    }
}
