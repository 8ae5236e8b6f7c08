//! The products of the coordinates of large modes, which carry what bending draws in.

use faer::Mat;

/// Factors of following modes in a product, at most: the body is linear in these about the large ones.
const MAX_FOLLOWING: usize = 2;

/// The products of the coordinates of some large modes and of modes that follow them. The large ones are numbered first.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct LargeProducts {
    /// Number of large modes.
    pub large: usize,
    /// Number of modes that follow.
    pub following: usize,
}

impl LargeProducts {
    /// Number of both.
    pub fn coordinates(&self) -> usize {
        self.large + self.following
    }

    /// Products of two, by their factors, ascending.
    pub fn second(&self) -> Vec<Vec<usize>> {
        self.with(2, MAX_FOLLOWING)
    }

    /// Products of three large modes.
    pub fn third(&self) -> Vec<Vec<usize>> {
        self.with(3, 0)
    }

    /// All products that have a displacement: those of two, then those of three.
    pub fn of_displacement(&self) -> Vec<Vec<usize>> {
        [self.second(), self.third()].concat()
    }

    /// The products in the strain energy beyond the linear one, to the fifth: of three all, since a load holds the modes that
    /// follow to one side, too, and that changes their stiffness by a first order.
    pub fn of_energy(&self) -> Vec<Vec<usize>> {
        let factors = [(3, 3), (4, MAX_FOLLOWING), (5, MAX_FOLLOWING)];
        factors.into_iter().flat_map(|(factors, following)| self.with(factors, following)).collect()
    }

    /// Products by their number of factors, with a limit on those that follow, in ascending order.
    fn with(&self, factors: usize, following: usize) -> Vec<Vec<usize>> {
        let mut products: Vec<Vec<usize>> = vec![Vec::new()];
        for _ in 0..factors {
            let longer = |product: Vec<usize>| {
                let first = product.last().copied().unwrap_or(0);
                let followers = product.iter().filter(|k| **k >= self.large).count();
                let end = if followers < following { self.coordinates() } else { self.large };
                (first..end).map(move |k| [&product[..], &[k]].concat())
            };
            products = products.into_iter().flat_map(longer).collect();
        }
        products
    }

    /// True if a product has a factor that follows.
    pub fn follows(&self, product: &[usize]) -> bool {
        product.iter().any(|k| *k >= self.large)
    }
}

/// The coordinates of large modes and of the modes that follow them, in extended shapes: modes of the motion, then others that
/// only their products move.
#[derive(Debug, Clone)]
pub struct LargeCoordinates {
    /// Number of shapes that are coordinates of the motion.
    pub dynamic: usize,
    /// The large modes, numbered from 0, ascending.
    pub large: Vec<usize>,
    /// The modes that follow, numbered from 0, ascending.
    pub following: Vec<usize>,
    /// a_α (extended shapes × [`LargeProducts::of_displacement`]): the displacement of each product.
    pub coefficients: Mat<f64>,
}

impl LargeCoordinates {
    /// The products of the coordinates.
    pub fn products(&self) -> LargeProducts {
        LargeProducts { large: self.large.len(), following: self.following.len() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn products_are_those_of_the_theory() {
        let products = LargeProducts { large: 2, following: 1 };
        assert_eq!(products.second(), [[0, 0], [0, 1], [0, 2], [1, 1], [1, 2], [2, 2]]);
        assert_eq!(products.third(), [[0, 0, 0], [0, 0, 1], [0, 1, 1], [1, 1, 1]]);
        assert!(products.follows(&[0, 2]));
        // Of one large and three following modes, all fields take eleven solutions.
        let products = LargeProducts { large: 1, following: 3 };
        assert_eq!(products.of_displacement().len(), 11);
        // q³, q² r, q r r and so on to the fifth.
        assert_eq!(products.of_energy().len(), 10 + 3 * (1 + 3 + 6));
    }
}
