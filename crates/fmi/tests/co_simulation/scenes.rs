//! Scenes on a slender beam of 8 m, and their runs by the library without an FMU.

use std::path::{Path, PathBuf};

use flexframe::fmu::{FmuBody, FmuModel};
use flexframe::model::Builder;
use flexframe::row::{BodyRow, Row};
use flexframe::scene::{Body, Scene};

const MATERIAL: &str = "material = { young_modulus = 6.8952e10, poisson_ratio = 0.3, density = 2766.7 }";
pub const STEP: f64 = 2e-3;
pub const END: f64 = 0.2;

fn mesh() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../meshes/wu_haug_beam.msh")
}

/// A scene on the beam with two points, in steps of [`STEP`].
pub fn scene(more: &str) -> Body {
    scene_in_steps(more, &format!("step = {STEP}"))
}

pub fn scene_in_steps(more: &str, step: &str) -> Body {
    let text = format!(
        r#"
        title = "a beam"
        units = {{ length = "m", mass = "kg", time = "s" }}
        [body]
        mesh = {:?}
        {MATERIAL}
        [modes]
        flexible = 5
        damping_ratio = 0.01
        static_correction = false
        [time]
        end = {END}
        {step}
        [output]
        interval = 0.02
        points = {{ tip = [8.0, 0.0, 0.0], "the middle" = [4.0, 0.0, 0.0] }}
        stress = true
        {more}
        "#,
        mesh()
    );
    Body::parse(&text, "beam.toml").unwrap()
}

/// It flies, tumbles, and is struck.
pub const FREE: &str = r#"
    [initial]
    angular_velocity = [0.5, 3.0, 1.0]
    velocity = [1.0, 0.0, 2.0]
    [[loads]]
    kind = "force"
    at = [8.0, 0.0, 0.0]
    direction = [0.0, 1.0, 1.0]
    frame = "body"
    amplitude = 300.0
    history = { kind = "half-sine", duration = 0.05 }
    [[loads]]
    kind = "gravity"
    direction = [0.0, 0.0, -1.0]
    amplitude = 9.81
"#;

/// A beam that bends far on a hinge.
pub const LARGE: &str = r#"
    [effects]
    large_deflection = true
    [[constraints]]
    kind = "hinge"
    at = [0.0, 0.0, 0.0]
    axis = [0.0, 0.0, 1.0]
    box = [[0.0, -0.1, -0.1], [0.0, 0.1, 0.1]]
    [[loads]]
    kind = "gravity"
    direction = [0.0, -1.0, 0.0]
    amplitude = 9.81
"#;

/// On a hinge that is driven at this speed.
pub fn driven(speed: &str) -> String {
    format!(
        r#"
        [[constraints]]
        kind = "hinge"
        at = [0.0, 0.0, 0.0]
        axis = [0.0, 0.0, 1.0]
        box = [[0.0, -0.1, -0.1], [0.0, 0.1, 0.1]]
        motion = {speed}
        "#
    )
}

/// A body without a mesh, on a pin.
pub fn rigid() -> Body {
    let text = r#"
        title = "a top"
        units = { length = "mm", mass = "Mg", time = "ms" }
        [body]
        rigid = { mass = 2e-3, center_of_mass = [0.0, 0.0, 50.0], inertia = [[4.0, 0.0, 0.0], [0.0, 4.0, 0.0], [0.0, 0.0, 3.0]] }
        [initial]
        angular_velocity = [0.001, 0.0, 0.05]
        [[constraints]]
        kind = "pin"
        at = [0.0, 0.0, 0.0]
        [[loads]]
        kind = "gravity"
        direction = [0.0, 0.1, -1.0]
        amplitude = 9.81e-3
        [time]
        end = 200.0
        step = 0.5
        [output]
        interval = 20.0
        points = { top = [0.0, 0.0, 100.0] }
    "#;
    Body::parse(text, "top.toml").unwrap()
}

/// The beam and a rigid body, as bodies of one scene.
pub fn bodies() -> Vec<Body> {
    let text = format!(
        r#"
        title = "two bodies"
        units = {{ length = "m", mass = "kg", time = "s" }}
        [bodies.beam]
        mesh = {:?}
        {MATERIAL}
        modes = {{ flexible = 3, damping_ratio = 0.01, static_correction = false }}
        points = {{ tip = [8.0, 0.0, 0.0] }}
        initial = {{ angular_velocity = [0.5, 3.0, 1.0] }}
        [bodies."the top"]
        rigid = {{ mass = 1.0, center_of_mass = [0, 0, 0], inertia = [[4, 0, 0], [0, 5, 0], [0, 0, 7]] }}
        initial = {{ angular_velocity = [0.1, 5.0, 0.1], position = [0.0, 4.0, 0.0] }}
        [time]
        end = {END}
        step = {STEP}
        [output]
        interval = 0.02
        "#,
        mesh()
    );
    Scene::parse(&text, "bodies.toml").unwrap().bodies
}

/// The rows of a run of the library, without an FMU.
pub fn own_run(body: &Body) -> Vec<Vec<f64>> {
    let fmu = FmuModel::new(body.clone().into(), &Builder::default(), |_| ()).unwrap();
    let FmuBody { body, model, .. } = &fmu.bodies[0];
    let mut row = Row { time: 0.0, bodies: vec![BodyRow::new(model)], joints: Vec::new() };
    (model.start(body).unwrap())
        .map(|now| {
            row.bodies[0].motion = now.unwrap();
            row.bodies[0].complete(model);
            let mut numbers = Vec::new();
            fmu.numbers(&row, &mut numbers);
            numbers
        })
        .collect()
}
