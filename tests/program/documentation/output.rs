//! Output of a command on a page, against what the command prints.

/// Numbers that stand for nothing but rounding, such as balances that are closed, may be any as small.
const ROUNDING: f64 = 1e-6;

/// Relative difference of numbers that are the same: machines differ in the last digits.
const SAME: f64 = 1e-4;

/// True if a line of what was printed is the claimed one, but for space and commas between words; `…` stands for any words.
pub fn says(printed: &str, claimed: &str) -> bool {
    let claimed = words(claimed);
    printed.lines().any(|line| fits(&words(line), &claimed))
}

fn words(line: &str) -> Vec<&str> {
    line.split(|c: char| c.is_whitespace() || c == ',').filter(|word| !word.is_empty()).collect()
}

fn fits(words: &[&str], claimed: &[&str]) -> bool {
    match claimed {
        [] => words.is_empty(),
        ["…", rest @ ..] => (0..=words.len()).any(|skipped| fits(&words[skipped..], rest)),
        [first, rest @ ..] => words.first().is_some_and(|word| is_same(word, first)) && fits(&words[1..], rest),
    }
}

fn is_same(word: &str, claimed: &str) -> bool {
    let ends = |c: char| "();:%[]".contains(c);
    match (word.trim_matches(ends).parse::<f64>(), claimed.trim_matches(ends).parse::<f64>()) {
        (Ok(x), Ok(y)) => (x - y).abs() <= SAME * x.abs().max(y.abs()) || x.abs().max(y.abs()) < ROUNDING,
        _ => word == claimed,
    }
}

#[test]
fn numbers_that_part_and_words_that_part_are_found() {
    let printed = "  mode   1   441.936528 Hz\n  balance  closed to 2.0e-8, (3, 4)\n0.01,13.884218,7\n";
    for (claimed, is_said) in [
        ("mode 1 441.9365 Hz", true),
        ("mode 1 442.1 Hz", false),
        ("mode 2 441.936528 Hz", false),
        ("mode … Hz", true),
        ("mode … s", false),
        ("balance …", true),
        ("balance closed to 3.0e-9, (3, 4)", true),
        ("balance closed to 3.0e-4, (3, 4)", false),
        ("balance closed to 2.0e-8, (3, 5)", false),
        ("balance closed", false),
        ("0.01,13.8842,…", true),
        ("0.01,13.9,…", false),
    ] {
        assert_eq!(says(printed, claimed), is_said, "{claimed}");
    }
}
