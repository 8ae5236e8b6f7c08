//! Bodies that steady spins and loads bend far, against the full nonlinear body of the same mesh.

mod bodies;
mod free;
mod limits;
mod manifold;
mod reference;
mod stress;
