//! The ladders: each method with shorter and shorter steps, or smaller and smaller tolerances.

use std::fmt;
use std::time::Instant;

use dynamics::{Method, StepControl};
use serde::Serialize;

use super::case::PreparedScene;
use super::reference::{ROUNDING, Reference};
use super::run::{Errors, Timing, Trajectory};
use super::setting::Setting;
use super::settings::CostSettings;
use crate::commands::run::RunFailure;
use crate::files::json;
use crate::report::rounded;

/// Errors below this multiple of the reference's own are not told apart.
const RANKED_ABOVE: f64 = 3.0;
/// Fraction of a limit of the modes at which the ladder begins.
const BELOW_LIMIT: f64 = 0.9;
/// Least number of steps with which the ladders begin.
const FEWEST_STEPS: f64 = 10.0;
/// Tolerances are 10^−k for these k.
const TOLERANCES: std::ops::RangeInclusive<i32> = 3..=10;
/// Steps whose error is this fraction of the formulation's need not be shorter.
const OUTWEIGHED: f64 = 1e-3;
/// Errors above this are too coarse for an order to show.
const COARSE: f64 = 1e-2;
/// Errors above this multiple of the reference's own are free of it.
const FAR_ABOVE: f64 = 100.0;
/// Errors below this may be rounding, in a run of few steps and in each of many.
const ROUNDED: f64 = 1e-11;
const ROUNDED_IN_A_STEP: f64 = 1e-16;

/// The runs of a method.
#[derive(Debug, Clone, Serialize)]
pub struct Line {
    /// Formulation, as in the scene.
    pub formulation: &'static str,
    /// Scheme, as in the scene.
    pub scheme: &'static str,
    /// True if tolerances are given instead of steps.
    pub controlled: bool,
    /// The order that the scheme has.
    pub order: u32,
    /// The order that was measured: the slope of the error against the step, where errors come from the steps; of the
    /// quantity that converges most slowly.
    #[serde(serialize_with = "json::optional")]
    pub measured_order: Option<f64>,
    /// The runs, longest step or largest tolerance first.
    pub rows: Vec<LadderRun>,
    #[serde(skip)]
    pub(super) method: Method,
}

/// A run of a ladder.
#[derive(Debug, Clone, Serialize)]
pub struct LadderRun {
    /// The setting asked for.
    pub setting: Setting,
    /// True if the scene asks for it itself.
    pub of_scene: bool,
    /// True if no other run is both closer and faster.
    pub on_front: bool,
    /// Its outcome.
    pub outcome: Outcome,
}

/// Outcome of a run.
#[derive(Debug, Clone, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Outcome {
    /// It came to its end.
    Ran(Box<MeasuredRun>),
    /// It failed, and why.
    Failed(String),
    /// It was stopped: it takes longer than the patience.
    OutOfPatience(Stopped),
}

/// A run that was stopped.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Stopped {
    /// Time of computing that it was allowed, seconds.
    pub patience: f64,
    /// Part of the motion that it came to, 0 to 1.
    pub reached: f64,
}

impl fmt::Display for Stopped {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        RunFailure::OutOfPatience { patience: self.patience, reached: self.reached }.fmt(f)
    }
}

/// A run that came to its end.
#[derive(Debug, Clone, Serialize)]
pub struct MeasuredRun {
    /// The largest of the errors against the reference, or, if that is larger, three times the reference's own error.
    #[serde(serialize_with = "json::number")]
    pub error: f64,
    /// True if the error is so small that the reference cannot tell it.
    pub at_reference: bool,
    /// Errors against the reference.
    pub errors: Errors,
    /// Errors against the limit of its own formulation: what the steps do.
    pub step_errors: Option<Errors>,
    /// Change of energy − work + dissipation, relative to the largest energy.
    #[serde(serialize_with = "json::number")]
    pub energy: f64,
    /// Change of angular momentum less angular impulse, relative to the largest angular momentum.
    #[serde(serialize_with = "json::number")]
    pub angular_momentum: f64,
    /// |ω| at the end over that of the reference, less one; none where the reference does not spin.
    #[serde(serialize_with = "json::optional")]
    pub spin: Option<f64>,
    /// The same against the limit of its own formulation: what the steps do to the spin.
    #[serde(serialize_with = "json::optional")]
    pub step_spin: Option<f64>,
    /// Steps taken.
    pub steps: u64,
    /// Steps tried in vain.
    pub rejected: u64,
    /// Evaluations of the rates.
    pub evaluations: u64,
    /// Shortest time of the loop, seconds.
    #[serde(serialize_with = "json::number")]
    pub seconds: f64,
    /// Longest time over shortest.
    #[serde(serialize_with = "json::number")]
    pub spread: f64,
    /// How often it was timed.
    pub repeats: u32,
}

impl LadderRun {
    /// The measurement, if the run came to its end.
    pub fn measured(&self) -> Option<&MeasuredRun> {
        match &self.outcome {
            Outcome::Ran(measured) => Some(measured),
            Outcome::Failed(_) | Outcome::OutOfPatience(_) => None,
        }
    }
}

/// Measures runs.
pub(super) struct Evaluator<'a> {
    pub reference: &'a Reference,
    pub paper_limit: Option<&'a Reference>,
    pub settings: CostSettings,
}

impl Evaluator<'_> {
    /// The limit to which a method converges with short steps.
    fn limit(&self, method: Method) -> Option<&Reference> {
        if method.abilities.keeps_energy { Some(self.reference) } else { self.paper_limit }
    }

    /// Runs the motion once for its errors, warming up, and then again and again for the time.
    pub(super) fn measure(&self, case: &PreparedScene<'_>, method: Method, control: StepControl) -> Outcome {
        match self.try_measure(case, method, control) {
            Ok(measured) => Outcome::Ran(measured.into()),
            Err(RunFailure::OutOfPatience { patience, reached }) => {
                Outcome::OutOfPatience(Stopped { patience, reached })
            }
            Err(failure) => Outcome::Failed(failure.to_string()),
        }
    }

    fn try_measure(
        &self,
        case: &PreparedScene<'_>,
        method: Method,
        control: StepControl,
    ) -> Result<MeasuredRun, RunFailure> {
        let begun = case.begin(method, control)?;
        let run = Trajectory::follow(begun.clone(), self.settings.patience)?;
        let timing = Timing::of(&begun, self.settings.timed_for, self.settings.patience)?;
        let errors = Errors::between(&run, &self.reference.trajectory, case.scales());
        let least = RANKED_ABOVE * self.reference.error.largest();
        let limit = self.limit(method).map(|limit| &limit.trajectory);
        let spin = |against: &Trajectory| run.spin_against(against);
        Ok(MeasuredRun {
            error: errors.largest().max(least),
            at_reference: errors.largest() <= least,
            errors,
            step_errors: limit.map(|limit| Errors::between(&run, limit, case.scales())),
            energy: run.energy,
            angular_momentum: run.angular_momentum,
            spin: spin(&self.reference.trajectory),
            step_spin: limit.and_then(spin),
            steps: run.steps,
            rejected: run.rejected,
            evaluations: run.evaluations,
            seconds: timing.shortest.as_secs_f64(),
            spread: timing.longest.as_secs_f64() / timing.shortest.as_secs_f64(),
            repeats: timing.repeats,
        })
    }

    /// True if shorter steps cannot bring a run closer to the reference, as far as can be told: the reference cannot
    /// tell, or the error is that of the formulation, or of rounding.
    fn is_at_the_end(&self, method: Method, before: Option<&MeasuredRun>, now: &MeasuredRun) -> bool {
        let own = self.limit(method).map_or(0.0, |limit| RANKED_ABOVE * limit.error.largest());
        now.at_reference
            || now.step_errors.is_some_and(|errors| errors.largest() <= own.max(OUTWEIGHED * now.error))
            || before.is_some_and(|before| now.error < ROUNDING && now.error > before.error / 2.0)
    }
}

/// Runs a method with shorter and shorter steps (or smaller tolerances), until that no longer helps, or a run would
/// take longer than the patience. `own` is what the scene asks for.
pub(super) fn refine_line(
    case: &PreparedScene<'_>,
    evaluator: &Evaluator<'_>,
    method: Method,
    controlled: bool,
    own: (Method, StepControl),
) -> Line {
    let mut line = Line {
        formulation: method.formulation,
        scheme: method.scheme,
        controlled,
        order: method.order,
        measured_order: None,
        rows: Vec::new(),
        method,
    };
    // The last run, and its work relative to the first setting.
    let mut before: Option<(f64, MeasuredRun)> = None;
    for (control, work) in refinements(case, method, controlled) {
        if let Some((work_before, run)) = &before {
            let more = work / work_before;
            let (seconds, steps) = (more * run.seconds, more * run.steps as f64);
            if seconds > evaluator.settings.patience.as_secs_f64()
                || steps > evaluator.settings.max_steps as f64 * 1.001
            {
                break;
            }
        }
        let of_scene = own.0 == method && is_same(own.1.into(), control.into());
        let started = Instant::now();
        let row = LadderRun::new(control, evaluator.measure(case, method, control), of_scene);
        let measured = row.measured().cloned();
        line.rows.push(row);
        let Some(measured) = measured else {
            // A run that fails on its way does so at every step where its formulation is at fault.
            if 2 * started.elapsed() > evaluator.settings.patience {
                break;
            }
            continue;
        };
        let ends = evaluator.is_at_the_end(method, before.as_ref().map(|(_, run)| run), &measured);
        before = Some((work, measured));
        if ends {
            break;
        }
    }
    let (own_method, own_control) = own;
    let is_ours = own_method == method && controlled == matches!(own_control, StepControl::Tolerance(_));
    if is_ours && !line.rows.iter().any(|row| row.of_scene) {
        let outcome = evaluator.measure(case, method, own_control);
        line.insert(LadderRun::new(own_control, outcome, true));
    }
    if !controlled && let Some(limit) = evaluator.limit(method) {
        line.measured_order = slowest_order(&line.rows, &limit.error);
    }
    line
}

impl LadderRun {
    pub(super) fn new(control: StepControl, outcome: Outcome, of_scene: bool) -> Self {
        Self { setting: control.into(), of_scene, on_front: false, outcome }
    }
}

impl Line {
    /// Inserts a row where its step belongs.
    pub(super) fn insert(&mut self, row: LadderRun) {
        let place = self.rows.partition_point(|other| other.setting.value() > row.setting.value());
        self.rows.insert(place, row);
    }

    /// The scheme, for tables and legends.
    pub fn name(&self) -> String {
        let formulation = match (self.formulation, self.scheme) {
            ("paper", "rkmk4") => "paper's form, ",
            _ => "",
        };
        let control = if self.controlled { ", step control" } else { "" };
        format!("{formulation}{}{control}", self.scheme)
    }
}

/// The settings of a line, coarsest first, and the work of each relative to the first.
fn refinements(case: &PreparedScene<'_>, method: Method, controlled: bool) -> Vec<(StepControl, f64)> {
    if controlled {
        // The estimate goes with the fourth power of the step.
        return TOLERANCES
            .map(|k| (StepControl::Tolerance(tidy(10_f64.powi(-k))), 10_f64.powf(f64::from(k) / 4.0)))
            .collect();
    }
    let end = case.end();
    let longest = case.longest_step(method);
    let factor = if method.is_limited_by_modes() && longest < end { BELOW_LIMIT } else { 1.0 };
    let fewest = (end / (factor * longest)).max(FEWEST_STEPS) * (1.0 - 1e-12);
    let first = step_counts().find(|count| *count as f64 >= fewest);
    let others = step_counts().filter(|count| is_one_two_five(*count) && Some(*count) > first);
    first.into_iter().chain(others).map(|count| (StepControl::Fixed(tidy(end / count as f64)), count as f64)).collect()
}

/// A number without the last digits that only rounding gave it.
fn tidy(value: f64) -> f64 {
    let tidy = rounded(value, 13);
    if (tidy / value - 1.0).abs() < 1e-14 { tidy } else { value }
}

/// True if two settings differ by rounding only.
fn is_same(a: Setting, b: Setting) -> bool {
    std::mem::discriminant(&a) == std::mem::discriminant(&b) && (a.value() / b.value() - 1.0).abs() < 1e-9
}

/// Numbers of steps with which the times of comparison are met and whose steps have few digits: 1, 1.25, 1.6, … 8 times
/// a power of ten.
fn step_counts() -> impl Iterator<Item = u64> {
    (0..10_u32)
        .flat_map(|decade| [100, 125, 160, 200, 250, 320, 400, 500, 625, 800].map(|c| c * 10_u64.pow(decade)))
        .filter(|hundredfold| hundredfold % 100 == 0)
        .map(|hundredfold| hundredfold / 100)
        .filter(|count| if *count < 100 { 100 % count == 0 } else { count % 100 == 0 })
}

fn is_one_two_five(count: u64) -> bool {
    let mut leading = count;
    while leading.is_multiple_of(10) {
        leading /= 10;
    }
    matches!(leading, 1 | 2 | 5)
}

/// The settings between one and a finer one, coarsest first.
pub(super) fn settings_between(case: &PreparedScene<'_>, coarse: Setting, fine: Setting) -> Vec<StepControl> {
    match (coarse, fine) {
        (Setting::Step(coarse), Setting::Step(fine)) => step_counts()
            .map(|count| tidy(case.end() / count as f64))
            .filter(|step| *step < coarse * (1.0 - 1e-9) && *step > fine * (1.0 + 1e-9))
            .map(StepControl::Fixed)
            .collect(),
        (Setting::Tolerance(coarse), Setting::Tolerance(fine)) => [0.5, 0.2]
            .map(|part| tidy(part * coarse))
            .into_iter()
            .filter(|tolerance| *tolerance > fine * (1.0 + 1e-9))
            .map(StepControl::Tolerance)
            .collect(),
        _ => Vec::new(),
    }
}

/// The smallest of the orders of all quantities: of each, the slope of ln(error) against ln(step) between the finest two
/// runs whose errors come from the steps. `limit` is the error of what they are compared with.
fn slowest_order(rows: &[LadderRun], limit: &Errors) -> Option<f64> {
    let quantities: [fn(&Errors) -> Option<f64>; 5] =
        [|e| Some(e.attitude), |e| e.modal, |e| e.displacement, |e| e.velocity, |e| e.acceleration];
    let orders = quantities.into_iter().filter_map(|quantity| {
        let of_reference = FAR_ABOVE * quantity(limit)?;
        let mut points = rows.iter().rev().filter_map(|row| {
            let run = row.measured()?;
            let error = quantity(&run.step_errors?)?;
            let above = of_reference.max(ROUNDED).max(ROUNDED_IN_A_STEP * run.steps as f64);
            (error > above && error < COARSE).then(|| (row.setting.value().ln(), error.ln()))
        });
        let (fine, coarse) = (points.next()?, points.next()?);
        Some((coarse.1 - fine.1) / (coarse.0 - fine.0))
    });
    orders.min_by(f64::total_cmp)
}

/// Marks the runs for which no other is both closer and faster.
pub(super) fn mark_front(lines: &mut [Line]) {
    let cost = |row: &LadderRun| row.measured().map(|measured| (measured.error, measured.seconds));
    let all: Vec<(f64, f64)> = lines.iter().flat_map(|line| &line.rows).filter_map(cost).collect();
    for row in lines.iter_mut().flat_map(|line| &mut line.rows) {
        row.on_front = cost(row).is_some_and(|(error, seconds)| {
            !all.iter().any(|(e, s)| *e <= error && *s <= seconds && (*e < error || *s < seconds))
        });
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn row(step: f64, error: f64, seconds: f64) -> LadderRun {
        let measured = MeasuredRun {
            error,
            at_reference: false,
            errors: Errors { attitude: error, ..Errors::default() },
            step_errors: Some(Errors { attitude: error, ..Errors::default() }),
            energy: 0.0,
            angular_momentum: 0.0,
            spin: None,
            step_spin: None,
            steps: 1,
            rejected: 0,
            evaluations: 4,
            seconds,
            spread: 1.0,
            repeats: 3,
        };
        LadderRun::new(StepControl::Fixed(step), Outcome::Ran(measured.into()), false)
    }

    #[test]
    fn counts_of_steps_meet_the_times_of_comparison() {
        let counts: Vec<u64> = step_counts().take_while(|count| *count <= 2000).collect();
        assert_eq!(counts, [1, 2, 4, 5, 10, 20, 25, 50, 100, 200, 400, 500, 800, 1000, 1600, 2000]);
        assert!([1, 2, 5, 10, 500, 2000].into_iter().all(is_one_two_five));
        assert!([4, 25, 800, 1250].into_iter().all(|count| !is_one_two_five(count)));
    }

    #[test]
    fn steps_have_no_digits_from_rounding() {
        assert_eq!(format!("{:e}", tidy(0.3 / 1000.0)), "3e-4");
        assert_eq!(format!("{:e}", tidy(0.2 * 1e-5)), "2e-6");
        assert_eq!(tidy(0.37 / 700.0), 0.37 / 700.0);
        assert!(is_same(Setting::Step(3e-4), Setting::Step(0.3 / 1000.0)));
        assert!(!is_same(Setting::Step(1e-4), Setting::Tolerance(1e-4)));
    }

    #[test]
    fn the_front_is_what_no_other_run_beats() {
        let rows = vec![row(4.0, 1e-2, 1.0), row(2.0, 1e-3, 3.0), row(1.0, 1e-3, 2.0), row(0.5, 1e-4, 2.0)];
        let failed = LadderRun::new(StepControl::Fixed(8.0), Outcome::Failed("blown up".to_owned()), false);
        let line = |rows| Line {
            formulation: "conservative",
            scheme: "exponential",
            controlled: false,
            order: 4,
            measured_order: None,
            rows,
            method: Method::EXPONENTIAL,
        };
        let mut lines = vec![line(rows), line(vec![failed])];
        mark_front(&mut lines);
        let marks: Vec<bool> = lines.iter().flat_map(|line| &line.rows).map(|row| row.on_front).collect();
        assert_eq!(marks, [true, false, false, true, false]);
    }

    /// Closed form: errors of order 4.
    #[test]
    fn the_order_is_the_slope_of_the_errors_between_coarse_and_reference() {
        let fourth = |step: f64| row(step, 3.0 * step.powi(4), 1.0);
        let mut rows: Vec<LadderRun> = [0.2, 0.1, 0.05, 0.02].map(fourth).into();
        // Errors that do not come from the step are left out.
        rows.insert(0, row(1.0, 0.5, 1.0));
        rows.push(row(0.01, 2e-9, 1.0));
        let limit = Errors { attitude: 1e-10, ..Errors::default() };
        let order = slowest_order(&rows, &limit).unwrap();
        assert!((order - 4.0).abs() < 1e-9, "{order}");
        assert_eq!(slowest_order(&rows[..2], &limit), None);
        // Nor are those of rounding, which a run of half a million steps has more of: an order of 0.5 was told.
        let free = Errors::default();
        let mut rounded = [row(2e-3, 3.0 * 2e-3_f64.powi(4), 1.0), row(1e-3, 1.3e-11, 1.0)];
        assert!(slowest_order(&rounded, &free).unwrap() < 3.0);
        let Outcome::Ran(run) = &mut rounded[1].outcome else { panic!("it ran") };
        run.steps = 500_000;
        assert!((slowest_order(&[&rows[1..5], &rounded].concat(), &free).unwrap() - 4.0).abs() < 1e-9);
    }
}
