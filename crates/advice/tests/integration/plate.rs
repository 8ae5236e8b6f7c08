//! The plate of the paper, solved once, with the stiffness that spinning gives it.

use std::sync::{Arc, OnceLock};

use advice::Case;
use dynamics::{
    EffectMap, History, Initial, Manifold, Method, Observation, Physics, PointForce, PointShapes, Rows, Setup,
    SharedLoad, Simulation, StepControl,
};
use faer::Mat;
use fem_tet10::{Material, Materials, Mesh, PointMass, assemble, read_msh, reduced_geometric_stiffness};
use modal::{Modes, Solver, Support, centrifugal_fields};
use nalgebra::Vector3;
use reduced_body::{LargeCoordinates, LargeProducts, ReducedBody, RigidMotion};

pub struct Plate {
    mesh: Mesh,
    modes: Modes,
    pub body: ReducedBody,
    pub peaks: Vec<f64>,
    pub length: f64,
    /// Static response to a unit force along z at the corner, in its own direction.
    pub corner_compliance: f64,
}

pub const CORNER: [f64; 3] = [500.0, 25.0, 10.0];

pub fn plate() -> &'static Plate {
    static PLATE: OnceLock<Plate> = OnceLock::new();
    PLATE.get_or_init(|| Plate::new(|_| Support::free()))
}

/// The same plate, clamped at one end.
pub fn clamped() -> &'static Plate {
    static PLATE: OnceLock<Plate> = OnceLock::new();
    PLATE.get_or_init(|| {
        Plate::new(|positions| {
            let held = (0..).zip(positions).filter(|(_, x)| x[0] < -499.9).map(|(node, _)| node).collect();
            Support::new(RigidMotion::clamp(Vector3::new(-500.0, 0.0, 5.0)), held)
        })
    })
}

impl Plate {
    fn new(support: impl Fn(&[[f64; 3]]) -> Support) -> Self {
        let corners = [-500.0, 500.0]
            .into_iter()
            .flat_map(|x| [-25.0, 25.0].map(|y| (x, y)))
            .flat_map(|(x, y)| [0.0, 10.0].map(|z| [x, y, z]));
        let masses: Vec<PointMass> = corners.map(|at| PointMass { at, mass: 0.001, spread: None }).collect();
        let mesh = read_msh(format!("{}/../../meshes/plate.msh", env!("CARGO_MANIFEST_DIR"))).unwrap();
        let material = Materials::Uniform(Material { young_modulus: 70_000.0, poisson_ratio: 0.33, density: 2.7e-9 });
        let matrices = assemble(&mesh, &material, &masses).unwrap();
        let (k, m) = (matrices.stiffness(), matrices.mass());
        let solver = Solver::new(k, m, mesh.positions(), &support(mesh.positions())).unwrap();
        let modes = solver.modes(10, |_| ()).unwrap();
        let body = modes.reduced(m, mesh.positions()).unwrap();
        let fields = centrifugal_fields(solver.mass(), mesh.positions(), &body.origin).unwrap();
        let answers = solver.static_response(fields.as_ref()).unwrap();
        let reduced = reduced_geometric_stiffness(&mesh, &material, answers.as_ref(), modes.shapes.as_ref()).unwrap();
        let body = body.with_stress_stiffness(Some(reduced.try_into().unwrap())).unwrap();
        let nodes = mesh.positions().len();
        let peak = |k: usize| {
            let at = |node: usize| Vector3::from_fn(|axis, _| modes.shapes[(3 * node + axis, k)]).norm();
            (0..nodes).map(at).fold(0.0, f64::max)
        };
        let place = mesh.locate(CORNER).unwrap();
        let mut force = faer::Mat::zeros(3 * nodes, 1);
        for (node, weight) in place.nodes.iter().zip(&place.weights) {
            force[(3 * *node as usize + 2, 0)] = *weight;
        }
        let answer = solver.static_response(force.as_ref()).unwrap();
        let corner_compliance = (force.transpose() * &answer)[(0, 0)];
        Plate { peaks: (0..10).map(peak).collect(), length: 1001.3, corner_compliance, mesh, modes, body }
    }

    /// A manifold of large modes without any term beyond the linear ones.
    pub fn manifold(&self, large: &[usize]) -> Manifold {
        let products = LargeProducts { large: large.len(), following: 0 };
        let coordinates = LargeCoordinates {
            dynamic: 10,
            large: large.to_vec(),
            following: Vec::new(),
            coefficients: Mat::zeros(10, products.of_displacement().len()),
        };
        Manifold::new(self.body.clone(), coordinates, &vec![0.0; products.of_energy().len()]).unwrap()
    }

    pub fn force(&self, at: [f64; 3], force: [f64; 3], history: History) -> SharedLoad {
        let place = self.mesh.locate(at).unwrap();
        let point = self.modes.point(self.mesh.positions(), &place.nodes, &place.weights).unwrap();
        Arc::new(PointForce::dead(PointShapes::new(&self.body, &point), force.into(), history))
    }

    pub fn case<'a>(&'a self, damping: &'a [f64], loads: &'a [SharedLoad], initial: &'a Initial, end: f64) -> Case<'a> {
        Case {
            body: &self.body,
            damping_ratios: damping,
            loads,
            is_gravity: &[],
            drive: None,
            initial,
            end,
            length: self.length,
            length_unit: "mm",
            peaks: &self.peaks,
            static_compliances: &[],
            centrifugal_remainders: &[],
            drive_remainder: None,
            backbones: &[],
            manifold: None,
            coupling: None,
        }
    }
}

pub fn spinning(omega: [f64; 3]) -> Initial {
    Initial { omega: omega.into(), ..Initial::at_rest(10) }
}

/// 200 rows of the motion.
pub fn run(case: &Case, effects: EffectMap<bool>) -> Vec<Observation> {
    let physics = Physics { effects, drive: case.drive.cloned(), ..Physics::default() };
    let simulation = Simulation::new(&Setup {
        body: case.body,
        damping_ratios: case.damping_ratios,
        loads: case.loads,
        physics: &physics,
        initial: case.initial,
        method: &Method::EXPONENTIAL,
        control: StepControl::Fixed(1e-4),
        end: case.end,
        rows: Rows::Interval(case.end / 200.0),
        points: &[],
    })
    .unwrap();
    simulation.map(Result::unwrap).collect()
}
