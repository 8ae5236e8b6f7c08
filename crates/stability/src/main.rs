//! `stability FILE`: runs every hard case with every scheme and writes the page; fails where a bound is broken.

use std::process::ExitCode;

use stability::{Extent, page};

fn main() -> ExitCode {
    let mut arguments = std::env::args().skip(1);
    let (Some(path), None) = (arguments.next(), arguments.next()) else {
        eprintln!("usage: stability FILE");
        return ExitCode::FAILURE;
    };
    let (page, broken) = page::page(Extent::Study, |line| eprintln!("{line}"));
    if let Err(error) = whole_file::write_whole(&path, page) {
        eprintln!("error: {path}: {error}");
        return ExitCode::FAILURE;
    }
    for line in &broken {
        eprintln!("error: {line}");
    }
    if broken.is_empty() { ExitCode::SUCCESS } else { ExitCode::FAILURE }
}
