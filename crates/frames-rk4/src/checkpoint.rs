//! A run's state as a list of words, so that it can be taken up again in another process.

use nalgebra::SVector;
use rigid_kin::Attitude;

/// A checkpoint that does not belong to the run that is to go on from it.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
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

/// Passes over the words of a state, in one order for both directions: it notes them, or sets them.
///
/// Each part of the state has one function that hands its variables to a tape, so that what is noted and what is set
/// cannot differ. Constants of the run, and what is computed anew before it is read, are left out.
#[derive(Debug)]
pub(crate) enum Tape<'a> {
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

impl<'a> Tape<'a> {
    pub(crate) fn set(words: &'a [u64]) -> Self {
        Self::Set { words, passed: 0, wrong: None }
    }

    /// Whether what was set is a whole state.
    pub(crate) fn finish(self) -> Result<(), RestoreError> {
        match self {
            Self::Set { words, passed, .. } if passed != words.len() => {
                Err(RestoreError::Length { expected: passed, found: words.len() })
            }
            Self::Set { wrong: Some(what), .. } => Err(RestoreError::Value { what }),
            _ => Ok(()),
        }
    }

    fn word(&mut self, value: &mut u64) {
        match self {
            Self::Note(words) => words.push(*value),
            Self::Set { words, passed, .. } => {
                *value = words.get(*passed).copied().unwrap_or(*value);
                *passed += 1;
            }
        }
    }

    /// The words set so far are refused unless `holds`.
    pub(crate) fn expect(&mut self, what: &'static str, holds: bool) {
        if let (Self::Set { wrong, .. }, false) = (self, holds) {
            *wrong = Some(what);
        }
    }

    /// A count, which no run brings beyond 2⁶⁰.
    pub(crate) fn count(&mut self, value: &mut u64) {
        self.word(value);
        self.expect("a count", *value <= 1 << 60);
    }

    pub(crate) fn flag(&mut self, value: &mut bool) {
        let mut word = u64::from(*value);
        self.word(&mut word);
        *value = word != 0;
    }

    /// Bit for bit, infinities and NaN too.
    pub(crate) fn number(&mut self, value: &mut f64) {
        let mut word = value.to_bits();
        self.word(&mut word);
        *value = f64::from_bits(word);
    }

    /// A number that is finite in any run.
    pub(crate) fn finite(&mut self, what: &'static str, value: &mut f64) {
        self.number(value);
        self.expect(what, value.is_finite());
    }

    /// A list whose length is a constant of the run.
    pub(crate) fn numbers(&mut self, values: &mut [f64]) {
        values.iter_mut().for_each(|value| self.number(value));
    }

    pub(crate) fn vector<const N: usize>(&mut self, vector: &mut SVector<f64, N>) {
        self.numbers(vector.as_mut_slice());
    }

    pub(crate) fn attitude(&mut self, attitude: &mut Attitude) {
        let mut wxyz = attitude.wxyz();
        self.numbers(&mut wxyz);
        match Attitude::from_unit_wxyz(wxyz) {
            Ok(found) => *attitude = found,
            Err(_) => self.expect("the attitude", false),
        }
    }
}
