//! Error of the mesh: the recovered stress against that of the elements (Zienkiewicz and Zhu 1987).
//!
//! A few fields at a time, in three passes: the stress of each element at its nodes, its mean at the sites, and the energies of both. What
//! depends on the place alone is found once for all fields of a pass, or for all passes.

use faer::{ColRef, MatRef};
use nalgebra::{Matrix3, Vector3};
use rayon::prelude::*;

use super::{COMPONENTS, StressRecovery};
use crate::element::deformation::check_field;
use crate::element::integration::{IntegrationPoint, RulePoint, is_straight, jacobian};
use crate::element::shape::{BARYCENTRIC_GRADIENTS, EDGES, NODES, edge_between, shape_functions, shape_gradients};
use crate::error::AssemblyError;
use crate::material::Material;

/// Fields of a pass.
const LANES: usize = 4;

/// A value of each field.
type Lanes = [f64; LANES];
/// ∂u_a/∂x_b, by a, then b.
type Gradient = [[Lanes; 3]; 3];
/// Stress, in the order of [`COMPONENTS`].
type Stress = [Lanes; 6];
/// Displacements of the nodes of an element.
type Displacements = [[Lanes; 3]; 10];

/// Strain energies of an element, or of a body: of its stress, and of the difference between its stress and the
/// recovered one.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct StressError {
    /// ½ ∫ σ:C⁻¹:σ dV.
    pub energy: f64,
    /// ½ ∫ (σ* − σ):C⁻¹:(σ* − σ) dV.
    pub error: f64,
}

impl StressError {
    /// The error of the stress in the norm of the energy, relative to the stress; 0 without any.
    pub fn relative(&self) -> f64 {
        if self.energy + self.error > 0.0 { (self.error / (self.energy + self.error)).sqrt() } else { 0.0 }
    }
}

impl std::iter::Sum for StressError {
    fn sum<I: Iterator<Item = Self>>(all: I) -> Self {
        all.fold(Self::default(), |sum, one| Self { energy: sum.energy + one.energy, error: sum.error + one.error })
    }
}

impl StressRecovery<'_> {
    /// The estimate by element, then by field, of displacement fields (N×k, length), Eq. (S3) of `docs/method/stress.md`: the stress of each
    /// element against [`nodal_stress`](Self::nodal_stress). The estimate of the body is the sum over its elements.
    ///
    /// # Errors
    /// Fields of other lengths, or with an entry that is not finite; not enough memory.
    pub fn error_estimate(&self, displacements: MatRef<'_, f64>) -> Result<Vec<StressError>, AssemblyError> {
        self.estimate(displacements, None)
    }

    /// The same of displacement fields u whose strain has a product in it, sym(∇u) + sym(∇aᵀ∇b) with a field b (N×k) for each u: about
    /// a body that is bent by a, b is u.
    ///
    /// # Errors
    /// As [`error_estimate`](Self::error_estimate).
    pub fn error_estimate_of_product(
        &self,
        displacements: MatRef<'_, f64>,
        (a, b): (ColRef<'_, f64>, MatRef<'_, f64>),
    ) -> Result<Vec<StressError>, AssemblyError> {
        check_field(self.mesh, "fields", a.as_mat())?;
        check_field(self.mesh, "fields", b)?;
        self.estimate(displacements, Some((a, b)))
    }

    fn estimate(
        &self,
        displacements: MatRef<'_, f64>,
        product: Option<(ColRef<'_, f64>, MatRef<'_, f64>)>,
    ) -> Result<Vec<StressError>, AssemblyError> {
        check_field(self.mesh, "displacements", displacements)?;
        let (elements, count) = (self.mesh.elements().len(), displacements.ncols());
        let what = "the error of each element";
        let mut errors = memory::with_capacity(what, elements * count)?;
        errors.resize(elements * count, StressError::default());
        let mut places: Vec<Place> = memory::with_capacity(what, elements)?;
        (0..elements)
            .into_par_iter()
            .map(|e| Place::new(&self.mesh.element_positions(e)))
            .collect_into_vec(&mut places);
        let mut raw: Vec<[Stress; 10]> = memory::with_capacity(what, elements)?;
        let products = products_of_shapes(self.rules.fine());
        for first in (0..count).step_by(LANES) {
            let lanes = LANES.min(count - first);
            let of_nodes = |fields: MatRef<'_, f64>| by_node(fields.subcols(first, lanes));
            let u = of_nodes(displacements);
            let bent = product.map(|(a, b)| (by_node_alike(a), of_nodes(b)));
            let fields = Fields { u: &u, bent: bent.as_ref().map(|(a, b)| (&a[..], &b[..])) };
            let at_nodes = |e: usize| self.at_nodes_of(e, &places[e], &fields);
            (0..elements).into_par_iter().map(at_nodes).collect_into_vec(&mut raw);
            let mean = |site: usize| self.mean_at(site, &places, &raw);
            let nodal: Vec<Stress> = (0..self.sites.len()).into_par_iter().map(mean).collect();
            errors.par_chunks_mut(count).enumerate().for_each(|(e, errors)| {
                let [energy, error] = match &places[e] {
                    Place::Straight { determinant, .. } => {
                        self.of_straight(e, determinant / 6.0, &products, &raw[e], &nodal)
                    }
                    Place::Curved { .. } => self.of_curved(e, &fields, &nodal),
                };
                let of_lanes = energy.into_iter().zip(error);
                for (found, (energy, error)) in errors[first..first + lanes].iter_mut().zip(of_lanes) {
                    *found = StressError { energy, error };
                }
            });
        }
        Ok(errors)
    }

    /// The stress of an element at its nodes.
    fn at_nodes_of(&self, e: usize, place: &Place, fields: &Fields<'_>) -> [Stress; 10] {
        let nodes = &self.mesh.elements()[e];
        let gradients: FieldGradients<[Gradient; 10]> = match place {
            Place::Straight { barycentric, .. } => fields.of_element(nodes, |u| at_nodes_of_straight(barycentric, u)),
            Place::Curved { .. } => {
                let positions = self.mesh.element_positions(e);
                let points = NODES.map(|at| IntegrationPoint::new(&positions, &shape_gradients(at), 1.0));
                fields.of_element(nodes, |u| std::array::from_fn(|node| gradient(&points[node].gradients, u)))
            }
        };
        std::array::from_fn(|node| {
            let bent = gradients.bent.as_ref().map(|(a, b)| (&a[node], &b[node]));
            stress(&self.materials[e], &gradients.u[node], bent)
        })
    }

    /// The mean of the elements around a site, weighted with the volumes that they would have if they were as there throughout.
    fn mean_at(&self, site: usize, places: &[Place], raw: &[[Stress; 10]]) -> Stress {
        let (mut mean, mut volume) = (Stress::default(), 0.0);
        for (e, node) in self.elements_at(site) {
            let determinant = match &places[e] {
                Place::Straight { determinant, .. } => *determinant,
                Place::Curved { determinants } => determinants[node],
            };
            volume += determinant;
            each(&mut mean, &raw[e][node], |mean, stress| mean + determinant * stress);
        }
        mean.as_flattened_mut().iter_mut().for_each(|sum| *sum /= volume);
        mean
    }

    /// On a straight element both stresses are quadratic in space: their energies are forms of their values at the ten nodes.
    fn of_straight(
        &self,
        e: usize,
        volume: f64,
        products: &[[f64; 10]; 10],
        raw: &[Stress; 10],
        nodal: &[Stress],
    ) -> [Lanes; 2] {
        let mut off = *raw;
        for (off, site) in off.iter_mut().zip(self.sites.of_element(e)) {
            each(off, &nodal[*site as usize], |raw, nodal| nodal - raw);
        }
        [raw, &off]
            .map(|at_nodes| complementary_form(&self.materials[e], products, at_nodes).map(|mean| 0.5 * volume * mean))
    }

    fn of_curved(&self, e: usize, fields: &Fields<'_>, nodal: &[Stress]) -> [Lanes; 2] {
        let mut energies = [Lanes::default(); 2];
        let nodes = &self.mesh.elements()[e];
        let points = self.rules.fine_points(&self.mesh.element_positions(e));
        for (point, rule) in points.iter().zip(self.rules.fine()) {
            let gradients = fields.of_element(nodes, |u| gradient(&point.gradients, u));
            let bent = gradients.bent.as_ref().map(|(a, b)| (a, b));
            let raw = stress(&self.materials[e], &gradients.u, bent);
            let mut off = raw.map(|component| component.map(|stress| -stress));
            for (site, shape) in self.sites.of_element(e).iter().zip(shape_functions(rule.point.at)) {
                each(&mut off, &nodal[*site as usize], |off, nodal| off + shape * nodal);
            }
            for (energy, stress) in energies.iter_mut().zip([raw, off]) {
                let density = complementary_form(&self.materials[e], &[[1.0]], &[stress]);
                energy.iter_mut().zip(density).for_each(|(sum, density)| *sum += 0.5 * point.volume * density);
            }
        }
        energies
    }
}

/// Properties of an element by its place, the same for all fields.
enum Place {
    /// The gradients of the barycentric coordinates, per length, and the determinant of the Jacobian, which is the same everywhere.
    Straight { barycentric: [[f64; 3]; 4], determinant: f64 },
    /// The determinants at the nodes.
    Curved { determinants: [f64; 10] },
}

impl Place {
    fn new(positions: &[[f64; 3]; 10]) -> Self {
        if !is_straight(positions) {
            let determinants = NODES.map(|at| jacobian(positions, &shape_gradients(at)).determinant());
            return Self::Curved { determinants };
        }
        let [first, others @ ..]: [Vector3<f64>; 4] = std::array::from_fn(|corner| Vector3::from(positions[corner]));
        let jacobian = Matrix3::from_columns(&others.map(|other| other - first));
        // A mesh that has been checked has no singular Jacobian.
        let inverse = jacobian.try_inverse().unwrap_or_else(Matrix3::zeros).transpose();
        let barycentric = BARYCENTRIC_GRADIENTS.map(|d| <[f64; 3]>::from(inverse * Vector3::from(d)));
        Self::Straight { barycentric, determinant: jacobian.determinant() }
    }
}

/// A displacement field by node.
type NodalField<'a> = &'a [[Lanes; 3]];

/// Displacement fields u, and a and b of a product, by node.
struct Fields<'a> {
    u: NodalField<'a>,
    bent: Option<(NodalField<'a>, NodalField<'a>)>,
}

/// The gradients of [`Fields`] somewhere.
struct FieldGradients<T> {
    u: T,
    bent: Option<(T, T)>,
}

impl Fields<'_> {
    /// The gradients in an element, by its displacements.
    fn of_element<T>(&self, nodes: &[u32; 10], gradients: impl Fn(&Displacements) -> T) -> FieldGradients<T> {
        let of = |field: &[[Lanes; 3]]| gradients(&nodes.map(|node| field[node as usize]));
        FieldGradients { u: of(self.u), bent: self.bent.map(|(a, b)| (of(a), of(b))) }
    }
}

/// Fields (N×k), k at most [`LANES`], by node.
fn by_node(fields: MatRef<'_, f64>) -> Vec<[Lanes; 3]> {
    let of_node = |node: usize| {
        std::array::from_fn(|axis| {
            std::array::from_fn(|k| if k < fields.ncols() { fields[(3 * node + axis, k)] } else { 0.0 })
        })
    };
    (0..fields.nrows() / 3).into_par_iter().map(of_node).collect()
}

/// The same field in each lane, by node.
fn by_node_alike(field: ColRef<'_, f64>) -> Vec<[Lanes; 3]> {
    (0..field.nrows() / 3).map(|node| std::array::from_fn(|axis| [field[3 * node + axis]; LANES])).collect()
}

/// Changes each number of `list` by that of `other` in its place.
#[inline]
fn each<const N: usize>(list: &mut [Lanes; N], other: &[Lanes; N], of: impl Fn(f64, f64) -> f64) {
    for (list, other) in list.iter_mut().zip(other) {
        for lane in 0..LANES {
            list[lane] = of(list[lane], other[lane]);
        }
    }
}

/// ∇u by the gradients of the shape functions.
fn gradient(shapes: &[[f64; 3]; 10], u: &Displacements) -> Gradient {
    let mut gradient = Gradient::default();
    for (shape, of_node) in shapes.iter().zip(u).skip(1) {
        let mut relative = *of_node;
        each(&mut relative, &u[0], |u, first| u - first);
        add_product(&mut gradient, &relative, shape);
    }
    gradient
}

/// ∇u at the nodes of a straight element, where it is linear in space. At corner c it is Σ (4 u_ci − u_i − 3 u_c) ⊗ ∇L_i over the other
/// corners i, u_ci of the node on the edge between.
fn at_nodes_of_straight(barycentric: &[[f64; 3]; 4], u: &Displacements) -> [Gradient; 10] {
    let mut gradients = [Gradient::default(); 10];
    for corner in 0..4 {
        for other in (0..4).filter(|other| *other != corner) {
            let mut along = u[4 + edge_between(corner, other)];
            for (axis, along) in along.iter_mut().enumerate() {
                for (lane, along) in along.iter_mut().enumerate() {
                    let here = u[corner][axis][lane];
                    *along = 4.0 * (*along - here) - (u[other][axis][lane] - here);
                }
            }
            add_product(&mut gradients[corner], &along, &barycentric[other]);
        }
    }
    for (edge, [a, b]) in EDGES.into_iter().enumerate() {
        let mut mean = gradients[a];
        for (mean, other) in mean.iter_mut().zip(&gradients[b]) {
            each(mean, other, |a, b| 0.5 * (a + b));
        }
        gradients[4 + edge] = mean;
    }
    gradients
}

/// Adds u ⊗ g.
#[inline]
fn add_product(gradient: &mut Gradient, u: &[Lanes; 3], g: &[f64; 3]) {
    for (row, u) in gradient.iter_mut().zip(u) {
        for (entry, g) in row.iter_mut().zip(g) {
            entry.iter_mut().zip(u).for_each(|(sum, u)| *sum += u * g);
        }
    }
}

/// C:(sym(∇u) + sym(∇aᵀ∇b)).
#[inline]
fn stress(material: &Material, u: &Gradient, bent: Option<(&Gradient, &Gradient)>) -> Stress {
    let (lambda, mu) = material.lame();
    // Twice the strain.
    let mut strain = COMPONENTS.map(|(i, j)| u[i][j]);
    for (strain, (i, j)) in strain.iter_mut().zip(COMPONENTS) {
        strain.iter_mut().zip(&u[j][i]).for_each(|(sum, u)| *sum += u);
    }
    if let Some((a, b)) = bent {
        for (strain, (i, j)) in strain.iter_mut().zip(COMPONENTS) {
            for (a, b) in a.iter().zip(b) {
                (0..LANES).for_each(|lane| strain[lane] += a[i][lane] * b[j][lane] + a[j][lane] * b[i][lane]);
            }
        }
    }
    let trace: Lanes = std::array::from_fn(|lane| 0.5 * lambda * (strain[0][lane] + strain[1][lane] + strain[2][lane]));
    let mut stress = strain.map(|component| component.map(|twice| mu * twice));
    stress[..3].iter_mut().for_each(|normal| normal.iter_mut().zip(trace).for_each(|(sum, trace)| *sum += trace));
    stress
}

/// ∫ N_a N_b dV over the volume, of a straight element.
fn products_of_shapes(rule: &[RulePoint]) -> [[f64; 10]; 10] {
    let mut products = [[0.0; 10]; 10];
    let total: f64 = rule.iter().map(|rule| rule.point.weight).sum();
    for rule in rule {
        let shapes = shape_functions(rule.point.at);
        for (row, a) in products.iter_mut().zip(shapes) {
            row.iter_mut().zip(shapes).for_each(|(entry, b)| *entry += rule.point.weight / total * a * b);
        }
    }
    products
}

/// Σ P_ab σ_a:C⁻¹:σ_b of stresses at some places, P symmetric.
fn complementary_form<const N: usize>(material: &Material, products: &[[f64; N]; N], at: &[Stress; N]) -> Lanes {
    let form = |of: &[Lanes; N]| {
        let mut sum = Lanes::default();
        for (a, products) in products.iter().enumerate() {
            let mut with: Lanes = of[a].map(|value| 0.5 * products[a] * value);
            for (product, other) in products.iter().zip(&of[..a]) {
                with.iter_mut().zip(other).for_each(|(sum, other)| *sum += product * other);
            }
            (0..LANES).for_each(|lane| sum[lane] += 2.0 * of[a][lane] * with[lane]);
        }
        sum
    };
    let nu = material.poisson_ratio;
    let mut whole = Lanes::default();
    // Shear strains count twice.
    let factors = [1.0, 1.0, 1.0, 2.0, 2.0, 2.0].map(|factor| factor * (1.0 + nu));
    for (component, times) in factors.into_iter().enumerate() {
        let of = form(&std::array::from_fn(|a| at[a][component]));
        whole.iter_mut().zip(of).for_each(|(sum, of)| *sum += times * of);
    }
    let trace =
        form(&std::array::from_fn(|a| std::array::from_fn(|lane| at[a][0][lane] + at[a][1][lane] + at[a][2][lane])));
    std::array::from_fn(|lane| (whole[lane] - nu * trace[lane]) / material.young_modulus)
}
