//! Scenes of several bodies: each moves as it would alone, bit for bit, and every command takes one of them by its name.

use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use flexframe::columns::COLUMNS;
use results::Results;

fn scene() -> PathBuf {
    Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../..")).join("examples/pair.toml")
}

fn flexframe(folder: &Path, arguments: &[&str]) -> Output {
    let mut command = Command::new(env!("CARGO_BIN_EXE_flexframe"));
    command.args(arguments).current_dir(folder).env("FLEXFRAME_CACHE", "").output().unwrap()
}

/// Standard output of a command that succeeds.
fn done(folder: &Path, arguments: &[&str]) -> String {
    let Output { status, stdout, stderr } = flexframe(folder, arguments);
    assert!(status.success(), "{arguments:?}: {}", String::from_utf8_lossy(&stderr));
    String::from_utf8(stdout).unwrap()
}

/// The bits of all columns.
fn histories(file: &Path) -> Vec<(String, Vec<u64>)> {
    let results = Results::open(file, &COLUMNS).unwrap();
    let columns = results::present(&COLUMNS, &results.metadata);
    let bits = |path: &str| {
        let numbers = results.numbers(path).map(<[f64]>::to_vec);
        let vectors = results.vectors::<3>(path).map(|vectors| vectors.concat());
        let quaternions = results.vectors::<4>(path).map(|vectors| vectors.concat());
        numbers.or(vectors).or(quaternions).unwrap_or_default().into_iter().map(f64::to_bits).collect()
    };
    columns.map(|column| (column.path.to_owned(), bits(column.path))).collect()
}

/// Conserved: the numbers of each body are those of a run of its own, to the last bit.
#[test]
fn each_body_of_a_pair_moves_as_it_would_alone_to_the_last_bit() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let scene = scene();
    let scene = scene.to_str().unwrap();
    let summary: serde_json::Value =
        serde_json::from_str(&done(folder, &["run", scene, "-o", "both", "--json"])).unwrap();
    for body in ["ring", "block"] {
        // From where it was placed.
        assert!(summary[body]["moved"][2].as_f64().unwrap().abs() < 1.0, "{summary}");
        assert!(summary[body]["steps"].as_u64().unwrap() > 10, "{summary}");
        let both = folder.join(format!("both/pair.{body}.h5"));
        // Alone: by its name, and from the scene that its results carry.
        done(folder, &["run", scene, "--body", body, "-o", "one"]);
        let text = Results::open(&both, &COLUMNS).unwrap().metadata.scene_text;
        std::fs::write(Path::new(scene).with_file_name(format!(".pair-{body}.toml")), &text).unwrap();
        let alone = Path::new(scene).with_file_name(format!(".pair-{body}.toml"));
        let run = flexframe(folder, &["run", alone.to_str().unwrap(), "-o", "alone"]);
        std::fs::remove_file(&alone).unwrap();
        assert!(run.status.success(), "{}", String::from_utf8_lossy(&run.stderr));
        let expected = histories(&both);
        assert!(expected.iter().filter(|(_, bits)| bits.len() > 100).count() > 10);
        assert_eq!(histories(&folder.join(format!("one/pair.{body}.h5"))), expected);
        assert_eq!(histories(&folder.join(format!("alone/.pair-{body}.h5"))), expected);
    }
    let ring = Results::open(folder.join("both/pair.ring.h5"), &COLUMNS).unwrap();
    let [_, _, z] = ring.vectors::<3>("origin").unwrap()[0];
    // The mesh is centred on its plane z = 20 mm to some mm.
    assert!((500.0..540.0).contains(&z), "{z}");
}

#[test]
fn every_output_takes_the_results_of_a_body_and_every_command_a_body() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let scene = scene();
    let scene = scene.to_str().unwrap();
    let text = done(folder, &["run", scene, "-o", "out", "--set", "time.end=0.02"]);
    assert!(text.contains("body ring\n") && text.contains("body block\n"), "{text}");
    for body in ["ring", "block"] {
        let file = format!("out/pair.{body}.h5");
        done(folder, &["export", &file, "--csv", &format!("{body}.csv")]);
        done(folder, &["report", &file]);
        done(folder, &["advise", scene, "--body", body]);
    }
    done(folder, &["animate", "out/pair.ring.h5", "-o", "ring.gif", "--frames", "3"]);
    done(folder, &["export", "out/pair.ring.h5", "--vtkhdf", "ring.vtkhdf"]);
    let modes = done(folder, &["modes", scene, "--body", "ring"]);
    assert!(modes.contains("Hz"), "{modes}");
}

#[test]
fn one_body_is_asked_for_where_there_are_several() {
    let folder = tempfile::tempdir().unwrap();
    let scene = scene();
    for (arguments, words) in [
        (&["modes"][..], "name one of them: ring, block"),
        (&["cost"], "name one of them: ring, block"),
        (&["modes", "--body", "wheel"], "no body `wheel`"),
        (&["run", "--solver", "slepc", "--ranks", "2"], "--body NAME"),
    ] {
        let all: Vec<&str> =
            [arguments[0], scene.to_str().unwrap()].into_iter().chain(arguments[1..].iter().copied()).collect();
        let Output { status, stderr, .. } = flexframe(folder.path(), &all);
        let stderr = String::from_utf8(stderr).unwrap();
        assert!(!status.success() && stderr.contains(words), "{arguments:?}: {stderr}");
    }
}
