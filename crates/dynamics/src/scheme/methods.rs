//! The schemes of the conservative form.

use crate::scheme::conservative_motion;
use crate::scheme::setup::Method;

impl Method {
    /// The conservative form by classical Runge–Kutta.
    pub const RKMK4: Self = conservative_motion::RKMK4;
    /// The conservative form by the exponential scheme: the default.
    pub const EXPONENTIAL: Self = conservative_motion::EXPONENTIAL;
}
