//! Real bodies for the tests, each solved once: the paper's plate, and a notched ring with curved elements.

use std::sync::{Arc, OnceLock};

use dynamics::{History, Initial, Method, PointForce, PointShapes, SharedLoad};
use fem_tet10::{Material, Materials, Matrices, Mesh, PointMass, assemble, read_msh};
use modal::{Modes, Solver, Support};
use nalgebra::Vector3;
use reduced_body::ReducedBody;

/// All schemes.
pub const METHODS: [Method; 4] = [frames_rk4::PAPER, frames_rk4::LIMIT, Method::RKMK4, Method::EXPONENTIAL];

/// A body from its mesh to its modes.
pub struct Specimen {
    pub mesh: Mesh,
    pub matrices: Matrices,
    pub modes: Modes,
    pub body: ReducedBody,
    /// R, P, Q in the mesh's frame, at nodes.
    pub reference_points: [[f64; 3]; 3],
}

/// The plate of the paper with its eight point masses and ten flexible modes.
pub fn plate() -> &'static Specimen {
    static PLATE: OnceLock<Specimen> = OnceLock::new();
    PLATE.get_or_init(|| plate_of("plate", 10))
}

/// The plate on another mesh, or with another number of modes.
pub fn plate_of(mesh: &str, flexible: usize) -> Specimen {
    let corners = [-500.0, 500.0]
        .into_iter()
        .flat_map(|x| [-25.0, 25.0].map(|y| (x, y)))
        .flat_map(|(x, y)| [0.0, 10.0].map(|z| [x, y, z]));
    let masses: Vec<PointMass> = corners.map(|at| PointMass { at, mass: 0.001, spread: None }).collect();
    let reference_points = [[-500.0, -25.0, 0.0], [500.0, -25.0, 0.0], [500.0, 25.0, 0.0]];
    Specimen::solve(mesh, &masses, reference_points, flexible)
}

/// A ring with a notch and ten flexible modes; one plane of symmetry, y = 0.
pub fn ring() -> &'static Specimen {
    static RING: OnceLock<Specimen> = OnceLock::new();
    RING.get_or_init(|| {
        let near = [[-100.0, 0.0, 0.0], [95.0, 30.0, 20.0], [0.0, -80.0, 20.0]];
        let mut specimen = Specimen::solve("ring", &[], near, 10);
        specimen.reference_points = near.map(|at| specimen.mesh.positions()[specimen.nearest_node(at)]);
        specimen
    })
}

impl Specimen {
    fn solve(mesh: &str, masses: &[PointMass], reference_points: [[f64; 3]; 3], flexible: usize) -> Self {
        let path = format!("{}/../../meshes/{mesh}.msh", env!("CARGO_MANIFEST_DIR"));
        let mesh = read_msh(&path).unwrap();
        let material = Material { young_modulus: 70_000.0, poisson_ratio: 0.33, density: 2.7e-9 };
        let matrices = assemble(&mesh, &Materials::Uniform(material), masses).unwrap();
        let (k, m) = (matrices.stiffness(), matrices.mass());
        let modes = Solver::new(k, m, mesh.positions(), &Support::free()).unwrap().modes(flexible, |_| ()).unwrap();
        let body = modes.reduced(m, mesh.positions()).unwrap();
        Self { mesh, matrices, modes, body, reference_points }
    }

    /// The same body with its first `flexible` modes only.
    pub fn truncated(&self, flexible: usize) -> Self {
        let modes = self.modes.truncated(flexible);
        let body = modes.reduced(self.matrices.mass(), self.mesh.positions()).unwrap();
        Self { mesh: self.mesh.clone(), matrices: self.matrices.clone(), modes, body, ..*self }
    }

    pub fn nearest_node(&self, at: [f64; 3]) -> usize {
        let distance = |x: &[f64; 3]| (Vector3::from(*x) - Vector3::from(at)).norm();
        let positions = self.mesh.positions();
        (0..positions.len()).min_by(|i, j| distance(&positions[*i]).total_cmp(&distance(&positions[*j]))).unwrap()
    }

    pub fn point(&self, at: [f64; 3]) -> PointShapes {
        let location = self.mesh.locate(at).unwrap();
        let point = self.modes.point(self.mesh.positions(), &location.nodes, &location.weights).unwrap();
        PointShapes::new(&self.body, &point)
    }

    /// R, P, Q from the centre of mass.
    pub fn reference_points_body(&self) -> [Vector3<f64>; 3] {
        self.reference_points.map(|x| Vector3::from(x) - self.body.center_of_mass)
    }

    /// A dead half-sine that begins at zero.
    pub fn half_sine(&self, at: [f64; 3], force_global: [f64; 3], duration: f64) -> SharedLoad {
        self.pulse(at, force_global, 0.0, duration)
    }

    /// A dead half-sine from `start` on.
    pub fn pulse(&self, at: [f64; 3], force_global: [f64; 3], start: f64, duration: f64) -> SharedLoad {
        dead_force(self.point(at), force_global.into(), History::HalfSine { start, duration })
    }

    /// No motion but a spin.
    pub fn spinning(&self, omega: Vector3<f64>) -> Initial {
        Initial { omega, ..Initial::at_rest(self.body.flexible()) }
    }
}

/// A dead force.
pub fn dead_force(point: PointShapes, force: Vector3<f64>, history: History) -> SharedLoad {
    Arc::new(PointForce::dead(point, force, history))
}
