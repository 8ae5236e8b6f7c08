//! Bad files: each is refused at its key with the file, its line, what was found, what was expected and help.

use super::files::cube;
use super::{Files, MARKET};
use crate::refusal;

/// The message that the files are refused with, which is at `key`.
fn message(files: &Files, body: &str, key: &str) -> String {
    let scene = files.scene(body, "flexible = 2", "", "end = 1e-3\nstep = 1e-5");
    let before: Vec<_> = std::fs::read_dir(files.path()).unwrap().map(|entry| entry.unwrap().file_name()).collect();
    let message = refusal(&scene).to_string();
    let after: Vec<_> = std::fs::read_dir(files.path()).unwrap().map(|entry| entry.unwrap().file_name()).collect();
    assert_eq!(before, after, "something was written");
    assert!(message.contains(&format!("`body.matrices.{key}`: found ")), "{message}");
    assert!(message.contains("expected ") && message.contains("\n  = "), "{message}");
    message
}

#[track_caller]
fn refused(files: &Files, key: &str, words: &[&str]) {
    let message = message(files, MARKET, key);
    for words in words {
        assert!(message.contains(words), "{words:?} is not in: {message}");
    }
}

/// The bar with one file changed.
fn changed(name: &str, change: impl Fn(&str) -> String) -> Files {
    let files = cube();
    files.write(name, &change(&files.text(name)));
    files
}

/// Replaces the last field of the entries of a row and a column.
fn with_entry(text: &str, row: usize, column: usize, value: &str) -> String {
    let place = format!("{row} {column} ");
    let lines = text
        .lines()
        .map(|line| if line.starts_with(&place) { format!("{place}{value}\n") } else { format!("{line}\n") });
    lines.collect()
}

/// A scene may name any file: no word of it is shown.
const HIDDEN: &str = "a line with other words than numbers";

#[test]
fn files_that_are_no_matrices() {
    refused(&changed("K.mtx", |_| String::new()), "stiffness", &["an empty file in ", "K.mtx"]);
    refused(&changed("K.mtx", |_| "\n\n".into()), "stiffness", &["a file without entries"]);
    refused(
        &changed("M.mtx", |text| text.replacen("coordinate real general", "coordinate complex general", 1)),
        "mass",
        &["M.mtx:1", HIDDEN, "A.real"],
    );
    refused(
        &changed("M.mtx", |text| text.replacen("coordinate", "array", 1)),
        "mass",
        &["M.mtx:1", "scipy.sparse.csc_matrix"],
    );
    refused(
        &changed("M.mtx", |text| text.replacen("%%MatrixMarket", "%%Matrix", 1)),
        "mass",
        &["M.mtx:1", "%%MatrixMarket matrix"],
    );
    refused(&changed("M.mtx", |text| format!("mass\n{text}")), "mass", &["M.mtx:1", HIDDEN, "`row column value`"]);
    let files = cube();
    std::fs::write(files.file("K.mtx"), [0x93, b'N', b'U', b'M', b'P', b'Y', b'\n']).unwrap();
    refused(&files, "stiffness", &["K.mtx:1", "bytes that are no text"]);
    std::fs::remove_file(files.file("K.mtx")).unwrap();
    refused(&files, "stiffness", &["a file that cannot be read", "K.mtx"]);
    std::fs::create_dir(files.file("K.mtx")).unwrap();
    refused(&files, "stiffness", &["a folder", "K.mtx"]);
}

#[test]
fn entries_that_are_wrong() {
    refused(
        &changed("K.mtx", |text| with_entry(text, 5, 4, "nan")),
        "stiffness",
        &[HIDDEN, "K.mtx:", "expected a finite number"],
    );
    refused(
        &changed("K.mtx", |text| with_entry(text, 5, 4, "12,5")),
        "stiffness",
        &["K.mtx:", "expected `row column value`"],
    );
    refused(
        &changed("K.mtx", |text| text.replacen("\n5 4 ", "\n5 25 ", 1)),
        "stiffness",
        &["`5 25 ", "a row and a column up to 24"],
    );
    refused(&changed("K.mtx", |text| text.replacen("\n5 4 ", "\n5 0 ", 1)), "stiffness", &["from 1, not from 0"]);
    refused(&changed("K.mtx", |text| text.replacen("\n5 4 ", "\n4 5 ", 1)), "stiffness", &["on or below the diagonal"]);
    refused(
        &changed("M.mtx", |text| text.replacen("\n4 4 ", "\n1 1 ", 1)),
        "mass",
        &["the entry of row 1 and column 1 a second time"],
    );
    refused(
        &changed("M.mtx", |text| with_entry(text, 2, 1, "1.5e-7")),
        "mass",
        &["a matrix that is not symmetric", "1.5e-7", "(A + Aᵀ)/2"],
    );
    refused(
        &changed("M.mtx", |text| text.lines().take(10).map(|line| format!("{line}\n")).collect()),
        "mass",
        &["found 7 entries", "the file has been cut"],
    );
    refused(&changed("M.mtx", |text| format!("{text}1 1 1.0\n")), "mass", &["more entries than the"]);
}

#[test]
fn sizes_that_do_not_fit() {
    let without_last = |text: &str| {
        let lines: Vec<&str> = text.lines().collect();
        lines[..lines.len() - 1].join("\n")
    };
    refused(&changed("nodes.csv", without_last), "mass", &["24 rows for 7 nodes", "21 or 42", "`node, dof`"]);
    refused(&changed("nodes.csv", |text| text.lines().take(1).collect()), "nodes", &["a file without nodes"]);
    refused(
        &changed("nodes.csv", |text| text.replacen("x,y,z", "z,y,x", 1)),
        "nodes",
        &["nodes.csv:1", "`node, x, y, z`"],
    );
    refused(
        &changed("nodes.csv", |text| format!("{text}1,0,0,0\n")),
        "nodes",
        &["the node 1 a second time", "nodes.csv:10"],
    );
    refused(
        &changed("nodes.csv", |text| format!("{text}1000,0,zero,0\n")),
        "nodes",
        &["nodes.csv:10", "three coordinates"],
    );
    refused(
        &changed("K.mtx", |_| "%%MatrixMarket matrix coordinate real symmetric\n3 3 1\n1 1 1.0\n".into()),
        "mass",
        &["24 rows", "3, as the stiffness has"],
    );
}

#[test]
fn rows_that_are_not_known() {
    let files = cube();
    let body = MARKET.replace(" }", ", dofs = \"rows.dof\" }");
    let said = |files: &Files, words: &str| {
        let message = message(files, &body, "dofs");
        assert!(message.contains(words), "{message}");
    };
    said(&files, "a file that cannot be read");
    let labels: Vec<String> =
        files.text("nodes.csv").lines().skip(1).map(|line| line.split(',').next().unwrap().to_owned()).collect();
    let rows: Vec<String> =
        labels.iter().flat_map(|label| (1..=3).map(move |dof| format!("{label}.{dof}\n"))).collect();
    files.write("rows.dof", &rows.concat());
    let given = files.scene(&body, "flexible = 2", "", "end = 1e-3\nstep = 1e-5");
    crate::build(&given);
    files.write("rows.dof", &rows.concat().replacen("1.3\n", "1.0\n", 1));
    said(&files, "rows.dof:3");
    files.write("rows.dof", &rows.concat().replacen("1.3\n", "777.3\n", 1));
    said(&files, "node 777");
    files.write("rows.dof", &format!("{}888.1\n", rows[..23].concat()));
    said(&files, "node 888");
    files.write("rows.dof", &rows[..23].concat());
    assert!(message(&files, &body, "mass").contains("rows and columns up to 23"));
    // CalculiX without its list.
    let triplets =
        |name: &str| -> String { files.text(name).lines().skip(3).map(|line| format!("{line}\n")).collect::<String>() };
    let files_of_calculix = Files::new();
    files_of_calculix.write("job.sti", &triplets("K.mtx"));
    files_of_calculix.write("job.mas", &triplets("M.mtx"));
    let nodes = files.text("nodes.csv");
    let nodes: Vec<&str> = nodes.lines().collect();
    files_of_calculix.write("nodes.csv", &nodes[..8].join("\n"));
    let body = "matrices = { mass = \"job.mas\", stiffness = \"job.sti\", nodes = \"nodes.csv\" }";
    assert!(message(&files_of_calculix, body, "mass").contains("`dofs = \"JOB.dof\"`"));
}

#[test]
fn matrices_that_are_none_of_a_free_body() {
    // A spring to the ground.
    let stiffer = |text: &str| with_entry(text, 1, 1, "1e9");
    refused(
        &changed("K.mtx", stiffer),
        "stiffness",
        &["a body that is not free", "no stiffness against the six rigid motions", "without *BOUNDARY"],
    );
    // Nodes in another order.
    let swapped = |text: &str| {
        let mut lines: Vec<&str> = text.lines().collect();
        let last = lines.len() - 1;
        lines.swap(1, last);
        lines.join("\n")
    };
    refused(&changed("nodes.csv", swapped), "stiffness", &["the nodes are not where the matrices have them"]);
    let negative = |text: &str| {
        let lines = text.lines().map(|line| {
            let fields: Vec<&str> = line.split_whitespace().collect();
            match fields[..] {
                [i, j, value] if value.contains('e') => format!("{i} {j} {:e}\n", -value.parse::<f64>().unwrap()),
                _ => format!("{line}\n"),
            }
        });
        lines.collect()
    };
    refused(&changed("M.mtx", negative), "mass", &["not positive definite", "negative kinetic energy"]);
    // One that only a motion shows.
    let indefinite = |text: &str| with_entry(text, 5, 5, "-1e-3");
    refused(
        &changed("M.mtx", indefinite),
        "mass",
        &["not positive definite", "some motion has a negative kinetic energy", "degree of freedom 2 of node 2 shows"],
    );
    let negative_stiffness = changed("K.mtx", negative);
    refused(&negative_stiffness, "stiffness", &["not positive semi-definite"]);
}

#[test]
fn a_held_body_of_abaqus() {
    let files = cube();
    files.write("K.mtx", "1,1, 1,1, 1.0e36\n");
    files.write("M.mtx", "1,1, 1,1, 1.0\n");
    refused(&files, "stiffness", &["K.mtx:1", "remove *BOUNDARY"]);
    files.write("K.mtx", "1,1, 1,1, 2.0\n1,1, 2,8, 1.0\n");
    refused(&files, "stiffness", &["K.mtx:2", "degrees of freedom 1 to 6"]);
}

#[test]
fn keys_that_need_elements_are_refused_in_the_scene() {
    let files = cube();
    let refused = |rest: &str, body: &str, words: &[&str]| {
        let text = files.text_of_scene(body, "flexible = 2", rest, "end = 1e-3\nstep = 1e-5");
        let message = scene::Body::parse(&text, files.file("scene.toml")).unwrap_err().to_string();
        for words in words {
            assert!(message.contains(words), "{words:?} is not in: {message}");
        }
    };
    refused("[output]\npeak_stress = true", MARKET, &["output.peak_stress", "matrices say nothing of stress"]);
    let load = "[[loads]]\nkind = \"pressure\"\ngroup = \"tip\"\namplitude = 1.0\nhistory = { kind = \"constant\" }";
    refused(load, MARKET, &["loads[0].group", "has no elements", "loads `kind = \"force\"`"]);
    refused(
        "[effects]\ngeometric_stiffening = true\n[initial]\nangular_velocity = [1, 0, 0]",
        MARKET,
        &["effects.geometric_stiffening", "whose elements are not known"],
    );
    refused("[effects]\nlarge_deflection = true", MARKET, &["effects.large_deflection", "give the body a mesh"]);
    refused("", &format!("{MARKET}\nmesh = \"bar.msh\""), &["body.mesh", "both `matrices` and `mesh`"]);
    refused("", &format!("{MARKET}\npoint_masses = []"), &["into the mass matrix"]);
    refused("", "matrices = { mass = \"M.mtx\", stiffness = \"K.mtx\" }", &["nodes"]);
}

#[test]
fn places_without_nodes_are_refused_with_the_nearest_node() {
    let files = cube();
    let build = |rest: &str| {
        let scene = files.scene(MARKET, "flexible = 2", rest, "end = 1e-3\nstep = 1e-5");
        refusal(&scene).to_string()
    };
    let message = build(
        "[[loads]]\nkind = \"force\"\nat = [100.0, 1.0, 0.0]\ndirection = [1, 0, 0]\namplitude = 1.0\nhistory = { kind = \"constant\" }",
    );
    assert!(
        message.contains("`loads[0].at`: found a point without a node") && message.contains("use its node"),
        "{message}"
    );
    let message = build(
        "[[loads]]\nkind = \"moment\"\nat = [100.0, 0.0, 0.0]\ndirection = [1, 0, 0]\namplitude = 1.0\nhistory = { kind = \"constant\" }",
    );
    assert!(message.contains("only have translations") && message.contains("`radius`"), "{message}");
}
