//! Bodies that bend far or are stretched.

mod backbones;
mod driven;
mod large;
mod manifold;
mod stretch;
