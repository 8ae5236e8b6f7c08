//! A results file alone, on another machine: without the mesh, the scene, the cache and gmsh.

use std::fs;
use std::path::Path;
use std::process::Output;

use flexframe::columns::COLUMNS;
use flexframe::run::{RunSettings, run};
use flexframe::scene::Body;
use results::Results;

use crate::program::command_in;

const BEAM: &str = r#"
title = "A beam that bends far"
units = { length = "m", mass = "kg", time = "s" }
[body]
BODY
[modes]
flexible = 4
damping_ratio = 0.01
[[constraints]]
kind = "hinge"
at = [0.0, 0.0, 0.0]
axis = [0.0, 0.0, 1.0]
box = [[0.0, -0.1, -0.1], [0.0, 0.1, 0.1]]
[[loads]]
kind = "gravity"
direction = [0.0, -1.0, 0.0]
amplitude = 9.81
[time]
end = 0.2
step = 1e-3
[output]
every = 10
points = { tip = [8.0, 0.0, 0.0] }
"#;

const MESH: &str = "mesh = \"beam.msh\"\nmaterial = { young_modulus = 6.9e10, poisson_ratio = 0.3, density = 2766.0 }";

/// The program where nothing but the folder is: no other program is found, and nothing was computed before.
fn flexframe(folder: &Path, arguments: &[&str]) -> Output {
    command_in(folder, arguments).env_clear().env("FLEXFRAME_CACHE", "").env("PATH", "").output().unwrap()
}

fn done(folder: &Path, arguments: &[&str]) -> String {
    let output = flexframe(folder, arguments);
    let error = String::from_utf8(output.stderr).unwrap();
    assert!(output.status.success(), "{arguments:?}: {error}");
    String::from_utf8(output.stdout).unwrap() + &error
}

fn refused(folder: &Path, arguments: &[&str], words: &[&str]) {
    let output = flexframe(folder, arguments);
    let error = String::from_utf8(output.stderr).unwrap();
    assert_eq!(output.status.code(), Some(3), "{arguments:?}: {error}");
    assert!(words.iter().all(|word| error.contains(word)), "{error}");
}

/// A folder with the scene of a beam and its mesh.
fn desk(body: &str) -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    let mesh = concat!(env!("CARGO_MANIFEST_DIR"), "/../../meshes/wu_haug_beam.msh");
    fs::copy(mesh, folder.path().join("beam.msh")).unwrap();
    fs::write(folder.path().join("beam.toml"), BEAM.replace("BODY", body)).unwrap();
    folder
}

/// All numbers of a VTKHDF file, by the names of its datasets.
fn numbers(file: &Path) -> Vec<(String, Vec<f64>)> {
    fn add(group: &hdf5::Group, to: &mut Vec<(String, Vec<f64>)>) {
        for inner in group.groups().unwrap() {
            add(&inner, to);
        }
        for dataset in group.datasets().unwrap() {
            to.push((dataset.name(), dataset.read_raw::<f64>().unwrap()));
        }
    }
    let mut found = Vec::new();
    add(&hdf5::File::open(file).unwrap(), &mut found);
    found.sort_by(|a, b| a.0.cmp(&b.0));
    found
}

/// Files that come after a run, made in a folder.
fn what_comes_after(folder: &Path, results: &str) {
    done(folder, &["report", results, "-o", "page.html"]);
    done(folder, &["export", results, "--csv", "table.csv", "--vtkhdf", "moving.vtkhdf", "--modes", "modes.vtkhdf"]);
    done(folder, &["animate", results, "-o", "moving.gif", "--frames", "3"]);
}

/// Conserved: the same bytes and numbers with and without the mesh.
#[test]
fn what_comes_after_a_run_needs_the_results_file_alone() {
    let desk = desk(MESH);
    done(desk.path(), &["run", "beam.toml", "-o", "out"]);
    what_comes_after(desk.path(), "out/beam.h5");
    let elsewhere = tempfile::tempdir().unwrap();
    fs::rename(desk.path().join("out/beam.h5"), elsewhere.path().join("moved.h5")).unwrap();
    let read = |folder: &Path, file: &str| fs::read(folder.join(file)).unwrap();
    let files = ["page.html", "table.csv", "moving.gif"];
    let expected = files.map(|file| read(desk.path(), file));
    let fields = ["moving.vtkhdf", "modes.vtkhdf"].map(|file| numbers(&desk.path().join(file)));
    drop(desk);

    what_comes_after(elsewhere.path(), "moved.h5");
    for (file, expected) in files.iter().zip(expected) {
        assert!(read(elsewhere.path(), file) == expected, "{file}");
    }
    for (file, expected) in ["moving.vtkhdf", "modes.vtkhdf"].iter().zip(fields) {
        assert_eq!(numbers(&elsewhere.path().join(file)), expected, "{file}");
        assert!(expected.iter().any(|(name, numbers)| name.contains("stress") && numbers.iter().any(|s| *s > 1e5)));
    }
}

/// Conserved: points of the volume that are on the surface have the numbers of the surface.
#[test]
fn the_whole_volume_comes_from_the_body_file() {
    let desk = desk(MESH);
    let at = |name: &str| desk.path().join(name);
    done(desk.path(), &["run", "beam.toml", "-o", "out"]);
    let volume = ["export", "out/beam.h5", "--volume", "--vtkhdf", "volume.vtkhdf", "--overwrite"];
    refused(desk.path(), &volume, &["not its inside", "out/beam.body.h5", "flexframe reduce", "--stress"]);

    // Of another body.
    let other = BEAM.replace("BODY", MESH).replace("6.9e10", "7e10");
    fs::write(at("other.toml"), other).unwrap();
    done(desk.path(), &["reduce", "other.toml", "--stress", "-o", "out/beam.body.h5"]);
    refused(desk.path(), &volume, &["does not have the shapes of the run in out/beam.h5", "flexframe reduce"]);

    // Without stress: there is none in the fields, and it is said.
    done(desk.path(), &["reduce", "beam.toml", "-o", "out/beam.body.h5", "--overwrite"]);
    assert!(done(desk.path(), &volume).contains("out/beam.body.h5 has no stress"));
    assert!(numbers(&at("volume.vtkhdf")).iter().all(|(name, _)| !name.contains("stress")));

    // Its points on the surface move as those of the surface do.
    done(desk.path(), &["reduce", "beam.toml", "--stress", "-o", "out/beam.body.h5", "--overwrite"]);
    fs::remove_file(at("beam.msh")).unwrap();
    done(desk.path(), &volume);
    done(desk.path(), &["export", "out/beam.h5", "--vtkhdf", "surface.vtkhdf"]);
    let [inside, outside] = ["volume.vtkhdf", "surface.vtkhdf"].map(|file| numbers(&at(file)));
    let of = |fields: &[(String, Vec<f64>)], path: &str| {
        fields.iter().find(|(name, _)| name.ends_with(path)).unwrap().1.clone()
    };
    let [all, some] = [&inside, &outside].map(|fields| of(fields, "/Points"));
    let (all, some) = (all.as_chunks::<3>().0, some.as_chunks::<3>().0);
    assert!(all.len() > some.len());
    let places: Vec<usize> = some.iter().map(|x| all.iter().position(|y| x == y).unwrap()).collect();
    for (field, width) in [("displacement", 3), ("elastic_displacement", 3), ("von_mises_stress", 1)] {
        let [inside, outside] = [&inside, &outside].map(|fields| of(fields, &format!("/{field}")));
        let steps = outside.len() / (width * some.len());
        assert_eq!(steps, 21);
        // Those of the surface are in single precision.
        let largest = inside.iter().fold(0.0_f64, |largest, x| x.abs().max(largest));
        let is_near = |(a, b): (&f64, &f64)| (a - b).abs() <= 1e-6 * largest;
        for step in 0..steps {
            for (i, place) in places.iter().enumerate() {
                let at = |list: &[f64], points: usize, i: usize| list[width * (step * points + i)..][..width].to_vec();
                let [a, b] = [at(&inside, all.len(), *place), at(&outside, some.len(), i)];
                assert!(a.iter().zip(&b).all(is_near), "{field} at {step}: {a:?} {b:?}");
            }
        }
    }
}

/// A run whose results file does not carry the shapes, as where they are too large for it.
#[test]
fn shapes_that_are_not_in_the_results_file_come_from_the_body_file_that_it_names() {
    let desk = desk(MESH);
    done(desk.path(), &["reduce", "beam.toml", "--stress", "-o", "some.body.h5"]);
    fs::write(desk.path().join("of_body.toml"), BEAM.replace("BODY", "file = \"some.body.h5\"")).unwrap();
    let body = Body::read(desk.path().join("of_body.toml")).unwrap();
    let out = desk.path().join("out");
    run(&body.clone().into(), &out, &RunSettings::default(), |_| ()).unwrap();
    what_comes_after(desk.path(), "out/of_body.h5");
    let with_shapes = fs::metadata(out.join("of_body.h5")).unwrap().len();
    // Rows alone have no trust card.
    let page = |name: &str| {
        let page = fs::read_to_string(desk.path().join(name)).unwrap();
        let (before, rest) = page.split_once("\"trust\":{").unwrap();
        [before, rest.split_once("\"live\":").unwrap().1].concat()
    };
    let expected = page("page.html");

    let settings = RunSettings { overwrite: true, rows_alone: true, ..RunSettings::default() };
    run(&body.clone().into(), &out, &settings, |_| ()).unwrap();
    assert!(fs::metadata(out.join("of_body.h5")).unwrap().len() < with_shapes);
    let metadata = Results::open(out.join("of_body.h5"), &COLUMNS).unwrap().metadata;
    assert!(metadata.bodies[0].model.mesh.as_ref().unwrap().body_file.ends_with("some.body.h5"));
    done(desk.path(), &["report", "out/of_body.h5", "-o", "page.html", "--overwrite"]);
    assert!(page("page.html") == expected);

    // Beside the results file as well.
    fs::rename(desk.path().join("some.body.h5"), out.join("some.body.h5")).unwrap();
    done(desk.path(), &["report", "out/of_body.h5", "-o", "page.html", "--overwrite"]);
    assert!(page("page.html") == expected);
    fs::remove_file(out.join("some.body.h5")).unwrap();
    for arguments in [
        ["report", "out/of_body.h5", "-o", "p.html"],
        ["animate", "out/of_body.h5", "-o", "p.gif"],
        ["export", "out/of_body.h5", "--vtkhdf", "p.vtkhdf"],
    ] {
        let words =
            ["more shapes than a results file carries", "some.body.h5 and out/some.body.h5", "flexframe reduce"];
        refused(desk.path(), &arguments, &words);
    }
    // The rows need none.
    done(desk.path(), &["export", "out/of_body.h5", "--csv", "table.csv", "--overwrite"]);
}
