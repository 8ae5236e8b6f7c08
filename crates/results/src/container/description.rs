//! Contents of a results file and their places, in a form that is read without HDF5.

use crate::shapes::stored::StoredArray;
use crate::{FileError, Metadata};
use serde::{Deserialize, Serialize};
use std::ops::Range;
use std::path::Path;

/// Stands as JSON in the head of the file.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Description {
    /// Rows that there is room for.
    pub rows: usize,
    /// Words of each of the two places for a checkpoint; none in a finished file.
    pub checkpoint_words: Option<usize>,
    /// First byte of the times, of each history in the order of [`histories`](crate::histories), and of the checkpoints; 0 where
    /// there is nothing.
    pub starts: Vec<u64>,
    /// The shapes of the bodies; none of a body that has none, or where they are elsewhere.
    pub arrays: Vec<StoredArray>,
    /// Metadata of the run.
    pub metadata: Metadata,
}

/// Bytes of the numbers of a file.
#[derive(Debug)]
pub(crate) struct Ranges {
    /// Of the times, and of each history in order.
    pub histories: Vec<Range<u64>>,
    /// Of the two places for a checkpoint.
    pub checkpoints: Range<u64>,
    /// Of each array.
    pub arrays: Vec<Range<u64>>,
}

impl Description {
    pub(crate) fn to_json(&self) -> String {
        // It has no maps, whose keys might be no text: it cannot fail.
        serde_json::to_string(self).unwrap_or_default()
    }

    pub(crate) fn from_json(path: &Path, json: &[u8]) -> Result<Self, FileError> {
        serde_json::from_slice(json).map_err(|error| {
            // Without what stands there.
            let what = format!("its description cannot be read from byte {} on", error.column());
            FileError::Damaged { path: path.to_path_buf(), what }
        })
    }

    /// The bytes of each history and of the checkpoints, from the values per row of the histories, and those of the arrays.
    /// `None` if they are not all within `free`, each in a place of its own, or are of a body that is not there.
    pub(crate) fn ranges(&self, widths: impl Iterator<Item = usize>, free: Range<u64>) -> Option<Ranges> {
        let size = |numbers: usize, each: usize| Some((numbers.checked_mul(each)?.checked_mul(8)?) as u64);
        let sizes = widths.map(|width| size(self.rows, width));
        let sizes = sizes.chain(self.checkpoint_words.map(|words| size(2, words)));
        let mut starts = self.starts.iter();
        let range = |start: u64, size: u64| Some(start..start.checked_add(size)?);
        let mut histories: Vec<_> = sizes.map(|size| range(*starts.next()?, size?)).collect::<Option<_>>()?;
        let of_array = |array: &StoredArray| {
            self.metadata.bodies.get(array.body)?;
            range(array.start, array.bytes()?)
        };
        let arrays: Vec<_> = self.arrays.iter().map(of_array).collect::<Option<_>>()?;
        let mut sorted: Vec<&Range<u64>> = histories.iter().chain(&arrays).filter(|range| !range.is_empty()).collect();
        sorted.sort_unstable_by_key(|range| range.start);
        let apart = sorted.windows(2).all(|pair| pair[0].end <= pair[1].start);
        let within = sorted.iter().all(|range| free.start <= range.start && range.end <= free.end);
        let fit = apart && within && starts.next().is_none();
        let checkpoints = self.checkpoint_words.and_then(|_| histories.pop()).unwrap_or_default();
        fit.then_some(Ranges { histories, checkpoints, arrays })
    }
}
