//! Tables of histories in CSV files: what they hold, and how they are refused.

use std::path::Path;

use scene::{Body, History, Interpolation, SceneError, TablePoints};

const EXAMPLE: &str = include_str!("../../src/text/example.toml");

/// The example, its history a table from `pulse.csv` with these bytes.
fn read(folder: &Path, table: &[u8]) -> Result<Body, SceneError> {
    std::fs::write(folder.join("pulse.csv"), table).unwrap();
    let half_sine = "{ kind = \"half-sine\", start = 0.0, duration = 0.02 }";
    let text = EXAMPLE.replace(half_sine, "{ kind = \"table\", file = \"pulse.csv\" }");
    assert_ne!(text, EXAMPLE);
    Body::parse(&text, folder.join("scene.toml"))
}

#[test]
fn two_columns_in_every_writing() {
    let folder = tempfile::tempdir().unwrap();
    let points = vec![[0.0, 0.0], [0.5, -1.5], [2.0, 300.0]];
    for text in [
        "0,0\n0.5,-1.5\n2,3e2\n",
        "0,0\n0.5,-1.5\n2,3e2",
        "time,force\r\n0,0\r\n0.5,-1.5\r\n2,3e2\r\n",
        "\"time, s\" , \"force, N\"\n 0 , 0\n\n 0.5, -1.5\n2.0,\t+300 \n",
        "# measured\n# t, f\n0,0\n# a remark\n0.5,-1.5\n2,300\n",
        "\u{feff}t,f\n0,0\n0.5,-1.5\n2,300\n",
    ] {
        let body = read(folder.path(), text.as_bytes()).unwrap_or_else(|error| panic!("{text:?}: {error}"));
        let file = Some(folder.path().join("pulse.csv"));
        assert_eq!(
            body.loads[0].history,
            History::Table(TablePoints { points: points.clone(), file, interpolation: Interpolation::Linear }),
            "{text:?}"
        );
    }
}

#[test]
fn a_bad_line_is_named_in_the_table() {
    let folder = tempfile::tempdir().unwrap();
    for (text, line, words) in [
        ("0,0\n1\n", 2, "found 1 field(s), 1 of them finite numbers, expected two finite numbers"),
        ("0,0\n1,2,3\n", 2, "found 3 field(s), 3 of them finite numbers, expected two finite numbers"),
        ("0,0\n1,x\n", 2, "only the first may name the columns"),
        ("t,f\nt,f\n", 2, "only the first may name the columns"),
        ("t,1\n", 1, "found 2 field(s), 1 of them finite numbers, expected two finite numbers"),
        ("0,nan\n", 1, "expected two finite numbers"),
        ("0,0\n1,inf\n", 2, "expected two finite numbers"),
        ("0;0\n1;1\n", 2, "with a comma between them"),
        ("t,f\n0,0\n0,1\n", 3, "found the time 0.0 after 0.0, expected times that rise"),
        ("# one\n# two\n\n1,0\n# three\n\n0.5,1\n", 7, "found the time 0.5 after 1.0"),
        ("0,0\n1,0\n1.0000000000004,1\n", 3, "expected times whose distance is not lost in rounding"),
        ("", 1, "found 0 pairs of time and value, expected two or more"),
        ("t,f\n0,1\n", 1, "found 1 pairs of time and value"),
    ] {
        let message = read(folder.path(), text.as_bytes()).unwrap_err().to_string();
        let head = format!("{}:{line}:1: `loads[0].history.file`: ", folder.path().join("pulse.csv").display());
        assert!(message.starts_with(&head), "{text:?}: no {head:?} in {message}");
        assert!(message.contains(words) && message.contains("\n  = "), "{text:?}: no {words:?} in {message}");
    }
}

/// A scene from elsewhere, or in a results file from elsewhere, may name any file of the user's as its table.
#[test]
fn nothing_is_shown_of_a_file_that_is_no_table() {
    let folder = tempfile::tempdir().unwrap();
    for text in
        ["secret", "secret,secret\nsecret,secret\n", "0,0\n1,1,secret\n", "root:secret:0:0\nsecret", "# secret\n"]
    {
        let message = read(folder.path(), text.as_bytes()).unwrap_err().to_string();
        assert!(message.contains("pulse.csv") && !message.contains("secret"), "{message}");
    }
}

#[test]
fn a_table_that_cannot_be_read_is_named_in_the_scene() {
    let folder = tempfile::tempdir().unwrap();
    let refusal = |table: &[u8], words: &str| {
        let message = read(folder.path(), table).unwrap_err().to_string();
        let head = format!("{}:30:", folder.path().join("scene.toml").display());
        assert!(message.starts_with(&head) && message.contains(words), "no {words:?} in {message}");
    };
    refusal(b"0,0\n1,\xff\n", "found a table that cannot be read: ");
    let long = "# a line\n".repeat((16 << 20) / 9 + 1);
    refusal(long.as_bytes(), "found more than 16777216 bytes of tables");
    let named = |file: &str| {
        let table = format!("{{ kind = \"table\", file = \"{file}\" }}");
        let text = EXAMPLE.replace("{ kind = \"half-sine\", start = 0.0, duration = 0.02 }", &table);
        Body::parse(&text, folder.path().join("scene.toml")).unwrap_err().to_string()
    };
    #[cfg(unix)]
    assert!(named("/dev/zero").contains("not an ordinary file but a device or a pipe"), "{}", named("/dev/zero"));
    let message = named("nowhere.csv");
    assert!(message.contains("nowhere.csv") && message.contains("`loads[0].history.file`"), "{message}");
    assert!(message.contains("relative to the folder of the scene file"), "{message}");
}
