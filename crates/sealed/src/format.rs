//! Formats of files.

use std::fs::File;
use std::io::Read;
use std::path::Path;

/// Bytes of the name and the version at the beginning of a file.
pub(crate) const MAGIC: usize = 24;

/// A format of files.
#[derive(Debug, PartialEq, Eq)]
pub struct Format {
    /// Its name at the beginning of a file.
    pub name: &'static str,
    /// The version that is written and read.
    pub version: u32,
    /// Its name in messages.
    pub noun: &'static str,
    /// How such a file is made again.
    pub again: &'static str,
}

impl Format {
    /// Body files, files of the cache, and tables of sweeps.
    pub const BODY: &'static Self =
        &Self { name: "body", version: 2, noun: "body file", again: "make it again: flexframe reduce SCENE -o FILE" };
    /// Files of a run.
    pub const RESULTS: &'static Self =
        &Self { name: "results", version: 7, noun: "results file", again: "run its scene again with --overwrite" };

    /// True if a file claims to be one, of any version.
    pub fn is_claimed(&self, path: &Path) -> bool {
        let prefix = self.prefix();
        let mut start = vec![0; prefix.len()];
        File::open(path).and_then(|mut file| file.read_exact(&mut start)).is_ok() && start == prefix.as_bytes()
    }

    fn prefix(&self) -> String {
        format!("flexframe {}, v. ", self.name)
    }

    /// How a file begins.
    pub(crate) fn magic(&self) -> [u8; MAGIC] {
        let mut magic = [b' '; MAGIC];
        let text = format!("{}{}", self.prefix(), self.version);
        magic.iter_mut().zip(text.bytes()).for_each(|(to, byte)| *to = byte);
        magic[MAGIC - 1] = b'\n';
        magic
    }

    /// The version that the beginning of a file claims, where it is another one.
    pub(crate) fn other_version(&self, head: &[u8]) -> Option<String> {
        let claimed = std::str::from_utf8(head.get(..MAGIC)?).ok()?.strip_prefix(&self.prefix())?.trim();
        let is_number = !claimed.is_empty() && claimed.bytes().all(|byte| byte.is_ascii_digit());
        (is_number && claimed != self.version.to_string()).then(|| claimed.to_owned())
    }
}
