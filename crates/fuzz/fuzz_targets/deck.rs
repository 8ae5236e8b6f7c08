//! The readers of decks: the first byte chooses Abaqus, Nastran or a universal file.
#![no_main]

use std::path::PathBuf;
use std::sync::LazyLock;

use libfuzzer_sys::fuzz_target;
use mesh_import::{ImportSettings, read_mesh};

static FOLDER: LazyLock<(tempfile::TempDir, [PathBuf; 3])> = LazyLock::new(|| {
    let folder = tempfile::tempdir().unwrap();
    let decks = ["deck.inp", "deck.bdf", "deck.unv"].map(|name| folder.path().join(name));
    // No other program is asked where these readers do not know a file.
    unsafe {
        std::env::set_var("FLEXFRAME_GMSH", "/nowhere/gmsh");
        std::env::set_var("FLEXFRAME_PYTHON", "/nowhere/python");
    }
    (folder, decks)
});

fuzz_target!(|bytes: &[u8]| {
    let Some((first, deck)) = bytes.split_first() else { return };
    let path = &FOLDER.1[usize::from(*first) % 3];
    std::fs::write(path, deck).unwrap();
    for raise_order in [false, true] {
        let settings = ImportSettings { raise_order, ..ImportSettings::default() };
        match read_mesh(path, &settings) {
            Ok(imported) => {
                let nodes = imported.mesh.positions().len();
                assert!(imported.mesh.positions().iter().flatten().all(|c| c.is_finite()));
                assert!(imported.mesh.elements().iter().flatten().all(|node| (*node as usize) < nodes));
            }
            Err(error) => assert!(!error.to_string().is_empty()),
        }
    }
});
