//! A body that can move, as a scene describes it.

pub(crate) mod initial;
pub(crate) mod point_rotations;
pub(crate) mod points;
pub(crate) mod rest;

use std::sync::Arc;

use advice::{Advice, Backbone, Case, Refusal, StepEstimate};
use dynamics::{
    ConservativeBody, EffectMap, History, Initial, LoadFrame, LoadedError, LoadedMode, Manifold, Physics, PointShapes,
    Rows, Setup, SharedLoad, Simulation, StepControl,
};
use faer::Mat;
use fem_tet10::Mesh;
use frames_rk4::Paper;
use modal::{Modes, NoCycles};
use nalgebra::Vector3;
use reduced_body::ReducedBody;
use scene::{Body, Choice, MeshedBody};

use crate::building::progress::BuildTimes;
use crate::error::StartError;
use crate::load::mesh_load::BaseAcceleration;
use crate::mesh::given::MatrixChecks;
use crate::model::initial::initial;
use crate::needs::{Needed, Needs};
use crate::stress::shapes::BodyStress;
use crate::structure::remainders::Remainders;
use crate::support::reactions::SupportRows;
use crate::tie::body_marker::BodyMarker;

/// Deflection over the length at which small vibrations are looked at.
const SMALL: f64 = 1e-3;

/// The finite-element side of a body.
#[derive(Debug, Clone)]
pub struct Meshed {
    /// The mesh.
    pub mesh: Arc<Mesh>,
    /// The mesh file, the materials and the point masses of its elements; `None` for a body of matrices from another program.
    pub elements: Option<MeshedBody>,
    /// Notes about the parts of the mesh file that were left out, in sentences.
    pub mesh_notes: Vec<String>,
    /// Checks of the matrices, of a body of matrices from another program.
    pub checks: Option<MatrixChecks>,
    /// The reason that a factor that takes long was made here, where multigrid cycles could not take its place.
    pub no_cycles: Option<NoCycles>,
    /// Bytes that the mass and stiffness matrices took.
    pub matrix_bytes: usize,
    /// Rigid and flexible modes on the mesh.
    pub modes: Modes,
    /// Shapes on the mesh that only follow large modes (3n × …), none without: what the extended shapes have after the
    /// modes.
    pub following: Mat<f64>,
    /// Displacement of the bent body that the modes are about (3n × 1); none of modes about the undeformed one.
    pub reference: Option<Mat<f64>>,
}

/// The body of a scene in modal coordinates, with its mesh, its points and its loads.
#[derive(Debug)]
pub struct Model {
    /// Mesh and modes; `None` for a rigid body without a mesh.
    pub meshed: Option<Meshed>,
    /// The reduced body.
    pub body: ReducedBody,
    /// The part of the physics that is computed.
    pub physics: Physics,
    /// The points whose motion is written out, by name.
    pub points: Vec<(String, PointShapes)>,
    /// Places with axes, in the order of [`Body::markers`].
    pub markers: Vec<BodyMarker>,
    /// The paper's scheme with the scene's reference points.
    pub paper: Paper,
    /// Which effects the scene calls for, and why.
    pub advice: Advice,
    /// Known error of the model, if there is one: it does not start unless the scene says `refuse = false`.
    pub refusal: Option<Refusal>,
    /// The effects as the scene chooses them, or whoever needs others.
    pub choices: EffectMap<Choice>,
    /// Where the time went.
    pub times: BuildTimes,
    /// Its stress, where the scene asks for it.
    pub stress: Option<BodyStress>,
    /// Reactions of several supports.
    pub supports: Option<SupportRows>,
    /// Accelerations of the support that loads stand for: the motion is relative to it.
    pub base: Vec<BaseAcceleration>,
    pub(crate) loads: Vec<SharedLoad>,
    pub(crate) damping_ratios: Vec<f64>,
    /// All loads that the scene does not switch off, gravity that it does not call for among them.
    pub(crate) all_loads: Vec<SharedLoad>,
    /// The damping that the scene does not switch off, where it does not call for it, too (nf).
    pub(crate) all_damping_ratios: Vec<f64>,
    pub(crate) size: Size,
    /// Parts of static responses that the modes leave out, where that is to be watched.
    pub(crate) left_out: Remainders,
    /// Backbones of the modes that may bend the body far.
    pub(crate) backbones: Vec<Option<Backbone>>,
}

/// The size of a body and of its modes.
#[derive(Debug, Clone)]
pub(crate) struct Size {
    /// Largest distance of two points of the body.
    pub length: f64,
    /// Largest displacement of a node in each mode (nf).
    pub peaks: Vec<f64>,
}

impl Model {
    /// Frequencies of the flexible modes, cycles per time.
    pub fn natural_frequencies(&self) -> Vec<f64> {
        self.body.circular_frequencies.iter().map(|omega| omega / std::f64::consts::TAU).collect()
    }

    /// The lowest circular frequency, 0 of a rigid body. Beside a static answer they do not rise.
    pub(crate) fn lowest_frequency(&self) -> f64 {
        self.body.circular_frequencies.iter().copied().reduce(f64::min).unwrap_or(0.0)
    }

    /// Damping ratio of each flexible mode.
    pub fn damping_ratios(&self) -> &[f64] {
        &self.damping_ratios
    }

    /// The loads, at their points of the body.
    pub fn loads(&self) -> &[SharedLoad] {
        &self.loads
    }

    /// The parts of the run of its scene where forces are added that the estimates do not know: the physics, the loads and the
    /// damping ratio of each flexible mode. Effects are on as by [`Needs::external_inputs`].
    pub fn under_unknown_forces(&self, body: &Body) -> (Physics, Vec<SharedLoad>, Vec<f64>) {
        let mut physics = self.physics.clone();
        for effect in Needed::new(body, &Needs::default()).on_under_unknown_forces() {
            physics.effects[effect] = true;
        }
        (physics, self.all_loads.clone(), self.all_damping_ratios.clone())
    }

    /// True if the stress of loads or of a drive stiffens the body.
    pub fn is_stressed(&self) -> bool {
        self.physics.drive_stiffness.is_some() || self.loads.iter().any(|load| load.matrix_entries() > 0)
    }

    /// The small vibrations of the body under the loads that stay as they are, seen from it: about its rest under them with
    /// large modes, otherwise they are the same about the undeformed body.
    ///
    /// # Errors
    /// [`LoadedError`].
    pub fn loaded_modes(&self, given: &Body) -> Result<Vec<LoadedMode>, LoadedError> {
        let turns = self.physics.drive.is_some() || !self.body.motion.rotations().is_empty();
        let is_steady = |load: &&SharedLoad| {
            let follows = load.pattern().is_some_and(|pattern| pattern.frame != LoadFrame::Global);
            matches!(load.history(), Some(History::Constant)) && (follows || !turns)
        };
        let steady = self.loads.iter().filter(is_steady).cloned().collect();
        let physics = Physics { drive: None, drive_stiffness: None, ..self.physics.clone() };
        let body = ConservativeBody::new(&self.body, &self.damping_ratios, steady, &physics)?;
        body.loaded_modes(&self.initial(given), &self.small_amplitudes())
    }

    /// Modal displacements (nf) that are small.
    pub(crate) fn small_amplitudes(&self) -> Vec<f64> {
        self.size.peaks.iter().map(|peak| SMALL * self.size.length / peak).collect()
    }

    /// How many static shapes follow the natural modes.
    pub fn static_shapes(&self) -> usize {
        self.body.flexible() - self.body.natural_modes
    }

    /// Which coordinates are large, numbered from 0: modes, and the [static answer](Self::static_answer); none without large deflection.
    pub fn large_modes(&self) -> &[usize] {
        self.physics.large_deflection.as_ref().map_or(&[], Manifold::large)
    }

    /// The large coordinate that is the static answer to moments, numbered from 0, if there is one.
    pub fn static_answer(&self) -> Option<usize> {
        Some(self.meshed.as_ref()?.modes.answer.as_ref()?.place)
    }

    /// The coordinates of the modes and of the shapes that follow them: u is their sum with [`Meshed::modes`] and then
    /// [`Meshed::following`].
    pub fn coordinates(&self, modal_displacement: &[f64]) -> Vec<f64> {
        let Some(manifold) = &self.physics.large_deflection else { return modal_displacement.to_vec() };
        let mut xi = vec![0.0; manifold.body().flexible()];
        manifold.coordinates(modal_displacement, &mut xi);
        xi
    }

    /// The rates of these coordinates, and after them of the products of large modes ([`Manifold::products`]), by the rates of the modal
    /// displacements: a list for each. `None` where they are the modal displacements.
    pub fn coordinate_slopes(&self, modal_displacement: &[f64]) -> Option<Vec<Vec<f64>>> {
        Some(self.physics.large_deflection.as_ref()?.slopes(modal_displacement))
    }

    /// From the origin to a point of the deformed body, body components.
    pub fn arm(&self, point: &PointShapes, modal_displacement: &[f64]) -> Vector3<f64> {
        point.position_body() + point.deformation(&self.coordinates(modal_displacement))
    }

    /// How the frequency of each of the first modes goes with its amplitude, of those that may bend the body far.
    pub fn backbones(&self) -> &[Option<Backbone>] {
        &self.backbones
    }

    /// Largest displacement by deformation over the length of the body, bounded above by the sum over the modes.
    pub fn deflection(&self, modal_displacement: &[f64]) -> f64 {
        modal_displacement.iter().zip(&self.size.peaks).map(|(q, peak)| (q * peak).abs()).sum::<f64>()
            / self.size.length
    }

    /// The state that a scene begins with, its lists padded with zeros.
    pub fn initial(&self, body: &Body) -> Initial {
        initial(body, &self.body)
    }

    /// The run as [`advice`] sees it, which begins with `initial`.
    pub fn case<'a>(&'a self, body: &'a Body, initial: &'a Initial) -> Case<'a> {
        Case {
            body: &self.body,
            damping_ratios: &self.damping_ratios,
            loads: &self.loads,
            is_gravity: &[],
            drive: self.physics.drive.as_ref(),
            initial,
            end: body.time.end,
            length: self.size.length,
            length_unit: &body.units.length,
            peaks: &self.size.peaks,
            static_compliances: &[],
            centrifugal_remainders: &self.left_out.of_spin,
            drive_remainder: self.left_out.of_drive,
            backbones: &self.backbones,
            manifold: self.physics.large_deflection.as_ref(),
            coupling: self.physics.coupling.as_ref(),
        }
    }

    /// The motion of a scene from its beginning.
    ///
    /// # Errors
    /// [`StartError`], e.g. a step beyond the stability limit.
    pub fn start(&self, body: &Body) -> Result<Simulation, StartError> {
        let started = self.start_with(body, *body.method(), body.time.control, body.rows);
        started.map_err(|error| error.at_key(body))
    }

    /// The motion of a scene by another method, in other steps or with other rows than its own.
    ///
    /// # Errors
    /// As [`Model::start`].
    pub fn start_with(
        &self,
        body: &Body,
        method: dynamics::Method,
        control: StepControl,
        rows: Rows,
    ) -> Result<Simulation, StartError> {
        StartError::refuse_tied(body)?;
        if let Some(refusal) = self.refusal.filter(|_| body.effects.refuse) {
            return Err(refusal.into());
        }
        let points: Vec<PointShapes> = self.points.iter().map(|(_, point)| point.clone()).collect();
        let initial = self.initial(body);
        let method = self.paper.or(&method);
        let setup = Setup { method, control, rows, points: &points, ..self.setup(body, &initial) };
        Ok(Simulation::new(&setup)?)
    }

    /// Estimated error of the length of the steps; nothing under step control.
    ///
    /// # Errors
    /// As [`Model::start`].
    pub fn step_estimate(&self, body: &Body) -> Result<Option<StepEstimate>, StartError> {
        Ok(advice::step_estimate(&self.setup(body, &self.initial(body)))?)
    }

    /// The setup that [`Simulation::new`] needs for the run of a scene, without its points. Loads, steps or anything else
    /// may be
    /// replaced.
    pub fn setup<'a>(&'a self, body: &'a Body, initial: &'a Initial) -> Setup<'a> {
        Setup {
            body: &self.body,
            damping_ratios: &self.damping_ratios,
            loads: &self.loads,
            physics: &self.physics,
            initial,
            method: self.paper.or(body.method()),
            control: body.time.control,
            end: body.time.end,
            rows: body.rows,
            points: &[],
        }
    }
}
