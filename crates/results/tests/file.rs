//! Writing results and reading them back.

mod rows;

use hdf5::types::{FloatSize, IntSize, TypeDescriptor, VarLenUnicode};
use results::*;
use rows::{COLUMNS, Resumed, Row, Writer, assert_rows, body, folder, metadata, shapes};
use sealed::SealedError;
use std::path::Path;

fn write(path: &Path, rows: usize, metadata: &Metadata) -> Writer {
    let expected = Expected { overwrite: true, ..Expected::default() };
    let mut writer = Writer::create(path, metadata, &[], &COLUMNS, expected).unwrap();
    let sizes: Vec<_> =
        metadata.bodies.iter().map(|body| (body.model.frequencies.len(), body.point_names.len())).collect();
    for i in 0..rows {
        writer.push(&Row::of_bodies(i, &sizes)).unwrap();
    }
    writer
}

/// Conserved: the numbers that were written, bit for bit.
#[test]
fn what_is_written_is_read_bit_for_bit() {
    let (_folder, path) = folder();
    // Counts around the size of a chunk; names in no alphabetical order.
    for rows in [0, 1, 511, 512, 513, 1300] {
        let metadata = metadata(3, &["P10", "P2", "corner at -x"]);
        write(&path, rows, &metadata).finish().unwrap();
        let results = Results::open(&path, &COLUMNS).unwrap();
        assert_eq!(results.metadata, metadata);
        assert!(results.complete);
        assert_rows(&results, rows);
    }
    let results = Results::open(&path, &COLUMNS).unwrap();
    let velocity = results.table("modal/velocity").unwrap();
    let column: Vec<f64> = velocity.column(2).unwrap().collect();
    assert_eq!((column.len(), column[7]), (1300, -3.0 * (7.0 * 1e-4 + 2.0)));
    assert!(velocity.column(3).is_none() && velocity.row(1300).is_none());
    assert_eq!(results.numbers("energy/work").unwrap()[7], 7.0 * 1e-4 + 14.0);
    assert_eq!(results.vectors("points/P2/velocity").unwrap()[0], [111.0, -111.0, 0.0]);
    // Nothing by a path that there is not, or of another width.
    assert!(results.table("energy").is_none() && results.numbers("position").is_none());
    assert!(results.vectors::<3>("attitude").is_none() && results.vectors::<4>("attitude").is_some());
}

#[test]
fn a_run_has_a_step_or_a_tolerance() {
    let (_folder, path) = folder();
    for (step, tolerance) in [(Some(2e-5), None), (None, Some(1e-8))] {
        let metadata = Metadata { step, tolerance, ..metadata(1, &[]) };
        write(&path, 3, &metadata).finish().unwrap();
        assert_eq!(Results::open(&path, &COLUMNS).unwrap().metadata, metadata);
        let attributes = hdf5::File::open(&path).unwrap().attr_names().unwrap();
        let has = |name: &str| attributes.iter().any(|found| found == name);
        assert_eq!((has("step"), has("tolerance")), (step.is_some(), tolerance.is_some()));
    }
}

#[test]
fn a_rigid_body_without_points_is_a_file_too() {
    let (_folder, path) = folder();
    for rows in [0, 600] {
        write(&path, rows, &metadata(0, &[])).finish().unwrap();
        let results = Results::open(&path, &COLUMNS).unwrap();
        assert_rows(&results, rows);
        let displacement = results.table("modal/displacement").unwrap();
        assert_eq!((displacement.width(), displacement.rows()), (0, rows));
    }
}

#[test]
fn a_dropped_writer_leaves_its_rows_in_an_unfinished_file_and_nothing_in_the_place_of_results() {
    let (_folder, path) = folder();
    drop(write(&path, 700, &metadata(2, &["P1"])));
    assert!(!path.exists());
    let results = Results::open(unfinished(&path), &COLUMNS).unwrap();
    assert!(!results.complete);
    assert_rows(&results, 700);
}

#[test]
fn a_sample_that_is_not_finite_is_refused_and_those_before_it_stay() {
    let (_folder, path) = folder();
    let metadata = metadata(2, &["P1"]);
    let mut writer = write(&path, 20, &metadata);
    let mut row = Row::new(20, 2, 1);
    row.bodies[0].points[0][2][1] = f64::NAN;
    match writer.push(&row) {
        Err(FileError::NotFinite { time, quantity, .. }) => {
            assert_eq!((time, quantity.as_str()), (row.time, "points/P1/acceleration"));
        }
        other => panic!("{other:?}"),
    }
    let mut row = Row::new(20, 2, 1);
    row.bodies[0].modal[1][1] = f64::INFINITY;
    let error = writer.push(&row).unwrap_err().to_string();
    assert!(error.contains("modal/velocity is inf at time 0.002") && error.contains("smaller step"), "{error}");
    writer.finish().unwrap();
    assert_rows(&Results::open(&path, &COLUMNS).unwrap(), 20);
}

/// Conserved: all of a file but its card.
#[test]
fn the_trust_card_of_a_finished_file_is_replaced_and_nothing_else() {
    let (folder, path) = folder();
    let line = |place: &str, error| TrustLine {
        place: place.into(),
        body: None,
        error,
        meaning: "displacements".into(),
        known: "estimated".into(),
        next: "mesh_size".into(),
    };
    let card = |error| vec![line("mesh", error), line("modes", None)];
    let write = |card| {
        let mut writer =
            Writer::create(&path, &metadata(2, &["P1"]), &[Some(shapes(2))], &COLUMNS, Expected::default());
        (0..700).for_each(|i| writer.as_mut().unwrap().push(&Row::new(i, 2, 1)).unwrap());
        writer.as_mut().unwrap().trust(card);
        writer.unwrap()
    };
    let unfinished = unfinished(&path);
    drop(write(card(None)));
    let before = std::fs::read(&unfinished).unwrap();
    assert!(matches!(replace_trust(&unfinished, &COLUMNS, card(Some(0.1))), Err(FileError::NotComplete { .. })));
    assert_eq!(std::fs::read(&unfinished).unwrap(), before);
    std::fs::remove_file(unfinished).unwrap();

    write(card(Some(0.1))).finish().unwrap();
    let expected = std::fs::read(&path).unwrap();
    std::fs::remove_file(&path).unwrap();
    write(card(None)).finish().unwrap();
    replace_trust(&path, &COLUMNS, card(Some(0.1))).unwrap();
    assert_eq!(std::fs::read(&path).unwrap(), expected);
    assert_eq!(std::fs::read_dir(&folder).unwrap().count(), 1);
}

#[test]
fn rows_that_could_not_be_written_wait_for_another_try() {
    let (folder, path) = folder();
    let place = path.parent().unwrap().to_owned();
    let away = folder.path().with_extension("away");
    let mut writer = Writer::create(&path, &metadata(2, &["P1"]), &[], &COLUMNS, Expected::default()).unwrap();
    let rows = 2000;
    let mut refused = 0;
    for i in 0..rows {
        let row = Row::new(i, 2, 1);
        // A larger file has no place to be made in.
        std::fs::rename(&place, &away).unwrap();
        let pushed = writer.push(&row);
        std::fs::rename(&away, &place).unwrap();
        if let Err(error) = pushed {
            assert!(matches!(error, FileError::Sealed(SealedError::System { .. })), "{error}");
            refused += 1;
            writer.push(&row).unwrap();
        }
    }
    assert!(refused > 0);
    writer.finish().unwrap();
    assert_rows(&Results::open(&path, &COLUMNS).unwrap(), rows);
}

#[test]
fn fields_that_do_not_fit_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let grid = Grid { points: vec![[0.0; 3]; 3], connectivity: vec![0, 1, 2], cells: CellKind::Triangle };
    let field = Field { name: "velocity".into(), components: 3 };
    let path = folder.path().join("field.vtu");
    let error = write_vtu(&path, &grid, &[(&field, &[0.0; 2])], false).unwrap_err();
    assert!(matches!(error, FileError::WrongLength { expected: 9, found: 2, .. }), "{error}");
    assert!(!path.exists());
    write_vtu(&path, &grid, &[(&field, &[0.0; 9])], false).unwrap();
    let out = VtkHdf::create(folder.path().join("field.vtkhdf"), &grid, None, &[field], false).unwrap();
    assert!(matches!(out.write(0, 0, 1, &[0.0; 9]), Err(FileError::WrongLength { expected: 2, found: 1, .. })));
    assert!(matches!(out.write(0, 0, 0, &[0.0; 2]), Err(FileError::Sealed(SealedError::Hdf5 { .. }))));
    assert!(matches!(out.write(0, 1, 0, &[0.0; 9]), Err(FileError::Sealed(SealedError::Hdf5 { .. }))));
    assert!(matches!(out.write(1, 0, 0, &[0.0; 9]), Err(FileError::WrongLength { expected: 1, found: 0, .. })));
    out.write(0, 0, 0, &[0.0; 9]).unwrap();
}

#[test]
fn wrong_lengths_and_names_are_refused() {
    let (_folder, path) = folder();
    let mut writer = write(&path, 2, &metadata(2, &["P1"]));
    for (modes, points, name, expected, found) in [
        (3, 1, "modal/displacement", 2, 3),
        (2, 0, "points/displacement", 3, 0),
        (2, 2, "points", 1, 2),
        (0, 1, "modal/displacement", 2, 0),
    ] {
        match writer.push(&Row::new(2, modes, points)) {
            Err(FileError::WrongLength { quantity, expected: e, found: f, .. }) => {
                assert_eq!((quantity.as_str(), e, f), (name, expected, found));
            }
            other => panic!("{other:?}"),
        }
    }
    writer.finish().unwrap();
    assert_rows(&Results::open(&path, &COLUMNS).unwrap(), 2);

    for names in [[""].as_slice(), &["a/b"], &["a\0"], &["a", "a"]] {
        let error = Writer::create(&path, &metadata(1, names), &[], &COLUMNS, Expected::default()).unwrap_err();
        assert!(matches!(error, FileError::PlaceName { .. }), "{names:?}: {error}");
    }
    let mut unequal = metadata(2, &[]);
    unequal.bodies[0].model.damping_ratios.pop();
    assert!(matches!(
        Writer::create(&path, &unequal, &[], &COLUMNS, Expected::default()),
        Err(FileError::WrongLength { expected: 2, found: 1, .. })
    ));
    let mut shapes = metadata(2, &[]);
    shapes.bodies[0].model.static_shapes = 3;
    assert!(matches!(
        Writer::create(&path, &shapes, &[], &COLUMNS, Expected::default()),
        Err(FileError::WrongLength { expected: 2, found: 3, .. })
    ));
    let mut nowhere = metadata(2, &["P1"]);
    nowhere.bodies[0].point_positions.clear();
    assert!(matches!(
        Writer::create(&path, &nowhere, &[], &COLUMNS, Expected::default()),
        Err(FileError::WrongLength { expected: 1, found: 0, .. })
    ));
    let mut nul = metadata(2, &[]);
    nul.scene_text = "a\0b".into();
    let fresh = path.with_file_name("fresh.h5");
    assert!(matches!(
        Writer::create(&fresh, &nul, &[], &COLUMNS, Expected::default()),
        Err(FileError::NulInText { .. })
    ));
}

#[test]
fn errors_name_the_file_and_what_is_wrong_with_it() {
    let (folder, path) = folder();
    let nowhere = folder.path().join("no such folder").join("run.h5");
    let error =
        Writer::create(&nowhere, &metadata(0, &[]), &[], &COLUMNS, Expected::default()).unwrap_err().to_string();
    assert!(error.contains("no such folder") && error.contains("create the file"), "{error}");
    let error = Results::open(&nowhere, &COLUMNS).unwrap_err().to_string();
    assert!(error.contains("no such folder") && error.contains("open the file"), "{error}");
    std::fs::write(&path, "a diary").unwrap();
    let error = Results::open(&path, &COLUMNS).unwrap_err();
    assert!(
        matches!(error, FileError::Sealed(SealedError::NoSeal { .. })) && error.to_string().contains("run.h5"),
        "{error}"
    );
}

#[test]
fn an_unfinished_file_has_the_rows_that_are_whole_in_every_column() {
    let (_folder, path) = folder();
    drop(write(&path, 10, &metadata(2, &["P1"])));
    let part = unfinished(&path);
    let file = hdf5::File::open_rw(&part).unwrap();
    let column = file.dataset("points/velocity").unwrap();
    assert_eq!(column.shape(), [512, 1, 3]);
    column.write_slice(&[f64::NAN], ndarray::s![7, 0, 1..2]).unwrap();
    drop(column);
    file.close().unwrap();
    assert_rows(&Results::open(&part, &COLUMNS).unwrap(), 7);
}

/// Room for 100 000 rows is 42 MB, 0.8 MB of which are the times.
#[test]
fn room_for_rows_to_come_costs_no_memory_when_it_is_read() {
    let (_folder, path) = folder();
    let expected = Expected { rows: 100_000, ..Expected::default() };
    let mut writer = Writer::create(&path, &metadata(3, &["P"]), &[], &COLUMNS, expected).unwrap();
    (0..700).for_each(|i| writer.push(&Row::new(i, 3, 1)).unwrap());
    drop(writer);
    let part = unfinished(&path);
    assert!(part.metadata().unwrap().len() > 40_000_000);
    let mut results = None;
    let memory = allocation_counter::measure(|| results = Some(Results::open(&part, &COLUMNS)));
    assert_rows(&results.unwrap().unwrap(), 700);
    assert!(memory.bytes_max < 4_000_000, "{memory:?}");
}

#[test]
fn a_finished_file_is_the_same_byte_for_byte_whatever_way_led_to_it() {
    let (_folder, path) = folder();
    let metadata = metadata(3, &["P1"]);
    let push = |writer: &mut Writer, rows: std::ops::Range<usize>| {
        rows.for_each(|i| writer.push(&Row::new(i, 3, 1)).unwrap());
    };
    let mut files = Vec::new();
    let overwrite = Expected { overwrite: true, ..Expected::default() };
    for expected in [overwrite, Expected { rows: 3000, checkpoint: 5, ..overwrite }] {
        let mut writer = Writer::create(&path, &metadata, &[], &COLUMNS, expected).unwrap();
        push(&mut writer, 0..2000);
        writer.finish().unwrap();
        assert!(!unfinished(&path).exists());
        files.push(std::fs::read(&path).unwrap());
        // The clock of HDF5 files has a second's resolution.
        std::thread::sleep(std::time::Duration::from_millis(1100));
    }
    let mut writer = Writer::create(&path, &metadata, &[], &COLUMNS, Expected { checkpoint: 2, ..overwrite }).unwrap();
    push(&mut writer, 0..700);
    writer.flush(&[7, 8]).unwrap();
    push(&mut writer, 700..1500);
    drop(writer);
    let Resumed { mut writer, results, checkpoint } = Writer::resume(&path, &COLUMNS, true).unwrap();
    assert_eq!(checkpoint, Some(vec![7, 8]));
    assert_rows(&results, 700);
    push(&mut writer, 700..2000);
    writer.finish().unwrap();
    files.push(std::fs::read(&path).unwrap());
    assert!(files[0] == files[1] && files[1] == files[2]);
    assert_rows(&Results::open(&path, &COLUMNS).unwrap(), 2000);
}

#[test]
fn of_two_checkpoints_the_last_whole_one_counts() {
    let (_folder, path) = folder();
    let metadata = metadata(1, &[]);
    let expected = Expected { checkpoint: 3, ..Expected::default() };
    let mut writer = Writer::create(&path, &metadata, &[], &COLUMNS, expected).unwrap();
    for i in 0..40 {
        writer.push(&Row::new(i, 1, 0)).unwrap();
        if i % 10 == 9 {
            writer.flush(&[i as u64, 1, 2]).unwrap();
        }
    }
    assert!(matches!(writer.flush(&[1, 2]), Err(FileError::WrongLength { expected: 3, found: 2, .. })));
    drop(writer);
    let resumed = || Writer::resume(&path, &COLUMNS, false).unwrap();
    let rows_and_state = |resumed: Resumed| (resumed.results.rows(), resumed.checkpoint);
    assert_eq!(rows_and_state(resumed()), (40, Some(vec![39, 1, 2])));
    // The fourth is in place 0; a torn one differs in a word.
    let spoil = |place: usize, word: usize| {
        let file = hdf5::File::open_rw(unfinished(&path)).unwrap();
        file.dataset("checkpoint").unwrap().write_slice(&[77_u64], ndarray::s![place, word..word + 1]).unwrap();
    };
    let unchecked_from = || Results::open(unfinished(&path), &COLUMNS).unwrap().unchecked_from;
    assert_eq!(unchecked_from(), None);
    spoil(0, 3);
    assert_eq!(unchecked_from(), Some(Row::new(30, 1, 0).time()));
    assert_eq!(rows_and_state(resumed()), (30, Some(vec![29, 1, 2])));
    // From there its successor is the fourth again.
    let mut writer = resumed().writer;
    writer.push(&Row::new(30, 1, 0)).unwrap();
    writer.flush(&[30, 1, 2]).unwrap();
    drop(writer);
    assert_eq!(rows_and_state(resumed()), (31, Some(vec![30, 1, 2])));
    spoil(0, 0);
    spoil(1, 5);
    assert_eq!(rows_and_state(resumed()), (0, None));
}

#[test]
fn nothing_is_overwritten_that_a_user_would_miss() {
    let (folder, path) = folder();
    let metadata = metadata(1, &[]);
    let create =
        |overwrite| Writer::create(&path, &metadata, &[], &COLUMNS, Expected { overwrite, ..Expected::default() });
    assert!(matches!(Writer::resume(&path, &COLUMNS, false), Err(FileError::NothingToResume { .. })));
    write(&path, 5, &metadata).finish().unwrap();
    assert!(matches!(Writer::resume(&path, &COLUMNS, false), Err(FileError::Complete { .. })));
    // A complete file is replaced only when asked, and stays until another one is complete.
    assert!(matches!(create(false), Err(FileError::Exists { .. })));
    assert!(matches!(Writer::check(&path, false), Err(FileError::Exists { .. })));
    drop(create(true).unwrap());
    assert_rows(&Results::open(&path, &COLUMNS).unwrap(), 5);
    assert!(matches!(Writer::resume(&path, &COLUMNS, false), Err(FileError::Exists { .. })));
    // Which is not resumed, nor thrown away unasked.
    let error = create(false).unwrap_err();
    assert!(matches!(error, FileError::Unfinished { .. }));
    assert!(error.to_string().contains("flexframe resume") && error.to_string().contains("--overwrite"), "{error}");
    // Nor while it is written.
    let writer = create(true).unwrap();
    for overwrite in [false, true] {
        assert!(matches!(create(overwrite), Err(FileError::Busy { .. })));
    }
    assert!(matches!(Writer::resume(unfinished(&path), &COLUMNS, false), Err(FileError::Busy { .. })));
    writer.finish().unwrap();
    assert_rows(&Results::open(&path, &COLUMNS).unwrap(), 0);
    // One that has come there meanwhile is not replaced by who was not asked to.
    let kept = std::fs::read(&path).unwrap();
    std::fs::remove_file(&path).unwrap();
    let mut writer = create(false).unwrap();
    writer.push(&Row::new(0, 1, 0)).unwrap();
    writer.flush(&[]).unwrap();
    std::fs::write(&path, &kept).unwrap();
    assert!(matches!(writer.finish(), Err(FileError::Exists { .. })));
    assert!(std::fs::read(&path).unwrap() == kept);
    Writer::resume(&path, &COLUMNS, true).unwrap().writer.finish().unwrap();
    assert_rows(&Results::open(&path, &COLUMNS).unwrap(), 1);
    // What is none of ours.
    std::fs::write(&path, "a diary").unwrap();
    assert!(matches!(create(false), Err(FileError::NotResults { .. })));
    assert_eq!(std::fs::read(&path).unwrap(), b"a diary");
    assert!(create(true).is_ok());
    std::fs::remove_file(unfinished(&path)).unwrap();
    std::fs::remove_file(&path).unwrap();
    std::fs::create_dir(&path).unwrap();
    assert!(matches!(create(true), Err(FileError::NotResults { .. })));
    std::fs::remove_dir(&path).unwrap();
    // Nor by the name of an unfinished file.
    let part = unfinished(&path);
    std::fs::write(&part, "a diary").unwrap();
    assert!(matches!(create(false), Err(FileError::NotResults { path }) if path == part));
    assert_eq!(std::fs::read(&part).unwrap(), b"a diary");
    std::fs::remove_file(&part).unwrap();
    std::fs::create_dir(&part).unwrap();
    for overwrite in [false, true] {
        assert!(matches!(create(overwrite), Err(FileError::NotResults { path }) if path == part));
    }
    // And no temporary file is left.
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 1);
}

#[test]
fn of_runs_that_begin_at_once_each_has_the_file_to_itself() {
    let (_folder, path) = folder();
    let metadata = metadata(1, &[]);
    let (mut done, mut busy) = (0, 0);
    for _ in 0..20 {
        let outcomes: Vec<Result<(), FileError>> = std::thread::scope(|scope| {
            let run = || {
                let expected = Expected { overwrite: true, ..Expected::default() };
                let mut writer = Writer::create(&path, &metadata, &[], &COLUMNS, expected)?;
                (0..5).for_each(|i| writer.push(&Row::new(i, 1, 0)).unwrap());
                writer.finish()
            };
            let threads: Vec<_> = (0..4).map(|_| scope.spawn(run)).collect();
            threads.into_iter().map(|thread| thread.join().unwrap()).collect()
        });
        for outcome in outcomes {
            match outcome {
                Ok(()) => done += 1,
                Err(error) => {
                    assert!(matches!(error, FileError::Busy { .. }), "{error}");
                    busy += 1;
                }
            }
        }
        assert_rows(&Results::open(&path, &COLUMNS).unwrap(), 5);
    }
    assert!(done >= 20 && done + busy == 80, "{done} {busy}");
}

/// Files that are finished, unfinished, grown and resumed: HDF5 finds the same numbers.
#[test]
fn the_shapes_of_the_body_come_back_bit_for_bit() {
    let (_folder, path) = folder();
    let (metadata, shapes) = (metadata(2, &["P1"]), shapes(2));
    let expected = Expected { checkpoint: 1, ..Expected::default() };
    let mut writer = Writer::create(&path, &metadata, &[Some(shapes.clone())], &COLUMNS, expected).unwrap();
    let read = |path: &Path| Results::open_with_shapes(path, &COLUMNS).unwrap().1.remove(0).unwrap();
    let part = unfinished(&path);
    // More than there is room for at first.
    (0..1300).for_each(|i| writer.push(&Row::new(i, 2, 1)).unwrap());
    writer.flush(&[7]).unwrap();
    drop(writer);
    assert_eq!(read(&part), shapes);
    Writer::resume(&path, &COLUMNS, false).unwrap().writer.finish().unwrap();
    assert_eq!(read(&path), shapes);
    assert_rows(&Results::open(&path, &COLUMNS).unwrap(), 1300);

    let file = hdf5::File::open(&path).unwrap();
    let numbers = |name: &str, shape: &[usize]| {
        let dataset = file.dataset(name).unwrap();
        assert_eq!(dataset.shape(), shape, "{name}");
        dataset.read_raw::<f64>().unwrap()
    };
    let whole = |name: &str| file.dataset(name).unwrap().read_raw::<u32>().unwrap();
    let stress = shapes.stress.as_ref().unwrap();
    assert_eq!(whole("body/mesh/nodes"), shapes.nodes);
    assert_eq!(whole("body/mesh/surface_triangles"), shapes.faces.as_flattened());
    assert_eq!(whole("body/large_deflection/factors"), [0, 0, 2]);
    assert_eq!(whole("body/stress/nodes"), stress.nodes);
    assert_eq!(numbers("body/mesh/positions", &[3, 3]), shapes.positions.as_flattened());
    assert_eq!(numbers("body/shapes", &[3, 3, 3]), shapes.displacements.concat().as_flattened());
    assert_eq!(numbers("body/large_deflection/products", &[1, 3]), shapes.products.concat());
    assert_eq!(numbers("body/stress/shapes", &[3, 4, 6]), stress.shapes[..3].concat().as_flattened());
    assert_eq!(numbers("body/stress/products", &[1, 4, 6]), stress.shapes[3].as_flattened());
    let unit: VarLenUnicode = file.dataset("body/shapes").unwrap().attr("unit").unwrap().read_scalar().unwrap();
    assert_eq!(unit.as_str(), "1/Mg^(1/2)");

    // Without large deflection and without elements.
    let plain = Shapes { faces: Vec::new(), factors: Vec::new(), products: Vec::new(), stress: None, ..shapes.clone() };
    let other = path.with_file_name("plain.h5");
    Writer::create(&other, &metadata, &[Some(plain.clone())], &COLUMNS, expected).unwrap().finish().unwrap();
    assert_eq!(read(&other), plain);
    let unlike = Shapes { nodes: vec![1, 2], ..shapes };
    let refused = Writer::create(path.with_file_name("un.h5"), &metadata, &[Some(unlike)], &COLUMNS, expected);
    assert!(matches!(refused, Err(FileError::WrongLength { .. })));
}

#[test]
fn a_file_of_another_version_is_refused_with_its_version_and_the_help() {
    let (_folder, path) = folder();
    write(&path, 3, &metadata(1, &[])).finish().unwrap();
    let mut bytes = std::fs::read(&path).unwrap();
    assert_eq!(bytes[..24], *b"flexframe results, v. 7\n");
    for (digit, words) in [(b'4', "a results file of version 4"), (b'9', "a results file of version 9")] {
        bytes[22] = digit;
        std::fs::write(&path, &bytes).unwrap();
        let error = Results::open(&path, &COLUMNS).unwrap_err();
        assert!(matches!(error, FileError::Sealed(SealedError::OtherVersion { .. })));
        let text = error.to_string();
        assert!(
            text.contains(words) && text.contains("reads version 7") && text.contains("run its scene again"),
            "{text}"
        );
    }
    bytes[22] = b'x';
    std::fs::write(&path, &bytes).unwrap();
    assert!(matches!(Results::open(&path, &COLUMNS), Err(FileError::Sealed(SealedError::NoSeal { .. }))));
}

/// Types from which h5py builds numpy arrays and `str`: IEEE doubles, and strings of variable length in UTF-8.
#[test]
fn names_types_and_shapes_are_those_of_the_contract() {
    let (_folder, path) = folder();
    let mut metadata = metadata(4, &["P1", "P2"]);
    metadata.bodies[0].parts = vec!["hinge".into()];
    write(&path, 5, &metadata).finish().unwrap();
    let file = hdf5::File::open(&path).unwrap();
    let of_columns = histories(&COLUMNS, &metadata).map(|history| {
        let shape: Vec<_> = [5].into_iter().chain(history.row_shape(&metadata)).collect();
        (history.path(&metadata), shape)
    });
    let of_body: [(&str, &[usize]); 10] = [
        ("model/rotation_axes", &[1, 3]),
        ("model/translation_axes", &[0, 3]),
        ("model/mesh/size", &[3]),
        ("model/origin", &[3]),
        ("points/position", &[2, 3]),
        ("model/mass", &[]),
        ("model/center_of_mass", &[3]),
        ("model/inertia", &[3, 3]),
        ("model/frequencies", &[4]),
        ("model/damping_ratios", &[4]),
    ];
    let of_body = of_body.map(|(name, shape)| (format!("bodies/body/{name}"), shape.to_vec()));
    let mut shapes: Vec<_> = of_columns.chain(of_body).chain([("time".into(), vec![5])]).collect();
    let of_body = |name: &str, values: usize| (format!("bodies/body/{name}"), vec![5, values]);
    assert_eq!(
        (shapes.len(), &shapes[0], &shapes[5]),
        (33, &of_body("attitude", 4), &of_body("modal/displacement", 4))
    );
    assert_eq!(shapes[21], ("system/energy/kinetic".into(), vec![5]));
    assert_eq!(shapes[16], ("bodies/body/points/displacement".into(), vec![5, 2, 3]));
    // All that is of a single body has a short path, too.
    let short = |(name, shape): &(String, Vec<usize>)| {
        let short = name.strip_prefix("bodies/body/")?;
        Some((short.replace("model/", "body/"), shape.clone()))
    };
    let short: Vec<_> = shapes.iter().filter_map(short).collect();
    assert!(
        short.contains(&("points/displacement".into(), vec![5, 2, 3])) && short.contains(&("body/mass".into(), vec![]))
    );
    shapes.extend(short);
    let texts = |name: &str| -> Vec<String> {
        let dataset = file.dataset(name).unwrap();
        dataset.read_raw::<VarLenUnicode>().unwrap().iter().map(ToString::to_string).collect()
    };
    assert_eq!(texts("points/names"), ["P1", "P2"]);
    assert_eq!(texts("input_files"), metadata.input_files);
    assert_eq!(texts("effects/reason"), ["It is slow."]);
    assert_eq!(texts("body/kinds"), ["natural mode", "natural mode", "static shape", "static shape"]);
    for (name, shape) in shapes {
        let dataset = file.dataset(&name).unwrap();
        assert_eq!(dataset.shape(), shape, "{name}");
        assert_eq!(dataset.dtype().unwrap().to_descriptor().unwrap(), TypeDescriptor::Float(FloatSize::U8));
        for attribute in ["unit", "frame", "description"] {
            let text: VarLenUnicode = dataset.attr(attribute).unwrap().read_scalar().unwrap();
            assert!(!text.is_empty(), "{name}: {attribute}");
        }
    }
    let texts = [
        "units_length",
        "units_mass",
        "units_time",
        "formulation",
        "scheme",
        "program_version",
        "title",
        "scene",
        "scene_file",
        "format_version",
    ];
    for name in texts {
        let attribute = file.attr(name).unwrap();
        assert_eq!(attribute.dtype().unwrap().to_descriptor().unwrap(), TypeDescriptor::VarLenUnicode);
        assert_eq!(attribute.ndim(), 0);
    }
    let descriptor = |name: &str| file.attr(name).unwrap().dtype().unwrap().to_descriptor().unwrap();
    assert_eq!(descriptor("step"), TypeDescriptor::Float(FloatSize::U8));
    assert_eq!(descriptor("complete"), TypeDescriptor::Integer(IntSize::U8));
}

/// Independent reference: HDF5 reads the numbers. The writer puts them into their places by itself; HDF5 must find
/// them there.
#[test]
fn hdf5_finds_the_numbers_that_were_written() {
    let (_folder, path) = folder();
    let metadata = metadata(3, &["P10", "P2"]);
    let mut writer =
        Writer::create(&path, &metadata, &[], &COLUMNS, Expected { checkpoint: 2, ..Expected::default() }).unwrap();
    (0..700).for_each(|i| writer.push(&Row::new(i, 3, 2)).unwrap());
    writer.flush(&[7, 8]).unwrap();
    let part = unfinished(&path);
    std::fs::copy(&part, path.with_extension("copy.h5")).unwrap();
    writer.finish().unwrap();
    for (path, complete, room) in [(path.clone(), 1, 700), (path.with_extension("copy.h5"), 0, 1024)] {
        let results = Results::open(&path, &COLUMNS).unwrap();
        assert_rows(&results, 700);
        let file = hdf5::File::open(&path).unwrap();
        assert_eq!(file.attr("complete").unwrap().read_scalar::<i64>().unwrap(), complete);
        let numbers = |name: &str| file.dataset(name).unwrap().read_raw::<f64>().unwrap();
        let check = |name: &str, width: usize, expected: &[f64]| {
            let found = numbers(name);
            assert_eq!(found.len(), room * width, "{name}");
            assert_eq!(found[..700 * width], *expected, "{name}");
            let is_left = |value: &f64| if name == "time" { value.is_nan() } else { *value == 0.0 };
            assert!(found[700 * width..].iter().all(is_left), "{name}");
        };
        check("time", 1, results.numbers("time").unwrap());
        assert_eq!(histories(&COLUMNS, &metadata).count(), 21);
        for history in histories(&COLUMNS, &metadata) {
            let path = history.path(&metadata);
            let of = |name: &String| results.table(&history.path_of(&metadata, Some(name))).unwrap();
            let of: Vec<_> = history.places(&metadata).iter().map(of).collect();
            let rows = (0..700).flat_map(|i| of.iter().flat_map(move |table| table.row(i).unwrap()));
            match history.is_of_places() {
                true => check(&path, history.width(&metadata), &rows.copied().collect::<Vec<_>>()),
                false => check(&path, history.width(&metadata), results.table(&path).unwrap().values()),
            }
            assert_eq!(results.dataset(history), numbers(&path)[..700 * history.width(&metadata)]);
        }
        // The run has no hinge.
        assert!(file.dataset("hinge/angle").is_err() && results.table("hinge/angle").is_none());
        assert_eq!(numbers("body/frequencies"), metadata.bodies[0].model.frequencies);
        if complete == 0 {
            let checkpoint = file.dataset("checkpoint").unwrap();
            assert_eq!(checkpoint.shape(), [2, 6]);
            assert_eq!(checkpoint.read_raw::<u64>().unwrap()[6 + 3..6 + 5], [7, 8]);
        }
    }
}

/// A link may lead to any file.
#[cfg(unix)]
#[test]
fn nothing_is_written_through_a_link_or_in_its_place() {
    use std::os::unix::fs::symlink;
    let (folder, path) = folder();
    let metadata = metadata(1, &[]);
    let target = folder.path().join("target");
    let refused = |outcome: Result<(), FileError>, link: &Path| match outcome {
        Err(FileError::Link { path, .. }) => assert_eq!(path, link),
        other => panic!("{other:?}"),
    };
    let elsewhere = folder.path().join("elsewhere.h5");
    drop(write(&elsewhere, 3, &metadata));
    let sound = std::fs::read(unfinished(&elsewhere)).unwrap();
    for content in [None, Some(&b"a diary"[..]), Some(&sound)] {
        for link in [path.clone(), unfinished(&path)] {
            content.iter().for_each(|content| std::fs::write(&target, content).unwrap());
            symlink(&target, &link).unwrap();
            for overwrite in [false, true] {
                refused(Writer::check(&path, overwrite), &link);
                let expected = Expected { overwrite, ..Expected::default() };
                refused(Writer::create(&path, &metadata, &[], &COLUMNS, expected).map(drop), &link);
            }
            if link != path {
                refused(Writer::resume(&path, &COLUMNS, false).map(drop), &link);
            }
            assert_eq!(std::fs::read_link(&link).unwrap(), target);
            assert_eq!(std::fs::read(&target).ok().as_deref(), content);
            std::fs::remove_file(link).unwrap();
        }
    }
    let message = FileError::Link { path, target }.to_string();
    assert!(message.contains("symbolic link") && message.contains("remove it"), "{message}");
}

#[cfg(unix)]
#[test]
fn names_that_are_not_utf8() {
    use std::os::unix::ffi::OsStrExt;
    let (folder, _) = folder();
    let name = |bytes: &[u8]| folder.path().join(std::ffi::OsStr::from_bytes(bytes));
    let [path, other] = [name(b"run\xff.h5"), name(b"run\xfe.h5")];
    assert_eq!(unfinished(&path), name(b"run\xff.part.h5"));
    assert_eq!(unfinished(unfinished(&other)), name(b"run\xfe.part.h5"));
    assert_eq!(unfinished(name(b"a.part")), name(b"a.part.part.h5"));
    assert_eq!(unfinished(name(b"a.b")), name(b"a.b.part.h5"));
    write(&path, 3, &metadata(1, &[])).finish().unwrap();
    assert_rows(&Results::open(&path, &COLUMNS).unwrap(), 3);
    // HDF5 wants the folder's name as text; that is said before the work.
    std::fs::create_dir(name(b"f\xff")).unwrap();
    let outcome = Writer::check(name(b"f\xff").join("run.h5"), false);
    assert!(matches!(outcome, Err(FileError::Sealed(SealedError::NameNotUtf8 { .. }))), "{outcome:?}");
}

#[test]
fn constants_are_finite() {
    let (_folder, path) = folder();
    let mut vast = metadata(2, &[]);
    vast.bodies[0].model.inertia[1][2] = f64::INFINITY;
    let error = Writer::create(&path, &vast, &[], &COLUMNS, Expected::default()).unwrap_err().to_string();
    assert!(error.contains("bodies/body/model/inertia is inf"), "{error}");
}

#[test]
fn units_are_in_the_labels_of_the_run() {
    let label = |dimension, [length, mass, time]: [&str; 3]| {
        let units = Units { length: length.into(), mass: mass.into(), time: time.into() };
        Column::<Row>::of_system(["", "x"], (dimension, "none"), "", Quantity::Number(|row| row.time)).unit(&units)
    };
    let mm = ["mm", "Mg", "s"];
    assert_eq!(label(Dimension::Number, mm), "1");
    assert_eq!(label(Dimension::AngularAcceleration, mm), "rad/s^2");
    assert_eq!(label(Dimension::Other("length mass^(1/2)/time"), mm), "mm Mg^(1/2)/s");
    assert_eq!(label(Dimension::Moment, mm), "Mg mm^2/s^2");
    // A label may be any text.
    assert_eq!(label(Dimension::Momentum, ["mass", "time", "length"]), "time mass/length");
}

/// Bodies of other sizes, one without points, in an unfinished file, one that was resumed, and a finished one.
#[test]
fn several_bodies_are_in_one_file() {
    let (_folder, path) = folder();
    let mut metadata = metadata(2, &["P1"]);
    metadata.bodies = vec![body("ring", 2, &["P1", "P2"]), body("block", 0, &[]), body("left arm", 3, &["P1"])];
    metadata.bodies[2].parts = vec!["hinge".into()];
    let bodies = [(2, 2), (0, 0), (3, 1)];
    let all = [Some(shapes(2)), None, Some(shapes(3))];
    let expected = Expected { checkpoint: 1, ..Expected::default() };
    let mut writer = Writer::create(&path, &metadata, &all, &COLUMNS, expected).unwrap();
    (0..900).for_each(|i| writer.push(&Row::of_bodies(i, &bodies)).unwrap());
    writer.flush(&[7]).unwrap();
    assert!(matches!(writer.push(&Row::of_bodies(900, &bodies[..2])), Err(FileError::WrongLength { expected: 3, .. })));
    let error = writer.push(&Row::of_bodies(900, &[(2, 2), (0, 0), (2, 1)])).unwrap_err().to_string();
    assert!(error.contains("bodies/left arm/modal/displacement has 2 values where 3"), "{error}");
    drop(writer);
    let (part, of_part) = Results::open_with_shapes(unfinished(&path), &COLUMNS).unwrap();
    assert_rows(&part, 900);
    assert_eq!(of_part, all);
    Writer::resume(&path, &COLUMNS, false).unwrap().writer.finish().unwrap();
    let (results, of_finished) = Results::open_with_shapes(&path, &COLUMNS).unwrap();
    assert_eq!((&of_finished[..], &results.metadata), (&all[..], &metadata));
    assert_rows(&results, 900);
    assert!(results.table("bodies/block/hinge/angle").is_none());
    let [_, _, arm] = results.bodies().collect::<Vec<_>>()[..] else { panic!() };
    assert_eq!(arm.numbers("hinge/angle").unwrap()[3], 3e-4 + 2000.0 + 19.0);
    assert_eq!(arm.vectors::<3>("points/P1/velocity"), results.vectors("bodies/left arm/points/P1/velocity"));
    // A path without a body is of none.
    assert!(results.table("position").is_none() && results.numbers("time").is_some());

    let file = hdf5::File::open(&path).unwrap();
    assert!(file.dataset("position").is_err());
    assert_eq!(file.dataset("bodies/ring/points/velocity").unwrap().shape(), [900, 2, 3]);
    assert_eq!(file.dataset("bodies/left arm/model/shapes").unwrap().shape(), [4, 3, 3]);
    assert!(file.dataset("bodies/block/model/shapes").is_err());

    metadata.bodies[1].name = "ring".into();
    let refused = Writer::create(path.with_file_name("twice.h5"), &metadata, &[], &COLUMNS, expected);
    assert!(matches!(refused, Err(FileError::PlaceName { kind: "body", .. })));
}

#[test]
fn joints_have_groups_beside_those_of_the_bodies() {
    let (_folder, path) = folder();
    let joint = |name: &str, parts: &[&str]| JointMetadata {
        name: name.into(),
        kind: "revolute".into(),
        between: ["body.tip".into(), "ground".into()],
        parts: parts.iter().map(|part| part.to_string()).collect(),
    };
    let joints = vec![joint("stiff", &[]), joint("shoulder", &["turns"])];
    let metadata = Metadata { joints, ..metadata(0, &[]) };
    let mut writer = Writer::create(&path, &metadata, &[], &COLUMNS, Expected::default()).unwrap();
    for i in 0..3 {
        writer.push(&Row { joints: vec![-1.0, 0.5 * i as f64], ..Row::new(i, 0, 0) }).unwrap();
    }
    let lacks = writer.push(&Row::new(3, 0, 0)).unwrap_err();
    assert!(matches!(lacks, FileError::WrongLength { expected: 2, found: 0, .. }), "{lacks}");
    writer.finish().unwrap();
    let results = Results::open(&path, &COLUMNS).unwrap();
    assert_eq!(results.metadata, metadata);
    assert_eq!(results.numbers("joints/shoulder/angle"), Some(&[0.0, 0.5, 1.0][..]));
    assert_eq!(results.numbers("joints/stiff/angle"), None);
    assert_eq!(results.numbers("joints/stiff/moment"), Some(&[-1.0; 3][..]));
    assert_eq!(results.numbers("joints/shoulder/moment"), None);
    let file = hdf5::File::open(&path).unwrap();
    let kind = file.group("joints/stiff").unwrap().attr("kind").unwrap();
    assert_eq!(kind.read_scalar::<hdf5::types::VarLenUnicode>().unwrap().as_str(), "revolute");
}
