//! Bodies made in code: rigid ones, and point masses joined by springs.

use dynamics::{Initial, PointShapes};
use faer::sparse::{SparseColMat, Triplet};
use modal::{Modes, Solver, Support};
use nalgebra::{Matrix3, Vector3};
use reduced_body::{Constants, ReducedBody, RigidMotion};

/// A rigid body of mass 1 with these principal moments.
pub fn rigid(moments: [f64; 3]) -> Result<ReducedBody, String> {
    let inertia = Matrix3::from_diagonal(&moments.into());
    ReducedBody::rigid(1.0, Vector3::zeros(), inertia, RigidMotion::free()).map_err(|e| e.to_string())
}

/// An elastic body with its mode shapes.
#[derive(Debug)]
pub struct ElasticBody {
    /// Its constants.
    pub body: ReducedBody,
    /// Its modes.
    pub modes: Modes,
    /// Its nodes.
    pub positions: Vec<[f64; 3]>,
}

impl ElasticBody {
    /// A node as a point.
    pub fn point(&self, node: u32) -> PointShapes {
        let point = self.modes.point(&self.positions, &[node], &[1.0]).expect("a node of the body");
        PointShapes::new(&self.body, &point)
    }

    /// From stiffness and mass.
    pub fn solve(
        stiffness: faer::sparse::SparseColMatRef<'_, usize, f64>,
        mass: faer::sparse::SparseColMatRef<'_, usize, f64>,
        positions: Vec<[f64; 3]>,
        flexible: usize,
    ) -> Result<Self, String> {
        let solver = Solver::new(stiffness, mass, &positions, &Support::free()).map_err(|e| e.to_string())?;
        let modes = solver.modes(flexible, |_| ()).map_err(|e| e.to_string())?;
        let body = modes.reduced(mass, &positions).map_err(|e| e.to_string())?;
        Ok(Self { body, modes, positions })
    }
}

/// A body with other constants, which fit together as before.
pub fn changed(body: &ReducedBody, change: impl FnOnce(&mut Constants)) -> ReducedBody {
    let mut constants = (**body).clone();
    change(&mut constants);
    ReducedBody::from_constants(constants).expect("constants that fit together")
}

/// Point masses, each joined to each other by a spring of the same stiffness: small, elastic in every direction, and
/// with all constants of a body from a mesh.
pub fn truss(nodes: &[([f64; 3], f64)], spring: f64, flexible: usize) -> Result<ElasticBody, String> {
    let n = nodes.len();
    let mut blocks = vec![Matrix3::zeros(); n * n];
    for i in 0..n {
        for j in 0..i {
            let along = (Vector3::from(nodes[i].0) - Vector3::from(nodes[j].0)).normalize();
            let block = along * along.transpose() * spring;
            for (row, column, sign) in [(i, i, 1.0), (j, j, 1.0), (i, j, -1.0), (j, i, -1.0)] {
                blocks[row * n + column] += block * sign;
            }
        }
    }
    let stiffness: Vec<_> = (0..3 * n)
        .flat_map(|r| (0..3 * n).map(move |c| (r, c)))
        .map(|(r, c)| Triplet::new(r, c, blocks[r / 3 * n + c / 3][(r % 3, c % 3)]))
        .collect();
    let mass: Vec<_> = (0..3 * n).map(|r| Triplet::new(r, r, nodes[r / 3].1)).collect();
    let matrix = |entries: &[Triplet<usize, usize, f64>]| {
        SparseColMat::try_new_from_triplets(3 * n, 3 * n, entries).map_err(|e| format!("{e:?}"))
    };
    let positions = nodes.iter().map(|node| node.0).collect();
    ElasticBody::solve(matrix(&stiffness)?.as_ref(), matrix(&mass)?.as_ref(), positions, flexible)
}

/// Six unequal masses, no two principal moments alike, of size 1.
pub const CLUSTER: [([f64; 3], f64); 6] = [
    ([0.9, 0.1, 0.0], 0.3),
    ([-1.1, 0.05, 0.1], 0.25),
    ([0.1, 0.7, -0.05], 0.2),
    ([0.0, -0.8, 0.1], 0.22),
    ([0.15, 0.1, 0.4], 0.15),
    ([-0.1, 0.05, -0.45], 0.18),
];

/// The body of [`CLUSTER`] in its softest `flexible` modes, from about 20 to 60 rad per time.
pub fn cluster(flexible: usize) -> Result<ElasticBody, String> {
    truss(&CLUSTER, 60.0, flexible)
}

/// A spin with some vibration: every modal velocity is `vibration`.
pub fn spinning(body: &ReducedBody, omega: [f64; 3], vibration: f64) -> Initial {
    let nf = body.flexible();
    Initial { omega: omega.into(), modal_velocity: vec![vibration; nf], ..Initial::at_rest(nf) }
}
