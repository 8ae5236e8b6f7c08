//! Pages of the documentation that teach: their commands are run as a reader would run them, page by page and in order, and
//! what a page shows of their output is compared with it.

mod output;
mod pages;
mod session;

use std::fs;

use pages::{Page, pages};
use session::Session;

use crate::program::root;

/// Blocks of commands that are not run, by how they begin, with the reason.
const NOT_RUN: [(&str, &str, &str); 10] = [
    ("README.md", "./dev plate", "builds the program and runs all tests"),
    ("README.md", "cargo install", "installs"),
    ("docs/start/first-steps.md", "cargo install", "installs"),
    ("docs/how-to/python.md", "", "builds the Python package, as ./dev python does"),
    ("docs/reference/python.md", "", "builds the Python package, as ./dev python does"),
    ("docs/reference/cli.md", "flexframe run blade", "a line of a reference: there is no such scene"),
    ("docs/reference/cluster.md", "", "wants a cluster"),
    ("docs/reference/live.md", "flexframe report", "play serves a page until ctrl-C"),
    ("docs/how-to/controllers.md", "cargo run", "a test of tests/program/library.rs runs the example"),
    ("docs/how-to/fmu.md", "cargo build", "builds the library, and calls FMPy, as ./dev fmu-test does"),
];

/// Pages of these folders, whose commands are run.
fn of(folder: &str) -> Vec<Page> {
    let found: Vec<Page> = pages().into_iter().filter(|page| page.name.starts_with(folder)).collect();
    assert!(!found.is_empty(), "no page in {folder}");
    found
}

/// True where a block of a page is in the list of those that are not run.
fn is_left_out(page: &Page, block: &str) -> bool {
    NOT_RUN.iter().any(|(name, begins, _)| page.name.starts_with(name) && block.starts_with(begins))
}

/// Runs the commands of a page; a block of text after them, until the next ones, is what they print.
fn run(page: &Page) {
    let mut session = Session::new();
    let mut printed = None;
    for block in &page.blocks {
        match block.language.as_str() {
            "sh" if is_left_out(page, &block.text) => printed = None,
            "sh" => printed = Some(session.run(page, block)),
            "text" => {
                if let Some(printed) = &printed {
                    for line in block.text.lines().filter(|line| !line.trim().is_empty()) {
                        assert!(
                            output::says(printed, line),
                            "{}:{}: no command before it prints\n{line}\nbut\n{printed}",
                            page.name,
                            block.line
                        );
                    }
                }
            }
            _ => {}
        }
    }
    // Pictures of a page are those that its commands make, or of another page.
    for picture in page.pictures() {
        let Some(made) = session.file_named(&picture) else {
            panic!("{}: no command makes {picture}", page.name);
        };
        let shown = page.path.with_file_name(&picture);
        if std::env::var_os("FLEXFRAME_ACCEPT").is_some() {
            fs::copy(&made, &shown).unwrap();
        }
        let size = fs::metadata(&shown).unwrap().len();
        assert!(0 < size && size < 300_000, "{}: {picture} has {size} bytes", page.name);
    }
}

#[test]
fn the_fork_rings_as_its_page_says() {
    of("docs/first-hour/fork").iter().for_each(run);
}

#[test]
fn the_handle_turns_over_as_its_page_says() {
    of("docs/first-hour/handle").iter().for_each(run);
}

#[test]
fn the_rod_is_stressed_as_its_page_says() {
    of("docs/first-hour/engine").iter().for_each(run);
}

#[test]
fn how_to_pages_print_what_they_show() {
    of("docs/how-to").iter().for_each(run);
}

#[test]
fn the_first_steps_print_what_they_show() {
    of("docs/start/first-steps").iter().for_each(run);
}

/// Commands on other pages would not be looked at by anything.
#[test]
fn commands_of_every_page_are_run_or_listed_with_a_reason() {
    let run = ["docs/first-hour/", "docs/how-to/", "docs/start/first-steps"];
    let mut listed = [false; NOT_RUN.len()];
    for page in pages() {
        for block in page.blocks.iter().filter(|block| block.language == "sh") {
            let entry = NOT_RUN
                .iter()
                .position(|(name, begins, _)| page.name.starts_with(name) && block.text.starts_with(begins));
            match entry {
                Some(entry) => listed[entry] = true,
                None => assert!(
                    run.iter().any(|name| page.name.starts_with(name)),
                    "{}:{}: nothing runs these commands, and NOT_RUN has no reason",
                    page.name,
                    block.line
                ),
            }
        }
    }
    for (entry, listed) in NOT_RUN.iter().zip(listed) {
        assert!(listed, "{entry:?} is on no page");
    }
}

/// A scene that a page of the first hour shows is the one that its commands copy.
#[test]
fn scenes_of_the_first_hour_are_those_of_the_examples() {
    let mut shown = 0;
    for page in of("docs/first-hour") {
        for block in page.blocks.iter().filter(|block| block.language == "toml" && block.text.starts_with("title")) {
            shown += 1;
            let is_there = fs::read_dir(root().join("examples/first-hour"))
                .unwrap()
                .any(|entry| fs::read_to_string(entry.unwrap().path()).unwrap() == block.text);
            assert!(is_there, "{}:{}: examples/first-hour has no such scene", page.name, block.line);
        }
    }
    assert_eq!(shown, 3);
}
