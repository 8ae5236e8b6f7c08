//! The kind of every error, and what it knows: the one place where that is decided.

use advice::AdviceError;
use dynamics::{EigenError, LoadedError, SetupError};
use fem_tet10::{AssemblyError, MeshError};
use figures::FigureError;
use mesh_import::ImportError;
use modal::ModalError;
use model::{BuildError, StartError};
use report::ReportError;
use results::FileError;
use scene::SceneError;
use sealed::SealedError;
use slepc::SlepcError;

use super::{Details, Failure, Kind};
use crate::commands::animation::AnimationError;
use crate::commands::campbell::CampbellError;
use crate::commands::cost::CostError;
use crate::commands::export::ExportError;
use crate::commands::fmu::FmuError;
use crate::commands::html_report::HtmlReportError;
use crate::commands::mode_shapes::ShapesError;
use crate::commands::new_scene::NewSceneError;
use crate::commands::paper::PaperError;
use crate::commands::run::{RunError, RunFailure};
use crate::commands::sweep::{SWEEP_CURE, SweepError};
use crate::drawn::DrawnError;
use crate::files::given_file::OtherFile;
use crate::files::outputs::OutputError;
use crate::files::write_error::WriteError;

impl Failure for SceneError {
    fn kind(&self) -> Kind {
        match self {
            Self::Unreadable { .. } => Kind::Io,
            _ => Kind::Input,
        }
    }

    fn details(&self) -> Details {
        Details {
            line: self.line(),
            key: self.place().map(|place| place.key.clone()).filter(|key| !key.is_empty()),
            found: self.found(),
            expected: self.expected(),
            help: self.help(),
            ..Details::of_file(self.file())
        }
    }
}

impl Failure for MeshError {
    fn kind(&self) -> Kind {
        match self {
            Self::Io { .. } | Self::Memory { .. } => Kind::Io,
            _ => Kind::Input,
        }
    }

    fn details(&self) -> Details {
        let mut details = Details { line: self.line(), ..Details::of_file(self.source_name()) };
        if let Self::Syntax { expected, found, .. } = self {
            details.expected = Some(expected.clone());
            details.found = Some(found.clone());
        }
        details
    }
}

impl Failure for FmuError {
    fn kind(&self) -> Kind {
        match self {
            Self::Scene(error) => error.kind(),
            Self::Build(error) => error.kind(),
            Self::Start { source, .. } => source.kind(),
            Self::Body(error) => error.kind(),
            Self::Unreadable { .. } | Self::Missing { .. } | Self::Library { .. } | Self::Write(_) => Kind::Io,
            Self::Platform { .. } => Kind::Refused,
            Self::NoBody | Self::NoScene { .. } | Self::Text(_) | Self::Damaged { .. } | Self::Version { .. } => {
                Kind::Input
            }
        }
    }

    fn details(&self) -> Details {
        match self {
            Self::Scene(error) => error.details(),
            Self::Build(error) => error.details(),
            Self::Start { scene, source } => Details { file: Details::of_file(scene).file, ..source.details() },
            Self::Body(error) => error.details(),
            Self::Write(error) => error.details(),
            Self::Library { path, .. }
            | Self::NoScene { path }
            | Self::Unreadable { path, .. }
            | Self::Missing { path, .. }
            | Self::Damaged { path } => Details::of_file(path),
            Self::NoBody | Self::Platform { .. } | Self::Text(_) | Self::Version { .. } => Details::default(),
        }
    }
}

impl Failure for AssemblyError {
    fn kind(&self) -> Kind {
        match self {
            Self::Memory(_) => Kind::Io,
            _ => Kind::Input,
        }
    }

    fn details(&self) -> Details {
        self.source_name().map_or_else(Details::default, Details::of_file)
    }
}

impl Failure for ModalError {
    fn kind(&self) -> Kind {
        match self {
            Self::TooManyModes { .. } | Self::HeldNode { .. } | Self::HeldFreedom { .. } | Self::NotUnit { .. } => {
                Kind::Input
            }
            Self::Memory(_) => Kind::Io,
            Self::Engine(source) => source.downcast_ref::<SlepcError>().map_or(Kind::Run, Failure::kind),
            Self::WrongAnswers { .. } => Kind::Run,
            Self::Ordering { .. }
            | Self::Factorization { .. }
            | Self::NotConverged { .. }
            | Self::StaticNotConverged { .. }
            | Self::NotPositiveDefinite { .. }
            | Self::DenseEigen { .. } => Kind::Run,
            _ => Kind::Refused,
        }
    }

    fn details(&self) -> Details {
        match self {
            Self::Engine(source) => source.downcast_ref::<SlepcError>().map_or_else(Details::default, Failure::details),
            _ => Details::default(),
        }
    }
}

impl Failure for SlepcError {
    fn kind(&self) -> Kind {
        match self {
            Self::NotInstalled { .. } | Self::Io { .. } | Self::NotFinished { .. } => Kind::Io,
            Self::Refused { .. } | Self::Failed { .. } => Kind::Run,
            Self::Stopped { .. } => Kind::Stopped,
            _ => Kind::Input,
        }
    }

    fn details(&self) -> Details {
        match self {
            Self::NotInstalled { found, help } | Self::Refused { found, help } => {
                Details { found: Some(found.clone()), help: Some(help.clone()), ..Details::default() }
            }
            Self::Failed { status, help, .. } => {
                Details { found: Some(status.clone()), help: Some(help.clone()), ..Details::default() }
            }
            Self::Io { path, .. } | Self::Damaged { path, .. } => Details::of_file(path),
            Self::NotFinished { folder, .. } | Self::OtherMatrices { folder } | Self::FewModes { folder, .. } => {
                Details::of_file(folder)
            }
            _ => Details::default(),
        }
    }
}

impl Failure for EigenError {
    fn kind(&self) -> Kind {
        Kind::Run
    }
}

impl Failure for AdviceError {
    fn kind(&self) -> Kind {
        match self {
            Self::Eigen(error) => error.kind(),
            _ => Kind::Input,
        }
    }
}

impl Failure for ImportError {
    fn kind(&self) -> Kind {
        match self {
            Self::Mesh(error) => error.kind(),
            Self::NoReader { .. } | Self::Io { .. } => Kind::Io,
            _ => Kind::Input,
        }
    }

    fn details(&self) -> Details {
        match self {
            Self::Mesh(error) => error.details(),
            other => Details::of_file(other.source_name()),
        }
    }
}

impl Failure for BuildError {
    fn kind(&self) -> Kind {
        match self {
            Self::Scene(error) => error.kind(),
            Self::Mesh(error) => error.kind(),
            Self::Import(error) => error.kind(),
            Self::Assembly(error) => error.kind(),
            Self::Modal { source, .. } => source.kind(),
            Self::Advice(error) => error.kind(),
            Self::Load(error) => error.kind(),
            Self::BodyFile(error) => error.kind(),
            Self::Loaded { source, .. } => source.kind(),
            _ => Kind::Run,
        }
    }

    fn details(&self) -> Details {
        match self {
            Self::Scene(error) => error.details(),
            Self::Mesh(error) => error.details(),
            Self::Import(error) => error.details(),
            Self::Assembly(error) => error.details(),
            Self::Modal { scene, source } => {
                let details = source.details();
                Details { file: details.file.clone().or(Details::of_file(scene).file), ..details }
            }
            Self::Advice(error) => error.details(),
            Self::Load(error) => error.details(),
            Self::BodyFile(error) => error.details(),
            Self::Loaded { scene, .. } => Details::of_file(scene),
            _ => Details::default(),
        }
    }
}

impl Failure for LoadedError {
    fn kind(&self) -> Kind {
        match self {
            Self::Setup(error) => error.kind(),
            Self::Eigen(error) => error.kind(),
            Self::NoRest => Kind::Refused,
            Self::Rates(_) => Kind::Run,
        }
    }
}

impl Failure for SetupError {
    fn kind(&self) -> Kind {
        match self {
            Self::FormulaTooFast { .. }
            | Self::StepBeyondLimit { .. }
            | Self::StepBeyondSpin { .. }
            | Self::MotionLeft { .. }
            | Self::CollinearPoints(_)
            | Self::Inertia(_) => Kind::Refused,
            _ => Kind::Input,
        }
    }
}

impl Failure for StartError {
    fn kind(&self) -> Kind {
        match self {
            Self::Setup(error) => error.kind(),
            _ => Kind::Refused,
        }
    }

    fn details(&self) -> Details {
        match self {
            Self::Step { at, found, expected, help } => Details {
                line: Some(at.line),
                key: Some(at.key.clone()),
                found: Some(found.clone()),
                expected: Some(expected.clone()),
                help: Some((*help).to_owned()),
                ..Details::of_file(&at.file)
            },
            _ => Details::default(),
        }
    }
}

impl Failure for RunFailure {
    fn kind(&self) -> Kind {
        match self {
            Self::Start(error) => error.kind(),
            Self::Step(_) | Self::OutOfPatience { .. } => Kind::Run,
        }
    }
}

impl Failure for RunError {
    fn kind(&self) -> Kind {
        match self {
            Self::Build(error) => error.kind(),
            Self::Setup { source, .. } => source.kind(),
            Self::Step { .. } => Kind::Run,
            Self::Refused { .. } => Kind::Refused,
            Self::File(error) => error.kind(),
            Self::Verify { failure, .. } => failure.kind(),
            Self::Stopped { .. } => Kind::Stopped,
            Self::Scene(error) => error.kind(),
            Self::NoBody | Self::Restore { .. } | Self::Changed { .. } => Kind::Input,
            Self::Folder { .. } => Kind::Io,
            Self::Output(error) => error.kind(),
            Self::Large { .. } => Kind::Refused,
        }
    }

    fn details(&self) -> Details {
        match self {
            Self::Build(error) => error.details(),
            Self::Setup { scene, source } => Details { file: Details::of_file(scene).file, ..source.details() },
            Self::Verify { scene, .. } => Details::of_file(scene),
            Self::Step { results, .. } | Self::Refused { results, .. } => Details::of_file(results),
            Self::File(error) => error.details(),
            Self::Stopped { part, .. } | Self::Restore { part, .. } | Self::Changed { part, .. } => {
                Details::of_file(part)
            }
            Self::NoBody => Details::default(),
            Self::Scene(error) => error.details(),
            Self::Folder { folder, .. } => Details::of_file(folder),
            Self::Output(error) => error.details(),
            Self::Large { scene, estimate } => Details {
                key: Some("output.interval".to_owned()),
                found: Some(estimate.to_string()),
                expected: Some("1 GB at the most".to_owned()),
                help: Some("name fewer rows in [output], or allow it with --large".to_owned()),
                ..Details::of_file(scene)
            },
        }
    }
}

impl Failure for FileError {
    fn kind(&self) -> Kind {
        match self {
            Self::Sealed(error) => error.kind(),
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
    }

    fn details(&self) -> Details {
        match self {
            Self::Sealed(error) => error.details(),
            _ => Details::of_file(self.path()),
        }
    }
}

impl Failure for SealedError {
    fn kind(&self) -> Kind {
        match self {
            Self::Hdf5 { .. } | Self::System { .. } => Kind::Io,
            // What is wrong with a file's content, or with the names in it.
            _ => Kind::Input,
        }
    }

    fn details(&self) -> Details {
        Details { help: self.help().map(str::to_owned), ..Details::of_file(self.path()) }
    }
}

impl Failure for FigureError {
    fn kind(&self) -> Kind {
        match self {
            Self::Write { .. } => Kind::Io,
            _ => Kind::Run,
        }
    }

    fn details(&self) -> Details {
        match self {
            Self::Write { path, .. } => Details::of_file(path),
            _ => Details::default(),
        }
    }
}

impl Failure for ShapesError {
    fn kind(&self) -> Kind {
        match self {
            Self::Scene(error) => error.kind(),
            Self::Figure(error) => error.kind(),
        }
    }

    fn details(&self) -> Details {
        match self {
            Self::Scene(error) => error.details(),
            Self::Figure(error) => error.details(),
        }
    }
}

impl Failure for AnimationError {
    fn kind(&self) -> Kind {
        match self {
            Self::Run(error) => error.kind(),
            Self::Step { .. } => Kind::Run,
            Self::NoMesh { .. } => Kind::Input,
            Self::NotGif { .. } | Self::Times { .. } => Kind::Usage,
            Self::Export(error) => error.kind(),
            Self::Figure(error) => error.kind(),
        }
    }

    fn details(&self) -> Details {
        match self {
            Self::Run(error) => error.details(),
            Self::Step { scene, .. } | Self::NoMesh { scene } => Details::of_file(scene),
            Self::NotGif { path } => Details::of_file(path),
            Self::Times { from, to, end } => Details {
                key: Some("--from, --to".to_owned()),
                found: Some(format!("{from} to {to}")),
                expected: Some(format!("a part of 0 to {end}")),
                ..Details::default()
            },
            Self::Export(error) => error.details(),
            Self::Figure(error) => error.details(),
        }
    }
}

impl Failure for DrawnError {
    fn kind(&self) -> Kind {
        match self {
            Self::File(error) => error.kind(),
            Self::BodyFile(error) => error.kind(),
            Self::NoBodyFile { .. } | Self::OtherBody { .. } => Kind::Input,
        }
    }

    fn details(&self) -> Details {
        match self {
            Self::File(error) => error.details(),
            Self::BodyFile(error) => error.details(),
            Self::NoBodyFile { results, .. } => Details::of_file(results),
            Self::OtherBody { body_file, .. } => Details::of_file(body_file),
        }
    }
}

impl Failure for ExportError {
    fn kind(&self) -> Kind {
        match self {
            Self::File(error) => error.kind(),
            Self::Write(error) => error.kind(),
            Self::Output(error) => error.kind(),
            Self::Drawn(error) => error.kind(),
            Self::NoMesh { .. } | Self::NoElements { .. } | Self::NoModes { .. } => Kind::Input,
            Self::NoRows { .. } | Self::NoColumn { .. } => Kind::Usage,
        }
    }

    fn details(&self) -> Details {
        match self {
            Self::File(error) => error.details(),
            Self::Write(error) => error.details(),
            Self::Output(error) => error.details(),
            Self::Drawn(error) => error.details(),
            Self::NoMesh { path }
            | Self::NoElements { path }
            | Self::NoModes { path }
            | Self::NoRows { path, .. }
            | Self::NoColumn { path, .. } => Details::of_file(path),
        }
    }
}

impl Failure for ReportError {
    fn kind(&self) -> Kind {
        match self {
            Self::Write { .. } => Kind::Io,
            _ => Kind::Run,
        }
    }

    fn details(&self) -> Details {
        match self {
            Self::Write { path, .. } => Details::of_file(path),
            _ => Details::default(),
        }
    }
}

impl Failure for HtmlReportError {
    fn kind(&self) -> Kind {
        match self {
            Self::Drawn(error) => error.kind(),
            Self::NoColumns { .. } => Kind::Input,
            Self::Page(error) => error.kind(),
        }
    }

    fn details(&self) -> Details {
        match self {
            Self::Drawn(error) => error.details(),
            Self::NoColumns { results } => Details::of_file(results),
            Self::Page(error) => error.details(),
        }
    }
}

impl Failure for WriteError {
    fn kind(&self) -> Kind {
        Kind::Io
    }

    fn details(&self) -> Details {
        Details::of_file(&self.path)
    }
}

impl Failure for OutputError {
    fn kind(&self) -> Kind {
        match self {
            Self::IsInput { .. } | Self::OtherEnding(_) => Kind::Usage,
            Self::Exists { .. }
            | Self::Folder { .. }
            | Self::LostLink { .. }
            | Self::Device { .. }
            | Self::NoFolder { .. } => Kind::Io,
        }
    }

    fn details(&self) -> Details {
        match self {
            Self::IsInput { path, .. }
            | Self::Exists { path }
            | Self::Folder { path }
            | Self::LostLink { path }
            | Self::Device { path, .. }
            | Self::NoFolder { path, .. } => Details::of_file(path),
            Self::OtherEnding(error) => {
                let (found, expected) = (Some(error.found.to_owned()), Some(error.expected.to_owned()));
                Details { found, expected, ..Details::of_file(&error.path) }
            }
        }
    }
}

impl Failure for CampbellError {
    fn kind(&self) -> Kind {
        match self {
            Self::Build(error) => error.kind(),
            Self::Eigen { source, .. } => source.kind(),
            Self::Axis { .. } | Self::Speeds { .. } | Self::Order { .. } => Kind::Usage,
            Self::Figure(error) => error.kind(),
            Self::Write(error) => error.kind(),
        }
    }

    fn details(&self) -> Details {
        match self {
            Self::Build(error) => error.details(),
            Self::Eigen { scene, .. } => Details::of_file(scene),
            Self::Axis { .. } | Self::Speeds { .. } | Self::Order { .. } => Details::default(),
            Self::Figure(error) => error.details(),
            Self::Write(error) => error.details(),
        }
    }
}

impl Failure for CostError {
    fn kind(&self) -> Kind {
        match self {
            Self::Build(error) => error.kind(),
            Self::NoBody => Kind::Input,
            Self::Reference { failure, .. } => failure.kind(),
            Self::Figure(error) => error.kind(),
            Self::Write(error) => error.kind(),
            Self::Output(error) => error.kind(),
        }
    }

    fn details(&self) -> Details {
        match self {
            Self::Build(error) => error.details(),
            Self::NoBody => Details::default(),
            Self::Reference { scene, .. } => Details::of_file(scene),
            Self::Figure(error) => error.details(),
            Self::Write(error) => error.details(),
            Self::Output(error) => error.details(),
        }
    }
}

impl Failure for PaperError {
    fn kind(&self) -> Kind {
        match self {
            Self::Run(error) => error.kind(),
            Self::Build(error) => error.kind(),
            Self::File(error) => error.kind(),
            Self::Figure(error) => error.kind(),
            Self::RigidBody(_) => Kind::Refused,
            Self::Step(_) => Kind::Run,
            Self::MissingPoint { .. } | Self::NotThePlate { .. } => Kind::Input,
            Self::Report { .. } => Kind::Io,
        }
    }

    fn details(&self) -> Details {
        match self {
            Self::Run(error) => error.details(),
            Self::Build(error) => error.details(),
            Self::File(error) => error.details(),
            Self::Figure(error) => error.details(),
            Self::RigidBody(_) | Self::Step(_) => Details::default(),
            Self::MissingPoint { scene, .. } | Self::NotThePlate { scene } => Details::of_file(scene),
            Self::Report { path, .. } => Details::of_file(path),
        }
    }
}

impl Failure for NewSceneError {
    fn kind(&self) -> Kind {
        match self {
            Self::Mesh(error) => error.kind(),
            Self::Assembly(error) => error.kind(),
            Self::Output(error) => error.kind(),
            Self::Write(error) => error.kind(),
        }
    }

    fn details(&self) -> Details {
        match self {
            Self::Mesh(error) => error.details(),
            Self::Assembly(error) => error.details(),
            Self::Output(error) => error.details(),
            Self::Write(error) => error.details(),
        }
    }
}

impl Failure for OtherFile {
    fn kind(&self) -> Kind {
        Kind::Input
    }

    fn details(&self) -> Details {
        Details {
            found: Some(self.found.in_words().to_owned()),
            expected: Some(self.expected.to_owned()),
            help: Some(self.found.taken_by(&self.path)),
            ..Details::of_file(&self.path)
        }
    }
}

impl Failure for SweepError {
    fn kind(&self) -> Kind {
        match self {
            Self::Unreadable { .. }
            | Self::Write(_)
            | Self::OtherTable { .. }
            | Self::OtherFiles { .. }
            | Self::OtherCsv { .. }
            | Self::Busy { .. }
            | Self::NoShard { .. } => Kind::Io,
            Self::Table(error) => error.kind(),
            Self::Output(error) => error.kind(),
            Self::AllFailed { .. } => Kind::Run,
            Self::Invalid { .. } | Self::Form { .. } => Kind::Input,
            Self::Scene { source, .. } => source.kind(),
            Self::Build(error) => error.kind(),
        }
    }

    fn details(&self) -> Details {
        match self {
            Self::Unreadable { path, .. }
            | Self::Form { path, .. }
            | Self::OtherTable { path, .. }
            | Self::OtherFiles { path, .. }
            | Self::OtherCsv { path }
            | Self::Busy { path }
            | Self::AllFailed { path, .. }
            | Self::NoShard { first: path, .. } => Details::of_file(path),
            Self::Invalid { path, key, found, expected } => Details {
                key: Some(key.clone()),
                found: Some(found.clone()),
                expected: Some(expected.clone()),
                help: Some(SWEEP_CURE.to_owned()),
                ..Details::of_file(path)
            },
            Self::Scene { source, .. } => source.details(),
            Self::Build(error) => error.details(),
            Self::Table(error) => error.details(),
            Self::Write(error) => Details::of_file(&error.path),
            Self::Output(error) => error.details(),
        }
    }
}
