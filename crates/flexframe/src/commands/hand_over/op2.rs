//! OP2 of Nastran: matrices in binary records, in words of four bytes, least byte first.
//!
//! A record has its length in bytes before and after it. Keys are records of one word: the number of words of the record that follows,
//! or, from −1 down, the number of the part of a data block that ends.

use super::craig_bampton::{DOUBLE, Named};

/// Head of a file: a date (always the same, as the file of the same body), a title, and the label that Nastran writes where nobody gives one.
const DATE: [i32; 3] = [1, 1, 0];
const TITLE: &[u8; 28] = b"NASTRAN FORT TAPE ID CODE - ";
const LABEL: &[u8; 8] = b"XXXXXXXX";
/// Number of the first data block.
const FIRST: i32 = 101;
/// Words after the name of a matrix in its second record.
const AFTER_NAME: [i32; 2] = [170; 2];
/// Kinds of the parts of a data block: an end, or a column of a matrix.
const END: i32 = 0;
const COLUMN: i32 = 1;

/// The bytes of the file.
pub fn bytes(matrices: &[Named]) -> Vec<u8> {
    let mut file = Records::default();
    file.counted(&words(&DATE));
    file.counted(TITLE);
    file.counted(LABEL);
    file.keys(&[-1, 0]);
    for (number, of) in (FIRST..).zip(matrices) {
        let columns: Vec<Option<(usize, Vec<f64>)>> = (0..of.matrix.ncols()).map(|c| of.filled(c)).collect();
        let longest = columns.iter().flatten().map(|(_, column)| column.len()).max().unwrap_or(0);
        let filled: usize = columns.iter().flatten().map(|(_, column)| column.len()).sum();
        let density = 10_000 * filled / (of.matrix.nrows() * of.matrix.ncols()).max(1);
        let [rows, ncols, longest, density] =
            [of.matrix.nrows(), of.matrix.ncols(), 2 * longest, density].map(|count| count as i32);
        let name = format!("{:8}", of.name).into_bytes();
        file.counted(&name);
        file.keys(&[-1]);
        file.counted(&words(&[number, ncols, rows, of.form, DOUBLE, longest, density]));
        file.keys(&[-2, 1, END]);
        file.counted(&[name, words(&AFTER_NAME)].concat());
        let mut part = -3;
        for column in columns {
            file.keys(&[part, 1, COLUMN]);
            if let Some((first, numbers)) = column {
                let row = words(&[first as i32 + 1]);
                let numbers = numbers.into_iter().flat_map(f64::to_le_bytes);
                file.counted(&row.into_iter().chain(numbers).collect::<Vec<u8>>());
            }
            part -= 1;
        }
        file.keys(&[part, 1, END, 0]);
    }
    file.keys(&[0]);
    file.0
}

fn words(numbers: &[i32]) -> Vec<u8> {
    numbers.iter().flat_map(|number| number.to_le_bytes()).collect()
}

/// Records of Fortran.
#[derive(Default)]
struct Records(Vec<u8>);

impl Records {
    fn record(&mut self, bytes: &[u8]) {
        let length = (bytes.len() as i32).to_le_bytes();
        [&length, bytes, &length].into_iter().for_each(|part| self.0.extend_from_slice(part));
    }

    fn keys(&mut self, keys: &[i32]) {
        keys.iter().for_each(|key| self.record(&key.to_le_bytes()));
    }

    /// A record with its number of words before it.
    fn counted(&mut self, bytes: &[u8]) {
        self.keys(&[(bytes.len() / 4) as i32]);
        self.record(bytes);
    }
}
