//! Reports of commands, and the pages of runs.
//!
//! * [`Report`] has all that a command found, as data: values by their paths, lines, [`Table`]s, [`Curves`] and charts. It becomes text, JSON,
//!   CSV, figures and a page in one way, for every command.
//! * [`RunPage`] is one HTML page with everything about a run, which opens without a network: the surfaces of the bodies, their mode shapes,
//!   the rows of their motion, histories and balances, and words. [`html`] and [`write()`] check it and put it into the page, whose program (in
//!   `web/`) draws it.

#![forbid(unsafe_code)]
#![cfg_attr(not(test), warn(clippy::unwrap_used, clippy::expect_used, clippy::panic, clippy::unreachable))]

mod check;
mod curves;
mod data;
mod error;
mod numbers;
mod packed;
mod page;
mod peak;
mod report;
mod run_page;
mod table;
mod thin;
mod value;

pub use curves::{Chart, Curve, Curves, PageWords};
pub use page::{html, write};
pub use report::{File, Report};
pub use run_page::{
    Compared, Component, Control, Effect, Fact, Live, LiveBody, PageBalance, PageBody, PageHistory, PageMotion,
    PageStress, PageSurface, PageTrustLine, PageUnits, RunPage, RunState, SceneText, Shape, ShapeKind, Trust,
};
pub use table::{Form, Table, quantity, quoted};
pub use value::{Value, at_path};
