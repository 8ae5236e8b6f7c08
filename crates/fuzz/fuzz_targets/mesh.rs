//! The reader of meshes: a sound mesh or an error with a message.
#![no_main]

use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| {
    match fem_tet10::parse_msh(bytes, "fuzzed.msh") {
        Ok(mesh) => {
            let nodes = mesh.positions().len();
            assert!(mesh.positions().iter().flatten().all(|c| c.is_finite()));
            assert!(mesh.elements().iter().flatten().all(|node| (*node as usize) < nodes));
        }
        Err(error) => assert!(!error.to_string().is_empty()),
    }
});
