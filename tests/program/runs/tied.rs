//! Scenes whose bodies joints tie together: runs, their rows, and the ways to go on.

use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use flexframe::columns::COLUMNS;
use flexframe::run::{RunError, RunProgress, RunReport, RunSettings, resume, run};
use flexframe::scene::Scene;
use results::Results;

use crate::program::command_in;

const SCENE: &str = include_str!("../../tied.toml");

fn system() -> Scene {
    let file = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../../tests/tied.toml"));
    Scene::parse(SCENE, file).unwrap()
}

/// Independent reference: the angle of the rod and the place of the slider at 0.1 s, of the plane beam of Simeon (1998).
#[test]
fn a_slider_crank_runs_from_its_scene() {
    let folder = tempfile::tempdir().unwrap();
    let (_, report) = run(&system(), folder.path(), &RunSettings::default(), |_| ()).unwrap();
    assert!(report.bodies.iter().all(|body| body.balances.energy < 1e-3), "{:?}", report.bodies);
    let errors = report.tied[0].step_errors.as_ref().unwrap();
    let [place, deformation, ..] = errors.sums;
    assert!(errors.ruled_by == Some("deformation") && place < deformation, "{errors:?}");
    let results = Results::open(&report.results, &COLUMNS).unwrap();
    let last = results.rows() - 1;
    let slider = results.vectors::<3>("bodies/slider/position").unwrap()[last];
    let pin =
        results.numbers("joints/pin/angle").unwrap()[last] + results.numbers("joints/bearing/angle").unwrap()[last];
    assert!((slider[0] - 0.169_737_332_842_786).abs() < 1e-6, "{slider:?}");
    // A pin turns with the bent end of the rod.
    let turns = pin / std::f64::consts::TAU;
    assert!((pin + 0.331_173_498_825_626 - turns.round() * std::f64::consts::TAU).abs() < 2e-2, "{pin}");
    assert!((results.numbers("joints/bearing/angle").unwrap()[last] - 15.0).abs() < 1e-12);
    assert!((results.numbers("joints/guide/position").unwrap()[last] - slider[0]).abs() < 1e-12);
    // Conserved: energy is what the drive has put in.
    let drive = results.numbers("joints/bearing/drive_work").unwrap();
    let energy = results.numbers("system/energy/total").unwrap();
    let largest = energy.iter().fold(0.0_f64, |most, energy| most.max(*energy));
    assert!(
        (energy[last] - energy[0] - drive[last]).abs() < 2e-3 * largest,
        "{} {}",
        energy[last] - energy[0],
        drive[last]
    );
}

/// Conserved: the bytes of the file, with and without an interruption.
#[test]
fn a_run_with_joints_goes_on_bit_for_bit() {
    let folder = tempfile::tempdir().unwrap();
    let (whole, cut) = (folder.path().join("whole"), folder.path().join("cut"));
    let settings = RunSettings { rows_alone: true, ..RunSettings::default() };
    let springs = "[[springs]]\nname = \"wire\"\nbetween = [\"ground.bearing\", \"slider.middle\"]\nstiffness = 50.0\ndamping = 0.1\n\
                   [[bushings]]\nname = \"pad\"\nbetween = [\"ground.guide\", \"slider.back\"]\n\
                   stiffness = { translation = [9.0, 9.0, 9.0] }\n";
    let file = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../../tests/tied.toml"));
    let scene = Scene::parse(&format!("{SCENE}\n{springs}"), file).unwrap();
    let (_, report) = run(&scene, &whole, &settings, |_| ()).unwrap();
    let stop = Arc::new(AtomicBool::new(false));
    let asked = RunSettings { stop: stop.clone(), ..settings.clone() };
    let stopped = run(&scene, &cut, &asked, |progress| {
        if matches!(progress, RunProgress::Motion(part) if part > 0.3) {
            stop.store(true, Ordering::Relaxed);
        }
    });
    let Err(RunError::Stopped { part, .. }) = stopped else { panic!("{stopped:?}") };
    let resumed = resume(&part, &settings, |_| ()).unwrap();
    let read = |path: &Path| std::fs::read(path).unwrap();
    assert!(read(&report.results) == read(&resumed.results));
    let results = Results::open(&resumed.results, &COLUMNS).unwrap();
    // Closed form: the wire goes from the origin to the slider, and the pad is at rest with it there.
    let slider = results.vectors::<3>("bodies/slider/position").unwrap();
    let (length, pad) =
        (results.numbers("joints/wire/length").unwrap(), results.vectors::<3>("joints/pad/force").unwrap());
    for ((place, length), force) in slider.iter().zip(length).zip(pad) {
        assert!(
            (place[0] - length).abs() < 1e-9 && (force[0] + 9.0 * place[0]).abs() < 1e-8,
            "{place:?} {length} {force:?}"
        );
    }
}

/// Independent reference: the same as above, by the other scheme.
#[test]
fn gauss_leads_a_scene_to_the_same_end() {
    let file = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../../tests/tied.toml"));
    let scene = Scene::parse(&SCENE.replace("[time]", "[time]\nscheme = \"gauss\""), file).unwrap();
    let folder = tempfile::tempdir().unwrap();
    let settings = RunSettings { rows_alone: true, ..RunSettings::default() };
    let (_, report) = run(&scene, folder.path(), &settings, |_| ()).unwrap();
    assert_eq!(report.scheme, "gauss");
    let results = Results::open(&report.results, &COLUMNS).unwrap();
    let slider = *results.vectors::<3>("bodies/slider/position").unwrap().last().unwrap();
    // 1.3e-6: Gauss keeps what rings, in some half of the steps that rows at an interval once asked for.
    assert!((slider[0] - 0.169_737_332_842_786).abs() < 3e-6, "{slider:?}");
}

#[test]
fn a_scene_with_joints_is_drawn_and_a_body_of_it_alone_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let flexframe = |arguments: &[&str]| {
        let scene = concat!(env!("CARGO_MANIFEST_DIR"), "/../../tests/tied.toml");
        command_in(folder.path(), &[&[arguments[0], scene], &arguments[1..]].concat()).output().unwrap()
    };
    let drawn = flexframe(&["animate", "-o", "tied.gif", "--frames", "5", "--to", "0.02"]);
    assert!(drawn.status.success(), "{}", String::from_utf8_lossy(&drawn.stderr));
    assert!(std::fs::read(folder.path().join("tied.gif")).unwrap().starts_with(b"GIF"));
    for arguments in [&["cost", "--body", "rod"][..], &["fmu", "-o", "tied.fmu", "--body", "rod"]] {
        let refused = flexframe(arguments);
        let words = String::from_utf8_lossy(&refused.stderr).into_owned();
        assert!(!refused.status.success() && words.contains("joints, springs or bushings hold"), "{words}");
    }
}

/// A bar of finite elements that swings about its left face, held by `hold`.
const HUNG: &str = r#"
title = "A bar on a hinge"
units = { length = "mm", mass = "Mg", time = "s" }

[body]
mesh = "../meshes/half_bar.msh"
material = { young_modulus = 70000.0, poisson_ratio = 0.33, density = 2.7e-9 }
markers = { root = { group = "left" } }

[modes]
flexible = 6
damping_ratio = 0.01

[[loads]]
kind = "gravity"
direction = [0.0, 0.0, -1.0]
amplitude = 9810.0

[time]
end = 0.3
tolerance = 1e-6

[output]
interval = 0.01
"#;

/// Independent reference: the same body with its constraint taken in by the reduction, by the exponential scheme. The joint
/// holds the mean of the face, the constraint each of its nodes.
#[test]
fn a_joint_to_the_ground_moves_a_body_as_its_constraint_does() {
    let constraint = "[[constraints]]\nkind = \"hinge\"\nat = [0, 0, 0]\naxis = [0, 1, 0]\ngroup = \"left\"\n";
    let joint =
        "[[joints]]\nname = \"hinge\"\nkind = \"revolute\"\nbetween = [\"ground\", \"body.root\"]\naxis = [0, 1, 0]\n";
    let results = |hold: &str| {
        let file = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../../tests/hung.toml"));
        let scene = Scene::parse(&format!("{HUNG}\n{hold}"), file).unwrap();
        let folder = tempfile::tempdir().unwrap();
        let (_, report) = run(&scene, folder.path(), &RunSettings::default(), |_| ()).unwrap();
        (Results::open(&report.results, &COLUMNS).unwrap(), report.steps)
    };
    let ((held, steps_held), (tied, steps_tied)) = (results(constraint), results(joint));
    let [angle, expected] = [tied.numbers("joints/hinge/angle"), held.numbers("hinge/angle")].map(Option::unwrap);
    let off = angle.iter().zip(expected).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
    let swing = expected.iter().fold(0.0_f64, |most, angle| most.max(angle.abs()));
    println!("{off:e} rad of {swing}; {steps_tied} steps, and {steps_held} with the constraint");
    assert!(swing > 1.0 && off < 2e-5, "{off:e}");
    // The stiffest shape of the joint does not limit its steps, once what it rings with is damped: it has 60 000 periods in the run.
    assert!(steps_tied < 10_000, "{steps_tied}");
}

/// Independent reference: the constraint taken in by the reduction, and a joint to the ground of a marker that the scene names. A spring
/// beside a constraint makes it a joint to the ground; one without force leaves the motion as it was.
#[test]
fn a_constraint_stands_beside_springs_and_joints() {
    const SPRING: &str =
        "[ground.markers.far]\nat = [400, 0, 300]\n[[springs]]\nbetween = [\"body.tip\", \"ground.far\"]\nstiffness = ";
    let file = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../../tests/hung.toml"));
    let short = HUNG.replace("end = 0.3", "end = 0.02").replace("tolerance = 1e-6", "tolerance = 1e-5");
    let tip = |hold: &str| {
        let text = short
            .replace("{ root = { group = \"left\" } }", "{ root = { at = [0, 0, 0] }, tip = { at = [200, 0, 0] } }");
        let (_folder, report) = ran(&format!("{text}points = {{ tip = [200, 0, 0] }}\n{hold}"), file);
        Results::open(&report.results, &COLUMNS).unwrap().vectors::<3>("points/tip/displacement").unwrap().to_vec()
    };
    let off = |one: &str, other: &str| {
        let apart =
            |(a, b): (&[f64; 3], &[f64; 3])| -> f64 { a.iter().zip(b).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max) };
        tip(one).iter().zip(&tip(other)).map(apart).fold(0.0, f64::max)
    };
    let constraint = |of: &str| format!("[[constraints]]\n{of}\n");
    // A shaft beside the axis, and nodes of a line: the tip moves by some 3 mm.
    for held in [
        constraint(
            "kind = \"hinge\"\nat = [0, 0, 12]\naxis = [0, 1, 0]\ngroup = \"left\"\n[initial]\nangular_velocity = [0, 5, 0]",
        ),
        constraint("kind = \"support\"\ndirections = [\"x\", \"y\", \"z\"]\nbox = [[0, -5, -5], [0, 5, -5]]"),
    ] {
        let off = off(&held, &format!("{held}{SPRING}1e-9\n"));
        assert!(off < 1e-3, "{off:e} mm, {held}");
    }
    let pin = constraint("kind = \"pin\"\nat = [0, 0, 0]");
    let joint = "[[joints]]\nkind = \"spherical\"\nbetween = [\"ground\", \"body.root\"]\n";
    let off = off(&format!("{pin}{SPRING}0.5\n"), &format!("{joint}{SPRING}0.5\n"));
    assert!(off < 1e-4, "{off:e} mm");
}

/// A scene that has run: the folder of its results, which goes with it, and its report.
#[track_caller]
fn ran(scene: &str, file: &Path) -> (tempfile::TempDir, RunReport) {
    let folder = tempfile::tempdir().unwrap();
    let system = Scene::parse(scene, file).unwrap();
    let (_, report) =
        run(&system, folder.path(), &RunSettings::default(), |_| ()).unwrap_or_else(|error| panic!("{error}: {scene}"));
    (folder, report)
}

/// Independent reference: the rigid bodies of `./dev random-systems` in maximal coordinates. Steps shrank to nothing where the rounding of a
/// place was above what counts of a radius of gyration.
#[test]
fn bodies_of_hardly_any_inertia_are_led_past_a_near_singular_place() {
    let file = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../../tests/small_inertia.toml"));
    let (_folder, report) = ran(include_str!("../../small_inertia.toml"), file);
    let results = Results::open(&report.results, &COLUMNS).unwrap();
    let last = |body: &str| *results.vectors::<3>(&format!("bodies/{body}/position")).unwrap().last().unwrap();
    let apart: Vec<f64> = last("b2").iter().zip(last("b1")).map(|(b2, b1)| b2 - b1).collect();
    for (found, expected) in apart.iter().zip([-0.681_523_93, 0.112_501_37, 0.082_337_28]) {
        assert!((found - expected).abs() < 1e-5, "{apart:?}");
    }
}

/// Closed form: friction F tanh(v / v_f) that holds 95 % of F creeps at v_f artanh(0.95); the arm starts at rest.
#[test]
fn a_run_tells_how_friction_that_holds_creeps() {
    let scene = r#"
title = "An arm held by friction"
units = { length = "m", mass = "kg", time = "s" }
[bodies.arm]
rigid = { mass = 2.0, center_of_mass = [0.5, 0, 0], inertia = [[0.2, 0, 0], [0, 0.2, 0], [0, 0, 0.2]] }
markers = { root = { at = [0, 0, 0] } }
[[bodies.arm.loads]]
kind = "gravity"
direction = [0, 0, -1]
amplitude = 9.81
[[joints]]
name = "brake"
kind = "revolute"
between = ["ground", "arm.root"]
axis = [0, 1, 0]
spring = { friction = { force = 10.326315789473684, rate = 1e-5 } }
[time]
end = 1.0
tolerance = 1e-4
[output]
interval = 0.1
"#;
    let (_folder, report) = ran(scene, Path::new("arm.toml"));
    let [held] = &report.tied[0].held[..] else { panic!("{:?}", report.tied) };
    let expected = 1e-5 * 0.95_f64.atanh();
    assert!(held.joint == "brake" && held.time > 0.999 && (held.path / expected - 1.0).abs() < 1e-3, "{held:?}");
    let text = report.to_string();
    assert!(text.contains("held     by friction of brake for 1, in which it creeps by 1.8"), "{text}");
    // What friction holds has hardly an error.
    assert!(report.tied[0].step_errors.as_ref().is_some_and(|errors| errors.ruled_by.is_none()), "{:?}", report.tied);
    assert!(text.contains("lengths  of steps were set by convergence"), "{text}");
    // At rest, balances stand over what its weight could give, and raise no alarm.
    let balances = &report.bodies[0].balances;
    assert!(balances.energy < 1e-2 && balances.angular_momentum < 1e-1, "{balances:?}");
    assert!(report.warnings.is_empty(), "{:?}", report.warnings);
}

#[test]
fn a_run_tells_that_stops_act_on_a_flexible_body() {
    let joint =
        "[[joints]]\nname = \"hinge\"\nkind = \"revolute\"\nbetween = [\"ground\", \"body.root\"]\naxis = [0, 1, 0]\n";
    let stops = "spring = { stops = { high = 0.5, stiffness = 1e4 } }\n";
    let file = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../../tests/hung.toml"));
    for (joint, expected) in [(joint.to_owned(), vec![]), (format!("{joint}{stops}"), vec!["hinge".to_owned()])] {
        let (_folder, report) = ran(&format!("{}\n{joint}", HUNG.replace("end = 0.3", "end = 0.02")), file);
        assert_eq!(report.tied[0].flexible_stops, expected);
        assert_eq!(report.to_string().contains("beyond its modes"), !expected.is_empty());
    }
}

/// A light body on a stiff bushing hangs at rest: its sag has less energy than places of the allowed error.
const HANGING: &str = r#"
title = "A light body on a stiff bushing"
units = { length = "m", mass = "kg", time = "s" }
[bodies.pendulum]
rigid = { mass = 1.0, center_of_mass = [0, 0, -1], inertia = [[1e-3, 0, 0], [0, 1e-3, 0], [0, 0, 1e-3]] }
markers = { hinge = { at = [0, 0, 0] }, end = { at = [0, 0, -1] } }
[[bodies.pendulum.loads]]
kind = "gravity"
direction = [0, 0, -1]
amplitude = 9.81
[bodies.dot]
rigid = { mass = 1e-4, center_of_mass = [0, 0, -1], inertia = [[1e-10, 0, 0], [0, 1e-10, 0], [0, 0, 1e-10]] }
markers = { end = { at = [0, 0, -1] } }
[[bodies.dot.loads]]
kind = "gravity"
direction = [0, 0, -1]
amplitude = 9.81
[[joints]]
name = "hinge"
kind = "revolute"
between = ["ground", "pendulum.hinge"]
axis = [0, 1, 0]
[[bushings]]
name = "pad"
between = ["pendulum.end", "dot.end"]
stiffness = { translation = [1e9, 1e9, 1e9], rotation = [1e3, 1e3, 1e3] }
[time]
end = 1.0
tolerance = 1e-6
"#;

/// A gear whose motor has a full torque from one instant to the next, after a rest.
const GEAR: &str = r#"
title = "A gear that begins at rest"
units = { length = "m", mass = "kg", time = "s" }
[bodies.first]
rigid = { mass = 1.0, center_of_mass = [0, 0, 0], inertia = [[0.5, 0, 0], [0, 0.5, 0], [0, 0, 0.5]] }
markers = { axle = { at = [0, 0, 0] } }
[bodies.second]
rigid = { mass = 1.0, center_of_mass = [0, 0, 0], inertia = [[0.5, 0, 0], [0, 0.5, 0], [0, 0, 0.5]] }
markers = { axle = { at = [0, 0, 0] } }
initial = { position = [1, 0, 0] }
[[joints]]
name = "driven"
kind = "revolute"
between = ["ground", "first.axle"]
axis = [0, 0, 1]
motor = { amplitude = 58.0, history = { kind = "table", points = [[0, 0], [0.25, 0], [0.250000001, 1]] } }
[[joints]]
name = "geared"
kind = "revolute"
between = ["ground", "second.axle"]
axis = [0, 0, 1]
[[couplings]]
kind = "gear"
joints = ["driven", "geared"]
ratio = -2.5
[time]
end = 1.25
tolerance = 1e-6
"#;

/// Runs a scene of rigid bodies at tolerances.
fn at_tolerances(tolerances: &[&str], scene: &str, check: impl Fn(&Results)) {
    for tolerance in tolerances {
        let scene = scene.replace("tolerance = 1e-6", &format!("tolerance = {tolerance}"));
        let (_folder, report) = ran(&scene, Path::new("scene.toml"));
        check(&Results::open(&report.results, &COLUMNS).unwrap());
    }
}

/// Closed form: nothing moves.
#[test]
fn a_light_body_that_hangs_at_rest_stays_there() {
    at_tolerances(&["1e-3", "1e-5", "1e-6", "1e-8"], HANGING, |results| {
        let angles = results.numbers("joints/hinge/angle").unwrap();
        assert!(angles.iter().all(|angle| angle.abs() < 1e-9), "{angles:?}");
    });
}

/// Closed form: a torque M on inertias J and J/r² turns the first by M t²/(2 J (1 + 1/r²)) in the second after the rest.
#[test]
fn a_gear_whose_motor_begins_within_an_instant_turns_as_it_must() {
    at_tolerances(&["1e-4", "1e-6", "1e-8"], GEAR, |results| {
        let [driven, geared] = ["driven", "geared"]
            .map(|joint| *results.numbers(&format!("joints/{joint}/angle")).unwrap().last().unwrap());
        let expected = 0.5 * 58.0 / (0.5 * (1.0 + 1.0 / 6.25));
        assert!((driven - expected).abs() < 1e-6 * expected, "{driven} for {expected}");
        assert!((driven + 2.5 * geared).abs() < 1e-9 * expected, "{driven} {geared}");
    });
}

/// Closed form: a joint that holds nothing lets its body fall by ½ g t².
#[test]
fn a_joint_that_holds_nothing_holds_nothing() {
    let text = "title = \"falls\"\nunits = { length = \"m\", mass = \"kg\", time = \"s\" }\n[bodies.ball]\n\
                rigid = { mass = 1.0, center_of_mass = [0, 0, 0], inertia = [[1, 0, 0], [0, 1, 0], [0, 0, 1]] }\n\
                markers = { m = { at = [0, 0, 0] } }\nloads = [{ kind = \"gravity\", direction = [0, 0, -1], amplitude = 8.0 }]\n\
                [[joints]]\nname = \"none\"\nlocked = []\naxis = [0, 0, 1]\nbetween = [\"ground\", \"ball.m\"]\n[time]\nend = 0.5\ntolerance = 1e-6\n";
    let folder = tempfile::tempdir().unwrap();
    let scene = Scene::parse(text, folder.path().join("ball.toml")).unwrap();
    let settings = RunSettings { check: false, ..RunSettings::default() };
    let (_, report) = run(&scene, folder.path(), &settings, |_| ()).unwrap();
    let results = Results::open(&report.results, &COLUMNS).unwrap();
    let [_, _, height] = *results.vectors::<3>("bodies/ball/position").unwrap().last().unwrap();
    assert!((height + 1.0).abs() < 1e-9, "{height}");
}

/// A point mass that a joint would turn is told by its name, and at its line of the scene.
#[test]
fn what_is_refused_of_a_body_in_joints_names_it() {
    let text = "title = \"arm and bob\"\nunits = { length = \"m\", mass = \"kg\", time = \"s\" }\n\
                [bodies.arm.rigid]\nmass = 1.0\ncenter_of_mass = [0, 0, 0]\ninertia = [[0.1, 0, 0], [0, 0.1, 0], [0, 0, 0.1]]\n\
                [bodies.arm.markers]\nroot = { at = [0, 0, 0] }\ntip = { at = [0.5, 0, 0] }\n\
                [bodies.bob.rigid]\nmass = 1.0\ncenter_of_mass = [0, 0, 0]\ninertia = [[0, 0, 0], [0, 0, 0], [0, 0, 0]]\n\
                [bodies.bob]\nmarkers = { middle = { at = [0, 0, 0] } }\ninitial = { position = [0.5, 0, 0] }\n\
                [[joints]]\nname = \"root\"\nkind = \"revolute\"\nbetween = [\"ground\", \"arm.root\"]\naxis = [0, 0, 1]\n\
                [[joints]]\nname = \"tip\"\nkind = \"revolute\"\nbetween = [\"arm.tip\", \"bob.middle\"]\naxis = [0, 0, 1]\n\
                [time]\nend = 1.0\ntolerance = 1e-4\n[output]\ninterval = 0.1\n";
    let scene = Scene::parse(text, Path::new("arm_and_bob.toml")).unwrap();
    let folder = tempfile::tempdir().unwrap();
    let message = run(&scene, folder.path(), &RunSettings::default(), |_| ()).err().unwrap().to_string();
    let at = "arm_and_bob.toml:13:11: `bodies.bob.rigid.inertia`";
    for words in [at, "a point mass", "that the joint \"tip\" would turn", "give it an inertia"] {
        assert!(message.contains(words), "{message}");
    }
}

/// A cart that runs far along a rail keeps as few digits as its places have there, and this is told.
#[test]
fn places_far_along_a_rail_are_told_to_be_coarse() {
    let scene = |x: f64| {
        format!(
            "title = \"cart\"\nunits = {{ length = \"m\", mass = \"kg\", time = \"s\" }}\n\
             [bodies.cart.rigid]\nmass = 1.0\ncenter_of_mass = [0, 0, 0]\ninertia = [[0.1, 0, 0], [0, 0.1, 0], [0, 0, 0.1]]\n\
             [bodies.cart]\nmarkers = {{ middle = {{ at = [0, 0, 0] }} }}\n\
             initial = {{ position = [{}, {}, 0], velocity = [0.6, 0.8, 0] }}\n\
             [[joints]]\nname = \"rail\"\nkind = \"prismatic\"\nbetween = [\"ground.start\", \"cart.middle\"]\naxis = [0.6, 0.8, 0]\n\
             [ground.markers]\nstart = {{ at = [0, 0, 0] }}\n\
             [time]\nend = 1.0\ntolerance = 1e-8\n[output]\ninterval = 0.5\n",
            0.6 * x,
            0.8 * x
        )
    };
    for (x, is_told) in [(1.0, false), (1e6, true)] {
        let (_folder, report) = ran(&scene(x), Path::new("cart.toml"));
        let text = report.to_string();
        assert_eq!(text.contains("their places are rounded to"), is_told, "{text}");
        // Of its size of 0.3 to 0.6 m.
        let part = report.tied[0].rounding_of_places / (f64::EPSILON * (x + 1.0));
        assert!(part > 1.6 && part < 3.4, "{part}");
    }
}
