//! Time of a step of a chain of flexible bodies in ball joints, for each body: `cargo bench -p dynamics --bench chain`.
//!
//! The paper's plates with ten modes hang in a row from the ground and swing; steps are fixed. The time is that of the loop
//! alone on one core, the shortest of several runs.

#[allow(dead_code)]
#[path = "../tests/common/mod.rs"]
mod common;

use std::time::Instant;

use dynamics::{ConservativeBody, Joint, Marker, MotionState, Physics, RotationShapes, System, SystemMotion};
use nalgebra::{Matrix3, Vector3};
use rigid_kin::Attitude;

const STEPS: u32 = 200;
const STEP: f64 = 1e-3;
const RUNS: usize = 5;

fn main() {
    println!("{:>8}{:>22}{:>22}", "bodies", "µs a body and step", "evaluations a step");
    for bodies in [1, 3, 10, 20, 100, 300] {
        let start = chain(bodies);
        let mut best = f64::INFINITY;
        let mut evaluations = 0.0;
        for _ in 0..RUNS {
            let mut motion = start.clone();
            let before = motion.evaluations();
            let started = Instant::now();
            for step in 1..=STEPS {
                motion.try_step(STEP, f64::from(step) * STEP, 1e-7, f64::INFINITY).expect("the step is short");
            }
            best = best.min(started.elapsed().as_secs_f64());
            evaluations = (motion.evaluations() - before) as f64 / f64::from(STEPS);
        }
        let each = 1e6 * best / f64::from(STEPS) / bodies as f64;
        println!("{bodies:>8}{each:>22.2}{evaluations:>22.1}");
    }
}

/// Plates of 1 m in a row.
fn chain(bodies: usize) -> SystemMotion {
    let plate = common::plate();
    let point = |x: f64| plate.point([x, 0.0, 5.0]);
    // Balls hold no rotation.
    let turning = RotationShapes::new(&plate.body, faer::Mat::zeros(3, 10).as_ref());
    let axes = Matrix3::identity();
    let end = |body: usize, x: f64| Marker::on_flexible(body, &point(x), &turning, axes);
    let body =
        ConservativeBody::new(&plate.body, &[0.01; 10], Vec::new(), &Physics::default()).expect("the plate moves");
    let first = end(0, -500.0);
    let ground = Marker::on_ground(Vector3::new(-500.0, 0.0, 5.0), axes);
    let mut joints = vec![Joint::spherical("ground", [ground, first])];
    joints.extend((1..bodies).map(|body| Joint::spherical("between", [end(body - 1, 500.0), end(body, -500.0)])));
    let center = plate.body.center_of_mass;
    let states: Vec<MotionState> = (0..bodies)
        .map(|body| MotionState {
            time: 0.0,
            attitude: Attitude::identity(),
            origin_global: center + Vector3::new(1000.0 * body as f64, 0.0, 0.0),
            velocity_global: Vector3::zeros(),
            omega_body: Vector3::new(0.0, 0.0, if body % 2 == 0 { 1.0 } else { -1.0 }),
            modal_displacement: vec![0.0; 10],
            modal_velocity: vec![0.0; 10],
        })
        .collect();
    let system = System::new(vec![body; bodies], joints).expect("the markers fit");
    let mut motion = SystemMotion::new(system, &states).expect("the states fit");
    motion.assemble().expect("the chain closes");
    motion
}
