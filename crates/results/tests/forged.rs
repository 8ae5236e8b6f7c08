//! Files with a right seal that no writer wrote: HDF5 is not asked what is in them, and nothing outside of them is
//! touched.
//!
//! Every third byte of a file is changed, and a thousand files in several places at once. `FLEXFRAME_FORGERIES` sets the number of the
//! latter, and lets each byte be changed (`./dev stability`).

mod rows;
mod sealed;

use ::sealed::SealedError;
use hdf5::dataset::Layout;
use results::*;
use rows::{COLUMNS, Resumed, Row, Writer, assert_rows, folder, metadata, shapes};
use serde_json::{Value, json};
use std::path::Path;

const ROWS: usize = 30;

fn push(writer: &mut Writer, rows: std::ops::Range<usize>) {
    rows.for_each(|i| writer.push(&Row::new(i, 2, 1)).unwrap());
}

/// An unfinished file, as bytes, and the finished one that it becomes with as many rows again.
fn files(path: &Path) -> [Vec<u8>; 2] {
    let metadata = Metadata { scene_text: "title = \"ω₂\"".into(), ..metadata(2, &["P1"]) };
    let mut writer = Writer::create(
        path,
        &metadata,
        &[Some(shapes(2))],
        &COLUMNS,
        Expected { checkpoint: 4, overwrite: true, ..Expected::default() },
    )
    .unwrap();
    push(&mut writer, 0..ROWS);
    writer.flush(&[1, 2, 3, 4]).unwrap();
    let part = std::fs::read(writer.unfinished()).unwrap();
    push(&mut writer, ROWS..2 * ROWS);
    writer.finish().unwrap();
    let finished = std::fs::read(path).unwrap();
    std::fs::remove_file(path).unwrap();
    [part, finished]
}

/// Goes on with the unfinished file to its end.
fn go_on(part: &Path) -> Result<(), FileError> {
    let mut writer = Writer::resume(part, &COLUMNS, true)?.writer;
    push(&mut writer, ROWS..2 * ROWS);
    writer.finish()
}

#[test]
fn numbers_are_taken_from_the_file_itself_and_written_there() {
    let (folder, path) = folder();
    let [part, finished] = files(&path);
    let place = unfinished(&path);
    let victim = folder.path().join("victim");
    let other = folder.path().join("other.h5");
    let of_victim = vec![b'v'; 20_000];
    let velocities = |file: &hdf5::File| {
        let dataset = file.new_dataset::<f64>().layout(Layout::Contiguous).shape((512, 3)).create("velocity").unwrap();
        dataset.write_raw(&[7.0; 3 * 512]).unwrap();
    };
    let external = |file: &hdf5::File| {
        let builder = file.new_dataset::<f64>().external(victim.to_str().unwrap(), 0, 3 * 8 * 512);
        builder.shape((512, 3)).create("velocity").unwrap();
    };
    let link = |file: &hdf5::File| file.link_external(other.to_str().unwrap(), "velocity", "velocity").unwrap();
    let soft = |file: &hdf5::File| file.link_soft("/angular_velocity", "velocity").unwrap();
    let hard = |file: &hdf5::File| file.link_hard("/angular_velocity", "velocity").unwrap();
    let virtually = |file: &hdf5::File| {
        let builder = file.new_dataset::<f64>();
        let name = other.to_str().unwrap();
        builder.virtual_map(name, "velocity", (512, 3), .., (512, 3), ..).shape((512, 3)).create("velocity").unwrap();
    };
    let chunked = |file: &hdf5::File| {
        file.new_dataset::<f64>().chunk((8, 3)).shape((512, 3)).create("velocity").unwrap();
    };
    let integers = |file: &hdf5::File| {
        file.new_dataset::<i8>().shape(1).create("velocity").unwrap();
    };
    let more = |file: &hdf5::File| {
        file.create_group("points of another")
            .unwrap()
            .new_attr::<hdf5::types::VarLenUnicode>()
            .create("unit")
            .unwrap();
    };
    type Forgery<'a> = (&'a str, &'a dyn Fn(&hdf5::File));
    let forgeries: [Forgery; 8] = [
        ("external storage", &external),
        ("external link", &link),
        ("soft link", &soft),
        ("hard link to another", &hard),
        ("virtual dataset", &virtually),
        ("chunks", &chunked),
        ("another type and shape", &integers),
        ("nothing, and more points", &more),
    ];
    for (what, forge) in forgeries {
        std::fs::write(&victim, &of_victim).unwrap();
        let file = hdf5::File::create(&other).unwrap();
        velocities(&file);
        file.close().unwrap();
        let of_other = std::fs::read(&other).unwrap();
        std::fs::write(&place, &part).unwrap();
        let file = hdf5::File::open_rw(&place).unwrap();
        file.unlink("velocity").unwrap();
        forge(&file);
        file.close().unwrap();
        let mut bytes = std::fs::read(&place).unwrap();
        let places = sealed::places(&sealed::read(&bytes), bytes.len());
        // HDF5 may have used the room of the velocities for something else.
        places.iter().for_each(|place| bytes[place.bytes.clone()].copy_from_slice(&part[place.bytes.clone()]));
        std::fs::write(&place, &bytes).unwrap();
        assert!(
            matches!(Results::open(&place, &COLUMNS), Err(FileError::Sealed(SealedError::Damaged { .. }))),
            "{what}"
        );
        sealed::seal(&mut bytes, &places);
        std::fs::write(&place, &bytes).unwrap();
        assert_rows(&Results::open(&place, &COLUMNS).unwrap(), ROWS);
        go_on(&place).unwrap();
        assert!(std::fs::read(&path).unwrap() == finished, "{what}");
        assert!(std::fs::read(&victim).unwrap() == of_victim, "{what}");
        assert!(std::fs::read(&other).unwrap() == of_other, "{what}");
    }
}

/// Results of the reader and the writer for a description, and the most memory that the reader held.
fn described(part: &[u8], place: &Path, json: &str) -> (Result<Results, FileError>, usize) {
    let mut bytes = part.to_vec();
    sealed::describe(&mut bytes, json);
    std::fs::write(place, &bytes).unwrap();
    let mut outcome = None;
    let memory = allocation_counter::measure(|| outcome = Some(Results::open(place, &COLUMNS)));
    (outcome.unwrap(), memory.bytes_max as usize)
}

#[test]
fn a_description_that_does_not_fit_the_file_is_refused() {
    let (_folder, path) = folder();
    let [part, _] = files(&path);
    let place = unfinished(&path);
    let sound = sealed::read(&part);
    assert_rows(&described(&part, &place, &sound.to_string()).0.unwrap(), ROWS);
    let length = part.len() as u64;
    let start = |dataset: &str| sound["datasets"][dataset]["start"].as_u64().unwrap();
    let set_in = |value: &Value, pointer: &str, new: Value| {
        let mut forged = value.clone();
        *forged.pointer_mut(pointer).unwrap_or_else(|| panic!("{pointer}")) = new;
        forged
    };
    let pointer = |dataset: &str, what: &str| format!("/datasets/{}/{what}", dataset.replace('/', "~1"));
    let set = |dataset: &str, what: &str, value: Value| set_in(&sound, &pointer(dataset, what), value).to_string();
    let sound_metadata = sealed::metadata(&sound);
    let with_metadata = |text: String| set_in(&sound, "/texts/metadata", json!(text)).to_string();
    let set_metadata = |pointer: &str, value| with_metadata(set_in(&sound_metadata, pointer, value).to_string());
    let without = |path: &str| {
        let mut forged = sound.clone();
        forged["datasets"].as_object_mut().unwrap().remove(path).unwrap();
        forged
    };
    let [velocity, position] = ["bodies/body/velocity", "bodies/body/position"];
    let [nodes, shapes_at] = ["bodies/body/model/mesh/nodes", "bodies/body/model/shapes"];
    let vast = u64::MAX;
    for json in [
        // Two in one place, partly in one place, in the head, on the end, beyond it.
        set(velocity, "start", json!(start(position))),
        set(velocity, "start", json!(start(position) + 8)),
        set(velocity, "start", json!(start("checkpoint"))),
        set("time", "start", json!(0)),
        set("time", "start", json!(60)),
        set("checkpoint", "start", json!(length - 8)),
        set("checkpoint", "start", json!(length)),
        set("time", "start", json!(vast)),
        set("time", "start", json!(vast - 4000)),
        set("time", "start", json!(-8)),
        set("time", "start", json!(8.5)),
        set_in(&sound, "/datasets", json!({})).to_string(),
        set_in(&sound, "/datasets", json!([])).to_string(),
        without(velocity).to_string(),
        without("time").to_string(),
        without("checkpoint").to_string(),
        set(nodes, "start", json!(start(position))),
        set(shapes_at, "start", json!(length - 8)),
        set(shapes_at, "shape", json!([vast, 3, 3])),
        set(shapes_at, "shape", json!([1_u64 << 61, 1_u64 << 61, 3])),
        set("time", "shape", json!([513])),
        set("time", "shape", json!([vast])),
        set("time", "shape", json!([vast / 8])),
        set("time", "shape", json!([1_u64 << 61])),
        set("time", "shape", json!([])),
        set("time", "shape", Value::Null),
        set("time", "kind", json!("u64")),
        set("time", "kind", json!("f32")),
        set(velocity, "hash", json!("0".repeat(64))),
        set("checkpoint", "shape", json!([2, 1 << 16])),
        set("checkpoint", "shape", json!([2, vast])),
        set("checkpoint", "shape", json!([3, 1])),
        set("checkpoint", "shape", json!([])),
        set("checkpoint", "kind", json!("f64")),
        set("checkpoint", "hash", json!("0".repeat(64))),
        set_in(&sound, "/texts", json!({})).to_string(),
        with_metadata(String::new()),
        with_metadata("null".into()),
        set_metadata("/bodies", json!([])),
        set_metadata("/bodies/0/name", json!("../body")),
        set_metadata("/bodies/0/name", json!("another")),
        set_metadata("/bodies/0/model/frequencies", json!(vec![1.0; 1000])),
        set_metadata("/bodies/0/model/frequencies", json!([])),
        set_metadata("/bodies/0/model/mass", json!("heavy")),
        set_metadata("/bodies/0/point_names", json!([])),
        set_metadata("/bodies/0/point_names", json!(["P1", "P2"])),
        set_metadata("/bodies/0/point_names", json!(["P1", "P1"])),
        set_metadata("/bodies/0/point_names", json!(["../P1"])),
        set_metadata("/bodies/0/point_names", json!(["\0"])),
        set_metadata("/scene_file", json!([255, 254])),
        with_metadata(sound_metadata.to_string().replace("1.0e-4", "1e999").replace("0.0001", "1e999")),
        "".into(),
        "[".repeat(100_000),
        "{\"datasets\":{\"time\":{\"shape\":[".to_owned() + &"0,".repeat(100_000) + "0]}}}",
        with_metadata("{\"input_files\":[".to_owned() + &"\"\",".repeat(100_000) + "\"\"]}"),
    ] {
        let shown = &json[..json.len().min(200)];
        let (outcome, memory) = described(&part, &place, &json);
        let error = outcome.err().unwrap_or_else(|| panic!("accepted: {shown}")).to_string();
        assert!(error.len() < 500, "{error}");
        println!(
            "{:.1} bytes of memory for a byte: {}",
            memory as f64 / json.len().max(part.len()) as f64,
            &shown[..shown.len().min(50)]
        );
        // An empty name takes 24 bytes for three; a list that grows is held twice for a moment.
        assert!(memory < 40 * json.len().max(part.len() / 10), "{memory} bytes for {}: {shown}", json.len());
        assert!(Writer::resume(&place, &COLUMNS, true).is_err(), "{shown}");
    }
    // Datasets that are within the file, but no shapes.
    let shapes_of = |forged: Value| {
        drop(described(&part, &place, &forged.to_string()).0.unwrap());
        Results::open_with_shapes(&place, &COLUMNS).map(|(_, shapes)| shapes)
    };
    assert_eq!(shapes_of(sound.clone()).unwrap(), [Some(shapes(2))]);
    let datasets = sound["datasets"].as_object().unwrap().iter();
    assert_eq!(datasets.filter(|(_, dataset)| dataset["hash"] != Value::Null).count(), 9);
    let of_body = |name: &str| format!("bodies/body/model/{name}");
    for lacks in [
        "mesh/nodes",
        "mesh/positions",
        "mesh/surface_triangles",
        "shapes",
        "large_deflection/products",
        "stress/shapes",
        "stress/products",
    ] {
        let error = shapes_of(without(&of_body(lacks))).unwrap_err();
        assert!(matches!(error, FileError::Sealed(SealedError::Damaged { .. })), "{lacks}: {error}");
    }
    for (dataset, shape) in [
        ("mesh/nodes", json!([2])),
        ("mesh/surface_triangles", json!([6])),
        ("shapes", json!([1, 3, 3])),
        ("shapes", json!([vast, 0, 3])),
        ("large_deflection/products", json!([1, 2])),
        ("stress/nodes", json!([3])),
    ] {
        let error = shapes_of(set_in(&sound, &pointer(&of_body(dataset), "shape"), shape)).unwrap_err();
        assert!(
            matches!(error, FileError::Sealed(SealedError::Damaged { .. }) | FileError::WrongLength { .. }),
            "{dataset}: {error}"
        );
    }
    // Text that is no UTF-8.
    let at = sealed::description(&part).start + sound.to_string().find("platten").unwrap();
    for byte in [0x80, 0xff] {
        let mut bytes = part.clone();
        bytes[at] = byte;
        let places = sealed::places(&sound, bytes.len());
        sealed::seal(&mut bytes, &places);
        std::fs::write(&place, &bytes).unwrap();
        assert!(matches!(Results::open(&place, &COLUMNS), Err(FileError::Sealed(SealedError::Damaged { .. }))));
    }
}

/// Knuth's MMIX linear congruential generator.
fn next(state: &mut u64) -> usize {
    *state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
    (*state >> 33) as usize
}

/// Whatever the bytes, the reader ends with rows or an error, and so does a run that goes on with them.
#[test]
fn changed_bytes_under_a_right_seal_do_no_harm() {
    let (_folder, path) = folder();
    let [part, _] = files(&path);
    let place = unfinished(&path);
    let sound = sealed::places(&sealed::read(&part), part.len());
    let (mut read, mut refused, mut finished) = (0, 0, 0);
    let mut attempt = |mut bytes: Vec<u8>, to_the_end: bool| {
        let description = serde_json::from_slice(bytes.get(sealed::description(&bytes)).unwrap_or_default());
        let places = description.map_or_else(|_| sound.clone(), |json| sealed::places(&json, bytes.len()));
        sealed::seal(&mut bytes, &places);
        std::fs::write(&place, &bytes).unwrap();
        let mut outcome = None;
        let memory = allocation_counter::measure(|| outcome = Some(Results::open(&place, &COLUMNS)));
        assert!(memory.bytes_max < 3 * bytes.len() as u64, "{} bytes for {}", memory.bytes_max, bytes.len());
        match outcome.unwrap() {
            Ok(_) => read += 1,
            Err(error) => {
                assert!(error.to_string().len() < 500, "{error}");
                refused += 1;
            }
        }
        if to_the_end && let Ok(Resumed { writer, .. }) = Writer::resume(&place, &COLUMNS, true) {
            // Only a text that HDF5 cannot hold keeps it from its end.
            match writer.finish() {
                Ok(()) => finished += 1,
                Err(error) => assert!(matches!(error, FileError::NulInText { .. }), "{error}"),
            }
        }
    };
    // Bytes of the head, of the description and of HDF5's own.
    let forgeries: Option<usize> = std::env::var("FLEXFRAME_FORGERIES").ok().map(|count| count.parse().unwrap());
    for at in (0..part.len()).step_by(if forgeries.is_some() { 1 } else { 3 }) {
        if sound.iter().any(|place| place.bytes.contains(&at)) || (24..32).contains(&at) || (40..72).contains(&at) {
            continue;
        }
        let mut bytes = part.clone();
        bytes[at] ^= [1 << (at / 2 % 8), 0xff][at % 2];
        attempt(bytes, at % 512 == 0);
    }
    // Several at once, among them numbers and checkpoints.
    let mut state = 1;
    for i in 0..forgeries.unwrap_or(1000) {
        let mut bytes = part.clone();
        for _ in 0..1 + next(&mut state) % 8 {
            let at = next(&mut state) % if next(&mut state).is_multiple_of(4) { bytes.len() } else { 4096 };
            bytes[at] = next(&mut state) as u8;
        }
        attempt(bytes, i % 20 == 0);
    }
    println!("{read} read, {refused} refused, {finished} brought to their end");
    assert!(read > 3_000 && refused > 500 && finished > 30, "{read} {refused} {finished}");
}
