//! Pages with their blocks of code.

use std::fs;
use std::path::{Path, PathBuf};

use crate::program::root;

/// A block of code between fences.
pub struct Block {
    pub language: String,
    /// Number of its fence in the page, from 1.
    pub line: usize,
    pub text: String,
}

pub struct Page {
    /// Path from the folder of the sources.
    pub name: String,
    pub path: PathBuf,
    pub blocks: Vec<Block>,
    /// Lines between the blocks.
    prose: String,
}

impl Page {
    fn read(path: PathBuf) -> Self {
        let text = fs::read_to_string(&path).unwrap();
        let name = path.strip_prefix(root()).unwrap().display().to_string();
        let mut blocks: Vec<Block> = Vec::new();
        let mut prose = String::new();
        let mut inside = false;
        for (k, line) in text.lines().enumerate() {
            match line.strip_prefix("```") {
                Some(_) if inside => inside = false,
                Some(language) => {
                    inside = true;
                    blocks.push(Block { language: language.to_owned(), line: k + 1, text: String::new() });
                }
                None if inside => blocks.last_mut().unwrap().text += &format!("{line}\n"),
                None => prose += &format!("{line}\n"),
            }
        }
        assert!(!inside, "{name}: a fence is open");
        Self { name, path, blocks, prose }
    }

    /// Names of the pictures beside the page that it shows.
    pub fn pictures(&self) -> Vec<String> {
        let links = self.prose.split("![").skip(1).filter_map(|rest| rest.split_once("](")?.1.split_once(')'));
        links.map(|(link, _)| link.to_owned()).filter(|link| !link.contains('/')).collect()
    }
}

/// Pages that users read, in the order of their names.
pub fn pages() -> Vec<Page> {
    let mut paths = vec![root().join("README.md"), root().join("CONTRIBUTING.md")];
    add(&root().join("docs"), &mut paths);
    paths.sort();
    paths.into_iter().map(Page::read).collect()
}

fn add(folder: &Path, paths: &mut Vec<PathBuf>) {
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            add(&path, paths);
        } else if path.extension().is_some_and(|extension| extension == "md") {
            paths.push(path);
        }
    }
}
