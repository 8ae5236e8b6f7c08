//! `flexframe export`: tables, and fields that agree with the modes. VTK itself reads them in `just paraview`.

use std::path::{Path, PathBuf};

use faer::{Mat, Scale};
use flexframe::columns::COLUMNS;
use flexframe::fem_tet10::{self, Materials, StressRecovery};
use flexframe::model::Model;
use flexframe::rigid_kin::Attitude;
use flexframe::row::{BodyRow, Row};
use flexframe::scene::{Body, BodySource};
use nalgebra::Vector3;
use results::{Results, unfinished};

use crate::program::{done, flexframe};

const SCENE: &str = r#"
title = "A pendulum that bends"
units = { length = "m", mass = "kg", time = "s" }
[body]
mesh = "MESH"
material = { young_modulus = 6.9e10, poisson_ratio = 0.3, density = 2766.0 }
[modes]
flexible = 4
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
points = { tip = [8.0, 0.0, 0.0], "half, way" = [4.0, 0.0, 0.0] }
"#;

const RIGID: &str = r#"
title = "A rod"
units = { length = "m", mass = "kg", time = "s" }
[body]
rigid = { mass = 3.0, center_of_mass = [0.0, 0.0, 0.0], inertia = [[0.02, 0.0, 0.0], [0.0, 0.25, 0.0], [0.0, 0.0, 0.25]] }
[time]
end = 0.1
step = 1e-2
"#;

fn refused(arguments: &[&str], code: i32) -> String {
    let output = flexframe(arguments);
    let text = String::from_utf8(output.stderr).unwrap();
    assert_eq!(output.status.code(), Some(code), "{text}");
    text
}

/// The results of a scene in a folder.
fn run(folder: &Path, text: &str) -> PathBuf {
    let mesh = concat!(env!("CARGO_MANIFEST_DIR"), "/../../meshes/wu_haug_beam.msh");
    let scene = folder.join("scene.toml");
    std::fs::write(&scene, text.replace("MESH", mesh)).unwrap();
    done(&["run", scene.to_str().unwrap(), "-o", folder.to_str().unwrap()]);
    folder.join("scene.h5")
}

fn materials(body: &Body) -> Materials {
    match &body.source {
        BodySource::Meshed(meshed) => meshed.materials.clone(),
        BodySource::File(_) | BodySource::Rigid(_) | BodySource::Matrices(_) => unreachable!("the body has a mesh"),
    }
}

fn numbers(line: &str) -> Vec<f64> {
    line.split(',').map(|number| number.parse().unwrap()).collect()
}

/// Independent reference: displacements and stress of the model at its nodes, summed here over shapes and
/// coordinates.
#[test]
fn a_results_file_becomes_a_table_and_fields() {
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name).to_str().unwrap().to_owned();
    let file = run(folder.path(), SCENE);
    let file = file.to_str().unwrap();
    let results = Results::open(file, &COLUMNS).unwrap();
    let count = results.metadata.bodies[0].model.frequencies.len();
    assert!(results.rows() == 21 && results.metadata.bodies[0].model.static_shapes == count - 4 && count > 4);

    // All columns, into a folder; the numbers are the same to the last bit.
    assert!(done(&["export", file, "--csv", &at("tables")]).contains("tables/scene.csv"));
    let table = std::fs::read_to_string(at("tables/scene.csv")).unwrap();
    let mut lines = table.lines();
    let heads = lines.next().unwrap();
    for head in [
        "time [s]",
        "attitude w [1]",
        "modal/displacement 4 [m kg^(1/2)]",
        "modal/displacement 5 static shape [m kg^(1/2)]",
        "hinge/angle [rad]",
        "reaction/force x [kg m/s^2]",
        "points/tip/elastic_displacement_body y [m]",
        "\"points/half, way/displacement z [m]\"",
    ] {
        assert!(heads.contains(head), "{head}: {heads}");
    }
    assert!(!heads.contains("drive/") && !heads.contains("slider/"), "{heads}");
    let rows: Vec<Vec<f64>> = lines.map(numbers).collect();
    assert_eq!(rows.len(), 21);
    let per_row: usize = 1 + 4 + 5 * 3 + 2 * count + 5 + 4 * 3 + 4 * 3 + 2 + 2 * 6 * 3 + 6 + 2 * 3;
    assert!(rows.iter().all(|row| row.len() == per_row), "{} {per_row}", rows[0].len());
    assert_eq!(rows[20][1..5], results.vectors::<4>("attitude").unwrap()[20]);

    // Some columns and rows.
    let some = ["--columns", "hinge/angle,points/tip", "--from", "0.1", "--to", "0.18", "--every", "2"];
    done(&[&["export", file, "--csv", &at("some.csv")][..], &some].concat());
    let table = std::fs::read_to_string(at("some.csv")).unwrap();
    let rows: Vec<Vec<f64>> = table.lines().skip(1).map(numbers).collect();
    assert_eq!(rows.iter().map(|row| row.len()).collect::<Vec<_>>(), [20; 5]);
    assert!(rows.iter().zip([0.1, 0.12, 0.14, 0.16, 0.18]).all(|(row, time)| (row[0] - time).abs() < 1e-12));
    assert_eq!(rows[0][1], results.numbers("hinge/angle").unwrap()[10]);

    // Fields: shapes times coordinates, the mesh once.
    done(&["export", file, "--vtkhdf", &at("moving.vtkhdf"), "--modes", &at("modes.vtkhdf"), "--every", "4"]);
    let moving = hdf5::File::open(at("moving.vtkhdf")).unwrap();
    let group = moving.group("VTKHDF").unwrap();
    let read = |group: &hdf5::Group, name: &str| group.dataset(name).unwrap().read_raw::<f64>().unwrap();
    let integers = |name: &str| group.dataset(name).unwrap().read_raw::<i64>().unwrap();
    assert_eq!(group.attr("Version").unwrap().read_raw::<i64>().unwrap(), [2, 0]);
    let points = read(&group, "Points");
    let n = points.len() / 3;
    assert_eq!((integers("NumberOfPoints"), integers("Steps/PointOffsets")), (vec![n as i64], vec![0; 6]));
    let offsets: Vec<i64> = (0..6).map(|step| step * n as i64).collect();
    assert_eq!(integers("Steps/PointDataOffsets/displacement"), offsets);
    let times = results.numbers("time").unwrap();
    assert_eq!(read(&group, "Steps/Values"), (0..6).map(|step| times[4 * step]).collect::<Vec<_>>());
    // By the points of the results: another way from modes to displacements.
    let body = Body::parse(&results.metadata.scene_text, &results.metadata.scene_file).unwrap();
    let model = Model::build(&body, |_| ()).unwrap();
    let node = (0..n).find(|i| (points[3 * i] - 8.0).abs() < 1e-9).unwrap();
    let place = Vector3::from_column_slice(&points[3 * node..3 * node + 3]);
    let mesh = &model.meshed.as_ref().unwrap();
    let (on_mesh, _) = mesh.mesh.nearest_node(place.into());
    let [displacement, elastic, von_mises] = ["displacement", "elastic_displacement", "von_mises_stress"]
        .map(|name| read(&group, &format!("PointData/{name}")));
    // The stress of the displaced mesh, not that of the modes.
    let recovery = StressRecovery::new(&mesh.mesh, &materials(&body)).unwrap();
    let mut largest: f64 = 0.0;
    for step in 0..6 {
        let coordinates = model.coordinates(results.table("modal/displacement").unwrap().row(4 * step).unwrap());
        let shapes = || mesh.modes.shapes.col_iter().chain(mesh.following.col_iter());
        let u = Vector3::from_fn(|axis, _| {
            shapes().zip(&coordinates).map(|(shape, xi)| xi * shape[3 * on_mesh as usize + axis]).sum::<f64>()
        });
        let first = 3 * (step * n + node);
        let found = Vector3::from_column_slice(&elastic[first..first + 3]);
        // The shapes of the file are in single precision.
        assert!((found - u).norm() < 1e-14 + 1e-6 * u.norm(), "{found} {u}");
        let attitude = Attitude::from_wxyz(results.vectors("attitude").unwrap()[4 * step]).unwrap();
        let moved = attitude.to_global(&(place + u)) - place; // about the hinge, which is at the origin
        let found = Vector3::from_column_slice(&displacement[first..first + 3]);
        assert!((found - moved).norm() < 1e-13 + 1e-6 * u.norm(), "{found} {moved}");
        let field = Mat::from_fn(mesh.modes.shapes.nrows(), 1, |i, _| {
            shapes().zip(&coordinates).map(|(shape, xi)| xi * shape[i]).sum::<f64>()
        });
        // Beyond the first order, ½ε₂(u₁, u₁) of the modes that bend the body, and ε₂(u₁, u₂) of the displacements of first and
        // second order of the large ones.
        let modal = results.table("modal/displacement").unwrap().row(4 * step).unwrap();
        let manifold = model.physics.large_deflection.as_ref().unwrap();
        let large = manifold.large();
        let mut of_second = vec![0.0; coordinates.len()];
        for (product, shape) in manifold.products().iter().zip(manifold.of_products().chunks_exact(coordinates.len())) {
            match product[..] {
                [j, k] if large.contains(&j) && large.contains(&k) => {
                    of_second.iter_mut().zip(shape).for_each(|(xi, shape)| *xi += shape * modal[j] * modal[k]);
                }
                _ => {}
            }
        }
        let in_modes = |modes: &[usize], i| modes.iter().map(|k| modal[*k] * mesh.modes.shapes[(i, *k)]).sum::<f64>();
        let of_bent = Mat::from_fn(field.nrows(), 3, |i, order| match order {
            0 => in_modes(manifold.bent(), i),
            1 => in_modes(large, i),
            _ => shapes().zip(&of_second).map(|(shape, xi)| xi * shape[i]).sum::<f64>(),
        });
        let of_pairs = recovery.second_order_nodal_stress(of_bent.as_ref(), &[[0, 0], [1, 2]]).unwrap();
        let stress = recovery.nodal_stress(field.as_ref()).unwrap()
            + of_pairs.get(.., 0..1)
            + of_pairs.get(.., 1..2) * Scale(2.0);
        let scale = stress.norm_max();
        largest = largest.max(scale);
        for (i, found) in von_mises[step * n..(step + 1) * n].iter().enumerate() {
            let (on_mesh, _) = mesh.mesh.nearest_node([0, 1, 2].map(|axis| points[3 * i + axis]));
            let expected = fem_tet10::von_mises(&[0, 1, 2, 3, 4, 5].map(|c| stress[(6 * on_mesh as usize + c, 0)]));
            assert!((found - expected).abs() <= 1e-5 * scale, "step {step}, point {i}: {found} {expected}");
        }
    }
    assert!(largest > 1e5 && !model.large_modes().is_empty(), "{largest}");
    let modes = hdf5::File::open(at("modes.vtkhdf")).unwrap().group("VTKHDF/PointData").unwrap();
    let names = modes.member_names().unwrap();
    assert_eq!(names.len(), 2 * count);
    // The stress of a mode is that of its displacement.
    let of_first = |name: &&String| name.starts_with("stress of mode 1:") || name.starts_with("stress of mode 01:");
    let found = modes.dataset(names.iter().find(of_first).unwrap()).unwrap().read_2d::<f64>().unwrap();
    let expected = recovery.nodal_stress(mesh.modes.shapes.as_ref().subcols(0, 1)).unwrap();
    assert_eq!(found.dim(), (n, 6));
    // In single precision.
    let scale = expected.norm_max();
    assert!((0..6).all(|c| (found[(node, c)] - expected[(6 * on_mesh as usize + c, 0)]).abs() <= 1e-6 * scale));
    assert!(names.iter().filter(|name| name.starts_with("mode ") && name.ends_with(" Hz")).count() == 4, "{names:?}");
    assert!(names.iter().any(|name| name.starts_with("static shape ") && name.ends_with('5')), "{names:?}");

    // What is there is not replaced unless asked for.
    for arguments in [["--csv", &at("some.csv")], ["--vtkhdf", &at("moving.vtkhdf")]] {
        let text = refused(&[&["export", file][..], &arguments].concat(), 6);
        assert!(text.contains("is there already") && text.contains("--overwrite"), "{text}");
        done(&[&["export", file, "--overwrite"][..], &arguments].concat());
    }
    let text = refused(&["export", file, "--csv", &at("new.csv"), "--columns", "points/nose"], 2);
    assert!(text.contains("no column \"points/nose\"") && text.contains("points/tip/displacement"), "{text}");
    for to in [["--vtkhdf", &at("new.vtkhdf")], ["--csv", &at("new.csv")]] {
        let text = refused(&[&["export", file, "--from", "7"][..], &to].concat(), 2);
        assert!(text.contains("no row") && text.contains("from time 0 to 0.2"), "{text}");
    }
    refused(&["export", file], 2);
    assert!(!Path::new(&at("new.csv")).exists() && !Path::new(&at("new.vtkhdf")).exists());
}

/// Closed form: the edges of the uniform box with a mass and moments of inertia, a² = 6 (J₂ + J₃ − J₁) / m; a bar to the point.
#[test]
fn a_rigid_body_without_a_mesh_is_drawn_as_the_box_of_its_inertia() {
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name).to_str().unwrap().to_owned();
    let file = run(folder.path(), &format!("{RIGID}[output.points]\nnose = [0.0, 0.0, 1.5]\n"));
    let file = file.to_str().unwrap();
    done(&["export", file, "--vtkhdf", &at("moving.vtkhdf")]);
    let points = hdf5::File::open(at("moving.vtkhdf")).unwrap().dataset("VTKHDF/Points").unwrap();
    let points = points.read_raw::<f64>().unwrap();
    let (points, _) = points.as_chunks::<3>();
    // Eight corners of a brick, and a middle on each of its 12 edges and 6 diagonals.
    let (of_box, of_bar) = points.split_at(26);
    assert_eq!(of_bar.len(), 26);
    let largest = |places: &[[f64; 3]]| [0, 1, 2].map(|axis| places.iter().map(|x| x[axis].abs()).fold(0.0, f64::max));
    let expected = [0.96_f64, 0.04, 0.04].map(|square| 0.5 * square.sqrt());
    assert!(largest(of_box).iter().zip(expected).all(|(found, half)| (found - half).abs() < 1e-9));
    assert!((largest(of_bar)[2] - 1.5).abs() < 1e-9);

    done(&["animate", file, "-o", &at("rod.gif"), "--frames", "2"]);
    done(&["report", file, "-o", &at("rod.html")]);
    let page = std::fs::read_to_string(at("rod.html")).unwrap();
    assert!(page.contains("the box of its mass and inertia"));
    let text = refused(&["export", file, "--vtkhdf", &at("inside.vtkhdf"), "--volume"], 3);
    assert!(text.contains("has a surface alone"), "{text}");
}

#[test]
fn what_cannot_be_exported_is_refused_and_an_unfinished_run_is_marked() {
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name).to_str().unwrap().to_owned();
    let file = run(folder.path(), RIGID);
    let file = file.to_str().unwrap();
    let text = refused(&["export", file, "--modes", &at("out")], 3);
    assert!(text.contains("the body has no flexible modes"), "{text}");
    std::fs::write(at("diary.h5"), "a diary").unwrap();
    let text = refused(&["export", &at("diary.h5"), "--csv", &at("out.csv")], 3);
    assert!(text.contains("not a results file"), "{text}");
    assert!(!Path::new(&at("out")).exists() && !Path::new(&at("out.csv")).exists());

    // A run that was cut off after three rows.
    let given = Body::read(at("scene.toml")).unwrap();
    let results = Results::open(file, &COLUMNS).unwrap();
    let part = unfinished(at("cut.h5"));
    let model = Model::build(&given, |_| ()).unwrap();
    let mut writer =
        results::Writer::create(at("cut.h5"), &results.metadata, &[None], &COLUMNS, results::Expected::default())
            .unwrap();
    for now in model.start(&given).unwrap().take(3) {
        let motion = now.unwrap();
        let time = motion.time;
        let body = BodyRow { motion, ..BodyRow::new(&model) };
        writer.push(&Row { time, bodies: vec![body], joints: Vec::new() }).unwrap();
    }
    drop(writer);
    let said = done(&["export", part.to_str().unwrap(), "--csv", &at("cut.csv")]);
    assert!(
        said.contains("the run is unfinished: its rows end at time 0.02, and from time 0 on no check sum covers"),
        "{said}"
    );
    let table = std::fs::read_to_string(at("cut.csv")).unwrap();
    assert!(table.starts_with("# the run is unfinished") && table.lines().count() == 5, "{table}");
}
