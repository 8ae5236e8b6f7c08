//! Each part of the scene file is what the scene holds, or is refused.

use crate::common;
mod constraints;
mod effects;
mod histories;
mod loads;
mod modes;
mod rigid;

use scene::Body;

/// The lines of the example from the section `from` up to the section `to`.
fn section(from: &str, to: &str) -> &'static str {
    &common::EXAMPLE[common::EXAMPLE.find(from).unwrap()..common::EXAMPLE.find(to).unwrap()]
}

/// The example with the section from `from` up to `to` replaced.
fn with(from: &str, to: &str, new: &str) -> Body {
    let text = common::EXAMPLE.replace(section(from, to), &format!("{new}\n"));
    Body::parse(&text, "dir/plate.toml").unwrap_or_else(|error| panic!("{new}: {error}"))
}

/// Asserts that the section from `from` up to `to` of the example, replaced by `new`, is refused at `mark`, for `key`,
/// with `words`.
#[track_caller]
fn refused(from: &str, to: &str, new: &str, mark: &str, key: &str, words: &[&str]) {
    crate::common::refused(section(from, to), &format!("{new}\n\n"), mark, key, words);
}
