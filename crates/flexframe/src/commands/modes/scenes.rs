//! Needs of scenes that modes are asked of.

use dynamics::Effect;
use model::{Meshed, Model};
use scene::{Body, Choice, Scene, SceneError, System};

/// The body of a scene of which the rates of a body alone are asked.
///
/// # Errors
/// The refusal of several bodies, and of a body that others hold.
pub(crate) fn lone_body(system: &System) -> Result<&Scene, SceneError> {
    let scene = system.only_body()?;
    if scene.tied {
        let found = "a body that joints, springs or bushings hold, whose frequencies are those of the whole";
        let help = "take what ties the body out of the scene, and hold it by [[constraints]]";
        return Err(scene.refuse("body", found, "a body that moves alone", help));
    }
    Ok(scene)
}

/// The mesh and the modes of a body that has flexible ones.
///
/// # Errors
/// The refusal of a body that has none, at the key that says so.
pub(crate) fn require_flexible<'a>(scene: &Scene, model: &'a Model) -> Result<&'a Meshed, SceneError> {
    if let Some(meshed) = model.meshed.as_ref().filter(|_| model.body.flexible() > 0) {
        return Ok(meshed);
    }
    let (key, help) = match scene.body {
        Body::Rigid(_) => ("body.rigid", "give the body a mesh, and `flexible` in [modes]"),
        Body::Meshed(_) | Body::File(_) | Body::Matrices(_)
            if scene.effects.choices[Effect::Flexibility] == Choice::Off =>
        {
            ("effects.flexibility", "remove it, so that the body deforms")
        }
        Body::Meshed(_) | Body::File(_) | Body::Matrices(_) => ("modes.flexible", "keep flexible modes"),
    };
    let found = "a body without flexible modes, which has no natural frequencies";
    Err(scene.refuse(key, found, "one flexible mode or more", help))
}

/// Refuses to draw a body whose surface is not known.
///
/// # Errors
/// [`SceneError`] of a body of matrices.
pub fn require_surface(scene: &Scene) -> Result<(), SceneError> {
    match scene.body {
        Body::Matrices(_) => Err(scene.refuse(
            "body.matrices",
            "a body of matrices, whose elements and surface are not known",
            "a body with a mesh, to draw it",
            "use the numbers: `flexframe modes` without -o, `flexframe run`, `flexframe export FILE --csv TABLE.csv`",
        )),
        Body::Meshed(_) | Body::File(_) | Body::Rigid(_) => Ok(()),
    }
}
