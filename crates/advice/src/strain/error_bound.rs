//! Error of linear strain in each mode, at the amplitude that is expected of it.
//!
//! With the mode's [`Backbone`] that is known; without it, it is that of a slender bar or arch: a free bar bent by u at its
//! ends has its frequency lower by about 20 (u/L)², and the force that holds an L in another shape differs by about u/L.

use dynamics::MAX_LARGE;

use crate::motion::case::Case;
use crate::motion::response::Response;
use crate::strain::backbone::Backbone;
use crate::strain::error::StrainError;
use crate::table::estimate::Estimate;
use crate::table::number::Number;
use crate::table::relative::relative;
use crate::table::row::Worth;

/// Change of the frequency of a free bar over (u/L)².
const OF_BAR: f64 = 22.0;
/// Change of the force on an L over u/L.
const OF_ARCH: f64 = 3.0;
/// Deflection over the length of the body up to which bounds are believed: runs that come there are stopped or warn.
const BELIEVED: f64 = 0.3;

/// The modes that `large_deflection = "auto"` makes large, numbered from 0, ascending.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct LargeModes {
    /// Modes that it takes.
    pub taken: Vec<usize>,
    /// Modes that it would take if there could be more than [`MAX_LARGE`].
    pub left_out: Vec<usize>,
}

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
    relative((shift * (omega[k] * response.memory[k]).max(1.0)).max(OF_ARCH * deflection), 1.0)
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
        phase: frequency.abs() * case.body.circular_frequencies[k] * response.memory[k],
        statics: backbone.static_error(amplitude),
    }
}

impl Worth {
    /// Influence on the answer of what linear strain gets wrong of the mode, where its backbone is known.
    pub fn strain_influence(&self) -> f64 {
        self.strain.map_or(0.0, |error| relative(error.largest(), 1.0) * self.share)
    }
}

/// The modes whose strain is not to be linear, of the first `keep`: those with the largest influence.
pub(crate) fn large_modes(modes: &[Worth], keep: usize, tolerance: f64) -> LargeModes {
    let influence = |k: &usize| modes[*k].strain_influence();
    let mut wanted: Vec<usize> = (0..modes.len().min(keep)).filter(|k| influence(k) >= tolerance).collect();
    // The sort is stable: of equals, the lower modes first.
    wanted.sort_by(|a, b| influence(b).total_cmp(&influence(a)));
    let mut left_out = wanted.split_off(wanted.len().min(MAX_LARGE));
    wanted.sort_unstable();
    left_out.sort_unstable();
    LargeModes { taken: wanted, left_out }
}

/// The row of [`dynamics::Effect::LargeDeflection`].
pub(crate) fn large_deflection(modes: &[Worth], large: &LargeModes, deflection: f64) -> Estimate {
    let worst = modes.iter().enumerate().filter_map(|(k, mode)| Some((k, mode.strain?, mode.strain_influence())));
    let worst = worst.max_by(|a, b| a.2.total_cmp(&b.2));
    let Some((k, error, influence)) = worst else {
        let influence = modes.iter().map(|mode| mode.strain_bound).fold(0.0, f64::max);
        let why = match deflection {
            0.0 => "The body does not bend.".into(),
            _ => {
                format!("Linear strain has frequencies off by about {:.1e} at most.", OF_BAR * deflection * deflection)
            }
        };
        return Estimate { value: OF_BAR * deflection * deflection, influence, why };
    };
    let StrainError { deflection, frequency, phase, statics } = error;
    let mut why = format!(
        "Mode {} bends the body by at most {:.2} % of its length: linear strain has its frequency {:.2} % too {}, its \
         phase out by {} rad, and what holds it in place off by {:.2} %.",
        k + 1,
        100.0 * deflection,
        100.0 * frequency.abs(),
        if frequency < 0.0 { "high" } else { "low" },
        Number(phase),
        100.0 * statics,
    );
    if frequency > OF_BAR * deflection * deflection {
        why += " A slender bar does not stiffen so with its amplitude: where the body is one, the elements along it are too long \
                for its thickness (membrane locking), and a finer mesh shows what is right.";
    }
    if !large.left_out.is_empty() {
        why += &format!(
            " Modes {} would be large, too, but {MAX_LARGE} are the most that can be.",
            numbers(&large.left_out)
        );
    }
    Estimate { value: frequency.abs(), influence, why }
}

/// "1, 2, 5" of modes that are numbered from 0.
fn numbers(modes: &[usize]) -> String {
    modes.iter().map(|k| (k + 1).to_string()).collect::<Vec<_>>().join(", ")
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
    fn of_more_modes_than_can_be_large_those_with_the_largest_errors_are_taken() {
        // From 0.1 to 1.1 rad, the largest in the middle.
        let mut modes: Vec<Worth> = [0.1, 0.3, 0.5, 0.7, 0.9, 1.0, 0.8, 0.6, 0.4, 0.2].map(out_of_phase).into();
        let found = large_modes(&modes, 10, 1e-3);
        assert_eq!((found.taken, found.left_out), (vec![1, 2, 3, 4, 5, 6, 7, 8], vec![0, 9]));
        let row = large_deflection(&modes, &large_modes(&modes, 10, 1e-3), 0.2).row(1e-3);
        assert!(
            row.on && row.why.contains("Mode 6 bends") && row.why.contains("Modes 1, 10 would be large"),
            "{row:?}"
        );
        // With fewer modes, and with a tolerance above the others: 0.5 of 0.8 rad.
        assert_eq!(large_modes(&modes, 3, 1e-3).taken, [0, 1, 2]);
        assert_eq!(large_modes(&modes, 10, 0.39), LargeModes { taken: vec![4, 5, 6], left_out: vec![] });
        // A mode that hardly moves may be out of phase; it is not worth it.
        modes[5].share = 1e-4;
        assert!(!large_modes(&modes, 10, 1e-3).taken.contains(&5));
    }

    /// A free rod of slenderness 100 in five elements of second order stiffens by 22 % where it is bent by 5 % of its length;
    /// in twenty it softens by 0.8 %.
    #[test]
    fn what_a_mesh_locks_is_not_taken_for_the_truth() {
        let why = |frequency: f64| {
            let mut mode = out_of_phase(1.0);
            mode.strain = mode.strain.map(|strain| StrainError { deflection: 0.05, frequency, ..strain });
            large_deflection(&[mode], &LargeModes::default(), 0.05).row(1e-3).why
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
