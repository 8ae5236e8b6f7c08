//! Flexible bodies in joints.

use std::sync::{Arc, OnceLock};

use crate::mechanism::at_rest;
use dynamics::{
    ConservativeBody, History, Initial, Joint, JointDrive, Marker, MotionState, Observation, Physics, PointForce,
    PointShapes, RotationShapes, Rows, SecondOrder, SharedLoad, Simulation, StepControl, System, SystemMotion, Table,
};
use fem_tet10::{Material, Materials, Mesh, Patch, assemble, read_msh, reduced_geometric_stiffness};
use modal::{Modes, Solver, StaticAccuracy, Support};
use nalgebra::{Matrix3, Vector3};
use reduced_body::{ReducedBody, RigidMotion};
use rigid_kin::Attitude;

/// A free body of a mesh with some natural modes and six static shapes for each patch, and the shapes of the patches.
pub struct Jointed {
    pub body: ReducedBody,
    pub patches: Vec<(PointShapes, RotationShapes)>,
    /// Displacement and rotation of second order of each patch.
    pub second_orders: Vec<[SecondOrder; 2]>,
    mesh: Mesh,
    modes: Modes,
}

impl Jointed {
    pub fn new(mesh: &str, material: Material, natural: usize, patches: &[&str]) -> Self {
        let mesh = read_msh(format!("{}/../../meshes/{mesh}.msh", env!("CARGO_MANIFEST_DIR"))).unwrap();
        let matrices = assemble(&mesh, &Materials::Uniform(material), &[]).unwrap();
        let (k, m, x) = (matrices.stiffness(), matrices.mass(), mesh.positions());
        let solver = Solver::new(k, m, x, &Support::free()).unwrap();
        let mut modes = solver.modes(natural, |_| ()).unwrap();
        let patches: Vec<Patch> = patches.iter().map(|group| mesh.surface_patch(group).unwrap()).collect();
        let mut responses = Vec::new();
        for patch in &patches {
            let forces = patch.forces(x.len());
            responses.push(solver.static_response_from(&modes, forces.as_ref(), StaticAccuracy::Full).unwrap());
            modes = solver.with_static_shapes(modes, responses[responses.len() - 1].as_ref()).unwrap();
        }
        let body = modes.reduced(m, x).unwrap();
        let second_orders = responses.iter().map(|responses| {
            let shapes = modes.shapes.as_ref();
            let materials = Materials::Uniform(material);
            let found = reduced_geometric_stiffness(&mesh, &materials, responses.as_ref(), shapes).unwrap();
            let axes = [Vector3::x(), Vector3::y(), Vector3::z()];
            [0, 3]
                .map(|first| SecondOrder::new(axes.into_iter().zip(found[first..].iter().cloned()).collect()).unwrap())
        });
        let second_orders = second_orders.collect();
        let patches = patches
            .iter()
            .map(|patch| {
                let point = modes.point(x, &patch.nodes, &patch.weights).unwrap();
                let turning = RotationShapes::new(&body, patch.rotations(modes.shapes.as_ref()).as_ref());
                (PointShapes::new(&body, &point), turning)
            })
            .collect();
        Self { body, patches, second_orders, mesh, modes }
    }

    /// A point of the body, at a place of its mesh.
    fn point(&self, at: [f64; 3]) -> PointShapes {
        let location = self.mesh.locate(at).unwrap();
        let point = self.modes.point(self.mesh.positions(), &location.nodes, &location.weights).unwrap();
        PointShapes::new(&self.body, &point)
    }

    pub fn marker(&self, number: usize, patch: usize) -> Marker {
        self.turned_marker(number, patch, Matrix3::identity())
    }

    pub fn turned_marker(&self, number: usize, patch: usize, axes: Matrix3<f64>) -> Marker {
        let (point, turning) = &self.patches[patch];
        Marker::on_flexible(number, point, turning, axes)
    }

    /// The marker of a patch whose forces stiffen the body.
    pub fn stiffening_marker(&self, number: usize, patch: usize) -> Marker {
        self.turned_stiffening_marker(number, patch, Matrix3::identity())
    }

    pub fn turned_stiffening_marker(&self, number: usize, patch: usize, axes: Matrix3<f64>) -> Marker {
        let ((point, turning), [of_point, of_turning]) = (&self.patches[patch], &self.second_orders[patch]);
        let point = point.clone().with_second_order(of_point.clone());
        let turning = turning.clone().with_second_order(of_turning.clone());
        Marker::on_flexible(number, &point, &turning, axes)
    }

    pub fn conservative(&self) -> ConservativeBody {
        self.loaded(Vec::new())
    }

    fn loaded(&self, loads: Vec<SharedLoad>) -> ConservativeBody {
        self.damped(0.0, loads)
    }

    pub fn damped(&self, ratio: f64, loads: Vec<SharedLoad>) -> ConservativeBody {
        let ratios = vec![ratio; self.body.circular_frequencies.len()];
        ConservativeBody::new(&self.body, &ratios, loads, &Physics::default()).unwrap()
    }

    pub fn at_rest(&self, origin: Vector3<f64>, attitude: Attitude) -> MotionState {
        let flexible = self.body.circular_frequencies.len();
        MotionState {
            time: 0.0,
            attitude,
            origin_global: origin,
            velocity_global: Vector3::zeros(),
            omega_body: Vector3::zeros(),
            modal_displacement: vec![0.0; flexible],
            modal_velocity: vec![0.0; flexible],
        }
    }
}

pub fn rod() -> &'static Jointed {
    static ROD: OnceLock<Jointed> = OnceLock::new();
    let steel = Material { young_modulus: 200e9, poisson_ratio: 0.3, density: 7870.0 };
    ROD.get_or_init(|| Jointed::new("crank_rod", steel, 6, &["crank", "slider"]))
}

/// Independent reference: φ₂ and x₃ at 0.1 s of the plane beam in the flexible slider-crank of Simeon (1998): a rod
/// of 300×8×8 mm, a crank of 0.15 m at 150 rad/s, a slider of 0.075552 kg.
#[test]
fn the_slider_crank_ends_where_others_have_it() {
    let (rod, radius, length, end) = (rod(), 0.15, 0.3, 0.1);
    let inertia = Matrix3::from_diagonal_element(1e-5);
    let rigid = |mass: f64| ReducedBody::rigid(mass, Vector3::zeros(), inertia, RigidMotion::free()).unwrap();
    let [crank, slider] = [0.36, 0.075_552].map(rigid);
    let of_rigid = |body| ConservativeBody::new(body, &[], Vec::new(), &Physics::default()).unwrap();
    let bodies = vec![of_rigid(&crank), rod.conservative(), of_rigid(&slider)];
    let speed = History::Table(Table::new(vec![0.0, 1.0], vec![0.0, 150.0]).unwrap());
    let along = |marker: fn(Vector3<f64>) -> Marker, x: f64| marker(Vector3::new(x, 0.0, 0.0));
    let on_ground: fn(Vector3<f64>) -> Marker = |at| Marker::on_ground(at, Matrix3::identity());
    // The z axis of a slide is along x.
    let slide = Matrix3::new(0.0, 0.0, 1.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0);
    let joints = vec![
        Joint::revolute(
            "crank",
            [along(on_ground, 0.0), Marker::on_rigid(0, -Vector3::x() * 0.5 * radius, Matrix3::identity())],
        )
        .turned_by(JointDrive { amplitude: 1.0, history: speed }),
        Joint::revolute(
            "pin",
            [Marker::on_rigid(0, Vector3::x() * 0.5 * radius, Matrix3::identity()), rod.marker(1, 0)],
        ),
        Joint::revolute("piston", [rod.marker(1, 1), Marker::on_rigid(2, Vector3::zeros(), Matrix3::identity())]),
        Joint::prismatic(
            "guide",
            [Marker::on_ground(Vector3::zeros(), slide), Marker::on_rigid(2, Vector3::zeros(), slide)],
        ),
    ];
    let still = Attitude::identity();
    let state = |mass_at: f64| at_rest(Vector3::new(mass_at, 0.0, 0.0));
    let spin = Vector3::new(0.0, 0.0, 150.0);
    let crank =
        MotionState { velocity_global: Vector3::y() * 150.0 * 0.5 * radius, omega_body: spin, ..state(0.5 * radius) };
    let turning = -150.0 * radius / length;
    let middle = MotionState {
        velocity_global: Vector3::y() * 0.5 * 150.0 * radius,
        omega_body: Vector3::new(0.0, 0.0, turning),
        ..rod.at_rest(Vector3::new(radius + 0.5 * length, 0.0, 0.0), still)
    };
    let system = System::new(bodies, joints).unwrap();
    let mut start = SystemMotion::new(system, &[crank, middle, state(radius + length)]).unwrap();
    let [residual, rate] = start.relax().unwrap();
    assert!(residual < 1e-14 && rate < 1e-12, "{residual:e} {rate:e}");
    // The test set's consistent start has the slider 1.69330e-5 further out than the undeformed rod.
    let first = start.state(2).unwrap().origin_global.x;
    assert!((first - 0.450_016_933_0).abs() < 2e-9, "{first}");
    for (tolerance, balance_bound) in [(1e-3, 0.1), (1e-4, 0.02), (1e-6, 0.01)] {
        let mut motion = start.clone();
        let energy = motion.energy().unwrap();
        let steps = motion.advance(end, tolerance, &mut 1e-5).unwrap();
        let crank = motion.state(0).unwrap();
        let pin = crank.origin_global + crank.attitude.to_global(&(Vector3::x() * 0.5 * radius));
        let slider = motion.state(2).unwrap().origin_global;
        let angle = (slider.y - pin.y).atan2(slider.x - pin.x);
        let balance = motion.energy().unwrap() - energy - motion.drive_work();
        println!(
            "{tolerance:e}: {steps} steps, {} evaluations, angle {angle}, slider {}, balance {balance:e} of {energy}",
            motion.evaluations(),
            slider.x,
        );
        // A solid in space is not the reference's plane beam: 3e-7 are left at any tolerance.
        assert!((angle + 0.331_173_498_825_626).abs() < 1e-6, "{angle}");
        assert!((slider.x - 0.169_737_332_842_786).abs() < 1e-6, "{slider}");
        assert!(balance.abs() < balance_bound, "{balance:e}");
        assert_eq!(motion.dependent_rows(), 0);
    }
}

/// Independent reference: the whole bar, by the exponential scheme and without joints, against its two halves welded face to face. It
/// tumbles and is struck at one end.
#[test]
fn two_welded_halves_move_as_the_whole() {
    let aluminium = Material { young_modulus: 70_000.0, poisson_ratio: 0.33, density: 2.7e-9 };
    let (omega, end) = (Vector3::new(3.0, 8.0, 5.0), 0.02);
    let strike = |point: PointShapes| -> SharedLoad {
        let history = History::HalfSine { start: 0.0, duration: 2e-3 };
        Arc::new(PointForce::dead(point, Vector3::new(0.0, 30.0, 50.0), history))
    };
    let whole = Jointed::new("slender_bar", aluminium, 12, &[]);
    let initial = Initial { omega, ..Initial::at_rest(12) };
    let mut simulation = Simulation::builder(&whole.body, StepControl::Tolerance(1e-6), end)
        .loads([strike(whole.point([0.0; 3]))])
        .initial(initial)
        .point(whole.point([0.0; 3]))
        .point(whole.point([400.0, 0.0, 0.0]))
        .rows(Rows::Interval(end))
        .build()
        .unwrap();
    let expected = simulation.by_ref().last().unwrap().unwrap();
    let bent = expected.points.iter().map(|point| point.elastic_displacement_body.norm()).fold(0.0, f64::max);

    let [left, right] = ["right", "left"].map(|patch| Jointed::new("half_bar", aluminium, 8, &[patch]));
    let weld = Joint::fixed("weld", [left.marker(0, 0), right.marker(1, 0)]);
    let bodies = vec![left.loaded(vec![strike(left.point([0.0; 3]))]), right.conservative()];
    let system = System::new(bodies, vec![weld]).unwrap();
    let start = |x: f64, body: &Jointed| MotionState {
        velocity_global: omega.cross(&Vector3::new(x, 0.0, 0.0)),
        omega_body: omega,
        ..body.at_rest(Vector3::new(200.0 + x, 0.0, 0.0), Attitude::identity())
    };
    let mut motion = SystemMotion::new(system, &[start(-100.0, &left), start(100.0, &right)]).unwrap();
    motion.assemble().unwrap();
    // Steps end where the strike does.
    let mut steps = motion.advance(2e-3, 1e-6, &mut 1e-5).unwrap();
    steps += motion.advance(end, 1e-6, &mut 1e-4).unwrap();
    motion.find_reactions().unwrap();
    for (body, half, at, number) in [(0, &left, 0.0, 0), (1, &right, 200.0, 1)] {
        let mut out = Observation::new(half.body.circular_frequencies.len(), 1);
        motion.observe(body, &[half.point([at, 0.0, 0.0])], &mut out).unwrap();
        let (found, expected) = (&out.points[0], &expected.points[number]);
        let [error, speed] =
            [found.displacement - expected.displacement, found.velocity - expected.velocity].map(|x| x.norm());
        println!(
            "end {number}: {steps} steps, off by {error:e} of {bent:e}, velocity by {speed:e} of {:e}",
            expected.velocity.norm()
        );
        assert!(error < 0.02 * bent, "{error:e} {bent:e}");
        assert!(speed < 0.03 * expected.velocity.norm(), "{speed:e}");
    }
}
