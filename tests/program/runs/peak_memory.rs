//! The memory that is printed is the memory that is used.
//!
//! Each model is made in a process of its own: this program, told by a variable which scene to take.

use std::path::Path;
use std::process::Command;

use flexframe::model::Builder;
use flexframe::modes::modes;
use scene::{Body, Flexible};

const SCENE: &str = "FLEXFRAME_PEAK_SCENE";

/// Bytes of a line of /proc/self/status.
fn status(key: &str) -> f64 {
    let text = std::fs::read_to_string("/proc/self/status").unwrap();
    let line = text.lines().find_map(|line| line.strip_prefix(key)).unwrap();
    1024.0 * line.split_whitespace().next().unwrap().parse::<f64>().unwrap()
}

#[test]
#[cfg(target_os = "linux")]
fn the_memory_that_is_printed_is_used() {
    if let Ok(asked) = std::env::var(SCENE) {
        let (path, count) = asked.split_once('*').unwrap();
        let mut body = Body::read(path).unwrap();
        body.modes.flexible = Flexible::Count(count.parse().unwrap());
        let before = status("VmRSS:");
        let (_, report) = modes(&body, &Builder::default(), None, |_| {}).unwrap();
        let (used, estimate) = (status("VmHWM:") - before, report.number("mesh.peak_bytes").unwrap());
        println!("{asked}: {:.0} MB used, {:.0} MB estimate", 1e-6 * used, 1e-6 * estimate);
        assert!((0.8..1.2).contains(&(estimate / used)), "{asked}: {estimate:e} estimate, {used:e} used");
        return;
    }
    let examples = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../..")).join("examples").canonicalize().unwrap();
    for (scene, count) in [("plate.toml", 10), ("plate.toml", 150), ("nafems_fv12.toml", 10)] {
        let output = Command::new(std::env::current_exe().unwrap())
            .args(["--exact", "runs::peak_memory::the_memory_that_is_printed_is_used", "--nocapture"])
            .env(SCENE, format!("{}*{count}", examples.join(scene).display()))
            .output()
            .unwrap();
        let words = String::from_utf8_lossy(&output.stdout) + String::from_utf8_lossy(&output.stderr);
        println!("{words}");
        assert!(output.status.success(), "{words}");
    }
}
