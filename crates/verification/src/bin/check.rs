//! `check FILE [--overwrite]`: holds the check by the full body against the truth, and writes the page and, in the folder `check` beside it, its picture.

use std::path::Path;
use std::process::ExitCode;

use verification::check::page;
use whole_file::{Outputs, write_whole};

fn main() -> ExitCode {
    let (options, arguments): (Vec<String>, Vec<String>) =
        std::env::args().skip(1).partition(|argument| argument.starts_with('-'));
    let (true, [path]) = (options.iter().all(|option| option == "--overwrite"), arguments.as_slice()) else {
        eprintln!("usage: check FILE [--overwrite]");
        return ExitCode::FAILURE;
    };
    let folder = Path::new(path).with_extension("");
    let picture = folder.join("scenes.svg");
    let written = Outputs::new(Vec::new(), !options.is_empty())
        .claim(&[Path::new(path), &picture])
        .map_err(|error| error.to_string())
        .and_then(|()| std::fs::create_dir_all(&folder).map_err(|error| format!("{}: {error}", folder.display())))
        .and_then(|()| page(&picture, |line| eprintln!("{line}")))
        .and_then(|page| write_whole(path, page).map_err(|error| format!("{path}: {error}")));
    match written {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("error: {error}");
            ExitCode::FAILURE
        }
    }
}
