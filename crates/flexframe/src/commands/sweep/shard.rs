//! Parts of a sweep, for as many machines.

use std::fmt;
use std::path::{Path, PathBuf};
use std::str::FromStr;

use foreign_program::shell_word;
use serde::{Serialize, Serializer};

/// More parts than these are a mistake.
const MOST: usize = 10_000;

/// A part of a sweep: every `count`-th row, from row `number` − 1 on. Written `2/4`.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Shard {
    number: usize,
    count: usize,
}

impl Shard {
    /// All `count` of a sweep.
    pub fn all(count: usize) -> impl Iterator<Item = Self> {
        (1..=count).map(move |number| Self { number, count })
    }

    /// True if a row, numbered from 0, is of this part.
    pub fn has(self, row: usize) -> bool {
        row % self.count + 1 == self.number
    }

    /// Its table beside that of the sweep: `out/blade.2-of-4.h5` for `out/blade.h5`.
    #[must_use]
    pub fn table(self, of_sweep: &Path) -> PathBuf {
        let mut name = of_sweep.file_stem().unwrap_or("sweep".as_ref()).to_owned();
        name.push(format!(".{}-of-{}", self.number, self.count));
        if let Some(ending) = of_sweep.extension() {
            name.push(".");
            name.push(ending);
        }
        of_sweep.with_file_name(name)
    }
}

impl FromStr for Shard {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let numbers = text.split_once('/').map(|(number, count)| (number.parse(), count.parse()));
        match numbers {
            Some((Ok(number), Ok(count))) if (1..=count).contains(&number) && count <= MOST => {
                Ok(Self { number, count })
            }
            _ => Err(format!("expected a part and the number of parts, from 1/1 to {MOST}/{MOST}, such as 2/4")),
        }
    }
}

impl fmt::Display for Shard {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}/{}", self.number, self.count)
    }
}

impl Serialize for Shard {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_str(self)
    }
}

/// A script for Slurm: an array of `count` jobs, each a shard of the sweep. Its head says how to merge them.
pub fn slurm_script(sweep: &Path, output: &Path, count: usize) -> String {
    let [sweep, output] = [sweep, output].map(shell_word);
    format!(
        "#!/bin/bash
# sbatch THIS_FILE runs the sweep as {count} jobs. When they have ended:
#   flexframe sweep {sweep} -o {output} --merge {count}
# A job that died: sbatch --array=ITS_NUMBER THIS_FILE, then merge again. Rows that it had done are kept.
#SBATCH --job-name=flexframe-sweep
#SBATCH --array=1-{count}
#SBATCH --cpus-per-task=2
set -euo pipefail
flexframe --threads \"${{SLURM_CPUS_PER_TASK:-2}}\" sweep {sweep} -o {output} --shard \"$SLURM_ARRAY_TASK_ID/{count}\"
"
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_row_is_of_one_shard() {
        for row in 0..20 {
            assert_eq!(Shard::all(7).filter(|shard| shard.has(row)).count(), 1);
        }
        let second: Shard = "2/4".parse().unwrap();
        assert_eq!((0..9).filter(|row| second.has(*row)).collect::<Vec<_>>(), [1, 5]);
        assert_eq!(second.table(Path::new("out/a blade.h5")), Path::new("out/a blade.2-of-4.h5"));
        for wrong in ["", "2", "0/4", "5/4", "1/0", "a/b", "1/20000", "-1/4", "1/4/2"] {
            assert!(wrong.parse::<Shard>().is_err(), "{wrong}");
        }
    }
}
