//! Reactions of joints and motions of drives in the linearised equations, Eqs. (L9) and (L10) of `docs/method/systems.md`.
//!
//! ```text
//! ξ = N η + Σ p d         p = −M⁻¹Gᵀ (G M⁻¹Gᵀ)⁻¹ ∂g/∂d        d the change of a drive's value; NᵀM p = 0
//! δλ = S (C ξ̇ + K ξ − f) + (G M⁻¹Gᵀ)⁻¹ G p d̈                S = (G M⁻¹Gᵀ)⁻¹ G M⁻¹
//! ```

use faer::Mat;
use nalgebra::Vector3;

use crate::system::description::System;
use crate::system::joint::Joint;
use crate::system::joint::row::Row;
use crate::system::radau::SystemMotion;
use crate::vibration::system::steady::SteadyState;
use crate::vibration::system::tie::Tie;

/// A reaction of a joint to first order: force and moment on its second body, at the second marker, along axes that are global in the
/// steady state and turn with its spin.
#[derive(Debug, Clone)]
pub struct ReactionRows {
    /// By changes of place ξ of all bodies (6×n).
    pub by_place: Mat<f64>,
    /// By their rates (6×n).
    pub by_rate: Mat<f64>,
    /// By generalised forces on all bodies (6×n).
    pub by_force: Mat<f64>,
    /// By ξ̈ (6×n): only that of drives has a part in it.
    pub by_acceleration: Mat<f64>,
}

impl SystemMotion {
    /// Changes of place of all bodies by a unit of the value of a joint's drive; `None` without one.
    pub fn driven_motion(&self, at: &SteadyState, joint: usize) -> Option<Vec<f64>> {
        let system = self.system();
        let of = &system.joints()[joint];
        of.drive.as_ref()?;
        let [value, _] = of.driven_at([at.configuration.time; 2]);
        let mut gaps = vec![0.0; system.rows()];
        let mut place = first_row(system, joint);
        for (markers, rows) in of.groups() {
            let places = at.configuration.places(markers);
            for row in rows {
                if matches!(row, Row::DrivenRotation | Row::DrivenPoint) {
                    gaps[place] = row.wrench(places.each_ref(), [value, 1.0]).own_rate;
                }
                place += 1;
            }
        }
        Some(at.terms.closing(system, &gaps))
    }

    /// K, with Λ, and C over the changes of place of all bodies.
    pub fn whole_matrices(&self, at: &SteadyState) -> [Mat<f64>; 2] {
        let (terms, strain) = (&at.terms, &at.linear.strain);
        let n = strain.len();
        let mut stiffness = terms.unsprung.whole(n) + terms.springs.transpose() * &terms.springs;
        strain.iter().enumerate().for_each(|(k, strain)| stiffness[(k, k)] += strain);
        [stiffness, terms.damping.whole(n)]
    }

    /// The first order of a joint's reaction ([`SystemMotion::reaction`]).
    pub fn reaction_rows(&self, at: &SteadyState, joint: usize) -> ReactionRows {
        let system = self.system();
        let n = system.coordinates();
        let of = &system.joints()[joint];
        // W: force and moment of unit multipliers.
        let first = first_row(system, joint);
        let wrenches = unit_wrenches(of, at);
        let [stiffness, damping] = self.whole_matrices(at);
        let mass = {
            let mut mass = Mat::zeros(n, n);
            for (block, first) in at.terms.masses.iter().zip(&system.first) {
                for (i, j) in (0..block.ncols()).flat_map(|j| (0..block.nrows()).map(move |i| (i, j))) {
                    mass[(first + i, first + j)] = block[(i, j)];
                }
            }
            mass
        };
        let of_multipliers = |forces: &Mat<f64>, sign: f64| {
            let mut out = Mat::zeros(6, forces.ncols());
            for j in 0..forces.ncols() {
                let column: Vec<f64> = (0..n).map(|i| sign * forces[(i, j)]).collect();
                let multipliers = at.terms.multipliers_of(system, &column);
                for (k, wrench) in wrenches.iter().enumerate() {
                    (0..6).for_each(|i| out[(i, j)] += wrench[i] * multipliers[first + k]);
                }
            }
            out
        };
        let mut by_place = of_multipliers(&stiffness, 1.0);
        let turned = turned_wrenches(self, at, joint);
        by_place += &turned;
        ReactionRows {
            by_place,
            by_rate: of_multipliers(&damping, 1.0),
            by_force: of_multipliers(&Mat::identity(n, n), -1.0),
            by_acceleration: of_multipliers(&mass, 1.0),
        }
    }
}

/// The number of the first row of a joint.
fn first_row(system: &System, joint: usize) -> usize {
    system.joints()[..joint].iter().map(Joint::row_count).sum()
}

/// Force and moment, about the second marker, of a unit multiplier of each row.
fn unit_wrenches(joint: &Joint, at: &SteadyState) -> Vec<[f64; 6]> {
    let driven = joint.driven_at([at.configuration.time; 2]);
    let about = at.configuration.places(&joint.markers)[1].position;
    let mut wrenches = Vec::new();
    for (markers, rows) in joint.groups().filter(|(_, rows)| !rows.is_empty()) {
        let places = at.configuration.places(markers);
        let arm = places[1].position - about;
        wrenches.extend(rows.iter().map(|row| {
            let wrench = row.wrench(places.each_ref(), driven);
            let moment = wrench.moments[1] + arm.cross(&wrench.force);
            std::array::from_fn(|i| if i < 3 { wrench.force[i] } else { moment[i - 3] })
        }));
    }
    wrenches
}

/// Changes by ξ of the wrench of the multipliers as they are (6×n), as seen along axes that turn with the spin.
fn turned_wrenches(motion: &SystemMotion, at: &SteadyState, joint: usize) -> Mat<f64> {
    let system = motion.system();
    let n = system.coordinates();
    let of = &system.joints()[joint];
    let configuration = &at.configuration;
    let driven = of.driven_at([configuration.time; 2]);
    let mut out = Mat::zeros(6, n);
    let mut left = &at.terms.multipliers[first_row(system, joint)..];
    let about = configuration.places(&of.markers)[1].position;
    let of_whole = Tie::new(system, configuration, of.markers.iter());
    for (markers, rows) in of.groups().filter(|(_, rows)| !rows.is_empty()) {
        let (own, rest) = left.split_at(rows.len());
        left = rest;
        let places = configuration.places(markers);
        let arm = places[1].position - about;
        let mut tie = Tie::new(system, configuration, markers.iter());
        tie.add_rows(rows, &places, driven, own);
        let force = tie.wrench(1)[0];
        for k in 0..n {
            let mut unit = vec![0.0; n];
            unit[k] = 1.0;
            let [force_change, moment_change] = tie.wrench_change(1, &unit);
            let moved = |tie: &Tie| Vector3::from_column_slice(&tie.motions(&unit)[6..9]);
            let arm_change = moved(&tie) - moved(&of_whole);
            let moment = moment_change + arm.cross(&force_change) + arm_change.cross(&force);
            for i in 0..3 {
                out[(i, k)] += force_change[i];
                out[(3 + i, k)] += moment[i];
            }
        }
    }
    out
}
