//! The shortest program: a scene, its model, and the rows of its motion.

use std::error::Error;

use flexframe::model::Model;
use flexframe::scene::Body;

fn main() -> Result<(), Box<dyn Error>> {
    let body = Body::read("examples/plate.toml")?;
    let model = Model::build(&body, |_progress| ())?;
    for now in model.start(&body)? {
        let now = now?;
        println!("{} {:?} {}", now.time, now.omega_body, now.energy());
    }
    Ok(())
}
