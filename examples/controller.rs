//! A controller outside of the library damps the paper's plate from the measured velocity of its tip.
//!
//! The law is a load like any other: the force −c v at the tip, v being the velocity of the tip less that of the centre
//! of mass. The balance of energy knows its work: kinetic + strain energy − work + dissipation stays what it was.

use std::error::Error;
use std::sync::Arc;

use flexframe::dynamics::{
    Initial, LoadFn, Method, Observation, Physics, Rows, Setup, SharedLoad, Simulation, StepControl,
};
use flexframe::model::Model;
use flexframe::nalgebra::Vector3;
use flexframe::scene::Body;

/// Result of the example.
pub struct Answer {
    /// Strain energy at the end over that of the same run without the controller.
    pub strain_energy_left: f64,
    /// Change of energy − work + dissipation, relative to the energy at the start.
    pub balance: f64,
}

/// Runs the example.
pub fn run() -> Result<Answer, Box<dyn Error>> {
    let body = Body::read(concat!(env!("CARGO_MANIFEST_DIR"), "/../../examples/plate.toml"))?;
    let model = Model::build(&body, |_| ())?;
    let tip = model.points[0].1.clone();
    let gain = 0.2;
    let controller: SharedLoad = Arc::new(LoadFn::new("tip damper", move |motion, applied| {
        let velocity: Vector3<f64> = motion.velocity_global(&tip) - motion.origin_velocity_global;
        applied.force(&tip, &(motion.body_from_global * velocity * -gain));
    }));

    // A blow has set the plate vibrating in its first bending mode.
    let mut initial = Initial::at_rest(model.body.flexible());
    initial.modal_velocity[0] = 20.0;
    let last = |loads: &[SharedLoad]| -> Result<[Observation; 2], Box<dyn Error>> {
        let mut simulation = Simulation::new(&Setup {
            body: &model.body,
            damping_ratios: &vec![0.0; model.body.flexible()],
            loads,
            physics: &Physics::default(),
            initial: &initial,
            method: &Method::EXPONENTIAL,
            control: StepControl::Fixed(1e-5),
            end: 0.2,
            rows: Rows::Interval(0.2),
            points: &[],
        })?;
        let first = simulation.observation()?;
        let last = simulation.last().ok_or("the run has no rows")??;
        Ok([first, last])
    };
    let [_, free] = last(&[])?;
    let [first, damped] = last(&[controller])?;
    Ok(Answer {
        strain_energy_left: damped.energy() / free.energy(),
        balance: (damped.energy_balance() - first.energy_balance()).abs() / first.energy(),
    })
}

#[allow(dead_code)] // a test runs the example as a module
fn main() -> Result<(), Box<dyn Error>> {
    let Answer { strain_energy_left, balance } = run()?;
    println!("energy left by the controller: {:?} of the free vibration's", strain_energy_left);
    println!("energy and work balance to {balance:.1e}");
    Ok(())
}
