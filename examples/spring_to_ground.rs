//! A spring from a point of a rigid body to the ground, and a thrust that follows the attitude: laws as closures.
//!
//! A body of mass m on a spring k through its centre swings with the period 2π√(m/k). A thrust T along the axis that a
//! body spins about with Ω moves it as T t²/2m; across that axis it only makes it circle: T/(mΩ²) (1 − cos Ωt).

use std::error::Error;

use flexframe::dynamics::{Initial, Load, LoadFn, Observation, PointShapes, Rows, Simulation, StepControl};
use flexframe::nalgebra::{Matrix3, Vector3};
use flexframe::reduced_body::{BodyPoint, ReducedBody, RigidMotion};

const MASS: f64 = 2.0;

/// Result of the example.
pub struct Answer {
    /// Deflection of the spring after one period over that at the start.
    pub after_a_period: f64,
    /// Energy of the body plus that of the spring after the run, over that at the start.
    pub energy: f64,
    /// Where the thrust has taken the body across the spin, and in closed form.
    pub circled: [f64; 2],
}

/// Runs the example.
pub fn run() -> Result<Answer, Box<dyn Error>> {
    let inertia = Matrix3::from_diagonal(&Vector3::new(0.2, 0.3, 0.4));
    let body = ReducedBody::rigid(MASS, Vector3::zeros(), inertia, RigidMotion::free())?;
    let center = PointShapes::new(&body, &BodyPoint::rigid(Vector3::zeros()));
    let (stiffness, amplitude) = (50.0, 0.1);
    let anchor = Vector3::new(-amplitude, 0.0, 0.0);

    let point = center.clone();
    let spring = LoadFn::new("spring to ground", move |motion, applied| {
        let stretch: Vector3<f64> = motion.position_global(&point) - anchor;
        applied.force(&point, &(motion.body_from_global * stretch * -stiffness));
    });
    let period = std::f64::consts::TAU * (MASS / stiffness).sqrt();
    let [first, last] = ends(&body, spring, Initial::at_rest(0), period)?;
    let deflection = |now: &Observation| (now.position_global - anchor).x;
    let energy = |now: &Observation| now.energy() + 0.5 * stiffness * deflection(now).powi(2);

    let thrust = LoadFn::new("thrust across the spin", move |_, applied| {
        applied.force(&center, &Vector3::new(3.0, 0.0, 0.0));
    });
    let (spin, end) = (2.0_f64, 1.0);
    let spinning = Initial { omega: Vector3::new(0.0, 0.0, spin), ..Initial::at_rest(0) };
    let [_, thrown] = ends(&body, thrust, spinning, end)?;
    let circled = 3.0 / (MASS * spin * spin) * (1.0 - (spin * end).cos());
    Ok(Answer {
        after_a_period: deflection(&last) / deflection(&first),
        energy: energy(&last) / energy(&first),
        circled: [thrown.position_global.x, circled],
    })
}

/// Beginning and end of a run.
fn ends(body: &ReducedBody, load: impl Load, initial: Initial, end: f64) -> Result<[Observation; 2], Box<dyn Error>> {
    let mut simulation = Simulation::builder(body, StepControl::Fixed(1e-3), end)
        .load(load)
        .initial(initial)
        .rows(Rows::Interval(end))
        .build()?;
    let first = simulation.observation()?;
    Ok([first, simulation.last().ok_or("the run has no rows")??])
}

#[allow(dead_code)] // a test runs the example as a module
fn main() -> Result<(), Box<dyn Error>> {
    let Answer { after_a_period, energy, circled } = run()?;
    println!("after a period the spring is at {after_a_period:?} of its first stretch, the energy at {energy:?}");
    println!("the thrust has taken the body to {:?}, in closed form {:?}", circled[0], circled[1]);
    Ok(())
}
