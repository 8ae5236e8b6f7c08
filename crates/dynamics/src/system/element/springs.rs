//! Springs, dampers and bushings between markers: Eq. (J22) of `docs/method/systems.md`.

use nalgebra::Vector3;
use rigid_kin::{cross_matrix, f_inverse, half_cotangent_factor, rotation_vector};

use crate::system::element::{ForceElement, SetDirection, Stored};
use crate::system::joint::observation::{JointObservation, LineObservation};
use crate::system::marker::motion::{MarkerChange, MarkerMotion, MarkerWrench};
use crate::system::marker::{Marker, tangent_of};

/// A spring and a damper along the line between two markers.
#[derive(Debug, Clone, serde::Serialize, serde::Deserialize)]
pub struct PointSpring {
    /// Its ends.
    pub markers: [Marker; 2],
    /// Force per length.
    pub stiffness: f64,
    /// Force per velocity.
    pub damping: f64,
    /// Length without force.
    pub free_length: f64,
}

impl PointSpring {
    /// The direction from the first marker to the second, and what is along it; none where they are at one place.
    fn line(&self, [i, j]: [&MarkerMotion; 2]) -> Option<(Vector3<f64>, LineObservation)> {
        let line = j.position_global - i.position_global;
        let length = line.norm();
        if length == 0.0 {
            return None;
        }
        let along = line / length;
        let rate = along.dot(&(j.velocity_global - i.velocity_global));
        let pull = self.stiffness * (length - self.free_length) + self.damping * rate;
        Some((along, LineObservation { length, rate, pull }))
    }
}

impl ForceElement for PointSpring {
    fn markers(&self) -> &[Marker] {
        &self.markers
    }

    fn is_relative(&self) -> bool {
        true
    }

    fn apply(&self, _: [f64; 2], motions: &[MarkerMotion], wrenches: &mut [MarkerWrench]) {
        let ([i, j], [on_i, on_j]) = (motions, wrenches) else { return };
        let Some((along, LineObservation { pull, .. })) = self.line([i, j]) else { return };
        let force = along * pull;
        (on_i.force_global, on_j.force_global) = (force, -force);
    }

    fn observe(&self, [i, j]: &[MarkerMotion; 2]) -> Option<JointObservation> {
        let (along, line) = self.line([i, j]).unwrap_or_default();
        let on_second = MarkerWrench { force_global: along * -line.pull, ..MarkerWrench::default() };
        Some(JointObservation { line, ..JointObservation::of_wrench(on_second, &i.axes_global) })
    }

    fn stored(&self, motions: &[MarkerMotion]) -> Option<Stored> {
        let [i, j] = motions else { return None };
        let LineObservation { length, rate, .. } = self.line([i, j]).map(|(_, line)| line).unwrap_or_default();
        Some(Stored {
            energy: 0.5 * self.stiffness * (length - self.free_length).powi(2),
            damping_power: self.damping * rate * rate,
        })
    }

    fn directions(&self) -> usize {
        1
    }

    fn linearize(&self, _: [f64; 2], motions: &[MarkerMotion], set: &mut SetDirection<'_>) {
        let [i, j] = motions else { return };
        let line = j.position_global - i.position_global;
        let Some(along) = line.try_normalize(0.0) else { return };
        let [on_i, on_j] = [-along, along].map(|force_global| MarkerWrench { force_global, ..MarkerWrench::default() });
        set(0, [self.stiffness, self.damping], &[on_i, on_j]);
    }

    fn differentiate(&self, _: [f64; 2], motions: &[MarkerMotion], by: &[MarkerChange], changes: &mut [MarkerWrench]) {
        let ([i, j], [by_i, by_j], [on_i, on_j]) = (motions, by, changes) else { return };
        let line = j.position_global - i.position_global;
        let length = line.norm();
        if length == 0.0 {
            return;
        }
        let along = line / length;
        let velocity = j.velocity_global - i.velocity_global;
        let moved = by_j.displacement_global - by_i.displacement_global;
        let longer = along.dot(&moved);
        let turned = (moved - along * longer) / length;
        let faster = along.dot(&(by_j.velocity_global - by_i.velocity_global)) + turned.dot(&velocity);
        let tension = self.stiffness * (length - self.free_length) + self.damping * along.dot(&velocity);
        let force = along * (self.stiffness * longer + self.damping * faster) + turned * tension;
        (on_i.force_global, on_j.force_global) = (force, -force);
    }
}

/// Springs and dampers along and about the axes of the first of two markers. Turns of the second against it are the components of their
/// rotation vector φ, with the energy ½ φᵀKφ. It is meant for small turns. About one axis without stiffness the second marker may turn
/// freely; tilts are then up to 2.5 times as stiff, at half a turn.
#[derive(Debug, Clone, serde::Serialize, serde::Deserialize)]
pub struct Bushing {
    /// i, whose axes count, and j.
    pub markers: [Marker; 2],
    /// Force per displacement along each axis, and moment per angle about it.
    pub stiffness: [Vector3<f64>; 2],
    /// Force per velocity, and moment per angular velocity.
    pub damping: [Vector3<f64>; 2],
}

impl Bushing {
    /// Displacement and turn of the second marker against the first, and their rates, in the axes of the first.
    fn path_and_rate([i, j]: [&MarkerMotion; 2]) -> [[Vector3<f64>; 2]; 2] {
        let line = j.position_global - i.position_global;
        let velocity = j.velocity_global - i.velocity_global - i.omega_global.cross(&line);
        let [moved, rate, spin] =
            [line, velocity, j.omega_global - i.omega_global].map(|vector| i.axes_global.tr_mul(&vector));
        // A turn by half a turn has no vector: then there is no spring, either.
        let turned = rotation_vector(&(j.axes_global.transpose() * i.axes_global)).unwrap_or_default();
        [[moved, turned], [rate, spin]]
    }
}

impl ForceElement for Bushing {
    fn markers(&self) -> &[Marker] {
        &self.markers
    }

    fn is_relative(&self) -> bool {
        true
    }

    fn apply(&self, _: [f64; 2], motions: &[MarkerMotion], wrenches: &mut [MarkerWrench]) {
        let ([i, j], [on_i, on_j]) = (motions, wrenches) else { return };
        let line = j.position_global - i.position_global;
        let [[moved, turned], [rate, spin]] = Self::path_and_rate([i, j]);
        let [pull, torque] = [(0, moved), (1, turned)].map(|(which, by)| self.stiffness[which].component_mul(&by));
        let law = |spring: Vector3<f64>, which: usize, rate: Vector3<f64>| {
            i.axes_global * (spring + self.damping[which].component_mul(&rate))
        };
        let force = law(pull, 0, rate);
        let moment = law(on_turn(&turned, &torque), 1, spin);
        on_j.force_global = -force;
        on_j.moment_global = -moment;
        on_i.force_global = force;
        on_i.moment_global = moment + line.cross(&force);
    }

    fn observe(&self, motions: &[MarkerMotion; 2]) -> Option<JointObservation> {
        let mut wrenches = [MarkerWrench::default(); 2];
        self.apply([0.0; 2], motions, &mut wrenches);
        Some(JointObservation::of_wrench(wrenches[1], &motions[0].axes_global))
    }

    fn stored(&self, motions: &[MarkerMotion]) -> Option<Stored> {
        let [i, j] = motions else { return None };
        let [path, rate] = Self::path_and_rate([i, j]);
        let square = |factors: &[Vector3<f64>; 2], of: &[Vector3<f64>; 2]| {
            factors.iter().zip(of).map(|(factor, of)| factor.component_mul(of).dot(of)).sum::<f64>()
        };
        Some(Stored { energy: 0.5 * square(&self.stiffness, &path), damping_power: square(&self.damping, &rate) })
    }

    fn directions(&self) -> usize {
        6
    }

    fn linearize(&self, _: [f64; 2], motions: &[MarkerMotion], set: &mut SetDirection<'_>) {
        let [i, j] = motions else { return };
        let line = j.position_global - i.position_global;
        let turned = rotation_vector(&(j.axes_global.transpose() * i.axes_global)).unwrap_or_default();
        let zero = Vector3::zeros();
        for (k, axis) in i.axes_global.column_iter().enumerate() {
            let along: Vector3<f64> = axis.into();
            let of = |which: usize| [self.stiffness[which][k], self.damping[which][k]];
            let [on_i, on_j] = [(-along, -line.cross(&along)), (along, zero)]
                .map(|(force_global, moment_global)| MarkerWrench { force_global, moment_global });
            set(k, of(0), &[on_i, on_j]);
            let about = i.axes_global * on_turn(&turned, &Vector3::ith(k, 1.0));
            let [on_i, on_j] = [-about, about].map(|moment_global| MarkerWrench { force_global: zero, moment_global });
            set(3 + k, of(1), &[on_i, on_j]);
        }
    }

    fn differentiate(&self, _: [f64; 2], motions: &[MarkerMotion], by: &[MarkerChange], changes: &mut [MarkerWrench]) {
        let ([i, j], [by_i, by_j], [on_i, on_j]) = (motions, by, changes) else { return };
        let axes = &i.axes_global;
        // In the axes of i, which turn.
        let change_in_i =
            |vector: &Vector3<f64>, change: Vector3<f64>| axes.tr_mul(&(change - by_i.turn_global.cross(vector)));
        let line = j.position_global - i.position_global;
        let d_line = by_j.displacement_global - by_i.displacement_global;
        let velocity = j.velocity_global - i.velocity_global - i.omega_global.cross(&line);
        let d_velocity = by_j.velocity_global
            - by_i.velocity_global
            - by_i.omega_global.cross(&line)
            - i.omega_global.cross(&d_line);
        let spin = j.omega_global - i.omega_global;
        let (moved, d_moved) = (axes.tr_mul(&line), change_in_i(&line, d_line));
        let (rate, d_rate) = (axes.tr_mul(&velocity), change_in_i(&velocity, d_velocity));
        let (turning, d_turning) = (axes.tr_mul(&spin), change_in_i(&spin, by_j.omega_global - by_i.omega_global));
        // exp[φ×] = C_iᵀ C_j turns by T(φ) δφ.
        let turned = rotation_vector(&(j.axes_global.transpose() * axes)).unwrap_or_default();
        let d_turn = axes.tr_mul(&(by_j.turn_global - by_i.turn_global));
        let d_turned = tangent_of(&turned).try_inverse().map_or_else(Vector3::zeros, |inverse| inverse * d_turn);
        let [pull, d_pull, torque, d_torque] = [(0, moved), (0, d_moved), (1, turned), (1, d_turned)]
            .map(|(which, by)| self.stiffness[which].component_mul(&by));
        let law = |spring: Vector3<f64>, which: usize, rate: &Vector3<f64>| {
            axes * (spring + self.damping[which].component_mul(rate))
        };
        let turn_of_i = cross_matrix(&by_i.turn_global);
        let force = law(pull, 0, &rate);
        let d_force = law(d_pull, 0, &d_rate) + turn_of_i * force;
        let d_on_turn = change_on_turn(&turned, &d_turned, &torque) + on_turn(&turned, &d_torque);
        let d_moment = law(d_on_turn, 1, &d_turning) + turn_of_i * law(on_turn(&turned, &torque), 1, &turning);
        (on_j.force_global, on_j.moment_global) = (-d_force, -d_moment);
        on_i.force_global = d_force;
        on_i.moment_global = d_moment + d_line.cross(&force) + line.cross(&d_force);
    }
}

/// T(φ)⁻ᵀ m = m + ½ φ×m + b φ×(φ×m), b = (1 − t/2 cot t/2)/t², t = |φ|: the moment of forces m along the components of φ.
fn on_turn(phi: &Vector3<f64>, m: &Vector3<f64>) -> Vector3<f64> {
    // A rotation vector is half a turn long at the most.
    f_inverse(phi, m).unwrap_or(*m)
}

/// The change of [`on_turn`] by that of φ.
fn change_on_turn(phi: &Vector3<f64>, change: &Vector3<f64>, m: &Vector3<f64>) -> Vector3<f64> {
    let [b, slope] = [half_cotangent_factor(phi.norm()), slope_of_factor(phi.norm())];
    let (crossed, changed) = (phi.cross(m), change.cross(m));
    changed * 0.5 + (change.cross(&crossed) + phi.cross(&changed)) * b + phi.cross(&crossed) * (slope * phi.dot(change))
}

/// b'(t)/t.
fn slope_of_factor(t: f64) -> f64 {
    let square = t * t;
    if t < 0.15 {
        return (1.0 + square / 21.0 * (1.0 + 3.0 * square / 80.0)) / 360.0;
    }
    let half = 0.5 * t;
    ((2.0 * t * half.tan()).recip() + 0.25 / half.sin().powi(2) - 2.0 / square) / square
}
