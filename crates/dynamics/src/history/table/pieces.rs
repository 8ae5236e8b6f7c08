//! Pieces of a table between rows.

/// Slope of a line through two rows, and its error by the rounding of both.
fn slope(t: &[f64], v: &[f64]) -> (f64, f64) {
    let dt = t[1] - t[0];
    let slope = (v[1] - v[0]) / dt;
    (slope, f64::EPSILON * (v[0].abs() + v[1].abs() + slope.abs() * (t[0].abs() + t[1].abs())) / dt)
}

/// Times where pieces meet that do not lie on one line; `rates` are the rates of cubics, or none.
pub(super) fn discontinuities(times: &[f64], values: &[f64], rates: &[f64]) -> Vec<f64> {
    const FLAT: (f64, f64, bool) = (0.0, 0.0, true);
    let lines = times.windows(2).zip(values.windows(2)).enumerate().map(|(row, (t, v))| {
        let (slope, error) = slope(t, v);
        let of_cubic = rates.get(row..row + 2).unwrap_or_default();
        (slope, error, of_cubic.iter().all(|rate| (rate - slope).abs() <= error))
    });
    let mut discontinuities = Vec::new();
    let mut before = FLAT;
    for (time, after) in times.iter().zip(lines.chain([FLAT])) {
        if (after.0 - before.0).abs() > before.1 + after.1 || !before.2 || !after.2 {
            discontinuities.push(*time);
        }
        before = after;
    }
    discontinuities
}

/// Rates at the rows by which the cubics between them rise and fall only where the rows do: none at a row that is the highest or
/// the lowest of three, otherwise a harmonic mean of the slopes beside it, each weighted by the lengths (Fritsch and Butland).
pub(super) fn monotone_rates(times: &[f64], values: &[f64]) -> Vec<f64> {
    let lengths: Vec<f64> = times.windows(2).map(|t| t[1] - t[0]).collect();
    let slopes: Vec<f64> = lengths.iter().zip(values.windows(2)).map(|(length, v)| (v[1] - v[0]) / length).collect();
    let last = slopes.len() - 1;
    let of_end = |end: usize, next: usize| match end == next {
        true => slopes[end],
        false => rate_at_end([lengths[end], lengths[next]], [slopes[end], slopes[next]]),
    };
    let between = (1..slopes.len()).map(|row| {
        let ([a, b], [h, l]) = ([slopes[row - 1], slopes[row]], [lengths[row - 1], lengths[row]]);
        let alike = (a > 0.0 && b > 0.0) || (a < 0.0 && b < 0.0);
        let [of_a, of_b] = [(2.0 * l + h) / (3.0 * (l + h)), (l + 2.0 * h) / (3.0 * (l + h))];
        if alike { (of_a / a + of_b / b).recip() } else { 0.0 }
    });
    let between: Vec<f64> = between.collect();
    [of_end(0, 1.min(last))].into_iter().chain(between).chain([of_end(last, last.saturating_sub(1))]).collect()
}

/// The rate at an end by a parabola through three rows, as far as it keeps the cubic monotone.
fn rate_at_end([length, next_length]: [f64; 2], [slope, next_slope]: [f64; 2]) -> f64 {
    let rate = ((2.0 * length + next_length) * slope - length * next_slope) / (length + next_length);
    if rate * slope <= 0.0 {
        0.0
    } else if slope * next_slope < 0.0 && rate.abs() > 3.0 * slope.abs() {
        3.0 * slope
    } else {
        rate
    }
}
