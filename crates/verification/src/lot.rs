//! Numbers drawn by lot.

/// Numbers drawn by lot (Marsaglia's xorshift).
pub(crate) struct Lot(u64);

impl Lot {
    /// The same numbers each time.
    pub fn new() -> Self {
        Self(0x9e37_79b9_7f4a_7c15)
    }

    /// From 0 to 1.
    pub fn number(&mut self) -> f64 {
        self.draw(0.0)
    }

    /// Number of the normal distribution with deviation 1 (Box and Muller).
    pub fn normal(&mut self) -> f64 {
        // Neither 0 nor 1: one has no logarithm.
        let radius = (-2.0 * self.draw(0.5).ln()).sqrt();
        radius * (std::f64::consts::TAU * self.draw(0.5)).cos()
    }

    /// One of 2⁵³ numbers in rising order, each at this part of its place, over their count.
    fn draw(&mut self, part: f64) -> f64 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        ((self.0 >> 11) as f64 + part) / (1_u64 << 53) as f64
    }

    /// From one number to another, their logarithms all alike.
    pub fn between(&mut self, low: f64, high: f64) -> f64 {
        low * (high / low).powf(self.number())
    }

    /// One of `count`.
    pub fn of(&mut self, count: usize) -> usize {
        ((self.number() * count as f64) as usize).min(count - 1)
    }

    /// A unit vector in a cube's directions, all signs alike.
    pub fn direction(&mut self) -> [f64; 3] {
        let vector = [(); 3].map(|()| 2.0 * self.number() - 1.0);
        let length = vector.iter().map(|x| x * x).sum::<f64>().sqrt().max(1e-3);
        vector.map(|x| x / length)
    }
}
