//! Sweeps: one table, one reduction, and every fault in words.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use flexframe::model::Builder;
use flexframe::run::{self, RunSettings};
use flexframe::scene::Body;
use flexframe::sweep::{Shard, SweepReport, SweepSettings, merge, sweep};

use crate::program::command_in;

const SCENE: &str = r#"
title = "Blade"
units = { length = "mm", mass = "Mg", time = "s" }
[body]
mesh = "bar.msh"
material = { young_modulus = 70e3, poisson_ratio = 0.3, density = 2.7e-9 }
[modes]
flexible = 4
[initial]
angular_velocity = [0.0, 0.0, 10.0]
[[loads]]
kind = "force"
at = [200.0, 0.0, 0.0]
direction = [0.0, 1.0, 0.0]
amplitude = 1.0
history = { kind = "half-sine", duration = 1e-3 }
[time]
end = 2e-4
step = 1e-5
[output.points]
tip = [200.0, 0.0, 0.0]
"#;
const RESULTS: &str =
    "[results]\ntip = { final = \"points/tip/displacement\" }\nstrain = { peak = \"energy/strain\" }\n";

/// A folder with the scene, its mesh and a sweep of these parameters.
struct Case {
    folder: tempfile::TempDir,
}

impl Case {
    fn new(parameters: &str) -> Self {
        let folder = tempfile::tempdir().unwrap();
        let data = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../..")).join("crates/model/tests/data/bar.msh");
        fs::copy(data, folder.path().join("bar.msh")).unwrap();
        fs::write(folder.path().join("blade.toml"), SCENE).unwrap();
        let case = Self { folder };
        case.write(parameters);
        case
    }

    fn write(&self, parameters: &str) {
        fs::write(self.path("sweep.toml"), format!("scene = \"blade.toml\"\n{parameters}\n{RESULTS}")).unwrap();
    }

    fn path(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    fn run(&self, overwrite: bool) -> Result<SweepReport, String> {
        self.run_shard(overwrite, None)
    }

    fn run_shard(&self, overwrite: bool, shard: Option<Shard>) -> Result<SweepReport, String> {
        let settings = SweepSettings { overwrite, large: false, threads: 3, builder: Builder::default(), shard };
        sweep(&self.path("sweep.toml"), &self.path("sweep.h5"), &settings, |_| ()).map_err(|error| error.to_string())
    }

    /// A table of numbers as HDF5 reads it.
    fn table(&self, name: &str) -> Vec<f64> {
        hdf5::File::open(self.path("sweep.h5")).unwrap().dataset(name).unwrap().read_raw().unwrap()
    }
}

/// Conserved: the numbers of each row are those of a run of its own, to the last bit.
#[test]
fn a_blade_at_twenty_speeds_costs_one_reduction_and_each_row_is_that_of_its_own_run() {
    let case = Case::new("[parameters]\n\"initial.angular_velocity[2]\" = { from = 0, to = 1900, count = 20 }");
    let report = case.run(false).unwrap();
    assert_eq!((report.rows, report.done, report.kept, report.reductions), (20, 20, 0, 1), "{:?}", report.failures);
    assert!(report.failures.is_empty(), "{:?}", report.failures);
    let speeds: Vec<f64> = (0..20).map(|i| 100.0 * f64::from(i)).collect();
    assert_eq!(case.table("parameters/initial.angular_velocity[2]"), speeds);
    assert_eq!(case.table("status"), vec![1.0; 20]);
    let tip = case.table("results/tip");
    for row in [0, 7, 19] {
        let text = SCENE.replace("10.0]", &format!("{:?}]", speeds[row]));
        let body = Body::parse(&text, case.path("blade.toml")).unwrap();
        run::run(&body.into(), &case.path("alone"), &RunSettings { overwrite: true, ..RunSettings::default() }, |_| ())
            .unwrap();
        let file = hdf5::File::open(case.path("alone/blade.h5")).unwrap();
        let alone: Vec<f64> = file.dataset("points/displacement").unwrap().read_raw().unwrap();
        assert_eq!(tip[3 * row..3 * row + 3], alone[alone.len() - 3..]);
        let strain: Vec<f64> = file.dataset("energy/strain").unwrap().read_raw().unwrap();
        assert_eq!(case.table("results/strain")[row], strain.into_iter().fold(0.0, f64::max));
    }
}

/// Closed form: strain energy goes with the square of the load.
#[test]
fn a_grid_has_every_pair_and_a_zip_has_pairs() {
    let lists = "[parameters]\n\"loads[0].amplitude\" = [1.0, 2, 3.0]\n\"time.step\" = [1e-5, 2e-5]";
    let case = Case::new(lists);
    let report = case.run(false).unwrap();
    assert_eq!((report.rows, report.done, report.reductions), (6, 6, 1));
    assert_eq!(case.table("parameters/loads[0].amplitude"), [1.0, 1.0, 2.0, 2.0, 3.0, 3.0]);
    assert_eq!(case.table("parameters/time.step"), [1e-5, 2e-5, 1e-5, 2e-5, 1e-5, 2e-5]);
    // The answer is linear in the load but for what the slow spin strains.
    let strain = case.table("results/strain");
    assert!((strain[2] / strain[0] - 4.0).abs() < 0.1 && (strain[5] / strain[1] - 9.0).abs() < 0.2, "{strain:?}");
    case.write(&format!("combine = \"zip\"\n{lists}"));
    let error = case.run(true).unwrap_err();
    assert!(
        error.contains("parameters.\"time.step\"") && error.contains("found 2 values, expected 3 values"),
        "{error}"
    );
    case.write("combine = \"zip\"\n[parameters]\n\"loads[0].amplitude\" = [1.0, 2.0]\n\"title\" = [\"a\", \"b\"]");
    assert_eq!(case.run(true).unwrap().rows, 2);
    assert_eq!(case.table("parameters/loads[0].amplitude"), [1.0, 2.0]);
}

#[test]
fn rows_that_fail_are_marked_with_their_words_and_rows_that_are_done_are_kept() {
    let case = Case::new("[parameters]\n\"time.step\" = [1e-5, 1.0, 2e-5]");
    let report = case.run(false).unwrap();
    assert_eq!((report.done, report.kept, report.failures.len()), (2, 0, 1));
    assert!(report.failures[&1].contains("time.step"), "{:?}", report.failures);
    let tip = case.table("results/tip");
    assert!(tip[3..6].iter().all(|x| x.is_nan()) && tip[..3].iter().chain(&tip[6..]).all(|x| x.is_finite()));
    // Done again, nothing is left to do but the row that failed.
    let report = case.run(false).unwrap();
    assert_eq!((report.done, report.kept, report.failures.len(), report.reductions), (2, 2, 1, 0));
    assert_eq!(case.table("results/tip")[6..], tip[6..]);
    // Another sweep has another table.
    case.write("[parameters]\n\"time.step\" = [1e-5, 2e-5]");
    let error = case.run(false).unwrap_err();
    assert!(error.contains("it is of another sweep or scene") && error.contains("--overwrite"), "{error}");
    assert_eq!(case.run(true).unwrap().done, 2);
    fs::write(case.path("sweep.h5"), "mine").unwrap();
    let error = case.run(false).unwrap_err();
    assert!(error.contains("it is no table of a sweep"), "{error}");
    assert_eq!(fs::read(case.path("sweep.h5")).unwrap(), b"mine");
}

#[test]
fn warnings_of_rows_are_kept_and_failures_name_no_file_that_is_gone() {
    let parameters = "combine = \"zip\"\n[parameters]\n\"loads[0].amplitude\" = [1.0, 8e5, 8e5]\n\
                      \"effects.refuse\" = [false, false, true]\n\
                      \"effects.large_deflection\" = [false, false, false]\n\"time.step\" = [1e-6, 1e-6, 1e-6]";
    let case = Case::new(parameters);
    let report = case.run(false).unwrap();
    assert_eq!((report.done, report.failures.len()), (2, 1), "{:?}", report.failures);
    let failure = &report.failures[&2];
    assert!(failure.contains("at time 0.0") && !failure.contains(".h5"), "{failure}");
    assert_eq!(report.warnings.keys().collect::<Vec<_>>(), [&1], "{:?}", report.warnings);
    let text = report.report().to_string();
    assert!(text.contains(&format!("warning  row 1: {}", report.warnings[&1][0])), "{text}");
    // They are in the table.
    assert_eq!(case.run(false).unwrap().warnings, report.warnings);
}

/// Conserved: the numbers of the whole sweep to the last bit.
#[test]
fn shards_of_a_sweep_merge_into_the_table_of_the_whole() {
    let case = Case::new("[parameters]\n\"time.step\" = [1e-5, 2e-5, 1.0, 4e-5, 5e-5]");
    let whole = case.run(false).unwrap();
    let table = case.table("results/tip");
    let csv = fs::read(case.path("sweep.csv")).unwrap();
    for name in ["sweep.h5", "sweep.csv"] {
        fs::remove_file(case.path(name)).unwrap();
    }

    let shard = |text: &str| Some(text.parse::<Shard>().unwrap());
    let first = case.run_shard(false, shard("1/3")).unwrap();
    assert_eq!((first.rows, first.done, first.failures.len()), (2, 2, 0));
    assert_eq!(first.output, case.path("sweep.1-of-3.h5"));
    assert_eq!(case.run_shard(false, shard("3/3")).unwrap().failures.len(), 1);
    let merged = |count| merge(&case.path("sweep.toml"), &case.path("sweep.h5"), count, false);
    let error = merged(2).unwrap_err().to_string();
    assert!(error.contains("sweep.1-of-2.h5: there is no such table"), "{error}");
    // The second has died before it wrote a table.
    let report = merged(3).unwrap();
    assert_eq!((report.done, report.unfinished), (2, vec!["2/3".parse().unwrap()]));
    assert_eq!(case.table("status"), [1.0, 0.0, 2.0, 1.0, 0.0]);
    // It is done again alone. What the others have done is not.
    assert_eq!(case.run_shard(false, shard("2/3")).unwrap().done, 2);
    let report = merged(3).unwrap();
    assert_eq!((report.done, report.kept, report.unfinished), (4, 2, Vec::new()));
    assert_eq!(report.failures, whole.failures);
    let bits = |values: &[f64]| values.iter().map(|value| value.to_bits()).collect::<Vec<_>>();
    assert_eq!(bits(&case.table("results/tip")), bits(&table));
    assert_eq!(fs::read(case.path("sweep.csv")).unwrap(), csv);
    assert!(!case.path("sweep.1-of-3.csv").exists());
    assert_eq!(case.run_shard(false, shard("1/3")).unwrap().kept, 2);
    // Rows of another mesh are not mixed with rows of this one.
    let mesh = case.path("bar.msh");
    let with_comment = fs::read_to_string(&mesh).unwrap() + "$Comments\nanother\n$EndComments\n";
    let original = fs::read(&mesh).unwrap();
    fs::write(&mesh, with_comment).unwrap();
    let before = fs::read(case.path("sweep.h5")).unwrap();
    let error = merged(3).unwrap_err().to_string();
    assert!(
        error.contains("sweep.1-of-3.h5: 2 of its rows were computed from files that have changed since"),
        "{error}"
    );
    assert!(fs::read(case.path("sweep.h5")).unwrap() == before);
    let again = case.run_shard(false, shard("1/3")).unwrap();
    assert_eq!((again.done, again.kept, again.stale), (2, 0, 2));
    let error = merged(3).unwrap_err().to_string();
    assert!(error.contains("sweep.2-of-3.h5"), "{error}");
    fs::write(&mesh, original).unwrap();
    // Shards of another sweep are not taken.
    case.write("[parameters]\n\"time.step\" = [1e-5]");
    for name in ["sweep.h5", "sweep.csv"] {
        fs::remove_file(case.path(name)).unwrap();
    }
    let error = merged(3).unwrap_err().to_string();
    assert!(error.contains("sweep.1-of-3.h5") && error.contains("it is of another sweep"), "{error}");
    assert!(!case.path("sweep.h5").exists());
}

#[test]
fn a_table_is_written_as_csv_and_shown() {
    let case = Case::new("[parameters]\n\"loads[0].amplitude\" = [1.0, 2.5, \"much\"]\n\"title\" = [\"a, b\"]");
    let report = case.run(false).unwrap();
    assert_eq!((report.done, report.failures.len()), (2, 1), "{:?}", report.failures);
    let csv = fs::read_to_string(case.path("sweep.csv")).unwrap();
    let lines: Vec<&str> = csv.lines().collect();
    assert_eq!(lines[0], "row,status,loads[0].amplitude,title,strain,tip x,tip y,tip z,failure");
    let (strain, tip) = (case.table("results/strain"), case.table("results/tip"));
    for row in 0..2 {
        let numbers: Vec<String> =
            strain[row..=row].iter().chain(&tip[3 * row..3 * row + 3]).map(|x| format!("{x:?}")).collect();
        let expected = format!("{row},done,{},\"a, b\",{},", ["1.0", "2.5"][row], numbers.join(","));
        assert_eq!(lines[1 + row], expected);
    }
    assert!(
        lines[3].starts_with("2,failed,much,\"a, b\",,,,,\"") && lines[3].contains("`loads[0].amplitude`"),
        "{csv}"
    );
    assert_eq!(lines.len(), 4);
    let text = report.report().to_string();
    let shown: Vec<Vec<&str>> = text.lines().map(|line| line.split_whitespace().collect()).collect();
    assert!(
        shown.iter().any(
            |line| line[..] == ["row", "loads[0].amplitude", "title", "strain", "tip", "x", "tip", "y", "tip", "z"]
        ),
        "{text}"
    );
    assert!(shown.iter().any(|line| line.starts_with(&["1", "2.5"]) && line.len() == 8), "{text}");
    assert!(shown.iter().any(|line| line.starts_with(&["2", "\"much\""]) && line.ends_with(&["failed"; 4])), "{text}");
    // It goes on with the table, and nothing else is replaced.
    assert_eq!(case.run(false).unwrap().kept, 2);
    assert_eq!(fs::read_to_string(case.path("sweep.csv")).unwrap(), csv);
    fs::write(case.path("sweep.csv"), "mine").unwrap();
    let error = case.run(false).unwrap_err();
    assert!(error.contains("sweep.csv: the sweep writes its numbers here, too"), "{error}");
    assert_eq!(fs::read(case.path("sweep.csv")).unwrap(), b"mine");
    case.run(true).unwrap();
    assert_eq!(fs::read_to_string(case.path("sweep.csv")).unwrap(), csv);
}

/// Closed form: E four times as large doubles every frequency. A run would not end.
#[test]
fn frequencies_are_swept_without_a_run() {
    let parameters = "[parameters]\n\"body.material.young_modulus\" = [70e3, 280e3]\n\"time.end\" = [1e3]";
    let case = Case::new(parameters);
    fs::write(
        case.path("sweep.toml"),
        format!("scene = \"blade.toml\"\n{parameters}\n[results]\nf = \"frequencies\"\n"),
    )
    .unwrap();
    let report = case.run(false).unwrap();
    assert_eq!((report.done, report.reductions), (2, 2), "{:?}", report.failures);
    let found = case.table("results/f");
    let body = Body::parse(SCENE, case.path("blade.toml")).unwrap();
    let (_, modes) = flexframe::modes::modes(&body, &Builder::default(), None, |_| ()).unwrap();
    assert_eq!(
        found[..4].to_vec(),
        (0..4).map(|k| modes.number(&format!("body.natural_frequencies[{k}]")).unwrap()).collect::<Vec<_>>()
    );
    for k in 0..4 {
        assert!((found[4 + k] / found[k] - 2.0).abs() < 1e-6, "{found:?}");
    }
    let csv = fs::read_to_string(case.path("sweep.csv")).unwrap();
    assert!(csv.starts_with("row,status,body.material.young_modulus,time.end,f 1,f 2,f 3,f 4,failure\n"), "{csv}");
    // With a result of a run beside them, they are the same.
    let both = "scene = \"blade.toml\"\n[parameters]\n\"time.step\" = [1e-5, 2e-5]\n[results]\nf = \"frequencies\"\n\
                strain = { peak = \"energy/strain\" }\n";
    fs::write(case.path("sweep.toml"), both).unwrap();
    let report = case.run(true).unwrap();
    assert_eq!((report.done, report.reductions), (2, 1), "{:?}", report.failures);
    assert_eq!(case.table("results/f"), [&found[..4], &found[..4]].concat());
    assert!(case.table("results/strain").iter().all(|strain| *strain > 0.0));
    // A body without modes has none.
    let none = both.replace("\"time.step\" = [1e-5, 2e-5]", "\"modes.flexible\" = [0, 4]");
    fs::write(case.path("sweep.toml"), none).unwrap();
    let report = case.run(true).unwrap();
    assert!(report.failures[&0].contains("which has no natural frequencies"), "{:?}", report.failures);
    assert_eq!(report.done, 1);
}

#[test]
fn the_script_for_slurm_runs_a_shard_for_each_number() {
    let case = Case::new("[parameters]\n\"time.step\" = [1e-5, 2e-5]");
    let program = Path::new(env!("CARGO_BIN_EXE_flexframe"));
    let paths = format!("{}:{}", program.parent().unwrap().display(), std::env::var("PATH").unwrap());
    let run = |command: &mut Command| {
        let output = command.env("PATH", &paths).current_dir(case.folder.path()).output().unwrap();
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
        output.stdout
    };
    let script = run(Command::new(program).args(["sweep", "sweep.toml", "-o", "it's.h5", "--slurm", "2"]));
    fs::write(case.path("job.sh"), script).unwrap();
    for number in ["1", "2"] {
        run(Command::new("bash").args(["job.sh"]).env("SLURM_ARRAY_TASK_ID", number));
    }
    let merged = run(Command::new(program).args(["sweep", "sweep.toml", "-o", "it's.h5", "--merge", "2", "--json"]));
    let report: serde_json::Value = serde_json::from_slice(&merged).unwrap();
    assert_eq!((&report["done"], &report["unfinished"]), (&2.into(), &serde_json::json!([])));
}

/// The script names the table in a comment, too.
#[test]
fn a_line_in_a_name_is_no_line_of_the_script() {
    let case = Case::new("[parameters]\n\"time.step\" = [1e-5, 2e-5]");
    let program = Path::new(env!("CARGO_BIN_EXE_flexframe"));
    let paths = format!("{}:{}", program.parent().unwrap().display(), std::env::var("PATH").unwrap());
    let run = |command: &mut Command| {
        let output = command.env("PATH", &paths).current_dir(case.folder.path()).output().unwrap();
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
        output.stdout
    };
    let name = "a\ntouch mark\n# it's.h5";
    let script = run(Command::new(program).args(["sweep", "sweep.toml", "-o", name, "--slurm", "2"]));
    fs::write(case.path("job.sh"), script).unwrap();
    for number in ["1", "2"] {
        run(Command::new("bash").args(["job.sh"]).env("SLURM_ARRAY_TASK_ID", number));
    }
    assert!(!case.path("mark").exists());
    run(Command::new(program).args(["sweep", "sweep.toml", "-o", name, "--merge", "2"]));
    assert!(case.path(name).is_file());
}

#[test]
fn what_a_sweep_cannot_be_is_refused() {
    let case = Case::new("");
    let refused = |parameters: &str, words: &[&str]| {
        case.write(parameters);
        let error = case.run(false).unwrap_err();
        assert!(words.iter().all(|word| error.contains(word)), "{error}");
        assert!(!case.path("sweep.h5").exists());
    };
    refused(
        "[parameters]\n\"time.stpe\" = [1e-5, 2e-5]",
        &["unknown key `stpe`", "did you mean `step`", "time.stpe = 0.00001"],
    );
    refused("[parameters]\n\"loads[3].amplitude\" = [1.0]", &["entry 3 of `loads`", "one from 0 to 0"]);
    refused("[parameters]\n\"effects[0]\" = [1.0]", &["`effects`, which is not there", "a list"]);
    refused("[parameters]\n\"time.step.x\" = [1.0]", &["`x` in a value that is a number"]);
    refused("[parameters]\n\"time.step\" = []", &["parameters.\"time.step\"", "a list such as"]);
    refused("[parameters]\ntime.step = [1e-5]", &["a key with dots is written in quotes"]);
    refused("[parameters]\n\"time.step\" = { from = 1, to = 2, count = 0 }", &["count = 0", "a range such as"]);
    refused("[parameters]", &["`parameters`: found nothing"]);
    refused("colour = 1\n[parameters]\n\"time.step\" = [1e-5]", &["unknown field `colour`"]);
    fs::write(case.path("sweep.toml"), "scene = \"nowhere.toml\"\n[parameters]\n\"time.step\" = [1e-5]\n[results]\n")
        .unwrap();
    assert!(case.run(false).unwrap_err().contains("nowhere.toml"));
    fs::write(
        case.path("sweep.toml"),
        "scene = \"blade.toml\"\n[parameters]\n\"time.step\" = [1e-5]\n[results]\n\"x\\n=1+1\" = \"frequencies\"\n",
    )
    .unwrap();
    assert!(case.run(false).unwrap_err().contains(r#"found "x\n=1+1", expected names of results on one line"#));
    // A column that is not there fails each row, in words.
    fs::write(
        case.path("sweep.toml"),
        "scene = \"blade.toml\"\n[parameters]\n\"time.step\" = [1e-5]\n[results]\na = { final = \"points/nose/displacement\" }\n",
    )
    .unwrap();
    let report = case.run(false).unwrap();
    assert!(report.failures[&0].contains("the results have no column points/nose/displacement"), "{report:?}");
}

/// Closed form: the answer is three times as large under three times the load. A load table that is read for each row
/// changes between two runs of the sweep.
#[test]
fn rows_of_an_old_table_are_computed_again() {
    let case = Case::new("[parameters]\n\"loads[0].history.file\" = [\"a.csv\", \"b.csv\"]");
    let scene = SCENE.replace("kind = \"half-sine\", duration = 1e-3", "kind = \"table\", file = \"a.csv\"");
    fs::write(case.path("blade.toml"), scene).unwrap();
    let write = |name: &str, factor: f64| fs::write(case.path(name), format!("0, 0\n1e-4, {factor}\n")).unwrap();
    write("a.csv", 1.0);
    write("b.csv", 1.0);
    assert_eq!(case.run(false).unwrap().done, 2);
    let before = case.table("results/tip");
    write("b.csv", 3.0);
    let report = case.run(false).unwrap();
    assert_eq!((report.done, report.kept, report.stale), (2, 1, 1));
    let now = case.table("results/tip");
    assert_eq!(now[..3], before[..3]);
    assert!((now[5] / before[5] - 3.0).abs() < 0.1, "{before:?} {now:?}");
    assert_eq!(case.run(false).unwrap().kept, 2);
}

#[test]
fn two_sweeps_do_not_write_one_table() {
    let case = Case::new("[parameters]\n\"time.step\" = [1e-5, 2e-5]");
    let lock = whole_file::FileLock::of(&case.path("sweep.h5")).unwrap().unwrap();
    let error = case.run(false).unwrap_err();
    assert!(error.contains("sweep.h5: another sweep is writing this table"), "{error}");
    let error = merge(&case.path("sweep.toml"), &case.path("sweep.h5"), 2, true).unwrap_err().to_string();
    assert!(error.contains("another sweep is writing this table"), "{error}");
    assert!(!case.path("sweep.h5").exists());
    // A shard has a table of its own.
    assert_eq!(case.run_shard(false, Some("1/2".parse().unwrap())).unwrap().done, 1);
    drop(lock);
    assert_eq!(case.run(false).unwrap().done, 2);
    let left: Vec<_> = fs::read_dir(case.folder.path()).unwrap().map(|entry| entry.unwrap().file_name()).collect();
    assert!(left.iter().all(|name| !name.to_string_lossy().contains("lock")), "{left:?}");
}

#[test]
fn a_sweep_none_of_whose_rows_is_done_has_failed() {
    let case = Case::new("[parameters]\n\"loads[0].amplitude\" = [1.0, 2.0]");
    let sweep = fs::read_to_string(case.path("sweep.toml")).unwrap().replace("tip/displacement", "nose/displacement");
    let run = |text: &str| {
        fs::write(case.path("sweep.toml"), text).unwrap();
        command_in(case.folder.path(), &["sweep", "sweep.toml", "--overwrite"]).output().unwrap()
    };
    let output = run(&sweep);
    let text = String::from_utf8(output.stderr).unwrap();
    assert_eq!(output.status.code(), Some(5), "{text}");
    assert!(text.contains("all rows that were run have failed; row 0: the results have no column"), "{text}");
    assert!(case.path("out/sweep.h5").is_file());
    let output = run(
        "scene = \"blade.toml\"\n[parameters]\n\"time.step\" = [1e-5, 1.0]\n[results]\na = { final = \"position\" }\n",
    );
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
}
