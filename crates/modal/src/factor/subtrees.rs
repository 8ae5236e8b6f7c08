//! Parts of a factor that do not touch each other: subtrees of its elimination tree, and the rest above them.

use std::ops::Range;

use crate::factor::supernodes::Supernodes;

/// A factor with fewer entries is not parted: one thread makes it, and takes the scratch of one.
const SMALL: usize = 500_000;
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
    /// True if there is work for more than one thread.
    pub(crate) fn is_parted(&self) -> bool {
        !self.top.is_empty()
    }

    /// The parts, each with its own range of a list, and the numbers in it.
    pub(crate) fn split<'a, T>(
        &self,
        mut list: &'a mut [T],
        range: impl Fn(&Range<usize>) -> Range<usize>,
    ) -> Vec<(Range<usize>, Range<usize>, &'a mut [T])> {
        let mut passed = 0;
        let mut parts = Vec::with_capacity(self.parts.len());
        for part in &self.parts {
            let range = range(part);
            let (_, from_first) = list.split_at_mut(range.start - passed);
            let (own, rest) = from_first.split_at_mut(range.len());
            (list, passed) = (rest, range.end);
            parts.push((part.clone(), range, own));
        }
        parts
    }

    /// Parts the supernodes of a factor.
    pub(crate) fn new(supernodes: &Supernodes) -> Self {
        let count = supernodes.count();
        let of_columns = supernodes.of_columns();
        // The supernode above each: that of the first row below it.
        let parent = |s: usize| supernodes.below(s).first().map(|row| of_columns[*row as usize] as usize);
        let parents: Vec<Option<usize>> = (0..count).map(parent).collect();
        let mut entries: Vec<usize> = (0..count).map(|s| supernodes.entries(s).len()).collect();
        let mut first: Vec<usize> = (0..count).collect();
        let mut size = vec![1; count];
        for (s, parent) in parents.iter().enumerate() {
            if let Some(parent) = *parent {
                entries[parent] += entries[s];
                first[parent] = first[parent].min(first[s]);
                size[parent] += size[s];
            }
        }
        let whole = supernodes.factor_entries();
        let limit = if whole < SMALL { whole } else { whole / MOST };
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
        let mut place = vec![0; supernodes.unknowns()];
        let mut top_rows = 0;
        for s in &top {
            for place in &mut place[supernodes.columns(*s)] {
                *place = top_rows as u32;
                top_rows += 1;
            }
        }
        Self { parts, top, place, top_rows }
    }
}

#[cfg(test)]
mod tests {
    use faer::sparse::linalg::cholesky::SymbolicCholeskyRaw;

    use super::*;
    use crate::factor::substitution::tests::{grid, supernodal};

    #[test]
    fn parts_touch_their_own_rows_and_those_of_the_top_alone() {
        let symbolic = supernodal(&grid(18));
        let SymbolicCholeskyRaw::Supernodal(factor) = symbolic.raw() else { panic!() };
        let supernodes = Supernodes::new(factor, 1);
        let Subtrees { parts, top, place, top_rows } = Subtrees::new(&supernodes);
        assert!(parts.len() > 3 && !top.is_empty());
        let mut all: Vec<usize> = parts.iter().cloned().flatten().chain(top.iter().copied()).collect();
        all.sort_unstable();
        assert_eq!(all, (0..supernodes.count()).collect::<Vec<_>>());
        let rows = |s: &usize| supernodes.columns(*s);
        let of_top: Vec<usize> = top.iter().flat_map(rows).collect();
        assert_eq!(of_top.len(), top_rows);
        assert!(of_top.iter().enumerate().all(|(i, row)| place[*row] as usize == i));
        for part in &parts {
            let own = supernodes.columns_of(part);
            for s in part.clone() {
                let mut rows = supernodes.below(s).iter().map(|row| *row as usize);
                assert!(rows.all(|row| own.contains(&row) || of_top.binary_search(&row).is_ok()));
            }
        }
        // None is larger than its share, which is what threads wait for.
        assert!(parts.iter().all(|part| supernodes.entries_of(part).len() <= supernodes.factor_entries() / 3));
    }
}
