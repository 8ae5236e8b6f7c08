//! The search for modes in a Krylov space, and engines that take its place.

pub(crate) mod engine;
pub(crate) mod lanczos;
pub(crate) mod outside;
pub(crate) mod polynomials;
pub(crate) mod ritz;
pub(crate) mod start;
pub(crate) mod svqb;
