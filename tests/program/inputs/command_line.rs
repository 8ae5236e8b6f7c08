//! The program as its users meet it.

use std::path::Path;

use flexframe::columns::COLUMNS;
use hdf5::types::VarLenUnicode;
use results::{Metadata, Results, Scope, Units, histories};

use crate::program::{flexframe, json, numbers, root};

#[test]
fn the_modes_of_the_plate_are_those_of_the_reference() {
    // Independent reference: the lc 10 column of plate_modes.csv by another FE code and ARPACK, given with the project.
    let expected = [24.5284, 86.1726, 93.2686, 117.3730, 206.1779, 359.9787, 387.9791, 536.7789, 545.4214, 582.0931];
    let report = json(&["modes", "examples/plate.toml"]);
    let found = numbers(&report["body"]["natural_frequencies"]);
    assert_eq!(found.len(), 10);
    for (found, expected) in found.iter().zip(expected) {
        // Half a unit of the last digit printed there, which is 2e-6 of the first frequency.
        assert!((found - expected).abs() < 5.1e-5, "{found} {expected}");
    }
    let twelve = json(&["modes", "examples/plate.toml", "-n", "12", "--threads", "1"]);
    let more = numbers(&twelve["body"]["natural_frequencies"]);
    assert_eq!(more.len(), 12);
    assert!(found.iter().zip(&more).all(|(a, b)| (a / b - 1.0).abs() < 1e-9));
}

/// Independent reference: the figures and tables of the paper, and moments of inertia given with the project.
#[test]
fn the_paper_is_reproduced_with_every_figure() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().to_str().unwrap();
    let report = json(&["paper", "examples/plate.toml", "-o", out]);
    let files: Vec<String> =
        std::fs::read_dir(out).unwrap().map(|e| e.unwrap().file_name().into_string().unwrap()).collect();
    for figure in 3..=13 {
        for kind in [".svg", ".pdf", ".png"] {
            let name = format!("fig{figure:02}_");
            assert!(files.iter().any(|f| f.starts_with(&name) && f.ends_with(kind)), "{name}*{kind} in {files:?}");
        }
    }
    let page = std::fs::read_to_string(folder.path().join("report.md")).unwrap();
    for words in [
        "## Table 1",
        "| 7 | 24.5282 | 24.5284 |",
        "What the paper does not give",
        "half-sine pulse of 50 N",
        " mJ at the end,",
    ] {
        assert!(page.contains(words), "{words}");
    }
    // Every picture that the page shows is there.
    for link in page.split("](").skip(1).filter_map(|rest| rest.split(')').next()) {
        assert!(folder.path().join(link).exists(), "{link}");
    }

    let comparison = &report["comparison"];
    let worst = comparison["frequencies"]
        .as_array()
        .unwrap()
        .iter()
        .map(|pair| (pair["here"].as_f64().unwrap() / pair["paper"].as_f64().unwrap() - 1.0).abs());
    assert!(worst.fold(0.0, f64::max) < 0.0046);
    let moment = |which: &str, i: usize| comparison[which][i]["here"].as_f64().unwrap();
    for (i, (consistent, lumped)) in
        [(5.4925, 5.48373), (2112.71125, 2112.70238), (2117.78125, 2117.77332)].into_iter().enumerate()
    {
        assert!((moment("moments", i) / consistent - 1.0).abs() < 1e-9);
        assert!((moment("lumped_moments", i) / lumped - 1.0).abs() < 1e-5);
    }
    // The paper: "match precisely". Measured 8e-9, 2.1e-5 (the scheme takes the mean of the force over a step), 7e-8, 5e-9.
    for (figure, bound) in [("fig_8", 1e-7), ("fig_9", 3e-5), ("fig_10", 1e-6), ("fig_11", 1e-7)] {
        let difference = comparison[figure]["difference"].as_f64().unwrap();
        assert!(difference < bound, "{figure}: {difference:e}");
    }
    // And the full acceleration does vibrate: 5 % and 11 % of the peak.
    assert!((0.04..0.07).contains(&comparison["fig_12"]["difference"].as_f64().unwrap()));
    assert!((0.09..0.13).contains(&comparison["fig_13"]["difference"].as_f64().unwrap()));
}

/// HDF5 finds each column of the table in the file, with its shape, unit, frame and description, and no other.
fn assert_describes_its_columns(path: &Path, rows: usize, metadata: &Metadata) {
    let file = hdf5::File::open(path).unwrap();
    let units = Units { length: "mm".into(), mass: "Mg".into(), time: "s".into() };
    // And static shapes.
    let modes = file.dataset("body/frequencies").unwrap().size();
    assert!(modes > 6);
    let mut paths = Vec::new();
    for column in COLUMNS.iter().filter(|column| column.part.is_some() && column.scope() != Scope::Joint) {
        let path = column.path();
        assert!(file.dataset(&path).is_err(), "{path}: the ring has no part of it");
    }
    for history in histories(&COLUMNS, metadata) {
        let (column, path) = (history.column, history.path(metadata));
        let dataset = file.dataset(&path).unwrap();
        let shape: Vec<usize> = std::iter::once(rows).chain(history.row_shape(metadata)).collect();
        assert_eq!(dataset.shape(), shape, "{path}");
        assert!(dataset.read_raw::<f64>().unwrap().iter().all(|value| value.is_finite()), "{path}");
        let text = |name: &str| dataset.attr(name).unwrap().read_scalar::<VarLenUnicode>().unwrap().to_string();
        assert_eq!(text("unit"), column.unit(&units), "{path}");
        assert_eq!([text("frame"), text("description")], [column.frame, column.description], "{path}");
        paths.push(path);
    }
    for (path, unit, frame) in [
        ("attitude", "1", "body to global"),
        ("angular_acceleration", "rad/s^2", "body"),
        ("modal/displacement", "mm Mg^(1/2)", "none"),
        ("modal/velocity", "mm Mg^(1/2)/s", "none"),
        ("energy/balance", "Mg mm^2/s^2", "none"),
        ("momentum/linear_balance", "Mg mm/s", "global"),
        ("momentum/angular_balance", "Mg mm^2/s", "global"),
        ("points/rigid_acceleration", "mm/s^2", "global"),
    ] {
        let text = |name: &str| file.dataset(path).unwrap().attr(name).unwrap().read_scalar::<VarLenUnicode>().unwrap();
        assert_eq!((text("unit").as_str(), text("frame").as_str()), (unit, frame), "{path}");
    }
    let mut found = Vec::new();
    datasets(&file, &mut found);
    let mut found: Vec<_> = found.iter().map(|path| path[1..].to_owned()).collect();
    let about = ["time", "warnings", "input_files", "bodies/body/points/names", "bodies/body/points/position"];
    found.retain(|path| {
        let is_of_model = ["model", "effects"].iter().any(|group| path.starts_with(&format!("bodies/body/{group}/")));
        (path.starts_with("bodies/") || path.starts_with("system/")) && !about.contains(&path.as_str()) && !is_of_model
    });
    found.sort();
    found.dedup();
    paths.sort();
    assert_eq!(found, paths);
}

/// Paths of all data sets within a group.
fn datasets(group: &hdf5::Group, out: &mut Vec<String>) {
    out.extend(group.datasets().unwrap().iter().map(|dataset| dataset.name()));
    group.groups().unwrap().iter().for_each(|group| datasets(group, out));
}

/// Closed form: the momentum is the impulse of a half sine, 2FT/π.
#[test]
fn another_mesh_runs_and_its_file_holds_all_that_is_promised() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().to_str().unwrap();
    let report = json(&["run", "examples/ring.toml", "-o", out]);
    let path = folder.path().join("ring.h5");
    let results = Results::open(&path, &COLUMNS).unwrap();
    assert_describes_its_columns(&path, 2001, &results.metadata);
    assert!(results.complete);
    assert_eq!(results.rows(), 2001);
    assert_eq!(report["rows"], 2001);
    assert!((results.numbers("time").unwrap()[2000] - 0.2).abs() < 1e-15);
    assert_eq!(results.metadata.scheme, "exponential");
    assert_eq!(results.metadata.scene_text, std::fs::read_to_string(root().join("examples/ring.toml")).unwrap());
    // Impulse = momentum: 200 N x 2/pi x 2 ms along (0, -1, 0.5) normalised.
    let impulse = 200.0 * 2.0 / std::f64::consts::PI * 0.002;
    let direction = [0.0, -1.0 / 1.25_f64.sqrt(), 0.5 / 1.25_f64.sqrt()];
    let momentum = results.vectors::<3>("momentum/linear").unwrap()[2000];
    for axis in 0..3 {
        assert!((momentum[axis] - impulse * direction[axis]).abs() < 1e-9 * impulse, "{momentum:?}");
    }
    assert!(
        results
            .vectors::<4>("attitude")
            .unwrap()
            .iter()
            .all(|q| (q.iter().map(|c| c * c).sum::<f64>() - 1.0).abs() < 1e-14)
    );
}

#[test]
fn a_results_file_is_the_same_byte_for_byte_on_each_run_and_for_any_number_of_threads() {
    let run = |threads: &str| {
        let folder = tempfile::tempdir().unwrap();
        let out = folder.path().to_str().unwrap();
        json(&["run", "examples/ring.toml", "-o", out, "--threads", threads]);
        std::fs::read(folder.path().join("ring.h5")).unwrap()
    };
    let first = run("1");
    for threads in ["1", "2", "3", "8"] {
        assert!(run(threads) == first, "{threads}");
    }
}

#[test]
fn a_scene_flies_as_a_moving_picture() {
    let folder = tempfile::tempdir().unwrap();
    let gif = folder.path().join("ring.gif");
    let animate = |frames: &str, more: &[&str]| {
        let gif = gif.to_str().unwrap();
        let output = flexframe(
            &[&["animate", "examples/ring.toml", "--overwrite", "-o", gif, "--frames", frames], more].concat(),
        );
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
        (std::fs::read(gif).unwrap(), String::from_utf8(output.stdout).unwrap())
    };
    let (whole, said) = animate("5", &[]);
    assert!(whole.starts_with(b"GIF89a"));
    // It turns by 20.6 rad/s for 0.2 s: 1 rad in each of four intervals, 4.1 rad in one.
    assert!(!said.contains("warning"), "{said}");
    let (_, said) = animate("2", &[]);
    assert_says(&said, &["  warning  ", "by up to 0.66 turns from frame to frame", "--frames 4 shows it"]);
    let (part, _) = animate("5", &["--from", "0.05", "--to", "0.0501"]);
    let (from_above, _) = animate("5", &["--view", "z"]);
    let (by_angles, _) = animate("5", &["--view", "-90,90"]);
    assert!(part != whole && from_above != whole && from_above == by_angles);

    for times in [["--from", "0.1", "--to", "0.1"], ["--from", "-0.1", "--to", "0.1"], ["--from", "0", "--to", "0.3"]] {
        let gif = gif.to_str().unwrap();
        let message = refused(2, &[&["animate", "examples/ring.toml", "--overwrite", "-o", gif], &times[..]].concat());
        assert_says(&message, &["--from", times[3], "from 0 to 0.2"]);
    }
}

/// Conserved: the linear momentum stays m V.
#[test]
fn the_tumbling_plate_turns_and_swings() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().to_str().unwrap();
    let report = json(&["run", "examples/tumbling_plate.toml", "-o", out]);
    let results = Results::open(folder.path().join("tumbling_plate.h5"), &COLUMNS).unwrap();
    assert_eq!(report["steps"], 20000);
    // Without loads the linear momentum stays m V to rounding.
    let last = results.vectors::<3>("momentum/linear").unwrap().last().unwrap();
    for (p, v) in last.iter().zip([400.0, 0.0, 250.0]) {
        assert!((p - 0.00935 * v).abs() < 1e-11, "{last:?}");
    }
    // It swings by centimetres.
    let peak = results.table("modal/displacement").unwrap().column(0).unwrap().fold(0.0_f64, |m, q| m.max(q.abs()));
    assert!(peak > 1.0, "{peak}");
}

/// A rigid body: a scene that takes no time.
pub const COIN: &str = r#"
title = "Coin"
units = { length = "m", mass = "kg", time = "s" }
[body.rigid]
mass = 2.0
center_of_mass = [0.0, 0.0, 0.0]
inertia = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.8]]
[initial]
angular_velocity = [0.1, 0.0, 5.0]
[time]
end = 0.1
step = 1e-2
"#;

/// Standard error of a command that is to be refused with the exit code given.
fn refused(code: i32, arguments: &[&str]) -> String {
    let output = flexframe(arguments);
    let message = String::from_utf8(output.stderr).unwrap();
    assert_eq!(output.status.code(), Some(code), "{message}");
    assert!(output.stdout.is_empty());
    message
}

#[track_caller]
fn assert_says(message: &str, words: &[&str]) {
    for word in words {
        assert!(message.contains(word), "{word} in: {message}");
    }
}

#[test]
fn a_dot_in_the_name_of_a_scene_stays_in_those_of_its_results() {
    let folder = tempfile::tempdir().unwrap();
    let place = |name: &str| folder.path().join(name).to_str().unwrap().to_owned();
    let first = place("coin.h5");
    for (scene, file) in [("coin.toml", "coin.h5"), ("coin.v2.toml", "coin.v2.h5")] {
        std::fs::write(place(scene), COIN).unwrap();
        let report = json(&["run", &place(scene), "-o", folder.path().to_str().unwrap()]);
        assert_eq!(report["results"], place(file));
        assert!(Results::open(place(file), &COLUMNS).unwrap().complete);
    }
    assert!(Results::open(first, &COLUMNS).unwrap().metadata.scene_file.ends_with("coin.toml"));
    std::fs::write(place("coin.v2.part.h5"), "").unwrap();
    let message = refused(6, &["run", &place("coin.v2.toml"), "-o", folder.path().to_str().unwrap()]);
    assert_says(&message, &["coin.v2.part.h5"]);
    assert_says(&refused(3, &["resume", "--overwrite", &place("coin.v2.h5")]), &["coin.v2.part.h5"]);
}

#[test]
fn an_animation_replaces_no_file_that_is_no_gif_and_says_what_keeps_it_from_being_written() {
    let folder = tempfile::tempdir().unwrap();
    let text = std::fs::read_to_string(root().join("examples/ring.toml")).unwrap();
    let text = text.replace("../meshes", root().join("meshes").to_str().unwrap());
    let scene = folder.path().join("self.toml");
    std::fs::write(&scene, &text).unwrap();
    let scene = scene.to_str().unwrap();
    for (output, words) in [(scene, "read by the command"), ("scene", "ends in .gif"), ("scene.png", "ends in .gif")] {
        assert_says(&refused(2, &["animate", scene, "-o", output]), &[output, words]);
    }
    assert_eq!(std::fs::read_to_string(scene).unwrap(), text);
    let nowhere = folder.path().join("no_folder/ring.GIF");
    let message = refused(6, &["animate", scene, "-o", nowhere.to_str().unwrap(), "--frames", "2"]);
    assert_says(&message, &["no_folder/ring.GIF", "there is no folder", "make the folder"]);
    assert!(!message.contains("IOError"), "{message}");
}

#[test]
fn arguments_beyond_all_bounds_are_refused() {
    let cases: [(&[&str], &[&str]); 13] = [
        (&["cost", "SCENE", "--patience", "1e20"], &["--patience", "from 0.001 to 1000000"]),
        (&["cost", "SCENE", "--patience", "1e18"], &["--patience", "from 0.001 to 1000000"]),
        (&["cost", "SCENE", "--patience", "1e-300"], &["--patience", "from 0.001 to 1000000"]),
        (&["cost", "SCENE", "--patience", "nan"], &["--patience", "from 0.001 to 1000000"]),
        (&["animate", "SCENE", "-o", "a.gif", "--frames", "100000000000"], &["--frames", "2..=10000"]),
        (&["animate", "SCENE", "-o", "a.gif", "--magnify", "nan"], &["--magnify", "a finite number"]),
        (&["animate", "SCENE", "-o", "a.gif", "--magnify", "-inf"], &["--magnify", "a finite number"]),
        (&["animate", "SCENE", "-o", "a.gif", "--view", "w"], &["--view", "x, y, z, -x, -y, -z, or two angles"]),
        (&["animate", "SCENE", "-o", "a.gif", "--view", "10,95"], &["--view", "from -90 to 90"]),
        (&["run", "SCENE", "--threads", "65535"], &["--threads", "1..=256"]),
        (&["run", "SCENE", "--threads", "0"], &["--threads", "1..=256"]),
        (&["cost", "SCENE", "--target", "0"], &["--target", "a positive number"]),
        (&["cost", "SCENE", "--target", "inf"], &["--target", "a positive number"]),
    ];
    for (arguments, says) in cases {
        assert_says(&refused(2, arguments), says);
    }
    let ring = "examples/ring.toml";
    let message = refused(2, &["campbell", ring, "--axis", "z", "--speeds", "0:100:1000000000000"]);
    assert_says(&message, &["speeds 0:100:1000000000000", "a count of 2 to 10000"]);
}

#[test]
fn a_refusal_is_where_the_fault_is() {
    let folder = tempfile::tempdir().unwrap();
    let coin = folder.path().join("coin.toml");
    std::fs::write(&coin, COIN).unwrap();
    let coin = coin.to_str().unwrap();
    let message = refused(3, &["campbell", coin, "--axis", "z", "--speeds", "0:100:3"]);
    assert_says(&message, &["coin.toml:4:", "`body.rigid`", "without flexible modes", "give the body a mesh"]);
    let ring = "examples/ring.toml";
    for command in
        [&["modes", ring, "-n", "100000"][..], &["campbell", ring, "-n", "100000", "--axis", "z", "--speeds", "0:1:2"]]
    {
        let message = refused(2, command);
        assert_says(&message, &["--flexible: found 100000, expected at most 6105", "ask for fewer modes"]);
        assert!(!message.contains("ring.toml"), "{message}");
    }
    let rigid = flexframe(&["modes", coin]);
    assert_says(&String::from_utf8(rigid.stdout).unwrap(), &["together 0.00 s"]);
}

#[test]
fn what_is_wrong_is_said_with_file_line_key_and_help() {
    let folder = tempfile::tempdir().unwrap();
    let text = std::fs::read_to_string(root().join("examples/ring.toml")).unwrap();
    let refused = |from: &str, to: &str| -> String {
        assert!(text.contains(from));
        let path = folder.path().join("scene.toml");
        let mesh = root().join("meshes/ring.msh");
        std::fs::write(&path, text.replace("../meshes/ring.msh", mesh.to_str().unwrap()).replace(from, to)).unwrap();
        let output = flexframe(&["run", path.to_str().unwrap(), "-o", folder.path().to_str().unwrap()]);
        let code = if to.contains("rkmk4") { 4 } else { 3 };
        assert_eq!(output.status.code(), Some(code));
        assert!(output.stdout.is_empty());
        String::from_utf8(output.stderr).unwrap()
    };
    let cases: [(&str, &str, &[&str]); 6] = [
        ("tolerance = 1e-6", "stepp = 2e-5", &["scene.toml:26", "stepp", "did you mean `step`"]),
        ("tolerance = 1e-6", "step = -2e-5", &["scene.toml:26", "time.step", "-2e-5"]),
        (
            "tolerance = 1e-6",
            "scheme = \"rkmk4\"\nstep = 1e-3",
            &["scene.toml:27", "time.step", "stability limit", "mode", "at most"],
        ),
        ("at = [0.0, 100.0, 10.0]", "at = [0.0, 150.0, 10.0]", &["loads[0].at", "not on the body", "50."]),
        ("flexible = 6", "flexible = 100000", &["modes.flexible", "at most 6105"]),
        ("poisson_ratio = 0.3", "poisson_ratio = 0.5", &["body.material.poisson_ratio", "0.5"]),
    ];
    for (from, to, words) in cases {
        let message = refused(from, to);
        for word in words {
            assert!(message.contains(word), "{word} in: {message}");
        }
    }
    let missing = flexframe(&["run", "no_such_scene.toml"]);
    assert_eq!(missing.status.code(), Some(6));
    assert!(String::from_utf8_lossy(&missing.stderr).contains("no_such_scene.toml"));
}

#[test]
fn it_says_its_name_and_version() {
    let output = flexframe(&["--version"]);
    assert_eq!(String::from_utf8(output.stdout).unwrap(), concat!("flexframe ", env!("CARGO_PKG_VERSION"), "\n"));
    let changes = include_str!("../../../CHANGELOG.md").lines().find_map(|line| line.strip_prefix("## ")).unwrap();
    assert!(changes.starts_with(concat!(env!("CARGO_PKG_VERSION"), " – ")), "{changes}");
}
