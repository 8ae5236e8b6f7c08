//! Systems of bodies in joints, against bodies without any: a joined mesh, a whole in the place of welded parts.
//!
//! * [`meshes`]: boxes of elements, alone and joined along lines of nodes, and their files.
//! * [`run`]: systems of scenes, run.
//! * [`hinged`]: bars hinged along shared lines of nodes, against nonlinear finite elements of the joined mesh.
//! * [`welded`]: frequencies of bodies in welds.

pub mod hinged;
pub mod meshes;
pub mod run;
pub mod welded;
