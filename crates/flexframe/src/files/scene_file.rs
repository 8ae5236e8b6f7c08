//! Where a scene file was, as text in a results file.

use std::path::{Path, PathBuf};

use percent_encoding::{AsciiSet, NON_ALPHANUMERIC, percent_decode_str, percent_encode};

/// Beginning of a path that is no UTF-8; another one begins with the root of the file system.
const URL: &str = "file://";

/// Characters that such a path keeps as they are.
const ENCODED: &AsciiSet = &NON_ALPHANUMERIC.remove(b'/').remove(b'.').remove(b'-').remove(b'_').remove(b'~');

/// The path from the root of the file system, with neither `..` nor links in the name of its folder: one file is at one
/// place, by whatever name it was called.
pub(crate) fn from_root(path: &Path) -> PathBuf {
    let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
    match (folder.canonicalize(), path.file_name()) {
        (Ok(folder), Some(name)) => folder.join(name),
        // A scene that a program has made is in no file.
        _ => std::path::absolute(path).unwrap_or_else(|_| path.to_owned()),
    }
}

/// The path [`from_root`]; one that is no UTF-8 becomes a `file:` URL.
pub(crate) fn to_text(path: &Path) -> String {
    let place = from_root(path);
    match place.to_str() {
        Some(text) => text.to_owned(),
        None => format!("{URL}{}", percent_encode(place.as_os_str().as_encoded_bytes(), ENCODED)),
    }
}

/// The path in such a text.
pub(crate) fn to_path(text: &str) -> PathBuf {
    match text.strip_prefix(URL) {
        Some(encoded) => from_bytes(percent_decode_str(encoded).collect()),
        None => PathBuf::from(text),
    }
}

#[cfg(unix)]
fn from_bytes(bytes: Vec<u8>) -> PathBuf {
    PathBuf::from(<std::ffi::OsString as std::os::unix::ffi::OsStringExt>::from_vec(bytes))
}

#[cfg(not(unix))]
fn from_bytes(bytes: Vec<u8>) -> PathBuf {
    PathBuf::from(String::from_utf8_lossy(&bytes).into_owned())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_scene_is_at_one_place() {
        let folder = tempfile::tempdir().unwrap();
        let root = folder.path().canonicalize().unwrap();
        std::fs::create_dir(root.join("a b")).unwrap();
        let expected = root.join("a b/ω.toml");
        for name in ["a b/ω.toml", "a b/../a b/ω.toml", "./a b/./ω.toml"] {
            let text = to_text(&root.join(name));
            assert_eq!(text, expected.to_str().unwrap());
            assert_eq!(to_path(&text), expected);
        }
        let here = std::env::current_dir().unwrap().canonicalize().unwrap().join("scene.toml");
        assert_eq!(to_path(&to_text(Path::new("scene.toml"))), here);
    }

    #[cfg(unix)]
    #[test]
    fn a_path_that_is_no_utf8_comes_back_byte_for_byte() {
        use std::os::unix::ffi::OsStrExt;
        let folder = tempfile::tempdir().unwrap();
        let root = folder.path().canonicalize().unwrap();
        let name = root.join(std::ffi::OsStr::from_bytes(b"caf\xe9 100%41 \xff\n"));
        std::fs::create_dir(&name).unwrap();
        let path = name.join("a scene.toml");
        let text = to_text(&path);
        assert!(text.starts_with("file:///") && text.ends_with("/caf%E9%20100%2541%20%FF%0A/a%20scene.toml"), "{text}");
        assert_eq!(to_path(&text), path);
    }
}
