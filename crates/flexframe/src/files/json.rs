//! Values that JSON has no form for: numbers that are not finite, and names of files that are not UTF-8.
//!
//! serde_json would write `null` for the former, which stands for "there is none", and fail at the latter.

use std::path::{Path, PathBuf};

use report::Value;
use serde::{Serialize, Serializer};

/// A finite number as it is, another as the text "infinite", "-infinite" or "undefined".
pub(crate) fn number<S: Serializer>(value: &f64, serializer: S) -> Result<S::Ok, S::Error> {
    Value::from(*value).json().serialize(serializer)
}

/// Each as [`number`].
pub(crate) fn numbers<S: Serializer>(values: &[f64], serializer: S) -> Result<S::Ok, S::Error> {
    Value::from(values).json().serialize(serializer)
}

/// As [`number`], or `null` where there is none.
pub(crate) fn optional<S: Serializer>(value: &Option<f64>, serializer: S) -> Result<S::Ok, S::Error> {
    Value::from(*value).json().serialize(serializer)
}

/// Values by their names.
pub(crate) fn object<S: Serializer>(pairs: &[(&'static str, bool)], serializer: S) -> Result<S::Ok, S::Error> {
    serializer.collect_map(pairs.iter().copied())
}

/// A path; what is not UTF-8 in it is replaced by U+FFFD.
pub(crate) fn path<S: Serializer>(path: &Path, serializer: S) -> Result<S::Ok, S::Error> {
    serializer.collect_str(&path.display())
}

/// As [`path`], or `null` where there is none.
pub(crate) fn optional_path<S: Serializer>(path: &Option<PathBuf>, serializer: S) -> Result<S::Ok, S::Error> {
    path.as_ref().map(|path| path.display().to_string()).serialize(serializer)
}

/// Each as [`path`].
pub(crate) fn paths<S: Serializer>(paths: &[PathBuf], serializer: S) -> Result<S::Ok, S::Error> {
    serializer.collect_seq(paths.iter().map(|path| path.display().to_string()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[derive(Serialize)]
    struct Report {
        #[serde(serialize_with = "number")]
        value: f64,
        #[serde(serialize_with = "numbers")]
        values: Vec<f64>,
        #[serde(serialize_with = "optional")]
        some: Option<f64>,
        #[serde(serialize_with = "optional")]
        none: Option<f64>,
        #[serde(serialize_with = "path")]
        path: PathBuf,
    }

    #[test]
    fn what_is_not_finite_is_no_null() {
        use std::os::unix::ffi::OsStringExt;
        let report = Report {
            value: f64::INFINITY,
            values: vec![1.5, f64::NEG_INFINITY, f64::NAN],
            some: Some(f64::INFINITY),
            none: None,
            path: std::ffi::OsString::from_vec(b"a\xff".to_vec()).into(),
        };
        let json = serde_json::to_value(&report).unwrap();
        let expected = serde_json::json!({
            "value": "infinite", "values": [1.5, "-infinite", "undefined"], "some": "infinite", "none": null,
            "path": "a\u{fffd}",
        });
        assert_eq!(json, expected);
    }
}
