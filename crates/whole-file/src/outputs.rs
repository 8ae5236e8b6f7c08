//! The rule for all commands that write files: none is written over a file that the command reads, and what is there is
//! replaced only where the user has said so.
//!
//! A command asks before its work, with the files that it reads and those that it will write.

use std::path::{Path, PathBuf};

use diagnostic::{Diagnosis, Diagnostic, Kind};

use crate::same::is_same;
use crate::written::{OtherEnding, Written};

/// A file that is not written, since something would be lost.
#[derive(Debug, thiserror::Error)]
#[allow(missing_docs)] // the message of a variant says what its fields are
pub enum OutputError {
    /// The command reads it. `input`: the file that is read, as it was named.
    #[error("{}: this file is read by the command, as {}: it is never written over\n = give the output another name", path.display(), input.display())]
    IsInput { path: PathBuf, input: PathBuf },
    /// Its name is that of another kind of file.
    #[error(transparent)]
    OtherEnding(#[from] OtherEnding),
    /// It is there.
    #[error("{}: this file is there already\n = choose another name or folder, or replace it with --overwrite", path.display())]
    Exists { path: PathBuf },
    /// A folder has its name.
    #[error("{}: a folder of this name is there\n = name a file in it, or choose another name", path.display())]
    Folder { path: PathBuf },
    /// It is a link to a file that is not there.
    #[error("{}: this symbolic link leads nowhere\n = remove it, or choose another name", path.display())]
    LostLink { path: PathBuf },
    /// It is a device or a pipe, and its bytes cannot be written one after another.
    #[error("{}: found a device or a pipe, expected {expected}\n = name a file: its bytes are not written from the first to the last", path.display())]
    Device { path: PathBuf, expected: &'static str },
    /// The folder that it is to be in is not there.
    #[error("{}: there is no folder {} to write it in\n = make the folder, or correct its path", path.display(), folder.display())]
    NoFolder { path: PathBuf, folder: PathBuf },
}

/// The files that a command may write.
#[derive(Debug, Clone)]
pub struct Outputs {
    inputs: Vec<PathBuf>,
    overwrite: bool,
}

impl Outputs {
    /// The outputs of a command that reads these files; `overwrite` lets it replace others that are there.
    pub fn new(inputs: Vec<PathBuf>, overwrite: bool) -> Self {
        Self { inputs, overwrite }
    }

    /// The same of a command that reads another file, too.
    #[must_use]
    pub fn and_input(mut self, file: &Path) -> Self {
        self.inputs.push(file.to_owned());
        self
    }

    /// Refuses files of which one is read, is there without the leave to replace it, or cannot be written: a folder, a link that
    /// leads nowhere. A device, such as /dev/null, may be written.
    ///
    /// # Errors
    /// [`OutputError`].
    pub fn claim(&self, files: &[impl AsRef<Path>]) -> Result<(), OutputError> {
        for path in files.iter().map(AsRef::as_ref) {
            self.spare(path)?;
            if path.is_dir() {
                return Err(OutputError::Folder { path: path.to_owned() });
            }
            if path.is_symlink() && !path.exists() {
                return Err(OutputError::LostLink { path: path.to_owned() });
            }
            if !self.overwrite && path.is_file() {
                return Err(OutputError::Exists { path: path.to_owned() });
            }
        }
        Ok(())
    }

    /// The same of one file of a kind, whose name may not be that of another, in a folder that is there.
    ///
    /// # Errors
    /// [`OutputError`].
    pub fn claim_as(&self, written: &Written, path: &Path) -> Result<(), OutputError> {
        self.spare(path)?;
        written.check(path)?;
        self.claim(&[path])?;
        if written.in_any_order && path.exists() && !path.is_file() {
            return Err(OutputError::Device { path: path.to_owned(), expected: written.what });
        }
        match path.parent().filter(|folder| !folder.as_os_str().is_empty() && !folder.is_dir()) {
            Some(folder) => Err(OutputError::NoFolder { path: path.to_owned(), folder: folder.to_owned() }),
            None => Ok(()),
        }
    }

    /// Refuses a file that is read, by whatever path or link.
    ///
    /// # Errors
    /// [`OutputError::IsInput`].
    pub fn spare(&self, path: &Path) -> Result<(), OutputError> {
        match self.inputs.iter().find(|input| is_same(path, input)) {
            Some(input) => Err(OutputError::IsInput { path: path.to_owned(), input: input.clone() }),
            None => Ok(()),
        }
    }
}

impl Diagnostic for OutputError {
    fn diagnosis(&self) -> Diagnosis {
        match self {
            Self::IsInput { path, .. } => Kind::Usage.of(path),
            Self::OtherEnding(error) => error.diagnosis(),
            Self::Exists { path }
            | Self::Folder { path }
            | Self::LostLink { path }
            | Self::Device { path, .. }
            | Self::NoFolder { path, .. } => Kind::Io.of(path),
        }
    }
}

#[cfg(test)]
mod tests {
    use std::fs;

    use super::*;

    #[test]
    fn an_input_is_known_by_any_name() {
        let folder = tempfile::tempdir().unwrap();
        let at = |name: &str| folder.path().join(name);
        fs::create_dir(at("folder")).unwrap();
        fs::write(at("input"), "mine").unwrap();
        fs::write(at("other"), "old").unwrap();
        fs::hard_link(at("input"), at("hard")).unwrap();
        let outputs = |overwrite| Outputs::new(vec![at("nowhere"), at("input")], overwrite);
        #[cfg(unix)]
        {
            std::os::unix::fs::symlink("input", at("soft")).unwrap();
            assert!(matches!(outputs(true).claim(&[at("soft")]), Err(OutputError::IsInput { .. })));
            outputs(false).claim(&["/dev/null"]).unwrap();
            outputs(false).claim_as(&Written::PAGE, Path::new("/dev/null")).unwrap();
            for overwrite in [false, true] {
                let device = outputs(overwrite).claim_as(&Written::BODY, Path::new("/dev/null"));
                assert!(matches!(device, Err(OutputError::Device { .. })));
            }
            std::os::unix::fs::symlink("gone", at("lost")).unwrap();
            // An input that is a pipe is not waited for.
            let modes = rustix::fs::Mode::RUSR | rustix::fs::Mode::WUSR;
            rustix::fs::mknodat(rustix::fs::CWD, at("pipe"), rustix::fs::FileType::Fifo, modes, 0).unwrap();
            Outputs::new(vec![at("pipe")], true).claim(&[at("other"), at("pipe")]).unwrap();
        }
        for name in ["input", "hard", "folder/../input"] {
            for overwrite in [false, true] {
                let refused = outputs(overwrite).claim(&[at("new"), at(name)]);
                assert!(matches!(refused, Err(OutputError::IsInput { input, .. }) if input == at("input")), "{name}");
            }
        }
        outputs(true).claim(&[at("other"), at("new")]).unwrap();
        outputs(false).claim(&[at("new"), at("nowhere")]).unwrap();
        assert!(matches!(outputs(false).claim(&[at("other")]), Err(OutputError::Exists { .. })));
        for overwrite in [false, true] {
            let folder = outputs(overwrite).claim(&[at("new"), at("folder")]);
            assert!(matches!(folder, Err(OutputError::Folder { .. })));
            let nowhere = outputs(overwrite).claim_as(&Written::BODY, &at("nowhere/new"));
            assert!(matches!(nowhere, Err(OutputError::NoFolder { folder, .. }) if folder == at("nowhere")));
            outputs(overwrite).claim_as(&Written::BODY, &at("folder/new")).unwrap();
            #[cfg(unix)]
            assert!(matches!(outputs(overwrite).claim(&[at("lost")]), Err(OutputError::LostLink { .. })));
        }
        let also = outputs(true).and_input(&at("other"));
        assert!(matches!(also.spare(&at("other")), Err(OutputError::IsInput { .. })));
    }
}
