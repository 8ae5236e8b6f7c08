//! Rows that the tests write, and that they find again.

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
        fingerprint: 0x89ab_cdef,
        scene_text: "title = \"ω₂\"\n".repeat(10_000), // more than an attribute of fixed length can hold
        scene_file: "platten/frei.toml".into(),
        body: BodyProperties {
            mass: 0.00935,
            center_of_mass: [0.1, -0.2, 0.3],
            inertia: [[5.5, 0.1, 0.2], [0.1, 2112.7, 0.3], [0.2, 0.3, 2117.8]],
            frequencies: (0..modes).map(|k| 24.5 + 60.0 * k as f64).collect(),
            damping_ratios: vec![0.05; modes],
        },
        point_names: point_names.iter().map(|name| name.to_string()).collect(),
    }
}

/// Distinct numbers for every row, so that nothing can be swapped unseen.
pub struct Row {
    pub time: f64,
    pub modal: [Vec<f64>; 2],
    pub points: Vec<PointSample>,
}

impl Row {
    pub fn new(i: usize, modes: usize, points: usize) -> Self {
        let time = i as f64 * 1e-4;
        let vector = |k: f64| [time + k, time - k, time * k];
        let point = |p: usize| {
            let p = 100.0 * p as f64;
            PointSample {
                displacement: vector(p + 10.0),
                velocity: vector(p + 11.0),
                acceleration: vector(p + 12.0),
                rigid_acceleration: vector(p + 13.0),
            }
        };
        Self {
            time,
            modal: [1.0, -3.0].map(|factor| (0..modes).map(|k| factor * (time + k as f64)).collect()),
            points: (0..points).map(point).collect(),
        }
    }

    pub fn sample(&self) -> Sample<'_> {
        let vector = |k: f64| [self.time + k, self.time - k, self.time * k];
        Sample {
            time: self.time,
            attitude: [self.time, 0.1, 0.2, 0.3],
            position: vector(1.0),
            velocity: vector(2.0),
            angular_velocity: vector(3.0),
            angular_acceleration: vector(4.0),
            modal_displacement: &self.modal[0],
            modal_velocity: &self.modal[1],
            kinetic_energy: self.time + 5.0,
            strain_energy: self.time + 6.0,
            work: self.time + 14.0,
            dissipation: self.time + 15.0,
            energy_balance: self.time + 16.0,
            linear_momentum: vector(7.0),
            angular_momentum: vector(8.0),
            linear_balance: vector(17.0),
            angular_balance: vector(18.0),
            points: &self.points,
        }
    }
}

/// The first `rows` rows are those of [`Row::new`], in every column.
pub fn assert_rows(results: &Results, rows: usize) {
    let names = results.metadata.point_names.clone();
    assert_eq!(results.time.len(), rows);
    for i in 0..rows {
        let row = Row::new(i, results.modal_displacement.width(), names.len());
        let mut points = Vec::new();
        let found = results.sample(i, &mut points).unwrap();
        assert_eq!(found, row.sample());
    }
}

pub fn folder() -> (tempfile::TempDir, PathBuf) {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("run.h5");
    (folder, path)
}
