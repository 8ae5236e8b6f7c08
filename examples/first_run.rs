//! The shortest program: a scene, its model, and the rows of its motion.

use std::error::Error;

use flexframe::model::Model;
use flexframe::scene::Scene;

fn main() -> Result<(), Box<dyn Error>> {
    let scene = Scene::read("examples/plate.toml")?;
    let model = Model::build(&scene, |_progress| ())?;
    for now in model.start(&scene)? {
        let now = now?;
        println!("{} {:?} {}", now.time, now.omega_body, now.energy());
    }
    Ok(())
}
