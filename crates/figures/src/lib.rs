//! Figures: line charts, deformed bodies and animations, as SVG, PNG and GIF.
//!
//! * [`LineChart`], [`ShapeGrid`] and [`Animation`] draw figures and write their files.
//! * [`boundary_triangles`] and [`sharp_edges`] turn a mesh into what the figures draw.
//!
//! The crate knows plain data only: no mesh, no mode, no results file.

#![forbid(unsafe_code)]
#![cfg_attr(not(test), warn(clippy::unwrap_used, clippy::expect_used, clippy::panic, clippy::unreachable))]

mod animation;
mod axis;
mod chart;
mod error;
mod font;
mod path;
mod picture;
mod render;
mod shapes;
mod surface;
mod view;

#[cfg(test)]
mod test_body;

pub use animation::{Animation, Frame};
pub use axis::Scale;
pub use chart::{LineChart, Series, Stroke};
pub use error::FigureError;
pub use shapes::{Panel, ShapeGrid};
pub use surface::{boundary_triangles, sharp_edges};
pub use view::View;
