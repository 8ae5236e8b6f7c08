//! The state of a run beside its rows in an unfinished file.

use crc32fast::Hasher;
use sealed::little_endian;

/// Words of a checkpoint in the file beside those of the state: number, rows, sum of the rows, and check sum.
pub(crate) const FRAME: usize = 4;

/// A checkpoint.
#[derive(Debug)]
pub(crate) struct Checkpoint {
    /// From 1.
    pub serial: u64,
    /// Rows before it.
    pub rows: usize,
    /// [`Sums::total`] of these.
    pub sum_of_rows: u32,
    /// State of the run.
    pub state: Vec<u64>,
}

impl Checkpoint {
    /// As it is in the file.
    pub(crate) fn words(&self) -> Vec<u64> {
        let mut words = vec![self.serial, self.rows as u64, self.sum_of_rows.into()];
        words.extend_from_slice(&self.state);
        words.push(sum_of_words(&words));
        words
    }

    /// `None` if there is none, or only part of one.
    pub(crate) fn read(words: &[u64]) -> Option<Self> {
        let (sum, words) = words.split_last()?;
        match words {
            [serial, rows, sum_of_rows, state @ ..] if *serial > 0 && sum_of_words(words) == *sum => Some(Self {
                serial: *serial,
                rows: usize::try_from(*rows).ok()?,
                sum_of_rows: u32::try_from(*sum_of_rows).ok()?,
                state: state.to_vec(),
            }),
            _ => None,
        }
    }
}

fn sum_of_words(words: &[u64]) -> u64 {
    let mut hasher = Hasher::new();
    words.iter().for_each(|word| hasher.update(&word.to_le_bytes()));
    hasher.finalize().into()
}

/// Running check sums of the columns, each by itself, so that it is the same however many rows are written at a time.
#[derive(Debug, Clone)]
pub(crate) struct Sums(Vec<Hasher>);

impl Sums {
    pub(crate) fn new(columns: usize) -> Self {
        Self(vec![Hasher::new(); columns])
    }

    /// Goes on with further rows of all columns.
    pub(crate) fn add<'a>(&mut self, columns: impl Iterator<Item = &'a [f64]>) {
        for (hasher, values) in self.0.iter_mut().zip(columns) {
            hasher.update(&little_endian(values));
        }
    }

    /// Check sum of all columns.
    pub(crate) fn total(&self) -> u32 {
        let mut total = Hasher::new();
        self.0.iter().for_each(|hasher| total.update(&hasher.clone().finalize().to_le_bytes()));
        total.finalize()
    }
}
