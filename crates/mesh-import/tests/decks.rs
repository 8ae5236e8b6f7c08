//! Decks of Abaqus and CalculiX in the forms that people have: each is the same box of 3 x 1 x 1, or is refused with its line.
//! Needs gmsh (`./dev test` sees to it).

use std::fmt::Write;
use std::fs;

use bar::{Bar, Dice, mean_of, of_environment, volume};
use mesh_import::Imported;

mod bar;

fn plain(x: [f64; 3]) -> String {
    format!("{:?}, {:?}, {:?}", x[0], x[1], x[2])
}

/// Closed form: the box is 3 x 1 x 1; in cylindrical coordinates its nodes are at the same places.
#[test]
fn coordinates_are_read_in_their_systems() {
    let bar = Bar::new();
    let elements = format!("*ELEMENT, TYPE=C3D10, ELSET=all\n{}", bar.element_lines());
    let polar = |x: [f64; 3]| format!("{:?}, {:?}, {:?}", x[0].hypot(x[1]), x[1].atan2(x[0]).to_degrees(), x[2]);
    let short = |x: [f64; 3]| {
        let field = |c: f64| if c == 0.0 { String::new() } else { format!("{c:?}D0") };
        let all = x.map(field).join(", ");
        all.trim_end_matches([',', ' ']).to_owned()
    };
    for (name, nodes) in [
        ("plain", format!("*NODE\n{}", bar.node_lines(plain))),
        ("cylindrical", format!("*NODE, SYSTEM=C\n{}", bar.node_lines(polar))),
        // Its x axis is along -y, its y axis along x.
        (
            "a system",
            format!("*SYSTEM\n1, 2, 5, 1, 1, 5\n2, 2, 5\n*NODE\n{}", {
                bar.node_lines(|x| plain([2.0 - x[1], x[0] - 1.0, x[2] - 5.0]))
            }),
        ),
        ("blank fields and D", format!("*Node, nset=a\n{}", bar.node_lines(short))),
    ] {
        let read = bar.read("systems.inp", &format!("** a comment\n{nodes}{elements}"));
        let Imported { mesh, notes, .. } = read.unwrap_or_else(|error| panic!("{name}: {error}"));
        assert!(notes.is_empty(), "{name}: {notes:?}");
        let parts = mesh.parts();
        for (tag, x) in parts.node_tags.iter().zip(&parts.positions) {
            let (_, given) = bar.nodes.iter().find(|(label, _)| label == tag).unwrap();
            let is_there = (0..3).all(|i| (x[i] - given[i]).abs() < 1e-9);
            assert!(is_there, "{name}: node {tag} at {x:?} for {given:?}");
        }
    }
    for (text, words) in [
        ("*NODE, SYSTEM=S\n1, 1, 2, 3\n", ["line 1", "SYSTEM"]),
        ("*NODE\n1, 1, x, 3\n", ["line 2", "coordinates"]),
        ("*NODE\n1, 0, 0, 0\n*NGEN\n1, 2\n", ["line 3", "*NGEN"]),
        ("*SYSTEM\n0,0,0,0,0,1\n", ["line 2", "second line"]),
        ("*NODE\n1, 0, 0, 0\n*ELEMENT, TYPE=C3D10\n1, 1, 1, 1\n", ["line 4", "all nodes"]),
    ] {
        let said = bar.read("bad.inp", text).unwrap_err().to_string();
        assert!(words.iter().all(|word| said.contains(word)), "{said}");
    }
}

/// Closed form: where the sets are. The part's set and the assembly's have one name, as CAE numbers them, and a reference point
/// of the assembly has the number of a node.
#[test]
fn names_of_parts_and_of_the_assembly_are_kept_apart() {
    let bar = Bar::new();
    let deck = |placement: &str| {
        format!(
            "*Heading\n*Part, name=Part-1\n*Node\n{}*Element, type=C3D10\n{}*Nset, nset=Set-1\n{}*Elset, elset=Set-2, generate\n1, \
             1000000, 1\n*Solid Section, elset=Set-2, material=Steel\n,\n*End Part\n*Assembly, name=Assembly\n*Instance, \
             name=Part-1-1, part=Part-1\n{placement}*End Instance\n*Node\n1, 9., 0., 0.\n*Nset, nset=RP\n1,\n*Nset, nset=Set-1, \
             instance=Part-1-1\n{}*Nset, nset=both\nPart-1-1.Set-1, Set-1\n*End Assembly\n*Material, name=steel\n*Density\n7.85e-9,\n\
             *Elastic\n210000., 0.3\n",
            bar.node_lines(plain),
            bar.element_lines(),
            bar.at(0.0),
            bar.at(3.0)
        )
    };
    let Imported { mesh, materials, notes, .. } =
        bar.read("scopes.inp", &deck("")).unwrap_or_else(|error| panic!("{error}"));
    assert!((mean_of(&mesh, "Set-1")[0] - 3.0).abs() < 1e-9);
    assert!(mean_of(&mesh, "Part-1.Set-1")[0].abs() < 1e-9);
    assert_eq!(mesh.group_nodes("both").unwrap().len(), bar.at(0.0).lines().count() + bar.at(3.0).lines().count());
    assert!((volume(&mesh) - 3.0).abs() < 1e-9);
    assert_eq!(materials.len(), 1, "{materials:?}");
    assert_eq!((&*materials[0].group, materials[0].material.young_modulus), ("Set-2", 210e3));
    assert_eq!(notes, ["the node set RP has no nodes of the body"]);
    // Moved along x, then turned about the z axis by a quarter: its far end is at y = 13.
    let placement = "10., 0., 0.\n10., 0., 0., 10., 0., 1., 90.\n";
    let mesh = bar.read("moved.inp", &deck(placement)).unwrap_or_else(|error| panic!("{error}")).mesh;
    let end = mean_of(&mesh, "Set-1");
    assert!((end[1] - 3.0).abs() < 1e-9 && (end[0] - 9.5).abs() < 0.2, "{end:?}");
}

#[test]
fn what_is_not_used_is_counted_and_named() {
    let bar = Bar::new();
    let more = "*ELEMENT, TYPE=MASS, ELSET=m\n9001, 1\n*MASS, ELSET=m\n7.85e-4\n*ELEMENT, TYPE=SPRINGA, ELSET=k\n9002, 1, 2\n\
                *SPRING, ELSET=k\n\n10.\n*EQUATION\n2\n1, 1, 1., 2, 1, -1.\n*RIGID BODY, REF NODE=1, NSET=root\n*COUPLING, \
                CONSTRAINT NAME=hub, REF NODE=1, SURFACE=face\n*KINEMATIC\n1, 3\n*COUPLING, REF NODE=1, SURFACE=face\n*KINEMATIC\n1, 2\n*COUPLING, REF NODE=1, SURFACE=face, INFLUENCE RADIUS=3.\n*DISTRIBUTING, WEIGHTING METHOD=LINEAR\n*MODEL CHANGE, TYPE=CONTACT PAIR, ADD\na, b\n\
                *ELEMENT, TYPE=S3, ELSET=skin\n9005, 1, 2, 3\n*MATERIAL, NAME=lead\n*DENSITY\n70.\n*SHELL SECTION, ELSET=skin, MATERIAL=lead\n.1, 5\n*ELEMENT, TYPE=S3R, ELSET=layers\n9006, 1, 2, 3\n\
                *SHELL SECTION, ELSET=layers, COMPOSITE, SYMMETRIC\n.1, 3, lead, 0.\n.2, , LEAD\n*ELEMENT, TYPE=B31, ELSET=edges\n9003, 1, 2,\n9004, 1, 2,\n*SECRET\n1\n";
    let text = format!(
        "*NODE\n{}*ELEMENT, TYPE=C3D10, ELSET=all\n{}*NSET, NSET=root\n{}{more}",
        bar.node_lines(plain),
        bar.element_lines(),
        bar.at(0.0)
    );
    let Imported { mut notes, beside, .. } = bar.read("more.inp", &text).unwrap_or_else(|error| panic!("{error}"));
    assert_eq!(notes.len(), 1, "{notes:?}");
    let first = bar.nodes.iter().find(|(label, _)| *label == 1).unwrap().1;
    let [rigid] = &beside.ties[..] else { panic!("{:?}", beside.ties) };
    assert_eq!((&*rigid.group, rigid.is_rigid, rigid.at), ("root", true, Some(first)));
    assert_eq!(beside.unused_masses(|mass| mass.at == first), None);
    notes[0] += &(beside.unused_masses(|_| false).unwrap() + &beside.unused_ties(|_| false).unwrap());
    // Closed form: the area between the corners.
    let at = |node: u64| bar.nodes.iter().find(|(label, _)| *label == node).unwrap().1;
    let side = |node: u64| -> [f64; 3] { std::array::from_fn(|i| at(node)[i] - first[i]) };
    let (a, b) = (side(2), side(3));
    let across = [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
    let area = across.iter().map(|c| c * c).sum::<f64>().sqrt() / 2.0;
    let shell = format!("1 S3 ({:.4e})", area * 0.1 * 70.0);
    let layers = format!("1 S3R ({:.4e})", area * 0.6 * 70.0);
    for words in [
        "read: ",
        "1 MASS (7.8500e-4",
        "point_masses = [{ at = [",
        "1 SPRINGA",
        "2 B31 (mass not known)",
        shell.as_str(),
        layers.as_str(),
        "1 *COUPLING in some directions only",
        "1 *MODEL CHANGE",
        "1 *SPRING",
        "1 *EQUATION",
        "1 *RIGID BODY (in a scene: a marker with group = \"root\" and tie = \"rigid\")",
        "2 *COUPLING of face",
        "1 INFLUENCE RADIUS of *COUPLING",
        "1 WEIGHTING METHOD of *DISTRIBUTING",
        "1 keyword(s) that are not known",
    ] {
        assert!(notes[0].contains(words), "{words}: {notes:?}");
    }
    assert!(!notes[0].contains("SECRET"));
}

/// Conserved: nodes, volume and sets of one body, however its deck is written. `FLEXFRAME_DECKS` is the number of decks.
#[test]
fn one_body_written_at_random_is_one_body() {
    let bar = Bar::new();
    for seed in 0..of_environment() {
        let dice = &mut Dice(seed);
        let text = written(&bar, dice);
        let name = format!("{seed}.inp");
        let Imported { mesh, materials, .. } =
            bar.read(&name, &text).unwrap_or_else(|error| panic!("{seed}: {error}\n"));
        fs::remove_file(bar.folder.path().join(name)).unwrap();
        assert_eq!(mesh.elements().len(), bar.elements.len(), "{seed}");
        assert!((volume(&mesh) - 3.0).abs() < 1e-9, "{seed}");
        assert_eq!(mesh.group_nodes("root").unwrap().len(), bar.at(0.0).lines().count(), "{seed}");
        assert!(mean_of(&mesh, "tip")[0] > 2.999, "{seed}");
        assert_eq!(materials.first().map(|deck| deck.material.density), Some(7.85e-9), "{seed}: {materials:?}");
    }
}

fn written(bar: &Bar, dice: &mut Dice) -> String {
    let end = ["\n", "\r\n"][dice.up_to(2)];
    let in_parts = dice.up_to(2) == 0;
    let number = |dice: &mut Dice, c: f64| match dice.up_to(4) {
        0 => format!("{c:?}"),
        1 => format!("{c:.17E}"),
        2 => format!("{c:.17e}").replace('e', "D"),
        _ if c == 0.0 => String::new(),
        _ => format!(" {c:?} "),
    };
    // A system with its origin elsewhere.
    let origin = [[0.0; 3], [0.5, -2.0, 4.0]][dice.up_to(2)];
    let mut nodes = if origin == [0.0; 3] { String::new() } else { dice.spelled("*SYSTEM\n.5, -2., 4.D0\n") };
    nodes += &dice.spelled("*NODE");
    let in_cylinders = dice.up_to(3) == 0;
    if dice.up_to(3) == 0 {
        nodes += &dice.spelled(" , NSET = all nodes");
    }
    if in_cylinders {
        nodes += &dice.spelled(", SYSTEM=C");
    }
    nodes.push('\n');
    for (label, x) in &bar.nodes {
        let x: [f64; 3] = std::array::from_fn(|i| x[i] - origin[i]);
        let x = if in_cylinders { [x[0].hypot(x[1]), x[1].atan2(x[0]).to_degrees(), x[2]] } else { x };
        let fields = x.map(|c| number(dice, c)).join(",");
        let _ = writeln!(nodes, "{label},{fields}");
        if dice.up_to(20) == 0 {
            nodes += "** *NODE\n";
        }
    }
    let mut elements = dice.spelled("*ELEMENT, TYPE=C3D10");
    let is_named = dice.up_to(2) == 0;
    elements += if is_named { ", ELSET=ALL\n" } else { "\n" };
    for element in &bar.elements {
        let mut words: Vec<String> = element.iter().map(u64::to_string).collect();
        if dice.up_to(2) == 0 {
            let at = 1 + dice.up_to(9);
            words[at] = format!("\n{}", words[at]);
        }
        elements += &(words.join(", ") + ["", ","][dice.up_to(2)] + "\n");
    }
    if !is_named {
        elements += &dice.spelled("*ELSET, ELSET=ALL,GENERATE\n1, 99999\n");
    }
    let sets = format!("*NSET,\nNSET=root\n{}*Nset, nset=inner\n{}*nset, nset=tip\ninner\n", bar.at(0.0), bar.at(3.0));
    let space = ["", " "][dice.up_to(2)];
    let section = dice.spelled(&format!("*SOLID{space}SECTION, ELSET=all, MATERIAL=Steel\n,\n"));
    let material = dice.spelled("*MATERIAL, NAME=STEEL\n*ELASTIC\n210e3,.3\n*DENSITY\n7.85e-9\n");
    let mut blocks = [nodes, elements, sets, section];
    // Any order is one deck.
    for i in (1..blocks.len()).rev() {
        blocks.swap(i, dice.up_to(i + 1));
    }
    if dice.up_to(3) == 0 {
        let at = dice.up_to(blocks.len());
        fs::write(bar.folder.path().join("more.txt"), &blocks[at]).unwrap();
        blocks[at] = dice.spelled("*INCLUDE, INPUT=") + "more.txt\n";
    }
    let body = blocks.concat();
    let text = if in_parts {
        // Moved across, and turned about its length.
        let placement = ["", "0., 7.\n", "0, 0, -1D0\n0, 0, 0, 2., 0, 0, 90.\n"][dice.up_to(3)];
        format!(
            "*PART, NAME=P\n{body}*END PART\n*ASSEMBLY, NAME=A\n*INSTANCE, NAME=P-1, PART=p\n{placement}*END INSTANCE\n*END ASSEMBLY\n{material}"
        )
    } else {
        format!("*HEADING\n a bar\n{material}{body}")
    };
    text.replace('\n', end)
}

#[test]
fn an_included_file_is_not_quoted() {
    let bar = Bar::new();
    fs::write(bar.folder.path().join("secret.txt"), "user:password\n").unwrap();
    let said = bar.read("leak.inp", "*NODE\n*INCLUDE, INPUT=secret.txt\n").unwrap_err().to_string();
    assert!(said.contains("secret.txt") && said.contains("line 1") && !said.contains("password"), "{said}");
}
