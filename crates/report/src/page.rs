//! The page: a report inside the built program of `web/`.

use std::path::Path;

use diagnostic::Failure;
use serde::Serialize;
use whole_file::write_whole;

use crate::RunPage;
use crate::check::check;
use crate::data::Data;
use crate::error::not_written;

/// The page that `./dev report-page` builds from `web/src`.
const PAGE: &str = include_str!("../web/page.html");

/// Where the data stand in the page.
const PLACE: &str = "\"the data of the report\"";

/// The page as one text.
///
/// Long runs are thinned so that the page stays small: of the motion evenly spread rows are kept, of the histories the
/// least and the greatest value of each range of rows. Shapes are written in steps of 1/32767 of their peak, stresses in steps of
/// 1/2047, the rest in single precision; all of it is packed.
///
/// # Errors
/// Lists that do not fit together, numbers that are not finite, more than 256 shapes.
pub fn html(report: &RunPage) -> Result<String, Failure> {
    check(report)?;
    Ok(filled(PAGE, PLACE, &Data::new(report)))
}

/// A page with its data in their place.
pub(crate) fn filled(page: &str, place: &str, data: &impl Serialize) -> String {
    // Strings and finite numbers: they can all be written.
    let json = serde_json::to_string(data).unwrap_or_default();
    // A text of the user could otherwise end the script that holds the data.
    page.replacen(place, &json.replace('<', "\\u003c"), 1)
}

/// Writes the page to `path`, whole or not at all.
///
/// # Errors
/// Errors of [`html`], and of the system.
pub fn write(report: &RunPage, path: &Path) -> Result<(), Failure> {
    write_whole(path, html(report)?).map_err(|error| not_written(path, &error))
}
