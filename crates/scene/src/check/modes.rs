//! The rules on `[modes]`.

use dynamics::{MAX_FOLLOWING, MAX_LARGE};

use super::Check;
use crate::body::BodySource;
use crate::body::effects::Choice;
use crate::body::modes::{About, Damping, Flexible, Large, Modes, Rayleigh};
use crate::error::SceneError;
use crate::section::{AboutGiven, AboutName, AboutSection, CountOrAuto, CountOrList, ModesSection, NumberOrList};

/// The largest number of modes with `flexible = "auto"`, where the scene gives none.
const DEFAULT_MOST: usize = 40;
/// The most modes that follow large ones where the scene says nothing.
const DEFAULT_FOLLOWING: usize = 3;

impl Check<'_> {
    pub fn modes(&self, section: Option<ModesSection>, body: &BodySource) -> Result<Modes, SceneError> {
        let is_rigid = matches!(body, BodySource::Rigid(_));
        let Some(section) = section else {
            return match is_rigid {
                true => Ok(Modes {
                    flexible: Flexible::Count(0),
                    damping: Damping::Uniform(0.0),
                    static_correction: Choice::Auto,
                    large: None,
                    following: DEFAULT_FOLLOWING,
                    about: None,
                    measured: None,
                }),
                false => Err(self.missing("", "modes")),
            };
        };
        let flexible = self.flexible(section.flexible, section.most)?;
        if is_rigid && flexible != Flexible::Count(0) {
            return Err(self.document.place("modes.flexible").refuse(
                "flexible modes of a rigid body",
                "0, since `rigid` in [body] has no mesh that could deform",
                "remove [modes], or give `mesh` and `material` in [body] instead of `rigid`",
            ));
        }
        let static_correction = section.static_correction;
        if static_correction == Choice::On && flexible == Flexible::Count(0) {
            return Err(self.document.place("modes.static_correction").refuse(
                "a static correction of a body without flexible modes",
                "`false` or `\"auto\"`",
                "remove it, or keep flexible modes",
            ));
        }
        let damping = self.damping(section.damping_ratio, section.damping_table, section.rayleigh, flexible)?;
        let large = self.large(section.large, flexible.most())?;
        let following = section.following.unwrap_or(DEFAULT_FOLLOWING);
        self.require(
            following <= MAX_FOLLOWING,
            "modes.following",
            &format!("a whole number from 0 to {MAX_FOLLOWING}"),
            "give the most modes that follow the large ones; three are enough for most bodies",
        )?;
        let about = section.about.map(|about| self.about(&about, body, flexible)).transpose()?;
        let measured = section.measured.map(|file| self.measured(&file, flexible)).transpose()?;
        Ok(Modes { flexible, damping, static_correction, large, following, about, measured })
    }

    fn about(&self, about: &AboutSection, body: &BodySource, flexible: Flexible) -> Result<About, SceneError> {
        let place = self.document.place("modes.about");
        let is_stiff = flexible == Flexible::Count(0);
        if let Some(found) = is_stiff.then_some("a body without flexible modes").or(body.not_by_elements()) {
            let found = format!("modes about the bent state of {found}");
            return Err(place.refuse(found, "a body with a mesh and flexible modes", "remove it"));
        }
        Ok(match about {
            AboutSection::Named(AboutName::Spin) => About::Spin,
            AboutSection::Named(AboutName::Loads) => About::Loads,
            AboutSection::Named(AboutName::Auto) => About::Auto,
            AboutSection::Given(AboutGiven { angular_velocity, loads }) => {
                if *angular_velocity == [0.0; 3] && !loads {
                    let help = "give the spin as `angular_velocity = [x, y, z]`, set `loads = true`, or remove it";
                    return Err(place.refuse("neither a spin nor loads", "one of them, or both", help));
                }
                About::Given { angular_velocity: *angular_velocity, loads: *loads }
            }
        })
    }

    fn large(&self, large: Option<CountOrList>, flexible: usize) -> Result<Option<Large>, SceneError> {
        let most = MAX_LARGE.min(flexible);
        let refuse = |found: String| {
            self.document.place("modes.large").refuse(
                found,
                format!(
                    "a number from 1 to {most}, or a list of as many numbers of modes that ascend, from 1 to {flexible}"
                ),
                "name the modes that bend the body far, or remove it",
            )
        };
        let is_in = |count: usize| (1..=most).contains(&count);
        match large {
            None => Ok(None),
            Some(CountOrList::Count(count)) if is_in(count) => Ok(Some(Large::Count(count))),
            Some(CountOrList::Count(count)) => Err(refuse(count.to_string())),
            Some(CountOrList::List(list)) => {
                let ascends = list.windows(2).all(|pair| pair[0] < pair[1]);
                let exist = list.iter().all(|mode| (1..=flexible).contains(mode));
                if is_in(list.len()) && ascends && exist {
                    Ok(Some(Large::List(list)))
                } else {
                    Err(refuse(format!("{list:?}")))
                }
            }
        }
    }

    fn flexible(&self, flexible: CountOrAuto, most: Option<usize>) -> Result<Flexible, SceneError> {
        match (flexible, most) {
            (CountOrAuto::Count(count), None) => Ok(Flexible::Count(count)),
            (CountOrAuto::Count(count), Some(_)) => Err(self.document.place("modes.most").refuse(
                format!("`most` with `flexible = {count}`"),
                "`most` with `flexible = \"auto\"` only",
                "remove `most`, or set `flexible = \"auto\"`",
            )),
            (CountOrAuto::Auto, most) => {
                let most = most.unwrap_or(DEFAULT_MOST);
                self.require(
                    most >= 1,
                    "modes.most",
                    "a whole number, 1 or more",
                    "give the largest number of modes, or set `flexible = 0` for none",
                )?;
                Ok(Flexible::Auto { most })
            }
        }
    }

    fn damping(
        &self,
        ratio: Option<NumberOrList>,
        table: Option<Vec<[f64; 2]>>,
        rayleigh: Option<Rayleigh>,
        flexible: Flexible,
    ) -> Result<Damping, SceneError> {
        let help = "keep one way to say how the modes are damped";
        self.at_most_one("modes", &["damping_ratio", "damping_table", "rayleigh"], help)?;
        if let Some(points) = table {
            self.damping_table("modes.damping_table", &points)?;
            return Ok(Damping::Table(points));
        }
        if let Some(rayleigh) = rayleigh {
            for (key, factor) in [("modes.rayleigh.alpha", rayleigh.alpha), ("modes.rayleigh.beta", rayleigh.beta)] {
                let help = "give the factor of the mass (alpha) or stiffness (beta) in C = αM + βK; \
                            a negative one could feed energy in";
                self.require(factor >= 0.0, key, "a number of 0 or more", help)?;
            }
            return Ok(Damping::Rayleigh(rayleigh));
        }
        let key = "modes.damping_ratio";
        match ratio {
            None => Ok(Damping::Uniform(0.0)),
            Some(NumberOrList::Number(ratio)) => {
                self.damping_ratio(key, ratio)?;
                Ok(Damping::Uniform(ratio))
            }
            Some(NumberOrList::List(ratios)) => {
                let help = "give a ratio for each mode, the lowest first; the last holds for the rest";
                self.require(!ratios.is_empty(), key, "at least one damping ratio", help)?;
                for (i, &ratio) in ratios.iter().enumerate() {
                    self.damping_ratio(&format!("{key}[{i}]"), ratio)?;
                }
                self.not_more_than_modes(key, ratios.len(), flexible)?;
                Ok(Damping::List(ratios))
            }
        }
    }

    fn damping_ratio(&self, key: &str, ratio: f64) -> Result<(), SceneError> {
        self.require(
            ratio >= 0.0,
            key,
            "a number of 0 or more",
            "give the fraction of critical damping, e.g. 0.05; a negative one would feed energy in",
        )
    }

    fn damping_table(&self, key: &str, points: &[[f64; 2]]) -> Result<(), SceneError> {
        let help = "give pairs of frequency and damping ratio, e.g. `damping_table = [[10, 0.02], [100, 0.05]]`";
        self.require(!points.is_empty(), key, "at least one pair of frequency and damping ratio", help)?;
        for (i, &[frequency, ratio]) in points.iter().enumerate() {
            let help = "give the frequency in cycles per time";
            self.require(frequency >= 0.0, &format!("{key}[{i}][0]"), "a number of 0 or more", help)?;
            self.damping_ratio(&format!("{key}[{i}][1]"), ratio)?;
        }
        let frequencies: Vec<f64> = points.iter().map(|[frequency, _]| *frequency).collect();
        self.rising(key, &frequencies, |i| format!("[{i}][0]"), "frequencies")
    }

    /// Refuses a list with more entries than there are flexible modes.
    pub(super) fn not_more_than_modes(&self, key: &str, entries: usize, flexible: Flexible) -> Result<(), SceneError> {
        if entries <= flexible.most() {
            return Ok(());
        }
        let more = match flexible {
            Flexible::Count(_) => format!("`flexible = {entries}`"),
            Flexible::Auto { .. } => format!("`most = {entries}`"),
        };
        Err(self.document.place(key).refuse(
            format!("{entries} entries"),
            format!("at most {}, one for each flexible mode", flexible.most()),
            format!("remove entries, or set {more} in [modes]"),
        ))
    }
}
