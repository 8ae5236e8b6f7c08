//! Rows that are checked at the end of a run: as many as cost no more than the modes of the body did, by the size of its factor.

use model::Model;

/// Seconds of one core for one `entries² / (2 unknowns)` of a factor, which is the number of its multiplications if all columns are alike:
/// K* with pivots of two rows, and K + sM.
const PIVOTED: f64 = 4e-10;
const DEFINITE: f64 = 2e-10;
/// Seconds for each unknown of K* and of the forces of all elements.
const ELEMENTS: f64 = 3e-6;
/// Seconds for each entry of the factor in the search for ten modes.
const SEARCH: f64 = 1.1e-7;
/// Factors of K* at a row: one, and a second where its error is large.
const FACTORS: f64 = 1.5;
/// Seconds that nobody waits for.
const SHORT: f64 = 1.0;

/// The number of rows whose check costs no more than the modes of the body did, or a second more. None where these were found without
/// the factor of all unknowns: that is what costs too much.
pub(super) fn affordable(model: &Model) -> usize {
    let Some(meshed) = &model.meshed else { return 0 };
    let stats = &meshed.modes.stats;
    if stats.cycles > 0 || stats.factor_entries == 0 {
        return 0;
    }
    rows(stats.unknowns as f64, stats.factor_entries as f64)
}

/// The same by the unknowns and the entries of the factor.
fn rows(unknowns: f64, entries: f64) -> usize {
    let multiplications = entries * entries / (2.0 * unknowns);
    let reduction = DEFINITE * multiplications + SEARCH * entries;
    let factor = PIVOTED * multiplications + ELEMENTS * unknowns;
    // One factor more, of the body at rest.
    let left = reduction + SHORT - factor;
    if left > 0.0 { (left / (FACTORS * factor)) as usize } else { 0 }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Regression only: unknowns and entries of the ring, the paper's plate, the same plate with elements of 6 mm, and ten times that.
    #[test]
    fn small_bodies_are_checked_at_all_rows_and_large_ones_at_none() {
        assert!(rows(6111.0, 712_674.0) >= 4);
        assert_eq!(rows(28_311.0, 4_251_285.0), 4);
        assert_eq!(rows(76_794.0, 17_878_779.0), 1);
        assert_eq!(rows(767_940.0, 3.8e8), 0);
    }
}
