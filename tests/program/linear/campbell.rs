//! `flexframe campbell` against rotating beams.

use std::f64::consts::TAU;

use nalgebra::{DMatrix, DVector};
use serde_json::Value;

use crate::program::{flexframe, json, root};

const YOUNG: f64 = 70_000.0;
const DENSITY: f64 = 2.7e-9;
const LENGTH: f64 = 202.07;
const SIDE: f64 = 10.0;

/// Independent reference: a clamped bar of slenderness 70 that spins about an axis across it through its root, hub
/// radius 0: η, then flap 1, 2, 3 (exact, thin beam), chord 1 without and with Coriolis forces (published). From
/// rotating_bar.csv, given with the project. Unit of frequencies and of η: √(EI/(ρAL⁴)).
const THIN_BEAM: [(f64, [f64; 3], f64, Option<f64>); 8] = [
    (0.0, [3.5160, 22.0345, 61.6972], 3.5160, None),
    (1.0, [3.6816, 22.1810, 61.8418], 3.5432, None),
    (2.0, [4.1373, 22.6149, 62.2732], 3.6218, Some(3.6195)),
    (4.0, [5.5850, 24.2733, 63.9668], 3.8977, Some(3.888)),
    (6.0, [7.3604, 26.8091, 66.6839], 4.2632, Some(4.2393)),
    (8.0, [9.2568, 29.9954, 70.2930], 4.6571, Some(4.6105)),
    (10.0, [11.2023, 33.6404, 74.6493], 5.0490, Some(4.97)),
    (12.0, [13.1702, 37.6031, 79.6145], 5.4270, None),
];

/// √(EI/(ρAL⁴)), rad/s.
fn unit() -> f64 {
    (YOUNG * SIDE.powi(2) / 12.0 / (DENSITY * LENGTH.powi(4))).sqrt()
}

/// The bar of `examples/rotating_bar.toml` with a number of modes and a section `[effects]`, spinning at η = 0, 1, …, 12.
fn spinning_bar(modes: usize, effects: &str) -> Value {
    let folder = tempfile::tempdir().unwrap();
    let text = std::fs::read_to_string(root().join("examples/rotating_bar.toml")).unwrap();
    let mesh = root().join("meshes/rotating_bar.msh");
    let text = text.replace("../meshes/rotating_bar.msh", mesh.to_str().unwrap());
    let scene = folder.path().join("bar.toml");
    let kept = format!("flexible = {modes}\n[effects]\n{effects}");
    assert!(text.contains("flexible = 12"));
    std::fs::write(&scene, text.replace("flexible = 12", &kept)).unwrap();
    let speeds = format!("0:{}:13", 12.0 * unit());
    let out = folder.path().to_str().unwrap();
    json(&["campbell", scene.to_str().unwrap(), "--axis", "z", "--speeds", &speeds, "-o", out])
}

/// Frequency of a branch at an η, unit √(EI/(ρAL⁴)).
fn frequency(report: &Value, branch: usize, eta: f64) -> f64 {
    report["branches"][branch]["frequency"][eta as usize].as_f64().unwrap() * TAU / unit()
}

/// Chord and flap of pair k = 0, 1, 2, as branches: their frequencies are equal at rest, and the flap's is higher in spin.
fn pair(report: &Value, k: usize) -> [usize; 2] {
    let [a, b] = [2 * k, 2 * k + 1];
    if frequency(report, a, 8.0) < frequency(report, b, 8.0) { [a, b] } else { [b, a] }
}

#[test]
fn a_spinning_bar_follows_the_tables_of_thin_beams() {
    let with = spinning_bar(12, "coriolis = true");
    let without = spinning_bar(12, "coriolis = false");
    // Measured: flap at most 0.146 %, chord 0.187 % (without) and 0.168 % (with Coriolis forces). That is with 12 modes,
    // which is not the limit: few modes are too stiff and make up for the shear that the thin beam has not. With 16 modes
    // the chord without Coriolis is 0.301 % off at η = 12, with 80 0.350 % at η = 10 and 0.476 % at 12 (with Coriolis
    // 0.336 % at 10); see the test against a Timoshenko beam.
    for (eta, flap, chord, chord_coriolis) in THIN_BEAM {
        let [c, f] = pair(&without, 0);
        let off = frequency(&without, f, eta) / flap[0] - 1.0;
        assert!(off.abs() < 0.003, "flap, eta {eta}: {off}");
        let off = frequency(&without, c, eta) / chord - 1.0;
        assert!(off.abs() < 0.003, "chord, eta {eta}: {off}");
        let [c, f] = pair(&with, 0);
        let off = frequency(&with, f, eta) / flap[0] - 1.0;
        assert!(off.abs() < 0.003, "flap with Coriolis, eta {eta}: {off}");
        if let Some(chord) = chord_coriolis {
            let off = frequency(&with, c, eta) / chord - 1.0;
            assert!(off.abs() < 0.003, "chord with Coriolis, eta {eta}: {off}");
        }
    }
    // Measured: at most 0.5 % and 0.6 %. Flap 3 crosses the torsion at η = 10; the branches are followed across.
    for k in [1, 2] {
        let [_, f] = pair(&without, k);
        for (eta, flap, ..) in &THIN_BEAM[1..] {
            let rise = frequency(&without, f, *eta).powi(2) - frequency(&without, f, 0.0).powi(2);
            let expected = flap[k].powi(2) - THIN_BEAM[0].1[k].powi(2);
            assert!((rise / expected - 1.0).abs() < 0.02, "flap {}, eta {eta}: {rise} {expected}", k + 1);
        }
    }
    // Torsion of a square: √(GJ/(ρ I_p)) π/(2L) with J = 0.1406 a⁴; here the clamp hinders warping too, measured +1.9 %.
    // It is stiffened less, and below flap 3 at η = 12.
    let torsion = (YOUNG / 2.0 * 0.1406 / (DENSITY / 6.0)).sqrt() * TAU / 4.0 / LENGTH / unit();
    assert!((frequency(&without, 6, 0.0) / torsion - 1.0).abs() < 0.03, "{torsion}");
    assert!((frequency(&without, 6, 12.0) / frequency(&without, 6, 0.0) - 1.0).abs() < 0.02);
    assert!(frequency(&without, 6, 12.0) < frequency(&without, 4, 12.0).min(frequency(&without, 5, 12.0)));
}

/// Lowest frequency of a clamped, spinning Timoshenko beam of the bar's section (κ = 5/6 for ν = 0), by Ritz: without
/// Coriolis forces, with rotary inertia, the centrifugal forces of turning sections, and the stress of the spin on them.
fn timoshenko(eta: f64, in_plane: bool) -> f64 {
    const TERMS: usize = 10;
    const CELLS: usize = 200;
    let (area, second) = (SIDE.powi(2), SIDE.powi(4) / 12.0);
    let shear = YOUNG / 2.0 * 5.0 / 6.0 * area;
    let spin = (eta * unit()).powi(2);
    let mut stiffness = DMatrix::<f64>::zeros(2 * TERMS, 2 * TERMS);
    let mut mass = stiffness.clone();
    for cell in 0..CELLS {
        for (offset, weight) in [(-(0.6_f64.sqrt()), 5.0), (0.0, 8.0), (0.6_f64.sqrt(), 5.0)] {
            let s = (cell as f64 + 0.5 + 0.5 * offset) / CELLS as f64;
            let w = weight / 18.0 / CELLS as f64 * LENGTH;
            // s T_k(2s − 1), which are zero at the root, and their rates along the beam.
            let (mut value, mut rate) = ([0.0; TERMS], [0.0; TERMS]);
            for k in 0..TERMS {
                let (angle, n) = ((2.0 * s - 1.0).acos(), k as f64);
                value[k] = s * (n * angle).cos();
                rate[k] = ((n * angle).cos() + s * 2.0 * n * (n * angle).sin() / angle.sin()) / LENGTH;
            }
            let tension = 0.5 * DENSITY * area * spin * LENGTH.powi(2) * (1.0 - s * s);
            let outwards = if in_plane { spin } else { 0.0 };
            // Turning sections are pulled outwards along the bar; in the plane of spin the stress across the bar,
            // ∫σ_yy dA = Ω²ρI, holds just as much against it.
            let turning = if in_plane { 0.0 } else { spin };
            for i in 0..TERMS {
                for j in 0..TERMS {
                    let (vv, dd) = (w * value[i] * value[j], w * rate[i] * rate[j]);
                    mass[(i, j)] += DENSITY * area * vv;
                    mass[(TERMS + i, TERMS + j)] += DENSITY * second * vv;
                    stiffness[(i, j)] += (shear + tension) * dd - outwards * DENSITY * area * vv;
                    stiffness[(TERMS + i, TERMS + j)] +=
                        (YOUNG + tension / area) * second * dd + (shear - turning * DENSITY * second) * vv;
                    stiffness[(i, TERMS + j)] -= w * shear * rate[i] * value[j];
                    stiffness[(TERMS + j, i)] -= w * shear * rate[i] * value[j];
                }
            }
        }
    }
    let factor = stiffness.clone().lu();
    let mut shape = DVector::from_element(2 * TERMS, 1.0);
    for _ in 0..60 {
        shape = factor.solve(&(&mass * &shape)).unwrap().normalize();
    }
    (shape.dot(&(&stiffness * &shape)) / shape.dot(&(&mass * &shape))).sqrt() / unit()
}

/// Independent reference: a Timoshenko beam by Ritz.
#[test]
fn with_many_modes_the_bar_is_a_timoshenko_beam() {
    // The thin beam is 0.16 % above this one at rest, and its chord 0.57 % at η = 12.
    assert!((timoshenko(0.0, true) / 3.5160 - 1.0).abs() < 0.002);
    let report = spinning_bar(80, "coriolis = false");
    let [c, f] = pair(&report, 0);
    for eta in [0.0, 4.0, 8.0, 12.0] {
        let flap = frequency(&report, f, eta) / timoshenko(eta, false) - 1.0;
        let chord = frequency(&report, c, eta) / timoshenko(eta, true) - 1.0;
        // Measured: 1.5e-4 at rest (the mesh); at η = 12 2.4e-4 and 9.9e-4.
        assert!(flap.abs() < 5e-4 && chord.abs() < 1.5e-3, "eta {eta}: flap {flap:e}, chord {chord:e}");
    }
}

/// Closed form: ω² = ω₀² − Ω², and beyond ω₀ growth by √(Ω² − ω₀²).
#[test]
fn without_stiffening_the_chord_falls_to_zero_and_then_grows() {
    let report = spinning_bar(12, "coriolis = false\ngeometric_stiffening = false");
    let falling = (0..2).min_by(|&a, &b| frequency(&report, a, 3.0).total_cmp(&frequency(&report, b, 3.0))).unwrap();
    let at_rest = frequency(&report, falling, 0.0);
    // ω² = ω₀² − Ω²: the whole motion is in the plane of spin. Measured: 2.5e-7 at most.
    for eta in [1.0, 2.0, 3.0_f64] {
        let expected = at_rest.powi(2) - eta * eta;
        let found = frequency(&report, falling, eta).powi(2);
        assert!((found - expected).abs() < 2e-6 * eta * eta, "eta {eta}: {found} {expected}");
    }
    let stable_below = report["stable_below"].as_f64().unwrap() / unit();
    assert!((stable_below / at_rest - 1.0).abs() < 1e-3, "{stable_below} {at_rest}");
    let growth = |eta: usize| report["branches"][falling]["growth"][eta].as_f64().unwrap() / unit();
    assert_eq!(growth(3), 0.0);
    // Beyond, it diverges at √(Ω² − ω₀²).
    assert!((growth(4) / (16.0 - at_rest.powi(2)).sqrt() - 1.0).abs() < 5e-3, "{}", growth(4));
    assert_eq!(frequency(&report, falling, 4.0), 0.0);
    let first = &report["critical_speeds"][0];
    assert_eq!((first["order"].as_f64(), first["frequency"].as_f64()), (Some(0.0), Some(0.0)));
    assert!((first["speed"].as_f64().unwrap() / unit() / stable_below - 1.0).abs() < 1e-12);
}

/// Conserved: a critical speed is where the branch in the table crosses its order.
#[test]
fn table_files_and_diagram_say_the_same() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().to_str().unwrap();
    let arguments = ["campbell", "examples/rotating_bar.toml", "--axis", "0,0,-2", "--speeds", "100:3000:30"];
    let output = flexframe(&[&arguments[..], &["--orders", "0.8,2", "-o", out]].concat());
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let table = String::from_utf8(output.stdout).unwrap();
    for words in ["about (0, 0, -1) through (0, 0, 0)", "mode 1", "critical speeds", "rpm", "0.8x", "campbell.png"] {
        assert!(table.contains(words), "{words} in: {table}");
    }
    let read = |name: &str| std::fs::read_to_string(folder.path().join(name)).unwrap();
    let rows = |text: &str| -> Vec<Vec<f64>> {
        text.lines().skip(1).map(|row| row.split(',').map(|x| x.parse().unwrap()).collect()).collect()
    };
    let csv = read("campbell.csv");
    assert!(csv.starts_with("speed,frequency_1,frequency_2,"), "{csv}");
    let branches = rows(&csv);
    assert_eq!((branches.len(), branches[0].len()), (30, 1 + 3 * 12));
    assert_eq!((branches[0][0], branches[29][0]), (100.0, 3000.0));
    // Each critical speed lies where its branch crosses its order, found another way.
    let critical = read("critical_speeds.csv");
    assert!(critical.starts_with("order,mode,speed,frequency,kind\n"), "{critical}");
    let critical = rows(&critical.replace(",crossing", "").replace(",kind", ""));
    // 2x meets chord and flap 1, 0.8x the chord alone: the flap rises by more than the spin.
    assert_eq!(critical.iter().map(|row| row[0]).collect::<Vec<_>>(), [0.8, 2.0, 2.0]);
    for row in &critical {
        let [order, mode, speed, frequency] = row[..] else { panic!("{row:?}") };
        assert!((frequency - order * speed / TAU).abs() < 1e-9 * frequency);
        let above = branches.iter().position(|b| b[0] >= speed).unwrap();
        let (a, b) = (&branches[above - 1], &branches[above]);
        let part = (speed - a[0]) / (b[0] - a[0]);
        let on_branch = a[mode as usize] + part * (b[mode as usize] - a[mode as usize]);
        // Straight lines between speeds 100 rad/s apart: measured 2e-3 at most.
        assert!((on_branch / frequency - 1.0).abs() < 5e-3, "{row:?}: {on_branch}");
    }
    let svg = read("campbell.svg");
    for words in ["0.8×", "2×", "critical speed", "Spin speed", "(0, 0, −1)", "mode 2"] {
        assert!(svg.contains(words), "{words}");
    }
    let png = std::fs::read(folder.path().join("campbell.png")).unwrap();
    assert!(png.starts_with(b"\x89PNG\r\n") && png.len() > 10_000, "{}", png.len());
}

#[test]
fn what_is_no_axis_no_range_of_speeds_and_no_order_is_refused() {
    let refused = |axis: &str, speeds: &str, rest: &[&str], words: &[&str]| {
        let arguments = ["campbell", "examples/rotating_bar.toml", "--axis", axis, "--speeds", speeds];
        let output = flexframe(&[&arguments[..], rest].concat());
        assert!(!output.status.success() && output.stdout.is_empty(), "{axis} {speeds}");
        let message = String::from_utf8(output.stderr).unwrap();
        assert!(words.iter().all(|word| message.contains(word)), "{words:?} in: {message}");
    };
    refused("w", "0:1:5", &[], &["'w'", "--axis", "three numbers"]);
    refused("0,0,0", "0:1:5", &[], &["not all zero"]);
    refused("1,2", "0:1:5", &[], &["three numbers"]);
    refused("0,nan,1", "0:1:5", &[], &["three numbers"]);
    refused("z", "0:200", &[], &["'0:200'", "start:end:count"]);
    refused("z", "0:200:x", &[], &["start:end:count"]);
    refused("z", "200:0:5", &[], &["speeds 200:0:5", "0 ≤ start < end"]);
    refused("z", "-5:200:5", &[], &["0 ≤ start < end"]);
    refused("z", "0:inf:5", &[], &["0 ≤ start < end"]);
    refused("z", "0:200:1", &[], &["a count of 2"]);
    refused("z", "0:200:5", &["--orders", "1,-2"], &["--orders", "positive"]);
    let set = ["--about-rest", "always", "--set", "effects.coriolis=false"];
    refused("z", "0:200:5", &set, &["`coriolis`", "--about-rest always", "--about-rest never"]);
    refused("z", "0:200:5", &["-n", "0"], &["--flexible", "a whole number, 1 or more"]);
}

/// The swept blade of `crates/model/tests/bent/reference.rs` at 0, 1 and 2 times its first frequency; `more` are options.
fn blade(speeds: &str, more: &[&str]) -> Value {
    let folder = tempfile::tempdir().unwrap();
    let scene = folder.path().join("blade.toml");
    let mesh = root().join("crates/verification/meshes/swept_blade.msh");
    let text = format!(
        "title = \"Blade\"\nunits = {{ length = \"m\", mass = \"kg\", time = \"s\" }}\n[body]\nmesh = {mesh:?}\n\
         material = {{ young_modulus = 2e9, poisson_ratio = 0.3, density = 1000.0 }}\n[modes]\nflexible = 6\n\
         [[constraints]]\nkind = \"hinge\"\nat = [0.0, 0.0, 0.0]\naxis = [1.0, 0.0, 0.0]\ngroup = \"root\"\n\
         motion = {{ amplitude = 1.0, history = {{ kind = \"constant\" }} }}\n[time]\nend = 1.0\nstep = 1e-3\n"
    );
    std::fs::write(&scene, text).unwrap();
    let out = folder.path().join("out");
    let mut arguments = vec!["campbell", scene.to_str().unwrap(), "--axis", "x", "--speeds", speeds, "--json"];
    arguments.extend(["-o", out.to_str().unwrap()]);
    arguments.extend(more);
    let output = flexframe(&arguments);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    serde_json::from_slice(&output.stdout).unwrap()
}

/// The frequencies at a speed, rising.
fn at(report: &Value, speed: usize) -> Vec<f64> {
    let branches = report["branches"].as_array().unwrap();
    let mut found: Vec<f64> = branches.iter().map(|branch| branch["frequency"][speed].as_f64().unwrap()).collect();
    found.sort_by(f64::total_cmp);
    found
}

/// Independent reference: eight modes and static shapes about the rest, and the full body (`cargo test -p model --test bent reference`).
#[test]
fn a_blade_that_its_spin_bends_vibrates_about_its_rest_at_each_speed() {
    let first = at(&blade("0:1:2", &["--about-rest", "never"]), 0)[0];
    let speeds = format!("0:{}:3", 2.0 * TAU * first);
    let report = blade(&speeds, &[]);
    for (found, expected) in at(&report, 2).into_iter().zip([6.20321, 12.82606, 37.7478, 50.2525]) {
        assert!((found - expected).abs() < 1e-3 * expected, "{found} {expected}");
    }
    let deflection: Vec<f64> = report["deflection"].as_array().unwrap().iter().map(|u| u.as_f64().unwrap()).collect();
    assert!(deflection[0] < 1e-9 && deflection[1] > 0.05 && (deflection[2] - 0.14).abs() < 0.02, "{deflection:?}");
    let straight = blade(&speeds, &["--about-rest", "never"]);
    assert!(straight["deflection"].is_null(), "{}", straight["deflection"]);
    let difference = at(&straight, 2)[0] / 6.20321 - 1.0;
    assert!(difference < -0.005, "{difference}");
}

/// Closed form: the lag hinge of the rotor blade with a damper, ζ̈ + 2d ζ̇ + a Ω² ζ = 0, swings from d/√a on, and meets order n at d/√(a − n²). Its
/// d and a are those of the highest speed.
#[test]
fn an_overdamped_hinge_begins_to_swing_and_is_stable_there() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().to_str().unwrap();
    let arguments =
        ["campbell", "examples/mechanisms/rotor_blade.toml", "--speeds", "0:60:4", "--orders", "0.25,1,2", "-o", out];
    let report = json(&arguments);
    assert!(report["stable_below"].is_null(), "{}", report["stable_below"]);
    let swings = report["swing_limits"].as_array().unwrap();
    assert_eq!(swings.len(), 1, "{swings:?}");
    let lag = swings[0]["mode"].as_u64().unwrap() as usize - 1;
    let last = |name: &str| report["branches"][lag][name].as_array().unwrap().last().unwrap().as_f64().unwrap();
    let damping = -last("growth");
    let a = ((TAU * last("frequency")).powi(2) + damping.powi(2)) / 60.0_f64.powi(2);
    let (begins, expected) = (swings[0]["speed"].as_f64().unwrap(), damping / a.sqrt());
    assert!((begins / expected - 1.0).abs() < 1e-3, "{begins} {expected}");
    assert_eq!(swings[0]["swings_above"].as_bool(), Some(true));
    // Flapping is 1.068 Ω and meets no order.
    let critical = report["critical_speeds"].as_array().unwrap();
    assert_eq!(critical.len(), 1, "{critical:?}");
    let (meets, expected) = (critical[0]["speed"].as_f64().unwrap(), damping / (a - 0.0625).sqrt());
    assert!((meets / expected - 1.0).abs() < 1e-3, "{meets} {expected}");
    assert_eq!((critical[0]["kind"].as_str(), critical[0]["order"].as_f64()), (Some("crossing"), Some(0.25)));
}

/// Closed form: a mass on a spring along a driven arm has ω² = k/m − Ω², and flies out from √(k/m) on.
#[test]
fn a_mass_on_a_spinning_arm_flies_out_from_the_frequency_of_its_spring_on() {
    let folder = tempfile::tempdir().unwrap();
    let scene = folder.path().join("arm.toml");
    let rigid =
        "rigid = { mass = 2.0, center_of_mass = [0, 0, 0], inertia = [[1e-2, 0, 0], [0, 1e-2, 0], [0, 0, 1e-2]] }";
    let text = format!(
        "title = \"Arm\"\nunits = {{ length = \"m\", mass = \"kg\", time = \"s\" }}\n[bodies.arm]\n{rigid}\n\
         markers = {{ a = {{ at = [0, 0, 0] }} }}\n[bodies.bob]\n{rigid}\nmarkers = {{ a = {{ at = [0, 0, 0] }} }}\n\
         [[joints]]\nname = \"axle\"\nkind = \"revolute\"\nbetween = [\"ground\", \"arm.a\"]\naxis = [0, 0, 1]\n\
         drive = {{ amplitude = 1.0, history = {{ kind = \"expression\", formula = \"t\" }} }}\n\
         [[joints]]\nname = \"slide\"\nkind = \"prismatic\"\nbetween = [\"arm.a\", \"bob.a\"]\naxis = [1, 0, 0]\n\
         spring = {{ stiffness = 200.0 }}\n[time]\nend = 1.0\ntolerance = 1e-5\n"
    );
    std::fs::write(&scene, text).unwrap();
    let out = folder.path().join("out");
    let arguments =
        ["campbell", scene.to_str().unwrap(), "--speeds", "0:12:5", "--orders", "1,3", "-o", out.to_str().unwrap()];
    let report = json(&arguments);
    let stable_below = report["stable_below"].as_f64().unwrap();
    assert!((stable_below - 10.0).abs() < 1e-9, "{stable_below}");
    assert!(report["swing_limits"].is_null());
    let found: Vec<(&str, f64, f64)> = report["critical_speeds"]
        .as_array()
        .unwrap()
        .iter()
        .map(|one| (one["kind"].as_str().unwrap(), one["order"].as_f64().unwrap(), one["speed"].as_f64().unwrap()))
        .collect();
    let expected =
        [("growth_begins", 0.0, 10.0), ("crossing", 1.0, 50.0_f64.sqrt()), ("crossing", 3.0, 10.0_f64.sqrt())];
    assert_eq!(found.len(), expected.len(), "{found:?}");
    for (found, expected) in found.iter().zip(expected) {
        assert_eq!((found.0, found.1), (expected.0, expected.1));
        assert!((found.2 / expected.2 - 1.0).abs() < 1e-9, "{found:?} {expected:?}");
    }
}
