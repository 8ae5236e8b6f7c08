//! Several models from one mesh.

use modal::Progress;
use model::{BuildProgress, Builder};
use scene::{Choice, Effect, Flexible};

use crate::{CLAMPED, bar, build, observations};

/// Conserved: the same frequencies and energies alone.
#[test]
fn models_of_one_assembly_are_those_built_alone_and_its_mesh_is_read_once() {
    let mut scene = bar("flexible = 8\nlarge = 2", CLAMPED, "end = 1e-4\nstep = 1e-5");
    scene.effects.choices[Effect::LargeDeflection] = Choice::On;
    scene.initial.modal_displacement = vec![1e-3];
    let mut heard = Vec::new();
    let assembly = Builder::default().assemble(&scene, |p| heard.push(p)).unwrap();
    let mut variants = assembly.variants().unwrap();
    let mut shapes = Vec::new();
    // Fewer modes than before are the first of those, more are searched again.
    for count in [8, 4, 1, 10] {
        scene.modes.flexible = Flexible::Count(count);
        let (model, alone) = (variants.build(&scene, |p| heard.push(p)).unwrap(), build(&scene));
        for (a, b) in model.body.circular_frequencies.iter().zip(&alone.body.circular_frequencies) {
            assert!((a / b - 1.0).abs() < 1e-9, "{count}: {a} {b}");
        }
        let manifold = model.physics.large_deflection.as_ref().unwrap();
        let expected = alone.physics.large_deflection.as_ref().unwrap();
        assert_eq!((manifold.modes(), manifold.large()), (count, expected.large()));
        assert_eq!(manifold.body().flexible(), expected.body().flexible());
        shapes.push(manifold.body().flexible());
        let [a, b] = [&model, &alone].map(|model| observations(&scene, model).last().unwrap().strain_energy);
        println!("{count} modes in {} shapes: {a:e} {b:e}", manifold.body().flexible());
        assert!((a / b - 1.0).abs() < 1e-8, "{count}: {a:e} {b:e}");
    }
    // With fewer modes the run is cheaper: what is left out is not carried along.
    assert!(shapes[0] > shapes[1] && shapes[1] > shapes[2], "{shapes:?}");
    let times = |is: fn(&BuildProgress) -> bool| heard.iter().filter(|p| is(p)).count();
    assert_eq!(times(|p| matches!(p, BuildProgress::Mesh)), 1);
    assert_eq!(times(|p| matches!(p, BuildProgress::Assembly)), 1);
    assert_eq!(times(|p| matches!(p, BuildProgress::Modes(Progress::Factorizing(_)))), 1);
}
