//! OP4 of Nastran, as text.

use std::fmt::Write;

use super::craig_bampton::{DOUBLE, Named};

/// Digits of a number after its point, its length, and numbers in a line: all digits of a double.
const FORMAT: &str = "1P,3E23.16";
const PER_LINE: usize = 3;

/// The text of the file: of each matrix a head, then for each column that is not zero its first row and its numbers from there, then one
/// column more.
pub fn text(matrices: &[Named]) -> String {
    let mut text = String::new();
    for of in matrices {
        let Named { name, matrix, form } = of;
        let (rows, columns) = (matrix.nrows(), matrix.ncols());
        // Writing to a text does not fail.
        _ = writeln!(text, "{columns:8}{rows:8}{form:8}{DOUBLE:8}{name:8}{FORMAT}");
        for (c, (first, column)) in (0..columns).filter_map(|c| Some((c, of.filled(c)?))) {
            _ = writeln!(text, "{:8}{:8}{:8}", c + 1, first + 1, column.len());
            let numbers: Vec<String> = column.into_iter().map(number).collect();
            numbers.chunks(PER_LINE).for_each(|line| _ = writeln!(text, "{}", line.concat()));
        }
        _ = writeln!(text, "{:8}{:8}{:8}\n{}", columns + 1, 1, 1, number(1.0));
    }
    text
}

/// A number as Fortran's 1P,E23.16 writes it.
fn number(value: f64) -> String {
    let text = format!("{value:.16E}");
    let (mantissa, exponent) = text.split_once('E').unwrap_or((&text, "0"));
    let (sign, digits) = exponent.strip_prefix('-').map_or(('+', exponent), |digits| ('-', digits));
    let exponent = if digits.len() > 2 { format!("{sign}{digits}") } else { format!("E{sign}{digits:0>2}") };
    format!("{:>23}", format!("{mantissa}{exponent}"))
}
