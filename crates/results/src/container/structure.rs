//! The HDF5 structure of a results file, laid out as its columns say.
//!
//! HDF5 only makes files here. It opens none that was there before, see [`mod@crate::container::seal`].

use crate::column::present;
use crate::container::room::Room;
use crate::container::seal;
use crate::shapes::stored::{ShapeDataset, StoredArray};
use crate::{Column, FileError, MeshProperties, Metadata, Units};
use hdf5::dataset::Layout;
use hdf5::plist::dataset_create::{AllocTime, FillTime};
use hdf5::types::VarLenUnicode;
use ndarray::{ArrayView2, ArrayViewD, aview0, aview1};
use std::path::Path;

/// Makes the file at `place` (called `path` in messages), which begins with a number of bytes that HDF5 leaves alone, and
/// closes it. Gives the first byte of each history, in the order of the columns, and of the checkpoints, and that of each
/// array; 0 where there is nothing.
pub(crate) fn make<R>(
    place: &Path,
    path: &Path,
    metadata: &Metadata,
    arrays: &[StoredArray],
    columns: &'static [Column<R>],
    room: Room,
    user_block: u64,
) -> Result<[Vec<u64>; 2], FileError> {
    let mut builder = hdf5::File::with_options();
    // Without times of creation, so that equal runs give equal files; the seal goes into the user block.
    builder.with_fcpl(|plist| plist.obj_track_times(false).userblock(user_block));
    // Numbers do not straddle the pages of the file, which may be written one by one. HDF5 would lock the file, and a process
    // that is started meanwhile would keep the lock to its end.
    builder.with_fapl(|plist| plist.alignment(1, 8).file_locking(false));
    let file = builder.create(place).map_err(FileError::hdf5(path, "create the file"))?;
    write_root_attributes(path, &file, metadata, room.checkpoint_words.is_none())?;
    write_body(path, &file, metadata)?;
    write_points(path, &file, metadata)?;
    if !metadata.support_names.is_empty() {
        let names = metadata.support_names.iter().map(String::as_str);
        write_texts(
            path,
            &file,
            "supports/names",
            names,
            "names of the supports, in the order of the other data sets",
        )?;
    }
    let inputs = metadata.input_files.iter().map(String::as_str);
    write_texts(path, &file, "input_files", inputs, "files that the run read, where they were")?;
    write_effects(path, &file, metadata)?;
    let warnings = metadata.warnings.iter().map(String::as_str);
    write_texts(path, &file, "warnings", warnings, "what should be known of the run; empty in an unfinished file")?;
    let arrays = (arrays.iter())
        .filter_map(|array| Some((array, array.dataset()?)))
        .map(|(array, dataset)| create_array(path, &file, array, dataset, &metadata.units))
        .collect::<Result<Vec<_>, _>>()?;
    let mut datasets = present(columns, metadata)
        .enumerate()
        .map(|(i, column)| create_history(path, &file, column, metadata, room, i == 0))
        .collect::<Result<Vec<_>, _>>()?;
    if let Some(words) = room.checkpoint_words {
        let checkpoint = file
            .new_dataset::<u64>()
            .layout(Layout::Contiguous)
            .alloc_time(Some(AllocTime::Early))
            .obj_track_times(false)
            .shape((2, words))
            .create("checkpoint")
            .map_err(FileError::hdf5(path, "create dataset checkpoint"))?;
        datasets.push(checkpoint);
    }
    // An empty dataset has no place.
    let starts = |datasets: &[hdf5::Dataset]| datasets.iter().map(|dataset| dataset.offset().unwrap_or(0)).collect();
    let starts = [starts(&datasets), starts(&arrays)];
    drop((datasets, arrays));
    // HDF5 gives back what room it has left over when it closes the file: from then on its structure stays.
    file.close().map_err(FileError::hdf5(path, "write the file"))?;
    Ok(starts)
}

/// Room for rows. Where no row has been written, the time of an unfinished file is NaN: it is the first history, and says
/// which rows there are. The others are left as the operating system makes a longer file, zeros that nobody has to write.
fn create_history<R>(
    path: &Path,
    file: &hdf5::File,
    column: &Column<R>,
    metadata: &Metadata,
    room: Room,
    is_time: bool,
) -> Result<hdf5::Dataset, FileError> {
    let name = column.path;
    let shape: Vec<usize> = std::iter::once(room.rows).chain(column.row_shape(metadata)).collect();
    let builder = file
        .new_dataset::<f64>()
        .layout(Layout::Contiguous)
        .alloc_time(Some(AllocTime::Early))
        .fill_time(if is_time && room.checkpoint_words.is_some() { FillTime::Alloc } else { FillTime::Never })
        .fill_value(f64::NAN)
        .obj_track_times(false);
    let dataset = builder.shape(shape).create(name).map_err(FileError::hdf5(path, format!("make room for {name}")))?;
    describe(path, &dataset, &column.unit(&metadata.units), column.frame, column.description)?;
    Ok(dataset)
}

/// Room for one of the arrays of the shapes.
fn create_array(
    path: &Path,
    file: &hdf5::File,
    StoredArray { shape, .. }: &StoredArray,
    ShapeDataset { path: name, is_whole, unit, frame, description }: &ShapeDataset,
    units: &Units,
) -> Result<hdf5::Dataset, FileError> {
    let builder = if *is_whole { file.new_dataset::<u32>() } else { file.new_dataset::<f64>() };
    let builder = builder.layout(Layout::Contiguous).alloc_time(Some(AllocTime::Early)).fill_time(FillTime::Never);
    let dataset = builder.obj_track_times(false).shape(shape.as_slice()).create(*name);
    let dataset = dataset.map_err(FileError::hdf5(path, format!("make room for {name}")))?;
    describe(path, &dataset, &units.in_labels(unit), frame, description)?;
    Ok(dataset)
}

/// The effects of the motion, a list for each of their texts.
fn write_effects(path: &Path, file: &hdf5::File, metadata: &Metadata) -> Result<(), FileError> {
    let effects = || metadata.effects.iter();
    write_texts(path, file, "effects/name", effects().map(|effect| &*effect.name), "name of each effect")?;
    let states = effects().map(|effect| &*effect.state);
    write_texts(path, file, "effects/state", states, "on or off in the run; – of one that cannot act")?;
    let measures = effects().map(|effect| &*effect.measure);
    write_texts(path, file, "effects/measure", measures, "size of each effect, a formula and its value")?;
    let reasons = effects().map(|effect| &*effect.reason);
    write_texts(path, file, "effects/reason", reasons, "reason of each state")
}

/// Names and places of the points.
fn write_points(path: &Path, file: &hdf5::File, metadata: &Metadata) -> Result<(), FileError> {
    let names = metadata.point_names.iter().map(String::as_str);
    write_texts(path, file, "points/names", names, "names of the points, in the order of the other data sets")?;
    let positions = ArrayView2::from(metadata.point_positions.as_slice());
    let description = "position of the point in the undeformed body";
    write_constant(path, file, "points/position", positions.into_dyn(), [&metadata.units.length, "mesh", description])
}

fn write_root_attributes(path: &Path, file: &hdf5::File, metadata: &Metadata, complete: bool) -> Result<(), FileError> {
    let texts = [
        ("title", &metadata.title),
        ("format_version", &seal::VERSION.to_owned()),
        ("scene", &metadata.scene_text),
        ("scene_file", &metadata.scene_file),
        ("formulation", &metadata.formulation),
        ("scheme", &metadata.scheme),
        ("program_version", &metadata.program_version),
        ("units_length", &metadata.units.length),
        ("units_mass", &metadata.units.mass),
        ("units_time", &metadata.units.time),
    ];
    for (name, text) in texts {
        write_text(path, file, name, text)?;
    }
    if let Some(refusal) = &metadata.refusal {
        write_text(path, file, "refusal", refusal)?;
    }
    for (name, number) in [("step", metadata.step), ("tolerance", metadata.tolerance), ("end", Some(metadata.end))] {
        let Some(number) = number else { continue };
        file.new_attr::<f64>()
            .create(name)
            .and_then(|attribute| attribute.write_scalar(&number))
            .map_err(FileError::hdf5(path, format!("write the attribute {name}")))?;
    }
    file.new_attr::<i64>()
        .create("complete")
        .and_then(|attribute| attribute.write_scalar(&i64::from(complete)))
        .map_err(FileError::hdf5(path, "write the attribute complete"))
}

fn write_body(path: &Path, file: &hdf5::File, metadata: &Metadata) -> Result<(), FileError> {
    let body = &metadata.body;
    let Units { length, mass, time } = &metadata.units;
    let frequency_unit = if time == "s" { "Hz".into() } else { format!("1/{time}") };
    let inertia_unit = format!("{mass} {length}^2");
    let inertia = ArrayView2::from(&body.inertia);
    let [rotation_axes, translation_axes] =
        [&body.rotation_axes, &body.translation_axes].map(|axes| ArrayView2::from(axes.as_slice()).into_dyn());
    for (name, values, unit, frame, description) in [
        ("mass", aview0(&body.mass).into_dyn(), mass.as_str(), "none", "total mass"),
        ("center_of_mass", aview1(&body.center_of_mass).into_dyn(), length, "mesh", "centre of mass"),
        ("inertia", inertia.into_dyn(), &inertia_unit, "body", "undeformed inertia about the centre of mass"),
        (
            "origin",
            aview1(&body.origin).into_dyn(),
            length,
            "mesh",
            "origin of the body frame in the undeformed body: the centre of mass of a free body, else a point that is held",
        ),
        (
            "frequencies",
            aview1(&body.frequencies).into_dyn(),
            &frequency_unit,
            "none",
            "natural frequencies of the flexible modes; of a static shape (see kinds) no natural frequency",
        ),
        (
            "damping_ratios",
            aview1(&body.damping_ratios).into_dyn(),
            "1",
            "none",
            "damping ratios of the flexible modes and static shapes",
        ),
        (
            "rotation_axes",
            rotation_axes,
            "1",
            "body",
            "unit vectors about which the support lets the body turn: three of a free body or a pin, one of a hinge, none",
        ),
        (
            "translation_axes",
            translation_axes,
            "1",
            "body",
            "unit vectors along which the support lets the origin move: three of a free body, one of a slider, none",
        ),
    ] {
        write_constant(path, file, &format!("body/{name}"), values, [unit, frame, description])?;
    }
    write_texts(
        path,
        file,
        "body/kinds",
        body.kinds(),
        "whether each coordinate is of a natural mode or a static shape",
    )?;
    match &body.mesh {
        Some(mesh) => write_mesh(path, file, mesh, length),
        None => Ok(()),
    }
}

/// Size of the finite-element model, and where all of it is.
fn write_mesh(path: &Path, file: &hdf5::File, mesh: &MeshProperties, length: &str) -> Result<(), FileError> {
    let MeshProperties { nodes, elements, size, body_file, shapes_hash } = mesh;
    let size = aview1(size).into_dyn();
    write_constant(path, file, "body/mesh/size", size, [length, "mesh", "extent of the whole mesh along its axes"])?;
    let group = file.group("body").map_err(FileError::hdf5(path, "write body"))?;
    for (name, count) in [("mesh_nodes", nodes), ("mesh_elements", elements)] {
        group
            .new_attr::<i64>()
            .create(name)
            .and_then(|attribute| attribute.write_scalar(&(*count as i64)))
            .map_err(FileError::hdf5(path, format!("write the attribute {name}")))?;
    }
    write_text(path, &group, "body_file", body_file)?;
    write_text(path, &group, "shapes_hash", shapes_hash)
}

/// A data set of numbers, with its unit, frame and description.
fn write_constant(
    path: &Path,
    file: &hdf5::File,
    name: &str,
    values: ArrayViewD<'_, f64>,
    [unit, frame, description]: [&str; 3],
) -> Result<(), FileError> {
    let dataset = file
        .new_dataset_builder()
        .with_data(values)
        .obj_track_times(false)
        .create(name)
        .map_err(FileError::hdf5(path, format!("write {name}")))?;
    describe(path, &dataset, unit, frame, description)
}

/// A data set of texts.
fn write_texts<'a>(
    path: &Path,
    file: &hdf5::File,
    name: &str,
    texts: impl Iterator<Item = &'a str>,
    description: &str,
) -> Result<(), FileError> {
    let texts: Vec<VarLenUnicode> = texts
        .map(str::parse)
        .collect::<Result<_, _>>()
        .map_err(|_| FileError::NulInText { path: path.to_path_buf(), attribute: name.into() })?;
    let dataset = file
        .new_dataset_builder()
        .with_data(&texts)
        .obj_track_times(false)
        .create(name)
        .map_err(FileError::hdf5(path, format!("write {name}")))?;
    describe(path, &dataset, "1", "none", description)
}

fn describe(path: &Path, dataset: &hdf5::Dataset, unit: &str, frame: &str, description: &str) -> Result<(), FileError> {
    write_text(path, dataset, "unit", unit)?;
    write_text(path, dataset, "frame", frame)?;
    write_text(path, dataset, "description", description)
}

/// A variable-length UTF-8 string, which h5py reads as `str`.
fn write_text(path: &Path, owner: &hdf5::Location, name: &str, text: &str) -> Result<(), FileError> {
    let value: VarLenUnicode =
        text.parse().map_err(|_| FileError::NulInText { path: path.to_path_buf(), attribute: name.into() })?;
    owner
        .new_attr::<VarLenUnicode>()
        .create(name)
        .and_then(|attribute| attribute.write_scalar(&value))
        .map_err(FileError::hdf5(path, format!("write the attribute {name}")))
}
