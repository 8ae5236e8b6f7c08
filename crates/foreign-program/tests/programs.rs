//! Programs that do not end, say too much, write too much, or leave others behind; and what becomes of them when this program
//! ends.

use std::cell::Cell;
use std::ffi::OsStr;
use std::fs;
use std::path::Path;
use std::process::{Command, ExitStatus};
use std::time::{Duration, Instant};

use foreign_program::{ForeignProgram, Limits, ProgramError, Stream, open_ordinary, read_at_most};

/// Runs a shell script.
fn shell(folder: &Path, script: &str, limits: Limits) -> (Result<ExitStatus, ProgramError>, Vec<(Stream, String)>) {
    let mut said = Vec::new();
    let program = ForeignProgram::new(OsStr::new("sh"), folder).args(["-c", script]);
    let ended = program.run(limits, || false, |stream, line| said.push((stream, line)));
    (ended, said)
}

const UNLIMITED: Limits = Limits { time: None, bytes: None, memory: None };

/// True if a process is there, and is no zombie.
fn is_alive(pid: &str) -> bool {
    let status = fs::read_to_string(format!("/proc/{pid}/stat")).unwrap_or_default();
    status.rsplit(") ").next().is_some_and(|rest| !rest.is_empty() && !rest.starts_with('Z'))
}

/// Waits until something is so.
#[track_caller]
fn until(what: &str, is_so: impl Fn() -> bool) {
    let started = Instant::now();
    while !is_so() {
        assert!(started.elapsed() < Duration::from_secs(60), "{what}");
        std::thread::sleep(Duration::from_millis(20));
    }
}

fn read(path: &Path) -> String {
    fs::read_to_string(path).unwrap_or_default().trim().to_owned()
}

#[test]
fn it_works_in_its_folder_and_is_heard_to_its_end() {
    let folder = tempfile::tempdir().unwrap();
    let (ended, said) = shell(folder.path(), "pwd; echo $PWD; echo aside >&2; cat; exit 3", UNLIMITED);
    assert_eq!(ended.unwrap().code(), Some(3));
    let of =
        |kind| said.iter().filter(|(stream, _)| *stream == kind).map(|(_, line)| line.as_str()).collect::<Vec<_>>();
    let path = folder.path().canonicalize().unwrap().display().to_string();
    assert_eq!(of(Stream::Output), [path.as_str(), path.as_str()]);
    assert_eq!(of(Stream::Error), ["aside"]);
    let missing = ForeignProgram::new(OsStr::new("no such program"), folder.path());
    assert!(matches!(missing.run(UNLIMITED, || false, |_, _| ()), Err(ProgramError::Start(_))));
}

#[test]
fn who_holds_its_pipes_and_who_floods_them_keep_nobody_waiting() {
    let folder = tempfile::tempdir().unwrap();
    let pid = folder.path().join("pid");
    // One that stays in its process group, and one that leaves it.
    for script in [
        "sleep 600 & echo $! > pid; echo done",
        "(while :; do echo flood; done) & echo $! > pid; echo done",
        "setsid sh -c 'echo $$ > pid; exec sleep 600' & while ! [ -s pid ]; do sleep 0.01; done; echo done",
    ] {
        let _ = fs::remove_file(&pid);
        let (ended, said) = shell(folder.path(), script, Limits { time: Some(Duration::from_secs(50)), ..UNLIMITED });
        assert!(ended.unwrap().success(), "{script}");
        assert!(said.contains(&(Stream::Output, "done".to_owned())), "{script}");
        until("it is still there", || !is_alive(&read(&pid)));
    }
}

#[test]
fn it_may_be_stopped_and_ended_for_its_time_and_for_its_bytes() {
    let folder = tempfile::tempdir().unwrap();
    let pid = folder.path().join("pid");
    // One that does not listen to a request, and has another beside it.
    let script = "trap '' TERM; sleep 600 & echo $! > ../pid; setsid sleep 600 & echo $! > ../other; while :; do sleep 0.1; done";
    let private = || {
        let path = folder.path().join("private");
        fs::create_dir(&path).unwrap();
        path
    };
    let (ended, _) = shell(&private(), script, Limits { time: Some(Duration::from_millis(300)), ..UNLIMITED });
    assert!(matches!(ended, Err(ProgramError::Time(_))), "{ended:?}");
    let other = folder.path().join("other");
    until("it is still there", || !is_alive(&read(&pid)) && !is_alive(&read(&other)));
    assert!(!private_is_left(folder.path()));
    let script = "while :; do cat /proc/self/maps >> much; done";
    let (ended, _) = shell(&private(), script, Limits { bytes: Some(10_000), ..UNLIMITED });
    assert!(matches!(ended, Err(ProgramError::Bytes { most: 10_000, .. })), "{ended:?}");
    if cfg!(target_os = "linux") {
        // Its memory has a limit from soon after its start on; the Python there needs some megabytes itself.
        let script = "sleep 0.3; exec python3 -c 'len(bytes(1 << 30)); print(1)'";
        let some = Limits { memory: Some(512 << 20), ..UNLIMITED };
        assert!(shell(&private(), script, UNLIMITED).0.unwrap().success());
        assert!(!shell(folder.path(), script, some).0.unwrap().success());
    }
    fs::remove_dir_all(folder.path().join("private")).unwrap();
    let asked = Cell::new(0);
    let stop = || {
        asked.set(asked.get() + 1);
        asked.get() > 3
    };
    let ended = ForeignProgram::new(OsStr::new("sleep"), &private()).arg("600").run(UNLIMITED, stop, |_, _| ());
    assert!(matches!(ended, Err(ProgramError::Stopped)));
}

fn private_is_left(folder: &Path) -> bool {
    folder.join("private").exists()
}

#[test]
fn a_line_without_an_end_takes_limited_memory() {
    let folder = tempfile::tempdir().unwrap();
    let (ended, said) = shell(folder.path(), "head -c 300000000 /dev/zero", UNLIMITED);
    assert!(ended.unwrap().success());
    assert_eq!(said.iter().map(|(_, line)| line.len()).max(), Some(1 << 20));
}

/// The part of this program where the environment variable names a folder: it starts another one, and waits for it.
const PART: &str = "FOREIGN_PROGRAM_TEST";

#[test]
fn a_program_ends_with_this_one_whatever_ends_it() {
    if let Some(folder) = std::env::var_os(PART) {
        let folder = Path::new(&folder).join("private");
        fs::create_dir(&folder).unwrap();
        let (_, _) = shell(&folder, "sleep 600 & echo $$ $! > ../pids.part; mv ../pids.part ../pids; wait", UNLIMITED);
        unreachable!("it is to be ended");
    }
    for signal in ["KILL", "TERM", "ABRT"] {
        let folder = tempfile::tempdir().unwrap();
        let name = "a_program_ends_with_this_one_whatever_ends_it";
        let mut part = Command::new(std::env::current_exe().unwrap());
        let mut part = part.arg(name).env(PART, folder.path()).spawn().unwrap();
        let pids = folder.path().join("pids");
        until("it does not start", || pids.is_file());
        let pids = read(&pids);
        assert!(pids.split(' ').count() == 2 && pids.split(' ').all(is_alive), "{pids}");
        let kill = Command::new("kill").args([&format!("-{signal}"), &part.id().to_string()]).status();
        assert!(kill.unwrap().success());
        part.wait().unwrap();
        until(&format!("{signal}: it goes on"), || !pids.split(' ').any(is_alive));
        until(&format!("{signal}: its folder is left"), || !folder.path().join("private").exists());
    }
}

#[test]
fn only_ordinary_files_are_read_and_no_more_of_them_than_is_allowed() {
    let folder = tempfile::tempdir().unwrap();
    let place = |name: &str| folder.path().join(name);
    fs::write(place("file"), "12345").unwrap();
    assert_eq!(read_at_most(&place("file"), 5).unwrap(), b"12345");
    assert!(read_at_most(&place("file"), 4).unwrap_err().to_string().contains("more than 4 bytes"));
    assert!(Command::new("mkfifo").arg(place("pipe")).status().unwrap().success());
    std::os::unix::fs::symlink("/dev/zero", place("zero")).unwrap();
    for (name, said) in [("pipe", "a device or a pipe"), ("zero", "a device or a pipe"), (".", "a folder")] {
        assert!(open_ordinary(&place(name)).unwrap_err().to_string().contains(said), "{name}");
    }
}
