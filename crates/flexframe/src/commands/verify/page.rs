//! Pages about benchmarks, in Markdown.

use std::path::{Path, PathBuf};

use diagnostic::Failure;
use figures::{LineChart, Scale, Series, Stroke};
use report::quantity;
use whole_file::write_whole;

use super::case::{Case, Quantity};
use super::found::Answer;
use super::outcome::{Outcome, Verdict, labelled};
use crate::files::outputs::{OutputError, Outputs};
use crate::files::write_error::WriteError;

/// The page of all cases.
const ALL: &str = "benchmarks.md";

/// The page of one case.
const ONE: &str = "page.md";

/// The copy of the scene of a case.
fn copy_of(scene: &Path, folder: &Path) -> PathBuf {
    folder.join(scene.file_name().unwrap_or("scene.toml".as_ref()))
}

/// Refuses to replace the pages and scenes of other cases, and those that the cases are made of.
///
/// # Errors
/// [`OutputError`].
pub fn claim(cases: &[Case], folder: &Path, overwrite: bool) -> Result<(), OutputError> {
    let of_case = |case: &Case| {
        let folder = folder.join(&case.name);
        let scene = case.scene().map(|scene| copy_of(&scene, &folder));
        std::iter::once(folder.join(ONE)).chain(scene).collect::<Vec<_>>()
    };
    let files: Vec<PathBuf> = std::iter::once(folder.join(ALL)).chain(cases.iter().flat_map(of_case)).collect();
    Outputs::new(cases.iter().filter_map(Case::scene).collect(), overwrite).claim(&files)
}

/// Writes the page of a case with its figures, and its scene beside it.
pub(super) fn write(case: &Case, outcomes: &[Outcome], answer: Option<&Answer>, folder: &Path) -> Result<(), Failure> {
    let path = folder.join(ONE);
    let mut page = format!(
        "# {}\n\n{}\n\n`flexframe {}`\n\n{}",
        case.title,
        about(case, outcomes),
        case.command,
        table(&[(case, outcomes)])
    );
    for (number, of) in outcomes.chunk_by(same_comparison).enumerate() {
        if let Some(chart) = answer.and_then(|answer| chart(case, of, answer)) {
            let name = format!("figure{}", number + 1);
            chart.save(folder.join(&name))?;
            page += &format!("\n![{}]({name}.svg)\n", of[0].quantity.name);
        }
    }
    write_whole(&path, page).map_err(WriteError::of(&path))?;
    if let Some(scene) = case.scene() {
        let copy = copy_of(&scene, folder);
        let text = std::fs::read(&scene).map_err(WriteError::of(&scene))?;
        write_whole(&copy, text).map_err(WriteError::of(&copy))?;
    }
    Ok(())
}

/// Values of a column at several of its rows: theirs as points, ours as a line.
fn chart(case: &Case, outcomes: &[Outcome], answer: &Answer) -> Option<LineChart> {
    let theirs = outcomes.iter().filter_map(|of| Some((of.quantity.place.row()?, of.quantity.published)));
    let theirs: Vec<(f64, f64)> = theirs.collect();
    let first = &outcomes.first().filter(|_| theirs.len() > 1)?.quantity;
    Some(LineChart {
        title: case.title.clone(),
        x_label: answer.first_heading(first),
        y_label: labelled(&first.name, &first.unit),
        x_scale: Scale::Linear,
        y_scale: Scale::Linear,
        series: vec![
            Series { label: "flexframe".to_owned(), points: answer.curve(case, first), stroke: Stroke::Solid },
            Series { label: "published".to_owned(), points: theirs, stroke: Stroke::Rings },
        ],
        reference: None,
    })
}

/// Writes the page of all cases, by their kinds.
pub(super) fn write_all(cases: &[Case], outcomes: &[Vec<Outcome>], folder: &Path) -> Result<(), Failure> {
    let all = || cases.iter().zip(outcomes.iter().map(Vec::as_slice));
    let mut kinds: Vec<&str> = cases.iter().map(|case| &case.kind[..]).collect();
    kinds.sort_unstable();
    kinds.dedup();
    let count = |verdict: Verdict| outcomes.iter().flatten().filter(|of| of.verdict() == verdict).count();
    let [passed, known, missed] = [Verdict::Pass, Verdict::KnownMiss, Verdict::Miss].map(count);
    let mut page = format!(
        "# Published benchmarks\n\nMade by `just benchmarks`, which runs `flexframe verify`. {} cases: {passed} numbers pass, {known} are known misses, {missed} miss. \
         Tolerances were set before the first run and stayed, but where a case says that its own was set later; where a first mesh missed, a finer one may stand. [How to run them, and add one](../how-to/verify.md).\n",
        cases.len()
    );
    for kind in kinds {
        let of_kind: Vec<(&Case, &[Outcome])> = all().filter(|(case, _)| case.kind == kind).collect();
        let about: String = of_kind
            .iter()
            .map(|(case, of)| format!("\n* **{}**, {}. {}", case.name, case.title, about(case, of)))
            .collect();
        page += &format!("\n## {}\n\n{}{about}\n", capitalised(kind), table(&of_kind));
    }
    let path = folder.join(ALL);
    Ok(write_whole(&path, page).map_err(WriteError::of(&path))?)
}

/// Source, notes and reasons of misses, each ending in a stop.
fn about(case: &Case, outcomes: &[Outcome]) -> String {
    let Case { source, note, .. } = case;
    let mut reasons: Vec<String> = Vec::new();
    for of in outcomes.iter().filter(|of| of.verdict() != Verdict::Pass) {
        let reason = of.failure.as_ref().or(of.quantity.miss.as_ref());
        reasons.extend(reason.map(|reason| format!("Missed: {reason}")).filter(|reason| !reasons.contains(reason)));
    }
    let all = [source, note].into_iter().chain(&reasons).filter(|words| !words.is_empty());
    let sentences: Vec<String> = all.map(|words| format!("{}.", words.trim_end_matches('.'))).collect();
    sentences.join(" ")
}

/// A row for each comparison: all its values, and the largest difference.
fn table(cases: &[(&Case, &[Outcome])]) -> String {
    let mut table =
        "| case | quantity | theirs | ours | off by | tolerance | |\n|---|---|---|---|---:|---:|---|\n".to_owned();
    let all = cases.iter().flat_map(|(case, of)| of.chunk_by(same_comparison).map(move |of| (case, of)));
    for (case, of) in all {
        let Quantity { name, unit, .. } = &of[0].quantity;
        let listed = |value: &dyn Fn(&Outcome) -> String| of.iter().map(value).collect::<Vec<_>>().join(", ");
        let theirs = listed(&|of| of.quantity.published.to_string());
        let ours = listed(&|of| of.ours.map_or("none".to_owned(), quantity));
        let worst = of.iter().max_by(|a, b| size(a).total_cmp(&size(b))).unwrap_or(&of[0]);
        let difference = worst.difference().map(|value| worst.in_words(value)).unwrap_or_default();
        let missed = of.iter().filter(|of| of.verdict() != Verdict::Pass).count();
        let verdict = match (missed, of.len()) {
            (0, _) => "pass".to_owned(),
            (_, 1) => worst.verdict().name().to_owned(),
            (missed, all) => format!("{missed} of {all}: {}", worst.verdict().name()),
        };
        let (label, most) = (labelled(name, unit), worst.in_words(worst.tolerance()));
        table += &format!("| {} | {label} | {theirs} | {ours} | {difference} | {most} | {verdict} |\n", case.name);
    }
    table
}

fn same_comparison(a: &Outcome, b: &Outcome) -> bool {
    a.quantity.line == b.quantity.line
}

/// Size of a difference; no answer is the largest.
fn size(of: &Outcome) -> f64 {
    of.difference().map_or(f64::INFINITY, f64::abs)
}

fn capitalised(word: &str) -> String {
    let (first, rest) = word.split_at(word.chars().next().map_or(0, char::len_utf8));
    format!("{}{rest}", first.to_uppercase())
}
