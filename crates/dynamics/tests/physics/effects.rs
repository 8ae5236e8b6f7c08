//! Effects that are off.

use dynamics::{ConservativeBody, Effect, EffectMap, Physics};
use nalgebra::Vector3;
use reduced_body::RigidMotion;

use crate::sample::{EXPONENTIAL, Run, body};

fn all() -> [EffectMap<bool>; 16] {
    let switched = [Effect::Translation, Effect::Rotation, Effect::DeformedInertia, Effect::Coriolis];
    std::array::from_fn(|bits| {
        let off = switched.iter().enumerate().filter(|(bit, _)| bits & (1 << bit) == 0);
        off.fold(EffectMap::all(), |effects, (_, effect)| effects.without(*effect))
    })
}

/// Conserved: energy.
#[test]
fn energy_is_conserved_whatever_is_off() {
    let body = body(RigidMotion::free(), &[5.0, 8.0, 13.0]);
    for effects in all() {
        let mut run = Run::new(&body, 5.0);
        run.physics.effects = effects;
        // Measured: at most 7.2e-13.
        assert!(run.energy_gap(EXPONENTIAL, 1e-3) < 1e-10, "{effects:?}");
    }
}

#[test]
fn what_is_off_takes_no_memory_and_no_multiplication() {
    let nf = 5;
    let body = body(RigidMotion::free(), &[5.0, 8.0, 13.0, 20.0, 30.0]);
    for effects in all() {
        let physics = Physics { effects, ..Physics::default() };
        let reduced = ConservativeBody::new(&body, &[0.0; 5], Vec::new(), &physics).unwrap();
        let matrices = match (effects[Effect::Rotation], effects[Effect::DeformedInertia], effects[Effect::Coriolis]) {
            (false, _, _) => 0,
            (true, inertia, coriolis) => 6 * usize::from(inertia) + 3 * usize::from(coriolis),
        };
        assert_eq!(reduced.matrix_entries(), matrices * nf * nf, "{effects:?}");
    }
    let hinged = crate::sample::body(RigidMotion::hinge(Vector3::zeros(), Vector3::x()), &[5.0; 5]);
    let reduced = ConservativeBody::new(&hinged, &[0.0; 5], Vec::new(), &Physics::default()).unwrap();
    assert_eq!(reduced.matrix_entries(), 2 * nf * nf);
}

/// Closed form: without turning each mode swings as q cos ωt + q̇/ω sin ωt.
#[test]
fn what_is_off_has_no_part_in_the_motion() {
    let body = body(RigidMotion::free(), &[5.0, 8.0, 13.0]);
    let end = |effects: EffectMap<bool>| {
        let mut run = Run::new(&body, 2.0);
        run.physics.effects = effects;
        let [_, last] = run.ends(EXPONENTIAL, 1e-2);
        last
    };
    let full = end(EffectMap::all());
    let still = end(EffectMap::all().without(Effect::Rotation));
    assert!(still.omega_body == Vector3::zeros() && still.position_global == full.position_global);
    // Without turning each mode swings by itself.
    for (k, omega) in [5.0_f64, 8.0, 13.0].into_iter().enumerate() {
        let start = crate::sample::start(3);
        let expected =
            start.modal_displacement[k] * (omega * 2.0).cos() + start.modal_velocity[k] / omega * (omega * 2.0).sin();
        assert!((still.modal_displacement[k] - expected).abs() < 1e-13);
    }
    let fixed = end(EffectMap::all().without(Effect::Translation));
    assert!(fixed.position_global == Vector3::zeros() && fixed.modal_displacement == full.modal_displacement);
    for effects in [EffectMap::all().without(Effect::Coriolis), EffectMap::all().without(Effect::DeformedInertia)] {
        assert!(end(effects).attitude.angle_to(&full.attitude) > 1e-3, "{effects:?}");
    }
}
