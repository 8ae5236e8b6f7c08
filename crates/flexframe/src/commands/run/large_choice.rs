//! The choice of large modes by the check, at the rows that a run has reached.
//!
//! While a body is built nobody knows how far and how long each of its modes will swing. The check knows what a model is wrong by at the states of a
//! run: other choices are held against the full body at the worst of them, and the best is told, or taken where the scene leaves it open.

use diagnostic::Failure;
use dynamics::{Effect, EffectMap};
use model::{Builder, Model, Needs};
use results::Results;
use scene::{Body, Choice, Scene, assign, key_path};
use serde::Serialize;
use toml::Value;

use crate::commands::check::checked_rows::check_run;
use crate::commands::check::report::{BodyCheck, CheckReport, RowCheck};
use crate::commands::check::rows::{self, CheckRows};
use crate::files::json;
use crate::trust::{model_error, percent};

/// Error of a model below which no other choice is looked for.
pub(crate) const WORTH: f64 = 1e-2;
/// The same, as a part of the accuracy that is asked for.
const WORTH_OF_ACCURACY: f64 = 0.5;
/// A choice is better where its error is below this part.
const BETTER: f64 = 0.5;
/// Large modes, and those that follow them, beyond which more are no better.
const LARGE: usize = 2;
const FOLLOWING: usize = 3;
/// Steps of a run beyond which it is not made again.
const LONG: u64 = 1_000_000;

/// Large modes that the check has found better than those of a run.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct LargeChoice {
    /// The large modes, numbered from 1.
    pub large: Vec<usize>,
    /// The most that follow them.
    pub following: usize,
    /// The error of the model with them at the worst of the checked states of the run, over the largest displacements.
    #[serde(serialize_with = "json::number")]
    pub error: f64,
    /// The error of the model of the run there.
    #[serde(serialize_with = "json::number")]
    pub before: f64,
}

/// Error of a model below which no other choice is looked for, where an accuracy is asked for.
pub(super) fn worth(accuracy: f64) -> f64 {
    WORTH_OF_ACCURACY * accuracy
}

impl LargeChoice {
    /// The best other choice of the large modes of a lone body whose model the check found wrong by more than `worth`, if one is better.
    ///
    /// # Errors
    /// [`Failure`]: the check of a choice.
    pub(super) fn better(
        results: &Results,
        (system, models): (&Scene, &[Model]),
        builder: &Builder,
        check: &CheckReport,
        worth: f64,
    ) -> Result<Option<Self>, Failure> {
        let ([scene], [model], [BodyCheck { rows, .. }]) = (&system.bodies[..], models, &check.bodies[..]) else {
            return Ok(None);
        };
        let error_of = |row: &RowCheck| model_error(std::slice::from_ref(row));
        let Some(worst) = rows.iter().max_by(|a, b| error_of(a).total_cmp(&error_of(b))) else { return Ok(None) };
        let before = error_of(worst);
        if !(before >= worth && may_be_large(scene, model)) {
            return Ok(None);
        }
        let candidates = candidates(scene, model, &rows::course(results, 0).swings);
        if candidates.is_empty() {
            return Ok(None);
        }
        let rows = CheckRows::Given(vec![worst.row]);
        let Ok(assembly) = builder.assemble(scene, |_| ()) else { return Ok(None) };
        let Ok(mut variants) = assembly.variants() else { return Ok(None) };
        let mut best: Option<Self> = None;
        for (large, following) in candidates {
            let needs = Needs {
                effects: EffectMap::from_fn(|effect| (effect == Effect::LargeDeflection).then_some(true)),
                large: Some(large.clone()),
                following: Some(following),
                ..builder.needs.clone()
            };
            // A choice that is refused is none.
            let Ok(built) = variants.build(scene, &needs, |_| ()) else { continue };
            if built.body.circular_frequencies != model.body.circular_frequencies {
                continue;
            }
            let checked = check_run(&check.results, results, system, &[built], builder, &rows, |_| ())?;
            let error = checked.bodies.first().map_or(f64::INFINITY, |body| model_error(&body.rows));
            if error < best.as_ref().map_or(BETTER * before, |best| best.error) {
                best = Some(Self { large, following, error, before });
            }
        }
        Ok(best)
    }

    /// Words on bodies of a run of several whose model the check found wrong by more than a per cent: other large modes were not tried.
    pub(super) fn not_tried((system, models): (&Scene, &[Model]), check: &CheckReport) -> Option<String> {
        if system.bodies.len() < 2 {
            return None;
        }
        let bodies = system.bodies.iter().zip(models).zip(&check.bodies);
        let wrong = bodies.filter(|((given, model), body)| {
            may_be_large(given, model) && model.body.flexible() > 0 && model_error(&body.rows) >= WORTH
        });
        let names: Vec<&str> = wrong.filter_map(|((given, _), _)| given.name.as_deref()).collect();
        (!names.is_empty()).then(|| {
            format!(
                "other large modes were not tried for {}: the check tries them for a body alone; name some in `large` of its \
                 `modes`, and compare the trust in the model",
                names.join(", ")
            )
        })
    }

    /// The system with this choice, if the scene leaves it open and the run may be made again.
    pub(super) fn taken(&self, system: &Scene, steps: u64) -> Option<Scene> {
        let [scene] = &system.bodies[..] else { return None };
        if scene.modes.large.is_some() || steps > LONG {
            return None;
        }
        let key = |key: &str| match &scene.name {
            Some(name) => format!("{}.{key}", key_path("bodies", name)),
            None => key.to_owned(),
        };
        let number = |number: usize| i64::try_from(number).map_or(Value::Integer(i64::MAX), Value::Integer);
        let large = self.large.iter().map(|mode| number(*mode)).collect();
        let values = [
            ("effects.large_deflection", Value::Boolean(true)),
            ("modes.large", Value::Array(large)),
            ("modes.following", number(self.following)),
        ];
        let text = assign(&system.text, &values.map(|(of, value)| (key(of), value))).ok()?;
        Scene::parse(&text, &system.path).ok()
    }

    /// The keys of the choice, with their values.
    fn keys(&self) -> String {
        format!("`large = {:?}` with `following = {}` in [modes]", self.large, self.following)
    }

    /// The cure of a run without it.
    pub(crate) fn cure(&self) -> String {
        format!(
            "{}: at the worst row the check finds {} for {}",
            self.keys(),
            percent(self.error),
            percent(self.before)
        )
    }

    /// The words of a run that has taken it.
    pub(super) fn reason(&self) -> String {
        format!(
            "chosen by the check, by which the model of a first run, without {}, was off by up to {}",
            self.keys(),
            percent(self.before)
        )
    }
}

/// True if large modes may be among those of a body.
fn may_be_large(body: &Body, model: &Model) -> bool {
    body.method().abilities.large_deflection
        && body.effects.choices[Effect::LargeDeflection] != Choice::Off
        && model.static_answer().is_none()
}

/// Choices that differ from that of a model: large modes numbered from 1, and the most that follow them.
fn candidates(body: &Body, model: &Model, swings: &[f64]) -> Vec<(Vec<usize>, usize)> {
    let now: Vec<usize> = model.large_modes().iter().map(|k| k + 1).collect();
    let mut order: Vec<usize> = (0..swings.len().min(model.body.natural_modes)).filter(|k| swings[*k] > 0.0).collect();
    order.sort_by(|a, b| swings[*b].total_cmp(&swings[*a]));
    let furthest = |count: usize| {
        let mut large: Vec<usize> = order.iter().take(count).map(|k| k + 1).collect();
        large.sort_unstable();
        large
    };
    let following = body.modes.following;
    let mut choices = Vec::new();
    for large in (1..=LARGE).map(furthest).chain([now.clone()]) {
        for following in [following, following.min(FOLLOWING)] {
            let choice = (large.clone(), following);
            if !large.is_empty() && choice != (now.clone(), body.modes.following) && !choices.contains(&choice) {
                choices.push(choice);
            }
        }
    }
    choices
}

#[cfg(test)]
mod tests {
    use scene::Large;

    use super::*;

    #[test]
    fn the_choice_of_a_body_alone_is_taken_with_a_name_or_without() {
        let choice = LargeChoice { large: vec![1, 3], following: 2, error: 0.01, before: 0.3 };
        for (body, modes) in [("body", "modes"), ("bodies.'left wing'", "bodies.'left wing'.modes")] {
            let text = format!(
                "title = 't'\nunits = {{ length = 'm', mass = 'kg', time = 's' }}\n[{body}]\nmesh = 'wing.msh'\n\
                 material = {{ young_modulus = 7e10, poisson_ratio = 0.3, density = 2700.0 }}\n[{modes}]\nflexible = 4\n\
                 [time]\nend = 1.0\ntolerance = 1e-4\n"
            );
            let scene = Scene::parse(&text, "wing.toml").unwrap();
            let taken = choice.taken(&scene, 1000).unwrap();
            let modes = &taken.bodies[0].modes;
            assert_eq!((&modes.large, modes.following), (&Some(Large::List(vec![1, 3])), 2), "{body}");
            assert_eq!(taken.bodies[0].effects.choices[Effect::LargeDeflection], Choice::On);
            // What the scene says stays.
            assert_eq!(choice.taken(&taken, 1000), None);
        }
    }
}
