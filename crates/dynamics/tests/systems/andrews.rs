//! Andrews' squeezer: seven bodies, ten hinges in space, a spring and a torque.

use std::sync::Arc;

use dynamics::{LoadFn, PointShapes, SharedLoad, SystemScheme};
use nalgebra::{Matrix3, Vector3};
use reduced_body::{BodyPoint, ReducedBody, RigidMotion};

use crate::mechanism::{Link, Mechanism, angle};

/// Places of hinges on the ground, and of the end of the spring there.
const A: [f64; 2] = [-0.06934, -0.00227];
const B: [f64; 2] = [-0.03635, 0.03273];
const C: [f64; 2] = [0.014, 0.072];

/// β, Θ, γ, Φ, δ, Ω, ε at the start and at 0.03 s.
const START: [f64; 7] = [
    -0.061_713_890_014_276_45,
    0.0,
    0.455_279_819_163_070_4,
    0.222_668_390_165_885_88,
    0.487_364_979_543_842_55,
    -0.222_668_390_165_885_88,
    1.230_547_444_549_821_2,
];
const END: [f64; 7] = [
    15.810_771_196_299_04,
    -15.756_371_059_842_98,
    0.040_822_240_130_731_01,
    -0.534_730_116_322_694_8,
    0.524_409_965_880_530_4,
    0.534_730_116_322_694_8,
    1.048_080_741_042_263,
];

fn squeezer() -> dynamics::SystemMotion {
    let [beta, theta, gamma, phi, delta, omega, epsilon] = START;
    let (sc, sd, e, ea, zf, fa) = (18e-3, 2e-2, 2e-2, 1421e-5, 2e-2, 1421e-5);
    let (rr, ra, d, da, sa, sb) = (7e-3, 92e-5, 28e-3, 115e-4, 1874e-5, 1043e-5);
    let (zt, ta, tb, u, ua, ub) = (4e-2, 2308e-5, 916e-5, 4e-2, 1228e-5, 449e-5);
    let polar = |r: f64, angle: f64| [r * angle.cos(), r * angle.sin()];
    let sum = |parts: &[[f64; 2]]| parts.iter().fold([0.0; 2], |a, b| [a[0] + b[0], a[1] + b[1]]);
    let quarter = std::f64::consts::FRAC_PI_2;
    let [a, b, f] = [A, B, polar(rr, beta)];
    let p = sum(&[f, polar(-d, beta + theta)]);
    let [h, i] = [sum(&[a, polar(zt, delta)]), sum(&[a, polar(u, epsilon - quarter)])];
    let centers = [
        polar(ra, beta),
        sum(&[f, polar(-da, beta + theta)]),
        sum(&[b, polar(sa, gamma - quarter), polar(sb, gamma)]),
        sum(&[h, polar(e - ea, phi + delta - quarter)]),
        sum(&[a, polar(ta, delta), polar(tb, delta + quarter)]),
        sum(&[i, polar(zf - fa, omega + epsilon)]),
        sum(&[a, polar(ua, epsilon - quarter), polar(-ub, epsilon)]),
    ];
    let angles = [beta, beta + theta, gamma, phi + delta, delta, omega + epsilon, epsilon];
    let masses = [0.04325, 0.00365, 0.02373, 0.00706, 0.07050, 0.00706, 0.05498];
    let inertias = [2.194e-6, 4.410e-7, 5.255e-6, 5.667e-7, 1.169e-5, 5.667e-7, 1.912e-5];

    let place = |arm: Vector3<f64>| {
        let body = ReducedBody::rigid(1.0, Vector3::zeros(), Matrix3::identity(), RigidMotion::free()).unwrap();
        PointShapes::new(&body, &BodyPoint::rigid(arm))
    };
    // A couple of forces at two points.
    let [near, far] = [Vector3::zeros(), Vector3::x()].map(place);
    let torque: SharedLoad = Arc::new(LoadFn::new("motor", move |_, applied| {
        applied.force(&far, &Vector3::new(0.0, 0.033, 0.0));
        applied.force(&near, &Vector3::new(0.0, -0.033, 0.0));
    }));
    // Where the spring holds the third body, in its axes.
    let end = place(Vector3::new(sd - sb, -sc + sa, 0.0));
    let spring: SharedLoad = Arc::new(LoadFn::new("spring", move |motion, applied| {
        let stretch = motion.position_global(&end) - Vector3::new(C[0], C[1], 0.0);
        let length = stretch.norm();
        let force = stretch * (-4530.0 * (length - 7785e-5) / length);
        applied.force(&end, &(motion.body_from_global * force));
    }));
    let mut mechanism = Mechanism::default();
    let numbers: Vec<usize> = (0..7)
        .map(|k| {
            let loads: Vec<SharedLoad> = match k {
                0 => vec![torque.clone()],
                2 => vec![spring.clone()],
                _ => Vec::new(),
            };
            let inertia = Vector3::repeat(inertias[k]);
            mechanism.link(Link { mass: masses[k], inertia, center: centers[k], angle: angles[k], loads })
        })
        .collect();
    let [k1, k2, k3, k4, k5, k6, k7] = [0, 1, 2, 3, 4, 5, 6].map(|k| Some(numbers[k]));
    let hinges = [
        ([None, k1], [0.0; 2]),
        ([k1, k2], f),
        ([k2, k3], p),
        ([k2, k4], p),
        ([k2, k6], p),
        ([None, k3], b),
        ([None, k5], a),
        ([None, k7], a),
        ([k4, k5], h),
        ([k6, k7], i),
    ];
    hinges.into_iter().for_each(|(bodies, at)| mechanism.hinge(bodies, at));
    mechanism.starts(&[([0.0; 2], 0.0); 7])
}

/// Independent reference: angles at 0.03 s of the test set of initial value problems (Mazzia and Magherini, Bari).
#[test]
fn the_squeezer_ends_where_others_have_it() {
    let mut start = squeezer();
    let [residual, _] = start.assemble().unwrap();
    assert!(residual < 1e-15, "{residual:e}");
    let runs = [(1e-4, 5e-3), (1e-6, 1e-4), (1e-8, 1e-7)].map(|run| (SystemScheme::Radau, run));
    let explicit = [(1e-4, 3e-2), (1e-6, 5e-4), (1e-8, 5e-6)].map(|run| (SystemScheme::Rkmk4, run));
    for (scheme, (tolerance, bound)) in runs.into_iter().chain(explicit) {
        let mut motion = start.clone().with_scheme(scheme);
        let steps = motion.advance(0.03, tolerance, &mut 1e-5).unwrap();
        let wrapped = |x: f64| (x + std::f64::consts::PI).rem_euclid(std::f64::consts::TAU) - std::f64::consts::PI;
        let angles: Vec<f64> = (0..7).map(|k| angle(&motion, k)).collect();
        let [k1, k2, k3, k4, k5, k6, k7] = angles[..] else { unreachable!() };
        let found = [k1, k2 - k1, k3, k4 - k5, k5, k6 - k7, k7];
        let error = found.iter().zip(END).map(|(found, end)| wrapped(found - end).abs()).fold(0.0, f64::max);
        println!("{scheme:?} {tolerance:e}: {steps} steps, {} evaluations, error {error:e}", motion.evaluations());
        assert!(error < bound, "{error:e}");
        // Ten hinges have 50 rows; in the plane, of 42 coordinates, 41 are independent.
        assert_eq!(motion.dependent_rows(), 9);
    }
}
