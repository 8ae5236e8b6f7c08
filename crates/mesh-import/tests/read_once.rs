//! A mesh is made of the same bytes as it is known by, whatever becomes of the files. Needs gmsh, and numpy in the
//! Python that `FLEXFRAME_PYTHON` names (`./dev test` sees to both).

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use keys::Hash;
use mesh_import::{ImportSettings, MeshFile};

/// A bar of this length along x.
fn geometry(length: f64) -> String {
    format!("SetFactory(\"OpenCASCADE\");\nBox(1) = {{0, 0, 0, {length}, 1, 1}};\nPhysical Volume(\"bar\") = {{1}};\n")
}

/// A bar of this length, in all forms: files, of which the first is the mesh.
fn forms(folder: &Path, length: f64) -> Vec<(&'static str, Vec<&'static str>)> {
    let write = |name: &str, text: String| fs::write(folder.join(name), text).unwrap();
    let gmsh = |arguments: &[&str]| {
        let output = Command::new("gmsh").args(arguments).current_dir(folder).output().unwrap();
        assert!(output.status.success(), "{arguments:?}: {}", String::from_utf8_lossy(&output.stderr));
    };
    write("bar.geo", geometry(length));
    gmsh(&["bar.geo", "-3", "-order", "2", "-format", "msh41", "-o", "bar.msh"]);
    gmsh(&["bar.geo", "-3", "-order", "2", "-format", "msh22", "-o", "old.msh"]);
    gmsh(&["bar.geo", "-0", "-o", "bar.step"]);
    gmsh(&["bar.geo", "-3", "-order", "2", "-o", "bar.inp"]);
    write("length.geo", format!("x = {length};\n"));
    write(
        "includes.geo",
        geometry(0.0).replace("{0, 0, 0, 0, 1", "{0, 0, 0, x, 1").replacen('\n', "\nInclude 'length.geo';\n", 1),
    );
    write(
        "merges.geo",
        "SetFactory(\"OpenCASCADE\");\nMerge 'bar.step';\nPhysical Volume(\"bar\") = {1};\n".to_owned(),
    );
    write("includes.inp", "*HEADING\r\nA bar\r\n* INCLUDE, INPUT=\"parts/more.inp\"\r\n".to_owned());
    fs::create_dir_all(folder.join("parts")).unwrap();
    write("parts/more.inp", "*include,input = ../bar.inp\n".to_owned());
    vec![
        ("bar.geo", vec!["bar.geo"]),
        ("bar.msh", vec!["bar.msh"]),
        ("old.msh", vec!["old.msh"]),
        ("bar.step", vec!["bar.step"]),
        ("bar.inp", vec!["bar.inp"]),
        ("includes.geo", vec!["length.geo", "includes.geo"]),
        ("merges.geo", vec!["bar.step"]),
        ("includes.inp", vec!["bar.inp"]),
    ]
}

fn hash(path: &Path) -> Hash {
    MeshFile::read(path, &ImportSettings::default()).unwrap_or_else(|error| panic!("{error}")).hash().unwrap()
}

fn length(file: &MeshFile) -> f64 {
    file.mesh().unwrap_or_else(|error| panic!("{error}")).mesh.size()[0]
}

/// Closed form: the lengths of the bars.
#[test]
fn files_that_are_replaced_after_they_were_read_are_not_what_is_meshed() {
    let [one, two] = [(); 2].map(|()| tempfile::tempdir().unwrap());
    let all = forms(one.path(), 3.0);
    forms(two.path(), 4.0);
    for (name, _) in &all {
        let path = one.path().join(name);
        // Where it lies does not matter.
        assert_ne!(hash(&path), hash(&two.path().join(name)), "{name}");
    }
    for (name, replaced) in all {
        let place: PathBuf = one.path().join(name);
        let file = MeshFile::read(&place, &ImportSettings::default()).unwrap();
        let before = file.hash().unwrap();
        let saved: Vec<(PathBuf, Vec<u8>)> =
            replaced.iter().map(|name| (one.path().join(name), fs::read(one.path().join(name)).unwrap())).collect();
        for name in &replaced {
            fs::copy(two.path().join(name), one.path().join(name)).unwrap();
        }
        let after = MeshFile::read(&place, &ImportSettings::default()).unwrap();
        assert_ne!(after.hash().unwrap(), before, "{name}");
        assert_eq!(after.hash(), Some(hash(&two.path().join(name))), "{name}");
        for (path, _) in &saved {
            fs::remove_file(path).unwrap();
        }
        let ([of_file, of_other], known) = ([length(&file), length(&after)], file.hash().unwrap());
        assert!((of_file - 3.0).abs() < 1e-9 && (of_other - 4.0).abs() < 1e-9, "{name}: {of_file} {of_other}");
        assert_eq!(known, before, "{name}");
        saved.into_iter().for_each(|(path, bytes)| fs::write(path, bytes).unwrap());
        assert_eq!(hash(&place), before, "{name}");
    }
}

#[test]
fn decks_that_include_what_they_cannot_are_refused_with_the_line() {
    let folder = tempfile::tempdir().unwrap();
    let place = |name: &str| folder.path().join(name);
    fs::write(place("round.inp"), "*NODE\n1, 0, 0, 0\n*INCLUDE, INPUT=back.inp\n").unwrap();
    fs::write(place("back.inp"), "*INCLUDE, INPUT=round.inp\n").unwrap();
    fs::write(place("lost.inp"), "*HEADING\n\n* INCLUDE, INPUT=absent.inp\n").unwrap();
    fs::write(place("bare.inp"), "*INCLUDE\n").unwrap();
    for (name, words) in [
        ("round.inp", ["back.inp", "line 1", "round.inp, which includes this file"]),
        ("lost.inp", ["lost.inp", "line 3", "absent.inp, which cannot be read"]),
        ("bare.inp", ["bare.inp", "line 1", "without the name of a file"]),
    ] {
        let said = MeshFile::read(&place(name), &ImportSettings::default()).unwrap_err().to_string();
        assert!(words.iter().all(|word| said.contains(word)), "{name}: {said}");
    }
}

/// Data that another program reads beside the file is not known before.
#[test]
fn what_names_data_beside_it_is_known_by_nothing() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("bar.xdmf");
    let known = |format: &str| {
        fs::write(&path, format!("<Xdmf><DataItem Format=\"{format}\">1</DataItem></Xdmf>\n")).unwrap();
        MeshFile::read(&path, &ImportSettings::default()).unwrap().hash().is_some()
    };
    assert_eq!((known("XML"), known("HDF")), (true, false));
}
