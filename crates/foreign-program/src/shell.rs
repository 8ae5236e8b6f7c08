//! Names in scripts for a shell.

use std::fmt::Write;
use std::path::Path;

/// A path as one word for bash, on one line, whatever is in it: it may stand in a comment, too.
pub fn shell_word(path: &Path) -> String {
    let text = path.display().to_string();
    if !text.chars().any(char::is_control) {
        return format!("'{}'", text.replace('\'', r"'\''"));
    }
    let mut word = "$'".to_owned();
    for letter in text.chars() {
        // Writing to a string does not fail.
        let _ = match letter {
            '\'' | '\\' => write!(word, "\\{letter}"),
            _ if letter.is_control() => write!(word, "\\u{:04x}", u32::from(letter)),
            _ => write!(word, "{letter}"),
        };
    }
    word + "'"
}

#[cfg(test)]
mod tests {
    use std::process::Command;

    use super::*;

    #[test]
    fn bash_reads_any_path_as_one_word_and_as_nothing_in_a_comment() {
        for name in ["a b", "it's", "a\nrm -rf /", "tab\tand 'quote'\\n\u{7f}", "$(echo x)`y`\"z\"", "é\u{85}\r\n#"] {
            let word = shell_word(Path::new(name));
            assert_eq!(word.lines().count(), 1, "{word}");
            let script = format!("# {word}\nprintf %s {word}");
            let output = Command::new("bash").args(["-c", &script]).env("LC_ALL", "C.UTF-8").output().unwrap();
            assert_eq!((output.status.code(), String::from_utf8(output.stdout).unwrap()), (Some(0), name.to_owned()));
        }
    }
}
