//! What can go wrong with a results file or a figure.

use std::path::PathBuf;

/// An error of the HDF5 writer or reader.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum FileError {
    /// The HDF5 library refused an operation.
    #[error("{path}: cannot {action}: {source}", path = .path.display())]
    Hdf5 {
        /// The results file.
        path: PathBuf,
        /// What was being done, for instance "create dataset modal/displacement".
        action: String,
        /// The library's own message.
        source: hdf5::Error,
    },
    /// A point's name cannot be the name of an HDF5 group, or occurs twice.
    #[error(
        "{path}: the output point \"{name}\" cannot be stored: {reason}; give it another name",
        path = .path.display()
    )]
    PointName {
        /// The results file.
        path: PathBuf,
        /// The name as given.
        name: String,
        /// Why it is refused.
        reason: &'static str,
    },
    /// A text holds a NUL character, at which HDF5 strings end.
    #[error("{path}: the text of `{attribute}` holds a NUL character; remove it", path = .path.display())]
    NulInText {
        /// The results file.
        path: PathBuf,
        /// The attribute that was to hold the text.
        attribute: String,
    },
    /// A sample or the metadata have a list of the wrong length.
    #[error("{path}: {quantity} has {found} values where {expected} are expected", path = .path.display())]
    WrongLength {
        /// The results file.
        path: PathBuf,
        /// Name of the quantity.
        quantity: String,
        /// The length that the metadata ask for.
        expected: usize,
        /// The length given.
        found: usize,
    },
    /// A NaN or an infinity in a sample; the sample is not stored, those before it are.
    #[error(
        "{path}: {quantity} is {value} at time {time}: the run has become unstable there; \
         use a smaller step (the samples before it are in the file)",
        path = .path.display()
    )]
    NotFinite {
        /// The results file.
        path: PathBuf,
        /// Time of the sample, in the run's unit of time.
        time: f64,
        /// Name of the dataset that was to hold the value.
        quantity: String,
        /// The value.
        value: f64,
    },
    /// A dataset or group of the contract is not in the file.
    #[error("{path}: there is no {dataset}; is it a results file of flexframe?", path = .path.display())]
    MissingDataset {
        /// The results file.
        path: PathBuf,
        /// The dataset or group that was looked for.
        dataset: String,
    },
    /// An attribute of the contract is not in the file.
    #[error("{path}: there is no attribute `{attribute}`; is it a results file of flexframe?", path = .path.display())]
    MissingAttribute {
        /// The results file.
        path: PathBuf,
        /// The attribute that was looked for.
        attribute: String,
    },
    /// A text is not in UTF-8.
    #[error("{path}: the attribute `{attribute}` is not text in UTF-8; is the file damaged?", path = .path.display())]
    NotUtf8 {
        /// The results file.
        path: PathBuf,
        /// The attribute.
        attribute: String,
    },
    /// The histories claim more numbers than the file can hold.
    #[error(
        "{path}: the datasets claim {claimed} bytes of numbers, more than the {length} bytes of the file; it is damaged, \
         or was compressed (h5repack without a filter undoes that)",
        path = .path.display()
    )]
    ClaimsTooMuch {
        /// The results file.
        path: PathBuf,
        /// Bytes that the shapes of the datasets come to.
        claimed: u128,
        /// Bytes of the file.
        length: u64,
    },
    /// A dataset has a shape other than the contract's.
    #[error("{path}: {dataset} has the shape {found:?} where {expected} is expected", path = .path.display())]
    WrongShape {
        /// The results file.
        path: PathBuf,
        /// Name of the dataset.
        dataset: String,
        /// The shape expected, `T` standing for any number of rows.
        expected: String,
        /// The shape found.
        found: Vec<usize>,
    },
}

/// An error of a figure.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum FigureError {
    /// The file could not be written.
    #[error("{path}: cannot write the figure: {reason}", path = .path.display())]
    Write {
        /// The figure's file.
        path: PathBuf,
        /// The message of the drawing library or the operating system.
        reason: String,
    },
    /// The drawing library failed on a picture held in memory.
    #[error("cannot draw the figure: {reason}")]
    Draw {
        /// The message of the drawing library.
        reason: String,
    },
    /// There is nothing to draw.
    #[error("the figure \"{figure}\" has no {what}; give it at least one")]
    Empty {
        /// Title of the figure.
        figure: String,
        /// What is missing.
        what: &'static str,
    },
    /// A NaN or an infinity in the data.
    #[error("the figure \"{figure}\" has a value that is not finite: {what}, entry {index}")]
    NotFinite {
        /// Title of the figure.
        figure: String,
        /// The series, panel or frame.
        what: String,
        /// Index in it, from 0.
        index: usize,
    },
    /// A logarithmic axis cannot show zero or a negative number.
    #[error(
        "the figure \"{figure}\" has a logarithmic axis but series \"{series}\" holds {value}, entry {index}; \
         leave the entry out or use a linear axis"
    )]
    NotPositive {
        /// Title of the figure.
        figure: String,
        /// Label of the series.
        series: String,
        /// Index in the series, from 0.
        index: usize,
        /// The value.
        value: f64,
    },
    /// Lists that belong together differ in length.
    #[error("the figure \"{figure}\": {what} has {found} entries where {expected} are expected")]
    WrongLength {
        /// Title of the figure.
        figure: String,
        /// The list.
        what: String,
        /// Length expected.
        expected: usize,
        /// Length found.
        found: usize,
    },
    /// A triangle, edge or trace names a point that is not there.
    #[error("the figure \"{figure}\": {what} names point {index}, but there are {count} points")]
    NoSuchPoint {
        /// Title of the figure.
        figure: String,
        /// What names it.
        what: &'static str,
        /// The index, from 0.
        index: usize,
        /// The number of points.
        count: usize,
    },
}
