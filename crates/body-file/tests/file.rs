//! Body files are read back as they were written, and refused where they are not.

use std::collections::BTreeMap;
use std::path::Path;

use body_file::{Array, BodyFile, BodyFileError, Declared, Kind, Writer};

fn declared(path: &str, kind: Kind, shape: &[usize]) -> Declared {
    let attributes = vec![("unit", "mm".to_owned())];
    Declared { path: path.to_owned(), kind, shape: shape.to_vec(), attributes, same_as: None }
}

fn write(path: &Path) {
    write_as(false, path);
}

fn write_as(is_plain: bool, path: &Path) {
    let texts = BTreeMap::from([("scene".to_owned(), "a = 1\nω".to_owned())]);
    let second = Declared { same_as: Some("modes/shapes".into()), ..declared("answers/0/x", Kind::F64, &[2, 2, 3]) };
    let datasets = [
        declared("modes/shapes", Kind::F64, &[2, 2, 3]),
        declared("mesh/tetrahedra", Kind::U32, &[1, 10]),
        declared("tags", Kind::U64, &[3]),
        declared("mass", Kind::F64, &[]),
        declared("none", Kind::F64, &[0, 3]),
        second,
    ];
    let mut writer =
        if is_plain { Writer::plain(path, texts, &datasets) } else { Writer::create(path, texts, &datasets) }.unwrap();
    writer.write("modes/shapes", &SHAPES).unwrap();
    writer.write("mesh/tetrahedra", &[0u32, 1, 2, 3, 4, 5, 6, 7, 8, 9]).unwrap();
    writer.write("tags", &[u64::MAX, 7, 0]).unwrap();
    writer.write("mass", &[2.5]).unwrap();
    writer.write::<f64>("none", &[]).unwrap();
    writer.finish(true).unwrap();
}

const SHAPES: [f64; 12] = [1.0, -0.0, 3.0, 1e-300, 5.0, 6.0, 7.0, 8.0, 9.0, 10.0, 11.0, 12.5];

/// Independent reference: HDF5 reads the numbers.
#[test]
fn what_is_written_is_read_back_by_us_and_by_hdf5() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("b.body.h5");
    write(&path);
    check(&path);
    let other = hdf5::File::open(&path).unwrap();
    assert_eq!(other.dataset("modes/shapes").unwrap().read_raw::<f64>().unwrap(), SHAPES);
    assert_eq!(other.dataset("answers/0/x").unwrap().read_raw::<f64>().unwrap(), SHAPES);
    assert_eq!(other.dataset("tags").unwrap().read_raw::<u64>().unwrap(), [u64::MAX, 7, 0]);
    let unit = other.dataset("mass").unwrap().attr("unit").unwrap();
    assert_eq!(unit.read_scalar::<hdf5::types::VarLenUnicode>().unwrap().as_str(), "mm");
    // Without HDF5, the same is read, and a bit that changes is found.
    write_as(true, &path);
    check(&path);
    let mut bytes = std::fs::read(&path).unwrap();
    assert!(hdf5::File::open(&path).is_err());
    let at = bytes.windows(8).position(|number| number == 12.5f64.to_ne_bytes()).unwrap();
    bytes[at] ^= 1;
    std::fs::write(&path, bytes).unwrap();
    let changed = BodyFile::open(&path).unwrap().read::<f64>("modes/shapes").unwrap_err();
    assert!(changed.to_string().contains("has been changed"), "{changed}");
}

/// Reads it back.
fn check(path: &Path) {
    let file = BodyFile::open(path).unwrap();
    assert_eq!(file.attribute("scene"), Some("a = 1\nω"));
    let shapes: Array<f64> = file.read("modes/shapes").unwrap();
    assert_eq!(shapes.shape, [2, 2, 3]);
    assert!(shapes.values.iter().zip(SHAPES).all(|(a, b)| a.to_bits() == b.to_bits()));
    assert_eq!(file.read::<f64>("answers/0/x").unwrap(), shapes);
    assert_eq!(file.read::<u64>("tags").unwrap().values, [u64::MAX, 7, 0]);
    assert_eq!(file.read::<f64>("mass").unwrap(), Array { shape: vec![], values: vec![2.5] });
    assert_eq!(file.read::<f64>("none").unwrap(), Array { shape: vec![0, 3], values: vec![] });
    assert!(!file.has("other") && file.datasets().count() == 6);
}

#[test]
fn what_is_not_as_it_was_written_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("b.body.h5");
    write(&path);
    let whole = std::fs::read(&path).unwrap();
    let open = |bytes: &[u8]| {
        std::fs::write(&path, bytes).unwrap();
        BodyFile::open(&path)
    };
    let message = |bytes: &[u8]| open(bytes).unwrap_err().to_string();

    assert!(matches!(open(b"").unwrap_err(), BodyFileError::NotABody { .. }));
    assert!(matches!(open(&whole[512..]).unwrap_err(), BodyFileError::NotABody { .. }));
    let cut = message(&whole[..whole.len() - 8]);
    assert!(cut.contains(&format!("it has {} bytes where {} were written", whole.len() - 8, whole.len())), "{cut}");

    let mut version = whole.clone();
    version[16] += 1;
    assert!(message(&version).contains("of version 2, and this program reads version 1"), "{}", message(&version));
    let mut order = whole.clone();
    order[16..20].reverse();
    order[20..24].reverse();
    assert!(matches!(open(&order).unwrap_err(), BodyFileError::OtherMachine { .. }));

    let file = open(&whole).unwrap();
    let missing = file.read::<f64>("static_shapes/shapes").unwrap_err().to_string();
    assert!(missing.contains("has no dataset static_shapes/shapes"), "{missing}");
    assert!(file.read::<u64>("mass").unwrap_err().to_string().contains("of another kind"));
}

/// Each single bit that changes is found, in the head or in the dataset that it is in; elsewhere it changes nothing that is
/// read.
#[test]
fn every_changed_bit_is_found() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("b.body.h5");
    write(&path);
    let whole = std::fs::read(&path).unwrap();
    let needle: Vec<u8> = SHAPES.iter().flat_map(|x| x.to_ne_bytes()).collect();
    let start = whole.windows(needle.len()).position(|window| window == needle).unwrap();
    let described = u64::from_ne_bytes(whole[32..40].try_into().unwrap()) as usize;
    let flipped = |at: usize, bit: u8| {
        let mut bytes = whole.clone();
        bytes[at] ^= 1 << bit;
        std::fs::write(&path, bytes).unwrap();
        BodyFile::open(&path)
    };
    for at in (0..72 + described).step_by(5) {
        assert!(flipped(at, (at % 8) as u8).is_err(), "byte {at}");
    }
    for at in start..start + needle.len() {
        let file = flipped(at, (at % 8) as u8).unwrap();
        let error = file.read::<f64>("modes/shapes").unwrap_err();
        assert!(error.to_string().contains("dataset modes/shapes has been changed"), "{error}");
        assert!(file.read::<f64>("mass").is_ok());
    }
}

#[test]
fn a_file_appears_when_it_is_whole() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("b.body.h5");
    let mut writer = Writer::create(&path, BTreeMap::new(), &[declared("a", Kind::F64, &[2])]).unwrap();
    assert!(writer.write("a", &[1.0]).is_err() && writer.write("a", &[1u64, 2]).is_err());
    assert!(writer.write("b", &[1.0]).is_err() && !path.exists());
    let error = writer.finish(false).unwrap_err();
    assert!(matches!(error, BodyFileError::Declared { .. }), "{error}");
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 0);

    let nowhere = folder.path().join("nowhere/b.body.h5");
    assert!(Writer::create(&nowhere, BTreeMap::new(), &[]).unwrap_err().to_string().contains("cannot create the file"));
}
