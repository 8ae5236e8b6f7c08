//! Where a clamped bar comes to rest under each load, with the static shapes of the loads beside a few modes, against
//! the theory of beams.

use faer::Mat;
use fem_tet10::{Material, Materials, assemble, read_msh};
use modal::{Solver, Support};
use nalgebra::Vector3;
use reduced_body::RigidMotion;

use crate::{BENDING, BREADTH, CLAMPED, DENSITY, LENGTH, POISSON, YOUNG, bar, last, point};

const AREA: f64 = BREADTH * BREADTH;

/// Displacement of the tip at rest: critically damped, after forty radians of the first mode (1.27e3 rad/s).
fn at_rest(modes: &str, load: &str) -> Vector3<f64> {
    let modes = format!("{modes}\ndamping_ratio = 1.0");
    let rest = format!("[effects]\ngeometric_stiffening = false\n{CLAMPED}[[loads]]\n{load}");
    let (model, end) = last(&bar(&modes, &rest, "end = 0.03\nstep = 1e-4"));
    point(&model, &end, "tip").displacement
}

const CORRECTED: &str = "flexible = 3\nstatic_correction = true";

/// Deflection of a beam that also shears: 5/6 of the section carries it.
fn sheared(bent: f64, force_arm: f64) -> f64 {
    let shear = YOUNG / (2.0 * (1.0 + POISSON));
    bent + force_arm / (5.0 / 6.0 * shear * AREA)
}

#[track_caller]
fn rests(load: &str, expected: Vector3<f64>, relative: f64) {
    let found = at_rest(CORRECTED, load);
    let off = (found - expected).norm() / expected.norm();
    assert!(off < relative, "{found:?} is {off:e} off {expected:?}");
}

/// Closed form: PL³/(3EI) + PL/(κGA), and ML²/(2EI).
#[test]
fn a_force_a_moment_and_a_traction_at_the_tip() {
    let bent = sheared(LENGTH.powi(3) / (3.0 * YOUNG * BENDING), LENGTH);
    let force = |frame: &str| {
        format!(
            "kind = \"force\"\nat = [200.0, 0.0, 0.0]\ndirection = [0.0, 0.0, 1.0]\namplitude = 2.0\nframe = \"{frame}\""
        )
    };
    // The solid is a little stiffer, since its root can neither narrow nor warp. Measured: 6.3e-3 (force), 6.7e-3
    // (traction), 4.0e-3 (moments).
    for frame in ["global", "body"] {
        rests(&force(frame), Vector3::z() * (2.0 * bent), 1e-2);
    }
    rests(
        "kind = \"traction\"\ngroup = \"tip\"\ndirection = [0.0, 1.0, 0.0]\namplitude = 0.02",
        Vector3::y() * (0.02 * AREA * bent),
        1e-2,
    );
    for radius in ["", "radius = 8.0"] {
        rests(
            &format!(
                "kind = \"moment\"\nat = [200.0, 0.0, 0.0]\ndirection = [0.0, 1.0, 0.0]\namplitude = 100.0\n{radius}"
            ),
            Vector3::z() * (-100.0 * LENGTH * LENGTH / (2.0 * YOUNG * BENDING)),
            1e-2,
        );
    }
}

/// Closed form: wL⁴/(8EI) + wL²/(2κGA).
#[test]
fn a_load_all_along_the_bar() {
    // Measured: 8.2e-3 (pressure), 8.4e-3 (gravity and base).
    let of_line_load = |w: f64| sheared(w * LENGTH.powi(4) / (8.0 * YOUNG * BENDING), 0.5 * w * LENGTH * LENGTH);
    rests("kind = \"pressure\"\ngroup = \"top\"\namplitude = 0.01", Vector3::z() * -of_line_load(0.01 * BREADTH), 1e-2);
    let weight = of_line_load(DENSITY * AREA * 9810.0);
    rests("kind = \"gravity\"\ndirection = [0.0, 0.0, -1.0]\namplitude = 9810.0", Vector3::z() * -weight, 1e-2);
    rests(
        "kind = \"base-acceleration\"\ndirection = [0.0, 0.0, -1.0]\namplitude = 9810.0\n\
         history = { kind = \"constant\" }",
        Vector3::z() * weight,
        1e-2,
    );
}

/// Closed form: FL/(EA).
#[test]
fn a_pull_along_the_bar() {
    // F L/(E A), but for the root that cannot narrow. Measured: 3.0e-3.
    rests("kind = \"pressure\"\ngroup = \"tip\"\namplitude = -10.0", Vector3::x() * (10.0 * LENGTH / YOUNG), 1e-2);
}

/// K⁻¹ f of a unit force on the tip.
fn answer_to_unit_force(axis: usize) -> Vector3<f64> {
    let mesh = read_msh(concat!(env!("CARGO_MANIFEST_DIR"), "/tests/data/bar.msh")).unwrap();
    let material = Material { young_modulus: YOUNG, poisson_ratio: POISSON, density: DENSITY };
    let matrices = assemble(&mesh, &Materials::Uniform(material), &[]).unwrap();
    let support = Support::new(RigidMotion::clamp(Vector3::zeros()), mesh.group_nodes("root").unwrap());
    let solver = Solver::new(matrices.stiffness(), matrices.mass(), mesh.positions(), &support).unwrap();
    let (tip, _) = mesh.nearest_node([LENGTH, 0.0, 0.0]);
    let forces = Mat::from_fn(3 * mesh.positions().len(), 1, |i, _| f64::from(i == 3 * tip as usize + axis));
    let answer = solver.static_response(forces.as_ref()).unwrap();
    Vector3::from_fn(|axis, _| answer[(3 * tip as usize + axis, 0)])
}

/// Independent reference: K⁻¹f of the whole mesh.
#[test]
fn static_shapes_give_what_the_modes_miss() {
    for (axis, direction) in ["[1.0, 0.0, 0.0]", "[0.0, 1.0, 0.0]", "[0.0, 0.0, 1.0]"].into_iter().enumerate() {
        let load = format!("kind = \"force\"\nat = [200.0, 0.0, 0.0]\ndirection = {direction}\namplitude = 2.0");
        let exact = 2.0 * answer_to_unit_force(axis);
        let off = |modes: &str| (at_rest(modes, &load) - exact).norm() / exact.norm();
        let (with, without) = (off(CORRECTED), off("flexible = 3\nstatic_correction = false"));
        // Measured: 8e-11; without, the whole of a pull along the bar and 2.6e-2 and 1.6e-2 of the tip's deflection.
        assert!(with < 1e-3 && without > 1e-2, "{axis}: {with:e}, {without:e}");
    }
}
