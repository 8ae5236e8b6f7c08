//! `docs/evidence/accuracy.md`: what accuracy costs on some scenes, from measured runs.

mod page;

pub use page::accuracy_page;
