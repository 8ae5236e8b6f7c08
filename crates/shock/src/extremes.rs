//! The least and the largest value of a quantity that is seen with its rate at the ends of steps.

/// Least and largest value so far.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Extremes {
    pub least: f64,
    pub largest: f64,
}

impl Extremes {
    fn see(&mut self, value: f64) {
        self.least = self.least.min(value);
        self.largest = self.largest.max(value);
    }

    /// A step of length h with value and rate at both ends; between them the cubic of Hermite.
    pub fn see_step(&mut self, h: f64, [from, to]: [[f64; 2]; 2]) {
        self.see(from[0]);
        self.see(to[0]);
        let [m0, m1] = [h * from[1], h * to[1]];
        if m0 * m1 < 0.0 {
            let rise = to[0] - from[0];
            // Rate of the cubic: a s² + b s + m0, s from 0 to 1.
            let (a, b) = (3.0 * (m0 + m1 - 2.0 * rise), 2.0 * (3.0 * rise - 2.0 * m0 - m1));
            let root = (b * b - 4.0 * a * m0).max(0.0).sqrt();
            let q = -0.5 * (b + if b < 0.0 { -root } else { root });
            for s in [q / a, m0 / q].into_iter().filter(|s| (0.0..=1.0).contains(s)) {
                let back = 1.0 - s;
                let value =
                    (1.0 + 2.0 * s) * back * back * from[0] + s * back * back * m0 + s * s * (3.0 - 2.0 * s) * to[0]
                        - s * s * back * m1;
                self.see(value);
            }
        }
    }

    /// The larger magnitude.
    pub fn magnitude(&self) -> f64 {
        self.largest.max(-self.least)
    }
}
