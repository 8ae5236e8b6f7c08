//! The stress of a model's state beside that of the full body.

use faer::{Mat, MatRef};
use fem_tet10::{Location, StressRecovery, von_mises};
use serde::Serialize;

use crate::full::FullError;
use crate::stress::about::stress_about;
use crate::stress::shapes::{BodyStress, StressPeak, larger};

/// The stress of a model against that of the full body, where the scene asks for stress.
#[derive(Debug, Clone, Serialize)]
pub struct StressCheck {
    /// The points of the output, where the scene asks for their stress.
    pub points: Vec<CheckedStress>,
    /// The whole body, where the scene asks for its largest stress.
    pub body: Option<BodyStressCheck>,
}

/// The von Mises stress at a point.
#[derive(Debug, Clone, Serialize)]
pub struct CheckedStress {
    /// Its name.
    pub name: String,
    /// Stress of the full body, force per area.
    pub full: f64,
    /// Stress of the difference of both.
    pub error: f64,
}

/// The von Mises stress over the body.
#[derive(Debug, Clone, Copy, Serialize)]
pub struct BodyStressCheck {
    /// Largest stress of the full body, force per area.
    pub full: f64,
    /// The node.
    pub node: u32,
    /// The von Mises stress of the difference of both stresses, there.
    pub error: f64,
    /// The largest stress of the difference anywhere.
    pub max_error: f64,
    /// Stress that the modes leave out of static responses: the model's own estimate of `max_error`.
    pub max_left_out: f64,
}

/// Compares the stress of a model at some modal displacements, of which `peak` was found, with that of the true displacements.
pub(crate) fn stress_check(
    recovery: &StressRecovery<'_>,
    stress: &BodyStress,
    points: &[(String, Location)],
    (modal_displacement, peak): (&[f64], Option<StressPeak>),
    truth: &[f64],
) -> Result<StressCheck, FullError> {
    let truth = MatRef::from_column_major_slice(truth, truth.len(), 1);
    let full = stress_about(recovery, truth, Mat::zeros(truth.nrows(), 0).as_ref())?;
    let at_site = |site: usize| -> [f64; 6] { std::array::from_fn(|c| full[(6 * site + c, 0)]) };
    let at = |location: &Location| {
        let of_material = |weights: Vec<(usize, f64)>| {
            let of = |c: usize| weights.iter().map(|(site, weight)| weight * at_site(*site)[c]).sum();
            std::array::from_fn(of)
        };
        larger(recovery.sites().at(location).into_iter().map(of_material))
    };
    let of_points = points.iter().zip(stress.at_points(modal_displacement)).map(|((name, location), model)| {
        let full = at(location);
        CheckedStress { name: name.clone(), full: von_mises(&full), error: von_mises(&difference(&model, &full)) }
    });
    let of_body = peak.and_then(|peak| {
        let model = stress.at_sites(modal_displacement)?;
        let (mut largest, mut max_error) = ((0.0, 0), 0.0_f64);
        for (site, model) in model.iter().enumerate() {
            let full = at_site(site);
            if von_mises(&full) > largest.0 {
                largest = (von_mises(&full), site);
            }
            max_error = max_error.max(von_mises(&difference(model, &full)));
        }
        let (full, site) = largest;
        let error = von_mises(&difference(&model[site], &at_site(site)));
        let node = recovery.sites().nodes()[site];
        Some(BodyStressCheck { full, node, error, max_error, max_left_out: peak.max_left_out })
    });
    Ok(StressCheck { points: of_points.collect(), body: of_body })
}

fn difference(a: &[f64; 6], b: &[f64; 6]) -> [f64; 6] {
    std::array::from_fn(|c| a[c] - b[c])
}
