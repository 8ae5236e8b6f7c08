//! `flexframe gradient` as its users meet it.

use std::path::Path;
use std::process::Output;

use serde_json::Value;

use crate::program::command_in;

/// The clamped bar with a mass at its tip, whose frequencies are two and two but for the mesh, and a prop at its tip, which parts them.
pub(crate) fn write_scene(folder: &Path) {
    let text = format!(
        "title = \"Bar\"\nunits = {{ length = \"mm\", mass = \"Mg\", time = \"s\" }}\n[body]\nmesh = \"{}/../../meshes/rotating_bar.msh\"\n\
         material = {{ young_modulus = 70000.0, poisson_ratio = 0.3, density = 2.7e-9 }}\n\
         point_masses = [{{ at = [202.07, 0.0, 0.0], mass = 1e-5 }}]\n[modes]\nflexible = 6\n\
         rayleigh = {{ alpha = 20.0, beta = 1e-6 }}\n\
         [[constraints]]\nkind = \"support\"\ngroup = \"root\"\ndirections = [\"x\", \"y\", \"z\"]\n\
         [[constraints]]\nkind = \"support\"\nat = [202.07, 0.0, 0.0]\nradius = 1.0\ndirections = [\"y\"]\n\
         [[loads]]\nkind = \"force\"\nat = [100.0, 0.0, 0.0]\ndirection = [0.0, 1.0, 0.5]\namplitude = 2.0\n\
         history = {{ kind = \"half-sine\", duration = 0.002 }}\n\
         [[loads]]\nkind = \"gravity\"\ndirection = [0.0, 0.0, -1.0]\namplitude = 9810.0\n\
         [time]\nend = 0.1\ntolerance = 1e-6\n\
         [output]\npoints = {{ tip = [202.07, 0.0, 0.0], middle = [100.0, 0.0, 0.0] }}\n",
        env!("CARGO_MANIFEST_DIR")
    );
    std::fs::write(folder.join("bar.toml"), text).unwrap();
}

pub(crate) fn run(folder: &Path, arguments: &[&str]) -> Output {
    command_in(folder, arguments).output().unwrap()
}

pub(crate) fn report(folder: &Path, arguments: &[&str]) -> Value {
    let output = run(folder, arguments);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    serde_json::from_slice(&output.stdout).unwrap()
}

fn numbers(value: &Value) -> Vec<f64> {
    match value {
        Value::Array(list) => list.iter().flat_map(numbers).collect(),
        Value::Number(number) => vec![number.as_f64().unwrap()],
        _ => Vec::new(),
    }
}

/// Independent reference: central differences of fourth order of the reports with other values of the key, 1e-3 apart. Responses are taken
/// near the first resonance and far from it.
#[test]
fn responses_and_all_else_have_the_rates_of_central_differences() {
    const STEP: f64 = 1e-3;
    let folder = tempfile::tempdir().unwrap();
    write_scene(folder.path());
    let asked = ["gradient", "bar.toml", "--frequencies", "100:500:3", "--overwrite", "--json"];
    let found = report(folder.path(), &asked);
    let parts = ["frequencies", "effective_masses", "responses"];
    let of = |report: &Value| -> Vec<Vec<f64>> {
        let responses = report["responses"].as_array().unwrap();
        let responses: Vec<f64> = responses.iter().flat_map(|response| numbers(&response["values"])).collect();
        vec![numbers(&report["frequencies"]), numbers(&report["effective_masses"]), responses]
    };
    for parameter in found["parameters"].as_array().unwrap() {
        let (name, value) = (parameter["name"].as_str().unwrap(), parameter["value"].as_f64().unwrap());
        let [a, b, c, d] = [-2.0, -1.0, 1.0, 2.0].map(|k| {
            let set = format!("{name}={:e}", value * (1.0 + k * STEP));
            of(&report(folder.path(), &[&asked[..], &["--parameters", name, "--set", &set]].concat()))
        });
        for (part, what) in parts.iter().enumerate() {
            let size = of(&found)[part].iter().map(|x| x.abs()).fold(0.0, f64::max);
            let rates = numbers(&parameter[what]);
            assert_eq!(rates.len(), a[part].len(), "{what}");
            for (i, rate) in rates.iter().enumerate() {
                let difference = (a[part][i] - d[part][i] + 8.0 * (c[part][i] - b[part][i])) / (12.0 * STEP);
                let off = (value * rate - difference).abs();
                assert!(off < 1e-6 * size, "{name} {what} {i}: {} {difference}", value * rate);
            }
        }
    }
    let csv = std::fs::read_to_string(folder.path().join("out/bar/gradient_frf.csv")).unwrap();
    let head = csv.lines().next().unwrap();
    // Of the last run: two loads, two points, three axes; a response and its rates with one parameter, each of two numbers.
    assert!(head.split(',').count() == 1 + 2 * 2 * 3 * 2 * 2 && csv.lines().count() == 4, "{head}");
    assert!(head.contains("im tip.displacement.z/loads[0]"), "{head}");
}

#[test]
fn the_table_has_a_row_for_each_number_and_parameter() {
    let folder = tempfile::tempdir().unwrap();
    write_scene(folder.path());
    let output =
        run(folder.path(), &["gradient", "bar.toml", "--parameters", "thickness.z,body.material.density", "-n", "4"]);
    let told = String::from_utf8(output.stdout).unwrap();
    assert!(output.status.success() && told.contains("[1]  thickness.z  "), "{told}");
    let csv = std::fs::read_to_string(folder.path().join("out/bar/gradient.csv")).unwrap();
    // Frequencies and three masses of four modes, and three displacements of two points under two loads.
    assert_eq!(csv.lines().count(), 1 + 2 * (4 * 4 + 2 * 2 * 3), "{csv}");
    assert!(
        csv.contains("\nfrequency.1,")
            && csv.contains("effective_mass.z.4,")
            && csv.contains("displacement.loads[1].tip.z,")
    );
    let again = run(folder.path(), &["gradient", "bar.toml"]);
    assert_eq!(again.status.code(), Some(6), "what is there is not written over");
}

#[test]
fn what_has_no_rates_is_told() {
    let folder = tempfile::tempdir().unwrap();
    write_scene(folder.path());
    for (arguments, code, says) in [
        (vec!["--parameters", "body.material.colour"], 3, "body.material.young_modulus"),
        (vec!["--parameters", "thickness.tip.z"], 3, "tip"),
        (vec!["--frequencies", "5:1:3"], 2, "start < end"),
        (vec!["-n", "5000"], 2, "--flexible"),
    ] {
        let output = run(folder.path(), &[&["gradient", "bar.toml"][..], &arguments].concat());
        let told = String::from_utf8(output.stderr).unwrap();
        assert!(output.status.code() == Some(code) && told.contains(says), "{:?} {told}", output.status.code());
    }
}

/// Writes a scene of a bar whose root sits in a bushing, with a stone on a spring at its tip; `rest` is added.
pub(crate) fn write_system(folder: &Path, rest: &str) {
    let text = format!(
        "title = \"Bar in a bushing\"\nunits = {{ length = \"mm\", mass = \"Mg\", time = \"s\" }}\n\
         [bodies.bar]\nmesh = \"{}/../../meshes/rotating_bar.msh\"\n\
         material = {{ young_modulus = 70000.0, poisson_ratio = 0.3, density = 2.7e-9 }}\n\
         point_masses = [{{ at = [100.0, 2.0, 0.0], mass = 5e-6 }}]\n\
         modes = {{ flexible = 6, damping_ratio = 0.01 }}\n\
         points = {{ tip = [202.07, 0.0, 0.0], middle = [100.0, 5.0, 5.0] }}\n\
         loads = [{{ kind = \"force\", at = [150.0, 5.0, 0.0], direction = [0.0, 1.0, 0.5], amplitude = 2.0, \
         history = {{ kind = \"half-sine\", duration = 0.002 }} }}, \
         {{ kind = \"moment\", at = [60.0, 0.0, 0.0], radius = 12.0, direction = [0.0, 0.0, 1.0], amplitude = 3.0, \
         history = {{ kind = \"half-sine\", duration = 0.002 }} }}]\n\
         markers = {{ root = {{ group = \"root\" }}, tip = {{ at = [202.07, 0.0, 0.0] }} }}\n\
         [bodies.stone]\n\
         rigid = {{ mass = 1e-5, center_of_mass = [0.0, 0.0, 0.0], inertia = [[1e-3, 0.0, 0.0], [0.0, 1e-3, 0.0], [0.0, 0.0, 1e-3]] }}\n\
         initial = {{ position = [202.07, 0.0, 50.0] }}\nmarkers = {{ middle = {{ at = [0.0, 0.0, 0.0] }} }}\n\
         [ground.markers]\nrail = {{ at = [202.07, 0.0, 0.0], z = [0.0, 0.0, 1.0] }}\n\
         [[bushings]]\nname = \"seat\"\nbetween = [\"ground\", \"bar.root\"]\n\
         stiffness = {{ translation = [2e3, 1e3, 1e3], rotation = [1e5, 2e5, 1e5] }}\n\
         damping = {{ translation = [0.0, 0.01, 0.0], rotation = [0.0, 0.0, 1.0] }}\n\
         [[joints]]\nname = \"rail\"\nkind = \"prismatic\"\nbetween = [\"ground.rail\", \"stone.middle\"]\n\
         [[springs]]\nname = \"hanger\"\nbetween = [\"bar.tip\", \"stone.middle\"]\nstiffness = 2.0\n\
         [time]\nend = 0.01\ntolerance = 1e-6\n{rest}",
        env!("CARGO_MANIFEST_DIR")
    );
    std::fs::write(folder.join("system.toml"), text).unwrap();
}

/// Independent reference: central differences of fourth order of the frequencies and responses of bodies that are reduced anew of each
/// material, with modes and static shapes of their own; `flexframe frf` for the responses. Conserved: all stiffnesses grown by one factor, the
/// modulus of the body with them, raise all frequencies by its root but for the damping of the bushing, which stays: their relative rates
/// sum to a half, seen in the lowest ones, which it damps little. At frequency 0 they lower all answers by their ratio, so that the rates sum to −1.
#[test]
fn numbers_of_a_system_have_the_rates_of_central_differences() {
    const STEP: f64 = 1e-3;
    let folder = tempfile::tempdir().unwrap();
    write_system(folder.path(), "");
    // With a weight, whose forces follow all of the mass.
    let scene = folder.path().join("system.toml");
    let weight = "{ kind = \"gravity\", direction = [0.3, 0.2, -1.0], amplitude = 9810.0, history = { kind = \"half-sine\", duration = 0.002 } }";
    let text = std::fs::read_to_string(&scene).unwrap().replace("}]\nmarkers", &format!("}}, {weight}]\nmarkers"));
    assert!(text.contains(weight));
    std::fs::write(&scene, text).unwrap();
    let asked = ["gradient", "system.toml", "--frequencies", "0:600:3", "--overwrite", "--json"];
    let found = report(folder.path(), &asked);
    let parameters = found["parameters"].as_array().unwrap();
    // Seven stiffnesses, three numbers of the material and a mass.
    assert_eq!(parameters.len(), 7 + 4, "{found}");
    let of = |report: &Value| -> [Vec<f64>; 2] {
        let responses = report["responses"].as_array().unwrap();
        let responses = responses.iter().flat_map(|response| numbers(&response["values"])).collect();
        [numbers(&report["frequencies"]), responses]
    };
    let here = of(&found);
    // Three loads and a slide, two points and the slide, three frequencies of two numbers.
    assert_eq!(here[1].len(), 4 * (2 * 3 + 1) * 3 * 2);
    let mut sums = here.each_ref().map(|list| vec![0.0; list.len()]);
    for parameter in parameters {
        let (name, value) = (parameter["name"].as_str().unwrap(), parameter["value"].as_f64().unwrap());
        let [a, b, c, d] = [-2.0, -1.0, 1.0, 2.0].map(|k| {
            let set = format!("{name}={:e}", value * (1.0 + k * STEP));
            of(&report(folder.path(), &[&asked[..], &["--parameters", name, "--set", &set]].concat()))
        });
        for (part, what) in ["frequencies", "responses"].into_iter().enumerate() {
            let rates = numbers(&parameter[what]);
            assert_eq!(rates.len(), here[part].len(), "{name} {what}");
            for (k, rate) in rates.iter().enumerate() {
                // A response is measured by the largest of its input at all outputs.
                let size = match part {
                    0 => here[0][k],
                    _ => here[1][k / 42 * 42..k / 42 * 42 + 42].iter().map(|x| x.abs()).fold(0.0, f64::max),
                };
                let difference = (a[part][k] - d[part][k] + 8.0 * (c[part][k] - b[part][k])) / (12.0 * STEP);
                let off = (value * rate - difference).abs();
                assert!(off < 1e-6 * size, "{name} {what} {k}: {} {difference} of {size}", value * rate);
                if name.contains("stiffness") || name.contains("young") {
                    sums[part][k] += value * rate;
                }
            }
        }
    }
    for (sum, frequency) in sums[0].iter().zip(&here[0]).take(6) {
        assert!((sum / frequency - 0.5).abs() < 1e-3, "{sum} {frequency}");
    }
    let largest = here[1].iter().map(|x| x.abs()).fold(0.0, f64::max);
    for k in (0..here[1].len()).step_by(6) {
        assert!((sums[1][k] + here[1][k]).abs() < 1e-6 * largest, "{k} {} {}", sums[1][k], here[1][k]);
    }
    let frf = [
        "frf",
        "system.toml",
        "--frequencies",
        "0:600:3",
        "--inputs",
        "bar.loads[0]",
        "--outputs",
        "bar.tip.displacement.y",
    ];
    report(folder.path(), &[&frf[..], &["-o", "frf", "--json"]].concat());
    let table = std::fs::read_to_string(folder.path().join("frf/frf.csv")).unwrap();
    let is_it =
        |response: &&Value| response["input"] == "bar.loads[0].force" && response["output"] == "bar.tip.displacement.y";
    let ours = numbers(&found["responses"].as_array().unwrap().iter().find(is_it).unwrap()["values"]);
    for (line, ours) in table.lines().skip(1).zip(ours.chunks(2)) {
        let magnitude: f64 = line.split(',').nth(1).unwrap().parse().unwrap();
        assert!((magnitude / ours[0].hypot(ours[1]) - 1.0).abs() < 1e-9, "{line} {ours:?}");
    }
}

#[test]
fn a_system_that_forces_deform_has_no_rates() {
    let folder = tempfile::tempdir().unwrap();
    write_system(folder.path(), "");
    for set in [
        "springs[0].free_length=40.0",
        "bodies.bar.loads=[{ kind = \"force\", at = [202.07, 0, 0], direction = [0, 1, 0], amplitude = 1.0 }]",
    ] {
        let refused = run(folder.path(), &["gradient", "system.toml", "--set", set, "-o", "other"]);
        let told = String::from_utf8(refused.stderr).unwrap();
        assert!(refused.status.code() == Some(4) && told.contains("forces deform at the start"), "{set}: {told}");
        assert!(!folder.path().join("other").exists());
    }
}

/// The modes of a body whose marker is rigid are no eigenvectors, of which rates would be wrong; stiffnesses beside it have theirs.
#[test]
fn numbers_of_a_body_with_a_rigid_marker_are_refused_at_its_key() {
    let folder = tempfile::tempdir().unwrap();
    write_system(folder.path(), "");
    let rigid = "bodies.bar.markers.root={ group = \"root\", tie = \"rigid\" }";
    let of =
        |parameter| ["gradient", "system.toml", "--set", rigid, "-o", "other", "--json", "--parameters", parameter];
    let refused = run(folder.path(), &of("bodies.bar.material.density"));
    let told = String::from_utf8(refused.stderr).unwrap();
    assert_eq!(refused.status.code(), Some(3), "{told}");
    for word in ["bodies.bar.markers.root.tie", "nodes", "mean"] {
        assert!(told.contains(word), "{word}: {told}");
    }
    assert_eq!(report(folder.path(), &of("springs[0].stiffness"))["parameters"].as_array().unwrap().len(), 1);
}

/// Closed form: a stone on a spring along a rail swings with √(k/m)/2π, whose relative rate is a half.
#[test]
fn a_stone_on_a_spring_has_a_relative_rate_of_a_half() {
    let folder = tempfile::tempdir().unwrap();
    let text = "title = \"Stone\"\nunits = { length = \"m\", mass = \"kg\", time = \"s\" }\n\
                [bodies.stone]\nrigid = { mass = 2.0, center_of_mass = [0.0, 0.0, 0.0], inertia = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]] }\n\
                initial = { position = [0.0, 0.0, 1.0] }\nmarkers = { middle = { at = [0.0, 0.0, 0.0] } }\n\
                [ground.markers]\nrail = { at = [0.0, 0.0, 0.0], z = [0.0, 0.0, 1.0] }\n\
                [[joints]]\nname = \"rail\"\nkind = \"prismatic\"\nbetween = [\"ground.rail\", \"stone.middle\"]\n\
                spring = { stiffness = 50.0, free = 1.0 }\n[time]\nend = 1.0\ntolerance = 1e-6\n";
    std::fs::write(folder.path().join("stone.toml"), text).unwrap();
    let found = report(folder.path(), &["gradient", "stone.toml", "--json"]);
    let (frequency, relative) = (numbers(&found["frequencies"])[0], numbers(&found["parameters"][0]["relative"])[0]);
    assert!((frequency - 5.0 / std::f64::consts::TAU).abs() < 1e-9 && (relative - 0.5).abs() < 1e-9, "{found}");
    let refused =
        run(folder.path(), &["gradient", "stone.toml", "--parameters", "bodies.stone.rigid.mass", "-o", "other"]);
    let told = String::from_utf8(refused.stderr).unwrap();
    assert!(refused.status.code() == Some(2) && told.contains("joints[0].spring.stiffness"), "{told}");
}

/// Closed form: a stone in a bushing that is alike along all axes has three modes of √(k/m)/2π, of which a stiffness along one axis moves
/// one, by f/2k, and three of √(c/J)/2π, which it leaves.
#[test]
fn modes_of_one_frequency_part_with_a_stiffness() {
    let folder = tempfile::tempdir().unwrap();
    let text = "title = \"Stone\"\nunits = { length = \"m\", mass = \"kg\", time = \"s\" }\n\
                [bodies.stone]\nrigid = { mass = 2.0, center_of_mass = [0.0, 0.0, 0.0], inertia = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]] }\n\
                markers = { middle = { at = [0.0, 0.0, 0.0] } }\n\
                [[bushings]]\nname = \"seat\"\nbetween = [\"ground\", \"stone.middle\"]\n\
                stiffness = { translation = [50.0, 50.0, 50.0], rotation = [20.0, 20.0, 20.0] }\n[time]\nend = 1.0\ntolerance = 1e-6\n";
    std::fs::write(folder.path().join("stone.toml"), text).unwrap();
    let along = "bushings[0].stiffness.translation[1]";
    let found = report(folder.path(), &["gradient", "stone.toml", "--json", "--parameters", along]);
    let rates = numbers(&found["parameters"][0]["frequencies"]);
    let expected = [0.0, 0.0, 0.0, 0.0, 0.0, 5.0 / std::f64::consts::TAU / 100.0];
    assert_eq!(rates.len(), 6);
    assert!(rates.iter().zip(expected).all(|(rate, expected)| (rate - expected).abs() < 1e-10), "{rates:?}");
    assert_eq!(found["repeated"].as_array().unwrap().len(), 2);
}
