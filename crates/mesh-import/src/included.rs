//! The files that a mesh or geometry may take in beside its own.

use std::fs::File;
use std::io::{BufRead, BufReader};
use std::path::{Path, PathBuf};

use foreign_program::open_ordinary;

use crate::format::ending;

/// Files that are looked for at the most.
const MAX_FILES: usize = 1000;

/// A file and all that it names, and what these name: whatever is there under the name that stands in quotes, after an equals
/// sign or in a tag. More may be named than is read.
pub fn files_of_mesh(path: &Path) -> Vec<PathBuf> {
    let mut files = vec![path.to_owned()];
    let mut next = 0;
    while let Some(file) = files.get(next).cloned() {
        next += 1;
        for named in named_in(&file) {
            if files.len() < MAX_FILES && !files.contains(&named) {
                files.push(named);
            }
        }
    }
    files
}

/// Files that are there of the names in a text.
fn named_in(path: &Path) -> Vec<PathBuf> {
    // The words of lines that name files; in a program any line may.
    let words: &[&str] = match ending(path).as_str() {
        "geo" | "geo_unrolled" => &[""],
        "inp" | "bdf" | "nas" | "fem" => &["INCLUDE"],
        "xdmf" | "xmf" => &["<", ":"],
        _ => return Vec::new(),
    };
    let Ok(file) = open_ordinary(path) else { return Vec::new() };
    let folder = path.parent().unwrap_or(Path::new(""));
    let mut found = Vec::new();
    for line in lines(file) {
        let spaceless = line.to_uppercase().replace(' ', "");
        if words.iter().any(|word| spaceless.contains(word)) {
            let names = line.split(['"', '\'', '=', '<', '>', ',', ':']).map(str::trim);
            // Nastran needs no quotes.
            let names = names.map(|name| match name.get(..8) {
                Some(word) if word.eq_ignore_ascii_case("INCLUDE ") => name[8..].trim(),
                _ => name,
            });
            let names = names.filter(|name| !name.is_empty());
            found.extend(names.map(|name| folder.join(name)).filter(|named| named.is_file()));
        }
    }
    found
}

fn lines(file: File) -> impl Iterator<Item = String> {
    let lines = BufReader::new(file).split(b'\n').map_while(Result::ok);
    lines.map(|line| String::from_utf8_lossy(&line).into_owned())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_a_file_includes_is_found_however_it_is_written() {
        let folder = tempfile::tempdir().unwrap();
        let at = |name: &str| folder.path().join(name);
        for (name, text) in [
            ("a.geo", "// Include \"c d.geo\";\nMerge 'part.step'; x = 1;"),
            ("c d.geo", "Include \"a.geo\"; Include \"nowhere.geo\";"),
            ("part.step", ""),
            ("a.inp", "*NODE\n1, 0, 0, 0\n* Include, input = nodes.txt\n"),
            ("nodes.txt", ""),
            ("a.bdf", "INCLUDE 'nodes.txt'\ninclude more.txt\n"),
            ("more.txt", ""),
            ("a.xdmf", "<DataItem Format=\"HDF\">data.h5:/mesh</DataItem>\n"),
            ("data.h5", ""),
        ] {
            std::fs::write(at(name), text).unwrap();
        }
        for (name, expected) in [
            ("a.geo", vec!["a.geo", "c d.geo", "part.step"]),
            ("a.inp", vec!["a.inp", "nodes.txt"]),
            ("a.bdf", vec!["a.bdf", "nodes.txt", "more.txt"]),
            ("a.xdmf", vec!["a.xdmf", "data.h5"]),
            ("part.step", vec!["part.step"]),
            ("nowhere.geo", vec!["nowhere.geo"]),
        ] {
            let expected: Vec<PathBuf> = expected.into_iter().map(at).collect();
            assert_eq!(files_of_mesh(&at(name)), expected, "{name}");
        }
    }
}
