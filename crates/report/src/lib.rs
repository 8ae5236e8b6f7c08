//! One HTML page with everything about a run, which opens without a network.
//!
//! [`Report`] is plain data: the surfaces of the bodies, their mode shapes, the rows of their motion, histories and balances,
//! and words. [`html`] and [`write()`] check it and put it into the page, whose program (in `web/`) draws it. [`Responses`] are a page of
//! answers over the frequency.

#![forbid(unsafe_code)]
#![cfg_attr(not(test), warn(clippy::unwrap_used, clippy::expect_used, clippy::panic, clippy::unreachable))]

mod check;
mod data;
mod error;
mod numbers;
mod packed;
mod page;
mod peak;
mod report;
mod responses;
mod thin;

pub use error::ReportError;
pub use page::{html, write};
pub use report::{
    Compared, Component, Control, Effect, Fact, Live, LiveBody, PageBalance, PageBody, PageHistory, PageMotion,
    PageStress, PageSurface, PageTrustLine, PageUnits, Report, RunState, SceneText, Shape, ShapeKind, Trust,
};
pub use responses::{Chart, Curve, Responses};
