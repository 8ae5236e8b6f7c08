//! Programs that the program has started, and its temporary files, when it ends.

use std::fs;
use std::os::unix::fs::PermissionsExt;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Output, Stdio};
use std::time::{Duration, Instant};

use tempfile::TempDir;

use crate::program::command_in;

/// A folder with a folder for temporary files.
struct Case {
    folder: TempDir,
}

impl Case {
    fn new() -> Self {
        let folder = tempfile::tempdir().unwrap();
        fs::create_dir(folder.path().join("temporary")).unwrap();
        Self { folder }
    }

    fn path(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    fn write(&self, name: &str, text: &str) {
        fs::write(self.path(name), text).unwrap();
    }

    /// A scene with this mesh.
    fn scene(&self, name: &str, mesh: &str) {
        let text = format!(
            "title = \"bar\"\nunits = {{ length = \"m\", mass = \"kg\", time = \"s\" }}\n[body]\nmesh = {mesh:?}\n\
             material = {{ young_modulus = 210e9, poisson_ratio = 0.3, density = 7850.0 }}\n[modes]\nflexible = 3\n\
             [initial]\nangular_velocity = [0.1, 0.2, 0.3]\n[time]\nend = 0.01\nstep = 1e-5\n"
        );
        self.write(name, &text);
    }

    fn command(&self, arguments: &[&str]) -> Command {
        let mut command = command_in(self.folder.path(), arguments);
        command.env("TMPDIR", self.path("temporary")).stdout(Stdio::piped()).stderr(Stdio::piped());
        command
    }

    fn is_clean(&self) -> bool {
        fs::read_dir(self.path("temporary")).unwrap().next().is_none()
    }

    /// Files that are not whole yet.
    fn unfinished(&self) -> usize {
        let entries = fs::read_dir(self.folder.path()).unwrap().flatten();
        entries.filter(|entry| entry.file_name().to_string_lossy().starts_with(".flexframe-")).count()
    }

    /// Processes whose command line names the folder of the case.
    fn processes(&self) -> Vec<String> {
        let folder = self.path("temporary").display().to_string();
        let entries = fs::read_dir("/proc").unwrap().flatten();
        let lines = entries.filter_map(|entry| fs::read(entry.path().join("cmdline")).ok());
        lines
            .map(|line| String::from_utf8_lossy(&line).replace('\0', " "))
            .filter(|line| line.contains(&folder))
            .collect()
    }
}

#[track_caller]
fn until(what: &str, is_so: impl Fn() -> bool) {
    let started = Instant::now();
    while !is_so() {
        assert!(started.elapsed() < Duration::from_secs(60), "{what}");
        std::thread::sleep(Duration::from_millis(20));
    }
}

fn signal(child: &Child, signal: &str) {
    assert!(Command::new("kill").args([&format!("-{signal}"), &child.id().to_string()]).status().unwrap().success());
}

fn said(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).into_owned()
}

const BOX: &str = "SetFactory(\"OpenCASCADE\");\nBox(1) = {0, 0, 0, 1, 0.1, 0.1};\nPhysical Volume(\"block\") = {1};\n";

#[test]
fn gmsh_and_its_files_end_with_the_program() {
    for name in ["TERM", "INT", "HUP", "KILL"] {
        let case = Case::new();
        case.write("bar.geo", &format!("{BOX}Sleep 600;\n"));
        case.scene("bar.toml", "bar.geo");
        let child = case.command(&["modes", "bar.toml"]).spawn().unwrap();
        until("gmsh is not there", || case.processes().iter().any(|line| line.contains("gmsh")));
        // The guard begins right after it.
        until("the guard is not there", || case.processes().len() > 1);
        signal(&child, name);
        let output = child.wait_with_output().unwrap();
        if name != "KILL" {
            assert_eq!(output.status.code(), Some(130), "{}", said(&output));
        }
        until(&format!("{name}: gmsh is still there"), || case.processes().is_empty());
        until(&format!("{name}: its files are still there"), || case.is_clean());
    }
}

#[test]
fn temporary_files_are_removed_by_a_signal() {
    let case = Case::new();
    case.scene(
        "bar.toml",
        Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../..")).join("meshes/slender_bar.msh").to_str().unwrap(),
    );
    let sweep = "scene = \"bar.toml\"\n[parameters]\n\"time.end\" = { from = 10, to = 20, count = 4 }\n[results]\n\
                 strain = { peak = \"energy/strain\" }\n";
    case.write("sweep.toml", sweep);
    for (name, ends) in [("TERM", Some(130)), ("INT", Some(130)), ("HUP", Some(130)), ("ABRT", None), ("USR1", None)] {
        let child = case.command(&["animate", "bar.toml", "-o", "bar.gif", "--frames", "2000"]).spawn().unwrap();
        until("the animation does not begin", || case.unfinished() > 0);
        signal(&child, name);
        let output = child.wait_with_output().unwrap();
        assert_eq!((output.status.code(), case.unfinished()), (ends, 0), "{}", said(&output));
        assert!(!case.path("bar.gif").exists());
        // The signals are the same for every command.
        if ends.is_none() {
            continue;
        }
        let child = case.command(&["sweep", "sweep.toml", "--no-cache"]).spawn().unwrap();
        until("the sweep does not begin", || !case.is_clean());
        signal(&child, name);
        let output = child.wait_with_output().unwrap();
        assert!(output.status.code() == ends && case.is_clean(), "{}", said(&output));
    }
}

#[test]
fn a_folder_of_temporary_files_that_is_not_there_is_named() {
    let case = Case::new();
    case.write("part.geo", BOX);
    case.scene("part.toml", "part.geo");
    for arguments in [["modes", "part.toml"], ["play", "part.toml"]] {
        let output = case.command(&arguments).env("TMPDIR", case.path("gone")).output().unwrap();
        assert_eq!(output.status.code(), Some(6), "{}", said(&output));
        assert!(said(&output).contains("error: no temporary folder can be made in "), "{}", said(&output));
        assert!(said(&output).contains("\n = let the environment variable TMPDIR name"), "{}", said(&output));
    }
}

#[test]
fn under_nohup_the_end_of_the_terminal_changes_nothing() {
    let case = Case::new();
    case.scene(
        "bar.toml",
        Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../..")).join("meshes/slender_bar.msh").to_str().unwrap(),
    );
    let mut command = Command::new("nohup");
    let inner = case.command(&["animate", "bar.toml", "-o", "bar.gif", "--frames", "40"]);
    command.arg(inner.get_program()).args(inner.get_args()).current_dir(case.folder.path());
    command.envs(inner.get_envs().filter_map(|(name, value)| Some((name, value?))));
    let child = command.stdin(Stdio::null()).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
    until("it does not begin", || case.unfinished() > 0 || case.path("bar.gif").exists());
    signal(&child, "HUP");
    let output = child.wait_with_output().unwrap();
    assert!(output.status.success(), "{}", said(&output));
    assert!(case.path("bar.gif").exists());
}

/// Every command that may come to have a mesh read.
#[test]
fn no_command_runs_what_a_mesh_says_unless_it_is_trusted() {
    let case = Case::new();
    let mark = case.path("mark");
    case.write("bar.geo", BOX);
    let gmsh = |more: &[&str], to: &str| {
        let mut command = Command::new("gmsh");
        command.args(["bar.geo", "-3", "-v", "0", "-format", "msh22"]).args(more).args(["-o", to]);
        assert!(command.current_dir(case.folder.path()).output().unwrap().status.success());
    };
    gmsh(&["-order", "2"], "bar.msh");
    case.scene("bar.toml", "bar.msh");
    let done = case.command(&["run", "bar.toml"]).output().unwrap();
    assert!(done.status.success(), "{}", said(&done));
    // The mesh that the results file names is another now.
    let touch = format!("SystemCall \"touch {}\";", mark.display());
    let mesh = fs::read_to_string(case.path("bar.msh")).unwrap();
    case.write("bar.msh", &format!("{touch} /*\n{mesh}*/\n"));
    case.write("evil.geo", &format!("{BOX}{touch}\n"));
    case.scene("evil.toml", "evil.geo");
    case.write(
        "sweep.toml",
        "scene = \"evil.toml\"\n[parameters]\n\"time.end\" = [0.01]\n[results]\ne = { peak = \"energy/strain\" }\n",
    );
    let refusals: [&[&str]; 15] = [
        &["modes", "bar.toml"],
        &["new", "bar.msh", "--raise-order", "-o", "new.toml"],
        &["modes", "bar.toml", "--set", "body.raise_order=true"],
        &["modes", "evil.toml"],
        &["new", "evil.geo", "-o", "new.toml"],
        &["run", "evil.toml"],
        &["advise", "evil.toml"],
        &["reduce", "evil.toml", "-o", "evil.h5"],
        &["campbell", "evil.toml", "--axis", "z", "--speeds", "0:1:2"],
        &["cost", "evil.toml"],
        &["animate", "evil.toml", "-o", "evil.gif"],
        &["modes", "evil.toml", "--solver", "slepc", "--ranks", "1", "--write-only", "job"],
        &["paper", "evil.toml", "--set", "output.points.P1=[1.0,0.0,0.0]"],
        &["modes", "evil.toml", "--json"],
        &["modes", "evil.toml", "-o", "pictures"],
    ];
    for arguments in refusals {
        let output = case.command(arguments).output().unwrap();
        assert_eq!(output.status.code(), Some(3), "{arguments:?}: {}", said(&output));
        let is_geometry = arguments[1].starts_with("evil");
        assert!(said(&output).contains("--trust-geometry") == is_geometry, "{arguments:?}: {}", said(&output));
        assert!(!mark.exists() && case.is_clean(), "{arguments:?}");
    }
    // A results file is read alone: nobody looks at the mesh of its scene.
    for arguments in [&["report", "out/bar/bar.h5"][..], &["export", "out/bar/bar.h5", "--vtkhdf", "bar.vtkhdf"]] {
        let output = case.command(arguments).output().unwrap();
        assert_eq!(output.status.code(), Some(0), "{arguments:?}: {}", said(&output));
        assert!(!mark.exists() && case.is_clean(), "{arguments:?}");
    }
    // A row of a sweep that fails does not stop the others.
    let output = case.command(&["sweep", "sweep.toml"]).output().unwrap();
    assert!(!mark.exists(), "{}", said(&output));
    for arguments in
        [&["modes", "evil.toml"][..], &["new", "evil.geo", "-o", "new.toml"], &["sweep", "sweep.toml", "--overwrite"]]
    {
        let output = case.command(&[arguments, &["--trust-geometry"]].concat()).output().unwrap();
        assert!(output.status.success() && mark.exists(), "{arguments:?}: {}", said(&output));
        fs::remove_file(&mark).unwrap();
        let told = format!("{}{}", said(&output), String::from_utf8_lossy(&output.stdout));
        let words = "evil.geo is a program, which gmsh runs: gmsh is free to do all that it says (--trust-geometry)";
        assert_eq!(told.matches(words).count(), 1, "{arguments:?}: {told}");
    }
    // Where it is not trusted, that is said, too.
    case.scene("box.toml", "bar.geo");
    let output = case.command(&["modes", "box.toml"]).output().unwrap();
    assert_eq!(said(&output).matches("bar.geo is a program, which gmsh runs: its commands that run").count(), 1);
    let output = case.command(&["modes", "box.toml", "--json"]).output().unwrap();
    assert!(output.status.success() && said(&output).is_empty(), "{}", said(&output));
}

/// A program that the user names by a path from the folder that he is in.
#[test]
fn programs_are_named_from_the_current_folder() {
    let case = Case::new();
    case.write("bar.geo", BOX);
    case.scene("bar.toml", "bar.geo");
    fs::create_dir(case.path("bin")).unwrap();
    case.write("bin/gmsh", "#!/bin/sh\nexec gmsh \"$@\"\n");
    fs::set_permissions(case.path("bin/gmsh"), fs::Permissions::from_mode(0o755)).unwrap();
    let output =
        case.command(&["modes", "bar.toml"]).env("FLEXFRAME_GMSH", "bin/gmsh").env("TMPDIR", "temporary").output();
    let output = output.unwrap();
    assert!(output.status.success() && case.is_clean(), "{}", said(&output));
}

#[test]
fn variables_of_the_users_python_do_not_reach_other_programs() {
    let case = Case::new();
    case.write("part.geo", "");
    case.scene("part.toml", "part.geo");
    let (gmsh, seen) = (case.path("gmsh.sh"), case.path("seen"));
    case.write("gmsh.sh", &format!("#!/bin/sh\nenv | grep ^PYTHON > '{}'\nexit 1\n", seen.display()));
    fs::set_permissions(&gmsh, fs::Permissions::from_mode(0o755)).unwrap();
    let mut command = case.command(&["modes", "part.toml"]);
    command.env("FLEXFRAME_GMSH", &gmsh).env("PYTHONPATH", case.path("modules")).env("PYTHONSTARTUP", "start.py");
    assert!(!command.output().unwrap().status.success());
    assert_eq!(fs::read_to_string(seen).unwrap(), "PYTHONSAFEPATH=1\n");
}
