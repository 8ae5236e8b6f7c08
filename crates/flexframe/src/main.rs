//! The command line.

mod cli;
mod out_of_memory;
mod progress;

use std::process::ExitCode;

fn main() -> ExitCode {
    // Without it the program works as well, but for its last words.
    let _ = out_of_memory::listen();
    cli::main()
}
