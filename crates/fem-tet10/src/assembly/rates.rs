//! Rates of K and M with a number that the body is made with, applied to fields: Eqs. (D1)–(D4) of `docs/method/gradients.md`.
//!
//! ```text
//! material:  K'u = Σ ∫ (λ' tr ε + 2μ' ε) ∇N dV              M'u = Σ ∫ ρ' u N dV
//! mass m:    K'u = 0                                        M'u = w wᵀ u
//! shape:     K'u = Σ ∫ (σ div V − σ Lᵀ − C:sym(∇u L)) ∇N dV   M'u = Σ ∫ ρ div V u N dV,   L = ∇V
//! ```
//!
//! V is the velocity of the nodes, carried into the elements by the shape functions. So the rates are those of the matrices of this
//! mesh, not of the continuum.

use faer::{Mat, MatRef};
use nalgebra::{Matrix3, Vector3};
use rayon::prelude::*;

use crate::assembly::point_mass::PointMass;
use crate::element::deformation::{check_field, strain};
use crate::element::integration::{IntegrationPoint, Rules};
use crate::element::quadrature;
use crate::element::shape::{EDGES, shape_functions};
use crate::error::{AssemblyError, AssemblyFault};
use crate::material::{Material, Materials};
use crate::mesh::checked::Mesh;
use crate::mesh::locate::Location;

/// Elements whose forces are held at once, before they are added in their order: the sums are the same for any number of threads.
const BLOCK: usize = 1024;

/// A number that a body is made with.
#[derive(Debug, Clone, PartialEq)]
pub enum BodyNumber {
    /// Young's modulus of a physical volume, or of the whole mesh.
    YoungModulus(Option<String>),
    /// Its Poisson's ratio.
    PoissonRatio(Option<String>),
    /// Its density.
    Density(Option<String>),
    /// A point mass, by its number from 0.
    PointMass(usize),
    /// A factor, now 1, by which a physical volume, or the whole mesh, is stretched along an axis (0 to 2) from its middle. Elements
    /// beside it follow by the nodes that they share; point masses stay on their nodes.
    Stretch(Option<String>, usize),
}

/// Rates of the matrices of a body with one number.
#[derive(Debug)]
pub struct MatrixRates {
    /// Lamé's constants and density of the elements that change, and their rates.
    elements: Vec<(usize, ElementRate)>,
    /// Velocities of the nodes; none where they stay.
    velocities: Option<Vec<[f64; 3]>>,
    carried: Option<Location>,
}

/// Constants of an element's products: their rates where the material changes, the constants themselves where its shape does.
#[derive(Debug, Clone, Copy)]
struct ElementRate {
    lambda: f64,
    mu: f64,
    density: f64,
}

impl MatrixRates {
    /// The rates with a number.
    ///
    /// # Errors
    /// Materials and point masses that do not fit the mesh; a group that the mesh does not have; an element that is in two groups with
    /// materials, which could not both have it.
    pub fn new(
        mesh: &Mesh,
        materials: &Materials,
        point_masses: &[PointMass],
        number: &BodyNumber,
    ) -> Result<Self, AssemblyError> {
        let of_elements = materials.of_elements(mesh)?;
        let changed = |group: &Option<String>, rate: fn(&Material) -> ElementRate| {
            let members = members(mesh, materials, group.as_deref())?;
            let elements = members.into_iter().map(|e| (e, rate(&of_elements[e]))).collect();
            Ok(Self { elements, velocities: None, carried: None })
        };
        match number {
            BodyNumber::YoungModulus(group) => changed(group, by_young_modulus),
            BodyNumber::PoissonRatio(group) => changed(group, by_poisson_ratio),
            BodyNumber::Density(group) => changed(group, |_| ElementRate { lambda: 0.0, mu: 0.0, density: 1.0 }),
            BodyNumber::PointMass(i) => {
                let carried = point_masses.get(*i).map(|mass| mass.location(mesh)).transpose()?;
                Ok(Self { elements: Vec::new(), velocities: None, carried })
            }
            BodyNumber::Stretch(group, axis) => {
                Self::of_velocities(mesh, materials, stretch(mesh, group.as_deref(), *axis)?)
            }
        }
    }

    /// The rates where the nodes move with given velocities, such as those of [`stretch`] before it began.
    ///
    /// # Errors
    /// Materials that do not fit the mesh.
    pub fn of_velocities(mesh: &Mesh, materials: &Materials, velocities: Vec<[f64; 3]>) -> Result<Self, AssemblyError> {
        let of_elements = materials.of_elements(mesh)?;
        let moves = |e: &usize| mesh.elements()[*e].iter().any(|node| velocities[*node as usize] != [0.0; 3]);
        let constants = |e: usize| {
            let (lambda, mu) = of_elements[e].lame();
            (e, ElementRate { lambda, mu, density: of_elements[e].density })
        };
        let elements = (0..mesh.elements().len()).filter(moves).map(constants).collect();
        Ok(Self { elements, velocities: Some(velocities), carried: None })
    }

    /// Velocities of the nodes; none of a number that moves none.
    pub fn velocities(&self) -> Option<&[[f64; 3]]> {
        self.velocities.as_deref()
    }

    /// K'U and M'U (N×k each) of fields U (N×k).
    ///
    /// # Errors
    /// Fields whose rows are not the degrees of freedom, or with an entry that is not finite.
    pub fn products(&self, mesh: &Mesh, fields: MatRef<'_, f64>) -> Result<[Mat<f64>; 2], AssemblyError> {
        check_field(mesh, "fields", fields)?;
        let (rows, columns) = (fields.nrows(), fields.ncols());
        let mut sums = [(); 2].map(|()| Mat::<f64>::zeros(rows, columns));
        let (rules, shapes) = (Rules::new(), quadrature::degree_5().into_iter().map(|p| shape_functions(p.at)));
        let shapes: Vec<[f64; 10]> = shapes.collect();
        for block in self.elements.chunks(BLOCK) {
            let parts: Vec<[Vec<Vector3<f64>>; 2]> =
                block.par_iter().map(|(e, rate)| self.of_element(mesh, &rules, &shapes, *e, rate, fields)).collect();
            for ((e, _), parts) in block.iter().zip(&parts) {
                for (sum, part) in sums.iter_mut().zip(parts) {
                    for (column, part) in part.chunks_exact(10).enumerate() {
                        for (node, force) in mesh.elements()[*e].iter().zip(part) {
                            for axis in 0..3 {
                                sum[(3 * *node as usize + axis, column)] += force[axis];
                            }
                        }
                    }
                }
            }
        }
        if let Some(Location { nodes, weights }) = &self.carried {
            for column in 0..columns {
                for axis in 0..3 {
                    let row = |node: &u32| 3 * *node as usize + axis;
                    let mean: f64 = nodes.iter().zip(weights).map(|(node, w)| w * fields[(row(node), column)]).sum();
                    nodes.iter().zip(weights).for_each(|(node, w)| sums[1][(row(node), column)] += w * mean);
                }
            }
        }
        Ok(sums)
    }

    /// Forces of K' and of M' on the nodes of an element, by field, then node.
    fn of_element(
        &self,
        mesh: &Mesh,
        rules: &Rules,
        shapes: &[[f64; 10]],
        element: usize,
        rate: &ElementRate,
        fields: MatRef<'_, f64>,
    ) -> [Vec<Vector3<f64>>; 2] {
        let (nodes, positions) = (&mesh.elements()[element], mesh.element_positions(element));
        let columns = fields.ncols();
        let at = |node: u32, column: usize| Vector3::from_fn(|axis, _| fields[(3 * node as usize + axis, column)]);
        let u: Vec<[Vector3<f64>; 10]> = (0..columns).map(|column| nodes.map(|node| at(node, column))).collect();
        let mut forces = [(); 2].map(|()| vec![Vector3::zeros(); 10 * columns]);
        let velocities = self.velocities.as_ref().map(|all| nodes.map(|node| Vector3::from(all[node as usize])));
        let stress = |gradient: &Matrix3<f64>| {
            let strain = strain(gradient);
            Matrix3::from_diagonal_element(rate.lambda * strain.trace()) + strain * (2.0 * rate.mu)
        };
        let gradient_of = |u: &[Vector3<f64>; 10], point: &IntegrationPoint| -> Matrix3<f64> {
            u.iter().zip(&point.gradients).map(|(u, g)| u * Vector3::from(*g).transpose()).sum()
        };
        let fine = rules.fine_points(&positions);
        if rate.lambda != 0.0 || rate.mu != 0.0 {
            // A straight element that does not stay straight meets products of three gradients.
            let points = if velocities.is_some() { None } else { Some(rules.points(&positions)) };
            for point in points.as_ref().unwrap_or(&fine) {
                let shear = velocities.as_ref().map(|v| gradient_of(v, point));
                for (u, forces) in u.iter().zip(forces[0].chunks_exact_mut(10)) {
                    let gradient = gradient_of(u, point);
                    let mut p = stress(&gradient);
                    if let Some(l) = &shear {
                        p = p * l.trace() - p * l.transpose() - stress(&(gradient * l));
                    }
                    for (force, g) in forces.iter_mut().zip(&point.gradients) {
                        *force += p * Vector3::from(*g) * point.volume;
                    }
                }
            }
        }
        if rate.density != 0.0 {
            for (point, n) in fine.iter().zip(shapes) {
                let expansion = velocities.as_ref().map_or(1.0, |v| gradient_of(v, point).trace());
                for (u, forces) in u.iter().zip(forces[1].chunks_exact_mut(10)) {
                    let at: Vector3<f64> = u.iter().zip(n).map(|(u, n)| u * *n).sum();
                    for (force, n) in forces.iter_mut().zip(n) {
                        *force += at * (rate.density * expansion * point.volume * n);
                    }
                }
            }
        }
        forces
    }
}

/// λ and μ are proportional to E.
fn by_young_modulus(material: &Material) -> ElementRate {
    let (lambda, mu) = Material { young_modulus: 1.0, ..*material }.lame();
    ElementRate { lambda, mu, density: 0.0 }
}

/// λ = E ν/((1 + ν)(1 − 2ν)), μ = E/(2(1 + ν)).
fn by_poisson_ratio(material: &Material) -> ElementRate {
    let Material { young_modulus: e, poisson_ratio: nu, .. } = *material;
    let [shear, bulk] = [1.0 + nu, 1.0 - 2.0 * nu];
    let lambda = e * (1.0 + 2.0 * nu * nu) / (shear * bulk).powi(2);
    ElementRate { lambda, mu: -e / (2.0 * shear * shear), density: 0.0 }
}

/// Elements whose material is that of a group.
fn members(mesh: &Mesh, materials: &Materials, group: Option<&str>) -> Result<Vec<usize>, AssemblyError> {
    let Some(name) = group else { return Ok((0..mesh.elements().len()).collect()) };
    let number = number_of(mesh, name)?;
    let others = match materials {
        Materials::Uniform(_) => Vec::new(),
        Materials::ByGroup(by_name) => {
            let is_other = |other: &usize| *other != number && by_name.contains_key(&mesh.groups()[*other]);
            (0..mesh.groups().len()).filter(is_other).collect()
        }
    };
    let of_group = |e: &usize| mesh.element_groups(*e).contains(&number);
    let members: Vec<usize> = (0..mesh.elements().len()).filter(of_group).collect();
    for e in &members {
        if let Some(other) = mesh.element_groups(*e).iter().find(|group| others.contains(group)) {
            let groups = [name.to_owned(), mesh.groups()[*other].clone()];
            return Err(AssemblyFault::TwoMaterials { element: mesh.element_tags()[*e], groups }.of(mesh.source()));
        }
    }
    Ok(members)
}

fn number_of(mesh: &Mesh, name: &str) -> Result<usize, AssemblyError> {
    mesh.groups().iter().position(|known| known == name).ok_or_else(|| {
        AssemblyFault::MissingGroup { group: name.to_owned(), present: mesh.groups().to_vec() }.of(mesh.source())
    })
}

/// Velocities of the nodes where a group, or the whole mesh, is stretched along an axis (0 to 2) from its middle. A node in the middle of an
/// edge of another element goes with its ends, so that straight edges stay straight.
///
/// # Errors
/// A group that the mesh does not have.
pub fn stretch(mesh: &Mesh, group: Option<&str>, axis: usize) -> Result<Vec<[f64; 3]>, AssemblyError> {
    let number = group.map(|name| number_of(mesh, name)).transpose()?;
    let is_member = |e: usize| number.is_none_or(|number| mesh.element_groups(e).contains(&number));
    let mut of_group = vec![false; mesh.positions().len()];
    let elements = || mesh.elements().iter().enumerate();
    for (_, nodes) in elements().filter(|(e, _)| is_member(*e)) {
        nodes.iter().for_each(|node| of_group[*node as usize] = true);
    }
    let places = || mesh.positions().iter().zip(&of_group).filter(|(_, is_in)| **is_in).map(|(x, _)| x[axis]);
    let (low, high) = (places().fold(f64::INFINITY, f64::min), places().fold(f64::NEG_INFINITY, f64::max));
    let middle = 0.5 * (low + high);
    let mut velocities = vec![[0.0; 3]; mesh.positions().len()];
    for ((v, x), _) in velocities.iter_mut().zip(mesh.positions()).zip(&of_group).filter(|(_, is_in)| **is_in) {
        v[axis] = x[axis] - middle;
    }
    for (_, nodes) in elements().filter(|(e, _)| !is_member(*e)) {
        for ([a, b], between) in EDGES.iter().zip(&nodes[4..]).filter(|(_, node)| !of_group[**node as usize]) {
            let [a, b] = [nodes[*a], nodes[*b]].map(|node| velocities[node as usize][axis]);
            velocities[*between as usize][axis] = 0.5 * (a + b);
        }
    }
    Ok(velocities)
}
