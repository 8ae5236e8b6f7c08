//! Quadrature on the reference tetrahedron (volume 1/6), with positive weights.

/// A point of a quadrature rule: reference coordinates (ξ, η, ζ) and weight.
pub(crate) struct Point {
    pub at: [f64; 3],
    pub weight: f64,
}

/// Degree 2, four points: exact for the stiffness of a straight element, whose strains are linear.
pub(crate) fn degree_2() -> Vec<Point> {
    let s5 = 5.0_f64.sqrt();
    let (a, b) = ((5.0 - s5) / 20.0, (5.0 + 3.0 * s5) / 20.0);
    vertex_orbit(a, b, 1.0 / 24.0)
}

/// Degree 5, fourteen points (Walkington 2000): exact for the mass of a straight element (degree 4).
pub(crate) fn degree_5() -> Vec<Point> {
    let (a1, w1) = (0.310_885_919_263_300_6, 0.018_781_320_953_002_643);
    let (a2, w2) = (0.092_735_250_310_891_23, 0.012_248_840_519_393_66);
    let (a3, w3) = (0.045_503_704_125_649_65, 0.007_091_003_462_846_911);
    let mut points = vertex_orbit(a1, 1.0 - 3.0 * a1, w1);
    points.extend(vertex_orbit(a2, 1.0 - 3.0 * a2, w2));
    points.extend(edge_orbit(a3, 0.5 - a3, w3));
    points
}

/// The four points with barycentric coordinates (a, a, a, b) in any order.
fn vertex_orbit(a: f64, b: f64, weight: f64) -> Vec<Point> {
    [[a, a, a], [b, a, a], [a, b, a], [a, a, b]].map(|at| Point { at, weight }).into()
}

/// The six points with barycentric coordinates (a, a, b, b) in any order.
fn edge_orbit(a: f64, b: f64, weight: f64) -> Vec<Point> {
    [[a, a, b], [a, b, a], [b, a, a], [b, b, a], [b, a, b], [a, b, b]].map(|at| Point { at, weight }).into()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// ∫ ξⁱ ηʲ ζᵏ over the reference tetrahedron = i! j! k! / (i + j + k + 3)!
    fn exact(i: u32, j: u32, k: u32) -> f64 {
        let factorial = |n: u32| (1..=n).map(f64::from).product::<f64>();
        factorial(i) * factorial(j) * factorial(k) / factorial(i + j + k + 3)
    }

    fn worst_error(rule: &[Point], degree: u32) -> f64 {
        let mut worst = 0.0_f64;
        for i in 0..=degree {
            for j in 0..=degree - i {
                for k in 0..=degree - i - j {
                    let sum: f64 = rule
                        .iter()
                        .map(|p| p.weight * p.at[0].powi(i as i32) * p.at[1].powi(j as i32) * p.at[2].powi(k as i32))
                        .sum();
                    worst = worst.max((sum / exact(i, j, k) - 1.0).abs());
                }
            }
        }
        worst
    }

    #[test]
    fn rules_are_exact_to_their_degree_and_no_further() {
        assert!(worst_error(&degree_2(), 2) < 1e-14);
        assert!(worst_error(&degree_2(), 3) > 1e-3);
        assert!(worst_error(&degree_5(), 5) < 1e-13);
        assert!(worst_error(&degree_5(), 6) > 1e-3);
    }
}
