//! Values of Python as those of Rust, and back.

pub(crate) mod arrays;
pub(crate) mod constants;
pub(crate) mod dict;
pub(crate) mod html;
pub(crate) mod numbers;
