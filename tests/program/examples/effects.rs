//! One body with everything, with nothing but its rigid motion, and with nothing but translation.

use flexframe::dynamics::{ConservativeBody, Stats};
use flexframe::model::Model;
use flexframe::scene::Body;

use crate::examples::{build, scene};

/// Numbers in the matrices that an evaluation reads.
fn matrix_entries(model: &Model) -> usize {
    let loads = model.loads().to_vec();
    ConservativeBody::new(&model.body, model.damping_ratios(), loads, &model.physics).unwrap().matrix_entries()
}

fn stats(model: &Model, body: &Body) -> Stats {
    let mut simulation = model.start(body).unwrap();
    simulation.by_ref().for_each(|row| assert!(row.is_ok()));
    simulation.stats()
}

#[test]
fn what_a_scene_has_not_got_is_not_computed() {
    let [full, rigid, translation] = ["full", "rigid", "translation"].map(|name| scene(&format!("effects/{name}")));
    let models = [&full, &rigid, &translation].map(build);
    let [of_full, of_rigid, of_translation] = &models;

    // Forty modes and the static shapes of the centrifugal field and of the force, whose direction turns in the body;
    // gravity strains nothing. The stress of the spin has no matrices of its own; that of the force has one for each of its
    // three directions.
    let nf = of_full.body.flexible();
    assert_eq!(nf, 40 + 6 + 3);
    assert_eq!(matrix_entries(of_full), (6 + 3 + 3) * nf * nf);
    assert!(of_full.body.stress_stiffness.is_some());
    assert!(of_full.damping_ratios().iter().all(|ratio| *ratio == 0.01));

    // No modes, no factor, no static responses.
    assert_eq!((of_rigid.body.flexible(), matrix_entries(of_rigid)), (0, 0));
    let stats_of_modes = of_rigid.meshed.as_ref().unwrap().modes.stats;
    assert_eq!((stats_of_modes.factor_entries, stats_of_modes.block_solves), (0, 0));
    assert!(of_rigid.body.stress_stiffness.is_none() && !of_rigid.is_stressed());

    // Modes that are coupled to nothing: no matrix at all, and no stress.
    assert_eq!(of_translation.body.flexible(), 40);
    assert_eq!(matrix_entries(of_translation), 0);
    assert!(of_translation.body.stress_stiffness.is_none() && !of_translation.is_stressed());

    // All take the same steps; what differs is what an evaluation costs (`./dev bench`).
    for (scene, model) in [&full, &rigid, &translation].into_iter().zip(&models) {
        let stats = stats(model, scene);
        assert_eq!((stats.accepted, stats.evaluations), (1000, 4000));
    }
}

/// Closed form: impulse and free fall. The rigid body moves as the mean of the one that deforms; the one that does
/// not turn only falls and is pushed.
#[test]
fn the_centre_of_mass_moves_alike() {
    let impulse = 50.0 * 2.0 * 0.02 / std::f64::consts::PI * std::f64::consts::FRAC_1_SQRT_2;
    for name in ["full", "rigid", "translation"] {
        let scene = scene(&format!("effects/{name}"));
        let model = build(&scene);
        let last = model.start(&scene).unwrap().last().unwrap().unwrap();
        let push = impulse / model.body.mass;
        let expected = nalgebra::Vector3::new(push, 0.0, push - 9810.0 * scene.time.end);
        let off = (last.velocity_global - expected).norm() / expected.norm();
        // Measured: 1.5e-12.
        assert!(off < 1e-9, "{name}: {off:e}");
    }
}
