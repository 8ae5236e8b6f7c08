//! The check by the full body, held against the truth: its estimate over the error that a model really has.
//!
//! A pair is a case and a model of it. The model comes to its rest, or to its rest in a steady spin, by Newton's iteration on its
//! coordinates; the truth is the full body under the same loads, by the mixed iteration to its end.

mod cases;
mod motions;
mod page;
mod pairs;
mod random;
mod rest;

pub use cases::{CheckedCase, MODELS, Truth, cases};
pub use motions::{LetGo, MotionRow, let_go, motions};
pub use page::page;
pub use pairs::{CaseInModel, pair, pairs};
pub use random::random_cases;
