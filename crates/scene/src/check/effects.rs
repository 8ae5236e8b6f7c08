//! The rules on `[effects]`: what is asked for must be there, and what is there by force cannot be switched off.

use dynamics::{Effect, Method};

use super::Check;
use crate::body::constraint::Constraint;
use crate::body::effects::{Choice, Effects};
use crate::body::modes::{Flexible, Modes};
use crate::body::{BodySource, Initial, MeshedBody};
use crate::document::join;
use crate::error::SceneError;
use crate::loads::load::Load;

impl Check<'_> {
    pub fn effects(
        &self,
        effects: &Effects,
        modes: &Modes,
        initial: &Initial,
        constraint: Option<&Constraint>,
        loads: &[Load],
        has_markers: bool,
    ) -> Result<(), SceneError> {
        let tolerance = effects.tolerance;
        self.require(
            tolerance > 0.0 && tolerance < 1.0,
            "effects.tolerance",
            "a number between 0 and 1, both excluded",
            "give the relative influence below which an effect is left out, e.g. `tolerance = 1e-3`",
        )?;
        self.of_deformation(effects, modes, initial)?;
        let has_gravity = loads.iter().any(Load::is_gravity);
        self.not_on(effects, Effect::Gravity, !has_gravity, "no load `kind = \"gravity\"`", "add it to [[loads]]")?;

        let (can_translate, can_turn) = match constraint {
            // What supports leave is known when the mesh is.
            None | Some(Constraint::Support { .. }) => (true, true),
            Some(Constraint::Pin { .. } | Constraint::Hinge { .. }) => (false, true),
            Some(Constraint::Slider { .. }) => (true, false),
            Some(Constraint::Clamp { .. }) => (false, false),
        };
        let held = "a constraint that leaves none";
        let help = "change [[constraints]]";
        self.not_on(effects, Effect::Translation, !can_translate, held, help)?;
        self.not_on(effects, Effect::Rotation, !can_turn, held, help)?;

        let turned = matches!(constraint, Some(Constraint::Hinge { motion: Some(_), .. }));
        let driven = matches!(constraint, Some(Constraint::Slider { motion: Some(_), .. }));
        let motion = "the `motion` of the constraint";
        let turns = initial.angular_velocity != [0.0; 3];
        let found = "nothing that stresses the body: no load, no `motion` of a constraint, no marker, no initial `angular_velocity`";
        let nothing = !(turned || driven || turns || has_markers) && loads.is_empty();
        self.not_on(effects, Effect::GeometricStiffening, nothing, found, "let something act on the body")?;
        self.not_off(effects, Effect::Rotation, turned, motion)?;
        self.not_off(effects, Effect::Translation, driven, motion)?;
        self.not_off(effects, Effect::Rotation, turns, "an initial `angular_velocity`")?;
        self.not_off(effects, Effect::Translation, initial.velocity != [0.0; 3], "an initial `velocity`")
    }

    /// The effects that need the elements of a body.
    pub fn effects_of_elements(&self, effects: &Effects, modes: &Modes, body: &BodySource) -> Result<(), SceneError> {
        let Some(found) = body.not_by_elements() else { return Ok(()) };
        let help = match body {
            BodySource::Matrices(_) => {
                let help = "give the body a mesh and a material";
                self.not_on(effects, Effect::GeometricStiffening, true, found, help)?;
                help
            }
            BodySource::Meshed(_) => MeshedBody::WITHOUT_TIED_MASSES,
            BodySource::File(_) | BodySource::Rigid(_) => return Ok(()),
        };
        self.not_on(effects, Effect::LargeDeflection, true, found, help)?;
        if modes.large.is_none() {
            return Ok(());
        }
        Err(self.document.place("modes.large").refuse(
            format!("large modes of {found}"),
            "modes that are small",
            format!("remove it, or {help}"),
        ))
    }

    /// A formulation may have effects that are fixed.
    pub fn fixed_effects(&self, effects: &Effects, method: Method) -> Result<(), SceneError> {
        if method.abilities.switches_effects {
            return Ok(());
        }
        let paper = "the paper's formulation";
        let help = "set `formulation = \"conservative\"`";
        self.not_on(effects, Effect::GeometricStiffening, true, paper, help)?;
        self.not_on(effects, Effect::LargeDeflection, true, paper, help)?;
        [Effect::DeformedInertia, Effect::Coriolis, Effect::Translation, Effect::Rotation]
            .into_iter()
            .try_for_each(|effect| self.not_off(effects, effect, true, paper))
    }

    /// The effects that need a body that deforms.
    fn of_deformation(&self, effects: &Effects, modes: &Modes, initial: &Initial) -> Result<(), SceneError> {
        let no_modes = modes.flexible == Flexible::Count(0);
        let (found, help) = match no_modes {
            true => ("no flexible modes", "keep flexible modes of a body with a mesh"),
            false => ("`flexibility = false`", "set `flexibility = \"auto\"`"),
        };
        self.not_on(effects, Effect::Flexibility, no_modes, found, help)?;
        let is_rigid = no_modes || effects.choices[Effect::Flexibility] == Choice::Off;
        for effect in [
            Effect::Damping,
            Effect::DeformedInertia,
            Effect::Coriolis,
            Effect::GeometricStiffening,
            Effect::LargeDeflection,
        ] {
            self.not_on(effects, effect, is_rigid, found, help)?;
        }
        let is_deformed =
            [&initial.modal_displacement, &initial.modal_velocity].into_iter().flatten().any(|&q| q != 0.0);
        self.not_off(effects, Effect::Flexibility, is_deformed, "an initial modal displacement or velocity")
    }

    /// Refuses an effect that is on although there is nothing to it.
    fn not_on(
        &self,
        effects: &Effects,
        effect: Effect,
        nothing: bool,
        found: &str,
        help: &str,
    ) -> Result<(), SceneError> {
        if effects.choices[effect] != Choice::On || !nothing {
            return Ok(());
        }
        let name = effect.name();
        Err(self.document.place(&join("effects", name)).refuse(
            format!("`{name} = true` with {found}"),
            "`false` or `\"auto\"`",
            format!("set `{name} = \"auto\"`, or {help}"),
        ))
    }

    /// Refuses an effect that is off although the scene demands it.
    fn not_off(&self, effects: &Effects, effect: Effect, demanded: bool, by: &str) -> Result<(), SceneError> {
        if effects.choices[effect] != Choice::Off || !demanded {
            return Ok(());
        }
        let name = effect.name();
        Err(self.document.place(&join("effects", name)).refuse(
            format!("`{name} = false` with {by}"),
            "`true` or `\"auto\"`",
            format!("set `{name} = \"auto\"`, or remove {by}"),
        ))
    }
}
