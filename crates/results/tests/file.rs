//! Writing results, reading them back, and what survives when a run does not reach its end.

use hdf5::types::{FloatSize, IntSize, TypeDescriptor, VarLenUnicode};
use results::*;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::time::Duration;

fn metadata(modes: usize, point_names: &[&str]) -> Metadata {
    Metadata {
        title: "Freie Platte, 50 N ½-sine".into(),
        units: Units { length: "mm".into(), mass: "Mg".into(), time: "s".into() },
        scheme: "paper".into(),
        step: 1e-4,
        program_version: "0.1.0".into(),
        scene_text: "title = \"ω₂\"\n".repeat(10_000), // more than an attribute of fixed length can hold
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
struct Row {
    time: f64,
    modal: [Vec<f64>; 2],
    points: Vec<PointSample>,
}

impl Row {
    fn new(i: usize, modes: usize, points: usize) -> Self {
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

    fn sample(&self) -> Sample<'_> {
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
            linear_momentum: vector(7.0),
            angular_momentum: vector(8.0),
            points: &self.points,
        }
    }
}

fn write(path: &Path, rows: usize, metadata: &Metadata) -> Writer {
    let mut writer = Writer::create(path, metadata).unwrap();
    for i in 0..rows {
        writer.push(&Row::new(i, metadata.body.frequencies.len(), metadata.point_names.len()).sample()).unwrap();
    }
    writer
}

/// The first `rows` rows are those that [`write`] wrote, in every column.
fn assert_rows(results: &Results, rows: usize) {
    let names = results.metadata.point_names.clone();
    assert_eq!(results.time.len(), rows);
    for i in 0..rows {
        let row = Row::new(i, results.modal_displacement.width(), names.len());
        let found_points: Vec<_> = names
            .iter()
            .map(|name| &results.points[name])
            .map(|point| PointSample {
                displacement: point.displacement[i],
                velocity: point.velocity[i],
                acceleration: point.acceleration[i],
                rigid_acceleration: point.rigid_acceleration[i],
            })
            .collect();
        let found = Sample {
            time: results.time[i],
            attitude: results.attitude[i],
            position: results.position[i],
            velocity: results.velocity[i],
            angular_velocity: results.angular_velocity[i],
            angular_acceleration: results.angular_acceleration[i],
            modal_displacement: results.modal_displacement.row(i).unwrap(),
            modal_velocity: results.modal_velocity.row(i).unwrap(),
            kinetic_energy: results.kinetic_energy[i],
            strain_energy: results.strain_energy[i],
            linear_momentum: results.linear_momentum[i],
            angular_momentum: results.angular_momentum[i],
            points: &found_points,
        };
        assert_eq!(found, row.sample());
    }
}

fn folder() -> (tempfile::TempDir, PathBuf) {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("run.h5");
    (folder, path)
}

#[test]
fn what_is_written_is_read_bit_for_bit() {
    let (_folder, path) = folder();
    // Counts around the size of a chunk; names in no alphabetical order.
    for rows in [0, 1, 511, 512, 513, 1300] {
        let metadata = metadata(3, &["P10", "P2", "corner at -x"]);
        write(&path, rows, &metadata).finish().unwrap();
        let results = Results::open(&path).unwrap();
        assert_eq!(results.metadata, metadata);
        assert!(results.complete);
        assert_rows(&results, rows);
    }
    let results = Results::open(&path).unwrap();
    let column: Vec<f64> = results.modal_velocity.column(2).unwrap().collect();
    assert_eq!((column.len(), column[7]), (1300, -3.0 * (7.0 * 1e-4 + 2.0)));
    assert!(results.modal_velocity.column(3).is_none() && results.modal_velocity.row(1300).is_none());
}

#[test]
fn a_rigid_body_without_points_is_a_file_too() {
    let (_folder, path) = folder();
    for rows in [0, 600] {
        write(&path, rows, &metadata(0, &[])).finish().unwrap();
        let results = Results::open(&path).unwrap();
        assert_rows(&results, rows);
        assert_eq!((results.modal_displacement.width(), results.points.len()), (0, 0));
        assert_eq!(results.modal_displacement.rows(), rows);
    }
}

#[test]
fn a_dropped_writer_leaves_its_rows_and_no_mark_of_completeness() {
    let (_folder, path) = folder();
    drop(write(&path, 700, &metadata(2, &["P1"])));
    let results = Results::open(&path).unwrap();
    assert!(!results.complete);
    assert_rows(&results, 700);
}

/// Not a test of its own: the process that [`a_killed_run_can_be_read_up_to_its_last_flush`] kills.
#[test]
#[ignore = "run by another test"]
fn child_that_is_killed() {
    let Some(path) = std::env::var_os("RESULTS_TEST_CHILD") else { return };
    let mut writer = write(Path::new(&path), 700, &metadata(2, &["P1"]));
    std::thread::sleep(Duration::from_millis(1100));
    // This row is late enough for a flush, the next hundred are not.
    for i in 700..801 {
        writer.push(&Row::new(i, 2, 1).sample()).unwrap();
    }
    std::process::abort();
}

#[test]
fn a_killed_run_can_be_read_up_to_its_last_flush() {
    let (_folder, path) = folder();
    let status = Command::new(std::env::current_exe().unwrap())
        .args(["--exact", "child_that_is_killed", "--ignored"])
        .env("RESULTS_TEST_CHILD", &path)
        .output()
        .unwrap()
        .status;
    assert!(!status.success(), "the child was to abort");
    let results = Results::open(&path).unwrap();
    assert!(!results.complete);
    assert!(results.time.len() >= 701, "{}", results.time.len());
    assert_rows(&results, results.time.len());
}

#[test]
fn a_sample_that_is_not_finite_is_refused_and_those_before_it_stay() {
    let (_folder, path) = folder();
    let metadata = metadata(2, &["P1"]);
    let mut writer = write(&path, 20, &metadata);
    let mut row = Row::new(20, 2, 1);
    row.points[0].acceleration[1] = f64::NAN;
    match writer.push(&row.sample()) {
        Err(FileError::NotFinite { time, quantity, .. }) => {
            assert_eq!((time, quantity.as_str()), (row.time, "points/P1/acceleration"));
        }
        other => panic!("{other:?}"),
    }
    let mut row = Row::new(20, 2, 1);
    row.modal[1][1] = f64::INFINITY;
    let error = writer.push(&row.sample()).unwrap_err().to_string();
    assert!(error.contains("modal/velocity is inf at time 0.002") && error.contains("smaller step"), "{error}");
    writer.finish().unwrap();
    assert_rows(&Results::open(&path).unwrap(), 20);
}

#[test]
fn wrong_lengths_and_names_are_refused() {
    let (_folder, path) = folder();
    let mut writer = write(&path, 2, &metadata(2, &["P1"]));
    for (modes, points, name, expected, found) in
        [(3, 1, "modal/displacement", 2, 3), (2, 0, "points", 1, 0), (0, 1, "modal/displacement", 2, 0)]
    {
        match writer.push(&Row::new(2, modes, points).sample()) {
            Err(FileError::WrongLength { quantity, expected: e, found: f, .. }) => {
                assert_eq!((quantity.as_str(), e, f), (name, expected, found));
            }
            other => panic!("{other:?}"),
        }
    }
    writer.finish().unwrap();
    assert_rows(&Results::open(&path).unwrap(), 2);

    for names in [[""].as_slice(), &["."], &[".."], &["a/b"], &["a\0"], &["a", "a"]] {
        let error = Writer::create(&path, &metadata(1, names)).unwrap_err();
        assert!(matches!(error, FileError::PointName { .. }), "{names:?}: {error}");
    }
    let mut unequal = metadata(2, &[]);
    unequal.body.damping_ratios.pop();
    assert!(matches!(Writer::create(&path, &unequal), Err(FileError::WrongLength { expected: 2, found: 1, .. })));
    let mut nul = metadata(2, &[]);
    nul.scene_text = "a\0b".into();
    assert!(matches!(Writer::create(&path, &nul), Err(FileError::NulInText { .. })));
}

#[test]
fn errors_name_the_file_and_what_is_wrong_with_it() {
    let (folder, path) = folder();
    let nowhere = folder.path().join("no such folder").join("run.h5");
    let error = Writer::create(&nowhere, &metadata(0, &[])).unwrap_err().to_string();
    assert!(error.contains("no such folder") && error.contains("create the file"), "{error}");
    let error = Results::open(&nowhere).unwrap_err().to_string();
    assert!(error.contains("no such folder") && error.contains("open the file"), "{error}");

    let spoil = |change: &dyn Fn(&hdf5::File)| {
        write(&path, 10, &metadata(2, &["P1"])).finish().unwrap();
        change(&hdf5::File::open_rw(&path).unwrap());
        Results::open(&path).unwrap_err()
    };
    match spoil(&|file| file.unlink("points/P1/velocity").unwrap()) {
        FileError::MissingDataset { dataset, .. } => assert_eq!(dataset, "points/P1/velocity"),
        other => panic!("{other}"),
    }
    match spoil(&|file| file.unlink("body").unwrap()) {
        FileError::MissingDataset { dataset, .. } => assert_eq!(dataset, "body/frequencies"),
        other => panic!("{other}"),
    }
    match spoil(&|file| file.delete_attr("scheme").unwrap()) {
        FileError::MissingAttribute { attribute, .. } => assert_eq!(attribute, "scheme"),
        other => panic!("{other}"),
    }
    match spoil(&|file| {
        file.unlink("attitude").unwrap();
        file.new_dataset::<f64>().shape((10, 3)).create("attitude").unwrap();
    }) {
        FileError::WrongShape { dataset, expected, found, .. } => {
            assert_eq!((dataset.as_str(), expected.as_str(), found), ("attitude", "[T, 4]", vec![10, 3]));
        }
        other => panic!("{other}"),
    }
}

#[test]
fn an_unfinished_file_has_as_many_rows_as_its_shortest_column() {
    let (_folder, path) = folder();
    drop(write(&path, 10, &metadata(2, &["P1"])));
    let file = hdf5::File::open_rw(&path).unwrap();
    file.dataset("points/P1/velocity").unwrap().resize((7, 3)).unwrap();
    file.close().unwrap();
    assert_rows(&Results::open(&path).unwrap(), 7);
}

/// What h5py builds numpy arrays and `str` from: IEEE doubles, and strings of variable length in UTF-8.
#[test]
fn names_types_and_shapes_are_those_of_the_contract() {
    let (_folder, path) = folder();
    write(&path, 5, &metadata(4, &["P1"])).finish().unwrap();
    let file = hdf5::File::open(&path).unwrap();
    let shapes: [(&str, &[usize]); 21] = [
        ("time", &[5]),
        ("attitude", &[5, 4]),
        ("position", &[5, 3]),
        ("velocity", &[5, 3]),
        ("angular_velocity", &[5, 3]),
        ("angular_acceleration", &[5, 3]),
        ("modal/displacement", &[5, 4]),
        ("modal/velocity", &[5, 4]),
        ("energy/kinetic", &[5]),
        ("energy/strain", &[5]),
        ("momentum/linear", &[5, 3]),
        ("momentum/angular", &[5, 3]),
        ("points/P1/displacement", &[5, 3]),
        ("points/P1/velocity", &[5, 3]),
        ("points/P1/acceleration", &[5, 3]),
        ("points/P1/rigid_acceleration", &[5, 3]),
        ("body/mass", &[]),
        ("body/center_of_mass", &[3]),
        ("body/inertia", &[3, 3]),
        ("body/frequencies", &[4]),
        ("body/damping_ratios", &[4]),
    ];
    for (name, shape) in shapes {
        let dataset = file.dataset(name).unwrap();
        assert_eq!(dataset.shape(), shape, "{name}");
        assert_eq!(dataset.dtype().unwrap().to_descriptor().unwrap(), TypeDescriptor::Float(FloatSize::U8));
        for attribute in ["unit", "frame", "description"] {
            let text: VarLenUnicode = dataset.attr(attribute).unwrap().read_scalar().unwrap();
            assert!(!text.is_empty(), "{name}: {attribute}");
        }
    }
    let texts = ["units_length", "units_mass", "units_time", "scheme", "program_version", "title", "scene"];
    for name in texts {
        let attribute = file.attr(name).unwrap();
        assert_eq!(attribute.dtype().unwrap().to_descriptor().unwrap(), TypeDescriptor::VarLenUnicode);
        assert_eq!(attribute.ndim(), 0);
    }
    let descriptor = |name: &str| file.attr(name).unwrap().dtype().unwrap().to_descriptor().unwrap();
    assert_eq!(descriptor("step"), TypeDescriptor::Float(FloatSize::U8));
    assert_eq!(descriptor("complete"), TypeDescriptor::Integer(IntSize::U8));
    let unit: VarLenUnicode = file.dataset("energy/strain").unwrap().attr("unit").unwrap().read_scalar().unwrap();
    assert_eq!(unit.as_str(), "Mg mm^2/s^2");
}
