//! Rates of what a body does with the numbers that it is made with: Eqs. (D1)–(D10), (D17) and (D18) of `docs/method/gradients.md`.

mod at;
pub(crate) mod in_joints;
pub(crate) mod load_rates;
pub(crate) mod parameter;
pub(crate) mod rates;
pub(crate) mod varied;
