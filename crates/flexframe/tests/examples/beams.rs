//! A slender bar under each constraint: rigid modes left, beam theory, and modes that the reactions do no work on.

use flexframe::fem_tet10::{Material, Materials, assemble};
use flexframe::scene::{Body, Model, Scene};

use crate::{build, scene};

const LENGTH: f64 = 400.0;
const SIDE: f64 = 10.0;
const STEEL: Material = Material { young_modulus: 210000.0, poisson_ratio: 0.3, density: 7.85e-9 };

// β_k of Euler–Bernoulli beams whose other end is free.
const CLAMPED: [f64; 3] = [1.875104069, 4.694091133, 7.854757438];
const HINGED: [f64; 3] = [3.926602312, 7.068582746, 10.21017612];
const GUIDED: [f64; 3] = [2.365020372, 5.497803919, 8.639379829];
const FREE: [f64; 3] = [4.730040745, 7.853204624, 10.99560784];

/// Frequencies of a beam, cycles per time, bending in two planes.
fn beam(planes: [[f64; 3]; 2]) -> Vec<f64> {
    let wave = (STEEL.young_modulus / STEEL.density / 12.0).sqrt() * SIDE / (LENGTH * LENGTH);
    let mut found: Vec<f64> =
        planes.as_flattened().iter().map(|beta| beta * beta * wave / std::f64::consts::TAU).collect();
    found.sort_by(f64::total_cmp);
    found
}

/// Relative gaps of the six first frequencies to beam theory; a bar has more mass and shear to move, so they are below.
fn gaps(model: &Model, planes: [[f64; 3]; 2]) -> Vec<f64> {
    model.natural_frequencies().iter().zip(beam(planes)).map(|(found, beam)| found / beam - 1.0).collect()
}

#[test]
fn each_constraint_leaves_its_rigid_modes_and_bends_as_a_beam() {
    for (name, rigid, planes, bounds) in [
        ("free", 6, [FREE, FREE], [-0.02, 0.005]),
        ("pin", 3, [HINGED, HINGED], [-0.02, 0.005]),
        ("hinge", 1, [HINGED, CLAMPED], [-0.02, 0.005]),
        ("clamp", 0, [CLAMPED, CLAMPED], [-0.02, 0.005]),
        ("slider", 1, [GUIDED, CLAMPED], [-0.02, 0.005]),
    ] {
        let scene = scene(&format!("bar/{name}"));
        let model = build(&scene);
        let meshed = model.meshed.as_ref().unwrap();
        let present = meshed.modes.rigid.shapes.col_iter().filter(|shape| shape.norm_max() > 0.0).count();
        assert_eq!((model.body.motion.count(), present), (rigid, rigid), "{name}");
        let gaps = gaps(&model, planes);
        println!("{name}: {gaps:.5?}");
        for gap in gaps {
            assert!(bounds[0] < gap && gap < bounds[1], "{name}: {gap}");
        }
        reactions_do_no_work(&scene, &model);
    }
}

/// K φ − λ M φ is what the support does: nothing on the nodes that are not held, and nothing on the rigid motions left.
fn reactions_do_no_work(scene: &Scene, model: &Model) {
    let meshed = model.meshed.as_ref().unwrap();
    assert!(matches!(&scene.body, Body::Meshed(_)));
    let matrices = assemble(&meshed.mesh, &Materials::Uniform(STEEL), &[]).unwrap();
    let modes = &meshed.modes;
    let (k_phi, m_phi) = (matrices.stiffness() * &modes.shapes, matrices.mass() * &modes.shapes);
    let at_root = |i: usize| meshed.mesh.positions()[i / 3][0] < 1e-6;
    for (k, lambda) in modes.eigenvalues.iter().enumerate() {
        let reaction: Vec<f64> = (0..k_phi.nrows()).map(|i| k_phi[(i, k)] - lambda * m_phi[(i, k)]).collect();
        let force = k_phi.col(k).norm_max();
        let away = reaction.iter().enumerate().filter(|(i, _)| !at_root(*i)).map(|(_, r)| r.abs()).fold(0.0, f64::max);
        assert!(away < 1e-5 * force, "mode {k}: {away:e} of {force:e} away from the support");
        for shape in modes.rigid.shapes.col_iter() {
            let power = |of: &[f64]| shape.iter().zip(of).map(|(u, r)| (u * r).abs()).sum::<f64>();
            let work: f64 = shape.iter().zip(&reaction).map(|(u, r)| u * r).sum();
            let scale = power(&k_phi.col(k).iter().copied().collect::<Vec<_>>());
            assert!(work.abs() <= 1e-7 * scale, "mode {k}: {work:e} of {scale:e}");
        }
    }
}
