//! Files that are refused, and what is said about them.

use fem_tet10::{FilePosition, MeshError, MeshFault, parse_msh, read_msh};

use crate::fixtures::data;

fn text(name: &str) -> String {
    std::fs::read_to_string(data(name)).unwrap()
}

/// The refusal of a text; it must name the mesh.
#[track_caller]
fn refusal(contents: impl AsRef<[u8]>) -> (MeshError, String) {
    let error = parse_msh(contents.as_ref(), "body.msh").unwrap_err();
    let message = error.to_string();
    assert!(message.starts_with("body.msh"), "{message}");
    (error, message)
}

#[track_caller]
fn assert_says(message: &str, parts: &[&str]) {
    for part in parts {
        assert!(message.contains(part), "\"{part}\" is missing in: {message}");
    }
}

#[test]
fn other_elements_are_named_with_the_help() {
    let cases: [(&str, &[&str]); 4] = [
        ("cube_order_1.msh", &["element 1 is a four-node tetrahedron", "mesh with -order 2"]),
        ("cube_order_3.msh", &["element 1 is a tetrahedron of order 3", "mesh with -order 2"]),
        (
            "cube_hexahedra.msh",
            &["element 1 is a hexahedron", "mesh with tetrahedra", "-order 2", "`matrices` in [body]"],
        ),
        ("cube_hexahedra_order_3.msh", &["element 1 is a hexahedron (gmsh's element type 92)", "mesh with tetrahedra"]),
    ];
    for (name, says) in cases {
        let error = read_msh(data(name)).unwrap_err();
        assert!(matches!(error, MeshError { fault: MeshFault::ElementType { element: 1, .. }, .. }), "{error:?}");
        assert_says(&error.to_string(), says);
        assert_says(&error.to_string(), &[name]);
    }
}

#[test]
fn other_versions_are_named_with_the_help() {
    let error = read_msh(data("cube_msh22.msh")).unwrap_err();
    assert!(matches!(error, MeshError { fault: MeshFault::Version { .. }, .. }), "{error:?}");
    assert_says(&error.to_string(), &["cube_msh22.msh", "version 2.2", "-save -format msh41", "-order 2"]);
}

#[test]
fn what_is_no_mesh_is_called_so() {
    for contents in
        ["", "\n\n", "solid cube\nfacet normal 0 0 1\n", "*NODE\n1, 0, 0, 0\n", "$Nodes\n0 0 0 0\n$EndNodes\n"]
    {
        let (error, message) = refusal(contents);
        assert!(matches!(error, MeshError { fault: MeshFault::Version { .. }, .. }), "{error:?}");
        assert_says(&message, &["not a MSH 4.1 file", "-format msh41"]);
    }
    let (_, message) = refusal([0xff, 0xd8, 0xff, 0xe0, 0x00]);
    assert_says(&message, &["not a MSH 4.1 file"]);
    // It may be a file of secrets, which a scene from elsewhere names: none of it is shown.
    for contents in ["root:x:0:0", "secret", "$secret 4.1", "$Nodes secret", "\u{feff}secret"] {
        let (_, message) = refusal(contents);
        assert_says(&message, &["does not begin with $MeshFormat"]);
        assert!(!message.contains("secret") && !message.contains("root"), "{message}");
    }
}

#[test]
fn a_file_that_is_not_there_is_named() {
    let error = read_msh("no/such.msh").unwrap_err();
    assert!(matches!(error, MeshError { fault: MeshFault::Io { .. }, .. }), "{error:?}");
    assert_says(&error.to_string(), &["no/such.msh", "cannot read"]);
}

#[test]
fn numbers_of_another_size_or_order_of_bytes_are_refused() {
    let (_, message) = refusal(text("cube.msh").replace("4.1 0 8", "4.1 0 4"));
    assert_says(&message, &["line 2", "numbers of 8 bytes", "\"4\""]);
    let (_, message) = refusal(text("cube.msh").replace("4.1 0 8", "4.1 2 8"));
    assert_says(&message, &["line 2", "0 (ASCII) or 1 (binary)", "\"2\""]);
    let mut swapped = std::fs::read(data("cube_binary.msh")).unwrap();
    let one = "$MeshFormat\n4.1 1 8\n".len();
    swapped[one..one + 4].reverse();
    let (_, message) = refusal(swapped);
    assert_says(&message, &["little-endian"]);
}

#[test]
fn a_file_cut_off_anywhere_is_refused() {
    for name in ["cube.msh", "cube_binary.msh", "quarter_everything_binary.msh", "overlapping_groups_partitioned.msh"] {
        let whole = std::fs::read(data(name)).unwrap();
        let whole = whole.trim_ascii_end();
        assert!(parse_msh(whole, name).is_ok());
        for length in 0..whole.len() {
            // A section that starts at the cut is not noticed: the rest may have been all there was.
            match parse_msh(&whole[..length], name) {
                Err(
                    MeshError { fault: MeshFault::Syntax { .. }, .. }
                    | MeshError { fault: MeshFault::Version { .. }, .. }
                    | MeshError { fault: MeshFault::MissingSection { .. }, .. },
                ) => {}
                Ok(_) => {
                    assert!(whole[length..].starts_with(b"\n$Periodic") || whole[length..].starts_with(b"$Periodic"))
                }
                Err(other) => panic!("{name} cut at {length}: {other}"),
            }
        }
    }
}

#[test]
fn the_place_of_a_cut_is_told() {
    let whole = text("cube.msh");
    let cut = whole.find("$Elements").unwrap() + "$Elements\n1 24".len();
    let lines = whole[..cut].lines().count();
    let (error, message) = refusal(&whole[..cut]);
    assert!(
        matches!(error, MeshError { place: Some(FilePosition::Line(l)), fault: MeshFault::Syntax { .. }, .. } if l == lines),
        "{message}"
    );
    assert_says(&message, &["$Elements", "the end of the file"]);

    let whole = std::fs::read(data("cube_binary.msh")).unwrap();
    let (error, message) = refusal(&whole[..1000]);
    assert!(
        matches!(error, MeshError { place: Some(FilePosition::Byte(b)), fault: MeshFault::Syntax { .. }, .. } if (992..=1000).contains(&b)),
        "{message}"
    );
    assert_says(&message, &["the end of the file"]);
}

#[test]
fn a_missing_section_is_named() {
    let whole = text("cube.msh");
    let elements = whole.find("$Elements").unwrap();
    let (error, message) = refusal(&whole[..elements]);
    assert!(
        matches!(error, MeshError { fault: MeshFault::MissingSection { section: "$Elements", .. }, .. }),
        "{error:?}"
    );
    assert_says(&message, &["there is no $Elements section", "gmsh -3"]);
    let (_, message) = refusal("$MeshFormat\n4.1 0 8\n$EndMeshFormat\n");
    assert_says(&message, &["there is no $Nodes section"]);
}

/// Inserts a word that is no number at the end of each line in turn: the line is told, or the one where it is noticed.
#[test]
fn the_line_of_an_error_is_right() {
    let whole = text("cube.msh");
    for ends in ["\n", "\r\n"] {
        let lines: Vec<&str> = whole.lines().collect();
        let mut noticed = 0;
        for number in 1..=lines.len() {
            let words: Vec<&str> = lines[number - 1].split_whitespace().collect();
            if words[0].starts_with('$') || words.last().unwrap().ends_with('"') {
                continue;
            }
            let mut spoiled: Vec<String> = lines.iter().map(|line| (*line).to_owned()).collect();
            spoiled[number - 1] = [&words[..words.len() - 1], &["1x2"]].concat().join(" ");
            let (error, message) = refusal(spoiled.join(ends));
            if number == 2 {
                continue; // the size of a number, checked above
            }
            assert!(
                matches!(error, MeshError { place: Some(FilePosition::Line(l)), fault: MeshFault::Syntax { .. }, .. } if l == number),
                "{number}: {message}"
            );
            assert_says(&message, &["expected", "\"1x2\"", &format!("line {number}:")]);
            noticed += 1;
        }
        assert!(noticed > 100, "{noticed} lines were spoiled");
    }
}

#[test]
fn more_numbers_than_announced_are_noticed_where_they_start() {
    let whole = text("cube.msh");
    let line = whole[..whole.find("$EndNodes").unwrap()].lines().count() + 1;
    let (_, message) = refusal(whole.replace("$EndNodes", "7 7 7\n$EndNodes"));
    assert_says(&message, &[&format!("line {line}:"), "$EndNodes", "\"7\""]);
}

/// The head of a section is `blocks total smallest largest`.
#[test]
fn a_total_that_the_blocks_do_not_hold_is_refused() {
    let whole = text("cube.msh");
    let binary = std::fs::read(data("cube_binary.msh")).unwrap();
    for (section, what) in [("$Nodes\n", "nodes"), ("$Elements\n", "elements")] {
        let head = whole.find(section).unwrap() + section.len();
        let line = whole[..head].lines().count() + 1;
        let (start, rest) = whole.split_at(head);
        let words: Vec<&str> = rest.lines().next().unwrap().split_whitespace().collect();
        let total: u64 = words[1].parse().unwrap();
        let rest = &rest[rest.find('\n').unwrap()..];
        let place =
            binary.windows(section.len()).position(|bytes| bytes == section.as_bytes()).unwrap() + section.len() + 8;
        let mut spoiled = binary.clone();
        assert_eq!(spoiled[place..place + 8], total.to_le_bytes());
        for claim in [0, total - 1, total + 1, 1_000_000_000_000] {
            let says = [
                format!("in {}", section.trim()),
                format!("the number {claim} for all {what}"),
                format!("expected {total}"),
            ];
            let says = says.each_ref().map(String::as_str);
            let (error, message) = refusal(format!("{start}{} {claim} {} {}{rest}", words[0], words[2], words[3]));
            assert!(
                matches!(error, MeshError { place: Some(FilePosition::Line(l)), fault: MeshFault::Total { .. }, .. } if l == line),
                "{message}"
            );
            assert_says(&message, &says);
            assert_says(&message, &["save the mesh again"]);
            spoiled[place..place + 8].copy_from_slice(&claim.to_le_bytes());
            let (error, message) = refusal(&spoiled);
            assert!(
                matches!(error, MeshError { place: Some(FilePosition::Byte(b)), fault: MeshFault::Total { .. }, .. } if b == place + 8),
                "{message}"
            );
            assert_says(&message, &says);
        }
    }
}

#[test]
fn a_byte_order_mark_is_passed_over() {
    let mesh = parse_msh(format!("\u{feff}{}", text("cube.msh")).as_bytes(), "marked.msh").unwrap();
    assert_eq!(mesh.elements(), read_msh(data("cube.msh")).unwrap().elements());
}

#[test]
fn what_is_no_ordinary_file_is_refused_before_it_is_opened() {
    let says = |path: &std::path::Path| {
        let error = read_msh(path).unwrap_err();
        assert!(matches!(error, MeshError { fault: MeshFault::Io { .. }, .. }), "{error:?}");
        error.to_string()
    };
    assert_says(&says(&data("")), &["cannot read the mesh", "a folder", "name the mesh file in it"]);
    #[cfg(unix)]
    assert_says(&says("/dev/zero".as_ref()), &["/dev/zero", "not an ordinary file", "write the mesh into a file"]);
}

#[test]
fn sections_out_of_place_are_refused() {
    let (_, message) = refusal(text("cube.msh") + "$EndElements\n");
    assert_says(&message, &["a section that begins with $", "$EndElements"]);
    let (_, message) = refusal(text("cube.msh") + "$Periodic\n1\n");
    assert_says(&message, &["$Periodic", "$EndPeriodic", "the end of the file"]);
    let (_, message) = refusal(text("cube.msh") + "junk");
    assert_says(&message, &["a section that begins with $", "junk"]);
}

#[test]
fn a_group_number_at_the_end_of_the_range_is_no_trouble() {
    let whole = text("cube.msh");
    let volume = whole.lines().find(|line| line.ends_with("1 1 6 1 2 3 4 5 6 ")).unwrap();
    let spoiled = volume.replace("1 1 6 1 2 3 4 5 6", "1 -2147483648 6 1 2 3 4 5 6");
    let mesh = parse_msh(whole.replace(volume, &spoiled).as_bytes(), "body.msh").unwrap();
    assert_eq!(mesh.groups(), ["2147483648"]);
}

#[test]
fn a_group_named_as_another_is_numbered_is_refused() {
    // Both ways round: the unnamed group 7 comes first in the tip's volume, or after it in the block's.
    for name in ["all", "tip"] {
        let whole = text("overlapping_groups.msh");
        let spoiled = whole.replace(&format!("\"{name}\""), "\"7\"");
        assert_ne!(spoiled, whole);
        let (error, message) = refusal(spoiled);
        assert!(
            matches!(&error, MeshError { fault: MeshFault::AmbiguousGroup { name, .. }, .. } if name == "7"),
            "{error:?}"
        );
        assert_says(&message, &["physical volume 7 has no name", "named \"7\"", "name the first", "rename the other"]);
    }
}

#[test]
fn an_element_type_that_gmsh_does_not_have_is_refused() {
    for kind in ["0", "-4", "141", "2147483647"] {
        let (_, message) = refusal(text("cube.msh").replace("\n3 1 11 24\n", &format!("\n3 1 {kind} 24\n")));
        assert_says(&message, &["an element type of gmsh", kind]);
    }
}

#[test]
fn a_message_does_not_quote_the_whole_file() {
    let (_, message) = refusal(format!("$MeshFormat\n{}", "9".repeat(100_000)));
    assert!(message.len() < 300, "{} characters", message.len());
    let (_, message) = refusal(text("cube.msh").replace("$EndNodes", &"x".repeat(100_000)));
    assert!(message.len() < 300, "{} characters", message.len());
}
