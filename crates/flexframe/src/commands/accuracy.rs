//! A run to an accuracy that is asked for: the settings are found by the trust card.
//!
//! The scene is run as it stands, and rows are checked by the full nonlinear body. The largest share of the error on the card is mended and the
//! scene run again, until the sum is below the accuracy, or something stops it that no setting mends. The last run that was better than those
//! before it stands. Meshes, modes and static responses that were found are found again in the cache.

mod change;
mod stated;

use std::fs;
use std::path::Path;
use std::time::Instant;

use diagnostic::Diagnostic;
use model::{Builder, Model};
use results::unfinished;
use scene::{Body, Choice, Effect, Flexible, Scene, StepControl, assign, without};
use toml::Value;
use whole_file::TemporaryFolder;

use crate::commands::run::{
    self, AccuracyReport, LargeChoice, Round, RunError, RunProgress, RunReport, RunSettings, StoppedBy, WORTH,
    check_files, run_models,
};
use crate::trust::model_error;
use change::{Change, Facts, PART, Stop, Tried, next};
use stated::{BodyError, errors};

/// Runs of a search at the most.
const ROUNDS: usize = 10;
/// A change is kept where it leaves less than this part of the stated error.
const WORTHWHILE: f64 = 0.8;

/// Runs a scene to the accuracy of the settings, or else of the scene; without one as it stands. What it was run with at the end is in the
/// report, and the scene in the results file has it.
///
/// # Errors
/// As [`run::run`]. A scene without a body whose elements are known, or with rigid ones alone, is refused.
pub fn run(
    scene: &Scene,
    folder: &Path,
    settings: &RunSettings,
    mut progress: impl FnMut(RunProgress),
) -> Result<(Vec<Model>, RunReport), RunError> {
    let asked = settings.accuracy.or(scene.accuracy);
    let Some(asked) = asked.filter(|_| settings.check) else {
        let (models, mut report) = run::run(scene, folder, settings, progress)?;
        if asked.is_some() {
            let words = "the accuracy was not gone for: the run was made without the check";
            report.warnings.push(words.to_owned());
        }
        return Ok((models, report));
    };
    let (with_mesh, left_out) = bodies(scene)?;
    check_files(scene, folder, settings)?;
    // Rounds find what earlier ones have asked of the mesh.
    let kept =
        TemporaryFolder::inside(folder).map_err(|source| RunError::Folder { folder: folder.to_owned(), source })?;
    let cache = match &settings.builder.cache {
        cache if cache.folder().is_some() => cache.clone(),
        none => none.elsewhere(kept.path().join("cache"), u64::MAX),
    };
    let builder = Builder { cache, ..settings.builder.clone() };
    let settings = RunSettings { accuracy: Some(asked), builder, ..settings.clone() };
    let mut search = Search { asked, given: scene, with_mesh, folder, settings, keys: Vec::new(), rounds: Vec::new() };
    let mut best = search.first(&mut progress)?;
    let stop = search.go_on(&mut best, kept.path(), &mut progress)?;
    Ok(search.end(best, stop, left_out))
}

/// The numbers of the bodies that have a mesh and bend, and the others with the reason.
fn bodies(scene: &Scene) -> Result<(Vec<usize>, Vec<String>), RunError> {
    let why = |body: &Body| -> Option<&str> {
        let is_rigid =
            body.modes.flexible == Flexible::Count(0) || body.effects.choices[Effect::Flexibility] == Choice::Off;
        body.source.not_by_elements().or_else(|| is_rigid.then_some("a body without flexible modes"))
    };
    let with_mesh: Vec<usize> = (0..scene.bodies.len()).filter(|body| why(&scene.bodies[*body]).is_none()).collect();
    let (Some(first), true) = (scene.bodies.first(), with_mesh.is_empty()) else {
        let name = |body: &Body| body.name.clone().unwrap_or_default();
        let left_out = scene.bodies.iter().filter_map(|body| Some(format!("{}: it is {}", name(body), why(body)?)));
        return Ok((with_mesh, left_out.collect()));
    };
    let found = why(first).unwrap_or_default();
    let help = "give the body a mesh and flexible modes, or leave the accuracy out and compare with more modes or a finer model by hand";
    let refused =
        first.refuse("body", found, "a body with a mesh and flexible modes, whose error can be measured", help);
    Err(RunError::Build(refused.into()))
}

/// A run and the error that its card states.
struct Found {
    scene: Scene,
    models: Vec<Model>,
    report: RunReport,
    errors: Vec<BodyError>,
}

impl Found {
    fn worst(&self) -> f64 {
        self.errors.first().map_or(f64::INFINITY, BodyError::at_most)
    }

    /// The stated error of the worst body, if it is known.
    fn stated(&self) -> Option<f64> {
        self.errors.first()?.whole()
    }

    fn is_below(&self, accuracy: f64) -> bool {
        self.worst() < accuracy && self.errors.iter().all(|error| !error.unstable)
    }

    /// The largest share in words.
    fn largest(&self) -> String {
        self.errors.first().map_or_else(String::new, |error| error.order()[0].name().to_owned())
    }
}

/// A key of the scene and its value; none where it is taken out.
type Keys = Vec<(String, Option<Value>)>;

/// Puts keys in the place of those with the same path.
fn put(keys: &mut Keys, new: Keys) {
    keys.retain(|(path, _)| new.iter().all(|(other, _)| other != path));
    keys.extend(new);
}

/// A search for settings.
struct Search<'a> {
    asked: f64,
    given: &'a Scene,
    with_mesh: Vec<usize>,
    folder: &'a Path,
    settings: RunSettings,
    /// The settings of the best run.
    keys: Keys,
    rounds: Vec<Round>,
}

impl Search<'_> {
    /// The scene with some keys.
    fn scene(&self, keys: &Keys) -> Result<Scene, RunError> {
        let removed: Vec<String> =
            keys.iter().filter(|(_, value)| value.is_none()).map(|(key, _)| key.clone()).collect();
        let set: Vec<(String, Value)> =
            keys.iter().filter_map(|(key, value)| Some((key.clone(), value.clone()?))).collect();
        let text = without(&self.given.text, &removed);
        // A path that leads nowhere stays as it is.
        let text = assign(&text, &set).unwrap_or(text);
        Ok(Scene::parse(&text, &self.given.path)?)
    }

    fn name(&self, body: usize) -> Option<&str> {
        self.given.bodies.get(body)?.name.as_deref()
    }

    /// A change of a body in words, with its name where there are several.
    fn words(&self, body: usize, change: &Change) -> String {
        let name = self.name(body).filter(|_| self.given.bodies.len() > 1);
        name.map_or_else(|| change.words(), |name| format!("{name}: {}", change.words()))
    }

    fn run(&self, keys: &Keys, overwrite: bool, progress: &mut dyn FnMut(RunProgress)) -> Result<Found, RunError> {
        let scene = self.scene(keys)?;
        let settings = RunSettings { overwrite: self.settings.overwrite || overwrite, ..self.settings.clone() };
        let models = settings.builder.models(&scene, |p| progress(RunProgress::Build(p)))?;
        progress(RunProgress::Built);
        for body in &self.with_mesh {
            let (given, model) = (&scene.bodies[*body], &models[*body]);
            let is_straight = model.meshed.as_ref().is_some_and(|meshed| meshed.reference.is_none());
            // The run would be the one before.
            if is_straight && keys.contains(&about(self.name(*body))) {
                let help = "leave it out";
                let refused =
                    given.refuse("modes.about", "no rest that bends far", "a steady load or spin that does", help);
                return Err(RunError::Build(refused.into()));
            }
        }
        let report = run_models(&scene, &models, self.folder, &settings, progress)?;
        let errors = errors(&report, &self.with_mesh);
        Ok(Found { scene, models, report, errors })
    }

    /// The first run: of the scene as it stands, but for settings that could not reach the accuracy. Where its model is refused, with large
    /// modes.
    fn first(&mut self, progress: &mut dyn FnMut(RunProgress)) -> Result<Found, RunError> {
        let mut changes: Vec<(usize, Change)> = Vec::new();
        for body in &self.with_mesh {
            if self.given.bodies[*body].effects.tolerance > PART * self.asked * (1.0 + 1e-9) {
                changes.push((*body, Change::Effects(PART * self.asked)));
            }
        }
        match self.given.time.control {
            StepControl::Tolerance(tolerance) if tolerance > 0.5 * self.asked => {
                changes.push((0, Change::Tolerance(PART * self.asked)));
            }
            StepControl::Tolerance(_) | StepControl::Fixed(_) => {}
        }
        let started = Instant::now();
        let found = match self.begin(&changes, false, progress) {
            Err(RunError::Refused { .. }) => {
                let large = self.with_mesh.iter().map(|body| (*body, Change::LargeModes));
                changes.extend(large);
                self.begin(&changes, true, progress)?
            }
            found => found?,
        };
        let words: Vec<String> = changes.iter().map(|(body, change)| self.words(*body, change)).collect();
        let change = if words.is_empty() { "the scene as it stands".to_owned() } else { words.join(", ") };
        let (after, largest, seconds) = (found.stated(), found.largest(), started.elapsed().as_secs_f64());
        self.rounds.push(Round { change, before: None, after, largest, kept: true, seconds });
        Ok(found)
    }

    fn begin(
        &mut self,
        changes: &[(usize, Change)],
        overwrite: bool,
        progress: &mut dyn FnMut(RunProgress),
    ) -> Result<Found, RunError> {
        self.keys = changes.iter().flat_map(|(body, change)| change.keys(self.name(*body))).collect();
        self.run(&self.keys, overwrite, progress)
    }

    /// Mends and runs until the accuracy is reached (`None`) or something stops it. `best` is the best run then, and its results are in their place.
    fn go_on(
        &mut self,
        best: &mut Found,
        kept: &Path,
        progress: &mut dyn FnMut(RunProgress),
    ) -> Result<Option<Stop>, RunError> {
        let mut tried = Tried::default();
        let mut steps_are_in_the_way = false;
        while !best.is_below(self.asked) {
            let worst = best.errors.iter().find(|error| error.at_most() >= self.asked || error.unstable);
            let Some(error) = worst.cloned() else { break };
            let change =
                match next(&error, &Facts { steps_are_in_the_way, ..self.facts(best, error.body) }, self.asked, &tried)
                {
                    Ok(_) if self.rounds.len() == ROUNDS => {
                        let why = format!("the number of runs, {ROUNDS}: begin with the settings below to go on");
                        return Ok(Some(Stop { by: StoppedBy::Rounds, why }));
                    }
                    Ok(change) => change,
                    Err(stop) => return Ok(Some(stop)),
                };
            let mut keys = self.keys.clone();
            put(&mut keys, change.keys(self.name(error.body)));
            let results = best.report.results.clone();
            // A name that a kept file may have still: of two links to one file a renaming leaves both.
            let place = kept.join(format!("{}.h5", self.rounds.len()));
            let failed = |source| RunError::Folder { folder: kept.to_owned(), source };
            fs::hard_link(&results, &place).or_else(|_| fs::copy(&results, &place).map(|_| ())).map_err(failed)?;
            let started = Instant::now();
            let found = self.run(&keys, true, progress);
            let seconds = started.elapsed().as_secs_f64();
            let (before, change_in_words) = (best.stated(), self.words(error.body, &change));
            let mut round =
                Round { change: change_in_words, before, after: None, largest: String::new(), kept: false, seconds };
            match found {
                Ok(found) => {
                    (round.after, round.largest) = (found.stated(), found.largest());
                    let is_in_the_way = steps_are_in_the_way && change.is_of_steps();
                    round.kept =
                        is_better(&found, best, self.asked) || (is_in_the_way && found.worst() <= best.worst());
                    steps_are_in_the_way = false;
                    if round.kept {
                        (self.keys, *best) = (keys, found);
                    }
                }
                Err(error @ RunError::Stopped { .. }) => {
                    fs::rename(&place, &results).map_err(failed)?;
                    return Err(error);
                }
                Err(error) => {
                    steps_are_in_the_way = error.diagnosis().key.as_deref() == Some("time.step") && !tried.has_steps();
                    fs::remove_file(unfinished(&results)).ok();
                    let place = error.diagnosis().key.unwrap_or_else(|| error.without_files());
                    round.largest = format!("failed: {}", place.lines().next().unwrap_or_default());
                }
            }
            match round.kept {
                true => fs::remove_file(&place).map_err(failed)?,
                false => {
                    // A change that wants shorter steps first is not in vain.
                    if !steps_are_in_the_way {
                        tried.add(error.body, &change);
                    }
                    fs::rename(&place, &results).map_err(failed)?;
                }
            }
            self.rounds.push(round);
        }
        Ok(None)
    }

    fn facts(&self, found: &Found, body: usize) -> Facts {
        let (given, model) = (&found.scene.bodies[body], &found.models[body]);
        let better = found.report.large_choice.as_ref().filter(|_| found.scene.bodies.len() == 1);
        let mesh_size = match &given.source {
            scene::BodySource::Meshed(meshed) => meshed.mesh_size,
            _ => None,
        };
        Facts {
            modes: model.body.flexible() - model.static_shapes(),
            has_static_shapes: model.static_shapes() > 0,
            has_large_modes: !model.large_modes().is_empty(),
            is_without_stiffening: given.effects.choices[Effect::GeometricStiffening] == Choice::Off,
            may_bend_far: given.method().abilities.large_deflection,
            better: better.map(|LargeChoice { large, following, .. }| (large.clone(), *following)),
            is_about_rest: given.modes.about.is_some(),
            control: given.time.control,
            rows: given.rows,
            end: given.time.end,
            estimates_error: found.scene.method().estimates_error,
            mesh_size,
            steps_are_in_the_way: false,
        }
    }

    /// The best run with the report of the search.
    fn end(mut self, best: Found, stop: Option<Stop>, left_out: Vec<String>) -> (Vec<Model>, RunReport) {
        self.pin(&best);
        let reached = stop.is_none();
        let Found { models, mut report, errors, .. } = best;
        let first = errors.first();
        let (stopped_by, why) = stop.map(|stop| (stop.by, stop.why)).unzip();
        if let Some(why) = &why {
            report.warnings.push(format!("the accuracy is not reached: it is stopped by {why}"));
        }
        let mesh_phase = first.and_then(|error| mesh_phase(self.given.time.end, &models[error.body], error));
        report.large_choice = None;
        report.accuracy = Some(AccuracyReport {
            asked: self.asked,
            stated: first.filter(|error| error.unknown.is_none()).and_then(BodyError::whole),
            of: first.map_or_else(String::new, |error| error.of.clone()),
            reached,
            stopped_by,
            why,
            mesh_phase,
            left_out,
            rounds: self.rounds,
            settings: settings_text(&self.given.text, &self.keys),
        });
        (models, report)
    }

    /// Names the large modes that a plain run would choose anew, as its first run is off by more than that takes.
    fn pin(&mut self, best: &Found) {
        let ([body], [model]) = (&best.scene.bodies[..], &best.models[..]) else { return };
        let checked = best.report.check.as_ref().and_then(|check| check.bodies.first());
        let is_right = checked.is_some_and(|checked| model_error(&checked.rows) < WORTH);
        if is_right || body.modes.large.is_some() {
            return;
        }
        let answer = model.static_answer();
        let large: Vec<usize> = model.large_modes().iter().filter(|k| answer != Some(**k)).map(|k| k + 1).collect();
        let change = match large.is_empty() {
            true => Change::NoneLarge,
            false => Change::TheseLarge(large, body.modes.following),
        };
        put(&mut self.keys, change.keys(body.name.as_deref()));
    }
}

/// The key of modes about a bent rest.
fn about(body: Option<&str>) -> (String, Option<Value>) {
    Change::BentRest.keys(body).swap_remove(0)
}

/// True if a run is so much better than another that its settings are worth it: what is not known is worse than all that is.
fn is_better(found: &Found, than: &Found, accuracy: f64) -> bool {
    let [found, than] = [found, than].map(|of| [of.worst(), of.stated().unwrap_or(f64::INFINITY)]);
    let is_less = |k: usize| found[k] < WORTHWHILE * than[k];
    found[0] < accuracy || is_less(0) || (found[0] == than[0] && is_less(1))
}

/// The angle by which an error of the mesh shifts the first vibration of a body by the end of its run at the most, rad.
fn mesh_phase(end: f64, model: &Model, error: &BodyError) -> Option<f64> {
    let first = model.natural_frequencies().first().copied().filter(|first| *first > 0.0)?;
    Some(error.share(crate::trust::Place::Mesh) * std::f64::consts::TAU * first * end)
}

/// Keys as TOML, a table after the other; keys of a scene that are taken out, as comments.
fn settings_text(scene: &str, keys: &Keys) -> String {
    let mut tables: Vec<(&str, Vec<String>)> = Vec::new();
    for (path, value) in keys {
        let (table, key) = path.rsplit_once('.').unwrap_or(("", path));
        let Some(value) = value else { continue };
        let line = format!("{key} = {value}");
        match tables.iter_mut().find(|(other, _)| *other == table) {
            Some((_, lines)) => lines.push(line),
            None => tables.push((table, vec![line])),
        }
    }
    let is_there = |path: &String| without(scene, std::slice::from_ref(path)) != scene;
    let removed = keys.iter().filter(|(path, value)| value.is_none() && is_there(path));
    let removed = removed.map(|(path, _)| format!("# without {path}"));
    let tables = tables.into_iter().map(|(table, lines)| format!("[{table}]\n{}", lines.join("\n")));
    tables.chain(removed).collect::<Vec<_>>().join("\n")
}
