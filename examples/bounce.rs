//! A body falls, meets a plane with a corner, and is thrown back: an event, the state, and a new state.
//!
//! The corner of a ring that falls from rest, without turning, from the height h reaches the plane at √(2h/g). The event
//! is found to the accuracy of the scheme. Then the velocity is turned round, and the corner is back at its height after
//! the same time again, where its velocity is zero.

use std::error::Error;

use flexframe::dynamics::{
    Crossing, Event, History, Observation, PointForce, PointShapes, Reached, Rows, Simulation, StepControl,
};
use flexframe::nalgebra::{Matrix3, Vector3};
use flexframe::reduced_body::{BodyPoint, ReducedBody, RigidMotion};

/// Result of the example.
pub struct Answer {
    /// Time of the impact, and √(2h/g).
    pub impact: [f64; 2],
    /// Time at which the body is at its height again, and twice that.
    pub back: [f64; 2],
}

const HEIGHT: f64 = 1.5;
const GRAVITY: f64 = 9.81;

/// Runs the example.
pub fn run() -> Result<Answer, Box<dyn Error>> {
    let inertia = Matrix3::from_diagonal(&Vector3::new(0.2, 0.3, 0.4));
    let body = ReducedBody::rigid(2.0, Vector3::zeros(), inertia, RigidMotion::free())?;
    let at = |position: Vector3<f64>| PointShapes::new(&body, &BodyPoint::rigid(position));
    let weight = Vector3::new(0.0, 0.0, -GRAVITY * body.mass);
    let mut simulation = Simulation::builder(&body, StepControl::Fixed(0.01), 3.0)
        .load(PointForce::dead(at(Vector3::zeros()), weight, History::Constant))
        .point(at(Vector3::new(0.3, 0.1, -0.2)))
        .rows(Rows::Interval(3.0))
        .build()?;
    let impact =
        simulation.add_event(Event::new("the corner is on the plane", Crossing::Falling, |now: &Observation| {
            now.points[0].displacement.z + HEIGHT
        }))?;
    let top =
        simulation.add_event(Event::new("at rest", Crossing::Falling, |now: &Observation| now.velocity_global.z))?;

    let mut times = [0.0; 2];
    loop {
        match simulation.advance(u64::MAX)? {
            Reached::Event(event) if event == impact => {
                times[0] = simulation.time();
                let mut state = simulation.states()?.remove(0);
                state.velocity_global = -state.velocity_global;
                simulation.set_states(&[state])?;
            }
            Reached::Event(event) if event == top => {
                times[1] = simulation.time();
                break;
            }
            Reached::End => break,
            _ => {}
        }
    }
    let fall = (2.0 * HEIGHT / GRAVITY).sqrt();
    Ok(Answer { impact: [times[0], fall], back: [times[1], 2.0 * fall] })
}

#[allow(dead_code)] // a test runs the example as a module
fn main() -> Result<(), Box<dyn Error>> {
    let Answer { impact, back } = run()?;
    println!("on the plane at {:.12}, in closed form {:.12}", impact[0], impact[1]);
    println!("back at its height at {:.12}, in closed form {:.12}", back[0], back[1]);
    Ok(())
}
