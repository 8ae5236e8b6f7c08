//! Pages from plain data: what is in them, how large they are, and what is refused.

mod data;

use data::{bytes, data};
use report::{
    Component, PageBalance, PageBody, PageHistory, PageMotion, PageStress, PageSurface, PageUnits, RunPage, RunState,
    SceneText, Shape, ShapeKind, Trust, html, write,
};
use serde_json::Value;

/// A flat strip of vertices, on which every shape is a wave.
fn strip(vertices: usize, modes: usize, rows: usize, components: usize) -> RunPage {
    let wave = |k: usize, i: usize| ((k + 1) as f64 * i as f64 / vertices as f64).sin() as f32;
    let shape = |k: usize| Shape {
        name: format!("mode {}", k + 1),
        kind: ShapeKind::Natural { frequency: 10.0 * (k + 1) as f64, damping_ratio: 0.01 },
        displacement: (0..vertices).map(|i| [0.0, 0.0, wave(k, i)]).collect(),
    };
    let times: Vec<f64> = (0..rows).map(|row| 1e-4 * row as f64).collect();
    let course =
        |name: &str| Component { name: name.to_owned(), values: times.iter().map(|t| (50.0 * t).sin()).collect() };
    let history = |i: usize| PageHistory {
        group: format!("point {i}"),
        name: "displacement".to_owned(),
        unit: "mm".to_owned(),
        least_range: 1e-9,
        components: vec![course("x")],
    };
    RunPage {
        title: "strip".to_owned(),
        program: "test".to_owned(),
        state: RunState::Complete,
        units: PageUnits { length: "mm".to_owned(), time: "s".to_owned(), frequency: "Hz".to_owned() },
        facts: Vec::new(),
        bodies: vec![PageBody {
            name: "body".to_owned(),
            facts: Vec::new(),
            surface: Some(PageSurface {
                vertices: (0..vertices).map(|i| [i as f32, (i % 2) as f32, 0.0]).collect(),
                triangles: (2..vertices as u32).map(|i| [i - 2, i - 1, i]).collect(),
                edges: vec![[0, 1]],
            }),
            shapes: (0..modes).map(shape).collect(),
            stress: Some(PageStress {
                unit: "MPa".to_owned(),
                shapes: (0..modes)
                    .map(|k| (0..vertices).map(|i| [wave(k, i), 0.0, 0.0, 0.0, 0.0, 0.0]).collect())
                    .collect(),
                products: Vec::new(),
            }),
            motion: PageMotion {
                origins: vec![[0.0; 3]; rows],
                attitudes: vec![[1.0, 0.0, 0.0, 0.0]; rows],
                coordinates: times.iter().flat_map(|t| (0..modes).map(move |k| (t * (k + 1) as f64).cos())).collect(),
            },
            effects: Vec::new(),
        }],
        times: times.clone(),
        histories: (0..components).map(history).collect(),
        balances: vec![PageBalance {
            group: String::new(),
            name: "energy".to_owned(),
            law: "constant".to_owned(),
            unit: "mJ".to_owned(),
            least_range: 1e-12,
            terms: vec![course("kinetic")],
            errors: vec![course("")],
        }],
        scene: SceneText { file: "strip.toml".to_owned(), text: "a = 1\n".to_owned() },
        warnings: Vec::new(),
        trust: Trust::default(),
        live: None,
        compared: None,
    }
}

/// Bytes of all lists of a page before they were packed: how well that goes depends on the numbers.
fn unpacked(value: &Value) -> usize {
    match value {
        Value::Object(fields) if fields.contains_key("packed") => bytes(value).len(),
        Value::Object(fields) => fields.values().map(unpacked).sum(),
        Value::Array(list) => list.iter().map(unpacked).sum(),
        _ => 0,
    }
}

fn singles(numbers: &Value) -> Vec<f32> {
    let bytes = bytes(numbers);
    bytes.chunks_exact(4).map(|b| f32::from_le_bytes([b[0], b[1], b[2], b[3]])).collect()
}

/// Conserved: the numbers that were given, in single precision.
#[test]
fn the_numbers_of_a_short_run_come_back_to_single_precision() {
    let report = strip(20, 3, 50, 2);
    let data = data(&html(&report).unwrap());
    assert_eq!((data["rows"].as_u64(), &data["unfinished"]), (Some(50), &Value::Null));
    let expected: Vec<f32> = report.bodies[0].motion.coordinates.iter().map(|q| *q as f32).collect();
    assert_eq!(singles(&data["bodies"][0]["motion"]["coordinates"]), expected);
    let expected: Vec<f32> = report.histories[1].components[0].values.iter().map(|x| *x as f32).collect();
    assert_eq!(singles(&data["histories"][1]["components"][0]["values"]), expected);
    let body = &data["bodies"][0];
    let vertices = &report.bodies[0].surface.as_ref().unwrap().vertices;
    assert_eq!(singles(&body["surface"]["vertices"]), vertices.as_flattened());
    assert_eq!(body["shapes"][2]["frequency"], 30.0);
}

/// Closed form: the wave at the last vertex.
#[test]
fn the_peaks_in_the_page_are_those_of_all_rows() {
    let report = strip(20, 1, 50, 1);
    let data = data(&html(&report).unwrap());
    let expected = f64::from(((19.0_f64 / 20.0).sin()) as f32); // the last vertex in the first row, where q = 1
    assert_eq!(data["bodies"][0]["displacement_peak"].as_f64(), Some(expected));
    assert_eq!(data["bodies"][0]["stress"]["peak"].as_f64(), Some(expected));
}

#[test]
fn texts_of_the_user_cannot_end_the_script_that_holds_them() {
    let mut report = strip(4, 1, 3, 1);
    let scripts = html(&report).unwrap().matches("</script>").count();
    let hostile = "</script><script>alert(1)</script><!-- \u{2028} \"quoted\" \\ 'x'";
    report.title = hostile.to_owned();
    report.scene.text = hostile.to_owned();
    report.warnings = vec![hostile.to_owned()];
    report.state = RunState::Unfinished(hostile.to_owned());
    let page = html(&report).unwrap();
    assert_eq!(page.matches("</script>").count(), scripts);
    let data = data(&page);
    for text in [&data["title"], &data["scene"][1], &data["warnings"][0], &data["unfinished"]] {
        assert_eq!(text, hostile);
    }
}

/// As large as the paper's plate: 7000 vertices of the surface, 10 modes with stress, 5001 rows, 8 points with 12
/// components each.
#[test]
fn the_page_of_the_plate_is_below_4_mb() {
    let bytes = html(&strip(7000, 10, 5001, 8 * 12 + 20)).unwrap().len();
    println!("the page of a run like the paper's plate has {bytes} bytes");
    assert!(bytes < 4_000_000, "{bytes}");
}

#[test]
fn a_run_of_ten_times_the_rows_makes_no_larger_page() {
    let size = |rows| unpacked(&data(&html(&strip(10, 2, rows, 40)).unwrap()));
    let (short, long) = (size(40_000), size(400_000));
    assert!(long < short + short / 100, "{short} and {long}");
}

#[test]
fn a_page_without_surface_shapes_or_histories_can_be_made() {
    let mut report = strip(4, 0, 1, 0);
    (report.bodies[0].surface, report.bodies[0].stress) = (None, None);
    report.balances.clear();
    let data = data(&html(&report).unwrap());
    assert_eq!(
        (&data["bodies"][0]["surface"], data["bodies"][0]["displacement_peak"].as_f64()),
        (&Value::Null, Some(0.0))
    );
}

#[test]
fn what_does_not_fit_together_is_refused_with_its_place() {
    let message = |change: &dyn Fn(&mut RunPage)| {
        let mut report = strip(4, 2, 3, 1);
        change(&mut report);
        html(&report).unwrap_err().to_string()
    };
    assert!(message(&|r| r.times.clear()).contains("no rows"));
    assert!(message(&|r| r.bodies[0].motion = PageMotion::default()).contains("positions has 0 entries where 3"));
    assert!(message(&|r| r.bodies.clear()).contains("no body"));
    assert!(message(&|r| r.bodies[0].motion.coordinates.truncate(5)).contains("coordinates has 5 entries where 6"));
    assert!(
        message(&|r| r.bodies[0].shapes[1].displacement.truncate(3)).contains("shape \"mode 2\" has 3 entries where 4")
    );
    let few = message(&|r| r.bodies[0].stress.as_mut().unwrap().shapes.truncate(1));
    assert!(few.contains("stresses of shapes and products has 1 entries"), "{few}");
    let of_no_shape = |r: &mut RunPage| {
        let stress = r.bodies[0].stress.as_mut().unwrap();
        stress.shapes.push(stress.shapes[0].clone());
        stress.products.push(vec![0, 5]);
    };
    assert!(message(&of_no_shape).contains("names coordinate 5 "));
    assert!(
        message(&|r| r.histories[0].components.clear()).contains("component in its history \"point 0: displacement\"")
    );
    assert!(message(&|r| r.balances[0].errors[0].values.truncate(1)).contains("balance \"energy\", errors"));
    assert!(message(&|r| r.histories[0].components[0].values[2] = f64::NAN).contains("holds NaN in entry 2"));
    assert!(
        message(&|r| r.bodies[0].motion.origins[1][2] = 1e39).contains("positions holds"),
        "infinite in single precision"
    );
    assert!(message(&|r| r.times[2] = 0.0).contains("row 2 (from 0) is at 0,"));
    assert!(message(&|r| r.bodies[0].motion.attitudes[1][0] = 1.1).contains("attitude in row 1 "));
    let edge = message(&|r| r.bodies[0].surface.as_mut().unwrap().edges[0][1] = 4);
    assert!(edge.contains("a edge of the report's surface names vertex 4 (from 0), but there are 4"), "{edge}");
    assert!(html(&strip(4, 257, 2, 1)).unwrap_err().to_string().contains("257 shapes, and the page draws 256"));
}

/// Each with its own shapes; the rows of all fit into what one has.
#[test]
fn several_bodies_share_the_rows_of_a_page() {
    let mut report = strip(10, 2, 200_000, 4);
    let alone = unpacked(&data(&html(&report).unwrap()));
    let mut other = strip(8, 3, 200_000, 0).bodies;
    other[0].name = "other".to_owned();
    report.bodies.append(&mut other);
    let page = html(&report).unwrap();
    let data = data(&page);
    let both = unpacked(&data);
    assert!(both < alone + 20_000, "{both} and {alone}");
    let rows = singles(&data["bodies"][1]["motion"]["origins"]).len() / 3;
    assert_eq!(singles(&data["bodies"][1]["motion"]["coordinates"]).len(), 3 * rows);
    assert_eq!(singles(&data["bodies"][0]["motion"]["coordinates"]).len(), 2 * rows);
    assert_eq!(data["bodies"][1]["name"], "other");
    report.bodies[1].shapes.pop();
    assert!(html(&report).unwrap_err().to_string().contains("entries where"));
}

#[test]
fn a_file_is_written_whole_and_a_missing_folder_is_named() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("report.html");
    let report = strip(4, 1, 3, 1);
    write(&report, &path).unwrap();
    assert_eq!(std::fs::read_to_string(&path).unwrap(), html(&report).unwrap());
    let missing = folder.path().join("missing").join("report.html");
    let error = write(&report, &missing).unwrap_err().to_string();
    assert!(error.contains("missing") && error.contains("check the folder"), "{error}");
}
