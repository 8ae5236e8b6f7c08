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

use std::path::PathBuf;

use flexframe::dynamics::Observation;
use flexframe::model::Model;
use flexframe::scene::Scene;

fn repository() -> PathBuf {
    PathBuf::from(concat!(env!("CARGO_MANIFEST_DIR"), "/../.."))
}

/// The scene `examples/<name>.toml`.
fn scene(name: &str) -> Scene {
    Scene::read(repository().join("examples").join(name).with_extension("toml")).unwrap()
}

fn build(scene: &Scene) -> Model {
    Model::build(scene, |_| ()).unwrap()
}

/// All rows of a scene's run, the first at t = 0.
fn rows(model: &Model, scene: &Scene) -> Vec<Observation> {
    model.start(scene).unwrap().map(Result::unwrap).collect()
}
