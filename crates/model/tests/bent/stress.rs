//! The stress of bent bodies with large modes, and what the model states that it leaves out of it.

use model::{BodyStressCheck, StateCheck};
use nonlinear::StateErrorSettings;
use scene::Choice;

use crate::bodies::{ARC, BRACKET, CLAMP, CONSTANT, Solid, checked};

impl Solid {
    /// The rest under a dead force at its tip, with its stress.
    fn stressed(&self, force: [f64; 3], statics: Choice) -> (Vec<usize>, StateCheck) {
        let rest = format!("{CLAMP}{}[output]\npeak_stress = true\nstress = true\n", self.force(force, 1.0, CONSTANT));
        let mut scene = self.scene("", &rest);
        scene.modes.static_correction = statics;
        let (model, check) = checked(&scene, &StateErrorSettings::converged());
        (model.large_modes().to_vec(), check)
    }
}

/// Independent reference: the stress of the full nonlinear body of the same mesh. The largest stress is right to half a per cent however
/// far large modes bend the body. What the model states that it leaves out is that of the linear answers: it is the error where the body
/// hardly bends, and less than the error where it bends far, which the check alone knows.
#[test]
fn the_check_knows_the_error_of_the_stress() {
    for (name, body, force, is_small) in [
        ("bracket, 1 N", BRACKET, [0.0, -1.0, 0.0], true),
        ("bracket, 30 N", BRACKET, [0.0, -30.0, 0.0], false),
        ("arc, 1 N", ARC, [0.0, 0.0, 1.0], true),
        ("arc, 35 N", ARC, [0.0, 0.0, 35.0], false),
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
            assert!(!large.is_empty(), "{name}");
            assert!(error < 5e-3 * full && error <= max_error && max_error < 0.035 * full, "{name}, {statics:?}");
            match (statics, is_small) {
                (Choice::On, _) => assert!(max_left_out < 1e-4 * full, "{name}"),
                (_, true) => {
                    assert!((max_left_out / max_error - 1.0).abs() < 0.1, "{name}: {max_left_out} {max_error}")
                }
                (_, false) => {
                    assert!((0.2..1.0).contains(&(max_left_out / max_error)), "{name}: {max_left_out} {max_error}")
                }
            }
        }
    }
}

/// Closed form: 6 M/a³ of the moment M = 0.6 N m at the root of the bracket, of a square section of a = 0.02 m. The clamp and the stress
/// of nodes, which is a mean, are worth 5 %.
#[test]
fn the_stress_of_the_full_body_is_that_of_bending() {
    let (_, check) = BRACKET.stressed([0.0, -1.0, 0.0], Choice::On);
    let stress = check.stress.unwrap();
    let (expected, found) = (6.0 * 0.6 / 0.02_f64.powi(3), stress.body.unwrap().full);
    assert!((found / expected - 1.0).abs() < 0.08, "{found} {expected}");
    // A point of its free end.
    let [tip] = &stress.points[..] else { panic!("{stress:?}") };
    assert!(tip.name == "tip" && tip.full < 0.1 * found && tip.error < 0.01 * found, "{tip:?}");
}
