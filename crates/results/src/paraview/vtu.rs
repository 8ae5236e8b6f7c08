//! VTU, a file of XML with numbers appended to it, and PVD, the list of such files: what ParaView before 5.12 reads.
//!
//! A VTU file has one step, and its mesh.

use crate::FileError;
use crate::error::check_length;
use crate::paraview::fields::{Field, Grid};
use crate::paraview::vtkhdf::{put, temporary};
use sealed::SealedError;
use std::fmt::Write as _;
use std::fs::File;
use std::io::{self, BufWriter, Write};
use std::path::Path;

/// Writes the fields of one step, each point by point.
///
/// # Errors
/// [`FileError::WrongLength`] for a field of another length than points times components; [`FileError::Exists`] and
/// [`FileError::Sealed`].
pub fn write_vtu(
    path: impl AsRef<Path>,
    grid: &Grid,
    fields: &[(&Field, &[f64])],
    overwrite: bool,
) -> Result<(), FileError> {
    let path = path.as_ref();
    for (field, values) in fields {
        check_length(path, &field.name, grid.points.len() * field.components, values.len())?;
    }
    let place = temporary(path, overwrite)?;
    let written = File::create(&place).map(BufWriter::new).and_then(|mut file| {
        write_grid(&mut file, grid, fields)?;
        file.flush()
    });
    written.map_err(SealedError::system(path, "write the file"))?;
    put(place, path, overwrite)
}

/// A file in a list.
#[derive(Debug, Clone, PartialEq)]
pub struct PvdEntry {
    /// Its time.
    pub time: f64,
    /// Number of its mesh among those of this time, from 0.
    pub part: usize,
    /// Name of this mesh.
    pub name: String,
    /// Name of the file, in the folder of the list.
    pub file: String,
}

/// Writes the list of files.
///
/// # Errors
/// [`FileError::Exists`] and [`FileError::Sealed`].
pub fn write_pvd(path: impl AsRef<Path>, files: &[PvdEntry], overwrite: bool) -> Result<(), FileError> {
    let path = path.as_ref();
    let place = temporary(path, overwrite)?;
    let mut text = "<?xml version=\"1.0\"?>\n<VTKFile type=\"Collection\" version=\"0.1\">\n<Collection>\n".to_owned();
    for PvdEntry { time, part, name, file } in files {
        let [name, file] = [name, file].map(|text| escaped(text));
        // Writing to a String cannot fail.
        let _ = writeln!(text, "<DataSet timestep=\"{time:?}\" part=\"{part}\" name=\"{name}\" file=\"{file}\"/>");
    }
    text += "</Collection>\n</VTKFile>\n";
    std::fs::write(&place, text).map_err(SealedError::system(path, "write the file"))?;
    put(place, path, overwrite)
}

/// An array that is appended: what the XML says of it, and its bytes.
struct Appended {
    head: String,
    bytes: Vec<u8>,
}

impl Appended {
    fn new<const N: usize>(kind: &str, name: &str, components: usize, values: impl Iterator<Item = [u8; N]>) -> Self {
        let name = escaped(name);
        let head = format!("<DataArray type=\"{kind}\" Name=\"{name}\" NumberOfComponents=\"{components}\"");
        Self { head, bytes: values.flatten().collect() }
    }
}

fn write_grid(file: &mut impl Write, grid: &Grid, fields: &[(&Field, &[f64])]) -> io::Result<()> {
    let (cells, each) = (grid.cells(), grid.cells.points());
    let doubles = |values: &[f64]| values.iter().map(|x| x.to_le_bytes()).collect::<Vec<_>>().into_iter();
    let data: Vec<Appended> = fields
        .iter()
        .map(|(field, values)| Appended::new("Float64", &field.name, field.components, doubles(values)))
        .collect();
    let points = [Appended::new("Float64", "Points", 3, doubles(grid.points.as_flattened()))];
    let connectivity = grid.connectivity.iter().map(|point| i64::from(*point).to_le_bytes());
    let cells = [
        Appended::new("Int64", "connectivity", 1, connectivity),
        Appended::new("Int64", "offsets", 1, (1..=cells).map(|cell| ((cell * each) as i64).to_le_bytes())),
        Appended::new("UInt8", "types", 1, std::iter::repeat_n([grid.cells.number()], cells)),
    ];
    writeln!(
        file,
        "<?xml version=\"1.0\"?>\n<VTKFile type=\"UnstructuredGrid\" version=\"1.0\" byte_order=\"LittleEndian\" \
         header_type=\"UInt64\">\n<UnstructuredGrid>\n<Piece NumberOfPoints=\"{}\" NumberOfCells=\"{}\">",
        grid.points.len(),
        grid.cells()
    )?;
    let mut offset = 0;
    for (section, arrays) in [("PointData", &data[..]), ("Points", &points), ("Cells", &cells)] {
        writeln!(file, "<{section}>")?;
        for Appended { head, bytes } in arrays {
            writeln!(file, "{head} format=\"appended\" offset=\"{offset}\"/>")?;
            offset += 8 + bytes.len();
        }
        writeln!(file, "</{section}>")?;
    }
    write!(file, "</Piece>\n</UnstructuredGrid>\n<AppendedData encoding=\"raw\">\n_")?;
    for Appended { bytes, .. } in data.iter().chain(&points).chain(&cells) {
        file.write_all(&(bytes.len() as u64).to_le_bytes())?;
        file.write_all(bytes)?;
    }
    writeln!(file, "\n</AppendedData>\n</VTKFile>")
}

/// Text within quotes in XML.
fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('"', "&quot;")
}
