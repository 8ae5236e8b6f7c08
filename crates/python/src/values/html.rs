//! Output for notebooks: headings and tables.

/// A text as it stands between tags.
pub(crate) fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;")
}

/// A title, and a line below it.
pub(crate) fn heading(title: &str, line: &str) -> String {
    format!("<b>{}</b><br>{}", escaped(title), escaped(line))
}

/// A table with the names of its columns.
pub(crate) fn table<const N: usize>(head: [&str; N], rows: impl Iterator<Item = [String; N]>) -> String {
    let cells = |tag: &str, cells: [&str; N]| {
        let cells = cells.map(|cell| format!("<{tag}>{}</{tag}>", escaped(cell)));
        format!("<tr>{}</tr>", cells.concat())
    };
    let rows: String = rows.map(|row| cells("td", row.each_ref().map(String::as_str))).collect();
    format!("<table><thead>{}</thead><tbody>{rows}</tbody></table>", cells("th", head))
}
