//! Every scene of `examples/` that shows a number, run through the library, against that number.

mod beams;
mod boom;
mod effects;
mod energy;
mod nafems;
mod pendulum;
mod spin;
mod stress;
mod top;

use flexframe::dynamics::Observation;
use flexframe::model::Model;
use flexframe::scene::Scene;

use crate::program::root;

/// The scene `examples/<name>.toml`.
fn scene(name: &str) -> Scene {
    Scene::read(root().join("examples").join(name).with_extension("toml")).unwrap()
}

fn build(scene: &Scene) -> Model {
    Model::build(scene, |_| ()).unwrap()
}

/// All rows of a scene's run, the first at t = 0.
fn rows(model: &Model, scene: &Scene) -> Vec<Observation> {
    model.start(scene).unwrap().map(Result::unwrap).collect()
}
