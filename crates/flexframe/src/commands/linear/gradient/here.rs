//! A system where it stands at the start, with its vibrations and the rates of its stiffness: Eq. (D15) of `docs/method/gradients.md`.

use std::ops::Range;
use std::path::PathBuf;

use diagnostic::{Diagnostic, Failure, Kind};
use dynamics::{CommonSpin, SteadyError, SteadyState, SystemMode, Vibrations};
use faer::Mat;
use model::Model;
use scene::Scene;

use super::number::{Number, Place};
use super::varying::{REPEATED, Varying};
use crate::commands::system_modes::{Rotors, TiedMotion, tied_motions};

/// A part of an entry that is rounding.
const ROUNDING: f64 = 1e-8;

/// A system where it stands at the start.
pub(super) struct Here<'a> {
    pub system: &'a Scene,
    pub models: &'a [Model],
    pub motion: TiedMotion,
    pub steady: SteadyState,
    /// True where a motion as a whole is left that nothing resists.
    pub is_loose: bool,
    pub modes: Vec<SystemMode>,
}

/// A body of which numbers vary, with their places among all numbers.
pub(super) struct NumbersOfBody<'a> {
    pub body: Varying<'a>,
    pub places: Vec<usize>,
}

impl<'a> NumbersOfBody<'a> {
    /// The body, and the place among its numbers of one of all.
    pub fn of(&self, number: usize) -> Option<(&Varying<'a>, usize)> {
        Some((&self.body, self.places.iter().position(|place| *place == number)?))
    }
}

impl<'a> Here<'a> {
    pub fn new(scene: &'a Scene, models: &'a [Model]) -> Result<Self, Failure> {
        let (motion, steady) = steady(scene, models)?;
        let linear = &steady.linear;
        let failed = |source: SteadyError| source.in_file(&scene.path);
        let Vibrations { rigid, zeros, modes } = linear.vibrations().map_err(failed)?;
        let mut modes: Vec<SystemMode> = modes.into_iter().filter(|mode| mode.circular_frequency() > 0.0).collect();
        modes.sort_by(|a, b| a.circular_frequency().total_cmp(&b.circular_frequency()));
        for matrix in [&linear.stiffness, &linear.damping] {
            if (matrix - matrix.transpose()).norm_max() > ROUNDING * matrix.norm_max() {
                return Err(loaded(scene));
            }
        }
        let is_loose = rigid.ncols() > 0 || zeros > 0;
        Ok(Self { system: scene, models, motion, steady, is_loose, modes })
    }

    pub fn path(&self) -> PathBuf {
        self.system.path.clone()
    }

    pub fn loaded(&self) -> Failure {
        loaded(self.system)
    }

    /// The error of a number of a body that is not in the system.
    pub fn outside(&self, number: &Number) -> Failure {
        let wrong = Kind::Refused.of(&self.system.path).found(format!("{} of a body outside the system", number.name));
        wrong.expected("one of a body that joints, springs or bushings tie to it").help("leave it out").into()
    }

    /// Refuses bodies that stand deformed, and so elsewhere with other numbers.
    pub fn refuse_deformed(&self) -> Result<(), Failure> {
        let is_still = |(place, body): (usize, &usize)| {
            let size = self.models[*body].body.inertia.trace().sqrt();
            self.steady.modal_displacement(place).iter().all(|q| q.abs() <= ROUNDING * size)
        };
        if self.motion.bodies.iter().enumerate().all(is_still) { Ok(()) } else { Err(self.loaded()) }
    }

    /// The body that a number varies, by its number in the scene, with the place of this number among those of the body.
    pub fn varying<'v>(
        &self,
        i: usize,
        number: &Number,
        varied: &'v [Option<NumbersOfBody<'v>>],
    ) -> Result<(usize, &'v Varying<'v>, usize), Failure> {
        let Place::Body(body, _) = number.place else { return Err(self.outside(number)) };
        let found = varied[body].as_ref().and_then(|varied| varied.of(i));
        found.map(|(of_body, k)| (body, of_body, k)).ok_or_else(|| self.outside(number))
    }

    pub fn repeated(&self) -> Vec<Range<usize>> {
        let is_one = |before: &SystemMode, after: &SystemMode| {
            (after.eigenvalue - before.eigenvalue).norm() <= REPEATED * after.eigenvalue.norm()
        };
        modal::repeated(&self.modes, is_one)
    }

    /// The rate of K with a stiffness.
    pub fn stiffness_rate(&self, number: &Number) -> Result<Mat<f64>, Failure> {
        let (mut changed, value) = (self.system.clone(), number.value(self.system));
        number.set(&mut changed, 2.0 * value);
        let (there, here) = (steady(&changed, self.models)?.1, &self.steady);
        // A body that the stiffness deforms stands elsewhere, with other coordinates.
        let is_moved = |(place, body): (usize, &usize)| {
            let size = self.models[*body].body.inertia.trace().sqrt();
            let pairs = there.modal_displacement(place).iter().zip(here.modal_displacement(place));
            pairs.into_iter().any(|(q, here)| (q - here).abs() > ROUNDING * size)
        };
        if self.motion.bodies.iter().enumerate().any(is_moved) {
            return Err(self.loaded());
        }
        let motion = self.motion.run.motion();
        let [[there, _], [whole, _]] = [&there, here].map(|at| motion.whole_matrices(at));
        let basis = &here.linear.basis;
        Ok(basis.transpose() * ((there - whole) * basis) * faer::Scale(1.0 / value))
    }
}

/// The refusal of a system whose place depends on its stiffnesses.
fn loaded(scene: &Scene) -> Failure {
    let words =
        "found bodies that forces deform at the start, whose vibrations follow stiffnesses and materials in two ways";
    let help = "take the loads and preloads out, and place the bodies so that springs have no force";
    Kind::Refused.of(&scene.path).help(help).says(words)
}

/// The one system of a scene where it stands at the start.
fn steady(scene: &Scene, models: &[Model]) -> Result<(TiedMotion, SteadyState), Failure> {
    let mut motions = tied_motions(scene, models)?;
    let (Some(motion), true) = (motions.pop(), motions.is_empty()) else {
        let found = format!("{} systems that nothing ties together", motions.len() + 1);
        let wrong = Kind::Input.of(&scene.path).found(found).expected("one");
        return Err(wrong.help("make a scene of each").into());
    };
    let failed = |source: SteadyError| source.in_file(&scene.path);
    let of_motion = motion.run.motion();
    let steady = Rotors::of(of_motion, |_| false).steady_state(of_motion, &CommonSpin::REST).map_err(failed)?;
    Ok((motion, steady))
}
