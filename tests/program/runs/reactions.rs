//! Reactions, drives and angles against closed forms: statics, a pendulum, a spinning bar, a spin-up.

use flexframe::columns::COLUMNS;
use flexframe::dynamics::Observation;
use flexframe::model::Model;
use flexframe::nalgebra::Vector3;
use flexframe::results::Results;
use flexframe::run::{RunSettings, run};
use flexframe::scene::Body;

fn rows(text: &str) -> (Model, Vec<Observation>) {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../../examples/of_a_test.toml");
    rows_of(&Body::parse(text, path).unwrap())
}

fn rows_of(body: &Body) -> (Model, Vec<Observation>) {
    let model = Model::build(body, |_| ()).unwrap();
    let rows = model.start(body).unwrap().map(Result::unwrap).collect();
    (model, rows)
}

const ROD: &str = r#"
title = "A rod on a hinge"
units = { length = "m", mass = "kg", time = "s" }
[body]
rigid = { mass = 3.0, center_of_mass = [0.5, 0.0, 0.0], inertia = [[0.02, 0.0, 0.0], [0.0, 0.25, 0.0], [0.0, 0.0, 0.25]] }
[[constraints]]
kind = "hinge"
at = [0.0, 0.0, 0.0]
axis = [0.0, 0.0, 1.0]
"#;

/// Closed form: with ω² = 2 (m g d/J) (cos θ − cos θ₀), the bearing gives m (d ω² + g cos θ) along the rod and m g
/// sin θ (1 − m d²/J) across it.
#[test]
fn the_bearing_of_a_pendulum_gives_what_the_closed_form_has() {
    let body = Body::read(concat!(env!("CARGO_MANIFEST_DIR"), "/../../examples/pendulum.toml")).unwrap();
    let (_, rows) = rows_of(&body);
    let (mass, arm, inertia, gravity, start) = (3.0, 0.5, 1.0, 9.81, 2.0_f64);
    for now in &rows {
        let theta = start - now.reaction.hinge_angle;
        let square = 2.0 * mass * gravity * arm / inertia * (theta.cos() - start.cos());
        let along = mass * (arm * square + gravity * theta.cos());
        let across = mass * gravity * theta.sin() * (1.0 - mass * arm * arm / inertia);
        let expected = Vector3::new(-along, -across, 0.0);
        assert!((now.reaction.force_body - expected).norm() < 1e-8 * mass * gravity, "{now:?} {expected}");
        // Gravity turns it about the hinge: the bearing does not.
        assert!(now.reaction.moment_body.norm() < 1e-10 * mass * gravity, "{now:?}");
    }
}

/// Closed form: m g.
#[test]
fn a_hung_rod_weighs_on_its_bearing_what_it_weighs() {
    let load = "[[loads]]\nkind = \"gravity\"\ndirection = [1.0, 0.0, 0.0]\namplitude = 9.81\n[time]\nend = 0.1\nstep = 1e-3\n";
    let (_, rows) = rows(&(ROD.to_owned() + load));
    let found = rows.last().unwrap().reaction;
    assert!((found.force_body - Vector3::new(-3.0 * 9.81, 0.0, 0.0)).norm() < 1e-12, "{found:?}");
    assert!(found.moment_body.norm() < 1e-12);
}

/// Closed form: θ = Ωt, and m d Ω² along the rod.
#[test]
fn seventy_two_turns_are_seventy_two_turns() {
    let speed = 72.0 * std::f64::consts::TAU;
    let spin = format!(
        "[initial]\nangular_velocity = [0.0, 0.0, {speed}]\n[time]\nend = 1.0\nstep = 1e-3\n[output]\ninterval = 0.25\n"
    );
    let (_, rows) = rows(&(ROD.to_owned() + &spin));
    for now in &rows {
        assert!(
            (now.reaction.hinge_angle - speed * now.time).abs() < 1e-9
                && (now.reaction.hinge_rate - speed).abs() < 1e-9
        );
        // The bearing holds the rod on its circle.
        assert!((now.reaction.force_body.x / (-3.0 * 0.5 * speed * speed) - 1.0).abs() < 1e-12);
    }
}

const BEAM: &str = r#"
title = "A slender beam"
units = { length = "m", mass = "kg", time = "s" }
[body]
mesh = "../meshes/wu_haug_beam.msh"
material = { young_modulus = 6.8952e10, poisson_ratio = 0.0, density = 2766.7 }
"#;

const END: &str = "box = [[0.0, -0.1, -0.1], [0.0, 0.1, 0.1]]\n";

/// Closed form: statics: the force and its moment about the clamp.
#[test]
fn a_clamped_beam_at_rest_has_the_moment_of_its_load() {
    let scene = format!(
        "{BEAM}[modes]\nflexible = 6\ndamping_ratio = 1.0\n[[constraints]]\nkind = \"clamp\"\n{END}[[loads]]\nkind = \"force\"\nat = \
         [8.0, 0.0, 0.0]\ndirection = [0.0, 1.0, 0.0]\namplitude = 0.5\nhistory = {{ kind = \"constant\" }}\n[time]\nend = 20.0\nstep = 1e-2\n\
         [output]\npoints = {{ tip = [8.0, 0.0, 0.0] }}\n"
    );
    let (_, rows) = rows(&scene);
    let now = rows.last().unwrap();
    let arm = Vector3::new(8.0, 0.0, 0.0) + now.points[0].elastic_displacement_body;
    let found = now.reaction;
    // At the start all of the load is taken by the inertia of the modes and what they leave to the support.
    assert!((found.force_body - Vector3::new(0.0, -0.5, 0.0)).norm() < 1e-9, "{found:?}");
    assert!((found.moment_body + arm.cross(&Vector3::new(0.0, 0.5, 0.0))).norm() < 1e-3 * 4.0, "{found:?}");
    assert!((found.moment_body.z + 4.0).abs() < 1e-3, "{found:?}");
}

/// Closed form: m Ω² times the distance of the centre of mass, which stretching moves by a ten-millionth, once the
/// bar that was not stretched at the start has come to rest on its hinge.
#[test]
fn the_hinge_of_a_spinning_bar_holds_it_on_its_circle() {
    let scene = format!(
        "{BEAM}[modes]\nflexible = 6\ndamping_ratio = 0.9\n[[constraints]]\nkind = \"hinge\"\nat = [0.0, 0.0, 0.0]\naxis = [0.0, 0.0, 1.0]\n{END}[initial]\nangular_velocity = \
         [0.0, 0.0, 0.5]\n[time]\nend = 8.0\nstep = 5e-3\n"
    );
    let (model, rows) = rows(&scene);
    let expected = model.body.mass * 0.25 * 4.0;
    for now in rows.iter().filter(|now| now.time > 7.0) {
        let found = now.reaction;
        assert!((found.force_body.x / -expected - 1.0).abs() < 1e-5, "{found:?} {expected}");
        assert!(found.moment_body.norm() < 1e-3 * 4.0 * expected, "{found:?}");
        assert!((found.hinge_angle - 0.5 * now.time).abs() < 1e-4);
    }
}

/// Closed form: θ(t) is the integral of the given speed; the energy is what the drive has put in.
#[test]
fn the_drive_of_a_spin_up_does_the_work_that_the_beam_has() {
    let mut body = Body::read(concat!(env!("CARGO_MANIFEST_DIR"), "/../../examples/spin_up.toml")).unwrap();
    body.time.end = 17.0;
    let (_, rows) = rows_of(&body);
    let last = rows.last().unwrap();
    // 6·15/2 rad in the rise, and 6 rad a second after it: more than nine turns.
    assert!((last.reaction.hinge_angle - (45.0 + 12.0)).abs() < 1e-8, "{:?}", last.reaction);
    assert!((last.reaction.hinge_rate - 6.0).abs() < 1e-12);
    let work: f64 = rows
        .windows(2)
        .map(|pair| 0.5 * (pair[1].time - pair[0].time) * (pair[0].reaction.drive_power + pair[1].reaction.drive_power))
        .sum();
    assert!((work / last.work.work - 1.0).abs() < 1e-4, "{work} {}", last.work.work);
    assert!((work / last.energy() - 1.0).abs() < 1e-4, "{work} {}", last.energy());
    // The torque is the rate of the angular momentum, by differences in time.
    let momentum = |now: &Observation| now.angular_momentum_global.z;
    let largest = rows.iter().map(|now| now.reaction.drive.abs()).fold(0.0, f64::max);
    for three in rows.windows(3).filter(|three| three[2].time < 14.9) {
        let rate = (momentum(&three[2]) - momentum(&three[0])) / (three[2].time - three[0].time);
        assert!((three[1].reaction.drive - rate).abs() < 1e-2 * largest, "{rate} {:?}", three[1].reaction);
        assert!((three[1].reaction.moment_body.z - three[1].reaction.drive).abs() < 1e-12 * largest);
    }
}

/// Closed form: no moment about the axis of a hinge: what it leaves free it does not hold, on the manifold of large
/// modes with static shapes beside them either.
#[test]
fn a_hinge_gives_no_moment_about_its_axis_to_a_rod_that_bends_far() {
    let scene = format!(
        "{}[modes]\nflexible = 8\nlarge = 4\nstatic_correction = true\n[[constraints]]\nkind = \"hinge\"\nat = [0.0, 0.0, 0.0]\naxis = \
         [0.0, 0.0, 1.0]\n{END}[effects]\nlarge_deflection = true\n[initial]\nangular_velocity = [0.0, 0.0, 2.0]\n[[loads]]\nkind = \
         \"gravity\"\ndirection = [0.0, -1.0, 0.0]\namplitude = 9.81\n[time]\nend = 0.3\nstep = 5e-4\n[output]\ninterval = 0.05\n",
        BEAM.replace("6.8952e10", "2e9")
    );
    let (model, rows) = rows(&scene);
    let weight = model.body.mass * 9.81 * 4.0;
    for now in &rows {
        let moment = now.reaction.moment_body;
        // Measured: 2e-16 of it.
        assert!(moment.z.abs() < 1e-9 * weight, "{moment}");
    }
}

/// A beam of 8 m with these supports and loads, and the reactions in its results file.
fn on_supports(rest: &str) -> (Model, Results) {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../../examples/of_a_test.toml");
    let body = Body::parse(&format!("{BEAM}{rest}"), path).unwrap();
    let folder = tempfile::tempdir().unwrap();
    let (mut models, report) = run(&body.into(), folder.path(), &RunSettings::default(), |_| ()).unwrap();
    (models.remove(0), Results::open(report.results, &COLUMNS).unwrap())
}

const CLAMP: &str = "[[constraints]]\nkind = \"support\"\nbox = [[0.0, -1.0, -1.0], [0.0, 1.0, 1.0]]\n\
                     directions = [\"x\", \"y\", \"z\"]\n";
const PROP: &str =
    "[[constraints]]\nkind = \"support\"\nbox = [[8.0, -1.0, -1.0], [8.0, 1.0, 1.0]]\ndirections = [\"y\"]\n";
const LENGTH: f64 = 8.0;

/// Closed form: at rest under its weight a propped cantilever has 3/8 of it on the prop, 5/8 on the clamp, and a
/// moment of an eighth of it times the length there; a modal sum of two modes would not have that.
#[test]
fn each_support_of_a_propped_cantilever_has_its_part() {
    let (model, results) = on_supports(&format!(
        "[modes]\nflexible = 2\ndamping_ratio = 0.7\n{CLAMP}{PROP}[effects]\nlarge_deflection = false\n[[loads]]\n\
         kind = \"gravity\"\ndirection = [0.0, -1.0, 0.0]\namplitude = 1e-3\n[time]\nend = 20.0\nstep = 1e-2\n[output]\nevery = 100\n"
    ));
    assert_eq!(results.metadata.bodies[0].support_names, ["1", "2"]);
    let weight = model.body.mass * 1e-3;
    let last = |path: &str| Vector3::from(*results.vectors::<3>(path).unwrap().last().unwrap()) / weight;
    let (clamp, prop) = (last("supports/1/force"), last("supports/2/force"));
    let moment = last("supports/1/moment") / LENGTH;
    println!("{clamp} {prop} {moment}");
    // Shear moves a little of it.
    assert!((prop.y - 0.375).abs() < 2e-3 && (clamp.y - 0.625).abs() < 2e-3, "{clamp} {prop}");
    assert!((moment.z - 0.125).abs() < 2e-3, "{moment}");
    assert!((clamp + prop - last("reaction/force")).norm() < 1e-6, "{clamp} {prop}");
}

/// Closed form: two supports that leave the beam to turn about none of its axes, of which each gives half of what a
/// force in the middle does; and while a force at the quarter shakes it, both together are d'Alembert's at every row.
#[test]
fn two_supports_share_a_force_and_their_sum_is_that_of_dalembert() {
    let rest = |at: f64, history: &str, damping: f64, time: &str| {
        format!(
            "[modes]\nflexible = 6\ndamping_ratio = {damping}\n{}{}[effects]\nlarge_deflection = false\ngeometric_stiffening = \
             false\n[[loads]]\nkind = \"force\"\nat = [{at:?}, 0.0, 0.0]\ndirection = [0.0, -1.0, 0.0]\namplitude = 1e-3\nhistory = \
             {history}\n{time}",
            // Simply supported: the mid-plane of each end.
            CLAMP.replace("-1.0, -1.0]", "0.0, -1.0]").replace("1.0, 1.0]", "0.0, 1.0]"),
            PROP.replace("-1.0, -1.0]", "0.0, -1.0]")
                .replace("1.0, 1.0]", "0.0, 1.0]")
                .replace("\"y\"", "\"y\", \"z\""),
        )
    };
    let forces = |results: &Results, path: &str| -> Vec<Vector3<f64>> {
        results.vectors::<3>(path).unwrap().iter().map(|force| Vector3::from(*force)).collect()
    };
    for (at, expected) in [(4.0, 0.5), (2.0, 0.25)] {
        let time = "[time]\nend = 10.0\nstep = 1e-2\n[output]\nevery = 100\n";
        let (_, results) = on_supports(&rest(at, "{ kind = \"constant\" }", 0.7, time));
        let far = forces(&results, "supports/2/force").last().unwrap().y / 1e-3;
        println!("{at}: {far}");
        assert!((far - expected).abs() < 1e-6, "{at}: {far}");
    }
    let time = "[time]\nend = 2.0\nstep = 1e-3\n[output]\nevery = 10\n";
    let (_, results) = on_supports(&rest(2.0, "{ kind = \"sine\", frequency = 3.0 }", 0.02, time));
    let [near, far, all] =
        ["supports/1/force", "supports/2/force", "reaction/force"].map(|path| forces(&results, path));
    let moments = ["supports/1/moment", "supports/2/moment", "reaction/moment"].map(|path| forces(&results, path));
    let largest = all.iter().map(|force| force.norm()).fold(0.0, f64::max);
    assert!(largest > 3e-4, "{largest}");
    let origin = Vector3::from(results.metadata.bodies[0].model.origin);
    let centers = [0.0, LENGTH].map(|x| Vector3::new(x, 0.0, 0.0) - origin);
    for row in 0..results.rows() {
        let sum = near[row] + far[row];
        assert!((sum - all[row]).norm() < 1e-6 * largest, "{row}: {sum} {}", all[row]);
        let moment = moments[0][row] + moments[1][row] + centers[0].cross(&near[row]) + centers[1].cross(&far[row]);
        assert!((moment - moments[2][row]).norm() < 1e-5 * LENGTH * largest, "{row}: {moment} {}", moments[2][row]);
    }
}
