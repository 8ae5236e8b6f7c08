//! Runs that cannot be written as data, and data that are no run.

/// A run that cannot be written as data, or bytes that cannot be read as one.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
#[allow(missing_docs)] // the message of a variant says what its fields are
pub enum DescriptionError {
    /// A load of one's own.
    #[error(
        "the run has a load that only its program knows: {load}; only point forces, moments and fields of forces can be written as data"
    )]
    Load { load: String },
    /// An element of one's own.
    #[error(
        "the run has a force between bodies that only its program knows: {element}; only springs and bushings can be written as data"
    )]
    Element { element: String },
    /// A law of one's own.
    #[error(
        "the joint \"{joint}\" has a law that only its program knows; only its springs, dampers, stops, friction and motors can be written as data"
    )]
    Law { joint: String },
    /// An equation of one's own.
    #[error(
        "the joint \"{joint}\" has an equation that only its program knows; only joints of a kind can be written as data"
    )]
    Equation { joint: String },
    /// A speed that a program adds to a drive.
    #[error("the drive has a speed that its program adds; only its own history can be written as data")]
    AddedSpeed,
    /// A method that is not of this crate.
    #[error(
        "the run is stepped by the scheme {scheme} of the formulation {formulation}; only those of the conservative formulation can be written as data"
    )]
    Method { formulation: String, scheme: String },
    /// Bytes of something else.
    #[error("these bytes are no run")]
    Other,
    /// A run of another version of the program.
    #[error(
        "the run is written in version {found} of its data, and this program reads version {expected}; write it anew with this program"
    )]
    Version { found: u32, expected: u32 },
    /// Bytes that are too few or damaged.
    #[error("the run cannot be read: {0}; write it anew")]
    Encoding(#[from] postcard::Error),
}
