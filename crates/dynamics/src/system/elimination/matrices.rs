//! The factors that the steps of a system need.

use nalgebra::{Complex, Matrix3};

use crate::conservative::ConservativeBody;
use crate::system::constraints::{Compliant, End};
use crate::system::description::System;
use crate::system::elimination::inverse::Inverse;
use crate::system::elimination::joint_matrix::JointMatrix;
use crate::system::elimination::number::Number;
use crate::system::elimination::patterns::Patterns;
use crate::system::elimination::tension::Tension;
use crate::system::stage::Stage;

/// Factors of a step.
#[derive(Debug, Clone)]
pub(in crate::system) struct Matrices {
    /// The compliant rows of the Newton matrix.
    pub compliant: Vec<Compliant>,
    /// True for each row that others imply, or that is compliant without stiffness.
    pub is_left_out: Vec<bool>,
    pub tension: Tension,
    mass: Vec<Inverse<f64>>,
    pub of_mass: JointMatrix<f64>,
    pub real: NewtonMatrix<f64>,
    pub complex: NewtonMatrix<Complex<f64>>,
    /// As if a step were a part of the run: what springs and shapes hold does not drift.
    pub drift: NewtonMatrix<f64>,
}

/// The Newton matrix of one κ.
#[derive(Debug, Clone)]
pub(in crate::system) struct NewtonMatrix<T> {
    pub kappa: T,
    /// Z⁻¹ of each body.
    pub bodies: Vec<Inverse<T>>,
    /// The factor over the rows, with the compliant ones.
    pub rows: JointMatrix<T>,
}

impl Matrices {
    /// Room for those of a system.
    pub fn new(system: &System, patterns: &Patterns) -> Self {
        let coordinates = system.coordinates();
        Self {
            compliant: vec![Compliant::default(); patterns.newton.len() - patterns.rows.len()],
            is_left_out: vec![false; patterns.newton.len()],
            tension: Tension::new(system.bodies.len()),
            mass: system.bodies.iter().map(Inverse::of).collect(),
            of_mass: JointMatrix::new(&patterns.rows, coordinates),
            real: NewtonMatrix::new(system, patterns),
            complex: NewtonMatrix::new(system, patterns),
            drift: NewtonMatrix::new(system, patterns),
        }
    }

    /// The factor of G M⁻¹ Gᵀ where a stage is. False where an inertia is singular.
    pub fn factor_mass(&mut self, patterns: &Patterns, stage: &Stage) -> bool {
        let Self { is_left_out, mass, of_mass, .. } = self;
        for (inertia, mass) in stage.inertia.iter().zip(&mut *mass) {
            if !mass.find_of_mass(inertia) {
                return false;
            }
        }
        of_mass.assemble(&patterns.rows, &stage.constraints, mass);
        of_mass.factor(&patterns.rows, is_left_out);
        true
    }

    /// Factors of G M⁻¹ Gᵀ, and of the Newton matrix of a real κ, where a stage is, with K of taut bodies or without. False where an
    /// inertia is singular.
    pub fn factor_real(
        &mut self,
        system: &System,
        patterns: &Patterns,
        stage: &Stage,
        kappa: f64,
        with_tension: bool,
    ) -> bool {
        if !self.factor_mass(patterns, stage) {
            return false;
        }
        let compliant = self.is_left_out[system.rows()..].iter_mut().zip(&self.compliant);
        compliant.for_each(|(is_left_out, row)| *is_left_out = row.is_slack());
        let Self { compliant, is_left_out, real, tension, .. } = self;
        for (b, inverse) in real.bodies.iter_mut().enumerate() {
            inverse.tension = if with_tension { tension.frozen[b] } else { Matrix3::zeros() };
        }
        real.factor(kappa, system, patterns, stage, compliant, is_left_out)
    }

    /// Factor of the Newton matrix for what drifts where a stage is, after the factor of a step. Taut bodies hang together, and drift.
    pub fn factor_drift(&mut self, system: &System, patterns: &Patterns, stage: &Stage, kappa: f64) -> bool {
        let Self { compliant, is_left_out, drift, .. } = self;
        drift.factor(kappa, system, patterns, stage, compliant, is_left_out)
    }

    /// Energy that a small motion of the bodies, in their axes, puts into the compliant rows.
    pub fn strain_energy(&self, stage: &Stage, x: &[f64]) -> f64 {
        let kappa = self.real.kappa;
        let rows = self.compliant.iter().zip(stage.constraints.compliant_ends());
        let of_row = |(row, ends): (&Compliant, &Vec<End>)| {
            let mut path = 0.0;
            ends.iter().for_each(|end| end.add_rate(1.0, x, &mut path));
            0.5 * kappa * row.resistance(kappa) * path * path
        };
        rows.filter(|(row, _)| !row.is_slack()).map(of_row).sum()
    }

    /// Factor of the Newton matrix of a complex κ where a stage is, after that of a real one.
    pub fn factor_complex(&mut self, system: &System, patterns: &Patterns, stage: &Stage, kappa: Complex<f64>) -> bool {
        let Self { compliant, is_left_out, complex, tension, .. } = self;
        complex.bodies.iter_mut().zip(&tension.frozen).for_each(|(inverse, tension)| inverse.tension = *tension);
        complex.factor(kappa, system, patterns, stage, compliant, is_left_out)
    }
}

impl<T: Number> NewtonMatrix<T> {
    fn new(system: &System, patterns: &Patterns) -> Self {
        let coordinates = system.coordinates();
        Self {
            kappa: T::from_real(1.0),
            bodies: system.bodies.iter().map(Inverse::of).collect(),
            rows: JointMatrix::new(&patterns.newton, coordinates),
        }
    }

    fn factor(
        &mut self,
        kappa: T,
        system: &System,
        patterns: &Patterns,
        stage: &Stage,
        compliant: &[Compliant],
        is_left_out: &[bool],
    ) -> bool {
        self.kappa = kappa;
        for ((body, inertia), inverse) in system.bodies.iter().zip(&stage.inertia).zip(&mut self.bodies) {
            if !inverse.find(kappa, inertia, |k| oscillator(body, k)) {
                return false;
            }
        }
        let pattern = &patterns.newton;
        self.rows.assemble(pattern, &stage.constraints, &self.bodies);
        let compliant = (system.rows()..).zip(compliant).filter(|(_, row)| !row.is_slack());
        compliant.for_each(|(row, of)| self.rows.add_compliance(pattern, row, of.resistance(kappa).recip()));
        self.rows.factor(pattern, is_left_out);
        true
    }
}

/// Λ_k and D_k of a mode.
fn oscillator(body: &ConservativeBody, k: usize) -> [f64; 2] {
    let (omega, zeta) = (body.circular_frequencies[k], body.damping_ratios[k]);
    [omega * omega, 2.0 * zeta * omega]
}
