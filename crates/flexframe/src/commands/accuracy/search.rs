//! The search for settings: a run, the change that mends the largest share of its error, and a run again.

use std::fs;
use std::io;
use std::path::Path;
use std::time::Instant;

use diagnostic::Diagnostic;
use model::Model;
use results::{Results, unfinished};
use scene::{BodySource, Choice, Effect, Scene, StepControl, assign, without};
use toml::Value;
use whole_file::TemporaryFolder;

use super::change::{Change, Facts, PART, Stop, Tried, next};
use super::left_out::{OfBody, difference};
use super::stated::{BodyError, errors};
use crate::commands::run::{
    AccuracyReport, LargeChoice, Round, RunError, RunProgress, RunReport, RunSettings, StoppedBy, WORTH, check_files,
    run_models,
};
use crate::report::rounded;
use crate::rows::columns::COLUMNS;
use crate::trust::{Place, model_error};

/// Runs of a search at the most.
const ROUNDS: usize = 10;
/// A change is kept where it leaves less than this part of the stated error.
const WORTHWHILE: f64 = 0.8;

/// A run and the error that its card states.
pub(super) struct Found {
    pub scene: Scene,
    models: Vec<Model>,
    report: RunReport,
    errors: Vec<BodyError>,
    /// True if it was compared with a run that has twice the modes.
    is_compared: bool,
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
pub(super) type Keys = Vec<(String, Option<Value>)>;

/// Puts keys in the place of those with the same path.
fn put(keys: &mut Keys, new: Keys) {
    keys.retain(|(path, _)| new.iter().all(|(other, _)| other != path));
    keys.extend(new);
}

/// A search for settings.
pub(super) struct Search<'a> {
    /// The error that is asked for.
    asked: f64,
    given: &'a Scene,
    with_mesh: Vec<usize>,
    left_out: Vec<String>,
    folder: &'a Path,
    settings: RunSettings,
    /// Where the results of the best run are kept while the next one is made, and what was asked of the mesh.
    kept: TemporaryFolder,
    /// The settings of the best run.
    keys: Keys,
    rounds: Vec<Round>,
}

impl<'a> Search<'a> {
    /// A search in a folder, which is made if it does not exist.
    pub fn new(
        given: &'a Scene,
        (with_mesh, left_out): (Vec<usize>, Vec<String>),
        folder: &'a Path,
        settings: &RunSettings,
    ) -> Result<Self, RunError> {
        check_files(given, folder, settings)?;
        let failed = |source| RunError::Folder { folder: folder.to_owned(), source };
        let kept = TemporaryFolder::inside(folder).map_err(failed)?;
        // Rounds find what earlier ones have asked of the mesh.
        let builder = settings.builder.with_cache_or(kept.path().join("cache"));
        let settings = RunSettings { builder, ..settings.clone() };
        let (keys, rounds) = (Keys::new(), Vec::new());
        Ok(Self { asked: 1.0, given, with_mesh, left_out, folder, settings, kept, keys, rounds })
    }

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
        let overwrite = self.settings.overwrite || overwrite;
        let settings = RunSettings { overwrite, accuracy: Some(self.asked), ..self.settings.clone() };
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
        Ok(Found { scene, models, report, errors, is_compared: false })
    }

    /// Settings that could not reach the accuracy, as they have to be.
    fn called_for(&self, scene: &Scene) -> Vec<(usize, Change)> {
        let most = rounded(PART * self.asked, 3);
        let effects = |body: &&usize| scene.bodies[**body].effects.tolerance > most;
        let changes = self.with_mesh.iter().filter(effects).map(|body| (*body, Change::Effects(most)));
        let is_coarse = matches!(scene.time.control, StepControl::Tolerance(tolerance) if tolerance > 0.5 * self.asked);
        changes.chain(is_coarse.then_some((0, Change::Tolerance(most)))).collect()
    }

    /// The run that a search begins with: the best one before, or of the scene as it stands, but for settings that could not reach the accuracy.
    /// Where its model is refused, with large modes. At the end of all searches it is the one before.
    pub fn begin(
        &mut self,
        asked: f64,
        before: Option<Found>,
        is_at_its_end: bool,
        progress: &mut dyn FnMut(RunProgress),
    ) -> Result<Found, RunError> {
        self.asked = asked;
        self.rounds.clear();
        let mut changes = self.called_for(before.as_ref().map_or(self.given, |found| &found.scene));
        let stated = before.as_ref().and_then(Found::stated);
        let is_first = before.is_none();
        if let (true, Some(before)) = (is_at_its_end || changes.is_empty(), before) {
            return Ok(before);
        }
        let started = Instant::now();
        let found = match self.with(&changes, !is_first, progress) {
            Err(RunError::Refused { .. }) => {
                let large = self.with_mesh.iter().map(|body| (*body, Change::LargeModes));
                changes.extend(large);
                self.with(&changes, true, progress)?
            }
            found => found?,
        };
        let words: Vec<String> = changes.iter().map(|(body, change)| self.words(*body, change)).collect();
        let change = if words.is_empty() { "the scene as it stands".to_owned() } else { words.join(", ") };
        let (after, largest, seconds) = (found.stated(), found.largest(), started.elapsed().as_secs_f64());
        self.rounds.push(Round { change, before: stated, after, largest, kept: true, seconds });
        Ok(found)
    }

    /// A run with changes of the settings, which stay.
    fn with(
        &mut self,
        changes: &[(usize, Change)],
        overwrite: bool,
        progress: &mut dyn FnMut(RunProgress),
    ) -> Result<Found, RunError> {
        let new = changes.iter().flat_map(|(body, change)| change.keys(self.name(*body))).collect();
        put(&mut self.keys, new);
        self.run(&self.keys, overwrite, progress)
    }

    /// Mends and runs until the accuracy is reached (`None`) or something stops it. `best` is the best run then, and its results are in their place.
    pub fn go_on(&mut self, best: &mut Found, progress: &mut dyn FnMut(RunProgress)) -> Result<Option<Stop>, RunError> {
        let mut tried = Tried::default();
        let mut steps_are_in_the_way = false;
        loop {
            match (best.is_below(self.asked), best.is_compared) {
                (true, true) => return Ok(None),
                (true, false) => {
                    self.compare(best, progress)?;
                    continue;
                }
                (false, _) => {}
            }
            let worst = best.errors.iter().find(|error| error.at_most() >= self.asked || error.unstable);
            let Some(error) = worst.cloned() else { return Ok(None) };
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
            let place = self.kept.path().join(format!("{}.h5", self.rounds.len()));
            fs::hard_link(&results, &place)
                .or_else(|_| fs::copy(&results, &place).map(|_| ()))
                .map_err(|source| self.not_kept(source))?;
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
                    fs::rename(&place, &results).map_err(|source| self.not_kept(source))?;
                    return Err(error);
                }
                Err(error) => {
                    steps_are_in_the_way = error.diagnosis().key.as_deref() == Some("time.step")
                        && !change.is_of_steps()
                        && !tried.has_steps();
                    fs::remove_file(unfinished(&results)).ok();
                    round.largest = failure(&error);
                }
            }
            match round.kept {
                true => fs::remove_file(&place).map_err(|source| self.not_kept(source))?,
                false => {
                    // A change that wants shorter steps first is not in vain.
                    if !steps_are_in_the_way {
                        tried.add(error.body, &change);
                    }
                    fs::rename(&place, &results).map_err(|source| self.not_kept(source))?;
                }
            }
            self.rounds.push(round);
        }
    }

    /// Compares the best run with one that has twice the modes, and adds the difference to its errors.
    fn compare(&mut self, best: &mut Found, progress: &mut dyn FnMut(RunProgress)) -> Result<(), RunError> {
        best.is_compared = true;
        let (started, before) = (Instant::now(), best.stated());
        let largest = match self.left_out(best, progress) {
            Ok(left_out) => {
                for error in &mut best.errors {
                    let of_body = self.with_mesh.iter().position(|body| *body == error.body);
                    error.left_out = of_body.and_then(|place| left_out[place]);
                }
                best.errors.sort_by(|a, b| b.at_most().total_cmp(&a.at_most()));
                best.largest()
            }
            Err(error @ RunError::Stopped { .. }) => return Err(error),
            Err(error) => failure(&error),
        };
        if best.errors.iter().any(|error| error.left_out.is_none()) {
            let words = "the vibrations of further modes: there is no run with twice as many to compare with";
            self.left_out.retain(|other| other != words);
            self.left_out.push(words.to_owned());
        }
        let (change, after, seconds) = (Round::TO_COMPARE.to_owned(), best.stated(), started.elapsed().as_secs_f64());
        self.rounds.push(Round { change, before, after, largest, kept: false, seconds });
        Ok(())
    }

    /// The largest difference of each body from a run that has twice the modes; `None` where its rows are others.
    fn left_out(&self, best: &Found, progress: &mut dyn FnMut(RunProgress)) -> Result<Vec<Option<f64>>, RunError> {
        let mut keys = self.keys.clone();
        for body in &self.with_mesh {
            put(&mut keys, Change::Modes(2 * natural(&best.models[*body])).keys(self.name(*body)));
        }
        let scene = self.scene(&keys)?;
        let builder = self.settings.builder.clone();
        let settings =
            RunSettings { overwrite: true, large: true, rows_alone: true, builder, ..RunSettings::default() };
        let models = settings.builder.models(&scene, |p| progress(RunProgress::Build(p)))?;
        let report = run_models(&scene, &models, self.kept.path(), &settings, progress)?;
        let open = |path: &Path| Results::open(path, &COLUMNS).map_err(RunError::File);
        let [results, others] = [open(&best.report.results)?, open(&report.results)?];
        let of = |body: &usize| {
            let run = OfBody { results: &results, body: *body, model: &best.models[*body] };
            difference(run, OfBody { results: &others, model: &models[*body], ..run })
        };
        Ok(self.with_mesh.iter().map(of).collect())
    }

    fn not_kept(&self, source: io::Error) -> RunError {
        RunError::Folder { folder: self.kept.path().to_owned(), source }
    }

    fn facts(&self, found: &Found, body: usize) -> Facts {
        let (given, model) = (&found.scene.bodies[body], &found.models[body]);
        let better = found.report.large_choice.as_ref().filter(|_| found.scene.bodies.len() == 1);
        let mesh_size = match &given.source {
            BodySource::Meshed(meshed) => meshed.mesh_size,
            _ => None,
        };
        Facts {
            modes: natural(model),
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
            modes_ring: found
                .errors
                .iter()
                .any(|error| error.body == body && error.left_out > Some(0.5 * error.share(Place::Modes))),
            steps_are_in_the_way: false,
        }
    }

    /// The best run with the report of the search.
    pub fn end(&self, best: Found, stop: Option<Stop>) -> (Vec<Model>, RunReport) {
        let accuracy = self.report(&best, stop);
        let Found { models, mut report, .. } = best;
        if let Some(why) = &accuracy.why {
            report.warnings.push(format!("the accuracy is not reached: it is stopped by {why}"));
        }
        report.large_choice = None;
        report.accuracy = Some(accuracy);
        (models, report)
    }

    /// The report of the search.
    pub fn report(&self, best: &Found, stop: Option<Stop>) -> AccuracyReport {
        let reached = stop.is_none();
        let first = best.errors.first();
        let (stopped_by, why) = stop.map(|stop| (stop.by, stop.why)).unzip();
        AccuracyReport {
            asked: self.asked,
            stated: first.filter(|error| error.unknown.is_none()).and_then(BodyError::whole),
            of: first.map_or_else(String::new, |error| error.of.clone()),
            reached,
            stopped_by,
            why,
            mesh_phase: first.and_then(|error| mesh_phase(self.given.time.end, &best.models[error.body], error)),
            left_out: self.left_out.clone(),
            rounds: self.rounds.clone(),
            settings: settings_text(&self.given.text, &self.pinned(best)),
        }
    }

    /// The settings of the best run, with the large modes that a plain run would choose anew, as its first run is off by more than that takes.
    pub fn pinned(&self, best: &Found) -> Keys {
        let mut keys = self.keys.clone();
        let ([body], [model]) = (&best.scene.bodies[..], &best.models[..]) else { return keys };
        let checked = best.report.check.as_ref().and_then(|check| check.bodies.first());
        let is_right = checked.is_some_and(|checked| model_error(&checked.rows) < WORTH);
        if is_right || body.modes.large.is_some() {
            return keys;
        }
        let answer = model.static_answer();
        let large: Vec<usize> = model.large_modes().iter().filter(|k| answer != Some(**k)).map(|k| k + 1).collect();
        let change = match large.is_empty() {
            true => Change::NoneLarge,
            false => Change::TheseLarge(large, body.modes.following),
        };
        put(&mut keys, change.keys(body.name.as_deref()));
        keys
    }
}

/// A run that failed, in a few words.
fn failure(error: &RunError) -> String {
    let place = error.diagnosis().key.unwrap_or_else(|| error.without_files());
    format!("failed: {}", place.lines().next().unwrap_or_default())
}

/// Natural modes of a model.
fn natural(model: &Model) -> usize {
    model.body.flexible() - model.static_shapes()
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
    Some(error.share(Place::Mesh) * std::f64::consts::TAU * first * end)
}

/// Keys of a scene that are taken out.
pub(super) fn removed<'a>(scene: &'a str, keys: &'a Keys) -> impl Iterator<Item = &'a String> {
    let removed = keys.iter().filter(|(_, value)| value.is_none()).map(|(path, _)| path);
    removed.filter(move |path| without(scene, std::slice::from_ref(*path)) != scene)
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
    let removed = removed(scene, keys).map(|path| format!("# without {path}"));
    let tables = tables.into_iter().map(|(table, lines)| format!("[{table}]\n{}", lines.join("\n")));
    tables.chain(removed).collect::<Vec<_>>().join("\n")
}
