//! The numbers of the paper, those found here, and how far they are apart.

use fem_tet10::LumpedInertia;
use nalgebra::{Matrix3, SymmetricEigen};
use results::Results;
use serde::Serialize;

use super::rigid_plate::{RigidHistories, WATCHED_POINT};
use crate::commands::run::BodyRunReport;

/// Table 1 of the paper: frequencies of its modes 7 to 16, the flexible modes 1 to 10, Hz.
pub(super) const TABLE_1: [f64; 10] =
    [24.5282, 85.8433, 93.2656, 117.3671, 206.1601, 359.8918, 387.63, 534.3499, 544.946, 579.7381];
/// Mass (Mg) and principal moments (Mg mm²) as the paper prints them.
pub(super) const PRINTED_MASS: f64 = 0.0093;
pub(super) const PRINTED_MOMENTS: [f64; 3] = [5.4839, 2112.7024, 2117.7732];

/// A quantity of the paper and its value here.
#[derive(Debug, Clone, Copy, Serialize)]
pub struct Pair {
    /// As the paper prints it.
    pub paper: f64,
    /// As found here.
    pub here: f64,
}

impl Pair {
    /// (here − paper) / paper
    pub fn difference(&self) -> f64 {
        (self.here - self.paper) / self.paper
    }
}

/// Two histories compared.
#[derive(Debug, Clone, Copy, Serialize)]
pub struct Histories {
    /// Largest magnitude of the second.
    pub peak: f64,
    /// Largest difference, relative to that peak.
    pub difference: f64,
}

/// All that the report compares.
#[derive(Debug, Clone, Serialize)]
pub struct Comparison {
    /// Frequencies of Table 1.
    pub frequencies: Vec<Pair>,
    /// Mass of the consistent mass matrix.
    pub mass: Pair,
    /// Principal moments of the consistent mass matrix.
    pub moments: [Pair; 3],
    /// Principal moments with each element's mass at its centroid.
    pub lumped_moments: [Pair; 3],
    /// Fig. 5: largest |α1|, |α3| relative to the largest |α2|.
    pub fig_5: f64,
    /// Fig. 6: largest |ω1|, |ω3| relative to the largest |ω2|.
    pub fig_6: f64,
    /// Fig. 7: largest X2 displacement of the points relative to their largest displacement.
    pub fig_7: f64,
    /// Fig. 8: α2 of the flexible plate against the rigid one.
    pub fig_8: Histories,
    /// Fig. 9: ω2.
    pub fig_9: Histories,
    /// Fig. 10: X1 acceleration of P1 in the embedded rigid motion.
    pub fig_10: Histories,
    /// Fig. 11: the same in X3.
    pub fig_11: Histories,
    /// Fig. 12: X1 acceleration of P1, vibration included.
    pub fig_12: Histories,
    /// Fig. 13: the same in X3.
    pub fig_13: Histories,
}

impl Comparison {
    pub(super) fn new(
        plate: &BodyRunReport,
        results: &Results,
        rigid: &RigidHistories,
        lumped: &LumpedInertia,
    ) -> Self {
        let inertia = Matrix3::from_fn(|i, j| plate.body.inertia[i][j]);
        let mut moments: [f64; 3] = SymmetricEigen::new(inertia).eigenvalues.into();
        moments.sort_by(f64::total_cmp);
        let beside_printed =
            |here: [f64; 3]| std::array::from_fn(|i| Pair { paper: PRINTED_MOMENTS[i], here: here[i] });
        let history = |path: &str| results.vectors(path).unwrap_or_default();
        let watched = |quantity: &str| history(&format!("points/{WATCHED_POINT}/{quantity}"));
        let (alpha, omega) = (history("angular_acceleration"), history("angular_velocity"));
        let beside = |ours: &[[f64; 3]], theirs: &[[f64; 3]], axis: usize| compare(ours, theirs, axis);
        let transverse = |rows: &[[f64; 3]]| largest(rows, 0).max(largest(rows, 2)) / largest(rows, 1);
        let names = results.metadata.bodies.iter().flat_map(|body| &body.point_names);
        let displacements = || names.clone().flat_map(|name| history(&format!("points/{name}/displacement")));
        let norm = |d: &[f64; 3]| d.iter().map(|c| c * c).sum::<f64>().sqrt();
        Self {
            frequencies: TABLE_1
                .iter()
                .zip(&plate.body.natural_frequencies)
                .map(|(paper, here)| Pair { paper: *paper, here: *here })
                .collect(),
            mass: Pair { paper: PRINTED_MASS, here: plate.body.mass },
            moments: beside_printed(moments),
            lumped_moments: beside_printed(lumped.principal_moments),
            fig_5: transverse(alpha),
            fig_6: transverse(omega),
            fig_7: displacements().map(|d| d[1].abs()).fold(0.0, f64::max)
                / displacements().map(norm).fold(0.0, f64::max),
            fig_8: beside(alpha, &rigid.alpha_body, 1),
            fig_9: beside(omega, &rigid.omega_body, 1),
            fig_10: beside(watched("rigid_acceleration"), &rigid.acceleration_global, 0),
            fig_11: beside(watched("rigid_acceleration"), &rigid.acceleration_global, 2),
            fig_12: beside(watched("acceleration"), &rigid.acceleration_global, 0),
            fig_13: beside(watched("acceleration"), &rigid.acceleration_global, 2),
        }
    }

    /// Largest relative difference to Table 1, in magnitude.
    pub fn worst_frequency_difference(&self) -> f64 {
        self.frequencies.iter().map(|pair| pair.difference().abs()).fold(0.0, f64::max)
    }

    /// Largest difference of Figs. 8 to 11, relative to the peak.
    pub fn worst_rigid_difference(&self) -> f64 {
        [self.fig_8, self.fig_9, self.fig_10, self.fig_11].iter().map(|h| h.difference).fold(0.0, f64::max)
    }
}

fn largest(rows: &[[f64; 3]], axis: usize) -> f64 {
    rows.iter().map(|row| row[axis].abs()).fold(0.0, f64::max)
}

fn compare(ours: &[[f64; 3]], theirs: &[[f64; 3]], axis: usize) -> Histories {
    let peak = largest(theirs, axis);
    let apart = ours.iter().zip(theirs).map(|(a, b)| (a[axis] - b[axis]).abs()).fold(0.0, f64::max);
    Histories { peak, difference: apart / peak }
}
