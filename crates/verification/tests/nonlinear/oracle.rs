//! The nonlinear body itself: what it keeps, and what it is for small displacements.

use nalgebra::{Rotation3, Vector3};
use verification::nonlinear::{NodalState, Solid, SolidMotion, bodies, cases, mean_axes, signal};

fn l() -> Solid {
    Solid::new(bodies::mesh("l").unwrap(), bodies::SOFT, |_| false).unwrap()
}

/// Displacements by a law of the position.
fn field(solid: &Solid, law: impl Fn(Vector3<f64>) -> Vector3<f64>) -> Vec<f64> {
    solid.mesh().positions().iter().flat_map(|x| <[f64; 3]>::from(law(Vector3::from(*x)))).collect()
}

fn moments(solid: &Solid, u: &[f64], forces: &[f64]) -> [Vector3<f64>; 2] {
    let mut sums = [Vector3::zeros(); 2];
    for (i, x) in solid.mesh().positions().iter().enumerate() {
        let at = Vector3::from(*x) + Vector3::from_column_slice(&u[3 * i..3 * i + 3]);
        let force = Vector3::from_column_slice(&forces[3 * i..3 * i + 3]);
        sums[0] += force;
        sums[1] += at.cross(&force);
    }
    sums
}

/// Conserved: a rigid motion has no strain energy.
#[test]
fn turning_as_a_whole_strains_nothing() {
    let solid = l();
    let turn = Rotation3::new(Vector3::new(1.0, -0.7, 2.1));
    let u = field(&solid, |x| turn * x - x + Vector3::new(0.3, 1.0, -2.0));
    assert!(solid.strain_energy(&u) < 1e-20 * 1e7);
    assert!(solid.internal_forces(&u, &u).iter().all(|f| f.abs() < 1e-8));
    let axes = mean_axes(&solid, &u);
    assert!((axes.rotation - turn.matrix()).norm() < 1e-12);
    assert!(axes.displacement.iter().all(|u| u.abs() < 1e-12));
}

/// Closed form: (λ/2 + μ) E² V.
#[test]
fn a_homogeneous_strain_has_its_energy() {
    // E_xx of a stretch e of the whole body, whose sides may not move.
    let solid = l();
    let e = 0.1;
    let u = field(&solid, |x| Vector3::new(e * x.x, 0.0, 0.0));
    let (lambda, mu) = bodies::SOFT.lame();
    let strain = e + 0.5 * e * e;
    let volume = (1.0 + 0.5) * 0.01;
    let expected = (0.5 * lambda + mu) * strain * strain * volume;
    assert!((solid.strain_energy(&u) / expected - 1.0).abs() < 1e-12);
}

/// Conserved: energy and momenta.
#[test]
fn it_keeps_energy_and_momenta_while_it_tumbles_and_bends() {
    let solid = l();
    let v = field(&solid, |x| Vector3::new(3.0, -2.0, 5.0).cross(&x) + Vector3::new(0.0, 2.0 * x.x, 4.0 * x.y * x.x));
    let u = field(&solid, |x| Vector3::new(0.0, 0.02 * x.x * x.x, 0.03 * x.y * x.x));
    let mut motion = SolidMotion::new(&solid, NodalState { time: 0.0, u, v }, 2e-3, |_, u| vec![0.0; u.len()]);
    let state = |motion: &SolidMotion<'_, _>| {
        let momentum = solid.momentum(&motion.state.v);
        let [kinetic, strain] = motion.energies();
        (kinetic + strain, strain, moments(&solid, &motion.state.u, &momentum))
    };
    let (energy, _, momenta) = state(&motion);
    let mut strained: f64 = 0.0;
    for _ in 0..100 {
        motion.advance().unwrap();
        strained = strained.max(state(&motion).1);
    }
    let (last, _, ends) = state(&motion);
    println!(
        "energy {:e}, momenta {:e} {:e}",
        last / energy - 1.0,
        (ends[0] - momenta[0]).norm(),
        (ends[1] - momenta[1]).norm()
    );
    assert!(strained > 0.01 * energy);
    assert!((last / energy - 1.0).abs() < 1e-9);
    for (end, start) in ends.iter().zip(momenta) {
        assert!((end - start).norm() < 1e-9 * start.norm());
    }
}

/// Closed form: 2/Δt atan(ωΔt/2) of the midpoint rule.
#[test]
fn small_vibrations_have_the_linear_frequency() {
    let solid = l();
    let (_, model) = cases::the_l("static_correction = false\n[time]\nend = 1e-3\nstep = 1e-3").unwrap();
    let omega = model.body.circular_frequencies[0];
    let phi = cases::shape(&model, 0);
    let momentum = solid.momentum(&phi);
    let u = phi.iter().map(|phi| 1e-6 * phi).collect();
    let step = std::f64::consts::TAU / omega / 30.0;
    let mut motion =
        SolidMotion::new(&solid, NodalState { time: 0.0, u, v: vec![0.0; phi.len()] }, step, |_, u| vec![0.0; u.len()]);
    let (mut times, mut values) = (vec![], vec![]);
    for _ in 0..90 {
        motion.advance().unwrap();
        times.push(motion.state.time);
        values.push(1e6 * momentum.iter().zip(&motion.state.u).map(|(m, u)| m * u).sum::<f64>());
    }
    let found = signal::frequency(&times, &values, omega, 1);
    let expected = 2.0 / step * (0.5 * omega * step).atan();
    println!("{found} {expected}");
    assert!((found / expected - 1.0).abs() < 1e-5);
}

/// Conserved: no resultant and no moment.
#[test]
fn a_pressure_all_round_has_neither_a_force_nor_a_moment() {
    let solid = l();
    let faces = solid.faces(|_| true);
    let u = field(&solid, |x| Vector3::new(0.3 * x.y * x.y, 0.2 * x.x * x.z, 0.4 * x.x * x.x));
    let forces = solid.pressure(&faces, &u);
    let [force, moment] = moments(&solid, &u, &forces);
    assert!(force.norm() < 1e-13 && moment.norm() < 1e-13, "{force} {moment}");
    // On the undeformed body they are those of the mesh.
    let (nodes, expected) = solid.mesh().surface_pressure("end").unwrap();
    let end = solid.faces(|x| x.y > 0.6 - 1e-9);
    let found = solid.pressure(&end, &vec![0.0; u.len()]);
    for (node, expected) in nodes.iter().zip(&expected) {
        let found = Vector3::from_column_slice(&found[3 * *node as usize..3 * *node as usize + 3]);
        assert!((found - expected).norm() < 1e-15);
    }
}
