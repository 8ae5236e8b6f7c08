//! From the URI of the resources to their folder.

use std::path::PathBuf;

use diagnostic::Failure;
use percent_encoding::percent_decode_str;

use crate::error::refused;

/// The folder that a URI of the scheme "file", or a plain path, stands for.
pub fn folder_of(location: &str) -> Result<PathBuf, Failure> {
    let refuse = || {
        refused(format!(
            "the resource location {location:?} is no folder of this machine; give the URI of the unpacked folder resources, such as file:///tmp/blade/resources"
        ))
    };
    let Some(rest) = location.strip_prefix("file:") else {
        return if location.is_empty() || location.contains("://") { Err(refuse()) } else { Ok(location.into()) };
    };
    let path = match rest.strip_prefix("//") {
        Some(rest) => rest.strip_prefix("localhost").unwrap_or(rest),
        None => rest,
    };
    let path = percent_decode_str(path).decode_utf8().map_err(|_| refuse())?;
    // Of Windows, "/C:/…" is "C:/…".
    let without_slash = path.strip_prefix('/').filter(|rest| rest.as_bytes().get(1) == Some(&b':'));
    match without_slash.unwrap_or(&path) {
        "" => Err(refuse()),
        path if path.starts_with('/') || without_slash.is_some() => Ok(path.into()),
        _ => Err(refuse()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn uris_and_paths_are_folders() {
        for (uri, path) in [
            ("file:///tmp/a%20b/resources", "/tmp/a b/resources"),
            ("file:/tmp/resources", "/tmp/resources"),
            ("file://localhost/tmp/resources/", "/tmp/resources/"),
            ("/tmp/resources", "/tmp/resources"),
            ("file:///C:/fmu/resources", "C:/fmu/resources"),
        ] {
            assert_eq!(folder_of(uri).unwrap(), PathBuf::from(path));
        }
        for wrong in ["", "file:", "file://server/share", "http://x/resources", "file:///%ff"] {
            let error = folder_of(wrong).unwrap_err().to_string();
            assert!(error.contains("file:///tmp/blade/resources"), "{error}");
        }
    }
}
