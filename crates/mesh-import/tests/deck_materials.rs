//! Materials in decks of Abaqus, CalculiX and Nastran, which belong to sets and properties. Needs gmsh
//! (`./dev test` sees to it).

use std::fs;
use std::process::Command;

use fem_tet10::Material;
use mesh_import::{ImportSettings, Imported, read_mesh};
use tempfile::TempDir;

const BOX: &str = "SetFactory(\"OpenCASCADE\");\nBox(1) = {0, 0, 0, 3, 1, 1};\nPhysical Volume(\"bar\") = {1};\n";
const ALUMINIUM: Material = Material { young_modulus: 70e3, poisson_ratio: 0.33, density: 2.7e-9 };

/// A box as a deck of this ending, by gmsh.
fn deck(ending: &str) -> (TempDir, String) {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("bar.geo"), BOX).unwrap();
    let name = format!("bar.{ending}");
    let mut command = Command::new("gmsh");
    command.args(["bar.geo", "-3", "-order", "2", "-v", "0", "-o", &name]).current_dir(folder.path());
    assert!(command.output().unwrap().status.success());
    let text = fs::read_to_string(folder.path().join(name)).unwrap();
    (folder, text)
}

fn read(folder: &TempDir, name: &str, text: &str) -> Imported {
    fs::write(folder.path().join(name), text).unwrap();
    read_mesh(&folder.path().join(name), &ImportSettings::default()).unwrap_or_else(|error| panic!("{error}"))
}

#[test]
fn materials_of_abaqus_belong_to_the_sets_of_their_sections() {
    let (folder, text) = deck("inp");
    let section = "*SOLID SECTION, ELSET=bar, MATERIAL=Alu\n";
    let elastic = "*ELASTIC\n70000., 0.33\n";
    let density = "*DENSITY\n2.7E-9,\n";
    let material = "*MATERIAL, NAME=ALU\n";
    let of = |more: String| read(&folder, "bar.inp", &(text.clone() + &more));
    let found = of(format!("{material}{elastic}{density}{section}"));
    assert!(found.notes.is_empty(), "{:?}", found.notes);
    let [deck] = &found.materials[..] else { panic!("{:?}", found.materials) };
    assert_eq!((&*deck.group, &*deck.name, deck.material), ("bar", "ALU", ALUMINIUM));
    // In the other order, with a temperature, in other letters.
    let found =
        of("* Solid Section, elset=BAR, material=alu\n*material,name=Alu\n*density\n2.7e-9, 20.\n*elastic, type=iso\n\
                    70e3, 0.33, 20.\n"
            .to_owned());
    assert_eq!(found.materials.first().map(|deck| deck.material), Some(ALUMINIUM), "{:?}", found.notes);
    for (more, words) in [
        (
            format!("{material}*ELASTIC\n70e3, 0.33, 20.\n60e3, 0.33, 200.\n{density}{section}"),
            "a table over temperature",
        ),
        (format!("{material}*ELASTIC, TYPE=ORTHO\n1, 1, 1, 1, 1, 1, 1, 1\n1\n{density}{section}"), "TYPE=ORTHO"),
        (format!("{material}{elastic}{section}"), "no *DENSITY"),
        (format!("{material}{density}{section}"), "no *ELASTIC"),
        (format!("{material}{elastic}{density}"), "no *SOLID SECTION names it"),
        (section.to_owned(), "no *MATERIAL of this name"),
        (format!("{material}*ELASTIC\n70e3, 0.5\n{density}{section}"), "Poisson's ratio 0.5"),
    ] {
        let found = of(more);
        assert!(found.materials.is_empty(), "{words}: {:?}", found.materials);
        let said = found.notes.join("\n");
        assert!(said.to_lowercase().contains("the material alu") && said.contains(words), "{words}: {said}");
    }
}

/// Closed form: the numbers on the cards, and ν = E/2G − 1.
#[test]
fn materials_of_nastran_belong_to_the_elements_of_their_properties() {
    let (folder, text) = deck("bdf");
    for cards in [
        "MAT1,7,70.+3,,.33,2.7-9\nPSOLID,1,7\n".to_owned(),
        format!("MAT1    {:>8}{:>8}{:>8}{:>8}{:>8}\nPSOLID  {:>8}{:>8}\n", 7, "70000.", "", ".33", "2.7-9", 1, 7),
        format!("MAT1*   {:>16}{:>16}{:>16}{:>16}\n*       {:>16}\nPSOLID,1,7\n", 7, "70000.", "", ".33", "2.7E-9"),
        "mat1,7,70000.,26315.789473684,,2.7E-6\npsolid,1,7\nPARAM,WTMASS,.001\n".to_owned(),
        "SOL 103\nCEND\n PARAM, WTMASS, .001\nBEGIN BULK\nMAT1,7,70000.,,.33,2.7-6\nPSOLID,1,7\n".to_owned(),
    ] {
        let found = read(&folder, "bar.bdf", &format!("{cards}{text}"));
        let [deck] = &found.materials[..] else { panic!("{cards}: {:?} {:?}", found.materials, found.notes) };
        let Material { young_modulus, poisson_ratio, density } = deck.material;
        let close = |a: f64, b: f64| (a / b - 1.0).abs() < 1e-9;
        assert!(close(young_modulus, 70e3) && close(poisson_ratio, 0.33) && close(density, 2.7e-9), "{deck:?}");
        assert_eq!((&*deck.group, &*deck.name), ("ref_1", "MAT1 7"));
    }
    for (cards, words) in [("PSOLID,1,7\nMAT9,7,1.,1.\n", "of kind MAT9"), ("PSOLID,1,8\n", "none of that number")] {
        let found = read(&folder, "bar.bdf", &format!("{cards}{text}"));
        assert!(found.materials.is_empty() && found.notes.join("\n").contains(words), "{:?}", found.notes);
    }
}
