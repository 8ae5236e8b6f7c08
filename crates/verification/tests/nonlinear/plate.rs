//! The plate of the paper, with its masses, on its own mesh.

use dynamics::{Method, Observation, Rows};
use model::Model;
use nalgebra::Vector3;
use scene::{Body, BodySource, Choice, Effect, Large, Materials, StepControl};
use verification::nonlinear::{NodalState, Solid, SolidMotion, bodies, cases, mean_axes};

/// Independent reference: the nonlinear finite elements of this crate.
#[test]
#[ignore = "minutes: just nonlinear"]
fn the_static_energy_of_the_first_mode_is_that_of_the_whole_mesh() {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../../examples/plate.toml");
    let mut body = Body::read(path).unwrap();
    body.loads.clear();
    body.time.method = Method::EXPONENTIAL;
    body.effects.choices[Effect::LargeDeflection] = Choice::On;
    body.effects.refuse = false;
    body.modes.large = Some(Large::Count(1));
    let BodySource::Meshed(meshed) = &body.source else { panic!("no mesh") };
    let Materials::Uniform(material) = meshed.materials else { panic!("materials") };
    let mesh = fem_tet10::read_msh(&meshed.mesh).unwrap();
    let solid = Solid::with_masses(mesh, material, &meshed.point_masses, |_| false).unwrap();
    let model = Model::build(&body, |_| ()).unwrap();
    let omega = model.body.circular_frequencies[0];
    for q in [0.1, 0.25, 0.5] {
        body.initial.modal_displacement = vec![q];
        let first = model.start(&body).unwrap().observation().unwrap();
        let found = first.strain_energy / (0.5 * (omega * q).powi(2)) - 1.0;
        let expected = cases::static_energy(&solid, &model, 0, q).unwrap();
        println!("{q}: {found:.5e}, nonlinear elements {expected:.5e}, off by {:.2e}", found / expected - 1.0);
        // Measured: -1.0e-4, -4.1e-4, -1.6e-3.
        assert!((found / expected - 1.0).abs() < 2e-3, "{q}: {found} instead of {expected}");
    }
}

/// The plate with elements of 60 mm that begins undeformed, with a spin and rates of its first modes.
fn spinning(rates: &[f64]) -> (Body, Solid) {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../../examples/spinning_plate.toml");
    let mut body = Body::read(path).unwrap();
    let BodySource::Meshed(meshed) = &mut body.source else { panic!("no mesh") };
    meshed.mesh = bodies::mesh_path("plate_60");
    let Materials::Uniform(material) = meshed.materials else { panic!("materials") };
    let solid =
        Solid::with_masses(bodies::mesh("plate_60").unwrap(), material, &meshed.point_masses, |_| false).unwrap();
    body.initial.angular_velocity = SPIN.into();
    body.initial.modal_displacement = Vec::new();
    body.initial.modal_velocity = rates.to_vec();
    body.time.end = 0.25;
    body.time.control = StepControl::Fixed(5e-5);
    body.rows = Rows::Interval(1e-3);
    body.effects.refuse = false;
    (body, solid)
}

const SPIN: Vector3<f64> = Vector3::new(6.0, 30.0, 60.0);

/// The modal displacements of the whole mesh at each row.
fn of_whole_mesh(model: &Model, solid: &Solid, rates: &[f64], steps_per_row: usize) -> Vec<Vec<f64>> {
    let shapes: Vec<Vec<f64>> = (0..model.body.flexible()).map(|k| cases::shape(model, k)).collect();
    let momenta: Vec<Vec<f64>> = shapes.iter().map(|shape| solid.momentum(shape)).collect();
    let arms = solid.mesh().positions().iter().map(|x| Vector3::from(*x) - model.body.center_of_mass);
    let mut v: Vec<f64> = arms.flat_map(|arm| <[f64; 3]>::from(SPIN.cross(&arm))).collect();
    for (rate, shape) in rates.iter().zip(&shapes) {
        v.iter_mut().zip(shape).for_each(|(v, shape)| *v += rate * shape);
    }
    let start = NodalState { time: 0.0, u: vec![0.0; v.len()], v };
    let mut motion = SolidMotion::new(solid, start, 1e-3 / steps_per_row as f64, |_, u| vec![0.0; u.len()]);
    let mut rows = Vec::new();
    for row in 0..=250 {
        if row > 0 {
            (0..steps_per_row).for_each(|_| motion.advance().unwrap());
        }
        let u = mean_axes(solid, &motion.state.u).displacement;
        let along = |momentum: &Vec<f64>| momentum.iter().zip(&u).map(|(a, b)| a * b).sum();
        rows.push(momenta.iter().map(along).collect());
    }
    rows
}

/// Independent reference: the nonlinear finite elements of this crate.
#[test]
#[ignore = "minutes: just nonlinear"]
fn a_plate_of_60_mm_that_spins_vibrates_as_the_whole_mesh() {
    for (rates, least_of_one, most_of_two) in
        [(&[154.0, 167.0][..], 0.2, 0.03), (&[200.0, -150.0, 100.0, 60.0], 0.25, 0.08)]
    {
        let (mut scene, solid) = spinning(rates);
        let mut truth = Vec::new();
        for (large, following) in [(0, 0), (1, 3), (2, 0), (2, 3), (2, 7), (3, 3), (4, 3)] {
            scene.effects.choices[Effect::LargeDeflection] = if large > 0 { Choice::On } else { Choice::Off };
            scene.modes.large = (large > 0).then_some(Large::Count(large));
            scene.modes.following = following;
            let model = Model::build(&scene, |_| ()).unwrap();
            if truth.is_empty() {
                truth = of_whole_mesh(&model, &solid, rates, 20);
            }
            let rows = cases::rows(&scene, &model).unwrap();
            let norm = |v: &[f64]| v.iter().map(|x| x * x).sum::<f64>().sqrt();
            // Modes that stretch have parts of the products, too.
            let apart = |(row, q): (&Observation, &Vec<f64>)| -> f64 {
                let each: Vec<f64> = row.modal_displacement.iter().zip(q).take(7).map(|(a, b)| a - b).collect();
                norm(&each)
            };
            let peak = truth.iter().map(|q| norm(&q[..7])).fold(0.0, f64::max);
            let off = rows.iter().zip(&truth).map(apart).fold(0.0, f64::max) / peak;
            println!("large {large}, following {following}: {:.2} % of the peak", 100.0 * off);
            assert!(large != 1 || off > least_of_one, "{off}");
            assert!(large < 2 || following == 0 || off < most_of_two, "{off}");
        }
    }
}
