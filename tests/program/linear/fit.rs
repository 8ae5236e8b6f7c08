//! `flexframe fit` as its users meet it.

use std::path::Path;

use serde_json::Value;

use crate::linear::gradient::{report, run, write_scene, write_system};

const E: &str = "body.material.young_modulus";
const RHO: &str = "body.material.density";
const TIP: &str = "body.point_masses[0].mass";

/// Writes exact frequencies of the bar with other values as measured ones, with shapes if wanted, each line times a factor.
fn measure(folder: &Path, values: &[&str], factors: &[f64]) {
    let set: Vec<&str> = values.iter().flat_map(|value| ["--set", value]).collect();
    let found = report(folder, &[&["modes", "bar.toml", "--json"][..], &set].concat());
    let frequencies = found["body"]["natural_frequencies"].as_array().unwrap().clone();
    let line = |(frequency, factor): (&Value, &f64)| format!("{:e}\n", frequency.as_f64().unwrap() * factor);
    let lines: String = frequencies.iter().zip(factors).map(line).collect();
    std::fs::write(folder.join("test.csv"), format!("frequency\n{lines}")).unwrap();
}

fn value(report: &Value, i: usize) -> f64 {
    report["parameters"][i]["value"].as_f64().unwrap()
}

/// Conserved: exact frequencies give back the values that they were computed with.
#[test]
fn exact_frequencies_give_back_modulus_and_density() {
    let folder = tempfile::tempdir().unwrap();
    write_scene(folder.path());
    measure(folder.path(), &[&format!("{E}=65000.0"), &format!("{RHO}=3.1e-9")], &[1.0; 6]);
    let parameters = format!("{E},{RHO}");
    let asked = ["fit", "bar.toml", "--measured", "test.csv", "--parameters", &parameters];
    let found = report(folder.path(), &[&asked[..], &["-o", "fitted.toml", "--json"]].concat());
    for (i, expected) in [65000.0, 3.1e-9].into_iter().enumerate() {
        assert!((value(&found, i) / expected - 1.0).abs() < 1e-8, "{}", value(&found, i));
    }
    // The scene that was written has these frequencies.
    let again = report(folder.path(), &["modes", "fitted.toml", "--json"]);
    for (frequency, mode) in
        again["body"]["natural_frequencies"].as_array().unwrap().iter().zip(found["modes"].as_array().unwrap())
    {
        let (frequency, measured) = (frequency.as_f64().unwrap(), mode["measured"].as_f64().unwrap());
        assert!((frequency / measured - 1.0).abs() < 1e-9);
    }
    assert!(std::fs::read_to_string(folder.path().join("fitted.toml")).unwrap().contains("rayleigh"));
    let told = run(folder.path(), &[&asked[..], &["--json"]].concat());
    assert!(told.status.success());
}

/// Closed form: of one parameter by two frequencies that go with its root, each with the deviation s, the logarithm has the deviation
/// 2s/√2, and by what is left of them t(1) = 12.706 times the scatter: here 1 % up and 1 % down, √2 %.
#[test]
fn intervals_are_those_of_one_parameter_in_closed_form() {
    let folder = tempfile::tempdir().unwrap();
    write_scene(folder.path());
    measure(folder.path(), &[&format!("{TIP}=1e-12")], &[1.01, 0.99]);
    let asked =
        ["fit", "bar.toml", "--set", &format!("{TIP}=1e-12"), "--measured", "test.csv", "--parameters", E, "--json"];
    for (deviation, half) in [(Some("0.01"), 1.959_964 * 0.02 / 2.0_f64.sqrt()), (None, 12.706_2 * 0.02)] {
        let deviation: Vec<&str> = deviation.map_or(Vec::new(), |deviation| vec!["--deviation", deviation]);
        let found = report(folder.path(), &[&asked[..], &deviation].concat());
        let interval = &found["parameters"][0]["interval"];
        let [low, high] = [0, 1].map(|i| interval[i].as_f64().unwrap());
        // Measured frequencies of 1.01 and 0.99 of the model's count by their own size: the slopes are 1 to 2e-4.
        assert!((0.5 * (high / low).ln() / half - 1.0).abs() < 1e-3, "{low} {high} {half}");
        assert!((value(&found, 0) / 70000.0 - 1.0).abs() < 1e-3);
        assert!(!found["warnings"].to_string().contains("still off"), "{found}");
    }
    // One modulus does not give these two.
    measure(folder.path(), &[&format!("{TIP}=1e-12")], &[1.1, 0.9]);
    assert!(report(folder.path(), &asked)["warnings"].to_string().contains("still off by"));
}

#[test]
fn shapes_tell_modes_that_are_not_in_order() {
    let folder = tempfile::tempdir().unwrap();
    write_scene(folder.path());
    // The first mode bends along z, the second along y, since the prop holds the tip along y.
    let found = report(folder.path(), &["modes", "bar.toml", "--set", &format!("{E}=60000.0"), "--json"]);
    let frequency = |k: usize| found["body"]["natural_frequencies"][k].as_f64().unwrap();
    let table = format!("frequency,middle.y,middle.z\n{:e},1.0,0.0\n{:e},0.0,1.0\n", frequency(1), frequency(0));
    std::fs::write(folder.path().join("test.csv"), table).unwrap();
    let fitted = report(folder.path(), &["fit", "bar.toml", "--measured", "test.csv", "--parameters", E, "--json"]);
    assert!((value(&fitted, 0) / 60000.0 - 1.0).abs() < 1e-8, "{fitted}");
    assert_eq!((&fitted["modes"][0]["mode"], &fitted["modes"][1]["mode"]), (&2.into(), &1.into()));
}

/// Writes the mesh of the bar with other heights of its nodes.
fn write_mesh(folder: &Path, name: &str, factor: f64) {
    let text =
        std::fs::read_to_string(format!("{}/../../meshes/rotating_bar.msh", env!("CARGO_MANIFEST_DIR"))).unwrap();
    let (before, rest) = text.split_once("$Nodes\n").unwrap();
    let (nodes, after) = rest.split_once("$EndNodes").unwrap();
    let line = |line: &str| match line.split(' ').collect::<Vec<_>>()[..] {
        [x, y, z] => format!("{x} {y} {:e}\n", factor * z.parse::<f64>().unwrap()),
        _ => format!("{line}\n"),
    };
    let nodes: String = nodes.lines().map(line).collect();
    std::fs::write(folder.join(name), format!("{before}$Nodes\n{nodes}$EndNodes{after}")).unwrap();
}

/// Independent reference: frequencies of a mesh of another thickness, made from the file. Conserved: they give it back, with the modulus.
#[test]
fn exact_frequencies_give_back_a_thickness() {
    let folder = tempfile::tempdir().unwrap();
    write_mesh(folder.path(), "bar.msh", 1.3);
    write_mesh(folder.path(), "thick.msh", 1.3 * 1.1);
    let text = "title = \"Bar\"\nunits = { length = \"mm\", mass = \"Mg\", time = \"s\" }\n[body]\nmesh = \"bar.msh\"\n\
                material = { young_modulus = 70000.0, poisson_ratio = 0.3, density = 2.7e-9 }\n\
                point_masses = [{ at = [202.07, 0.0, 0.0], mass = 1e-5 }]\n[modes]\nflexible = 5\n\
                [[constraints]]\nkind = \"clamp\"\ngroup = \"root\"\n[time]\nend = 0.1\ntolerance = 1e-6\n";
    std::fs::write(folder.path().join("bar.toml"), text).unwrap();
    measure(folder.path(), &[&format!("{E}=65000.0"), "body.mesh=\"thick.msh\""], &[1.0; 5]);
    let parameters = format!("{E},thickness.z");
    let asked = ["fit", "bar.toml", "--measured", "test.csv", "--parameters", &parameters];
    let found = report(folder.path(), &[&asked[..], &["--json"]].concat());
    for (i, expected) in [65000.0, 1.1].into_iter().enumerate() {
        assert!((value(&found, i) / expected - 1.0).abs() < 1e-7, "{}", value(&found, i));
    }
    assert_eq!(found["parameters"][1]["start"], 1.0);
    let told = String::from_utf8(run(folder.path(), &asked).stdout).unwrap();
    assert!(told.contains("a mesh with thickness.z = 1.1"), "{told}");
}

#[test]
fn what_the_frequencies_do_not_tell_is_refused_by_name() {
    let folder = tempfile::tempdir().unwrap();
    write_scene(folder.path());
    measure(folder.path(), &[], &[1.0; 3]);
    let refused = |arguments: &[&str], code: i32, words: &[&str]| {
        let output = run(folder.path(), &[&["fit", "bar.toml"], arguments].concat());
        let told = String::from_utf8(output.stderr).unwrap();
        assert_eq!(output.status.code(), Some(code), "{told}");
        assert!(words.iter().all(|word| told.contains(word)), "{told}");
    };
    let table = ["--measured", "test.csv"];
    let all = format!("{E},{RHO},{TIP}");
    refused(&[&table[..], &["--parameters", &all]].concat(), 4, &[E, RHO, TIP, "do not tell", "apart"]);
    let four = format!("{all},body.material.poisson_ratio");
    refused(&[&table[..], &["--parameters", &four]].concat(), 3, &["3 measured frequencies for 4 parameters"]);
    refused(&table, 2, &["no parameters", E]);
    refused(&["--parameters", E], 2, &["--measured"]);
    let thickness = [&table[..], &["--parameters", "thickness.z", "-o", "other.toml"]].concat();
    refused(&thickness, 2, &["thickness.z", "leave -o out"]);
    refused(&[&table[..], &["--parameters", E, "-o", "../other.toml"]].concat(), 2, &["in another folder"]);
    // Nothing of the first modes reaches a mass that rests on the support.
    let resting = "body.point_masses=[{at=[0.0,0.0,0.0],mass=1e-5}]";
    refused(&[&table[..], &["--parameters", TIP, "--set", resting]].concat(), 4, &[TIP, "changes none"]);
    std::fs::write(folder.path().join("test.csv"), "frequency,deviation\n100,1\n200,\n").unwrap();
    refused(&[&table[..], &["--parameters", E]].concat(), 3, &["test.csv:3", "no deviation"]);
    std::fs::write(folder.path().join("test.csv"), "frequency,deviation\n100,-1\n").unwrap();
    refused(&[&table[..], &["--parameters", E]].concat(), 3, &["test.csv:2", "deviation"]);
    refused(&["--measured", "nowhere.csv", "--parameters", E], 3, &["nowhere.csv", "cannot be read"]);
}

/// Conserved: exact frequencies of bodies in joints give back the stiffnesses and the modulus that they were computed with.
#[test]
fn exact_frequencies_give_back_the_numbers_of_bodies_in_joints() {
    let folder = tempfile::tempdir().unwrap();
    write_system(folder.path(), "");
    let (turn, modulus) = ("bushings[0].stiffness.rotation[2]", "bodies.bar.material.young_modulus");
    let slide = "bushings[0].stiffness.translation[1]";
    let set = [format!("{turn}=1.5e5"), format!("{slide}=700.0"), format!("{modulus}=65000.0")];
    let set: Vec<&str> = set.iter().flat_map(|set| ["--set", set]).collect();
    let found = report(folder.path(), &[&["modes", "system.toml", "--json"][..], &set].concat());
    let modes = found["systems"][0]["modes"].as_array().unwrap();
    let frequencies = modes.iter().map(|mode| mode["frequency"].as_f64().unwrap()).filter(|f| *f > 0.0).take(8);
    let lines: String = frequencies.map(|frequency| format!("{frequency:e}\n")).collect();
    std::fs::write(folder.path().join("test.csv"), format!("frequency\n{lines}")).unwrap();
    let parameters = format!("{turn},{slide},{modulus}");
    let asked = ["fit", "system.toml", "--measured", "test.csv", "--parameters", &parameters, "--json"];
    let found = report(folder.path(), &asked);
    for (i, expected) in [1.5e5, 700.0, 65000.0].into_iter().enumerate() {
        assert!((value(&found, i) / expected - 1.0).abs() < 1e-7, "{}", value(&found, i));
    }
    // The stiffness of the second vibration is not that of the bar: its modulus grows without an end.
    let [first, second] = [0, 1].map(|k| modes[k]["frequency"].as_f64().unwrap());
    std::fs::write(folder.path().join("test.csv"), format!("frequency\n{first:e}\n{:e}\n", 3.0 * second)).unwrap();
    let gone = run(folder.path(), &["fit", "system.toml", "--measured", "test.csv", "--parameters", modulus]);
    let gone = String::from_utf8_lossy(&gone.stderr).into_owned();
    assert!(gone.contains("the search has taken bodies.bar.material.young_modulus to where it changes none"), "{gone}");
    std::fs::write(folder.path().join("test.csv"), "frequency,tip.x\n100,1\n200,1\n300,1\n").unwrap();
    let refused = run(folder.path(), &asked);
    assert!(String::from_utf8_lossy(&refused.stderr).contains("matched by their order"));
}
