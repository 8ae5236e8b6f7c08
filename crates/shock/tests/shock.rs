//! Spectra and sums against closed forms and a second integration.

use std::f64::consts::{PI, TAU};

use shock::{BaseMotion, Following, ModalPeak, ShockError, Sum, correlation};

fn close(found: f64, expected: f64, tolerance: f64) {
    assert!((found - expected).abs() <= tolerance * expected.abs(), "{found} instead of {expected}");
}

/// Closed form: an oscillator of 50 cycles in one of a half sine follows all of it; what is left is largest after it, where a wave of 2β/(1 − β²) goes
/// on, β = 1/100. One of 1e-3 cycles follows nothing.
#[test]
fn a_fast_oscillator_follows_the_base_and_a_slow_one_does_not() {
    let half_sine = pulse(|t| (PI * t).sin());
    let Following { peaks, correlation, part, rest } = half_sine.following(50.0, 0.0).unwrap();
    assert_eq!(peaks, half_sine.peaks(50.0, 0.0).unwrap());
    close(part, 1.0, 1e-3);
    close(correlation, 1.0, 1e-3);
    close(rest.acceleration(), 2.0 * 0.01 / (1.0 - 1e-4), 1e-4);
    close(rest.displacement * (50.0 * TAU).powi(2), rest.acceleration(), 1e-4);
    assert!(half_sine.following(1e-3, 0.0).unwrap().part < 1e-3);
}

/// A pulse of duration 1 as a table of straight pieces.
fn pulse(of: impl Fn(f64) -> f64) -> BaseMotion {
    const ROWS: usize = 4000;
    let times: Vec<f64> = (0..=ROWS).map(|k| k as f64 / ROWS as f64).collect();
    let accelerations = times.iter().map(|t| of(*t)).collect();
    BaseMotion::new(times, accelerations).unwrap()
}

#[test]
fn a_step_of_the_base_overshoots() {
    let step = BaseMotion::new(vec![0.0, 2.0], vec![3.0, 3.0]).unwrap();
    for zeta in [0.0, 0.05, 0.5, 0.9] {
        let frequency = 1.7;
        let omega = TAU * frequency;
        // Closed form: the answer to a step overshoots by exp(−πζ/√(1 − ζ²)). Undamped, the end of the step adds to it.
        let overshoot = 1.0 + (-PI * zeta / (1.0_f64 - zeta * zeta).sqrt()).exp();
        let peaks = step.peaks(frequency, zeta).unwrap();
        if zeta > 0.0 {
            close(peaks.displacement, 3.0 * overshoot / (omega * omega), 1e-6);
        } else {
            // Closed form: z = −3 (1 − cos ωt)/ω², and after the pulse of length τ an amplitude of 6 |sin(ωτ/2)|/ω².
            close(peaks.displacement, 6.0 / (omega * omega), 1e-6);
            close(-peaks.acceleration_least, 6.0 * (omega).sin().abs(), 1e-6);
        }
    }
}

#[test]
fn a_half_sine_gives_its_known_spectrum() {
    let half_sine = pulse(|t| (PI * t).sin());
    // Closed form: with β = period/(2 · duration), z ω² = (sin πt − β sin ωt)/(1 − β²) during the pulse, whose largest value
    // for β = 1/2 is sin(2π/3)/(1 − β); after it the amplitude is 2β cos(π/2β)/(1 − β²), here for β = 2.
    let during = half_sine.peaks(1.0, 0.0).unwrap();
    close(during.acceleration(), (TAU / 3.0).sin() / 0.5, 1e-6);
    close(during.displacement * TAU * TAU, (TAU / 3.0).sin() / 0.5, 1e-6);
    let after = half_sine.peaks(0.25, 0.0).unwrap();
    close(after.acceleration_largest, 4.0 * (PI / 4.0).cos() / 3.0, 1e-6);
    close(-after.acceleration_least, 4.0 * (PI / 4.0).cos() / 3.0, 1e-6);
}

#[test]
fn slow_oscillators_stay_and_fast_ones_follow() {
    let sine = pulse(|t| (TAU * t).sin());
    // Closed form: a base that is moved by 1/(2π) and stops there leaves a slow mass behind. (1e-5: straight pieces, and the
    // square of ω; 4000 steps of 4e-9 of a period keep their digits.)
    close(sine.peaks(1e-5, 0.0).unwrap().displacement, 1.0 / TAU, 1e-5);
    // Closed form: a fast mass has the acceleration of the base, whose largest is 1; ripples of rows are π/(f · 4000²).
    close(sine.peaks(500.0, 0.05).unwrap().acceleration(), 1.0, 2e-4);
}

/// A second implementation: Runge–Kutta of fourth order in fine steps, extremes of the steps' ends.
fn by_runge_kutta(rows: &[(f64, f64)], frequency: f64, zeta: f64) -> [f64; 3] {
    let omega = TAU * frequency;
    let base = |t: f64| {
        let k = rows.partition_point(|row| row.0 < t).max(1);
        let Some((t1, a1)) = rows.get(k) else { return 0.0 };
        let (t0, a0) = rows[k - 1];
        a0 + (a1 - a0) * (t - t0) / (t1 - t0)
    };
    let rate = |t: f64, [z, v]: [f64; 2]| [v, -base(t) - 2.0 * zeta * omega * v - omega * omega * z];
    let mut out = [0.0_f64; 3];
    let mut y = [0.0; 2];
    let pieces: Vec<[f64; 2]> = rows.windows(2).map(|rows| [rows[0].0, rows[1].0]).collect();
    let end = rows[rows.len() - 1].0;
    for [from, to] in pieces.into_iter().chain([[end + 1e-12, end + 2.0 / frequency]]) {
        const STEPS: usize = 4000;
        let h = (to - from) / STEPS as f64;
        for k in 0..STEPS {
            // Within the piece, so that no rate is taken beyond its ends.
            let t = from + h * k as f64;
            let add = |y: [f64; 2], k: [f64; 2], h: f64| [y[0] + h * k[0], y[1] + h * k[1]];
            let k1 = rate(t + 1e-9 * h, y);
            let k2 = rate(t + 0.5 * h, add(y, k1, 0.5 * h));
            let k3 = rate(t + 0.5 * h, add(y, k2, 0.5 * h));
            let k4 = rate(t + h * (1.0 - 1e-9), add(y, k3, h));
            y = std::array::from_fn(|i| y[i] + h / 6.0 * (k1[i] + 2.0 * k2[i] + 2.0 * k3[i] + k4[i]));
            let acceleration = -(2.0 * zeta * omega * y[1] + omega * omega * y[0]);
            out = [out[0].max(y[0].abs()), out[1].max(acceleration), out[2].min(acceleration)];
        }
    }
    out
}

#[test]
fn uneven_tables_agree_with_runge_kutta() {
    let rows = [(0.0, 0.0), (0.13, 4.0), (0.2, -1.0), (0.55, 2.5), (0.6, -3.0), (1.1, 0.7)];
    let motion = BaseMotion::new(rows.map(|row| row.0).to_vec(), rows.map(|row| row.1).to_vec()).unwrap();
    for (frequency, zeta) in
        [(0.4, 0.02), (2.3, 0.0), (2.3, 0.1), (7.0, 0.7), (2.3, 1.0), (2.3, 1.0 + 1e-9), (2.3, 1.3), (2.3, 4.0)]
    {
        let [displacement, largest, least] = by_runge_kutta(&rows, frequency, zeta);
        let peaks = motion.peaks(frequency, zeta).unwrap();
        close(peaks.displacement, displacement, 2e-6);
        close(peaks.acceleration_largest, largest, 2e-6);
        close(peaks.acceleration_least, least, 2e-6);
    }
}

fn mode(frequency: f64, damping_ratio: f64, value: f64) -> ModalPeak {
    ModalPeak { frequency, damping_ratio, value }
}

#[test]
fn the_correlation_is_that_of_white_noise() {
    // Closed form: for white noise the moments a = E z₁z₂ and b = E z₁v₂ = −E v₁z₂ of two oscillators obey
    // 2 b (ζ₁ω₁ + ζ₂ω₂) = a (ω₁² − ω₂²),  E v₁v₂ = 2ζ₂ω₂ b + ω₂² a,  2 (ζ₁ω₁ + ζ₂ω₂) E v₁v₂ = 1 − b (ω₁² − ω₂²).
    let covariance = |w1: f64, z1: f64, w2: f64, z2: f64| {
        let decay = z1 * w1 + z2 * w2;
        let b = (w1 * w1 - w2 * w2) / (2.0 * decay);
        1.0 / (2.0 * decay * (2.0 * z2 * w2 * b + w2 * w2) + b * (w1 * w1 - w2 * w2))
    };
    for (w1, z1, w2, z2) in
        [(1.0, 0.05, 1.1, 0.05), (3.0, 0.01, 2.0, 0.2), (1.0, 0.3, 5.0, 0.02), (1.0, 0.02, 5.0, 3.0)]
    {
        let own = covariance(w1, z1, w1, z1) * covariance(w2, z2, w2, z2);
        close(correlation(&mode(w1, z1, 1.0), &mode(w2, z2, 1.0)), covariance(w1, z1, w2, z2) / own.sqrt(), 1e-12);
    }
}

#[test]
fn sums_know_their_limits() {
    let apart = [mode(1.0, 0.01, 3.0), mode(50.0, 0.01, -4.0)];
    // Closed form: 3 and 4 at a right angle are 5; modes far apart are not correlated (ρ = 2e-6 here).
    close(Sum::Absolute.of(&apart).unwrap(), 7.0, 1e-15);
    close(Sum::Srss.of(&apart).unwrap(), 5.0, 1e-15);
    close(Sum::Cqc.of(&apart).unwrap(), 5.0, 1e-5);
    // Closed form: peaks of one and the same oscillator come together, with their signs.
    let same = [mode(2.0, 0.03, 3.0), mode(2.0, 0.03, -4.0)];
    close(Sum::Cqc.of(&same).unwrap(), 1.0, 1e-12);
}

#[test]
fn a_spectrum_is_read_between_its_frequencies_and_not_beyond() {
    let half_sine = pulse(|t| (PI * t).sin());
    let frequencies: Vec<f64> = (0..=200).map(|k| 0.1 * 100.0_f64.powf(f64::from(k) / 200.0)).collect();
    let spectrum = half_sine.spectrum(&frequencies, 0.05).unwrap();
    // Independent reference: the oscillator itself.
    close(spectrum.displacement_at(1.234).unwrap(), half_sine.peaks(1.234, 0.05).unwrap().displacement, 1e-3);
    close(spectrum.displacement_at(frequencies[200]).unwrap(), spectrum.peaks[200].displacement, 1e-15);
    let beyond = spectrum.displacement_at(11.0).unwrap_err();
    assert!(matches!(beyond, ShockError::NotCovered { .. }));
    assert!(beyond.to_string().contains("does not cover"), "{beyond}");
}

#[test]
fn bad_input_is_told_with_its_row() {
    let text = |times: &[f64], accelerations: &[f64]| {
        BaseMotion::new(times.to_vec(), accelerations.to_vec()).unwrap_err().to_string()
    };
    assert!(text(&[0.0], &[1.0]).contains("two or more"));
    assert!(text(&[0.0, 1.0, 1.0], &[0.0; 3]).contains("the time in row 3: found 1"));
    assert!(text(&[0.0, 1.0], &[0.0, f64::NAN]).contains("the acceleration in row 2"));
    let motion = BaseMotion::new(vec![0.0, 1.0], vec![1.0, 1.0]).unwrap();
    for (frequency, zeta, expected) in [
        (0.0, 0.1, "a frequency"),
        (1.0, -0.1, "the damping ratio"),
        (1.0, f64::NAN, "the damping ratio"),
        (1e9, 0.1, "cycles"),
    ] {
        assert!(motion.peaks(frequency, zeta).unwrap_err().to_string().contains(expected));
    }
    assert!(motion.spectrum(&[2.0, 1.0], 0.1).is_err());
    assert!(Sum::Cqc.of(&[mode(0.0, 0.1, 1.0)]).is_err());
    assert!(Sum::Srss.of(&[mode(1.0, 0.1, f64::NAN)]).is_err());
}

/// Two equal masses, each on a spring of stiffness k above the one below, on a base.
#[test]
fn the_absolute_sum_bounds_two_masses() {
    const STIFFNESS: f64 = 400.0;
    const ZETA: f64 = 0.03;
    let motion = pulse(|t| (PI * t).sin() + 0.5 * (7.0 * PI * t).sin());
    // Closed form: frequencies and shapes of [[2, −1], [−1, 1]] are those of the golden ratio.
    let golden = (1.0 + 5.0_f64.sqrt()) / 2.0;
    let modes = [golden - 1.0, golden].map(|root| {
        let omega = STIFFNESS.sqrt() * root;
        let shape = [1.0, 2.0 - root * root]; // of the lower and of the upper mass
        let factor = (shape[0] + shape[1]) / (shape[0] * shape[0] + shape[1] * shape[1]);
        (omega, shape, factor)
    });
    let peaks = modes.map(|(omega, shape, factor)| {
        let displacement = motion.peaks(omega / TAU, ZETA).unwrap().displacement;
        ModalPeak { frequency: omega / TAU, damping_ratio: ZETA, value: factor * shape[1] * displacement }
    });
    // Independent reference: the coupled equations by Runge–Kutta, damping Σ 2ζω φφᵀ/φᵀφ.
    let rate = |t: f64, y: [f64; 4]| {
        let base = if t <= 1.0 { (PI * t).sin() + 0.5 * (7.0 * PI * t).sin() } else { 0.0 };
        let mut out = [y[2], y[3], 0.0, 0.0];
        let force = [STIFFNESS * (y[1] - 2.0 * y[0]), STIFFNESS * (y[0] - y[1])];
        for i in 0..2 {
            let damping: f64 = modes
                .iter()
                .map(|(omega, shape, _)| {
                    let length = shape[0] * shape[0] + shape[1] * shape[1];
                    2.0 * ZETA * omega * shape[i] * (shape[0] * y[2] + shape[1] * y[3]) / length
                })
                .sum();
            out[2 + i] = force[i] - damping - base;
        }
        out
    };
    let (mut y, mut most, h) = ([0.0; 4], 0.0_f64, 1e-4);
    for k in 0..25_000 {
        let t = f64::from(k) * h;
        let add = |d: [f64; 4], h: f64| -> [f64; 4] { std::array::from_fn(|i| y[i] + h * d[i]) };
        let k1 = rate(t, y);
        let k2 = rate(t + 0.5 * h, add(k1, 0.5 * h));
        let k3 = rate(t + 0.5 * h, add(k2, 0.5 * h));
        let k4 = rate(t + h, add(k3, h));
        y = std::array::from_fn(|i| y[i] + h / 6.0 * (k1[i] + 2.0 * k2[i] + 2.0 * k3[i] + k4[i]));
        most = most.max(y[1].abs());
    }
    let sum = |rule: Sum| rule.of(&peaks).unwrap();
    assert!(most <= sum(Sum::Absolute) && most >= peaks[0].value.abs() - peaks[1].value.abs());
    // Regression only: how far the two others are from the truth for this motion.
    close(sum(Sum::Srss), most, 0.1);
    close(sum(Sum::Cqc), most, 0.1);
    // Closed form: the factors of all modes of a mass add up to 1.
    close(modes.iter().map(|(_, shape, factor)| factor * shape[1]).sum(), 1.0, 1e-12);
}
