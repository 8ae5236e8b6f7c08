//! How far each mode is moved, bounded above, and how a small force from one mode on another moves it.

use frames_rk4::DrivenMotion;

use crate::case::Case;
use crate::course::Course;
use crate::excitation::{Source, Spin};
use crate::tensor;

/// Motion of the modes.
#[derive(Debug, Clone)]
pub(crate) struct Response {
    /// Largest |q|, |q̇| and |q̈| of each mode (nf).
    pub displacement: Vec<f64>,
    pub velocity: Vec<f64>,
    pub acceleration: Vec<f64>,
    /// Part of `displacement` that gravity makes (nf).
    pub of_gravity: Vec<f64>,
    /// |q| and |Λ^½ q| that there will be at some time.
    pub scale: f64,
    pub strain_scale: f64,
    /// Forces on the modes whose course has been followed, for resonance with one mode of what another passes on:
    /// modal force, and |z| at each frequency.
    forced: Vec<(Vec<f64>, Vec<f64>)>,
    omega: Vec<f64>,
    /// Longest time in which a small force builds up a mode, ½ of it over ω.
    memory: Vec<f64>,
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
            of_gravity: vec![0.0; nf],
            scale: norm(&start),
            strain_scale: norm(&product(&start, omega)),
            forced: Vec::new(),
            omega: omega.clone(),
            memory,
        };
        response.centrifugal(case, spin);
        for source in sources {
            let z: Vec<_> = (0..nf).map(|k| swing(source, spin, omega[k], zeta[k])).collect();
            let q: Vec<f64> = (0..nf).map(|k| source.modal[k] * z[k].0 / omega[k]).collect();
            for k in 0..nf {
                response.displacement[k] += q[k];
                response.velocity[k] += source.modal[k] * z[k].0;
                response.acceleration[k] += source.modal[k] * z[k].1;
                if source.gravity {
                    response.of_gravity[k] += q[k];
                }
            }
            response.certainly(&q);
            response.forced.push((source.modal.clone(), z.iter().map(|z| z.0).collect()));
        }
        if let Some(drive) = case.drive {
            let (unit, coupling) = match drive.motion {
                DrivenMotion::Turn { axis } => (axis, &case.body.rotation_first),
                DrivenMotion::Slide { direction } => (direction, &case.body.translation_first),
            };
            let course = Course::new(&drive.history, case.end).risen();
            let z: Vec<_> = (0..nf).map(|k| course.swing(omega[k], zeta[k])).collect();
            let force: Vec<f64> = (0..nf)
                .map(|k| ((0..3).map(|i| unit[i] * coupling[i][k]).sum::<f64>() * drive.amplitude).abs())
                .collect();
            // q̈ + ω² q = −b v̇: q goes with z of v itself.
            let q: Vec<f64> = (0..nf).map(|k| force[k] * z[k].z).collect();
            for k in 0..nf {
                response.displacement[k] += q[k];
                response.velocity[k] += force[k] * z[k].rate;
                response.acceleration[k] += 2.0 * force[k] * z[k].rate * omega[k];
            }
            response.certainly(&q);
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
            self.velocity[k] += 0.5 * gain * force / omega;
            self.acceleration[k] += 0.5 * gain * force;
            let w = if case.drive.is_some() { 0.0 } else { 1.0 };
            let entries = std::array::from_fn(|ij| case.body.inertia_first[ij][k]);
            let at_start = case.initial.omega.dot(&(tensor::symmetric(entries) * case.initial.omega));
            steady[k] = if case.drive.is_some() { force } else { w * at_start.abs() } / (omega * omega);
        }
        self.certainly(&steady);
    }

    /// Half of a bound that is sharp within two.
    fn certainly(&mut self, q: &[f64]) {
        self.scale = self.scale.max(0.5 * norm(q));
        self.strain_scale = self.strain_scale.max(0.5 * norm(&product(q, &self.omega)));
    }

    /// Relative change of the motion of the modes by small forces: `force(k, l)` on mode k for a unit of `amplitude` of
    /// mode l, and `constant` ones.
    ///
    /// On itself, a mode's frequency changes and its phase runs away for as long as it rings. From another mode, the
    /// force has that mode's frequency, or that of a load which it passes on.
    pub(crate) fn change(&self, force: impl Fn(usize, usize) -> f64, amplitude: &[f64], constant: &[f64]) -> f64 {
        let nf = self.omega.len();
        let square = |k: usize| self.omega[k] * self.omega[k];
        let mut change = vec![0.0; nf];
        for k in 0..nf {
            let ring = self.memory[k] / self.omega[k];
            let mut shift = force(k, k);
            for l in (0..nf).filter(|l| *l != k) {
                let apart = (square(k) - square(l)).abs();
                let (there, back) = (force(k, l), force(l, k));
                // Second order in general, first where two modes have one frequency.
                shift += if there * back > apart * apart { (there * back).sqrt() } else { there * back / apart };
                let passing = (2.0 / square(k)).max((1.0 + self.omega[l] / self.omega[k]) / apart);
                change[k] += there * amplitude[l] * passing.min(ring);
                let passed: f64 =
                    self.forced.iter().map(|(modal, z)| (modal[l] / apart.max(1e-9 * square(k))) * z[k]).sum();
                let unit = if self.displacement[l] > 0.0 { amplitude[l] / self.displacement[l] } else { 0.0 };
                change[k] += there * unit * (passed / self.omega[k]).min(self.displacement[l] * ring);
            }
            if shift >= 0.5 * square(k) && self.displacement[k] > 0.0 {
                return 1.0;
            }
            change[k] += self.displacement[k] * shift * (2.0 / square(k)).max(ring);
            change[k] += constant[k] * 2.0 / square(k);
        }
        relative(norm(&change), self.scale)
    }

    /// Share of each mode in the displacement and in the strain, whichever is larger (nf).
    pub(crate) fn shares(&self) -> Vec<f64> {
        let of = |k: usize| {
            let q = self.displacement[k];
            relative(q, self.scale).max(relative(q * self.omega[k], self.strain_scale))
        };
        (0..self.omega.len()).map(of).collect()
    }
}

/// |z| and |z'| of a mode under a load; one whose direction turns in the body has the spin in its spectrum.
fn swing(source: &Source, spin: &Spin, omega: f64, zeta: f64) -> (f64, f64) {
    let at = |omega: f64| source.course.swing(omega, zeta);
    let own = at(omega);
    if !source.dead || spin.turn < 0.1 {
        return (own.z, own.rate);
    }
    if spin.largest >= 0.5 * omega || !spin.steady {
        let decay = zeta * omega;
        let forced = if decay > 0.0 { source.course.largest / decay } else { f64::INFINITY };
        let most = source.course.magnitude_integral.min(forced);
        // Below half the frequency no turning is in time with the mode: twice what the slowest side band does.
        if spin.largest >= 0.5 * omega {
            return (most, omega * most + source.course.largest);
        }
    }
    let sides = [at(omega - spin.largest), at(omega + spin.largest)];
    let sum = |of: fn(&crate::course::Swing) -> f64| sides.iter().map(of).fold(of(&own), f64::max);
    (sum(|s| s.z), sum(|s| s.rate) + spin.largest * sum(|s| s.z))
}

/// part/whole, at most 1; 1 where something is changed of nothing.
pub(crate) fn relative(part: f64, whole: f64) -> f64 {
    if part <= 0.0 {
        0.0
    } else if part >= whole || part.is_nan() || whole.is_nan() {
        1.0
    } else {
        part / whole
    }
}

pub(crate) fn norm(x: &[f64]) -> f64 {
    x.iter().map(|x| x * x).sum::<f64>().sqrt()
}

fn product(a: &[f64], b: &[f64]) -> Vec<f64> {
    a.iter().zip(b).map(|(a, b)| a * b).collect()
}
