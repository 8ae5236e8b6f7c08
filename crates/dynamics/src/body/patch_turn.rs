//! The rotation of a patch of nodes that large modes turn far, and the work of a moment on it.
//!
//! ```text
//! G(ξ) = Σ (d + u) dᵀ = G₀ + Σ_k Q_k ξ_k      G = R P,  R a rotation, P symmetric
//! δφ = R (tr P − P)⁻¹ axial(Rᵀ δG)            m·δφ = (R [n×]) : δG,   n = (tr P − P)⁻¹ Rᵀ m
//! ```
//!
//! d are the places of the nodes from their mean, u their displacements. R is the rotation of the patch that fits them best;
//! its small change is that of `fem_tet10::MeanRotation` where u is small. axial(A) is the vector of A − Aᵀ.

use keys::{Key, Keyed};
use nalgebra::Matrix3;
use nalgebra::Vector3;

/// Iterations to the polar decomposition: each squares the error, from a turn of less than half a right angle in four.
const MOST: usize = 30;
const ROUNDING: f64 = 1e-14;

/// A patch of nodes with what the modes do to it.
#[derive(Debug, Clone, serde::Serialize, serde::Deserialize)]
pub struct PatchTurn {
    /// G₀ = Σ d dᵀ, squared length.
    rest: Matrix3<f64>,
    /// Q_k = Σ ψ_k dᵀ of each flexible mode.
    modes: Vec<Matrix3<f64>>,
    /// The normal of a flat patch.
    normal: Option<Vector3<f64>>,
}

/// A patch where it is: R, (tr P − P)⁻¹ and G.
#[derive(Debug, Clone, Copy)]
pub(crate) struct PatchFit {
    pub rotation: Matrix3<f64>,
    inverse: Matrix3<f64>,
    /// G.
    sum: Matrix3<f64>,
}

/// How a coordinate moves a patch, in the axes that R turns: Rᵀ ∂G/∂q, and its angular velocity.
#[derive(Debug, Clone, Copy)]
pub(crate) struct PatchSlope {
    slope: Matrix3<f64>,
    pub spin: Vector3<f64>,
}

impl PatchFit {
    /// The change of the angular velocity of one coordinate by another, in the axes that R turns, but for that by ∂²G/∂q∂q: of
    /// (tr P − P) w = axial(Rᵀ ∂G), where R changes by R [w_j ×] and P with it.
    pub(crate) fn spin_change(&self, of: &PatchSlope, by: &PatchSlope) -> Vector3<f64> {
        let turned = by.spin.cross_matrix();
        let p = self.rotation.tr_mul(&self.sum);
        let p_change = by.slope - turned * p;
        let stretched = Matrix3::from_diagonal_element(p_change.trace()) - p_change;
        self.inverse * -(axial(&(turned * of.slope)) + stretched * of.spin)
    }

    /// A patch that is torn flat: no number.
    pub const NONE: Self = Self { rotation: NO_NUMBERS, inverse: NO_NUMBERS, sum: NO_NUMBERS };
}

const NO_NUMBERS: Matrix3<f64> =
    Matrix3::new(f64::NAN, f64::NAN, f64::NAN, f64::NAN, f64::NAN, f64::NAN, f64::NAN, f64::NAN, f64::NAN);

impl PatchTurn {
    /// By Σ d dᵀ, and Σ ψ dᵀ of each flexible mode; `None` where the nodes lie on a line.
    pub fn new(rest: Matrix3<f64>, modes: Vec<Matrix3<f64>>) -> Option<Self> {
        let eigen = rest.symmetric_eigen();
        let least = eigen.eigenvalues.imin();
        let most = eigen.eigenvalues.max();
        if eigen.eigenvalues.sum() - most - eigen.eigenvalues[least] <= FLAT * most {
            return None;
        }
        let is_flat = eigen.eigenvalues[least] < FLAT * most;
        let normal = is_flat.then(|| eigen.eigenvectors.column(least).into());
        let turn = Self { rest, modes, normal };
        turn.polar(&rest)?;
        Some(turn)
    }

    /// The rotation of the patch where the flexible modes have the displacements ξ; `None` of one that is torn flat.
    pub fn rotation(&self, xi: &[f64]) -> Option<Matrix3<f64>> {
        Some(self.fit(xi.iter().copied())?.rotation)
    }

    /// Number of flexible modes.
    pub(crate) fn flexible(&self) -> usize {
        self.modes.len()
    }

    /// The first of the modes only.
    pub(crate) fn truncated(&self, modes: usize) -> Self {
        Self { modes: self.modes[..modes.min(self.modes.len())].to_vec(), ..*self }
    }

    /// Its Q_k.
    pub(crate) fn modes(&self) -> &[Matrix3<f64>] {
        &self.modes
    }

    /// The same patch by other coordinates, with their Q_k.
    pub(crate) fn with_modes(&self, modes: Vec<Matrix3<f64>>) -> Self {
        Self { modes, ..*self }
    }

    /// Forces of a moment on the flexible modes where these have the displacements ξ; `None` of a patch that is torn flat.
    pub(crate) fn forces<'a>(
        &'a self,
        moment: &Vector3<f64>,
        xi: &[f64],
    ) -> Option<impl Iterator<Item = f64> + use<'a>> {
        Some(self.forces_at(&self.fit(xi.iter().copied())?, moment))
    }

    /// Where the patch is at displacements ξ; `None` of one that is torn flat.
    pub(crate) fn fit(&self, xi: impl Iterator<Item = f64>) -> Option<PatchFit> {
        let g = self.modes.iter().zip(xi).fold(self.rest, |sum, (q, x)| sum + q * x);
        let rotation = self.polar(&g)?;
        let p = rotation.transpose() * g;
        let inverse = (Matrix3::from_diagonal_element(p.trace()) - p).try_inverse()?;
        Some(PatchFit { rotation, inverse, sum: g })
    }

    /// Forces of a moment on the flexible modes where the patch is.
    pub(crate) fn forces_at<'a>(
        &'a self,
        fit: &PatchFit,
        moment: &Vector3<f64>,
    ) -> impl Iterator<Item = f64> + use<'a> {
        let PatchFit { rotation, inverse, .. } = fit;
        let turned = rotation * (inverse.transpose() * rotation.tr_mul(moment)).cross_matrix();
        self.modes.iter().map(move |q| turned.dot(q))
    }

    /// Its angular velocity where it is, at the rates of ξ.
    pub(crate) fn spin_at(&self, fit: &PatchFit, rates: impl Iterator<Item = f64>) -> Vector3<f64> {
        let PatchFit { rotation, inverse, .. } = fit;
        let g_rate = self.modes.iter().zip(rates).fold(Matrix3::zeros(), |sum, (q, rate)| sum + q * rate);
        rotation * (inverse * axial(&rotation.tr_mul(&g_rate)))
    }

    /// How a coordinate that moves ξ along this moves the patch where it is.
    pub(crate) fn slope_at(&self, fit: &PatchFit, along: impl Iterator<Item = f64>) -> PatchSlope {
        let slope = self.modes.iter().zip(along).fold(Matrix3::zeros(), |sum, (q, x)| sum + q * x);
        let slope = fit.rotation.tr_mul(&slope);
        PatchSlope { slope, spin: fit.inverse * axial(&slope) }
    }

    /// R of G, by the iteration of Newton: the mean of a matrix and its transposed inverse.
    fn polar(&self, g: &Matrix3<f64>) -> Option<Matrix3<f64>> {
        // A patch may be flat: out of its plane it has the size that makes it a rotation.
        let mut r = match self.normal {
            Some(normal) => {
                let [a, b] = across(&normal);
                let (a, b) = (g * a, g * b);
                let out = a.cross(&b).try_normalize(0.0)? * g.norm();
                g + out * normal.transpose()
            }
            None => *g,
        } / g.norm();
        for _ in 0..MOST {
            let next = (r + r.try_inverse()?.transpose()) * 0.5;
            let change = (next - r).norm();
            r = next;
            if change < ROUNDING {
                break;
            }
        }
        (r.determinant() > 0.0).then_some(r)
    }
}

/// Squared distance of the nodes from a plane, or from a line, over that from the middle: below this a patch is flat, or a line.
const FLAT: f64 = 1e-9;

/// The vector of the skew part of a matrix, twice.
fn axial(a: &Matrix3<f64>) -> Vector3<f64> {
    Vector3::new(a[(2, 1)] - a[(1, 2)], a[(0, 2)] - a[(2, 0)], a[(1, 0)] - a[(0, 1)])
}

/// Two unit vectors across a third one, right-handed before it.
fn across(normal: &Vector3<f64>) -> [Vector3<f64>; 2] {
    let axis = Vector3::ith(normal.iamin(), 1.0);
    let a = axis.cross(normal).normalize();
    [a, normal.cross(&a)]
}

impl Keyed for PatchTurn {
    fn key(&self, key: Key) -> Key {
        let key = key.of("patch turn", 1).with("rest", &self.rest).with("modes", &self.modes.len());
        self.modes.iter().fold(key, |key, q| key.with("mode", q))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nodes_on_a_line_have_no_turn() {
        let along = Vector3::new(0.3, -0.7, 0.2);
        let rest = [-1.0, 0.0, 1.0].iter().map(|x| along * *x * (along * *x).transpose()).sum();
        assert!(PatchTurn::new(rest, Vec::new()).is_none());
    }

    /// Closed form: of a rigid turn by φ about z, the forces on modes that turn it further are those of the moment about z, however far it
    /// has turned; of a shape that stretches it, none.
    #[test]
    fn a_moment_works_on_the_angle_however_large_it_is() {
        let nodes = [Vector3::new(1.0, 0.0, 0.0), Vector3::new(-1.0, 0.5, 0.0), Vector3::new(0.0, -0.5, 0.0)];
        for lift in [0.0, 0.3] {
            let nodes = [nodes[0] + Vector3::z() * lift, nodes[1] - Vector3::z() * lift, nodes[2]];
            let sum = |of: &dyn Fn(&Vector3<f64>) -> Vector3<f64>| -> Matrix3<f64> {
                nodes.iter().map(|d| of(d) * d.transpose()).sum()
            };
            let rest = sum(&|d| *d);
            // ξ₀ and ξ₁ are cos φ − 1 and sin φ of a turn about z.
            let modes = vec![sum(&|d| Vector3::new(d.x, d.y, 0.0)), sum(&|d| Vector3::z().cross(d))];
            let patch = PatchTurn::new(rest, modes).unwrap();
            for phi in [0.0_f64, 0.4, 1.3, 2.0] {
                let xi = [phi.cos() - 1.0, phi.sin()];
                let forces: Vec<f64> = patch.forces(&Vector3::new(0.0, 0.0, 5.0), &xi).unwrap().collect();
                let along = -phi.sin() * forces[0] + phi.cos() * forces[1];
                let stretched = phi.cos() * forces[0] + phi.sin() * forces[1];
                // Of nodes out of the plane, a stretch in it turns the best fit about other axes.
                let is_still = lift > 0.0 || stretched.abs() < 1e-12;
                assert!((along - 5.0).abs() < 1e-12 && is_still, "{phi}: {along} {stretched}");
            }
        }
    }
}
