//! A St. Venant–Kirchhoff body at any displacement: stresses, internal forces, stiffness. Eqs. (K1), (K3) of
//! `docs/method/check.md`.
//!
//! ```text
//! F = 1 + ∇u      E = ½ (FᵀF − 1)      δE = sym(Fᵀ ∇δu) = B(u) δu      W = ½ ∫ E:C:E dV
//!
//! v·f(u, S) = ∫ B(u)v : S dV               internal forces: S = C:E(u)
//! v·K(u, S) w = ∫ B(u)v : C : B(u)w  +  sym(∇vᵀ∇w) : S dV
//! ```
//!
//! S stands beside u: with S = C:E(u), K is the tangent stiffness; a Newton iteration that keeps S as an unknown of its own
//! takes far fewer steps on slender bodies, since the membrane stress of a displacement that is still wrong does not enter K.
//!
//! All integrals are by the rule of degree 5, which is exact on straight elements. Displacements count against the first
//! node of an element, as in the other terms.

use std::sync::Arc;

use faer::MatRef;
use nalgebra::{Matrix3, SMatrix};
use rayon::prelude::*;

use crate::assembly::matrices::Matrices;
use crate::element::deformation::OTHERS;
use crate::element::integration::Rules;
use crate::element::lanes::{Group, GroupPoint, LANES, Lame, Lanes, Rows, Tensors};
use crate::element::vectorized::vectorized;
use crate::error::AssemblyError;
use crate::material::{Material, Materials};
use crate::mesh::checked::Mesh;

/// Groups of elements that are held at once, before they are added in their order: the sums are the same for any number of
/// threads.
const BLOCK: usize = 256;
/// 3×3 blocks of the stiffness of the nodes 1 to 9, on and above the diagonal.
const BLOCKS: usize = OTHERS * (OTHERS + 1) / 2;

/// A St. Venant–Kirchhoff body. Displacements and forces are lists of 3n numbers, row `3·node + axis`.
#[derive(Debug)]
pub struct FiniteStrain {
    mesh: Arc<Mesh>,
    materials: Vec<Material>,
    rules: Rules,
    groups: Vec<Group>,
}

/// A second Piola–Kirchhoff stress at the integration points of a body, force per undeformed area.
#[derive(Debug, Clone)]
pub struct Stresses(Vec<Tensors>);

impl Stresses {
    /// The mean of two.
    pub fn mean(&self, other: &Self) -> Self {
        Self(self.0.iter().zip(&other.0).map(|(a, b)| a.plus(b).scaled(&[0.5; LANES])).collect())
    }
}

/// State of a group of elements at one of its points.
struct Here<'a> {
    point: &'a GroupPoint,
    lame: &'a Lame,
    /// ∇ of each field.
    gradients: &'a [Tensors],
}

impl FiniteStrain {
    /// The body of a mesh.
    ///
    /// # Errors
    /// Materials that do not fit the mesh.
    pub fn new(mesh: Arc<Mesh>, materials: &Materials) -> Result<Self, AssemblyError> {
        let materials = materials.of_elements(&mesh)?;
        Ok(Self { groups: Group::all(&mesh), rules: Rules::new(), materials, mesh })
    }

    /// Its mesh.
    pub fn mesh(&self) -> &Mesh {
        &self.mesh
    }

    /// C:E(u).
    pub fn stresses(&self, u: &[f64]) -> Stresses {
        self.at_points([u], |here| {
            let [g] = here.gradients else { return Tensors::ZERO };
            green_strain(g).stress(here.lame)
        })
    }

    /// C:ε(u): the stress of a small displacement.
    pub fn linear_stresses(&self, u: &[f64]) -> Stresses {
        self.at_points([u], |here| {
            let [g] = here.gradients else { return Tensors::ZERO };
            g.strain().stress(here.lame)
        })
    }

    /// C:(E(u) + B(u)e): the stress at u + e, linear in e.
    pub fn linearized_stresses(&self, u: &[f64], e: &[f64]) -> Stresses {
        self.at_points([u, e], |here| {
            let [g, change] = here.gradients else { return Tensors::ZERO };
            let added = change.strain().plus(&g.second_strain(change));
            green_strain(g).plus(&added).stress(here.lame)
        })
    }

    /// W: the strain energy.
    pub fn strain_energy(&self, u: &[f64]) -> f64 {
        let energies = self.at_points([u], |here| {
            let [g] = here.gradients else { return Tensors::ZERO };
            let strain = green_strain(g);
            let (strain, stress) = (strain.upper(1.0), strain.stress(here.lame).upper(2.0));
            let mut energy = Tensors::ZERO;
            for (strain, stress) in strain.iter().zip(&stress) {
                for lane in 0..LANES {
                    energy.0[0][0][lane] += 0.5 * here.point.volume[lane] * strain[lane] * stress[lane];
                }
            }
            energy
        });
        energies.0.iter().flat_map(|energy| energy.0[0][0]).sum()
    }

    /// `∫ B(u)ᵀ S dV` (3n).
    pub fn forces(&self, u: &[f64], stresses: &Stresses) -> Vec<f64> {
        let mut forces = vec![0.0; u.len()];
        self.for_each_group(
            [u],
            |number, group, gradients, point, sums: &mut [[Lanes; 3]; OTHERS]| {
                let _ = group;
                let [g] = gradients else { return };
                let p = with_one(g).times(&stresses.0[number]).scaled(&point.volume);
                point.add_forces(&p, sums);
            },
            [[[0.0; LANES]; 3]; OTHERS],
            |nodes, lane, sums| {
                for (node, force) in nodes[1..].iter().zip(sums) {
                    for (axis, force) in force.iter().enumerate() {
                        forces[3 * *node as usize + axis] += force[lane];
                        forces[3 * nodes[0] as usize + axis] -= force[lane];
                    }
                }
            },
        );
        forces
    }

    /// The internal forces at u (3n): those of the stress there.
    pub fn internal_forces(&self, u: &[f64]) -> Vec<f64> {
        self.forces(u, &self.stresses(u))
    }

    /// K(u, S): its entries in the order of [`Matrices::stiffness_by_nodes`] of matrices of the same mesh.
    pub fn stiffness(&self, u: &[f64], stresses: &Stresses, matrices: &Matrices) -> Vec<f64> {
        let (start, all) = (matrices.start(), matrices.nodes());
        let mut values = vec![0.0; matrices.stiffness_by_nodes().len()];
        self.for_each_group(
            [u],
            |number, group, gradients, point, sums: &mut Blocks| {
                let [g] = gradients else { return };
                let f = with_one(g);
                let lame = group.lame(&self.materials);
                add_stiffness(&f, &stresses.0[number].scaled(&point.volume), point, &lame, sums);
            },
            Blocks([[[[0.0; LANES]; 3]; 3]; BLOCKS]),
            |nodes, lane, sums| {
                let element = sums.of_element(lane);
                for (b, column) in nodes.iter().enumerate() {
                    let range = start[*column as usize]..start[*column as usize + 1];
                    let (rows, count) = (&all[range.clone()], range.len());
                    for (a, row) in nodes.iter().enumerate() {
                        // A mesh and its matrices couple the nodes of an element.
                        let Ok(place) = rows.binary_search(row) else { continue };
                        for j in 0..3 {
                            let first = 9 * range.start + 3 * (j * count + place);
                            for (i, value) in values[first..first + 3].iter_mut().enumerate() {
                                *value += element[(3 * a + i, 3 * b + j)];
                            }
                        }
                    }
                }
            },
        );
        values
    }

    /// A matrix at each point, made of the gradients of some fields there.
    fn at_points<const N: usize>(&self, fields: [&[f64]; N], value: impl Fn(&Here<'_>) -> Tensors + Sync) -> Stresses {
        let fields = fields.map(|field| Rows::new(MatRef::from_column_major_slice(field, field.len(), 1)));
        let points = self.rules.fine();
        let of_group = |group: &Group| -> Vec<Tensors> {
            let mut found = Vec::with_capacity(points.len());
            vectorized(
                #[inline(always)]
                || {
                    let (lame, positions) = (group.lame(&self.materials), group.positions(&self.mesh));
                    let relative = relative(&fields, &self.mesh, group);
                    for rule in points {
                        let point = GroupPoint::new(&positions, rule, group.count);
                        let mut gradients = [Tensors::ZERO; N];
                        for (gradient, relative) in gradients.iter_mut().zip(&relative) {
                            *gradient = point.gradient(relative);
                        }
                        found.push(value(&Here { point: &point, lame: &lame, gradients: &gradients }));
                    }
                },
            );
            found
        };
        let parts: Vec<Vec<Tensors>> = self.groups.par_iter().map(of_group).collect();
        Stresses(parts.into_iter().flatten().collect())
    }

    /// Sums over the points of each group of elements, and adds them element by element, in their order. `sum` hears the number
    /// of the point among all, `add` the nodes and the lane of an element.
    fn for_each_group<const N: usize, T: Clone + Send + Sync>(
        &self,
        fields: [&[f64]; N],
        sum: impl Fn(usize, &Group, &[Tensors], &GroupPoint, &mut T) + Sync,
        zero: T,
        mut add: impl FnMut(&[u32; 10], usize, &T),
    ) {
        let fields = fields.map(|field| Rows::new(MatRef::from_column_major_slice(field, field.len(), 1)));
        let points = self.rules.fine();
        let of_group = |(number, group): (usize, &Group)| -> T {
            let mut sums = zero.clone();
            vectorized(
                #[inline(always)]
                || {
                    let positions = group.positions(&self.mesh);
                    let relative = relative(&fields, &self.mesh, group);
                    for (at, rule) in points.iter().enumerate() {
                        let point = GroupPoint::new(&positions, rule, group.count);
                        let mut gradients = [Tensors::ZERO; N];
                        for (gradient, relative) in gradients.iter_mut().zip(&relative) {
                            *gradient = point.gradient(relative);
                        }
                        sum(number * points.len() + at, group, &gradients, &point, &mut sums);
                    }
                },
            );
            sums
        };
        for (block, groups) in self.groups.chunks(BLOCK).enumerate() {
            let first = block * BLOCK;
            let parts: Vec<T> = groups.par_iter().enumerate().map(|(i, group)| of_group((first + i, group))).collect();
            for (group, sums) in groups.iter().zip(&parts) {
                for (lane, element) in group.elements[..group.count].iter().enumerate() {
                    add(&self.mesh.elements()[*element], lane, sums);
                }
            }
        }
    }
}

/// The stiffness of the nodes 1 to 9: node pairs (i, j ≥ i), row, column, element.
#[derive(Clone)]
struct Blocks([[[Lanes; 3]; 3]; BLOCKS]);

impl Blocks {
    /// The whole stiffness of an element: forces of its nodes balance, and no translation deforms it.
    fn of_element(&self, lane: usize) -> SMatrix<f64, 30, 30> {
        let mut all = SMatrix::<f64, 30, 30>::zeros();
        let pairs = (1..10).flat_map(|a| (a..10).map(move |b| (3 * a, 3 * b)));
        for ((a, b), block) in pairs.zip(&self.0) {
            let block = Matrix3::from_fn(|i, j| block[i][j][lane]);
            all.fixed_view_mut::<3, 3>(a, b).copy_from(&block);
            all.fixed_view_mut::<3, 3>(b, a).copy_from(&block.transpose());
        }
        let mut corner = Matrix3::<f64>::zeros();
        for b in (3..30).step_by(3) {
            let column: Matrix3<f64> = (3..30).step_by(3).map(|a| all.fixed_view::<3, 3>(a, b).into_owned()).sum();
            all.fixed_view_mut::<3, 3>(0, b).copy_from(&-column);
            all.fixed_view_mut::<3, 3>(b, 0).copy_from(&-column.transpose());
            corner += column;
        }
        all.fixed_view_mut::<3, 3>(0, 0).copy_from(&corner);
        all
    }
}

/// Displacements of the nodes 1 to 9 of a group against node 0.
#[inline(always)]
fn relative<const N: usize>(fields: &[Rows; N], mesh: &Mesh, group: &Group) -> Vec<[[Lanes; 3]; OTHERS]> {
    let (mut all, mut one) = (Vec::with_capacity(N), Vec::new());
    for field in fields {
        field.relative(mesh, group, &mut one);
        all.extend_from_slice(&one);
    }
    all
}

/// ½ (FᵀF − 1) by ∇u.
#[inline(always)]
fn green_strain(gradient: &Tensors) -> Tensors {
    gradient.strain().plus(&gradient.second_strain(gradient).scaled(&[0.5; LANES]))
}

/// 1 + ∇u.
#[inline(always)]
fn with_one(gradient: &Tensors) -> Tensors {
    let mut f = *gradient;
    for axis in 0..3 {
        for lane in 0..LANES {
            f.0[axis][axis][lane] += 1.0;
        }
    }
    f
}

/// Adds the stiffness of a point: with g the gradients of the shape functions and t = F g,
/// `λ t_i t_jᵀ + μ t_j t_iᵀ + (μ g_i·g_j) F Fᵀ + (g_i·S g_j) 1`.
#[inline(always)]
fn add_stiffness(f: &Tensors, stress: &Tensors, point: &GroupPoint, lame: &Lame, sums: &mut Blocks) {
    let (mut lambda, mut mu) = ([0.0; LANES], [0.0; LANES]);
    for lane in 0..LANES {
        lambda[lane] = lame.lambda[lane] * point.volume[lane];
        mu[lane] = lame.mu[lane] * point.volume[lane];
    }
    let both = f.times(&f.transpose()).scaled(&mu);
    let turned = applied(f, &point.gradients);
    let tractions = applied(stress, &point.gradients);
    let mut blocks = sums.0.iter_mut();
    for i in 0..OTHERS {
        let (g, t) = (&point.gradients[i], &turned[i]);
        for j in i..OTHERS {
            let Some(block) = blocks.next() else { return };
            let (other, traction, s) = (&point.gradients[j], &tractions[j], &turned[j]);
            let (mut product, mut initial) = ([0.0; LANES], [0.0; LANES]);
            for axis in 0..3 {
                for lane in 0..LANES {
                    product[lane] += g[axis][lane] * other[axis][lane];
                    initial[lane] += g[axis][lane] * traction[axis][lane];
                }
            }
            for row in 0..3 {
                for column in 0..3 {
                    for lane in 0..LANES {
                        block[row][column][lane] += lambda[lane] * t[row][lane] * s[column][lane]
                            + mu[lane] * s[row][lane] * t[column][lane]
                            + product[lane] * both.0[row][column][lane];
                    }
                }
                for lane in 0..LANES {
                    block[row][row][lane] += initial[lane];
                }
            }
        }
    }
}

/// A matrix times each of the vectors.
#[inline(always)]
fn applied(matrix: &Tensors, vectors: &[[Lanes; 3]; OTHERS]) -> [[Lanes; 3]; OTHERS] {
    let mut products = [[[0.0; LANES]; 3]; OTHERS];
    for (product, vector) in products.iter_mut().zip(vectors) {
        for (product, row) in product.iter_mut().zip(&matrix.0) {
            for (entry, component) in row.iter().zip(vector) {
                for lane in 0..LANES {
                    product[lane] += entry[lane] * component[lane];
                }
            }
        }
    }
    products
}
