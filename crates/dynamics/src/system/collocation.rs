//! Collocation at three times in a step: Radau IIA of order 5 and Gauss of order 6, in the form of their structured Newton; and the
//! explicit scheme of order 4.
//!
//! Hairer and Wanner, Solving Ordinary Differential Equations II, IV.5 and IV.8; Eqs. (J5)–(J7) of `docs/method/systems.md`.

pub(crate) mod two_step;

use nalgebra::{Complex, Matrix3, Vector3};

/// Stages of a step.
pub(crate) const STAGES: usize = 3;

/// A scheme for the steps of a system.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
pub enum SystemScheme {
    /// Radau IIA of order 5: forgets vibration that its steps do not resolve.
    #[default]
    Radau,
    /// Gauss of order 6: keeps all vibration, and energy better over long times, but needs shorter steps for what rings.
    Gauss,
    /// Explicit Runge–Kutta–Munthe-Kaas of order 4: for rigid and soft systems, in steps that follow the fastest mode.
    Rkmk4,
}

impl SystemScheme {
    /// All of them.
    pub const ALL: [Self; 3] = [Self::Radau, Self::Gauss, Self::Rkmk4];

    /// Its name.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Radau => "radau",
            Self::Gauss => "gauss",
            Self::Rkmk4 => "rkmk4",
        }
    }

    /// True if the frequencies of the modes limit its steps.
    pub const fn is_limited_by_modes(self) -> bool {
        matches!(self, Self::Rkmk4)
    }

    /// Its order: of collocation 2s − 1 or 2s with the number of stages s.
    pub const fn order(self) -> u32 {
        match self {
            Self::Radau => 2 * STAGES as u32 - 1,
            Self::Gauss => 2 * STAGES as u32,
            Self::Rkmk4 => 4,
        }
    }
}

/// The constants of the scheme.
#[derive(Debug, Clone)]
pub(crate) struct Collocation {
    /// True of explicit steps: the increments of the stages are then the step times the rates at its start, in its middle, and at its
    /// end.
    pub is_explicit: bool,
    /// c: times of the stages, as fractions of the step.
    pub times: [f64; STAGES],
    /// b: the weights of their rates.
    pub weights: [f64; STAGES],
    /// A
    pub matrix: Matrix3<f64>,
    /// A⁻¹
    pub inverse: Matrix3<f64>,
    /// κ_r, and one of the two complex κ: the eigenvalues of A⁻¹.
    pub real: f64,
    pub complex: Complex<f64>,
    /// Rows of T⁻¹ for the two.
    pub to_real: Vector3<f64>,
    pub to_complex: Vector3<Complex<f64>>,
    /// Columns of T for the two; the third is the conjugate of the second.
    pub from_real: Vector3<f64>,
    pub from_complex: Vector3<Complex<f64>>,
    /// Values at the start of the step of the polynomials that are 1 at one stage and 0 at the others.
    pub at_start: [f64; STAGES],
    /// Factors of the increments at the stages in that at the end of the step; `None` where the last stage is the end.
    pub at_end: Option<[f64; STAGES]>,
}

impl Collocation {
    /// Radau IIA with three stages.
    pub fn radau() -> Self {
        let root = 6.0_f64.sqrt();
        let times = [(4.0 - root) / 10.0, (4.0 + root) / 10.0, 1.0];
        let a = Matrix3::new(
            (88.0 - 7.0 * root) / 360.0,
            (296.0 - 169.0 * root) / 1800.0,
            (-2.0 + 3.0 * root) / 225.0,
            (296.0 + 169.0 * root) / 1800.0,
            (88.0 + 7.0 * root) / 360.0,
            (-2.0 - 3.0 * root) / 225.0,
            (16.0 - root) / 36.0,
            (16.0 + root) / 36.0,
            1.0 / 9.0,
        );
        Self { at_end: None, ..Self::new(times, a, [a[(2, 0)], a[(2, 1)], a[(2, 2)]]) }
    }

    /// Gauss with three stages.
    pub fn gauss() -> Self {
        let root = 15.0_f64.sqrt();
        let a = Matrix3::new(
            5.0 / 36.0,
            2.0 / 9.0 - root / 15.0,
            5.0 / 36.0 - root / 30.0,
            5.0 / 36.0 + root / 24.0,
            2.0 / 9.0,
            5.0 / 36.0 - root / 24.0,
            5.0 / 36.0 + root / 30.0,
            2.0 / 9.0 + root / 15.0,
            5.0 / 36.0,
        );
        Self::new([0.5 - root / 10.0, 0.5, 0.5 + root / 10.0], a, [5.0 / 18.0, 4.0 / 9.0, 5.0 / 18.0])
    }

    /// The classical explicit scheme, with the Newton matrix of Radau IIA for the metric of projections.
    pub fn rkmk4() -> Self {
        Self {
            is_explicit: true,
            times: [0.0, 0.5, 1.0],
            weights: [1.0 / 6.0, 2.0 / 3.0, 1.0 / 6.0],
            at_end: None,
            ..Self::radau()
        }
    }

    fn new(times: [f64; STAGES], a: Matrix3<f64>, weights: [f64; STAGES]) -> Self {
        let inverse = a.try_inverse().unwrap_or_else(Matrix3::zeros);
        let real = real_eigenvalue(&inverse);
        // The other two are the roots of κ² − (tr − κ_r) κ + det/κ_r.
        let half = 0.5 * (inverse.trace() - real);
        let complex = Complex::new(half, (inverse.determinant() / real - half * half).sqrt());
        let from_real = eigenvector(&inverse, Complex::new(real, 0.0)).map(|entry| entry.re);
        let from_complex = eigenvector(&inverse, complex);
        let columns = [from_real.map(Complex::from), from_complex, from_complex.map(|entry| entry.conj())];
        let back = Matrix3::from_columns(&columns).try_inverse().unwrap_or_else(Matrix3::zeros);
        let at_start = std::array::from_fn(|i| {
            let others = (0..STAGES).filter(|j| *j != i);
            others.map(|j| times[j] / (times[j] - times[i])).product()
        });
        let mut scheme = Self {
            is_explicit: false,
            times,
            weights,
            matrix: a,
            inverse,
            real,
            complex,
            to_real: back.row(0).transpose().map(|entry| entry.re),
            to_complex: back.row(1).transpose(),
            from_real,
            from_complex,
            at_start,
            at_end: None,
        };
        scheme.at_end = Some(scheme.at(1.0));
        scheme
    }

    /// Factors of the increments at the stages in that at a time, counted in steps.
    pub fn at(&self, time: f64) -> [f64; STAGES] {
        if self.is_explicit {
            return self.weights_to(time);
        }
        std::array::from_fn(|i| {
            let others = (0..STAGES).filter(|j| *j != i);
            time / self.times[i]
                * others.map(|j| (time - self.times[j]) / (self.times[i] - self.times[j])).product::<f64>()
        })
    }

    /// Factors of the increments at the stages in their rate at a time, both counted in steps.
    pub fn rates_at(&self, time: f64) -> [f64; STAGES] {
        std::array::from_fn(|i| {
            let [j, k] = [(i + 1) % STAGES, (i + 2) % STAGES];
            let [at, other, third] = [i, j, k].map(|stage| self.times[stage]);
            let [first, second] = [time - other, time - third];
            let scale = ((at - other) * (at - third)).recip();
            if self.is_explicit {
                return scale * first * second;
            }
            scale / at * (first * second + time * (first + second))
        })
    }

    /// The polynomial of fourth degree whose rate, counted in steps, is 1 at the start and 0 at the stages. It is 0 at both ends.
    pub fn bend(&self, time: f64) -> f64 {
        if self.is_explicit {
            return 0.0;
        }
        let rate = |time: f64| -> f64 { self.times.iter().map(|stage| 1.0 - time / stage).product() };
        // The rate is of third degree, and Simpson's rule is exact.
        time / 6.0 * (rate(0.0) + 4.0 * rate(0.5 * time) + rate(time))
    }

    /// Weights of the rates at the stages in an integral from the start to a time, counted in steps.
    pub fn weights_to(&self, time: f64) -> [f64; STAGES] {
        // The polynomials that are 1 at one stage and 0 at the others are of second degree, and Simpson's rule is exact.
        let half = 0.5 * time;
        std::array::from_fn(|i| {
            let at = |time: f64| -> f64 {
                let others = (0..STAGES).filter(|j| *j != i);
                others.map(|j| (time - self.times[j]) / (self.times[i] - self.times[j])).product()
            };
            time / 6.0 * (at(0.0) + 4.0 * at(half) + at(time))
        })
    }

    /// Factors of the increments at the stages of one step in those at a time of the next, both counted from their own
    /// starts: `time` is counted in steps of the last from its start.
    pub fn continued(&self, time: f64) -> [f64; STAGES] {
        let [then, end] = [time, 1.0].map(|time| self.at(time));
        std::array::from_fn(|i| then[i] - end[i])
    }
}

/// The real eigenvalue of a matrix that has only one.
fn real_eigenvalue(matrix: &Matrix3<f64>) -> f64 {
    let trace = matrix.trace();
    let minors = 0.5 * (trace * trace - (matrix * matrix).trace());
    let determinant = matrix.determinant();
    let mut x = trace / 3.0;
    for _ in 0..100 {
        let value = ((x - trace) * x + minors) * x - determinant;
        let slope = (3.0 * x - 2.0 * trace) * x + minors;
        x -= value / slope;
    }
    x
}

/// The vector that a matrix less an eigenvalue makes zero: at right angles to two of its rows.
fn eigenvector(matrix: &Matrix3<f64>, eigenvalue: Complex<f64>) -> Vector3<Complex<f64>> {
    let shifted = matrix.map(Complex::from) - Matrix3::identity() * eigenvalue;
    let row = |i: usize| -> Vector3<Complex<f64>> { shifted.row(i).transpose() };
    row(0).cross(&row(1))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Independent reference: RADAU5 of Hairer and Wanner (γ = 3.6378342527444957, α = 2.6810828736277521, β =
    /// 3.0504301992474105).
    #[test]
    fn the_eigenvalues_are_those_of_the_literature() {
        let scheme = Collocation::radau();
        assert!((scheme.real - 3.637_834_252_744_495_5).abs() < 1e-13);
        assert!((scheme.complex - Complex::new(2.681_082_873_627_752, 3.050_430_199_247_410_5)).norm() < 1e-13);
    }

    /// Conserved: T Λ T⁻¹ = A⁻¹.
    #[test]
    fn the_transform_makes_the_inverse_diagonal() {
        for scheme in [Collocation::radau(), Collocation::gauss()] {
            let Collocation { inverse, real, complex, to_real, to_complex, from_real, from_complex, .. } = scheme;
            let made = Matrix3::from_fn(|i, j| {
                from_real[i] * real * to_real[j] + 2.0 * (from_complex[i] * complex * to_complex[j]).re
            });
            assert!((made - inverse).norm() < 1e-12);
        }
    }

    /// Closed form: integrals of 1, t and t².
    #[test]
    fn rates_are_summed_up_to_any_time() {
        for scheme in [Collocation::radau(), Collocation::gauss()] {
            for time in [0.0, 0.3, 0.8, 1.0] {
                let weights = scheme.weights_to(time);
                for power in 0..3 {
                    let sum: f64 = weights.iter().zip(scheme.times).map(|(b, c)| b * c.powi(power)).sum();
                    assert!((sum - time.powi(power + 1) / f64::from(power + 1)).abs() < 1e-14);
                }
            }
            assert!(scheme.weights_to(1.0).iter().zip(scheme.weights).all(|(b, whole)| (b - whole).abs() < 1e-14));
        }
    }

    /// Closed form: the rate of a polynomial of third degree; of explicit steps, whose increments are rates, one of the second.
    #[test]
    fn rates_are_those_of_the_polynomials() {
        for scheme in [Collocation::radau(), Collocation::gauss()] {
            let (x, rate) = (|t: f64| t - 0.3 * t * t + 2.0 * t.powi(3), |t: f64| 1.0 - 0.6 * t + 6.0 * t * t);
            for time in [0.0, 0.3, 1.0] {
                let found: f64 = scheme.rates_at(time).iter().zip(scheme.times).map(|(f, c)| f * x(c)).sum();
                assert!((found - rate(time)).abs() < 1e-13);
            }
        }
        let scheme = Collocation::rkmk4();
        let rate = |t: f64| 1.0 - 0.6 * t + 6.0 * t * t;
        let found: f64 = scheme.rates_at(0.7).iter().zip(scheme.times).map(|(f, c)| f * rate(c)).sum();
        assert!((found - rate(0.7)).abs() < 1e-13);
    }

    /// Closed form: with its rate at the start, a polynomial of degree 4 is found from its rates at the stages.
    #[test]
    fn a_bend_makes_a_step_one_order_better() {
        for scheme in [Collocation::radau(), Collocation::gauss()] {
            let (x, rate) = (|t: f64| t - 0.3 * t.powi(2) + 2.0 * t.powi(4), |t: f64| 1.0 - 0.6 * t + 8.0 * t.powi(3));
            let missing = rate(0.0) - scheme.at_start.iter().zip(scheme.times).map(|(l, c)| l * rate(c)).sum::<f64>();
            for time in [0.0, 0.2, 0.7, 1.0] {
                let weights = scheme.weights_to(time);
                let of_stages: f64 = weights.iter().zip(scheme.times).map(|(b, c)| b * rate(c)).sum();
                assert!((of_stages + missing * scheme.bend(time) - x(time)).abs() < 1e-14);
            }
            assert!(scheme.bend(1.0).abs() < 1e-15);
        }
    }

    /// Closed form: a polynomial of degree 3.
    #[test]
    fn a_polynomial_is_continued() {
        let scheme = Collocation::radau();
        let x = |time: f64| 2.0 * time - 3.0 * time * time + 0.7 * time * time * time;
        let factors = scheme.continued(1.4);
        let found: f64 = factors.iter().zip(scheme.times).map(|(factor, time)| factor * x(time)).sum();
        assert!((found - (x(1.4) - x(1.0))).abs() < 1e-13);
        let start: f64 =
            scheme.at_start.iter().zip(scheme.times).map(|(factor, time)| factor * (1.0 + time * time)).sum();
        assert!((start - 1.0).abs() < 1e-13);
    }
}
