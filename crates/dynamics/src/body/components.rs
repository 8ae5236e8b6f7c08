//! The shapes of a place by components, so that all modes are gone through side by side.

use nalgebra::Vector3;
use pulp::{Arch, Simd, WithSimd};

use crate::matrix::four::{Four, WIDTH};

/// x, y and z of a vector for each mode, a list each, as far as the last mode that is not zero.
#[derive(Debug, Clone)]
pub(crate) struct Components([Vec<f64>; 3]);

impl Components {
    pub fn new(columns: &[Vector3<f64>]) -> Self {
        let moving = columns.iter().rposition(|column| *column != Vector3::zeros()).map_or(0, |last| last + 1);
        Self(std::array::from_fn(|i| columns[..moving].iter().map(|column| column[i]).collect()))
    }

    /// Components of the modes from `first` on.
    pub fn from(&self, first: usize) -> ComponentsFrom<'_> {
        let Self(all) = self;
        ComponentsFrom(all.each_ref().map(|list| list.get(first..).unwrap_or_default()))
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
        if self.0[0].is_empty() {
            return (Vector3::zeros(), 0.0);
        }
        Arch::new().dispatch(Push { shapes: self, force, coordinates, velocity, modal_force })
    }
}

/// Sums over all modes, in the widest vectors that the processor has.
struct Sums<'a, const N: usize> {
    shapes: ComponentsFrom<'a>,
    coordinates: [&'a [f64]; N],
}

impl<const N: usize> WithSimd for Sums<'_, N> {
    type Output = [Vector3<f64>; N];

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) -> Self::Output {
        let Self { shapes: ComponentsFrom(shapes), coordinates } = self;
        let mut sums = [Vector3::zeros(); N];
        for (sum, c) in sums.iter_mut().zip(coordinates) {
            for (sum, shape) in sum.iter_mut().zip(shapes) {
                *sum = dot_product(simd, shape, c);
            }
        }
        sums
    }
}

/// aᵀb, as far as the shorter list goes.
#[inline(always)]
fn dot_product<S: Simd>(simd: S, a: &[f64], b: &[f64]) -> f64 {
    let length = a.len().min(b.len());
    let ((a, a_rest), (b, b_rest)) = (a[..length].as_chunks::<WIDTH>(), b[..length].as_chunks::<WIDTH>());
    let mut sum = Four::splat(simd, 0.0);
    for (a, b) in a.iter().zip(b) {
        sum = Four::load(simd, a).mul_add(simd, Four::load(simd, b), sum);
    }
    let mut rest = 0.0;
    for (a, b) in a_rest.iter().zip(b_rest) {
        rest += a * b;
    }
    sum.sum() + rest
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
    fn with_simd<S: Simd>(self, simd: S) -> Self::Output {
        let Self { shapes: ComponentsFrom([x, y, z]), force, coordinates, velocity, modal_force } = self;
        let modes = modal_force.len().min(velocity.len()).min(coordinates.len()).min(x.len());
        let ((x, x_rest), (y, y_rest)) = (x[..modes].as_chunks::<WIDTH>(), y[..modes].as_chunks::<WIDTH>());
        let ((z, z_rest), (q, q_rest)) = (z[..modes].as_chunks::<WIDTH>(), coordinates[..modes].as_chunks::<WIDTH>());
        let (v, v_rest) = velocity[..modes].as_chunks::<WIDTH>();
        let (f, f_rest) = modal_force[..modes].as_chunks_mut::<WIDTH>();
        let (zero, along) = (Four::splat(simd, 0.0), [force.x, force.y, force.z]);
        let along = [Four::splat(simd, along[0]), Four::splat(simd, along[1]), Four::splat(simd, along[2])];
        let (mut moved, mut power) = ([zero; 3], zero);
        for (((((x, y), z), q), v), f) in x.iter().zip(y).zip(z).zip(q).zip(v).zip(f) {
            let (x, y, z) = (Four::load(simd, x), Four::load(simd, y), Four::load(simd, z));
            let q = Four::load(simd, q);
            moved = [x.mul_add(simd, q, moved[0]), y.mul_add(simd, q, moved[1]), z.mul_add(simd, q, moved[2])];
            let modal = z.mul_add(simd, along[2], y.mul_add(simd, along[1], x.mul(simd, along[0])));
            power = modal.mul_add(simd, Four::load(simd, v), power);
            Four::load(simd, f).add(simd, modal).store(f);
        }
        let mut displacement = Vector3::new(moved[0].sum(), moved[1].sum(), moved[2].sum());
        let mut power = power.sum();
        for (i, f) in f_rest.iter_mut().enumerate() {
            let shape = Vector3::new(x_rest[i], y_rest[i], z_rest[i]);
            let modal = shape.dot(force);
            *f += modal;
            power += modal * v_rest[i];
            displacement += shape * q_rest[i];
        }
        (displacement, power)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Independent reference: the sums column by column.
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
            // A place that only rigid modes move.
            let still = Components::new(&[&columns[..2], &vec![Vector3::zeros(); modes]].concat());
            assert_eq!(still.from(2).push(&force, &q, &v, &mut modal_force), (Vector3::zeros(), 0.0));
            assert_eq!((still.from(2).sum(&q), still.from(0).sum(&[1.0, 0.0])), (Vector3::zeros(), columns[0]));
        }
    }
}
