//! A first guess from the geometry: displacement fields that are polynomials of degree two.
//!
//! Rayleigh–Ritz on these 30 fields, six of which are the rigid motions, bounds the first flexible eigenvalue from
//! above (bending of a slender body is nearly quadratic). That gives the shift its scale, whatever the units.

use faer::Mat;
use faer::sparse::SparseColMatRef;

use crate::dense::symmetric_eigen;
use crate::error::ModalError;
use crate::mass::NodalMass;
use crate::products::symmetric_product;
use crate::rigid::RigidModes;
use crate::tall;

/// Directions of the Gram matrix below this are taken for dependent.
const DEPENDENT: f64 = 1e-10;

/// The lowest Rayleigh–Ritz value of the polynomial fields.
pub(crate) fn eigenvalue_estimate(
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

/// The 30 fields `x^p y^q z^r e_k`, p + q + r ≤ 2 (3n×30), scaled so that each is one in the mean over the mass.
fn polynomial_fields(positions: &[[f64; 3]], rigid: &RigidModes) -> Mat<f64> {
    // Lengths in units of the radii of gyration, so that a slender body gives well-scaled fields.
    let inertia = rigid.inertia;
    let half_trace = 0.5 * inertia.trace();
    let radius: [f64; 3] = std::array::from_fn(|axis| ((half_trace - inertia[(axis, axis)]) / rigid.mass).sqrt());
    let scaled = |node: usize, axis: usize| {
        if radius[axis] > 0.0 { (positions[node][axis] - rigid.center_of_mass[axis]) / radius[axis] } else { 0.0 }
    };
    const POWERS: [[i32; 3]; 10] =
        [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1], [2, 0, 0], [0, 2, 0], [0, 0, 2], [1, 1, 0], [0, 1, 1], [1, 0, 1]];
    let weight = 1.0 / rigid.mass.sqrt();
    Mat::from_fn(3 * positions.len(), 30, |i, field| {
        if i % 3 != field % 3 {
            return 0.0;
        }
        let powers = POWERS[field / 3];
        (0..3).map(|axis| scaled(i / 3, axis).powi(powers[axis])).product::<f64>() * weight
    })
}
