//! `flexframe linearize`, `flexframe frf` and `flexframe psd`. Needs a Python with SciPy, which `FLEXFRAME_READERS` names (`./dev test` sees to it).

use std::f64::consts::TAU;
use std::path::Path;
use std::process::Command;

use serde_json::Value;

use crate::program::{flexframe, json, root};

/// The bar on a support, pushed at its tip.
fn bar(folder: &Path, support: &str, history: &str, time: &str) -> String {
    let path = folder.join("bar.toml");
    std::fs::write(&path, bar_text(support, history, time)).unwrap();
    path.to_str().unwrap().to_owned()
}

fn bar_text(support: &str, history: &str, time: &str) -> String {
    format!(
        "title = \"Bar\"\nunits = {{ length = \"mm\", mass = \"Mg\", time = \"s\" }}\n[body]\nmesh = \"{}\"\n\
         material = {{ young_modulus = 70000.0, poisson_ratio = 0.3, density = 2.7e-9 }}\n[modes]\nflexible = 6\n\
         damping_ratio = 0.05\nstatic_correction = false\n{support}\n[[loads]]\nkind = \"force\"\nat = [202.07, 0.0, 0.0]\n\
         direction = [0, 1, 0.5]\namplitude = 1e-3\nhistory = {history}\n[time]\n{time}\n\
         [effects]\ndamping = true\nlarge_deflection = false\ngeometric_stiffening = false\n[output]\n\
         points = {{ tip = [202.07, 0.0, 0.0] }}\n",
        root().join("meshes/rotating_bar.msh").display()
    )
}

const CLAMP: &str = "[[constraints]]\nkind = \"clamp\"\ngroup = \"root\"";

/// Closed form: a force moves no displacement at once, and its acceleration by Σ φ² at once. Two accelerations of one place see two forces
/// there along one direction as one.
#[test]
fn what_outputs_see_at_once_is_told() {
    let folder = tempfile::tempdir().unwrap();
    let time = "end = 0.01\ntolerance = 1e-6\n";
    let scene = bar(folder.path(), CLAMP, "\"constant\"", time);
    let more = "[[loads]]\nkind = \"force\"\nat = [202.07, 0.0, 0.0]\ndirection = [0, 2, 1.0]\namplitude = 7.0\nhistory = \"constant\"\n";
    let text = std::fs::read_to_string(&scene).unwrap().replace("[time]", &format!("{more}[time]"));
    let two = folder.path().join("two.toml");
    std::fs::write(&two, text).unwrap();
    let file = folder.path().join("x.mat");
    let out = folder.path().join("frf");
    for (scene, outputs, rank, of, words) in [
        (&scene[..], &["tip.displacement.y"][..], 0, 1, "D        zero: no output sees an input at once"),
        (&scene, &["tip.acceleration.y"], 1, 1, ""),
        (
            two.to_str().unwrap(),
            &["tip.acceleration.y", "tip.acceleration.z"],
            1,
            2,
            "D        singular, of rank 1 of 2",
        ),
    ] {
        let outputs = outputs.iter().flat_map(|name| ["--outputs", name]);
        let of_linear = ["linearize", scene, "-o", file.to_str().unwrap(), "--overwrite"];
        let of_frf = ["frf", scene, "--frequencies", "0:5:3", "-o", out.to_str().unwrap(), "--overwrite"];
        for command in [&of_linear[..], &of_frf] {
            let arguments: Vec<&str> = command.iter().copied().chain(outputs.clone()).collect();
            let found = json(&arguments)["at_once"].clone();
            assert_eq!((found["rank"].as_u64(), found["of"].as_u64()), (Some(rank), Some(of)), "{found}");
            let said = flexframe(&arguments).stdout;
            let said = String::from_utf8_lossy(&said);
            assert!(if words.is_empty() { !said.contains("D  ") } else { said.contains(words) }, "{said}");
        }
    }
}

/// Closed form: poles −ζω ± iω√(1−ζ²) of the modes, and SciPy reads the matrices of the file.
#[test]
fn poles_of_a_clamped_bar_are_those_of_its_modes() {
    let folder = tempfile::tempdir().unwrap();
    let scene = bar(folder.path(), CLAMP, "\"constant\"", "end = 0.01\ntolerance = 1e-6");
    let file = folder.path().join("bar.mat");
    let report = json(&["linearize", &scene, "-o", file.to_str().unwrap()]);
    let modes = json(&["modes", &scene]);
    let frequencies = modes["body"]["natural_frequencies"].as_array().unwrap();
    let poles = report["poles"].as_array().unwrap();
    assert_eq!((poles.len(), report["states"].as_u64()), (6, Some(12)));
    // Closed form: in a mode velocities are s times displacements, and damping by modes leaves all in phase.
    let shape =
        |k: usize| poles[0]["shape"][k].as_array().unwrap().iter().map(|x| x.as_f64().unwrap()).collect::<Vec<f64>>();
    let (largest, velocity) = ((1..3).map(shape).find(|u| (u[0] - 1.0).abs() < 1e-12).unwrap(), shape(4));
    let [re, im] = [poles[0]["growth"].as_f64().unwrap(), TAU * poles[0]["frequency"].as_f64().unwrap()];
    assert!(largest[1].abs() < 1e-12 && shape(1)[1].abs() < 1e-6);
    assert!((velocity[0] - re * shape(1)[0]).hypot(velocity[1] - im * shape(1)[0]) < 1e-6 * im, "{velocity:?}");
    for (pole, frequency) in poles.iter().zip(frequencies) {
        let omega = TAU * frequency.as_f64().unwrap();
        let expected = [omega * (1.0_f64 - 0.05 * 0.05).sqrt() / TAU, -0.05 * omega];
        let found = [pole["frequency"].as_f64().unwrap(), pole["growth"].as_f64().unwrap()];
        for (found, expected) in found.iter().zip(expected) {
            assert!((found / expected - 1.0).abs() < 1e-6, "{found} {expected}");
        }
    }
    let python =
        std::env::var_os("FLEXFRAME_READERS").expect("FLEXFRAME_READERS names no Python with SciPy; use ./dev test");
    let script = "import sys, json, scipy.io, scipy.signal, numpy\n\
        m = scipy.io.loadmat(sys.argv[1])\n\
        names = lambda key: [str(cell[0]) for cell in m[key][:, 0]]\n\
        system = scipy.signal.StateSpace(m['A'], m['B'], m['C'], m['D'])\n\
        w, h = scipy.signal.freqresp(scipy.signal.StateSpace(m['A'], m['B'], m['C'][1:2], m['D'][1:2]), [0.0, 3000.0])\n\
        json.dump({'poles': sorted(abs(numpy.linalg.eigvals(m['A']))), 'outputs': names('outputs'), 'units': names('output_units'),\n\
        'h': [[z.real, z.imag] for z in h], 'shape': list(m['D'].shape)}, sys.stdout)";
    let read = Command::new(python).args(["-c", script]).arg(&file).output().unwrap();
    assert!(read.status.success(), "{}", String::from_utf8_lossy(&read.stderr));
    let read: Value = serde_json::from_slice(&read.stdout).unwrap();
    let slowest = read["poles"][0].as_f64().unwrap();
    assert!((slowest / (TAU * frequencies[0].as_f64().unwrap()) - 1.0).abs() < 1e-6);
    assert_eq!(read["outputs"][1], "tip.displacement.y");
    assert_eq!((&read["units"][1], &read["units"][8]), (&"mm".into(), &"mm/s²".into()));
    assert_eq!(read["shape"], serde_json::json!([9, 1]));

    // The same response by `frf`.
    let out = folder.path().join("frf");
    let at = format!("0:{}:2", 3000.0 / TAU);
    json(&["frf", &scene, "--frequencies", &at, "--outputs", "tip.displacement.y", "-o", out.to_str().unwrap()]);
    let table = std::fs::read_to_string(out.join("frf.csv")).unwrap();
    for (line, h) in table.lines().skip(1).zip(read["h"].as_array().unwrap()) {
        let numbers: Vec<f64> = line.split(',').map(|x| x.parse().unwrap()).collect();
        let [re, im] = [0, 1].map(|k| h[k].as_f64().unwrap());
        assert!((numbers[1] / re.hypot(im) - 1.0).abs() < 1e-9, "{numbers:?} {h}");
    }
}

/// Closed form: the damping ratio of the scene. Nothing in the scene moves this body, so that a run of it would leave damping out.
#[test]
fn a_held_body_without_loads_keeps_its_damping() {
    let folder = tempfile::tempdir().unwrap();
    let scene = bar(folder.path(), CLAMP, "\"constant\"", "end = 0.01\ntolerance = 1e-6");
    let text = std::fs::read_to_string(&scene).unwrap();
    let start = text.find("[[loads]]").unwrap();
    let end = start + text[start + 1..].find("\n[").unwrap() + 1;
    // Damping is left open there, as in most scenes.
    let text = format!("{}{}", &text[..start], &text[end..]).replace("damping = true\n", "");
    std::fs::write(&scene, &text).unwrap();
    let file = folder.path().join("bar.mat");
    let arguments = ["linearize", &scene, "--inputs", "base.acceleration.z", "-o", file.to_str().unwrap()];
    let report = json(&arguments);
    for pole in report["poles"].as_array().unwrap() {
        assert!((pole["damping_ratio"].as_f64().unwrap() - 0.05).abs() < 1e-9, "{pole}");
    }
    assert_eq!(report["about"], "rest; damping ratio 0.05 in each mode");
    std::fs::write(&scene, text.replace("damping_ratio = 0.05", "damping_ratio = 0.0")).unwrap();
    let arguments = [&arguments[..], &["--overwrite"]].concat();
    assert_eq!(json(&arguments)["about"], "rest; no damping");
}

/// Independent reference: the run in the time domain, swung in, of a sine.
#[test]
fn a_harmonic_run_agrees_with_the_frequency_response() {
    let folder = tempfile::tempdir().unwrap();
    let quiet = bar(folder.path(), CLAMP, "\"constant\"", "end = 0.01\ntolerance = 1e-6");
    let modes = json(&["modes", &quiet]);
    let first = modes["body"]["natural_frequencies"][0].as_f64().unwrap();
    let frequency = 0.6 * first;
    // exp(−ζωT) < 1e-9 after 70 periods of the first mode.
    let end = 70.0 / first;
    let (period, start) = (1.0 / frequency, end - 1.0 / frequency);
    let history = format!("{{ kind = \"sine\", frequency = {frequency:e} }}");
    let time = format!("end = {end:e}\ntolerance = 1e-9");
    let scene = bar(folder.path(), CLAMP, &history, &time);
    let out = folder.path().join("out");
    // Rows at equal parts of the last period.
    let interval = format!("output.interval={:e}", period / 40.0);
    json(&["run", &scene, "--no-check", "-o", out.to_str().unwrap(), "--set", &interval]);
    let csv = folder.path().join("bar.csv");
    let file = out.join("bar.h5");
    let written = flexframe(&[
        "export",
        file.to_str().unwrap(),
        "--csv",
        csv.to_str().unwrap(),
        "--columns",
        "points/tip/displacement",
    ]);
    assert!(written.status.success(), "{}", String::from_utf8_lossy(&written.stderr));
    let rows: Vec<Vec<f64>> = std::fs::read_to_string(&csv)
        .unwrap()
        .lines()
        .skip(1)
        .map(|line| line.split(',').map(|x| x.parse().unwrap()).collect())
        .filter(|row: &Vec<f64>| row[0] >= start)
        .collect();
    // Least squares of a sin + b cos of the y displacement.
    let mut normal = [[0.0; 2]; 2];
    let mut right = [0.0; 2];
    for row in &rows {
        let phase = TAU * frequency * row[0];
        let basis = [phase.sin(), phase.cos()];
        for i in 0..2 {
            (0..2).for_each(|j| normal[i][j] += basis[i] * basis[j]);
            right[i] += basis[i] * row[2];
        }
    }
    let determinant = normal[0][0] * normal[1][1] - normal[0][1] * normal[1][0];
    let a = (right[0] * normal[1][1] - right[1] * normal[0][1]) / determinant;
    let b = (right[1] * normal[0][0] - right[0] * normal[1][0]) / determinant;

    let frf = folder.path().join("frf");
    let at = format!("{frequency:e}:{:e}:2", 2.0 * frequency);
    json(&["frf", &scene, "--frequencies", &at, "--outputs", "tip.displacement.y", "-o", frf.to_str().unwrap()]);
    let table = std::fs::read_to_string(frf.join("frf.csv")).unwrap();
    let line: Vec<f64> = table.lines().nth(1).unwrap().split(',').map(|x| x.parse().unwrap()).collect();
    let magnitude = a.hypot(b);
    assert!((magnitude / line[1] - 1.0).abs() < 1e-6, "{magnitude:e} {:e}", line[1]);
    assert!((b.atan2(a).to_degrees() - line[2]).abs() < 1e-3, "{} {}", b.atan2(a).to_degrees(), line[2]);
}

/// Independent reference: `campbell`, without damping, of a bar on a driven hinge.
#[test]
fn poles_in_a_spin_are_those_of_the_campbell_diagram() {
    let folder = tempfile::tempdir().unwrap();
    let support = "[[constraints]]\nkind = \"hinge\"\nat = [0, 0, 0]\naxis = [0, 0, 1]\ngroup = \"root\"\n\
                   motion = { amplitude = 300.0, history = \"constant\" }";
    let scene = bar(folder.path(), support, "{ kind = \"step\", at = 1.0 }", "end = 0.01\ntolerance = 1e-6");
    let undamped = [
        "--set",
        "modes.damping_ratio=0",
        "--set",
        "effects.damping=false",
        "--set",
        "effects.geometric_stiffening=true",
    ];
    let file = folder.path().join("linear.json");
    let report = json(&[&["linearize", &scene, "-o", file.to_str().unwrap()], &undamped[..]].concat());
    let out = folder.path().join("campbell");
    let arguments = [
        "campbell",
        &scene,
        "--axis",
        "z",
        "--speeds",
        "0:300:2",
        "--about-rest",
        "never",
        "-o",
        out.to_str().unwrap(),
    ];
    json(&[&arguments, &undamped[..]].concat());
    let table = std::fs::read_to_string(out.join("campbell.csv")).unwrap();
    let last: Vec<f64> = table.lines().last().unwrap().split(',').map(|x| x.parse().unwrap()).collect();
    let mut expected = last[1..7].to_vec();
    expected.sort_by(f64::total_cmp);
    for (pole, expected) in report["poles"].as_array().unwrap().iter().zip(expected) {
        let found = pole["frequency"].as_f64().unwrap();
        assert!((found / expected - 1.0).abs() < 1e-6, "{found} {expected}");
    }
}

/// Independent reference: the vibrations that `modes` finds of the system.
#[test]
fn a_system_is_linearised_with_its_joints() {
    let folder = tempfile::tempdir().unwrap();
    let scene = "examples/mechanisms/double_pendulum.toml";
    let file = folder.path().join("pendulum.json");
    let report = json(&["linearize", scene, "-o", file.to_str().unwrap()]);
    let modes = json(&["modes", scene]);
    let inputs = report["inputs"].to_string();
    assert!(inputs.contains(".turn"), "{inputs}");
    let found: Vec<f64> =
        report["poles"].as_array().unwrap().iter().map(|pole| pole["frequency"].as_f64().unwrap()).collect();
    let of_system = modes["systems"][0]["modes"].as_array().unwrap();
    let frequencies = of_system.iter().map(|mode| mode["frequency"].as_f64().unwrap());
    // Slower ones are the rigid swing, which a state that is not steady leaves to rounding; the highest are static shapes, of which
    // some have nearly one frequency.
    let swinging: Vec<f64> = frequencies.filter(|frequency| *frequency > 1.0).collect();
    assert!(swinging.len() > 20, "{swinging:?}");
    for frequency in swinging.into_iter().take(20) {
        assert!(found.iter().any(|f| (f / frequency - 1.0).abs() < 1e-6), "{frequency} {found:?}");
    }
}

#[test]
fn what_has_no_linear_model_is_refused_in_words() {
    let folder = tempfile::tempdir().unwrap();
    let scene = bar(folder.path(), CLAMP, "\"constant\"", "end = 0.01\ntolerance = 1e-6");
    let at = |name: &str| folder.path().join(name).to_str().unwrap().to_owned();
    let refused = |arguments: &[&str], code: i32, words: &[&str]| {
        let output = flexframe(arguments);
        let text = String::from_utf8_lossy(&output.stderr).into_owned();
        assert_eq!(output.status.code(), Some(code), "{text}");
        words.iter().for_each(|word| assert!(text.contains(word), "{word}: {text}"));
    };
    refused(&["linearize", &scene, "-o", &at("x.csv")], 2, &[".mat or .json"]);
    refused(&["linearize", &scene, "-o", &at("x.mat"), "--reduce", "balanced:99"], 4, &["order 99", "1 to 12"]);
    refused(&["linearize", &scene, "-o", &at("x.mat"), "--reduce", "modal:5"], 4, &["order 5", "no conjugate pair"]);
    refused(&["linearize", &scene, "-o", &at("x.mat"), "--reduce", "krylov:5"], 2, &["balanced:N or modal:N"]);
    refused(&["linearize", &scene, "-o", &at("x.mat"), "--time", "7"], 2, &["time 7", "0 to 0.01"]);
    refused(
        &["linearize", &scene, "-o", &at("x.mat"), "--inputs", "bass"],
        2,
        &["no input `bass`", "base.acceleration.x", "loads[0].force"],
    );
    refused(&["linearize", &scene, "-o", &at("x.mat"), "--spin", "0,0,1"], 4, &["--spin of a body that is held"]);
    refused(&["frf", &scene, "--frequencies", "5:1:9", "-o", &at("f")], 2, &["5:1:9", "0 ≤ start < end"]);
    refused(
        &["frf", &scene, "--frequencies", "1:5:9", "--outputs", "top", "-o", &at("f")],
        2,
        &["no output `top`", "tip.displacement.x"],
    );
    for (way, has_bound) in [("balanced:4", true), ("modal:4", false)] {
        let reduced = json(&["linearize", &scene, "-o", &at("x.mat"), "--overwrite", "--reduce", way]);
        assert_eq!((reduced["error_bound"].is_number(), reduced["states"].as_u64()), (has_bound, Some(4)), "{way}");
    }
}

#[test]
fn what_does_nothing_and_what_grows_is_told() {
    let folder = tempfile::tempdir().unwrap();
    let scene = bar(folder.path(), CLAMP, "\"constant\"", "end = 0.01\ntolerance = 1e-6");
    let file = folder.path().join("x.mat").to_str().unwrap().to_owned();
    let held = [
        "linearize",
        &scene,
        "-o",
        &file,
        "--set",
        "output.points={ root = [0.0, 0.0, 0.0], tip = [202.07, 0.0, 0.0] }",
    ];
    let told = json(&held)["warnings"].to_string();
    assert!(
        told.contains("see nothing") && told.contains("root.velocity.y") && !told.contains("tip.velocity.y"),
        "{told}"
    );
    let text = "title = \"Stick\"\nunits = { length = \"m\", mass = \"kg\", time = \"s\" }\n\
                [bodies.stick]\nrigid = { mass = 1.0, center_of_mass = [0.0, 0.0, 0.0], inertia = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]] }\n\
                initial = { position = [0.0, 0.0, 1.0] }\nmarkers = { foot = { at = [0.0, 0.0, -1.0] } }\n\
                loads = [{ kind = \"gravity\", direction = [0.0, 0.0, -1.0], amplitude = 8.0 }]\n\
                [[joints]]\nname = \"foot\"\nkind = \"revolute\"\nbetween = [\"ground\", \"stick.foot\"]\naxis = [0.0, 1.0, 0.0]\n\
                [time]\nend = 1.0\ntolerance = 1e-6\n";
    let stick = folder.path().join("stick.toml");
    std::fs::write(&stick, text).unwrap();
    let found = json(&["linearize", stick.to_str().unwrap(), "-o", &file, "--overwrite"]);
    let told = found["warnings"].to_string();
    // Closed form: √(m g l/(J + m l²)) = √(8/2).
    assert!(told.contains("unstable: 1 motion grows, at 2.000e0"), "{told}");
    // The weight has no moment about the foot.
    assert!(told.contains("move nothing: loads[0].gravity"), "{told}");
}

#[test]
fn an_input_that_is_a_rigid_motion_is_told_where_that_is_left_out() {
    let folder = tempfile::tempdir().unwrap();
    let scene = bar(folder.path(), "", "\"constant\"", "end = 0.01\ntolerance = 1e-6");
    let file = folder.path().join("x.mat").to_str().unwrap().to_owned();
    let weight = "loads=[{ kind = \"gravity\", direction = [0.0, 0.0, -1.0], amplitude = 9810.0 }]";
    let asked = ["linearize", &scene, "-o", &file, "--overwrite", "--set", weight];
    let told = json(&asked)["warnings"].to_string();
    assert!(!told.contains("move nothing"), "{told}");
    let told = json(&[&asked[..], &["--without-rigid"]].concat())["warnings"].to_string();
    assert!(told.contains("move nothing: loads[0].gravity"), "{told}");
}

/// Closed form: a slender bar that stands on a hinge falls as exp(st), s² = g (L/2)/(L²/3 + h²/12). Its static shapes are faster by 1e8 and more.
/// The bar with a stone at its tip that spins freely about the axis of its largest inertia does not grow, with two poles at zero for each
/// motion as a whole.
#[test]
fn slow_growth_is_told_beside_fast_shapes_and_a_free_spin_is_not() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("x.mat").to_str().unwrap().to_owned();
    let bar = |markers: &str, rest: &str| {
        format!(
            "title = \"Bar\"\nunits = {{ length = \"mm\", mass = \"Mg\", time = \"s\" }}\n[bodies.bar]\nmesh = \"{}\"\n\
             material = {{ young_modulus = 70000.0, poisson_ratio = 0.3, density = 2.7e-9 }}\n\
             modes = {{ flexible = 4, damping_ratio = 0.0 }}\npoints = {{ tip = [202.07, 0.0, 0.0] }}\nmarkers = {{ {markers} }}\n{rest}\
             [time]\nend = 1.0\ntolerance = 1e-6\n",
            root().join("meshes/rotating_bar.msh").display()
        )
    };
    let path = folder.path().join("bar.toml");
    let gravity = 3e-3;
    let standing = bar(
        "root = { group = \"root\" }",
        &format!(
            "loads = [{{ kind = \"gravity\", direction = [-1.0, 0.0, 0.0], amplitude = {gravity} }}]\n\
             [[joints]]\nname = \"foot\"\nkind = \"revolute\"\nbetween = [\"ground\", \"bar.root\"]\naxis = [0.0, 1.0, 0.0]\n"
        ),
    );
    std::fs::write(&path, standing).unwrap();
    let told = json(&["linearize", path.to_str().unwrap(), "-o", &file])["warnings"].to_string();
    let (length, height) = (202.07_f64, 10.0_f64);
    let growth = (gravity * 0.5 * length / (length * length / 3.0 + height * height / 12.0)).sqrt();
    let found = told.split("1 motion grows, at ").nth(1).and_then(|rest| rest.split(' ').next()).map(str::parse::<f64>);
    assert!(matches!(found, Some(Ok(found)) if (found / growth - 1.0).abs() < 2e-3), "{growth} {told}");
    let spinning = bar(
        "tip = { at = [202.07, 0.0, 0.0], radius = 7.5 }",
        "loads = [{ kind = \"force\", at = [150.0, 5.0, 0.0], direction = [0.0, 1.0, 0.5], amplitude = 2.0, \
         history = { kind = \"half-sine\", duration = 0.002 } }]\n[bodies.stone]\n\
         rigid = { mass = 1e-5, center_of_mass = [0.0, 0.0, 0.0], inertia = [[3e-3, 0.0, 0.0], [0.0, 4e-3, 0.0], [0.0, 0.0, 6e-3]] }\n\
         initial = { position = [202.07, 0.0, 0.0] }\nmarkers = { middle = { at = [0.0, 0.0, 0.0] } }\n\
         [[joints]]\nname = \"weld\"\nkind = \"fixed\"\nbetween = [\"bar.tip\", \"stone.middle\"]\n",
    );
    std::fs::write(&path, spinning).unwrap();
    for spin in ["0,0,0", "0,0,20"] {
        let asked = ["linearize", path.to_str().unwrap(), "-o", &file, "--overwrite", "--spin", spin];
        let told = json(&asked)["warnings"].to_string();
        assert!(!told.contains("unstable"), "{spin}: {told}");
    }
}

#[test]
fn spectra_that_are_none_are_refused_in_words() {
    let folder = tempfile::tempdir().unwrap();
    let scene = bar(folder.path(), CLAMP, "\"constant\"", "end = 0.01\ntolerance = 1e-6");
    let undamped = bar_text(CLAMP, "\"constant\"", "end = 0.01\ntolerance = 1e-6")
        .replace("damping_ratio = 0.05", "damping_ratio = 0.0");
    let undamped_scene = folder.path().join("undamped.toml");
    std::fs::write(&undamped_scene, undamped.replace("damping = true", "damping = false")).unwrap();
    let table = folder.path().join("spectra.csv");
    let refused = |scene: &str, text: &str, more: &[&str], words: &[&str]| {
        std::fs::write(&table, text).unwrap();
        let arguments = ["psd", scene, "--spectra", table.to_str().unwrap(), "-o", "out/none"];
        let output = flexframe(&[&arguments, more].concat());
        let message = String::from_utf8_lossy(&output.stderr).into_owned();
        assert!(!output.status.success(), "{text}");
        words.iter().for_each(|word| assert!(message.contains(word), "{word}: {message}"));
    };
    let flat = "frequency,loads[0].force\n10,1\n9000,1\n";
    refused(&scene, "frequency,loads[0].force\n10,1\n90,-2\n", &[], &["spectra.csv:3", "density -2", "0 or more"]);
    refused(&scene, "frequency,loads[0].force\n10,1\n5,2\n", &[], &["spectra.csv:3", "frequency 5"]);
    refused(&scene, "frequency,loads[0].force\n10,1\n20\n", &[], &["spectra.csv:3", "1 field(s)", "2 numbers"]);
    refused(&scene, "time,loads[0].force\n10,1\n20,1\n", &[], &["spectra.csv:1", "expected `frequency`"]);
    refused(&scene, flat, &["--band", "5:9000"], &["from 10 to 9000", "leave out 0.001"]);
    refused(&scene, flat, &["--band", "9:5"], &["band 9:5"]);
    refused(&scene, "frequency,loads[7].force\n10,1\n20,1\n", &[], &["no input `loads[7].force`", "loads[0].force"]);
    refused(
        &scene,
        "frequency,loads[0].force,coherence loads[0].force & base\n10,1,1\n20,1,1\n",
        &[],
        &["coherence loads[0].force & base", "no column"],
    );
    refused(undamped_scene.to_str().unwrap(), flat, &[], &["does not decay", "no mean square"]);
}

/// A, B, C and D of a linear model with its channels, as JSON has them.
fn linear_model(scene: &str, folder: &Path, more: &[&str]) -> Value {
    let file = folder.join("linear.json");
    json(&[&["linearize", scene, "-o", file.to_str().unwrap(), "--overwrite"], more].concat());
    serde_json::from_str(&std::fs::read_to_string(file).unwrap()).unwrap()
}

fn numbers(matrix: &Value) -> Vec<Vec<f64>> {
    let row = |row: &Value| row.as_array().unwrap().iter().map(|x| x.as_f64().unwrap()).collect();
    matrix.as_array().unwrap().iter().map(row).collect()
}

/// Closed form: the mean square of a sum of oscillators under white noise, Σ_r Σ_s of the modes of the linear model.
#[test]
fn white_noise_gives_the_mean_square_of_its_closed_form() {
    let folder = tempfile::tempdir().unwrap();
    let scene = bar(folder.path(), CLAMP, "\"constant\"", "end = 0.01\ntolerance = 1e-6");
    let stress = ["--set", "output.stress=true"];
    let space = linear_model(&scene, folder.path(), &[&stress[..], &["--outputs", "tip"]].concat());
    let [a, b, c] = ["A", "B", "C"].map(|name| numbers(&space[name]));
    let n = a.len() / 2;
    let modes: Vec<[f64; 2]> = (0..n).map(|k| [(-a[n + k][k]).sqrt(), -0.5 * a[n + k][n + k]]).collect();
    // ∫₀^∞ Re(H_r H_s*) df of two oscillators.
    let together = |[wa, da]: [f64; 2], [wb, db]: [f64; 2]| {
        let below = (wa * wa - wb * wb).powi(2) + 4.0 * (da + db) * (da * wb * wb + db * wa * wa);
        (da + db) / below
    };
    let density = 0.25;
    let cross = |row: &[f64], other: &[f64]| -> f64 {
        let pair = |r: usize, s: usize| row[r] * other[s] * b[n + r][0] * b[n + s][0] * together(modes[r], modes[s]);
        density * (0..n).flat_map(|r| (0..n).map(move |s| (r, s))).map(|(r, s)| pair(r, s)).sum::<f64>()
    };
    let names: Vec<&str> =
        space["outputs"].as_array().unwrap().iter().map(|output| output["name"].as_str().unwrap()).collect();
    let row = |name: &str| &c[names.iter().position(|other| *other == name).unwrap()][..];

    let table = folder.path().join("white.csv");
    std::fs::write(&table, format!("frequency,loads[0]\n0,{density}\n1e9,{density}\n")).unwrap();
    let out = folder.path().join("psd");
    let arguments = ["psd", &scene, "--spectra", table.to_str().unwrap(), "-o", out.to_str().unwrap()];
    let report = json(&[&arguments, &stress[..]].concat());
    let rms = |name: &str| {
        let all = report["outputs"].as_array().unwrap();
        all.iter().find(|output| output["output"] == name).unwrap()["rms"].as_f64().unwrap()
    };
    for name in ["tip.displacement.y", "tip.stress.xx", "tip.stress.xy"] {
        let expected = cross(row(name), row(name)).sqrt();
        assert!((rms(name) / expected - 1.0).abs() < 1e-8, "{name}: {} {expected}", rms(name));
    }
    let [xx, yy, zz, xy, yz, zx] =
        ["xx", "yy", "zz", "xy", "yz", "zx"].map(|letters| row(&format!("tip.stress.{letters}")));
    let normal = cross(xx, xx) + cross(yy, yy) + cross(zz, zz) - cross(xx, yy) - cross(yy, zz) - cross(zz, xx);
    let expected = (normal + 3.0 * (cross(xy, xy) + cross(yz, yz) + cross(zx, zx))).sqrt();
    assert!((rms("tip.von_mises") / expected - 1.0).abs() < 1e-8, "{} {expected}", rms("tip.von_mises"));
    // The velocity is an output of its own.
    let of_tip = report["outputs"].as_array().unwrap().iter().find(|o| o["output"] == "tip.displacement.y").unwrap();
    let apparent = of_tip["crossings"][0].as_f64().unwrap();
    let expected = rms("tip.velocity.y") / rms("tip.displacement.y") / TAU;
    assert!((apparent / expected - 1.0).abs() < 1e-9, "{apparent} {expected}");
    let ratio = of_tip["crossings"][3].as_f64().unwrap() / apparent;
    assert!((ratio / (-4.5_f64).exp() - 1.0).abs() < 1e-9, "{ratio}");
    let csv = std::fs::read_to_string(out.join("psd.csv")).unwrap();
    assert!(csv.starts_with("frequency,tip.displacement.x") && csv.lines().next().unwrap().ends_with("tip.von_mises"));
}

/// Conserved: inputs in step with each other are one input of both, and against each other they take each other away; that of two
/// forces alike.
#[test]
fn coherence_and_phase_of_two_inputs_count() {
    let folder = tempfile::tempdir().unwrap();
    let one = bar(folder.path(), CLAMP, "\"constant\"", "end = 0.01\ntolerance = 1e-6");
    let text = std::fs::read_to_string(&one).unwrap();
    let load = text[text.find("[[loads]]").unwrap()..text.find("[time]").unwrap()].to_owned();
    let two = folder.path().join("two.toml");
    std::fs::write(&two, text.replace("[time]", &format!("{load}[time]"))).unwrap();
    let rms = |more: &str, numbers: &str| {
        let table = folder.path().join("spectra.csv");
        let header = format!("frequency,loads[0].force,loads[1].force{more}");
        std::fs::write(&table, format!("{header}\n10,1,1{numbers}\n90000,1,1{numbers}\n")).unwrap();
        let out = folder.path().join("psd");
        let arguments = ["psd", two.to_str().unwrap(), "--spectra", table.to_str().unwrap(), "-o"];
        let report = json(&[&arguments, &[out.to_str().unwrap(), "--overwrite"][..]].concat());
        report["outputs"][1]["rms"].as_f64().unwrap()
    };
    let coherence = ",coherence loads[0].force & loads[1].force";
    let both = format!("{coherence},phase loads[0].force & loads[1].force");
    let apart = rms("", "");
    assert!((rms(coherence, ",1") / apart - 2.0_f64.sqrt()).abs() < 1e-9);
    assert!((rms(coherence, ",0") / apart - 1.0).abs() < 1e-9);
    assert!((rms(&both, ",1,90") / apart - 1.0).abs() < 1e-9);
    assert!((rms(&both, ",0.25,0") / apart - 1.5_f64.sqrt()).abs() < 1e-9);
    assert!(rms(&both, ",1,180") < 1e-6 * apart);
}

/// Responses by name at a frequency: real and imaginary part.
fn response(scene: &str, folder: &Path, input: &str, outputs: &str, frequency: f64, more: &[&str]) -> Vec<[f64; 2]> {
    let out = folder.join("frf");
    let at = format!("{frequency:e}:{:e}:2", frequency + 1.0);
    let (out, at) = (out.to_str().unwrap(), at.as_str());
    let arguments =
        ["frf", scene, "--frequencies", at, "-o", out, "--overwrite", "--inputs", input, "--outputs", outputs];
    json(&[&arguments, more].concat());
    let table = std::fs::read_to_string(Path::new(out).join("frf.csv")).unwrap();
    let row: Vec<f64> = table.lines().nth(1).unwrap().split(',').map(|x| x.parse().unwrap()).collect();
    row[1..]
        .chunks(2)
        .map(|pair| [pair[0] * pair[1].to_radians().cos(), pair[0] * pair[1].to_radians().sin()])
        .collect()
}

#[track_caller]
fn assert_alike(found: &[[f64; 2]], expected: &[[f64; 2]], bound: f64) {
    let size = expected.iter().map(|[re, im]| re.hypot(*im)).fold(0.0, f64::max);
    assert!(size > 0.0 && found.len() == expected.len());
    for (a, b) in found.iter().zip(expected) {
        assert!((a[0] - b[0]).hypot(a[1] - b[1]) < bound * size, "{found:?} {expected:?}");
    }
}

/// Independent reference: a load of kind "base-acceleration", which is a static force on the modes.
/// Closed form: at frequency 0 the whole body has the acceleration of its base, and the support carries its mass.
#[test]
fn a_base_motion_is_an_input() {
    let folder = tempfile::tempdir().unwrap();
    let scene = bar(folder.path(), CLAMP, "\"constant\"", "end = 0.01\ntolerance = 1e-6");
    let text = std::fs::read_to_string(&scene).unwrap();
    let load = "[[loads]]\nkind = \"base-acceleration\"\ndirection = [0, 1, 0]\namplitude = 1.0\nhistory = { kind = \"step\", at = 1.0 }\n";
    let shaken = folder.path().join("shaken.toml");
    std::fs::write(&shaken, text.replace("[time]", &format!("{load}[time]"))).unwrap();
    let shaken = shaken.to_str().unwrap();
    let at = |input: &str, outputs: &str, f: f64| response(shaken, folder.path(), input, outputs, f, &[]);
    assert_alike(&at("base.acceleration.y", "tip.displacement", 50.0), &at("loads[1]", "tip.displacement", 50.0), 1e-9);
    assert_alike(&at("base.acceleration.y", "tip.acceleration.y", 0.0), &[[1.0, 0.0]], 1e-9);
    // A load that stands for it is the same input, and the acceleration relative to the support has a name of its own.
    for frequency in [10.0, 50.0] {
        let absolute = at("base.acceleration.y", "tip.acceleration.y", frequency);
        assert_alike(&at("loads[1]", "tip.acceleration.y", frequency), &absolute, 1e-9);
        let relative = at("base.acceleration.y", "tip.acceleration_relative.y", frequency);
        assert_alike(&at("loads[1]", "tip.acceleration_relative.y", frequency), &relative, 1e-9);
        assert_alike(&[[relative[0][0] + 1.0, relative[0][1]]], &absolute, 1e-8);
    }
    // A turn of the base about the origin: ω × x.
    let turned = at("base.angular_acceleration.z", "tip.acceleration.y", 0.0);
    assert_alike(&turned, &[[202.07, 0.0]], 1e-9);
    let mass = json(&["modes", shaken])["body"]["mass"].as_f64().unwrap();
    assert_alike(&at("base.acceleration.y", "reaction.force.y", 0.0), &[[mass, 0.0]], 1e-6);
    // The support holds the load, and is above it near the resonance.
    assert_alike(&at("loads[0]", "reaction.force.y", 0.0), &[[-1e-3 / 1.25_f64.sqrt(), 0.0]], 1e-9);
    // About the origin: −x × F.
    assert_alike(&at("loads[0]", "reaction.moment.z", 0.0), &[[-202.07e-3 / 1.25_f64.sqrt(), 0.0]], 1e-6);
}

/// Independent reference: the same bar in 24 modes. Two modes miss more than 1 % of each rate of the tip, their static shapes less than 1e-4.
#[test]
fn static_shapes_are_in_all_rates_of_a_response() {
    let folder = tempfile::tempdir().unwrap();
    let scene = bar(folder.path(), CLAMP, "\"constant\"", "end = 0.01\ntolerance = 1e-6");
    let at = |modes: &str, shapes: &str, output: &str| {
        let set = ["--set", modes, "--set", shapes];
        response(&scene, folder.path(), "loads[0]", output, 20.0, &set)[0]
    };
    for output in ["tip.displacement.y", "tip.velocity.y", "tip.acceleration.y"] {
        let whole = at("modes.flexible=24", "modes.static_correction=true", output);
        let off = |shapes: &str| {
            let found = at("modes.flexible=2", shapes, output);
            (found[0] - whole[0]).hypot(found[1] - whole[1]) / whole[0].hypot(whole[1])
        };
        let [with, without] = ["modes.static_correction=true", "modes.static_correction=false"].map(off);
        assert!(with < 1e-4 && without > 1e-2, "{output}: {with:e} {without:e}");
    }
}

/// Independent reference: the clamp, where the drive stands still, and its own input; in a spin, the load along the axis.
/// Closed form: in a spin, too, the support carries the mass along the axis.
#[test]
fn a_base_of_a_driven_body_is_an_input() {
    let folder = tempfile::tempdir().unwrap();
    let none = "{ kind = \"step\", at = 1.0 }";
    let clamped = bar(folder.path(), CLAMP, none, "end = 0.01\ntolerance = 1e-6");
    let of_clamp = |input: &str, output: &str| response(&clamped, folder.path(), input, output, 50.0, &[]);
    let inputs = ["base.acceleration.y", "base.angular_acceleration.y", "base.angular_acceleration.z"];
    let outputs = ["tip.displacement", "tip.acceleration", "reaction.force", "reaction.moment"];
    let expected: Vec<_> = inputs.iter().flat_map(|input| outputs.map(|output| of_clamp(input, output))).collect();
    let hinge = |history: &str| {
        format!(
            "[[constraints]]\nkind = \"hinge\"\nat = [0, 0, 0]\naxis = [0, 0, 1]\ngroup = \"root\"\n\
             motion = {{ amplitude = 300.0, history = {history} }}"
        )
    };
    let still = bar(folder.path(), &hinge(none), none, "end = 0.01\ntolerance = 1e-6");
    let of_hinge = |input: &str, output: &str| response(&still, folder.path(), input, output, 50.0, &[]);
    let found = inputs.iter().flat_map(|input| outputs.map(|output| of_hinge(input, output)));
    for (found, expected) in found.zip(&expected) {
        assert_alike(&found, expected, 1e-6);
    }
    let turned = of_hinge("drive.acceleration", "tip.displacement");
    assert_alike(&of_hinge("base.angular_acceleration.z", "tip.displacement"), &turned, 1e-9);

    let spinning = bar(folder.path(), &hinge("\"constant\""), none, "end = 0.01\ntolerance = 1e-6");
    let load = format!(
        "[[loads]]\nkind = \"base-acceleration\"\ndirection = [0, 0, 1]\namplitude = 1.0\nhistory = {none}\n[time]"
    );
    let text = std::fs::read_to_string(&spinning).unwrap().replace("[time]", &load);
    std::fs::write(&spinning, text).unwrap();
    let of_spin = |input: &str, output: &str, f: f64| response(&spinning, folder.path(), input, output, f, &[]);
    let along = of_spin("loads[1]", "tip.displacement", 50.0);
    assert_alike(&of_spin("base.acceleration.z", "tip.displacement", 50.0), &along, 1e-9);
    let mass = json(&["modes", &spinning])["body"]["mass"].as_f64().unwrap();
    assert_alike(&of_spin("base.acceleration.z", "reaction.force.z", 0.0), &[[mass, 0.0]], 1e-6);
    let refused = flexframe(&["linearize", &spinning, "--inputs", "base.angular_acceleration.x", "-o", "spin.mat"]);
    assert!(!refused.status.success() && String::from_utf8_lossy(&refused.stderr).contains("base.acceleration.z"));
}

/// Independent reference: the same bar in a fixed joint of a free body, whose equations are linearised in another way.
#[test]
fn the_reaction_of_a_joint_is_that_of_a_support() {
    let folder = tempfile::tempdir().unwrap();
    let joint = "[[joints]]\nname = \"weld\"\nkind = \"fixed\"\nbetween = [\"ground\", \"body.root\"]\n";
    let held = bar(folder.path(), CLAMP, "\"constant\"", "end = 0.01\ntolerance = 1e-6");
    let text = std::fs::read_to_string(&held).unwrap().replace(CLAMP, "");
    let free = folder.path().join("free.toml");
    let text = text.replace("[modes]\nflexible = 6", "[modes]\nflexible = 16").replace("static_correction = false", "");
    std::fs::write(
        &free,
        text.replace("[time]", &format!("{joint}[time]"))
            .replace("[output]", "[body.markers]\nroot = { group = \"root\" }\n[output]"),
    )
    .unwrap();
    let free = free.to_str().unwrap();
    for (outputs, of_joint) in [("reaction.force.y", "weld.force.y"), ("reaction.moment.z", "weld.moment.z")] {
        // Slow against the first mode, so that the other shapes of the two bodies do not count.
        let expected = response(&held, folder.path(), "loads[0]", outputs, 1.0, &[]);
        let found = response(free, folder.path(), "loads[0]", of_joint, 1.0, &[]);
        assert_alike(&found, &expected, 1e-3);
    }
}

/// Independent reference: a run whose drive is shaken by 1e-4 of its speed beside it, in a spin, swung in.
#[test]
fn a_drive_in_a_spin_is_an_input() {
    let folder = tempfile::tempdir().unwrap();
    let (spin, shaken, frequency) = (300.0, 0.03, 40.0);
    let hinge = |history: &str| {
        format!(
            "[[constraints]]\nkind = \"hinge\"\nat = [0, 0, 0]\naxis = [0, 0, 1]\ngroup = \"root\"\nmotion = {{ amplitude = {spin:?}, \
             history = {history} }}"
        )
    };
    let none = "{ kind = \"step\", at = 1e3 }";
    let formula = format!("1 + {:?}*sin(2*pi*{frequency:?}*t)", shaken / spin);
    let formula = format!("{{ kind = \"expression\", formula = \"{formula}\" }}");
    let end = 0.3;
    let scene = bar(folder.path(), &hinge(&formula), none, &format!("end = {end}\ntolerance = 1e-10"));
    let out = folder.path().join("out");
    let interval = format!("output.interval={:e}", 1.0 / frequency / 40.0);
    json(&["run", &scene, "--no-check", "-o", out.to_str().unwrap(), "--set", &interval]);
    let csv = folder.path().join("bar.csv");
    let (file, csv_file) = (out.join("bar.h5"), csv.to_str().unwrap());
    let columns = "points/tip/elastic_displacement_body,reaction/moment_body";
    let written = flexframe(&["export", file.to_str().unwrap(), "--csv", csv_file, "--columns", columns]);
    assert!(written.status.success(), "{}", String::from_utf8_lossy(&written.stderr));
    let text = std::fs::read_to_string(&csv).unwrap();
    let header: Vec<&str> = text.lines().next().unwrap().split(',').collect();
    let rows: Vec<Vec<f64>> = text
        .lines()
        .skip(1)
        .map(|line| line.split(',').map(|x| x.parse().unwrap()).collect())
        .filter(|row: &Vec<f64>| row[0] > end - 4.0 / frequency)
        .collect();
    let quiet = bar(folder.path(), &hinge("\"constant\""), none, "end = 0.01\ntolerance = 1e-6");
    for (name, output) in [
        ("points/tip/elastic_displacement_body y", "tip.displacement.y"),
        ("reaction/moment_body z", "reaction.moment.z"),
    ] {
        let column = header.iter().position(|column| column.starts_with(name)).unwrap();
        // Least squares of a sin + b cos + c.
        let basis = |t: f64| [(TAU * frequency * t).sin(), (TAU * frequency * t).cos(), 1.0];
        let found = least_squares(rows.iter().map(|row| (basis(row[0]), row[column])));
        // The acceleration is 2πf shaken cos.
        let amplitude = TAU * frequency * shaken;
        let [re, im] = response(&quiet, folder.path(), "drive", output, frequency, &[])[0];
        let expected = [-im * amplitude, re * amplitude];
        let size = expected[0].hypot(expected[1]);
        assert!(
            (found[0] - expected[0]).hypot(found[1] - expected[1]) < 1e-5 * size,
            "{output} {found:?} {expected:?}"
        );
    }
}

/// Independent reference: the bar on a driven hinge of its support, whose equations are linearised in another way.
#[test]
fn a_driven_joint_is_an_input() {
    let folder = tempfile::tempdir().unwrap();
    let none = "{ kind = \"step\", at = 1.0 }";
    // At rest, and in a spin of 300 rad/s: there the moment, and the force along the bar, which follows the rate.
    for (of_hinge, of_drive, wrench) in [
        (none, none, ["moment.z", "force.y"]),
        ("\"constant\"", "{ kind = \"expression\", formula = \"t\" }", ["moment.z", "force.x"]),
    ] {
        let hinge = format!(
            "[[constraints]]\nkind = \"hinge\"\nat = [0, 0, 0]\naxis = [0, 0, 1]\ngroup = \"root\"\n\
             motion = {{ amplitude = 300.0, history = {of_hinge} }}"
        );
        let held = bar(folder.path(), &hinge, none, "end = 0.01\ntolerance = 1e-6");
        let joint = format!(
            "[[joints]]\nname = \"pin\"\nkind = \"revolute\"\nbetween = [\"ground\", \"body.root\"]\naxis = [0, 0, 1]\n\
             drive = {{ amplitude = 300.0, history = {of_drive} }}\n[time]"
        );
        let text = std::fs::read_to_string(&held).unwrap().replace(&hinge, "");
        let text =
            text.replace("[modes]\nflexible = 6", "[modes]\nflexible = 16").replace("static_correction = false", "");
        let markers = "[body.markers]\nroot = { group = \"root\" }\n[output]";
        let free = folder.path().join("free.toml");
        std::fs::write(&free, text.replace("[time]", &joint).replace("[output]", markers)).unwrap();
        let free = free.to_str().unwrap();
        for output in wrench {
            // Slow against the first mode, so that the other shapes of the two bodies do not count.
            let (of_support, of_joint) = (format!("reaction.{output}"), format!("pin.{output}"));
            let expected = response(&held, folder.path(), "drive", &of_support, 1.0, &[]);
            let found = response(free, folder.path(), "pin.drive", &of_joint, 1.0, &[]);
            assert_alike(&found, &expected, 1e-3);
        }
    }
}

/// a, b and c of a₀ x₀ + a₁ x₁ + a₂ x₂ = y.
fn least_squares(rows: impl Iterator<Item = ([f64; 3], f64)>) -> [f64; 3] {
    let mut system = [[0.0; 4]; 3];
    for (basis, y) in rows {
        for i in 0..3 {
            (0..3).for_each(|j| system[i][j] += basis[i] * basis[j]);
            system[i][3] += basis[i] * y;
        }
    }
    for i in 0..3 {
        for k in (0..3).filter(|k| *k != i) {
            let factor = system[k][i] / system[i][i];
            (0..4).for_each(|j| system[k][j] -= factor * system[i][j]);
        }
    }
    std::array::from_fn(|i| system[i][3] / system[i][i])
}

/// Independent reference: the spin that a drive has at that time, given from the beginning.
#[test]
fn a_model_may_be_about_a_later_time() {
    let folder = tempfile::tempdir().unwrap();
    let hinge = |amplitude: f64, history: &str| {
        format!(
            "[[constraints]]\nkind = \"hinge\"\nat = [0, 0, 0]\naxis = [0, 0, 1]\ngroup = \"root\"\n\
             motion = {{ amplitude = {amplitude:?}, history = {history} }}"
        )
    };
    let none = "{ kind = \"step\", at = 1e3 }";
    let poles = |support: &str, more: &[&str]| -> Vec<f64> {
        let scene = bar(folder.path(), support, none, "end = 0.02\ntolerance = 1e-6");
        let file = folder.path().join("x.json");
        let report = json(&[&["linearize", &scene, "-o", file.to_str().unwrap(), "--overwrite"], more].concat());
        report["poles"].as_array().unwrap().iter().map(|pole| pole["frequency"].as_f64().unwrap()).collect()
    };
    let rising = "{ kind = \"expression\", formula = \"100*t\" }";
    let later = poles(&hinge(200.0, rising), &["--time", "0.01"]);
    let steady = poles(&hinge(200.0, "\"constant\""), &[]);
    let still = poles(&hinge(200.0, rising), &[]);
    assert!(later.iter().zip(&steady).all(|(a, b)| (a / b - 1.0).abs() < 1e-9), "{later:?} {steady:?}");
    assert!((still[0] / steady[0] - 1.0).abs() > 1e-3, "{still:?}");
}

/// Closed form: motions that nothing resists have poles of zero, and not of rounding.
#[test]
fn rigid_motions_have_poles_of_zero() {
    let folder = tempfile::tempdir().unwrap();
    let scene = bar(folder.path(), "", "{ kind = \"step\", at = 1.0 }", "end = 0.01\ntolerance = 1e-6");
    let file = folder.path().join("free.json");
    let report = json(&["linearize", &scene, "-o", file.to_str().unwrap()]);
    let poles: Vec<f64> =
        report["poles"].as_array().unwrap().iter().map(|pole| pole["frequency"].as_f64().unwrap()).collect();
    let zeros = poles.iter().take_while(|frequency| **frequency == 0.0).count();
    assert!(zeros == 12 && poles[12] > 100.0, "{poles:?}");
    // Balanced truncation keeps them.
    let reduced = json(&["linearize", &scene, "-o", file.to_str().unwrap(), "--overwrite", "--reduce", "balanced:16"]);
    assert_eq!(reduced["states"], 16);
    assert!(reduced["error_bound"].as_f64().unwrap() > 0.0);
}

/// Independent reference: runs with the shock as the history of the load: with one mode the sums are the peak of the run, with six it is
/// between them.
/// Closed form: under a slow push of the base the tip's acceleration is that of the base.
#[test]
fn sums_of_modes_are_about_the_peaks_of_a_run() {
    let folder = tempfile::tempdir().unwrap();
    let table = folder.path().join("pulse.csv");
    let duration = 3e-3;
    let rows = (0..=60).map(|k| f64::from(k) / 60.0);
    let rows = rows.map(|s| format!("{:e},{:e}\n", s * duration, (std::f64::consts::PI * s).sin()));
    std::fs::write(&table, format!("time,value\n{}", rows.collect::<String>())).unwrap();
    let table = table.to_str().unwrap();
    let history = format!("{{ kind = \"table\", file = \"{table}\" }}");
    let scene = bar(folder.path(), CLAMP, &history, "end = 0.03\ntolerance = 1e-9");
    let out = folder.path().join("out");
    // Of the last one the two fastest modes do not swing.
    for (modes, damping, within) in
        [("1", "0.05", 2e-4), ("6", "0.05", 0.2), ("6", "[0.05, 0.05, 0.05, 0.05, 1.0, 1.5]", 0.2)]
    {
        let count = format!("modes={{flexible={modes},damping_ratio={damping},static_correction=false}}");
        let shock = ["shock", &scene, "--table", table, "--input", "loads[0]", "--outputs", "tip.displacement"];
        let report = json(&[&shock[..], &["--set", &count]].concat());
        assert_eq!(report["modes"].as_array().unwrap().len().to_string(), modes);
        let run = ["run", &scene, "--no-check", "--overwrite", "-o", out.to_str().unwrap(), "--set", &count];
        json(&[&run[..], &["--set", "output.interval=2e-5"]].concat());
        let csv = folder.path().join("bar.csv");
        let file = out.join("bar.h5");
        let columns = "points/tip/elastic_displacement_body";
        let csv_file = csv.to_str().unwrap();
        let export = ["export", file.to_str().unwrap(), "--csv", csv_file, "--columns", columns, "--overwrite"];
        assert!(flexframe(&export).status.success());
        let text = std::fs::read_to_string(&csv).unwrap();
        let mut peaks = [0.0_f64; 3];
        for line in text.lines().filter(|line| line.starts_with(|c: char| c.is_ascii_digit())) {
            let fields: Vec<f64> = line.split(',').map(|field| field.parse().unwrap()).collect();
            for (peak, value) in peaks.iter_mut().zip(&fields[fields.len() - 3..]) {
                *peak = peak.max(value.abs());
            }
        }
        // Along y and z the bar bends; along x nothing moves at first order.
        for (axis, peak) in peaks.iter().enumerate().skip(1) {
            let output = &report["outputs"][axis];
            let [absolute, srss, cqc] = ["absolute", "srss", "cqc"].map(|sum| output[sum].as_f64().unwrap());
            assert!(*peak <= absolute * (1.0 + 1e-4), "{peak:e} {output}");
            for sum in [srss, cqc] {
                assert!((sum / peak - 1.0).abs() < within, "{modes} modes: {peak:e} {output}");
            }
        }
    }

    // 200 times as long as the first period.
    let slow = folder.path().join("slow.csv");
    let rows = (0..=60).map(|k| f64::from(k) / 60.0);
    let rows = rows.map(|s| format!("{:e},{:e}\n", 20.0 * s, 3.0 * (std::f64::consts::PI * s).sin().powi(2)));
    std::fs::write(&slow, rows.collect::<String>()).unwrap();
    let arguments = [
        "shock",
        &scene,
        "--table",
        slow.to_str().unwrap(),
        "--input",
        "base.acceleration.y",
        "--outputs",
        "tip.acceleration.y",
    ];
    let report = json(&arguments);
    for sum in ["absolute", "srss", "cqc"] {
        let sum = report["outputs"][0][sum].as_f64().unwrap();
        assert!((sum / 3.0 - 1.0).abs() < 1e-3, "{report}");
    }
    assert!(report["modes"][0]["follows"].as_f64().unwrap() > 0.999);

    let refused = |arguments: &[&str]| {
        let done = flexframe(&[&["shock", &scene, "--table", table][..], arguments].concat());
        assert!(!done.status.success());
        String::from_utf8_lossy(&done.stderr).into_owned()
    };
    assert!(refused(&["--input", "base.acceleration"]).contains("expected one, which follows the table"));
    assert!(refused(&["--input", "base.acceleration.w"]).contains("base.acceleration.w"));
    let velocities = refused(&["--input", "base.acceleration.y", "--outputs", "tip.velocity"]);
    assert!(velocities.contains("velocities and rates alone, of which a shock has no sums"), "{velocities}");
}
