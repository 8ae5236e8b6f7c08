//! Motions that grow.

use dynamics::ScaledEquations;
use faer::Mat;
use linear::{LinearError, SecondOrder};

/// Parts of the fastest frequency that rounding gives a pole, of one that stands alone.
const ROUNDING: f64 = 1e-12;
/// A part of its own size that is rounding in a pole.
const OWN: f64 = 1e-9;

/// A sentence about motions of equations that grow, of whose coordinates the first `rigid` deform nothing; none where all decay or stay.
///
/// # Errors
/// [`LinearError::Eigen`].
pub(super) fn growing(equations: &SecondOrder, rigid: usize) -> Result<Option<String>, LinearError> {
    let kept = without_loose(equations);
    if kept.is_empty() {
        return Ok(None);
    }
    let of_kept = |matrix: &Mat<f64>| Mat::from_fn(kept.len(), kept.len(), |i, j| matrix[(kept[i], kept[j])]);
    let scaled = ScaledEquations::new(&of_kept(&equations.stiffness), &of_kept(&equations.damping));
    let poles = scaled.matrix.eigenvalues().map_err(|_| LinearError::Eigen { size: scaled.matrix.nrows() })?;
    let slow =
        kept.iter().zip(&scaled.scales).filter(|(k, _)| **k < rigid).map(|(_, scale)| *scale).fold(0.0, f64::max);
    let least = scaled.zero(slow, ROUNDING);
    let growing = poles.iter().filter(|pole| pole.im >= 0.0 && pole.re > least.max(OWN * pole.norm()));
    let (count, most) = growing.fold((0, 0.0_f64), |(count, most), pole| (count + 1, most.max(pole.re)));
    let subject =
        if count == 1 { "1 motion grows, ".to_owned() } else { format!("{count} motions grow, the fastest ") };
    let told = || format!("unstable: {subject}at {most:.3e} per time; small motions do not stay small");
    Ok((count > 0).then(told))
}

/// Coordinates without those that nothing acts on, or that act on nothing: their poles are zeros, whatever the others do.
fn without_loose(equations: &SecondOrder) -> Vec<usize> {
    let SecondOrder { stiffness, damping, .. } = equations;
    let mut kept: Vec<usize> = (0..equations.size()).collect();
    loop {
        let is_zero = |i: usize, j: usize| stiffness[(i, j)] == 0.0 && damping[(i, j)] == 0.0;
        let is_loose = |k: usize| kept.iter().all(|j| is_zero(k, *j)) || kept.iter().all(|i| is_zero(*i, k));
        let Some(loose) = kept.iter().position(|k| is_loose(*k)) else { return kept };
        kept.remove(loose);
    }
}

#[cfg(test)]
mod tests {
    use linear::Channel;

    use super::*;

    fn equations<const N: usize>(stiffness: [[f64; N]; N], damping: [[f64; N]; N]) -> SecondOrder {
        SecondOrder {
            stiffness: Mat::from_fn(N, N, |i, j| stiffness[i][j]),
            damping: Mat::from_fn(N, N, |i, j| damping[i][j]),
            forces: Mat::zeros(N, 0),
            inputs: Vec::new(),
            outputs: Vec::new(),
            coordinates: (0..N).map(|i| Channel::new(format!("x{i}"), "")).collect(),
        }
    }

    /// Closed form: η'' = 1e-4 η grows at 1e-2, beside shapes at 1e7 and 1.4e6 rad per time.
    #[test]
    fn slow_growth_is_told_beside_fast_shapes() {
        let stiffness = [[-1e-4, 1.0, 0.0], [1.0, 1e14, 1e7], [0.0, 1e7, 2e12]];
        let told = growing(&equations(stiffness, [[0.0; 3]; 3]), 1).unwrap().unwrap();
        assert!(told.contains("1 motion grows, at 1.000e-2 per"), "{told}");
        let told = growing(&equations([[-2.0, 0.0], [0.0, -3.0]], [[0.0; 2]; 2]), 0).unwrap().unwrap();
        assert!(told.contains("2 motions grow, the fastest at 1.732e0 per"), "{told}");
    }

    /// Closed form: a free particle, seen from a frame that spins at 20, has the poles ±20i, twice, and its line of motion is no growth; nor is that
    /// of a drive, which nothing acts on.
    #[test]
    fn poles_that_rounding_parts_are_no_growth() {
        let (w, fast) = (20.0, 1e14);
        let damping = [[0.0, -2.0 * w, 0.0], [2.0 * w, 0.0, 0.0], [0.0; 3]];
        for coupling in [0.0, 1e3] {
            let stiffness = [[-w * w, 0.0, 0.0], [0.0, -w * w, coupling], [0.0, coupling, fast]];
            assert_eq!(growing(&equations(stiffness, damping), 2).unwrap(), None);
        }
        assert_eq!(growing(&equations([[0.0, 1e5], [0.0, fast]], [[0.0; 2]; 2]), 0).unwrap(), None);
    }
}
