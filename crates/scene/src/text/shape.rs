//! Shapes that values of the file must have, and help if they have others.

use std::fmt;

use toml::de::DeValue;

use crate::document::Node;
use crate::error::SceneError;
use crate::text::example::example;
use crate::text::shorten::shorten;

/// A shape that a value must have.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Shape {
    Number,
    /// A whole number, 0 or more.
    Count,
    Text,
    List,
    /// A list with this number of numbers.
    Vector(usize),
    Table,
}

impl fmt::Display for Shape {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Number => f.write_str("a finite number"),
            Self::Count => f.write_str("a whole number, 0 or more"),
            Self::Text => f.write_str("a string"),
            Self::List => f.write_str("a list"),
            Self::Vector(length) => write!(f, "a list of {length} numbers"),
            Self::Table => f.write_str("a table"),
        }
    }
}

/// The refusal of a value that does not have the shape.
pub(crate) fn wrong_shape(node: &Node, expected: Shape) -> SceneError {
    let found = node.value.get_ref();
    let help = match (expected, found) {
        (Shape::Number, DeValue::String(text)) if text.parse::<f64>().is_ok() => "remove the quotes".to_owned(),
        (Shape::Count, DeValue::String(text)) if text.parse::<u64>().is_ok() => "remove the quotes".to_owned(),
        (Shape::Text, DeValue::Integer(_) | DeValue::Float(_) | DeValue::Boolean(_)) => "put it in quotes".to_owned(),
        _ => like_the_example(node, &expected.to_string()),
    };
    node.place().refuse(describe(node), expected.to_string(), help)
}

/// The refusal of a value that has none of the types `expected`.
pub(crate) fn wrong_type(node: &Node, expected: &str) -> SceneError {
    let help = match node.value.get_ref() {
        DeValue::String(text) if text.parse::<f64>().is_ok() || text.parse::<bool>().is_ok() => {
            "remove the quotes".to_owned()
        }
        _ => like_the_example(node, expected),
    };
    node.place().refuse(describe(node), expected, help)
}

fn like_the_example(node: &Node, expected: &str) -> String {
    match example(&node.path) {
        Some(lines) if lines.contains('\n') => format!("write it like this:\n{lines}"),
        Some(line) => format!("write it like this: `{line}`"),
        None => format!("write {expected}"),
    }
}

fn describe(node: &Node) -> String {
    let written = shorten(node.written());
    match node.value.get_ref() {
        DeValue::String(_) => format!("the string {written}"),
        DeValue::Integer(_) | DeValue::Float(_) => format!("the number {written}"),
        DeValue::Boolean(_) => format!("the boolean {written}"),
        DeValue::Datetime(_) => format!("the date {written}"),
        DeValue::Array(list) if list.len() == 1 => "a list of 1 entry".to_owned(),
        DeValue::Array(list) => format!("a list of {} entries", list.len()),
        DeValue::Table(_) => "a table".to_owned(),
    }
}
