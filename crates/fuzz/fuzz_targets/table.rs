//! The reader of load tables, as a scene calls it: a file of two columns.
#![no_main]

use std::path::PathBuf;
use std::sync::LazyLock;

use libfuzzer_sys::fuzz_target;
use scene::{Body, History};

const SCENE: &str = include_str!("../../scene/src/text/example.toml");

/// A folder with a scene, whose load has its history from `table.csv`, and the scene's text.
static SETUP: LazyLock<(tempfile::TempDir, PathBuf, String)> = LazyLock::new(|| {
    let folder = tempfile::tempdir().unwrap();
    let half_sine = "{ kind = \"half-sine\", start = 0.0, duration = 0.02 }";
    let text = SCENE.replace(half_sine, "{ kind = \"table\", file = \"table.csv\" }");
    assert_ne!(text, SCENE);
    let table = folder.path().join("table.csv");
    (folder, table, text)
});

fuzz_target!(|bytes: &[u8]| {
    let (folder, table, text) = &*SETUP;
    std::fs::write(table, bytes).unwrap();
    match Body::parse(text, folder.path().join("scene.toml")) {
        Ok(scene) => {
            let History::Table(table) = &scene.loads[0].history else { panic!("not a table") };
            let (times, values) = table.points.iter().map(|[time, value]| (*time, *value)).unzip();
            let table = dynamics::Table::new(times, values).expect("what a scene takes is a table");
            assert!(table.discontinuities().windows(2).all(|pair| pair[0] < pair[1]));
        }
        Err(error) => assert!(!error.to_string().is_empty()),
    }
});
