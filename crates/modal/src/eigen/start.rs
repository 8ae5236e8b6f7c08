//! A first guess from the geometry: displacement fields that are polynomials of degree two.
//!
//! Rayleigh–Ritz on the six linear and eighteen quadratic ones that strain the body bounds the first flexible eigenvalue
//! from above (bending of a slender body is nearly quadratic). That gives the shift its scale, whatever the units.

use faer::Mat;
use nalgebra::Vector3;

use crate::eigen::polynomials::{Field, Polynomials, rigid_field, straining_fields};
use crate::error::ModalError;
use crate::matrix::dense::symmetric_eigen;
use crate::matrix::mass_matrix::MassMatrix;
use crate::matrix::stiffness::StiffnessMatrix;
use crate::matrix::tall;
use crate::support::rigid::RigidModes;
use crate::support::rigid_fields::rigid_fields;
use reduced_body::ReducedBody;
use reduced_body::RigidMotion;

/// Directions of the Gram matrix below this are taken for dependent.
const DEPENDENT: f64 = 1e-10;

/// The shift of a held body is this part of the estimate for the free body: a clamp at one end lowers the first
/// eigenvalue of a bar to (3.516/22.37)² = 0.025 of the free one's, a support elsewhere to less of a change. A shift far
/// above the eigenvalues costs iterations, one below them nothing.
const HELD: f64 = 0.02;

/// The shift s: about the first flexible eigenvalue, whatever holds the body.
pub(crate) fn shift(
    stiffness: StiffnessMatrix<'_>,
    mass: &MassMatrix<'_>,
    positions: &[[f64; 3]],
    rigid: &RigidModes,
) -> Result<f64, ModalError> {
    let center = &rigid.center_of_mass;
    if rigid.motion.is_free() {
        return eigenvalue_estimate(stiffness, mass, positions, center, &rigid.shapes);
    }
    let free = match mass {
        MassMatrix::Nodal(_) => RigidModes::new(mass, positions, RigidMotion::free())?.shapes,
        MassMatrix::General(_) => orthonormal_motions(mass, positions, center)?,
    };
    Ok(HELD * eigenvalue_estimate(stiffness, mass, positions, center, &free)?)
}

/// An M-orthonormal basis of the rigid motions, without those that meet no mass.
fn orthonormal_motions(
    mass: &MassMatrix<'_>,
    positions: &[[f64; 3]],
    center: &Vector3<f64>,
) -> Result<Mat<f64>, ModalError> {
    let fields = rigid_fields(positions, center, mass.dofs());
    let gram = tall::inner(fields.as_ref(), mass.product(fields.as_ref()).as_ref());
    Ok(tall::product(fields.as_ref(), independent(&gram)?.as_ref()))
}

/// Orthonormal combinations (size × k) of fields with this Gram matrix, without those that depend on others.
fn independent(gram: &Mat<f64>) -> Result<Mat<f64>, ModalError> {
    let size = gram.nrows();
    let unit = |i: usize| if gram[(i, i)] > 0.0 { 1.0 / gram[(i, i)].sqrt() } else { 0.0 };
    let scaled = Mat::from_fn(size, size, |i, j| gram[(i, j)] * unit(i) * unit(j));
    let (values, vectors) = symmetric_eigen(&scaled)?;
    let largest = values.iter().copied().fold(0.0, f64::max);
    let kept: Vec<usize> = (0..size).filter(|k| values[*k] > DEPENDENT * largest).collect();
    Ok(Mat::from_fn(size, kept.len(), |i, j| unit(i) * vectors[(i, kept[j])] / values[kept[j]].sqrt()))
}

/// The lowest Rayleigh–Ritz value of the polynomial fields, of the body without supports.
fn eigenvalue_estimate(
    stiffness: StiffnessMatrix<'_>,
    mass: &MassMatrix<'_>,
    positions: &[[f64; 3]],
    center: &Vector3<f64>,
    rigid: &Mat<f64>,
) -> Result<f64, ModalError> {
    let fields = polynomial_fields(positions, center, mass.dofs());
    let k_fields = stiffness.product(fields.as_ref());
    let m_fields = mass.product(fields.as_ref());
    let stiffness = tall::inner(fields.as_ref(), k_fields.as_ref());
    let gram = tall::inner(fields.as_ref(), m_fields.as_ref());
    let coupling = tall::inner(rigid.as_ref(), m_fields.as_ref());
    lowest(&stiffness, gram, &coupling)
}

/// The same from the polynomials themselves, of positions from the centre of mass.
pub(crate) fn shift_of(polynomials: &Polynomials, motion: &RigidMotion) -> Result<f64, ModalError> {
    let fields = straining_fields();
    let unit = |axis: usize| Vector3::ith(axis, 1.0);
    let motions: [Field; 6] = std::array::from_fn(|k| {
        if k < 3 { rigid_field(&unit(k), &Vector3::zeros()) } else { rigid_field(&Vector3::zeros(), &unit(k - 3)) }
    });
    let orthonormal = independent(&polynomials.mass_of(&motions, &motions))?;
    let coupling = orthonormal.transpose() * polynomials.mass_of(&motions, &fields);
    let gram = polynomials.mass_of(&fields, &fields);
    let estimate = lowest(&polynomials.stiffness_of(&fields), gram, &coupling)?;
    Ok(if motion.is_free() { estimate } else { HELD * estimate })
}

/// The lowest Rayleigh–Ritz value of fields with these matrices, `coupling` their products with an orthonormal basis of the
/// rigid motions.
fn lowest(stiffness: &Mat<f64>, gram: Mat<f64>, coupling: &Mat<f64>) -> Result<f64, ModalError> {
    // Rigid parts are taken out of the Gram matrix; K has none of them to begin with.
    let gram = gram - coupling.transpose() * coupling;
    let whitened = independent(&gram)?;
    let projected = whitened.transpose() * stiffness * &whitened;
    let (ritz, _) = symmetric_eigen(&projected)?;
    // A mechanism may hide among the polynomials with no energy at all; the scale is that of those with some.
    let scale = ritz.iter().copied().fold(0.0, f64::max);
    Ok(ritz.into_iter().filter(|value| *value > 1e-12 * scale).fold(scale, f64::min))
}

/// Number of polynomial fields: three passes over K at eight vectors each.
const FIELDS: usize = 24;

/// The linear fields `x_a e_b + x_b e_a` and the quadratic ones `x_a x_b e_c`; rotations are half the curl (N×24).
fn polynomial_fields(positions: &[[f64; 3]], center: &Vector3<f64>, dofs: usize) -> Mat<f64> {
    let mut fields = Mat::zeros(dofs * positions.len(), FIELDS);
    for (node, position) in positions.iter().enumerate() {
        let x = Vector3::from(*position) - center;
        for (pair, (a, b)) in ReducedBody::PAIRS.into_iter().enumerate() {
            fields[(dofs * node + a, pair)] += x[b];
            fields[(dofs * node + b, pair)] += x[a];
            for axis in 0..3 {
                let field = 6 + 3 * pair + axis;
                fields[(dofs * node + axis, field)] = x[a] * x[b];
                if dofs == 6 {
                    // The curl of f e is ∇f × e.
                    let gradient = Vector3::ith(a, x[b]) + Vector3::ith(b, x[a]);
                    let rotation = 0.5 * gradient.cross(&Vector3::ith(axis, 1.0));
                    (0..3).for_each(|i| fields[(6 * node + 3 + i, field)] = rotation[i]);
                }
            }
        }
    }
    fields
}
