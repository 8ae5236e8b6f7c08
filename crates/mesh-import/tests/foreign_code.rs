//! Files that would have other programs run, write or read what they like, and what becomes of them. Needs gmsh, and meshio in the
//! Python that `FLEXFRAME_PYTHON` names (`./dev test` sees to both).

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use mesh_import::{ImportError, ImportSettings, Imported, read_mesh};
use tempfile::TempDir;

const BOX: &str = "SetFactory(\"OpenCASCADE\");\nBox(1) = {0, 0, 0, 1, 1, 1};\nPhysical Volume(\"block\") = {1};\n";

/// A folder with files, and one beside it in which a file appears where foreign code has run.
struct Place {
    folder: TempDir,
    marks: TempDir,
}

impl Place {
    fn new() -> Self {
        Self { folder: tempfile::tempdir().unwrap(), marks: tempfile::tempdir().unwrap() }
    }

    fn path(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    fn write(&self, name: &str, text: &str) -> PathBuf {
        if let Some(folder) = Path::new(name).parent() {
            fs::create_dir_all(self.path(folder.to_str().unwrap())).unwrap();
        }
        fs::write(self.path(name), text).unwrap();
        self.path(name)
    }

    /// The path of a mark.
    fn mark(&self) -> String {
        self.marks.path().join("mark").display().to_string()
    }

    fn touch(&self) -> String {
        format!("SystemCall \"touch {}\";", self.mark())
    }

    fn read(&self, name: &str, settings: ImportSettings) -> Result<Imported, ImportError> {
        read_mesh(&self.path(name), &settings)
    }

    /// A geometry and meshes of it, by gmsh.
    fn gmsh(&self, geometry: &str, name: &str, more: &[&str]) {
        let mut command = Command::new("gmsh");
        command.args([geometry, "-v", "0"]).args(more).args(["-o", name]).current_dir(self.folder.path());
        assert!(command.output().unwrap().status.success(), "{name}");
    }

    #[track_caller]
    fn nothing_has_run(&self, what: &str) {
        let marks: Vec<_> = fs::read_dir(self.marks.path()).unwrap().map(|mark| mark.unwrap().path()).collect();
        assert!(marks.is_empty(), "{what}: {marks:?}");
    }

    #[track_caller]
    fn refuses(&self, name: &str, settings: ImportSettings, words: &[&str]) {
        let said = match self.read(name, settings) {
            Ok(_) => panic!("{name} is read; expected {words:?}"),
            Err(error) => error.to_string(),
        };
        assert!(words.iter().all(|word| said.contains(word)), "{name}: {said}");
        self.nothing_has_run(name);
    }
}

fn raised() -> ImportSettings {
    ImportSettings { raise_order: true, ..ImportSettings::default() }
}

fn trusted() -> ImportSettings {
    ImportSettings { trust_geometry: true, ..ImportSettings::default() }
}

/// The first finding of the trials: gmsh takes what does not begin as a mesh for a program.
#[test]
fn a_mesh_that_is_a_program_is_not_run() {
    let place = Place::new();
    place.write("bar.geo", BOX);
    place.gmsh("bar.geo", "bar.msh", &["-3", "-format", "msh22"]);
    let mesh = fs::read_to_string(place.path("bar.msh")).unwrap();
    let touch = place.touch();
    for (name, text) in [
        ("comment.msh", format!("{touch} /*\n{mesh}*/\n")),
        ("line.msh", format!("{touch}\n{mesh}")),
        ("space.msh", format!(" $MeshFormat\n{touch}\n{mesh}")),
        ("empty_line.msh", format!("\n{mesh}\n{touch}")),
        ("mark.msh", format!("\u{feff}{mesh}{touch}")),
        ("almost.msh", format!("$MeshFormats\n{touch}\n{mesh}")),
        ("view.msh", format!("$View\n{touch}\n{mesh}")),
    ] {
        place.write(name, &text);
        for settings in [ImportSettings::default(), raised(), ImportSettings { trust_geometry: true, ..raised() }] {
            assert!(place.read(name, settings).is_err(), "{name}");
            place.nothing_has_run(name);
        }
    }
    place.refuses("comment.msh", raised(), &["comment.msh", "does not begin as .msh files do", "expected $MeshFormat"]);
    // Comments are a section of the format.
    place.write("comments.msh", &format!("$Comments\n{touch}\n$EndComments\n{mesh}"));
    assert!(place.read("comments.msh", raised()).unwrap().mesh.elements().len() > 10);
    place.nothing_has_run("comments.msh");
}

/// gmsh merges `FILE.opt` with `FILE`, and the options of its user.
#[test]
fn options_beside_a_file_and_of_the_user_are_not_read() {
    let place = Place::new();
    place.write("bar.geo", BOX);
    let touch = place.touch();
    for (name, more) in [
        ("old.msh", &["-3", "-order", "2", "-format", "msh22"][..]),
        ("linear.msh", &["-3", "-format", "msh41"]),
        ("bar.unv", &["-3", "-order", "2"]),
        ("bar.step", &["-0"]),
        ("bar.brep", &["-0"]),
    ] {
        place.gmsh("bar.geo", name, more);
        place.write(&format!("{name}.opt"), &touch);
        let settings = ImportSettings { raise_order: name == "linear.msh", ..ImportSettings::default() };
        assert!(place.read(name, settings).unwrap().mesh.elements().len() > 10, "{name}");
        place.nothing_has_run(name);
    }
    place.write("bar.geo.opt", &touch);
    assert!(place.read("bar.geo", ImportSettings::default()).is_ok());
    place.nothing_has_run("bar.geo");
}

/// Modules and settings of Python beside a mesh.
#[test]
fn modules_beside_a_file_are_not_run() {
    let place = Place::new();
    place.write("bar.geo", BOX);
    place.gmsh("bar.geo", "bar.inp", &["-3", "-order", "2", "-format", "inp"]);
    place.gmsh("bar.geo", "bar.vtk", &["-3", "-order", "2"]);
    for module in ["numpy", "json", "io", "contextlib", "meshio", "collections", "sitecustomize", "h5py", "source"] {
        place.write(&format!("{module}.py"), &format!("open({:?}, 'w')\n", place.mark()));
    }
    // As of a user who stands in the folder, also one whose path of modules has that folder in it by its empty entry.
    for (variable, value) in [("PYTHONPATH", ":"), ("PYTHONPATH", "."), ("NOTHING", "")] {
        for name in ["bar.inp", "bar.vtk"] {
            let mut part = Command::new(std::env::current_exe().unwrap());
            part.args(["--exact", "reads_what_it_is_told", "--ignored"]).current_dir(place.folder.path());
            let output = part.env("FOREIGN_CODE_TEST", name).env(variable, value).output().unwrap();
            assert!(output.status.success(), "{name}: {}", String::from_utf8_lossy(&output.stdout));
            place.nothing_has_run(name);
        }
    }
}

#[test]
#[ignore = "a part of another test"]
fn reads_what_it_is_told() {
    let name = std::env::var_os("FOREIGN_CODE_TEST").unwrap();
    let read = read_mesh(Path::new(&name), &ImportSettings::default());
    assert!(read.unwrap_or_else(|error| panic!("{error}")).mesh.elements().len() > 10);
}

#[test]
fn geometry_that_runs_writes_or_names_what_it_likes_is_refused_unless_it_is_trusted() {
    let place = Place::new();
    let mark = place.mark();
    let touch = format!("touch {mark}");
    for (line, word) in [
        (format!("SystemCall \"{touch}\";"), "`SystemCall`"),
        (format!("NonBlockingSystemCall '{touch}';"), "`SystemCall`"),
        (format!("System \"{touch}\";"), "`System`"),
        (format!("S2N[StrCat(\"Sys\", \"tem\")] \"{touch}\";"), "`S2N`"),
        (format!("StringToName[StrCat(\"Sys\", \"tem\")] \"{touch}\";"), "`StringToName`"),
        (format!("OnelabRun(\"x\", \"{touch}\");"), "`OnelabRun`"),
        (format!("Field[1] = ExternalProcess; Field[1].CommandLine = \"{touch}\";"), "`ExternalProcess`"),
        (format!("Save \"{mark}\";"), "`Save`"),
        (format!("Print \"{mark}.msh\";"), "`Print`"),
        (format!("Printf(\"x\") > \"{mark}\";"), "`) >`"),
        (format!("Printf(\"%g\", 1) /* into */\n>> \"{mark}\";"), "`) >`"),
        (format!("CreateDir \"{mark}\";"), "`CreateDir`"),
        ("Plugin(NewView).Run;".to_owned(), "`Plugin`"),
        (format!("General.OptionsFileName = \"{mark}\";"), "`FileName`"),
        (format!("Print.ParameterCommand = \"System '{touch}';\";"), "`System`"),
        ("Solver.Executable0 = \"x\";".to_owned(), "`Solver`"),
        (format!("s = \"{mark}\"; Merge s;"), "`Merge` of a file"),
        ("Include StrCat(\"a\", \".geo\");".to_owned(), "`Include` of a file"),
        ("l[] = ListFromFile[Str(\"numbers\")];".to_owned(), "`ListFromFile` of a file"),
    ] {
        place.write("bar.geo", &format!("{BOX}\n{line}\n"));
        place.refuses("bar.geo", ImportSettings::default(), &["bar.geo", "line 5", word, "--trust-geometry"]);
    }
    for (line, words) in [("/* a comment", "a comment that does not end"), ("a = \"x;", "a text that does not end")] {
        place.write("bar.geo", &format!("{BOX}\n{line}\n"));
        place.refuses("bar.geo", ImportSettings::default(), &[words]);
    }
    place.write("bar.geo", &format!("{BOX}/* \0 {} */\n", place.touch()));
    place.refuses("bar.geo", ImportSettings::default(), &["a byte that is zero"]);
    // Trusted geometry works where it is.
    place.write("bar.geo", "SystemCall \"sh make.sh\";\nMerge StrCat(CurrentDirectory, \"part.geo\");\n");
    place.write("make.sh", &format!("touch {mark}\ncat > part.geo <<'END'\n{BOX}END\n"));
    assert!(place.read("bar.geo", trusted()).unwrap().mesh.elements().len() > 10);
    assert!(Path::new(&mark).is_file());
}

/// Closed form: the extent of the three boxes that words in comments, loops and blocks that are skipped leave.
#[test]
fn what_geometry_includes_is_found_and_looked_at() {
    let place = Place::new();
    place.write("box.geo", "SetFactory(\"OpenCASCADE\");\nBox(1) = {2, 0, 0, 1, 1, 1};\n");
    place.gmsh("box.geo", "box.step", &["-0"]);
    place.write("parts/more/box.step", &fs::read_to_string(place.path("box.step")).unwrap());
    place.write("parts/numbers.txt", "0.25\n0.25\n");
    place.write("parts/shapes.geo", "Macro Shape\n  Box(newv) = {x, 0, 0, 1, 1, 1};\nReturn\n");
    place.write(
        "bar.geo",
        "// Merge and Save, by SystemCall: only words. \"\n\
         SetFactory(\"OpenCASCADE\");\n\
         Include 'parts/shapes.geo'; /* Include \"nothing\";\n */ Mesh.SaveAll = 0; Mesh.MeshSizeMax = 2;\n\
         If (1 < 0)\n  Include \"absent.geo\";\nElse\n  For i In {0:1}\n    x = i;\n    Call Shape;\n  EndFor\n\
         EndIf\n\
         v[] = ShapeFromFile(\"parts/more/box.step\");\n\
         n[] = ListFromFile[ \"parts/numbers.txt\" ];\n\
         Printf(\"%g numbers\", #n[]);\n\
         Coherence;\nPhysical Volume(\"all\") = {Volume{:}};\n",
    );
    let read = place.read("bar.geo", ImportSettings::default()).unwrap_or_else(|error| panic!("{error}"));
    let extent = read.mesh.size();
    assert!((extent[0] - 3.0).abs() < 1e-9, "{extent:?}");
    // What is included is looked at, too, and errors name the files as they are.
    let touch = place.touch();
    place.write("parts/shapes.geo", &format!("Macro Shape\n{touch}\nReturn\n"));
    let shapes = place.path("parts/shapes.geo").display().to_string();
    place.refuses("bar.geo", ImportSettings::default(), &[&shapes, "line 2", "`SystemCall`"]);
    place.write("parts/shapes.geo", "Macro Shape\nReturn\n");
    place.write("parts/more/box.step", &touch);
    place.refuses("bar.geo", ImportSettings::default(), &["parts/more/box.step", "expected ISO-10303-21"]);
    place.write("bar.geo", &format!("{BOX}Include \"absent.geo\";\n"));
    place.refuses("bar.geo", ImportSettings::default(), &[&place.path("absent.geo").display().to_string()]);
    place.write("bar.geo", &format!("{BOX}Box(1) = {{;\n"));
    place.refuses("bar.geo", ImportSettings::default(), &[&place.path("bar.geo").display().to_string(), "line 4"]);
    // A long line, as gmsh itself writes lists.
    let list = (0..4000).map(|i| i.to_string()).collect::<Vec<_>>().join(", ");
    place.write("bar.geo", &format!("l[] = {{{list}}};\n{BOX}"));
    assert!(place.read("bar.geo", ImportSettings::default()).is_ok());
    place.write("bar.geo", &format!("a{} = 1;\n{BOX}", "a".repeat(9000)));
    place.refuses("bar.geo", ImportSettings::default(), &["a line of more than 8000 bytes"]);
    // Files that include each other without an end.
    for i in 0..1100 {
        place.write(&format!("{i}.geo"), &format!("Include \"{}.geo\";\n", i + 1));
    }
    place.refuses("0.geo", ImportSettings::default(), &["more than 1000 files"]);
}

#[test]
fn pipes_and_devices_are_refused_at_once() {
    let place = Place::new();
    for ending in ["inp", "geo", "step", "unv", "vtu", "msh", "xdmf"] {
        let pipe = place.path(&format!("pipe.{ending}"));
        assert!(Command::new("mkfifo").arg(&pipe).status().unwrap().success());
        std::os::unix::fs::symlink("/dev/zero", place.path(&format!("zero.{ending}"))).unwrap();
        for name in ["pipe", "zero"] {
            for settings in [ImportSettings::default(), raised(), trusted()] {
                place.refuses(&format!("{name}.{ending}"), settings, &["a device or a pipe"]);
            }
        }
    }
    place.write("part.inp", "*NODE\n*INCLUDE, INPUT=pipe.inp\n");
    place.refuses("part.inp", ImportSettings::default(), &["a device or a pipe"]);
    place.write("part.geo", "Merge \"zero.step\";\n");
    place.refuses("part.geo", ImportSettings::default(), &["a device or a pipe"]);
    place.write("deep.geo", "Include \"zero.geo\";\n");
    place.refuses("deep.geo", ImportSettings::default(), &["a device or a pipe"]);
}
