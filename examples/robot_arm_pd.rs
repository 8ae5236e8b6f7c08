//! A robot arm of two links that follows a path by a PD controller in each joint: laws at joints as closures.
//!
//! With the angles a of the shoulder and b of the elbow, links of length l, mass m and moment of inertia J about their centres, and
//! φ₁ = a, φ₂ = a + b:
//!
//! ```text
//! (J + 5/4 m l²) φ₁'' + ½ m l² cos(b) φ₂'' − ½ m l² sin(b) φ₂'² + 3/2 m g l cos φ₁ = τ₁ − τ₂
//! (J + 1/4 m l²) φ₂'' + ½ m l² cos(b) φ₁'' + ½ m l² sin(b) φ₁'² + 1/2 m g l cos φ₂ = τ₂
//! τ = k_p (r(t) − x) + k_d (r'(t) − x'),      r(t) = ½ r_T (1 − cos πt/T) up to T
//! ```
//!
//! Nothing of this is written below: bodies, hinges and controllers say it.

use std::error::Error;
use std::f64::consts::PI;
use std::sync::Arc;

use flexframe::dynamics::{
    ConservativeBody, Coordinate, History, Joint, JointLawFn, Marker, MotionState, Physics, PointForce, PointShapes,
    Reached, Rows, Simulation, Start, StepControl, System, SystemScheme, SystemSetup,
};
use flexframe::nalgebra::{Matrix3, Vector3};
use flexframe::reduced_body::{BodyPoint, ReducedBody, RigidMotion};
use flexframe::rigid_kin::Attitude;

/// Length of a link, m.
pub const LENGTH: f64 = 0.5;
/// Mass of a link, kg.
pub const MASS: f64 = 4.0;
/// Its moment of inertia about its centre, kg m².
pub const INERTIA: f64 = MASS * LENGTH * LENGTH / 12.0;
/// Gains of the shoulder and of the elbow: moment per angle, and per rate.
pub const GAINS: [[f64; 2]; 2] = [[400.0, 40.0], [150.0, 12.0]];
/// Angles that they are to reach, rad.
pub const TARGETS: [f64; 2] = [1.0, -0.7];
/// Time at which they are to be there, s.
pub const ARRIVAL: f64 = 0.6;
/// End of the run, s.
pub const END: f64 = 1.0;

/// A path to a target, and its rate.
pub fn path(target: f64, time: f64) -> [f64; 2] {
    if time >= ARRIVAL {
        return [target, 0.0];
    }
    let phase = PI * time / ARRIVAL;
    [0.5 * target * (1.0 - phase.cos()), 0.5 * target * PI / ARRIVAL * phase.sin()]
}

/// A row of the motion; pairs are of the shoulder and the elbow.
pub struct ArmRow {
    /// s
    pub time: f64,
    /// rad
    pub angles: [f64; 2],
    /// rad/s
    pub rates: [f64; 2],
    /// Power of the controllers, W.
    pub power: [f64; 2],
}

/// Result of the example.
pub struct Answer {
    /// The motion.
    pub rows: Vec<ArmRow>,
    /// Energy of the links at the end less the work of gravity and of the controllers, over the latter.
    pub open: f64,
    /// Steps taken.
    pub steps: u64,
}

/// Runs the example.
pub fn run() -> Result<Answer, Box<dyn Error>> {
    let inertia = Matrix3::from_diagonal(&Vector3::new(1e-3, INERTIA, INERTIA));
    let link = ReducedBody::rigid(MASS, Vector3::zeros(), inertia, RigidMotion::free())?;
    let center = PointShapes::new(&link, &BodyPoint::rigid(Vector3::zeros()));
    let weight = PointForce::dead(center, -9.81 * MASS * Vector3::y(), History::Constant);
    let link = ConservativeBody::new(&link, &[], vec![Arc::new(weight)], &Physics::default())?;

    let axes = Matrix3::identity();
    let end = |body: usize, side: f64| Marker::on_rigid(body, 0.5 * side * LENGTH * Vector3::x(), axes);
    let joints = vec![
        Joint::revolute("shoulder", [Marker::on_ground(Vector3::zeros(), axes), end(0, -1.0)]),
        Joint::revolute("elbow", [end(0, 1.0), end(1, -1.0)]),
    ];
    let mut system = System::new(vec![link.clone(), link], joints)?;
    for (joint, ([proportional, derivative], target)) in GAINS.into_iter().zip(TARGETS).enumerate() {
        let controller = JointLawFn::new("PD", move |time, angle, rate| {
            let [wanted, wanted_rate] = path(target, time);
            proportional * (wanted - angle) + derivative * (wanted_rate - rate)
        });
        let controller = controller.with_discontinuities(vec![ARRIVAL]);
        system = system.with_law(joint, Coordinate::Turn, Arc::new(controller))?;
    }
    let at = |x: f64| MotionState {
        time: 0.0,
        attitude: Attitude::identity(),
        origin_global: x * LENGTH * Vector3::x(),
        velocity_global: Vector3::zeros(),
        omega_body: Vector3::zeros(),
        modal_displacement: Vec::new(),
        modal_velocity: Vec::new(),
    };
    let mut simulation = Simulation::of_system(SystemSetup {
        system,
        states: vec![at(0.5), at(1.5)],
        start: Start::AsPlaced,
        scheme: SystemScheme::Radau,
        control: StepControl::Tolerance(1e-8),
        end: END,
        rows: Rows::Interval(0.05),
        points: vec![Vec::new(), Vec::new()],
    })?;
    let mut rows = Vec::new();
    loop {
        let now = simulation.system_observation()?;
        let of = |of: fn(&flexframe::dynamics::JointObservation) -> f64| [0, 1].map(|joint| of(&now.joints[joint]));
        rows.push(ArmRow {
            time: now.time,
            angles: of(|joint| joint.coordinates.turn),
            rates: of(|joint| joint.coordinates.turn_rate),
            power: of(|joint| joint.drive_power),
        });
        if simulation.is_over() {
            let balance: f64 = now.bodies.iter().map(|body| body.energy_balance()).sum();
            let work: f64 = now.joints.iter().map(|joint| joint.work.drive).sum();
            return Ok(Answer { rows, open: balance.abs() / work, steps: simulation.stats().accepted });
        }
        while simulation.advance(u64::MAX)? != Reached::Row {}
    }
}

#[allow(dead_code)] // the tests call `run` themselves
fn main() -> Result<(), Box<dyn Error>> {
    let Answer { rows, open, steps } = run()?;
    println!("time s   shoulder   wanted     elbow     wanted    power W");
    for ArmRow { time, angles: [a, b], power, .. } in &rows {
        let [wanted_a, wanted_b] = TARGETS.map(|target| path(target, *time)[0]);
        println!("{time:6.2}  {a:9.5}  {wanted_a:9.5} {b:9.5}  {wanted_b:9.5}  {:8.2}", power[0] + power[1]);
    }
    println!("{steps} steps; the energy is open by {open:.1e} of the work of the controllers");
    Ok(())
}
