//! The page of all keys of a scene, made of the JSON schema that editors use.

use std::collections::VecDeque;
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
        text += &page.table(schema, "", false);
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
                Some(kinds) => {
                    for kind in kinds.iter().filter(|kind| kind["properties"].is_object()) {
                        let name = kind["properties"]["kind"]["const"].as_str().unwrap_or_default();
                        let kind_is = format!("`kind = \"{name}\"`");
                        let about = about(kind).unwrap_or_default();
                        let about = about.trim_start_matches(&kind_is).trim_start_matches(": ");
                        let _ = writeln!(text, "**{kind_is}** {about}\n");
                        text += &page.table(kind, &path, true);
                        text.push('\n');
                    }
                    text.truncate(text.trim_end().len());
                    text.push('\n');
                }
                None => text += &page.table(section, &path, false),
            }
        }
        text
    }

    fn table(&mut self, section: &'a Value, path: &str, is_kind: bool) -> String {
        let required = section["required"].as_array().map(Vec::as_slice).unwrap_or_default();
        let mut rows = String::new();
        for (key, of) in section["properties"].as_object().into_iter().flatten() {
            if is_kind && key == "kind" {
                continue;
            }
            let inner = if path.is_empty() { key.clone() } else { format!("{path}.{key}") };
            let value = self.value(of, &inner);
            let default = match &of["default"] {
                Value::Null => String::new(),
                default => format!("`{default}`"),
            };
            let name =
                if required.iter().any(|name| name == key) { format!("**`{key}`**") } else { format!("`{key}`") };
            let about = about(of).or_else(|| about(self.target(of)?.1)).unwrap_or_default();
            let _ = writeln!(rows, "| {name} | {value} | {default} | {about} |");
        }
        if rows.is_empty() { rows } else { format!("| key | value | default | meaning |\n|---|---|---|---|\n{rows}") }
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
                match of["maxItems"].as_u64() {
                    Some(count) => format!("list of {count}: {entry}"),
                    None => format!("list: {entry}"),
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

fn link(path: &str) -> String {
    let anchor: String = path.to_lowercase().chars().filter(|c| c.is_alphanumeric() || "_-".contains(*c)).collect();
    format!("[{}](#{anchor})", path.replace("[]", ""))
}

/// First paragraph of a description.
fn about(of: &Value) -> Option<String> {
    Some(cell(of["description"].as_str()?.split("\n\n").next()?))
}
