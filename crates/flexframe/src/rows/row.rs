//! A row of a results file.

use std::ops::Deref;

use dynamics::{JointObservation, Observation};
use fem_tet10::{principal_stresses, von_mises};
use model::Model;
use nalgebra::Vector3;
use results::SystemRow;

/// A row of a results file: all bodies at one time.
#[derive(Debug, Clone, PartialEq)]
pub struct Row {
    /// The time.
    pub time: f64,
    /// The bodies, in the order of the scene.
    pub bodies: Vec<BodyRow>,
    /// The joints, then the springs and the bushings, each in the order of the scene.
    pub joints: Vec<JointObservation>,
}

/// A body in a row: its motion, and what was asked for besides.
#[derive(Debug, Clone, PartialEq)]
pub struct BodyRow {
    /// The motion.
    pub motion: Observation,
    /// Stress at the points; empty if not asked for.
    pub stress: Vec<PointStress>,
    /// Force of each of several supports on the body, and its moment about the mean of the nodes that it holds, global
    /// components.
    pub supports: Vec<[[f64; 3]; 2]>,
    /// Acceleration of the support, which the motion is relative to, global components.
    pub base_acceleration_global: Vector3<f64>,
}

/// The stress at a point, force per area.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct PointStress {
    /// xx, yy, zz, xy, yz, zx in body axes.
    pub components: [f64; 6],
    /// The von Mises stress.
    pub von_mises: f64,
    /// The principal stresses, the largest first.
    pub principal: [f64; 3],
}

impl BodyRow {
    /// Zeros: room for the rows of a model.
    pub fn new(model: &Model) -> Self {
        let stressed = model.stress.as_ref().map_or(0, model::BodyStress::points);
        Self {
            motion: Observation::new(model.body.flexible(), model.points.len()),
            stress: vec![PointStress::default(); stressed],
            supports: vec![[[0.0; 3]; 2]; model.supports.as_ref().map_or(0, |supports| supports.names().len())],
            base_acceleration_global: Vector3::zeros(),
        }
    }

    /// Fills in what follows from the motion.
    pub fn complete(&mut self, model: &Model) {
        self.complete_with(model, |_| 1.0);
    }

    /// The same, where what is outside multiplies each load that may act by a factor.
    pub fn complete_with(&mut self, model: &Model, factor: impl Fn(usize) -> f64) {
        let time = self.motion.time;
        self.base_acceleration_global = model.base.iter().map(|base| base.at(time) * factor(base.load)).sum();
        if let Some(supports) = &model.supports {
            let to_global = |vectors: [_; 2]| vectors.map(|vector| self.motion.attitude.to_global(&vector).into());
            self.supports = supports.at(&self.motion).into_iter().map(to_global).collect();
        }
        let Some(stress) = &model.stress else { return };
        for (row, components) in self.stress.iter_mut().zip(stress.at_points(&self.motion.modal_displacement)) {
            *row = PointStress {
                components,
                von_mises: von_mises(&components),
                principal: principal_stresses(&components),
            };
        }
    }
}

impl BodyRow {
    /// An acceleration that is relative to the support, and then that of the support, too.
    pub(super) fn absolute(&self, relative_global: Vector3<f64>) -> [f64; 3] {
        (relative_global + self.base_acceleration_global).into()
    }
}

impl SystemRow for Row {
    type Body = BodyRow;

    fn time(&self) -> f64 {
        self.time
    }

    fn bodies(&self) -> &[BodyRow] {
        &self.bodies
    }

    type Joint = JointObservation;

    fn joints(&self) -> &[JointObservation] {
        &self.joints
    }
}

impl Row {
    fn sum(&self, of_body: impl Fn(&BodyRow) -> f64) -> f64 {
        self.bodies.iter().map(of_body).sum()
    }

    /// Kinetic energy of all bodies.
    pub fn kinetic_energy(&self) -> f64 {
        self.sum(|body| body.kinetic_energy)
    }

    /// Strain energy of all bodies.
    pub fn strain_energy(&self) -> f64 {
        self.sum(|body| body.strain_energy)
    }

    /// Kinetic and strain energy of all bodies.
    pub fn energy(&self) -> f64 {
        self.sum(|body| body.energy())
    }

    /// Work of the loads since the beginning.
    pub fn work(&self) -> f64 {
        self.sum(|body| body.work.work)
    }

    /// Energy that damping has taken since the beginning.
    pub fn dissipation(&self) -> f64 {
        self.sum(|body| body.work.dissipation)
    }

    /// Energy less the work, and with the dissipation: constant in exact motion.
    pub fn energy_balance(&self) -> f64 {
        self.sum(|body| body.energy_balance())
    }

    /// Linear momentum of all bodies.
    pub fn linear_momentum_global(&self) -> Vector3<f64> {
        self.bodies.iter().map(|body| body.linear_momentum_global).sum()
    }

    /// Angular momentum of all bodies about the global origin.
    pub fn angular_momentum_global(&self) -> Vector3<f64> {
        let of_body =
            |body: &BodyRow| body.angular_momentum_global + body.position_global.cross(&body.linear_momentum_global);
        self.bodies.iter().map(of_body).sum()
    }
}

impl Deref for BodyRow {
    type Target = Observation;

    fn deref(&self) -> &Observation {
        &self.motion
    }
}
