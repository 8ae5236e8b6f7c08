//! The shapes of a place by components, so that all modes are gone through side by side.

use nalgebra::Vector3;
use pulp::{Arch, Simd, WithSimd};

use crate::column_major::{dot, total};

/// x, y and z of a vector for each mode, a list each.
#[derive(Debug, Clone)]
pub(crate) struct Components([Vec<f64>; 3]);

impl Components {
    pub fn new(columns: &[Vector3<f64>]) -> Self {
        Self(std::array::from_fn(|i| columns.iter().map(|column| column[i]).collect()))
    }

    /// Those of the modes from `first` on.
    pub fn from(&self, first: usize) -> ComponentsFrom<'_> {
        let Self([x, y, z]) = self;
        ComponentsFrom([&x[first..], &y[first..], &z[first..]])
    }
}

/// The components of some modes.
#[derive(Debug, Clone, Copy)]
pub(crate) struct ComponentsFrom<'a>([&'a [f64]; 3]);

impl ComponentsFrom<'_> {
    /// Σ_k shape_k c_k
    pub fn sum(self, coordinates: &[f64]) -> Vector3<f64> {
        let [sum] = self.sums([coordinates]);
        sum
    }

    /// The same of several lists.
    pub fn sums<const N: usize>(self, coordinates: [&[f64]; N]) -> [Vector3<f64>; N] {
        Arch::new().dispatch(Sums { shapes: self, coordinates })
    }

    /// Adds the modal forces of a force on the place. Returns its displacement and the power of the modal forces.
    pub fn push(
        self,
        force: &Vector3<f64>,
        coordinates: &[f64],
        velocity: &[f64],
        modal_force: &mut [f64],
    ) -> (Vector3<f64>, f64) {
        Arch::new().dispatch(Push { shapes: self, force, coordinates, velocity, modal_force })
    }
}

/// Modes that are taken side by side, whatever the vectors of the processor.
const WIDTH: usize = 4;

/// Sums over all modes, in the widest vectors that the processor has.
struct Sums<'a, const N: usize> {
    shapes: ComponentsFrom<'a>,
    coordinates: [&'a [f64]; N],
}

impl<const N: usize> WithSimd for Sums<'_, N> {
    type Output = [Vector3<f64>; N];

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) -> Self::Output {
        let Self { shapes: ComponentsFrom([x, y, z]), coordinates } = self;
        coordinates.map(|c| Vector3::new(dot(x, c), dot(y, c), dot(z, c)))
    }
}

/// A force on a place, in the widest vectors that the processor has.
struct Push<'a> {
    shapes: ComponentsFrom<'a>,
    force: &'a Vector3<f64>,
    coordinates: &'a [f64],
    velocity: &'a [f64],
    modal_force: &'a mut [f64],
}

impl WithSimd for Push<'_> {
    type Output = (Vector3<f64>, f64);

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) -> Self::Output {
        let Self { shapes: ComponentsFrom([x, y, z]), force, coordinates, velocity, modal_force } = self;
        let displacement = Vector3::new(dot(x, coordinates), dot(y, coordinates), dot(z, coordinates));
        let modes = modal_force.len().min(velocity.len()).min(x.len());
        let (modal_force, f_rest) = modal_force[..modes].as_chunks_mut::<WIDTH>();
        let ((x, x_rest), (y, y_rest)) = (x[..modes].as_chunks::<WIDTH>(), y[..modes].as_chunks::<WIDTH>());
        let ((z, z_rest), (v, v_rest)) = (z[..modes].as_chunks::<WIDTH>(), velocity[..modes].as_chunks::<WIDTH>());
        let mut power = [0.0; WIDTH];
        for ((((f, x), y), z), v) in modal_force.iter_mut().zip(x).zip(y).zip(z).zip(v) {
            for i in 0..WIDTH {
                let along = x[i] * force.x + y[i] * force.y + z[i] * force.z;
                f[i] += along;
                power[i] += along * v[i];
            }
        }
        for (i, f) in f_rest.iter_mut().enumerate() {
            let along = x_rest[i] * force.x + y_rest[i] * force.y + z_rest[i] * force.z;
            *f += along;
            power[i] += along * v_rest[i];
        }
        (displacement, total(power))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_force_does_its_work_on_the_displacement_for_any_number_of_modes() {
        for modes in 0..14_usize {
            let columns: Vec<_> = (0..modes + 2).map(|k| Vector3::new(k as f64, 0.3, (k as f64).sin())).collect();
            let components = Components::new(&columns);
            let list = |phase: f64| -> Vec<f64> { (0..modes).map(|k| (k as f64 + phase).cos()).collect() };
            let (q, v) = (list(0.1), list(0.2));
            let sum = |c: &[f64]| columns[2..].iter().zip(c).map(|(column, c)| column * *c).sum::<Vector3<f64>>();
            let [of_q, of_v] = components.from(2).sums([&q, &v]);
            assert!((of_q - sum(&q)).norm() < 1e-13 && (of_v - sum(&v)).norm() < 1e-13, "{modes} modes");
            let force = Vector3::new(1.0, -2.0, 0.7);
            let mut modal_force = vec![1.0; modes];
            let (displacement, power) = components.from(2).push(&force, &q, &v, &mut modal_force);
            assert!((displacement - of_q).norm() < 1e-13 && (power - of_v.dot(&force)).abs() < 1e-13, "{modes} modes");
            for (k, f) in modal_force.iter().enumerate() {
                assert!((f - 1.0 - columns[k + 2].dot(&force)).abs() < 1e-13, "mode {k} of {modes}");
            }
        }
    }
}
