//! Pages about benchmarks, in Markdown.

use std::path::Path;

use diagnostic::Failure;
use report::quantity;
use whole_file::write_whole;

use super::case::Case;
use super::outcome::{Outcome, Verdict};
use crate::files::write_error::WriteError;

/// The page of all cases.
const ALL: &str = "benchmarks.md";

/// Writes the page of a case, and its scene beside it.
pub(super) fn write(case: &Case, outcomes: &[Outcome], folder: &Path) -> Result<(), Failure> {
    std::fs::create_dir_all(folder).map_err(WriteError::of(folder))?;
    let path = folder.join("page.md");
    let page = format!("# {}\n\n{}\n{}", case.title, about(case, outcomes), table(&[(case, outcomes)]));
    write_whole(&path, page).map_err(WriteError::of(&path))?;
    if let Some(scene) = case.scene() {
        let copy = folder.join(scene.file_name().unwrap_or("scene.toml".as_ref()));
        let text = std::fs::read(&scene).map_err(WriteError::of(&scene))?;
        write_whole(&copy, text).map_err(WriteError::of(&copy))?;
    }
    Ok(())
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
         Tolerances were set before the first run and stayed; where a first mesh missed, a finer one may stand. [How to run them, and add one](../how-to/verify.md).\n",
        cases.len()
    );
    for kind in kinds {
        let of_kind: Vec<(&Case, &[Outcome])> = all().filter(|(case, _)| case.kind == kind).collect();
        let about: String = of_kind
            .iter()
            .map(|(case, of)| format!("\n* **{}**, {}. {}", case.name, case.title, about(case, of).trim_end()))
            .collect();
        page += &format!("\n## {}\n\n{}{about}\n", capitalised(kind), table(&of_kind));
    }
    let path = folder.join(ALL);
    Ok(write_whole(&path, page).map_err(WriteError::of(&path))?)
}

/// Source, notes and reasons of misses, each ending in a stop.
fn about(case: &Case, outcomes: &[Outcome]) -> String {
    let Case { source, note, command, .. } = case;
    let mut reasons: Vec<String> = Vec::new();
    for of in outcomes.iter().filter(|of| of.verdict() != Verdict::Pass) {
        let reason = of.failure.as_ref().or(of.quantity.miss.as_ref());
        reasons.extend(reason.map(|reason| format!("Missed: {reason}")).filter(|reason| !reasons.contains(reason)));
    }
    let all = [source, note].into_iter().chain(&reasons).filter(|words| !words.is_empty());
    let sentences: Vec<String> = all.map(|words| format!("{}.", words.trim_end_matches('.'))).collect();
    format!("{} `{command}`\n", sentences.join(" "))
}

fn table(cases: &[(&Case, &[Outcome])]) -> String {
    let mut table =
        "| case | quantity | theirs | ours | difference | tolerance | |\n|---|---|---:|---:|---:|---:|---|\n"
            .to_owned();
    for (case, of) in cases.iter().flat_map(|(case, of)| of.iter().map(move |of| (case, of))) {
        let (Some(ours), Some(difference)) = (of.ours, of.difference()) else {
            table += &format!("| {} | {} | {} | | | | no answer |\n", case.name, of.labelled(), of.quantity.published);
            continue;
        };
        let [difference, most] = [difference, of.tolerance()].map(|value| of.in_words(value));
        let (label, theirs, ours, verdict) =
            (of.labelled(), of.quantity.published, quantity(ours), of.verdict().name());
        table += &format!("| {} | {label} | {theirs} | {ours} | {difference} | {most} | {verdict} |\n", case.name);
    }
    table
}

fn capitalised(word: &str) -> String {
    let (first, rest) = word.split_at(word.chars().next().map_or(0, char::len_utf8));
    format!("{}{rest}", first.to_uppercase())
}
