//! Systems of bodies in joints against joined meshes. One program, so that it is linked once.

mod bent;
mod bent_linear;
mod four_bar;
mod hinged;
mod princeton;
mod shaft;
mod welded;
