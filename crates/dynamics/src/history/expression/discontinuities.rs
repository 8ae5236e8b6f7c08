//! Times at which a formula has a kink or a jump: where one of its functions goes from one smooth piece to another.

use std::hash::DefaultHasher;
use std::hash::Hasher;

use super::law::Law;

/// Cells that a run is looked at in. What happens twice within one may be missed.
const CELLS: u32 = 1 << 14;
/// A cell with more of them is left as it is, and so is a formula with more in all.
const MAX_IN_CELL: usize = 64;
const MAX_IN_ALL: usize = 20_000;

/// The times between 0 and `end`, rising; each is the first time of its new piece. None where there are too many of them.
pub(super) fn discontinuities(law: &Law, end: f64) -> Vec<f64> {
    let mut found = Vec::new();
    if !law.has_pieces() {
        return found;
    }
    let pieces = |time: f64| {
        let mut hasher = DefaultHasher::new();
        law.value_and_pieces(time, &mut |piece| hasher.write_i64(piece));
        hasher.finish()
    };
    let (mut from, mut at_start) = (0.0, pieces(0.0));
    for cell in 1..=CELLS {
        let to = end * f64::from(cell) / f64::from(CELLS);
        let at_end = pieces(to);
        let before = found.len();
        while at_start != at_end && found.len() - before <= MAX_IN_CELL {
            let first = first_change(&pieces, from, at_start, to);
            found.push(first);
            (from, at_start) = (first, pieces(first));
        }
        if found.len() - before > MAX_IN_CELL {
            found.truncate(before);
        }
        if found.len() > MAX_IN_ALL {
            return Vec::new();
        }
        (from, at_start) = (to, at_end);
    }
    found.retain(|time| *time > 0.0 && *time < end);
    found
}

/// A time in a cell at which the pieces are no longer those at its start, while they are just before it.
fn first_change(pieces: &impl Fn(f64) -> u64, start: f64, at_start: u64, end: f64) -> f64 {
    let (mut before, mut after) = (start, end);
    loop {
        let middle = 0.5 * (before + after);
        if middle <= before || middle >= after {
            return after;
        }
        if pieces(middle) == at_start { before = middle } else { after = middle }
    }
}

#[cfg(test)]
mod tests {
    use super::super::syntax;
    use super::*;

    fn found(text: &str, end: f64) -> Vec<f64> {
        discontinuities(&syntax::read(text).unwrap_or_else(|_| panic!("{text}")), end)
    }

    /// Closed form: the zeros and multiples where each formula jumps or kinks.
    #[test]
    fn kinks_and_jumps_are_found_to_rounding() {
        let pi = std::f64::consts::PI;
        let cases: [(&str, f64, Vec<f64>); 9] = [
            ("sin(20*t) + t^2", 1.0, vec![]),
            ("sign(t - 0.3)", 1.0, vec![0.3]),
            ("abs(sin(20*t))", 1.0, (1..=6).map(|k| f64::from(k) * pi / 20.0).collect()),
            ("floor(7.395*t + 0.329)", 1.0, (1..=7).map(|k| (f64::from(k) - 0.329) / 7.395).collect()),
            ("max(0, min(1, t - 2, 10 - t))", 12.0, vec![2.0, 3.0, 9.0, 10.0]),
            ("t % 0.4", 1.0, vec![0.4, 0.8]),
            ("round(t) + trunc(2*t) + fract(t)", 1.2, vec![0.5, 1.0]),
            ("atan2(sin(t), cos(t))", 4.0, vec![pi]),
            ("floor(1e9*t)", 1.0, vec![]),
        ];
        for (text, end, expected) in cases {
            let found = found(text, end);
            assert_eq!(found.len(), expected.len(), "{text}: {found:?}");
            for (found, expected) in found.iter().zip(&expected) {
                assert!((found - expected).abs() < 1e-14 * end, "{text}: {found} {expected}");
            }
        }
    }

    #[test]
    fn many_in_a_cell_are_found_and_too_many_are_left() {
        assert_eq!(found("floor(10000*t)", 1.0).len(), 9999);
        assert_eq!(found("floor(100000*t)", 1.0).len(), 0);
        assert_eq!(found("floor(1e6*max(0, t - 0.999999)) + sign(t - 0.25)", 1.0).len(), 2);
    }
}
