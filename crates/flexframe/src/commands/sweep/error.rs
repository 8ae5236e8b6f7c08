//! Errors of a sweep.

use std::path::PathBuf;

use model::BuildError;
use scene::SceneError;
use sealed::SealedError;

use crate::files::outputs::OutputError;
use crate::files::write_error::WriteError;

/// Help about the file of a sweep.
pub(crate) const SWEEP_CURE: &str = "correct it: docs/reference/cli.md, \"Sweeps\", has an example with all its keys";

/// A sweep that could not be made. What fails in a row of it is in its table.
#[derive(Debug, thiserror::Error)]
#[allow(missing_docs)] // the message of a variant says what its fields are
pub enum SweepError {
    /// The file of the sweep cannot be read.
    #[error("{}: the file of the sweep cannot be read: {source}\n = check its name; it is relative to the folder you are in", path.display())]
    Unreadable { path: PathBuf, source: std::io::Error },
    /// The file of the sweep says something that cannot be right.
    #[error("{}: `{key}`: found {found}, expected {expected}\n = {SWEEP_CURE}", path.display())]
    Invalid { path: PathBuf, key: String, found: String, expected: String },
    /// The file of the sweep is not TOML, or has another form. `message`: of the parser, with the place.
    #[error("{}: {message}\n = {SWEEP_CURE}", path.display())]
    Form { path: PathBuf, message: String },
    /// The scene cannot be read, or no row of the sweep is a scene. `key`: the parameters of the first row, if it is
    /// not the scene itself.
    #[error("{source}{}", where_(key.as_deref()))]
    Scene { key: Option<String>, source: SceneError },
    /// The body cannot be made.
    #[error("{0}")]
    Build(#[from] BuildError),
    /// A file that is there is not the table of this sweep.
    #[error(
        "{}: the file there is not the table of this sweep ({what}); move it away, choose another file with -o, or replace it \
         with --overwrite",
        path.display()
    )]
    OtherTable { path: PathBuf, what: String },
    /// The table would go where a file is that the sweep reads.
    #[error("{0}")]
    Output(#[from] OutputError),
    /// A file is where the CSV file would go, which the sweep has not written.
    #[error(
        "{}: the sweep writes its numbers here, too, and has not written what is there\n = move it away, choose another name for \
         the table with -o, or replace both with --overwrite",
        path.display()
    )]
    OtherCsv { path: PathBuf },
    /// Another sweep writes the table.
    #[error("{}: another sweep is writing this table\n = wait for its end, or choose another file with -o", path.display())]
    Busy { path: PathBuf },
    /// A shard has rows of other files than there are now. `path`: the table of the shard.
    #[error(
        "{}: {rows} of its rows were computed from files that have changed since: a mesh, what it includes, or a table of a load\n = \
         run this shard again, which computes them anew, and then merge",
        path.display()
    )]
    OtherFiles { path: PathBuf, rows: usize },
    /// No row is done. `row`: the first that failed; `words`: its reason.
    #[error("{}: all rows that were run have failed; row {row}: {words}", path.display())]
    AllFailed { path: PathBuf, row: usize, words: String },
    /// There is nothing to merge. `first`: the table of the first shard; `count`: as many were asked for.
    #[error(
        "{}: there is no such table, nor one of the other shards of {count}; run the shards first (--shard 1/{count} and so on), with \
         the same -o, or merge as many as there are", first.display()
    )]
    NoShard { first: PathBuf, count: usize },
    /// The table cannot be written.
    #[error("{0}")]
    Table(#[from] SealedError),
    /// A folder cannot be made.
    #[error("{0}")]
    Write(#[from] WriteError),
}

fn where_(key: Option<&str>) -> String {
    key.map_or_else(String::new, |key| format!("\n  = with {key} (no row of the sweep is a scene that can be read)"))
}
