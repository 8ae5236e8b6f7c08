//! Runs that are killed, stopped, crowded out or refused.
//!
//! `FLEXFRAME_KILLS` sets the number of kills.

use std::path::{Path, PathBuf};
use std::process::{Child, Command, Output, Stdio};
use std::sync::{Mutex, PoisonError};
use std::time::{Duration, Instant};

use flexframe::columns::COLUMNS;
use results::{Results, Scope, unfinished};
use tempfile::TempDir;

/// A scene that takes some seconds, and the folder that it is in.
struct Scene {
    folder: TempDir,
    path: PathBuf,
}

impl Scene {
    fn new(step: &str) -> Self {
        let root = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../..")).canonicalize().unwrap();
        let text = std::fs::read_to_string(root.join("examples/ring.toml")).unwrap();
        let text = text
            .replace("../meshes", root.join("meshes").to_str().unwrap())
            .replace("flexible = 6", "flexible = 2")
            .replace("tolerance = 1e-6", &format!("step = {step}"));
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("long.toml");
        std::fs::write(&path, text).unwrap();
        Self { folder, path }
    }

    /// The results file in a folder of its own.
    fn results(&self, name: &str) -> PathBuf {
        self.folder.path().join(name).join("long.h5")
    }

    fn run(&self, name: &str) -> Command {
        let mut command = flexframe(&["run", "--no-check"]);
        command.arg(&self.path).arg("-o").arg(self.folder.path().join(name));
        command
    }

    fn resume(&self, name: &str) -> Command {
        let mut command = flexframe(&["resume", "--no-check"]);
        command.arg(self.results(name));
        command
    }

    /// Starts a run and comes back when its unfinished file is there.
    fn start(&self, command: Command, name: &str) -> Child {
        let child = spawn(command);
        let started = Instant::now();
        while !unfinished(self.results(name)).exists() {
            assert!(started.elapsed() < Duration::from_secs(60));
            std::thread::sleep(Duration::from_millis(1));
        }
        child
    }
}

fn flexframe(arguments: &[&str]) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_flexframe"));
    command.args(arguments);
    command
}

/// A child inherits the files that its parent has open, with HDF5's locks: none is started while a file is open.
static OPEN: Mutex<()> = Mutex::new(());

fn spawn(mut command: Command) -> Child {
    let _none_open = OPEN.lock().unwrap_or_else(PoisonError::into_inner);
    command.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap()
}

fn open(path: impl AsRef<Path>) -> Results {
    let _open = OPEN.lock().unwrap_or_else(PoisonError::into_inner);
    Results::open(path, &COLUMNS).unwrap()
}

fn succeed(command: Command) {
    let output = spawn(command).wait_with_output().unwrap();
    assert!(output.status.success(), "{}", message(&output));
}

/// Standard error of a command that is to fail with bad input.
fn failure(command: Command) -> String {
    failure_with(3, command)
}

/// Standard error of a command that is to fail because of a file.
fn io_failure(command: Command) -> String {
    failure_with(6, command)
}

fn failure_with(code: i32, command: Command) -> String {
    let output = spawn(command).wait_with_output().unwrap();
    assert_eq!(output.status.code(), Some(code), "{}", message(&output));
    assert!(output.stdout.is_empty());
    message(&output)
}

fn message(output: &Output) -> String {
    String::from_utf8(output.stderr.clone()).unwrap()
}

fn assert_has(message: &str, words: &[&str]) {
    for word in words {
        assert!(message.contains(word), "{word} in: {message}");
    }
}

/// Random numbers in 0 to 1, other ones on each run (SplitMix64).
fn random() -> impl FnMut() -> f64 {
    let mut state = std::time::SystemTime::now().duration_since(std::time::UNIX_EPOCH).unwrap().as_nanos() as u64;
    move || {
        state = state.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let z = (state ^ (state >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) >> 11) as f64 / (1_u64 << 53) as f64
    }
}

/// Conserved: the bytes of the run that nobody killed, and its numbers in every row on the way.
#[test]
fn a_run_that_is_killed_again_and_again_ends_in_the_same_file() {
    let scene = Scene::new("3e-7");
    succeed(scene.run("whole"));
    let expected = std::fs::read(scene.results("whole")).unwrap();
    let whole = open(scene.results("whole"));
    let kills: usize = std::env::var("FLEXFRAME_KILLS").map_or(6, |count| count.parse().unwrap());
    let part = unfinished(scene.results("killed"));
    let mut random = random();
    let (mut done, mut rounds, mut kept) = (0, 0, 0);
    while done < kills {
        // From the start of the process, so that reading, building and taking up are hit too.
        let mut command = if part.exists() { scene.resume("killed") } else { scene.run("killed") };
        command.arg("--overwrite");
        let mut child = spawn(command);
        std::thread::sleep(Duration::from_secs_f64(2.5 * random()));
        child.kill().unwrap();
        let output = child.wait_with_output().unwrap();
        if output.status.success() {
            assert!(std::fs::read(scene.results("killed")).unwrap() == expected);
            rounds += 1;
            continue;
        }
        assert_eq!(output.status.code(), None, "{}", message(&output));
        done += 1;
        if part.exists() {
            let results = open(&part);
            let rows = results.rows();
            assert!(!results.complete);
            // Never less than before, and every row is that of the whole run.
            assert!(rows >= kept || rounds > 0, "{rows} after {kept}");
            kept = rows;
            let is_of_joint = |column: &results::Column<_>| column.scope() == Scope::Joint;
            for column in COLUMNS.iter().filter(|column| column.part.is_none() && !is_of_joint(column)) {
                let place = (column.scope() == Scope::Point).then_some("struck");
                let path = match column.scope() {
                    Scope::System => format!("system/{}", column.path()),
                    _ => column.path_of(place),
                };
                let (found, expected) = (results.table(&path).unwrap(), whole.table(&path).unwrap());
                assert_eq!(found.values(), &expected.values()[..rows * found.width()], "{path}");
            }
        }
        if scene.results("killed").exists() {
            assert!(std::fs::read(scene.results("killed")).unwrap() == expected);
        }
    }
    if part.exists() {
        let mut resume = scene.resume("killed");
        resume.arg("--overwrite");
        succeed(resume);
        assert!(std::fs::read(scene.results("killed")).unwrap() == expected);
        assert!(!part.exists());
    }
    println!("{done} kills, {rounds} runs that came to their end between them");
}

/// Kills a command that writes into a folder at random moments. Each of its files must then be the old one or the new
/// one; returns how many were either.
fn kill_while_it_writes(whole: &Path, killed: &Path, command: impl Fn(&Path) -> Command) -> (usize, usize) {
    let started = Instant::now();
    succeed(command(whole));
    let longest = started.elapsed();
    let names: Vec<_> = std::fs::read_dir(whole).unwrap().map(|entry| entry.unwrap().file_name()).collect();
    assert!(!names.is_empty());
    let kills: usize = std::env::var("FLEXFRAME_KILLS").map_or(6, |count| count.parse().unwrap());
    std::fs::create_dir(killed).unwrap();
    let mut random = random();
    let (mut old, mut new) = (0, 0);
    for _ in 0..kills {
        for name in &names {
            std::fs::write(killed.join(name), "old").unwrap();
        }
        let mut child = spawn(command(killed));
        std::thread::sleep(longest.mul_f64(1.2 * random()));
        child.kill().unwrap();
        child.wait().unwrap();
        for name in &names {
            let now = std::fs::read(killed.join(name)).unwrap();
            let is_new = now == std::fs::read(whole.join(name)).unwrap();
            assert!(is_new || now == b"old", "{}: {} bytes", name.display(), now.len());
            if is_new { new += 1 } else { old += 1 }
        }
    }
    (old, new)
}

#[test]
fn pictures_and_tables_are_the_old_or_the_new_ones_when_a_command_is_killed() {
    let scene = Scene::new("2e-5");
    let folder = |name: &str| scene.folder.path().join(name);
    std::fs::create_dir(folder("gif")).unwrap();
    let kept = kill_while_it_writes(&folder("gif"), &folder("gif-killed"), |folder| {
        let mut animate = flexframe(&["animate", "--overwrite", "--frames", "12", "-o"]);
        animate.arg(folder.join("ring.gif")).arg(&scene.path);
        animate
    });
    println!("animate: {kept:?} old and new files");
    let kept = kill_while_it_writes(&folder("tables"), &folder("tables-killed"), |folder| {
        let mut campbell = flexframe(&["campbell", "--overwrite", "--axis", "z", "--speeds", "0:3000:40", "-o"]);
        campbell.arg(folder).arg(&scene.path);
        campbell
    });
    println!("campbell: {kept:?} old and new files");
}

#[test]
fn a_full_disk_leaves_the_old_picture() {
    let scene = Scene::new("2e-5");
    let path = scene.folder.path().join("ring.gif");
    std::fs::write(&path, "old").unwrap();
    // The shell's limit on the size of a file stands for a full disk.
    let mut limited = Command::new("sh");
    limited.args(["-c", "trap '' XFSZ; ulimit -f 20; exec \"$@\"", "sh", env!("CARGO_BIN_EXE_flexframe"), "animate"]);
    limited.arg(&scene.path).arg("--overwrite").arg("-o").arg(&path);
    assert_has(&io_failure(limited), &["ring.gif", "File too large", "make room"]);
    assert_eq!(std::fs::read(&path).unwrap(), b"old");
    // The scene and the picture, and nothing half-written.
    assert_eq!(std::fs::read_dir(scene.folder.path()).unwrap().count(), 2);
}

#[test]
fn a_full_disk_leaves_the_old_problem_for_a_cluster() {
    let scene = Scene::new("2e-5");
    let folder = scene.folder.path().join("problem");
    let write = || {
        let mut modes = flexframe(&["modes", "--solver", "slepc", "--ranks", "2", "--overwrite", "--write-only"]);
        modes.arg(&folder).arg(&scene.path);
        modes
    };
    succeed(write());
    std::fs::write(folder.join("modes.json"), "the answer").unwrap();
    let files = || {
        let mut files: Vec<_> = std::fs::read_dir(&folder).unwrap().map(|entry| entry.unwrap().path()).collect();
        files.sort();
        files.into_iter().map(|path| (std::fs::read(&path).unwrap(), path)).collect::<Vec<_>>()
    };
    let before = files();
    // The largest file, K.petsc, finds no room; half of it would.
    let blocks = std::fs::metadata(folder.join("K.petsc")).unwrap().len() / 1024;
    let mut limited = Command::new("bash");
    limited.args(["-c", &format!("trap '' XFSZ; ulimit -f {}; exec \"$@\"", blocks / 2), "bash"]);
    let all = write();
    limited.arg(all.get_program()).args(all.get_args());
    io_failure(limited);
    assert!(files() == before);
}

/// Conserved: a run that goes on after a signal ends in the bytes of the one that had none.
#[test]
fn control_c_stops_at_a_row_and_says_how_to_go_on() {
    let scene = Scene::new("2e-6");
    succeed(scene.run("whole"));
    for signal in ["-INT", "-TERM"] {
        let child = scene.start(scene.run(signal), signal);
        std::thread::sleep(Duration::from_millis(100));
        let mut kill = Command::new("kill");
        kill.args([signal, &child.id().to_string()]);
        succeed(kill);
        let output = child.wait_with_output().unwrap();
        assert_eq!(output.status.code(), Some(130), "{}", message(&output));
        assert_has(&message(&output), &["stopped at time", "flexframe resume", "long.part.h5"]);
        assert!(!scene.results(signal).exists());
        assert!(open(unfinished(scene.results(signal))).rows() > 1);
        succeed(scene.resume(signal));
        assert!(std::fs::read(scene.results(signal)).unwrap() == std::fs::read(scene.results("whole")).unwrap());
    }
    // A row that is far away is not waited for.
    let text = std::fs::read_to_string(&scene.path).unwrap();
    assert!(text.contains("interval = 1e-4"));
    std::fs::write(&scene.path, text.replace("interval = 1e-4", "interval = 0.2").replace("2e-6", "1e-9")).unwrap();
    let child = scene.start(scene.run("far"), "far");
    let mut kill = Command::new("kill");
    kill.args(["-INT", &child.id().to_string()]);
    succeed(kill);
    let output = child.wait_with_output().unwrap();
    assert_eq!(output.status.code(), Some(130), "{}", message(&output));
    assert_eq!(open(unfinished(scene.results("far"))).rows(), 1);
    let again = scene.resume("-INT");
    assert_has(&failure(again), &["complete", "nothing to resume"]);
}

/// A terminal, a shell and a job scheduler may send several signals for one request.
#[test]
fn signals_at_once_are_one_request_to_stop() {
    let scene = Scene::new("1e-9");
    let text = std::fs::read_to_string(&scene.path).unwrap();
    // No row comes soon, and many modes make the steps between two looks at the request long.
    let text = text.replace("interval = 1e-4", "interval = 0.2").replace("flexible = 2", "flexible = 60");
    std::fs::write(&scene.path, text).unwrap();
    let child = scene.start(scene.run("burst"), "burst");
    let id = child.id();
    // Until the motion has begun, a signal ends the program at once.
    std::thread::sleep(Duration::from_millis(200));
    let burst = format!("for i in 1 2 3 4 5; do kill -TERM {id}; kill -INT {id}; done 2>/dev/null; true");
    let mut kill = Command::new("bash");
    kill.args(["-c", &burst]);
    succeed(kill);
    let output = child.wait_with_output().unwrap();
    assert_eq!(output.status.code(), Some(130), "{}", message(&output));
    assert_has(&message(&output), &["stopped at time", "flexframe resume", "long.part.h5"]);
}

/// True if a process has something of its own for SIGTERM, or is at its end.
fn listens(process: u32) -> bool {
    const SIGTERM: u32 = 15;
    let status = std::fs::read_to_string(format!("/proc/{process}/status")).unwrap_or_default();
    let of = |key: &str| status.lines().find_map(|line| line.strip_prefix(key)).map(str::trim);
    let is_over = of("State:").is_none_or(|state| state.starts_with('Z'));
    is_over || of("SigCgt:").is_some_and(|mask| u64::from_str_radix(mask, 16).unwrap() & (1 << (SIGTERM - 1)) != 0)
}

/// Reading, assembling, ordering by METIS, factoring, searching: whatever a request to stop meets, it is answered in words.
#[test]
fn a_request_to_stop_is_answered_whenever_it_comes() {
    let scene = Scene::new("1e-9");
    let text = std::fs::read_to_string(&scene.path).unwrap().replace("flexible = 2", "flexible = 60");
    std::fs::write(&scene.path, text).unwrap();
    for delay in (0..300).step_by(20) {
        let mut modes = Command::new(env!("CARGO_BIN_EXE_flexframe"));
        modes.arg("modes").arg(&scene.path);
        let child = spawn(modes);
        // A signal that comes before the program can listen ends it without a word.
        while !listens(child.id()) {
            std::thread::sleep(Duration::from_millis(1));
        }
        std::thread::sleep(Duration::from_millis(delay));
        // It may have come to its end before.
        let _ = Command::new("kill").args(["-TERM", &child.id().to_string()]).output().unwrap();
        let output = child.wait_with_output().unwrap();
        match output.status.code() {
            Some(0) => {}
            Some(130) => assert_has(&message(&output), &["stopped"]),
            other => panic!("{other:?} after {delay} ms: {}", message(&output)),
        }
    }
}

#[test]
fn what_is_there_is_not_lost_unasked() {
    let scene = Scene::new("1e-6");
    let first = scene.start(scene.run("out"), "out");
    for command in [
        scene.run("out"),
        {
            let mut c = scene.run("out");
            c.arg("--overwrite");
            c
        },
        scene.resume("out"),
    ] {
        assert_has(&io_failure(command), &["long.part.h5", "another run is writing this file"]);
    }
    let mut first = first;
    first.kill().unwrap();
    first.wait().unwrap();
    assert_has(&io_failure(scene.run("out")), &["unfinished run", "flexframe resume", "--overwrite"]);
    succeed(scene.resume("out"));
    let whole = std::fs::read(scene.results("out")).unwrap();
    // A complete file is replaced only when asked, and stays until the new one is complete.
    assert_has(&io_failure(scene.run("out")), &["long.h5", "is there already", "--overwrite"]);
    let mut again = scene.run("out");
    again.arg("--overwrite");
    let mut second = scene.start(again, "out");
    assert!(std::fs::read(scene.results("out")).unwrap() == whole);
    second.kill().unwrap();
    second.wait().unwrap();
    assert!(std::fs::read(scene.results("out")).unwrap() == whole);
    // What is none of ours stays.
    std::fs::create_dir(scene.folder.path().join("other")).unwrap();
    std::fs::write(scene.results("other"), "a diary").unwrap();
    assert_has(&io_failure(scene.run("other")), &["long.h5", "not a results file of flexframe", "--overwrite"]);
    assert_eq!(std::fs::read(scene.results("other")).unwrap(), b"a diary");
    assert_has(&io_failure(scene.resume("nowhere")), &["no unfinished run", "long.part.h5"]);
}

#[test]
fn a_run_goes_on_with_the_same_body_or_not_at_all() {
    let scene = Scene::new("3e-7");
    // Another copy of the mesh, which is changed while nobody looks.
    let mesh = scene.folder.path().join("ring.msh");
    let original =
        Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../..")).join("meshes/ring.msh").canonicalize().unwrap();
    std::fs::copy(&original, &mesh).unwrap();
    let text = std::fs::read_to_string(&scene.path).unwrap();
    let half_sine = "{ kind = \"half-sine\", duration = 0.002 }";
    assert!(text.contains(half_sine));
    let text = text.replace(half_sine, "{ kind = \"table\", file = \"pulse.csv\" }");
    std::fs::write(&scene.path, text.replace(original.to_str().unwrap(), "ring.msh")).unwrap();
    let table = scene.folder.path().join("pulse.csv");
    let pulse = "0,0\n0.001,1\n0.002,0\n0.15,0\n0.2,0.1\n";
    std::fs::write(&table, pulse).unwrap();
    // A run that is killed before its first checkpoint begins anew, with what the files say then.
    for milliseconds in std::iter::successors(Some(50), |wait| Some(2 * wait)) {
        let mut child = scene.start(scene.run("out"), "out");
        std::thread::sleep(Duration::from_millis(milliseconds));
        child.kill().unwrap();
        child.wait().unwrap();
        let part = unfinished(scene.results("out"));
        if open(&part).rows() > 0 {
            break;
        }
        std::fs::remove_file(part).unwrap();
    }
    std::fs::copy(original.with_file_name("plate.msh"), &mesh).unwrap();
    let words = failure(scene.resume("out"));
    assert!(words.contains("has changed since the run began") || words.contains("not on the body"), "{words}");
    std::fs::copy(&original, &mesh).unwrap();
    // A table whose change is still to come.
    std::fs::write(&table, pulse.replace("0.2,0.1", "0.2,0.2")).unwrap();
    assert_has(&failure(scene.resume("out")), &["load 1 has changed", "another run"]);
    std::fs::write(&table, pulse).unwrap();
    // The scene counts as it was, wherever the program is started.
    std::fs::write(&scene.path, "nonsense").unwrap();
    let mut resume = scene.resume("out");
    resume.current_dir(std::env::temp_dir());
    succeed(resume);
}

/// The folder of the scene has a name in Latin-1.
#[cfg(unix)]
#[test]
fn a_run_goes_on_in_a_folder_whose_name_is_no_utf8() {
    use std::os::unix::ffi::OsStrExt;
    let mut scene = Scene::new("2e-6");
    let folder = scene.folder.path().join(std::ffi::OsStr::from_bytes(b"caf\xe9 %41"));
    std::fs::create_dir(&folder).unwrap();
    let mesh = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../..")).join("meshes/ring.msh").canonicalize().unwrap();
    std::fs::copy(&mesh, folder.join("ring.msh")).unwrap();
    let text = std::fs::read_to_string(&scene.path).unwrap().replace(mesh.to_str().unwrap(), "ring.msh");
    assert!(text.contains("\"ring.msh\""));
    scene.path = folder.join("long.toml");
    std::fs::write(&scene.path, text).unwrap();
    succeed(scene.run("whole"));
    let mut child = scene.start(scene.run("out"), "out");
    child.kill().unwrap();
    child.wait().unwrap();
    let mut resume = scene.resume("out");
    resume.current_dir(std::env::temp_dir());
    succeed(resume);
    assert!(std::fs::read(scene.results("out")).unwrap() == std::fs::read(scene.results("whole")).unwrap());
}

#[cfg(unix)]
#[test]
fn one_scene_gives_one_file_by_whatever_name_it_is_called() {
    let scene = Scene::new("2e-5");
    let root = scene.folder.path();
    succeed(scene.run("first"));
    let first = std::fs::read(scene.results("first")).unwrap();
    std::os::unix::fs::symlink(root, root.join("link")).unwrap();
    for (folder, path) in [
        ("", "long.toml"),
        ("", "./long.toml"),
        ("first", "../long.toml"),
        ("first", "../first/../long.toml"),
        ("", "link/long.toml"),
    ] {
        let mut run = flexframe(&["run", "--no-check", path, "--overwrite", "-o"]);
        run.arg(root.join("again")).current_dir(root.join(folder));
        succeed(run);
        assert!(std::fs::read(scene.results("again")).unwrap() == first, "{path} in {folder}");
    }
}

#[test]
fn no_room_and_no_folder_are_said_plainly() {
    let scene = Scene::new("2e-5");
    // The shell's limit on the size of a file stands for a full disk; half of what the run needs.
    let mut limited = Command::new("sh");
    limited.args(["-c", "ulimit -f 1000; exec \"$@\"", "sh", env!("CARGO_BIN_EXE_flexframe"), "run"]);
    limited.arg(&scene.path).arg("-o").arg(scene.folder.path().join("full"));
    assert_has(&io_failure(limited), &["long.part.h5", "File too large", "make room"]);
    // Nothing half-written is left.
    assert_eq!(std::fs::read_dir(scene.folder.path().join("full")).unwrap().count(), 0);

    std::fs::write(scene.folder.path().join("file"), "").unwrap();
    assert_has(&io_failure(scene.run("file")), &["cannot make the output folder"]);

    let locked = scene.folder.path().join("locked");
    std::fs::create_dir(&locked).unwrap();
    let mut permissions = std::fs::metadata(&locked).unwrap().permissions();
    permissions.set_readonly(true);
    std::fs::set_permissions(&locked, permissions).unwrap();
    // The superuser writes everywhere.
    if std::fs::write(locked.join("probe"), "").is_err() {
        assert_has(&io_failure(scene.run("locked")), &["long.h5", "Permission denied", "choose a folder"]);
    }
}
