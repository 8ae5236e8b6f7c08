//! Which effects a motion calls for: estimated before it is computed, and checked on what happened.
#![forbid(unsafe_code)]

mod case;
mod course;
mod excitation;
mod limits;
mod response;
mod review;
mod rigid;
mod row;
mod table;
mod tensor;

pub use case::{AdviceError, Case};
pub use limits::{Refusal, SOFTENED, limits};
pub use review::{Broken, Review};
pub use row::{Effect, Row, Worth};
pub use table::{Advice, advise, screen};
