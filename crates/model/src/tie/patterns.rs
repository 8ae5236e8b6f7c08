//! Patterns of forces over nodes that a joint ties one by one.

use faer::Mat;
use nalgebra::Vector3;

/// A pattern of which not more than this is left beside the others adds nothing.
const LEAST: f64 = 1e-6;

/// As many orthonormal patterns over places as there are places (n×n, one a column): the constant one, those that are linear in
/// the places, quadratic, and so on.
///
/// Forces on single nodes have responses that are nearly alike; those to these patterns are not.
pub(crate) fn patterns(places: &[Vector3<f64>]) -> Mat<f64> {
    let count = places.len();
    let center = places.iter().sum::<Vector3<f64>>() / count as f64;
    let size = places.iter().map(|x| (x - center).norm()).fold(f64::MIN_POSITIVE, f64::max);
    let scaled: Vec<Vector3<f64>> = places.iter().map(|x| (x - center) / size).collect();
    let mut found: Vec<Vec<f64>> = Vec::with_capacity(count);
    let mut next = 0;
    let add = |found: &mut Vec<Vec<f64>>, mut candidate: Vec<f64>| {
        let whole = norm(&candidate);
        // What is left may be small: a second round takes out what rounding has left in it.
        for _ in 0..2 {
            for other in &*found {
                let part: f64 = other.iter().zip(&candidate).map(|(a, b)| a * b).sum();
                candidate.iter_mut().zip(other).for_each(|(c, o)| *c -= part * o);
            }
        }
        let left = norm(&candidate);
        if left > LEAST * whole.max(LEAST) {
            candidate.iter_mut().for_each(|c| *c /= left);
            found.push(candidate);
        }
    };
    add(&mut found, vec![1.0; count]);
    // Each polynomial times a coordinate, in the order of degrees.
    while found.len() < count && next < found.len() {
        for axis in 0..3 {
            let candidate = found[next].iter().zip(&scaled).map(|(value, x)| value * x[axis]).collect();
            if found.len() < count {
                add(&mut found, candidate);
            }
        }
        next += 1;
    }
    // Places that are alike leave some out.
    for single in 0..count {
        if found.len() < count {
            add(&mut found, (0..count).map(|i| f64::from(u8::from(i == single))).collect());
        }
    }
    Mat::from_fn(count, count, |place, pattern| found[pattern][place])
}

fn norm(v: &[f64]) -> f64 {
    v.iter().map(|x| x * x).sum::<f64>().sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Conserved: patterns are orthonormal, and those of a line go up by one degree each: by as many changes of sign.
    #[test]
    fn patterns_of_a_line_are_polynomials_of_rising_degree() {
        let line: Vec<_> = (0..41).map(|i| Vector3::new(3.0, 0.1 * f64::from(i), -2.0)).collect();
        let face: Vec<_> = (0..25).map(|i| Vector3::new(f64::from(i % 5), 0.0, f64::from(i / 5))).collect();
        for places in [&line[..], &face[..], &[Vector3::x(); 3][..]] {
            let found = patterns(places);
            let product = found.transpose() * &found;
            for i in 0..places.len() {
                for j in 0..places.len() {
                    assert!((product[(i, j)] - f64::from(u8::from(i == j))).abs() < 1e-12);
                }
            }
        }
        let found = patterns(&line);
        for degree in 0..10 {
            let changes = (1..41).filter(|i| found[(*i, degree)] * found[(i - 1, degree)] < -1e-12).count();
            let zeros = (0..41).filter(|i| found[(*i, degree)].abs() < 1e-12).count();
            assert_eq!(changes + zeros, degree, "{degree}");
        }
    }
}
