//! Small results files for the target `results`.

use std::path::Path;

use results::Quantity::{Number, Quaternion, Vector};
use results::{
    BodyMetadata, BodyProperties, Column, Dimension, Expected, FileError, Metadata, Quantities, SystemRow, Units,
    Writer,
};

/// A row.
#[derive(Debug)]
pub struct SampleRow {
    bodies: Vec<SampleBody>,
}

/// A body in a row.
#[derive(Debug)]
pub struct SampleBody {
    modes: Vec<f64>,
    points: usize,
}

impl SystemRow for SampleRow {
    type Body = SampleBody;

    fn time(&self) -> f64 {
        0.5
    }

    fn bodies(&self) -> &[SampleBody] {
        &self.bodies
    }

    type Joint = ();

    fn joints(&self) -> &[()] {
        &[]
    }
}

const VELOCITY: (Dimension, &str) = (Dimension::Velocity, "global");

/// A column of each kind.
pub static COLUMNS: [Column<SampleRow>; 5] = [
    Column::of_system(["", "number"], VELOCITY, "a number", Number(|_| 0.25)),
    Column::of_body(["", "attitude"], VELOCITY, "a quaternion", Quaternion(|_| [1.0, 0.0, 0.0, 0.0])),
    Column::of_body(["", "velocity"], VELOCITY, "a vector", Vector(|_| [1.0; 3])),
    Column::of_modes("velocity", VELOCITY.0, "modal coordinates", |body: &SampleBody| &body.modes),
    Column::of_points(
        "velocity",
        VELOCITY,
        "a vector of each point",
        Quantities::Vectors(|body: &SampleBody, i| (i < body.points).then_some([2.0; 3])),
    ),
];

/// Writes a file of bodies, modes, points and rows of these numbers, finished or not.
pub fn write_results(
    path: &Path,
    bodies: usize,
    [modes, points]: [usize; 2],
    rows: u32,
    finish: bool,
) -> Result<(), FileError> {
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
        bodies: (0..bodies).map(|i| body(format!("B{i}"), modes, points)).collect(),
        joints: Vec::new(),
        warnings: Vec::new(),
        trust: Vec::new(),
    };
    let mut writer =
        Writer::create(path, &metadata, &[], &COLUMNS, Expected { overwrite: true, ..Expected::default() })?;
    let row = SampleRow { bodies: (0..bodies).map(|_| SampleBody { modes: vec![0.5; modes], points }).collect() };
    (0..rows).try_for_each(|_| writer.push(&row))?;
    if finish { writer.finish() } else { Ok(()) }
}

fn body(name: String, modes: usize, points: usize) -> BodyMetadata {
    BodyMetadata {
        name,
        model: BodyProperties {
            mass: 1.0,
            center_of_mass: [0.0; 3],
            inertia: [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
            frequencies: vec![1.0; modes],
            damping_ratios: vec![0.0; modes],
            origin: [0.0; 3],
            static_shapes: 0,
            kinds: Vec::new(),
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
    }
}
