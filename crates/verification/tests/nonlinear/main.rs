//! flexframe against nonlinear finite elements and closed forms. One program, so that it is linked once.

mod elastica;
mod energy;
mod l;
mod once;
mod oracle;
mod pinned;
mod plate;
mod pressure;
mod rods;
