//! The stress at all sites of a mesh, as a sum of shapes.

use std::cmp::Ordering;

use faer::Mat;
use fem_tet10::von_mises;
use rayon::prelude::*;

/// The stress of some coordinates at all sites: by site, then coordinate.
#[derive(Debug)]
pub(crate) struct SiteStress {
    coordinates: usize,
    stress: Vec<[f64; 6]>,
}

impl SiteStress {
    pub fn new(nodal: &Mat<f64>) -> Self {
        let coordinates = nodal.ncols();
        let stress = (0..nodal.nrows() / 6 * coordinates)
            .map(|i| std::array::from_fn(|c| nodal[(6 * (i / coordinates) + c, i % coordinates)]))
            .collect();
        Self { coordinates, stress }
    }

    pub fn coordinates(&self) -> usize {
        self.coordinates
    }

    /// The stress of each coordinate at a site.
    pub fn of_site(&self, site: usize) -> &[[f64; 6]] {
        &self.stress[site * self.coordinates..(site + 1) * self.coordinates]
    }

    /// The von Mises stress at a site.
    pub fn at(&self, site: usize, coordinates: &[f64]) -> f64 {
        von_mises(&combined(self.of_site(site), coordinates))
    }

    /// The site with the largest von Mises stress, the first of equal ones, and the stress; none without coordinates.
    pub fn largest(&self, coordinates: &[f64]) -> Option<(usize, f64)> {
        let sites = self.stress.len().checked_div(self.coordinates)?;
        let larger = |a: &(usize, f64), b: &(usize, f64)| match a.1.total_cmp(&b.1) {
            Ordering::Equal => b.0.cmp(&a.0),
            order => order,
        };
        (0..sites).into_par_iter().with_min_len(256).map(|site| (site, self.at(site, coordinates))).max_by(larger)
    }
}

/// The sum of stresses times their coordinates.
pub(crate) fn combined(shapes: &[[f64; 6]], coordinates: &[f64]) -> [f64; 6] {
    let mut sum = [0.0; 6];
    for (shape, coordinate) in shapes.iter().zip(coordinates) {
        sum.iter_mut().zip(shape).for_each(|(sum, s)| *sum += s * coordinate);
    }
    sum
}
