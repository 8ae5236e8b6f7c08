//! From the text of a scene to the motion of its body, on a bar small enough for closed forms.

mod auto;
mod damping;
mod gradient;
mod histories;
mod hostile_ties;
mod kept;
mod loads;
mod matrices;
mod mechanisms;
mod mesh_lies;
mod off;
mod quasi_static;
mod statics;
mod step;
mod strain;
mod stress;
mod supports;
mod ties;
mod tolerance;
mod turned;

use std::path::Path;

use dynamics::{Observation, PointMotion};
use model::{BuildError, BuildProgress, Model};
use nalgebra::Vector3;
use scene::{Body, BodySource, Material, Materials};

/// Length and breadth of the bar of `../data/bar.geo`, which lies on the x-axis from its origin.
const LENGTH: f64 = 200.0;
const BREADTH: f64 = 10.0;
/// Its material.
const YOUNG: f64 = 70e3;
const POISSON: f64 = 0.3;
const DENSITY: f64 = 2.7e-9;
const MASS: f64 = DENSITY * LENGTH * BREADTH * BREADTH;
/// Second moment of its cross-section.
const BENDING: f64 = BREADTH * BREADTH * BREADTH * BREADTH / 12.0;

const CLAMPED: &str = "[[constraints]]\nkind = \"clamp\"\ngroup = \"root\"\n";

/// A scene of the bar: its modes, what else there is, and how its time goes.
fn bar(modes: &str, rest: &str, time: &str) -> Body {
    let text = format!(
        r#"
title = "Bar"
units = {{ length = "mm", mass = "Mg", time = "s" }}
[body]
mesh = "../data/bar.msh"
material = {{ young_modulus = {YOUNG:e}, poisson_ratio = {POISSON}, density = {DENSITY:e} }}
[modes]
{modes}
{rest}
[time]
{time}
[output.points]
root = [0.0, 0.0, 0.0]
middle = [100.0, 0.0, 0.0]
tip = [200.0, 0.0, 0.0]
"#
    );
    parse(&text)
}

/// A rigid body: mass 2, centre of mass (1, 2, 3), and a general inertia about it.
fn rigid(rest: &str, time: &str) -> Body {
    parse(&format!(
        r#"
title = "Stone"
units = {{ length = "m", mass = "kg", time = "s" }}
[body.rigid]
mass = 2.0
center_of_mass = [1.0, 2.0, 3.0]
inertia = [[5.0, 0.5, 0.2], [0.5, 6.0, -0.3], [0.2, -0.3, 4.0]]
{rest}
[time]
{time}
[output.points]
center = [1.0, 2.0, 3.0]
"#
    ))
}

fn parse(text: &str) -> Body {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/integration/scene.toml");
    Body::parse(text, path).unwrap_or_else(|error| panic!("{error}"))
}

fn build(body: &Body) -> Model {
    Model::build(body, |_| ()).unwrap_or_else(|error| panic!("{error}"))
}

/// Error with which a scene is refused.
fn refusal(body: &Body) -> BuildError {
    match Model::build(body, |_| ()) {
        Ok(_) => panic!("it was built"),
        Err(error) => error,
    }
}

/// All observations of a run, the first included.
fn observations(body: &Body, model: &Model) -> Vec<Observation> {
    let run = model.start(body).unwrap_or_else(|error| panic!("{error}"));
    run.map(|row| row.unwrap_or_else(|error| panic!("{error}"))).collect()
}

fn first(body: &Body) -> (Model, Observation) {
    let model = build(body);
    let mut run = model.start(body).unwrap_or_else(|error| panic!("{error}"));
    let first = run.observation().unwrap();
    (model, first)
}

fn last(body: &Body) -> (Model, Observation) {
    let model = build(body);
    let last = observations(body, &model).pop().unwrap();
    (model, last)
}

/// The motion of a named point.
fn point<'a>(model: &Model, observation: &'a Observation, name: &str) -> &'a PointMotion {
    let i = model.points.iter().position(|(point, _)| point == name).unwrap();
    &observation.points[i]
}

#[track_caller]
fn near(found: Vector3<f64>, expected: Vector3<f64>, relative: f64) {
    let off = (found - expected).norm() / expected.norm();
    assert!(off < relative, "{found:?} is {off:e} off {expected:?}");
}

#[track_caller]
fn close(found: f64, expected: f64, relative: f64) {
    let off = (found / expected - 1.0).abs();
    assert!(off < relative, "{found} is {off:e} off {expected}");
}

#[test]
fn what_the_modal_analysis_refuses_names_the_scene_file() {
    for (density, young_modulus, says) in
        [(1e-310, YOUNG, "which no rigid body can have"), (1e300, 1e300, "a dense eigenvalue problem")]
    {
        let mut body = bar("flexible = 2", "", "end = 1e-3\nstep = 1e-5");
        let BodySource::Meshed(meshed) = &mut body.source else { panic!("no mesh") };
        meshed.materials = Materials::Uniform(Material { young_modulus, poisson_ratio: POISSON, density });
        let error = refusal(&body);
        assert!(matches!(error, BuildError::Modal { .. }), "{error}");
        let message = error.to_string();
        assert!(message.starts_with(&format!("{}: ", body.path.display())) && message.contains(says), "{message}");
    }
}
