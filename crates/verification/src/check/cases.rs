//! Bodies under loads and spins that bend them by known parts of their length.

use fem_tet10::Material;

/// A body under a load or a spin.
#[derive(Debug, Clone)]
pub struct CheckedCase {
    /// Its name.
    pub name: String,
    /// Its mesh.
    pub mesh: &'static str,
    /// Its material.
    pub material: Material,
    /// Supports, drives and loads. `SPIN` stands for a spin of `parameter` of the first frequency, `FORCE` for a force
    /// that would bend a linear body by about that part of a metre.
    pub text: String,
    /// The part that `SPIN`, `FORCE` and `GRAVITY` stand for,
    pub parameter: f64,
    /// each times its own.
    pub parts: [f64; 3],
    /// The point that is compared.
    pub tip: [f64; 3],
    /// A free body that spins by itself about the axis z.
    pub spins: bool,
    /// Where the truth comes from.
    pub truth: Truth,
}

/// The full body that a model is compared with.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Truth {
    /// Its rest under the loads and the spin, from the undeformed body.
    Rest,
    /// Rest under the accelerations of the row, by the iteration of the check to its end: a drive that speeds up leaves no rest.
    OfRow,
}

/// Names and scene keys of the models: without stiffening, with stiffening by stress, with large modes.
pub const MODELS: [(&str, &str, &str); 3] = [
    ("linear", "", "geometric_stiffening = false\nlarge_deflection = false\n"),
    ("stress", "", "geometric_stiffening = true\nlarge_deflection = false\n"),
    ("large modes", "large = 2\n", "geometric_stiffening = true\nlarge_deflection = true\n"),
];

pub(super) const SOFT: Material = Material { young_modulus: 7e7, poisson_ratio: 0.3, density: 1000.0 };

/// Held at its root.
const CLAMP: &str = "[[constraints]]\nkind = \"clamp\"\ngroup = \"root\"\n";
/// Turned about the axis z through its root.
const SPIN: &str = "[[constraints]]\nkind = \"hinge\"\nat = [0.0, 0.0, 0.0]\naxis = [0.0, 0.0, 1.0]\ngroup = \"root\"\n\
                    [constraints.motion]\namplitude = SPIN\nhistory = { kind = \"constant\" }\n";

fn force(at: [f64; 3], direction: [f64; 3]) -> String {
    format!(
        "[[loads]]\nkind = \"force\"\nat = {at:?}\ndirection = {direction:?}\namplitude = FORCE\n\
         history = {{ kind = \"constant\" }}\n"
    )
}

/// All cases.
pub fn cases() -> Vec<CheckedCase> {
    let mut cases = Vec::new();
    let mut add = |name: &str, mesh, text: String, tip, spins, parameters: &[f64]| {
        for parameter in parameters {
            let (name, text, parameter) = (name.to_owned(), text.clone(), *parameter);
            let parts = [1.0, 1.0, 0.6];
            cases.push(CheckedCase {
                name,
                mesh,
                material: SOFT,
                text,
                parameter,
                parts,
                tip,
                spins,
                truth: Truth::Rest,
            });
        }
    };
    let end = [1.0, 0.0, 0.0];
    let forces = [0.02, 0.1, 0.3, 0.6];
    let across = format!("{CLAMP}{}", force(end, [0.0, 0.0, 1.0]));
    add("column, force across its end", "column", across, end, false, &forces);
    let drawn = format!("{CLAMP}{}", force(end, [0.96, 0.0, 0.28]));
    add("column, force along and across its end", "column", drawn, end, false, &[0.1, 0.6, 2.0]);
    let tip = [1.0, 0.0, 0.05];
    add("coned bar, spin", "coned", SPIN.to_owned(), tip, false, &[0.3, 1.0, 2.0, 3.0]);
    let (sine, cosine) = (0.5, 0.75_f64.sqrt());
    let tip = [2.0 * sine, 2.0 - 2.0 * cosine, 0.0];
    add("30° blade, spin", "blade", SPIN.to_owned(), tip, false, &[0.25, 0.5, 1.0, 2.0]);
    let tip = [1.0, 0.0, 1.0];
    add("quarter arc, spin", "arc", SPIN.to_owned(), tip, false, &[0.25, 0.5, 1.0]);
    let inwards = format!("{CLAMP}{}", force(tip, [0.0, 0.0, -1.0]));
    add("quarter arc, force in its plane", "arc", inwards, tip, false, &[0.02, 0.1, 0.3]);
    let aside = format!("{CLAMP}{}", force(tip, [0.0, 1.0, 0.0]));
    add("quarter arc, force across its plane", "arc", aside, tip, false, &[0.02, 0.1, 0.3]);
    let hanging = format!(
        "{CLAMP}[[loads]]\nkind = \"gravity\"\ndirection = [0.0, 0.0, -1.0]\namplitude = GRAVITY\n\
         history = {{ kind = \"constant\" }}\n"
    );
    add("30° blade, gravity across it", "blade", hanging, [2.0 * sine, 2.0 - 2.0 * cosine, 0.0], false, &[0.05, 0.3]);
    add("free L, its own spin", "l", String::new(), [1.0, 0.0, 0.05], true, &[0.1, 0.2, 0.3]);
    cases
}
