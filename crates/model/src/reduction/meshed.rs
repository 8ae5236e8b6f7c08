//! A body with a mesh: its modes, and the effects that its scene calls for.

use frames_rk4::Paper;
use std::sync::Arc;
use std::time::Instant;

use advice::{Refusal, limits, unsteady};
use dynamics::{Effect, LoadedError, Physics, PointShapes};
use faer::Mat;
use fem_tet10::{Location, Mesh};
use modal::Modes;
use nalgebra::Vector3;
use reduced_body::ReducedBody;
use scene::{Body, Choice, Frame};

use crate::building::assembly::AssembledMesh;
use crate::building::progress::{BuildProgress, BuildTimes, timed};
use crate::error::{BuildError, modal, refuse};
use crate::load::mesh_load::{self, BaseAcceleration, UnitWeight};
use crate::model::points::{output_points, well_spread};
use crate::model::{Meshed, Model};
use crate::needs::Needed;
use crate::reduction::about::proposed;
use crate::reduction::bent::manifold::LargeDeflection;
use crate::reduction::decide::Decision;
use crate::reduction::measured::as_measured;
use crate::reduction::mesh_model::MeshModel;
use crate::reduction::modal_model::ModalModel;
use crate::reduction::physics;
use crate::reduction::reduce::Reduction;
use crate::reduction::survey::Survey;
use crate::stress::shapes::BodyStress;
use crate::structure::Structure;
use crate::structure::kept::Found;
use crate::support::reactions::SupportRows;
use crate::tie::mesh_marker;
use crate::tie::place::ShapedBody;

/// The model of a scene, from its mesh and the modes that it asks for.
pub(crate) fn reduce(
    scene: &Needed<'_>,
    assembled: &AssembledMesh,
    structure: &Structure<'_>,
    found: Found,
    mut times: BuildTimes,
    progress: &mut dyn FnMut(BuildProgress),
) -> Result<Model, BuildError> {
    let AssembledMesh { mesh, support, drive, .. } = assembled;
    let dofs = assembled.dofs();
    let Found { modes, body, weights, matrix_bytes, .. } = found;
    let loads = mesh_load::on_mesh(scene, mesh, dofs, &Arc::new(UnitWeight::new(weights, dofs)))?;
    let markers = mesh_marker::on_mesh(scene, mesh, dofs)?;
    let (positions, reference) = (assembled.positions()?, structure.reference());
    // What stresses the bent body in the reference has stiffened it already.
    let about_reference = reference.is_some().then(|| physics::about_reference(scene));
    let scene = about_reference.as_ref().unwrap_or(scene);
    let drive = drive.clone();
    let model = MeshModel { scene, mesh, positions, reference, dofs, structure, support, loads, markers, drive };

    if !scene.method().abilities.any_mass && assembled.checks.is_some_and(|checks| !checks.is_scalar_mass) {
        let found = "a scheme of the paper's formulation, which knows no rotations of nodes, for a mass that is no scalar for each node";
        let help = "set `formulation = \"conservative\"`";
        return Err(scene.refuse("time", found, "the conservative form", help).into());
    }

    let on_all_modes = timed(&mut times.reduction, || ModalModel::new(&model, body, &modes))?;
    let started = Instant::now();
    let survey = Survey::new(&model, modes, on_all_modes, progress)?;
    let has_statics = survey.statics.any() || survey.of_markers.is_some();
    let decision = Decision::new(scene, &survey);
    let Reduction { modes, modal: reduced, large, backbones, stress, forces, coupling, of_markers, warps, mut advice } =
        Reduction::new(&model, survey, &decision)?;
    if let Some(proposal) = proposed(&model, &modes, &reduced) {
        let why = &mut advice.effects[Effect::LargeDeflection].why;
        *why = format!("{why} {proposal}");
    }
    if has_statics {
        times.statics = started.elapsed();
    }

    let started = Instant::now();
    let (manifold, in_shapes, shapes) = match &large {
        Some(large) => (Some(&large.manifold), large.manifold.body(), large.modes()),
        None => (None, &reduced.body, &modes),
    };
    let points = points(&model, shapes, in_shapes)?;
    let on_body = ShapedBody { body: in_shapes, modes: shapes, is_bent: manifold.is_some() };
    let markers = mesh_marker::reduced(&model.markers, scene, mesh, &on_body, &of_markers, &warps)?;
    let reference_points = reference_points(scene, mesh, &reduced.body);
    let extended = manifold.map(|manifold| (manifold, shapes));
    let has_gravity = decision.effects[Effect::Gravity];
    let body_stress = BodyStress::new(&model, &modes, extended, &reduced.body.origin, has_gravity)?;
    let supports = SupportRows::new(&model, shapes, manifold, &decision.effects, has_gravity)?;
    times.reduction += started.elapsed();

    let (mut damping_ratios, has_large) = (reduced.damping_ratios, large.is_some());
    let body = as_measured(scene, reduced.body, (&points, &reduced.size.peaks), has_large, &mut damping_ratios)?;
    let Decision { mut effects, lacks, .. } = decision;
    effects[Effect::LargeDeflection] = large.is_some();
    let following = large.as_ref().map_or_else(Mat::new, LargeDeflection::following);
    let large_deflection = large.map(|large| large.manifold);
    let mut model = Model {
        physics: Physics {
            effects,
            drive: model.drive,
            drive_stiffness: stress.of_drive,
            large_deflection,
            reference: forces,
            coupling,
        },
        points,
        markers,
        paper: Paper { reference_points },
        advice,
        refusal: None,
        choices: scene.effects.choices,
        times,
        base: BaseAcceleration::of(scene, effects[Effect::Gravity])?,
        all_loads: reduced.loads.loads.clone(),
        loads: reduced.loads.acting(effects[Effect::Gravity]),
        damping_ratios: if effects[Effect::Damping] { damping_ratios.clone() } else { vec![0.0; body.flexible()] },
        all_damping_ratios: damping_ratios,
        size: reduced.size,
        // Who switches static shapes off is not warned again.
        left_out: lacks.filter(|_| scene.modes.static_correction == Choice::Auto).unwrap_or_default(),
        backbones,
        stress: body_stress,
        supports,
        body,
        meshed: Some(Meshed {
            matrix_bytes,
            mesh: Arc::clone(mesh),
            elements: assembled.elements().cloned(),
            mesh_notes: assembled.mesh_notes.clone(),
            checks: structure.checks(&modes)?,
            no_cycles: structure.no_cycles().cloned(),
            modes,
            following,
            reference: reference.map(|reference| reference.displacement.clone()),
        }),
    };
    // About a bent body these would count what it has carried already.
    if reference.is_some() {
        return Ok(model);
    }
    let initial = model.initial(scene);
    if model.is_stressed() {
        let least = model.damping_ratios.iter().copied().fold(f64::INFINITY, f64::min);
        model.refusal = match model.loaded_modes(scene) {
            Ok(modes) => unsteady(&modes, least),
            // How far the run bends is watched while it runs.
            Err(LoadedError::NoRest) => None,
            Err(source) => return Err(BuildError::Loaded { scene: scene.path.clone(), source: Box::new(source) }),
        };
    }
    if model.refusal.is_none() {
        model.refusal = limits(&model.case(scene, &initial), &model.physics.effects)?;
    }
    // What stresses the body may stiffen it beyond what the estimate knows.
    if model.refusal.is_none() && !model.is_stressed() {
        model.refusal = model.advice.refusal();
    }
    // A factor like that of its modes is at hand for the full body, too.
    let is_cheap = model.meshed.as_ref().is_some_and(|meshed| meshed.modes.stats.cycles == 0);
    if let Some(refusal @ (Refusal::Indefinite { .. } | Refusal::Diverges { .. })) = model.refusal
        && is_cheap
    {
        model.refusal = Some(refusal.with_rest_of_body(assembled.rest_of_body()?));
    }
    Ok(model)
}

/// The points of the output, by name.
fn points(
    &MeshModel { scene, mesh, positions, reference, .. }: &MeshModel<'_, '_>,
    modes: &Modes,
    body: &ReducedBody,
) -> Result<Vec<(String, PointShapes)>, BuildError> {
    output_points(scene, |key: String, at: [f64; 3]| {
        let Location { nodes, weights } = mesh.locate(at).map_err(|error| refuse(scene, &key, error))?;
        let point = modes.point(positions, &nodes, &weights);
        let point = PointShapes::new(body, &point.map_err(modal(scene))?);
        Ok(match reference {
            Some(reference) => point.moved_by(reference.displacement_at(&nodes, &weights)),
            None => point,
        })
    })
}

/// R, P and Q of the scene, or three nodes that lie far from each other, from the origin of the body.
fn reference_points(scene: &Body, mesh: &Mesh, body: &ReducedBody) -> [Vector3<f64>; 3] {
    match scene.frame {
        Some(Frame { r, p, q }) => [r, p, q],
        None => well_spread(mesh.positions(), &body.center_of_mass),
    }
    .map(|x| Vector3::from(x) - body.origin)
}
