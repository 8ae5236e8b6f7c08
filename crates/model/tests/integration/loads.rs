//! The rigid acceleration that each load gives a free body at the beginning: F/m of its centre, J⁻¹M of its turning.

use nalgebra::{Matrix3, Vector3};

use crate::{BREADTH, LENGTH, MASS, bar, first, last, near, point, rigid};

const TIME: &str = "end = 1e-3\nstep = 1e-5";

/// Force, and moment about the centre of mass, that an undeformed free bar must be under.
#[track_caller]
fn pushes(rest: &str, force: [f64; 3], moment: [f64; 3]) {
    let (model, start) = first(&bar("flexible = 3", rest, TIME));
    let (force, moment) = (Vector3::from(force), Vector3::from(moment));
    let about_x = MASS * 2.0 * BREADTH * BREADTH / 12.0;
    let across = MASS * (LENGTH * LENGTH + BREADTH * BREADTH) / 12.0;
    let alpha = Matrix3::from_diagonal(&Vector3::new(about_x, across, across)).try_inverse().unwrap() * moment;
    let acceleration = force / MASS;
    // The middle of the bar is its centre of mass. Measured: below 1e-12.
    let scale = acceleration.norm() + alpha.norm() * LENGTH;
    let found = point(&model, &start, "middle").rigid_acceleration;
    assert!((found - acceleration).norm() < 1e-10 * scale, "{found:?} instead of {acceleration:?}");
    let off = (start.alpha_body - alpha).norm() * LENGTH;
    assert!(off < 1e-10 * scale, "{:?} instead of {alpha:?}", start.alpha_body);
    let tip = acceleration + alpha.cross(&Vector3::new(0.5 * LENGTH, 0.0, 0.0));
    near(point(&model, &start, "tip").rigid_acceleration, tip, 1e-10);
}

/// Closed form: F/m and J⁻¹M of a rigid bar.
#[test]
fn a_force_on_a_node_and_one_between_nodes() {
    for (at, arm) in [("[200.0, 0.0, 0.0]", 100.0), ("[187.3, 0.0, 0.0]", 87.3)] {
        for frame in ["global", "body"] {
            pushes(
                &format!(
                    "[[loads]]\nkind = \"force\"\nat = {at}\ndirection = [0.0, 0.0, 2.0]\namplitude = 7.0\n\
                     frame = \"{frame}\""
                ),
                [0.0, 0.0, 7.0],
                [0.0, -7.0 * arm, 0.0],
            );
        }
    }
    pushes(
        "[[loads]]\nkind = \"force\"\nat = [31.7, 2.3, -4.1]\ndirection = [3.0, 0.0, 4.0]\namplitude = -5.0",
        [-3.0, 0.0, -4.0],
        Vector3::new(-68.3, 2.3, -4.1).cross(&Vector3::new(-3.0, 0.0, -4.0)).into(),
    );
}

/// Closed form: F/m and J⁻¹M of a rigid bar.
#[test]
fn a_moment_with_and_without_a_radius() {
    for radius in ["", "radius = 8.0"] {
        for frame in ["global", "body"] {
            pushes(
                &format!(
                    "[[loads]]\nkind = \"moment\"\nat = [150.0, 0.0, 0.0]\ndirection = [1.0, 2.0, -2.0]\n\
                     amplitude = 30.0\nframe = \"{frame}\"\n{radius}"
                ),
                [0.0; 3],
                [10.0, 20.0, -20.0],
            );
        }
    }
}

/// Closed form: F/m and J⁻¹M of a rigid bar.
#[test]
fn a_pressure_and_a_traction() {
    let tip = BREADTH * BREADTH;
    let top = BREADTH * LENGTH;
    pushes("[[loads]]\nkind = \"pressure\"\ngroup = \"tip\"\namplitude = 0.5", [-0.5 * tip, 0.0, 0.0], [0.0; 3]);
    pushes("[[loads]]\nkind = \"pressure\"\ngroup = \"top\"\namplitude = 0.5", [0.0, 0.0, -0.5 * top], [0.0; 3]);
    for frame in ["global", "body"] {
        pushes(
            &format!(
                "[[loads]]\nkind = \"traction\"\ngroup = \"tip\"\ndirection = [0.0, 1.0, 0.0]\namplitude = 0.2\n\
                 frame = \"{frame}\""
            ),
            [0.0, 0.2 * tip, 0.0],
            [0.0, 0.0, 0.2 * tip * 0.5 * LENGTH],
        );
    }
    // On a face beside the axis: F a/2 about it.
    pushes(
        "[[loads]]\nkind = \"traction\"\ngroup = \"top\"\ndirection = [0.0, 1.0, 0.0]\namplitude = 0.2",
        [0.0, 0.2 * top, 0.0],
        [-0.2 * top * 0.5 * BREADTH, 0.0, 0.0],
    );
}

/// Closed form: F/m and J⁻¹M of a rigid bar.
#[test]
fn several_loads_add_up() {
    pushes(
        "[[loads]]\nkind = \"gravity\"\ndirection = [0.0, 0.0, -1.0]\namplitude = 9810.0\n\
         [[loads]]\nkind = \"pressure\"\ngroup = \"top\"\namplitude = 0.005\n\
         [[loads]]\nkind = \"moment\"\nat = [50.0, 0.0, 0.0]\ndirection = [0.0, 0.0, 1.0]\namplitude = 9.0",
        [0.0, 0.0, -9810.0 * MASS - 0.005 * BREADTH * LENGTH],
        [0.0, 0.0, 9.0],
    );
}

/// Closed form: g, and no deformation.
#[test]
fn gravity_on_a_free_body_moves_it_as_a_whole_and_deforms_nothing() {
    let gravity = "[[loads]]\nkind = \"gravity\"\ndirection = [0.0, 1.0, 0.0]\namplitude = 9810.0";
    pushes(gravity, [0.0, 9810.0 * MASS, 0.0], [0.0; 3]);
    let (_, start) = first(&bar("flexible = 6", gravity, TIME));
    let largest = start.modal_acceleration.iter().fold(0.0_f64, |m, a| m.max(a.abs()));
    // Measured: 2e-12 of the rigid mode's.
    assert!(largest < 1e-9 * 9810.0 * MASS.sqrt(), "{largest}");
}

/// Closed form: −500 · 0.8 along the slider.
#[test]
fn base_acceleration_pulls_a_held_body_the_other_way() {
    let slider = "[[constraints]]\nkind = \"slider\"\ndirection = [0.0, 0.6, 0.8]\ngroup = \"root\"\n";
    let base = "[[loads]]\nkind = \"base-acceleration\"\ndirection = [0.0, 0.0, 1.0]\namplitude = 500.0\n\
                history = { kind = \"constant\" }";
    let (model, start) = first(&bar("flexible = 4", &format!("{slider}{base}"), TIME));
    // Only the part along the slider moves it: −500 · 0.8.
    near(point(&model, &start, "root").rigid_acceleration, Vector3::new(0.0, 0.6, 0.8) * -400.0, 1e-10);
}

/// Closed form: F/m and J⁻¹M.
#[test]
fn loads_on_a_body_without_a_mesh() {
    let inertia = Matrix3::new(5.0, 0.5, 0.2, 0.5, 6.0, -0.3, 0.2, -0.3, 4.0).try_inverse().unwrap();
    let push = |rest: &str, force: [f64; 3], moment: [f64; 3]| {
        let (model, start) = first(&rigid(rest, TIME));
        let (acceleration, alpha) = (Vector3::from(force) / 2.0, inertia * Vector3::from(moment));
        assert!((point(&model, &start, "center").rigid_acceleration - acceleration).norm() < 1e-13);
        assert!((start.alpha_body - alpha).norm() < 1e-13);
    };
    push(
        "[[loads]]\nkind = \"force\"\nat = [1.0, 2.0, 4.0]\ndirection = [1.0, 0.0, 0.0]\namplitude = 3.0",
        [3.0, 0.0, 0.0],
        [0.0, 3.0, 0.0],
    );
    push(
        "[[loads]]\nkind = \"moment\"\nat = [9.0, 9.0, 9.0]\ndirection = [0.0, 0.0, 1.0]\namplitude = 3.0",
        [0.0; 3],
        [0.0, 0.0, 3.0],
    );
    push("[[loads]]\nkind = \"gravity\"\ndirection = [0.0, 0.0, -1.0]\namplitude = 9.81", [0.0, 0.0, -19.62], [0.0; 3]);
}

/// Closed form: F/m along the turned force: a force at the centre of a body that turns about z: one turns with it,
/// the other does not.
#[test]
fn a_follower_turns_with_the_body_and_a_dead_load_does_not() {
    let (spin, end, force): (f64, f64, f64) = (3.0, 0.4, 7.0);
    let turned = spin * end;
    for (frame, direction) in
        [("global", Vector3::new(1.0, 0.0, 0.0)), ("body", Vector3::new(turned.cos(), turned.sin(), 0.0))]
    {
        let rest = format!(
            "[effects]\nflexibility = false\n[initial]\nangular_velocity = [0.0, 0.0, {spin}]\n[[loads]]\nkind = \"force\"\nat = [100.0, 0.0, 0.0]\n\
             direction = [1.0, 0.0, 0.0]\namplitude = {force}\nframe = \"{frame}\""
        );
        let (model, end) = last(&bar("flexible = 3", &rest, &format!("end = {end}\nstep = 1e-3")));
        // Measured: 3e-12.
        near(point(&model, &end, "middle").rigid_acceleration, direction * force / MASS, 1e-9);
    }
}
