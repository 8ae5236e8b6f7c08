//! The price list: complete, true to the orders of the schemes, and right about the cheapest setting.

use std::path::{Path, PathBuf};
use std::process::Output;
use std::sync::OnceLock;
use std::time::Duration;

use dynamics::{Method, Observation, Rows, StepControl};
use flexframe::cost::{CostReport, CostSettings, LadderRun, Line, MeasuredRun, Outcome, Setting, price_list};
use model::{Builder, Model};
use scene::{Body, METHODS, Scene};

use crate::program::command_in;

const TARGET: f64 = 1e-4;

/// The ring, spinning and ringing, for a twentieth of a second.
const SCENE: &str = include_str!("short_ring.toml");

fn scene_text(time: &str) -> String {
    let mesh = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../..")).join("meshes/ring.msh");
    SCENE.replace("MESH", mesh.to_str().unwrap()).replace("TIME", time)
}

fn scene(time: &str) -> Body {
    Body::parse(&scene_text(time), "ring.toml").unwrap()
}

/// Bounded by steps, not by time, so that the rows are the same on any machine, however busy.
fn settings(max_steps: u64, target: f64) -> CostSettings {
    let timed_for = Duration::from_millis(1);
    CostSettings { patience: Duration::from_secs(600), max_steps, timed_for, target: Some(target) }
}

/// The list with a target, and the CSV file, made once.
fn list() -> &'static (CostReport, String) {
    static LIST: OnceLock<(CostReport, String)> = OnceLock::new();
    LIST.get_or_init(|| {
        let folder = tempfile::tempdir().unwrap();
        let settings = settings(40_000, TARGET);
        let report =
            price_list(&scene("step = 3e-5").into(), &Builder::default(), folder.path(), settings, |_| ()).unwrap();
        assert_eq!(report.files.len(), 4);
        assert!(report.files.iter().all(|file| std::fs::metadata(file).unwrap().len() > 1000));
        let csv = std::fs::read_to_string(folder.path().join("cost.csv")).unwrap();
        (report, csv)
    })
}

fn line(method: Method, controlled: bool) -> &'static Line {
    let is_it = |line: &&Line| {
        (line.formulation, line.scheme, line.controlled) == (method.formulation, method.scheme, controlled)
    };
    list().0.lines.iter().find(is_it).unwrap()
}

fn runs(line: &Line) -> Vec<(f64, &MeasuredRun)> {
    line.rows.iter().filter_map(|row| Some((row.setting.value(), row.measured()?))).collect()
}

/// Conserved: the error falls with the order of each scheme.
#[test]
fn every_method_is_in_the_list_with_its_order() {
    for method in METHODS {
        let line = line(method, false);
        assert_eq!(line.order, method.order);
        let order = line.measured_order.unwrap_or_else(|| panic!("no order of {}", line.name()));
        assert!((order - f64::from(line.order)).abs() < 0.3, "{}: {order}", line.name());
        for (_, run) in runs(line) {
            assert_eq!(run.evaluations, run.steps * u64::from(method.evaluations_per_step));
        }
    }
    let controlled = METHODS.into_iter().filter(|method| method.estimates_error);
    assert_eq!(controlled.map(|method| line(method, true).rows.len()).filter(|rows| *rows > 2).count(), 2);
}

/// Conserved: the error falls with the step.
#[test]
fn errors_fall_down_the_ladder() {
    for line in &list().0.lines {
        let errors: Vec<f64> = runs(line).iter().map(|(_, run)| run.step_errors.unwrap().largest()).collect();
        let first = errors.iter().copied().find(|error| *error < 1e-2).unwrap();
        let last = errors.last().unwrap();
        assert!(last < &(0.05 * first), "{}: {errors:?}", line.name());
        assert!(line.rows.is_sorted_by(|a, b| a.setting.value() > b.setting.value()));
    }
}

/// Conserved: a scheme that shares no step with the reference comes to the same motion.
#[test]
fn the_reference_is_closer_than_all_that_is_ranked() {
    let report = &list().0;
    let own = report.reference.own_error.largest();
    assert!(own > 0.0 && own < 1e-8, "{own:e}");
    for (_, run) in report.lines.iter().flat_map(runs) {
        assert!(run.error >= 3.0 * own);
        assert_eq!(run.at_reference, run.errors.largest() <= 3.0 * own);
    }
    // A scheme that has no step in common with the reference comes to the same motion.
    let closest = runs(line(Method::RKMK4, false)).last().unwrap().1;
    assert!(closest.errors.largest() < 1e-5, "{:?}", closest.errors);
    // The paper's formulation comes to another one.
    let limit = report.paper_limit.as_ref().unwrap();
    assert!(limit.errors.unwrap().largest() > 100.0 * limit.own_error.largest());
}

#[test]
fn nothing_on_the_front_is_beaten() {
    let all: Vec<&LadderRun> = list().0.lines.iter().flat_map(|line| &line.rows).collect();
    let front: Vec<&MeasuredRun> = all.iter().filter(|row| row.on_front).map(|row| row.measured().unwrap()).collect();
    assert!(front.len() > 2);
    for run in all.iter().filter_map(|row| row.measured()) {
        assert!(!front.iter().any(|best| run.error < best.error && run.seconds < best.seconds));
    }
    // The scene's own setting is marked, once.
    let own: Vec<&&LadderRun> = all.iter().filter(|row| row.of_scene).collect();
    assert_eq!(own.len(), 1);
    assert_eq!(own[0].setting, Setting::Step(3e-5));
}

/// Conserved: the same motion by another scheme in short steps.
#[test]
fn the_answer_reaches_the_target_when_the_scene_is_run_with_it() {
    let answer = list().0.answer.as_ref().unwrap();
    let run = answer.run.as_ref().unwrap().measured().unwrap();
    assert!(run.error <= TARGET);
    let cheaper = |line: &Line| runs(line).iter().any(|(_, m)| m.error <= TARGET && m.seconds < run.seconds);
    assert!(!list().0.lines.iter().any(cheaper));

    let pasted = scene(&answer.lines.join("\n"));
    let model = Model::build(&pasted, |_| ()).unwrap();
    let all = |simulation: dynamics::Simulation| -> Vec<Observation> { simulation.map(Result::unwrap).collect() };
    let found = all(model.start(&pasted).unwrap());
    // Another scheme at a step that is short enough.
    let rkmk4 = Method::RKMK4;
    let expected = all(model.start_with(&pasted, rkmk4, StepControl::Fixed(2.5e-6), Rows::Interval(5e-4)).unwrap());
    assert_eq!((found.len(), expected.len()), (101, 101));
    let worst = |values: &dyn Fn(&Observation, &Observation) -> (f64, f64)| {
        let (mut error, mut peak) = (0.0_f64, 0.0_f64);
        for (a, b) in found.iter().zip(&expected) {
            assert!((a.time - b.time).abs() < 1e-12);
            let (e, p) = values(a, b);
            (error, peak) = (error.max(e), peak.max(p));
        }
        error / peak
    };
    let attitude = worst(&|a, b| (a.attitude.angle_to(&b.attitude), 1.0));
    let modal = worst(&|a, b| {
        let pairs = || a.modal_displacement.iter().zip(&b.modal_displacement);
        (pairs().map(|(a, b)| (a - b).abs()).fold(0.0, f64::max), pairs().map(|(_, b)| b.abs()).fold(0.0, f64::max))
    });
    let acceleration = worst(&|a, b| {
        let (a, b) = (a.points[0].acceleration, b.points[0].acceleration);
        ((a - b).norm(), b.norm())
    });
    let reached = attitude.max(modal).max(acceleration);
    assert!(reached <= 1.01 * TARGET, "{reached:e}");
    // And it is the error that the list says, as far as it comes from these three.
    let listed = run.errors.attitude.max(run.errors.modal.unwrap()).max(run.errors.acceleration.unwrap());
    assert!((reached / listed - 1.0).abs() < 0.05, "{reached:e} {listed:e}");
}

#[test]
fn a_target_beyond_reach_is_said_to_be() {
    let folder = tempfile::tempdir().unwrap();
    let report =
        price_list(&scene("step = 3e-5").into(), &Builder::default(), folder.path(), settings(1000, 1e-30), |_| ())
            .unwrap();
    let answer = report.answer.unwrap();
    assert!(answer.run.is_none() && answer.lines.is_empty() && answer.smallest_error > 1e-20);
    assert!(answer.to_string().contains("no setting that was tried"), "{answer}");
}

#[test]
fn a_run_that_takes_longer_than_the_patience_is_stopped_and_named() {
    let folder = tempfile::tempdir().unwrap();
    let patience = Duration::from_millis(20);
    let settings = CostSettings { patience, timed_for: Duration::from_millis(1), ..settings(1_000_000, TARGET) };
    // Five million steps, which take some seconds.
    let report =
        price_list(&scene("step = 1e-8").into(), &Builder::default(), folder.path(), settings, |_| ()).unwrap();
    let rows: Vec<&LadderRun> = report.lines.iter().flat_map(|line| &line.rows).collect();
    let own = rows.iter().find(|row| row.of_scene).unwrap();
    let Outcome::OutOfPatience(stopped) = &own.outcome else { panic!("{own:?}") };
    assert!(stopped.patience == 0.02 && stopped.reached < 0.5, "{stopped:?}");
    // None of the others took longer, those under step control neither: a thousand steps may go by between two looks.
    for run in rows.iter().filter_map(|row| row.measured()) {
        let of_a_thousand_steps = 1000.0 / (run.steps + run.rejected) as f64 * run.seconds;
        assert!(run.seconds <= 0.02 + of_a_thousand_steps, "{run:?}");
    }
    let answer = report.answer.as_ref().unwrap().to_string();
    for words in [
        "took too long and were stopped",
        "step 1e-8 (the scene's own setting): stopped at",
        "patience of 0.02 s",
        "--patience",
    ] {
        assert!(answer.contains(words), "{words} in {answer}");
    }
    let table = CostReport { answer: None, ..report }.to_string();
    assert!(table.contains("patience of 0.02 s was used up"), "{table}");
    let csv = std::fs::read_to_string(folder.path().join("cost.csv")).unwrap();
    assert!(csv.lines().any(|line| fields(line).last().unwrap().contains("patience of 0.02 s")));
}

#[test]
fn the_worst_quantity_of_the_modes_is_named_with_the_others_beside_it() {
    let report = &list().0;
    let errors = report.bodies[0].modes[1].errors.unwrap();
    // The half-sine strikes the point: its acceleration needs the most modes.
    assert!(errors.largest() == errors.acceleration.unwrap() && errors.displacement < errors.velocity, "{errors:?}");
    let words = report.answer.as_ref().unwrap().modes.as_ref().unwrap();
    for expected in [
        format!("with 4 of them the acceleration of the points is {:.1e} off", errors.largest()),
        format!("the displacement of the points {:.1e}", errors.displacement.unwrap()),
        format!("the velocity of the points {:.1e}", errors.velocity.unwrap()),
    ] {
        assert!(words.contains(&expected), "{expected} in {words}");
    }
    // With and without a target.
    assert!(CostReport { answer: None, ..report.clone() }.to_string().contains("the acceleration of the points is"));
}

#[test]
fn modes_left_out_are_an_error_of_their_own() {
    let modes = &list().0.bodies[0].modes;
    let counts: Vec<usize> = modes.iter().map(|row| row.flexible).collect();
    assert_eq!(counts, [2, 4, 8, 16]);
    assert!(modes.is_sorted_by(|a, b| a.highest_frequency < b.highest_frequency));
    assert!(modes[3].errors.is_none());
    let error = |row: usize| modes[row].errors.unwrap().largest();
    // The struck point's acceleration needs the higher modes; what is shown is theirs, not that of the steps.
    assert!(error(0) > error(2) && error(2) > 100.0 * modes[0].step_error, "{modes:?}");
    let words = list().0.answer.as_ref().unwrap().modes.as_ref().unwrap();
    assert!(words.contains("with 4 of them") && words.contains("`flexible = 8`"), "{words}");
}

#[test]
fn the_table_for_programs_is_well_formed() {
    let (report, csv) = list();
    let mut lines = csv.lines();
    let header: Vec<&str> = lines.next().unwrap().split(',').collect();
    let column = |name: &str| header.iter().position(|column| *column == name).unwrap();
    let rows: Vec<&LadderRun> = report.lines.iter().flat_map(|line| &line.rows).collect();
    let records: Vec<Vec<String>> = lines.map(fields).collect();
    assert_eq!(records.len(), rows.len());
    for (record, row) in records.iter().zip(rows) {
        assert_eq!(record.len(), header.len(), "{record:?}");
        let number = |name: &str| record[column(name)].parse::<f64>().ok();
        match row.setting {
            Setting::Step(step) => assert_eq!((number("step"), number("tolerance")), (Some(step), None)),
            Setting::Tolerance(tolerance) => {
                assert_eq!((number("step"), number("tolerance")), (None, Some(tolerance)));
            }
        }
        match &row.outcome {
            Outcome::Ran(m) => {
                assert_eq!(number("error"), Some(m.error));
                assert_eq!(number("acceleration"), m.errors.acceleration);
                assert_eq!(number("seconds"), Some(m.seconds));
                assert_eq!(record[column("on_front")], row.on_front.to_string());
                assert!(record[column("failure")].is_empty());
            }
            Outcome::Failed(failure) => assert_eq!(&record[column("failure")], failure),
            Outcome::OutOfPatience(stopped) => assert_eq!(record[column("failure")], stopped.to_string()),
        }
    }
}

/// The fields of a line of CSV.
fn fields(line: &str) -> Vec<String> {
    let (mut fields, mut quoted) = (vec![String::new()], false);
    let mut characters = line.chars().peekable();
    while let Some(c) = characters.next() {
        match c {
            '"' if quoted && characters.peek() == Some(&'"') => {
                characters.next();
                fields.last_mut().unwrap().push('"');
            }
            '"' => quoted = !quoted,
            ',' if !quoted => fields.push(String::new()),
            other => fields.last_mut().unwrap().push(other),
        }
    }
    fields
}

fn flexframe(folder: &Path, arguments: &[&str]) -> Output {
    command_in(folder, arguments).output().unwrap()
}

fn scene_file(folder: &Path) -> PathBuf {
    let path = folder.join("ring.toml");
    std::fs::write(&path, scene_text("step = 1e-4")).unwrap();
    path
}

#[test]
fn the_command_prints_the_list_or_the_answer() {
    let folder = tempfile::tempdir().unwrap();
    scene_file(folder.path());
    let list = flexframe(folder.path(), &["cost", "ring.toml", "--patience", "0.005"]);
    assert!(list.status.success(), "{}", String::from_utf8_lossy(&list.stderr));
    let text = String::from_utf8(list.stdout).unwrap();
    for words in ["reference  conservative, exponential", "scheme rkmk4: order 4", "step control", "out/ring/cost.csv"]
    {
        assert!(text.contains(words), "{words} in {text}");
    }
    let arguments = ["cost", "ring.toml", "--patience", "0.02", "--target", "0.1", "-o", "here"];
    let answer = flexframe(folder.path(), &arguments);
    let text = String::from_utf8(answer.stdout).unwrap();
    let first = text.lines().next().unwrap();
    assert!(first.starts_with("formulation = \"conservative\", scheme = "), "{first}");
    assert!(text.contains("[time]") && folder.path().join("here/work_precision.svg").exists());
    let json = flexframe(folder.path(), &["cost", "ring.toml", "--patience", "0.002", "--json", "--overwrite"]);
    let value: serde_json::Value = serde_json::from_slice(&json.stdout).unwrap();
    assert_eq!(value["lines"].as_array().unwrap().len(), 6);
    assert!(value["lines"][0]["rows"][0]["outcome"]["ran"]["error"].as_f64().unwrap() > 0.0);
    for wrong in ["0", "-1e-3", "NaN", "ten"] {
        let refused = flexframe(folder.path(), &["cost", "ring.toml", &format!("--target={wrong}")]);
        assert_eq!(refused.status.code(), Some(2), "{wrong}");
    }
}

/// Two rigid bodies, one of which tumbles fast.
const SEVERAL: &str = r#"
title = "Two tops"
units = { length = "m", mass = "kg", time = "s" }
[bodies.slow]
rigid = { mass = 1.0, center_of_mass = [0, 0, 0], inertia = [[1.0, 0, 0], [0, 2.0, 0], [0, 0, 2.5]] }
initial = { angular_velocity = [0.1, 1.0, 0.2] }
[bodies.fast]
rigid = { mass = 2.0, center_of_mass = [0, 0, 0], inertia = [[1.0, 0, 0], [0, 1.5, 0], [0, 0, 2.0]] }
initial = { angular_velocity = [0.2, 7.0, 0.3] }
points = { tip = [1.0, 0.0, 0.0] }
[time]
end = 1.0
step = 0.01
"#;

/// Conserved: the errors and steps of lists of each body alone.
#[test]
fn of_several_bodies_an_error_is_that_of_the_worst_and_work_is_that_of_all() {
    let folder = tempfile::tempdir().unwrap();
    let priced = |system: &Scene, name: &str| {
        let settings = CostSettings { target: None, ..settings(2000, 0.0) };
        price_list(system, &Builder::default(), &folder.path().join(name), settings, |_| ()).unwrap()
    };
    let system = Scene::parse(SEVERAL, "tops.toml").unwrap();
    let both = priced(&system, "both");
    assert_eq!(both.bodies.iter().map(|body| body.name.as_str()).collect::<Vec<_>>(), ["slow", "fast"]);
    assert_eq!((both.bodies[0].points, both.bodies[1].points), (0, 1));
    let [slow, fast] = [0, 1].map(|number| {
        let scene = system.bodies[number].clone();
        let name = scene.name.clone().unwrap();
        priced(&scene.into(), &name)
    });
    let rows = |report: &CostReport| -> Vec<(&'static str, f64, MeasuredRun)> {
        let lines = report.lines.iter().filter(|line| line.formulation == "conservative" && !line.controlled);
        lines.flat_map(|line| runs(line).into_iter().map(|(step, run)| (line.scheme, step, run.clone()))).collect()
    };
    let [slow, fast] = [slow, fast].map(|report| rows(&report));
    let mut compared = 0;
    for (scheme, step, run) in rows(&both) {
        let alone = |rows: &[(&str, f64, MeasuredRun)]| {
            rows.iter().find(|row| (row.0, row.1) == (scheme, step)).map(|row| row.2.clone())
        };
        let (Some(slow), Some(fast)) = (alone(&slow), alone(&fast)) else { continue };
        assert_eq!(run.steps, slow.steps + fast.steps);
        assert_eq!(run.evaluations, slow.evaluations + fast.evaluations);
        if fast.error > 1e-6 {
            compared += 1;
            assert!((run.error / slow.error.max(fast.error) - 1.0).abs() < 1e-3, "{scheme} {step}: {run:?}");
        }
    }
    assert!(compared > 2, "{compared}");
    // Words and data have both.
    let words = both.to_string();
    for part in ["2 bodies, 1 s", "slow       0 flexible modes, 0 points", "fast       0 flexible modes, 1 points"] {
        assert!(words.contains(part), "{part}: {words}");
    }
    let json = serde_json::to_value(&both).unwrap();
    assert!(json["bodies"][1]["initial_spin"].as_f64().unwrap() > 7.0 && json.get("initial_spin").is_none(), "{json}");
}

const TIED: &str = r#"
title = "double pendulum"
units = { length = "m", mass = "kg", time = "s" }
[bodies.upper]
rigid = { mass = 1.0, center_of_mass = [0, 0, 0], inertia = [[0.01, 0, 0], [0, 0.09, 0], [0, 0, 0.09]] }
markers = { top = { at = [-0.5, 0, 0] }, bottom = { at = [0.5, 0, 0] } }
initial = { position = [0.5, 0, 0] }
[[bodies.upper.loads]]
kind = "gravity"
amplitude = 9.81
direction = [0, -1, 0]
[bodies.lower]
rigid = { mass = 1.0, center_of_mass = [0, 0, 0], inertia = [[0.01, 0, 0], [0, 0.09, 0], [0, 0, 0.09]] }
markers = { top = { at = [-0.5, 0, 0] } }
initial = { position = [1.5, 0, 0] }
points = { tip = [0.5, 0, 0] }
[[bodies.lower.loads]]
kind = "gravity"
amplitude = 9.81
direction = [0, -1, 0]
[[joints]]
name = "top"
kind = "revolute"
between = ["ground", "upper.top"]
axis = [0, 0, 1]
[[joints]]
name = "middle"
kind = "revolute"
between = ["upper.bottom", "lower.top"]
axis = [0, 0, 1]
[time]
end = 1.0
tolerance = 1e-5
"#;

/// Conserved: the orders of the schemes of tied bodies.
#[test]
fn tied_bodies_have_a_price_list_of_their_schemes() {
    let folder = tempfile::tempdir().unwrap();
    let scene = Scene::parse(TIED, "pendulum.toml").unwrap();
    let settings = settings(20_000, 1e-4);
    let report = price_list(&scene, &Builder::default(), folder.path(), settings, |_| ()).unwrap();
    let lines: Vec<_> = report.lines.iter().map(|line| (line.scheme, line.controlled, line.order)).collect();
    assert_eq!(
        lines,
        [
            ("radau", false, 5),
            ("radau", true, 5),
            ("gauss", false, 6),
            ("gauss", true, 6),
            ("rkmk4", false, 4),
            ("rkmk4", true, 4)
        ]
    );
    assert!(report.reference.own_error.largest() < 1e-7, "{:?}", report.reference.own_error);
    for line in &report.lines {
        let errors: Vec<f64> = runs(line).into_iter().map(|(_, run)| run.error).collect();
        println!("{} {}: {errors:?} {:?}", line.scheme, line.controlled, line.measured_order);
        assert!(errors.len() > 1 && errors.last().unwrap() < &1e-6, "{} {errors:?}", line.scheme);
        if let Some(order) = line.measured_order {
            assert!((order - f64::from(line.order)).abs() < 0.7, "{} {order}", line.scheme);
        }
    }
    assert!(report.lines[1].rows.iter().any(|row| row.of_scene && row.measured().is_some()));
    assert!(report.paper_limit.is_none() && report.bodies.iter().all(|body| body.modes_failure.is_some()));
    let answer = report.answer.unwrap();
    assert!(
        ["radau", "gauss", "rkmk4"].iter().any(|name| answer.lines[0] == format!("scheme = \"{name}\"")),
        "{:?}",
        answer.lines
    );
    let alone = flexframe::scene::Body::parse_body(TIED, "pendulum.toml", Some("upper")).unwrap();
    let refused = price_list(&alone.into(), &Builder::default(), folder.path(), settings, |_| ()).unwrap_err();
    assert!(refused.to_string().contains("joints"), "{refused}");
}
