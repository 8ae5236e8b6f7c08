//! Bodies that steady spins and loads bend far, against the full nonlinear body of the same mesh.

mod bodies;
mod manifold;
mod reference;
mod stress;
