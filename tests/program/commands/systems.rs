//! `flexframe modes` and `flexframe campbell` of bodies in joints.

use std::f64::consts::TAU;
use std::path::Path;

use flexframe::columns::COLUMNS;
use results::Results;
use serde_json::Value;

use crate::program::{flexframe, json, root};

const YOUNG: f64 = 70_000.0;
const DENSITY: f64 = 2.7e-9;
const LENGTH: f64 = 202.07;
const SIDE: f64 = 10.0;

fn number(value: &Value) -> f64 {
    value.as_f64().unwrap_or_else(|| panic!("{value}"))
}

/// √(EI/(ρAL⁴)), rad/s.
fn unit() -> f64 {
    (YOUNG * SIDE.powi(2) / 12.0 / (DENSITY * LENGTH.powi(4))).sqrt()
}

/// The bar of `examples/rotating_bar.toml` as a free body, welded to a hub that a drive turns about z through its root.
fn welded_bar(folder: &Path) -> String {
    let mesh = root().join("meshes/rotating_bar.msh");
    let text = format!(
        r#"
title = "Bar on a hub"
units = {{ length = "mm", mass = "Mg", time = "s" }}
[bodies.hub]
rigid = {{ mass = 1e-3, center_of_mass = [0, 0, 0], inertia = [[0.1, 0, 0], [0, 0.1, 0], [0, 0, 0.1]] }}
markers = {{ shaft = {{ at = [0, 0, 0] }}, root = {{ at = [0, 0, 0] }} }}
[bodies.bar]
mesh = "{}"
material = {{ young_modulus = {YOUNG:?}, poisson_ratio = 0.0, density = {DENSITY:e} }}
modes = {{ flexible = 10 }}
markers = {{ root = {{ group = "root" }} }}
[[joints]]
name = "shaft"
kind = "revolute"
between = ["ground", "hub.shaft"]
axis = [0, 0, 1]
drive = {{ amplitude = 1.0, history = {{ kind = "expression", formula = "t" }} }}
[[joints]]
name = "weld"
kind = "fixed"
between = ["hub.root", "bar.root"]
[time]
end = 0.1
tolerance = 1e-5
[output]
interval = 0.01
"#,
        mesh.display()
    );
    let scene = folder.join("hub.toml");
    std::fs::write(&scene, text).unwrap();
    scene.to_str().unwrap().to_owned()
}

/// Independent reference: the first flap of a clamped thin beam that spins about an axis across it through its root, at η = 0, 2, 4,
/// 6, 8, 10 in units of √(EI/(ρAL⁴)): rotating_bar.csv, given with the project. The mean of the face at the root gives way a little:
/// the table of the theory of systems has 3.442 to 11.121 on a coarser mesh.
const FLAP: [f64; 6] = [3.5160, 4.1373, 5.5850, 7.3604, 9.2568, 11.2023];

#[test]
fn a_bar_welded_to_a_driven_hub_stiffens_as_it_spins() {
    let folder = tempfile::tempdir().unwrap();
    let scene = welded_bar(folder.path());
    let out = folder.path().join("diagram");
    let speeds = format!("0:{}:6", 10.0 * unit());
    let report = json(&["campbell", &scene, "--speeds", &speeds, "-o", out.to_str().unwrap()]);
    let frequency = |branch: usize, i: usize| number(&report["branches"][branch]["frequency"][i]) * TAU / unit();
    // Flap and chord are equal at rest; flap is the stiffer one.
    let flap = usize::from(frequency(0, 5) < frequency(1, 5));
    for (i, expected) in FLAP.into_iter().enumerate() {
        let found = frequency(flap, i);
        println!("eta {}: {found:.4}, {expected}", 2 * i);
        assert!((found / expected - 1.0).abs() < 0.01, "{found} {expected}");
    }
    assert_eq!(report["bodies"], serde_json::json!(["hub", "bar"]));
    assert!(out.join("campbell.csv").exists() && out.join("campbell.svg").exists());
    let given =
        ["campbell", &scene, "--joint", "wold", "--speeds", "0:10:3", "--overwrite", "-o", out.to_str().unwrap()];
    let refused = flexframe(&given);
    let said = String::from_utf8_lossy(&refused.stderr);
    assert!(!refused.status.success() && said.contains("no joint \"wold\"") && said.contains("shaft, weld"), "{said}");
}

/// Closed form: the modes of the welded bar at rest are those of the bar on a clamp, and only the bar moves.
#[test]
fn modes_of_a_system_say_who_moves() {
    let folder = tempfile::tempdir().unwrap();
    let scene = welded_bar(folder.path());
    let out = folder.path().join("pictures");
    let report = json(&["modes", &scene, "-o", out.to_str().unwrap()]);
    let system = &report["systems"][0];
    assert_eq!(system["joints"], serde_json::json!(["shaft", "weld"]));
    assert_eq!(number(&system["rigid_modes"]), 0.0);
    let first = &system["modes"][0];
    let found = number(&first["frequency"]) * TAU / unit();
    assert!((found / 3.516 - 1.0).abs() < 0.03, "{found}");
    assert_eq!((&first["moves"][0]["name"], &first["strained"][0]["name"]), (&"bar".into(), &"bar".into()));
    assert!(number(&first["moves"][0]["part"]) > 0.999);
    assert!(out.join("modes.svg").exists());
    let alone = json(&["modes", &scene, "--body", "bar"]);
    let free = number(&alone["body"]["natural_frequencies"][0]) * TAU / unit();
    // Closed form: a free beam has 22.373.
    assert!((free / 22.373 - 1.0).abs() < 0.01, "{free}");
    let told = flexframe(&["modes", &scene]);
    let told = String::from_utf8_lossy(&told.stdout);
    assert!(told.contains("bodies   hub, bar") && told.contains("bar 100 %  bar 100 %"), "{told}");
    let advised = flexframe(&["advise", &scene]);
    let advised = String::from_utf8_lossy(&advised.stdout);
    assert!(advised.contains("system of hub, bar") && advised.contains("bar bends in motions of"), "{advised}");
}

/// Closed form: damping in proportion to the stiffness is βω/2 in every vibration, however a body is held. A ratio of the free modes is not
/// kept by vibrations that joints make slower: 14 times less, which is told with the β that keeps it.
#[test]
fn joints_lower_the_damping_of_modes_and_that_is_told() {
    let folder = tempfile::tempdir().unwrap();
    let scene = welded_bar(folder.path());
    let of_first = |set: &str| {
        let system = &json(&["modes", &scene, "--set", set])["systems"][0];
        // Fast shapes do not swing with a β of a slow vibration, and come behind it all the same.
        let first = &system["modes"][0];
        let [ratio, frequency] = ["damping_ratio", "frequency"].map(|name| number(&first[name]));
        let told = system["warnings"].as_array().unwrap().iter().filter_map(Value::as_str);
        (ratio, frequency, told.filter(|line| line.contains("rayleigh")).map(str::to_owned).collect::<Vec<_>>())
    };
    let (ratio, frequency, told) = of_first("bodies.bar.modes.damping_ratio=0.02");
    assert!(ratio < 0.004, "{ratio}");
    assert!(told.len() == 1 && told[0].contains("body bar has 0.02"), "{told:?}");
    let beta = 0.02 / (std::f64::consts::PI * frequency);
    assert!(
        told[0].contains(&format!("{beta:.5e}")[..6]) || told[0].contains(&format!("{beta:.8}")[..8]),
        "{beta} {told:?}"
    );
    let (ratio, _, told) = of_first(&format!("bodies.bar.modes.rayleigh={{alpha=0.0,beta={beta}}}"));
    assert!((ratio / 0.02 - 1.0).abs() < 1e-3 && told.is_empty(), "{ratio} {told:?}");
    let out = folder.path().join("campbell");
    let (out, damped) = (out.to_str().unwrap(), format!("bodies.bar.modes.rayleigh={{alpha=0.0,beta={beta}}}"));
    let report = json(&["campbell", &scene, "--joint", "shaft", "--speeds", "0:0.1:2", "-o", out, "--set", &damped]);
    let line = &report["branches"][0];
    let swings = number(&line["frequency"][0]) / frequency;
    assert!(line["kind"] == "natural mode" && (swings - 1.0).abs() < 1e-3, "{line}");
}

/// The tolerance is kept for the deformation of a body that hardly bends, and the card tells what steps have damped of it. Independent
/// reference: a run at 1e-7.
#[test]
fn a_small_deformation_is_as_right_as_the_tolerance_says() {
    let folder = tempfile::tempdir().unwrap();
    let scene = welded_bar(folder.path());
    let out = folder.path().join("out");
    let of_steps = |tolerance: &str, rate: &str| {
        let [tolerance, rate] =
            [format!("time.tolerance={tolerance}"), format!("joints[0].drive.history.formula={rate}")];
        let run = ["run", &scene, "-o", out.to_str().unwrap(), "--overwrite", "--no-check"];
        let report = json(
            &[
                &run[..],
                &[
                    "--set",
                    &tolerance,
                    "--set",
                    &rate,
                    "--set",
                    "relaxed=true",
                    "--set",
                    "bodies.bar.modes.damping_ratio=0.05",
                ],
            ]
            .concat(),
        );
        let lines = report["trust"]["lines"].as_array().unwrap();
        let line = lines.iter().find(|line| line["place"] == "steps").unwrap().to_string();
        let results = Results::open(Path::new(report["results"].as_str().unwrap()), &COLUMNS).unwrap();
        (results.numbers("bodies/bar/energy/strain").unwrap().to_vec(), line)
    };
    let (rough, told) = of_steps("1e-4", "1e-4*(1-cos(100*t))");
    let (fine, _) = of_steps("1e-7", "1e-4*(1-cos(100*t))");
    let largest = fine.iter().copied().fold(0.0, f64::max);
    let off = rough.iter().zip(&fine).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max) / largest;
    println!("off by {off:e}: {told}");
    // Of the energy, twice the amplitude; measured: 6e-5.
    assert!(off < 2e-4, "{rough:?} {fine:?}");
    assert!(told.contains("and of the largest deformation"), "{told}");
    assert!(told.contains("of the largest deformation was damped"), "{told}");
}

/// Outputs that damping makes go with velocities are left out of the sums of a shock, and that is told.
#[test]
fn a_shock_tells_which_outputs_it_leaves_out() {
    let folder = tempfile::tempdir().unwrap();
    let scene = welded_bar(folder.path());
    let table = folder.path().join("pulse.csv");
    std::fs::write(&table, "0,0\n0.01,1\n0.02,0\n").unwrap();
    let load =
        "bodies.bar.loads=[{kind=\"force\",at=[100,0,0],direction=[0,0,1],amplitude=1.0,history={kind=\"step\",at=1}}]";
    let told = |damping: &str| {
        let tip = "bodies.bar.points={tip=[100,0,0]}";
        let shock =
            ["shock", &scene, "--table", table.to_str().unwrap(), "--input", "bar.loads[0].force", "--spin", "0,0,0"];
        let more = ["--outputs", "bar.tip.displacement.z,weld.force.z", "--set", load, "--set", tip, "--set", damping];
        json(&[&shock[..], &more].concat())
    };
    let free = told("bodies.bar.modes.damping_ratio=0.0");
    assert_eq!((free["outputs"].as_array().unwrap().len(), &free["warnings"]), (2, &serde_json::json!([])));
    let damped = told("bodies.bar.modes.rayleigh={alpha=0.0,beta=1e-5}");
    let [output] = &damped["outputs"].as_array().unwrap()[..] else { panic!("{damped}") };
    assert_eq!(output["output"], "bar.tip.displacement.z");
    let warnings = damped["warnings"].to_string();
    assert!(warnings.contains("left out are weld.force.z: with damping"), "{warnings}");
}

/// Closed form: flapping about a hinge at the distance e with first and second moments S and I of what is outside of it has the
/// frequency Ω √(1 + e S/I), as at the head of `examples/mechanisms/rotor_blade.toml`.
#[test]
fn a_blade_flaps_in_its_closed_form() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().to_str().unwrap();
    let scene = "examples/mechanisms/rotor_blade.toml";
    let report = json(&["campbell", scene, "--joint", "shaft", "--speeds", "25:50:2", "-o", out]);
    let (offset, link, rod) = (0.03, 0.01, 0.3 * 0.008 * 0.008 * 7870.0);
    // The link's center is 0.01 from the hinge, the rod from 0.02 to 0.32.
    let first = link * 0.01 + rod * 0.17;
    let second = 1e-6 + link * 0.01 * 0.01 + rod * (0.3 * 0.3 + 0.008 * 0.008) / 12.0 + rod * 0.17 * 0.17;
    for (i, speed) in [25.0, 50.0].into_iter().enumerate() {
        let expected = speed * f64::sqrt(1.0 + offset * first / second);
        let branches = report["branches"].as_array().unwrap().iter();
        let found = branches.map(|branch| number(&branch["frequency"][i]) * TAU);
        let off = found.map(|found| (found / expected - 1.0).abs()).fold(f64::INFINITY, f64::min);
        println!("{speed} rad/s: {expected} rad/s, off by {off:e}");
        // The rod bends a little.
        assert!(off < 1e-3, "{off}");
    }
}

/// Closed form: the first shape of a clamped beam has 0.3395 of its displacement at the end in its middle.
/// Conserved: a wheel that is free to turn about the axis of a clamped bar has the same part in what bends the bar as one that is welded to it:
/// the turn that nothing resists is in none of the vibrations.
#[test]
fn a_free_turn_is_in_no_vibration() {
    let folder = tempfile::tempdir().unwrap();
    let mesh = root().join("meshes/rotating_bar.msh");
    let of_kind = |kind: &str| {
        let text = format!(
            r#"
title = "Wheel on a bar"
units = {{ length = "mm", mass = "Mg", time = "s" }}
[bodies.bar]
mesh = "{}"
material = {{ young_modulus = {YOUNG:?}, poisson_ratio = 0.0, density = {DENSITY:e} }}
modes = {{ flexible = 6 }}
markers = {{ root = {{ group = "root" }}, tip = {{ box = [[202, -10, -10], [203, 10, 10]], z = [1, 0, 0] }} }}
[bodies.wheel]
rigid = {{ mass = 1e-4, center_of_mass = [0, 0, 0], inertia = [[0.04, 0, 0], [0, 0.021, 0], [0, 0, 0.021]] }}
initial = {{ position = [{LENGTH:?}, 0, 0] }}
markers = {{ hub = {{ at = [0, 0, 0], z = [1, 0, 0] }} }}
[[joints]]
name = "foot"
kind = "fixed"
between = ["ground", "bar.root"]
[[joints]]
name = "axle"
kind = "{kind}"
between = ["bar.tip", "wheel.hub"]
[time]
end = 0.1
tolerance = 1e-5
"#,
            mesh.display()
        );
        let scene = folder.path().join(format!("{kind}.toml"));
        std::fs::write(&scene, text).unwrap();
        json(&["modes", scene.to_str().unwrap()])["systems"][0]["modes"].clone()
    };
    let parts = |modes: &Value| -> Vec<(f64, f64)> {
        let of_wheel = |mode: &Value| {
            let moves = mode["moves"].as_array().unwrap();
            moves.iter().find(|share| share["name"] == "wheel").map_or(0.0, |share| number(&share["part"]))
        };
        modes.as_array().unwrap().iter().map(|mode| (number(&mode["frequency"]), of_wheel(mode))).collect()
    };
    let (free, welded) = (parts(&of_kind("revolute")), parts(&of_kind("fixed")));
    assert!(free.len() > 6 && free[0].1 < 0.999, "{free:?}");
    for (frequency, part) in &free[..2] {
        let same = welded.iter().min_by(|a, b| (a.0 - frequency).abs().total_cmp(&(b.0 - frequency).abs())).unwrap();
        assert!((same.0 / frequency - 1.0).abs() < 1e-6 && (same.1 - part).abs() < 1e-6, "{frequency} {part} {same:?}");
    }
}

#[test]
fn shapes_of_a_system_are_in_a_file_for_paraview() {
    let folder = tempfile::tempdir().unwrap();
    let scene = welded_bar(folder.path());
    let out = folder.path().join("pictures");
    json(&["modes", &scene, "-o", out.to_str().unwrap()]);
    let file = hdf5::File::open(out.join("modes.vtkhdf")).unwrap();
    let root = file.group("VTKHDF").unwrap();
    // The hub has no mesh: it is drawn as a box.
    assert!(root.group("hub").is_ok() && root.group("bar").is_ok());
    let points = file.dataset("VTKHDF/bar/Points").unwrap().read_raw::<f64>().unwrap();
    let fields = file.group("VTKHDF/bar/PointData").unwrap();
    let names = fields.member_names().unwrap();
    let first = names.iter().min().unwrap();
    let shape = fields.dataset(first).unwrap().read_raw::<f64>().unwrap();
    assert_eq!(shape.len(), points.len(), "{names:?}");
    let near = |x: f64| {
        let distance = |k: &usize| (points[3 * k] - x).abs();
        let node = (0..points.len() / 3).min_by(|a, b| distance(a).total_cmp(&distance(b))).unwrap();
        assert!(distance(&node) < 0.02 * LENGTH, "no point near {x}");
        // Across the bar.
        f64::hypot(shape[3 * node + 1], shape[3 * node + 2])
    };
    let ends = points.chunks(3).map(|x| x[0]);
    let low = ends.clone().fold(f64::INFINITY, f64::min);
    let (middle, end) = (near(low + 0.5 * LENGTH), near(low + LENGTH));
    println!("{first}: {middle} {end}");
    assert!((middle / end / 0.3395 - 1.0).abs() < 0.03, "{middle} {end}");
}

/// Closed form: a wheel of the inertia I about its axle, with a spring of the stiffness k, and a stone of the mass m and the inertia i
/// that a drive takes out along it to the radius r: √(k/(I + i + m r²)).
#[test]
fn modes_are_taken_where_a_run_has_the_bodies_at_a_time() {
    let folder = tempfile::tempdir().unwrap();
    let scene = folder.path().join("wheel.toml");
    let inertia = |i: f64| format!("inertia = [[{i}, 0, 0], [0, {i}, 0], [0, 0, {i}]]");
    let text = format!(
        r#"
title = "Stone on a wheel"
units = {{ length = "m", mass = "kg", time = "s" }}
[bodies.wheel]
rigid = {{ mass = 1.0, center_of_mass = [0, 0, 0], {} }}
markers = {{ axle = {{ at = [0, 0, 0] }}, rail = {{ at = [0.5, 0, 0] }} }}
[bodies.stone]
rigid = {{ mass = 3.0, center_of_mass = [0, 0, 0], {} }}
initial = {{ position = [0.5, 0, 0] }}
markers = {{ middle = {{ at = [0, 0, 0] }} }}
[[joints]]
name = "axle"
kind = "revolute"
between = ["ground", "wheel.axle"]
axis = [0, 0, 1]
spring = {{ stiffness = 40.0 }}
[[joints]]
name = "rail"
kind = "prismatic"
between = ["wheel.rail", "stone.middle"]
axis = [1, 0, 0]
drive = {{ amplitude = 2.0, history = {{ kind = "expression", formula = "t" }} }}
[time]
end = 0.5
tolerance = 1e-8
"#,
        inertia(2.0),
        inertia(0.1)
    );
    std::fs::write(&scene, text).unwrap();
    let scene = scene.to_str().unwrap();
    for time in [0.0, 0.25] {
        let radius = 0.5 + 2.0 * time;
        let expected = f64::sqrt(40.0 / (2.0 + 0.1 + 3.0 * radius * radius)) / TAU;
        let report = json(&["modes", scene, "--time", &time.to_string()]);
        let modes = report["systems"][0]["modes"].as_array().unwrap();
        let found = number(&modes[0]["frequency"]);
        println!("{time}: {found} {expected}");
        assert!(modes.len() == 1 && (found / expected - 1.0).abs() < 1e-9, "{found} {expected}");
    }
    let refused = flexframe(&["modes", scene, "--time", "0.7"]);
    assert!(!refused.status.success());
}

/// Conserved: about its rest without loads, a body with large modes has the frequencies of the same body without them, at rest and in spin. It
/// runs, and its true error is found with its joints' forces.
#[test]
fn a_body_in_joints_may_have_large_modes() {
    let folder = tempfile::tempdir().unwrap();
    let scene = welded_bar(folder.path());
    let text = std::fs::read_to_string(&scene).unwrap().replace("formula = \"t\"", "formula = \"1e3*t^3\"");
    let out = folder.path().join("out");
    let answers = |modes: &str, rest: &str| {
        let text = text
            .replace("flexible = 10", modes)
            .replace("group = \"root\" } }", &format!("group = \"root\" }} }}{rest}"));
        std::fs::write(&scene, text).unwrap();
        let modes = json(&["modes", &scene]);
        let speeds = format!("0:{}:2", 4.0 * unit());
        let folder = out.to_str().unwrap();
        let campbell = json(&["campbell", &scene, "--speeds", &speeds, "-o", folder, "--overwrite"]);
        let linear = out.join("linear.mat");
        let linear = json(&["linearize", &scene, "-o", linear.to_str().unwrap(), "--overwrite"]);
        let all = modes["systems"][0]["modes"].as_array().unwrap();
        let mut found: Vec<f64> = all.iter().take(4).map(|mode| number(&mode["frequency"])).collect();
        found.extend(campbell["branches"].as_array().unwrap().iter().take(4).map(|of| number(&of["frequency"][1])));
        found.extend(linear["poles"].as_array().unwrap().iter().take(4).map(|pole| number(&pole["frequency"])));
        found
    };
    let load = format!(
        "\nloads = [{{ kind = \"force\", at = [{LENGTH:?}, 0.0, 0.0], direction = [0, 0, -1], amplitude = 400.0 }}]\n\
         points = {{ tip = [{LENGTH:?}, 0.0, 0.0] }}"
    );
    let [small, large] = ["flexible = 10", "flexible = 10, large = 1, following = 3"].map(|modes| answers(modes, ""));
    for (small, large) in small.iter().zip(&large) {
        println!("{small} {large}");
        assert!((large / small - 1.0).abs() < 1e-3, "{large} {small}");
    }
    // A load that bends it by a tenth of its length changes them.
    let bent = answers("flexible = 10, large = 1, following = 3", &load);
    println!("{bent:?}");
    let change = |k: usize| (bent[k] / large[k] - 1.0).abs();
    assert!((0..4).map(change).fold(0.0, f64::max) > 3e-3 && (8..12).map(change).fold(0.0, f64::max) > 3e-3);
    // Loads are no part of a diagram.
    assert!((4..8).all(|k| change(k) < 1e-6));
    std::fs::write(&scene, text.replace("flexible = 10", "flexible = 10, large = 1")).unwrap();
    let run = flexframe(&["run", &scene, "-o", out.to_str().unwrap()]);
    assert!(run.status.success(), "{}", String::from_utf8_lossy(&run.stderr));
    let checked = json(&["check", out.join("hub.h5").to_str().unwrap()]);
    println!("{checked}");
}

/// Closed form: a disk at the center of its stand tilts as J φ̈ − i Ω J_p φ̇ + k φ = 0, so ω = √(a² + k/J) ± a, a = Ω J_p / 2J, and keeps
/// its sway √(k/m).
#[test]
fn a_rotor_on_a_soft_stand_has_its_diagram() {
    let folder = tempfile::tempdir().unwrap();
    let scene = folder.path().join("rotor.toml");
    let text = |inertia: &str| {
        format!(
            r#"
title = "Disk on a stand"
units = {{ length = "m", mass = "kg", time = "s" }}
[bodies.stand]
rigid = {{ mass = 3.0, center_of_mass = [0, 0, 0], inertia = [[0.2, 0, 0], [0, 0.3, 0], [0, 0, 0.3]] }}
markers = {{ bearing = {{ at = [0, 0, 0] }}, foot = {{ at = [0, 0, 0] }} }}
[bodies.disk]
rigid = {{ mass = 2.0, center_of_mass = [0, 0, 0], inertia = {inertia} }}
markers = {{ hub = {{ at = [0, 0, 0] }} }}
[[joints]]
name = "shaft"
kind = "revolute"
between = ["stand.bearing", "disk.hub"]
axis = [1, 0, 0]
drive = {{ amplitude = 40.0, history = {{ kind = "expression", formula = "t" }} }}
[[bushings]]
name = "pad"
between = ["ground", "stand.foot"]
stiffness = {{ translation = [4e4, 3e4, 3e4], rotation = [90.0, 50.0, 50.0] }}
[time]
end = 0.1
tolerance = 1e-5
[output]
interval = 0.01
"#
        )
    };
    std::fs::write(&scene, text("[[0.4, 0, 0], [0, 0.25, 0], [0, 0, 0.25]]")).unwrap();
    let (scene_name, out) = (scene.to_str().unwrap(), folder.path().join("diagram"));
    let given = ["campbell", scene_name, "--speeds", "0:40:3", "-o", out.to_str().unwrap(), "--overwrite"];
    let report = json(&given);
    assert_eq!(report["rotor"], "disk");
    // Its spin does nothing to the bodies of its support.
    assert!(report.get("effects").is_none(), "{}", report["effects"]);
    let branches = report["branches"].as_array().unwrap();
    for (i, speed) in [0.0_f64, 20.0, 40.0].into_iter().enumerate() {
        let (half, still): (f64, f64) = (0.5 * speed * 0.4 / 0.55, 50.0 / 0.55);
        let root = (half * half + still).sqrt();
        for expected in [root - half, root + half, (3e4_f64 / 5.0).sqrt()] {
            let off = |branch: &Value| (number(&branch["frequency"][i]) * TAU / expected - 1.0).abs();
            let least = branches.iter().map(off).fold(f64::INFINITY, f64::min);
            assert!(least < 1e-8, "{speed}: {expected}: {least}");
        }
    }
    let told = flexframe(&given);
    assert!(String::from_utf8_lossy(&told.stdout).contains("disk alone spins"), "{told:?}");
    std::fs::write(&scene, text("[[0.4, 0, 0], [0, 0.25, 0], [0, 0, 0.35]]")).unwrap();
    let refused = flexframe(&given);
    let said = String::from_utf8_lossy(&refused.stderr);
    assert!(!refused.status.success() && said.contains("\"shaft\"") && said.contains("across the axis"), "{said}");
}

/// Closed form: a second disk on the same stand that spins at s all the while: as before, with a = (Ω J_p + s j_p) / 2J.
#[test]
fn a_diagram_has_the_other_rotors_of_the_scene() {
    let folder = tempfile::tempdir().unwrap();
    let scene = folder.path().join("rotors.toml");
    let body = |name: &str, mass: f64, [polar, across]: [f64; 2], rest: &str| {
        format!(
            "[bodies.{name}]\nmarkers = {{ hub = {{ at = [0, 0, 0] }} }}\nrigid = {{ mass = {mass:?}, center_of_mass = [0, 0, 0], \
             inertia = [[{polar}, 0, 0], [0, {across}, 0], [0, 0, {across}]] }}\n{rest}"
        )
    };
    let joint = |name: &str, on: &str, rest: &str| {
        let between = format!("between = [\"stand.hub\", \"{on}.hub\"]");
        format!("[[joints]]\nname = \"{name}\"\nkind = \"revolute\"\n{between}\naxis = [1, 0, 0]\n{rest}")
    };
    let text = [
        "title = \"Two disks\"\nunits = { length = \"m\", mass = \"kg\", time = \"s\" }\n".to_owned(),
        body("stand", 3.0, [0.2, 0.3], ""),
        body("disk", 2.0, [0.4, 0.25], "initial = { angular_velocity = [40.0, 0, 0] }\n"),
        body("wheel", 1.0, [0.1, 0.06], "initial = { angular_velocity = [70.0, 0, 0] }\n"),
        joint("shaft", "disk", "drive = { amplitude = 40.0, history = { kind = \"expression\", formula = \"t\" } }\n"),
        joint("bearing", "wheel", ""),
        "[[bushings]]\nname = \"pad\"\nbetween = [\"ground\", \"stand.hub\"]\n\
         stiffness = { translation = [4e4, 3e4, 3e4], rotation = [90.0, 50.0, 50.0] }\n[time]\nend = 0.1\n\
         tolerance = 1e-5\n"
            .to_owned(),
    ];
    std::fs::write(&scene, text.concat()).unwrap();
    let out = folder.path().join("diagram");
    let given = ["campbell", scene.to_str().unwrap(), "--speeds", "0:40:3", "-o", out.to_str().unwrap()];
    let report = json(&given);
    assert_eq!(report["rotor"], "disk");
    assert_eq!(report["rotors"][0]["joint"], "bearing");
    let branches = report["branches"].as_array().unwrap();
    for (i, speed) in [0.0_f64, 20.0, 40.0].into_iter().enumerate() {
        let (half, still): (f64, f64) = (0.5 * (speed * 0.4 + 70.0 * 0.1) / 0.61, 50.0 / 0.61);
        let root = (half * half + still).sqrt();
        for expected in [root - half, root + half] {
            let off = |branch: &Value| (number(&branch["frequency"][i]) * TAU / expected - 1.0).abs();
            let least = branches.iter().map(off).fold(f64::INFINITY, f64::min);
            assert!(least < 1e-8, "{speed}: {expected}: {least}");
        }
    }
}

/// Doubts about one of several bodies name it, once.
#[test]
fn doubts_name_their_body() {
    let folder = tempfile::tempdir().unwrap();
    let scene = welded_bar(folder.path());
    let text = std::fs::read_to_string(&scene).unwrap().replace("young_modulus = 70000.0", "young_modulus = 0.07");
    std::fs::write(&scene, text).unwrap();
    let told = flexframe(&["modes", &scene]);
    let said = String::from_utf8_lossy(&told.stderr);
    assert_eq!(said.matches("warning: body bar: ").count(), 1, "{said}");
}
