//! VTKHDF, ParaView's own layout of an HDF5 file (version 2.0, ParaView 5.12 and later).
//!
//! A mesh is there once: all steps begin at the same points and cells, and `PointDataOffsets` says where the values of
//! each step are. ParaView then keeps the mesh while time goes on. Steps are written one by one. Several meshes are a collection
//! (version 2.1): a group for each by its name, with its steps, and a tree that links to them.

use crate::FileError;
use crate::error::check_length;
use crate::paraview::fields::{Field, Grid};
use hdf5::plist::group_create::LinkCreationOrder;
use hdf5::types::FixedAscii;
use hdf5::{Group, H5Type};
use ndarray::{ArrayView, ArrayView1, ArrayView2, Dimension, s};
use sealed::SealedError;
use std::path::{Path, PathBuf};
use whole_file::TemporaryFile;

/// A mesh of a collection, with its fields.
#[derive(Debug, Clone, Copy)]
pub struct Block<'a> {
    /// Name in ParaView, without `/`.
    pub name: &'a str,
    /// The mesh.
    pub grid: &'a Grid,
    /// The fields.
    pub fields: &'a [Field],
}

/// A file that is being written. It takes its place in [`VtkHdf::finish`]; if it is dropped before, nothing has happened.
#[derive(Debug)]
pub struct VtkHdf {
    file: hdf5::File,
    place: TemporaryFile,
    path: PathBuf,
    /// Points of each mesh, and the datasets of its fields.
    blocks: Vec<(usize, Vec<hdf5::Dataset>)>,
    overwrite: bool,
}

impl VtkHdf {
    /// Begins a file of one mesh with the fields at these times; without times, of a state that has none.
    ///
    /// # Errors
    /// [`FileError::Exists`] and [`FileError::Sealed`].
    pub fn create(
        path: impl AsRef<Path>,
        grid: &Grid,
        times: Option<&[f64]>,
        fields: &[Field],
        overwrite: bool,
    ) -> Result<Self, FileError> {
        Self::begin(path.as_ref(), overwrite, |root| Ok(vec![create_block(root, grid, times, fields)?]))
    }

    /// Begins a file of several meshes, which ParaView shows as a collection.
    ///
    /// # Errors
    /// As [`VtkHdf::create`].
    pub fn create_collection(
        path: impl AsRef<Path>,
        blocks: &[Block<'_>],
        times: Option<&[f64]>,
        overwrite: bool,
    ) -> Result<Self, FileError> {
        Self::begin(path.as_ref(), overwrite, |root| {
            write_kind(root, [2, 1], "PartitionedDataSetCollection")?;
            let tree = ordered_group(root, TREE)?;
            let create = |(i, Block { name, grid, fields }): (usize, &Block<'_>)| {
                let name = if *name == TREE { "Assembly (body)" } else { name };
                let group = root.create_group(name)?;
                group.new_attr::<i64>().create("Index")?.write_scalar(&(i as i64))?;
                // Names in the tree are those of XML.
                ordered_group(&tree, &format!("body{i}"))?.link_soft(&format!("/{ROOT}/{name}"), name)?;
                create_block(&group, grid, times, fields)
            };
            blocks.iter().enumerate().map(create).collect()
        })
    }

    fn begin(
        path: &Path,
        overwrite: bool,
        blocks: impl FnOnce(&Group) -> hdf5::Result<Vec<(usize, Vec<hdf5::Dataset>)>>,
    ) -> Result<Self, FileError> {
        let place = temporary(path, overwrite)?;
        let mut builder = hdf5::File::with_options();
        // HDF5 would lock the file, and a process that is started meanwhile would keep the lock to its end.
        builder.with_fapl(|plist| plist.file_locking(false));
        let file = builder.create(&place).map_err(SealedError::hdf5(path, "create the file"))?;
        let blocks = ordered_group(&file, ROOT).and_then(|root| blocks(&root));
        let blocks = blocks.map_err(SealedError::hdf5(path, "write the mesh"))?;
        Ok(Self { file, place, path: path.to_owned(), blocks, overwrite })
    }

    /// Writes a field of a step of a mesh, point by point; all three are numbered from 0.
    ///
    /// # Errors
    /// [`FileError::WrongLength`] for a mesh or a field that there is not; [`FileError::Sealed`], also for a list of another length
    /// than points times components, and for a step that there is not.
    pub fn write(&self, block: usize, step: usize, field: usize, values: &[f64]) -> Result<(), FileError> {
        let (points, datasets) = self.blocks.get(block).map_or((0, &[][..]), |(points, sets)| (*points, sets));
        let count = datasets.len();
        check_length(&self.path, "the fields", count.max(field + 1), count)?;
        let dataset = &datasets[field];
        let rows = step * points..(step + 1) * points;
        let written = match values.len() / points.max(1) {
            1 => dataset.write_slice(ArrayView1::from(values), s![rows]),
            components => ArrayView2::from_shape((points, components), values)
                .map_err(|error| hdf5::Error::Internal(error.to_string()))
                .and_then(|values| dataset.write_slice(values, s![rows, ..])),
        };
        Ok(written.map_err(SealedError::hdf5(&self.path, format!("write step {step}")))?)
    }

    /// Moves the file into its place, once it is safe on the disk.
    ///
    /// # Errors
    /// [`FileError::Exists`] and [`FileError::Sealed`].
    pub fn finish(self) -> Result<(), FileError> {
        drop(self.blocks);
        self.file.close().map_err(SealedError::hdf5(&self.path, "write the file"))?;
        put(self.place, &self.path, self.overwrite)
    }
}

/// The place of a file that is not there yet, in the same folder.
pub(crate) fn temporary(path: &Path, overwrite: bool) -> Result<TemporaryFile, FileError> {
    if !overwrite && path.symlink_metadata().is_ok() {
        return Err(FileError::Exists { path: path.to_owned() });
    }
    let made = TemporaryFile::beside(path, ".tmp");
    Ok(made.map_err(SealedError::system(path, "create the file"))?.1)
}

/// Moves a file that is complete into its place.
pub(crate) fn put(place: TemporaryFile, path: &Path, overwrite: bool) -> Result<(), FileError> {
    let failed = |error| FileError::from(SealedError::system(path, "write the file")(error));
    std::fs::File::open(&place).and_then(|file| file.sync_all()).map_err(failed)?;
    place.put(path, overwrite).map_err(|error| match error.kind() {
        std::io::ErrorKind::AlreadyExists => FileError::Exists { path: path.to_owned() },
        _ => failed(error),
    })
}

/// Group of everything that VTK reads.
const ROOT: &str = "VTKHDF";
/// Group of the tree of a collection.
const TREE: &str = "Assembly";

/// A group that keeps the order of what is in it, as VTK wants of collections.
fn ordered_group(parent: &Group, name: &str) -> hdf5::Result<Group> {
    let order = LinkCreationOrder::Indexed;
    parent.create_group_builder().with_gcpl(|plist| plist.link_creation_order(order)).create(name)
}

fn write_kind(group: &Group, version: [i64; 2], kind: &str) -> hdf5::Result<()> {
    group.new_attr_builder().with_data(&version).create("Version")?;
    let text = FixedAscii::<28>::from_ascii(kind).map_err(|error| hdf5::Error::Internal(error.to_string()))?;
    group.new_attr::<FixedAscii<28>>().create("Type")?.write_scalar(&text)
}

/// A mesh with room for its fields: the number of its points, and a dataset for each field.
fn create_block(
    group: &Group,
    grid: &Grid,
    times: Option<&[f64]>,
    fields: &[Field],
) -> hdf5::Result<(usize, Vec<hdf5::Dataset>)> {
    write_head(group, grid)?;
    let (steps, points) = (times.map_or(1, <[f64]>::len), grid.points.len());
    let data = group.create_group("PointData")?;
    let create = |field: &Field| {
        let builder = data.new_dataset::<f64>();
        match field.components {
            1 => builder.shape(steps * points).create(field.name.as_str()),
            components => builder.shape((steps * points, components)).create(field.name.as_str()),
        }
    };
    let datasets = fields.iter().map(create).collect::<Result<_, _>>()?;
    if let Some(times) = times {
        write_steps(group, times, points, fields)?;
    }
    Ok((points, datasets))
}

/// Version, type and mesh.
fn write_head(group: &Group, grid: &Grid) -> hdf5::Result<()> {
    write_kind(group, [2, 0], "UnstructuredGrid")?;
    let (cells, each) = (grid.cells(), grid.cells.points());
    for (name, count) in [
        ("NumberOfPoints", grid.points.len()),
        ("NumberOfCells", cells),
        ("NumberOfConnectivityIds", grid.connectivity.len()),
    ] {
        write(group, name, ArrayView::from(&[count as i64]))?;
    }
    write(group, "Points", ArrayView2::from(grid.points.as_slice()))?;
    let connectivity: Vec<i64> = grid.connectivity.iter().map(|point| i64::from(*point)).collect();
    write(group, "Connectivity", ArrayView::from(&connectivity))?;
    let offsets: Vec<i64> = (0..=cells).map(|cell| (cell * each) as i64).collect();
    write(group, "Offsets", ArrayView::from(&offsets))?;
    write(group, "Types", ArrayView::from(&vec![grid.cells.number(); cells]))
}

/// The times, and where each step begins: in the same mesh, and after the values of the steps before it.
fn write_steps(group: &Group, times: &[f64], points: usize, fields: &[Field]) -> hdf5::Result<()> {
    let steps = group.create_group("Steps")?;
    steps.new_attr::<i64>().create("NSteps")?.write_scalar(&(times.len() as i64))?;
    write(&steps, "Values", ArrayView::from(times))?;
    write(&steps, "NumberOfParts", ArrayView::from(&vec![1_i64; times.len()]))?;
    let zeros = vec![0_i64; times.len()];
    for name in ["PartOffsets", "PointOffsets"] {
        write(&steps, name, ArrayView::from(&zeros))?;
    }
    for name in ["CellOffsets", "ConnectivityIdOffsets"] {
        // A column for the one kind of cells of this type.
        write(&steps, name, ArrayView::from(&zeros).into_shape_with_order((times.len(), 1)).map_err(internal)?)?;
    }
    let of_data = steps.create_group("PointDataOffsets")?;
    let offsets: Vec<i64> = (0..times.len()).map(|step| (step * points) as i64).collect();
    fields.iter().try_for_each(|field| write(&of_data, &field.name, ArrayView::from(&offsets)))
}

fn internal(error: ndarray::ShapeError) -> hdf5::Error {
    hdf5::Error::Internal(error.to_string())
}

fn write<T: H5Type, D: Dimension>(group: &Group, name: &str, values: ArrayView<'_, T, D>) -> hdf5::Result<()> {
    group.new_dataset_builder().with_data(values).create(name).map(drop)
}
