//! Needs of scenes that modes are asked of.

use dynamics::Effect;
use model::{Meshed, Model};
use scene::{Body, BodySource, Choice, Scene, SceneError};

/// The body of a scene of which the rates of a body alone are asked.
///
/// # Errors
/// The refusal of several bodies, and of a body that others hold.
pub(crate) fn lone_body(scene: &Scene) -> Result<&Body, SceneError> {
    let body = scene.only_body()?;
    if body.tied {
        let found = "a body that joints, springs or bushings hold, whose frequencies are those of the whole";
        let help = "take what ties the body out of the scene, and hold it by [[constraints]]";
        return Err(body.refuse("body", found, "a body that moves alone", help));
    }
    Ok(body)
}

/// The mesh and the modes of a body that has flexible ones.
///
/// # Errors
/// The refusal of a body that has none, at the key that says so.
pub(crate) fn require_flexible<'a>(body: &Body, model: &'a Model) -> Result<&'a Meshed, SceneError> {
    if let Some(meshed) = model.meshed.as_ref().filter(|_| model.body.flexible() > 0) {
        return Ok(meshed);
    }
    let (key, help) = match body.source {
        BodySource::Rigid(_) => ("body.rigid", "give the body a mesh, and `flexible` in [modes]"),
        BodySource::Meshed(_) | BodySource::File(_) | BodySource::Matrices(_)
            if body.effects.choices[Effect::Flexibility] == Choice::Off =>
        {
            ("effects.flexibility", "remove it, so that the body deforms")
        }
        BodySource::Meshed(_) | BodySource::File(_) | BodySource::Matrices(_) => {
            ("modes.flexible", "keep flexible modes")
        }
    };
    let found = "a body without flexible modes, which has no natural frequencies";
    Err(body.refuse(key, found, "one flexible mode or more", help))
}

/// Refuses to draw a body whose surface is not known.
///
/// # Errors
/// [`SceneError`] of a body of matrices.
pub fn require_surface(body: &Body) -> Result<(), SceneError> {
    match body.source {
        BodySource::Matrices(_) => Err(body.refuse(
            "body.matrices",
            "a body of matrices, whose elements and surface are not known",
            "a body with a mesh, to draw it",
            "use the numbers: `flexframe modes` without -o, `flexframe run`, `flexframe export FILE --csv TABLE.csv`",
        )),
        BodySource::Meshed(_) | BodySource::File(_) | BodySource::Rigid(_) => Ok(()),
    }
}
