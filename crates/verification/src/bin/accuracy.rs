//! `accuracy FILE SCENE... [--overwrite]`: measures the scenes and writes the page FILE, with its diagrams in a folder of the same name.

use std::error::Error;
use std::path::Path;
use std::process::ExitCode;
use std::time::Duration;

use flexframe::scene::Body;

/// How long a run may take.
const PATIENCE: Duration = Duration::from_secs(1);

fn main() -> ExitCode {
    let (options, arguments): (Vec<String>, Vec<String>) =
        std::env::args().skip(1).partition(|argument| argument == "--overwrite");
    let [page, scenes @ ..] = arguments.as_slice() else {
        eprintln!("usage: accuracy FILE SCENE... [--overwrite]");
        return ExitCode::FAILURE;
    };
    match write(page, scenes, !options.is_empty()) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("error: {error}");
            ExitCode::FAILURE
        }
    }
}

fn write(page: &str, scenes: &[String], overwrite: bool) -> Result<(), Box<dyn Error>> {
    let scenes = scenes.iter().map(Body::read).collect::<Result<Vec<_>, _>>()?;
    for file in
        verification::accuracy::accuracy_page(&scenes, page.as_ref(), Path::new("out/accuracy"), PATIENCE, overwrite)?
    {
        println!("{}", file.display());
    }
    Ok(())
}
