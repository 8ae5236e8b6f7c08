//! Models that are known to be wrong.

use advice::{Refusal, limits};
use dynamics::{Effect, EffectMap};

use crate::plate::{plate, spinning};

/// Closed form: across a bending direction the critical speed is ω₁ itself.
#[test]
fn the_plate_about_axis_2_is_refused_at_160_without_stiffening_and_not_about_axis_3() {
    let bare = EffectMap::all().without(Effect::GeometricStiffening);
    let zeta = [0.0; 10];
    let verdict = |omega: [f64; 3], effects: &EffectMap<bool>| {
        let initial = spinning(omega);
        limits(&plate().case(&zeta, &[], &initial, 0.5), effects).unwrap()
    };
    let Some(Refusal::Unstable { critical, .. }) = verdict([0.0, 160.0, 0.0], &bare) else {
        panic!("{:?}", verdict([0.0, 160.0, 0.0], &bare));
    };
    // ω1 = 154.1 rad/s, measured the same: across a bending direction the softening is Ω² itself.
    assert!((critical / plate().body.circular_frequencies[0] - 1.0).abs() < 2e-3, "{critical}");
    assert!(matches!(verdict([0.0, 150.0, 0.0], &bare), Some(Refusal::Softened { .. })));
    assert_eq!(verdict([0.0, 50.0, 0.0], &bare), None);
    assert_eq!(verdict([0.0, 160.0, 0.0], &EffectMap::all()), None);
    assert_eq!(verdict([0.0, 160.0, 0.0], &bare.without(Effect::DeformedInertia)), None);
    assert!(!matches!(verdict([0.0, 0.0, 300.0], &bare), Some(Refusal::Unstable { .. })));
    let text = verdict([0.0, 160.0, 0.0], &bare).unwrap().to_string();
    assert!(text.contains("loses definiteness") && text.contains("geometric_stiffening on"), "{text}");
}
