//! The shapes of a place by components, so that all modes are gone through side by side.

use nalgebra::Vector3;
use pulp::{Arch, Simd, WithSimd};

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

    /// The same of several lists: each shape is read once.
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

/// Modes that are taken side by side.
const WIDTH: usize = 4;

type Lanes = [f64; WIDTH];

/// The lanes that begin with mode k; zeros beyond the end.
#[inline(always)]
fn lanes(list: &[f64], k: usize) -> Lanes {
    match list[k..].first_chunk() {
        Some(lanes) => *lanes,
        None => std::array::from_fn(|i| list.get(k + i).copied().unwrap_or(0.0)),
    }
}

#[inline(always)]
fn add_product(sum: &mut Lanes, a: Lanes, b: Lanes) {
    for i in 0..WIDTH {
        sum[i] += a[i] * b[i];
    }
}

#[inline(always)]
fn total(sums: Lanes) -> f64 {
    (sums[0] + sums[2]) + (sums[1] + sums[3])
}

/// Sums over all modes, in the widest vectors that the processor has.
struct Sums<'a, const N: usize> {
    shapes: ComponentsFrom<'a>,
    coordinates: [&'a [f64]; N],
}

impl<const N: usize> WithSimd for Sums<'_, N> {
    type Output = [Vector3<f64>; N];

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) -> Self::Output {
        let Self { shapes: ComponentsFrom(shapes), coordinates } = self;
        let mut sums = [[[0.0; WIDTH]; 3]; N];
        for k in (0..coordinates[0].len().min(shapes[0].len())).step_by(WIDTH) {
            for (sums, coordinates) in sums.iter_mut().zip(&coordinates) {
                let c = lanes(coordinates, k);
                for (sum, shapes) in sums.iter_mut().zip(&shapes) {
                    add_product(sum, lanes(shapes, k), c);
                }
            }
        }
        sums.map(|[x, y, z]| Vector3::new(total(x), total(y), total(z)))
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
        let Self { shapes: ComponentsFrom(shapes), force, coordinates, velocity, modal_force } = self;
        let (mut displacement, mut power) = ([[0.0; WIDTH]; 3], [0.0; WIDTH]);
        for k in (0..coordinates.len().min(shapes[0].len())).step_by(WIDTH) {
            let c = lanes(coordinates, k);
            let mut along = [0.0; WIDTH];
            for (i, shapes) in shapes.iter().enumerate() {
                let shapes = lanes(shapes, k);
                add_product(&mut displacement[i], shapes, c);
                add_product(&mut along, shapes, [force[i]; WIDTH]);
            }
            add_product(&mut power, along, lanes(velocity, k));
            match modal_force[k..].first_chunk_mut::<WIDTH>() {
                Some(modal_force) => add_product(modal_force, along, [1.0; WIDTH]),
                None => modal_force[k..].iter_mut().zip(along).for_each(|(f, along)| *f += along),
            }
        }
        let [x, y, z] = displacement;
        (Vector3::new(total(x), total(y), total(z)), total(power))
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
