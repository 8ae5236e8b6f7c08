//! The longest steps with which loads and drives are seen as they are.

use crate::error::SetupError;
use crate::history::History;
use crate::history::formula_steps::FormulaSteps;
use crate::load::SharedLoad;
use crate::simulation::plan::Segment;

/// The loads and the other histories of a run, and the steps that they ask for. Step control does not see what swings within a step,
/// where all its stages fall on like phases.
#[derive(Debug, Clone)]
pub(crate) struct LongestStep {
    loads: Vec<SharedLoad>,
    /// Histories of drives and motors.
    drives: Vec<History>,
    formulas: FormulaSteps,
}

impl LongestStep {
    /// The longest steps of a run to `end`.
    pub(crate) fn new<'a>(
        loads: &[SharedLoad],
        drives: impl IntoIterator<Item = &'a History>,
        end: f64,
    ) -> Result<Self, SetupError> {
        let drives: Vec<History> = drives.into_iter().cloned().collect();
        let of_loads = loads.iter().filter_map(|load| load.history());
        let histories: Vec<History> = of_loads.chain(&drives).cloned().collect();
        Ok(Self { loads: loads.to_vec(), formulas: FormulaSteps::new(&histories, end)?, drives })
    }

    /// Times at which loads or drives jump.
    pub(crate) fn discontinuities(&self) -> impl Iterator<Item = f64> {
        let of_loads = self.loads.iter().flat_map(|load| load.discontinuities());
        of_loads.chain(self.drives.iter().flat_map(History::discontinuities))
    }

    /// The longest step in a segment.
    pub(crate) fn in_segment(&self, segment: &Segment) -> f64 {
        let time = segment.start + 0.5 * segment.length;
        let of_loads = self.loads.iter().map(|load| load.longest_step(time));
        let of_drives = self.drives.iter().map(|history| history.longest_step(time));
        of_loads.chain(of_drives).fold(self.formulas.longest_step(time), f64::min)
    }
}
