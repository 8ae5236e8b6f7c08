//! A history in samples, and how far it swings an oscillator.

use dynamics::History;
use nalgebra::Complex;

/// A history from 0 to the end of the run as straight lines between samples.
#[derive(Debug, Clone)]
pub(crate) struct Course {
    pieces: Vec<Piece>,
    /// ∫|h| and max |h|.
    pub magnitude_integral: f64,
    /// max |∫₀ᵗ h|
    pub net_integral: f64,
    pub largest: f64,
    /// True if the straight lines follow it.
    resolved: bool,
}

/// Samples at equal distances between two discontinuities.
#[derive(Debug, Clone)]
struct Piece {
    step: f64,
    samples: Vec<f64>,
}

/// Intervals that one of few pieces begins with, and most intervals in a piece.
const FEWEST: usize = 64;
const MOST: usize = 1 << 15;
/// Intervals that pieces begin with, in all but for one in each: what lies between many discontinuities is short.
const FEWEST_IN_ALL: usize = 1 << 14;
/// Most intervals in all pieces, but for one in each.
const MAX_IN_ALL: usize = 1 << 22;
/// Distance of the lines from the history, of its largest value.
const CLOSE: f64 = 1e-3;
/// A part of loads that is rounding where they cancel.
const ROUNDING: f64 = 1e-12;

impl Course {
    /// The course of one history, `among` others that cost more than closed forms do.
    pub(crate) fn new(history: &History, end: f64, among: usize) -> Self {
        let stops = stops(&[history], end);
        let largest = history.largest(end);
        let counts = intervals(history, among, stops.len());
        let mut start = 0.0;
        let mut resolved = true;
        let mut pieces = Vec::with_capacity(stops.len());
        for stop in stops {
            if stop > start {
                let (piece, follows) = Piece::new(history, start, stop, CLOSE * largest, counts);
                pieces.push(piece);
                resolved &= follows;
                start = stop;
            }
        }
        let magnitude_integral = history.magnitude_integral(end);
        let net_integral = if resolved { net_integral(&pieces).min(magnitude_integral) } else { magnitude_integral };
        Self { pieces, magnitude_integral, net_integral, largest, resolved }
    }

    /// The courses of histories in the same samples, for [`Self::sum`].
    pub(crate) fn aligned(histories: &[&History], end: f64, among: usize) -> Vec<Self> {
        let mut courses: Vec<Self> = histories.iter().map(|history| Self::new(history, end, among)).collect();
        courses.iter_mut().for_each(|course| course.pieces.clear());
        let stops = stops(histories, end);
        let mut start = 0.0;
        for stop in stops.iter().copied() {
            if stop <= start {
                continue;
            }
            let found = histories.iter().zip(&courses).map(|(history, course)| {
                Piece::new(history, start, stop, CLOSE * course.largest, intervals(history, among, stops.len()))
            });
            let found: Vec<(Piece, bool)> = found.collect();
            let count = found.iter().map(|(piece, _)| piece.samples.len() - 1).max().unwrap_or(1);
            for ((course, history), (_, follows)) in courses.iter_mut().zip(histories).zip(found) {
                course.pieces.push(Piece::of(history, start, stop, count));
                course.resolved &= follows;
            }
            start = stop;
        }
        courses
    }

    /// The sum of courses in the same samples, times a factor each.
    pub(crate) fn sum(courses: &[(f64, &Self)]) -> Self {
        let total =
            |of: fn(&Self) -> f64| courses.iter().map(|(factor, course)| factor.abs() * of(course)).sum::<f64>();
        let resolved = courses.iter().all(|(_, course)| course.resolved);
        let count = courses.first().map_or(0, |(_, course)| course.pieces.len());
        let piece = |i: usize| {
            let parts = courses.iter().map(|(factor, course)| (*factor, &course.pieces[i]));
            let length = courses[0].1.pieces[i].samples.len();
            let at = |k: usize| parts.clone().map(|(factor, piece)| factor * piece.samples[k]).sum();
            Piece { step: courses[0].1.pieces[i].step, samples: (0..length).map(at).collect() }
        };
        let pieces: Vec<Piece> = (0..count).map(piece).collect();
        let most = total(|course| course.largest);
        // What is left of loads that cancel is rounding.
        let sampled = pieces.iter().flat_map(|piece| &piece.samples).fold(0.0_f64, |most, h| most.max(h.abs()));
        let largest = match resolved {
            true if sampled <= ROUNDING * most => {
                return Self { pieces: Vec::new(), magnitude_integral: 0.0, net_integral: 0.0, largest: 0.0, resolved };
            }
            true => sampled,
            false => most,
        };
        let magnitude_integral = total(|course| course.magnitude_integral);
        let net_integral = if resolved { net_integral(&pieces).min(magnitude_integral) } else { magnitude_integral };
        Self { pieces, magnitude_integral, net_integral, largest, resolved }
    }

    /// The same course less its first value: what its rate adds up to.
    pub(crate) fn risen(mut self) -> Self {
        let first = self.pieces.first().and_then(|piece| piece.samples.first()).copied().unwrap_or(0.0);
        let mut largest: f64 = 0.0;
        for h in self.pieces.iter_mut().flat_map(|piece| &mut piece.samples) {
            *h -= first;
            largest = largest.max(h.abs());
        }
        if self.resolved {
            self.largest = largest;
        } else {
            self.largest += first.abs();
        }
        let length: f64 = self.pieces.iter().map(|piece| piece.step * (piece.samples.len() - 1) as f64).sum();
        self.magnitude_integral = (self.magnitude_integral + first.abs() * length).min(self.largest * length);
        self
    }

    /// Bounds of |z| and |z'| on the way, where `z' = (−ζω + iω√(1−ζ²)) z + h` from rest: a unit force with this course
    /// moves a mass of 1 on a spring ω² by z's imaginary part over ω√(1−ζ²). Exact at the samples, whatever ω is to
    /// their distance.
    pub(crate) fn swing(&self, omega: f64, zeta: f64) -> Swing {
        let zeta = zeta.min(0.999);
        let decay = zeta * omega;
        let forced = if decay > 0.0 { self.largest / decay } else { f64::INFINITY };
        let most = self.magnitude_integral.min(forced);
        let worst = Swing { z: most, rate: omega * most + self.largest };
        if !self.resolved {
            return worst;
        }
        let lambda = Complex::new(-decay, omega * (1.0 - zeta * zeta).sqrt());
        let mut z = Complex::new(0.0, 0.0);
        let mut swing = Swing { z: 0.0, rate: 0.0 };
        for piece in &self.pieces {
            let x = lambda * piece.step;
            let turn = x.exp();
            let (phi1, phi2) = phi(x, turn);
            for pair in piece.samples.windows(2) {
                let (a, b) = (pair[0], pair[1]);
                // Between the samples: the particular solution and the circle about it, or what the force can do at all.
                let slope = (b - a) / piece.step;
                let high = a.abs().max(b.abs());
                let circle = (z + a / lambda + slope / (lambda * lambda)).norm()
                    + high / lambda.norm()
                    + slope.abs() / lambda.norm_sqr();
                swing.z = swing.z.max(circle.min(z.norm() + high * piece.step));
                // z' follows the same law, with the slope for its force.
                let rate = lambda * z + a;
                let about = (rate + slope / lambda).norm() + slope.abs() / lambda.norm();
                swing.rate = swing.rate.max(about.min(rate.norm() + (b - a).abs()));
                z = turn * z + (phi1 * a + phi2 * (b - a)) * piece.step;
            }
        }
        Swing { z: swing.z.min(worst.z), rate: swing.rate.min(worst.rate) }
    }

    /// Largest slope between jumps.
    pub(crate) fn steepest(&self) -> f64 {
        let of = |piece: &Piece| piece.samples.windows(2).map(|p| (p[1] - p[0]).abs() / piece.step).fold(0.0, f64::max);
        self.pieces.iter().map(of).fold(0.0, f64::max)
    }
}

/// Bounds of |z| and |z'|, see [`Course::swing`].
#[derive(Debug, Clone, Copy)]
pub(crate) struct Swing {
    pub z: f64,
    pub rate: f64,
}

/// The discontinuities of histories before the end, and the end, ascending.
fn stops(histories: &[&History], end: f64) -> Vec<f64> {
    let of_all = histories.iter().flat_map(|history| history.discontinuities());
    let mut stops: Vec<f64> = of_all.filter(|t| *t > 0.0 && *t < end).collect();
    stops.push(end);
    stops.sort_by(f64::total_cmp);
    stops
}

/// Fewest and most intervals in each of `pieces` of a history, `among` others that cost more than closed forms do.
fn intervals(history: &History, among: usize, pieces: usize) -> [usize; 2] {
    // What a value costs is in the number of samples as its square root: the walks for the size have the other part.
    let share = history.cost().sqrt() * among.max(1) as f64;
    let most = ((MAX_IN_ALL / pieces).clamp(1, MOST) as f64 / share).max(1.0) as usize;
    [(FEWEST_IN_ALL / pieces).clamp(1, FEWEST).min(most), most]
}

impl Piece {
    /// In `n` intervals.
    fn of(history: &History, start: f64, stop: f64, n: usize) -> Self {
        let inside = 0.5 * (start + stop);
        let at = |i: usize| history.at(start + (stop - start) * i as f64 / n as f64, inside);
        Self { step: (stop - start) / n as f64, samples: (0..=n).map(at).collect() }
    }

    fn new(history: &History, start: f64, stop: f64, close: f64, [fewest, most]: [usize; 2]) -> (Self, bool) {
        let mut n = fewest;
        loop {
            // Three points between the samples: one in the middle could fall on the waves of the history.
            let (piece, finer) = (Self::of(history, start, stop, n), Self::of(history, start, stop, 4 * n));
            let away = (0..4 * n).map(|i| {
                let (k, part) = (i / 4, (i % 4) as f64 / 4.0);
                (finer.samples[i] - piece.samples[k] * (1.0 - part) - piece.samples[k + 1] * part).abs()
            });
            let follows = away.fold(0.0, f64::max) <= close;
            if follows || 2 * n > most {
                return (piece, follows);
            }
            n *= 2;
        }
    }
}

/// max |∫₀ᵗ h| of straight lines, to the distance of the lines from the history.
fn net_integral(pieces: &[Piece]) -> f64 {
    let (mut sum, mut largest): (f64, f64) = (0.0, 0.0);
    for piece in pieces {
        for pair in piece.samples.windows(2) {
            sum += 0.5 * piece.step * (pair[0] + pair[1]);
            largest = largest.max(sum.abs() + 0.5 * piece.step * pair[0].abs().min(pair[1].abs()));
        }
    }
    largest
}

/// φ₁ = (eˣ − 1)/x and φ₂ = (φ₁ − 1)/x.
fn phi(x: Complex<f64>, exp: Complex<f64>) -> (Complex<f64>, Complex<f64>) {
    if x.norm() < 0.05 {
        let series = |first: f64| {
            let mut term = Complex::new(1.0 / first, 0.0);
            let mut sum = term;
            for k in 1..8 {
                term *= x / (first + f64::from(k));
                sum += term;
            }
            sum
        };
        // 1/1! + x/2! + x²/3! …, and 1/2! + x/3! + …
        (series(1.0), series(2.0))
    } else {
        let phi1 = (exp - 1.0) / x;
        (phi1, (phi1 - 1.0) / x)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Largest |q| ω² and |q̈| of q̈ + 2ζω q̇ + ω² q = h by brute force.
    fn dynamic_factor(history: &History, omega: f64, zeta: f64, end: f64) -> [f64; 2] {
        let n = 200_000;
        let h = end / f64::from(n);
        let rate = |t: f64, q: f64, v: f64| (v, history.at(t, t) - omega * omega * q - 2.0 * zeta * omega * v);
        let (mut q, mut v, mut largest, mut fastest) = (0.0, 0.0, 0.0_f64, 0.0_f64);
        for i in 0..n {
            let t = f64::from(i) * h;
            let (a, b) = rate(t, q, v);
            let (c, d) = rate(t + 0.5 * h, q + 0.5 * h * a, v + 0.5 * h * b);
            q += h * c;
            v += h * d;
            largest = largest.max(q.abs());
            fastest = fastest.max(d.abs());
        }
        [largest * omega * omega, fastest]
    }

    /// Independent reference: the oscillator by steps of the midpoint rule.
    #[test]
    fn the_swing_bounds_the_oscillator_closely() {
        // Longest pulse of 30 periods down to one of a thousandth of a period; measured bound/actual: 1.00 to 1.91, of the
        // acceleration 1.00 to 1.33.
        for (duration, omega, zeta) in
            [(0.5, 400.0, 0.0), (0.02, 154.0, 0.0), (0.02, 154.0, 0.1), (0.02, 1000.0, 0.02), (1e-4, 60.0, 0.0)]
        {
            let pulse = History::HalfSine { start: 0.01, duration };
            let swing = Course::new(&pulse, 0.7, 1).swing(omega, zeta);
            let damped = (1.0_f64 - zeta * zeta).sqrt();
            let [actual, acceleration] = dynamic_factor(&pulse, omega, zeta, 0.7);
            let bound = swing.z * omega / damped;
            assert!(bound >= actual * (1.0 - 2e-3), "{duration} {omega} {zeta}: {bound} {actual}");
            assert!(bound <= 2.0 * actual, "{duration} {omega} {zeta}: {bound} {actual}");
            let bound = swing.rate / damped;
            assert!(bound >= acceleration * (1.0 - 2e-3), "{duration} {omega} {zeta}: {bound} {acceleration}");
            assert!(bound <= 2.0 * acceleration, "{duration} {omega} {zeta}: {bound} {acceleration}");
        }
    }

    /// Closed form: the impulse 2T/π.
    #[test]
    fn a_short_pulse_swings_by_its_impulse_and_a_course_that_has_risen_starts_at_zero() {
        let duration = 1e-4;
        let pulse = History::HalfSine { start: 0.0, duration };
        let swing = Course::new(&pulse, 1.0, 1).swing(10.0, 0.0).z;
        assert!((swing / (2.0 * duration / std::f64::consts::PI) - 1.0).abs() < 2e-3);
        let late = History::HalfSine { start: -0.5, duration: 1.0 };
        let risen = Course::new(&late, 0.25, 1).risen();
        assert!((risen.largest - (1.0 - 0.5_f64.sqrt())).abs() < 1e-12);
    }

    #[test]
    fn very_many_discontinuities_do_not_make_very_many_samples() {
        for discontinuities in [3000, 300_000] {
            let times: Vec<f64> = (0..discontinuities).map(f64::from).collect();
            let values = (0..discontinuities).map(|k| f64::from(k % 2)).collect();
            let table = dynamics::Table::new(times, values).unwrap();
            let course = Course::new(&History::Table(table), f64::from(discontinuities), 1);
            let samples: usize = course.pieces.iter().map(|piece| piece.samples.len()).sum();
            // The straight lines of a table are followed by however few. Measured: 18 000 and 600 000.
            assert!(course.resolved && samples <= FEWEST_IN_ALL + 2 * course.pieces.len(), "{samples}");
            assert!((course.magnitude_integral / (0.5 * f64::from(discontinuities)) - 1.0).abs() < 1e-3);
        }
    }

    #[test]
    fn long_formulas_share_few_samples_and_fall_back_to_the_bound() {
        let text = format!("fract(9e5*sin(7e4*t)){}", " + 0*t*t*t*t*t".repeat(60));
        let history = History::Expression(dynamics::Expression::new(&text, vec![]).unwrap());
        for (among, most) in [(1, 2_000), (20, 100)] {
            let course = Course::new(&history, 1.0, among);
            let samples: usize = course.pieces.iter().map(|piece| piece.samples.len()).sum();
            assert!(!course.resolved && samples < most, "{samples}");
            let swing = course.swing(1e3, 0.0);
            assert!(course.net_integral == course.magnitude_integral && swing.z == course.magnitude_integral);
        }
    }

    /// Closed form: 1/(πf) of a half wave.
    #[test]
    fn the_net_integral_is_that_of_a_half_wave() {
        let frequency = 10.0;
        let sine = History::Sine { frequency, phase: 0.0, start: 0.0, duration: None };
        let course = Course::new(&sine, 1.0, 1);
        let half = 1.0 / (std::f64::consts::PI * frequency);
        // Measured 0.9999 of it, and 20.000 of them in the magnitude.
        assert!((0.999..1.01).contains(&(course.net_integral / half)));
        assert!((course.magnitude_integral / half - 20.0).abs() < 0.02);
        assert!((course.steepest() / (std::f64::consts::TAU * frequency) - 1.0).abs() < 0.01);
    }
}
