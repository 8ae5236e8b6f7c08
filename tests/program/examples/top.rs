//! The heavy symmetrical top.

use flexframe::dynamics::Observation;
use nalgebra::Vector3;

use crate::examples::{build, rows, scene};

/// K(m) and sn(x | m), by the arithmetic–geometric mean.
fn elliptic(m: f64) -> (f64, impl Fn(f64) -> f64) {
    let (mut a, mut b) = (1.0_f64, (1.0 - m).sqrt());
    let mut ratios = Vec::new();
    while (a - b).abs() > 1e-16 * a {
        let c = 0.5 * (a - b);
        (a, b) = (0.5 * (a + b), (a * b).sqrt());
        ratios.push(c / a);
    }
    let complete = std::f64::consts::FRAC_PI_2 / a;
    let sn = move |x: f64| {
        let mut phi = 2.0_f64.powi(ratios.len() as i32) * a * x;
        for ratio in ratios.iter().rev() {
            phi = 0.5 * (phi + (ratio * phi.sin()).asin());
        }
        phi.sin()
    };
    (complete, sn)
}

/// Closed form: the elliptic function sn. The energy, 1269.975, is published (Simo and Wong).
#[test]
fn the_heavy_top_nutates_as_the_elliptic_functions_say_and_keeps_its_energy() {
    let scene = scene("heavy_top");
    let rows = rows(&build(&scene), &scene);
    let tilt = 0.05_f64;
    let up = Vector3::new(0.0, tilt.sin(), tilt.cos());
    let energy = |o: &Observation| o.energy() + 20.0 * up.dot(&o.position_global);
    assert!((energy(&rows[0]) - 1269.975).abs() < 5e-4, "{}", energy(&rows[0]));

    // u = cos θ of the axis. It begins without precession, so with a = J₃ω₃/J₁ and β = 2 M g l/J₁
    // u'² = (u₀ − u) (β (1 − u²) − a² (u₀ − u)) = β (u − u₁)(u₀ − u)(u₃ − u).
    let (a, beta, u0): (f64, f64, f64) = (50.0 / 5.0, 2.0 * 20.0 / 5.0, tilt.cos());
    let root = (a.powi(4) - 4.0 * beta * (a * a * u0 - beta)).sqrt();
    let [u1, u3] = [-root, root].map(|root: f64| (a * a + root) / (2.0 * beta));
    let (quarter, sn) = elliptic((u0 - u1) / (u3 - u1));
    let rate = 0.5 * (beta * (u3 - u1)).sqrt();
    let (mut drift, mut off) = (0.0_f64, 0.0_f64);
    for row in &rows {
        let u = row.attitude.to_global(&Vector3::z()).dot(&up);
        let expected = u1 + (u0 - u1) * sn(quarter + rate * row.time).powi(2);
        off = off.max((u - expected).abs());
        drift = drift.max((energy(row) / energy(&rows[0]) - 1.0).abs());
        assert!((row.omega_body.z / 50.0 - 1.0).abs() < 1e-12);
    }
    assert_eq!(rows.last().unwrap().time, 10.0);
    // Measured: 6.5e-14 of the energy, 3.2e-7 of the nutation.
    assert!(drift < 1e-9, "{drift:e}");
    assert!(off < 1e-6 * (u0 - u1), "{off:e}");
}
