//! The stress of a body about a bent reference u₀.
//!
//! ```text
//! S = S₀ + C:sym(F₀ᵀ∇u) + …        F₀ = 1 + ∇u₀,   S₀ = C:E(u₀)
//! ```
//!
//! Terms beyond the linear ones are those about the undeformed body.

use faer::{Mat, MatRef};
use fem_tet10::{AssemblyError, StressRecovery};

/// The stress (6m×(k+1)) of small displacements (3n×k) of a bent reference (3n×1), and after them that of the reference itself.
///
/// # Errors
/// [`AssemblyError`].
pub fn stress_about(
    recovery: &StressRecovery<'_>,
    reference: MatRef<'_, f64>,
    displacements: MatRef<'_, f64>,
) -> Result<Mat<f64>, AssemblyError> {
    let count = displacements.ncols();
    let fields =
        Mat::from_fn(
            reference.nrows(),
            count + 1,
            |i, j| {
                if j < count { displacements[(i, j)] } else { reference[(i, 0)] }
            },
        );
    let pairs: Vec<[usize; 2]> = (0..=count).map(|k| [k, count]).collect();
    let linear = recovery.nodal_stress(fields.as_ref())?;
    // C:½ sym(∇aᵀ∇b) of each pair; both orders of two different fields.
    let of_pairs = recovery.second_order_nodal_stress(fields.as_ref(), &pairs)?;
    let times = |k: usize| if k < count { 2.0 } else { 1.0 };
    Ok(Mat::from_fn(linear.nrows(), count + 1, |i, k| linear[(i, k)] + times(k) * of_pairs[(i, k)]))
}
