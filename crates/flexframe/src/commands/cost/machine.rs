//! Where times were measured.

use std::fmt;

use serde::Serialize;

/// A computer.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct Machine {
    /// Name of the processor, where the system tells it.
    pub processor: Option<String>,
    /// Cores that the program may use; the loop uses one.
    pub cores: usize,
    /// Architecture and operating system.
    pub system: String,
}

impl Machine {
    /// The one that this runs on.
    pub fn this() -> Self {
        let cpuinfo = std::fs::read_to_string("/proc/cpuinfo").unwrap_or_default();
        let name = |line: &str| Some(line.strip_prefix("model name")?.split_once(':')?.1.trim().to_owned());
        Self {
            processor: cpuinfo.lines().find_map(name),
            cores: std::thread::available_parallelism().map_or(1, usize::from),
            system: format!("{}, {}", std::env::consts::ARCH, std::env::consts::OS),
        }
    }
}

impl fmt::Display for Machine {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let processor = self.processor.as_deref().unwrap_or("processor unknown");
        write!(f, "{processor} ({}), one of {} cores", self.system, self.cores)
    }
}
