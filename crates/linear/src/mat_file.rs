//! MAT-files of version 5, uncompressed, as MATLAB, Octave and SciPy read them.
//!
//! Source of the format: "MAT-File Format", The MathWorks (the part on level 5).

use faer::Mat;

/// A variable of a MAT-file. Its name begins with a letter and has letters, digits and `_`.
#[derive(Debug, Clone)]
pub enum MatArray<'a> {
    /// A matrix.
    Numbers(&'a str, &'a Mat<f64>),
    /// A cell column of strings.
    Words(&'a str, Vec<&'a str>),
}

/// Types of data elements.
const INT8: u32 = 1;
const INT32: u32 = 5;
const UINT32: u32 = 6;
const DOUBLE: u32 = 9;
const MATRIX: u32 = 14;
const UTF16: u32 = 17;
/// Classes of arrays.
const CELL: u32 = 1;
const CHARACTERS: u32 = 4;
const DOUBLES: u32 = 6;

/// The bytes of a MAT-file with these variables.
pub fn mat_file(variables: &[MatArray<'_>]) -> Vec<u8> {
    let mut file = format!("{:<124}", "MATLAB 5.0 MAT-file, written by flexframe").into_bytes();
    file.extend(0x0100_u16.to_le_bytes());
    file.extend(b"IM"); // little endian
    for variable in variables {
        match variable {
            MatArray::Numbers(name, matrix) => element(&mut file, MATRIX, &numbers(name, matrix)),
            MatArray::Words(name, words) => element(&mut file, MATRIX, &cells(name, words)),
        }
    }
    file
}

/// A data element: its type, its length, its bytes, filled up to eight.
fn element(to: &mut Vec<u8>, kind: u32, bytes: &[u8]) {
    to.extend(kind.to_le_bytes());
    to.extend((bytes.len() as u32).to_le_bytes());
    to.extend(bytes);
    to.resize(to.len().next_multiple_of(8), 0);
}

/// Flags, dimensions and name of an array.
fn head(class: u32, [rows, columns]: [usize; 2], name: &str) -> Vec<u8> {
    let mut array = Vec::new();
    element(&mut array, UINT32, &[class.to_le_bytes(), [0; 4]].concat());
    element(&mut array, INT32, &[(rows as u32).to_le_bytes(), (columns as u32).to_le_bytes()].concat());
    element(&mut array, INT8, name.as_bytes());
    array
}

fn numbers(name: &str, matrix: &Mat<f64>) -> Vec<u8> {
    let mut array = head(DOUBLES, [matrix.nrows(), matrix.ncols()], name);
    let bytes: Vec<u8> =
        matrix.col_iter().flat_map(|c| c.iter().flat_map(|x| x.to_le_bytes()).collect::<Vec<_>>()).collect();
    element(&mut array, DOUBLE, &bytes);
    array
}

fn cells(name: &str, words: &[&str]) -> Vec<u8> {
    let mut array = head(CELL, [words.len(), 1], name);
    for word in words {
        let letters: Vec<u16> = word.encode_utf16().collect();
        let mut text = head(CHARACTERS, [1, letters.len()], "");
        element(&mut text, UTF16, &letters.iter().flat_map(|letter| letter.to_le_bytes()).collect::<Vec<_>>());
        element(&mut array, MATRIX, &text);
    }
    array
}
