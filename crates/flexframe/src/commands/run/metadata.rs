//! The metadata of a results file.

use dynamics::{Coordinate, DrivenMotion};
use model::Builder;
use results::{BodyMetadata, BodyProperties, JointMetadata, Metadata, Units};
use scene::{End, Scene, Shared, StepControl};

use super::body::RunBody;
use crate::drawn::mesh_properties;
use crate::files::scene_file;
use crate::report::BodyReport;
use crate::rows::columns::part;
use crate::rows::effects;

/// The metadata in the results file of a run.
pub(super) fn metadata_of_file(scene: &Scene, bodies: &[RunBody<'_>], builder: &Builder) -> Metadata {
    let mut metadata = metadata_of_scene(scene, bodies);
    for (RunBody { body, model }, of_body) in bodies.iter().zip(&mut metadata.bodies) {
        of_body.model.mesh = mesh_properties(body, model);
    }
    let input_files = builder.files(scene).iter().map(|file| scene_file::to_text(file)).collect();
    Metadata { input_files, ..metadata }
}

/// As [`metadata`], with the joints, springs and bushings.
pub fn metadata_of_scene(scene: &Scene, bodies: &[RunBody<'_>]) -> Metadata {
    let joints = (0..scene.joints.len()).map(|joint| joint_metadata(scene, joint));
    let joints = joints.chain(element_metadata(scene)).collect();
    Metadata { joints, ..metadata(scene, bodies) }
}

/// The metadata of a run without what only a file has: the files that it read, and the sizes of meshes.
pub fn metadata(scene: &Shared, bodies: &[RunBody<'_>]) -> Metadata {
    let (step, tolerance) = match scene.time.control {
        StepControl::Fixed(step) => (Some(step), None),
        StepControl::Tolerance(tolerance) => (None, Some(tolerance)),
    };
    Metadata {
        title: scene.title.clone(),
        units: units(scene),
        formulation: scene.time.method.formulation.to_owned(),
        scheme: scheme(bodies),
        step,
        tolerance,
        program_version: env!("CARGO_PKG_VERSION").to_owned(),
        end: scene.time.end,
        scene_text: scene.text.to_string(),
        scene_file: scene_file::to_text(&scene.path),
        input_files: Vec::new(),
        bodies: bodies.iter().map(body_metadata).collect(),
        joints: Vec::new(),
        warnings: Vec::new(),
        trust: Vec::new(),
    }
}

/// The scheme, or the two of bodies that are tied and bodies that are not.
fn scheme(bodies: &[RunBody<'_>]) -> String {
    let mut schemes: Vec<&str> = bodies.iter().map(|of| of.body.method().scheme).collect();
    schemes.sort_unstable();
    schemes.dedup();
    schemes.join(", ")
}

fn body_metadata(of: &RunBody<'_>) -> BodyMetadata {
    let RunBody { body, model } = *of;
    let report = BodyReport::new(model);
    BodyMetadata {
        name: of.name().to_owned(),
        model: BodyProperties {
            mass: report.mass,
            center_of_mass: report.center_of_mass,
            inertia: report.inertia,
            origin: model.body.origin.into(),
            static_shapes: model.static_shapes(),
            kinds: model
                .static_answer()
                .map_or_else(Vec::new, |_| report.kinds.iter().map(|kind| (*kind).to_owned()).collect()),
            frequencies: report.natural_frequencies,
            damping_ratios: report.damping_ratios,
            rotation_axes: model.body.motion.rotations().iter().map(|axis| (*axis).into()).collect(),
            translation_axes: model.body.motion.translations().iter().map(|axis| (*axis).into()).collect(),
            mesh: None,
        },
        point_names: model.points.iter().map(|(name, _)| name.clone()).collect(),
        point_positions: model
            .points
            .iter()
            .map(|(_, p)| (model.body.origin + p.position_body() - p.of_reference()).into())
            .collect(),
        parts: parts(of).map(str::to_owned).collect(),
        support_names: model.supports.as_ref().map_or(Vec::new(), |supports| supports.names().to_vec()),
        effects: effects::described(body, model),
        refusal: model.refusal.map(|refusal| refusal.to_string()),
    }
}

fn joint_metadata(scene: &Scene, number: usize) -> JointMetadata {
    let joint = &scene.joints[number];
    let coordinates = joint.kind.coordinates();
    let acts = |along| {
        let of_spring = joint.spring.iter().map(|spring| spring.along);
        let is_coupled = scene.couplings.iter().any(|coupling| coupling.kind.acts_on(number, along));
        is_coupled || of_spring.chain(joint.motor.iter().map(|motor| motor.along)).any(|coordinate| coordinate == along)
    };
    let parts = [
        (part::TURNS, coordinates.contains(&Coordinate::Turn)),
        (part::SLIDES, coordinates.contains(&Coordinate::Slide)),
        (part::DRIVE, joint.drive.is_some() || joint.motor.is_some()),
        (part::SPRING, joint.spring.is_some()),
        (part::TURN_FORCE, acts(Coordinate::Turn)),
        (part::SLIDE_FORCE, acts(Coordinate::Slide)),
    ];
    JointMetadata {
        name: joint.name.clone(),
        kind: joint.kind.name().to_owned(),
        between: joint.between.map(|end| scene.name_of(end)),
        parts: parts.into_iter().filter(|(_, has)| *has).map(|(part, _)| part.to_owned()).collect(),
    }
}

/// Springs, then bushings.
fn element_metadata(scene: &Scene) -> impl Iterator<Item = JointMetadata> {
    let of = |name: &String, kind: &str, between: [End; 2], parts: &[&str]| JointMetadata {
        name: name.clone(),
        kind: kind.to_owned(),
        between: between.map(|end| scene.name_of(end)),
        parts: parts.iter().map(|part| (*part).to_owned()).collect(),
    };
    let of_spring = [part::LINE, part::SPRING];
    let springs = scene.springs.iter().map(move |spring| of(&spring.name, "spring", spring.between, &of_spring));
    let of_bushing = [part::SPRING];
    springs.chain(scene.bushings.iter().map(move |of_| of(&of_.name, "bushing", of_.between, &of_bushing)))
}

/// The labels of a scene's units.
pub(crate) fn units(scene: &Shared) -> Units {
    let scene::Units { length, mass, time } = scene.units.clone();
    Units { length, mass, time }
}

/// Parts of a body that has further columns. In the formulation of the paper there are no reactions.
fn parts<'a>(RunBody { body, model }: &RunBody<'a>) -> impl Iterator<Item = &'static str> + use<'a> {
    let motion = &model.body.motion;
    let drive = model.physics.drive.as_ref().map(|drive| drive.motion);
    let turns = matches!(drive, Some(DrivenMotion::Turn { .. }));
    let slides = matches!(drive, Some(DrivenMotion::Slide { .. }));
    let is_held = !motion.is_free() && body.method().abilities.reactions;
    [
        (part::CONSTRAINT, true),
        (part::HINGE, turns || motion.rotations().len() == 1),
        (part::SLIDER, slides || motion.translations().len() == 1),
        (part::DRIVE, drive.is_some()),
        (part::DRIVEN_HINGE, turns),
        (part::DRIVEN_SLIDER, slides),
    ]
    .into_iter()
    .filter_map(move |(part, has)| (is_held && has).then_some(part))
    .chain(model.supports.as_ref().map(|_| part::SUPPORTS))
    .chain((!model.base.is_empty()).then_some(part::MOVING_SUPPORT))
    .chain(model.stress.as_ref().filter(|stress| stress.points() > 0).map(|_| part::STRESS))
}
