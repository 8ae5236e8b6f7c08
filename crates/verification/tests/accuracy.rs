//! The page has what it is to show.

use std::path::Path;
use std::time::Duration;

use flexframe::scene::Body;
use verification::accuracy::accuracy_page;

/// The ring, spinning and ringing, for a twentieth of a second.
const SCENE: &str = include_str!("../../../tests/program/commands/short_ring.toml");

#[test]
fn the_page_has_its_tables_and_its_pictures() {
    let folder = tempfile::tempdir().unwrap();
    let mesh = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../meshes/ring.msh");
    let body = Body::parse(&SCENE.replace("MESH", mesh.to_str().unwrap()).replace("TIME", "step = 1e-4"), "ring.toml")
        .unwrap();
    let (docs, lists) = (folder.path().join("docs"), folder.path().join("lists"));
    std::fs::create_dir(&docs).unwrap();
    accuracy_page(&[body], &docs.join("accuracy.md"), &lists, Duration::from_millis(100), false).unwrap();
    let page = std::fs::read_to_string(docs.join("accuracy.md")).unwrap();
    for words in ["# The price of accuracy", "## Ring", "**The paper's scheme.**", "The price of modes"] {
        assert!(page.contains(words), "{words} in {page}");
    }
    assert!(docs.join("accuracy/ring.svg").exists());
    // Every table has as many cells in each row as in its head.
    for table in page.split("\n\n").filter(|block| block.starts_with('|')) {
        let cells: Vec<usize> = table.lines().map(|row| row.matches('|').count()).collect();
        assert!(cells.windows(2).all(|pair| pair[0] == pair[1]), "{table}");
    }
}
