//! Rates of modes with numbers of the body.

use faer::Mat;
use fem_tet10::{BodyNumber, Material, Materials, MatrixRates, Mesh, MeshParts};
use modal::{ModeRates, Modes, Solver, Support};
use nalgebra::Vector3;
use reduced_body::RigidMotion;

use crate::bodies::{Body, STEEL, block_mesh};

/// A mesh whose nodes have moved by a time.
fn moved(mesh: &Mesh, velocities: &[[f64; 3]], time: f64) -> Mesh {
    let place = |(x, v): (&[f64; 3], &[f64; 3])| std::array::from_fn(|axis| x[axis] + time * v[axis]);
    let positions = mesh.positions().iter().zip(velocities).map(place).collect();
    let mut parts = MeshParts { positions, ..mesh.parts() };
    parts.source = "moved".to_owned();
    Mesh::new(parts).unwrap()
}

/// The nodes at the lowest x are held.
fn clamp(mesh: &Mesh) -> Support {
    let low = mesh.positions().iter().map(|x| x[0]).fold(f64::INFINITY, f64::min);
    let held = (0..).zip(mesh.positions()).filter(|(_, x)| x[0] < low + 1e-9).map(|(node, _)| node).collect();
    Support::new(RigidMotion::clamp(Vector3::new(low, 0.0, 0.0)), held)
}

struct Rated {
    modes: Modes,
    rates: ModeRates,
    shapes: Mat<f64>,
}

/// Rates of the first modes of a mesh with a number.
fn rated(mesh: &Mesh, support: &Support, number: &BodyNumber, count: usize) -> Rated {
    let body = Body::new(mesh, STEEL);
    let solver: Solver<'_> = body.held(support);
    let modes = solver.modes(count + 4, |_| ()).unwrap();
    let count = modes.whole(count);
    let matrices = MatrixRates::new(mesh, &Materials::Uniform(STEEL), &[], number).unwrap();
    let [k, m] = matrices.products(mesh, modes.shapes.as_ref()).unwrap();
    let rates = modes.rates([k.subcols(0, count), m.subcols(0, count)]).unwrap();
    let shapes = solver.shape_rates(&modes, &rates, [k.as_ref(), m.as_ref()]).unwrap();
    Rated { modes, rates, shapes }
}

/// Independent reference: central differences of modes that are found anew on moved meshes, free and clamped. Their errors are of the second
/// power of the step, and those of the modes over the step: below 1e-7 of the rates.
#[test]
fn rates_of_modes_and_shapes_are_central_differences_of_modes_found_anew() {
    const STEP: f64 = 1e-4;
    let mesh = block_mesh([60.0, 9.0, 7.0], [6, 2, 2]);
    let number = BodyNumber::Stretch(None, 2);
    let velocities = MatrixRates::new(&mesh, &Materials::Uniform(STEEL), &[], &number).unwrap();
    let velocities = velocities.velocities().unwrap().to_vec();
    for support in [Support::free(), clamp(&mesh)] {
        let Rated { modes, rates, shapes } = rated(&mesh, &support, &number, 5);
        assert!(modes.repeated(5).is_empty());
        let [after, before] = [STEP, -STEP].map(|time| {
            let body = Body::new(&moved(&mesh, &velocities, time), STEEL);
            body.held(&support).modes(5, |_| ()).unwrap()
        });
        for k in 0..5 {
            let rate = (after.eigenvalues[k] - before.eigenvalues[k]) / (2.0 * STEP);
            let off = (rates.eigenvalues[k] - rate).abs();
            assert!(off < 1e-6 * modes.eigenvalues[k], "{k}: {off:e} of {rate:e}");
            let [after, before] = [&after, &before].map(|found| {
                let sign = (modes.shapes.col(k).transpose() * found.shapes.col(k)).signum();
                found.shapes.col(k) * faer::Scale(sign)
            });
            let rate = (after - before) * faer::Scale(0.5 / STEP);
            let off = (shapes.col(k) - &rate).norm_l2() / rate.norm_l2();
            assert!(off < 1e-6, "shape {k}: {off:e}");
        }
    }
}

/// Independent reference: central differences of the frequencies of a cube, many of which are two or three, on meshes stretched along one
/// axis, which parts them: the branches cross where the cube is.
#[test]
fn modes_of_one_frequency_part_as_central_differences_say() {
    const STEP: f64 = 1e-4;
    let mesh = block_mesh([10.0; 3], [2; 3]);
    let number = BodyNumber::Stretch(None, 2);
    let velocities = MatrixRates::new(&mesh, &Materials::Uniform(STEEL), &[], &number).unwrap();
    let velocities = velocities.velocities().unwrap().to_vec();
    let Rated { modes, rates, .. } = rated(&mesh, &Support::free(), &number, 12);
    let count = rates.eigenvalues.len();
    let [after, before] = [STEP, -STEP].map(|time| {
        let body = Body::new(&moved(&mesh, &velocities, time), STEEL);
        body.held(&Support::free()).modes(count, |_| ()).unwrap().eigenvalues
    });
    let repeated = modes.repeated(count);
    assert!(repeated.iter().any(|group| group.len() == 3) && repeated.iter().any(|group| group.len() == 2));
    let apart = (0..count).filter(|k| !repeated.iter().any(|group| group.contains(k))).map(|k| k..k + 1);
    for group in repeated.iter().cloned().chain(apart) {
        for k in group.clone() {
            let rate = (after[k] - before[group.end - 1 - (k - group.start)]) / (2.0 * STEP);
            let off = (rates.eigenvalues[k] - rate).abs();
            assert!(off < 1e-6 * modes.eigenvalues[k], "{group:?} {k}: {off:e} of {rate:e}");
        }
    }
}

/// Closed form: λ ∝ E/ρ, so λ' = λ/E and −λ/ρ; shapes of modal mass 1 ∝ ρ^−½, so φ' = −φ/(2ρ), and none with E.
#[test]
fn frequencies_go_with_the_root_of_stiffness_over_density() {
    let mesh = block_mesh([10.0; 3], [2; 3]);
    let Material { young_modulus, density, .. } = STEEL;
    for (number, power, value, of_shape) in
        [(BodyNumber::YoungModulus(None), 1.0, young_modulus, 0.0), (BodyNumber::Density(None), -1.0, density, -0.5)]
    {
        for support in [Support::free(), clamp(&mesh)] {
            let Rated { modes, rates, shapes } = rated(&mesh, &support, &number, 9);
            for k in 0..rates.eigenvalues.len() {
                let off = value * rates.eigenvalues[k] / modes.eigenvalues[k] - power;
                assert!(off.abs() < 1e-9, "{k}: {off:e}");
                let shape = modes.shapes.subcols(0, rates.eigenvalues.len()) * rates.turn.col(k);
                let off = (shapes.col(k) * faer::Scale(value) - &shape * faer::Scale(of_shape)).norm_max();
                assert!(off < 1e-8 * shape.norm_max(), "{k}: {off:e}");
            }
        }
    }
}

/// Conserved: φᵀMφ = 1 as the number grows, so 2 φᵀMφ' = −φᵀM'φ, also where all modes are known and nothing is left beside them.
#[test]
fn modal_masses_stay_where_all_modes_are_known() {
    let mesh = block_mesh([10.0, 8.0, 7.0], [1; 3]);
    let support = clamp(&mesh);
    let body = Body::new(&mesh, STEEL);
    let solver = body.held(&support);
    let modes = solver.modes(solver.available(), |_| ()).unwrap();
    let number = BodyNumber::Stretch(None, 1);
    let matrices = MatrixRates::new(&mesh, &Materials::Uniform(STEEL), &[], &number).unwrap();
    let [k, m] = matrices.products(&mesh, modes.shapes.as_ref()).unwrap();
    let rates = modes.rates([k.subcols(0, 5), m.subcols(0, 5)]).unwrap();
    let shapes = solver.shape_rates(&modes, &rates, [k.as_ref(), m.as_ref()]).unwrap();
    let momenta = solver.mass().product(modes.shapes.subcols(0, 5));
    for i in 0..5 {
        let (of_shape, of_mass) =
            (momenta.col(i).transpose() * shapes.col(i), modes.shapes.col(i).transpose() * m.col(i));
        assert!((2.0 * of_shape + of_mass).abs() < 1e-9 * of_mass.abs(), "{i}: {of_shape} {of_mass}");
    }
}
