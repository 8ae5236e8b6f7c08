//! Lines of tables in CSV files.

use std::io::{self, Read};
use std::path::Path;

use foreign_program::open_ordinary;

/// The lines of a table with their numbers, without empty ones and those that begin with `#`.
pub(super) fn lines(path: &Path) -> io::Result<Vec<(usize, String)>> {
    let mut text = String::new();
    open_ordinary(path)?.read_to_string(&mut text)?;
    let lines = (1..).zip(text.trim_start_matches('\u{feff}').lines().map(str::trim));
    let lines = lines.filter(|(_, content)| !content.is_empty() && !content.starts_with('#'));
    Ok(lines.map(|(line, content)| (line, content.to_owned())).collect())
}
