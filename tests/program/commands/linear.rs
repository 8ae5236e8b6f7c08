//! `flexframe linearize` and `flexframe frf`. Needs a Python with SciPy, which `FLEXFRAME_READERS` names (`./dev test` sees to it).

use std::f64::consts::TAU;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use serde_json::Value;

fn root() -> PathBuf {
    PathBuf::from(concat!(env!("CARGO_MANIFEST_DIR"), "/../.."))
}

fn flexframe(arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_flexframe")).args(arguments).current_dir(root()).output().unwrap()
}

#[track_caller]
fn json(arguments: &[&str]) -> Value {
    let output = flexframe(&[arguments, &["--json"]].concat());
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    serde_json::from_slice(&output.stdout).unwrap()
}

/// The bar on a support, pushed at its tip.
fn bar(folder: &Path, support: &str, history: &str, time: &str) -> String {
    let text = format!(
        "title = \"Bar\"\nunits = {{ length = \"mm\", mass = \"Mg\", time = \"s\" }}\n[body]\nmesh = \"{}\"\n\
         material = {{ young_modulus = 70000.0, poisson_ratio = 0.3, density = 2.7e-9 }}\n[modes]\nflexible = 6\n\
         damping_ratio = 0.05\nstatic_correction = false\n{support}\n[[loads]]\nkind = \"force\"\nat = [202.07, 0.0, 0.0]\n\
         direction = [0, 1, 0.5]\namplitude = 1e-3\nhistory = {history}\n[time]\n{time}\n\
         [effects]\ndamping = true\nlarge_deflection = false\ngeometric_stiffening = false\n[output]\n\
         points = {{ tip = [202.07, 0.0, 0.0] }}\n",
        root().join("meshes/rotating_bar.msh").display()
    );
    let path = folder.join("bar.toml");
    std::fs::write(&path, text).unwrap();
    path.to_str().unwrap().to_owned()
}

const CLAMP: &str = "[[constraints]]\nkind = \"clamp\"\ngroup = \"root\"";

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
    refused(&["linearize", &scene, "-o", &at("x.mat"), "--order", "99"], 4, &["order 99", "1 to 12"]);
    refused(&["linearize", &scene, "-o", &at("x.mat"), "--spin", "0,0,1"], 4, &["--spin of a body that is held"]);
    refused(&["frf", &scene, "--frequencies", "5:1:9", "-o", &at("f")], 2, &["5:1:9", "0 ≤ start < end"]);
    refused(
        &["frf", &scene, "--frequencies", "1:5:9", "--outputs", "top", "-o", &at("f")],
        2,
        &["no output `top`", "tip.displacement.x"],
    );
    let balanced = json(&["linearize", &scene, "-o", &at("x.mat"), "--order", "4"]);
    assert!(balanced["error_bound"].as_f64().unwrap() > 0.0 && balanced["states"] == 4);
}
