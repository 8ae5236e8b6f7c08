//! `stability FILE [--overwrite]`: runs every hard case with every scheme and writes the page; fails where a bound is broken.

use std::process::ExitCode;

use verification::stability::{Extent, page};
use whole_file::{Outputs, write_whole};

fn main() -> ExitCode {
    let (options, arguments): (Vec<String>, Vec<String>) =
        std::env::args().skip(1).partition(|argument| argument.starts_with('-'));
    let (true, [path]) = (options.iter().all(|option| option == "--overwrite"), arguments.as_slice()) else {
        eprintln!("usage: stability FILE [--overwrite]");
        return ExitCode::FAILURE;
    };
    if let Err(error) = Outputs::new(Vec::new(), !options.is_empty()).claim(&[path]) {
        eprintln!("error: {error}");
        return ExitCode::FAILURE;
    }
    let (page, broken) = page::page(Extent::Study, |line| eprintln!("{line}"));
    if let Err(error) = write_whole(path, page) {
        eprintln!("error: {path}: {error}");
        return ExitCode::FAILURE;
    }
    for line in &broken {
        eprintln!("error: {line}");
    }
    if broken.is_empty() { ExitCode::SUCCESS } else { ExitCode::FAILURE }
}
