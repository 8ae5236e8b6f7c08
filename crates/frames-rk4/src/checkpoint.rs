//! A run's state as a list of words, so that it can be taken up again in another process.

use nalgebra::SVector;
use rigid_kin::Attitude;

/// A checkpoint that does not belong to the run that is to go on from it.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum RestoreError {
    /// It has more or fewer words than the state of the run.
    #[error(
        "the checkpoint has {found} words where the state of this run has {expected}; it is that of another scene or version: run the scene again from its beginning"
    )]
    Length {
        /// Words that this run's state has.
        expected: usize,
        /// Words of the checkpoint.
        found: usize,
    },
    /// A word that no run can have left.
    #[error(
        "the checkpoint holds no state of a run: {what} is out of its range; run the scene again from its beginning"
    )]
    Value {
        /// What the word stands for.
        what: &'static str,
    },
}

/// Encodes or decodes a state as a list of words.
///
/// Each part of the state has one function `code` for both directions, so that the encoder and the decoder cannot differ.
/// It hands over its variables one by one. Constants of the run, and what is computed again before it is read, are left
/// out.
#[derive(Debug)]
pub struct StateCoder<'a>(Way<'a>);

/// Which way it goes.
#[derive(Debug)]
enum Way<'a> {
    /// Notes the words.
    Note(&'a mut Vec<u64>),
    /// Sets them from a list.
    Set {
        words: &'a [u64],
        /// Words passed, those beyond the end of the list counted too.
        passed: usize,
        wrong: Option<&'static str>,
    },
}

impl<'a> StateCoder<'a> {
    /// Sets a state from a list of words.
    pub(crate) fn decode(words: &'a [u64]) -> Self {
        Self(Way::Set { words, passed: 0, wrong: None })
    }

    /// Notes a state in a list of words.
    pub(crate) fn encode(words: &'a mut Vec<u64>) -> Self {
        Self(Way::Note(words))
    }

    /// Whether what was set is a whole state.
    pub(crate) fn finish(self) -> Result<(), RestoreError> {
        match self.0 {
            Way::Set { words, passed, .. } if passed != words.len() => {
                Err(RestoreError::Length { expected: passed, found: words.len() })
            }
            Way::Set { wrong: Some(what), .. } => Err(RestoreError::Value { what }),
            _ => Ok(()),
        }
    }

    fn word(&mut self, value: &mut u64) {
        match &mut self.0 {
            Way::Note(words) => words.push(*value),
            Way::Set { words, passed, .. } => {
                *value = words.get(*passed).copied().unwrap_or(*value);
                *passed += 1;
            }
        }
    }

    /// The words set so far are refused unless `holds`.
    pub fn expect(&mut self, what: &'static str, holds: bool) {
        if let (Way::Set { wrong, .. }, false) = (&mut self.0, holds) {
            *wrong = Some(what);
        }
    }

    /// A count, which no run brings beyond 2⁶⁰.
    pub fn count(&mut self, value: &mut u64) {
        self.word(value);
        self.expect("a count", *value <= 1 << 60);
    }

    /// Yes or no.
    pub fn flag(&mut self, value: &mut bool) {
        let mut word = u64::from(*value);
        self.word(&mut word);
        *value = word != 0;
    }

    /// Bit for bit, infinities and NaN too.
    pub fn number(&mut self, value: &mut f64) {
        let mut word = value.to_bits();
        self.word(&mut word);
        *value = f64::from_bits(word);
    }

    /// A number that is finite in any run.
    pub fn finite(&mut self, what: &'static str, value: &mut f64) {
        self.number(value);
        self.expect(what, value.is_finite());
    }

    /// A list whose length is a constant of the run.
    pub fn numbers(&mut self, values: &mut [f64]) {
        values.iter_mut().for_each(|value| self.number(value));
    }

    /// A vector, bit for bit.
    pub fn vector<const N: usize>(&mut self, vector: &mut SVector<f64, N>) {
        self.numbers(vector.as_mut_slice());
    }

    /// An attitude, bit for bit.
    pub fn attitude(&mut self, attitude: &mut Attitude) {
        let mut wxyz = attitude.wxyz();
        self.numbers(&mut wxyz);
        match Attitude::from_unit_wxyz(wxyz) {
            Ok(found) => *attitude = found,
            Err(_) => self.expect("the attitude", false),
        }
    }
}
