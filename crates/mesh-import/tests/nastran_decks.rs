//! Decks of Nastran in the forms that people have: each is the same box of 3 x 1 x 1, or is refused with its line. Needs gmsh
//! (`./dev test` sees to it).

use std::fmt::Write;
use std::fs;

use bar::{Bar, Dice, mean_of, of_environment, volume};
use mesh_import::{ImportSettings, Imported};

mod bar;

/// The cards of the elements, all of property 1. Abaqus and Nastran have one order of nodes.
fn elements(bar: &Bar) -> String {
    let card = |element: &Vec<u64>| {
        let words: Vec<String> = element.iter().map(u64::to_string).collect();
        format!("CTETRA,{},1,{},+\n+,{}\n", words[0], words[1..7].join(","), words[7..].join(","))
    };
    bar.elements.iter().map(card).collect()
}

fn grids(bar: &Bar, system: &str, of: impl Fn([f64; 3]) -> [f64; 3]) -> String {
    let card = |(label, x): &(u64, [f64; 3])| {
        let [x, y, z] = of(*x);
        format!("GRID*,{label},{system},{x:?},{y:?}\n*,{z:?}\n")
    };
    bar.nodes.iter().map(card).collect()
}

fn cylindrical([x, y, z]: [f64; 3]) -> [f64; 3] {
    [x.hypot(y), y.atan2(x).to_degrees(), z]
}

fn spherical([x, y, z]: [f64; 3]) -> [f64; 3] {
    [(x * x + y * y + z * z).sqrt(), x.hypot(y).atan2(z).to_degrees(), y.atan2(x).to_degrees()]
}

fn all_in_place(bar: &Bar, name: &str, text: &str) {
    let Imported { mesh, .. } = bar.read("deck.bdf", text).unwrap_or_else(|error| panic!("{name}: {error}"));
    let parts = mesh.parts();
    assert_eq!(parts.positions.len(), bar.nodes.len(), "{name}");
    for (tag, x) in parts.node_tags.iter().zip(&parts.positions) {
        let (_, given) = bar.nodes.iter().find(|(label, _)| label == tag).unwrap();
        let is_there = (0..3).all(|i| (x[i] - given[i]).abs() < 1e-9);
        assert!(is_there, "{name}: node {tag} at {x:?} for {given:?}");
    }
}

/// Closed form: the nodes are at the same places, whatever system they are written in.
#[test]
fn coordinates_are_read_in_their_systems() {
    let bar = Bar::new();
    let elements = elements(&bar);
    // The axes of a system with its origin in (1, 2, 3), z along X and x along Y.
    let turned = |x: [f64; 3]| [x[1] - 2.0, x[2] - 3.0, x[0] - 1.0];
    let system = "1.,2.,3.,5.,2.,3.\n,1.,4.,3.\n";
    for (name, nodes) in [
        ("basic", grids(&bar, "", |x| x)),
        ("nought over GRDSET", format!("GRDSET,,7\nCORD2R,7,,{system}{}", grids(&bar, "0", |x| x))),
        ("rectangular", format!("CORD2R,7,0,{system}{}", grids(&bar, "7", turned))),
        (
            "cylindrical by GRDSET",
            format!("{}CORD2C,7,,{system}GRDSET,,7\n", grids(&bar, "", |x| cylindrical(turned(x)))),
        ),
        ("spherical", format!("cord2s,7,,{system}{}", grids(&bar, "7", |x| spherical(turned(x))))),
        // The origin of the second is at (2, 2, 4) of the basic system; its points are given by radius, angle and height.
        (
            "a chain",
            format!(
                "CORD2C,8,7,1.,90.,1.,1.,90.,9.\n,2.,90.,1.\n{}CORD2C,7,,{system}",
                grids(&bar, "8", |x| {
                    // z is along X, x along Z.
                    cylindrical([x[2] - 4.0, -(x[1] - 2.0), x[0] - 2.0])
                })
            ),
        ),
        (
            "of nodes",
            format!(
                "GRID,9001,,1.,2.,3.\nGRID,9002,,5.,2.,3.\nGRID,9003,,1.,4.,3.\nCORD1S,3,9001,9002,9003,7,9001,9002,9003\n{}",
                grids(&bar, "7", |x| spherical(turned(x)))
            ),
        ),
    ] {
        all_in_place(&bar, name, &format!("{nodes}{elements}"));
    }
    for (cards, words) in [
        ("GRID,9001,5,1.,2.,3.", ["line 1", "coordinate system 5"]),
        ("GRID,9001,x,1.,2.,3.", ["line 1", "field 3"]),
        ("GRID,9001,,1.,2 .,3.", ["line 1", "field 5"]),
        (
            "CORD2R,1,2,0.,0.,0.,0.,0.,1.\n,1.,0.,0.\nCORD2R,2,1,0.,0.,0.,0.,0.,1.\n,1.,0.,0.\nGRID,9001,2",
            ["line 3", "in itself"],
        ),
        ("CORD2R,1,,0.,0.,0.,0.,0.,1.\n,0.,0.,3.\nGRID,9001,1", ["line 1", "on a line"]),
        ("$\n=,*(1),=", ["line 2", "repeats no card"]),
        ("GRID,1\n=,*(1.5)", ["line 2", "field 2"]),
        ("GRID,1\n=3", ["line 2", "repeats no card"]),
        ("GRID,1\nCTETRA,1,1,1,1,1,1,1,1,+\n+,1,1,1,1\n=,*1,==", ["line 4", "repeats no card"]),
        ("GRID,1\nCTETRA,1,1,1,1,1,1,1,1,+A\n=,*1,==\n+A,1,1,1,1", ["line 3", "repeats no card"]),
        ("GRID,1,,0.,0.,0.,,,,+A\nGRID,2\n+A,1\n+A,2", ["line 4", "second line of this name"]),
        ("GRID,1,,0.,0.,0.,,,,+A\n+B,1", ["line 2", "continues no card"]),
        ("GRID,1\nCTETRA,1,1,1,1,1", ["line 2", "3 nodes"]),
        ("GRID,1\nCTETRA,1,1,1,1,,1", ["line 2", "field 6"]),
        ("GRID,1\nCTETRA,1,1,1,1,1,2", ["line 2", "node 2"]),
        ("GRID,1\nRBE2,1,1,123,1,THRU,9", ["line 2", "field 6"]),
        ("GRID,1\nRBE3,1,,1,123,1.,123,1,THRU\n,9", ["line 2", "field 9"]),
        ("GRID,1\nCHEXA,1,1,1,1,1,2", ["line 2", "1 CHEXA"]),
        ("GRID,1\nGRID,1,,2.", ["line 2", "twice"]),
        ("GRID,1,,2.,,,,,,,3.", ["line 1", "more than 10 fields"]),
        ("INCLUDE 'nowhere.bdf'", ["line 1", "nowhere.bdf"]),
    ] {
        let said = bar.read("bad.bdf", cards).unwrap_err().to_string();
        assert!(words.iter().all(|word| said.contains(word)), "{cards}: {said}");
    }
}

/// Closed form: the volume of a quarter of a ring, whose nodes are given by radius and angle. The edges along the circle are
/// parabolas.
#[test]
fn a_bar_in_a_cylindrical_system_is_a_quarter_of_a_ring() {
    let bar = Bar::new();
    let nodes = grids(&bar, "3", |[x, y, z]| [10.0 + y, 30.0 * x, z]);
    let text = format!("CORD2C,3,,0.,0.,0.,0.,0.,1.\n,1.,0.,0.\n{nodes}{}", elements(&bar));
    let mesh = bar.read("ring.bdf", &text).unwrap_or_else(|error| panic!("{error}")).mesh;
    let exact = std::f64::consts::PI / 4.0 * (11.0_f64.powi(2) - 10.0_f64.powi(2));
    assert!((volume(&mesh) / exact - 1.0).abs() < 2e-3, "{} for {exact}", volume(&mesh));
}

#[test]
fn what_is_not_used_is_counted_and_named() {
    let bar = Bar::new();
    let more = "PARAM,WTMASS,.001\nCORD2R,7,,0.,0.,0.,1.,0.,0.\n,0.,1.,0.\nCONM2,9001,1,7,7.85-1,0.,0.,.5\nRBE2,9002,1,123456,2\n\
                RBE3,9003,,1,123,1.,123,2,3\nCBAR,9004,1,1,2,0.,0.,1.\nCELAS2,9005,1.+3,1,1\nPSHELL,9,1,.1,,,,,3.\nMAT1,1,2.+5,,.3,70.\nCTRIA3,9006,9,1,2,3\n\
                SPC1,1,123,1\nDEQATN  2       f(b,c) = b*c\n        + b,\n+       + c\nBSURF,1,1,2,3,4,5,6,7,\n8,9,10\n\
                CTRIA6,9007,9,1,2,3,,2\nCMASS2,9008,5.,1,2\nPMASS,9009,6.\nCMASS1,9009,,2,1\nCMASS1,9010,9009,2,2\nCMASS1,9011,9009,2,3\n\
                CONM1,9012,3,,7.,,7.,,,+\n+,7.\nCONROD,9013,1,2,1,.1\nRBE2,9014,1,1,2\nRBE3,9015,,1,123,1.,123,2\n,2.,123,3,UM,1,123\nSECRET,1\nENDDATA\nMORE\n";
    let [x, y, z] = bar.nodes.iter().find(|(label, _)| *label == 1).unwrap().1;
    let text = format!("{}{}{more}", grids(&bar, "", |x| x), elements(&bar));
    let Imported { mut notes, beside, mesh, .. } =
        bar.read("more.bdf", &text).unwrap_or_else(|error| panic!("{error}"));
    assert_eq!(
        notes[..2],
        [
            "the material of ref_1 is not known: there is no PSOLID of that number".to_owned(),
            "the weights of RBE3 9015 are taken as equal".to_owned()
        ]
    );
    notes.drain(..2);
    assert_eq!(notes.len(), 1, "{notes:?}");
    let ties: Vec<_> = beside.ties.iter().map(|tie| (&*tie.group, tie.is_rigid, tie.at)).collect();
    let at = Some([x, y, z]);
    assert_eq!(ties, [("RBE2_9002", true, at), ("RBE3_9003", false, at), ("RBE3_9015", false, at)]);
    // The node that the others move with is one of the body.
    assert_eq!(mesh.group_nodes("RBE2_9002").unwrap().len(), 2);
    assert_eq!(mesh.group_nodes("RBE3_9003").unwrap().len(), 2);
    notes[0] += &(beside.unused_masses(|_| false).unwrap() + &beside.unused_ties(|_| false).unwrap());
    assert_eq!(beside.unused_ties(|_| true), None);
    // Closed form: areas and lengths between the nodes, with the factor of PARAM,WTMASS.
    let at = |node: u64| bar.nodes.iter().find(|(label, _)| *label == node).unwrap().1;
    let side = |node: u64| -> [f64; 3] { std::array::from_fn(|i| at(node)[i] - at(1)[i]) };
    let norm = |v: [f64; 3]| v.iter().map(|c| c * c).sum::<f64>().sqrt();
    let (a, b) = (side(2), side(3));
    let area = norm([a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]) / 2.0;
    let shells = format!("1 CTRIA3 ({:.4e})", area * (70.0 * 0.1 + 3.0) * 1e-3);
    let rod = format!("1 CONROD ({:.4e})", norm(a) * 70.0 * 0.1 * 1e-3);
    let place = format!("point_masses = [{{ at = [{:?}, {y:?}, {z:?}]", x + 0.5);
    for words in [
        "read: ",
        "1 CONM2 (7.8500e-4",
        place.as_str(),
        "1 RBE2 (in a scene: a marker with group = \"RBE2_9002\" and tie = \"rigid\")",
        "2 RBE3 (in a scene: a marker with group = \"RBE3_9003\", … and tie = \"mean\")",
        "1 RBE2 in some directions only",
        "1 CMASS1 (6.0000e-3",
        "1 CMASS2 in single directions (5.0000e-3)",
        "1 CONM1 (7.0000e-3",
        "1 CBAR (mass not known)",
        shells.as_str(),
        rod.as_str(),
        "where it is known",
        "1 CELAS2",
        "1 PSHELL",
        "1 CTRIA6 (",
        "1 DEQATN",
        "1 BSURF",
        "1 SPC1",
        "1 card(s) that are not known here, the first in line",
        "1 lines after ENDDATA",
    ] {
        assert!(notes[0].contains(words), "{words}: {notes:?}");
    }
    assert!(!notes[0].contains("SECRET"));
}

/// Independent reference: the sums of the masses that pyNastran 1.4 gives to these bars and beams.
#[test]
fn bars_and_beams_of_all_sections_have_their_masses() {
    let bar = Bar::new();
    let kinds = [
        "ROD,,,,,2.",
        "TUBE,,,,,3.,2.",
        "TUBE2,,,,,3.,.5",
        "I,,,,,9.,4.,5.,.5,.6,.7",
        "CHAN,,,,,4.,8.,.5,.6",
        "T,,,,,6.,8.,.7,.5",
        "BOX,,,,,6.,8.,.7,.5",
        "BAR,,,,,3.,2.",
        "CROSS,,,,,5.,1.,8.,2.",
        "H,,,,,5.,2.,8.,1.",
        "T1,,,,,6.,5.,1.,.8",
        "I1,,,,,4.,.5,6.,8.",
        "CHAN1,,,,,4.,.5,6.,8.",
        "Z,,,,,4.,.5,6.,8.",
        "CHAN2,,,,,.5,.6,7.,9.",
        "T2,,,,,6.,8.,.7,.5",
        "BOX1,,,,,6.,8.,.4,.5,.6,.7",
        "HEXA,,,,,1.,6.,4.",
        "HAT,,,,,5.,.4,6.,2.",
        "HAT1,,,,,6.,5.,4.,.4,.6",
        "L,,,,,5.,7.,.5,.6",
    ];
    let mut cards = "GRID,9101,,0.,0.,0.\nGRID,9102,,0.,0.,4.\nMAT1,9,2.1+5,,.3,.5\n".to_owned();
    for (number, kind) in (9200..).zip(kinds) {
        let fields: Vec<&str> = kind.split(',').chain([".25"]).collect();
        let (first, more) = fields.split_at(5);
        let _ = writeln!(cards, "PBARL,{number},9,,{}\n,{}", first.join(","), more.join(","));
        let _ = writeln!(cards, "CBAR,{number},{number},9101,9102,1.,0.,0.");
    }
    for (number, beam) in (9300..).zip([
        "PBEAM,#,9,6.,1.,1.,,,.2\n,,,,,,,,\n,YES,.5,4.,1.,1.,,,.1\n,,,,,,,,\n,NO,1.,2.,1.,1.,,,.3",
        "PBEAM,#,9,6.,1.,1.\n,NO,1.,2.,1.,1.",
        "PBEAM,#,9,6.,1.,1.\n,0.,0.,0.,0.,0.,0.,0.,0.\n,NO,1.0\n,1.,1.",
        "PBEAML,#,9,,BAR\n,3.,2.,.2,NO,1.,1.,1.,.4",
        "PBEAML,#,9,,TUBE\n,3.,2.,.2",
        "PBEAML,#,9,,ROD\n,2.,.1,YES,.4,1.,.2,NO,1.\n,.5,.3",
        "PBEAM,#,9,6.,1.,1.,,,.2\n,,,,,,,,\n,YES,.25\n,,,,,,,,\n,YES,1.,2.,1.,1.,,,.4",
    ]) {
        let _ =
            writeln!(cards, "{}\nCBEAM,{number},{number},9101,9102,1.,0.,0.", beam.replace('#', &number.to_string()));
    }
    let text = format!("{}{}{cards}", grids(&bar, "", |x| x), elements(&bar));
    let notes = bar.read("beams.bdf", &text).unwrap_or_else(|error| panic!("{error}")).notes;
    let [of_bars, of_beams] = [
        [
            26.132741228718345,
            32.41592653589793,
            18.27875959474386,
            20.5,
            17.4,
            16.7,
            31.0,
            13.0,
            37.0,
            43.0,
            21.0,
            25.0,
            25.0,
            25.0,
        ]
        .into_iter()
        .chain([24.6, 16.7, 30.259999999999998, 41.0, 16.36, 19.4, 13.8])
        .sum::<f64>(),
        [8.7, 8.0, 12.0, 8.2, 32.21592653589793, 9.479379797371926, 9.2].into_iter().sum(),
    ];
    for words in [format!("21 CBAR ({of_bars:.4e})"), format!("7 CBEAM ({of_beams:.4e})")] {
        assert!(notes.iter().any(|note| note.contains(&words)), "{words}: {notes:?}");
    }
}

#[test]
fn elements_that_are_all_mirrored_are_turned_and_told() {
    let bar = Bar::new();
    let text = format!("{}{}", grids(&bar, "", |[x, y, z]| [-x, y, z]), elements(&bar));
    let Imported { mesh, notes, .. } = bar.read("mirrored.bdf", &text).unwrap_or_else(|error| panic!("{error}"));
    assert!((volume(&mesh) - 3.0).abs() < 1e-9);
    assert!(notes.len() == 1 && notes[0].contains("are turned"), "{notes:?}");
}

#[test]
fn an_included_file_is_not_quoted() {
    let bar = Bar::new();
    for secret in ["user:password\n", "GRID,password\n", "password,1\n", "PASSWORD,1\n"] {
        fs::write(bar.folder.path().join("secret.txt"), secret).unwrap();
        let said = bar.read("leak.bdf", "GRID,1\nINCLUDE 'secret.txt'\n").unwrap_err().to_string();
        assert!(!said.to_lowercase().contains("password"), "{said}");
    }
}

/// Conserved: nodes, volume and groups of one body, however its deck is written. `FLEXFRAME_DECKS` is the number of decks.
#[test]
fn one_body_written_at_random_is_one_body() {
    let bar = Bar::new();
    for seed in 0..of_environment() {
        let text = written(&bar, &mut Dice(seed));
        let name = format!("{seed}.{}", ["bdf", "nas", "fem"][seed as usize % 3]);
        let Imported { mesh, materials, .. } =
            bar.read(&name, &text).unwrap_or_else(|error| panic!("{seed}: {error}\n{text}"));
        fs::remove_file(bar.folder.path().join(name)).unwrap();
        assert_eq!(mesh.elements().len(), bar.elements.len(), "{seed}");
        // Fields of eight letters have five digits.
        assert!((volume(&mesh) - 3.0).abs() < 1e-3, "{seed}: {}", volume(&mesh));
        assert_eq!(mesh.groups(), ["ref_1"], "{seed}");
        assert_eq!(materials.first().map(|deck| deck.material.density), Some(7.85e-9), "{seed}: {materials:?}");
    }
}

/// A card in one of the formats of fields.
fn card(dice: &mut Dice, name: &str, fields: &[String]) -> String {
    let name = dice.spelled(name);
    let mut text = String::new();
    let (is_free, is_wide) = (dice.up_to(2) == 0, dice.up_to(2) == 0);
    let count = if is_wide { 4 } else { 8 };
    let lines: Vec<&[String]> = fields.chunks(count).collect();
    for (number, line) in lines.iter().enumerate() {
        let mark = if is_wide { "*" } else { "" };
        let head = match (number, dice.up_to(3)) {
            (0, _) => format!("{name}{mark}"),
            (_, 0) if !is_wide => String::new(),
            _ => format!("{}{}", if is_wide { "*" } else { "+" }, ["", "C1"][dice.up_to(2)]),
        };
        let label = if number + 1 < lines.len() && line.len() == count { ["", "+C1", "+"][dice.up_to(3)] } else { "" };
        if is_free {
            let space = ["", " "][dice.up_to(2)];
            let words: Vec<String> = line.iter().map(|word| format!("{space}{word}")).collect();
            let _ = write!(text, "{head},{}", words.join(","));
            if !label.is_empty() {
                let _ = write!(text, ",{label}");
            }
        } else {
            let width = if is_wide { 16 } else { 8 };
            if width == 8 && number == 0 && dice.up_to(4) == 0 && head.len() < 8 {
                text += &format!("{head}\t");
            } else {
                text += &format!("{head:<8}");
            }
            for word in *line {
                text += &if dice.up_to(2) == 0 { format!("{word:>width$}") } else { format!("{word:<width$}") };
            }
            if label.is_empty() {
                text.truncate(text.trim_end().len());
            } else {
                text += &" ".repeat(width * (count - line.len()));
                text += label;
            }
        }
        text += ["", " $ a comment"][usize::from(dice.up_to(10) == 0)];
        text += "\n";
        if dice.up_to(20) == 0 {
            text += "$ GRID,1,,9.\n\n";
        }
    }
    text
}

/// A number in eight letters at most.
fn short(dice: &mut Dice, number: f64) -> String {
    if number.abs() < 1e-12 {
        return ["", "0.", "0.0", ".0"][dice.up_to(4)].to_owned();
    }
    match dice.up_to(3) {
        0 => {
            let text = format!("{number:.2e}");
            let exact = format!("{number:.4}");
            // Only where no digit is lost.
            let is_exact = text.parse::<f64>().is_ok_and(|read| (read - number).abs() < 1e-12);
            if is_exact { text.replace("e-", "-").replace('e', "+") } else { exact }
        }
        1 => format!("{number:.5}").chars().take(8).collect::<String>().trim_end_matches('0').to_owned(),
        _ => format!("{number:.4}"),
    }
}

/// Cards of one line that repeat the one before them: their numbers and coordinates are those of the nodes.
fn repeated(dice: &mut Dice, before: &(u64, [f64; 3]), node: &(u64, [f64; 3])) -> String {
    let mut fields = vec![format!("*({})", node.0 - before.0)];
    fields.push("=".to_owned());
    let (from, to) = (before.1, node.1);
    for i in 0..3 {
        fields.push(match dice.up_to(3) {
            0 if from[i] == to[i] => "=".to_owned(),
            1 => format!("*({:?})", to[i] - from[i]),
            _ => format!("{:?}", to[i]),
        });
    }
    format!("=,{}\n", fields.join(","))
}

/// Lines that continue a card by its label, for another place in the deck.
fn apart(number: usize, card: &str) -> Option<[String; 2]> {
    let lines: Vec<&str> = card.lines().collect();
    let [first, second] = lines[..] else { return None };
    let is_plain = !card.contains(['\t', '*', '$', ',']) && !first[..8.min(first.len())].contains('*');
    let (head, rest) = (first.get(..72)?, second.get(8..)?);
    (is_plain && second.starts_with('+'))
        .then(|| [format!("{head}+K{number}\n"), format!("{:<8}{rest}\n", format!("+k{number}"))])
}

fn written(bar: &Bar, dice: &mut Dice) -> String {
    let end = ["\n", "\r\n"][dice.up_to(2)];
    let mut cards: Vec<String> = Vec::new();
    let system = [0, 7, 8][dice.up_to(3)];
    let is_default = dice.up_to(2) == 0;
    let placed = |node: &(u64, [f64; 3])| {
        let x = node.1;
        let x = match system {
            0 => x,
            7 => cylindrical(x),
            _ => [x[1], x[2] - 1.0, x[0] + 1.0],
        };
        (node.0, x)
    };
    for (at, node) in bar.nodes.iter().enumerate() {
        let (label, x) = placed(node);
        // A card and those that repeat it stay together.
        if at > 0 && dice.up_to(8) == 0 {
            let more = repeated(dice, &placed(&bar.nodes[at - 1]), &(label, x));
            let last: &mut String = cards.last_mut().unwrap();
            if !last.contains('*') || last.contains('=') {
                if !last.contains('=') {
                    // Exact, since what repeats it adds to it.
                    let (before, x) = placed(&bar.nodes[at - 1]);
                    let of = if is_default { String::new() } else { system.to_string() };
                    *last = format!("GRID,{before},{of},{:?},{:?},{:?}\n", x[0], x[1], x[2]);
                }
                *last += &more;
                continue;
            }
        }
        let of = if is_default { String::new() } else { system.to_string() };
        let mut fields = vec![label.to_string(), of];
        fields.extend(x.map(|c| short(dice, c)));
        cards.push(card(dice, "GRID", &fields));
    }
    for element in &bar.elements {
        let mut fields: Vec<String> = element.iter().map(u64::to_string).collect();
        fields.insert(1, "1".to_owned());
        cards.push(card(dice, "CTETRA", &fields));
    }
    let words = |words: &[&str]| words.iter().map(|word| (*word).to_owned()).collect::<Vec<_>>();
    for (name, fields) in [
        ("CORD2C", words(&["7", "", "0.", "0.", "0.", "0.", "0.", "1.", "1.", "0.", "0."])),
        ("CORD2R", words(&["8", "0", "-1.", "0.", "1.", "9.", "0.", "1.", "-1.", "1.", "1."])),
        ("MAT1", words(&["5", "2.1+5", "", ".3", "7.85-9"])),
        ("PSOLID", words(&["1", "5"])),
    ] {
        cards.push(card(dice, name, &fields));
    }
    // A quarter of the decks has continuations apart from their cards.
    if dice.up_to(4) == 0 {
        for at in 0..cards.len() {
            if let Some([first, second]) = apart(at, &cards[at]) {
                cards[at] = first;
                cards.push(second);
            }
        }
    }
    if is_default {
        cards.push(card(dice, "GRDSET", &words(&["", &system.to_string()])));
    }
    // Any order is one deck.
    for i in (1..cards.len()).rev() {
        cards.swap(i, dice.up_to(i + 1));
    }
    if dice.up_to(3) == 0 {
        let folder = bar.folder.path().join("more");
        fs::create_dir_all(&folder).unwrap();
        let at = dice.up_to(cards.len());
        let part: String = cards.drain(at..).collect();
        fs::write(folder.join("a b.dat"), part).unwrap();
        cards.push(
            dice.spelled("INCLUDE ")
                + ["'more/a b.dat'\n", "'more/\n  a b.dat'\n", "\"more\\a b.dat\" $\n"][dice.up_to(3)],
        );
    }
    let before = ["", "$ a deck\n", "SOL 103\nCEND\nTITLE = GRID, 1\nbegin bulk\n"][dice.up_to(3)];
    let after = ["", "ENDDATA\n", "enddata"][dice.up_to(3)];
    format!("{before}{}{after}", cards.concat()).replace('\n', end)
}

/// Closed form: the same box, its nodes on a lattice by replication, its elements with continuations at the end of the deck; and names that
/// Femap and HyperMesh write into comments.
#[test]
fn replication_continuations_apart_and_names_in_comments_are_read() {
    let bar = Bar::new();
    let text = "GRID,11,,0.,1.,,17\n=,*(1),=,*(0.5),==\n=(2)\n=,20,,9.,=,7.,=\nGRID    31              1.\n=       *1      =       *.5     ==\n=1\n";
    let plain = format!("{}{}", grids(&bar, "", |x| x), elements(&bar));
    let Imported { mesh, .. } = bar.read("plain.bdf", &plain).unwrap();
    // Nodes that no element has are left out: one element holds them.
    let tetrahedron = "CTETRA,1,1,11,12,20,32,,,+E\n$ Femap Property 1 : lattice\n$HMNAME PROP   1\"hub\" 4\n";
    let said = bar.read("lattice.bdf", &format!("{text}{tetrahedron}")).unwrap_err().to_string();
    assert!(said.contains("first order"), "{said}");
    let settings = ImportSettings { raise_order: true, ..ImportSettings::default() };
    let lattice = mesh_import::read_mesh(&bar.folder.path().join("lattice.bdf"), &settings).unwrap().mesh;
    let mut found: Vec<(u64, [f64; 3])> =
        lattice.parts().node_tags.iter().copied().zip(lattice.parts().positions.iter().copied()).take(4).collect();
    found.sort_by_key(|(tag, _)| *tag);
    let wanted = [(11, [0.0, 1.0, 0.0]), (12, [0.5, 1.0, 0.0]), (20, [9.0, 1.0, 7.0]), (32, [1.5, 0.0, 0.0])];
    assert_eq!(found, wanted);
    let mut names = lattice.groups().to_vec();
    names.sort();
    assert_eq!(names, ["hub", "lattice", "ref_1"]);
    // Each continuation after all cards, in the other order, in any letters.
    let (mut cards, mut ends) = (grids(&bar, "", |x| x), Vec::new());
    for (number, e) in bar.elements.iter().enumerate() {
        let words: Vec<String> = e.iter().map(u64::to_string).collect();
        let _ = writeln!(cards, "CTETRA,{},1,{},+E{number}", words[0], words[1..7].join(","));
        ends.push(format!("+e{number},{}\n", words[7..].join(",")));
    }
    ends.reverse();
    let Imported { mesh: other, .. } = bar.read("apart.bdf", &(cards.clone() + &ends.concat())).unwrap();
    assert_eq!(other.elements(), mesh.elements());
    let said = bar.read("lost.bdf", &(cards + &ends.concat().replace("+e0,", "+nowhere,"))).unwrap_err().to_string();
    assert!(said.contains("continues no card"), "{said}");
}

/// Straight elements with four nodes get nodes on their edges, if asked for.
#[test]
fn elements_of_first_order_are_raised() {
    let bar = Bar::new();
    let four: String =
        bar.elements.iter().map(|e| format!("CTETRA,{},1,{},{},{},{}\n", e[0], e[1], e[2], e[3], e[4])).collect();
    let text = format!("{}{four}", grids(&bar, "", |x| x));
    let said = bar.read("four.bdf", &text).unwrap_err().to_string();
    assert!(said.contains("first order"), "{said}");
    let settings = ImportSettings { raise_order: true, ..ImportSettings::default() };
    let mesh = mesh_import::read_mesh(&bar.folder.path().join("four.bdf"), &settings).unwrap().mesh;
    assert!((volume(&mesh) - 3.0).abs() < 1e-9 && (mean_of(&mesh, "ref_1")[1] - 0.5).abs() < 0.1);
    // Nodes on edges that some elements lack are those of their neighbours, or new.
    let some: String = (bar.elements.iter().enumerate())
        .map(|(number, e)| {
            let word =
                |k: usize| if k > 4 && (number + k).is_multiple_of(3) { String::new() } else { e[k].to_string() };
            let words: Vec<String> = (1..11).map(word).collect();
            format!("CTETRA,{},1,{},+\n+,{}\n", e[0], words[..6].join(","), words[6..].join(","))
        })
        .collect();
    let text = format!("{}{some}", grids(&bar, "", |x| x));
    let said = bar.read("some.bdf", &text).unwrap_err().to_string();
    assert!(said.contains("without nodes on some"), "{said}");
    let mesh = mesh_import::read_mesh(&bar.folder.path().join("some.bdf"), &settings).unwrap().mesh;
    assert!((volume(&mesh) - 3.0).abs() < 1e-9);
    assert_eq!(mesh.positions().len(), bar.nodes.len());
}
