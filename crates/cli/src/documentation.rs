//! Tests that what the documentation shows works: its commands, its scenes and its Rust; and pages made of the sources.

mod columns;
mod commands;
mod keys;

use std::fs;
use std::path::{Path, PathBuf};

use clap::Parser;
use clap::error::ErrorKind;
use scene::Scene;

use crate::cli::Cli;

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..")
}

/// Files with an ending, in a folder and those within it.
fn files(folder: &Path, ending: &str) -> Vec<PathBuf> {
    let mut found = Vec::new();
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            found.extend(files(&path, ending));
        } else if path.extension().is_some_and(|extension| extension == ending) {
            found.push(path);
        }
    }
    found
}

/// Compares a page with what the sources give, or writes it where `FLEXFRAME_ACCEPT` is set.
fn is_made(page: &str, text: &str) {
    let path = root().join(page);
    if std::env::var_os("FLEXFRAME_ACCEPT").is_some() {
        fs::write(&path, text).unwrap();
    }
    assert!(
        fs::read_to_string(path).is_ok_and(|found| found == text),
        "{page} is not what the sources give: run ./dev reference"
    );
}

/// Text for a cell of a table.
fn cell(text: &str) -> String {
    let line = text.split_whitespace().collect::<Vec<_>>().join(" ").replace('|', "\\|");
    // Outside spans of code a `<` begins HTML.
    let parts = line
        .split('`')
        .enumerate()
        .map(|(k, part)| if k % 2 == 0 { part.replace('<', "&lt;") } else { part.to_owned() });
    parts.collect::<Vec<_>>().join("`")
}

/// Names and texts of the pages that users read.
fn pages() -> Vec<(String, String)> {
    let mut paths = files(&root().join("docs"), "md");
    paths.push(root().join("README.md"));
    paths.push(root().join("CONTRIBUTING.md"));
    paths.into_iter().map(|path| (path.display().to_string(), fs::read_to_string(path).unwrap())).collect()
}

/// Blocks of code between fences, each with its language.
fn blocks(text: &str) -> Vec<(&str, String)> {
    let mut found: Vec<(&str, String)> = Vec::new();
    let mut inside = false;
    for line in text.lines() {
        match line.strip_prefix("```") {
            Some(_) if inside => inside = false,
            Some(language) => {
                inside = true;
                found.push((language, String::new()));
            }
            None if inside => {
                let (_, block) = found.last_mut().unwrap();
                block.push_str(line);
                block.push('\n');
            }
            None => {}
        }
    }
    found
}

/// Spans of code within the lines of a text.
fn spans(text: &str) -> impl Iterator<Item = &str> {
    text.lines().filter(|line| !line.starts_with("```")).flat_map(|line| line.split('`').skip(1).step_by(2))
}

/// Words of a command as a shell has them, without optional brackets, comments and what follows the command.
fn words(command: &str) -> Vec<String> {
    let mut words = Vec::new();
    for word in command.split_whitespace() {
        if word.starts_with(['#', '>', '|', '<', ';', '&']) {
            break;
        }
        let end = word.ends_with(';');
        let word = word.trim_matches(['\'', ';']);
        let word = if word.contains('=') { word } else { word.trim_matches(['[', ']']) };
        // One of several, and places where a number goes.
        let word = word.split('|').next().unwrap();
        words.push(match word {
            "N" | "SECONDS" | "T" => "1".to_owned(),
            _ => word.to_owned(),
        });
        if end {
            break;
        }
    }
    words
}

#[test]
fn the_program_takes_every_command_of_the_documentation() {
    let mut commands = 0;
    let mut refused = Vec::new();
    for (page, text) in pages() {
        let blocks = blocks(&text);
        let lines = blocks.iter().filter(|(language, _)| ["", "sh", "text", "console"].contains(language));
        let lines = lines.flat_map(|(_, block)| block.lines()).map(|line| (line, true));
        for (line, whole) in lines.chain(spans(&text).map(|span| (span, false))) {
            if !line.starts_with("flexframe ") {
                continue;
            }
            let words = words(line);
            // What a shell prints, and names that stand for a command.
            if words.len() < 2
                || words[1] == "COMMAND"
                || !words[1].starts_with(|c: char| c.is_ascii_lowercase() || c == '-')
            {
                continue;
            }
            commands += 1;
            match Cli::try_parse_from(&words).map_err(|error| error.kind()) {
                Ok(_) | Err(ErrorKind::DisplayHelp | ErrorKind::DisplayVersion) => {}
                // Text between lines of code may name a command without what it needs.
                Err(ErrorKind::MissingRequiredArgument | ErrorKind::MissingSubcommand | ErrorKind::InvalidValue)
                    if !whole => {}
                Err(kind) => refused.push(format!("{page}: {line}: {kind}")),
            }
        }
    }
    assert!(refused.is_empty(), "{}", refused.join("\n"));
    assert!(commands > 50, "{commands}");
}

#[test]
fn scenes_of_the_documentation_are_read() {
    let mut whole = 0;
    for (page, text) in pages() {
        for (_, block) in blocks(&text).into_iter().filter(|(language, _)| *language == "toml") {
            if block.starts_with("title") {
                whole += 1;
                if let Err(error) = Scene::parse(&block, root().join("examples/of_the_page.toml")) {
                    panic!("{page}: {error}\n{block}");
                }
            } else if let Err(error) = toml::from_str::<toml::Table>(&block) {
                panic!("{page}: {error}\n{block}");
            }
        }
    }
    assert!(whole >= 2, "{whole}");
}

/// Lines of Rust without their indentation.
fn code(text: &str) -> Vec<&str> {
    text.lines().map(str::trim).filter(|line| !line.is_empty()).collect()
}

#[test]
fn rust_of_the_documentation_stands_in_an_example() {
    let examples: Vec<String> =
        files(&root().join("examples"), "rs").into_iter().map(|path| fs::read_to_string(path).unwrap()).collect();
    let stands = |paragraph: &[&str]| {
        examples.iter().any(|example| code(example).windows(paragraph.len()).any(|lines| lines == paragraph))
    };
    let mut shown = 0;
    for (page, text) in pages() {
        for (_, block) in blocks(&text).into_iter().filter(|(language, _)| *language == "rust") {
            for paragraph in block.split("\n\n") {
                shown += 1;
                assert!(stands(&code(paragraph)), "{page}: no example has\n{paragraph}");
            }
        }
    }
    assert!(shown >= 2, "{shown}");
}
