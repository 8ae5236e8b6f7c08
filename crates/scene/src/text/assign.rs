//! Values of keys, set in the text of a scene from outside of it.

use toml::Value;
use toml_edit::{DocumentMut, Item, Key, Table};

/// A key that cannot be set.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("`{key}`: found {found}, expected {expected}")]
pub struct AssignError {
    /// The path of keys.
    pub key: String,
    /// The fault.
    pub found: String,
    /// A right value or place.
    pub expected: String,
}

/// A part of a path of keys.
enum Step {
    Key(String),
    Entry(usize),
}

/// The text of a scene with other values of some keys, in their order. A key is a path such as `loads[0].amplitude`; tables
/// that the text lacks are added. Comments and everything else stay. Keys are written as in TOML: `points."left wing"`.
///
/// A text that is no TOML stays as it is: [`Body::parse`](crate::Body::parse) refuses it and says where.
///
/// # Errors
/// [`AssignError`] if a path does not lead to a place in the text.
pub fn assign(text: &str, values: &[(String, Value)]) -> Result<String, AssignError> {
    if values.is_empty() {
        return Ok(text.to_owned());
    }
    let Ok(mut document) = text.parse::<DocumentMut>() else { return Ok(text.to_owned()) };
    let mut root = Item::Table(std::mem::take(document.as_table_mut()));
    for (key, value) in values {
        set(&mut root, key, value).map_err(|(found, expected)| AssignError { key: key.clone(), found, expected })?;
    }
    *document.as_table_mut() = root.into_table().unwrap_or_else(|_| Table::new());
    Ok(document.to_string())
}

/// The text of a scene without some keys, by their paths.
pub fn without(text: &str, keys: &[String]) -> String {
    let Ok(mut document) = text.parse::<DocumentMut>() else { return text.to_owned() };
    for key in keys {
        let Some(mut steps) = steps(key) else { continue };
        let Some(Step::Key(last)) = steps.pop() else { continue };
        let inner = steps.into_iter().try_fold(document.as_item_mut(), |item, step| match step {
            Step::Key(key) => item.get_mut(key),
            Step::Entry(index) => item.get_mut(index),
        });
        inner.and_then(Item::as_table_like_mut).map(|table| table.remove(&last));
    }
    document.to_string()
}

fn set(root: &mut Item, path: &str, value: &Value) -> Result<(), (String, String)> {
    const A_PATH: &str = "a path of keys of the scene, such as loads[0].amplitude";
    let mut item = root;
    let mut name = String::new();
    for step in steps(path).ok_or_else(|| (format!("{path:?}"), A_PATH.to_owned()))? {
        let refused = refusal(item, &name, &step);
        let inner = match step {
            Step::Key(key) => {
                name.clone_from(&key);
                item.get_mut(key)
            }
            Step::Entry(index) => item.get_mut(index),
        };
        item = inner.ok_or(refused)?;
    }
    let new = format!("value = {value}").parse::<DocumentMut>().ok().and_then(|mut text| text.remove("value"));
    let mut new = new.ok_or_else(|| (value.to_string(), "a value in TOML".to_owned()))?;
    // The comment behind the old value.
    if let (Some(old), Some(new)) = (item.as_value(), new.as_value_mut()) {
        *new.decor_mut() = old.decor().clone();
    }
    *item = new;
    Ok(())
}

/// The fault if the value with the key `name` has no such place: the value found, and the one expected.
fn refusal(item: &Item, name: &str, step: &Step) -> (String, String) {
    let entries = match item {
        Item::ArrayOfTables(list) => Some(list.len()),
        other => other.as_array().map(toml_edit::Array::len),
    };
    match (step, entries) {
        (Step::Key(key), _) => (format!("`{key}` in a value that is {}", kind(item)), "a key of a table".to_owned()),
        (Step::Entry(index), Some(length)) => {
            let expected = match length.checked_sub(1) {
                Some(last) => format!("one from 0 to {last}"),
                None => "a list that is not empty".to_owned(),
            };
            (format!("entry {index} of `{name}`"), expected)
        }
        (Step::Entry(_), None) => (format!("`{name}`, which is {}", kind(item)), "a list".to_owned()),
    }
}

/// The parts of a path: `a.b[2]."c d"`. `None` if it is none.
fn steps(path: &str) -> Option<Vec<Step>> {
    let mut steps = Vec::new();
    let mut rest = path;
    loop {
        let (key, after) = rest.split_at(key_length(rest)?);
        let [key] = Key::parse(key).ok()?.try_into().ok()?;
        steps.push(Step::Key(key.get().to_owned()));
        rest = after;
        while let Some(list) = rest.strip_prefix('[') {
            let (index, after) = list.split_once(']')?;
            steps.push(Step::Entry(index.parse().ok()?));
            rest = after;
        }
        match rest.strip_prefix('.') {
            Some(more) => rest = more,
            None => return rest.is_empty().then_some(steps),
        }
    }
}

/// Bytes of the first key of a path, with its quotes. `None` where these have no end.
fn key_length(path: &str) -> Option<usize> {
    let Some(quote) = path.chars().next().filter(|first| ['"', '\''].contains(first)) else {
        return Some(path.find(['.', '[']).unwrap_or(path.len()));
    };
    let mut is_escaped = false;
    let end = path[1..].find(|c| {
        let ends = c == quote && !is_escaped;
        is_escaped = quote == '"' && c == '\\' && !is_escaped;
        ends
    })?;
    Some(end + 2)
}

fn kind(item: &Item) -> &'static str {
    match item.type_name() {
        "table" | "inline table" => "a table",
        "array" | "array of tables" => "a list",
        "string" => "a text",
        "boolean" => "true or false",
        "integer" | "float" => "a number",
        "datetime" => "a date",
        _ => "not there",
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const TEXT: &str =
        "title = \"a\" # why\n[time]\nend = 1.0\n# two of them\n[[loads]]\nat = [1.0, 2.0]\n[[loads]]\nkind = \"b\"\n";

    fn one(key: &str, value: impl Into<Value>) -> Result<String, String> {
        assign(TEXT, &[(key.to_owned(), value.into())]).map_err(|error| error.to_string())
    }

    #[test]
    fn values_are_set_and_all_else_stays() {
        assert_eq!(one("time.end", 2.5).unwrap(), TEXT.replace("1.0\n", "2.5\n"));
        assert_eq!(one("loads[0].at[1]", 7).unwrap(), TEXT.replace("2.0]", "7]"));
        assert_eq!(one("loads[1].kind", "c").unwrap(), TEXT.replace("\"b\"", "\"c\""));
        let added = one("output.points.\"a b\"", vec![1.0, 0.0, 0.5]).unwrap();
        let table: toml::Table = added.parse().unwrap();
        assert_eq!(table["output"]["points"]["a b"][2].as_float(), Some(0.5));
        assert!(added.contains("# two of them"));
        let both = [("modes.flexible".to_owned(), Value::from(3)), ("modes.large".to_owned(), Value::from(2))];
        let table: toml::Table = assign("", &both).unwrap().parse().unwrap();
        assert_eq!((table["modes"]["flexible"].as_integer(), table["modes"]["large"].as_integer()), (Some(3), Some(2)));
    }

    #[test]
    fn keys_are_taken_out_and_all_else_stays() {
        let keys = ["time.end", "loads[0].at", "time.step", "output.every"].map(str::to_owned);
        assert_eq!(without(TEXT, &keys), TEXT.replace("end = 1.0\n", "").replace("at = [1.0, 2.0]\n", ""));
    }

    #[test]
    fn the_comment_behind_a_changed_value_stays() {
        assert_eq!(one("title", "b").unwrap(), TEXT.replace("\"a\" # why", "\"b\" # why"));
        let list = "list = [\n  1, # one\n  2 # two\n]\n";
        let changed = assign(list, &[("list[1]".to_owned(), Value::from(3))]).unwrap();
        assert_eq!(changed, list.replace("2 # two", "3 # two"));
    }

    #[test]
    fn keys_in_either_quotes_are_those_of_toml() {
        for (path, key) in [
            (r#"points."a.b[0]""#, "a.b[0]"),
            ("points.'a.b[0]'", "a.b[0]"),
            (r#"points."a\"b""#, "a\"b"),
            (r"points.'a\'", "a\\"),
            ("'points'.c", "c"),
        ] {
            let table: toml::Table = one(path, 1).unwrap().parse().unwrap();
            assert_eq!(table["points"][key].as_integer(), Some(1), "{path}");
        }
    }

    #[test]
    fn a_path_that_leads_nowhere_is_told() {
        for (path, words) in [
            ("", "a path of keys"),
            ("a..b", "a path of keys"),
            ("loads[x].at", "a path of keys"),
            ("loads[0]at", "a path of keys"),
            ("points.'a", "a path of keys"),
            ("points.a b", "a path of keys"),
            ("points.'a'b", "a path of keys"),
            ("title.end", "`end` in a value that is a text, expected a key of a table"),
            ("time[0]", "`time`, which is a table, expected a list"),
            ("points[0]", "`points`, which is not there, expected a list"),
            ("loads[2].at", "entry 2 of `loads`, expected one from 0 to 1"),
            ("loads.at", "`at` in a value that is a list"),
        ] {
            let refusal = one(path, 1).unwrap_err();
            assert!(refusal.contains(words), "{path}: {refusal}");
        }
        assert_eq!(assign("no TOML", &[("a".to_owned(), Value::from(1))]).unwrap(), "no TOML");
    }
}
