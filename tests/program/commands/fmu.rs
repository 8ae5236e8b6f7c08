//! `flexframe fmu`: what is packed, and what is refused. The crate `fmi` tests FMUs in motion.

use std::fs;
use std::path::Path;
use std::process::Output;

use flexframe::fmu::marker;
use serde_json::Value;

use crate::program::command;

/// The program without a library of the environment, unless there is one here.
fn flexframe(library: &str, arguments: &[&str]) -> Output {
    command(arguments).env("FLEXFRAME_FMU_LIBRARY", library).output().unwrap()
}

/// Bytes that pass for the library: its version, and a name that it exports.
fn library_bytes() -> String {
    format!("{} fmi2DoStep", marker())
}

fn refused(library: &str, arguments: &[&str], code: i32) -> Value {
    let output = flexframe(library, &[arguments, &["--json", "--overwrite"]].concat());
    let text = String::from_utf8(output.stderr).unwrap();
    assert_eq!(output.status.code(), Some(code), "{text}");
    serde_json::from_str(text.lines().last().unwrap()).unwrap()
}

/// Conserved: the same bytes each time.
#[test]
fn an_fmu_is_packed_of_a_scene_or_of_its_body_file_and_is_the_same_each_time() {
    let folder = tempfile::tempdir().unwrap();
    let place = |name: &str| folder.path().join(name).to_str().unwrap().to_owned();
    fs::write(place("library"), library_bytes()).unwrap();
    let scene = "examples/ring.toml";
    let pack = |of: &str, name: &str| -> Value {
        let more = ["--json", "--overwrite", "--set", "time.end=0.01"];
        let output = flexframe(&place("library"), &[&["fmu", of, "-o", &place(name)][..], &more].concat());
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
        serde_json::from_slice(&output.stdout).unwrap()
    };
    let first = pack(scene, "ring.fmu");
    let inputs: Vec<&str> = first["inputs"].as_array().unwrap().iter().map(|name| name.as_str().unwrap()).collect();
    assert_eq!(inputs[..3], ["loads[1].factor", "points.struck.force[1]", "points.struck.force[2]"]);
    assert_eq!(inputs.len(), 7);
    let bytes = fs::read(place("ring.fmu")).unwrap();
    assert_eq!(pack(scene, "ring.fmu")["guid"], first["guid"]);
    assert!(fs::read(place("ring.fmu")).unwrap() == bytes);
    let output = flexframe("", &["reduce", scene, "-o", &place("ring.body.h5")]);
    assert!(output.status.success());
    let of_body = pack(&place("ring.body.h5"), "of_body.fmu");
    assert_eq!(of_body["inputs"], first["inputs"]);
}

#[test]
fn without_its_library_nothing_is_packed() {
    let folder = tempfile::tempdir().unwrap();
    let place = |name: &str| folder.path().join(name).to_str().unwrap().to_owned();
    let (fmu, nothing, other) = (place("top.fmu"), place("nothing.so"), place("other.so"));
    fs::write(&other, "no library").unwrap();
    // The program knows the version as the library does, and the static library has all its names.
    let (program, archive) = (env!("CARGO_BIN_EXE_flexframe").to_owned(), place("library.rlib"));
    fs::write(&archive, format!("!<arch>\n{}", library_bytes())).unwrap();
    let arguments = ["fmu", "examples/pendulum.toml", "-o", &fmu];
    let not_it = "not the library for FMUs of flexframe";
    for (library, found) in [(&nothing, "cannot be read"), (&other, not_it), (&program, not_it), (&archive, not_it)] {
        for failure in
            [refused(library, &arguments, 6), refused("", &[&arguments[..], &["--library", library]].concat(), 6)]
        {
            let message = failure["message"].as_str().unwrap();
            for words in [found, "./dev build", "--library", "FLEXFRAME_FMU_LIBRARY"] {
                assert!(message.contains(words), "{message}");
            }
            assert_eq!(failure["file"], library.as_str());
        }
    }
    assert!(!Path::new(&fmu).exists());
}

#[test]
fn what_cannot_be_packed_leaves_the_old_file() {
    let folder = tempfile::tempdir().unwrap();
    let place = |name: &str| folder.path().join(name).to_str().unwrap().to_owned();
    fs::write(place("library"), library_bytes()).unwrap();
    fs::write(place("old.fmu"), "old").unwrap();
    fs::write(place("no.h5"), "no body file").unwrap();
    let (library, old) = (place("library"), place("old.fmu"));
    let scene = "examples/pendulum.toml";
    let failure = refused(&library, &["fmu", &place("no.h5"), "-o", &old], 3);
    assert!(failure["message"].as_str().unwrap().contains("no.h5"), "{failure}");
    let failure = refused(&library, &["fmu", scene, "-o", &old, "--set", "time.step=-1"], 3);
    assert_eq!(failure["key"], "time.step");
    let auto = ["fmu", "examples/ring.toml", "-o", &old, "--set", "modes.flexible=auto"];
    let failure = refused(&library, &auto, 3);
    assert_eq!(failure["key"], "modes.flexible");
    let failure = refused("", &["fmu", "examples/boom.toml", "-o", &old], 3);
    assert_eq!(failure["key"], "body.matrices");
    assert!(failure["help"].as_str().unwrap().contains("a mesh"), "{failure}");
    // A step in which the body turns by 10 rad. It is found in the packed scene; the message names the one that was given.
    let spun = ["--set", "time.step=1.0", "--set", "initial.angular_velocity=[0.0, 0.0, 10.0]"];
    let failure = refused(&library, &[&["fmu", scene, "-o", &old][..], &spun].concat(), 4);
    assert_eq!((&failure["file"], &failure["key"]), (&scene.into(), &"time.step".into()));
    assert!(failure["message"].as_str().unwrap().starts_with("examples/pendulum.toml:"), "{failure}");
    let failure = refused(&library, &["fmu", scene, "-o", &place("nowhere/top.fmu")], 6);
    assert!(failure["message"].as_str().unwrap().contains("there is no folder"), "{failure}");
    assert_eq!(fs::read(old).unwrap(), b"old");
}
