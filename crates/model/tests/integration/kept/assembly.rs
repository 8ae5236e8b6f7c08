//! Several models from one mesh.

use modal::Progress;
use model::{Assembly, BuildProgress, Builder, Cache, ModeCount, Needs};
use scene::{Body, BodySource, Choice, Effect, RigidBody};

use super::cache::{FORCE, built_by};
use crate::{CLAMPED, bar, observations};

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
        let needs = Needs { flexible: Some(ModeCount::Count(count)), ..Needs::default() };
        let model = variants.build(&scene, &needs, |p| heard.push(p)).unwrap();
        let alone = Builder::default().needing(needs).build(&scene, |_| ()).unwrap();
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

/// Conserved: the same body to the last bit without the cache that commands with other needs have filled.
#[test]
fn commands_with_other_needs_of_one_scene_share_what_is_the_same_and_nothing_else() {
    let output = "[output]\nstress = true\n";
    let modes = "flexible = 3\ndamping_ratio = 0.01\nabout = { angular_velocity = [0.0, 0.0, 300.0], loads = true }";
    let scene = bar(modes, &format!("{CLAMPED}{FORCE}{output}"), "end = 1e-4\nstep = 1e-5");
    let needs = [
        Needs::default(),
        Needs::without_rows(),
        Needs::external_inputs(),
        Needs::modes(),
        Needs::spin(),
        Needs { flexible: Some(ModeCount::Count(2)), ..Needs::default() },
        Needs { static_correction: Some(false), ..Needs::default() },
    ];
    let folder = tempfile::tempdir().unwrap();
    let inputs = needs.each_ref().map(|needs| Assembly::input(&scene, needs));
    for needs in &needs {
        let (direct, _) = built_by(&Builder::default().needing(needs.clone()), &scene);
        let cache = Cache::new(folder.path(), 1 << 30);
        assert!(built_by(&Builder::with_cache(cache).needing(needs.clone()), &scene).0 == direct, "{needs:?}");
    }
    // An assembly knows how many modes there are to be, and the rest that they are about.
    let [run, without_rows, external, modes, spin, fewer, plain] = &inputs;
    assert!([without_rows, external, modes, plain].iter().all(|other| *other == run));
    assert!(spin != run && fewer != run && spin != fewer);
    // A scene with other data of the same assembly shares it; another body, support or rest does not.
    let same = |change: &dyn Fn(&mut Body)| {
        let mut other = scene.clone();
        change(&mut other);
        Assembly::input(&other, &needs[0]) == *run
    };
    assert!(same(&|other| other.title = "other".into()) && same(&|other| other.output.stress = false));
    assert!(!same(&|other| other.constraint = None) && !same(&|other| other.loads.clear()));
    assert!(!same(&|other| other.source =
        BodySource::Rigid(RigidBody { mass: 1.0, center_of_mass: [0.0; 3], inertia: [[0.0; 3]; 3] })));
}
