//! The plate of the paper, with its masses, on its own mesh.

use dynamics::Method;
use model::Model;
use scene::{Body, Choice, Effect, Large, Materials, Scene};
use verification::nonlinear::{Solid, cases};

/// Independent reference: the nonlinear finite elements of this crate.
#[test]
#[ignore = "minutes: just nonlinear"]
fn the_static_energy_of_the_first_mode_is_that_of_the_whole_mesh() {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../../examples/plate.toml");
    let mut scene = Scene::read(path).unwrap();
    scene.loads.clear();
    scene.time.method = Method::EXPONENTIAL;
    scene.effects.choices[Effect::LargeDeflection] = Choice::On;
    scene.effects.refuse = false;
    scene.modes.large = Some(Large::Count(1));
    let Body::Meshed(body) = &scene.body else { panic!("no mesh") };
    let Materials::Uniform(material) = body.materials else { panic!("materials") };
    let mesh = fem_tet10::read_msh(&body.mesh).unwrap();
    let solid = Solid::with_masses(mesh, material, &body.point_masses, |_| false).unwrap();
    let model = Model::build(&scene, |_| ()).unwrap();
    let omega = model.body.circular_frequencies[0];
    for q in [0.1, 0.25, 0.5] {
        scene.initial.modal_displacement = vec![q];
        let first = model.start(&scene).unwrap().observation().unwrap();
        let found = first.strain_energy / (0.5 * (omega * q).powi(2)) - 1.0;
        let expected = cases::static_energy(&solid, &model, 0, q).unwrap();
        println!("{q}: {found:.5e}, nonlinear elements {expected:.5e}, off by {:.2e}", found / expected - 1.0);
        // Measured: -1.0e-4, -4.1e-4, -1.6e-3.
        assert!((found / expected - 1.0).abs() < 2e-3, "{q}: {found} instead of {expected}");
    }
}
