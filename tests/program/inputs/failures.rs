//! How a command that fails says so: exit codes, JSON, and streams that cannot be written.

use std::process::{Command, Output, Stdio};
use std::time::Duration;

use diagnostic::Kind;
use serde_json::Value;
use tempfile::TempDir;

use crate::inputs::command_line::COIN;
use crate::program::{self, flexframe, root};

/// The program under a shell, for its redirections and limits; `flexframe` stands for the program.
fn shell(script: &str) -> Output {
    let script = script.replace("flexframe", env!("CARGO_BIN_EXE_flexframe"));
    Command::new("bash").args(["-c", &script]).current_dir(root()).output().unwrap()
}

fn errors(output: &Output) -> String {
    String::from_utf8(output.stderr.clone()).unwrap()
}

/// The object on standard error of a command that fails, after the agreement of code and kind has been checked.
#[track_caller]
fn failure(kind: Kind, arguments: &[&str]) -> Value {
    let output = flexframe(arguments);
    let text = errors(&output);
    assert_eq!(output.status.code(), Some(kind.exit_code().into()), "{text}");
    assert!(output.stdout.is_empty());
    assert_eq!(text.lines().count(), 1, "{text}");
    let object: Value = serde_json::from_str(&text).unwrap();
    assert_eq!(object["kind"], kind.name());
    assert_eq!(object["exit_code"], kind.exit_code());
    assert!(!object["message"].as_str().unwrap().is_empty());
    assert!(!object["message"].as_str().unwrap().starts_with("error"), "{text}");
    object
}

#[track_caller]
fn assert_says(value: &Value, words: &[&str]) {
    let text = value.as_str().unwrap_or_else(|| panic!("no text: {value}"));
    for word in words {
        assert!(text.contains(word), "{word} in: {text}");
    }
}

/// The ring of the examples in a folder of its own, with changes.
struct Ring {
    folder: TempDir,
}

impl Ring {
    fn new() -> Self {
        Self { folder: tempfile::tempdir().unwrap() }
    }

    fn scene(&self, changes: &[(&str, &str)]) -> String {
        let mut text = std::fs::read_to_string(root().join("examples/ring.toml")).unwrap();
        for (from, to) in changes {
            assert!(text.contains(from), "{from}");
            text = text.replace(from, to);
        }
        text = text.replace("../meshes", root().join("meshes").to_str().unwrap());
        self.file("scene.toml", &text)
    }

    fn file(&self, name: &str, text: &str) -> String {
        let path = self.folder.path().join(name);
        std::fs::write(&path, text).unwrap();
        path.to_str().unwrap().to_owned()
    }

    fn out(&self) -> String {
        self.folder.path().join("out").to_str().unwrap().to_owned()
    }
}

#[test]
fn wrong_arguments_are_an_object_too() {
    for arguments in [&["run", "--json"][..], &["modes", "a.toml", "--json", "--nonsense"], &["nothing", "--json"]] {
        failure(Kind::Usage, arguments);
    }
    let object = failure(Kind::Usage, &["modes", "examples/ring.toml", "-n", "100000", "--json"]);
    assert_says(&object["key"], &["--flexible"]);
    assert_says(&object["expected"], &["at most 6105"]);
    let ring = Ring::new();
    let pulse = ring.file("pulse.csv", "0,0\n1,1\n");
    let object = failure(Kind::Usage, &["srs", &pulse, "--frequencies", "1:9:3", "-o", "srs.csv", "--json"]);
    assert_says(&object["found"], &["a table of text"]);
    let axis = ["--axis", "z", "--speeds", "5:1:3", "--json"];
    failure(Kind::Usage, &[&["campbell", "examples/ring.toml"], &axis[..]].concat());
}

#[test]
fn a_fault_of_a_scene_is_named_by_file_line_and_key() {
    let ring = Ring::new();
    let scene = ring.scene(&[("tolerance = 1e-6", "step = -2e-5")]);
    let object = failure(Kind::Input, &["run", &scene, "-o", &ring.out(), "--json"]);
    assert_eq!(object["file"], scene);
    assert_eq!((&object["line"], &object["key"]), (&26.into(), &"time.step".into()));
    assert_says(&object["found"], &["-2e-5"]);
    assert!(object["expected"].is_string() && object["help"].is_string(), "{object}");

    let scene = ring.scene(&[("tolerance = 1e-6", "stepp = 2e-5")]);
    let object = failure(Kind::Input, &["advise", &scene, "--json"]);
    assert_eq!(object["found"], "stepp");
    assert_says(&object["help"], &["rename it to `step`"]);
    assert_says(&object["expected"], &["`step`"]);

    let scene = ring.scene(&[("end = 0.2\n", "")]);
    let object = failure(Kind::Input, &["cost", &scene, "--json"]);
    assert_says(&object["help"], &["add it"]);

    let scene = ring.scene(&[("[time]", "[time")]);
    let object = failure(Kind::Input, &["modes", &scene, "--json"]);
    assert!(object["line"].is_u64() && object["help"].is_string(), "{object}");
}

#[test]
fn a_mesh_is_named_whether_it_is_absent_or_wrong() {
    let ring = Ring::new();
    let absent = ring.scene(&[("../meshes/ring.msh", "none.msh")]);
    let object = failure(Kind::Input, &["run", &absent, "-o", &ring.out(), "--json"]);
    assert_eq!((&object["file"], &object["key"]), (&absent.as_str().into(), &"body.mesh".into()));
    assert_says(&object["found"], &["a mesh that cannot be read", "none.msh", "No such file"]);
    let broken = ring.file("none.msh", "$MeshFormat\n4.1 0 8\n$EndMeshFormat\n$Nodes\nmany\n");
    let object = failure(Kind::Input, &["run", &absent, "-o", &ring.out(), "--json"]);
    assert_eq!((&object["file"], &object["line"]), (&broken.into(), &5.into()));
    assert!(object["expected"].is_string() && object["found"].is_string(), "{object}");
    // The scene itself.
    let object = failure(Kind::Io, &["run", "no_such_scene.toml", "--json"]);
    assert_eq!(object["file"], "no_such_scene.toml");
}

#[test]
fn a_refused_model_a_failed_run_and_a_file_in_the_way_differ() {
    let ring = Ring::new();
    let beyond = ring.scene(&[("tolerance = 1e-6", "scheme = \"rkmk4\"\nstep = 1e-3")]);
    let object = failure(Kind::Refused, &["run", &beyond, "-o", &ring.out(), "--json"]);
    assert_eq!(object["file"], beyond);

    let wild = ring.scene(&[
        ("tolerance = 1e-6", "step = 1e-3"),
        ("amplitude = 200.0", "amplitude = 2e12"),
        ("[initial]", "[effects]\nrefuse = false\n[initial]"),
    ]);
    let object = failure(Kind::Run, &["run", &wild, "-o", &ring.out(), "--json"]);
    assert_says(&object["message"], &["at time", "the states before it are in"]);
    let gif = format!("{}.gif", ring.out());
    let output = flexframe(&["animate", &wild, "-o", &gif]);
    assert_eq!(output.status.code(), Some(5));
    let text = errors(&output);
    assert!(text.contains("scene.toml: at time") && !text.contains("no file"), "{text}");

    let object = failure(Kind::Io, &["run", &wild, "-o", &ring.out(), "--json"]);
    assert_says(&object["message"], &["unfinished run", "--overwrite"]);
    assert_says(&object["file"], &["scene.part.h5"]);
    // No results file at all, and one that says nothing.
    failure(Kind::Io, &["resume", &ring.file("nothing", ""), "--json"]);
    let object = failure(Kind::Input, &["resume", &ring.file("diary.part.h5", &"a diary".repeat(1000)), "--json"]);
    assert_says(&object["file"], &["diary.part.h5"]);
}

#[test]
fn a_body_without_modes_has_no_pictures_of_them() {
    let ring = Ring::new();
    let coin = ring.file("coin.toml", COIN);
    let stiff = ring.scene(&[("flexible = 6", "flexible = 0"), ("damping_ratio = 0.01", "")]);
    for (scene, key) in [(&coin, "body.rigid"), (&stiff, "modes.flexible")] {
        let object = failure(Kind::Input, &["modes", scene, "-o", &ring.out(), "--json"]);
        assert_eq!((&object["file"], &object["key"]), (&scene.as_str().into(), &key.into()));
        assert_says(&object["found"], &["a body without flexible modes"]);
    }
}

#[test]
fn what_is_infinite_is_said_in_json() {
    let ring = Ring::new();
    let text =
        std::fs::read_to_string(ring.scene(&[("angular_velocity = [0.0, 5.0, 20.0]", "modal_velocity = [12.0]")]));
    let text = text.unwrap();
    let (before, loads) = text.split_once("[[loads]]").unwrap();
    let (_, after) = loads.split_once("[time]").unwrap();
    let scene = ring.file("still.toml", &format!("{before}[time]{after}"));
    let output = flexframe(&["advise", &scene, "--json"]);
    let report: Value = serde_json::from_slice(&output.stdout).unwrap();
    let row = report["rows"].as_array().unwrap().iter().find(|row| row["effect"] == "flexibility").unwrap();
    assert_eq!(row["value"], "infinite");
}

#[test]
fn a_full_or_closed_standard_error_leaves_the_exit_code() {
    for (script, code) in [
        ("flexframe run no_such_scene.toml 2>/dev/full", 6),
        ("flexframe run no_such_scene.toml --json 2>/dev/full", 6),
        ("flexframe run 2>/dev/full", 2),
        ("flexframe run --json 2>/dev/full", 2),
        ("flexframe modes examples/ring.toml 2>/dev/full", 0),
        ("flexframe modes examples/ring.toml >/dev/full 2>/dev/full", 6),
        ("flexframe run no_such_scene.toml 2>&-", 6),
        // A reader that has gone away.
        ("(sleep 0.2; exec flexframe run no_such_scene.toml) 2>&1 | true; exit ${PIPESTATUS[0]}", 6),
    ] {
        let output = shell(script);
        assert_eq!(output.status.code(), Some(code), "{script}: {}", errors(&output));
    }
}

#[test]
fn a_full_standard_output_is_named() {
    for script in ["flexframe modes examples/ring.toml >/dev/full", "flexframe --help >/dev/full"] {
        let output = shell(script);
        assert_eq!(output.status.code(), Some(6), "{script}");
        let text = errors(&output);
        assert!(text.contains("standard output: cannot be written: No space left"), "{text}");
    }
    let output = shell("flexframe modes examples/ring.toml --json >/dev/full");
    let object: Value = serde_json::from_str(&errors(&output)).unwrap();
    assert_eq!((&object["kind"], &object["file"]), (&"io".into(), &"standard output".into()));
    // A reader that has had enough is no error.
    let output = shell("set -o pipefail; flexframe --help | true; flexframe modes examples/ring.toml | head -1");
    assert_eq!(output.status.code(), Some(0), "{}", errors(&output));
}

#[test]
fn threads_that_cannot_be_are_refused_in_words() {
    for count in ["100000", "0", "many"] {
        let mut command = program::command(&["modes", "examples/ring.toml"]);
        let output = command.env("RAYON_NUM_THREADS", count).output().unwrap();
        assert_eq!(output.status.code(), Some(2));
        let text = errors(&output);
        for words in ["RAYON_NUM_THREADS", count, "1 to 256", "--threads"] {
            assert!(text.contains(words), "{words} in: {text}");
        }
    }
    // 256 stacks do not fit into the memory that is left.
    for how in ["flexframe --threads 256", "RAYON_NUM_THREADS=256 flexframe"] {
        let output = shell(&format!("ulimit -v 300000; {how} modes examples/ring.toml"));
        assert_eq!(output.status.code(), Some(6), "{}", errors(&output));
        assert!(errors(&output).contains("256 threads cannot be started"), "{}", errors(&output));
    }
}

#[test]
fn the_exit_codes_are_documented() {
    let help = String::from_utf8(flexframe(&["--help"]).stdout).unwrap();
    let page = std::fs::read_to_string(root().join("docs/reference/cli.md")).unwrap();
    for kind in Kind::ALL {
        let (code, meaning) = (kind.exit_code(), kind.meaning());
        assert!(help.contains(&format!("{code:>3}  {meaning}")), "{help}");
        assert!(page.contains(&format!("| {code} | `{}` | {meaning} |", kind.name())), "{code}");
    }
    let mut codes = Kind::ALL.map(Kind::exit_code);
    codes.sort_unstable();
    assert!(codes.windows(2).all(|pair| pair[0] < pair[1]) && codes[0] > 1);
}

#[test]
fn a_signal_before_the_motion_ends_the_program_with_words() {
    let ring = Ring::new();
    for (signal, json) in [("-INT", true), ("-TERM", false)] {
        let mut command = program::command(&["cost", "examples/ring.toml", "--patience", "1000", "-o", &ring.out()]);
        if json {
            command.arg("--json");
        }
        let child = command.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
        let status = format!("/proc/{}/status", child.id());
        let listens = || {
            let status = std::fs::read_to_string(&status).unwrap();
            let caught = status.lines().find_map(|line| line.strip_prefix("SigCgt:")).unwrap().trim().to_owned();
            // Signals 2 and 15.
            u64::from_str_radix(&caught, 16).unwrap() & 0x4002 == 0x4002
        };
        while !listens() {
            std::thread::sleep(Duration::from_millis(1));
        }
        assert!(Command::new("kill").args([signal, &child.id().to_string()]).status().unwrap().success());
        let output = child.wait_with_output().unwrap();
        assert_eq!(output.status.code(), Some(130));
        let text = errors(&output);
        if json {
            assert_eq!(serde_json::from_str::<Value>(&text).unwrap()["kind"], "stopped");
        } else {
            assert_eq!(text, "error: stopped\n");
        }
    }
}

/// Whichever error a command ends with, its cure is told under a key of its own.
#[test]
fn a_cure_that_only_the_message_has_is_help() {
    let ring = Ring::new();
    let scene = ring.scene(&[]);
    let out = ring.out();
    std::fs::create_dir_all(&out).unwrap();
    ["frf.csv", "gradient.csv"].iter().for_each(|name| std::fs::write(format!("{out}/{name}"), "mine").unwrap());
    for arguments in [
        &["frf", &scene, "--frequencies", "1:2:2", "-o", &out, "--json"][..],
        &["gradient", &scene, "-o", &out, "--json"],
        &["frf", &scene, "--frequencies", "1:2:2", "--set", "loads=[]", "-o", &out, "--json"],
    ] {
        let output = flexframe(arguments);
        let object: Value = serde_json::from_slice(&output.stderr).unwrap();
        let (_, cure) = object["message"].as_str().unwrap().rsplit_once("\n = ").unwrap();
        assert_eq!(object["help"], cure, "{object}");
    }
}
