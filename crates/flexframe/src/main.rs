//! The command line.

mod cli;
mod cli_error;
mod output;
mod progress;
mod signals;
mod threads;

use std::process::ExitCode;
use std::sync::Arc;

fn main() -> ExitCode {
    // At the limit on the size of a file this signal would end the program without a word. Caught, it leaves the error to
    // the write that comes too far.
    let _ = signal_hook::flag::register(signal_hook::consts::SIGXFSZ, Arc::default());
    cli::main()
}
