//! Figures: line charts, deformed bodies and animations, as SVG, PDF, PNG and GIF.
//!
//! * [`LineChart`], [`ChartGrid`], [`ShapeGrid`] and [`Animation`] draw figures and write their files.
//! * [`facets()`] and [`sharp_edges`] turn the surface of a mesh into what the figures draw.
//!
//! The crate knows plain data only: no mesh, no mode, no results file.

#![forbid(unsafe_code)]
#![cfg_attr(not(test), warn(clippy::unwrap_used, clippy::expect_used, clippy::panic, clippy::unreachable))]

mod animation;
mod axis;
mod chart;
mod chart_grid;
mod error;
mod facets;
mod font;
mod formats;
mod inset;
mod key;
mod path;
mod pdf;
mod picture;
mod plot;
mod render;
mod series;
mod shapes;
mod surface;
mod view;

#[cfg(test)]
mod test_body;

pub use animation::{Animation, Frame};
pub use axis::Scale;
pub use chart::{LineChart, Reference};
pub use chart_grid::ChartGrid;
pub use error::FigureError;
pub use formats::files;
pub use series::{Series, Stroke};
pub use shapes::{Panel, ShapeGrid};
pub use surface::{facets, sharp_edges};
pub use view::View;
