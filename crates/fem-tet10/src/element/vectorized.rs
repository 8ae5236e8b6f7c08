//! Loops compiled for the vector instructions that the processor has.

use pulp::{Arch, Simd, WithSimd};

/// Calls a function, which is to be a closure that is `#[inline(always)]`: whatever is not inlined is compiled for any
/// processor of the kind. (pulp takes closures itself, but calls them through a shim that the compiler does not always inline.)
pub(crate) fn vectorized(function: impl FnMut()) {
    Arch::new().dispatch(Inlined(function));
}

struct Inlined<F>(F);

impl<F: FnMut()> WithSimd for Inlined<F> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(mut self, _: S) {
        (self.0)();
    }
}
