//! `flexframe sweep`: one scene with many values of its keys.
//!
//! Scenes with the same body share it: it is assembled and factored once. The models are made one after the other, and their
//! runs go on at once, as many as there are threads.

mod plan;
mod shard;
mod table;
mod text;

use std::collections::BTreeMap;
use std::error::Error;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Mutex, PoisonError, mpsc};
use std::time::{Duration, Instant};

use diagnostic::{Failure, Kind};
use keys::Hash;
use model::{Assembly, AssemblyInput, BuildError, BuildProgress, Builder, Model, Needs, Variants};
use report::{Report, Value};
use results::{ColumnTable, Results};
use scene::{Body, Scene};
use whole_file::{FileLock, TemporaryFolder, cure_of_temporaries};

use crate::commands::run::{self, RunSettings};
use crate::files::outputs::{Outputs, Written};
use crate::files::write_error::WriteError;
use crate::rows::columns::COLUMNS;
use crate::{modes, plausible};
use plan::{Asked, Plan};
use table::{Done, RowState, Table};
use text::{shown, write_csv};

pub use shard::{Shard, slurm_script};

/// The table is written again so often.
const WRITE_INTERVAL: Duration = Duration::from_secs(1);

/// Rows that the summary names of those that failed, and of those with warnings.
const SHOWN: usize = 5;

/// How far a sweep has come.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum SweepProgress {
    /// A body is being made.
    Build(BuildProgress),
    /// Rows that are done or have failed.
    Rows {
        /// Their number.
        done: u64,
        /// Number of all.
        total: u64,
    },
}

/// How a sweep treats files, and how it works.
#[derive(Debug, Clone)]
pub struct SweepSettings {
    /// Throws a table of another sweep away that is in the way, and the rows of this one.
    pub overwrite: bool,
    /// Allows runs whose results are more than 1 GB; they are temporary.
    pub large: bool,
    /// Runs at once.
    pub threads: usize,
    /// The builder of the bodies.
    pub builder: Builder,
    /// Only the rows of this part of the sweep, into a table of its own ([`Shard::table`]).
    pub shard: Option<Shard>,
}

/// The end of a sweep.
#[derive(Debug, Clone)]
pub struct SweepReport {
    /// Title of the scene.
    pub title: String,
    /// The table.
    pub output: PathBuf,
    /// Rows of the table; with a shard, those that are the shard's.
    pub rows: usize,
    /// Rows that are done, those of an earlier run of the sweep among them.
    pub done: usize,
    /// Shards without a table or with rows that were not run, such as "2/4", where shards were merged.
    pub unfinished: Vec<Shard>,
    /// Rows that were done before.
    pub kept: usize,
    /// Rows that were computed before from files that have changed since, and were open again.
    pub stale: usize,
    /// Errors of the rows without results, by their number from 0.
    pub failures: BTreeMap<usize, String>,
    /// Warnings of rows that are done, by their number.
    pub warnings: BTreeMap<usize, Vec<String>>,
    /// How often matrices were assembled and factored.
    pub reductions: usize,
    /// The same numbers as CSV; none of a shard.
    pub csv: Option<PathBuf>,
    /// The rows that were run.
    shown: report::Table,
}

impl SweepReport {
    /// The failure of a sweep none of whose rows is done, though some were run.
    ///
    /// # Errors
    /// [`Failure`].
    pub fn require_a_row(&self) -> Result<(), Failure> {
        match self.failures.iter().next() {
            Some((row, words)) if self.done == 0 => {
                let words = format!("all rows that were run have failed; row {row}: {words}");
                Err(Kind::Run.of(&self.output).says(words))
            }
            _ => Ok(()),
        }
    }

    /// The same as a report.
    pub fn report(&self) -> Report {
        let mut report = Report::new(&self.title);
        let failures =
            self.failures.iter().map(|(row, words)| (*row, words.lines().next().unwrap_or_default().to_owned()));
        let warnings = self.warnings.iter().map(|(row, words)| (*row, words.join("; ")));
        let (done, kept, failed) = (self.done, self.kept, self.failures.len());
        let csv = self.csv.as_ref().map(|csv| csv.display().to_string());
        report.put("output", self.output.display().to_string());
        report.put("rows", self.rows);
        report.put("done", done);
        report.put("unfinished", Value::of(&self.unfinished));
        report.put("kept", kept);
        report.put("stale", self.stale);
        report.put("failures", Value::of(&self.failures));
        report.put("warnings", Value::of(&self.warnings));
        report.put("reductions", self.reductions);
        report.put("csv", csv.as_deref());
        report.line("rows", format!("{done} done ({kept} of them before), {failed} failed"));
        if self.stale > 0 {
            report
                .line("stale", format!("{} rows were computed before from files that have changed since", self.stale));
        }
        add_rows(&mut report, "failed", "failures", failures);
        add_rows(&mut report, "warning", "warnings", warnings);
        for shard in &self.unfinished {
            let again = format!("run it again (--shard {shard}), then merge again");
            report.line("open", format!("shard {shard} has rows that were not run: {again}"));
        }
        if self.reductions > 0 {
            report.line("body", format!("matrices assembled and factored {} time(s)", self.reductions));
        }
        if done > 0 {
            report.table(self.shown.clone());
        }
        report.line("wrote", format!("{} {}", self.output.display(), csv.unwrap_or_default()).trim_end());
        report
    }

    /// The report of a table of the whole sweep, of which `kept` rows were done before.
    fn of(plan: Plan, output: &Path, csv: Option<PathBuf>, table: &Table, kept: usize) -> Self {
        let [done, _] = table.counts();
        Self {
            csv,
            shown: shown(&plan, table),
            title: plan.title,
            output: output.to_owned(),
            rows: table.rows.len(),
            done,
            unfinished: Vec::new(),
            kept,
            stale: table.stale,
            failures: table.failures(),
            warnings: table.warnings(),
            reductions: 0,
        }
    }
}

/// Adds some rows with words to a report.
fn add_rows(report: &mut Report, label: &str, dataset: &str, rows: impl ExactSizeIterator<Item = (usize, String)>) {
    let left = rows.len().saturating_sub(SHOWN);
    rows.take(SHOWN).for_each(|(row, words)| report.line(label, format!("row {row}: {words}")));
    if left > 0 {
        report.line("", format!("and {left} more, see `{dataset}` in the file"));
    }
}

/// Runs a sweep and writes its table to `output`, or that of its shard beside it. Rows that are in it already are kept.
///
/// # Errors
/// [`Failure`]; what fails in one row is in the table.
pub fn sweep(
    path: &Path,
    output: &Path,
    settings: &SweepSettings,
    mut progress: impl FnMut(SweepProgress),
) -> Result<SweepReport, Failure> {
    let temporary = TemporaryFolder::new().map_err(WriteError::of(output))?;
    // Rows find what earlier rows have asked of the mesh.
    let builder = settings.builder.with_cache_or(temporary.path().join("cache"));
    let plan = Plan::read(path)?;
    let of_shard = settings.shard.map(|shard| shard.table(output));
    let output = of_shard.as_deref().unwrap_or(output);
    let csv = settings.shard.is_none().then(|| output.with_extension("csv"));
    let outputs = outputs(&plan, path, &builder, settings.overwrite);
    csv.iter().map(PathBuf::as_path).chain([output]).try_for_each(|file| outputs.spare(file))?;
    Written::SWEEP.check(output)?;
    if let Some(folder) = output.parent().filter(|folder| !folder.as_os_str().is_empty()) {
        std::fs::create_dir_all(folder).map_err(WriteError::of(folder))?;
    }
    let _alone = lock(output)?;
    let is_mine = |row: usize| settings.shard.is_none_or(|shard| shard.has(row));
    let mut table = Table::open(output, &plan, settings.overwrite)?;
    if let Some(csv) = csv.as_deref() {
        claim_csv(csv, &table, settings.overwrite)?;
    }
    let [kept, _] = table.counts();
    let mine = (0..plan.rows.len()).filter(|row| is_mine(*row)).count();
    // Rows that share the assemblies of all bodies.
    let mut groups: Vec<(Vec<AssemblyInput<'_>>, Vec<usize>)> = Vec::new();
    for (i, row) in plan.rows.iter().enumerate() {
        match row {
            _ if table.rows[i] != RowState::Open || !is_mine(i) => {}
            Ok(scene) => {
                let inputs = scene.bodies.iter().map(|body| Assembly::input(body, &builder.needs)).collect();
                match groups.iter_mut().rev().find(|(of_group, _)| *of_group == inputs) {
                    Some((_, rows)) => rows.push(i),
                    None => groups.push((inputs, vec![i])),
                }
            }
            Err(words) => table.rows[i] = RowState::Failed(words.clone()),
        }
    }
    table.write(output, &plan, false)?;
    let mut written = Instant::now();
    for (_, rows) in &groups {
        let Some(Ok(first)) = rows.first().map(|row| &plan.rows[*row]) else { continue };
        let mut all_failed =
            |words: &str| rows.iter().for_each(|row| table.rows[*row] = RowState::Failed(words.to_owned()));
        let assemblies: Result<Vec<_>, _> =
            first.bodies.iter().map(|body| builder.assemble(body, |p| progress(SweepProgress::Build(p)))).collect();
        let assemblies = match assemblies {
            Ok(assemblies) => assemblies,
            Err(error) => {
                all_failed(&cured(&error, error.to_string()));
                continue;
            }
        };
        let variants = assemblies.iter().map(|assembly| assembly.variants().map(Mutex::new));
        let variants = match variants.collect::<Result<Vec<_>, BuildError>>() {
            Ok(variants) => variants,
            Err(error) => {
                all_failed(&cured(&error, error.to_string()));
                continue;
            }
        };
        if plan.has_changed(rows[0]) {
            all_failed(CHANGED);
            continue;
        }
        let of_run = RunSettings { large: settings.large, rows_alone: true, ..RunSettings::default() };
        run_rows(&plan, rows, &variants, temporary.path(), (settings.threads, &of_run), |row, outcome| {
            table.rows[row] = outcome;
            let [done, failed] = table.counts();
            progress(SweepProgress::Rows { done: (done + failed) as u64, total: mine as u64 });
            if written.elapsed() >= WRITE_INTERVAL {
                table.write(output, &plan, false)?;
                written = Instant::now();
            }
            Ok(())
        })?;
        if plan.has_changed(rows[0]) {
            rows.iter().for_each(|row| table.rows[*row] = RowState::Failed(CHANGED.to_owned()));
        }
    }
    finish(&mut table, &plan, output, csv.as_deref())?;
    let report = SweepReport::of(plan, output, csv, &table, kept);
    Ok(SweepReport { rows: mine, reductions: builder.cache.notes().assembled, ..report })
}

/// Merges the tables of all `count` shards of a sweep into the table `output`. Rows that no shard has run stay open: a
/// shard that was cut off is run again and merged again, or the sweep goes on without shards.
///
/// # Errors
/// [`Failure`]: the sweep cannot be read, or a table is of another one.
pub fn merge(path: &Path, output: &Path, count: usize, overwrite: bool) -> Result<SweepReport, Failure> {
    let plan = Plan::read(path)?;
    let shards = Shard::all(count).map(|shard| shard.table(output));
    let csv = output.with_extension("csv");
    let outputs =
        shards.fold(outputs(&plan, path, &Builder::default(), overwrite), |outputs, shard| outputs.and_input(&shard));
    [output, &csv].into_iter().try_for_each(|file| outputs.spare(file))?;
    Written::SWEEP.check(output)?;
    let _alone = lock(output)?;
    // Rows that the table has already stay, and one of another sweep is not lost.
    let mut table = Table::open(output, &plan, overwrite)?;
    claim_csv(&csv, &table, overwrite)?;
    let [kept, _] = table.counts();
    let mut unfinished = Vec::new();
    let mut has_tables = false;
    for shard in Shard::all(count) {
        let found = Table::read(&shard.table(output), &plan)?;
        has_tables |= found.is_some();
        if let Some(Table { stale: rows @ 1.., .. }) = found {
            let words = format!(
                "{rows} of its rows were computed from files that have changed since: a mesh, what it includes, or a table of a load"
            );
            let help = "run this shard again, which computes them anew, and then merge";
            return Err(Kind::Io.of(shard.table(output)).help(help).says(words));
        }
        for (row, state) in table.rows.iter_mut().enumerate().filter(|(row, _)| shard.has(*row)) {
            if *state == RowState::Open
                && let Some(of_shard) = &found
            {
                *state = of_shard.rows[row].clone();
            }
            if *state == RowState::Open && unfinished.last() != Some(&shard) {
                unfinished.push(shard);
            }
        }
    }
    if !has_tables {
        let first = Shard::all(count).next().map(|shard| shard.table(output)).unwrap_or_default();
        let help = format!(
            "run the shards first (--shard 1/{count} and so on), with the same -o, or merge as many as there are"
        );
        let words = format!("there is no such table, nor one of the other shards of {count}");
        return Err(Kind::Io.of(first).help(help).says(words));
    }
    finish(&mut table, &plan, output, Some(&csv))?;
    Ok(SweepReport { unfinished, ..SweepReport::of(plan, output, Some(csv), &table, kept) })
}

/// Refuses to replace a CSV file that was not written with the table.
fn claim_csv(csv: &Path, table: &Table, overwrite: bool) -> Result<(), Failure> {
    let is_ours = || Hash::of_file(csv).is_ok_and(|hash| hash.to_string() == table.csv);
    if overwrite || !csv.exists() || is_ours() {
        return Ok(());
    }
    let help = "move it away, choose another name for the table with -o, or replace both with --overwrite";
    Err(Kind::Io.of(csv).help(help).says("the sweep writes its numbers here, too, and has not written what is there"))
}

/// Writes the table for the last time, and its numbers as CSV.
fn finish(table: &mut Table, plan: &Plan, output: &Path, csv: Option<&Path>) -> Result<(), Failure> {
    if let Some(csv) = csv {
        write_csv(csv, plan, table).map_err(WriteError::of(csv))?;
        table.csv = Hash::of_file(csv).map_err(WriteError::of(csv))?.to_string();
    }
    table.write(output, plan, true)
}

/// Error of a row whose files changed.
const CHANGED: &str = "a file of the body was changed while the sweep ran\n = run it again";

/// Files that a sweep may not write over: all that it reads.
fn outputs(plan: &Plan, sweep: &Path, builder: &Builder, overwrite: bool) -> Outputs {
    // Rows with the same bodies and tables have the same files.
    let named = |scene: &Scene| -> (Vec<PathBuf>, Vec<PathBuf>) {
        (scene.files(), scene.bodies.iter().flat_map(|body| body.source.files()).map(Path::to_owned).collect())
    };
    let systems: BTreeMap<_, &Scene> = plan.rows.iter().flatten().map(|scene| (named(scene), scene)).collect();
    let files = systems.into_values().flat_map(|scene| builder.files(scene));
    Outputs::new(std::iter::once(sweep.to_owned()).chain(files).collect(), overwrite)
}

/// Keeps other sweeps from writing the table.
fn lock(table: &Path) -> Result<FileLock, Failure> {
    let lock = FileLock::of(table).map_err(WriteError::of(table))?;
    lock.ok_or_else(|| {
        let help = "wait for its end, or choose another file with -o";
        Kind::Io.of(table).help(help).says("another sweep is writing this table")
    })
}

/// Runs some rows of one body, and tells what became of each.
fn run_rows(
    plan: &Plan,
    rows: &[usize],
    variants: &[Mutex<Variants<'_>>],
    folder: &Path,
    (threads, settings): (usize, &RunSettings),
    mut tell: impl FnMut(usize, RowState) -> Result<(), Failure>,
) -> Result<(), Failure> {
    let next = AtomicUsize::new(0);
    std::thread::scope(|scope| {
        let (sender, receiver) = mpsc::channel();
        for _ in 0..threads.clamp(1, rows.len()) {
            let (sender, next) = (sender.clone(), &next);
            scope.spawn(move || {
                while let Some(row) = rows.get(next.fetch_add(1, Ordering::Relaxed)) {
                    let outcome = match &plan.rows[*row] {
                        Ok(system) => run_row(system, plan, variants, folder, settings)
                            .map_or_else(RowState::Failed, RowState::Done),
                        Err(words) => RowState::Failed(words.clone()),
                    };
                    // Where nobody listens any longer, the table could not be written.
                    if sender.send((*row, outcome)).is_err() {
                        break;
                    }
                }
            });
        }
        drop(sender);
        receiver.iter().try_for_each(|(row, outcome)| tell(row, outcome))
    })
}

/// The results of a row, or why there are none.
fn run_row(
    scene: &Scene,
    plan: &Plan,
    variants: &[Mutex<Variants<'_>>],
    folder: &Path,
    settings: &RunSettings,
) -> Result<Done, String> {
    let build = |given: &Body, needs: &Needs, variants: &Mutex<Variants<'_>>| -> Result<Model, String> {
        let mut variants = variants.lock().unwrap_or_else(PoisonError::into_inner);
        variants.build(given, needs, |_| ()).map_err(|error| cured(&error, error.to_string()))
    };
    let [asks_run, asks_frequencies] = plan.asks();
    let mut done = Done { results: Vec::new(), warnings: Vec::new() };
    let mut frequencies: BTreeMap<Option<&str>, Vec<f64>> = BTreeMap::new();
    if asks_frequencies {
        for (given, variants) in scene.bodies.iter().zip(variants).filter(|(given, _)| plan.asks_frequencies_of(given))
        {
            let model = build(given, &Needs::modes(), variants)?;
            modes::require_flexible(given, &model).map_err(|error| error.to_string())?;
            frequencies.insert(given.name.as_deref(), model.natural_frequencies());
            done.warnings.extend(plausible::doubts(given, &model));
        }
    }
    let folder = TemporaryFolder::inside(folder).map_err(|error| cured(&error, error.to_string()))?;
    let mut results = None;
    if asks_run {
        let models =
            scene.bodies.iter().zip(variants).map(|(given, variants)| build(given, &Needs::default(), variants));
        let models = models.collect::<Result<Vec<_>, _>>()?;
        let run = run::run_models(scene, &models, folder.path(), settings, |_| ());
        let run = run.map_err(|error| cured(&error, error.without_files()))?;
        done.warnings = run.warnings;
        results = Some(Results::open(run.results, &COLUMNS).map_err(|error| error.to_string())?);
    }
    let value = |asked: &Asked| match (asked, &results) {
        (Asked::Final(column), Some(results)) => column_of(results, column, |table| {
            table.rows().checked_sub(1).and_then(|last| table.row(last)).map(<[f64]>::to_vec)
        }),
        (Asked::Peak(column), Some(results)) => column_of(results, column, |table| {
            let largest = |k: usize| table.column(k)?.max_by(|a, b| a.abs().total_cmp(&b.abs()));
            (0..table.width()).map(largest).collect()
        }),
        (Asked::FrequenciesOf(body), _) => Ok(frequencies.get(&Some(body.as_str())).cloned().unwrap_or_default()),
        _ => Ok(frequencies.get(&None).cloned().unwrap_or_default()),
    };
    done.results = plan.results.values().map(value).collect::<Result<_, String>>()?;
    Ok(done)
}

/// The words of a row's error, with the cure where its temporary folder is full.
fn cured(error: &(dyn Error + 'static), words: String) -> String {
    cure_of_temporaries(error, &words).map_or(words.clone(), |cure| format!("{words}\n = {cure}"))
}

/// Numbers of a column of the results.
fn column_of(
    results: &Results,
    column: &str,
    numbers: impl FnOnce(&ColumnTable) -> Option<Vec<f64>>,
) -> Result<Vec<f64>, String> {
    let table = results.table(column).ok_or_else(|| {
        format!(
            "the results have no column {column}: docs/reference/results.md lists them; those of points are \
             points/NAME/displacement and so on, and those of one of several bodies bodies/NAME/position"
        )
    })?;
    numbers(table).ok_or_else(|| format!("the column {column} has no rows"))
}
