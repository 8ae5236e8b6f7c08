//! Small results files for the target `results`.

use std::path::Path;

use results::{BodyProperties, Expected, FileError, Metadata, PointSample, Sample, Units, Writer};

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
        fingerprint: 0x89ab_cdef,
        scene_text: "title = \"a seed\"".into(),
        scene_file: "fuzz.toml".into(),
        body: BodyProperties {
            mass: 1.0,
            center_of_mass: [0.0; 3],
            inertia: [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
            frequencies: vec![1.0; modes],
            damping_ratios: vec![0.0; modes],
        },
        point_names: (0..points).map(|i| format!("P{i}")).collect(),
    };
    let mut writer = Writer::create(path, &metadata, Expected { overwrite: true, ..Expected::default() })?;
    let modal = vec![0.5; modes];
    let point = || PointSample {
        displacement: [1.0; 3],
        velocity: [2.0; 3],
        acceleration: [3.0; 3],
        rigid_acceleration: [4.0; 3],
    };
    let at_points: Vec<_> = (0..points).map(|_| point()).collect();
    for row in 0..rows {
        writer.push(&Sample {
            time: f64::from(row),
            attitude: [1.0, 0.0, 0.0, 0.0],
            position: [0.0; 3],
            velocity: [0.0; 3],
            angular_velocity: [0.0; 3],
            angular_acceleration: [0.0; 3],
            modal_displacement: &modal,
            modal_velocity: &modal,
            kinetic_energy: 0.0,
            strain_energy: 0.0,
            work: 0.0,
            dissipation: 0.0,
            energy_balance: 0.0,
            linear_momentum: [0.0; 3],
            angular_momentum: [0.0; 3],
            linear_balance: [0.0; 3],
            angular_balance: [0.0; 3],
            points: &at_points,
        })?;
    }
    if finish { writer.finish() } else { Ok(()) }
}
