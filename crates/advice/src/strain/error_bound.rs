//! Error of linear strain in each mode, at the amplitude that is expected of it.
//!
//! With the mode's [`Backbone`] that is known; without it, it is that of a slender bar or arch: a free bar bent by u at its
//! ends has its frequency lower by about 20 (u/L)², and the force that holds an L in another shape differs by about u/L.

use crate::motion::case::Case;
use crate::motion::response::Response;
use crate::strain::backbone::Backbone;
use crate::strain::error::StrainError;
use crate::table::estimate::Estimate;
use crate::table::number::Number;
use crate::table::relative::relative;
use crate::table::row::Worth;

/// Change of the frequency of a free bar over (u/L)².
pub(crate) const OF_BAR: f64 = 22.0;
/// Change of the force on an L over u/L.
const OF_ARCH: f64 = 3.0;
/// Deflection over the length of the body up to which bounds are believed: runs that come there are stopped or warn.
const BELIEVED: f64 = 0.3;
/// A mode is large where its coordinate reaches this part of the largest.
const PART: f64 = 0.3;
/// Most modes that are large by themselves: with more of them the motion is worse.
const MOST: usize = 2;
/// Modes whose frequencies differ by less than this part are a pair: their shapes are any two of those that they span.
const PAIR: f64 = 0.01;

/// The expected amplitudes as a part of the bounds. Bounds of bodies that are driven or stiffened by their spin may be
/// far above all that could happen; what they say of the modes beside each other is kept.
pub(crate) fn believed(deflection: f64) -> f64 {
    if deflection > BELIEVED { BELIEVED / deflection } else { 1.0 }
}

/// Influence of linear strain on mode `k` with an expected amplitude, as far as it is known without its backbone.
pub(crate) fn screen(case: &Case, response: &Response, k: usize, amplitude: f64) -> f64 {
    let omega = &case.body.circular_frequencies;
    let lowest = omega.iter().copied().fold(f64::INFINITY, f64::min);
    let deflection = amplitude * case.peaks[k] / case.length;
    let shift = OF_BAR * deflection * deflection * omega[k] / lowest;
    let steady = OF_ARCH * response.steady[k].min(amplitude) * case.peaks[k] / case.length;
    let swings = omega[k] * response.memory[k];
    relative((shift * swings.max(1.0)).max(OF_ARCH * deflection).max(0.5 * steady * swings), 1.0)
}

/// Error of linear strain in mode `k` by its backbone.
pub(crate) fn by_backbone(
    case: &Case,
    response: &Response,
    k: usize,
    amplitude: f64,
    backbone: &Backbone,
) -> StrainError {
    let frequency = backbone.shift(amplitude);
    StrainError {
        deflection: amplitude * case.peaks[k] / case.length,
        frequency,
        // Where it is held to one side, its frequency changes by a first order.
        phase: (frequency.abs() + 0.5 * (backbone.cubic * response.steady[k].min(amplitude)).abs())
            * case.body.circular_frequencies[k]
            * response.memory[k],
        statics: backbone.static_error(amplitude),
    }
}

impl Worth {
    /// Influence on the answer of what linear strain gets wrong of the mode, where its backbone is known.
    pub fn strain_influence(&self) -> f64 {
        self.strain.map_or(0.0, |error| relative(error.largest(), 1.0) * self.share)
    }
}

/// The modes whose strain is not to be linear, of the first `keep`, numbered from 0, ascending: none where linear strain is
/// right within the tolerance.
pub(crate) fn large_modes(modes: &[Worth], keep: usize, tolerance: f64) -> Vec<usize> {
    let matters = modes.iter().take(keep).any(|mode| mode.strain_influence() >= tolerance);
    if matters { furthest_modes(modes, keep) } else { Vec::new() }
}

/// The modes that move furthest of the first `keep`, numbered from 0, ascending: those whose coordinates reach a part of the
/// largest, two at most, and both of a pair with one frequency.
pub(crate) fn furthest_modes(modes: &[Worth], keep: usize) -> Vec<usize> {
    let displacement = |k: &usize| modes[*k].displacement;
    let mut order: Vec<usize> = (0..modes.len().min(keep)).filter(|k| displacement(k) > 0.0).collect();
    // The sort is stable: of equals, the lower modes first.
    order.sort_by(|a, b| displacement(b).total_cmp(&displacement(a)));
    let Some(first) = order.first().copied() else { return order };
    let omega = |k: usize| modes[k].circular_frequency;
    let is_pair = |k: &usize| *k != first && (omega(*k) - omega(first)).abs() <= PAIR * omega(first);
    let mut large = match (0..modes.len().min(keep)).find(is_pair) {
        Some(other) => vec![first, other],
        None => order.into_iter().filter(|k| displacement(k) >= PART * displacement(&first)).take(MOST).collect(),
    };
    large.sort_unstable();
    large
}

/// The row of [`dynamics::Effect::LargeDeflection`].
pub(crate) fn large_deflection(modes: &[Worth], deflection: f64, (length, unit): (f64, &str)) -> Estimate {
    let worst = modes.iter().enumerate().filter_map(|(k, mode)| Some((k, mode.strain?, mode.strain_influence())));
    let worst = worst.max_by(|a, b| a.2.total_cmp(&b.2));
    let Some((k, error, influence)) = worst else {
        let influence = modes.iter().map(|mode| mode.strain_bound).fold(0.0, f64::max);
        let why = match deflection {
            0.0 => "The body does not bend.".into(),
            _ if deflection > 1.0 => "How far the body bends cannot be told before the run.".into(),
            _ => format!("Linear strain has frequencies right to {}.", Number(OF_BAR * deflection * deflection)),
        };
        return Estimate { value: OF_BAR * deflection * deflection, influence, why };
    };
    let StrainError { deflection, frequency, phase, statics } = error;
    let mut why = format!(
        "Mode {} moves the body by up to {} {}: linear strain has its frequency {} % too {}, its phase out by {} rad, and what \
         holds it in place off by {} %.",
        k + 1,
        Number(deflection * length),
        unit,
        Number(100.0 * frequency.abs()),
        if frequency < 0.0 { "high" } else { "low" },
        Number(phase),
        Number(100.0 * statics),
    );
    if frequency > OF_BAR * deflection * deflection {
        why += " A slender bar does not stiffen so with its amplitude: where the body is one, the elements along it are too long \
                for its thickness (membrane locking), and a finer mesh shows what is right.";
    }
    Estimate { value: frequency.abs(), influence, why }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A mode that linear strain has out of phase by an angle.
    fn out_of_phase(phase: f64) -> Worth {
        let strain = StrainError { deflection: 0.02, frequency: -0.01, phase, statics: 0.0 };
        Worth {
            circular_frequency: 1.0,
            displacement: 1.0,
            share: 0.5,
            worth_keeping: true,
            strain_bound: 1.0,
            strain: Some(strain),
        }
    }

    #[test]
    fn the_modes_that_move_furthest_are_large_and_both_of_a_pair() {
        let moved =
            |omega: f64, displacement: f64| Worth { circular_frequency: omega, displacement, ..out_of_phase(0.5) };
        let modes = [moved(1.0, 0.2), moved(3.0, 1.0), moved(7.0, 0.5), moved(9.0, 0.4)];
        assert_eq!(large_modes(&modes, 4, 1e-3), [1, 2]);
        assert_eq!(large_modes(&modes[..2], 2, 1e-3), [1]);
        // With fewer modes, and with a tolerance above the influence of all: 0.5 of 0.5 rad.
        assert_eq!(large_modes(&modes, 1, 1e-3), [0]);
        assert_eq!(large_modes(&modes, 4, 0.26), [] as [usize; 0]);
        assert_eq!(furthest_modes(&modes, 4), [1, 2]);
        // Any two shapes of a pair will do: one of them may hardly move.
        let pair = [moved(1.0, 1.0), moved(1.003, 0.0), moved(7.0, 0.5)];
        assert_eq!(large_modes(&pair, 3, 1e-3), [0, 1]);
        assert_eq!(furthest_modes(&[moved(1.0, 0.0)], 1), [] as [usize; 0]);
    }

    /// A free rod of slenderness 100 in five elements of second order stiffens by 22 % where it is bent by 5 % of its length;
    /// in twenty it softens by 0.8 %.
    #[test]
    fn what_a_mesh_locks_is_not_taken_for_the_truth() {
        let why = |frequency: f64| {
            let mut mode = out_of_phase(1.0);
            mode.strain = mode.strain.map(|strain| StrainError { deflection: 0.05, frequency, ..strain });
            large_deflection(&[mode], 0.05, (1.0, "m")).row(1e-3).why
        };
        assert!(why(0.22).contains("too long for its thickness"), "{}", why(0.22));
        assert!(!why(-0.008).contains("too long") && !why(0.01).contains("too long"));
    }

    /// Closed form: the largest bound that is believed.
    #[test]
    fn bounds_that_nothing_can_reach_are_scaled_down() {
        assert_eq!(believed(0.2), 1.0);
        assert!((350.0 * believed(350.0) - BELIEVED).abs() < 1e-12);
    }
}
