//! Every command on a body of matrices: it works, or says why not and what to do.

use std::path::Path;

use crate::program::command_in;

fn works(folder: &Path, arguments: &[&str], words: &[&str]) -> String {
    let output = command_in(folder, arguments).output().unwrap();
    let (said, error) = (String::from_utf8_lossy(&output.stdout), String::from_utf8_lossy(&output.stderr));
    assert!(output.status.success(), "{arguments:?}: {error}");
    for words in words {
        assert!(said.contains(words), "{arguments:?}: {words:?} is not in: {said}{error}");
    }
    said.into_owned()
}

#[test]
fn each_command_works_or_refuses_in_words() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let examples = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../..")).join("examples");
    std::fs::create_dir(folder.join("boom")).unwrap();
    for name in ["boom.toml", "boom/K.mtx", "boom/M.mtx", "boom/nodes.csv"] {
        std::fs::copy(examples.join(name), folder.join(name)).unwrap();
    }
    let short = ["boom.toml", "--set", "time.end=0.2"];
    let with = |command: &'static str, more: &[&'static str]| [&[command], &short[..], more].concat();
    let checks = "6 degrees of freedom a node, symmetric as written, no stiffness against the six rigid motions";
    works(
        folder,
        &["modes", "boom.toml"],
        &["9 nodes, matrices of another program, 54 unknowns", checks, "of the modal mass"],
    );
    works(folder, &with("run", &["-o", "out"]), &[checks]);
    works(folder, &with("advise", &[]), &["the elements of a body of matrices are not known"]);
    works(folder, &["export", "out/boom.h5", "--csv", "boom.csv"], &[]);
    works(folder, &["report", "out/boom.h5", "-o", "boom.html"], &[]);
    for (arguments, says) in [
        (&["reduce", "boom.toml", "-o", "boom.body.h5"][..], "a body of matrices"),
        (&["modes", "boom.toml", "-o", "pictures"], "elements and surface are not known"),
        (&["animate", "boom.toml", "-o", "boom.gif"], "elements and surface are not known"),
        (&["export", "out/boom.h5", "--vtkhdf", "boom.vtkhdf"], "a body of matrices has none, nor a surface"),
        (&["paper", "boom.toml", "-o", "paper"], "the paper has a free body with a mesh"),
    ] {
        let before = std::fs::read_dir(folder).unwrap().count();
        let output = command_in(folder, arguments).output().unwrap();
        let error = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(3), "{arguments:?}: {error}");
        assert!(error.contains(says), "{arguments:?}: {error}");
        assert_eq!(std::fs::read_dir(folder).unwrap().count(), before, "{arguments:?} wrote something");
    }
}
