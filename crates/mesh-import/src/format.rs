//! The beginnings of files, by which a format is known. No other program is given a file that does not begin as its name says:
//! gmsh takes what it does not know for a program.

use std::path::Path;

/// Bytes at the beginning of a file by which its format is known.
pub(crate) const HEAD: usize = 4096;

/// The ending of a file's name, in small letters.
pub(crate) fn ending(path: &Path) -> String {
    path.extension().unwrap_or_default().to_string_lossy().to_lowercase()
}

/// How files of a format begin.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Format {
    /// In words.
    pub(crate) expected: &'static str,
    begins: fn(&[u8]) -> bool,
}

impl Format {
    /// True if a file of this format may begin with these bytes.
    pub(crate) fn may_be(&self, head: &[u8]) -> bool {
        (self.begins)(head)
    }
}

/// The format of files with this ending; none of an ending that is not known.
pub(crate) fn format_of(ending: &str) -> Option<Format> {
    let format = |expected, begins| Some(Format { expected, begins });
    match ending {
        "msh" => format("$MeshFormat (or $Comments, $NOD) as its first line", is_msh),
        "unv" => format("-1 as its first line", |head| first_line(head) == b"-1"),
        "step" | "stp" => format("ISO-10303-21 at its beginning", |head| text(head).starts_with(b"ISO-10303-21")),
        "iges" | "igs" => format("a first line with S in column 73", is_iges),
        "brep" => format("DBRep_DrawableShape or CASCADE Topology at its beginning", |head| {
            [&b"DBRep_DrawableShape"[..], b"CASCADE Topology"].iter().any(|word| text(head).starts_with(word))
        }),
        "stl" => format("an STL file", |head| !head.is_empty()),
        "inp" => format("text whose first line begins with *", |head| is_text(head) && text(head).starts_with(b"*")),
        "bdf" | "nas" | "fem" => format("text", is_text),
        "vtu" | "xdmf" | "xmf" => format("XML", |head| text(head).starts_with(b"<")),
        "vtk" => format("\"# vtk DataFile\" as its first words", |head| head.starts_with(b"# vtk DataFile")),
        "mesh" => format("MeshVersionFormatted", |head| contains(head, b"MeshVersionFormatted")),
        "meshb" => format("the integer 1, which tells the order of bytes", |head| {
            [[0, 0, 0, 1], [1, 0, 0, 0]].iter().any(|one| head.starts_with(one))
        }),
        "med" | "h5m" => format("an HDF5 file", is_hdf5),
        "e" | "exo" | "ex2" | "g" | "gen" => {
            format("a NetCDF or HDF5 file", |head| head.starts_with(b"CDF") || is_hdf5(head))
        }
        _ => None,
    }
}

/// As gmsh has it, to the byte: before these words there is nothing, not even a space.
fn is_msh(head: &[u8]) -> bool {
    let line = head.split(|byte| *byte == b'\n').next().unwrap_or_default();
    [&b"$MeshFormat"[..], b"$Comments", b"$NOD"].contains(&line.trim_ascii_end())
}

/// The text after a byte order mark and spaces.
fn text(head: &[u8]) -> &[u8] {
    head.strip_prefix("\u{feff}".as_bytes()).unwrap_or(head).trim_ascii_start()
}

/// The first line that is not empty, without spaces around it.
fn first_line(head: &[u8]) -> &[u8] {
    let lines = text(head).split(|byte| *byte == b'\n');
    lines.map(<[u8]>::trim_ascii).next().unwrap_or_default()
}

fn is_iges(head: &[u8]) -> bool {
    let mut lines = head.split(|byte| *byte == b'\n').skip_while(|line| line.trim_ascii().is_empty());
    lines.next().and_then(|line| line.get(72)) == Some(&b'S')
}

fn is_text(head: &[u8]) -> bool {
    !head.is_empty() && !head.contains(&0)
}

/// The signature is at the beginning, or at a power of two.
fn is_hdf5(head: &[u8]) -> bool {
    [0, 512, 1024, 2048].iter().any(|at| head.get(*at..).is_some_and(|rest| rest.starts_with(b"\x89HDF\r\n\x1a\n")))
}

fn contains(head: &[u8], word: &[u8]) -> bool {
    head.windows(word.len()).any(|window| window == word)
}
