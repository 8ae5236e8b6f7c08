//! Systems far from the origin, and that fly fast, against the same near it and at rest as a whole.

use dynamics::{StepError, SystemMotion, SystemScheme};
use nalgebra::{Vector3, Vector6};

use crate::mechanism::{Link, Mechanism};

/// Three bars in a row that turn against each other, moved and in motion as a whole.
fn chain(away: [f64; 2], velocity: [f64; 2]) -> SystemMotion {
    let bar = |x: f64| Link {
        mass: 1.0,
        inertia: Vector3::new(1e-3, 1.0 / 12.0, 1.0 / 12.0),
        center: [away[0] + x, away[1]],
        angle: 0.0,
        loads: Vec::new(),
    };
    let mut mechanism = Mechanism::default();
    let [a, b, c] = [-1.0, 0.0, 1.0].map(|x| mechanism.link(bar(x)));
    mechanism.hinge([Some(a), Some(b)], [away[0] - 0.5, away[1]]);
    mechanism.hinge([Some(b), Some(c)], [away[0] + 0.5, away[1]]);
    // The middle one turns with 1 rad/s, the others with 3 and −2, about a centre of mass that goes along.
    let own =
        [[0.0, -0.5 - 1.5], [0.0, 0.0], [0.0, 0.5 - 1.0]].map(|[x, y]| [x + velocity[0], y + velocity[1] + 2.5 / 3.0]);
    mechanism.starts(&[(own[0], 3.0), (own[1], 1.0), (own[2], -2.0)])
}

/// Steps to two seconds, places and attitudes of the bodies from the way of the whole, and momenta that have changed, over their size.
fn run(away: [f64; 2], velocity: [f64; 2], tolerance: f64) -> (u64, Vec<Vector6<f64>>, [f64; 2]) {
    let mut motion = chain(away, velocity).with_scheme(SystemScheme::Radau);
    motion.assemble().unwrap();
    let before = motion.momenta();
    let steps = motion.advance(2.0, tolerance, &mut 1e-2).unwrap();
    let after = motion.momenta();
    let changed = [0, 1].map(|k: usize| (after[k] - before[k]).norm() / before[k].norm().max(1.0));
    let way = Vector3::new(away[0] + 2.0 * velocity[0], away[1] + 2.0 * velocity[1], 0.0);
    let of_body = |body: usize| {
        let state = motion.state(body).unwrap();
        let (place, turned) = (state.origin_global - way, state.attitude.to_global(&Vector3::x()));
        Vector6::new(place.x, place.y, place.z, turned.x, turned.y, turned.z)
    };
    (steps, (0..3).map(of_body).collect(), changed)
}

/// Conserved: what a system does does not depend on where it is and how it flies as a whole, nor do the steps that it takes.
#[test]
fn a_free_chain_does_far_away_and_in_orbit_what_it_does_at_the_origin() {
    // Places 10⁷ away are rounded to 2e-9: a tolerance of 1e-4 is what that leaves of them in two seconds, near the origin less is asked. With less a run says so.
    for tolerance in [1e-4, 1e-6] {
        let (steps, here, _) = run([0.0; 2], [0.0; 2], tolerance);
        // What places are rounded to at the end.
        for (away, velocity, rounding) in
            [([0.0; 2], [300.0, 0.0], 1e-11), ([1e7, 3e6], [0.0; 2], 2e-7), ([7e6, 0.0], [0.0, 7500.0], 2e-7)]
        {
            if tolerance < 1e-4 && rounding > 1e-10 {
                let mut motion = chain(away, velocity).with_scheme(SystemScheme::Radau);
                motion.assemble().unwrap();
                let refused = motion.advance(2.0, tolerance, &mut 1e-2);
                assert!(matches!(refused, Err(StepError::TooFar { .. })), "{refused:?}");
                continue;
            }
            let (count, there, changed) = run(away, velocity, tolerance);
            let off = here.iter().zip(&there).map(|(a, b)| (a - b).norm()).fold(0.0, f64::max);
            println!(
                "{tolerance:e} {away:?} {velocity:?}: {count} of {steps} steps, off by {off:e}, momenta {changed:?}"
            );
            assert!(count.abs_diff(steps) <= 1 + steps / 20, "{count} {steps}");
            assert!(off < rounding, "{off:e}");
            assert!(changed.iter().all(|changed| *changed < rounding), "{changed:?}");
        }
    }
}
