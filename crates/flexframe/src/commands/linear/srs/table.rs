//! The base motion in a CSV file: two columns, time and acceleration.

use std::path::Path;

use shock::BaseMotion;

use super::error::SrsError;
use crate::commands::linear::table;

/// Reads a base motion. The first line may name the columns; empty lines and those that begin with `#` are left out.
pub(in crate::commands::linear) fn read(path: &Path) -> Result<BaseMotion, SrsError> {
    let unreadable = |source| SrsError::Unreadable { path: path.to_owned(), source };
    let (mut times, mut accelerations): (Vec<f64>, Vec<f64>) = (Vec::new(), Vec::new());
    let mut is_first = true;
    for (line, content) in table::lines(path).map_err(unreadable)? {
        let fields: Vec<Option<f64>> = content.split(',').map(|field| field.trim().parse().ok()).collect();
        let names_columns = is_first && fields.iter().all(Option::is_none);
        is_first = false;
        match fields[..] {
            _ if names_columns => {}
            [Some(time), Some(acceleration)] if time.is_finite() && acceleration.is_finite() => {
                if let Some(before) = times.last().copied().filter(|before| time <= *before) {
                    return Err(SrsError::Order { path: path.to_owned(), line, before, time });
                }
                times.push(time);
                accelerations.push(acceleration);
            }
            _ => {
                let count = fields.iter().flatten().filter(|number| number.is_finite()).count();
                let found = format!("{} field(s), {count} of them finite numbers", fields.len());
                return Err(SrsError::Line { path: path.to_owned(), line, found });
            }
        }
    }
    BaseMotion::new(times, accelerations).map_err(|source| SrsError::Shock { table: path.to_owned(), source })
}
