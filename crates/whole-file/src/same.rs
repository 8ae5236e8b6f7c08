//! Comparison of names that stand for one file.

use std::fs::Metadata;
use std::path::Path;

/// True if both names lead to the same ordinary file. Neither is opened: a pipe would wait for somebody to write into it.
pub fn is_same(one: &Path, other: &Path) -> bool {
    // What cannot be looked at is not there.
    let (Ok(of_one), Ok(of_other)) = (one.metadata(), other.metadata()) else { return false };
    of_one.is_file() && of_other.is_file() && are_of_one(&of_one, &of_other)
}

/// True if both are of one file.
pub fn are_of_one(one: &Metadata, other: &Metadata) -> bool {
    use std::os::unix::fs::MetadataExt;

    (one.dev(), one.ino()) == (other.dev(), other.ino())
}
