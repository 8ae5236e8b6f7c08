//! The reader of scenes: a scene, or an error that has a place and a message.
#![no_main]

use libfuzzer_sys::fuzz_target;
use scene::Scene;

fuzz_target!(|text: &str| {
    if let Err(error) = Scene::parse(text, "/nowhere/fuzzed.toml") {
        let place = error.place().expect("every error of a text has a place");
        assert!(place.line >= 1 && place.line <= 1 + text.matches('\n').count());
        assert!(!error.to_string().is_empty());
    }
});
