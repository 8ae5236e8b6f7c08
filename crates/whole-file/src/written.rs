//! Kinds of outputs, and the endings of their names.

use std::path::{Path, PathBuf};

use diagnostic::{Diagnosis, Diagnostic, Kind};

/// Endings that say what is in a file, and what that is.
const ENDINGS: [(&[&str], &str); 12] = [
    (&["toml"], "a scene or a sweep"),
    (&["h5", "hdf5"], "an HDF5 file"),
    (&["csv", "tsv", "txt", "dat"], "a table of text"),
    (&["json"], "JSON"),
    (&["html", "htm"], "a web page"),
    (&["gif", "mp4", "webm"], "an animation"),
    (&["svg", "pdf", "png", "jpg", "jpeg"], "a picture"),
    (&["fmu"], "an FMU"),
    (&["vtkhdf", "vtu", "pvd", "vtk", "xdmf"], "a file for ParaView"),
    (&["msh", "inp", "cdb", "bdf", "nas", "med", "unv"], "a mesh"),
    (&["geo", "geo_unrolled", "step", "stp", "iges", "igs", "brep", "stl", "obj", "ply", "off"], "geometry"),
    (&["mtx", "mtb"], "a matrix"),
];

/// An output whose name is that of another kind of file.
#[derive(Debug, thiserror::Error)]
#[error(
    "{}: found the name of {found}, expected that of {expected}\n = give it a name {}", path.display(),
    match ending {
        Some(ending) => format!("that ends in .{ending}"),
        None => "without this ending".to_owned(),
    }
)]
pub struct OtherEnding {
    /// The output.
    pub path: PathBuf,
    /// The kind of file that has such a name.
    pub found: &'static str,
    /// The kind that would be written.
    pub expected: &'static str,
    /// How its name ends; none of a folder.
    pub ending: Option<&'static str>,
}

impl Diagnostic for OtherEnding {
    fn diagnosis(&self) -> Diagnosis {
        Kind::Usage.of(&self.path).found(self.found).expected(self.expected)
    }
}

/// A kind of output. A name may end otherwise, but not as that of another kind.
#[derive(Debug, Clone, Copy)]
pub struct Written {
    pub(crate) what: &'static str,
    endings: &'static [&'static str],
    /// True where its bytes are not written from the first to the last: not into a pipe.
    pub(crate) in_any_order: bool,
}

impl Written {
    /// Endings of the names of its files, in small letters.
    pub fn endings(&self) -> &'static [&'static str] {
        self.endings
    }

    /// A folder.
    pub const FOLDER: Self = Self { what: "a folder", endings: &[], in_any_order: false };
    /// A scene.
    pub const SCENE: Self = Self { what: "a scene", endings: &["toml"], in_any_order: false };
    /// A body file.
    pub const BODY: Self = Self { what: "a body file", endings: &["h5", "hdf5"], in_any_order: true };
    /// The table of a sweep.
    pub const SWEEP: Self = Self { what: "the table of a sweep", endings: &["h5", "hdf5"], in_any_order: true };
    /// An FMU.
    pub const FMU: Self = Self { what: "an FMU", endings: &["fmu"], in_any_order: false };
    /// Matrices for Nastran.
    pub const OP4: Self = Self { what: "an OP4 file of matrices", endings: &["op4"], in_any_order: false };
    /// Matrices in binary records of Nastran.
    pub const OP2: Self = Self { what: "an OP2 file of matrices", endings: &["op2"], in_any_order: false };
    /// A modal body for MBDyn.
    pub const MBDYN: Self = Self { what: "a modal data file of MBDyn", endings: &["fem"], in_any_order: false };
    /// A flexible body for 42.
    pub const FLEX: Self = Self { what: "a Flex file of 42", endings: &["flex42"], in_any_order: false };
    /// Standard Input Data.
    pub const SID: Self = Self { what: "a file of Standard Input Data", endings: &["sid_fem"], in_any_order: false };
    /// A moving surface.
    pub const GLTF: Self = Self { what: "a glTF file", endings: &["glb"], in_any_order: false };
    /// A report.
    pub const PAGE: Self = Self { what: "a web page", endings: &["html", "htm"], in_any_order: false };
    /// A table of numbers.
    pub const TABLE: Self = Self { what: "a table of text", endings: &["csv"], in_any_order: false };
    /// An animation.
    pub const ANIMATION: Self = Self { what: "an animation", endings: &["gif", "mp4", "webm"], in_any_order: false };
    /// A file for ParaView.
    pub const VTKHDF: Self =
        Self { what: "a VTKHDF file", endings: &["vtkhdf", "h5", "hdf5", "hdf"], in_any_order: true };

    /// Refuses a name that ends as that of another kind. A folder that is there may have any.
    ///
    /// # Errors
    /// [`OtherEnding`].
    pub fn check(&self, path: &Path) -> Result<(), OtherEnding> {
        let Some(ending) = path.extension().and_then(|ending| ending.to_str()) else { return Ok(()) };
        let is = |known: &&str| ending.eq_ignore_ascii_case(known);
        if self.endings.iter().any(&is) || self.endings.is_empty() && path.is_dir() {
            return Ok(());
        }
        match ENDINGS.iter().find(|(endings, _)| endings.iter().any(&is)) {
            Some((_, found)) => Err(OtherEnding {
                path: path.to_owned(),
                found,
                expected: self.what,
                ending: self.endings.first().copied(),
            }),
            None => Ok(()),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_name_that_ends_as_that_of_another_kind_is_refused() {
        let refused =
            |written: Written, name: &str| written.check(Path::new(name)).err().map(|error| error.to_string());
        for name in ["a", "a.h5", "a.HDF5", "a.b", "v1.2", ".h5", "a.toml/b", "a.body"] {
            assert_eq!(refused(Written::BODY, name), None);
        }
        let error = refused(Written::BODY, "o/a.TOML").unwrap();
        assert_eq!(
            error,
            "o/a.TOML: found the name of a scene or a sweep, expected that of a body file\n = give it a name that ends in .h5"
        );
        for name in ["a.csv", "a.msh", "a.html", "a.step"] {
            assert!(refused(Written::SWEEP, name).is_some(), "{name}");
        }
        let folder = tempfile::tempdir().unwrap();
        let named = folder.path().join("results.h5");
        let error = Written::FOLDER.check(&named).unwrap_err().to_string();
        assert!(error.ends_with("expected that of a folder\n = give it a name without this ending"), "{error}");
        std::fs::create_dir(&named).unwrap();
        Written::FOLDER.check(&named).unwrap();
    }
}
