//! A body with a mesh: its modes, and the effects that its scene calls for.

use std::time::Instant;

use advice::{Advice, Backbone, Case, Effect, StaticCompliance, advise, buckling, limits, screen};
use faer::{Col, Mat, MatRef};
use fem_tet10::{AssemblyError, Location, Matrices, Mesh, geometric_stiffness_product, reduced_geometric_stiffness};
use frames_rk4::{Drive, Initial, Method, Physics, PointShapes, SharedLoad};
use modal::{BodyPoint, ModalError, Modes, ReducedBody, Solver, Support, centrifugal_fields};
use nalgebra::Vector3;

use super::backbones::backbones;
use super::damping::damping_ratios;
use super::error::{BuildError, modal, refuse, too_many_modes};
use super::initial::initial;
use super::loads::{self, MeshLoad};
use super::mesh::{matrices, read_mesh};
use super::model::{Meshed, Model, Size, truncated_modes};
use super::points::{output_points, well_spread};
use super::progress::{BuildProgress, BuildTimes, timed};
use super::support::support;
use super::{physics, turning};
use crate::effects::{Choice, Effects};
use crate::modes::Flexible;
use crate::scene::{Frame, MeshedBody, Scene};

pub(super) fn build(
    scene: &Scene,
    body: &MeshedBody,
    mut progress: impl FnMut(BuildProgress),
) -> Result<Model, BuildError> {
    let mut times = BuildTimes::default();
    progress(BuildProgress::Mesh);
    let mesh = timed(&mut times.mesh, || read_mesh(scene, body))?;
    progress(BuildProgress::Assembly);
    let matrices = timed(&mut times.assembly, || matrices(scene, body, &mesh))?;
    let (support, drive) = support(scene, Some(&mesh))?;
    let requested = match scene.effects.flexibility {
        Choice::Off => 0,
        Choice::On | Choice::Auto => scene.modes.flexible.most(),
    };
    let solver =
        Solver::new(matrices.stiffness(), matrices.mass(), mesh.positions(), &support).map_err(modal(scene))?;
    let modes = timed(&mut times.modes, || {
        solver.modes(requested, |p| progress(BuildProgress::Modes(p))).map_err(|error| too_many_modes(scene, error))
    })?;
    let loads = loads::on_mesh(scene, &mesh, &solver.nodal_mass().row_sums())?;
    let parts =
        Parts { scene, body, mesh: &mesh, matrices: &matrices, solver: &solver, support: &support, loads, drive };
    let Reduced { modes, body, physics, mut loads, size, damping_ratios, advice, left_out, buckles, backbones } =
        parts.reduce(modes, &mut times, &mut progress)?;

    let started = Instant::now();
    let point = |key: String, at: [f64; 3]| -> Result<PointShapes, BuildError> {
        let Location { nodes, weights } = mesh.locate(at).map_err(|error| refuse(scene, &key, error))?;
        let point = BodyPoint::new(&modes, mesh.positions(), &nodes, &weights);
        Ok(PointShapes::new(&body, &point.map_err(modal(scene))?))
    };
    let points = output_points(scene, point)?;
    if scene.effects.gravity == Choice::Auto && !advice.is_on(Effect::Gravity) {
        loads.truncate(loads.len() - loads::count_gravity(scene));
    }
    let reference_points = match scene.frame {
        Some(Frame { r, p, q }) => [r, p, q],
        None => well_spread(mesh.positions(), &body.center_of_mass),
    }
    .map(|x| Vector3::from(x) - body.origin);
    times.reduction += started.elapsed();
    drop(parts);
    drop(solver);
    let mut model = Model {
        meshed: Some(Meshed { matrix_bytes: matrices.bytes(), mesh, modes }),
        body,
        physics,
        points,
        reference_points,
        advice,
        refusal: None,
        times,
        loads,
        damping_ratios,
        size,
        left_out,
        backbones,
    };
    let initial = model.initial(scene);
    model.refusal = buckling(buckles);
    if model.refusal.is_none() {
        model.refusal = limits(&model.case(scene, &initial), &model.physics.effects)?;
    }
    // What stresses the body may stiffen it beyond what the estimate knows.
    if model.refusal.is_none() && model.physics.load_stiffness.is_none() {
        model.refusal = model.advice.refusal();
    }
    Ok(model)
}

/// What the reduced body is made from.
struct Parts<'a> {
    scene: &'a Scene,
    body: &'a MeshedBody,
    mesh: &'a Mesh,
    matrices: &'a Matrices,
    solver: &'a Solver<'a>,
    support: &'a Support,
    /// Those that may act, gravity last.
    loads: Vec<MeshLoad>,
    drive: Option<Drive>,
}

/// The body with the effects that its scene calls for.
struct Reduced {
    modes: Modes,
    body: ReducedBody,
    physics: Physics,
    loads: Vec<SharedLoad>,
    size: Size,
    damping_ratios: Vec<f64>,
    advice: Advice,
    left_out: Vec<f64>,
    /// The steady loads over those at which the body buckles; 0 where they do not.
    buckles: f64,
    backbones: Vec<Option<Backbone>>,
}

/// A body in the coordinates of some modes.
struct Draft {
    body: ReducedBody,
    loads: Vec<SharedLoad>,
    size: Size,
    damping_ratios: Vec<f64>,
    initial: Initial,
    backbones: Vec<Option<Backbone>>,
}

/// A load, and another force or moment in the place of its own.
type Acting<'a> = (&'a MeshLoad, Option<Vector3<f64>>);

/// Static answers (3n each), side by side; none where nothing asks for them.
struct Statics {
    /// To the loads in every direction that they may come to have in the body, and the work of each load on its answers.
    of_loads: Option<(Mat<f64>, Vec<StaticCompliance>)>,
    /// To the centrifugal field of each pair of spins (3n × 6), and what the modes leave out of each.
    of_spin: Option<(Mat<f64>, Vec<f64>)>,
    /// To the steady loads together (3n × 1).
    of_steady: Option<Mat<f64>>,
}

impl Parts<'_> {
    /// Decides what the scene leaves open, and makes the body that has it. What turns out not to be called for is not
    /// computed, but for what tells so.
    fn reduce(
        &self,
        mut modes: Modes,
        times: &mut BuildTimes,
        progress: &mut dyn FnMut(BuildProgress),
    ) -> Result<Reduced, BuildError> {
        let scene = self.scene;
        let tolerance = scene.effects.tolerance;
        let mut draft = timed(&mut times.reduction, || self.draft(&modes))?;

        let stiffening = self.may_stiffen(&draft)?;
        let correction = match scene.modes.static_correction {
            _ if draft.body.flexible() == 0 => Choice::Off,
            // The shapes are stiff, which only this scheme does not mind.
            Choice::Auto if scene.time.method != Method::EXPONENTIAL => Choice::Off,
            choice => choice,
        };
        let of_loads = correction != Choice::Off && !self.loads.is_empty();
        let of_spin = stiffening || self.may_stretch(&draft)?;
        let steady = self.steady_loads(&draft);
        if of_loads || of_spin || !steady.is_empty() {
            progress(BuildProgress::Statics);
        }
        let started = Instant::now();
        let statics = self.statics(&modes, &draft.body, [of_loads, of_spin], &steady)?;
        if stiffening {
            self.stiffen(&mut draft, self.stress_stiffness(&statics, &modes)?)?;
        }
        let mut advice = advise(&self.case(&draft, Some(&statics)), tolerance)?;
        let material = &self.body.materials;
        draft.backbones = backbones(scene, self.mesh, material, self.solver, &modes, &draft.size, &advice)?;
        if draft.backbones.iter().any(Option::is_some) {
            advice = advise(&self.case(&draft, Some(&statics)), tolerance)?;
        }
        let keep = match (scene.modes.flexible, scene.effects.flexibility) {
            (Flexible::Auto { .. }, Choice::On) => advice.keep.max(1).min(draft.body.flexible()),
            (Flexible::Auto { .. }, Choice::Auto) => advice.keep,
            _ => draft.body.flexible(),
        };
        let corrects = keep > 0
            && match correction {
                Choice::On => true,
                Choice::Off => false,
                Choice::Auto => advice.is_on(Effect::StaticCorrection),
            };
        let mut left_out = Vec::new();
        if let Some((_, remainders)) = statics.of_spin.as_ref().filter(|_| !corrects && keep > 0) {
            advice.lack_stretch();
            if scene.modes.static_correction == Choice::Auto {
                left_out.clone_from(remainders);
            }
        }
        let stiffening = stiffening
            && keep > 0
            && (scene.effects.geometric_stiffening == Choice::On || advice.is_on(Effect::GeometricStiffening));
        if keep < draft.body.flexible() || corrects {
            modes = truncated_modes(&modes, keep);
            if corrects {
                let of_loads = statics.of_loads.as_ref().map(|(answers, _)| answers);
                let of_spin = statics.of_spin.as_ref().map(|(answers, _)| answers);
                for answers in of_loads.into_iter().chain(of_spin) {
                    modes = self.solver.with_static_shapes(modes, answers.as_ref()).map_err(modal(scene))?;
                }
            }
            let backbones = std::mem::take(&mut draft.backbones);
            draft = self.draft(&modes)?;
            draft.backbones = backbones.into_iter().take(keep).collect();
            // What the static shapes carry is to be expected, too.
            advice.deflection = advise(&self.case(&draft, None), tolerance)?.deflection;
            if stiffening {
                self.stiffen(&mut draft, self.stress_stiffness(&statics, &modes)?)?;
            }
        }
        let effects = physics::effects(scene, &advice, stiffening);
        if !effects.geometric_stiffening {
            self.stiffen(&mut draft, None)?;
        }
        let (load_stiffness, buckles) = self.load_stiffness(statics.of_steady.as_ref(), &modes, &draft, &mut advice)?;
        if of_loads || of_spin || !steady.is_empty() {
            times.statics = started.elapsed();
        }

        let Draft { body, loads, size, mut damping_ratios, backbones, .. } = draft;
        if scene.effects.damping == Choice::Auto && !scene.time.method.is_of_paper() && !advice.is_on(Effect::Damping) {
            damping_ratios.fill(0.0);
        }
        let physics = Physics { effects, drive: self.drive.clone(), load_stiffness };
        Ok(Reduced { modes, body, physics, loads, size, damping_ratios, advice, left_out, buckles, backbones })
    }

    /// Gives the body the stress stiffness of the spin, or takes it away.
    fn stiffen(&self, draft: &mut Draft, stress_stiffness: Option<[Mat<f64>; 6]>) -> Result<(), BuildError> {
        draft.body = draft.body.clone().with_stress_stiffness(stress_stiffness).map_err(modal(self.scene))?;
        Ok(())
    }

    fn draft(&self, modes: &Modes) -> Result<Draft, BuildError> {
        let body = ReducedBody::new(modes, self.matrices.mass(), self.mesh.positions()).map_err(modal(self.scene))?;
        let peak = |shape: faer::ColRef<'_, f64>| {
            let at = |node: usize| Vector3::from_fn(|axis, _| shape[3 * node + axis]).norm();
            (0..shape.nrows() / 3).map(at).fold(0.0, f64::max)
        };
        Ok(Draft {
            loads: self
                .loads
                .iter()
                .map(|load| load.reduced(&body, modes, self.mesh))
                .collect::<Result<_, _>>()
                .map_err(modal(self.scene))?,
            size: Size { length: self.mesh.diagonal(), peaks: modes.shapes.as_ref().col_iter().map(peak).collect() },
            damping_ratios: damping_ratios(self.scene, &body),
            initial: initial(self.scene, body.flexible()),
            backbones: Vec::new(),
            body,
        })
    }

    fn case<'a>(&'a self, draft: &'a Draft, statics: Option<&'a Statics>) -> Case<'a> {
        let (loads, gravity) = draft.loads.split_at(draft.loads.len() - loads::count_gravity(self.scene));
        Case {
            body: &draft.body,
            damping_ratios: &draft.damping_ratios,
            loads,
            gravity,
            drive: self.drive.as_ref(),
            initial: &draft.initial,
            end: self.scene.time.end,
            length: draft.size.length,
            peaks: &draft.size.peaks,
            static_compliances: statics.and_then(|s| s.of_loads.as_ref()).map_or(&[], |(_, compliances)| compliances),
            centrifugal_remainders: statics.and_then(|s| s.of_spin.as_ref()).map_or(&[], |(_, remainders)| remainders),
            backbones: &draft.backbones,
        }
    }

    /// Whether the stress of the spin may matter, and is to be computed.
    fn may_stiffen(&self, draft: &Draft) -> Result<bool, BuildError> {
        let scene = self.scene;
        if draft.body.flexible() == 0 || scene.effects.deformed_inertia == Choice::Off {
            return Ok(false);
        }
        Ok(match scene.effects.geometric_stiffening {
            Choice::On => true,
            Choice::Off => false,
            Choice::Auto => {
                !scene.time.method.is_of_paper()
                    && physics::may_spin(scene, self.support.motion, self.drive.as_ref())
                    && screen(&self.case(draft, None), scene.effects.tolerance)?.on
            }
        })
    }

    /// Whether the modes may leave out something of the static answer to the spin that matters, and what is to be
    /// computed: for static shapes, or to tell that they are missing.
    fn may_stretch(&self, draft: &Draft) -> Result<bool, BuildError> {
        let scene = self.scene;
        let acts = draft.body.flexible() > 0
            && scene.effects.deformed_inertia != Choice::Off
            && physics::may_spin(scene, self.support.motion, self.drive.as_ref());
        Ok(acts
            && match scene.modes.static_correction {
                Choice::On => true,
                Choice::Off => false,
                Choice::Auto => {
                    let tolerance = scene.effects.tolerance;
                    advise(&self.case(draft, None), tolerance)?.stretch >= tolerance
                }
            })
    }

    /// All static answers that are asked for, from one block of forces.
    fn statics(
        &self,
        modes: &Modes,
        body: &ReducedBody,
        [of_loads, of_spin]: [bool; 2],
        steady: &[&MeshLoad],
    ) -> Result<Statics, BuildError> {
        let turning = turning::turning(self.scene, self.support.motion, self.drive.as_ref());
        let loads = if of_loads { &self.loads[..] } else { &[] };
        let turned: Vec<Vec<Vector3<f64>>> = loads.iter().map(|load| load.turned(turning)).collect();
        // What each column is the sum of.
        let mut columns: Vec<Vec<Acting<'_>>> = Vec::new();
        for (load, turned) in loads.iter().zip(&turned) {
            match turned[..] {
                [] => columns.push(vec![(load, None)]),
                _ => columns.extend(turned.iter().map(|vector| vec![(load, Some(*vector))])),
            }
        }
        let for_loads = columns.len();
        if !steady.is_empty() {
            columns.push(steady.iter().map(|load| (*load, None)).collect());
        }
        let for_all_loads = columns.len();
        let fields = of_spin.then(|| centrifugal_fields(self.solver.nodal_mass(), self.mesh.positions(), &body.origin));
        if columns.is_empty() && fields.is_none() {
            return Ok(Statics { of_loads: None, of_spin: None, of_steady: None });
        }
        let spins = fields.as_ref().map_or(0, Mat::ncols);
        let unknowns = 3 * self.mesh.positions().len();
        memory::check("the forces of the loads", 8 * unknowns * (for_all_loads + spins))
            .map_err(|source| modal(self.scene)(source.into()))?;
        let mut forces = Mat::zeros(unknowns, for_all_loads + spins);
        for (i, loads) in columns.iter().enumerate() {
            for (load, vector) in loads {
                load.add_nodal_forces(*vector, forces.as_mut().col_mut(i));
            }
        }
        if let Some(fields) = &fields {
            forces.as_mut().subcols_mut(for_all_loads, spins).copy_from(fields);
        }
        let answers = self.solver.static_response(forces.as_ref()).map_err(modal(self.scene))?;

        let to_spin = answers.subcols(for_all_loads, spins);
        let mut first = 0;
        let compliances = loads.iter().zip(&turned).map(|(load, turned)| {
            let columns = turned.len().max(1);
            let (of, to) = (forces.subcols(first, columns), answers.subcols(first, columns));
            first += columns;
            let parts = Col::from_iter(load.parts(turned));
            let work = |i: usize| of.col(i).transpose() * to.col(i);
            StaticCompliance {
                at_start: (of * &parts).transpose() * (to * &parts),
                turned: turned.iter().enumerate().map(|(i, vector)| (*vector, work(i))).collect(),
            }
        });
        let compliances: Vec<StaticCompliance> = compliances.collect();
        Ok(Statics {
            of_loads: of_loads.then(|| (answers.subcols(0, for_loads).to_owned(), compliances)),
            of_spin: of_spin.then(|| (to_spin.to_owned(), self.remainders(modes, to_spin))),
            of_steady: (!steady.is_empty()).then(|| answers.subcols(for_loads, 1).to_owned()),
        })
    }

    /// √(uᵀMu − Σ(Φ_kᵀMu)²) of each answer u.
    fn remainders(&self, modes: &Modes, answers: MatRef<'_, f64>) -> Vec<f64> {
        let momenta = self.solver.nodal_mass().product(answers);
        let of = |(u, mu): (faer::ColRef<'_, f64>, faer::ColRef<'_, f64>)| {
            let carried: f64 = modes.shapes.as_ref().col_iter().map(|shape| (shape.transpose() * mu).powi(2)).sum();
            (u.transpose() * mu - carried).max(0.0).sqrt()
        };
        answers.col_iter().zip(momenta.as_ref().col_iter()).map(of).collect()
    }

    /// K_ij of each pair of spins in the modes.
    fn stress_stiffness(&self, statics: &Statics, modes: &Modes) -> Result<Option<[Mat<f64>; 6]>, BuildError> {
        let Some((answers, _)) = &statics.of_spin else { return Ok(None) };
        let shapes = modes.shapes.as_ref();
        let stiffness = reduced_geometric_stiffness(self.mesh, &self.body.materials, answers.as_ref(), shapes)?;
        Ok(stiffness.try_into().ok())
    }

    /// The loads whose stress may stiffen the body: those that stay as they are.
    fn steady_loads(&self, draft: &Draft) -> Vec<&MeshLoad> {
        let steady = |load: &&MeshLoad| physics::stiffens(self.scene, self.support.motion, self.drive.as_ref(), load);
        self.loads.iter().filter(steady).filter(|_| draft.body.flexible() > 0).collect()
    }

    /// Stress stiffness of steady loads in the modes, none where it may be left out, which `advice` is told; and the loads
    /// over those at which the body buckles.
    fn load_stiffness(
        &self,
        answer: Option<&Mat<f64>>,
        modes: &Modes,
        draft: &Draft,
        advice: &mut Advice,
    ) -> Result<(Option<Mat<f64>>, f64), BuildError> {
        let Some(answer) = answer.filter(|_| modes.shapes.ncols() > 0) else { return Ok((None, 0.0)) };
        // Gravity stresses no body that falls.
        if answer.norm_max() == 0.0 {
            return Ok((None, 0.0));
        }
        let buckles = self.buckles(answer.as_ref(), modes)?;
        let shapes = modes.shapes.as_ref();
        let stiffness = reduced_geometric_stiffness(self.mesh, &self.body.materials, answer.as_ref(), shapes)?.pop();
        let (value, influence) = stiffness.as_ref().map_or((0.0, 0.0), |k| steady_stiffening(k, draft, self.scene));
        let Effects { geometric_stiffening: choice, tolerance, .. } = self.scene.effects;
        let row = advice.rows.iter_mut().find(|row| row.effect == Effect::GeometricStiffening);
        if let Some(row) = row.filter(|row| row.influence <= influence) {
            let shift = 100.0 * 0.5 * value;
            row.why = format!("The stress of steady loads moves the frequency of a mode by up to {shift:.2e} %.");
            (row.value, row.influence, row.on) = (value, influence, influence >= tolerance);
        }
        Ok((stiffness.filter(|_| choice == Choice::On || influence >= tolerance), buckles))
    }

    /// The loads of a static `answer` over those at which the body buckles, on the whole mesh: the modes that are kept do
    /// not hold the shape in which it does.
    fn buckles(&self, answer: MatRef<'_, f64>, modes: &Modes) -> Result<f64, BuildError> {
        let material = &self.body.materials;
        let product = |fields: MatRef<'_, f64>| -> Result<Mat<f64>, BucklingError> {
            Ok(geometric_stiffness_product(self.mesh, material, answer, fields)?)
        };
        match self.solver.lowest_buckling_ratio(modes.shapes.as_ref(), product) {
            Ok(lowest) => Ok(-lowest),
            Err(BucklingError::Modal(error)) => Err(modal(self.scene)(error)),
            Err(BucklingError::Assembly(error)) => Err(error.into()),
        }
    }
}

/// What the search for the buckling load may meet.
#[derive(Debug, thiserror::Error)]
enum BucklingError {
    #[error(transparent)]
    Modal(#[from] ModalError),
    #[error(transparent)]
    Assembly(#[from] AssemblyError),
}

/// Largest |K_kl|/(ω_k ω_l), and its influence: the phase that a mode is out by in the end of the time that it rings.
fn steady_stiffening(stiffness: &Mat<f64>, draft: &Draft, scene: &Scene) -> (f64, f64) {
    let omega = &draft.body.circular_frequencies;
    let (mut value, mut influence) = (0.0_f64, 0.0_f64);
    for k in 0..omega.len() {
        let rings = scene.time.end.min(1.0 / (draft.damping_ratios[k] * omega[k]));
        for l in 0..omega.len() {
            let ratio = stiffness[(k, l)].abs() / (omega[k] * omega[l]);
            value = value.max(ratio);
            influence = influence.max(ratio * (0.5 * omega[k].min(omega[l]) * rings).max(1.0));
        }
    }
    (value, influence.min(1.0))
}
