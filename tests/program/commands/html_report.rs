//! `flexframe report`: the page shows the motion that is in the results file.

#[path = "../../../crates/report/tests/data/mod.rs"]
mod page_data;

use std::path::Path;

use flexframe::columns::COLUMNS;
use flexframe::fem_tet10::von_mises;
use flexframe::html_report;
use flexframe::model::{Builder, Needs};
use flexframe::scene::Body;
use live::{BODY_NUMBERS, LiveRun, Player};
use nalgebra::{Quaternion, UnitQuaternion, Vector3};
use page_data::bytes;
use results::Results;
use serde_json::Value;

use crate::program::{done, flexframe};

/// The data of a page in a file.
fn data(page: &Path) -> Value {
    page_data::data(&std::fs::read_to_string(page).unwrap())
}

fn numbers(list: &Value) -> Vec<f64> {
    let bytes = bytes(list);
    let factor = list["factor"].as_f64().unwrap();
    match list["type"].as_str().unwrap() {
        "f64" => bytes.as_chunks().0.iter().map(|b| f64::from_le_bytes(*b)).collect(),
        "f32" => bytes.as_chunks().0.iter().map(|b| f64::from(f32::from_le_bytes(*b))).collect(),
        "i16" => bytes.as_chunks().0.iter().map(|b| factor * f64::from(i16::from_le_bytes(*b))).collect(),
        other => panic!("{other}"),
    }
}

fn vectors<const N: usize>(list: &Value) -> Vec<[f64; N]> {
    numbers(list).as_chunks().0.to_vec()
}

/// Where the page draws the vertex nearest to a point of the mesh, less where it was at first: the displacement of the
/// point in the results file, but for the precision of the page.
fn follows_the_point(scene: &str, point: &str, place: [f64; 3]) {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().to_str().unwrap();
    done(&["run", &format!("examples/{scene}.toml"), "-o", out]);
    let file = folder.path().join(format!("{scene}.h5"));
    done(&["report", file.to_str().unwrap()]);
    let results = Results::open(&file, &COLUMNS).unwrap();
    let page = data(&file.with_extension("html"));

    let times = numbers(&page["times"]);
    let body = &page["bodies"][0];
    let vertices: Vec<[f64; 3]> = vectors(&body["surface"]["vertices"]);
    let origins: Vec<[f64; 3]> = vectors(&body["motion"]["origins"]);
    let attitudes: Vec<[f64; 4]> = vectors(&body["motion"]["attitudes"]);
    let coordinates = numbers(&body["motion"]["coordinates"]);
    let shapes: Vec<Vec<[f64; 3]>> =
        body["shapes"].as_array().unwrap().iter().map(|shape| vectors(&shape["displacement"])).collect();
    let drawn = |row: usize, vertex: usize| {
        let [w, x, y, z] = attitudes[row];
        let q = &coordinates[row * shapes.len()..(row + 1) * shapes.len()];
        let u: Vector3<f64> = shapes.iter().zip(q).map(|(shape, q)| Vector3::from(shape[vertex]) * *q).sum();
        let turned = UnitQuaternion::from_quaternion(Quaternion::new(w, x, y, z));
        Vector3::from(origins[row]) + turned * (Vector3::from(vertices[vertex]) + u)
    };
    // The undeformed body at t = 0 is where the mesh is: the origin tells where that is in body axes.
    let displacements = results.vectors::<3>(&format!("points/{point}/displacement")).unwrap();
    let stored = results.numbers("time").unwrap();
    let at_start = |vertex: usize| drawn(0, vertex) - Vector3::from(displacements[0]);
    let distance = |vertex: &usize| (at_start(*vertex) - Vector3::from(place)).norm();
    let vertex = (0..vertices.len()).min_by(|a, b| distance(a).total_cmp(&distance(b))).unwrap();
    let size = vertices.iter().map(|v| Vector3::from(*v).norm()).fold(0.0, f64::max);
    assert!(distance(&vertex) < 1e-5 * size, "the nearest vertex is {} away", distance(&vertex));

    let mut moved: f64 = 0.0;
    for (row, time) in times.iter().enumerate() {
        let now = Vector3::from(displacements[stored.iter().position(|t| t == time).unwrap()]);
        let error = (drawn(row, vertex) - Vector3::from(place) - now).norm();
        moved = moved.max(now.norm());
        assert!(error < 2e-5 * (size + now.norm()), "row {row}: {error}");
    }
    assert!(moved > 1e-3 * size, "{moved}");

    // The von Mises stress there, which the shader makes of the stress of the shapes.
    let fields = &body["stress"];
    assert_eq!(fields["unit"], "MPa");
    let stresses: Vec<Vec<[f64; 6]>> = fields["shapes"].as_array().unwrap().iter().map(vectors).collect();
    let index = |value: &Value| value.as_u64().unwrap() as usize;
    let products: Vec<[usize; 2]> =
        fields["products"].as_array().unwrap().iter().map(|pair| [index(&pair[0]), index(&pair[1])]).collect();
    assert_eq!(stresses.len(), shapes.len() + products.len());
    let scene = Body::parse(&results.metadata.scene_text, &results.metadata.scene_file).unwrap();
    let builder = Builder::default().needing(Needs { stress_field: true, ..Needs::default() });
    let model = builder.build(&scene, |_| ()).unwrap();
    let stress = model.stress.as_ref().unwrap();
    let (node, _) = model.meshed.as_ref().unwrap().mesh.nearest_node(place);
    let (mut peak, mut worst): (f64, f64) = (0.0, 0.0);
    for (row, time) in times.iter().enumerate() {
        let q = &coordinates[row * shapes.len()..(row + 1) * shapes.len()];
        let products = products.iter().map(|[j, k]| q[*j] * q[*k]);
        let mut sum = [0.0; 6];
        for (shape, q) in stresses.iter().zip(q.iter().copied().chain(products)) {
            sum.iter_mut().zip(shape[vertex]).for_each(|(sum, s)| *sum += s * q);
        }
        let stored = stored.iter().position(|t| t == time).unwrap();
        let modal = results.table("modal/displacement").unwrap().row(stored).unwrap();
        let now = von_mises(&stress.in_coordinates(node, &stress.coordinates(modal)));
        peak = peak.max(now);
        worst = worst.max((von_mises(&sum) - now).abs());
    }
    let legend = fields["peak"].as_f64().unwrap();
    assert!(peak > 0.0 && legend >= peak * (1.0 - 1e-6), "{peak} {legend}");
    // The shapes are rounded to 1.6e-5 of their own peaks.
    assert!(worst < 2e-4 * legend, "{worst} {legend}");
    assert!(std::fs::metadata(file.with_extension("html")).unwrap().len() < 4_000_000);
}

/// Conserved: displacement and stress of a point are those of the run. The corner is a node, so that the point is a
/// vertex.
#[test]
fn the_page_moves_a_free_body_as_the_run_did() {
    follows_the_point("plate", "P3", [500.0, 25.0, 0.0]);
}

#[test]
fn the_page_opens_on_the_motion_of_a_point_in_units_of_si() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().to_str().unwrap();
    let short = ["--set", "time.end=0.004", "--set", "output.stress=true", "-o", out];
    done(&[&["run", "examples/ring.toml"], &short[..]].concat());
    let file = folder.path().join("ring.h5");
    done(&["report", file.to_str().unwrap()]);
    let page = data(&file.with_extension("html"));

    let histories = page["histories"].as_array().unwrap();
    let text = |history: &Value, key: &str| history[key].as_str().unwrap().to_owned();
    assert_eq!(text(&histories[0], "group"), "point struck");
    assert_eq!(text(&histories[0], "name"), "displacement (global)");
    assert!(text(histories.last().unwrap(), "name").starts_with("attitude"), "{:?}", histories.last());
    let unit_of = |name: &str| {
        let history = histories.iter().find(|history| text(history, "name") == name);
        text(history.unwrap_or_else(|| panic!("{name} in {histories:?}")), "unit")
    };
    assert_eq!(unit_of("von mises stress"), page["bodies"][0]["stress"]["unit"]);
    assert_eq!(["kinetic", "linear (global)", "angular (global)"].map(unit_of), ["mJ", "N s", "N mm s"]);
    let balances = page["balances"].as_array().unwrap();
    assert_eq!(balances.iter().map(|balance| text(balance, "unit")).collect::<Vec<_>>(), ["mJ", "N s", "N mm s"]);

    // An axis is longer than rounding and shorter than what moves.
    for history in histories.iter().filter(|history| !history["unit"].as_str().unwrap().is_empty()) {
        let greatest = |history: &Value| {
            let components = history["components"].as_array().unwrap().iter();
            components.flat_map(|component| numbers(&component["values"])).fold(0.0, |most, x| x.abs().max(most))
        };
        let alike = histories.iter().filter(|other| other["unit"] == history["unit"]).map(greatest).fold(0.0, f64::max);
        let least = history["least_range"].as_f64().unwrap();
        assert!(least >= 0.99e-12 * alike && least < 1e-8 * alike, "{}: {least} {alike}", history["name"]);
    }
}

/// Conserved: displacements of a point are those of the run. Its nodes may turn, so that a node has six numbers in a
/// shape.
#[test]
fn a_body_of_matrices_is_drawn_by_its_nodes_which_move_as_the_run_did() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().to_str().unwrap();
    done(&["run", "examples/boom.toml", "--set", "time.end=1.0", "-o", out]);
    let file = folder.path().join("boom.h5");
    done(&["report", file.to_str().unwrap()]);
    let page = data(&file.with_extension("html"));

    let body = &page["bodies"][0];
    let vertices: Vec<[f64; 3]> = vectors(&body["surface"]["vertices"]);
    assert_eq!(vertices.len(), 9);
    assert!(bytes(&body["surface"]["triangles"]).is_empty());
    let camera = vertices.iter().position(|x| *x == [6.0, 0.0, 0.0]).unwrap();
    let shapes: Vec<Vec<[f64; 3]>> =
        body["shapes"].as_array().unwrap().iter().map(|shape| vectors(&shape["displacement"])).collect();
    let coordinates = numbers(&body["motion"]["coordinates"]);
    let results = Results::open(&file, &COLUMNS).unwrap();
    let elastic = results.vectors::<3>("points/camera/elastic_displacement_body").unwrap();
    assert_eq!(coordinates.len(), elastic.len() * shapes.len());
    let greatest = elastic.iter().map(|u| Vector3::from(*u).norm()).fold(0.0, f64::max);
    for (q, expected) in coordinates.chunks(shapes.len()).zip(elastic) {
        let u: Vector3<f64> = shapes.iter().zip(q).map(|(shape, q)| Vector3::from(shape[camera]) * *q).sum();
        assert!((u - Vector3::from(*expected)).norm() < 1e-4 * greatest, "{u} {expected:?}");
    }
    assert!(greatest > 1e-3);
}

/// The run of a live page, led natively to each row of a results file: all that the two have in common, to the last bit where `exact`.
fn is_led_to_the_rows(scene: &str, exact: bool) {
    let folder = tempfile::tempdir().unwrap();
    done(&["run", scene, "--no-check", "-o", folder.path().to_str().unwrap()]);
    let file = folder.path().join(Path::new(scene).with_extension("h5").file_name().unwrap());
    let page = html_report::live_contents(&file, &Builder::default(), |_| ()).unwrap();
    let live = page.live.unwrap();
    assert!(live.controls.iter().any(|control| control.name == "gravity"));
    let run = LiveRun::from_bytes(&live.run).unwrap();
    let results = Results::open(&file, &COLUMNS).unwrap();
    let times = results.numbers("time").unwrap();
    let mut player = Player::new(run, times[1]).unwrap();
    for (row, time) in times.iter().enumerate() {
        player.lead_to(*time).unwrap();
        let mut first = 1;
        for (number, body) in results.bodies().enumerate() {
            let numbers = &player.numbers()[first..first + BODY_NUMBERS];
            first += BODY_NUMBERS + player.coordinates(number);
            let (origin, attitude) =
                (body.vectors::<3>("origin").unwrap()[row], body.vectors::<4>("attitude").unwrap()[row]);
            let kinetic = body.table("energy/kinetic").unwrap().row(row).unwrap()[0];
            let expected = origin.iter().chain(&attitude).chain([&kinetic]);
            for (found, expected) in numbers[..7].iter().chain([&numbers[10]]).zip(expected) {
                let is_same =
                    if exact { found == expected } else { (found - expected).abs() < 1e-9 * expected.abs().max(1.0) };
                assert!(is_same, "{scene}, row {row}, body {number}: {found} {expected}");
            }
        }
    }
    assert!(player.is_recorded());
}

/// Conserved: the numbers of the results file, by the run that a live page has.
#[test]
fn a_live_page_has_the_run_of_its_file() {
    is_led_to_the_rows("tests/bent_rod.toml", true);
    is_led_to_the_rows("tests/chain.toml", false); // rows within steps, whose times differ by rounding
}

#[test]
fn a_live_page_of_what_a_page_cannot_step_is_refused_by_name() {
    let folder = tempfile::tempdir().unwrap();
    let scene = ["--set", "time.scheme=paper", "--set", "time.end=1e-3"];
    let out = folder.path().to_str().unwrap();
    done(&[&["run", "examples/tumbling_plate.toml", "--no-check", "-o", out][..], &scene].concat());
    let file = folder.path().join("tumbling_plate.h5");
    let refused = flexframe(&["report", file.to_str().unwrap(), "--live"]);
    let words = String::from_utf8_lossy(&refused.stderr);
    assert!(
        !refused.status.success() && words.contains("no live page") && words.contains("formulation paper"),
        "{words}"
    );
}

/// Two runs on one page: the second is shorter, and starts with another velocity.
#[test]
fn another_run_is_compared_where_both_have_the_time() {
    let folder = tempfile::tempdir().unwrap();
    let place = |name: &str| folder.path().join(name).to_str().unwrap().to_owned();
    let run = |to: &str, end: &str, more: &[&str]| {
        let set = format!("time.end={end}");
        let arguments = ["run", "examples/ring.toml", "--no-check", "-o", to, "--set", &set];
        done(&[&arguments[..], more].concat());
    };
    run(&place("a"), "0.02", &[]);
    run(&place("b"), "0.01", &["--set", "modes.damping_ratio=0.2"]);
    let [a, b] = ["a/ring.h5", "b/ring.h5"].map(place);
    let page = place("page.html");
    done(&["report", &a, "--compare", &b, "-o", &page]);
    let page = data(Path::new(&page));

    let times = numbers(&page["history_times"]);
    assert!((times[times.len() - 1] - 0.01).abs() < 1e-9);
    let warnings = page["warnings"].to_string();
    assert!(warnings.contains("compared from 0 to 0.01 s"), "{warnings}");
    // Closed form: each difference is that of its two courses, up to single precision.
    let histories = page["histories"].as_array().unwrap();
    let pairs = histories.windows(2).filter(|pair| {
        pair[1]["name"].as_str().unwrap() == format!("{}: difference", pair[0]["name"].as_str().unwrap())
    });
    let (mut compared, mut differ) = (0, 0);
    for pair in pairs {
        let components = |of: &Value| of["components"].as_array().unwrap().clone();
        let (both, differences) = (components(&pair[0]), components(&pair[1]));
        assert_eq!(both.len(), 2 * differences.len());
        for (i, difference) in differences.iter().enumerate() {
            let [own, other] = [i, i + differences.len()].map(|k| numbers(&both[k]["values"]));
            for ((own, other), found) in own.iter().zip(&other).zip(numbers(&difference["values"])) {
                assert!((own - other - found).abs() <= 2e-7 * (own.abs() + other.abs()), "{own} {other} {found}");
                differ += usize::from(found != 0.0);
            }
            compared += 1;
        }
    }
    assert!(compared > 10 && differ > 100, "{compared} {differ}");
    let ghost = &page["compared"];
    assert_eq!(ghost["bodies"].as_array().unwrap().len(), 1);
    assert!((numbers(&ghost["times"]).last().unwrap() - 0.01).abs() < 1e-9);

    let refused = flexframe(&["report", &a, "--compare", "examples/ring.toml", "-o", &place("x.html")]);
    assert_eq!(refused.status.code(), Some(3), "{}", String::from_utf8_lossy(&refused.stderr));
}
