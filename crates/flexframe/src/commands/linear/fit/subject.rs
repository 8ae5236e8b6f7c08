//! The subject of a fit: numbers of a body, or of a system.

use diagnostic::{Failure, Kind};
use model::{BuildProgress, Builder, Parameter, RatesOf};
use scene::{Measured, Scene, Shared};

use crate::commands::linear::gradient::number::Number;
use crate::commands::linear::gradient::system::Varied;

/// The limits within which Poisson's ratio is searched.
const POISSON: [f64; 2] = [-0.95, 0.499];
/// Largest logarithm of a ratio to the first value.
const FAR: f64 = 20.0;

/// A body or a system with its parameters.
pub(super) struct Subject {
    system: Scene,
    numbers: Vec<Number>,
    varied: Varied,
}

/// Frequencies of the modes that were measured, their rates with the coordinates by parameter, and their numbers from 0.
pub(super) struct Found {
    pub frequencies: Vec<f64>,
    pub rates: Vec<Vec<f64>>,
    pub modes: Vec<usize>,
}

impl Subject {
    pub fn new(
        scene: &Scene,
        builder: &Builder,
        names: &[String],
        measured: &Measured,
        progress: impl FnMut(BuildProgress),
    ) -> Result<Self, Failure> {
        let all = Number::all(scene)?;
        check(names, || all.iter().map(|number| number.name.clone()).collect(), measured)?;
        if scene.has_connections() && !measured.places.is_empty() {
            let wrong = Kind::Input.of(&measured.file).found("shapes");
            let expected = "frequencies alone: modes of bodies in joints are matched by their order";
            return Err(wrong.expected(expected).help("leave the shapes out, and put the lines in order").into());
        }
        let numbers = Number::named(scene, names)?;
        Ok(Self { system: scene.clone(), numbers, varied: Varied::new(scene, builder, progress)? })
    }

    pub fn names(&self) -> Vec<String> {
        self.numbers.iter().map(|number| number.name.clone()).collect()
    }

    /// True of a parameter that stands in the scene; not of a stretch.
    pub fn is_key(&self, i: usize) -> bool {
        self.numbers[i].parameter().is_none_or(Parameter::is_key)
    }

    pub fn scene(&self) -> &Shared {
        &self.system
    }

    /// The value of a parameter at a coordinate: the logarithm of its ratio to the first value, or of a Poisson's ratio the difference.
    pub fn value(&self, i: usize, x: f64) -> f64 {
        let first = self.numbers[i].value(&self.system);
        if self.numbers[i].is_poisson_ratio() { first + x } else { first * x.exp() }
    }

    /// True within the limits of the search.
    pub fn is_within(&self, i: usize, x: f64) -> bool {
        if self.numbers[i].is_poisson_ratio() {
            (POISSON[0]..=POISSON[1]).contains(&self.value(i, x))
        } else {
            x.abs() < FAR
        }
    }

    /// The frequencies at coordinates.
    pub fn found(&self, x: &[f64], measured: &Measured) -> Result<Found, Failure> {
        let values: Vec<f64> = x.iter().enumerate().map(|(i, x)| self.value(i, *x)).collect();
        let (frequencies, rates, modes) = match &self.varied {
            Varied::Body(varied) => {
                let parameters: Vec<Parameter> = self.numbers.iter().filter_map(Number::parameter).cloned().collect();
                let mut body = varied.body().clone();
                parameters.iter().zip(&values).for_each(|(parameter, value)| parameter.set(&mut body, *value));
                let factors = parameters.iter().zip(&values).filter(|(parameter, _)| !parameter.is_key());
                let factors: Vec<(&Parameter, f64)> = factors.map(|(parameter, value)| (parameter, *value)).collect();
                let found = match factors.is_empty() {
                    true => varied.rates(&body, &parameters, RatesOf::Frequencies)?,
                    false => {
                        let stretched = varied.stretched(&body, &factors)?;
                        stretched.rates(stretched.body(), &parameters, RatesOf::Frequencies)?
                    }
                };
                let modes = varied.matched(measured, &found)?;
                let rates: Vec<Vec<f64>> = found.rates.into_iter().map(|rates| rates.frequencies).collect();
                (found.frequencies, rates, modes)
            }
            Varied::System(varied) => {
                let mut scene = self.system.clone();
                self.numbers.iter().zip(&values).for_each(|(number, value)| number.set(&mut scene, *value));
                let found = varied.rates(&scene, &self.numbers, &[])?;
                let (count, there) = (measured.modes.len(), found.frequencies.len());
                if count > there {
                    let wrong = Kind::Input.of(&measured.file).found(format!("{count} measured modes"));
                    let expected = format!("at most {there}, the vibrations of the bodies");
                    return Err(wrong.expected(expected).help("leave lines out, or keep more modes").into());
                }
                (
                    found.frequencies,
                    found.rates.into_iter().map(|rates| rates.frequencies).collect(),
                    (0..count).collect(),
                )
            }
        };
        let slope = |i: usize| if self.numbers[i].is_poisson_ratio() { 1.0 } else { values[i] };
        let of_modes = |(i, rates): (usize, Vec<f64>)| modes.iter().map(|k| slope(i) * rates[*k]).collect();
        Ok(Found {
            frequencies: modes.iter().map(|k| frequencies[*k]).collect(),
            rates: rates.into_iter().enumerate().map(of_modes).collect(),
            modes,
        })
    }
}

/// Refuses a fit without parameters, and one of more than there are frequencies.
fn check(names: &[String], all: impl Fn() -> Vec<String>, measured: &Measured) -> Result<(), Failure> {
    if names.is_empty() {
        let help = format!("name some of {}: --parameters NAME,…", all().join(", "));
        return Err(Kind::Usage.alone().help(help).says("no parameters to fit"));
    }
    let (count, unknowns) = (measured.modes.len(), names.len());
    if unknowns > count {
        let found = format!("{count} measured frequencies for {unknowns} parameters ({})", names.join(", "));
        let wrong = Kind::Input.of(&measured.file).found(found);
        let expected = "at least as many as parameters, and more for intervals";
        return Err(wrong.expected(expected).help("measure more modes, or fit fewer parameters").into());
    }
    Ok(())
}
