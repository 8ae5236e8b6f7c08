//! Vibrations of a body that its spin bends: of the full body, about its rest at each speed.

use std::cell::RefCell;

use diagnostic::{Diagnostic, Failure, Kind};
use dynamics::{SpinMode, SteadySpin};
use faer::{Mat, c64};
use model::{Builder, FullModel, Model};
use nalgebra::Vector3;
use nonlinear::{
    EquilibriumSettings, ExternalForces, FullBody, NonlinearError, SpinVibration, equilibrium, spin_vibrations,
};
use reduced_body::ReducedBody;
use scene::Body;

use super::family::Family;

/// Deflection over the length, by the linear answer to the spin, below which a body is not bent.
const STRAIGHT: f64 = 1e-3;
/// Vibrations that are compared, and the difference of one from which the rest at each speed is taken.
const COMPARED: usize = 4;
const DIFFERENCE: f64 = 0.01;

/// Vibrations are about the rest of the full body at each speed, or about the undeformed body.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum AboutRest {
    /// About the rest where the spin bends the body so far that a frequency at the highest speed is off by 1 % without.
    #[default]
    Auto,
    /// About the rest.
    Always,
    /// About the undeformed body.
    Never,
}

/// The full body of a scene, where it has one.
pub(super) fn full(body: &Body, builder: &Builder) -> Result<FullModel, Failure> {
    let full = builder.full(body, |_| ())?;
    full.ok_or_else(|| no_full_body(body))
}

fn no_full_body(body: &Body) -> Failure {
    let found = body.source.not_by_elements().unwrap_or("a body without elements");
    let expected = "one with a mesh, whose rest at each speed can be found";
    Kind::Usage.of(&body.path).found(found).expected(expected).help("leave `--about-rest` out").into()
}

/// Deflection over the length, by the linear answer to a spin; none where it does not bend the body.
pub(super) fn deflection(model: &Model, axis: &Vector3<f64>, speed: f64) -> Option<f64> {
    let body = &model.body;
    let weights = ReducedBody::pair_weights([axis, axis]);
    let answer = |(k, omega): (usize, &f64)| {
        let force: f64 = weights.iter().zip(&body.inertia_first).map(|(weight, c)| weight * c[k]).sum();
        force * (speed / omega).powi(2)
    };
    let q: Vec<f64> = body.circular_frequencies.iter().enumerate().map(answer).collect();
    Some(model.deflection(&q)).filter(|deflection| *deflection >= STRAIGHT)
}

/// The full body in a spin about an axis.
pub(super) struct BentSpin<'a> {
    given: &'a Body,
    body: FullBody<'a>,
    axis: Vector3<f64>,
    /// Modes and static shapes of the undeformed body (3n×k), and M times them: shapes are compared in these coordinates.
    shapes: &'a Mat<f64>,
    momenta: Mat<f64>,
    circular_frequencies: &'a [f64],
    /// Number of vibrations.
    count: usize,
    /// Vibrations found so far: those at the highest speed are asked for twice.
    found: RefCell<Vec<AtSpeed>>,
}

/// The vibrations at a speed, slowest first, and the largest displacement of a node.
#[derive(Clone)]
struct AtSpeed {
    speed: f64,
    modes: Vec<SpinMode>,
    deflection: f64,
}

impl Family for BentSpin<'_> {
    fn vibrations(&self, speed: f64) -> Result<Vec<SpinMode>, Failure> {
        if let Some(known) = self.known(speed) {
            return Ok(known.modes);
        }
        let failed = |source: NonlinearError| {
            let help = "end the speeds before this one, or take vibrations about the undeformed body with `--about-rest never`";
            let known = source.diagnosis().in_file(&self.given.path).help(help);
            known.says(format!("at {speed} rad per time: {source}"))
        };
        let (omega, settings) = (self.axis * speed, EquilibriumSettings::default());
        let rest = equilibrium(&self.body, &ExternalForces::default(), &omega, None, &settings).map_err(failed)?;
        let size = |u: &[f64]| Vector3::from_column_slice(u).norm();
        let deflection = rest.displacement.chunks_exact(3).map(size).fold(0.0, f64::max);
        let found = spin_vibrations(&self.body, &rest, &omega, self.shapes.as_ref(), self.count).map_err(failed)?;
        let mut modes: Vec<SpinMode> = found.iter().map(|vibration| self.seen(vibration)).collect();
        modes.sort_by(|a, b| a.circular_frequency.total_cmp(&b.circular_frequency));
        self.found.borrow_mut().push(AtSpeed { speed, modes: modes.clone(), deflection });
        Ok(modes)
    }

    fn is_slow(&self) -> bool {
        true
    }
}

impl<'a> BentSpin<'a> {
    pub fn new(given: &'a Body, full: &'a FullModel, model: &'a Model, axis: &Vector3<f64>) -> Result<Self, Failure> {
        let Some(meshed) = &model.meshed else { return Err(no_full_body(given)) };
        let body = full.body().map_err(|source| source.in_file(&given.path))?;
        Ok(Self {
            given,
            axis: *axis,
            shapes: &meshed.modes.shapes,
            momenta: body.momenta_of(meshed.modes.shapes.as_ref()),
            circular_frequencies: &model.body.circular_frequencies,
            count: model.body.natural_modes,
            found: RefCell::default(),
            body,
        })
    }

    fn known(&self, speed: f64) -> Option<AtSpeed> {
        self.found.borrow().iter().find(|found| found.speed == speed).cloned()
    }

    /// The largest displacement of a node at a speed where the vibrations were found.
    pub fn deflection(&self, speed: f64) -> f64 {
        self.known(speed).map_or(0.0, |found| found.deflection)
    }

    /// A vibration in the coordinates of the modes of the undeformed body.
    fn seen(&self, vibration: &SpinVibration) -> SpinMode {
        let [re, im] = &vibration.shape;
        let root = c64::new(vibration.growth, vibration.circular_frequency);
        let along = |k: usize, part: &[f64]| -> f64 { self.momenta.col(k).iter().zip(part).map(|(m, x)| m * x).sum() };
        let q: Vec<c64> = (0..self.momenta.ncols()).map(|k| c64::new(along(k, re), along(k, im))).collect();
        let state: Vec<c64> = q
            .iter()
            .zip(self.circular_frequencies)
            .map(|(q, omega)| q * *omega)
            .chain(q.iter().map(|q| q * root))
            .collect();
        let length = state.iter().map(|x| x.norm_sqr()).sum::<f64>().sqrt().max(f64::MIN_POSITIVE);
        SpinMode {
            circular_frequency: vibration.circular_frequency,
            growth: vibration.growth,
            whirl: self.whirl(re, im),
            state: state.into_iter().map(|x| x / length).collect(),
        }
    }

    /// Im(xᴴ M (a×) x)/(xᴴ M x)
    fn whirl(&self, re: &[f64], im: &[f64]) -> f64 {
        let turned: Vec<f64> = im
            .chunks_exact(3)
            .flat_map(|u| <[f64; 3]>::from(self.axis.cross(&Vector3::from_column_slice(u))))
            .collect();
        let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
        let size = dot(re, &self.body.momentum(re)) + dot(im, &self.body.momentum(im));
        if size > 0.0 { 2.0 * dot(re, &self.body.momentum(&turned)) / size } else { 0.0 }
    }

    /// True if a low frequency at a speed is off about the undeformed body, or the body has no rest there.
    pub fn differs(&self, spin: &SteadySpin, speed: f64) -> Result<bool, Failure> {
        let linear = spin.modes(speed).map_err(|source| source.in_file(&self.given.path))?;
        let Ok(bent) = self.vibrations(speed) else { return Ok(true) };
        let size = |mode: &SpinMode| mode.circular_frequency.powi(2) - mode.growth.powi(2);
        let mut pairs = linear.iter().zip(&bent).take(COMPARED);
        Ok(pairs.any(|(linear, bent)| (size(linear) - size(bent)).abs() > 2.0 * DIFFERENCE * size(bent).abs()))
    }
}
