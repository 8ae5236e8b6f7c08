//! Sealed files are read back as they were written, and refused where they are not.

use std::collections::BTreeMap;
use std::fs::OpenOptions;
use std::os::unix::fs::FileExt;
use std::path::Path;

use keys::Hash;
use sealed::{Array, Declared, Format, Kind, Made, SealedError, SealedFile, Writer, little_endian};

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
    let changed = SealedFile::open(&path, Format::BODY).unwrap().read::<f64>("modes/shapes").unwrap_err();
    assert!(changed.to_string().contains("has been changed"), "{changed}");
}

/// Reads it back.
fn check(path: &Path) {
    let file = SealedFile::open(path, Format::BODY).unwrap();
    assert_eq!(file.text("scene"), Some("a = 1\nω"));
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
        SealedFile::open(&path, Format::BODY)
    };
    let message = |bytes: &[u8]| open(bytes).unwrap_err().to_string();

    assert!(matches!(open(b"").unwrap_err(), SealedError::NoSeal { .. }));
    assert!(matches!(open(&whole[512..]).unwrap_err(), SealedError::NoSeal { .. }));
    let cut = message(&whole[..whole.len() - 8]);
    assert!(cut.contains(&format!("it has {} bytes where {} were written", whole.len() - 8, whole.len())), "{cut}");

    assert!(whole.starts_with(b"flexframe body, v. 2   \n"));
    let mut version = whole.clone();
    version[19] = b'3';
    assert!(message(&version).contains("of version 3, and this program reads version 2"), "{}", message(&version));
    open(&whole).unwrap();
    assert!(Format::BODY.is_claimed(&path) && !Format::RESULTS.is_claimed(&path));
    let other = SealedFile::open(&path, Format::RESULTS).unwrap_err();
    assert!(matches!(other, SealedError::NoSeal { .. }), "{other}");

    let file = open(&whole).unwrap();
    let missing = file.read::<f64>("static_shapes/shapes").unwrap_err().to_string();
    assert!(missing.contains("has no dataset static_shapes/shapes"), "{missing}");
    assert!(file.read::<u64>("mass").unwrap_err().to_string().contains("of another kind"));
}

/// Each byte that changes is found: in the head and in HDF5's own when the file is opened, in a dataset when that is read.
#[test]
fn every_changed_byte_is_found() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("b.body.h5");
    write(&path);
    let whole = std::fs::read(&path).unwrap();
    let file = OpenOptions::new().write(true).open(&path).unwrap();
    let mut in_datasets = 0;
    for at in 0..whole.len() {
        file.write_at(&[whole[at] ^ 1 << (at % 8)], at as u64).unwrap();
        if let Ok(file) = SealedFile::open(&path, Format::BODY) {
            let read = ["modes/shapes", "mass"].map(|dataset| file.read::<f64>(dataset).err());
            let others = [file.read::<u32>("mesh/tetrahedra").err(), file.read::<u64>("tags").err()];
            let errors: Vec<_> = read.into_iter().chain(others).flatten().map(|error| error.to_string()).collect();
            assert!(errors.len() == 1 && errors[0].contains("has been changed"), "byte {at}: {errors:?}");
            in_datasets += 1;
        }
        file.write_at(&whole[at..=at], at as u64).unwrap();
    }
    assert_eq!(in_datasets, 8 * 12 + 4 * 10 + 8 * 3 + 8);
}

/// A dataset without a hash is written in place; sealed, it is as it was.
#[test]
fn numbers_that_change_are_sealed_at_the_end() {
    let folder = tempfile::tempdir().unwrap();
    let [path, copy] = ["a.h5", "b.h5"].map(|name| folder.path().join(name));
    let texts = BTreeMap::from([("what".to_owned(), "a run".to_owned())]);
    let datasets = [declared("row", Kind::F64, &[3]), declared("fixed", Kind::F64, &[2])];
    let make = |path: &Path| {
        let made = Made { place: path, path, format: Format::RESULTS, texts: &texts, datasets: &datasets };
        made.by_hdf5::<SealedError>(|_| Ok(())).unwrap()
    };
    let mut file = make(&path);
    file.write_at("fixed", 0, &[4.0, 5.0]).unwrap();
    file.seal("fixed", &Hash::of(&little_endian(&[4.0, 5.0])));
    file.write_head().unwrap();
    file.write_at("row", 1, &[1.0, 2.0]).unwrap();
    assert!(matches!(file.write_at("row", 2, &[0.0; 2]), Err(SealedError::Declared { .. })));
    let read = SealedFile::open(&path, Format::RESULTS).unwrap();
    assert_eq!(read.read::<f64>("row").unwrap().values, [0.0, 1.0, 2.0]);
    assert_eq!(read.read_first::<f64>("row", 2).unwrap(), [0.0, 1.0]);
    assert_eq!(read.read_first::<f64>("row", 9).unwrap(), [0.0, 1.0, 2.0]);

    let mut sealed = make(&copy);
    let hash = sealed.copy_from(&read, "row", 24).unwrap();
    sealed.seal("row", &hash);
    assert!(matches!(sealed.copy_from(&read, "row", 32), Err(SealedError::Declared { .. })));
    // What has been damaged is not sealed again.
    file.write_at("fixed", 0, &[4.5]).unwrap();
    assert!(matches!(sealed.copy_from(&read, "fixed", 16), Err(SealedError::Damaged { .. })));
    sealed.write_head().unwrap();
    let whole = SealedFile::open(&copy, Format::RESULTS).unwrap();
    assert_eq!(whole.read::<f64>("row").unwrap().values, [0.0, 1.0, 2.0]);
    sealed.write_at("row", 0, &[1.0]).unwrap();
    assert!(matches!(whole.read::<f64>("row"), Err(SealedError::Damaged { .. })));
}

#[test]
fn a_file_appears_when_it_is_whole() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("b.body.h5");
    let mut writer = Writer::create(&path, BTreeMap::new(), &[declared("a", Kind::F64, &[2])]).unwrap();
    assert!(writer.write("a", &[1.0]).is_err() && writer.write("a", &[1u64, 2]).is_err());
    assert!(writer.write("b", &[1.0]).is_err() && !path.exists());
    let error = writer.finish(false).unwrap_err();
    assert!(matches!(error, SealedError::Declared { .. }), "{error}");
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 0);

    let nowhere = folder.path().join("nowhere/b.body.h5");
    assert!(Writer::create(&nowhere, BTreeMap::new(), &[]).unwrap_err().to_string().contains("cannot create the file"));
}
