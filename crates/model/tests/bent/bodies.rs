//! The bodies, and the check of a model at rest by the full body.

use std::path::Path;

use model::{Builder, Checker, Model, StateCheck};
use nonlinear::StateErrorSettings;
use scene::Body;

/// A body of a mesh of the verification in SI, clamped at its root.
#[derive(Clone, Copy)]
pub struct Solid {
    pub mesh: &'static str,
    pub tip: [f64; 3],
    /// Axis of the spin through the origin.
    pub axis: [f64; 3],
}

pub const CONED: Solid = Solid { mesh: "rod", tip: [1.0, 0.0, 0.0], axis: [0.05, 0.0, 0.998749] };
pub const BLADE: Solid = Solid { mesh: "swept_blade", tip: [0.0, 0.917722, 0.289357], axis: [1.0, 0.0, 0.0] };
pub const ARC: Solid = Solid { mesh: "quarter_arc", tip: [0.0, 0.8, 0.8], axis: [1.0, 0.0, 0.0] };
pub const BRACKET: Solid = Solid { mesh: "bracket", tip: [0.6, 0.5, 0.0], axis: [0.0, 0.0, 1.0] };

pub const CLAMP: &str = "[[constraints]]\nkind = \"clamp\"\ngroup = \"root\"\n";

impl Solid {
    pub fn parse(&self, modes: &str, rest: &str) -> Result<Body, String> {
        let Self { mesh, tip, .. } = self;
        let text = format!(
            "title = \"Bent\"\nunits = {{ length = \"m\", mass = \"kg\", time = \"s\" }}\n[body]\n\
             mesh = \"meshes/{mesh}.msh\"\n\
             material = {{ young_modulus = 2e9, poisson_ratio = 0.3, density = 1000.0 }}\n\
             [modes]\nflexible = 8\nstatic_correction = true\n{modes}\n[effects]\nrefuse = false\n{rest}\n\
             [output.points]\ntip = {tip:?}\n[time]\nend = 1.0\nstep = 1e-4\n"
        );
        let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../verification/scene.toml");
        Body::parse(&text, path).map_err(|error| error.to_string())
    }

    pub fn scene(&self, modes: &str, rest: &str) -> Body {
        self.parse(modes, rest).unwrap_or_else(|error| panic!("{error}"))
    }

    /// Its first circular frequency at rest.
    pub fn first(&self) -> f64 {
        built(&self.scene("", CLAMP)).body.circular_frequencies[0]
    }

    /// A hinge at its root that is driven at a speed.
    pub fn driven(&self, spin: f64) -> String {
        let axis = self.axis;
        format!(
            "[[constraints]]\nkind = \"hinge\"\nat = [0.0, 0.0, 0.0]\naxis = {axis:?}\ngroup = \"root\"\n\
             motion = {{ amplitude = {spin:e}, history = {{ kind = \"constant\" }} }}\n"
        )
    }

    /// A multiple of a dead force at its tip.
    pub fn force(&self, force: [f64; 3], times: f64, history: &str) -> String {
        let size = force.iter().map(|f| f * f).sum::<f64>().sqrt();
        let (tip, direction, amplitude) = (self.tip, force.map(|f| f / size), size * times);
        format!(
            "[[loads]]\nkind = \"force\"\nat = {tip:?}\ndirection = {direction:?}\namplitude = {amplitude:e}\n\
             history = {history}\n"
        )
    }
}

/// A history that does not change.
pub const CONSTANT: &str = "{ kind = \"constant\" }";

pub fn built(body: &Body) -> Model {
    Model::build(body, |_| ()).unwrap_or_else(|error| panic!("{error}"))
}

/// The rest of a model, checked by the full body.
pub fn checked(body: &Body, settings: &StateErrorSettings) -> (Model, StateCheck) {
    let model = built(body);
    let motion = model.rest(body).unwrap();
    let full = Builder::default().full(body, |_| ()).unwrap().unwrap();
    let full_body = full.body().unwrap();
    let checker = Checker::new(&full, body, &model, &full_body).unwrap();
    let check = checker.check(&motion, &[], settings, true).unwrap();
    (model, check)
}
