//! Rows that the tests write, and that they find again.

use results::Quantity::{Number, Quaternion, Vector};
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
        bodies: vec![body("body", modes, point_names)],
        joints: Vec::new(),
        warnings: Vec::new(),
        trust: Vec::new(),
    }
}

pub fn body(name: &str, modes: usize, point_names: &[&str]) -> BodyMetadata {
    BodyMetadata {
        name: name.into(),
        model: BodyProperties {
            mass: 0.00935,
            center_of_mass: [0.1, -0.2, 0.3],
            inertia: [[5.5, 0.1, 0.2], [0.1, 2112.7, 0.3], [0.2, 0.3, 2117.8]],
            origin: [0.1, -0.2, 0.3],
            frequencies: (0..modes).map(|k| 24.5 + 60.0 * k as f64).collect(),
            damping_ratios: vec![0.05; modes],
            static_shapes: modes / 2,
            kinds: Vec::new(),
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
    }
}

/// Three nodes on one face, with the shapes of `modes` coordinates; one of them is large and has a shape that follows.
pub fn shapes(modes: usize) -> Shapes {
    let value = |i: usize, k: usize| (i + 10 * k) as f64 - 0.125;
    Shapes {
        nodes: vec![0, 7, 3],
        positions: vec![[0.0; 3], [1.0, 0.5, 0.0], [0.0, 2.0, -3.0]],
        faces: vec![[0, 1, 2, 2, 1, 0]],
        displacements: (0..=modes).map(|k| (0..3).map(|i| [value(i, k), -1.0, 0.5]).collect()).collect(),
        factors: vec![[0, 0, modes as u32]],
        products: vec![(0..=modes).map(|k| value(5, k)).collect()],
        stress: Some(StressShapes {
            nodes: vec![0, 1, 1, 2],
            shapes: (0..modes + 2).map(|k| (0..4).map(|i| [value(i, k); 6]).collect()).collect(),
        }),
    }
}

pub type Writer = results::Writer<Row>;
pub type Resumed = results::Resumed<Row>;

/// The last but one is of a body with a hinge only.
pub static COLUMNS: [Column<Row>; 24] = [
    Column::of_system(["energy", "kinetic"], KIND, "of a test", Number(|row: &Row| row.time + 20.0)),
    of_body("", "attitude", Quaternion(|row| [row.time, 0.1, 0.2, 0.3])),
    of_body("", "position", Vector(|row| row.vector(1.0))),
    of_body("", "velocity", Vector(|row| row.vector(2.0))),
    of_body("", "angular_velocity", Vector(|row| row.vector(3.0))),
    of_body("", "angular_acceleration", Vector(|row| row.vector(4.0))),
    Column::of_modes("displacement", KIND.0, "of a test", |row: &Body| &row.modal[0]),
    Column::of_modes("velocity", KIND.0, "of a test", |row: &Body| &row.modal[1]),
    of_body("energy", "kinetic", Number(|row| row.time + 5.0)),
    of_body("energy", "strain", Number(|row| row.time + 6.0)),
    of_body("energy", "work", Number(|row| row.time + 14.0)),
    of_body("energy", "dissipation", Number(|row| row.time + 15.0)),
    of_body("energy", "balance", Number(|row| row.time + 16.0)),
    of_body("momentum", "linear", Vector(|row| row.vector(7.0))),
    of_body("momentum", "angular", Vector(|row| row.vector(8.0))),
    of_body("momentum", "linear_balance", Vector(|row| row.vector(17.0))),
    of_body("momentum", "angular_balance", Vector(|row| row.vector(18.0))),
    of_points("displacement", |row, i| Some(row.points.get(i)?[0])),
    of_points("velocity", |row, i| Some(row.points.get(i)?[1])),
    of_points("acceleration", |row, i| Some(row.points.get(i)?[2])),
    of_points("rigid_acceleration", |row, i| Some(row.points.get(i)?[3])),
    of_body("hinge", "angle", Number(|row| row.time + 19.0)).only_with("hinge"),
    Column::of_joint(["", "angle"], KIND, "of a test", Number(|joint: &f64| *joint)).only_with("turns"),
    Column::of_joint(["", "moment"], KIND, "of a test", Number(|joint: &f64| *joint)).only_without("turns"),
];

const KIND: (Dimension, &str) = (Dimension::Energy, "none");

const fn of_body(group: &'static str, name: &'static str, values: Quantity<Body>) -> Column<Row> {
    Column::of_body([group, name], KIND, "of a test", values)
}

const fn of_points(name: &'static str, values: fn(&Body, usize) -> Option<[f64; 3]>) -> Column<Row> {
    Column::of_points(name, KIND, "of a test", Quantities::Vectors(values))
}

/// Distinct numbers for every row, so that nothing can be swapped unseen.
#[derive(Debug)]
pub struct Row {
    pub time: f64,
    pub bodies: Vec<Body>,
    /// The angle of each joint.
    pub joints: Vec<f64>,
}

#[derive(Debug)]
pub struct Body {
    time: f64,
    pub modal: [Vec<f64>; 2],
    /// The vectors of each point.
    pub points: Vec<[[f64; 3]; 4]>,
}

impl SystemRow for Row {
    type Body = Body;

    fn time(&self) -> f64 {
        self.time
    }

    fn bodies(&self) -> &[Body] {
        &self.bodies
    }

    type Joint = f64;

    fn joints(&self) -> &[f64] {
        &self.joints
    }
}

impl Row {
    pub fn new(i: usize, modes: usize, points: usize) -> Self {
        Self::of_bodies(i, &[(modes, points)])
    }

    /// A row of bodies with these numbers of modes and points.
    pub fn of_bodies(i: usize, bodies: &[(usize, usize)]) -> Self {
        let time = i as f64 * 1e-4;
        let body =
            |(b, (modes, points)): (usize, &(usize, usize))| Body::new(time + 1000.0 * b as f64, *modes, *points);
        Self { time, bodies: bodies.iter().enumerate().map(body).collect(), joints: Vec::new() }
    }
}

impl Body {
    fn new(time: f64, modes: usize, points: usize) -> Self {
        let mut body = Self {
            time,
            modal: [1.0, -3.0].map(|factor| (0..modes).map(|k| factor * (time + k as f64)).collect()),
            points: Vec::new(),
        };
        let vectors = |p: usize| [10.0, 11.0, 12.0, 13.0].map(|k| body.vector(100.0 * p as f64 + k));
        body.points = (0..points).map(vectors).collect();
        body
    }

    fn vector(&self, k: f64) -> [f64; 3] {
        [self.time + k, self.time - k, self.time * k]
    }
}

/// The first `rows` rows are those of [`Row::of_bodies`], in every column.
pub fn assert_rows(results: &Results, rows: usize) {
    assert_eq!(results.rows(), rows);
    let sizes = |body: &BodyMetadata| (body.model.frequencies.len(), body.point_names.len());
    let bodies: Vec<_> = results.metadata.bodies.iter().map(sizes).collect();
    for i in 0..rows {
        assert!(results.is_row(i, &COLUMNS, &Row::of_bodies(i, &bodies)), "row {i}");
        assert!(!results.is_row(i, &COLUMNS, &Row::of_bodies(i + 1, &bodies)));
    }
}

pub fn folder() -> (tempfile::TempDir, PathBuf) {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("run.h5");
    (folder, path)
}
