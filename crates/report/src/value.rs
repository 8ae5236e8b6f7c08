//! Values of a report.

use serde::Serialize;
use serde_json::Value as Json;

/// A value: a number, a word, a list, or a tree of them.
#[derive(Debug, Clone, PartialEq)]
pub enum Value {
    /// A number that may be not finite: JSON has the words "infinite", "-infinite" or "undefined" then, since its `null` stands for none.
    Number(f64),
    /// A list.
    List(Vec<Value>),
    /// Another form of JSON.
    Json(Json),
}

impl Value {
    /// No value: `null` in JSON, nothing in CSV, a dash in text.
    pub const NONE: Self = Self::Json(Json::Null);

    /// Plain data without numbers that are not finite.
    pub fn of(data: &impl Serialize) -> Self {
        Self::Json(serde_json::to_value(data).unwrap_or_default())
    }

    /// As JSON.
    pub fn json(&self) -> Json {
        match self {
            Self::Number(value) if value.is_finite() => (*value).into(),
            Self::Number(value) => not_finite(*value).into(),
            Self::List(values) => values.iter().map(Self::json).collect(),
            Self::Json(json) => json.clone(),
        }
    }
}

/// The value at a path of JSON, such as `peaks[0].magnitude`.
///
/// # Errors
/// The part of the path that leads nowhere, and the value that it leads on from.
pub fn at_path<'j, 'p>(json: &'j Json, path: &'p str) -> Result<&'j Json, (&'p str, &'j Json)> {
    path.split(['.', '[']).try_fold(json, |json, part| {
        let next = match part.strip_suffix(']') {
            Some(index) => index.parse::<usize>().ok().and_then(|index| json.get(index)),
            None => json.get(part),
        };
        next.ok_or((part, json))
    })
}

fn not_finite(value: f64) -> &'static str {
    match value {
        value if value.is_nan() => "undefined",
        value if value > 0.0 => "infinite",
        _ => "-infinite",
    }
}

impl From<f64> for Value {
    fn from(value: f64) -> Self {
        Self::Number(value)
    }
}

macro_rules! from_json {
    ($($of:ty),*) => {
        $(impl From<$of> for Value {
            fn from(value: $of) -> Self {
                Self::Json(value.into())
            }
        })*
    };
}

from_json!(usize, u64, bool, &str, String);

impl From<&String> for Value {
    fn from(value: &String) -> Self {
        value.as_str().into()
    }
}

impl<V: Into<Value>> From<Option<V>> for Value {
    fn from(value: Option<V>) -> Self {
        value.map_or(Self::NONE, Into::into)
    }
}

impl<V: Into<Value>> From<Vec<V>> for Value {
    fn from(values: Vec<V>) -> Self {
        Self::List(values.into_iter().map(Into::into).collect())
    }
}

impl<V: Into<Value> + Clone> From<&[V]> for Value {
    fn from(values: &[V]) -> Self {
        values.to_vec().into()
    }
}

impl<V: Into<Value>, const N: usize> From<[V; N]> for Value {
    fn from(values: [V; N]) -> Self {
        Vec::from(values).into()
    }
}
