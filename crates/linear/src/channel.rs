//! Names and units.

/// An input, an output or a state: its name and its unit.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Channel {
    /// Name.
    pub name: String,
    /// Label of its unit.
    pub unit: String,
}

impl Channel {
    /// With a name and the label of a unit.
    pub fn new(name: impl Into<String>, unit: impl Into<String>) -> Self {
        Self { name: name.into(), unit: unit.into() }
    }
}
