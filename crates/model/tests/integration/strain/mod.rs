//! Bodies that bend far or are stretched.

mod backbones;
mod large;
mod manifold;
mod stretch;
