//! The way through the segments of a run: how long the steps are.

use serde::{Deserialize, Serialize};

use crate::error::StepError;
use crate::motion::Motion;
use crate::motion::facts::Stepping;
use crate::simulation::checkpoint::{CheckpointError, equal_room, expect};
use crate::simulation::plan::{EqualSteps, HalvedSteps, Segment, StepControl};
use crate::simulation::stats::Stats;
use crate::tolerance::allowance::{Allowance, ErrorEstimate};
use crate::tolerance::{ErrorKinds, ErrorMeasure, StatedError};

/// First free step that is tried, as a part of the run.
const FIRST: f64 = 1e-3;
/// Exactness of iterations in steps whose error nobody bounds.
pub(crate) const EXACT: f64 = 1e-10;

/// The way through the present segment.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub(crate) enum Walk {
    /// Equal steps.
    Equal {
        step: f64,
        #[serde(with = "equal_room")]
        steps: Option<EqualSteps>,
    },
    /// Pairs of steps under a tolerance.
    Pairs {
        measure: ErrorMeasure,
        longest_try: f64,
        #[serde(with = "equal_room")]
        steps: Option<HalvedSteps>,
    },
    /// Free steps under a tolerance.
    Free {
        measure: ErrorMeasure,
        /// Longest step that the scheme allows.
        limit: f64,
        /// Length of the next try before the segment limits it, and the longest in this segment.
        next: f64,
        longest: f64,
        #[serde(with = "equal_room")]
        segment: Option<Segment>,
        is_done: bool,
    },
}

impl Walk {
    /// Before the first step of a run from `start` to `end`.
    pub(crate) fn new(control: StepControl, stepping: Stepping, [start, end]: [f64; 2]) -> Self {
        match (control, stepping) {
            (StepControl::Fixed(step), _) => Self::Equal { step, steps: None },
            (StepControl::Tolerance(tolerance), Stepping::Pairs) => {
                let measure = ErrorMeasure::new(tolerance, end - start, f64::EPSILON);
                Self::Pairs { measure, longest_try: f64::INFINITY, steps: None }
            }
            (StepControl::Tolerance(tolerance), Stepping::Free { longest: limit, rounding }) => Self::Free {
                measure: ErrorMeasure::new(tolerance, end - start, rounding),
                limit,
                next: FIRST * end,
                longest: f64::INFINITY,
                segment: None,
                is_done: false,
            },
        }
    }

    /// The segment, if there is one, and whether all its steps are done.
    fn segment(&self) -> Option<(&Segment, bool)> {
        match self {
            Self::Equal { steps, .. } => steps.as_ref().map(|steps| (&steps.segment, steps.is_done())),
            Self::Pairs { steps, .. } => steps.as_ref().map(|steps| (&steps.segment, steps.next_step().is_none())),
            Self::Free { segment, is_done, .. } => segment.as_ref().map(|segment| (segment, *is_done)),
        }
    }

    /// True if a segment has to come before the next step.
    pub(crate) fn is_done(&self) -> bool {
        self.segment().is_none_or(|(_, is_done)| is_done)
    }

    /// True at the end of a segment with a discontinuity.
    pub(crate) fn is_at_discontinuity(&self) -> bool {
        self.segment().is_some_and(|(segment, is_done)| is_done && segment.discontinuity)
    }

    /// Goes into a segment, with steps of at most this length.
    pub(crate) fn enter(&mut self, into: Segment, longest: f64) {
        match self {
            Self::Equal { step, steps } => *steps = Some(EqualSteps::new(into, step.min(longest))),
            Self::Pairs { longest_try, steps, .. } => *steps = Some(HalvedSteps::new(into, *longest_try, longest)),
            Self::Free { limit, longest: of_segment, segment, is_done, .. } => {
                (*of_segment, *segment, *is_done) = (longest.min(*limit), Some(into), false);
            }
        }
    }

    /// Leaves the segment.
    pub(crate) fn leave(&mut self) {
        match self {
            Self::Equal { steps, .. } => *steps = None,
            Self::Pairs { steps, .. } => *steps = None,
            Self::Free { segment, .. } => *segment = None,
        }
    }

    /// The measure of errors under a tolerance.
    fn measure(&self) -> Option<&ErrorMeasure> {
        match self {
            Self::Equal { .. } => None,
            Self::Pairs { measure, .. } | Self::Free { measure, .. } => Some(measure),
        }
    }

    /// The tolerance.
    pub(crate) fn tolerance(&self) -> Option<f64> {
        self.measure().map(|measure| measure.tolerance)
    }

    /// Error of the steps by their estimates.
    pub(crate) fn stated_error(&self) -> Option<StatedError> {
        self.measure().map(ErrorMeasure::stated)
    }

    /// Error that iterations may leave in parts of steps that are done again, the shortest of which was this long.
    pub(crate) fn exactness(&self, shortest: f64) -> f64 {
        self.measure().map_or(EXACT, |measure| measure.exactness(shortest.min(measure.span)))
    }

    /// True if steps are taken in pairs.
    pub(crate) fn is_in_pairs(&self) -> bool {
        matches!(self, Self::Pairs { .. })
    }

    /// Tries to go on. Returns the number of steps that were taken, and their length.
    pub(crate) fn try_step(
        &mut self,
        motion: &mut dyn Motion,
        stats: &mut Stats,
    ) -> Result<Option<(u64, f64)>, StepError> {
        match self {
            Self::Equal { steps, .. } => {
                let Some((h, end)) = steps.as_mut().and_then(EqualSteps::next_step) else { return Ok(None) };
                motion.step(h, end)?;
                Ok(Some((1, h)))
            }
            Self::Pairs { measure, longest_try, steps } => {
                let Some(steps) = steps else { return Ok(None) };
                let Some((h, end)) = steps.next_step() else { return Ok(None) };
                let (time, allowed) = (motion.time(), measure.allowed(h));
                let estimate = match motion.controlled_step(h, end, allowed) {
                    Ok(estimate) => estimate,
                    Err(error @ StepError::NoErrorEstimate { .. }) => return Err(error),
                    // A step so long that it cannot even be tried.
                    Err(_) => ErrorEstimate { step: f64::INFINITY, doubled: f64::INFINITY },
                };
                if estimate.step <= allowed {
                    measure.taken(end, &ErrorKinds { place: estimate.step, ..ErrorKinds::default() }, 0.0);
                    steps.accept(Allowance::may_double(&estimate, allowed));
                    // A step that only the segment's end made short says nothing about the next segment.
                    *longest_try = longest_try.max(steps.length());
                    return Ok(Some((2, 0.5 * h)));
                }
                stats.rejected += 2;
                measure.refused(time, end);
                if steps.reject(estimate.step / allowed) {
                    *longest_try = steps.length();
                    Ok(None)
                } else {
                    Err(StepError::Tolerance { time, step: h, tolerance: measure.tolerance })
                }
            }
            Self::Free { measure, next, longest, segment, is_done, .. } => {
                let Some(segment) = segment else { return Ok(None) };
                let mut h = next.min(*longest);
                let taken = motion.free_step(segment.end, measure, &mut h)?;
                // What only the segment made short says nothing about the next one.
                *next = if taken.is_none() || h < *next { h } else { next.max(h) };
                *is_done = motion.time() >= segment.end;
                stats.rejected += u64::from(taken.is_none());
                Ok(taken.map(|length| (1, length)))
            }
        }
    }

    /// Refuses what a run of this one cannot leave.
    pub(crate) fn check_saved(&self, saved: &Self) -> Result<(), CheckpointError> {
        match (self, saved) {
            (Self::Equal { step, .. }, Self::Equal { step: found, steps }) => {
                expect("the step", step == found)?;
                steps.iter().try_for_each(EqualSteps::check)
            }
            (Self::Pairs { measure, .. }, Self::Pairs { measure: found, longest_try, steps }) => {
                measure.check_saved(found)?;
                expect("the longest step to try", *longest_try > 0.0)?;
                steps.iter().try_for_each(HalvedSteps::check)
            }
            (
                Self::Free { measure, limit: own, .. },
                Self::Free { measure: found, limit, next, longest, segment, .. },
            ) => {
                measure.check_saved(found)?;
                expect("the next step", limit == own && *next > 0.0 && *longest > 0.0)?;
                segment.iter().try_for_each(Segment::check)
            }
            _ => expect("the kind of step control", false),
        }
    }
}
