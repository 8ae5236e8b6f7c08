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
use flexframe::scene::Body;

use crate::program::root;

/// The scene `examples/<name>.toml`.
fn scene(name: &str) -> Body {
    Body::read(root().join("examples").join(name).with_extension("toml")).unwrap()
}

fn build(body: &Body) -> Model {
    Model::build(body, |_| ()).unwrap()
}

/// All rows of a scene's run, the first at t = 0.
fn rows(model: &Model, body: &Body) -> Vec<Observation> {
    model.start(body).unwrap().map(Result::unwrap).collect()
}
