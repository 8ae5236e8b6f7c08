//! Tables, pages and pictures of runs.

pub mod animate;
pub mod export;
pub mod play;
pub mod report;
