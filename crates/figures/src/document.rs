//! Files of a figure.

pub(crate) mod font;
pub(crate) mod formats;
pub(crate) mod pdf;
pub(crate) mod picture;
