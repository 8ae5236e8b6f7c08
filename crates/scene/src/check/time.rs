//! The rules on `[time]` and `[output]`.

use super::Check;
use crate::document::join;
use crate::error::{SceneError, shorten};
use crate::scene::{Method, Output, Rows, Stepping, Time};
use crate::section::{Formulation, OutputSection, Scheme, TimeSection};

/// Intervals between rows where the scene gives a tolerance and no interval.
const DEFAULT_ROWS: f64 = 500.0;

/// Shortest step, interval, duration and distance of times, over the end of the run: times closer than a tenth of this are one to the stepper.
const LEAST_PART: f64 = 1e-12;

impl Check<'_> {
    pub fn time(&self, section: &TimeSection) -> Result<Time, SceneError> {
        let &TimeSection { end, step, tolerance, formulation, scheme } = section;
        let cure = "the run starts at 0 and makes at least one step, e.g. `end = 0.5`";
        self.positive("time.end", end, cure)?;
        let method = self.method(formulation, scheme)?;
        let expected = "exactly one of them";
        let cure = "give `step`, the length of a step, e.g. `step = 1e-4`, or `tolerance`, \
                    what the estimated relative errors of all steps may sum to, e.g. `tolerance = 1e-6`";
        let stepping = match (step, tolerance) {
            (Some(_), Some(_)) => {
                return Err(self.document.place("time.tolerance").refuse(
                    "both `step` and `tolerance`",
                    expected,
                    cure,
                ));
            }
            (None, None) => {
                return Err(self.document.place("time.step").refuse("neither `step` nor `tolerance`", expected, cure));
            }
            (Some(step), None) => {
                self.positive("time.step", step, "give the length of a time step, e.g. `step = 1e-4`")?;
                self.part_of_the_run("time.step", step, end, "step")?;
                Stepping::Step(step)
            }
            (None, Some(tolerance)) => {
                self.tolerance(tolerance, method)?;
                Stepping::Tolerance(tolerance)
            }
        };
        Ok(Time { end, stepping, method })
    }

    fn method(&self, formulation: Option<Formulation>, scheme: Option<Scheme>) -> Result<Method, SceneError> {
        match (formulation, scheme) {
            (Some(Formulation::Conservative), Some(Scheme::Paper)) => {
                let found = "the conservative formulation with the scheme `paper`";
                let expected = "the formulation `paper`, which that scheme belongs to";
                let cure = "remove `formulation`, or set `scheme = \"exponential\"` for the conservative one";
                Err(self.document.place("time.formulation").refuse(found, expected, cure))
            }
            (None | Some(Formulation::Paper), Some(Scheme::Paper)) | (Some(Formulation::Paper), None) => {
                Ok(Method::Paper)
            }
            (Some(Formulation::Paper), Some(Scheme::Rkmk4)) => Ok(Method::PaperRkmk4),
            (Some(Formulation::Paper), Some(Scheme::Exponential | Scheme::Strang)) => {
                let scheme = self.document.nearest("time.scheme");
                let found = format!("{} with the formulation `paper`", shorten(scheme.written()));
                let expected = "`paper` or `rkmk4`, since `exponential` and `strang` need the conservative form";
                let cure = "set `scheme = \"rkmk4\"`, or `formulation = \"conservative\"`";
                Err(scheme.place().refuse(found, expected, cure))
            }
            (None | Some(Formulation::Conservative), Some(Scheme::Rkmk4)) => Ok(Method::Rkmk4),
            (None | Some(Formulation::Conservative), Some(Scheme::Strang)) => Ok(Method::Strang),
            (None | Some(Formulation::Conservative), Some(Scheme::Exponential) | None) => Ok(Method::Exponential),
        }
    }

    fn tolerance(&self, tolerance: f64, method: Method) -> Result<(), SceneError> {
        let found = match method {
            Method::Rkmk4 | Method::Exponential => {
                return self.require(
                    tolerance > 0.0 && tolerance < 1.0,
                    "time.tolerance",
                    "a number between 0 and 1, both excluded",
                    "give what the estimated relative errors of all steps may sum to, e.g. `tolerance = 1e-6`",
                );
            }
            Method::Paper | Method::PaperRkmk4 => "a tolerance with the paper's formulation",
            Method::Strang => "a tolerance with the scheme `strang`",
        };
        Err(self.document.place("time.tolerance").refuse(
            found,
            "`step`, since only `exponential` and `rkmk4` on the conservative form estimate the error of a step",
            "give `step`, e.g. `step = 1e-4`, or set `scheme = \"exponential\"` and \
             `formulation = \"conservative\"`",
        ))
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

    pub fn output(&self, section: OutputSection, time: &Time) -> Result<Output, SceneError> {
        let OutputSection { every, interval, points } = section;
        let rows = match (every, interval, time.stepping) {
            (Some(_), Some(_), _) => {
                return Err(self.document.place("output.interval").refuse(
                    "both `every` and `interval`",
                    "at most one of them",
                    "keep `every` for a row after so many steps, or `interval` for rows at its multiples",
                ));
            }
            (Some(_), None, Stepping::Tolerance(_)) => {
                return Err(self.document.place("output.every").refuse(
                    "`every` with a tolerance",
                    "`interval`, since steps under a tolerance are not equally long",
                    "replace it by the time between two rows, e.g. `interval = 1e-3`",
                ));
            }
            (Some(every), None, Stepping::Step(_)) => {
                self.require(
                    every >= 1,
                    "output.every",
                    "a whole number, 1 or more",
                    "write 1 for every step, 10 for every tenth",
                )?;
                Rows::EverySteps(every)
            }
            (None, Some(interval), _) => {
                let cure = "give the time between two rows, e.g. `interval = 1e-3`";
                self.positive("output.interval", interval, cure)?;
                self.part_of_the_run("output.interval", interval, time.end, "interval")?;
                Rows::Interval(interval)
            }
            (None, None, Stepping::Step(_)) => Rows::EverySteps(1),
            (None, None, Stepping::Tolerance(_)) => Rows::Interval(time.end / DEFAULT_ROWS),
        };
        let cure = "keep the points that you look at";
        self.not_too_many("output.points", points.len(), cure)?;
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
        Ok(Output { rows, points })
    }
}
