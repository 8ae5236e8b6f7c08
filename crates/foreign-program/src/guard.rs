//! A guard that ends a program: when it is to end, and when this program has ended, whatever has ended it.

use std::io::Write;
use std::os::unix::process::CommandExt;
use std::path::Path;
use std::process::{Child, Command, Stdio};

use crate::error::ProgramError;

/// Names the private folder in the environment of a program. What it starts has that, too, wherever it goes.
pub(crate) const MARK: &str = "FLEXFRAME_PRIVATE_FOLDER";

/// A word on standard input says that the program has ended. A pipe that is closed without one says that it is to end: the process
/// group `$1` is asked to, and has to after ten seconds, and the folder `$2` is removed. In both cases what the program has left
/// running outside of its group is ended, which Linux knows by its environment `$3`: the ranks of an mpirun are such.
const SCRIPT: &str = r#"read -r word
if [ "$word" != ended ]; then
    kill -s TERM -- "-$1"
    count=0
    while kill -s 0 -- "-$1" && [ $count -lt 100 ]; do
        sleep 0.1
        count=$((count + 1))
    done
    kill -s KILL -- "-$1"
fi
for _ in 1 2 3; do
    files=$(grep -slF -- "$3=$2" /proc/[0-9]*/environ)
    [ -n "$files" ] || break
    for file in $files; do
        process=${file#/proc/}
        kill -s KILL "${process%/environ}"
    done
done
[ "$word" = ended ] || rm -rf -- "$2"
"#;

/// A shell that guards a process group.
#[derive(Debug)]
pub(crate) struct Guard(Child);

impl Guard {
    pub(crate) fn over(group: u32, folder: &Path) -> Result<Self, ProgramError> {
        let mut shell = Command::new("sh");
        shell.args(["-c", SCRIPT, "sh"]).arg(group.to_string()).arg(folder).arg(MARK);
        // In a group of its own: what a terminal sends to this program is not for it.
        shell.current_dir("/").env_remove(MARK).process_group(0);
        shell.stdin(Stdio::piped()).stdout(Stdio::null()).stderr(Stdio::null());
        shell.spawn().map(Self).map_err(ProgramError::Guard)
    }

    /// Has it end the program.
    pub(crate) fn begin_the_end(&mut self) {
        drop(self.0.stdin.take());
    }

    /// Says that the program has ended; not heard after [`Guard::begin_the_end`].
    pub(crate) fn has_ended(&mut self) {
        if let Some(mut pipe) = self.0.stdin.take() {
            // A guard that is not there has nothing left to do.
            let _ = pipe.write_all(b"ended\n");
        }
    }

    /// Waits until it has done what it has to do.
    pub(crate) fn wait(&mut self) {
        let _ = self.0.wait();
    }
}
