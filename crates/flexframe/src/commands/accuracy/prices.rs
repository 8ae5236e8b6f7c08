//! The price list of accuracies: for each the settings that reach it, the error that is stated of them, and the time of the run.

use std::time::Instant;

use figures::{LineChart, Scale, Series, Stroke};
use model::Builder;
use report::{File, Form, Report, Table};
use scene::Scene;
use whole_file::TemporaryFolder;

use super::bodies;
use super::change::Stop;
use super::search::{Found, Keys, Search, removed};
use crate::commands::run::{AccuracyReport, RunError, RunProgress, RunSettings, run_models};
use crate::trust::percent;

/// The files of [`prices`]: `accuracies.csv`, and `accuracies` as SVG, PDF and PNG.
pub const FILES: [File; 2] = [File::Table("accuracies"), File::Chart("accuracies")];

/// An accuracy of the list.
struct Price {
    found: AccuracyReport,
    /// Keys for `--set`.
    keys: String,
    /// The time of the run alone with its model, s.
    seconds: f64,
}

/// Finds the settings for some accuracies, the coarsest first: each search begins with the settings of the one before. Where one is stopped, the
/// finer ones are, too. Nothing is kept of the runs.
///
/// # Errors
/// As [`run`](super::run()).
pub fn prices(
    scene: &Scene,
    accuracies: &[f64],
    builder: &Builder,
    mut progress: impl FnMut(RunProgress),
) -> Result<Report, RunError> {
    let folder = temporary()?;
    let settings = RunSettings { check: true, large: true, builder: builder.clone(), ..RunSettings::default() };
    let mut search = Search::new(scene, bodies(scene)?, folder.path(), &settings)?;
    let mut sorted = accuracies.to_vec();
    sorted.sort_by(|a, b| b.total_cmp(a));
    sorted.dedup();
    let mut list: Vec<Price> = Vec::new();
    let mut best: Option<Found> = None;
    let mut stop: Option<Stop> = None;
    let mut timed: Option<(Keys, f64)> = None;
    for asked in sorted {
        let mut found = search.begin(asked, best.take(), stop.is_some(), &mut progress)?;
        if stop.is_none() {
            stop = search.go_on(&mut found, &mut progress)?;
        }
        let keys = search.pinned(&found);
        let seconds = match &timed {
            Some((of, seconds)) if *of == keys => *seconds,
            _ => alone(&found.scene, builder, &mut progress)?,
        };
        let report = search.report(&found, stop.clone());
        list.push(Price { found: report, keys: in_words(&scene.text, &keys), seconds });
        timed = Some((keys, seconds));
        best = Some(found);
    }
    Ok(report(scene, &list))
}

/// The time of the run of a scene alone: without the check, and with nothing that is known of its mesh.
fn alone(scene: &Scene, builder: &Builder, progress: &mut dyn FnMut(RunProgress)) -> Result<f64, RunError> {
    let folder = temporary()?;
    let builder = Builder { trust_geometry: builder.trust_geometry, ..Builder::default() };
    let started = Instant::now();
    let models = builder.models(scene, |p| progress(RunProgress::Build(p)))?;
    let plain = RunSettings { large: true, builder, ..RunSettings::default() };
    run_models(scene, &models, folder.path(), &plain, progress)?;
    Ok(started.elapsed().as_secs_f64())
}

fn temporary() -> Result<TemporaryFolder, RunError> {
    TemporaryFolder::new().map_err(|source| RunError::Folder { folder: std::env::temp_dir(), source })
}

/// Settings as `--set` takes them, and keys that have to go.
fn in_words(scene: &str, keys: &Keys) -> String {
    let word = |(path, value): &(String, Option<toml::Value>)| value.as_ref().map(|value| format!("{path}={value}"));
    let removed = removed(scene, keys).map(|path| format!("without {path}"));
    keys.iter().filter_map(word).chain(removed).collect::<Vec<_>>().join(" ")
}

fn report(scene: &Scene, list: &[Price]) -> Report {
    let mut report = Report::new(&scene.title);
    let found = || list.iter().map(|price| &price.found);
    let words = |error: Option<f64>| error.map_or_else(|| "not known".to_owned(), percent);
    let stopped = |found: &AccuracyReport| found.stopped_by.map(|by| by.name());
    let spent = |found: &AccuracyReport| found.rounds.iter().fold(0.0, |sum, round| sum + round.seconds);
    let table = Table::new("accuracies", "accuracies")
        .titled("accuracies and what they cost; settings are for `--set`")
        .all()
        .column("asked", found().map(|found| found.asked))
        .column("stated", found().map(|found| found.stated))
        .text_only("asked", Form::Plain, found().map(|found| percent(found.asked)))
        .text_only("stated", Form::Plain, found().map(|found| words(found.stated)))
        .shown("stopped_by", "stopped by", Form::Plain, found().map(stopped))
        .shown("seconds", "seconds", Form::Fixed(2), list.iter().map(|price| price.seconds))
        .shown("search_seconds", "search", Form::Fixed(2), found().map(spent))
        .shown("runs", "runs", Form::Plain, found().map(|found| found.rounds.len()))
        .shown("settings", "settings", Form::Plain, list.iter().map(|price| price.keys.clone()));
    report.table(table);
    let left_out = list.first().map(|price| price.found.left_out.as_slice()).unwrap_or_default();
    report.warnings.extend(left_out.iter().map(|body| format!("without {body}")));
    if let Some(found) = found().find(|found| !found.reached) {
        let why = found.why.clone().unwrap_or_default();
        report.warnings.push(format!("{} is not reached: stopped by {why}", percent(found.asked)));
    }
    let point = |price: &Price| Some((price.found.stated.filter(|stated| *stated > 0.0)?, price.seconds));
    let mut points: Vec<(f64, f64)> = list.iter().filter_map(point).collect();
    points.dedup();
    let chart = LineChart {
        title: format!("{}: what accuracy costs", scene.title),
        x_label: "stated error".to_owned(),
        y_label: "time of the run, s".to_owned(),
        x_scale: Scale::Log,
        y_scale: Scale::Log,
        series: vec![Series { label: String::new(), points, stroke: Stroke::Solid }],
        reference: None,
    };
    if !chart.is_empty() {
        report.charts.push(("accuracies", chart.into()));
    }
    report
}
