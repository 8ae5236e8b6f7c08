//! A nonlinear finite-element body to hold flexframe's modes against: nothing of it is in the program.
//!
//! * [`Solid`]: a total Lagrangian St. Venant–Kirchhoff body of second-order tetrahedra.
//! * [`SolidMotion`]: its motion by the energy–momentum midpoint rule of Simo and Tarnow.
//! * [`Solid::at_rest`], [`Solid::held_in_modes`]: its static responses.
//! * [`Solid::pressure`]: a pressure that follows its surface, exactly.
//! * [`mean_axes()`]: the frame of the linear modes in its motion.
//! * [`bodies`], [`cases`]: bodies, and what is compared on them.

pub mod bodies;
pub mod cases;
mod error;
mod mean_axes;
mod motion;
mod pressure;
pub mod signal;
mod solid;
mod statics;

pub use error::SolidError;
pub use mean_axes::{MeanAxes, mean_axes};
pub use motion::{NodalState, SolidMotion};
pub use solid::{Factor, Solid, product};
