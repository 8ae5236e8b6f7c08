//! The rules on `[time]` and `[output]`.

use dynamics::{Method, Rows, StepControl, SystemScheme};

use super::Check;
use crate::body::{BodySource, Output};
use crate::document::join;
use crate::error::SceneError;
use crate::methods::{METHODS, is_without_joints, method_named, method_of_joints_named};
use crate::section::{Formulation, OutputSection, Scheme, TimeSection};
use crate::shared::Time;
use crate::text::shorten::shorten;

/// Intervals between rows where the scene gives a tolerance and names no rows.
const DEFAULT_ROWS: f64 = 500.0;
/// Most intervals between rows where it gives a step and names no rows: a row after every step, or after as many as it takes.
const MAX_DEFAULT_ROWS: f64 = 5000.0;

/// Shortest step, interval, duration and distance of times, over the end of the run: times closer than a tenth of this are one to the stepper.
const LEAST_PART: f64 = 1e-12;

impl Check<'_> {
    /// `is_tied` of bodies in joints, springs or bushings.
    pub fn time(&self, section: &TimeSection, is_tied: bool) -> Result<Time, SceneError> {
        let &TimeSection { end, step, tolerance, formulation, scheme } = section;
        let help = "the run starts at 0 and makes at least one step, e.g. `end = 0.5`";
        self.positive("time.end", end, help)?;
        let method =
            if is_tied { self.method_of_ties(formulation, scheme)? } else { self.method(formulation, scheme)? };
        let expected = "exactly one of them";
        let help = "give `step`, the length of a step, e.g. `step = 1e-4`, or `tolerance`, \
                    a bound of the sum of the estimated relative errors of all steps, e.g. `tolerance = 1e-6`";
        let control = match (step, tolerance) {
            (Some(_), Some(_)) => {
                return Err(self.document.place("time.tolerance").refuse(
                    "both `step` and `tolerance`",
                    expected,
                    help,
                ));
            }
            (None, None) => {
                return Err(self.document.place("time.step").refuse("neither `step` nor `tolerance`", expected, help));
            }
            (Some(step), None) => {
                self.positive("time.step", step, "give the length of a time step, e.g. `step = 1e-4`")?;
                self.part_of_the_run("time.step", step, end, "step")?;
                StepControl::Fixed(step)
            }
            (None, Some(tolerance)) => {
                self.tolerance(tolerance, method)?;
                StepControl::Tolerance(tolerance)
            }
        };
        Ok(Time { end, control, method })
    }

    /// Bodies in joints move by `radau`, which needs no name, by `gauss` or by `rkmk4`.
    fn method_of_ties(&self, formulation: Option<Formulation>, scheme: Option<Scheme>) -> Result<Method, SceneError> {
        let refuse = |key: &str, found: &str, expected: &str| {
            let found = format!("the {key} `{found}` with joints, springs or bushings");
            let help = format!("remove `{key}`: bodies in joints move by `radau`, the others by `exponential`");
            Err(self.document.place(&join("time", key)).refuse(found, expected, help))
        };
        match (formulation, scheme) {
            (Some(Formulation(name)), _) if name != Method::EXPONENTIAL.formulation => {
                refuse("formulation", name, "the conservative form: the paper's scheme has no joints")
            }
            (_, Some(Scheme(name))) => match method_of_joints_named(name) {
                Some(method) => Ok(method),
                None => refuse("scheme", name, "`radau`, `gauss`, `rkmk4`, or none"),
            },
            _ => Ok(Method::of_joints(SystemScheme::default())),
        }
    }

    fn method(&self, formulation: Option<Formulation>, scheme: Option<Scheme>) -> Result<Method, SceneError> {
        let of_formulation = formulation.map(|Formulation(name)| name);
        let Some(Scheme(name)) = scheme else {
            return Ok(if of_formulation == Some(frames_rk4::PAPER.formulation) {
                frames_rk4::PAPER
            } else {
                Method::EXPONENTIAL
            });
        };
        if !is_without_joints(name) {
            return Err(self.document.place("time.scheme").refuse(
                format!("the scheme `{name}` without joints, springs and bushings"),
                "a scheme of a body alone",
                "remove `scheme`, or tie bodies together by [[joints]]",
            ));
        }
        method_named(of_formulation, name).ok_or_else(|| {
            let of_formulation = of_formulation.unwrap_or_default();
            let others = |fits: &dyn Fn(&Method) -> bool, of: fn(&Method) -> &'static str| {
                let names: Vec<String> = METHODS.iter().filter(|m| fits(m)).map(|m| format!("`{}`", of(m))).collect();
                names.join(" or ")
            };
            let schemes = others(&|method| method.formulation == of_formulation, |method| method.scheme);
            let formulations = others(&|method| method.scheme == name, |method| method.formulation);
            let scheme = self.document.nearest("time.scheme");
            let found = format!("{} with the formulation `{of_formulation}`", shorten(scheme.written()));
            let expected = format!("{schemes}, or the formulation {formulations}, which has that scheme");
            scheme.place().refuse(found, expected, "change `scheme`, or change or remove `formulation`")
        })
    }

    fn tolerance(&self, tolerance: f64, method: Method) -> Result<(), SceneError> {
        if method.estimates_error {
            return self.require(
                tolerance > 0.0 && tolerance < 1.0,
                "time.tolerance",
                "a number between 0 and 1, both excluded",
                "give a bound of the sum of the estimated relative errors of all steps, e.g. `tolerance = 1e-6`",
            );
        }
        Err(self.document.place("time.tolerance").refuse(
            format!("a tolerance with the scheme `{}` of the formulation `{}`", method.scheme, method.formulation),
            "`step`, since only `exponential` and `rkmk4` on the conservative form estimate the error of a step",
            "give `step`, e.g. `step = 1e-4`, or set `scheme = \"exponential\"` and \
             `formulation = \"conservative\"`",
        ))
    }

    pub fn accuracy(&self, accuracy: Option<f64>) -> Result<(), SceneError> {
        self.require(
            accuracy.is_none_or(|accuracy| accuracy > 0.0 && accuracy < 1.0),
            "accuracy",
            "a number between 0 and 1, both excluded",
            "give the error that the answer may have, e.g. `accuracy = 0.01` for a per cent",
        )
    }

    /// Refuses a length of time beyond the end of the run, or lost in rounding beside it.
    fn part_of_the_run(&self, key: &str, length: f64, end: f64, name: &str) -> Result<(), SceneError> {
        self.require(
            length <= end,
            key,
            &format!("at most the end of the run, {end:?}"),
            &format!("make the {name} shorter or the run longer"),
        )?;
        self.not_lost(key, length, name)
    }

    /// Refuses a length of time that is lost in rounding beside the end of the run.
    pub(super) fn not_lost(&self, key: &str, length: f64, name: &str) -> Result<(), SceneError> {
        self.require(
            !self.is_lost(length),
            key,
            &format!("a {name} that is not lost in rounding beside the end of the run, {:?}", self.end),
            &format!("make the {name} longer or the run shorter"),
        )
    }

    pub(super) fn is_lost(&self, length: f64) -> bool {
        length < LEAST_PART * self.end
    }

    pub fn output(&self, section: OutputSection, time: &Time, body: &BodySource) -> Result<(Rows, Output), SceneError> {
        let OutputSection { every, interval, points, stress, peak_stress } = section;
        let rows = match (every, interval, time.control) {
            (Some(_), Some(_), _) => {
                return Err(self.document.place("output.interval").refuse(
                    "both `every` and `interval`",
                    "at most one of them",
                    "keep `every` for a row after that number of steps, or `interval` for rows at its multiples",
                ));
            }
            (Some(_), None, StepControl::Tolerance(_)) => {
                return Err(self.document.place("output.every").refuse(
                    "`every` with a tolerance",
                    "`interval`, since steps under a tolerance are not equally long",
                    "replace it by the time between two rows, e.g. `interval = 1e-3`",
                ));
            }
            (Some(every), None, StepControl::Fixed(_)) => {
                self.require(
                    every >= 1,
                    "output.every",
                    "a whole number, 1 or more",
                    "write 1 for every step, 10 for every tenth",
                )?;
                Rows::EverySteps(every)
            }
            (None, Some(interval), _) => {
                let help = "give the time between two rows, e.g. `interval = 1e-3`";
                self.positive("output.interval", interval, help)?;
                self.part_of_the_run("output.interval", interval, time.end, "interval")?;
                Rows::Interval(interval)
            }
            (None, None, StepControl::Fixed(step)) => {
                Rows::EverySteps((time.end / step / MAX_DEFAULT_ROWS * (1.0 - 1e-12)).ceil() as u64)
            }
            (None, None, StepControl::Tolerance(_)) => Rows::Interval(time.end / DEFAULT_ROWS),
        };
        let help = "keep the points that you look at";
        self.not_too_many("output.points", points.len(), help)?;
        for name in points.keys() {
            let names_a_group = !matches!(name.as_str(), "" | "." | "..");
            if !names_a_group || name.contains(|c: char| c == '/' || c.is_control()) {
                return Err(self.document.nearest(&join("output.points", name)).place_of_key().refuse(
                    format!("the name {:?}", shorten(name)),
                    "a name that is not empty, `.` or `..`, without `/` and control characters",
                    "rename the point, e.g. `P1`: it names a group in the results file",
                ));
            }
        }
        for (key, asked) in [("output.stress", stress), ("output.peak_stress", peak_stress)] {
            self.require(
                !asked || body.has_elements(),
                key,
                "a body with a mesh",
                match body {
                    BodySource::Matrices(_) => {
                        "remove the key: matrices say nothing of stress, which needs the elements of a mesh"
                    }
                    _ => "remove the key: a rigid body without a mesh has no stress",
                },
            )?;
        }
        self.require(
            !stress || !points.is_empty(),
            "output.stress",
            "points whose stress is written",
            "name them, e.g. `points = { root = [0, 0, 0] }`, or ask for `peak_stress = true`",
        )?;
        Ok((rows, Output { points, stress, peak_stress }))
    }
}
