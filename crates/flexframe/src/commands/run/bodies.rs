//! What is told about the runs of all bodies of a scene.

use std::fmt;

use serde::ser::{Serialize, SerializeMap, Serializer};

use super::report::RunReport;

/// The runs of the bodies of a scene, in its order. As JSON it is an object of the names, and of a single body its report.
#[derive(Debug, Clone)]
pub struct BodyRuns(pub Vec<(Option<String>, RunReport)>);

impl fmt::Display for BodyRuns {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (i, (name, report)) in self.0.iter().enumerate() {
            if i > 0 {
                f.write_str("\n\n")?;
            }
            if let Some(name) = name {
                writeln!(f, "body {name}")?;
            }
            write!(f, "{report}")?;
        }
        Ok(())
    }
}

impl Serialize for BodyRuns {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        if let [(None, report)] = &self.0[..] {
            return report.serialize(serializer);
        }
        let mut map = serializer.serialize_map(Some(self.0.len()))?;
        for (name, report) in &self.0 {
            map.serialize_entry(name.as_deref().unwrap_or_default(), report)?;
        }
        map.end()
    }
}
