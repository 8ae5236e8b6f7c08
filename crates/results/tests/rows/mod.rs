//! Rows that the tests write, and that they find again.

use results::Values::{Modal, Number, Points, Quaternion, Vector};
use results::*;
use std::path::PathBuf;

pub fn metadata(modes: usize, point_names: &[&str]) -> Metadata {
    Metadata {
        title: "Freie Platte, 50 N ½-sine".into(),
        units: Units { length: "mm".into(), mass: "Mg".into(), time: "s".into() },
        formulation: "conservative".into(),
        scheme: "exponential".into(),
        step: Some(1e-4),
        tolerance: None,
        program_version: "0.1.0".into(),
        end: 0.5,
        scene_text: "title = \"ω₂\"\n".repeat(10_000), // more than an attribute of fixed length can hold
        scene_file: "platten/frei.toml".into(),
        input_files: vec!["platten/frei.toml".into(), "netz ω.msh".into()],
        body: BodyProperties {
            mass: 0.00935,
            center_of_mass: [0.1, -0.2, 0.3],
            inertia: [[5.5, 0.1, 0.2], [0.1, 2112.7, 0.3], [0.2, 0.3, 2117.8]],
            origin: [0.1, -0.2, 0.3],
            frequencies: (0..modes).map(|k| 24.5 + 60.0 * k as f64).collect(),
            damping_ratios: vec![0.05; modes],
            static_shapes: modes / 2,
            rotation_axes: vec![[0.0, 0.0, 1.0]],
            translation_axes: Vec::new(),
            mesh: Some(MeshProperties {
                nodes: 393,
                elements: 40,
                size: [1000.0, 50.0, 10.0],
                body_file: "frei.body.h5".into(),
                shapes_hash: "0123".into(),
            }),
        },
        point_names: point_names.iter().map(|name| name.to_string()).collect(),
        point_positions: (0..point_names.len()).map(|p| [p as f64, 2.0, -3.0]).collect(),
        parts: Vec::new(),
        support_names: Vec::new(),
        effects: vec![EffectProperties {
            name: "coriolis".into(),
            state: "off".into(),
            measure: "2 ω/ω₁ = 1e-5".into(),
            reason: "It is slow.".into(),
        }],
        refusal: None,
        warnings: Vec::new(),
    }
}

/// Three nodes on one face, with the shapes of so many coordinates; one of them is large and has a shape that follows.
pub fn shapes(modes: usize) -> Shapes {
    let value = |i: usize, k: usize| (i + 10 * k) as f64 - 0.125;
    Shapes {
        nodes: vec![0, 7, 3],
        positions: vec![[0.0; 3], [1.0, 0.5, 0.0], [0.0, 2.0, -3.0]],
        faces: vec![[0, 1, 2, 2, 1, 0]],
        displacements: (0..=modes).map(|k| (0..3).map(|i| [value(i, k), -1.0, 0.5]).collect()).collect(),
        pairs: vec![[0, 0]],
        products: vec![(0..=modes).map(|k| value(5, k)).collect()],
        stress: Some(StressShapes {
            nodes: vec![0, 1, 1, 2],
            shapes: (0..modes + 2).map(|k| (0..4).map(|i| [value(i, k); 6]).collect()).collect(),
        }),
    }
}

pub type Writer = results::Writer<Row>;
pub type Resumed = results::Resumed<Row>;

/// The widths are known to `sealed`, too. The last column is in the file of a run with a hinge only.
pub static COLUMNS: [Column<Row>; 22] = [
    column("time", Number(|row| row.time)),
    column("attitude", Quaternion(|row| [row.time, 0.1, 0.2, 0.3])),
    column("position", Vector(|row| row.vector(1.0))),
    column("velocity", Vector(|row| row.vector(2.0))),
    column("angular_velocity", Vector(|row| row.vector(3.0))),
    column("angular_acceleration", Vector(|row| row.vector(4.0))),
    column("modal/displacement", Modal(|row| &row.modal[0])),
    column("modal/velocity", Modal(|row| &row.modal[1])),
    column("energy/kinetic", Number(|row| row.time + 5.0)),
    column("energy/strain", Number(|row| row.time + 6.0)),
    column("energy/work", Number(|row| row.time + 14.0)),
    column("energy/dissipation", Number(|row| row.time + 15.0)),
    column("energy/balance", Number(|row| row.time + 16.0)),
    column("momentum/linear", Vector(|row| row.vector(7.0))),
    column("momentum/angular", Vector(|row| row.vector(8.0))),
    column("momentum/linear_balance", Vector(|row| row.vector(17.0))),
    column("momentum/angular_balance", Vector(|row| row.vector(18.0))),
    column("points/displacement", Points(|row, i| Some(row.points.get(i)?[0]))),
    column("points/velocity", Points(|row, i| Some(row.points.get(i)?[1]))),
    column("points/acceleration", Points(|row, i| Some(row.points.get(i)?[2]))),
    column("points/rigid_acceleration", Points(|row, i| Some(row.points.get(i)?[3]))),
    column("hinge/angle", Number(|row| row.time + 19.0)).only_with("hinge"),
];

const fn column(path: &'static str, values: Values<Row>) -> Column<Row> {
    Column::new(path, "mass length^2/time^2", "none", "of a test", values)
}

/// Distinct numbers for every row, so that nothing can be swapped unseen.
#[derive(Debug)]
pub struct Row {
    pub time: f64,
    pub modal: [Vec<f64>; 2],
    /// The vectors of each point.
    pub points: Vec<[[f64; 3]; 4]>,
}

impl Row {
    pub fn new(i: usize, modes: usize, points: usize) -> Self {
        let time = i as f64 * 1e-4;
        let mut row = Self {
            time,
            modal: [1.0, -3.0].map(|factor| (0..modes).map(|k| factor * (time + k as f64)).collect()),
            points: Vec::new(),
        };
        row.points = (0..points).map(|p| [10.0, 11.0, 12.0, 13.0].map(|k| row.vector(100.0 * p as f64 + k))).collect();
        row
    }

    fn vector(&self, k: f64) -> [f64; 3] {
        [self.time + k, self.time - k, self.time * k]
    }
}

/// The first `rows` rows are those of [`Row::new`], in every column.
pub fn assert_rows(results: &Results, rows: usize) {
    assert_eq!(results.rows(), rows);
    let Metadata { body, point_names, .. } = &results.metadata;
    for i in 0..rows {
        let row = Row::new(i, body.frequencies.len(), point_names.len());
        assert!(results.is_row(i, &COLUMNS, &row), "row {i}");
        assert!(!results.is_row(i, &COLUMNS, &Row::new(i + 1, body.frequencies.len(), point_names.len())));
    }
}

pub fn folder() -> (tempfile::TempDir, PathBuf) {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("run.h5");
    (folder, path)
}
