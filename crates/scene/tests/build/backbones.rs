//! How frequencies go with amplitudes, against geometrically nonlinear finite elements and beams.

use scene::{Model, Scene};

/// The plate of the paper, undamped, its first mode displaced by so much at the ends (mm).
fn plate(displacement: f64) -> Model {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../../examples/plate.toml");
    let mut scene = Scene::read(path).unwrap();
    scene.loads.clear();
    scene.initial.modal_displacement = vec![displacement];
    Model::build(&scene, |_| ()).unwrap()
}

/// Nonlinear finite elements on the same mesh, free of spin: 24.3364 Hz with 20 mm at the ends, 22.952 Hz with 60 mm, where
/// the linear modes have 24.5323 Hz.
#[test]
fn of_the_first_mode_of_the_plate_it_is_that_of_nonlinear_elements() {
    let unit = plate(1.0);
    // The largest displacement of the mode is at the ends.
    let peak = unit.deflection(&[1.0]) * 1001.3;
    let model = plate(60.0 / peak);
    let backbone = model.backbones()[0].unwrap();
    let linear = model.natural_frequencies()[0];
    for (at_ends, frequency, tolerance) in [(20.0, 24.3364, 0.02), (60.0, 22.952, 0.05)] {
        let (shift, exact) = (backbone.shift(at_ends / peak), frequency / linear - 1.0);
        println!("{at_ends} mm: {shift:e}, by elements {exact:e}");
        assert!((shift / exact - 1.0).abs() < tolerance, "{at_ends} mm: {shift:e}, by elements {exact:e}");
    }
    // What does not bend it far has none, and nothing is computed for it.
    let small = plate(1.0 / peak);
    assert!(small.backbones().iter().all(Option::is_none));
}
