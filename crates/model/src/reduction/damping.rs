//! The damping of a scene.

use dynamics::Effect;
use reduced_body::ReducedBody;
use scene::Choice;

use crate::needs::Needed;

/// One damping ratio for each flexible mode.
pub(crate) fn damping_ratios(scene: &Needed<'_>, body: &ReducedBody) -> Vec<f64> {
    let frequencies = body.circular_frequencies.iter().enumerate();
    match scene.effects.choices[Effect::Damping] {
        Choice::Off => vec![0.0; body.flexible()],
        Choice::On | Choice::Auto => frequencies.map(|(k, omega)| scene.modes.damping.ratio(k, *omega)).collect(),
    }
}
