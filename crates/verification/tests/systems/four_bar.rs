//! A four-bar with a hinge out of line: rigid it locks, flexible it turns.

use dynamics::StepControl;
use nalgebra::Vector3;
use verification::stability::meshes::box_mesh;
use verification::systems::meshes::write;
use verification::systems::run::{Built, built, rows};

const SPEED: f64 = 0.6;
/// Beyond the position at 2.6 s where all bars lie on a line.
const END: f64 = 3.0;

/// Bars of 0.12, 0.24 and 0.12 m around A (0, 0), B (0, 0.12), C (0.24, 0.12) and D (0.24, 0); hinges about z, that at C turned by 5° about y.
fn four_bar(flexible: usize) -> (tempfile::TempDir, Built) {
    let directory = tempfile::tempdir().unwrap();
    let mut text = "title = 'four-bar'\nunits = { length = 'm', mass = 'kg', time = 's' }\n".to_owned();
    let bars = [
        ("one", [0.016, 0.12], true, [0.0, 0.0], [-0.5 * SPEED * 0.12, SPEED]),
        ("two", [0.016, 0.24], false, [0.0, 0.12], [-SPEED * 0.12, 0.0]),
        ("three", [0.008, 0.12], true, [0.24, 0.0], [-0.5 * SPEED * 0.12, SPEED]),
    ];
    for (name, [side, length], upright, at, [velocity, omega]) in bars {
        let (size, cells) =
            if upright { ([side, length, side], [2, 8, 2]) } else { ([length, side, side], [12, 2, 2]) };
        write(directory.path(), name, &box_mesh(size, cells), &[]).unwrap();
        let along = usize::from(upright);
        let end = |x: f64| {
            let (mut low, mut high) = ([-1.0; 3], [1.0; 3]);
            (low[along], high[along]) = (x - 1e-6, x + 1e-6);
            format!("{{ box = [{low:?}, {high:?}] }}")
        };
        let mut position = [at[0], at[1], -0.5 * side];
        position[1 - along] -= 0.5 * side;
        let mut middle = [0.5 * side; 3];
        middle[along] = 0.5 * length;
        text += &format!(
            "[bodies.{name}]\nmesh = '{name}.msh'\nmaterial = {{ young_modulus = 207e9, poisson_ratio = 0.3, density = 7800.0 }}\n\
             modes = {{ flexible = {flexible} }}\nmarkers = {{ low = {}, high = {} }}\npoints = {{ middle = {middle:?} }}\n\
             initial = {{ position = {position:?}, velocity = [{velocity}, 0, 0], angular_velocity = [0, 0, {omega}] }}\n",
            end(0.0),
            end(length)
        );
    }
    let tilt = 5.0_f64.to_radians();
    let out_of_line = format!("[{}, 0, {}]", tilt.sin(), tilt.cos());
    for (name, ends, axis) in [
        ("A", "'ground', 'one.low'", "[0, 0, 1]"),
        ("B", "'one.high', 'two.low'", "[0, 0, 1]"),
        ("C", "'two.high', 'three.high'", &out_of_line),
        ("D", "'ground', 'three.low'", "[0, 0, 1]"),
    ] {
        text += &format!("[[joints]]\nname = '{name}'\nkind = 'revolute'\nbetween = [{ends}]\naxis = {axis}\n");
        if name == "A" {
            text += &format!("drive = {{ amplitude = {SPEED}, history = {{ kind = 'expression', formula = 't' }} }}\n");
        }
    }
    text += &format!("[time]\nend = {END}\ntolerance = 1e-3\n");
    let built = built(directory.path(), &text).unwrap();
    (directory, built)
}

/// Independent reference: geometrically exact beams in Exudyn 1.13.6, crates/verification/performance/peers/exudyn_four_bar.py with 4
/// elements a bar: the middle of BC and the turn at D. The same bars as Bauchau et al. (2016).
#[test]
fn a_hinge_out_of_line_locks_rigid_bars_and_lets_flexible_ones_turn() {
    let (_directory, rigid) = four_bar(0);
    let stopped = rigid
        .start(StepControl::Tolerance(1e-3), END, 0.5, false)
        .and_then(|mut simulation| rows(&mut simulation, 3).map(|_| simulation.time()));
    println!("rigid: {stopped:?}");
    assert!(stopped.is_err(), "rigid bars lock: {stopped:?}");
    let (_directory, flexible) = four_bar(6);
    let mut simulation = flexible.start(StepControl::Tolerance(1e-3), END, 0.5, true).unwrap();
    let found = rows(&mut simulation, 3).unwrap();
    println!("{} steps", simulation.stats().accepted);
    // At 2 s and at 3 s.
    for (row, expected) in [(4, [-0.111_838, -0.076_604, 0.000_913_8]), (6, [-0.118_240, -0.129_219, 0.001_021_7])] {
        let (moved, expected) = (found[row][1].points[0].displacement, Vector3::from(expected));
        println!("{} s: {moved:?} {expected:?}", found[row][1].time);
        assert!((moved - expected).norm() < 1e-3 * expected.norm(), "{moved} {expected}");
        // Across the plane it moves by the deformation alone.
        assert!((moved.z / expected.z - 1.0).abs() < 0.02, "{moved} {expected}");
    }
    let turn = simulation.system_motion().unwrap().joint_coordinates(3).turn;
    println!("turn at D {turn}");
    assert!((turn - 1.498_116).abs() < 2e-3, "{turn}");
}
