//! Accelerations of the base of a held body as inputs, Eq. (F10), and reactions of its support as outputs.

use dynamics::Effect;
use linear::{Channel, Output};
use model::{HeldSlopes, Model};
use nalgebra::Vector3;
use reduced_body::Participation;
use scene::Scene;

use crate::commands::linear::linearize::channels::{along_axes, wrench_channels};
use crate::rows::units::UnitLabels;

/// The number of translations of a base.
pub(super) const TRANSLATIONS: usize = 3;

/// The motions of a base: translations along the axes of the body, then turns about them through its origin.
pub(super) fn base_channels(scene: &Scene) -> Vec<Channel> {
    let UnitLabels { length, time, .. } = (&scene.units).into();
    let translations = along_axes("base.acceleration", &format!("{length}/{time}²"));
    translations.into_iter().chain(along_axes("base.angular_acceleration", &format!("rad/{time}²"))).collect()
}

/// The acceleration that a motion of the base gives a point.
pub(super) fn at_point(arm: &Vector3<f64>, motion: usize) -> Vector3<f64> {
    let axis = Vector3::ith(motion % 3, 1.0);
    if motion < TRANSLATIONS { axis } else { axis.cross(arm) }
}

/// A held body that nothing but its modes moves in its base.
pub(super) struct Held<'a> {
    pub model: &'a Model,
    pub slopes: &'a HeldSlopes,
}

impl Held<'_> {
    /// Momenta of a unit rate of each mode: force and moment about the origin of its unit acceleration.
    pub fn momenta(&self) -> Vec<[f64; 6]> {
        let body = &self.model.body;
        let q = &self.slopes.modal_displacement;
        let Participation { factors, .. } = body.participation(&body.origin);
        let follows = self.model.physics.effects[Effect::Coriolis];
        let turned = |axis: usize, k: usize| -> f64 {
            q.iter().enumerate().filter(|_| follows).map(|(j, q)| body.gyroscopic[axis][(k, j)] * q).sum()
        };
        let of_mode = |(k, factor): (usize, [f64; 6])| {
            std::array::from_fn(|i| factor[i] + if i < 3 { 0.0 } else { turned(i - 3, k) })
        };
        factors.into_iter().enumerate().map(of_mode).collect()
    }

    /// Force and moment that a unit acceleration of each motion of the base takes where no mode moves.
    pub fn rigid(&self, motion: usize) -> [f64; 6] {
        let mass = self.model.body.rigid_mass();
        std::array::from_fn(|i| mass[(i, motion)])
    }

    /// The reaction: rows over `before` other coordinates, the modes and `after` others; `direct` by input.
    pub fn reactions(&self, scene: &Scene, [before, after]: [usize; 2], direct: &[[f64; 6]]) -> Vec<Output> {
        let [by_place, by_rate] = &self.slopes.by_modes;
        let row = |answers: &[(Vec<f64>, [f64; 6])], i: usize| {
            let of_modes = answers.iter().map(|(_, reaction)| reaction[i]);
            std::iter::repeat_n(0.0, before)
                .chain(of_modes)
                .chain(std::iter::repeat_n(0.0, after))
                .collect::<Vec<f64>>()
        };
        let channels = wrench_channels(scene, "reaction").into_iter().enumerate();
        let output = |(i, channel)| Output {
            channel,
            rows: [row(by_place, i), row(by_rate, i), Vec::new()],
            direct: direct.iter().map(|of_input| of_input[i]).collect(),
        };
        channels.map(output).collect()
    }
}
