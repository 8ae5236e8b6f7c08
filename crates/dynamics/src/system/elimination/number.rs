//! Numbers of the structured elimination.

use nalgebra::ComplexField;

/// A number of the structured elimination, real or complex.
pub(crate) trait Number: ComplexField<RealField = f64> + Copy {}
impl<T: ComplexField<RealField = f64> + Copy> Number for T {}
