//! The stress of bent bodies with large modes, and what the model states that it leaves out of it.

use model::{BodyStressCheck, StateCheck};
use nonlinear::StateErrorSettings;
use scene::Choice;

use crate::bodies::{ARC, BRACKET, Body, CLAMP, CONSTANT, checked};

impl Body {
    /// The rest under a dead force at its tip, with its stress.
    fn stressed(&self, force: [f64; 3], statics: Choice) -> (Vec<usize>, StateCheck) {
        let rest = format!("{CLAMP}{}[output]\npeak_stress = true\nstress = true\n", self.force(force, 1.0, CONSTANT));
        let mut scene = self.scene("", &rest);
        scene.modes.static_correction = statics;
        let (model, check) = checked(&scene, &StateErrorSettings::converged());
        (model.large_modes().to_vec(), check)
    }
}

/// Independent reference: the stress of the full nonlinear body of the same mesh. What the model states that it leaves out is that of
/// the linear answers: it is to be of the size of the true error, also where large modes bend the body.
#[test]
fn what_is_left_out_of_the_stress_is_of_the_size_of_its_error() {
    for (name, body, force) in [
        ("bracket, 1 N", BRACKET, [0.0, -1.0, 0.0]),
        ("bracket, 30 N", BRACKET, [0.0, -30.0, 0.0]),
        ("arc, 1 N", ARC, [0.0, 0.0, 1.0]),
        ("arc, 13 N", ARC, [0.0, 0.0, 13.0]),
        ("arc, 35 N", ARC, [0.0, 0.0, 35.0]),
    ] {
        for statics in [Choice::Off, Choice::On] {
            let (large, check) = body.stressed(force, statics);
            let BodyStressCheck { full, error, max_error, max_left_out, .. } = check.stress.unwrap().body.unwrap();
            println!(
                "{name}, {statics:?}: large {large:?}, stress {full:.3e}, off by {:.2} % there and {:.2} % at most, stated {:.2} %",
                100.0 * error / full,
                100.0 * max_error / full,
                100.0 * max_left_out / full
            );
        }
    }
}
