//! Sums of the peaks of modes, which do not come at the same time.

use crate::error::ShockError;

/// The peak of a mode in some quantity, with its sign.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ModalPeak {
    /// Frequency of the mode, in any unit that all modes share.
    pub frequency: f64,
    /// Its damping ratio.
    pub damping_ratio: f64,
    /// The peak: shape times participation factor times the displacement of the spectrum.
    pub value: f64,
}

/// How peaks are summed, Eq. (R4).
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Sum {
    /// Σ |r|: an upper bound.
    Absolute,
    /// √Σ r²: modes far apart.
    Srss,
    /// √ΣΣ ρ r r, with the correlation of Der Kiureghian.
    Cqc,
}

impl Sum {
    /// The sum of these peaks.
    ///
    /// # Errors
    /// [`ShockError::Value`] for frequencies, dampings or peaks out of range.
    pub fn of(self, peaks: &[ModalPeak]) -> Result<f64, ShockError> {
        for peak in peaks {
            check(peak, self)?;
        }
        let squares = || peaks.iter().map(|peak| peak.value * peak.value).sum::<f64>();
        Ok(match self {
            Self::Absolute => peaks.iter().map(|peak| peak.value.abs()).sum(),
            Self::Srss => squares().sqrt(),
            Self::Cqc => {
                let pairs = peaks.iter().enumerate().flat_map(|(i, a)| peaks[..i].iter().map(move |b| (a, b)));
                let between: f64 = pairs.map(|(a, b)| correlation(a, b) * a.value * b.value).sum();
                (squares() + 2.0 * between).max(0.0).sqrt()
            }
        })
    }
}

fn check(peak: &ModalPeak, sum: Sum) -> Result<(), ShockError> {
    let refuse = |what, found, expected| Err(ShockError::Value { what, found, expected });
    if !peak.value.is_finite() {
        return refuse("the peak of a mode", peak.value, "a finite number");
    }
    if sum != Sum::Cqc {
        return Ok(());
    }
    if !(peak.frequency.is_finite() && peak.frequency > 0.0) {
        return refuse("the frequency of a mode", peak.frequency, "a positive number");
    }
    if !(peak.damping_ratio >= 0.0 && peak.damping_ratio.is_finite()) {
        return refuse("the damping ratio of a mode", peak.damping_ratio, "0 or more");
    }
    Ok(())
}

/// Correlation of two modes under white noise, Eq. (R5) (Der Kiureghian 1981).
pub fn correlation(a: &ModalPeak, b: &ModalPeak) -> f64 {
    let ratio = b.frequency / a.frequency;
    let (zeta_a, zeta_b) = (a.damping_ratio, b.damping_ratio);
    let apart = 1.0 - ratio * ratio;
    let below = apart * apart
        + 4.0 * zeta_a * zeta_b * ratio * (1.0 + ratio * ratio)
        + 4.0 * (zeta_a * zeta_a + zeta_b * zeta_b) * ratio * ratio;
    if below == 0.0 {
        return 1.0; // the same undamped oscillator
    }
    8.0 * (zeta_a * zeta_b).sqrt() * (zeta_a + ratio * zeta_b) * ratio.powf(1.5) / below
}
