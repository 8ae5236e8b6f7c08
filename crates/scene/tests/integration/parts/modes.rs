//! How many modes, and their damping.

use std::f64::consts::TAU;

use scene::{Choice, Damping, Flexible, Large, Modes, Rayleigh};

const FROM: &str = "[modes]";
const TO: &str = "[frame]";

fn modes(lines: &str) -> Modes {
    crate::parts::with(FROM, TO, &format!("[modes]\n{lines}")).modes
}

#[track_caller]
fn refused(lines: &str, mark: &str, key: &str, words: &[&str]) {
    crate::parts::refused(FROM, TO, &format!("[modes]\n{lines}"), mark, key, words);
}

#[test]
fn a_number_of_modes_or_auto() {
    assert_eq!(modes("flexible = 7").flexible, Flexible::Count(7));
    assert_eq!(modes("flexible = \"auto\"").flexible, Flexible::Auto { most: 40 });
    assert_eq!(modes("flexible = \"auto\"\nmost = 12").flexible, Flexible::Auto { most: 12 });
    assert_eq!([Flexible::Count(7).most(), Flexible::Auto { most: 12 }.most()], [7, 12]);

    refused("flexible = \"atuo\"", "\"atuo\"", "modes.flexible", &["unknown value `atuo`; did you mean `auto`?"]);
    refused(
        "flexible = \"many\"",
        "\"many\"",
        "modes.flexible",
        &["found the string \"many\", expected a whole number, 0 or more, or \"auto\"", "this: `flexible = 10`"],
    );
    refused("flexible = true", "true", "modes.flexible", &["found the boolean true, expected a whole number"]);
    refused("flexible = [1]", "[1]", "modes.flexible", &["found a list of 1 entry, expected a whole number"]);
    refused("flexible = {}", "{}", "modes.flexible", &["found a table, expected a whole number"]);
    refused("flexible = 3\nmost = 5", "5\n", "modes.most", &["found `most` with `flexible = 3`", "remove `most`"]);
    refused("flexible = \"auto\"\nmost = 0", "0\n\n[frame]", "modes.most", &["found 0, expected a whole number, 1 or"]);
    refused("most = 5", "[modes]", "modes.flexible", &["`flexible` is missing", "flexible = 10"]);
}

#[test]
fn static_correction() {
    for (written, choice) in [("true", Choice::On), ("false", Choice::Off), ("\"auto\"", Choice::Auto)] {
        assert_eq!(modes(&format!("flexible = 1\nstatic_correction = {written}")).static_correction, choice);
    }
    let key = "modes.static_correction";
    refused("flexible = 1\nstatic_correction = \"on\"", "\"on\"", key, &["expected true, false or \"auto\""]);
    refused("flexible = 1\nstatic_correction = \"true\"", "\"true\"", key, &["remove the quotes"]);
    refused("flexible = 1\nstatic_correction = 7", "7\n", key, &["found the number 7, expected true", "= \"auto\"`"]);
    refused("flexible = 0\nstatic_correction = true", "true", key, &["a body without flexible modes"]);
}

#[test]
fn large_modes() {
    let large = |line: &str| modes(&format!("flexible = 6\n{line}")).large;
    assert_eq!(large(""), None);
    assert_eq!(large("large = 4"), Some(Large::Count(4)));
    assert_eq!(large("large = [1, 6]"), Some(Large::List(vec![1, 6])));
    for (written, found) in [("0", "0"), ("7", "7"), ("[]", "[]"), ("[2, 1]", "[2, 1]"), ("[0]", "[0]"), ("[7]", "[7]")]
    {
        let words = format!("found {found}, expected a number from 1 to 4, or a list");
        refused(
            &format!("flexible = 6\nlarge = {written}"),
            &format!("{written}\n\n[frame]"),
            "modes.large",
            &[&words],
        );
    }
    refused("flexible = 6\nlarge = \"many\"", "\"many\"", "modes.large", &["a number of modes or a list"]);
}

#[test]
fn one_way_of_damping() {
    let damping = |line: &str| modes(&format!("flexible = 3\n{line}")).damping;
    assert_eq!(damping(""), Damping::Uniform(0.0));
    assert_eq!(damping("damping_ratio = 1"), Damping::Uniform(1.0));
    assert_eq!(damping("damping_ratio = 0.02"), Damping::Uniform(0.02));
    assert_eq!(damping("damping_ratio = [0.02, 1]"), Damping::List(vec![0.02, 1.0]));
    let table = Damping::Table(vec![[0.0, 0.02], [10.0, 0.0]]);
    assert_eq!(damping("damping_table = [[0, 0.02], [10, 0]]"), table);
    let rayleigh = Damping::Rayleigh(Rayleigh { alpha: 0.1, beta: 1e-5 });
    assert_eq!(damping("rayleigh = { alpha = 0.1, beta = 1e-5 }"), rayleigh);

    let bad = |line: &str, mark: &str, key: &str, words: &[&str]| {
        refused(&format!("flexible = 3\n{line}"), mark, &format!("modes.{key}"), words);
    };
    bad(
        "damping_ratio = 0.1\nrayleigh = { alpha = 1, beta = 1 }",
        "{ alpha",
        "rayleigh",
        &["found both `damping_ratio` and `rayleigh`, expected at most one", "keep one way"],
    );
    bad("damping_table = [[1, 1]]\ndamping_ratio = 0", "[[1, 1]]", "damping_table", &["both `damping_ratio` and"]);
    bad("damping_ratio = []", "[]\n\n[frame]", "damping_ratio", &["found [], expected at least one damping ratio"]);
    bad("damping_ratio = [0.1, -1]", "-1]", "damping_ratio[1]", &["found -1, expected a number of 0 or more"]);
    bad("damping_ratio = [0.1, 'a']", "'a'", "damping_ratio[1]", &["found the string 'a', expected a finite number"]);
    bad("damping_ratio = [0.1, nan]", "nan", "damping_ratio[1]", &["expected a finite number"]);
    bad("damping_ratio = \"0.1\"", "\"0.1\"", "damping_ratio", &["expected a finite number, or a list", "the quotes"]);
    bad("damping_ratio = [1, 1, 1, 1]", "[1, 1, 1, 1]", "damping_ratio", &["found 4 entries, expected at most 3"]);
    bad("damping_table = []", "[]\n\n[frame]", "damping_table", &["at least one pair of frequency"]);
    bad("damping_table = [[2, 1], [2, 1]]", "2, 1]]", "damping_table[1][0]", &["found 2.0 after 2.0, expected freq"]);
    bad("damping_table = [[-2, 1]]", "-2, 1]]", "damping_table[0][0]", &["found -2, expected a number of 0"]);
    bad("damping_table = [[2, -1]]", "-1]]", "damping_table[0][1]", &["found -1, expected a number of 0"]);
    bad("damping_table = [[2]]", "[2]", "damping_table[0]", &["found a list of 1 entry, expected a list of 2 numbers"]);
    bad("rayleigh = { alpha = -1, beta = 1 }", "-1,", "rayleigh.alpha", &["found -1, expected a number of 0"]);
    bad("rayleigh = { alpha = 1 }", "{ alpha", "rayleigh.beta", &["`beta` is missing", "beta = 1e-5"]);
    bad("raileigh = 1", "raileigh", "raileigh", &["did you mean `rayleigh`?"]);
    refused(
        "flexible = \"auto\"\nmost = 1\ndamping_ratio = [1, 1]",
        "[1, 1]",
        "modes.damping_ratio",
        &["set `most = 2` in [modes]"],
    );
}

/// Closed form: straight lines of the table, and √(αβ) of Rayleigh's damping.
#[test]
fn the_ratio_of_a_mode() {
    let list = Damping::List(vec![0.1, 0.2]);
    assert_eq!([0, 1, 2, 9].map(|k| list.ratio(k, 1.0)), [0.1, 0.2, 0.2, 0.2]);
    assert_eq!(Damping::Uniform(0.3).ratio(4, 1.0), 0.3);
    let table = Damping::Table(vec![[10.0, 0.02], [20.0, 0.04], [40.0, 0.0]]);
    for (frequency, ratio) in
        [(0.0, 0.02), (10.0, 0.02), (15.0, 0.03), (20.0, 0.04), (30.0, 0.02), (40.0, 0.0), (1e9, 0.0)]
    {
        // Rounding of the frequency only: 7e-18 measured.
        assert!((table.ratio(0, TAU * frequency) - ratio).abs() < 1e-15, "{frequency}");
    }
    // The least ratio of α/2ω + βω/2 is √(αβ), at ω = √(α/β).
    let rayleigh = Damping::Rayleigh(Rayleigh { alpha: 0.9, beta: 0.4 });
    assert!((rayleigh.ratio(0, 1.5) - 0.6).abs() < 1e-15);
    assert!(rayleigh.ratio(0, 1.4) > 0.6 && rayleigh.ratio(0, 1.6) > 0.6);
}
