//! Parts of a factor that do not touch each other: subtrees of its elimination tree, and the rest above them.

use std::ops::Range;

use faer::sparse::linalg::cholesky::supernodal::SymbolicSupernodalCholesky;

/// Stored entries that are worth a part of their own.
const GRAIN: usize = 200_000;
/// Parts at the most, or hardly more: the entries of one are at most this part of all.
const MOST: usize = 12;

/// The supernodes of a factor, parted. It depends on the factor alone, not on the number of threads.
pub(crate) struct Subtrees {
    /// Runs of supernodes that touch no row but those of the run and of the top.
    pub parts: Vec<Range<usize>>,
    /// The other supernodes, in rising order.
    pub top: Vec<usize>,
    /// The place of a row among those of the top; of no meaning for another row.
    pub place: Vec<u32>,
    /// Rows of the top.
    pub top_rows: usize,
}

impl Subtrees {
    /// Parts the supernodes of a factor.
    pub(crate) fn new(factor: &SymbolicSupernodalCholesky<usize>) -> Self {
        let (begin, end, values) = (factor.supernode_begin(), factor.supernode_end(), factor.col_ptr_for_val());
        let count = factor.n_supernodes();
        // The supernode above each: that of the first row below it.
        let parent = |s: usize| {
            let row = factor.supernode(s).pattern().first()?;
            Some(begin.partition_point(|first| first <= row) - 1)
        };
        let parents: Vec<Option<usize>> = (0..count).map(parent).collect();
        let mut entries: Vec<usize> = values.windows(2).map(|range| range[1] - range[0]).collect();
        let mut first: Vec<usize> = (0..count).collect();
        let mut size = vec![1; count];
        for (s, parent) in parents.iter().enumerate() {
            if let Some(parent) = *parent {
                entries[parent] += entries[s];
                first[parent] = first[parent].min(first[s]);
                size[parent] += size[s];
            }
        }
        let whole = values[count] - values[0];
        let limit = whole / (whole / GRAIN).clamp(1, MOST);
        let is_part = |s: usize| entries[s] <= limit && size[s] == s + 1 - first[s];

        let (mut parts, mut top): (Vec<Range<usize>>, Vec<usize>) = Default::default();
        let mut in_part = 0;
        let mut s = count;
        // From the last supernode back: a subtree is the run before its root.
        while s > 0 {
            s -= 1;
            if !is_part(s) {
                top.push(s);
                continue;
            }
            // Small neighbours make one part.
            match parts.last_mut() {
                Some(last) if last.start == s + 1 && in_part + entries[s] <= limit => {
                    last.start = first[s];
                    in_part += entries[s];
                }
                _ => {
                    parts.push(first[s]..s + 1);
                    in_part = entries[s];
                }
            }
            s = first[s];
        }
        parts.reverse();
        top.reverse();
        let mut place = vec![0; factor.ncols()];
        let mut top_rows = 0;
        for s in &top {
            for row in begin[*s]..end[*s] {
                place[row] = top_rows as u32;
                top_rows += 1;
            }
        }
        Self { parts, top, place, top_rows }
    }
}
