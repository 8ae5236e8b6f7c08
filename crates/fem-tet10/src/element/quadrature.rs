//! Quadrature on the reference tetrahedron (volume 1/6) and triangle (area 1/2), with positive weights but for that of degree 3.

/// A point of a quadrature rule.
#[derive(Debug, Clone, Copy)]
pub struct Point {
    /// Reference coordinates (ξ, η, ζ).
    pub at: [f64; 3],
    /// Weight.
    pub weight: f64,
}

/// Degree 2, four points: exact for the stiffness of a straight element, whose strains are linear.
pub(crate) fn degree_2() -> Vec<Point> {
    let s5 = 5.0_f64.sqrt();
    let (a, b) = ((5.0 - s5) / 20.0, (5.0 + 3.0 * s5) / 20.0);
    vertex_orbit(a, b, 1.0 / 24.0)
}

/// Degree 3, five points: exact for products of three linear gradients. The weight of the middle is negative, so it is no rule
/// for what must be positive.
pub(crate) fn degree_3() -> Vec<Point> {
    let mut points = vertex_orbit(1.0 / 6.0, 0.5, 0.075);
    points.push(Point { at: [0.25; 3], weight: -2.0 / 15.0 });
    points
}

/// Degree 5, fourteen points (Walkington 2000): exact for the mass of a straight element (degree 4).
pub fn degree_5() -> Vec<Point> {
    let (a1, w1) = (0.310_885_919_263_300_6, 0.018_781_320_953_002_643);
    let (a2, w2) = (0.092_735_250_310_891_23, 0.012_248_840_519_393_66);
    let (a3, w3) = (0.045_503_704_125_649_65, 0.007_091_003_462_846_911);
    let mut points = vertex_orbit(a1, 1.0 - 3.0 * a1, w1);
    points.extend(vertex_orbit(a2, 1.0 - 3.0 * a2, w2));
    points.extend(edge_orbit(a3, 0.5 - a3, w3));
    points
}

/// Degree 6 on the triangle, twelve points (Dunavant 1985): barycentric coordinates and weights.
pub fn triangle_degree_6() -> Vec<([f64; 3], f64)> {
    let (a1, w1) = (0.249_286_745_170_910_42, 0.058_393_137_863_189_685);
    let (a2, w2) = (0.063_089_014_491_502_23, 0.025_422_453_185_103_41);
    let (a3, b3, w3) = (0.053_145_049_844_816_95, 0.310_352_451_033_784_4, 0.041_425_537_809_186_79);
    let c3 = 1.0 - a3 - b3;
    let corners = |a: f64| [[a, a, 1.0 - 2.0 * a], [a, 1.0 - 2.0 * a, a], [1.0 - 2.0 * a, a, a]];
    let skew = [[a3, b3, c3], [b3, c3, a3], [c3, a3, b3], [b3, a3, c3], [a3, c3, b3], [c3, b3, a3]];
    let orbits = corners(a1).map(|l| (l, w1)).into_iter().chain(corners(a2).map(|l| (l, w2)));
    orbits.chain(skew.map(|l| (l, w3))).collect()
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

    /// Closed form: ∫ ξⁱ ηʲ ζᵏ over the reference tetrahedron.
    #[test]
    fn rules_are_exact_to_their_degree_and_no_further() {
        assert!(worst_error(&degree_2(), 2) < 1e-14);
        assert!(worst_error(&degree_2(), 3) > 1e-3);
        assert!(worst_error(&degree_3(), 3) < 1e-14);
        assert!(worst_error(&degree_3(), 4) > 1e-3);
        assert!(worst_error(&degree_5(), 5) < 1e-13);
        assert!(worst_error(&degree_5(), 6) > 1e-3);
    }

    /// Closed form: ∫ L₁ⁱ L₂ʲ over the reference triangle.
    #[test]
    fn the_triangle_is_exact_to_degree_six_and_no_further() {
        // ∫ L₁ⁱ L₂ʲ over the reference triangle = i! j! / (i + j + 2)!
        let factorial = |n: u32| (1..=n).map(f64::from).product::<f64>();
        let worst = |degree: u32| {
            (0..=degree)
                .flat_map(|i| (0..=degree - i).map(move |j| (i, j)))
                .map(|(i, j)| {
                    let terms = triangle_degree_6().into_iter();
                    let sum: f64 = terms.map(|(l, w)| w * l[1].powi(i as i32) * l[2].powi(j as i32)).sum();
                    (sum * factorial(i + j + 2) / (factorial(i) * factorial(j)) - 1.0).abs()
                })
                .fold(0.0, f64::max)
        };
        assert!(worst(6) < 1e-13, "{:e}", worst(6));
        assert!(worst(7) > 1e-5, "{:e}", worst(7));
    }
}
