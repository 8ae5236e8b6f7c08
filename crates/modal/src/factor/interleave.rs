//! Sorts a factor, as it was made, into the order in which a substitution reads it ([`factor_layout`](crate::factor::layout)).

use rayon::prelude::*;

use crate::factor::layout::{of_own_rows, write_strips};
use crate::factor::subtrees::Subtrees;
use crate::factor::supernodes::Supernodes;

/// Sorts the rows below all supernodes, which stand column by column, into the order in which they are read: by strips.
pub(crate) fn interleave(supernodes: &Supernodes, subtrees: &Subtrees, values: &mut [f64]) {
    let supernode = |s: usize, values: &mut [f64], scratch: &mut Vec<f64>| {
        let width = supernodes.width(s);
        let below = &mut values[of_own_rows(width)..];
        scratch.clear();
        scratch.extend_from_slice(below);
        write_strips(width, scratch, below);
    };
    subtrees.split(values, |part| supernodes.entries_of(part)).into_par_iter().for_each_init(
        Vec::new,
        |scratch, (part, range, values)| {
            for s in part {
                let of_it = supernodes.entries(s);
                supernode(s, &mut values[of_it.start - range.start..of_it.end - range.start], scratch);
            }
        },
    );
    let mut scratch = Vec::new();
    for s in &subtrees.top {
        supernode(*s, &mut values[supernodes.entries(*s)], &mut scratch);
    }
}
