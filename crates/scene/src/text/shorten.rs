//! Long texts in messages.

/// Longest piece of a line, of a key or of a value that is shown, in characters.
pub(crate) const SHOWN: usize = 100;

/// The text, cut if it is very long, on one line.
pub fn shorten(text: &str) -> String {
    let mut words = text.split_whitespace();
    let mut short = words.next().unwrap_or_default().to_owned();
    for word in words.take(SHOWN) {
        short.push(' ');
        short.push_str(word);
    }
    match short.char_indices().nth(SHOWN) {
        Some((cut, _)) => format!("{}…", &short[..cut]),
        None => short,
    }
}
