//! Keeps the library in the memory of the importing program once it is there: threads that have been started for the body
//! sleep in its code, whatever becomes of the FMU.

fn main() {
    if std::env::var("CARGO_CFG_TARGET_OS").is_ok_and(|system| system == "linux") {
        println!("cargo::rustc-cdylib-link-arg=-Wl,-z,nodelete");
    }
    println!("cargo::rerun-if-changed=build.rs");
}
