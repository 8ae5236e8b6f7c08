//! Scenes, meshes, matrices and paths that the program is given, and what it says of them.

pub(crate) mod canary;
pub(crate) mod children;
pub(crate) mod command_line;
pub(crate) mod decks;
pub(crate) mod failures;
pub(crate) mod files_opened;
pub(crate) mod files_read;
pub(crate) mod import;
pub(crate) mod matrices;
pub(crate) mod measured;
pub(crate) mod newcomer;
pub(crate) mod outputs;
pub(crate) mod scene_input;
pub(crate) mod warnings;
