//! The path of a line: the parts within the axes, and no more points than can be seen.

/// A point in shown values of both axes.
pub(crate) type Point = (f64, f64);

/// Lines with more points than this are thinned.
const MANY_POINTS: usize = 3000;

/// The parts of a line that lie within the ranges of the two axes.
pub(crate) fn clipped(line: Vec<Point>, x: (f64, f64), y: (f64, f64)) -> Vec<Vec<Point>> {
    let mut parts = vec![line];
    for inside in [&(|p: &Point| p.0 - x.0) as &dyn Fn(&Point) -> f64, &|p| x.1 - p.0, &|p| p.1 - y.0, &|p| y.1 - p.1] {
        parts = parts.iter().flat_map(|part| cut(part, inside)).collect();
    }
    parts
}

/// The parts of a line where a linear function of the place is not negative.
fn cut(line: &[Point], inside: &dyn Fn(&Point) -> f64) -> Vec<Vec<Point>> {
    let mut parts = Vec::new();
    let mut part: Vec<Point> = line.first().copied().filter(|point| inside(point) >= 0.0).into_iter().collect();
    for pair in line.windows(2) {
        let (a, b) = (pair[0], pair[1]);
        let (from, to) = (inside(&a), inside(&b));
        if (from < 0.0) != (to < 0.0) {
            let fraction = from / (from - to);
            part.push((a.0 + fraction * (b.0 - a.0), a.1 + fraction * (b.1 - a.1)));
        }
        if to >= 0.0 {
            part.push(b);
        } else if !part.is_empty() {
            parts.push(std::mem::take(&mut part));
        }
    }
    parts.push(part);
    parts.retain(|part| !part.is_empty());
    parts
}

/// The visible points of a long line that runs to the right, if it is `column` wide: each column keeps its first, lowest,
/// highest and last point, so that peaks survive. Other lines stay as they are.
pub(crate) fn thinned(line: Vec<Point>, column: f64) -> Vec<Point> {
    if line.len() <= MANY_POINTS || !line.is_sorted_by(|a, b| a.0 <= b.0) {
        return line;
    }
    let mut kept = Vec::new();
    for group in line.chunk_by(|a, b| (a.0 / column).floor() == (b.0 / column).floor()) {
        let by_height = |a: &&Point, b: &&Point| a.1.total_cmp(&b.1);
        let mut four: Vec<Point> = [group.first(), group.last()].into_iter().flatten().copied().collect();
        four.extend(group.iter().min_by(by_height));
        four.extend(group.iter().max_by(by_height));
        four.sort_by(|a, b| a.0.total_cmp(&b.0));
        kept.extend(four);
    }
    kept.dedup();
    kept
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Closed form: the places where the lines cross.
    #[test]
    fn a_line_is_cut_where_it_leaves_the_axes() {
        let line = [(0.0, 0.0), (1.0, 2.0), (2.0, 0.0), (3.0, 0.5), (4.0, 3.0)];
        let all = (-1.0, 5.0);
        let below = clipped(line.to_vec(), all, (0.0, 1.0));
        assert_eq!(below, [vec![(0.0, 0.0), (0.5, 1.0)], vec![(1.5, 1.0), (2.0, 0.0), (3.0, 0.5), (3.2, 1.0)]]);
        let above = clipped(line.to_vec(), all, (1.0, 9.0));
        assert_eq!(above, [vec![(0.5, 1.0), (1.0, 2.0), (1.5, 1.0)], vec![(3.2, 1.0), (4.0, 3.0)]]);
        assert!(clipped(line.to_vec(), (5.0, 6.0), all).is_empty());
        assert_eq!(clipped(line.to_vec(), all, all), [line.to_vec()]);
        // One that runs along the edge stays.
        let edge = vec![(0.0, 0.0), (1.0, 0.0)];
        assert_eq!(clipped(edge.clone(), all, (0.0, 1.0)), [edge]);
    }

    #[test]
    fn a_thinned_line_keeps_its_ends_and_its_peak() {
        let height = |i: usize| if i == 12_345 { 3.0 } else { (i as f64 * 0.37).sin() };
        let line: Vec<Point> = (0..100_000).map(|i| (i as f64, height(i))).collect();
        let kept = thinned(line.clone(), 100.0);
        assert!(kept.len() <= 4000, "{}", kept.len());
        assert!(kept.contains(&(12_345.0, 3.0)) && kept[0] == line[0] && kept.last() == line.last());
    }
}
