//! Systems of bodies in joints against joined meshes. One program, so that it is linked once.

mod hinged;
mod welded;
