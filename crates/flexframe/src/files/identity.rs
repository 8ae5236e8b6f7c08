//! Numbers for what a run reads: a run goes on, and a row of a sweep is kept, only while they are the same.

use keys::{Digest, Hash, Key};
use model::files_of_body;
use scene::{Body, BodySource, Measured, MeasuredMode, Scene};

/// A number for what the files hold that a system names: all tables as they were read, and the files that the bodies are read from,
/// whose hash `contents_of` knows. The names of the files do not count: a run goes on from another folder.
pub fn identity_of_files(scene: &Scene, contents_of: impl FnMut(&Body) -> Hash) -> u64 {
    number(with_files(Key::new().of("files", 1), scene, contents_of))
}

/// The same with the texts of the scenes.
pub fn identity_of_row(scene: &Scene, contents_of: impl FnMut(&Body) -> Hash) -> u64 {
    let key = Key::new().of("row", 2);
    let key = scene.bodies.iter().fold(key, |key, body| key.with("scene", body.text_alone.as_str()));
    number(with_files(key, scene, contents_of))
}

fn with_files(key: Key, scene: &Scene, contents_of: impl FnMut(&Body) -> Hash) -> Key {
    let key = scene.tables().fold(key, |key, table| key.with("table", table.points.as_flattened()));
    let measured = scene.bodies.iter().filter_map(|body| body.modes.measured.as_ref());
    let key = measured.fold(key, with_measured);
    scene.bodies.iter().map(contents_of).fold(key, |key, contents| key.with("body", &contents))
}

/// With measured modes as they were read.
fn with_measured(key: Key, Measured { file: _, places, modes }: &Measured) -> Key {
    let key = key.of("measured modes", 1).with("places", &places.len());
    let key = places.iter().fold(key, |key, (point, axis)| key.with("point", point.as_str()).with("axis", axis));
    modes.iter().fold(key, |key, MeasuredMode { line, frequency, deviation, damping_ratio, shape }| {
        let key = key.with("line", line).with("frequency", frequency).with("deviation", deviation);
        key.with("damping ratio", damping_ratio).with("shape", shape)
    })
}

fn number(key: Key) -> u64 {
    let mut first = [0; 8];
    first.copy_from_slice(&key.finish().as_bytes()[..8]);
    u64::from_be_bytes(first)
}

/// Hash of the files of a body.
pub fn contents(source: &BodySource) -> Hash {
    let files = files_of_body(source);
    let digest = files.iter().fold(Digest::new(), |digest, path| {
        // What is no ordinary file can be read only once; what cannot be read fails where it is read.
        let hash = Some(path).filter(|path| path.is_file()).and_then(|path| Hash::of_file(path).ok());
        let hash = hash.map_or_else(String::new, |hash| hash.to_string());
        digest.text(&hash)
    });
    digest.finish()
}
