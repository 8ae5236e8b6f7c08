//! The state of a run at a time.

use diagnostic::{Diagnostic, Failure, Kind};
use dynamics::{Island, MotionState, Reached, StepError};
use model::Model;
use scene::Scene;

use crate::motion::{self, StartSettings};

/// Steps that are taken at once.
const STEPS: u64 = 1000;
/// A part of the speed of a body's vibration, by ω q, that is more than a rest.
const MOVES: f64 = 1e-3;

/// The state of each body at a time of the scene's run.
pub(super) fn states_at(scene: &Scene, models: &[Model], time: f64) -> Result<Vec<MotionState>, Failure> {
    let end = scene.time.end;
    if !(time.is_finite() && (0.0..=end).contains(&time)) {
        let expected = format!("0 to {end}, the end of the run");
        let wrong = Kind::Usage.of(&scene.path).found(time.to_string()).expected(&expected);
        return Err(wrong.says(format!("time {time}: expected {expected}")));
    }
    let references: Vec<&Model> = models.iter().collect();
    let beginning = StartSettings::of(scene, &references);
    let mut states: Vec<Option<MotionState>> = vec![None; models.len()];
    let failed = |source: StepError| source.in_file(&scene.path);
    let mut run = motion::begin(scene, &references, &beginning)?;
    run.set_stop_time(Some(time));
    while run.time() < time {
        if let Reached::Stop | Reached::End = run.advance(STEPS, |_, _| ()).map_err(|of| failed(of.source))? {
            break;
        }
    }
    for Island { motion, bodies, .. } in run.islands() {
        for (body, state) in bodies.iter().zip(motion.states().map_err(failed)?) {
            states[*body] = Some(state);
        }
    }
    Ok(states.into_iter().flatten().collect())
}

/// Reservations about a state whose modes are in motion: equations are about the rest that is near.
pub(super) fn moving_modes(models: &[Model], states: &[MotionState]) -> Vec<String> {
    let mut warnings = Vec::new();
    for (model, state) in models.iter().zip(states) {
        let swings = state.modal_velocity.iter().zip(&model.body.circular_frequencies).map(|(v, omega)| v / omega);
        let deflection = model.deflection(&swings.collect::<Vec<_>>());
        if deflection > MOVES {
            warnings.push(format!(
                "at that time modes swing by {:.1e} of the length of a body; the equations are about the steady state near it",
                deflection
            ));
        }
    }
    warnings
}
