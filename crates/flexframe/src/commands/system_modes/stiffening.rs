//! Loads of joints on the bodies of a system where its scene starts and the frequencies that they change, in numbers and in sentences.

use std::f64::consts::TAU;

use dynamics::{BodyStiffening, Effect, SteadyError, StiffenedMode};
use model::Model;
use scene::Scene;
use serde::Serialize;

use super::assembled::TiedMotion;
use super::report::body_names;
use crate::files::json;
use crate::report::{quantity, rounded};
use crate::rows::units::UnitLabels;
use crate::surface::Surface;

/// A flexible body of a system, in the motion that it starts with.
#[derive(Debug, Clone, Serialize)]
pub struct StiffenedBody {
    /// Its name.
    pub body: String,
    /// The largest force that a joint, spring or bushing puts on one marker of it.
    #[serde(serialize_with = "json::number")]
    pub force: f64,
    /// The largest moment.
    #[serde(serialize_with = "json::number")]
    pub moment: f64,
    /// The largest displacement of its surface that all forces bend it by, in the frame of its modes.
    #[serde(serialize_with = "json::number")]
    pub deflection: f64,
    /// False if the scene lets no forces stiffen it.
    pub stiffens: bool,
    /// Relative changes of frequencies below this do not count: the tolerance of its effects.
    #[serde(skip)]
    pub tolerance: f64,
    /// Frequencies of the slowest vibrations in which it bends.
    pub modes: Vec<StiffenedFrequency>,
}

/// The frequency of one vibration, cycles per time.
#[derive(Debug, Clone, Copy, Serialize)]
pub struct StiffenedFrequency {
    /// In the motion of the start.
    #[serde(serialize_with = "json::number")]
    pub frequency: f64,
    /// The same if the stress of the forces of joints stiffened no body.
    #[serde(serialize_with = "json::number")]
    pub without_stress: f64,
    /// At rest in this place, if no forces acted.
    #[serde(serialize_with = "json::number")]
    pub unloaded: f64,
}

impl From<&StiffenedMode> for StiffenedFrequency {
    fn from(mode: &StiffenedMode) -> Self {
        let [frequency, without_stress, unloaded] =
            [mode.moving, mode.without_stress, mode.unloaded].map(|omega| omega / TAU);
        Self { frequency, without_stress, unloaded }
    }
}

/// The flexible bodies of a system in the motion that they start with.
pub(super) fn stiffened(
    scene: &Scene,
    models: &[Model],
    motion: &TiedMotion,
) -> Result<Vec<StiffenedBody>, SteadyError> {
    let of_body = |(body, (number, found)): (String, (&usize, BodyStiffening))| {
        let model = &models[*number];
        let largest = |surface: Surface| {
            surface
                .displacements(&model.coordinates(&found.modal_displacement))
                .iter()
                .map(nalgebra::Vector3::norm)
                .fold(0.0, f64::max)
        };
        (model.body.flexible() > 0).then(|| StiffenedBody {
            body,
            force: found.force,
            moment: found.moment,
            deflection: largest(Surface::of_model(model)),
            stiffens: model.physics.effects[Effect::GeometricStiffening],
            tolerance: scene.bodies[*number].effects.tolerance,
            modes: found.modes.iter().map(StiffenedFrequency::from).collect(),
        })
    };
    let found = motion.run.motion().stiffening()?;
    let names = body_names(scene, &motion.bodies);
    Ok(names.into_iter().zip(motion.bodies.iter().zip(found)).filter_map(of_body).collect())
}

impl StiffenedBody {
    /// A sentence about it.
    pub(super) fn sentence(&self, units: UnitLabels<'_>, frequency_unit: &str) -> String {
        let &Self { ref body, force, moment, tolerance, .. } = self;
        let (length, unit) = (units.length, frequency_unit);
        let bent = if self.deflection > 0.0 {
            format!(", and it bends by up to {} {length}", short(self.deflection))
        } else {
            String::new()
        };
        let borne = format!(
            "{body}: at the start its joints bear up to {} {} and {} {}{bent}",
            short(force),
            units.force(),
            short(moment),
            units.moment(),
        );
        if !self.stiffens {
            return format!("{borne}; forces do not stiffen it, as the scene says");
        }
        let Some(lowest) = self.modes.first() else { return borne };
        let relative = |mode: &StiffenedFrequency| {
            [mode.frequency / mode.unloaded - 1.0, mode.frequency / mode.without_stress - 1.0]
        };
        let largest = |k: usize| {
            self.modes.iter().map(|mode| relative(mode)[k]).max_by(|a, b| a.abs().total_cmp(&b.abs())).unwrap_or(0.0)
        };
        let [change, by_stress] = [0, 1].map(largest);
        if change.abs() < tolerance {
            return format!("{borne}; that changes its frequencies by {} % at most", short(100.0 * change.abs()));
        }
        let [of_lowest, _] = relative(lowest);
        let keep = if by_stress.abs() < tolerance {
            "`geometric_stiffening = false` in its [effects] would do there".to_owned()
        } else {
            format!("without `geometric_stiffening` a frequency would be off by {} %", short(100.0 * by_stress.abs()))
        };
        format!(
            "{borne}; forces and motion take its lowest frequency from {} to {} {unit} ({:+.2} %); {keep}",
            short(lowest.unloaded),
            short(lowest.frequency),
            100.0 * of_lowest
        )
    }
}

/// A number to four digits.
fn short(value: f64) -> String {
    quantity(rounded(value, 4))
}
