//! Whatever the text, the answer is a scene or an error with a message, never a panic.

use scene::Body;

const EXAMPLE: &str = include_str!("../../src/text/example.toml");

/// Reads the text; a refusal must have a place within it and a message.
fn read(text: &str) -> Result<Body, String> {
    Body::parse(text, "damaged.toml").map_err(|error| {
        let message = error.to_string();
        let place = error.place().expect("a place in every error of a text");
        let lines = 1 + text.matches('\n').count();
        assert!((1..=lines).contains(&place.line) && place.column >= 1, "{message}");
        assert!(message.lines().count() >= 5 && message.contains('^'), "{message}");
        assert!(message.chars().count() < 4000, "{} long", message.len());
        message
    })
}

#[test]
fn cut_anywhere() {
    for end in 0..EXAMPLE.len() {
        let cut = read(&EXAMPLE[..end]);
        // The last required key is the step.
        if end < EXAMPLE.find("step = 1e-4").unwrap() + "step = 1e-4".len() {
            assert!(cut.is_err(), "accepted when cut at {end}");
        }
        let _ = read(&EXAMPLE[end..]);
    }
}

#[test]
fn changed_anywhere() {
    let mut refused = 0;
    for at in 0..EXAMPLE.len() {
        for new in ["", "\"", "=", "[", "]", "{", "}", ".", ",", "\n", "-", "9", "e", "é", "\0", "#", "\u{1f600}"] {
            let replaced = format!("{}{new}{}", &EXAMPLE[..at], &EXAMPLE[at + 1..]);
            let inserted = format!("{}{new}{}", &EXAMPLE[..at], &EXAMPLE[at..]);
            refused += read(&replaced).is_err() as usize + read(&inserted).is_err() as usize;
        }
    }
    assert!(refused > 10 * EXAMPLE.len(), "only {refused} of these were refused");
}

#[test]
fn lines_lost_doubled_and_swapped() {
    let lines: Vec<&str> = EXAMPLE.lines().collect();
    for i in 0..lines.len() {
        for j in 0..lines.len() {
            let mut changed = lines.clone();
            changed.swap(i, j);
            let _ = read(&changed.join("\n"));
            changed.insert(j, lines[i]);
            let _ = read(&changed.join("\n"));
            changed.remove(i);
            changed.remove(j);
            let _ = read(&changed.join("\n"));
        }
    }
}

#[test]
fn deep_and_long() {
    let n = 100_000;
    for text in [
        "[".repeat(n),
        "a = ".to_owned() + &"[".repeat(n),
        "a = ".to_owned() + &"{ a = ".repeat(n),
        "a.".repeat(n) + "a = 1",
        format!("[{}a]", "a.".repeat(n)),
        "a".repeat(n) + " = 1",
        format!("\"{}\" = 1", "a b\\n".repeat(n)),
        format!("title = {}", "1".repeat(n)),
        format!("title = 3{}", " # é".repeat(n)),
        format!("title = [{}]", "1,".repeat(n)),
        format!("{EXAMPLE}\n[[loads]]\nkind = '{}'", "x".repeat(n)),
    ] {
        read(&text).unwrap_err();
    }
}

#[test]
fn a_very_long_line_is_shown_around_the_fault() {
    let padding = "0.0, ".repeat(10_000);
    let text =
        EXAMPLE.replace("modal_displacement = []", &format!("modal_displacement = [{padding}'here', {padding}]"));
    let message = read(&text).unwrap_err();
    let lines: Vec<&str> = message.lines().collect();
    let caret = lines[3].find('^').unwrap();
    assert!(lines[2][caret..].starts_with("'here'"), "{message}");
    assert_eq!(lines[3].matches('^').count(), 6, "{message}");
    assert!(lines[0].contains("`initial.modal_displacement[10000]`"), "{message}");
}
