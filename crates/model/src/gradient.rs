//! Rates of what a body does with the numbers that it is made with: Eqs. (G1) to (G11) of `docs/method/gradients.md`.

pub(crate) mod parameter;
pub(crate) mod rates;
pub(crate) mod varied;
