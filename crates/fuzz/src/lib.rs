//! Small results files for the target `results`.

use std::path::Path;

use results::Values::{Modal, Number, Points, Quaternion, Vector};
use results::{BodyProperties, Column, Expected, FileError, Metadata, Units, Writer};

/// A row.
#[derive(Debug)]
pub struct Row {
    modes: Vec<f64>,
    points: usize,
}

/// A column of each kind.
pub static COLUMNS: [Column<Row>; 5] = [
    Column::new("time", "time", "none", "time of each row", Number(|_| 0.5)),
    Column::new("attitude", "1", "none", "a quaternion", Quaternion(|_| [1.0, 0.0, 0.0, 0.0])),
    Column::new("velocity", "length/time", "global", "a vector", Vector(|_| [1.0; 3])),
    Column::new("modal/velocity", "1", "none", "modal coordinates", Modal(|row| &row.modes)),
    Column::new(
        "points/velocity",
        "length/time",
        "global",
        "a vector of each point",
        Points(|row, i| (i < row.points).then_some([2.0; 3])),
    ),
];

/// Writes a file of so many modes, points and rows, finished or not.
pub fn write_results(path: &Path, modes: usize, points: usize, rows: u32, finish: bool) -> Result<(), FileError> {
    let metadata = Metadata {
        title: "a seed".into(),
        units: Units { length: "m".into(), mass: "kg".into(), time: "s".into() },
        formulation: "conservative".into(),
        scheme: "exponential".into(),
        step: Some(1e-3),
        tolerance: None,
        program_version: "0".into(),
        end: 1.0,
        scene_text: "title = \"a seed\"".into(),
        scene_file: "fuzz.toml".into(),
        input_files: Vec::new(),
        body: BodyProperties {
            mass: 1.0,
            center_of_mass: [0.0; 3],
            inertia: [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
            frequencies: vec![1.0; modes],
            damping_ratios: vec![0.0; modes],
            origin: [0.0; 3],
            static_shapes: 0,
            rotation_axes: Vec::new(),
            translation_axes: Vec::new(),
            mesh: None,
        },
        point_names: (0..points).map(|i| format!("P{i}")).collect(),
        point_positions: vec![[0.0; 3]; points],
        parts: Vec::new(),
        support_names: Vec::new(),
        effects: Vec::new(),
        refusal: None,
        warnings: Vec::new(),
    };
    let mut writer = Writer::create(path, &metadata, None, &COLUMNS, Expected { overwrite: true, ..Expected::default() })?;
    let row = Row { modes: vec![0.5; modes], points };
    (0..rows).try_for_each(|_| writer.push(&row))?;
    if finish { writer.finish() } else { Ok(()) }
}
