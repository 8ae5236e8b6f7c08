//! A first guess from the geometry: displacement fields that are polynomials of degree two.
//!
//! Rayleigh–Ritz on the six linear and eighteen quadratic ones that strain the body bounds the first flexible eigenvalue
//! from above (bending of a slender body is nearly quadratic). That gives the shift its scale, whatever the units.

use faer::Mat;
use faer::sparse::SparseColMatRef;
use nalgebra::Vector3;

use crate::dense::symmetric_eigen;
use crate::error::ModalError;
use crate::mass::NodalMass;
use crate::pairs::PAIRS;
use crate::products::symmetric_product;
use crate::rigid::RigidModes;
use crate::support::RigidMotion;
use crate::tall;

/// Directions of the Gram matrix below this are taken for dependent.
const DEPENDENT: f64 = 1e-10;

/// Of a body that is held, the shift is this part of the estimate for the free body: a clamp at one end lowers the first
/// eigenvalue of a bar to (3.516/22.37)² = 0.025 of the free one's, a support elsewhere to less of a change. A shift far
/// above the eigenvalues costs iterations, one below them nothing.
const HELD: f64 = 0.02;

/// The shift s: about the first flexible eigenvalue, whatever holds the body.
pub(crate) fn shift(
    stiffness: SparseColMatRef<'_, usize, f64>,
    mass: &NodalMass,
    positions: &[[f64; 3]],
    rigid: &RigidModes,
) -> Result<f64, ModalError> {
    if rigid.motion.is_free() {
        return eigenvalue_estimate(stiffness, mass, positions, rigid);
    }
    let free = RigidModes::new(mass, positions, RigidMotion::free())?;
    Ok(HELD * eigenvalue_estimate(stiffness, mass, positions, &free)?)
}

/// The lowest Rayleigh–Ritz value of the polynomial fields, of the body without supports.
fn eigenvalue_estimate(
    stiffness: SparseColMatRef<'_, usize, f64>,
    mass: &NodalMass,
    positions: &[[f64; 3]],
    rigid: &RigidModes,
) -> Result<f64, ModalError> {
    let fields = polynomial_fields(positions, rigid);
    let k_fields = symmetric_product(stiffness, fields.as_ref());
    let m_fields = mass.product(fields.as_ref());
    let stiffness = tall::inner(fields.as_ref(), k_fields.as_ref());
    let gram = tall::inner(fields.as_ref(), m_fields.as_ref());
    let coupling = tall::inner(rigid.shapes.as_ref(), m_fields.as_ref());

    // Rigid parts are taken out of the Gram matrix; K has none of them to begin with.
    let gram = gram - coupling.transpose() * &coupling;
    let unit = |i: usize| if gram[(i, i)] > 0.0 { 1.0 / gram[(i, i)].sqrt() } else { 0.0 };
    let scaled = |matrix: &Mat<f64>| Mat::from_fn(FIELDS, FIELDS, |i, j| matrix[(i, j)] * unit(i) * unit(j));
    let (stiffness, gram) = (scaled(&stiffness), scaled(&gram));
    let (values, vectors) = symmetric_eigen(&gram)?;
    let largest = values.iter().copied().fold(0.0, f64::max);
    let kept: Vec<usize> = (0..values.len()).filter(|i| values[*i] > DEPENDENT * largest).collect();
    let whitened = Mat::from_fn(gram.nrows(), kept.len(), |i, j| vectors[(i, kept[j])] / values[kept[j]].sqrt());
    let projected = whitened.transpose() * &stiffness * &whitened;
    let (ritz, _) = symmetric_eigen(&projected)?;
    // A mechanism may hide among the polynomials with no energy at all; the scale is that of those with some.
    let scale = ritz.iter().copied().fold(0.0, f64::max);
    Ok(ritz.into_iter().filter(|value| *value > 1e-12 * scale).fold(scale, f64::min))
}

/// Number of polynomial fields: three passes over K at eight vectors each.
const FIELDS: usize = 24;

/// The linear fields `x_a e_b + x_b e_a` and the quadratic ones `x_a x_b e_c` (3n×24).
fn polynomial_fields(positions: &[[f64; 3]], rigid: &RigidModes) -> Mat<f64> {
    let mut fields = Mat::zeros(3 * positions.len(), FIELDS);
    for (node, position) in positions.iter().enumerate() {
        let x = Vector3::from(*position) - rigid.center_of_mass;
        for (pair, (a, b)) in PAIRS.into_iter().enumerate() {
            fields[(3 * node + a, pair)] += x[b];
            fields[(3 * node + b, pair)] += x[a];
            for axis in 0..3 {
                fields[(3 * node + axis, 6 + 3 * pair + axis)] = x[a] * x[b];
            }
        }
    }
    fields
}
