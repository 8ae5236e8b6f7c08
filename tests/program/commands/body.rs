//! The body file and the cache, as users of the program meet them.

use std::fs;
use std::path::Path;
use std::process::Output;

use flexframe::nalgebra::{Quaternion, UnitQuaternion, Vector3};

use crate::program::{command, root};

/// A node of the ring.
const NODE: usize = 100;

/// The program with this folder for its cache; an empty name is none.
fn flexframe(cache: &str, arguments: &[&str]) -> Output {
    command(arguments).env("FLEXFRAME_CACHE", cache).output().unwrap()
}

fn succeeds(cache: &str, arguments: &[&str]) -> (String, String) {
    let output = flexframe(cache, arguments);
    let text = |bytes: &[u8]| String::from_utf8(bytes.to_vec()).unwrap();
    assert!(output.status.success(), "{}", text(&output.stderr));
    (text(&output.stdout), text(&output.stderr))
}

/// A scene of the ring, which spins and is struck, with this body.
fn ring(folder: &Path, body: &str) -> String {
    let text = fs::read_to_string(root().join("examples/ring.toml")).unwrap();
    let mesh = root().join("meshes/ring.msh");
    let text = text.replace("mesh = \"../meshes/ring.msh\"", body).replace("MESH", mesh.to_str().unwrap());
    let path = folder.join("ring.toml");
    fs::write(&path, text.replace("end = 0.2", "end = 0.002")).unwrap();
    path.to_str().unwrap().to_owned()
}

#[test]
fn the_cache_is_used_by_itself_and_the_results_are_the_same_to_the_last_byte() {
    let folder = tempfile::tempdir().unwrap();
    let scene = ring(folder.path(), "mesh = \"MESH\"");
    let cache = folder.path().join("cache");
    let cache = cache.to_str().unwrap();
    let results = |name: &str, more: &[&str]| {
        let out = folder.path().join(name);
        let (_, notes) = succeeds(cache, &[&["run", &scene, "-o", out.to_str().unwrap()], more].concat());
        let (estimate, notes) = notes.split_once('\n').unwrap();
        assert!(estimate.starts_with("run: 21 rows, "), "{estimate}");
        (fs::read(out.join("ring.h5")).unwrap(), notes.to_owned())
    };
    let (direct, notes) = results("direct", &["--no-cache"]);
    assert_eq!(notes, "");
    assert!(!Path::new(cache).exists());
    let (first, notes) = results("first", &[]);
    assert_eq!(notes, "");
    let (second, notes) = results("second", &[]);
    assert!(notes.contains("all parts were read from its file or the cache"), "{notes}");
    assert!(direct == first && first == second);
    // Modes are asked for in another way, but the mesh is the same; the answers are kept, too.
    let (_, notes) = succeeds(cache, &["modes", &scene]);
    assert!(notes.starts_with("note: reduced body:"), "{notes}");
    let (json, notes) = succeeds(cache, &["modes", &scene, "--json"]);
    assert_eq!((notes.as_str(), json.starts_with('{')), ("", true));
    // No folder can be made under a file.
    let file = folder.path().join("file");
    fs::write(&file, "").unwrap();
    let (_, notes) = succeeds(file.to_str().unwrap(), &["modes", &scene]);
    assert!(notes.contains("cannot be written, and what is computed is not kept"), "{notes}");
}

/// Independent reference: displacements and kinetic energy by plain sums over the body file and the results file
/// alone, with the full mass matrix, as h5py has them in docs/reference/body.md.
#[test]
fn a_body_file_gives_back_the_field_and_the_kinetic_energy_of_a_run() {
    let folder = tempfile::tempdir().unwrap();
    let scene = ring(folder.path(), "mesh = \"MESH\"");
    let body = folder.path().join("ring.body.h5");
    let (said, _) = succeeds("", &["reduce", &scene, "-o", body.to_str().unwrap(), "--matrices"]);
    assert!(said.contains("ring.body.h5"), "{said}");
    let body = hdf5::File::open(body).unwrap();
    let of_body = |name: &str| body.dataset(name).unwrap().read_raw::<f64>().unwrap();
    let positions = of_body("mesh/positions");
    // A point of the output that is a node.
    let scene = ring(folder.path(), "file = \"ring.body.h5\"");
    let text = fs::read_to_string(&scene).unwrap();
    let text =
        text.replace("struck = [0.0, 100.0, 10.0]", &format!("struck = {:?}", &positions[3 * NODE..3 * NODE + 3]));
    fs::write(&scene, text).unwrap();
    let out = folder.path().join("out");
    let (_, notes) = succeeds("", &["run", &scene, "-o", out.to_str().unwrap()]);
    assert!(notes.contains("all parts were read from its file or the cache"), "{notes}");

    let run = hdf5::File::open(out.join("ring.h5")).unwrap();
    let indices = |name: &str| body.dataset(name).unwrap().read_raw::<u64>().unwrap();
    let last = |name: &str| {
        let dataset = run.dataset(name).unwrap();
        let rows = dataset.shape()[0];
        let all = dataset.read_raw::<f64>().unwrap();
        all[all.len() - all.len() / rows..].to_vec()
    };
    let shapes = [of_body("modes/shapes"), of_body("static_shapes/shapes")].concat();
    let size = positions.len();
    let field = |q: &[f64]| -> Vec<f64> {
        (0..size).map(|i| q.iter().enumerate().map(|(k, q)| q * shapes[k * size + i]).sum()).collect()
    };
    let (u, rate) = (field(&last("modal/displacement")), field(&last("modal/velocity")));
    assert_eq!(last("modal/displacement").len() * size, shapes.len());
    let vector = |values: &[f64]| Vector3::from_column_slice(values);
    let origin = vector(&of_body("constants/origin"));
    let attitude = last("attitude");
    let turned = UnitQuaternion::from_quaternion(Quaternion::new(attitude[0], attitude[1], attitude[2], attitude[3]));
    let v_origin = turned.inverse() * vector(&last("velocity"));
    let omega = vector(&last("angular_velocity"));
    let velocities: Vec<f64> = (0..size / 3)
        .flat_map(|node| {
            let at = |values: &[f64]| vector(&values[3 * node..3 * node + 3]);
            let v = v_origin + omega.cross(&(at(&positions) - origin + at(&u))) + at(&rate);
            [v.x, v.y, v.z]
        })
        .collect();
    let (data, rows, starts) =
        (of_body("matrices/mass/data"), indices("matrices/mass/indices"), indices("matrices/mass/indptr"));
    let mut energy = 0.0;
    for column in 0..size {
        for entry in starts[column] as usize..starts[column + 1] as usize {
            energy += 0.5 * velocities[column] * data[entry] * velocities[rows[entry] as usize];
        }
    }
    let expected = last("energy/kinetic")[0];
    assert!((energy / expected - 1.0).abs() < 1e-12, "{energy} {expected}");
    // What the body file gives at the node is what the run has.
    let node = NODE;
    let x = vector(&positions[3 * node..3 * node + 3]);
    let moved = vector(&last("position")) + turned * (x - origin + vector(&u[3 * node..3 * node + 3])) - x;
    let told = vector(&last("points/displacement"));
    assert!((moved - told).norm() < 1e-12 * (x.norm() + moved.norm()), "{moved} {told}");
}

/// Files that a geometry includes are known, unless it is free to do what it likes: no body file is made of that. (Needs gmsh.)
#[test]
fn a_mesh_that_takes_in_others_unknown_is_refused_with_the_help() {
    let folder = tempfile::tempdir().unwrap();
    fs::copy(root().join("meshes/ring.geo"), folder.path().join("ring.geo")).unwrap();
    let outer = folder.path().join("outer.geo");
    fs::write(&outer, "Include \"ring.geo\";\n").unwrap();
    let scene = ring(folder.path(), &format!("mesh = {outer:?}"));
    let cache = folder.path().join("cache");
    let file = folder.path().join("ring.body.h5");
    let reduce = || {
        let arguments = ["reduce", &scene, "--trust-geometry", "-o", file.to_str().unwrap()];
        flexframe(cache.to_str().unwrap(), &arguments)
    };
    let output = reduce();
    assert!(output.status.success() && file.exists(), "{}", String::from_utf8_lossy(&output.stderr));
    fs::remove_file(&file).unwrap();
    fs::write(&outer, "SystemCall \"true\";\nInclude \"ring.geo\";\n").unwrap();
    let output = reduce();
    let said = String::from_utf8(output.stderr).unwrap();
    assert_eq!(output.status.code(), Some(3), "{said}");
    for words in ["`body.mesh`", "names others", "gmsh -3 -order 2 -format msh41"] {
        assert!(said.contains(words), "{said}");
    }
    assert!(!file.exists());
}
