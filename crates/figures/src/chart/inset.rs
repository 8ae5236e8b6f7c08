//! An inset for a chart where all happens within a small part of the x axis: which part, and where there is room.

use crate::chart::series::Series;

/// A line is flat where it stays within this part of the height of the chart.
const FLAT: f64 = 0.01;
/// An inset is called for where the lines are flat outside of this part of the x axis.
const SHORT: f64 = 0.1;
/// The inset shows so much of the flat parts, in lengths of what happens: before and after it.
const AROUND: [f64; 2] = [0.1, 0.4];
/// An inset lower than this part of the height shows nothing.
const LOWEST: f64 = 0.4;
/// Free room around the inset, as a part of the height, and of the width beside what happens.
const GAP: f64 = 0.04;

/// An enlarged part of a chart.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Inset {
    /// The part of the x axis that is shown.
    pub(crate) x: (f64, f64),
    /// The end of that part which lies nearer to the inset.
    pub(crate) edge: f64,
    /// Its place in the chart: left and right, as parts of the width.
    pub(crate) across: (f64, f64),
    /// Top and bottom, as parts of the height, from below.
    pub(crate) up: (f64, f64),
}

impl Inset {
    /// For lines in a chart with these linear axes; `None` where the chart is readable without, or has no room.
    pub(crate) fn of(series: &[Series], x: (f64, f64), y: (f64, f64)) -> Option<Self> {
        let lines: Vec<&[(f64, f64)]> =
            series.iter().filter(|series| series.is_line()).map(|series| series.points.as_slice()).collect();
        let flat = FLAT * (y.1 - y.0);
        let (from, to) =
            lines.iter().filter_map(|line| changing(line, flat)).reduce(|a, b| (a.0.min(b.0), a.1.max(b.1)))?;
        let (width, extent) = (to - from, x.1 - x.0);
        if width > SHORT * extent {
            return None;
        }
        let shown = ((from - AROUND[0] * width).max(x.0), (to + AROUND[1] * width).min(x.1));

        // On the side with more room, in the largest gap between the flat ends of the lines there.
        let is_right = x.1 - to >= from - x.0;
        let end = |line: &&[(f64, f64)]| if is_right { line.last().copied() } else { line.first().copied() };
        let mut levels: Vec<f64> = lines.iter().filter_map(end).map(|point| (point.1 - y.0) / (y.1 - y.0)).collect();
        levels.extend([0.0, 1.0]);
        levels.sort_by(f64::total_cmp);
        let gap =
            levels.windows(2).map(|pair| (pair[0], pair[1])).max_by(|a, b| (a.1 - a.0).total_cmp(&(b.1 - b.0)))?;
        let up = (gap.0 + GAP, gap.1 - GAP);
        let part = |value: f64| (value - x.0) / extent;
        let edge = if is_right { shown.1 } else { shown.0 };
        let free = if is_right { (part(edge), 1.0) } else { (0.0, part(edge)) };
        let margin = GAP * (free.1 - free.0);
        let inset = Self { x: shown, edge, across: (free.0 + 2.0 * margin, free.1 - margin), up };
        (up.1 - up.0 >= LOWEST).then_some(inset)
    }
}

/// The part of the x axis outside of which a line stays within `flat` of its ends; `None` if it does everywhere.
fn changing(line: &[(f64, f64)], flat: f64) -> Option<(f64, f64)> {
    let (first, last) = (line.first()?.1, line.last()?.1);
    let from = line.iter().position(|point| (point.1 - first).abs() > flat)?;
    // One further, where it is flat.
    let to = line.iter().rposition(|point| (point.1 - last).abs() > flat)? + 1;
    let at = |i: usize| line.get(i).map(|point| point.0);
    let (from, to) = (at(from.saturating_sub(1))?, at(to)?);
    Some((from.min(to), from.max(to)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::chart::series::Stroke;
    use std::f64::consts::PI;

    fn series(height: impl Fn(f64) -> f64) -> Series {
        let points = (0..=1000).map(|i| f64::from(i) * 1e-3).map(|x| (x, height(x))).collect();
        Series { label: String::new(), points, stroke: Stroke::Solid }
    }

    /// Rises within `width` after `start`, and stays or comes back.
    fn pulse(x: f64, start: f64, width: f64) -> f64 {
        if (start..start + width).contains(&x) { (PI * (x - start) / width).sin() } else { 0.0 }
    }

    /// Closed form: the length of the pulse.
    #[test]
    fn a_short_pulse_is_enlarged_where_there_is_room() {
        let inset = Inset::of(&[series(|x| pulse(x, 0.0, 0.04))], (0.0, 1.0), (-0.05, 1.05)).unwrap();
        assert_eq!(inset.x.0, 0.0);
        assert!((inset.x.1 - 0.056).abs() < 2e-3, "{inset:?}");
        // To the right of it and above the flat line at zero.
        assert!(inset.across.0 > 0.056 && inset.across.1 < 1.0 && inset.up.0 > 0.05 / 1.1 && inset.up.1 < 1.0);

        let late = Inset::of(&[series(|x| pulse(x, 0.9, 0.04))], (0.0, 1.0), (-0.05, 1.05)).unwrap();
        assert!(late.across.1 < 0.9 && late.x.0 < 0.9 && late.x.1 > 0.94, "{late:?}");

        // A step that stays at the top leaves room below.
        let step = Inset::of(&[series(|x| (x / 0.04).min(1.0))], (0.0, 1.0), (-0.05, 1.05)).unwrap();
        assert!(step.up.0 < 0.1 && step.up.1 < 1.05 / 1.1, "{step:?}");
    }

    #[test]
    fn there_is_no_inset_where_it_is_not_called_for() {
        let none = |series: &[Series]| Inset::of(series, (0.0, 1.0), (-0.05, 1.05)).is_none();
        assert!(none(&[series(|x| pulse(x, 0.0, 0.2))]), "a long pulse");
        assert!(none(&[series(|x| pulse(x, 0.0, 0.04)), series(|x| 0.3 * (30.0 * x).sin())]), "something later");
        assert!(none(&[series(|_| 0.5)]), "nothing at all");
        assert!(none(&[]));
        let levels = [0.0, 0.35, 0.7, 1.0].map(|level| series(move |x| level + 0.1 * pulse(x, 0.0, 0.04)));
        assert!(none(&levels), "no room");
    }
}
