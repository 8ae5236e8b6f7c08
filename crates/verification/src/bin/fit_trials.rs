//! `fit_trials FILE [--overwrite]`: counts how often intervals of fits have the true values in them, and writes the page.

use std::path::Path;
use std::process::ExitCode;

use verification::trials::page;
use whole_file::{Outputs, write_whole};

fn main() -> ExitCode {
    let (options, arguments): (Vec<String>, Vec<String>) =
        std::env::args().skip(1).partition(|argument| argument.starts_with('-'));
    let (true, [path]) = (options.iter().all(|option| option == "--overwrite"), arguments.as_slice()) else {
        eprintln!("usage: fit_trials FILE [--overwrite]");
        return ExitCode::FAILURE;
    };
    let written = Outputs::new(Vec::new(), !options.is_empty())
        .claim(&[Path::new(path)])
        .map_err(|error| error.to_string())
        .and_then(|()| page(|line| eprintln!("{line}")).map_err(|error| error.to_string()))
        .and_then(|page| write_whole(path, page).map_err(|error| format!("{path}: {error}")));
    match written {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("error: {error}");
            ExitCode::FAILURE
        }
    }
}
