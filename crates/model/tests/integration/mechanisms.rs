//! The mechanisms of `examples/`: each moves as the mathematics at the head of its scene say.

use std::f64::consts::{FRAC_PI_2, TAU};
use std::path::Path;

use dynamics::{Reached, Rows, Simulation, Start, SystemSetup};
use model::{Model, tie};
use scene::Scene;

use crate::build;

/// The mechanism of an example at its start.
fn mechanism(name: &str, rows: f64) -> Simulation {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../examples/mechanisms").join(name);
    let scene = Scene::read(path).unwrap_or_else(|error| panic!("{error}"));
    let models: Vec<Model> = scene.bodies.iter().map(build).collect();
    let tied = tie(&scene, &models).unwrap_or_else(|error| panic!("{error}")).remove(0);
    assert_eq!(tied.bodies.len(), scene.bodies.len());
    let time = scene.bodies[0].time;
    let simulation = Simulation::of_system(SystemSetup {
        points: vec![Vec::new(); tied.bodies.len()],
        system: tied.system,
        states: tied.states,
        start: scene.start,
        scheme: dynamics::SystemScheme::Radau,
        control: time.control,
        end: time.end,
        rows: Rows::Interval(rows),
    })
    .unwrap_or_else(|error| panic!("{error}"));
    for change in simulation.system().unwrap().assembled() {
        assert!(
            scene.start == Start::Relaxed || change.moved < 1e-9 && change.turned < 1e-9,
            "its bodies are placed: {change:?}"
        );
    }
    simulation
}

/// Goes to the next row; false at the end.
fn to_row(simulation: &mut Simulation) -> bool {
    loop {
        match simulation.advance_watched(1000, |_, _| ()).unwrap_or_else(|error| panic!("{error}")) {
            Reached::End => return false,
            Reached::Row => return true,
            _ => {}
        }
    }
}

fn turn(simulation: &Simulation, joint: usize) -> f64 {
    simulation.system_motion().unwrap().joint_coordinates(joint).turn
}

/// Conserved: the energy of a rigid bar on the hinge.
#[test]
fn the_bar_on_a_hinge_falls_with_the_energy_of_its_weight() {
    let mut simulation = mechanism("hinge.toml", 0.02);
    let over_mass = 200.0_f64.powi(2) / 3.0 + 100.0 / 12.0;
    let mut rows = 0;
    while to_row(&mut simulation) {
        let hinge = simulation.system_motion().unwrap().joint_coordinates(0);
        let (kinetic, fallen) = (0.5 * over_mass * hinge.turn_rate.powi(2), 9810.0 * 100.0 * hinge.turn.sin());
        assert!((kinetic - fallen).abs() < 2e-3 * 9810.0 * 100.0, "{}: {kinetic} {fallen}", simulation.time());
        rows += 1;
    }
    assert!(rows > 10);
}

/// Closed form, integrated here: the equations of Lagrange of two rigid bars.
#[test]
fn the_double_pendulum_falls_as_two_rods_do() {
    let mut simulation = mechanism("double_pendulum.toml", 0.2);
    let (l, h, g) = (200.0, 10.0, 9810.0);
    // Over the mass.
    let j = (l * l + h * h) / 12.0;
    let rates = |[a, b, da, db]: [f64; 4]| {
        let (s, c) = (a - b).sin_cos();
        let (m11, m22, m12) = (j + 1.25 * l * l, j + 0.25 * l * l, 0.5 * l * l * c);
        let f1 = -0.5 * l * l * db * db * s - 1.5 * g * l * a.sin();
        let f2 = 0.5 * l * l * da * da * s - 0.5 * g * l * b.sin();
        let det = m11 * m22 - m12 * m12;
        [da, db, (m22 * f1 - m12 * f2) / det, (m11 * f2 - m12 * f1) / det]
    };
    let mut y = [FRAC_PI_2, FRAC_PI_2, 0.0, 0.0];
    let (steps, h) = (2000, 1e-4);
    for _ in 0..steps {
        let add = |y: [f64; 4], k: [f64; 4], by: f64| std::array::from_fn(|i| y[i] + by * k[i]);
        let k1 = rates(y);
        let k2 = rates(add(y, k1, 0.5 * h));
        let k3 = rates(add(y, k2, 0.5 * h));
        let k4 = rates(add(y, k3, h));
        y = std::array::from_fn(|i| y[i] + h / 6.0 * (k1[i] + 2.0 * k2[i] + 2.0 * k3[i] + k4[i]));
    }
    assert!(to_row(&mut simulation));
    // About y, the bars turn down from the horizontal.
    let (hook, knee) = (turn(&simulation, 0), turn(&simulation, 1));
    println!("{hook} {} {knee} {}", FRAC_PI_2 - y[0], y[0] - y[1]);
    assert!((hook - (FRAC_PI_2 - y[0])).abs() < 2e-3 && (knee - (y[0] - y[1])).abs() < 4e-3);
}

/// Independent reference: Simeon's plane beam, after 0.1 s.
#[test]
fn the_slider_crank_of_a_scene_ends_where_others_have_it() {
    let mut simulation = mechanism("slider_crank.toml", 0.1);
    while to_row(&mut simulation) {}
    let motion = simulation.system_motion().unwrap();
    let slider = motion.state(2).unwrap().origin_global;
    let crank = motion.state(0).unwrap();
    let pin = crank.origin_global * 2.0;
    let angle = (slider.y - pin.y).atan2(slider.x - pin.x);
    println!("{angle} {}", slider.x);
    assert!((angle + 0.331_173_498_825_626).abs() < 1e-6 && (slider.x - 0.169_737_332_842_786).abs() < 1e-6);
    assert!((turn(&simulation, 0) - 15.0).abs() < 1e-9, "full turns are counted");
}

/// Closed form: the loop of rigid links.
#[test]
fn the_four_bar_linkage_turns_as_its_loop_says() {
    let mut simulation = mechanism("four_bar.toml", 0.1);
    let rocker = |crank: f64| {
        let pin = [60.0 * crank.sin(), 60.0 * crank.cos()];
        let (dx, dz) = (200.0 - pin[0], -pin[1]);
        let d = f64::hypot(dx, dz);
        let along = (200.0_f64.powi(2) - 120.0_f64.powi(2) + d * d) / (2.0 * d);
        let across = (200.0_f64.powi(2) - along * along).sqrt();
        let joint = [pin[0] + (along * dx - across * dz) / d, pin[1] + (along * dz + across * dx) / d];
        f64::atan2(joint[1], joint[0] - 200.0)
    };
    let mut rows = 0;
    while to_row(&mut simulation) {
        rows += 1;
        let crank = turn(&simulation, 0);
        let time = simulation.time();
        assert!((crank - TAU * (time - (std::f64::consts::PI * time).sin() / std::f64::consts::PI)).abs() < 1e-9);
        // About y, x turns towards −z.
        let (found, expected) = (turn(&simulation, 3), rocker(0.0) - rocker(crank));
        assert!((found - expected).abs() < 1e-4, "{time}: {found} {expected}");
    }
    assert!(rows >= 9);
    assert_eq!(
        simulation.system_motion().unwrap().dependent_rows(),
        0,
        "the coupler's shapes make the rows independent"
    );
}

/// Conserved: the momenta of a satellite without forces. Closed form: the angles at rest.
#[test]
fn the_panels_deploy_to_their_stops_and_momenta_stay_zero() {
    let mut simulation = mechanism("deployment.toml", 0.5);
    let mut most = 0.0_f64;
    let mut largest = [0.0_f64; 2];
    while to_row(&mut simulation) {
        most = most.max(turn(&simulation, 0)).max(turn(&simulation, 1));
        let [linear, angular] = simulation.system_motion().unwrap().momenta();
        largest = [largest[0].max(linear.norm()), largest[1].max(angular.norm())];
    }
    println!("{most} {largest:?} {} {}", turn(&simulation, 0), turn(&simulation, 1));
    // Of one panel at its speed: 1e-3 Mg, 1e3 mm/s, 1e3 mm.
    assert!(largest[0] < 1e-12 && largest[1] < 1e-9, "{largest:?}");
    for (joint, stiffness) in [(0, 1500.0), (1, 1100.0)] {
        let rest = (stiffness * 2.0 + 2e5 * FRAC_PI_2) / (stiffness + 2e5);
        assert!((turn(&simulation, joint) - rest).abs() < 5e-3, "{joint}: {} {rest}", turn(&simulation, joint));
    }
}

/// Closed form: where the controllers bear the weight of rigid links.
#[test]
fn the_robot_arm_comes_to_rest_where_its_controllers_bear_its_weight() {
    let mut simulation = mechanism("robot_arm.toml", 1.0);
    while to_row(&mut simulation) {}
    let weight = 200.0 * 100.0 * 2.7e-9 * 9810.0 * 200.0;
    let [mut a, mut b] = [0.8_f64, -1.2_f64];
    for _ in 0..100 {
        a = 0.8 - weight * (1.5 * a.cos() + 0.5 * (a + b).cos()) / 2e4;
        b = -1.2 - 0.5 * weight * (a + b).cos() / 5e3;
    }
    let found = [0, 1].map(|joint| turn(&simulation, joint));
    println!("{found:?} {a} {b}");
    assert!((found[0] - a).abs() < 2e-4 && (found[1] - b).abs() < 2e-4, "{found:?} {a} {b}");
}

/// Closed form: the frequency of flapping of a rigid blade.
#[test]
fn the_blade_flaps_at_the_frequency_of_its_hinge() {
    let step = 1e-3;
    let mut simulation = mechanism("rotor_blade.toml", step);
    let mut times = Vec::new();
    let mut before = turn(&simulation, 1);
    // Two periods and a bit.
    while simulation.time() < 0.3 && to_row(&mut simulation) {
        let now = turn(&simulation, 1);
        if before < 0.0 && now >= 0.0 {
            times.push(simulation.time() - step * now / (now - before));
        }
        before = now;
    }
    let [first, .., last] = &times[..] else { panic!("{times:?}") };
    let found = TAU * (times.len() - 1) as f64 / (last - first);
    let (blade, link, length) = (0.3 * 64e-6 * 7870.0, 0.01, 0.3_f64);
    let (first_moment, second_moment) = (
        link * 0.01 + blade * (0.02 + 0.5 * length),
        link * 0.01 * 0.01 + blade * ((0.02_f64 + 0.5 * length).powi(2) + length * length / 12.0),
    );
    let expected = 50.0 * (1.0_f64 + 0.03 * first_moment / second_moment).sqrt();
    println!("{found} {expected}");
    assert!((found / expected - 1.0).abs() < 3e-3, "{found} {expected}");
}
