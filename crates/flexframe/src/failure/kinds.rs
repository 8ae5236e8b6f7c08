//! The kind of every error, and what it knows: the one place where that is decided.

use std::error::Error;
use std::io;
use std::iter::successors;
use std::path::Path;

use advice::AdviceError;
use dynamics::{LoadedError, SetupError};
use fem_tet10::{AssemblyError, MeshError, MeshFault};
use figures::FigureError;
use memory::OutOfMemory;
use mesh_import::ImportError;
use modal::ModalError;
use model::{BuildError, StartError};
use nonlinear::NonlinearError;
use reduced_body::BodyError;
use report::ReportError;
use results::FileError;
use scene::SceneError;
use sealed::SealedError;
use shock::ShockError;
use slepc::SlepcError;
use whole_file::{NoTemporaryFolder, cure_of_temporaries};

use super::{CURE, Details, FailureReport, Kind};
use crate::commands::campbell::CampbellError;
use crate::commands::check::CheckError;
use crate::commands::cost::CostError;
use crate::commands::export::ExportError;
use crate::commands::fmu::FmuError;
use crate::commands::linear::fit::FitError;
use crate::commands::linear::gradient::GradientError;
use crate::commands::linear::linearize::LinearizeError;
use crate::commands::linear::psd::PsdError;
use crate::commands::linear::shock::ShockResponseError;
use crate::commands::linear::spectra::SpectraError;
use crate::commands::linear::srs::SrsError;
use crate::commands::paper::PaperError;
use crate::commands::pictures::animation::{AnimationError, FilmError};
use crate::commands::pictures::html_report::HtmlReportError;
use crate::commands::run::RunError;
use crate::commands::sweep::{SWEEP_CURE, SweepError};
use crate::commands::system_modes::SystemModesError;
use crate::drawn::DrawnError;
use crate::files::given_file::OtherFile;
use crate::files::outputs::OutputError;
use crate::files::write_error::WriteError;

/// The kind of an error and its details, each from the innermost of its sources that knows it. A computation that nothing is known
/// of did not come to its end.
pub fn known(error: &(dyn Error + 'static)) -> (Kind, Details) {
    let sources = successors(Some(error), |&error| error.source());
    let known = sources.filter_map(|error| FAULTS.iter().find_map(|known| known(error)));
    let innermost = |outer: Known, inner: Known| Known(inner.0.or(outer.0), inner.1.or(outer.1));
    let Known(kind, details) = known.fold(Known::default(), innermost);
    (kind.unwrap_or(Kind::Run), details)
}

impl FailureReport {
    /// The failure of an error.
    pub fn of(error: &(dyn Error + 'static)) -> Self {
        let (kind, details) = known(error);
        let message = error.to_string();
        let mut sources =
            successors(Some(error), |&error| error.source()).filter_map(|error| error.downcast_ref::<io::Error>());
        let none = |source: &io::Error| Some(source.get_ref()?.downcast_ref::<NoTemporaryFolder>()?.to_string());
        if let Some(none) = sources.find_map(none) {
            return Self::new(Kind::Io, none, Details::of_file(std::env::temp_dir()));
        }
        match cure_of_temporaries(error, &message) {
            Some(cure) => Self::new(Kind::Io, format!("{message}{CURE}{cure}"), details),
            None => Self::new(kind, message, details),
        }
    }
}

/// Kind, place and details of an error, besides those of its source.
#[derive(Default)]
struct Known(Option<Kind>, Details);

impl Kind {
    /// With details.
    fn with(self, details: Details) -> Known {
        Known(Some(self), details)
    }

    /// In a file.
    fn of(self, file: impl AsRef<Path>) -> Known {
        self.with(Details::of_file(file))
    }

    /// Without details.
    fn alone(self) -> Known {
        self.with(Details::default())
    }
}

/// A file, where the source knows the kind.
fn in_file(file: impl AsRef<Path>) -> Known {
    Known(None, Details::of_file(file))
}

/// An error that knows something.
trait Fault: Error {
    fn known(&self) -> Known;
}

/// All of them.
const FAULTS: [fn(&(dyn Error + 'static)) -> Option<Known>; 40] = [
    known_by::<io::Error>,
    known_by::<OutOfMemory>,
    known_by::<SceneError>,
    known_by::<MeshError>,
    known_by::<AssemblyError>,
    known_by::<ModalError>,
    known_by::<SlepcError>,
    known_by::<AdviceError>,
    known_by::<ImportError>,
    known_by::<BuildError>,
    known_by::<LoadedError>,
    known_by::<SetupError>,
    known_by::<StartError>,
    known_by::<SealedError>,
    known_by::<FileError>,
    known_by::<FigureError>,
    known_by::<ReportError>,
    known_by::<WriteError>,
    known_by::<OutputError>,
    known_by::<OtherFile>,
    known_by::<DrawnError>,
    known_by::<RunError>,
    known_by::<CheckError>,
    known_by::<NonlinearError>,
    known_by::<FmuError>,
    known_by::<AnimationError>,
    known_by::<ExportError>,
    known_by::<HtmlReportError>,
    known_by::<CampbellError>,
    known_by::<LinearizeError>,
    known_by::<PsdError>,
    known_by::<ShockResponseError>,
    known_by::<SpectraError>,
    known_by::<SystemModesError>,
    known_by::<CostError>,
    known_by::<PaperError>,
    known_by::<SweepError>,
    known_by::<SrsError>,
    known_by::<FitError>,
    known_by::<GradientError>,
];

/// Kind, place and details of an error of this type, in a box or not.
fn known_by<E: Fault + 'static>(error: &(dyn Error + 'static)) -> Option<Known> {
    let boxed = || error.downcast_ref::<Box<E>>().map(|error| &**error);
    error.downcast_ref::<E>().or_else(boxed).map(Fault::known)
}

impl Fault for io::Error {
    fn known(&self) -> Known {
        Kind::Io.alone()
    }
}

impl Fault for OutOfMemory {
    fn known(&self) -> Known {
        Kind::Io.alone()
    }
}

impl Fault for SceneError {
    fn known(&self) -> Known {
        let kind = if matches!(self, Self::Unreadable { .. }) { Kind::Io } else { Kind::Input };
        kind.with(Details {
            line: self.line(),
            key: self.place().map(|place| place.key.clone()).filter(|key| !key.is_empty()),
            found: self.found(),
            expected: self.expected(),
            help: self.help(),
            ..Details::of_file(self.file())
        })
    }
}

impl Fault for MeshError {
    fn known(&self) -> Known {
        let details = Details { line: self.line(), ..Details::of_file(&self.mesh) };
        Kind::Input.with(match &self.fault {
            MeshFault::Syntax { expected, found, .. } => {
                Details { expected: Some(expected.clone()), found: Some(found.clone()), ..details }
            }
            _ => details,
        })
    }
}

impl Fault for AssemblyError {
    fn known(&self) -> Known {
        Kind::Input.with(self.mesh.as_ref().map_or_else(Details::default, Details::of_file))
    }
}

impl Fault for ModalError {
    fn known(&self) -> Known {
        match self {
            Self::TooManyModes { .. }
            | Self::HeldNode { .. }
            | Self::HeldFreedom { .. }
            | Self::Body(BodyError::NotUnit { .. }) => Kind::Input,
            Self::Engine(_)
            | Self::WrongAnswers { .. }
            | Self::Ordering { .. }
            | Self::Factorization { .. }
            | Self::NotConverged { .. }
            | Self::StaticNotConverged { .. }
            | Self::NotPositiveDefinite { .. }
            | Self::DenseEigen { .. } => Kind::Run,
            _ => Kind::Refused,
        }
        .alone()
    }
}

impl Fault for SlepcError {
    fn known(&self) -> Known {
        let words = |found: &str, help: &str| Details {
            found: Some(found.to_owned()),
            help: Some(help.to_owned()),
            ..Details::default()
        };
        match self {
            Self::NotInstalled { found, help } => Kind::Io.with(words(found, help)),
            Self::Refused { found, help } => Kind::Run.with(words(found, help)),
            Self::Failed { status, help, .. } => Kind::Run.with(words(status, help)),
            Self::Stopped { .. } => Kind::Stopped.alone(),
            Self::Io { path, .. } | Self::NotFinished { folder: path, .. } => Kind::Io.of(path),
            Self::Damaged { path, .. } | Self::OtherMatrices { folder: path } | Self::FewModes { folder: path, .. } => {
                Kind::Input.of(path)
            }
            _ => Kind::Input.alone(),
        }
    }
}

impl Fault for AdviceError {
    fn known(&self) -> Known {
        if matches!(self, Self::Eigen(_)) { Kind::Run.alone() } else { Kind::Input.alone() }
    }
}

impl Fault for ImportError {
    fn known(&self) -> Known {
        match self {
            Self::NoReader { .. } | Self::Io { .. } => Kind::Io.of(self.source_name()),
            _ => Kind::Input.of(self.source_name()),
        }
    }
}

impl Fault for BuildError {
    fn known(&self) -> Known {
        match self {
            Self::Modal { scene, .. } | Self::Loaded { scene, .. } => in_file(scene),
            Self::Refused { scene, .. } => Kind::Refused.of(scene),
            _ => Known::default(),
        }
    }
}

impl Fault for LoadedError {
    fn known(&self) -> Known {
        if matches!(self, Self::NoRest) { Kind::Refused.alone() } else { Kind::Run.alone() }
    }
}

impl Fault for SetupError {
    fn known(&self) -> Known {
        match self {
            Self::FormulaTooFast { .. }
            | Self::StepBeyondLimit { .. }
            | Self::StepBeyondBody { .. }
            | Self::StepBeyondSpin { .. }
            | Self::MotionLeft { .. }
            | Self::CollinearPoints(_)
            | Self::Inertia(_) => Kind::Refused.alone(),
            _ => Kind::Input.alone(),
        }
    }
}

impl Fault for StartError {
    fn known(&self) -> Known {
        Kind::Refused.with(match self {
            Self::Step { at, found, expected, help } => Details {
                line: Some(at.line),
                key: Some(at.key.clone()),
                found: Some(found.clone()),
                expected: Some(expected.clone()),
                help: Some((*help).to_owned()),
                ..Details::of_file(&at.file)
            },
            Self::Tied { at } | Self::Point { at, .. } => {
                Details { line: Some(at.line), key: Some(at.key.clone()), ..Details::of_file(&at.file) }
            }
            _ => Details::default(),
        })
    }
}

impl Fault for SealedError {
    fn known(&self) -> Known {
        // What is wrong with a file's content, or with the names in it.
        let kind = if matches!(self, Self::Hdf5 { .. }) { Kind::Io } else { Kind::Input };
        kind.with(Details { help: self.help().map(str::to_owned), ..Details::of_file(self.path()) })
    }
}

impl Fault for FileError {
    fn known(&self) -> Known {
        match self {
            Self::Busy { .. }
            | Self::Exists { .. }
            | Self::Unfinished { .. }
            | Self::NotResults { .. }
            | Self::Link { .. }
            | Self::NothingToResume { .. } => Kind::Io,
            Self::NotFinite { .. } => Kind::Run,
            // What is wrong with a file's content, or with the names in it.
            _ => Kind::Input,
        }
        .of(self.path())
    }
}

impl Fault for FigureError {
    fn known(&self) -> Known {
        if let Self::Write { path, .. } = self { Kind::Io.of(path) } else { Known::default() }
    }
}

impl Fault for ReportError {
    fn known(&self) -> Known {
        if let Self::Write { path, .. } = self { in_file(path) } else { Known::default() }
    }
}

impl Fault for WriteError {
    fn known(&self) -> Known {
        in_file(&self.path)
    }
}

impl Fault for OutputError {
    fn known(&self) -> Known {
        match self {
            Self::IsInput { path, .. } => Kind::Usage.of(path),
            Self::OtherEnding(error) => {
                let (found, expected) = (Some(error.found.to_owned()), Some(error.expected.to_owned()));
                Kind::Usage.with(Details { found, expected, ..Details::of_file(&error.path) })
            }
            Self::Exists { path }
            | Self::Folder { path }
            | Self::LostLink { path }
            | Self::Device { path, .. }
            | Self::NoFolder { path, .. } => Kind::Io.of(path),
        }
    }
}

impl Fault for OtherFile {
    fn known(&self) -> Known {
        Kind::Input.with(Details {
            found: Some(self.found.in_words().to_owned()),
            expected: Some(self.expected.to_owned()),
            help: Some(self.found.taken_by(&self.path)),
            ..Details::of_file(&self.path)
        })
    }
}

impl Fault for DrawnError {
    fn known(&self) -> Known {
        match self {
            Self::File(_) | Self::BodyFile(_) => Known::default(),
            Self::NoBodyFile { results: path, .. } | Self::OtherBody { body_file: path, .. } => Kind::Input.of(path),
        }
    }
}

impl Fault for RunError {
    fn known(&self) -> Known {
        match self {
            Self::Build(_) | Self::File(_) | Self::Scene(_) | Self::Output(_) => Known::default(),
            Self::Setup { scene: path, .. } | Self::Verify { scene: path, .. } | Self::Folder { folder: path, .. } => {
                in_file(path)
            }
            Self::Step { results, .. } => Kind::Run.of(results),
            Self::Refused { results, .. } => Kind::Refused.of(results),
            Self::Stopped { part, .. } => Kind::Stopped.of(part),
            Self::Restore { part, .. } | Self::Changed { part, .. } => Kind::Input.of(part),
            Self::Large { scene, estimate } => Kind::Refused.with(Details {
                key: Some("output.interval".to_owned()),
                found: Some(estimate.to_string()),
                expected: Some("1 GB at the most".to_owned()),
                help: Some("name fewer rows in [output], or allow it with --large".to_owned()),
                ..Details::of_file(scene)
            }),
        }
    }
}

impl Fault for CheckError {
    fn known(&self) -> Known {
        match self {
            Self::File(_) | Self::Scene(_) | Self::Build(_) => Known::default(),
            Self::Changed { file, .. } | Self::NoRows { file } => Kind::Input.of(file),
            Self::NoRow { file, asked, rows } => Kind::Usage.with(Details {
                key: Some("--rows".to_owned()),
                found: Some(asked.to_string()),
                expected: Some(format!("a number from 0 to {}", rows - 1)),
                ..Details::of_file(file)
            }),
            Self::Full { scene, .. } => in_file(scene),
        }
    }
}

impl Fault for NonlinearError {
    fn known(&self) -> Known {
        match self {
            Self::Assembly(_) | Self::Mesh(_) | Self::Modal(_) => Known::default(),
            Self::Singular | Self::NoEquilibrium { .. } | Self::NotFinite { .. } => Kind::Run.alone(),
        }
    }
}

impl Fault for FmuError {
    fn known(&self) -> Known {
        match self {
            Self::Scene(_) | Self::Build(_) | Self::Body(_) | Self::Write(_) => Known::default(),
            Self::Start { scene, .. } => in_file(scene),
            Self::Library { path, .. } | Self::Unreadable { path, .. } | Self::Missing { path, .. } => {
                Kind::Io.of(path)
            }
            Self::Platform { .. } => Kind::Refused.alone(),
            Self::NoScene { path } | Self::Damaged { path } => Kind::Input.of(path),
            Self::NoBody | Self::Text(_) | Self::Version { .. } => Kind::Input.alone(),
        }
    }
}

impl Fault for AnimationError {
    fn known(&self) -> Known {
        match self {
            Self::Run(_) | Self::Export(_) | Self::Figure(_) | Self::Build(_) | Self::Scene(_) | Self::Modes(_) => {
                Known::default()
            }
            Self::Step { scene, .. } => Kind::Run.of(scene),
            Self::NoStress { file } => Kind::Input.of(file),
            Self::NoSuchMode { scene, .. } | Self::SeveralMotions { scene, .. } => Kind::Usage.of(scene),
            Self::Film(FilmError::OtherFormat { path }) => Kind::Usage.of(path),
            Self::Film(FilmError::Figure(_)) => Known::default(),
            Self::Film(
                FilmError::NoProgram { path, .. }
                | FilmError::NoEncoder { path, .. }
                | FilmError::Failed { path, .. }
                | FilmError::Io { path, .. },
            ) => Kind::Io.of(path),
            Self::Times { from, to, end } => Kind::Usage.with(Details {
                key: Some("--from, --to".to_owned()),
                found: Some(format!("{from} to {to}")),
                expected: Some(format!("a part of 0 to {end}")),
                ..Details::default()
            }),
        }
    }
}

impl Fault for ExportError {
    fn known(&self) -> Known {
        match self {
            Self::File(_) | Self::Write(_) | Self::Output(_) | Self::Drawn(_) => Known::default(),
            Self::NoElements { path } | Self::NoModes { path } => Kind::Input.of(path),
            Self::NoRows { path, .. } | Self::NoColumn { path, .. } => Kind::Usage.of(path),
        }
    }
}

impl Fault for HtmlReportError {
    fn known(&self) -> Known {
        match self {
            Self::NoColumns { results } | Self::Changed { results, .. } => Kind::Input.of(results),
            Self::Live { results, .. } => Kind::Usage.of(results),
            Self::Apart { other, .. } => Kind::Input.of(other),
            Self::Drawn(_) | Self::Page(_) | Self::Scene(_) | Self::Build(_) => Known::default(),
        }
    }
}

impl Fault for CampbellError {
    fn known(&self) -> Known {
        match self {
            Self::Build(_) | Self::System(_) | Self::Figure(_) | Self::Write(_) => Known::default(),
            Self::Eigen { scene, .. } | Self::Steady { scene, .. } => Kind::Run.of(scene),
            Self::Full { scene, .. } | Self::Bent { scene, .. } => Kind::Run.of(scene),
            Self::Rotor { scene, .. } => Kind::Refused.of(scene),
            Self::NoAxis { scene, .. } | Self::NoFullBody { scene, .. } | Self::WithoutEffect { scene } => {
                Kind::Usage.of(scene)
            }
            Self::Axis { .. } | Self::Speeds { .. } | Self::Order { .. } => Kind::Usage.alone(),
        }
    }
}

impl Fault for GradientError {
    fn known(&self) -> Known {
        match self {
            Self::Build(_) | Self::System(_) | Self::Write(_) => Known::default(),
            Self::Frequencies { .. } | Self::Number { .. } => Kind::Usage.alone(),
            Self::Resonance { scene, .. } => Kind::Run.of(scene),
            Self::Loaded { scene } | Self::Critical { scene, .. } | Self::Outside { scene, .. } => {
                Kind::Refused.of(scene)
            }
            Self::NotFinite { scene, .. } => Kind::Run.of(scene),
            Self::Systems { scene, .. } => Kind::Input.of(scene),
        }
    }
}

impl Fault for FitError {
    fn known(&self) -> Known {
        match self {
            Self::Build(_) | Self::Scene(_) | Self::Gradient(_) | Self::Write(_) => Known::default(),
            Self::Shapes { file } | Self::FewModes { file, .. } => Kind::Input.of(file),
            Self::NoTable | Self::NoParameters { .. } | Self::NoKey { .. } => Kind::Usage.alone(),
            Self::TooFew { file, .. } => Kind::Input.of(file),
            Self::SomeDeviations { file, line } => {
                Kind::Input.with(Details { line: Some(*line), ..Details::of_file(file) })
            }
            Self::NoInfluence { .. } | Self::Gone { .. } | Self::Apart { .. } => Kind::Refused.alone(),
            Self::NotFound { .. } => Kind::Run.alone(),
        }
    }
}

impl Fault for SrsError {
    fn known(&self) -> Known {
        match self {
            Self::Figure(_) | Self::Page(_) | Self::Write(_) => Known::default(),
            Self::Unreadable { path, .. } => Kind::Io.of(path),
            Self::Points { path, source } => {
                Kind::Input.with(Details { line: Some(source.line), ..Details::of_file(path) })
            }
            Self::Table { path, .. } => Kind::Input.of(path),
            Self::Shock { table, source: ShockError::Rows { .. } } => Kind::Input.of(table),
            Self::Shock { table, .. } => Kind::Usage.of(table),
            Self::Frequencies { .. } | Self::Dampings { .. } => Kind::Usage.alone(),
        }
    }
}

impl Fault for LinearizeError {
    fn known(&self) -> Known {
        match self {
            Self::Build(_) | Self::Begin(_) | Self::Write(_) | Self::Figure(_) | Self::Page(_) => Known::default(),
            Self::Steady { scene, .. } | Self::Rest { scene, .. } => Kind::Run.of(scene),
            Self::Linear { scene, .. } | Self::Refused { scene, .. } => Kind::Refused.of(scene),
            Self::Run { scene, .. } => Kind::Run.of(scene),
            Self::State { scene, .. } => Kind::Refused.of(scene),
            Self::NoChannel { scene, .. } | Self::Nothing { scene, .. } | Self::Time { scene, .. } => {
                Kind::Usage.of(scene)
            }
            Self::Ending { .. } | Self::Frequencies { .. } => Kind::Usage.alone(),
        }
    }
}

impl Fault for PsdError {
    fn known(&self) -> Known {
        match self {
            Self::Linearize(_) | Self::Spectra(_) | Self::Write(_) | Self::Figure(_) | Self::Page(_) => {
                Known::default()
            }
            Self::Linear { scene, .. } => Kind::Refused.of(scene),
        }
    }
}

impl Fault for ShockResponseError {
    fn known(&self) -> Known {
        match self {
            Self::Linearize(_) | Self::Table(_) => Known::default(),
            Self::Linear { scene, .. } => Kind::Refused.of(scene),
            Self::Inputs { scene, .. } | Self::Outputs { scene } => Kind::Usage.of(scene),
            Self::Shock { table, .. } => Kind::Input.of(table),
        }
    }
}

impl Fault for SpectraError {
    fn known(&self) -> Known {
        match self {
            Self::Unreadable { path, .. } => Kind::Io.of(path),
            Self::Row { path, line, .. } => Kind::Input.with(Details { line: Some(*line), ..Details::of_file(path) }),
            Self::Header { path, .. } | Self::Input { path, .. } => {
                Kind::Input.with(Details { line: Some(1), ..Details::of_file(path) })
            }
            Self::Few { path, .. } => Kind::Input.of(path),
            Self::Short { path, .. } => Kind::Usage.of(path),
            Self::Band { .. } => Kind::Usage.alone(),
        }
    }
}

impl Fault for SystemModesError {
    fn known(&self) -> Known {
        match self {
            Self::Build(_) | Self::Begin(_) => Known::default(),
            Self::Run { scene, .. } | Self::Steady { scene, .. } => Kind::Run.of(scene),
        }
    }
}

impl Fault for CostError {
    fn known(&self) -> Known {
        match self {
            Self::Build(_) | Self::Start(_) | Self::Figure(_) | Self::Write(_) | Self::Output(_) => Known::default(),
            Self::Reference { scene, .. } => in_file(scene),
        }
    }
}

impl Fault for PaperError {
    fn known(&self) -> Known {
        match self {
            Self::Run(_) | Self::Build(_) | Self::File(_) | Self::Figure(_) => Known::default(),
            Self::RigidBody(_) => Kind::Refused.alone(),
            Self::Step(_) => Kind::Run.alone(),
            Self::MissingPoint { scene, .. } | Self::NotThePlate { scene } => Kind::Input.of(scene),
            Self::Report { path, .. } => Kind::Io.of(path),
        }
    }
}

impl Fault for SweepError {
    fn known(&self) -> Known {
        match self {
            Self::Scene { .. } | Self::Build(_) | Self::Table(_) | Self::Write(_) | Self::Output(_) => Known::default(),
            Self::Unreadable { path, .. }
            | Self::OtherTable { path, .. }
            | Self::OtherFiles { path, .. }
            | Self::OtherCsv { path }
            | Self::Busy { path }
            | Self::NoShard { first: path, .. } => Kind::Io.of(path),
            Self::AllFailed { path, .. } => Kind::Run.of(path),
            Self::Form { path, .. } => Kind::Input.of(path),
            Self::Invalid { path, key, found, expected } => Kind::Input.with(Details {
                key: Some(key.clone()),
                found: Some(found.clone()),
                expected: Some(expected.clone()),
                help: Some(SWEEP_CURE.to_owned()),
                ..Details::of_file(path)
            }),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn kind_and_details_are_of_the_innermost_source_that_knows_them() {
        let of = |error: RunError| known(&error);
        let scene = || "a.toml".into();
        let mesh = fem_tet10::parse_msh(b"$MeshFormat\n4.1 x", "a.msh").unwrap_err();
        let (kind, details) = of(BuildError::from(Box::new(ImportError::from(mesh))).into());
        assert_eq!((kind, details.file.as_deref(), details.line), (Kind::Input, Some("a.msh"), Some(2)));
        let stopped = ModalError::Engine(SlepcError::Stopped { command: "mpirun".to_owned() }.into());
        let (kind, details) = of(BuildError::Modal { scene: scene(), source: stopped }.into());
        assert_eq!((kind, details.file.as_deref()), (Kind::Stopped, Some("a.toml")));
        let source = SetupError::StepBeyondSpin { step: 1.0, limit: 0.1, spin: 2.0 };
        let (kind, details) = of(RunError::Setup { scene: scene(), source: Box::new(source.into()) });
        assert_eq!((kind, details), (Kind::Refused, Details::of_file("a.toml")));
        assert_eq!(known(&std::fmt::Error), (Kind::Run, Details::default()));
    }
}
