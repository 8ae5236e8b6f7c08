//! A beam from its own matrices, with a mass at its end.

use super::{build, scene};

/// Closed form: frequencies of a clamped beam w = a(cosh βx − cos βx) + b(sinh βx − sin βx) with the mass m and the
/// inertia J at its end: EI w'' = J ω² w', EI w''' = −m ω² w, with ρA ω² = EI β⁴. Consistent elements are above them
/// by less than 1e-5 here.
#[test]
fn has_the_frequencies_of_a_beam_with_a_mass_at_its_end() {
    let (length, outer, inner, mass, inertia) = (6.0_f64, 0.04_f64, 0.035_f64, 20.0, 0.3);
    let area = std::f64::consts::PI * (outer.powi(2) - inner.powi(2));
    let bending = 210e9 * std::f64::consts::PI / 4.0 * (outer.powi(4) - inner.powi(4));
    let line = 7850.0 * area;
    let determinant = |beta: f64| {
        let z = beta * length;
        let (ch, sh, c, s) = (z.cosh(), z.sinh(), z.cos(), z.sin());
        // w, w', w'', w''' at the end, over powers of β, of the two shapes.
        let (one, other) = ([ch - c, sh + s, ch + c, sh - s], [sh - s, ch - c, sh + s, ch + c]);
        let turning = |w: [f64; 4]| w[2] - inertia / line * beta.powi(3) * w[1];
        let pulling = |w: [f64; 4]| w[3] + mass / line * beta * w[0];
        turning(one) * pulling(other) - turning(other) * pulling(one)
    };
    let mut expected = Vec::new();
    let step = 1e-3;
    for i in 50..2000 {
        let (mut low, mut high) = (step * f64::from(i), step * f64::from(i + 1));
        if determinant(low) * determinant(high) < 0.0 {
            for _ in 0..60 {
                let middle = 0.5 * (low + high);
                if determinant(low) * determinant(middle) <= 0.0 { high = middle } else { low = middle }
            }
            expected.push(low * low * (bending / line).sqrt() / std::f64::consts::TAU);
        }
    }
    let scene = scene("boom");
    let model = build(&scene);
    let found = model.natural_frequencies();
    // Bending in both planes.
    for k in 0..4 {
        let off = found[k] / expected[k / 2] - 1.0;
        assert!(off.abs() < 1e-4, "{k}: {} against {}", found[k], expected[k / 2]);
    }
    let checks = model.meshed.as_ref().and_then(|meshed| meshed.checks).unwrap();
    assert!(checks.dofs == 6 && !checks.is_scalar_mass && checks.left_out < 0.01, "{checks:?}");
}
