//! The points of a table in CSV: the one reader of all tables over time.

/// A line of a table that is no point, or a table without two of them.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("found {found}, expected {expected}\n = {help}")]
pub struct PointsError {
    /// The line of the text, counted from 1.
    pub line: usize,
    /// Content of the line.
    pub found: String,
    /// The content that a table has there.
    pub expected: &'static str,
    /// The cure.
    pub help: &'static str,
}

/// The points of a CSV text with their lines: two columns of numbers with a comma between them, time and value, the times rising,
/// two points or more. The first line may name the columns; empty lines and those that begin with `#` are left out.
///
/// # Errors
/// [`PointsError`].
pub fn points_of(text: &str) -> Result<Vec<(usize, [f64; 2])>, PointsError> {
    let text = text.strip_prefix('\u{feff}').unwrap_or(text);
    let mut points: Vec<(usize, [f64; 2])> = Vec::new();
    let mut is_first = true;
    // Numbers need no quotes, and a library for CSV loses the line where comments stand before it.
    let lines = (1..).zip(text.lines().map(str::trim));
    for (line, content) in lines.filter(|(_, content)| !content.is_empty() && !content.starts_with('#')) {
        let numbers: Vec<Option<f64>> = content.split(',').map(|field| field.trim().parse().ok()).collect();
        let names_columns = is_first && numbers.iter().all(Option::is_none);
        is_first = false;
        match (&numbers[..], points.last()) {
            _ if names_columns => {}
            (&[Some(time), Some(_)], Some(&(_, [before, _]))) if time <= before => {
                return Err(PointsError {
                    line,
                    found: format!("the time {time:?} after {before:?}"),
                    expected: "times that rise from line to line",
                    help: "put the lines in order, each time once",
                });
            }
            (&[Some(time), Some(value)], _) if time.is_finite() && value.is_finite() => {
                points.push((line, [time, value]));
            }
            _ => {
                let count = numbers.iter().flatten().filter(|number| number.is_finite()).count();
                return Err(PointsError {
                    line,
                    found: format!("{} field(s), {count} of them finite numbers", numbers.len()),
                    expected: "two finite numbers, time and value, with a comma between them",
                    help: "correct the line; only the first may name the columns, and lines that begin with # are left out",
                });
            }
        }
    }
    if points.len() < 2 {
        return Err(PointsError {
            line: 1,
            found: format!("{} pairs of time and value", points.len()),
            expected: "two or more",
            help: "write a line `time,value` for each point",
        });
    }
    Ok(points)
}
