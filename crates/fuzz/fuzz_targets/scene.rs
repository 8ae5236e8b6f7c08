//! The reader of scenes: a scene, or an error that has a place and a message.
#![no_main]

use libfuzzer_sys::fuzz_target;
use scene::{Body, Scene};

fuzz_target!(|text: &str| {
    let path = "/nowhere/fuzzed.toml";
    let alone = Body::parse(text, path).map(drop);
    for error in [alone, Scene::parse(text, path).map(drop)].into_iter().filter_map(Result::err) {
        let place = error.place().expect("every error of a text has a place");
        assert!(place.line >= 1 && place.line <= 1 + text.matches('\n').count());
        assert!(!error.to_string().is_empty());
    }
});
