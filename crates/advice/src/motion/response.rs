//! How far each mode is moved, bounded above, and how a small force from one mode on another moves it.

use dynamics::{Drive, DrivenMotion, History};
use nalgebra::Vector3;
use reduced_body::ReducedBody;

use crate::motion::case::Case;
use crate::motion::course::{Course, Swing};
use crate::motion::excitation::Spin;
use crate::motion::source::{CANCELLED, Source};
use crate::motion::tensor;
use crate::table::relative::relative;

/// Motion of the modes.
#[derive(Debug, Clone)]
pub(crate) struct Response {
    /// Largest |q|, |q̇| and |q̈| of each mode (nf).
    pub displacement: Vec<f64>,
    pub velocity: Vec<f64>,
    pub acceleration: Vec<f64>,
    /// Part of `displacement` to which the spin and the loads hold the modes, about (nf).
    pub steady: Vec<f64>,
    /// Part of `displacement` that gravity makes (nf).
    pub of_gravity: Vec<f64>,
    /// Lower bound on max |q| over the run.
    pub scale: f64,
    /// Deflection over the length by a single mode that the loads will make at some time, but for what stiffens the body.
    pub certain_deflection: f64,
    /// Forces on the modes whose course has been followed, for resonance with one mode of what another passes on:
    /// modal force, and |z| at each frequency.
    forced: Vec<(Vec<f64>, Vec<f64>)>,
    omega: Vec<f64>,
    /// How long a mode remembers: min(T, 1/ζω).
    pub memory: Vec<f64>,
}

impl Response {
    pub(crate) fn new(case: &Case, spin: &Spin, sources: &[Source]) -> Self {
        let omega = &case.body.circular_frequencies;
        let nf = omega.len();
        let zeta = case.damping_ratios;
        let memory: Vec<f64> = (0..nf).map(|k| case.end.min(1.0 / (zeta[k] * omega[k]))).collect();
        let initial = case.initial;
        let start: Vec<f64> =
            (0..nf).map(|k| initial.modal_displacement[k].hypot(initial.modal_velocity[k] / omega[k])).collect();
        let mut response = Self {
            displacement: start.clone(),
            velocity: (0..nf).map(|k| start[k] * omega[k]).collect(),
            acceleration: (0..nf).map(|k| start[k] * omega[k] * omega[k]).collect(),
            steady: vec![0.0; nf],
            of_gravity: vec![0.0; nf],
            scale: norm(&start),
            certain_deflection: 0.0,
            forced: Vec::new(),
            omega: omega.clone(),
            memory,
        };
        response.centrifugal(case, spin);
        let together = Together::new(case, sources);
        for source in sources {
            let z: Vec<_> = (0..nf).map(|k| swing(source, spin, omega[k], zeta[k], response.memory[k])).collect();
            response.forced.push((source.modal.clone(), z.iter().map(|z| z.0).collect()));
            if source.gravity {
                (0..nf).for_each(|k| response.of_gravity[k] += source.modal[k] * z[k].0 / omega[k]);
            }
            if together.has(source) {
                continue;
            }
            for k in 0..nf {
                let q = source.modal[k] * z[k].0 / omega[k];
                response.steady[k] += source.modal[k] * source.course.largest / (omega[k] * omega[k]);
                response.displacement[k] += q;
                response.velocity[k] += source.modal[k] * z[k].0;
                response.acceleration[k] += source.modal[k] * z[k].1;
            }
            // A direction that turns may take as much away as it may add.
            let turning = |k: usize| turning(source, spin, response.memory[k]);
            let straight =
                |k: usize| source.modal_at_start[k].abs() * source.course.swing(omega[k], zeta[k]).z / omega[k];
            let certain: Vec<f64> = (0..nf).map(|k| straight(k) / turning(k)).collect();
            response.certainly_bent(case, &certain);
        }
        if !together.loads.is_empty() {
            let courses: Vec<Course> = (0..nf).map(|k| together.course(k)).collect();
            let z: Vec<Swing> = (0..nf).map(|k| courses[k].swing(omega[k], zeta[k])).collect();
            for k in 0..nf {
                response.steady[k] += courses[k].largest / (omega[k] * omega[k]);
                response.displacement[k] += z[k].z / omega[k];
                response.velocity[k] += z[k].z;
                response.acceleration[k] += z[k].rate;
            }
            let certain: Vec<f64> = (0..nf).map(|k| z[k].z / omega[k]).collect();
            response.certainly_bent(case, &certain);
        }
        if let Some(drive) = case.drive {
            let (unit, coupling) = of_drive(case.body, drive);
            let course = Course::new(&drive.speed.history, case.end, case.costly_histories()).risen();
            let z: Vec<_> = (0..nf).map(|k| course.swing(omega[k], zeta[k])).collect();
            let force: Vec<f64> = (0..nf)
                .map(|k| ((0..3).map(|i| unit[i] * coupling[i][k]).sum::<f64>() * drive.speed.amplitude).abs())
                .collect();
            // q̈ + ω² q = −b v̇: q goes with z of v itself.
            let q: Vec<f64> = (0..nf).map(|k| force[k] * z[k].z).collect();
            for k in 0..nf {
                response.displacement[k] += q[k];
                response.velocity[k] += force[k] * z[k].rate;
                response.acceleration[k] += 2.0 * force[k] * z[k].rate * omega[k];
            }
            // The circle of z is wider than the swing of its real part.
            response.certainly(&q, 0.25);
        }
        response
    }

    /// The centrifugal field, met suddenly, or in time with the mode where the body tumbles that fast.
    fn centrifugal(&mut self, case: &Case, spin: &Spin) {
        let c = tensor::of_modes(&case.body.inertia_first, &spin.directions);
        let mut steady = vec![0.0; c.len()];
        for k in 0..c.len() {
            let omega = self.omega[k];
            let unsteady = !spin.steady && case.drive.is_none() && spin.largest > 0.3 * omega;
            let gain = if unsteady { (omega * self.memory[k]).max(2.0) } else { 2.0 };
            let force = spin.largest * spin.largest * c[k];
            self.displacement[k] += gain * force / (omega * omega);
            self.steady[k] += force / (omega * omega);
            self.velocity[k] += 0.5 * gain * force / omega;
            self.acceleration[k] += 0.5 * gain * force;
            let entries = std::array::from_fn(|ij| case.body.inertia_first[ij][k]);
            let at_start = case.initial.omega.dot(&(tensor::symmetric(entries) * case.initial.omega));
            steady[k] = if case.drive.is_some() { force } else { at_start.abs() } / (omega * omega);
        }
        self.certainly(&steady, 0.5);
    }

    /// The same with half of a deflection by loads, in each mode.
    fn certainly_bent(&mut self, case: &Case, q: &[f64]) {
        self.certainly(q, 0.5);
        let bent = q.iter().zip(case.peaks).map(|(q, peak)| 0.5 * q * peak / case.length);
        self.certain_deflection = bent.fold(self.certain_deflection, f64::max);
    }

    /// A deflection of which there will be this part.
    fn certainly(&mut self, q: &[f64], part: f64) {
        self.scale = self.scale.max(part * norm(q));
    }

    /// Change of each mode by small forces that come from the others: `force(k, l)` on mode k for a unit of `amplitude`
    /// of mode l. The force has the frequency of mode l, or that of a load which mode l passes on.
    fn passed(&self, force: &impl Fn(usize, usize) -> f64, amplitude: &[f64]) -> Vec<f64> {
        let nf = self.omega.len();
        let mut change = vec![0.0; nf];
        for k in 0..nf {
            let (omega, ring) = (self.omega[k], self.memory[k] / self.omega[k]);
            for l in (0..nf).filter(|l| *l != k) {
                let apart = self.apart(k, l);
                let own = amplitude[l] * ((1.0 + self.omega[l] / omega) / apart).max(2.0 / (omega * omega)).min(ring);
                let unit = if self.displacement[l] > 0.0 { amplitude[l] / self.displacement[l] } else { 0.0 };
                let loads: f64 = self.forced.iter().map(|(modal, z)| modal[l] / apart * z[k] / omega).sum();
                change[k] += force(k, l) * (own + unit * loads.min(self.displacement[l] * ring));
            }
        }
        change
    }

    /// |ω_k² − ω_l²|
    fn apart(&self, k: usize, l: usize) -> f64 {
        let (a, b) = (self.omega[k], self.omega[l]);
        ((a - b) * (a + b)).abs().max(1e-9 * a * a)
    }

    /// Adds what the modes hand to each other by forces that are there in any case.
    pub(crate) fn share_out(&mut self, force: impl Fn(usize, usize) -> f64) {
        let change = self.passed(&force, &self.displacement);
        let fastest = self.omega.iter().zip(&self.displacement).filter(|(_, q)| **q > 0.0);
        let fastest = fastest.map(|(omega, _)| *omega).fold(0.0, f64::max);
        for (k, change) in change.into_iter().enumerate() {
            let omega = self.omega[k].max(fastest);
            self.displacement[k] += change;
            self.velocity[k] += change * omega;
            self.acceleration[k] += change * omega * omega;
        }
    }

    /// Relative change of the motion of the modes by small forces: `force(k, l)` on mode k for a unit of `amplitude` of
    /// mode l, and `constant` ones. On itself, a mode's frequency changes and its phase runs away for as long as it
    /// rings.
    pub(crate) fn change(&self, force: impl Fn(usize, usize) -> f64, amplitude: &[f64], constant: &[f64]) -> f64 {
        let nf = self.omega.len();
        let mut change = self.passed(&force, amplitude);
        for k in 0..nf {
            let square = self.omega[k] * self.omega[k];
            let mut shift = force(k, k);
            for l in (0..nf).filter(|l| *l != k) {
                // Second order in general, first where two modes have one frequency.
                let both = force(k, l) * force(l, k);
                shift += (both / self.apart(k, l)).min(both.sqrt());
            }
            if shift >= 0.5 * square && self.displacement[k] > 0.0 {
                return 1.0;
            }
            change[k] += self.displacement[k] * shift * (2.0 / square).max(self.memory[k] / self.omega[k]);
            change[k] += constant[k] * 2.0 / square;
        }
        relative(norm(&change), self.scale)
    }

    /// Share of each mode in the deformation (nf).
    pub(crate) fn shares(&self) -> Vec<f64> {
        self.displacement.iter().map(|q| relative(*q, self.scale)).collect()
    }
}

/// Several loads that keep their directions in the body: at each time their forces on a mode add up, or cancel.
struct Together<'a> {
    /// One for each different history, with the forces of its loads on the modes (nf).
    loads: Vec<(&'a History, Vec<f64>)>,
    courses: Vec<Course>,
}

impl<'a> Together<'a> {
    /// Nothing where only one keeps its direction.
    fn new(case: &Case, sources: &'a [Source]) -> Self {
        let mut loads: Vec<(&History, Vec<f64>)> = Vec::new();
        let steady = || sources.iter().filter(|source| !source.dead);
        if steady().count() > 1 {
            for source in steady() {
                match loads.iter_mut().find(|(history, _)| *history == &source.history) {
                    Some((_, forces)) => forces.iter_mut().zip(&source.modal_at_start).for_each(|(sum, f)| *sum += f),
                    None => loads.push((&source.history, source.modal_at_start.clone())),
                }
            }
            // Of forces that cancel, rounding is left.
            for k in 0..case.body.flexible() {
                let largest = steady().map(|source| source.modal_at_start[k].abs()).fold(0.0, f64::max);
                let of_mode = loads.iter_mut().map(|(_, forces)| &mut forces[k]);
                of_mode.filter(|force| force.abs() <= CANCELLED * largest).for_each(|force| *force = 0.0);
            }
        }
        let histories: Vec<&History> = loads.iter().map(|(history, _)| *history).collect();
        let courses = Course::aligned(&histories, case.end, case.costly_histories());
        Self { loads, courses }
    }

    /// True if it has this load.
    fn has(&self, source: &Source) -> bool {
        !source.dead && !self.loads.is_empty()
    }

    /// The force on mode `k`.
    fn course(&self, k: usize) -> Course {
        let parts: Vec<(f64, &Course)> =
            self.loads.iter().zip(&self.courses).map(|((_, forces), course)| (forces[k], course)).collect();
        Course::sum(&parts)
    }
}

/// |z| and |z'| of a mode under a load. With a direction a(t) that turns in the body, |a'| ≤ Ω, by parts:
/// `|∫ e^{λ(t−s)} h a ds| ≤ sup|z| (1 + ∫|a'|)`, as far back as the mode remembers.
fn swing(source: &Source, spin: &Spin, omega: f64, zeta: f64, memory: f64) -> (f64, f64) {
    let Swing { z, rate } = source.course.swing(omega, zeta);
    if !source.dead {
        return (z, rate);
    }
    let most = source.course.magnitude_integral.min(source.course.largest * memory);
    let turning = turning(source, spin, memory);
    ((z * turning).min(most), ((rate + spin.largest * z) * turning).min(omega * most + source.course.largest))
}

/// 1 + ∫|a'| of the direction of a load, as far back as a mode remembers.
fn turning(source: &Source, spin: &Spin, memory: f64) -> f64 {
    if source.dead { 1.0 + spin.turn.min(spin.largest * memory) } else { 1.0 }
}

/// The direction of a drive, and how its acceleration along each axis pushes the modes.
pub(crate) fn of_drive<'a>(body: &'a ReducedBody, drive: &Drive) -> (Vector3<f64>, &'a [Vec<f64>; 3]) {
    match drive.motion {
        DrivenMotion::Turn { axis } => (axis, &body.rotation_first),
        DrivenMotion::Slide { direction } => (direction, &body.translation_first),
    }
}

pub(crate) fn norm(x: &[f64]) -> f64 {
    x.iter().map(|x| x * x).sum::<f64>().sqrt()
}
