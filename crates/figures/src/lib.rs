//! Figures: line charts, deformed bodies and animations, as SVG, PDF, PNG and GIF.
//!
//! * [`LineChart`], [`ChartStack`], [`ChartGrid`], [`ShapeGrid`] and [`Animation`] draw figures and write their files.
//! * [`facets()`] and [`sharp_edges`] turn the surface of a mesh into what the figures draw.
//!
//! The crate knows plain data only: no mesh, no mode, no results file.

#![forbid(unsafe_code)]
#![cfg_attr(not(test), warn(clippy::unwrap_used, clippy::expect_used, clippy::panic, clippy::unreachable))]

mod body;
mod chart;
mod document;
mod error;

pub use body::animation::{Animation, FilmFrame};
pub use body::shapes::{Panel, ShapeGrid};
pub use body::surface::{facets, sharp_edges};
pub use body::view::View;
pub use chart::axis::Scale;
pub use chart::grid::ChartGrid;
pub use chart::lines::{LineChart, Reference};
pub use chart::series::{Series, Stroke};
pub use chart::stack::ChartStack;
pub use document::formats::files;
pub use error::FigureError;
