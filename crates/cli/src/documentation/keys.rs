//! The page of all keys of a scene, made of the JSON schema that editors use.

use std::collections::{BTreeMap, VecDeque};
use std::fmt::Write;

use serde_json::Value;

use super::{cell, is_made};

#[test]
fn the_page_of_keys_is_what_the_schema_has() {
    let page = Page::of(&flexframe::scene::json_schema());
    is_made("docs/reference/keys.md", &page);
}

/// The page as it grows: tables that are linked to are written later, each once, where it was met first.
struct Page<'a> {
    definitions: &'a Value,
    /// Definitions that have a heading, with the path of their first use.
    met: Vec<(&'a str, String)>,
    to_write: VecDeque<(&'a Value, String)>,
}

impl<'a> Page<'a> {
    fn of(schema: &'a Value) -> String {
        let mut page = Self { definitions: &schema["definitions"], met: Vec::new(), to_write: VecDeque::new() };
        let mut text = "# All keys of a scene\n\nMade of the schema that `flexframe schema` prints, by `./dev reference`. \
             [The scene file](scene.md) and [scenes of several bodies](systems.md) say what the keys mean together, \
             and which go with which. `[]` is an entry of a list, `NAME` a name of your own. Required keys are in bold.\n\n"
            .to_owned();
        text += &table(&page.rows(schema, ""));
        let mut of_body: Vec<Row> = Vec::new();
        while let Some((section, path)) = page.to_write.pop_front() {
            // What a body of several shares with one alone has its tables there.
            if path == "bodies.NAME" && !page.to_write.is_empty() {
                page.to_write.push_back((section, path));
                continue;
            }
            let _ = writeln!(text, "\n## {path}\n");
            if let Some(about) = about(section) {
                let _ = writeln!(text, "{about}\n");
            }
            match section["oneOf"].as_array().filter(|_| !section["properties"].is_object()) {
                Some(kinds) => text += &page.kinds(kinds, &path),
                None => {
                    let mut rows = page.rows(section, &path);
                    if path == "body" {
                        of_body.clone_from(&rows);
                    } else if path == "bodies.NAME" {
                        // The rest is in the table of `body`.
                        rows.retain(|row| !of_body.contains(row));
                    }
                    text += &table(&rows);
                }
            }
        }
        text
    }

    /// The kinds of a table, and its keys, each once with the kinds that have it.
    fn kinds(&mut self, kinds: &'a [Value], path: &str) -> String {
        let mut names = Vec::new();
        let mut keys: Vec<(Row, Vec<String>)> = Vec::new();
        for kind in kinds.iter().filter(|kind| kind["properties"].is_object()) {
            let name = format!("`\"{}\"`", kind["properties"]["kind"]["const"].as_str().unwrap_or_default());
            let about = about(kind).unwrap_or_default();
            let about =
                about.trim_start_matches(&format!("`kind = {}`", name.trim_matches('`'))).trim_start_matches(": ");
            names.push([name.clone(), about.to_owned()]);
            for row in self.rows(kind, path).into_iter().filter(|row| !row[0].contains("`kind`")) {
                match keys.iter_mut().find(|(known, _)| *known == row) {
                    Some((_, of)) => of.push(name.clone()),
                    None => keys.push((row, vec![name.clone()])),
                }
            }
        }
        let count = names.len();
        keys.sort_by_key(|(row, _)| row[0].trim_matches('*').to_owned());
        let names: String = names.iter().map(|[name, about]| format!("| {name} | {about} |\n")).collect();
        let rows: Vec<Row> = keys
            .into_iter()
            .map(|([key, value, default, about], of)| {
                let of = if of.len() == count { "all kinds".to_owned() } else { of.join(", ") };
                [format!("{key} of {of}"), value, default, about]
            })
            .collect();
        format!("| `kind` | |\n|---|---|\n{names}\n{}", table(&rows))
    }

    /// Key, value, default and meaning.
    fn rows(&mut self, section: &'a Value, path: &str) -> Vec<Row> {
        let required = section["required"].as_array().map(Vec::as_slice).unwrap_or_default();
        let mut rows = Vec::new();
        // By name: features of serde_json decide the order of a map.
        let keys: BTreeMap<_, _> = section["properties"].as_object().into_iter().flatten().collect();
        for (key, of) in keys {
            let inner = if path.is_empty() { key.clone() } else { format!("{path}.{key}") };
            let value = self.value(of, &inner);
            let default = match &of["default"] {
                Value::Null => String::new(),
                default => format!("`{default}`"),
            };
            let name =
                if required.iter().any(|name| name == key) { format!("**`{key}`**") } else { format!("`{key}`") };
            let about = about(of).or_else(|| about(self.target(of)?.1)).unwrap_or_default();
            rows.push([name, value, default, about]);
        }
        rows
    }

    /// The definition that a value refers to, with its name.
    fn target(&self, of: &Value) -> Option<(&'a str, &'a Value)> {
        let name = of["$ref"].as_str()?.strip_prefix("#/definitions/")?;
        self.definitions.as_object()?.get_key_value(name).map(|(name, of)| (name.as_str(), of))
    }

    /// Kind of a value in words, with a link to its table if it has one.
    fn value(&mut self, of: &'a Value, path: &str) -> String {
        if let Some((name, target)) = self.target(of) {
            return self.definition(name, target, path);
        }
        for several in ["anyOf", "oneOf", "allOf"] {
            if let Some(all) = of[several].as_array() {
                let mut found: Vec<String> = Vec::new();
                for one in all.iter().filter(|one| one["type"] != "null") {
                    let value = self.value(one, path);
                    if !found.contains(&value) {
                        found.push(value);
                    }
                }
                return found.join(" or ");
            }
        }
        if let Some(values) = of["enum"].as_array() {
            let values: Vec<String> = values.iter().filter(|v| !v.is_null()).map(|v| format!("`{v}`")).collect();
            return values.join(", ");
        }
        if !of["const"].is_null() {
            return format!("`{}`", of["const"]);
        }
        let kind = match &of["type"] {
            Value::Array(kinds) => {
                kinds.iter().filter_map(Value::as_str).find(|kind| *kind != "null").unwrap_or_default()
            }
            kind => kind.as_str().unwrap_or_default(),
        };
        match kind {
            "number" => "number".to_owned(),
            "integer" => "whole number".to_owned(),
            "boolean" => "`true`, `false`".to_owned(),
            "string" => "text".to_owned(),
            "array" => {
                let entry = self.value(&of["items"], &format!("{path}[]"));
                match (of["maxItems"].as_u64(), entry.as_str()) {
                    (Some(count), "number") => format!("{count} numbers"),
                    (None, "number" | "text") => format!("list of {entry}s"),
                    (Some(count), _) => format!("{count} × {entry}"),
                    (None, _) => format!("list: {entry}"),
                }
            }
            "object" if of["properties"].is_object() => self.link(of, path),
            "object" => format!("by name: {}", self.value(&of["additionalProperties"], &format!("{path}.NAME"))),
            _ => panic!("{path}: {of}"),
        }
    }

    fn definition(&mut self, name: &'a str, target: &'a Value, path: &str) -> String {
        let is_table = target["properties"].is_object()
            || target["oneOf"].as_array().is_some_and(|kinds| kinds.iter().any(|kind| kind["properties"].is_object()));
        if !is_table {
            return self.value(target, path);
        }
        match self.met.iter().find(|(met, _)| *met == name) {
            Some((_, first)) => link(first),
            None => {
                self.met.push((name, path.to_owned()));
                self.link(target, path)
            }
        }
    }

    fn link(&mut self, to: &'a Value, path: &str) -> String {
        self.to_write.push_back((to, path.to_owned()));
        link(path)
    }
}

type Row = [String; 4];

/// A table of keys; without a column of defaults where there are none.
fn table(rows: &[Row]) -> String {
    if rows.is_empty() {
        return String::new();
    }
    let has_default = rows.iter().any(|row| !row[2].is_empty());
    let head = if has_default {
        "| key | value | default | meaning |\n|---|---|---|---|\n"
    } else {
        "| key | value | meaning |\n|---|---|---|\n"
    };
    let mut text = head.to_owned();
    for [key, value, default, about] in rows {
        let default = if has_default { format!(" {default} |") } else { String::new() };
        let _ = writeln!(text, "| {key} | {value} |{default} {about} |");
    }
    text
}

fn link(path: &str) -> String {
    let anchor: String = path.to_lowercase().chars().filter(|c| c.is_alphanumeric() || "_-".contains(*c)).collect();
    format!("[{}](#{anchor})", path.replace("[]", ""))
}

/// First paragraph of a description.
fn about(of: &Value) -> Option<String> {
    Some(cell(of["description"].as_str()?.split("\n\n").next()?))
}
