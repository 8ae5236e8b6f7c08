//! Models that are known to be wrong.

use advice::{Case, Refusal, RestOfBody, limits};
use dynamics::{Effect, EffectMap, Initial};
use faer::Mat;

use crate::plate::{clamped, plate, spinning};

/// Closed form: across a bending direction the critical speed is ω₁ itself.
#[test]
fn the_plate_about_axis_2_is_refused_at_160_without_stiffening_and_not_about_axis_3() {
    let bare = EffectMap::all().without(Effect::GeometricStiffening);
    let zeta = [0.0; 10];
    let verdict = |omega: [f64; 3], effects: &EffectMap<bool>| {
        let initial = spinning(omega);
        limits(&plate().case(&zeta, &[], &initial, 0.5), effects).unwrap()
    };
    let Some(Refusal::Indefinite { critical, .. }) = verdict([0.0, 160.0, 0.0], &bare) else {
        panic!("{:?}", verdict([0.0, 160.0, 0.0], &bare));
    };
    // ω1 = 154.1 rad/s, measured the same: across a bending direction the softening is Ω² itself.
    assert!((critical / plate().body.circular_frequencies[0] - 1.0).abs() < 2e-3, "{critical}");
    // As long as the model has a rest, it is not refused: how wrong it is, the check by the full body tells.
    assert_eq!(verdict([0.0, 150.0, 0.0], &bare), None);
    assert_eq!(verdict([0.0, 160.0, 0.0], &EffectMap::all()), None);
    assert_eq!(verdict([0.0, 160.0, 0.0], &bare.without(Effect::DeformedInertia)), None);
    assert_eq!(verdict([0.0, 0.0, 300.0], &bare), None);
    let refusal = verdict([0.0, 160.0, 0.0], &bare).unwrap();
    let text = refusal.to_string();
    for words in
        ["the model has no rest", "of its modes is not positive definite", "flexframe check", "geometric_stiffening on"]
    {
        assert!(text.contains(words), "{text}");
    }
    // Once the full body was asked, its answer is in the message.
    let text = refusal.with_rest_of_body(RestOfBody::Unstable { directions: 2 }).to_string();
    assert!(
        text.contains("its stiffness is negative in 2 direction(s)") && !text.contains("flexframe check"),
        "{text}"
    );
    let text = refusal.with_rest_of_body(RestOfBody::Stable { displacement: 0.25 }).to_string();
    assert!(text.contains("the full body of the mesh has a stable one") && text.contains("0.25"), "{text}");
}

/// Closed form: ½ qᵀ(Λ + B) q of two large modes with ω₁ q₁ = ±ω₂ q₂ and B₁₂ = −3 ω₁ω₂ is −½ or 2½ times (ω₁ q₁)²; without B it is (ω₁ q₁)².
#[test]
fn the_energy_of_large_modes_has_what_couples_them() {
    let zeta = [0.0; 10];
    let manifold = clamped().manifold(&[0, 1]);
    let omega = &clamped().body.circular_frequencies;
    let coupling = Mat::from_fn(10, 10, |i, j| if i + j == 1 { -3.0 * omega[0] * omega[1] } else { 0.0 });
    let q = 0.01 * clamped().length / clamped().peaks[0];
    for (sign, coupling, is_refused) in
        [(1.0, Some(&coupling), true), (-1.0, Some(&coupling), false), (1.0, None, false)]
    {
        let mut initial = Initial::at_rest(10);
        (initial.modal_displacement[0], initial.modal_displacement[1]) = (q, sign * q * omega[0] / omega[1]);
        let case = clamped().case(&zeta, &[], &initial, 1e-6);
        let found = limits(&Case { manifold: Some(&manifold), coupling, ..case }, &EffectMap::all()).unwrap();
        assert_eq!(matches!(found, Some(Refusal::NegativeEnergy { .. })), is_refused, "{sign}: {found:?}");
    }
}
