//! The entries of a matrix file, in the three forms that programs write.

use std::collections::HashMap;
use std::ops::ControlFlow;

use crate::error::{MatrixError, Which};
use crate::source::{Next, Source, fields, number, shown};

/// A row or a column of a matrix.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub(crate) enum Index {
    /// By its number, from 1.
    Number(u32),
    /// By its node and degree of freedom (1 to 6).
    Of { node: u64, dof: u8 },
}

impl std::fmt::Display for Index {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Number(number) => write!(f, "{number}"),
            Self::Of { node, dof } => write!(f, "node {node} degree of freedom {dof}"),
        }
    }
}

/// An entry as it stands in the file.
pub(crate) struct Written {
    pub line: usize,
    pub row: Index,
    pub column: Index,
    pub value: f64,
}

/// How a file writes a matrix.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Form {
    /// `%%MatrixMarket matrix coordinate real symmetric|general`, with its number of rows.
    MatrixMarket { symmetric: bool, size: usize },
    /// `row column value`: CalculiX, and Abaqus with FORMAT=COORDINATE.
    Triplets,
    /// `node, dof, node, dof, value`: Abaqus with FORMAT=MATRIX INPUT.
    Labelled,
}

/// An entry above this on the diagonal is Abaqus' way to hold a degree of freedom.
const HELD: f64 = 1e30;

const FORMS: &str = "a first line `%%MatrixMarket matrix coordinate real symmetric` (or `general`), or lines `row column value` \
                     (CalculiX), or lines `node, dof, node, dof, value` (Abaqus)";
const EXPORT: &str = "write the file as docs/reference/matrices.md says, from CalculiX, Abaqus or Python";

/// Calls `take` with each entry of the file, in its order, until it breaks off; returns how the file is written.
pub(crate) fn each_entry(
    source: &Source<'_>,
    mut take: impl FnMut(Form, Written) -> Result<ControlFlow<()>, MatrixError>,
) -> Result<Form, MatrixError> {
    let mut state = State::Start;
    let mut entries = 0;
    let mut is_cut = false;
    source.each_line(|line, text| {
        let form = match state {
            State::Start => match first_line(source, line, text)? {
                First::Header { symmetric } => {
                    state = State::Header { symmetric };
                    return Ok(Next::Go);
                }
                First::Comment => return Ok(Next::Go),
                First::Entry(form) => {
                    state = State::Body { form, count: None };
                    form
                }
            },
            State::Header { .. } if text.starts_with('%') => return Ok(Next::Go),
            State::Header { symmetric } => {
                let (size, count) = size_line(source, line, text)?;
                state = State::Body { form: Form::MatrixMarket { symmetric, size }, count: Some(count) };
                return Ok(Next::Go);
            }
            State::Body { form, .. } => form,
        };
        if text.starts_with("**") || (text.starts_with('%') && matches!(form, Form::MatrixMarket { .. })) {
            return Ok(Next::Go);
        }
        if let State::Body { count: Some(count), .. } = state
            && entries == count
        {
            let found = format!("more entries than the {count} that the line with the size announces");
            return Err(source.refuse(Some(line), found, "as many entries as announced", EXPORT));
        }
        entries += 1;
        if take(form, entry(source, form, line, text)?)?.is_break() {
            is_cut = true;
            return Ok(Next::Stop);
        }
        Ok(Next::Go)
    })?;
    match state {
        State::Body { count: Some(count), .. } if entries < count && !is_cut => {
            let found = format!("{entries} entries");
            let expected = format!("{count}, as the line with the size announces");
            Err(source.refuse(None, found, expected, "the file has been cut: write it again"))
        }
        State::Body { form, .. } => Ok(form),
        State::Start | State::Header { .. } => Err(source.refuse(None, "a file without entries", FORMS, EXPORT)),
    }
}

#[derive(Clone, Copy)]
enum State {
    Start,
    Header { symmetric: bool },
    Body { form: Form, count: Option<usize> },
}

enum First {
    Header { symmetric: bool },
    Comment,
    Entry(Form),
}

fn first_line(source: &Source<'_>, line: usize, text: &str) -> Result<First, MatrixError> {
    if text.starts_with("**") {
        return Ok(First::Comment);
    }
    let refuse = |help: &str| Err(source.refuse(Some(line), shown(text), FORMS, help));
    if text.starts_with('%') {
        let words: Vec<String> = text.split_whitespace().map(str::to_lowercase).collect();
        let words: Vec<&str> = words.iter().map(String::as_str).collect();
        return match words[..] {
            ["%%matrixmarket", "matrix", "coordinate", "real" | "integer" | "double", symmetry] => match symmetry {
                "symmetric" => Ok(First::Header { symmetric: true }),
                "general" => Ok(First::Header { symmetric: false }),
                _ => refuse("write the symmetric matrix of a structure without damping and gyroscopic terms"),
            },
            ["%%matrixmarket", "matrix", "array", ..] => refuse(
                "write it as a sparse matrix: scipy.io.mmwrite(name, scipy.sparse.csc_matrix(A), symmetry=\"symmetric\")",
            ),
            ["%%matrixmarket", "matrix", "coordinate", "complex" | "pattern", ..] => {
                refuse("write a matrix of real numbers: scipy.io.mmwrite(name, A.real)")
            }
            _ => refuse(EXPORT),
        };
    }
    match fields(text).len() {
        3 => Ok(First::Entry(Form::Triplets)),
        5 => Ok(First::Entry(Form::Labelled)),
        _ => refuse(EXPORT),
    }
}

/// Rows and entries of a Matrix Market file.
fn size_line(source: &Source<'_>, line: usize, text: &str) -> Result<(usize, usize), MatrixError> {
    let numbers: Option<Vec<usize>> = text.split_whitespace().map(|word| word.parse().ok()).collect();
    match numbers.as_deref() {
        Some(&[rows, columns, entries]) if rows == columns && rows > 0 && u32::try_from(rows).is_ok() => {
            Ok((rows, entries))
        }
        Some(&[rows, columns, _]) => Err(source.refuse(
            Some(line),
            format!("{rows} rows and {columns} columns"),
            "a square matrix with a row for each degree of freedom",
            EXPORT,
        )),
        _ => Err(source.refuse(Some(line), shown(text), "the numbers of rows, columns and entries", EXPORT)),
    }
}

fn entry(source: &Source<'_>, form: Form, line: usize, text: &str) -> Result<Written, MatrixError> {
    let fields = fields(text);
    let refuse = |expected: &str, help: &str| source.refuse(Some(line), shown(text), expected, help);
    let value = |text: &str| {
        let value = number(text).ok_or_else(|| refuse("an entry whose last field is a number", EXPORT))?;
        if value.is_finite() {
            return Ok(value);
        }
        let help = "find the element that gives it: one without volume or thickness, or a material without a value";
        Err(refuse("a finite number", help))
    };
    let (row, column, value) = match (form, &fields[..]) {
        (Form::MatrixMarket { .. } | Form::Triplets, [row, column, last]) => {
            let index = |text: &str| {
                text.parse().ok().filter(|index| *index > 0).map(Index::Number).ok_or_else(|| {
                    refuse("row and column as whole numbers from 1", "count rows and columns from 1, not from 0")
                })
            };
            (index(row)?, index(column)?, value(last)?)
        }
        (Form::Labelled, [node, dof, other, other_dof, last]) => {
            let index = |node: &str, dof: &str| match (node.parse(), dof.parse()) {
                (Ok(node), Ok(dof @ 1..=6)) if node > 0 => Ok(Index::Of { node, dof }),
                _ => Err(refuse(
                    "a node and one of its degrees of freedom 1 to 6",
                    "leave out of the model what has other unknowns: temperatures, pressures, Lagrange multipliers, generalized \
                     degrees of freedom",
                )),
            };
            (index(node, dof)?, index(other, other_dof)?, value(last)?)
        }
        (Form::MatrixMarket { .. } | Form::Triplets, _) => return Err(refuse("`row column value`", EXPORT)),
        (Form::Labelled, _) => return Err(refuse("`node, dof, node, dof, value`", EXPORT)),
    };
    if let Form::MatrixMarket { symmetric, size } = form {
        let outside = |index: Index| matches!(index, Index::Number(number) if number as usize > size);
        if outside(row) || outside(column) {
            let help = "count rows and columns from 1, or correct the line with the size";
            return Err(refuse(&format!("a row and a column up to {size}, as the line with the size says"), help));
        }
        if let (true, Index::Number(i), Index::Number(j)) = (symmetric, row, column)
            && i < j
        {
            let help = "write the lower triangle, or `general` in the first line and both triangles";
            return Err(refuse("an entry on or below the diagonal of a `symmetric` matrix", help));
        }
    }
    if source.which == Which::Stiffness && row == column && value >= HELD {
        let help = "remove *BOUNDARY from the model that writes the matrices, and hold the body by [[constraints]] in the scene";
        return Err(refuse(
            "the stiffness of a body that nothing holds: Abaqus writes 1e36 where *BOUNDARY holds it",
            help,
        ));
    }
    Ok(Written { line, row, column, value })
}

/// The rows of both matrices: each gets a place, in the order in which they are met.
#[derive(Default)]
pub(crate) struct Rows {
    places: HashMap<Index, u32>,
    pub list: Vec<Index>,
}

impl Rows {
    /// The place of a row.
    pub fn place(&mut self, index: Index) -> u32 {
        let list = &mut self.list;
        *self.places.entry(index).or_insert_with(|| {
            list.push(index);
            (list.len() - 1) as u32
        })
    }
}
