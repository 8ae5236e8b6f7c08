//! Bodies that are assembled once, kept from run to run, or read from a file.

mod assembly;
mod body_file;
mod cache;
mod pools;
mod work;
