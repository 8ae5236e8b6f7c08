//! The rules on `[effects]`: what is asked for must be there, and what is there by force cannot be switched off.

use frames_rk4::Method;

use super::Check;
use crate::constraint::Constraint;
use crate::document::join;
use crate::effects::{Choice, Effects};
use crate::error::SceneError;
use crate::load::Load;
use crate::modes::{Flexible, Modes};
use crate::scene::Initial;

impl Check<'_> {
    pub fn effects(
        &self,
        effects: &Effects,
        modes: &Modes,
        initial: &Initial,
        constraint: Option<&Constraint>,
        loads: &[Load],
    ) -> Result<(), SceneError> {
        let tolerance = effects.tolerance;
        self.require(
            tolerance > 0.0 && tolerance < 1.0,
            "effects.tolerance",
            "a number between 0 and 1, both excluded",
            "give the relative influence below which an effect is left out, e.g. `tolerance = 1e-3`",
        )?;
        self.of_deformation(effects, modes, initial)?;
        let has_gravity = loads.iter().any(|load| matches!(load, Load::Gravity(_)));
        self.not_on("gravity", effects.gravity, !has_gravity, "no load `kind = \"gravity\"`", "add it to [[loads]]")?;

        let (can_translate, can_turn) = match constraint {
            // What supports leave is known when the mesh is.
            None | Some(Constraint::Support { .. }) => (true, true),
            Some(Constraint::Pin { .. } | Constraint::Hinge { .. }) => (false, true),
            Some(Constraint::Slider { .. }) => (true, false),
            Some(Constraint::Clamp { .. }) => (false, false),
        };
        let held = "a constraint that leaves none";
        let cure = "change [[constraints]]";
        self.not_on("translation", effects.translation, !can_translate, held, cure)?;
        self.not_on("rotation", effects.rotation, !can_turn, held, cure)?;

        let turned = matches!(constraint, Some(Constraint::Hinge { motion: Some(_), .. }));
        let driven = matches!(constraint, Some(Constraint::Slider { motion: Some(_), .. }));
        let motion = "the `motion` of the constraint";
        self.not_off("rotation", effects.rotation, turned, motion)?;
        self.not_off("translation", effects.translation, driven, motion)?;
        self.not_off(
            "rotation",
            effects.rotation,
            initial.angular_velocity != [0.0; 3],
            "an initial `angular_velocity`",
        )?;
        self.not_off("translation", effects.translation, initial.velocity != [0.0; 3], "an initial `velocity`")
    }

    /// The paper's formulation has the effects that it has.
    pub fn effects_of_paper(&self, effects: &Effects, method: Method) -> Result<(), SceneError> {
        if !method.is_of_paper() {
            return Ok(());
        }
        let paper = "the paper's formulation";
        let stiffening = effects.geometric_stiffening;
        self.not_on("geometric_stiffening", stiffening, true, paper, "set `formulation = \"conservative\"`")?;
        let &Effects { deformed_inertia, coriolis, translation, rotation, .. } = effects;
        for (name, choice) in [
            ("deformed_inertia", deformed_inertia),
            ("coriolis", coriolis),
            ("translation", translation),
            ("rotation", rotation),
        ] {
            self.not_off(name, choice, true, paper)?;
        }
        Ok(())
    }

    /// The effects that need a body that deforms.
    fn of_deformation(&self, effects: &Effects, modes: &Modes, initial: &Initial) -> Result<(), SceneError> {
        let &Effects { flexibility, damping, deformed_inertia, coriolis, geometric_stiffening, .. } = effects;
        let no_modes = modes.flexible == Flexible::Count(0);
        let (found, cure) = match no_modes {
            true => ("no flexible modes", "keep flexible modes of a body with a mesh"),
            false => ("`flexibility = false`", "set `flexibility = \"auto\"`"),
        };
        self.not_on("flexibility", flexibility, no_modes, found, cure)?;
        let is_rigid = no_modes || flexibility == Choice::Off;
        for (name, choice) in [
            ("damping", damping),
            ("deformed_inertia", deformed_inertia),
            ("coriolis", coriolis),
            ("geometric_stiffening", geometric_stiffening),
        ] {
            self.not_on(name, choice, is_rigid, found, cure)?;
        }
        let is_deformed =
            [&initial.modal_displacement, &initial.modal_velocity].into_iter().flatten().any(|&q| q != 0.0);
        self.not_off("flexibility", flexibility, is_deformed, "an initial modal displacement or velocity")
    }

    /// Refuses an effect that is on although there is nothing to it.
    fn not_on(&self, name: &str, choice: Choice, nothing: bool, found: &str, cure: &str) -> Result<(), SceneError> {
        if choice != Choice::On || !nothing {
            return Ok(());
        }
        Err(self.document.place(&join("effects", name)).refuse(
            format!("`{name} = true` with {found}"),
            "`false` or `\"auto\"`",
            format!("set `{name} = \"auto\"`, or {cure}"),
        ))
    }

    /// Refuses an effect that is off although the scene demands it.
    fn not_off(&self, name: &str, choice: Choice, demanded: bool, by: &str) -> Result<(), SceneError> {
        if choice != Choice::Off || !demanded {
            return Ok(());
        }
        Err(self.document.place(&join("effects", name)).refuse(
            format!("`{name} = false` with {by}"),
            "`true` or `\"auto\"`",
            format!("set `{name} = \"auto\"`, or remove {by}"),
        ))
    }
}
