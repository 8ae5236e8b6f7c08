//! Joints whose numbers are as bad as numbers can be: each scene is refused with a message, or moves with finite numbers only.

use std::path::Path;

use dynamics::{Observation, Simulation, SystemSetup};
use model::{Model, tie};
use scene::Scene;

const SCENE: &str = r#"
title = "t"
units = { length = "m", mass = "kg", time = "s" }
[bodies.stone]
rigid = { mass = 2.0, center_of_mass = [1.0, 2.0, 3.0], inertia = [[5.0, 0.5, 0.2], [0.5, 6.0, -0.3], [0.2, -0.3, 4.0]] }
initial = { position = [0.1, 0.2, 0.3], velocity = [1.0, 0.0, 0.5], angular_velocity = [0.0, 1.0, 3.0] }
loads = [{ kind = "gravity", direction = [0.0, 0.0, -1.0], amplitude = 9.81 }]
[bodies.stone.markers]
top = { at = [1.0, 2.0, 4.0], z = [0.0, 1.0, 0.2], x = [1.0, 0.3, 0.1] }
side = { at = [2.0, 2.0, 3.0] }
[bodies.bar]
mesh = "../data/bar.msh"
material = { young_modulus = 7e10, poisson_ratio = 0.33, density = 2.7e-3 }
modes = { flexible = 2, damping_ratio = 0.1 }
initial = { position = [2.1, 2.2, 3.3] }
[bodies.bar.markers]
root = { box = [[0.0, -9.0, -9.0], [0.0, 9.0, 9.0]], z = [0.0, 0.0, 1.0] }
tip = { at = [200.0, 0.0, 0.0], radius = 8.0 }
[ground.markers.wall]
at = [1.1, 2.2, 4.3]
z = [0.0, 1.0, 0.2]
[[joints]]
kind = "cylindrical"
between = ["ground.wall", "stone.top"]
drive = { along = "slide", amplitude = 0.1, history = { kind = "sine", frequency = 2.0, phase = 0.0 } }
motor = { along = "turn", amplitude = 3.0, history = { kind = "ramp", duration = 0.1 } }
[joints.spring]
along = "turn"
stiffness = 10.0
damping = 0.2
free = 0.1
preload = 0.3
stops = { low = -0.5, high = 0.5, stiffness = 1e3, damping = 1.0 }
friction = { force = 0.5, rate = 1e-2 }
[[joints]]
kind = "revolute"
between = ["stone.side", "bar.root"]
axis = [0.0, 0.0, 1.0]
[[couplings]]
kind = "gear"
joints = ["joint1", "joint2"]
ratio = 2.0
[[springs]]
between = ["bar.tip", "ground.wall"]
stiffness = 30.0
damping = 0.5
free_length = 100.0
[[bushings]]
between = ["bar.tip", "ground"]
stiffness = { translation = [1.0, 2.0, 3.0], rotation = [4.0, 5.0, 6.0] }
damping = { translation = [0.1, 0.2, 0.3], rotation = [0.4, 0.5, 0.6] }
[time]
end = 0.1
tolerance = 1e-4
"#;

/// Where the numbers stand in a text.
fn numbers(text: &str) -> Vec<std::ops::Range<usize>> {
    let ends = |c: char| " ,[]{}\n".contains(c);
    let mut at = 0;
    let mut found = Vec::new();
    for piece in text.split_inclusive(ends) {
        let word = piece.trim_end_matches(ends);
        if word.parse::<f64>().is_ok() {
            found.push(at..at + word.len());
        }
        at += piece.len();
    }
    found
}

const NASTY: [&str; 16] = [
    "0.0", "-1.0", "0.5", "1e-5", "1e-17", "1e-160", "1e-300", "5e-324", "1e5", "1e9", "1e20", "1e100", "1e160",
    "-1e200", "1e300", "1.7e308",
];

/// Reads, builds, ties and steps; how far it came.
fn run(text: &str) -> Result<usize, (usize, String)> {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/integration/hostile.toml");
    let scene = Scene::parse(text, path).map_err(|error| (0, error.to_string()))?;
    let models = scene.bodies.iter().map(|given| Model::build(given, |_| ())).collect::<Result<Vec<_>, _>>();
    let models = models.map_err(|error| (1, error.to_string()))?;
    for tied in tie(&scene, &models).map_err(|error| (2, error.to_string()))? {
        let time = scene.bodies[0].time;
        let setup = SystemSetup {
            points: vec![Vec::new(); tied.bodies.len()],
            system: tied.system,
            states: tied.states,
            start: scene.start,
            scheme: dynamics::SystemScheme::Radau,
            control: time.control,
            end: time.end,
            rows: scene.rows,
        };
        let mut simulation = Simulation::of_system(setup).map_err(|error| (3, error.to_string()))?;
        let mut now: Vec<Observation> = (0..tied.bodies.len()).map(|body| simulation.room(body)).collect();
        for _ in 0..3 {
            simulation.observe(&mut now).map_err(|error| (4, error.to_string()))?;
            for body in &now {
                let numbers = body.origin_global.iter().chain(&body.omega_body).chain(&body.modal_displacement);
                assert!(numbers.chain([&body.kinetic_energy]).all(|x| x.is_finite()), "{text}\n{body:?}");
            }
            simulation.advance_watched(4, |_, _| ()).map_err(|error| (4, error.to_string()))?;
        }
    }
    Ok(5)
}

#[test]
fn bad_numbers_of_joints_are_refused_or_move_with_finite_ones() {
    assert_eq!(run(SCENE), Ok(5));
    // Knuth's MMIX linear congruential generator.
    let mut state = 1_u64;
    let mut below = |end: usize| {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 33) as usize % end
    };
    let mut ended = [0; 6];
    for _ in 0..40 {
        let mut spoiled = SCENE.to_owned();
        for _ in 0..=below(2) {
            let places = numbers(&spoiled);
            spoiled.replace_range(places[below(places.len())].clone(), NASTY[below(NASTY.len())]);
        }
        let came = match run(&spoiled) {
            Ok(came) => came,
            Err((came, message)) => {
                assert!(!message.is_empty() && message.chars().count() < 4000, "{message}");
                came
            }
        };
        ended[came] += 1;
    }
    println!("{ended:?}");
    assert!(ended[0] > 0 && ended[5] > 0, "{ended:?}");
}
