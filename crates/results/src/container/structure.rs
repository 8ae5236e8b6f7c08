//! The HDF5 structure of a results file, laid out as its columns say.
//!
//! HDF5 only makes files here. It opens none that was there before ([`sealed`]).

use crate::column::SystemRow;
use crate::history::{History, histories};
use crate::metadata::{BODIES, JOINTS};
use crate::{
    BodyMetadata, BodyProperties, Column, FileError, JointMetadata, MeshProperties, Metadata, TrustLine, Units,
};
use hdf5::Group;
use hdf5::types::VarLenUnicode;
use ndarray::{ArrayView2, ArrayViewD, aview0, aview1};
use sealed::{Declared, Format, Kind, SealedError};
use std::path::Path;

/// The datasets of the times and the histories, with room for `rows` rows.
pub(crate) fn declared<R: SystemRow>(columns: &'static [Column<R>], metadata: &Metadata, rows: usize) -> Vec<Declared> {
    let times = Declared::new("time", Kind::F64, &[rows], [&metadata.units.time, "none", "time of each row"]);
    let of_history = |history: History<R>| {
        let Column { frame, description, .. } = history.column;
        let shape: Vec<usize> = std::iter::once(rows).chain(history.row_shape(metadata)).collect();
        let unit = history.column.unit(&metadata.units);
        Declared::new(history.path(metadata), Kind::F64, &shape, [&unit, frame, description])
    };
    std::iter::once(times).chain(histories(columns, metadata).map(of_history)).collect()
}

/// Writes what other programs read besides: texts and constants.
pub(crate) fn write(path: &Path, file: &hdf5::File, metadata: &Metadata, is_complete: bool) -> Result<(), FileError> {
    write_root_attributes(path, file, metadata, is_complete)?;
    let inputs = metadata.input_files.iter().map(String::as_str);
    write_texts(path, file, "input_files", inputs, "files that the run read, where they were")?;
    let warnings = metadata.warnings.iter().map(String::as_str);
    write_texts(path, file, "warnings", warnings, "what should be known of the run; empty in an unfinished file")?;
    if !metadata.trust.is_empty() {
        write_trust(path, file, &metadata.trust)?;
    }
    for body in &metadata.bodies {
        write_body(path, file, body, &metadata.units)?;
    }
    for joint in &metadata.joints {
        write_joint(path, file, joint)?;
    }
    if let Some(body) = metadata.only_body() {
        write_short_paths(file, body).map_err(SealedError::hdf5(path, "write the short paths"))?;
    }
    Ok(())
}

/// The trust card, a list for each of its parts.
fn write_trust(path: &Path, file: &hdf5::File, lines: &[TrustLine]) -> Result<(), FileError> {
    let group = file.create_group("trust").map_err(SealedError::hdf5(path, "write the trust card"))?;
    let each = |text: fn(&TrustLine) -> &str| lines.iter().map(text);
    write_texts(path, &group, "place", each(|line| &line.place), "places where the answer may be wrong, worst first")?;
    let body = each(|line| line.body.as_deref().unwrap_or_default());
    write_texts(path, &group, "body", body, "body that it is worst in, of several")?;
    let errors: Vec<f64> = lines.iter().map(|line| line.error.unwrap_or(f64::NAN)).collect();
    let described = ["1", "none", "the error, relative; NaN where it is not known"];
    write_constant(path, &group, "error", aview1(&errors).into_dyn(), described)?;
    write_texts(path, &group, "meaning", each(|line| &line.meaning), "meaning of the error")?;
    write_texts(path, &group, "known", each(|line| &line.known), "way in which it is known")?;
    write_texts(path, &group, "next", each(|line| &line.next), "means that would make it smaller, or known")
}

/// Links at the root to all that is of a single body, for scripts that know nothing of bodies. Its model is `body` there.
fn write_short_paths(file: &hdf5::File, body: &BodyMetadata) -> hdf5::Result<()> {
    for name in file.group(&format!("{BODIES}/{}", body.name))?.member_names()? {
        let short = if name == MODEL { "body" } else { &name };
        file.link_soft(&format!("/{}", body.path(&name)), short)?;
    }
    Ok(())
}

/// Group of what is known of a body without its motion.
const MODEL: &str = "model";

/// Everything of a body that does not change with time.
fn write_body(path: &Path, file: &hdf5::File, body: &BodyMetadata, units: &Units) -> Result<(), FileError> {
    let group = group_of(path, file, BODIES, &body.name)?;
    write_model(path, &group, &body.model, units)?;
    write_points(path, &group, body, units)?;
    if !body.support_names.is_empty() {
        let names = body.support_names.iter().map(String::as_str);
        let description = "names of the supports, in the order of the other data sets";
        write_texts(path, &group, "supports/names", names, description)?;
    }
    write_effects(path, &group, body)?;
    body.refusal.iter().try_for_each(|refusal| write_text(path, &group, "refusal", refusal))
}

/// The kind of a joint and what it joins.
fn write_joint(path: &Path, file: &hdf5::File, joint: &JointMetadata) -> Result<(), FileError> {
    let group = group_of(path, file, JOINTS, &joint.name)?;
    write_text(path, &group, "kind", &joint.kind)?;
    let [first, second] = &joint.between;
    write_text(path, &group, "first", first)?;
    write_text(path, &group, "second", second)
}

/// The group of a body or a joint, which is there where it has histories.
fn group_of(path: &Path, file: &hdf5::File, all: &str, name: &str) -> Result<Group, FileError> {
    let name = format!("{all}/{name}");
    let group = if file.link_exists(&name) { file.group(&name) } else { file.create_group(&name) };
    Ok(group.map_err(SealedError::hdf5(path, format!("write {name}")))?)
}

/// The effects of the motion, a list for each of their texts.
fn write_effects(path: &Path, group: &Group, body: &BodyMetadata) -> Result<(), FileError> {
    let effects = || body.effects.iter();
    write_texts(path, group, "effects/name", effects().map(|effect| &*effect.name), "name of each effect")?;
    let states = effects().map(|effect| &*effect.state);
    write_texts(path, group, "effects/state", states, "on or off in the run; – of one that cannot act")?;
    let measures = effects().map(|effect| &*effect.measure);
    write_texts(path, group, "effects/measure", measures, "size of each effect, a formula and its value")?;
    let reasons = effects().map(|effect| &*effect.reason);
    write_texts(path, group, "effects/reason", reasons, "reason of each state")
}

/// Names and places of the points.
fn write_points(path: &Path, group: &Group, body: &BodyMetadata, units: &Units) -> Result<(), FileError> {
    let names = body.point_names.iter().map(String::as_str);
    write_texts(path, group, "points/names", names, "names of the points, in the order of the other data sets")?;
    let positions = ArrayView2::from(body.point_positions.as_slice());
    let description = "position of the point in the undeformed body";
    write_constant(path, group, "points/position", positions.into_dyn(), [&units.length, "mesh", description])
}

fn write_root_attributes(path: &Path, file: &hdf5::File, metadata: &Metadata, complete: bool) -> Result<(), FileError> {
    let texts = [
        ("title", &metadata.title),
        ("format_version", &Format::RESULTS.version.to_string()),
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
    for (name, number) in [("step", metadata.step), ("tolerance", metadata.tolerance), ("end", Some(metadata.end))] {
        let Some(number) = number else { continue };
        file.new_attr::<f64>()
            .create(name)
            .and_then(|attribute| attribute.write_scalar(&number))
            .map_err(SealedError::hdf5(path, format!("write the attribute {name}")))?;
    }
    let written = file.new_attr::<i64>().create("complete");
    let written = written.and_then(|attribute| attribute.write_scalar(&i64::from(complete)));
    Ok(written.map_err(SealedError::hdf5(path, "write the attribute complete"))?)
}

/// Mass properties and modes.
fn write_model(path: &Path, group: &Group, body: &BodyProperties, units: &Units) -> Result<(), FileError> {
    let Units { length, mass, time } = units;
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
            "natural frequencies of the flexible modes; of other kinds (see kinds) no natural frequencies",
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
        write_constant(path, group, &format!("{MODEL}/{name}"), values, [unit, frame, description])?;
    }
    let description = "kind of each coordinate, such as natural mode or static shape";
    write_texts(path, group, "model/kinds", body.kinds(), description)?;
    match &body.mesh {
        Some(mesh) => write_mesh(path, group, mesh, length),
        None => Ok(()),
    }
}

/// Size of the finite-element model, and where all of it is.
fn write_mesh(path: &Path, group: &Group, mesh: &MeshProperties, length: &str) -> Result<(), FileError> {
    let MeshProperties { nodes, elements, size, body_file, shapes_hash } = mesh;
    let size = aview1(size).into_dyn();
    write_constant(path, group, "model/mesh/size", size, [length, "mesh", "extent of the whole mesh along its axes"])?;
    let group = group.group(MODEL).map_err(SealedError::hdf5(path, "write the model"))?;
    for (name, count) in [("mesh_nodes", nodes), ("mesh_elements", elements)] {
        group
            .new_attr::<i64>()
            .create(name)
            .and_then(|attribute| attribute.write_scalar(&(*count as i64)))
            .map_err(SealedError::hdf5(path, format!("write the attribute {name}")))?;
    }
    write_text(path, &group, "body_file", body_file)?;
    write_text(path, &group, "shapes_hash", shapes_hash)
}

/// A data set of numbers, with its unit, frame and description.
fn write_constant(
    path: &Path,
    group: &Group,
    name: &str,
    values: ArrayViewD<'_, f64>,
    [unit, frame, description]: [&str; 3],
) -> Result<(), FileError> {
    let dataset = group
        .new_dataset_builder()
        .with_data(values)
        .obj_track_times(false)
        .create(name)
        .map_err(SealedError::hdf5(path, format!("write {name}")))?;
    describe(path, &dataset, unit, frame, description)
}

/// A data set of texts.
fn write_texts<'a>(
    path: &Path,
    group: &Group,
    name: &str,
    texts: impl Iterator<Item = &'a str>,
    description: &str,
) -> Result<(), FileError> {
    let texts: Vec<VarLenUnicode> = texts
        .map(str::parse)
        .collect::<Result<_, _>>()
        .map_err(|_| FileError::NulInText { path: path.to_path_buf(), attribute: name.into() })?;
    let dataset = group
        .new_dataset_builder()
        .with_data(&texts)
        .obj_track_times(false)
        .create(name)
        .map_err(SealedError::hdf5(path, format!("write {name}")))?;
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
    let written = owner.new_attr::<VarLenUnicode>().create(name);
    let written = written.and_then(|attribute| attribute.write_scalar(&value));
    Ok(written.map_err(SealedError::hdf5(path, format!("write the attribute {name}")))?)
}
