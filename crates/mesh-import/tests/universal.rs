//! Universal files in the forms of Salome and of older programs: each is the same box of 3 x 1 x 1, or is refused with its line.
//! Needs gmsh (`./dev test` sees to it).

use std::fmt::Write;

use bar::{Bar, mean_of, volume};
use mesh_import::Imported;

mod bar;

/// Nodes of the faces of a tetrahedron: corners, then those between 01 12 20.
const FACES: [[usize; 6]; 4] = [[0, 1, 2, 4, 5, 6], [0, 3, 1, 7, 8, 4], [1, 3, 2, 8, 9, 5], [2, 3, 0, 9, 7, 6]];

fn dataset(number: u32, records: &str) -> String {
    format!("    -1\n  {number}\n{records}    -1\n")
}

fn line(numbers: &[u64]) -> String {
    numbers.chunks(8).fold(String::new(), |mut text, part| {
        part.iter().for_each(|number| text += &format!("{number:>10}"));
        text + "\n"
    })
}

fn number(c: f64) -> String {
    format!("{c:25.16e}").replace('e', "D")
}

/// The box with its root at x = 0 as triangles, one edge, and labels as Salome has them: one series for all elements.
struct File<'b> {
    bar: &'b Bar,
    elements: String,
    tetrahedra: Vec<u64>,
    triangles: Vec<u64>,
}

impl<'b> File<'b> {
    /// With the words between the kind of an element and the number of its nodes.
    fn of(bar: &'b Bar, between: &[u64]) -> Self {
        let mut found = Self { bar, elements: String::new(), tetrahedra: Vec::new(), triangles: Vec::new() };
        let head = |label: u64, kind: u64, count: u64| line(&[&[label, kind], between, &[count]].concat());
        let beam = [bar.nodes[0].0, bar.nodes[1].0, bar.nodes[2].0];
        let _ = write!(found.elements, "{}{}{}", head(1, 22, 3), line(&[0, 1, 1]), line(&beam));
        let mut label = 1;
        let x = |node: &u64| bar.nodes.iter().find(|(label, _)| label == node).unwrap().1[0];
        for element in &bar.elements {
            let n = &element[1..];
            for face in FACES.map(|face| face.map(|k| n[k])).iter().filter(|face| face.iter().all(|n| x(n) == 0.0)) {
                label += 1;
                found.triangles.push(label);
                found.elements += &(head(label, 42, 6) + &line(&[0, 3, 1, 4, 2, 5].map(|k| face[k])));
            }
            label += 1;
            found.tetrahedra.push(label);
            found.elements += &(head(label, 118, 10) + &line(&[0, 4, 1, 5, 2, 6, 7, 8, 9, 3].map(|k| n[k])));
        }
        found
    }

    fn groups(&self, width: usize) -> String {
        let group = |number: u64, name: &str, kind: u64, members: &[u64]| {
            let members: Vec<u64> =
                members.iter().flat_map(|label| [kind, *label, 0, 0].into_iter().take(width)).collect();
            let count = (members.len() / width) as u64;
            format!("{}{name}\n{}", line(&[number, 0, 0, 0, 0, 0, 0, count]), line(&members))
        };
        let tip: Vec<u64> = self.bar.nodes.iter().filter(|(_, x)| x[0] == 3.0).map(|(label, _)| *label).collect();
        group(1, "all of it", 8, &self.tetrahedra)
            + &group(2, "root", 8, &self.triangles)
            + &group(3, "tip", 7, &tip)
            + &group(4, "edge", 8, &[1])
            + &group(5, "nothing", 8, &[])
            + "\n"
            + &group(6, "", 7, &tip)
    }
}

/// Closed form: the volume of the box and where its groups are.
#[test]
fn all_datasets_of_groups_give_one_body() {
    let bar = Bar::new();
    let two_lines = |bar: &Bar| -> String {
        let node = |(label, x): &(u64, [f64; 3])| format!("{}{}\n", line(&[*label, 1, 1, 11]), x.map(number).concat());
        bar.nodes.iter().map(node).collect()
    };
    let one_line = |bar: &Bar| -> String {
        let node = |(label, x): &(u64, [f64; 3])| {
            format!("{label:>10}{:>10}{:>10}{:>10}{:13.5E}{:13.5E}{:13.5E}\n", 0, 0, 11, x[0], x[1], x[2])
        };
        bar.nodes.iter().map(node).collect()
    };
    let head = dataset(164, "         1  SI: Meter (newton)         2\n 1. 1. 1.\n 0.\n");
    for (nodes, elements, groups, width) in [
        (dataset(2411, &two_lines(&bar)), 2412, 2467, 4),
        (dataset(2411, &two_lines(&bar)), 2412, 2477, 4),
        (dataset(781, &two_lines(&bar)), 780, 2435, 4),
        (dataset(15, &one_line(&bar)), 71, 2430, 2),
        (dataset(2411, &two_lines(&bar)), 2412, 2452, 4),
    ] {
        let between: &[u64] = if elements == 780 { &[1, 1, 1, 1, 7] } else { &[1, 1, 7] };
        let file = File::of(&bar, between);
        let text = format!(
            "{head}{nodes}{}{}{}",
            dataset(elements, &file.elements),
            dataset(groups, &file.groups(width)),
            dataset(2414, "results\n")
        );
        let text = if width == 2 { text.replace('\n', "\r\n") } else { text };
        let Imported { mesh, notes, .. } =
            bar.read("bar.unv", &text).unwrap_or_else(|error| panic!("{groups}: {error}"));
        assert!((volume(&mesh) - 3.0).abs() < 1e-4, "{groups}: {}", volume(&mesh));
        assert_eq!(mesh.groups(), ["all of it"], "{groups}");
        assert_eq!(mesh.parts().surfaces.len(), 1, "{groups}");
        assert_eq!(mesh.parts().surfaces[0].triangles.len(), file.triangles.len(), "{groups}");
        assert!(mean_of(&mesh, "root")[0].abs() < 1e-9 && (mean_of(&mesh, "tip")[0] - 3.0).abs() < 1e-9, "{groups}");
        let said = notes.join("\n");
        assert_eq!(mesh.group_nodes("group_6").unwrap(), mesh.group_nodes("tip").unwrap(), "{groups}");
        for words in ["the group edge has no", "the group nothing has no", "1 beams", "1 dataset 2414"] {
            assert!(said.contains(words), "{groups}: {words}: {said}");
        }
        assert_eq!(notes.len(), 3, "{notes:?}");
    }
}

#[test]
fn what_is_wrong_is_refused_with_its_line() {
    let bar = Bar::new();
    let node = "         1         1         1        11\n  0. 0. 0.\n";
    for (text, words) in [
        (format!("    -1\n  2411\n{node}"), ["line 4", "ends within"]),
        (dataset(2411, "         1         1\n"), ["line 3", "four numbers"]),
        (dataset(2411, "         1         1         1        11\n 0. x 0.\n"), ["line 4", "three coordinates"]),
        (
            dataset(2411, &node.repeat(2).replace("  0. 0. 0.\n         1  ", "  0. 1. 0.\n         1  ")),
            ["line 5", "twice"],
        ),
        (dataset(2411, node) + &dataset(2412, "  1 111 1 1 7 4\n 1 1 1 2\n"), ["line 8", "node 2"]),
        (dataset(2411, node) + &dataset(2412, "  1 118 1 1 7 4\n 1 1 1\n"), ["line 9", "whole numbers after"]),
        (dataset(2411, node) + &dataset(2412, "  1 115 1 1 7 8\n 1 1 1 1 1 1 1 1\n"), ["line 8", "no tetrahedra"]),
        (dataset(2411, node) + &dataset(2412, "  1 118 1 1 7 8\n 1 1 1 1 1 1 1 1\n"), ["line 8", "8 nodes"]),
        (dataset(2411, node) + "more\n", ["line 6", "begins a dataset"]),
    ] {
        let said = bar.read("bad.unv", &text).unwrap_err().to_string();
        assert!(words.iter().all(|word| said.contains(word)), "{text}: {said}");
    }
}
