//! `flexframe export`: a results file as a table, and its motion as fields for ParaView.

mod csv;
mod fields;
mod motion;
mod paraview;
mod rows;

use std::path::PathBuf;

pub use csv::{csv_text, export_csv};
pub use motion::DrawnMotion;
pub use paraview::{export_modes, export_vtkhdf, export_vtu};
pub use rows::ExportRows;
pub(crate) use rows::{no_elements, no_rows};

/// Files of an export.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Exported {
    /// The files.
    pub files: Vec<PathBuf>,
    /// Warning about them: that the run is unfinished.
    pub warning: Option<String>,
}
