//! Fewer points of long courses.

/// Which rows of `rows` are kept so that there are `most` at the most: evenly spread, first and last among them.
pub(crate) fn spread(rows: usize, most: usize) -> Vec<usize> {
    if rows <= most || most < 2 {
        return (0..rows).collect();
    }
    (0..most).map(|i| i * (rows - 1) / (most - 1)).collect()
}

/// Ranges of neighbouring rows, two points for each, so that there are `most` points at the most.
#[derive(Debug, Clone)]
pub(crate) struct Thinning {
    /// Where each range begins, and after them the number of rows.
    starts: Vec<usize>,
}

impl Thinning {
    /// For courses with a number of rows; `None` where they are short enough.
    pub(crate) fn new(rows: usize, most: usize) -> Option<Self> {
        let ranges = most / 2;
        (rows > most && ranges > 0).then(|| Self { starts: (0..=ranges).map(|i| i * rows / ranges).collect() })
    }

    /// Times of the points: of the first and of the last row of each range.
    pub(crate) fn times(&self, times: &[f64]) -> Vec<f64> {
        self.starts.windows(2).flat_map(|range| [times[range[0]], times[range[1] - 1]]).collect()
    }

    /// The least and the greatest value of each range, in the order in which they come. So no peak is lost, and each is
    /// shown within its range.
    pub(crate) fn values(&self, values: &[f64]) -> Vec<f64> {
        let of_range = |range: &[usize]| {
            let (mut least, mut greatest) = (range[0], range[0]);
            for row in range[0]..range[1] {
                if values[row] < values[least] {
                    least = row;
                }
                if values[row] > values[greatest] {
                    greatest = row;
                }
            }
            [values[least.min(greatest)], values[least.max(greatest)]]
        };
        self.starts.windows(2).flat_map(of_range).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::{Thinning, spread};

    #[test]
    fn spread_rows_keep_first_and_last() {
        assert_eq!(spread(5, 10), [0, 1, 2, 3, 4]);
        let kept = spread(10_001, 101);
        assert_eq!((kept.len(), kept[0], kept[100]), (101, 0, 10_000));
        assert!(kept.windows(2).all(|pair| pair[1] - pair[0] == 100));
    }

    #[test]
    fn a_spike_of_one_row_survives_thinning_with_sign_and_place() {
        let rows = 10_007;
        let times: Vec<f64> = (0..rows).map(|row| row as f64).collect();
        let mut values: Vec<f64> = times.iter().map(|t| (0.01 * t).sin()).collect();
        values[3_333] = -7.5;
        let thinning = Thinning::new(rows, 500).unwrap();
        let (thin_times, thin) = (thinning.times(&times), thinning.values(&values));
        assert_eq!((thin_times.len(), thin.len()), (500, 500));
        assert!(thin_times.windows(2).all(|pair| pair[0] < pair[1]), "{thin_times:?}");
        assert_eq!((thin_times[0], thin_times[499]), (0.0, 10_006.0));
        let at = thin.iter().position(|value| *value == -7.5).unwrap();
        assert!((thin_times[at] - 3_333.0).abs() < 42.0, "{}", thin_times[at]);
        assert!(Thinning::new(500, 500).is_none());
    }
}
