//! The subject of a fit: numbers of a body, or of a system.

use diagnostic::{Failure, Kind};
use fem_tet10::BodyNumber;
use model::{BuildError, BuildProgress, Builder, Needs, Parameter, RatesOf, VariedBody};
use scene::{Measured, Shared, System};

use crate::commands::linear::gradient::number::Number;
use crate::commands::linear::gradient::system::VariedSystem;
use crate::commands::modes::lone_body;

/// The limits within which Poisson's ratio is searched.
const POISSON: [f64; 2] = [-0.95, 0.499];
/// Largest logarithm of a ratio to the first value.
const FAR: f64 = 20.0;

/// A body or a system with its parameters.
pub(super) enum Subject {
    Body(Box<VariedBody>, Vec<Parameter>),
    System(Box<VariedSystem>, Vec<Number>),
}

/// Frequencies of the modes that were measured, their rates with the coordinates by parameter, and their numbers from 0.
pub(super) struct Found {
    pub frequencies: Vec<f64>,
    pub rates: Vec<Vec<f64>>,
    pub modes: Vec<usize>,
}

impl Subject {
    pub fn new(
        system: &System,
        builder: &Builder,
        names: &[String],
        measured: &Measured,
        progress: impl FnMut(BuildProgress),
    ) -> Result<Self, Failure> {
        if system.has_connections() {
            let all = Number::all(system)?;
            check(names, || all.iter().map(|number| number.name.clone()).collect(), measured)?;
            if !measured.places.is_empty() {
                let wrong = Kind::Input.of(&measured.file).found("shapes");
                let expected = "frequencies alone: modes of bodies in joints are matched by their order";
                return Err(wrong.expected(expected).help("leave the shapes out, and put the lines in order").into());
            }
            let parameters = Number::named(system, names)?;
            return Ok(Self::System(Box::new(VariedSystem::new(system, builder, progress)?), parameters));
        }
        let scene = lone_body(system).map_err(BuildError::from)?;
        let known = Parameter::all(scene).map_err(BuildError::from)?;
        check(names, || known.iter().map(|parameter| parameter.name.clone()).collect(), measured)?;
        let parameters = Parameter::named(scene, names).map_err(BuildError::from)?;
        Ok(Self::Body(Box::new(builder.needing(Needs::modes()).varied(scene, progress)?), parameters))
    }

    pub fn names(&self) -> Vec<String> {
        match self {
            Self::Body(_, parameters) => parameters.iter().map(|parameter| parameter.name.clone()).collect(),
            Self::System(_, parameters) => parameters.iter().map(|parameter| parameter.name.clone()).collect(),
        }
    }

    /// True of a parameter that stands in the scene; not of a stretch.
    pub fn is_key(&self, i: usize) -> bool {
        match self {
            Self::Body(_, parameters) => parameters[i].is_key(),
            Self::System(..) => true,
        }
    }

    pub fn scene(&self) -> &Shared {
        match self {
            Self::Body(body, _) => body.scene(),
            Self::System(varied, _) => &varied.system,
        }
    }

    /// The value of a parameter at a coordinate: the logarithm of its ratio to the first value, or of a Poisson's ratio the difference.
    pub fn value(&self, i: usize, x: f64) -> f64 {
        let first = match self {
            Self::Body(body, parameters) => parameters[i].value(body.body()),
            Self::System(varied, parameters) => parameters[i].value(&varied.system),
        };
        if self.is_plain(i) { first + x } else { first * x.exp() }
    }

    /// True within the limits of the search.
    pub fn is_within(&self, i: usize, x: f64) -> bool {
        if self.is_plain(i) { (POISSON[0]..=POISSON[1]).contains(&self.value(i, x)) } else { x.abs() < FAR }
    }

    fn is_plain(&self, i: usize) -> bool {
        match self {
            Self::Body(_, parameters) => matches!(parameters[i].number, BodyNumber::PoissonRatio(_)),
            Self::System(_, parameters) => parameters[i].is_poisson_ratio(),
        }
    }

    /// The frequencies at coordinates.
    pub fn found(&self, x: &[f64], measured: &Measured) -> Result<Found, Failure> {
        let values: Vec<f64> = x.iter().enumerate().map(|(i, x)| self.value(i, *x)).collect();
        let (frequencies, rates, modes) = match self {
            Self::Body(varied, parameters) => {
                let mut body = varied.body().clone();
                parameters.iter().zip(&values).for_each(|(parameter, value)| parameter.set(&mut body, *value));
                let factors = parameters.iter().zip(&values).filter(|(parameter, _)| !parameter.is_key());
                let factors: Vec<(&Parameter, f64)> = factors.map(|(parameter, value)| (parameter, *value)).collect();
                let found = match factors.is_empty() {
                    true => varied.rates(&body, parameters, RatesOf::Frequencies)?,
                    false => {
                        let stretched = varied.stretched(&body, &factors)?;
                        stretched.rates(stretched.body(), parameters, RatesOf::Frequencies)?
                    }
                };
                let modes = varied.matched(measured, &found)?;
                let rates: Vec<Vec<f64>> = found.rates.into_iter().map(|rates| rates.frequencies).collect();
                (found.frequencies, rates, modes)
            }
            Self::System(varied, parameters) => {
                let mut system = varied.system.clone();
                parameters.iter().zip(&values).for_each(|(parameter, value)| parameter.set(&mut system, *value));
                let found = varied.rates(&system, parameters, &[])?;
                let (count, there) = (measured.modes.len(), found.frequencies.len());
                if count > there {
                    let wrong = Kind::Input.of(&measured.file).found(format!("{count} measured modes"));
                    let expected = format!("at most {there}, the vibrations of the bodies");
                    return Err(wrong.expected(expected).help("leave lines out, or keep more modes").into());
                }
                (found.frequencies, found.rates, (0..count).collect())
            }
        };
        let slope = |i: usize| if self.is_plain(i) { 1.0 } else { values[i] };
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
