//! K and M among the displacements that are polynomials of degree two in the positions, in one pass over each matrix.
//!
//! A field is a sum of monomials along the axes, `Σ c_kb p_k(x) e_b`. Each entry of K meets the monomials of one node only, so
//! all thirty of them take the work of ten fields. Two fields of random numbers go with them, which tell whether K is its own
//! transpose: `rᵀ K s` and `sᵀ K r` are two different sums over its entries.

use std::array::from_fn;

use faer::Mat;
use nalgebra::Vector3;
use pulp::{Arch, Simd, WithSimd};
use rayon::prelude::*;

use crate::matrix::mass::NodalMass;
use crate::matrix::stiffness::NodalStiffness;
use reduced_body::ReducedBody;

/// 1, x, y, z, then x_a x_b by [`ReducedBody::PAIRS`].
pub(crate) const MONOMIALS: usize = 10;
/// The same and two random numbers: whole vectors of numbers.
const ALL: usize = 12;
/// Where the sums over the two triangles differ by more than this, relative to the largest entry on the diagonal, it is no
/// rounding.
const ASYMMETRY: f64 = 1e-10;
/// Nodes of a task. Fixed, so that the sums are.
const PART: usize = 1024;

/// The monomials at a node, and the random numbers.
type Monomials = [f64; ALL];

/// A field by its coefficients: axis, monomial.
pub(crate) type Field = [[f64; MONOMIALS]; 3];

/// K and M_s in the space of the polynomials, and how K resists some of them.
pub(crate) struct Polynomials {
    /// Twice the energies of two monomials along axes (30×30): row and column `10·axis + monomial`.
    stiffness: Mat<f64>,
    /// `pᵀ M_s p` (10×10).
    mass: Mat<f64>,
    /// The largest difference of the sums over the two triangles of K, relative to the largest entry on its diagonal; not
    /// finite where K is not.
    asymmetry: f64,
    /// ‖K r‖ and ‖D r‖ of each of the fields r that were asked for, D the diagonal of K.
    pub resistance: Vec<[f64; 2]>,
}

impl Polynomials {
    /// The sums for matrices over the nodes at `positions`; the monomials are those of the positions from `origin`. `fields` are linear.
    pub fn new(
        stiffness: &NodalStiffness<'_>,
        mass: &NodalMass<'_>,
        positions: &[[f64; 3]],
        origin: &Vector3<f64>,
        fields: &[Field],
    ) -> Self {
        let monomials: Vec<Monomials> =
            (0..).zip(positions).map(|(node, x)| monomials(node, Vector3::from(*x) - origin)).collect();
        let parts: Vec<Sums> = (0..positions.len())
            .step_by(PART)
            .collect::<Vec<_>>()
            .into_par_iter()
            .map(|first| {
                let mut sums = Sums::new(fields.len());
                let nodes = first..positions.len().min(first + PART);
                Arch::new().dispatch(Pass { stiffness, mass, monomials: &monomials, fields, nodes, sums: &mut sums });
                sums
            })
            .collect();
        let sum = parts.into_iter().fold(Sums::new(fields.len()), Sums::plus);
        let entry = |i: usize, j: usize| sum.stiffness[i / MONOMIALS][j / MONOMIALS][i % MONOMIALS][j % MONOMIALS];
        // Axis and place among the two of a random field.
        let random = |i: usize, j: usize| sum.stiffness[i / 2][j / 2][MONOMIALS + i % 2][MONOMIALS + j % 2];
        let differences = (0..6).flat_map(|i| (0..i).map(move |j| (random(i, j) - random(j, i)).abs()));
        // NaN stays.
        let largest =
            differences.fold(0.0, |most: f64, found| if found > most || found.is_nan() { found } else { most });
        Self {
            asymmetry: largest / sum.largest,
            stiffness: Mat::from_fn(3 * MONOMIALS, 3 * MONOMIALS, |i, j| 0.5 * (entry(i, j) + entry(j, i))),
            mass: Mat::from_fn(MONOMIALS, MONOMIALS, |k, l| 0.5 * (sum.mass[k][l] + sum.mass[l][k])),
            resistance: sum.resistance.iter().map(|squares| squares.map(f64::sqrt)).collect(),
        }
    }

    /// True if K is finite and its own transpose, as far as sums over all of its entries tell.
    pub fn is_symmetric(&self) -> bool {
        self.asymmetry <= ASYMMETRY
    }

    /// `uᵀ K v` of all pairs of fields.
    pub fn stiffness_of(&self, fields: &[Field]) -> Mat<f64> {
        let columns = Mat::from_fn(3 * MONOMIALS, fields.len(), |i, j| fields[j][i / MONOMIALS][i % MONOMIALS]);
        columns.transpose() * &self.stiffness * &columns
    }

    /// `uᵀ M v` of all pairs of fields of two lists.
    pub fn mass_of(&self, left: &[Field], right: &[Field]) -> Mat<f64> {
        let mut sum = Mat::zeros(left.len(), right.len());
        for axis in 0..3 {
            let [left, right] = [left, right]
                .map(|fields| Mat::from_fn(MONOMIALS, fields.len(), |monomial, field| fields[field][axis][monomial]));
            sum += left.transpose() * &self.mass * &right;
        }
        sum
    }
}

/// The linear fields `x_a e_b + x_b e_a`, then the quadratic ones `x_a x_b e_c`.
pub(crate) fn straining_fields() -> Vec<Field> {
    let linear = ReducedBody::PAIRS.map(|(a, b)| {
        let mut field = Field::default();
        field[a][1 + b] += 1.0;
        field[b][1 + a] += 1.0;
        field
    });
    let quadratic = (0..ReducedBody::PAIRS.len()).flat_map(|pair| {
        (0..3).map(move |axis| {
            let mut field = Field::default();
            field[axis][4 + pair] = 1.0;
            field
        })
    });
    linear.into_iter().chain(quadratic).collect()
}

/// The velocities `v + ω × x` of a rigid motion.
pub(crate) fn rigid_field(velocity: &Vector3<f64>, rotation: &Vector3<f64>) -> Field {
    let turned = rotation.cross_matrix();
    from_fn(|axis| {
        from_fn(|k| {
            if k == 0 {
                velocity[axis]
            } else if k < 4 {
                turned[(axis, k - 1)]
            } else {
                0.0
            }
        })
    })
}

fn monomials(node: u64, x: Vector3<f64>) -> Monomials {
    from_fn(|k| match k {
        0 => 1.0,
        1..4 => x[k - 1],
        4..MONOMIALS => x[ReducedBody::PAIRS[k - 4].0] * x[ReducedBody::PAIRS[k - 4].1],
        _ => random(2 * node + (k - MONOMIALS) as u64),
    })
}

/// A number in [−1, 1) that looks random, of a place in a list (SplitMix64, Steele, Lea, Flood 2014).
fn random(place: u64) -> f64 {
    let mut bits = place.wrapping_add(1).wrapping_mul(0x9e37_79b9_7f4a_7c15);
    bits = (bits ^ (bits >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    bits = (bits ^ (bits >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    ((bits ^ (bits >> 31)) >> 11) as f64 / (1u64 << 52) as f64 - 1.0
}

/// Sums of a pass over some nodes.
struct Sums {
    /// Axis of the row, axis of the column, then the monomials.
    stiffness: [[[Monomials; ALL]; 3]; 3],
    mass: [Monomials; ALL],
    /// The largest entry on the diagonal of K.
    largest: f64,
    /// The squares.
    resistance: Vec<[f64; 2]>,
}

impl Sums {
    fn new(fields: usize) -> Self {
        Self {
            stiffness: Default::default(),
            mass: Default::default(),
            largest: 0.0,
            resistance: vec![[0.0; 2]; fields],
        }
    }

    fn plus(mut self, other: Self) -> Self {
        let own = self.stiffness.as_flattened_mut().as_flattened_mut().as_flattened_mut().iter_mut();
        own.zip(other.stiffness.as_flattened().as_flattened().as_flattened()).for_each(|(sum, value)| *sum += value);
        let own = self.mass.as_flattened_mut().iter_mut();
        own.zip(other.mass.as_flattened()).for_each(|(sum, value)| *sum += value);
        let own = self.resistance.as_flattened_mut().iter_mut();
        own.zip(other.resistance.as_flattened()).for_each(|(sum, value)| *sum += value);
        self.largest = self.largest.max(other.largest);
        self
    }
}

/// A pass over some nodes. A type rather than a closure: what a closure calls is compiled without the vector instructions.
struct Pass<'a> {
    stiffness: &'a NodalStiffness<'a>,
    mass: &'a NodalMass<'a>,
    monomials: &'a [Monomials],
    fields: &'a [Field],
    nodes: std::ops::Range<usize>,
    sums: &'a mut Sums,
}

impl WithSimd for Pass<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _simd: S) {
        let Self { stiffness, mass, monomials, fields, nodes, sums } = self;
        for node in nodes {
            let own = &monomials[node];
            for axis in 0..3 {
                let (forces, diagonal) = forces(stiffness, monomials, node, axis);
                sums.largest = sums.largest.max(diagonal);
                for (sums, forces) in sums.stiffness[axis].iter_mut().zip(&forces) {
                    for (sums, own) in sums.iter_mut().zip(own) {
                        add_scaled(sums, *own, forces);
                    }
                }
                for (field, squares) in fields.iter().zip(&mut sums.resistance) {
                    let mut force = 0.0;
                    for (coefficients, forces) in field.iter().zip(&forces) {
                        for k in 0..4 {
                            force += coefficients[k] * forces[k];
                        }
                    }
                    let mut displacement = 0.0;
                    for k in 0..4 {
                        displacement += field[axis][k] * own[k];
                    }
                    squares[0] += force * force;
                    squares[1] += (diagonal * displacement) * (diagonal * displacement);
                }
            }
            let mut momenta = [0.0; ALL];
            for (other, value) in mass.column(node) {
                add_scaled(&mut momenta, value, &monomials[other]);
            }
            for (sums, own) in sums.mass.iter_mut().zip(own) {
                add_scaled(sums, *own, &momenta);
            }
        }
    }
}

/// The forces of all monomials along each axis on a node along an axis, and the entry of K on the diagonal.
#[inline(always)]
fn forces(stiffness: &NodalStiffness<'_>, monomials: &[Monomials], node: usize, axis: usize) -> ([Monomials; 3], f64) {
    let mut forces = [[0.0; ALL]; 3];
    let mut diagonal = 0.0;
    // A column of a symmetric matrix is its row.
    let (nodes, values) = stiffness.column(node, axis);
    for (other, values) in nodes.iter().zip(values) {
        let monomials = &monomials[*other as usize];
        for (forces, value) in forces.iter_mut().zip(values) {
            add_scaled(forces, *value, monomials);
        }
        if *other as usize == node {
            diagonal = values[axis];
        }
    }
    (forces, diagonal)
}

#[inline(always)]
fn add_scaled(sum: &mut Monomials, factor: f64, x: &Monomials) {
    for k in 0..ALL {
        sum[k] += factor * x[k];
    }
}
