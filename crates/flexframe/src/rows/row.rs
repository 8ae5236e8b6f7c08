//! A row of a results file.

use std::ops::Deref;

use dynamics::Observation;
use fem_tet10::{principal_stresses, von_mises};
use model::Model;

/// A row of a results file: the motion, and what was asked for besides.
#[derive(Debug, Clone, PartialEq)]
pub struct Row {
    /// The motion.
    pub motion: Observation,
    /// Stress at the points; empty if not asked for.
    pub stress: Vec<PointStress>,
    /// Force of each of several supports on the body, and its moment about the mean of the nodes that it holds, global
    /// components.
    pub supports: Vec<[[f64; 3]; 2]>,
}

/// The stress at a point, force per area.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct PointStress {
    /// xx, yy, zz, xy, yz, zx in body axes.
    pub components: [f64; 6],
    /// The von Mises stress.
    pub von_mises: [f64; 1],
    /// The principal stresses, the largest first.
    pub principal: [f64; 3],
}

impl Row {
    /// Zeros: room for the rows of a model.
    pub fn new(model: &Model) -> Self {
        let stressed = model.stress.as_ref().map_or(0, model::BodyStress::points);
        Self {
            motion: Observation::new(model.body.flexible(), model.points.len()),
            stress: vec![PointStress::default(); stressed],
            supports: vec![[[0.0; 3]; 2]; model.supports.as_ref().map_or(0, |supports| supports.names().len())],
        }
    }

    /// Fills in what follows from the motion.
    pub fn complete(&mut self, model: &Model) {
        if let Some(supports) = &model.supports {
            let to_global = |vectors: [_; 2]| vectors.map(|vector| self.motion.attitude.to_global(&vector).into());
            self.supports = supports.at(&self.motion).into_iter().map(to_global).collect();
        }
        let Some(stress) = &model.stress else { return };
        for (row, components) in self.stress.iter_mut().zip(stress.at_points(&self.motion.modal_displacement)) {
            *row = PointStress {
                components,
                von_mises: [von_mises(&components)],
                principal: principal_stresses(&components),
            };
        }
    }
}

impl Deref for Row {
    type Target = Observation;

    fn deref(&self) -> &Observation {
        &self.motion
    }
}
