//! Modes and static responses by SLEPc on two ranks, against those of this program, and what a user is told where that does not
//! work. Needs SLEPc and MPI (`./dev test` sees to it).

use std::fs;
use std::os::unix::fs::PermissionsExt;
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};
use std::time::{Duration, Instant};

use faer::Mat;
use flexframe::model::{Builder, Model};
use flexframe::scene::Body;
use serde_json::Value;
use slepc::{Slepc, Stop};
use tempfile::TempDir;

use crate::program::root;

/// A scene of `examples`, as SLEPc is to solve it, and as this program does.
fn both(name: &str, change: impl Fn(&mut Body)) -> [Model; 2] {
    let mut scene = Body::read(root().join("examples").join(name)).unwrap();
    change(&mut scene);
    let ours = Model::build(&scene, |_| ()).unwrap();
    let builder = Builder { solver: Some(Slepc::run(2, Stop::default())), ..Builder::default() };
    [builder.build(&scene, |_| ()).unwrap(), ours]
}

/// Sine of the largest angle between what the columns of two matrices span.
fn sine(a: &Mat<f64>, b: &Mat<f64>) -> f64 {
    let [a, b] = [a, b].map(|columns| columns.qr().compute_thin_Q());
    let rest = &a - &b * (b.transpose() * &a);
    rest.singular_values().unwrap()[0]
}

/// Independent reference: SLEPc.
#[test]
fn two_ranks_find_the_modes_and_static_answers_that_this_program_finds() {
    // Free and struck; held on a patch that turns about an axis; clamped. Bars have pairs of equal frequencies.
    for (name, rigid) in [("ring.toml", 6), ("bar/hinge.toml", 1), ("bar/clamp.toml", 0)] {
        let [found, expected] = both(name, |_| ());
        let [modes, ours] = [&found, &expected].map(|model| &model.meshed.as_ref().unwrap().modes);
        let natural = ours.natural();
        let engine = modes.stats.engine.unwrap();
        assert_eq!((modes.natural(), engine.ranks, modes.stats.factor_entries), (natural, 2, 0), "{name}");
        assert!(engine.counted >= natural + rigid && ours.stats.engine.is_none(), "{name}: {engine:?}");
        // Natural modes, and the static shapes of loads and spin, of which there are as many.
        let (found, expected) = (found.natural_frequencies(), expected.natural_frequencies());
        assert_eq!(found.len(), expected.len(), "{name}");
        for (k, (found, expected)) in found.iter().zip(&expected).enumerate() {
            let off = (found / expected - 1.0).abs();
            // Measured: 8.3e-10 at most, the lowest of the clamped bar: what rounding in K leaves.
            assert!(off < 1e-8, "{name}, mode {k}: {found} {expected} {off:e}");
        }
        let angle = sine(&modes.shapes, &ours.shapes);
        // Measured: 2.8e-10 at most.
        assert!(angle < 1e-7, "{name}: {angle:e}");
    }
}

/// A folder with a scene, for the temporary files of SLEPc, and for programs that stand in its way.
struct Case {
    folder: TempDir,
}

/// Output of the program, and how it ended.
struct Said {
    code: Option<i32>,
    out: String,
    error: String,
}

impl From<Output> for Said {
    fn from(output: Output) -> Self {
        let text = |bytes: Vec<u8>| String::from_utf8(bytes).unwrap();
        Self { code: output.status.code(), out: text(output.stdout), error: text(output.stderr) }
    }
}

impl Case {
    fn new() -> Self {
        let folder = tempfile::tempdir().unwrap();
        fs::create_dir(folder.path().join("temporary")).unwrap();
        let text = fs::read_to_string(root().join("examples/bar/clamp.toml")).unwrap();
        let mesh = root().join("meshes/slender_bar.msh");
        let text = text.replace("../../meshes/slender_bar.msh", mesh.to_str().unwrap());
        fs::write(folder.path().join("bar.toml"), text).unwrap();
        Self { folder }
    }

    fn path(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    fn command(&self, program: impl AsRef<Path>, arguments: &[&str]) -> Command {
        let mut command = Command::new(program.as_ref());
        command.args(arguments).current_dir(self.folder.path()).env("FLEXFRAME_CACHE", "");
        command.env("TMPDIR", self.path("temporary")).stdout(Stdio::piped()).stderr(Stdio::piped());
        command
    }

    fn modes(&self, arguments: &[&str]) -> Command {
        let arguments = [&["modes", "bar.toml"], arguments].concat();
        self.command(env!("CARGO_BIN_EXE_flexframe"), &arguments)
    }

    /// Does Slurm's work with the folder.
    fn do_job(&self) {
        let mut job = self.command("bash", &["job.sh"]);
        job.current_dir(self.path("out put"));
        let said = said(job);
        assert_eq!(said.code, Some(0), "{}", said.error);
    }

    /// A program that the shell runs.
    fn program(&self, name: &str, text: &str) -> PathBuf {
        let path = self.path(name);
        fs::write(&path, format!("#!/bin/sh\n{text}\n")).unwrap();
        fs::set_permissions(&path, fs::Permissions::from_mode(0o755)).unwrap();
        path
    }

    /// Nothing is left of the files of SLEPc and Open MPI.
    fn is_clean(&self) -> bool {
        fs::read_dir(self.path("temporary")).unwrap().next().is_none()
    }
}

const SLEPC: [&str; 4] = ["--solver", "slepc", "--ranks", "2"];

fn said(mut command: Command) -> Said {
    command.output().unwrap().into()
}

#[track_caller]
fn refuses(command: Command, code: i32, words: &[&str]) {
    let said = said(command);
    assert_eq!((said.code, said.out.as_str()), (Some(code), ""), "{}", said.error);
    for words in words {
        assert!(said.error.contains(words), "{words:?} is not in: {}", said.error);
    }
}

fn frequencies(said: &Said) -> Vec<f64> {
    assert_eq!(said.code, Some(0), "{}", said.error);
    let report: Value = serde_json::from_str(&said.out).unwrap();
    let list = report["body"]["natural_frequencies"].as_array().unwrap();
    list.iter().map(|frequency| frequency.as_f64().unwrap()).collect()
}

/// Independent reference: SLEPc.
#[test]
fn a_folder_goes_to_a_cluster_and_its_answers_come_back() {
    let case = Case::new();
    let written = said(case.modes(&["--solver", "slepc", "--ranks", "2", "--write-only", "out put"]));
    assert_eq!(written.code, Some(0), "{}", written.error);
    for name in ["problem.json", "K.petsc", "M.petsc", "rigid.petsc", "driver.py", "job.sh", "README.txt"] {
        assert!(written.out.contains(&format!("wrote    out put/{name}")), "{}", written.out);
        assert!(case.path("out put").join(name).is_file(), "{name}");
    }
    let script = fs::read_to_string(case.path("out put/job.sh")).unwrap();
    assert!(script.contains("#SBATCH --ntasks=2\n"), "{script}");
    let read = |more: &[&str]| case.modes(&[&["--solver", "slepc", "--read", "out put", "--json"], more].concat());
    refuses(read(&[]), 6, &["modes.json is not there: the driver has not come to its end", "sbatch job.sh"]);
    fs::write(case.path("out put/driver.log"), "{\"phase\": \"load\"}\nslurmstepd: it was cancelled\n\n").unwrap();
    refuses(read(&[]), 6, &["driver.log ends with: slurmstepd: it was cancelled"]);

    case.do_job();
    let found = frequencies(&said(read(&[])));
    let expected = frequencies(&said(case.modes(&["--json"])));
    assert_eq!(found.len(), 8);
    for (found, expected) in found.iter().zip(&expected) {
        assert!((found / expected - 1.0).abs() < 1e-8, "{found} {expected}");
    }
    let told = said(case.modes(&["--solver", "slepc", "--read", "out put"])).out;
    assert!(told.contains("SLEPc 3.") && told.contains("none is missing"), "{told}");

    // The cache has them from then on, for every command.
    let cached = |mut command: Command| {
        command.env("FLEXFRAME_CACHE", case.path("cache"));
        frequencies(&said(command))
    };
    assert_eq!(cached(read(&[])), found);
    fs::rename(case.path("out put"), case.path("elsewhere")).unwrap();
    assert_eq!(cached(case.modes(&["--json"])), found);
    assert_eq!(cached(read(&[])), found);
    fs::rename(case.path("elsewhere"), case.path("out put")).unwrap();

    refuses(read(&["-n", "40"]), 3, &["where 40 are asked for", "--write-only"]);
    let density = ["--set", "body.material.density=7.9e-9"];
    refuses(read(&density), 3, &["those of other matrices than the scene's now"]);
    let spoil = |name: &str, spoiled: &dyn Fn(Vec<u8>) -> Vec<u8>, code: i32, words: &[&str]| {
        let path = case.path("out put").join(name);
        let kept = fs::read(&path).unwrap();
        fs::write(&path, spoiled(kept.clone())).unwrap();
        refuses(read(&[]), code, words);
        fs::write(&path, kept).unwrap();
    };
    let cut = |bytes: Vec<u8>| bytes[..bytes.len() / 2].to_vec();
    spoil("modes.petsc", &cut, 3, &["modes.petsc", "it ends in vector", "let the driver write it again"]);
    spoil("modes.json", &cut, 3, &["modes.json", "let the driver write it again"]);
    let other = |bytes: Vec<u8>| bytes.iter().enumerate().map(|(i, b)| if i == 2000 { b ^ 0x40 } else { *b }).collect();
    spoil("modes.petsc", &other, 5, &["the answers of the engine are not those of this body"]);
    let counted = |bytes: Vec<u8>| {
        let mut answer: Value = serde_json::from_slice(&bytes).unwrap();
        answer["counted"] = (answer["counted"].as_u64().unwrap() + 1).into();
        answer.to_string().into_bytes()
    };
    spoil("modes.json", &counted, 5, &["as the count of the pivots has it"]);
}

/// Independent reference: SLEPc.
#[test]
fn static_answers_of_a_run_come_back_from_the_folder_too() {
    let case = Case::new();
    let force = "{kind=\"force\",at=[400.0,0.0,0.0],direction=[0.0,0.0,1.0],amplitude=1.0,history={kind=\"constant\"}}";
    let loads = format!("loads=[{force}]");
    const STIFFENING: &str = "effects.geometric_stiffening=false";
    let run = |more: &[&str]| {
        let arguments =
            [&["run", "bar.toml", "--set", &loads, "--set", STIFFENING, "--overwrite", "--json"], more].concat();
        case.command(env!("CARGO_BIN_EXE_flexframe"), &arguments)
    };
    let expected = frequencies(&said(run(&[])));
    assert!(expected.len() > 8, "there are no static shapes");
    assert_eq!(said(run(&["--solver", "slepc", "--ranks", "1", "--write-only", "out put"])).code, Some(0));
    let mut jobs = 0;
    let done = loop {
        let said = said(run(&["--solver", "slepc", "--read", "out put"]));
        if said.code == Some(0) {
            break said;
        }
        assert!(jobs < 4 && said.code == Some(6) && said.error.contains("sbatch job.sh"), "{}", said.error);
        assert_eq!(jobs > 0, said.error.contains("static responses: the scene asks"), "{}", said.error);
        case.do_job();
        jobs += 1;
    };
    assert!(jobs > 1, "no static responses were asked for");
    let found = frequencies(&done);
    assert_eq!(found.len(), expected.len());
    for (found, expected) in found.iter().zip(&expected) {
        assert!((found / expected - 1.0).abs() < 1e-8, "{found} {expected}");
    }
}

#[test]
fn what_is_missing_is_named_with_the_help() {
    let case = Case::new();
    let install = "apt-get install python3-slepc4py python3-petsc4py openmpi-bin";
    let mut command = case.modes(&SLEPC);
    command.env("FLEXFRAME_MPIRUN", "no-such-mpirun");
    refuses(command, 6, &["`no-such-mpirun` cannot be started", install]);
    let mut command = case.modes(&SLEPC);
    command.env("FLEXFRAME_MPI_PYTHON", "no-such-python");
    refuses(command, 5, &["no-such-python driver.py` failed", install]);
    // A Python that has no SLEPc.
    fs::create_dir(case.path("hidden")).unwrap();
    fs::write(case.path("hidden/slepc4py.py"), "raise ImportError('none here')\n").unwrap();
    let mut command = case.modes(&SLEPC);
    command.env("PYTHONPATH", case.path("hidden"));
    refuses(command, 6, &["has no slepc4py that works (none here)", install]);
    let mut command = case.modes(&["--solver", "slepc", "--ranks", "1000"]);
    command.env("OMPI_MCA_rmaps_base_oversubscribe", "0").env("OMPI_MCA_rmaps_base_mapping_policy", "");
    refuses(command, 5, &["-n 1000", "ask for as many ranks as there are cores at most"]);
    let mut command = case.modes(&SLEPC);
    command.env("PETSC_OPTIONS", "-mat_mumps_icntl_14 -95");
    refuses(command, 5, &["MUMPS cannot factor the matrix: INFOG(1) = -9", "-mat_mumps_icntl_14 200"]);
    for (arguments, words) in [
        (&["--solver", "slepc"][..], &["--solver: found slepc alone", "--ranks N or --read DIR"][..]),
        (&["--solver", "built-in", "--ranks", "2"], &["--ranks: found it beside --solver built-in"]),
        (&["--ranks", "2"], &["--solver"]),
        (&["--solver", "slepc", "--write-only", "x"], &["--ranks"]),
        (&["--solver", "slepc", "--ranks", "2", "--read", "x"], &["--read", "cannot be used with"]),
    ] {
        refuses(case.modes(arguments), 2, words);
    }
    let mut command = case.modes(&["--solver", "slepc", "--read", "nowhere"]);
    command.arg("--json");
    refuses(command, 6, &["nowhere/modes.json"]);
    assert!(case.is_clean());
}

#[test]
fn a_rank_that_dies_is_told_with_the_last_words_of_mpirun() {
    let case = Case::new();
    let python = std::env::var("FLEXFRAME_MPI_PYTHON").unwrap_or_else(|_| "python3".to_owned());
    let text = format!("if [ \"$OMPI_COMM_WORLD_RANK\" = 1 ]; then kill -9 $$; fi\nexec {python} \"$@\"");
    let mut command = case.modes(&SLEPC);
    command.env("FLEXFRAME_MPI_PYTHON", case.program("python", &text));
    refuses(command, 5, &["driver.py` failed (exit status: 137: signal 9 ended a rank)", "for want of memory"]);
    // One that fails in Python leaves none of the others waiting.
    let broken = case.path("broken.py");
    fs::write(
        &broken,
        "import os\nif os.environ['OMPI_COMM_WORLD_RANK'] == '1':\n    raise ValueError('a broken rank')\n",
    )
    .unwrap();
    let text = format!("exec {python} -c \"exec(open('{}').read() + open('$1').read())\" \"$@\"", broken.display());
    let mut command = case.modes(&SLEPC);
    command.env("FLEXFRAME_MPI_PYTHON", case.program("python", &text));
    refuses(command, 5, &["ValueError: a broken rank"]);
    assert!(case.is_clean());
}

#[test]
fn a_signal_ends_the_processes_and_removes_the_files() {
    let case = Case::new();
    // A driver that works for long.
    let pids = case.path("pids");
    let text = format!("echo $$ >> {}\nexec sleep 600", pids.display());
    for signal in ["TERM", "INT"] {
        let _ = fs::remove_file(&pids);
        let mut command = case.modes(&SLEPC);
        let child = command.env("FLEXFRAME_MPI_PYTHON", case.program("python", &text)).spawn().unwrap();
        let ranks = || fs::read_to_string(&pids).unwrap_or_default().lines().map(str::to_owned).collect::<Vec<_>>();
        let started = Instant::now();
        while ranks().len() < 2 {
            assert!(started.elapsed() < Duration::from_secs(60), "the ranks have not started");
            std::thread::sleep(Duration::from_millis(20));
        }
        assert!(!case.is_clean(), "the files are there while it works");
        let kill = Command::new("kill").args([&format!("-{signal}"), &child.id().to_string()]).status().unwrap();
        assert!(kill.success());
        let said: Said = child.wait_with_output().unwrap().into();
        assert_eq!(said.code, Some(130), "{}", said.error);
        assert!(said.error.contains("stopped; the processes of `mpirun -n 2") && said.out.is_empty(), "{}", said.error);
        for rank in ranks() {
            let command = fs::read_to_string(format!("/proc/{rank}/cmdline")).unwrap_or_default();
            assert!(!command.contains("sleep"), "rank {rank} is still there");
        }
        assert!(case.is_clean());
    }
}

/// Modules and options of others, in the folder of the driver and in that of the user.
#[test]
fn files_of_others_in_the_folder_are_not_run() {
    let case = Case::new();
    let mark = case.path("mark");
    fs::create_dir(case.path("out put")).unwrap();
    for folder in [case.path(""), case.path("out put")] {
        for module in ["json", "glob", "re", "time", "traceback", "slepc4py", "numpy"] {
            fs::write(folder.join(format!("{module}.py")), format!("open({mark:?}, 'w')\n")).unwrap();
        }
        fs::write(folder.join(".petscrc"), format!("-info {}\n", mark.display())).unwrap();
    }
    let mut command = case.modes(&[&SLEPC[..], &["--json"]].concat());
    command.env("PYTHONPATH", ":");
    let found = frequencies(&said(command));
    let written = said(case.modes(&["--solver", "slepc", "--ranks", "1", "--write-only", "out put"]));
    assert_eq!(written.code, Some(0), "{}", written.error);
    case.do_job();
    let read = frequencies(&said(case.modes(&["--solver", "slepc", "--read", "out put", "--json"])));
    assert_eq!((found.len(), read.len()), (8, 8));
    let left: Vec<_> = fs::read_dir(case.path("")).unwrap().map(|entry| entry.unwrap().file_name()).collect();
    assert!(left.iter().all(|name| !name.to_string_lossy().starts_with("mark")), "{left:?}");
}

#[test]
fn pipes_and_devices_in_the_folder_are_refused() {
    let case = Case::new();
    let written = said(case.modes(&["--solver", "slepc", "--ranks", "1", "--write-only", "out put"]));
    assert_eq!(written.code, Some(0), "{}", written.error);
    case.do_job();
    let read = || case.modes(&["--solver", "slepc", "--read", "out put"]);
    for name in ["modes.json", "modes.petsc"] {
        let (path, kept) = (case.path("out put").join(name), case.path("kept"));
        fs::rename(&path, &kept).unwrap();
        assert!(Command::new("mkfifo").arg(&path).status().unwrap().success());
        refuses(read(), 6, &[name, "a device or a pipe"]);
        fs::remove_file(&path).unwrap();
        std::os::unix::fs::symlink("/dev/zero", &path).unwrap();
        refuses(read(), 6, &[name, "a device or a pipe"]);
        fs::remove_file(&path).unwrap();
        fs::rename(&kept, &path).unwrap();
    }
    // The log, of which the last line is shown, and an answer that claims more than there is.
    fs::rename(case.path("out put/modes.json"), case.path("kept")).unwrap();
    let _ = fs::remove_file(case.path("out put/driver.log"));
    assert!(Command::new("mkfifo").arg(case.path("out put/driver.log")).status().unwrap().success());
    refuses(read(), 6, &["modes.json is not there"]);
    let mut answer: Value = serde_json::from_slice(&fs::read(case.path("kept")).unwrap()).unwrap();
    answer["eigenvalues"] = vec![1.0; 1_000_000].into();
    fs::write(case.path("out put/modes.json"), answer.to_string()).unwrap();
    refuses(read(), 3, &["modes.petsc", "it ends in vector 10 of 1000000"]);
}

/// Also where the program has no time to end them itself.
#[test]
fn the_ranks_end_with_the_program_whatever_ends_it() {
    let case = Case::new();
    let pids = case.path("pids");
    let text = format!("echo $$ >> {}\nexec sleep 600", pids.display());
    for signals in [&["KILL"][..], &["TERM", "TERM"], &["INT", "KILL"]] {
        let _ = fs::remove_file(&pids);
        let mut command = case.modes(&SLEPC);
        let mut child = command.env("FLEXFRAME_MPI_PYTHON", case.program("python", &text)).spawn().unwrap();
        let ranks = || fs::read_to_string(&pids).unwrap_or_default().lines().map(str::to_owned).collect::<Vec<_>>();
        let is_alive =
            |rank: &String| fs::read_to_string(format!("/proc/{rank}/cmdline")).unwrap_or_default().contains("sleep");
        let started = Instant::now();
        let until = |what: &str, is_so: &dyn Fn() -> bool| {
            while !is_so() {
                assert!(started.elapsed() < Duration::from_secs(120), "{signals:?}: {what}");
                std::thread::sleep(Duration::from_millis(20));
            }
        };
        until("the ranks have not started", &|| ranks().len() == 2);
        for (i, signal) in signals.iter().enumerate() {
            std::thread::sleep(Duration::from_millis(if i > 0 { 600 } else { 0 }));
            let _ = Command::new("kill").args([&format!("-{signal}"), &child.id().to_string()]).output().unwrap();
        }
        child.wait().unwrap();
        until("a rank is still there", &|| !ranks().iter().any(is_alive));
        until("the files are still there", &|| case.is_clean());
    }
}
