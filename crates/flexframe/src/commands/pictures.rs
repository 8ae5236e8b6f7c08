//! Pictures: moving ones, shapes of modes, pages about runs.

pub mod animation;
pub mod html_report;
pub mod mode_shapes;
