//! Shape functions of the ten-node tetrahedron.
//!
//! With barycentric coordinates `L₀ = 1 − ξ − η − ζ, L₁ = ξ, L₂ = η, L₃ = ζ`:
//! corners `N_a = L_a (2 L_a − 1)`, mid-edges `N_ab = 4 L_a L_b`, in gmsh's order of the edges.

/// Corner pairs of the mid-edge nodes 4 to 9 in gmsh's order. (VTK and Abaqus swap the last two.)
pub(crate) const EDGES: [[usize; 2]; 6] = [[0, 1], [1, 2], [0, 2], [0, 3], [2, 3], [1, 3]];

/// Gradients of `L₀ … L₃` with respect to (ξ, η, ζ).
pub(crate) const BARYCENTRIC_GRADIENTS: [[f64; 3]; 4] =
    [[-1.0, -1.0, -1.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];

/// Reference coordinates (ξ, η, ζ) of the ten nodes.
pub(crate) const NODES: [[f64; 3]; 10] = [
    [0.0, 0.0, 0.0],
    [1.0, 0.0, 0.0],
    [0.0, 1.0, 0.0],
    [0.0, 0.0, 1.0],
    [0.5, 0.0, 0.0],
    [0.5, 0.5, 0.0],
    [0.0, 0.5, 0.0],
    [0.0, 0.0, 0.5],
    [0.0, 0.5, 0.5],
    [0.5, 0.0, 0.5],
];

/// The place in [`EDGES`] of the edge between two corners.
pub(crate) const fn edge_between(a: usize, b: usize) -> usize {
    const OF: [[usize; 4]; 4] = {
        let mut of = [[0; 4]; 4];
        let mut edge = 0;
        while edge < EDGES.len() {
            let [a, b] = EDGES[edge];
            of[a][b] = edge;
            of[b][a] = edge;
            edge += 1;
        }
        of
    };
    OF[a][b]
}

pub(crate) fn barycentric([xi, eta, zeta]: [f64; 3]) -> [f64; 4] {
    [1.0 - xi - eta - zeta, xi, eta, zeta]
}

/// Values of the ten shape functions at the reference point (ξ, η, ζ), Eq. (M1) of `docs/method/modes.md`.
pub fn shape_functions(at: [f64; 3]) -> [f64; 10] {
    let l = barycentric(at);
    let mut n = [0.0; 10];
    for a in 0..4 {
        n[a] = l[a] * (2.0 * l[a] - 1.0);
    }
    for (edge, [a, b]) in EDGES.into_iter().enumerate() {
        n[4 + edge] = 4.0 * l[a] * l[b];
    }
    n
}

/// Gradients of the ten shape functions with respect to (ξ, η, ζ) at a reference point.
pub fn shape_gradients(at: [f64; 3]) -> [[f64; 3]; 10] {
    let l = barycentric(at);
    let dl = BARYCENTRIC_GRADIENTS;
    let mut dn = [[0.0; 3]; 10];
    for axis in 0..3 {
        for a in 0..4 {
            dn[a][axis] = (4.0 * l[a] - 1.0) * dl[a][axis];
        }
        for (edge, [a, b]) in EDGES.into_iter().enumerate() {
            dn[4 + edge][axis] = 4.0 * (l[a] * dl[b][axis] + l[b] * dl[a][axis]);
        }
    }
    dn
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Closed form: N_i(x_j) = δ_ij.
    #[test]
    fn each_function_is_one_at_its_node_and_zero_at_the_others() {
        for (j, node) in NODES.into_iter().enumerate() {
            for (i, value) in shape_functions(node).into_iter().enumerate() {
                assert_eq!(value, if i == j { 1.0 } else { 0.0 }, "N_{i}(x_{j})");
            }
        }
    }

    /// Independent reference: central differences, exact for quadratic functions.
    #[test]
    fn gradients_are_the_differences_of_the_functions() {
        let at = [0.21, 0.17, 0.33];
        let h = 1e-5;
        for axis in 0..3 {
            let (mut plus, mut minus) = (at, at);
            plus[axis] += h;
            minus[axis] -= h;
            let (up, down) = (shape_functions(plus), shape_functions(minus));
            for (a, gradient) in shape_gradients(at).into_iter().enumerate() {
                // The functions are quadratic, so the central difference is exact to rounding.
                assert!((gradient[axis] - (up[a] - down[a]) / (2.0 * h)).abs() < 1e-10);
            }
        }
    }

    /// Conserved: the sum of the functions is one.
    #[test]
    fn functions_sum_to_one_and_gradients_to_zero() {
        let at = [0.4, 0.05, 0.3];
        assert!((shape_functions(at).iter().sum::<f64>() - 1.0).abs() < 1e-15);
        for axis in 0..3 {
            let sum: f64 = shape_gradients(at).iter().map(|g| g[axis]).sum();
            assert!(sum.abs() < 1e-15);
        }
    }
}
