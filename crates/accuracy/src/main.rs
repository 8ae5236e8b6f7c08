//! `accuracy FILE SCENE...`: measures the scenes and writes the page FILE, with its diagrams in a folder of the same name.

use std::error::Error;
use std::path::Path;
use std::process::ExitCode;
use std::time::Duration;

use flexframe::scene::Scene;

/// How long a run may take.
const PATIENCE: Duration = Duration::from_secs(1);

fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [page, scenes @ ..] = arguments.as_slice() else {
        eprintln!("usage: accuracy FILE SCENE...");
        return ExitCode::FAILURE;
    };
    match write(page, scenes) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("error: {error}");
            ExitCode::FAILURE
        }
    }
}

fn write(page: &str, scenes: &[String]) -> Result<(), Box<dyn Error>> {
    let scenes = scenes.iter().map(Scene::read).collect::<Result<Vec<_>, _>>()?;
    for file in accuracy::accuracy_page(&scenes, page.as_ref(), Path::new("out/accuracy"), PATIENCE)? {
        println!("{}", file.display());
    }
    Ok(())
}
