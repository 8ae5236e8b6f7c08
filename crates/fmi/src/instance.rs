//! An instance of an FMU, and what may be called in each phase of its life.

use diagnostic::Failure;
use flexframe::dynamics::{decode, encode};
use flexframe::fmu::{FmuModel, Manifest, Source, Variable};
use serde::{Deserialize, Serialize};

use crate::error::{broken, lost, no_bytes, no_state, refused};
use crate::location::folder_of;
use crate::motion::{self, Motion};
use crate::phase::Phase;

/// An instance.
pub struct Instance {
    guid: String,
    variables: Vec<Variable>,
    /// Seconds in the scene's unit of time.
    seconds: f64,
    phase: Phase,
    /// Stop time of the experiment, seconds.
    stop: Option<f64>,
    /// Values of the inputs, by value reference, for a motion that is still to come.
    starts: Vec<(u32, f64)>,
    body: Body,
}

/// The model, or its motion.
enum Body {
    Still(Box<FmuModel>),
    Moving(Box<Motion>),
    /// Lost by a panic; callers get [`lost`].
    Lost,
}

/// A state of an instance.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Saved {
    guid: String,
    phase: Phase,
    stop: Option<f64>,
    motion: motion::State,
}

impl Instance {
    /// Opens the FMU that was unpacked to where `location` says.
    pub fn new(guid: &str, location: &str) -> Result<Self, Failure> {
        let resources = folder_of(location)?;
        let manifest = Manifest::checked(&resources)?;
        if manifest.guid != guid {
            return Err(refused(format!(
                "the GUID {guid} is not that of this FMU, {}: modelDescription.xml and the resources are of different FMUs; unpack the FMU again",
                manifest.guid
            )));
        }
        let fmu = FmuModel::open(&resources, &manifest)?;
        Ok(Self {
            guid: manifest.guid,
            variables: fmu.variables.clone(),
            seconds: fmu.seconds,
            phase: Phase::Instantiated,
            stop: None,
            starts: Vec::new(),
            body: Body::Still(Box::new(fmu)),
        })
    }

    /// Refuses a call in a phase that it is not for.
    fn allow(&self, function: &'static str, phases: &[Phase], allowed: &'static str) -> Result<(), Failure> {
        match phases.contains(&self.phase) {
            true => Ok(()),
            false => Err(refused(format!("{function} cannot be called {}; call it {allowed}", self.phase))),
        }
    }

    fn motion(&mut self) -> Result<&mut Motion, Failure> {
        match &mut self.body {
            Body::Moving(motion) => Ok(motion),
            Body::Still(_) => Err(broken()),
            Body::Lost => Err(lost()),
        }
    }

    /// Times in seconds.
    pub fn set_up(&mut self, start: f64, stop: Option<f64>) -> Result<(), Failure> {
        self.allow("fmi2SetupExperiment", &[Phase::Instantiated], "right after fmi2Instantiate or fmi2Reset")?;
        if start != 0.0 {
            return Err(refused(format!("the start time is {start}; the scene begins at time 0: start there")));
        }
        if let Some(found) = stop.filter(|stop| !(*stop > 0.0 && stop.is_finite())) {
            return Err(refused(format!("the stop time is {found}; give a positive number, or none")));
        }
        self.stop = stop;
        Ok(())
    }

    pub fn enter_initialization(&mut self) -> Result<(), Failure> {
        self.allow("fmi2EnterInitializationMode", &[Phase::Instantiated], "once, after fmi2SetupExperiment")?;
        self.begin()?;
        self.phase = Phase::Initialization;
        Ok(())
    }

    /// Makes the motion.
    fn begin(&mut self) -> Result<(), Failure> {
        let fmu = match std::mem::replace(&mut self.body, Body::Lost) {
            Body::Still(fmu) => fmu,
            other => {
                self.body = other;
                return Ok(());
            }
        };
        match Motion::new(*fmu, self.stop.map(|stop| stop / self.seconds)) {
            Ok(mut motion) => {
                for (reference, value) in self.starts.drain(..) {
                    if let Some(number) = input_number(&self.variables, reference) {
                        motion.set_input(number, value);
                    }
                }
                self.body = Body::Moving(Box::new(motion));
                Ok(())
            }
            Err((fmu, error)) => {
                self.body = Body::Still(fmu);
                Err(error)
            }
        }
    }

    pub fn exit_initialization(&mut self) -> Result<(), Failure> {
        self.allow("fmi2ExitInitializationMode", &[Phase::Initialization], "after fmi2EnterInitializationMode")?;
        self.phase = Phase::Stepping;
        Ok(())
    }

    pub fn terminate(&mut self) -> Result<(), Failure> {
        self.allow("fmi2Terminate", &[Phase::Stepping], "after fmi2ExitInitializationMode")?;
        self.phase = Phase::Terminated;
        Ok(())
    }

    /// Back to what it was after it was made.
    pub fn reset(&mut self) -> Result<(), Failure> {
        self.body = match std::mem::replace(&mut self.body, Body::Lost) {
            Body::Moving(motion) => motion.into_model().map_or(Body::Lost, |fmu| Body::Still(Box::new(fmu))),
            other => other,
        };
        if matches!(self.body, Body::Lost) {
            return Err(lost());
        }
        self.starts.clear();
        (self.phase, self.stop) = (Phase::Instantiated, None);
        Ok(())
    }

    fn variable(&self, reference: u32) -> Result<&Variable, Failure> {
        let last = self.variables.len().saturating_sub(1);
        let words = || format!("the value reference {reference} is none of this FMU, which has 0 to {last}");
        self.variables.get(reference as usize).ok_or_else(|| refused(words()))
    }

    pub fn get_real(&mut self, references: &[u32], values: &mut [f64]) -> Result<(), Failure> {
        let phases = [Phase::Initialization, Phase::Stepping, Phase::Terminated];
        self.allow("fmi2GetReal", &phases, "from fmi2EnterInitializationMode on")?;
        for reference in references {
            self.variable(*reference)?;
        }
        let Self { variables, body: Body::Moving(motion), seconds, .. } = self else { return Err(broken()) };
        for (reference, value) in references.iter().zip(values) {
            *value = match variables[*reference as usize].source {
                Source::Time => motion.time() * *seconds,
                Source::Input(_) => motion.input(input_number(variables, *reference).unwrap_or_default()),
                Source::Row { place, .. } => motion.numbers()?.get(place).copied().unwrap_or(f64::NAN),
            };
        }
        Ok(())
    }

    /// Sets inputs: all of them or none.
    pub fn set_real(&mut self, references: &[u32], values: &[f64]) -> Result<(), Failure> {
        let phases = [Phase::Instantiated, Phase::Initialization, Phase::Stepping];
        self.allow("fmi2SetReal", &phases, "before fmi2Terminate")?;
        for (reference, value) in references.iter().zip(values) {
            let Variable { name, source, .. } = self.variable(*reference)?;
            let what = match source {
                Source::Input(_) if value.is_finite() => continue,
                Source::Input(_) => {
                    let words = format!("{name} cannot be {value}: give a finite number; nothing has been set");
                    return Err(refused(words));
                }
                Source::Time => "the time, which fmi2DoStep sets",
                Source::Row { is_output: true, .. } => "an output",
                Source::Row { is_output: false, .. } => "a variable to look at",
            };
            return Err(refused(format!(
                "{name} cannot be set: it is {what}; inputs are the variables with causality=\"input\""
            )));
        }
        for (reference, value) in references.iter().zip(values) {
            match &mut self.body {
                Body::Moving(motion) => {
                    if let Some(number) = input_number(&self.variables, *reference) {
                        motion.set_input(number, *value);
                    }
                }
                Body::Still(_) | Body::Lost => self.starts.push((*reference, *value)),
            }
        }
        Ok(())
    }

    /// Goes on from `point` by `step`, seconds. Returns what the user has to be warned of.
    pub fn step(&mut self, point: f64, step: f64) -> Result<Vec<String>, Failure> {
        self.allow("fmi2DoStep", &[Phase::Stepping], "between fmi2ExitInitializationMode and fmi2Terminate")?;
        let seconds = self.seconds;
        let motion = self.motion()?;
        motion.go(point / seconds, step / seconds)?;
        Ok(motion.warnings())
    }

    /// Seconds.
    pub fn time(&mut self) -> Result<f64, Failure> {
        let seconds = self.seconds;
        Ok(self.motion()?.time() * seconds)
    }

    pub fn save(&mut self) -> Result<Saved, Failure> {
        let phases = [Phase::Initialization, Phase::Stepping, Phase::Terminated];
        self.allow("fmi2GetFMUstate", &phases, "from fmi2EnterInitializationMode on, when there is a state")?;
        let (guid, phase, stop) = (self.guid.clone(), self.phase, self.stop);
        Ok(Saved { guid, phase, stop, motion: self.motion()?.state()? })
    }

    /// Goes back, or on, to a state that was saved; of an instance that has not begun, too. After an error everything is
    /// as it was.
    pub fn restore(&mut self, saved: &Saved) -> Result<(), Failure> {
        if saved.guid != self.guid {
            return Err(no_bytes());
        }
        if self.phase == Phase::Instantiated {
            let before = (self.stop, self.starts.clone());
            self.stop = saved.stop;
            let done = self.begin().and_then(|()| self.motion()?.set_state(&saved.motion));
            if let Err(error) = done {
                self.reset()?;
                (self.stop, self.starts) = before;
                return Err(error);
            }
        } else if saved.stop == self.stop {
            self.motion()?.set_state(&saved.motion)?;
        } else {
            return Err(no_bytes());
        }
        self.phase = saved.phase;
        Ok(())
    }

    /// As a panic while the motion is made leaves it.
    #[cfg(test)]
    pub fn lose(&mut self) {
        self.body = Body::Lost;
    }
}

/// The number of a variable among the inputs.
fn input_number(variables: &[Variable], reference: u32) -> Option<usize> {
    let is_input = |variable: &Variable| matches!(variable.source, Source::Input(_));
    let reference = reference as usize;
    variables.get(reference).filter(|variable| is_input(variable))?;
    Some(variables.iter().take(reference).filter(|variable| is_input(variable)).count())
}

impl Saved {
    /// As bytes, with a check sum.
    pub fn to_bytes(&self) -> Result<Vec<u8>, Failure> {
        let bytes = encode(self).map_err(no_state)?;
        Ok([&crc32fast::hash(&bytes).to_le_bytes(), bytes.as_slice()].concat())
    }

    /// From these bytes.
    pub fn from_bytes(bytes: &[u8]) -> Result<Self, Failure> {
        match bytes.split_first_chunk::<4>() {
            Some((sum, bytes)) if *sum == crc32fast::hash(bytes).to_le_bytes() => decode(bytes).map_err(|_| no_bytes()),
            _ => Err(no_bytes()),
        }
    }
}
