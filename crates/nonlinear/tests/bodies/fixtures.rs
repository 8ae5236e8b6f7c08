//! Bodies of the meshes of `crates/verification/meshes`, SI.

use std::borrow::Cow;
use std::path::Path;
use std::sync::Arc;

use fem_tet10::{Material, Materials, Mesh, assemble, read_msh};
use modal::faer::Mat;
use modal::{NodalMass, NodalStiffness, Solver, Support};
use nalgebra::Vector3;
use nonlinear::FullBody;
use reduced_body::RigidMotion;

/// A slender column of 1 × 0.025 × 0.025 along x.
pub const COLUMN: Material = Material { young_modulus: 7e7, poisson_ratio: 0.0, density: 1000.0 };
pub const COLUMN_BENDING: f64 = COLUMN.young_modulus * 0.025 * 0.025 * 0.025 * 0.025 / 12.0;
/// An L of legs 1 and 0.6.
pub const L: Material = Material { young_modulus: 1e7, poisson_ratio: 0.3, density: 1000.0 };

pub fn mesh(name: &str) -> Mesh {
    read_msh(Path::new(env!("CARGO_MANIFEST_DIR")).join("../verification/meshes").join(format!("{name}.msh"))).unwrap()
}

/// The column clamped at its root.
pub fn column() -> FullBody<'static> {
    let mesh = mesh("column");
    let root = nodes(&mesh, |x| x.x < 1e-9);
    body(mesh, COLUMN, &Support::new(RigidMotion::clamp(Vector3::zeros()), root))
}

pub fn body(mesh: Mesh, material: Material, support: &Support) -> FullBody<'static> {
    let materials = Materials::Uniform(material);
    let matrices = assemble(&mesh, &materials, &[]).unwrap();
    FullBody::new(Arc::new(mesh), &materials, Cow::Owned(matrices), support).unwrap()
}

pub fn nodes(mesh: &Mesh, is_there: impl Fn(Vector3<f64>) -> bool) -> Vec<u32> {
    (0..).zip(mesh.positions()).filter(|(_, x)| is_there(Vector3::from(**x))).map(|(node, _)| node).collect()
}

/// The node at a point.
pub fn node(mesh: &Mesh, at: [f64; 3]) -> usize {
    nodes(mesh, |x| (x - Vector3::from(at)).norm() < 1e-9)[0] as usize
}

/// Circular frequencies and shapes of the first flexible modes.
pub fn modes(body: &FullBody<'_>, support: &Support, count: usize) -> (Vec<f64>, Mat<f64>) {
    let matrices = body.matrices();
    let (start, nodes) = (matrices.start(), matrices.nodes());
    let stiffness = NodalStiffness::new(start, nodes, matrices.stiffness_by_nodes()).unwrap();
    let mass = NodalMass::of_nodes(start, nodes, matrices.mass_by_nodes()).unwrap();
    let solver = Solver::of_nodes(stiffness, mass, body.mesh().positions(), support).unwrap();
    let modes = solver.modes(count, |_| ()).unwrap();
    (modes.eigenvalues.iter().map(|value| value.sqrt()).collect(), modes.shapes)
}

/// Forces on one node.
pub fn force(body: &FullBody<'_>, node: usize, force: [f64; 3]) -> Vec<f64> {
    let mut forces = vec![0.0; body.dofs()];
    forces[3 * node..3 * node + 3].copy_from_slice(&force);
    forces
}
