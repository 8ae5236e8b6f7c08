//! The command line.

mod cli;
mod cli_error;
mod output;
mod progress;
mod signals;
mod threads;

use std::process::ExitCode;

fn main() -> ExitCode {
    cli::main()
}
