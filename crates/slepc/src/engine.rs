//! SLEPc as an engine of modes.

use std::path::PathBuf;
use std::sync::{Mutex, PoisonError};

use diagnostic::Failure;
use faer::MatRef;
use modal::{Eigenpairs, Engine, EngineError, EnginePhase, HeldProblem, Progress, StaticAnswers};
use whole_file::TemporaryFolder;

use crate::answers;
use crate::error::failed;
use crate::folder::{check_digest, digest, files_of_folder, write_forces, write_matrices, write_problem};
use crate::run::drive;
use crate::stop::Stop;

/// How SLEPc is used.
#[derive(Debug, Clone)]
pub struct Slepc(Way);

#[derive(Debug, Clone)]
enum Way {
    Run { ranks: usize, stop: Stop },
    Read { folder: PathBuf },
}

impl Slepc {
    /// Runs the driver on `ranks` ranks, in a temporary folder (below TMPDIR); `stop` stops it.
    pub fn run(ranks: usize, stop: Stop) -> Self {
        Self(Way::Run { ranks, stop })
    }

    /// Takes what the driver has left in a folder of [`write_folder`](crate::write_folder). Forces to which static responses are asked
    /// for are written there, for the driver to answer when it is run again.
    pub fn read(folder: impl Into<PathBuf>) -> Self {
        Self(Way::Read { folder: folder.into() })
    }

    /// The files of the folder that it reads.
    pub fn files(&self) -> Vec<PathBuf> {
        match &self.0 {
            Way::Run { .. } => Vec::new(),
            Way::Read { folder } => files_of_folder(folder),
        }
    }

    /// The engine of one body.
    pub fn engine(&self) -> Box<dyn Engine> {
        match self.0.clone() {
            Way::Run { ranks, stop } => Box::new(Runner { ranks, stop, work: Mutex::new(None) }),
            Way::Read { folder } => Box::new(Reader { folder }),
        }
    }
}

/// The same number of ranks, or the same folder.
impl PartialEq for Slepc {
    fn eq(&self, other: &Self) -> bool {
        match (&self.0, &other.0) {
            (Way::Run { ranks, .. }, Way::Run { ranks: others, .. }) => ranks == others,
            (Way::Read { folder }, Way::Read { folder: other }) => folder == other,
            _ => false,
        }
    }
}

/// Runs the driver.
struct Runner {
    ranks: usize,
    stop: Stop,
    /// Made at the first question.
    work: Mutex<Option<Work>>,
}

/// A temporary folder with the matrices.
struct Work {
    folder: TemporaryFolder,
    digest: String,
}

impl Work {
    fn new(problem: &HeldProblem<'_>) -> Result<Self, Failure> {
        let folder = TemporaryFolder::new();
        let folder = folder.map_err(failed(std::env::temp_dir(), "make a folder in it"))?;
        let digest = write_matrices(problem, folder.path())?;
        Ok(Self { folder, digest })
    }
}

impl Runner {
    /// The answer of the driver to a question about some modes, in the folder with the matrices, which are written once.
    fn ask<T>(
        &self,
        problem: &HeldProblem<'_>,
        modes: usize,
        progress: &mut dyn FnMut(Progress),
        answer: impl FnOnce(&Work, &mut dyn FnMut(Progress)) -> Result<T, Failure>,
    ) -> Result<T, EngineError> {
        let _at_work = self.stop.work();
        let mut work = self.work.lock().unwrap_or_else(PoisonError::into_inner);
        // Taken out, so that what fails leaves nothing behind.
        let there = match work.take() {
            Some(there) => there,
            None => {
                progress(Progress::Engine(EnginePhase::Writing));
                Work::new(problem)?
            }
        };
        write_problem(problem, &there.digest, modes, there.folder.path())?;
        let found = answer(&there, progress)?;
        *work = Some(there);
        Ok(found)
    }
}

impl Engine for Runner {
    fn eigenpairs(
        &self,
        problem: &HeldProblem<'_>,
        count: usize,
        progress: &mut dyn FnMut(Progress),
    ) -> Result<Eigenpairs, EngineError> {
        self.ask(problem, count, progress, |Work { folder, digest }, progress| {
            drive(folder.path(), self.ranks, &self.stop, progress)?;
            answers::eigenpairs(folder.path(), digest, problem.stiffness.size(), count)
        })
    }

    fn static_answers(&self, problem: &HeldProblem<'_>, forces: MatRef<'_, f64>) -> Result<StaticAnswers, EngineError> {
        self.ask(problem, 0, &mut |_| (), |Work { folder, digest }, progress| {
            let name = write_forces(forces, folder.path())?;
            drive(folder.path(), self.ranks, &self.stop, progress)?;
            answers::static_answers(folder.path(), &name, digest, problem.stiffness.size())
        })
    }
}

/// Reads what the driver has left.
struct Reader {
    folder: PathBuf,
}

impl Engine for Reader {
    fn eigenpairs(
        &self,
        problem: &HeldProblem<'_>,
        count: usize,
        _: &mut dyn FnMut(Progress),
    ) -> Result<Eigenpairs, EngineError> {
        answers::eigenpairs(&self.folder, &digest(problem)?, problem.stiffness.size(), count)
    }

    fn static_answers(&self, problem: &HeldProblem<'_>, forces: MatRef<'_, f64>) -> Result<StaticAnswers, EngineError> {
        let digest = digest(problem)?;
        check_digest(&self.folder, &digest)?;
        let name = write_forces(forces, &self.folder)?;
        answers::static_answers(&self.folder, &name, &digest, problem.stiffness.size())
    }
}
