//! Files that commands read and write.

pub mod given_file;
pub(crate) mod identity;
pub(crate) mod json;
pub mod outputs;
pub(crate) mod results_path;
pub(crate) mod scene_file;
pub mod write_error;
