//! The command line.

mod arguments;
mod cli;
mod cli_error;
mod commands;
#[cfg(test)]
mod documentation;
mod out_of_memory;
mod output;
mod progress;
mod scene_input;
mod served;
mod session;
mod signals;
mod solver_input;
mod threads;

use std::process::ExitCode;
use std::sync::Arc;

fn main() -> ExitCode {
    // At the limit on the size of a file this signal would end the program without a word. Caught, it leaves the error to
    // the write that comes too far.
    let _ = signal_hook::flag::register(signal_hook::consts::SIGXFSZ, Arc::default());
    // Without it the program works as well, but for its last words.
    let _ = out_of_memory::listen();
    cli::main()
}
