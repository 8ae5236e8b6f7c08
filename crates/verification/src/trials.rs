//! `docs/evidence/fit.md`: how often the intervals of `flexframe fit` have the true values in them.

use std::error::Error;
use std::fmt::Write;
use std::path::Path;

use flexframe::fit::{FitSettings, ParameterFit};
use model::Builder;
use scene::{Body, Measured, MeasuredMode};

use crate::lot::Lot;

/// Fits of each case.
const TRIALS: usize = 200;
/// Standard deviation of the frequencies, relative.
const NOISE: f64 = 0.01;
/// The values that the search begins with, over the true ones.
const START: f64 = 1.2;

/// A body and the parameters that are fitted.
struct Case {
    name: &'static str,
    modes: usize,
    /// Paths of keys, and the true values.
    parameters: &'static [(&'static str, f64)],
}

const CASES: [Case; 2] = [
    Case {
        name: "E, ν and ρ by 8 modes",
        modes: 8,
        parameters: &[
            ("body.material.young_modulus", 70e3),
            ("body.material.poisson_ratio", 0.3),
            ("body.material.density", 2.7e-9),
        ],
    },
    Case {
        name: "E and the mass at the tip by 6 modes",
        modes: 6,
        parameters: &[("body.material.young_modulus", 70e3), ("body.point_masses[0].mass", 1e-5)],
    },
];

/// A number with its trials.
#[derive(Default, Clone)]
struct Counted {
    hits: usize,
    /// Sums of ln(found/true) and its square, and of the half width of the interval, relative.
    sum: f64,
    squares: f64,
    width: f64,
}

/// The page. `notify` hears how far it is.
///
/// # Errors
/// The refusal of the scene or of a fit.
pub fn page(mut notify: impl FnMut(String)) -> Result<String, Box<dyn Error>> {
    let mut rows = String::new();
    for case in &CASES {
        for stated in [true, false] {
            let counted = trials(case, stated)?;
            for ((name, _), Counted { hits, sum, squares, width }) in case.parameters.iter().zip(counted) {
                let of = TRIALS as f64;
                let (mean, scatter) = (sum / of, (squares / of - (sum / of).powi(2)).max(0.0).sqrt());
                writeln!(
                    rows,
                    "| {} | {} | `{name}` | {hits} | {:.2} | {:.2} | {:.2} |",
                    case.name,
                    if stated { "stated" } else { "what is left" },
                    100.0 * mean,
                    100.0 * scatter,
                    100.0 * width / of
                )?;
                notify(format!("{}, {name}: {hits} of {TRIALS}", case.name));
            }
        }
    }
    // Within two standard deviations of the binomial distribution.
    let expected = 0.95 * TRIALS as f64;
    let spread = 2.0 * (expected * 0.05).sqrt();
    Ok(format!(
        "# Intervals of a fit\n\n\
         Made by `./dev fit-trials`: {TRIALS} fits each of the clamped bar of `meshes/rotating_bar.msh` with a mass at its tip to frequencies \
         drawn by\nlot about the true ones, with a standard deviation of {:.0} % each. The search begins {:.0} % off. \
         Counted is how often the\n95 % interval that `flexframe fit` states has the true value in it: {expected:.0} are expected, {:.0} to {:.0} \
         are within two standard deviations. The\ninterval is made of stated deviations of the frequencies, or, by Student's \
         distribution, of what is left of them.\n\n\
         | case | deviations | parameter | hits of {TRIALS} | mean error, % | scatter, % | mean half width, % |\n|---|---|---|---|---|---|---|\n{rows}\n\
         Errors and widths are of logarithms. The mean error is zero but for the scatter over √{TRIALS}. Without stated deviations the intervals are\n\
         wider: they tell the scatter from {} frequencies beyond the parameters or fewer.\n",
        100.0 * NOISE,
        100.0 * (START - 1.0),
        expected - spread,
        expected + spread,
        CASES.iter().map(|case| case.modes - case.parameters.len()).max().unwrap_or_default(),
    ))
}

/// Fits of a case to frequencies drawn by lot.
fn trials(case: &Case, stated: bool) -> Result<Vec<Counted>, Box<dyn Error>> {
    let settings = FitSettings {
        parameters: case.parameters.iter().map(|(name, _)| (*name).to_owned()).collect(),
        measured: Some(table(case.modes)),
        deviation: stated.then_some(NOISE),
    };
    let truth = ParameterFit::new(&scene(case, 1.0)?.into(), &Builder::default(), &settings, |_| ())?.frequencies()?;
    let mut fit = ParameterFit::new(&scene(case, START)?.into(), &Builder::default(), &settings, |_| ())?;
    let mut lot = Lot::new();
    let mut counted = vec![Counted::default(); case.parameters.len()];
    for _ in 0..TRIALS {
        let measured: Vec<f64> = truth.iter().map(|frequency| frequency * (1.0 + NOISE * lot.normal())).collect();
        fit.set_frequencies(&measured);
        let report = fit.run()?;
        for ((found, (name, value)), counted) in report.parameters.iter().zip(case.parameters).zip(&mut counted) {
            let [low, high] = found.interval.ok_or_else(|| format!("no interval of {name}"))?;
            let error = (found.value / value).ln();
            counted.hits += usize::from((low..=high).contains(value));
            counted.sum += error;
            counted.squares += error * error;
            counted.width += 0.5 * (high - low) / value;
        }
    }
    Ok(counted)
}

/// Measured modes whose frequencies are yet to be drawn.
fn table(modes: usize) -> Measured {
    let mode = |line| MeasuredMode { line, frequency: 1.0, deviation: None, damping_ratio: None, shape: Vec::new() };
    Measured { file: "trials.csv".into(), places: Vec::new(), modes: (1..=modes).map(mode).collect() }
}

/// The scene of a case with its parameters, as multiples of the true ones.
fn scene(case: &Case, times: f64) -> Result<Body, Box<dyn Error>> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    let value = |name: &str, default: f64| {
        let parameter = case.parameters.iter().find(|(other, _)| *other == name);
        parameter.map_or(default, |(_, value)| times * value)
    };
    let text = format!(
        "title = \"Bar\"\nunits = {{ length = \"mm\", mass = \"Mg\", time = \"s\" }}\n[body]\nmesh = \"meshes/rotating_bar.msh\"\n\
         material = {{ young_modulus = {:e}, poisson_ratio = {:e}, density = {:e} }}\n\
         point_masses = [{{ at = [202.07, 0.0, 0.0], mass = {:e} }}]\n[modes]\nflexible = {}\n\
         [[constraints]]\nkind = \"clamp\"\ngroup = \"root\"\n[time]\nend = 1.0\ntolerance = 1e-6\n",
        value("body.material.young_modulus", 70e3),
        value("body.material.poisson_ratio", 0.3),
        value("body.material.density", 2.7e-9),
        value("body.point_masses[0].mass", 1e-5),
        case.modes,
    );
    Ok(Body::parse(&text, root.join("trials.toml"))?)
}
