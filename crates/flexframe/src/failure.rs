//! Failure of a command, with its exit code and its form in JSON.

use std::error::Error;
use std::fmt;
use std::io;
use std::iter::successors;

use diagnostic::{CURE, Diagnosis, Diagnostic, Kind};
use serde::Serialize;
use whole_file::{NoTemporaryFolder, cure_of_temporaries};

/// The object that stands for a failure under `--json`. Details that are not known are left out.
#[derive(Debug, Serialize)]
pub struct FailureReport {
    kind: &'static str,
    exit_code: u8,
    message: String,
    #[serde(skip_serializing_if = "Option::is_none")]
    file: Option<String>,
    #[serde(skip_serializing_if = "Option::is_none")]
    line: Option<usize>,
    #[serde(skip_serializing_if = "Option::is_none")]
    key: Option<String>,
    #[serde(skip_serializing_if = "Option::is_none")]
    found: Option<String>,
    #[serde(skip_serializing_if = "Option::is_none")]
    expected: Option<String>,
    #[serde(skip_serializing_if = "Option::is_none")]
    help: Option<String>,
}

impl FailureReport {
    /// A failure with a message. A cure that only the message has, in its last line after ` = `, is help, too.
    pub fn new(message: impl Into<String>, diagnosis: Diagnosis) -> Self {
        let message = message.into();
        let Diagnosis { kind, file, line, key, found, expected, help } = diagnosis;
        let help = help.or_else(|| Some(message.rsplit_once(CURE)?.1.to_owned()));
        Self { kind: kind.name(), exit_code: kind.exit_code(), message, file, line, key, found, expected, help }
    }

    /// The failure of an error.
    pub fn of(error: &dyn Diagnostic) -> Self {
        let message = error.to_string();
        let mut sources = successors(Some(error as &(dyn Error + 'static)), |&error| error.source())
            .filter_map(|error| error.downcast_ref::<io::Error>());
        let none = |source: &io::Error| Some(source.get_ref()?.downcast_ref::<NoTemporaryFolder>()?.to_string());
        if let Some(none) = sources.find_map(none) {
            return Self::new(none, Kind::Io.of(std::env::temp_dir()));
        }
        match cure_of_temporaries(error, &message) {
            Some(cure) => {
                let full = Diagnosis { kind: Kind::Io, ..error.diagnosis() };
                Self::new(format!("{message}{CURE}{cure}"), full)
            }
            None => Self::new(message, error.diagnosis()),
        }
    }

    /// The same with another message and another line.
    pub fn with_message(self, message: impl FnOnce(&str) -> String, line: Option<usize>) -> Self {
        Self { message: message(&self.message), line, ..self }
    }

    /// The exit code of the program.
    pub fn exit_code(&self) -> u8 {
        self.exit_code
    }
}

/// The message for people.
impl fmt::Display for FailureReport {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "error: {}", self.message)
    }
}

#[cfg(test)]
mod tests {
    use dynamics::SetupError;
    use mesh_import::ImportError;
    use modal::ModalError;
    use model::BuildError;

    use super::*;
    use crate::commands::run::RunError;

    #[test]
    fn kind_and_place_are_of_the_innermost_error_that_knows_them() {
        let of = |error: RunError| error.diagnosis();
        let scene = || "a.toml".into();
        let mesh = fem_tet10::parse_msh(b"$MeshFormat\n4.1 x", "a.msh").unwrap_err();
        let known = of(BuildError::from(Box::new(ImportError::from(mesh))).into());
        assert_eq!((known.kind, known.file.as_deref(), known.line), (Kind::Input, Some("a.msh"), Some(2)));
        let stopped = ModalError::Engine(Kind::Stopped.alone().says("stopped"));
        assert_eq!(of(BuildError::Modal { scene: scene(), source: stopped }.into()), Kind::Stopped.of("a.toml"));
        let source = SetupError::StepBeyondSpin { step: 1.0, limit: 0.1, spin: 2.0 };
        let known = of(RunError::Setup { scene: scene(), source: Box::new(source.into()) });
        assert_eq!(known, Kind::Refused.of("a.toml"));
    }
}
