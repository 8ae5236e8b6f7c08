//! Rates of frequencies, effective masses and static answers with the numbers of a scene.

use model::{BodyRates, Builder, Parameter, ParameterRates, RatesOf, VariedBody};
use scene::Body;

use crate::{CLAMPED, MASS, bar, close};

const TIME: &str = "end = 1e-3\nstep = 1e-5";
const LOADS: &str = "[[loads]]\nkind = \"gravity\"\ndirection = [0.0, 0.3, -1.0]\namplitude = 9810.0\n\
                     [[loads]]\nkind = \"pressure\"\ngroup = \"top\"\namplitude = 0.01\n";

/// The bar with two point masses, its root held and its tip propped, so that bending along y and along z are apart.
fn loaded() -> Body {
    let held = "[[constraints]]\nkind = \"support\"\ngroup = \"root\"\ndirections = [\"x\", \"y\", \"z\"]\n\
                [[constraints]]\nkind = \"support\"\ngroup = \"tip\"\ndirections = [\"y\"]\n";
    let scene = bar("flexible = 5", &format!("{held}{LOADS}"), TIME);
    let masses =
        "point_masses = [{ at = [200.0, 0.0, 0.0], mass = 1e-5 }, { at = [100.0, 3.0, 2.0], mass = 2e-5 }]\n[modes]";
    Body::parse(&scene.text_alone.replace("[modes]", masses), &scene.path).unwrap()
}

fn varied(body: &Body) -> VariedBody {
    Builder::default().varied(body, |_| ()).unwrap_or_else(|error| panic!("{error}"))
}

/// Numbers of a report that have rates, in a fixed order.
fn numbers(found: &BodyRates) -> Vec<f64> {
    let masses = found.effective_masses.iter().flatten().flatten();
    let statics = found.statics.iter().flatten().flatten().flat_map(|u| u.iter());
    found.frequencies.iter().chain(masses).chain(statics).copied().collect()
}

fn rates(found: &ParameterRates) -> Vec<f64> {
    let masses = found.effective_masses.iter().flatten().flatten();
    let statics = found.statics.iter().flatten().flatten().flatten().flat_map(|u| u.iter());
    found.frequencies.iter().chain(masses).chain(statics).copied().collect()
}

/// Independent reference: central differences of fourth order of a body that is solved anew; what they leave is their own error, of 1e-10
/// of the numbers over a step of 2e-3 of the parameter.
#[test]
fn rates_are_central_differences_of_the_body_solved_anew() {
    const STEP: f64 = 2e-3;
    let varied = varied(&loaded());
    let parameters = Parameter::all(varied.scene()).unwrap();
    let names: Vec<&str> = parameters.iter().map(|parameter| parameter.name.as_str()).collect();
    let material = ["young_modulus", "poisson_ratio", "density"].map(|name| format!("body.material.{name}"));
    let masses = ["body.point_masses[0].mass", "body.point_masses[1].mass"];
    assert_eq!(names, material.iter().map(String::as_str).chain(masses).collect::<Vec<_>>());
    let found = varied.rates(varied.body(), &parameters, RatesOf::All).unwrap();
    let scale = numbers(&found);
    assert_eq!(scale.len(), 5 + 15 + 2 * 3 * 3);
    for (parameter, of_parameter) in parameters.iter().zip(&found.rates) {
        let value = parameter.value(varied.body());
        let [a, b, c, d] = [-2.0, -1.0, 1.0, 2.0].map(|k| {
            let mut body = varied.body().clone();
            parameter.set(&mut body, value * (1.0 + k * STEP));
            numbers(&varied.rates(&body, &[], RatesOf::All).unwrap())
        });
        for (i, rate) in rates(of_parameter).into_iter().enumerate() {
            let difference = (a[i] - d[i] + 8.0 * (c[i] - b[i])) / (12.0 * STEP);
            let size = if i < 5 {
                scale[i]
            } else if i < 20 {
                MASS
            } else {
                scale[20..].iter().map(|u| u.abs()).fold(0.0, f64::max)
            };
            let off = (value * rate - difference).abs() / size;
            assert!(off < 1e-6, "{} {i}: {} {difference}: {off:e}", parameter.name, value * rate);
        }
    }
}

/// Closed form: f ∝ √(E/ρ) without point masses, u ∝ 1/E under any load and ∝ ρ under weight.
#[test]
fn logarithmic_rates_of_a_bar_of_one_material_are_halves_and_ones() {
    let varied = varied(&bar("flexible = 4", &format!("{CLAMPED}{LOADS}"), TIME));
    let names = ["body.material.young_modulus".to_owned(), "body.material.density".to_owned()];
    let parameters = Parameter::named(varied.scene(), &names).unwrap();
    let found = varied.rates(varied.body(), &parameters, RatesOf::All).unwrap();
    let statics = found.statics.as_ref().unwrap();
    for (parameter, (power, of_weight, of_pressure)) in parameters.iter().zip([(0.5, -1.0, -1.0), (-0.5, 1.0, 0.0)]) {
        let value = parameter.value(varied.body());
        let i = parameters.iter().position(|other| other == parameter).unwrap();
        let rates = &found.rates[i];
        for (rate, frequency) in rates.frequencies.iter().zip(&found.frequencies) {
            close(value * rate / frequency, power, 1e-9);
        }
        for (load, power) in [of_weight, of_pressure].into_iter().enumerate() {
            let of_load = rates.statics.as_ref().unwrap()[load].as_ref().unwrap();
            // The tip.
            let (rate, u) = (of_load.last().unwrap(), statics[load].last().unwrap());
            assert!((value * rate - u * power).norm() < 1e-8 * u.norm(), "{} {load}: {rate} {u}", parameter.name);
        }
    }
}

/// Closed form: m f²  stays for a mass on a spring, so f ∝ m^−½ where the tip mass is far more than the bar.
#[test]
fn a_heavy_tip_makes_the_bar_a_spring() {
    let body = loaded();
    let text = body
        .text_alone
        .replace("mass = 1e-5", "mass = 1.0")
        .replace("[100.0, 3.0, 2.0], mass = 2e-5", "[100.0, 0.0, 0.0], mass = 1e-9");
    let varied = varied(&Body::parse(&text, &body.path).unwrap());
    let parameters = Parameter::named(varied.scene(), &["body.point_masses[0].mass".to_owned()]).unwrap();
    let found = varied.rates(varied.body(), &parameters, RatesOf::Frequencies).unwrap();
    for k in 0..2 {
        // The bar's 5.4e-5 counts by a quarter.
        let power = found.rates[0].frequencies[k] / found.frequencies[k];
        assert!((power + 0.5).abs() < 1e-4, "{power}");
    }
}

/// Closed form: f ∝ t of a thin beam that bends in the direction of its thickness t, and does not change across it. A solid bar of 20
/// times its thickness falls short by shear, 0.3 %.
#[test]
fn bending_goes_with_the_thickness() {
    let varied = varied(&bar("flexible = 2", CLAMPED, TIME));
    let parameters =
        Parameter::named(varied.scene(), &["thickness.z".to_owned(), "thickness.bar.y".to_owned()]).unwrap();
    let found = varied.rates(varied.body(), &parameters, RatesOf::Frequencies).unwrap();
    for rates in &found.rates {
        // The two are alike but for the mesh, which mixes their directions: their sum is that of one mode of each.
        let powers: f64 = (0..2).map(|k| rates.frequencies[k] / found.frequencies[k]).sum();
        assert!((powers - 1.0).abs() < 1e-2, "{powers}");
    }
}

#[test]
fn what_has_no_rates_is_refused_at_its_key() {
    let body = bar("flexible = 2", "", TIME);
    let unknown = Parameter::named(&body, &["body.material.colour".to_owned()]).unwrap_err().to_string();
    assert!(unknown.contains("body.material.colour") && unknown.contains("body.material.density"), "{unknown}");
    let twice = Parameter::named(&body, &["thickness.z".to_owned(), "thickness.z".to_owned()]).unwrap_err();
    assert!(twice.to_string().contains("twice"), "{twice}");
    for (from, to, says) in [
        ("flexible = 2", "flexible = 0", "modes.flexible"),
        ("flexible = 2", "flexible = 2\nabout = { angular_velocity = [0.0, 0.0, 10.0] }", "modes.about"),
    ] {
        let text = body.text_alone.replace(from, to).replace("[time]", &format!("{CLAMPED}[time]"));
        let body = Body::parse(&text, &body.path).unwrap();
        let refused = Builder::default().varied(&body, |_| ()).err().map(|error| error.to_string());
        assert!(refused.as_ref().is_some_and(|message| message.contains(says)), "{refused:?}");
    }
    let rigid = crate::rigid("", "end = 1.0\nstep = 0.1");
    assert!(Parameter::all(&rigid).unwrap_err().to_string().contains("body.rigid"));
}
