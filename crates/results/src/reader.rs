//! Reads a results file back, finished or not.

use crate::checkpoint::{Checkpoint, Sums};
use crate::layout::Quantity;
use crate::{BodyProperties, FileError, Metadata, PointSample, Sample, Units, seal};
use hdf5::types::VarLenUnicode;
use hdf5::{IndexType, IterationOrder};
use ndarray::s;
use std::collections::BTreeMap;
use std::path::Path;

/// A results file in memory; rows are output times.
///
/// Frames and units are those of [`mod@crate::layout`].
#[derive(Debug, Clone, PartialEq)]
pub struct Results {
    /// What the file says of the run as a whole; the points in the order in which they were given.
    pub metadata: Metadata,
    /// Whether the run came to its end.
    pub complete: bool,
    /// Time (T).
    pub time: Vec<f64>,
    /// Unit quaternions w x y z, body to global.
    pub attitude: Vec<[f64; 4]>,
    /// Position of the centre of mass, global.
    pub position: Vec<[f64; 3]>,
    /// Velocity of the centre of mass, global.
    pub velocity: Vec<[f64; 3]>,
    /// Angular velocity, body axes.
    pub angular_velocity: Vec<[f64; 3]>,
    /// Angular acceleration, body axes.
    pub angular_acceleration: Vec<[f64; 3]>,
    /// Coordinates of the flexible modes (T×nf).
    pub modal_displacement: Table,
    /// Their rates (T×nf).
    pub modal_velocity: Table,
    /// Kinetic energy.
    pub kinetic_energy: Vec<f64>,
    /// Strain energy.
    pub strain_energy: Vec<f64>,
    /// Work of the loads since t = 0.
    pub work: Vec<f64>,
    /// Energy that damping has taken since t = 0.
    pub dissipation: Vec<f64>,
    /// Kinetic + strain energy − work + dissipation.
    pub energy_balance: Vec<f64>,
    /// Linear momentum, global.
    pub linear_momentum: Vec<[f64; 3]>,
    /// Angular momentum about the centre of mass, global.
    pub angular_momentum: Vec<[f64; 3]>,
    /// Linear momentum less the impulse of the loads since t = 0, global.
    pub linear_balance: Vec<[f64; 3]>,
    /// Angular momentum less the angular impulse of the loads since t = 0, both about the centre of
    /// mass, global.
    pub angular_balance: Vec<[f64; 3]>,
    /// The points by name.
    pub points: BTreeMap<String, PointHistory>,
}

/// Motion of one point, global components.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct PointHistory {
    /// Displacement from the place at t = 0 in the undeformed body.
    pub displacement: Vec<[f64; 3]>,
    /// Velocity.
    pub velocity: Vec<[f64; 3]>,
    /// Acceleration.
    pub acceleration: Vec<[f64; 3]>,
    /// Part of the acceleration that belongs to the rigid motion.
    pub rigid_acceleration: Vec<[f64; 3]>,
}

/// A T×n table, row by row.
#[derive(Debug, Clone, PartialEq)]
pub struct Table {
    rows: usize,
    width: usize,
    values: Vec<f64>,
}

impl Table {
    /// Number of rows, T.
    pub fn rows(&self) -> usize {
        self.rows
    }

    /// Values per row, n.
    pub fn width(&self) -> usize {
        self.width
    }

    /// Row `i`, if there is one.
    pub fn row(&self, i: usize) -> Option<&[f64]> {
        (i < self.rows).then(|| &self.values[i * self.width..(i + 1) * self.width])
    }

    /// The history of column `k`, if there is one.
    pub fn column(&self, k: usize) -> Option<impl Iterator<Item = f64>> {
        (k < self.width).then(|| self.values.iter().skip(k).step_by(self.width).copied())
    }
}

impl Results {
    /// Reads the whole file. Of an unfinished one, the rows that every dataset has.
    ///
    /// # Errors
    /// [`FileError::NoSeal`] and [`FileError::Damaged`] if it is not what a [`Writer`](crate::Writer) wrote;
    /// [`FileError::System`] and [`FileError::Hdf5`] if it cannot be read, [`FileError::MissingDataset`],
    /// [`FileError::MissingAttribute`], [`FileError::NotUtf8`] or [`FileError::WrongShape`] if it departs from the
    /// contract, [`FileError::ClaimsTooMuch`] if its shapes come to more than the file holds.
    pub fn open(path: impl AsRef<Path>) -> Result<Self, FileError> {
        Ok(Self::open_with_checkpoint(path.as_ref())?.0)
    }

    /// With the last checkpoint of an unfinished file whose rows are as they were then, and their sums.
    pub(crate) fn open_with_checkpoint(path: &Path) -> Result<(Self, Option<(Checkpoint, Sums)>), FileError> {
        seal::check(path)?;
        let file = hdf5::File::open(path).map_err(FileError::hdf5(path, "open the file"))?;
        let source = Source { path, file: &file, length: file.size() };

        let metadata = source.metadata()?;
        let complete = source.attribute::<i64>("complete")? == 1;
        let modes = metadata.body.frequencies.len();
        let names = &metadata.point_names;
        let quantities: Vec<Quantity> = Quantity::all(names.len()).collect();
        let mut rows = usize::MAX;
        for quantity in &quantities {
            rows = rows.min(source.rows_of(&quantity.path(names), quantity.width(modes))?);
        }
        let width: usize = quantities.iter().map(|quantity| quantity.width(modes).unwrap_or(1)).sum();
        source.refuse_if_claimed(rows as u128 * width as u128)?;
        let mut columns = Vec::with_capacity(quantities.len());
        for quantity in &quantities {
            columns.push(source.column(&quantity.path(names), quantity.width(modes), rows)?);
        }
        if !complete {
            // What has not been written is NaN; no run writes what is not finite.
            for (quantity, column) in quantities.iter().zip(&columns) {
                let whole = column.iter().position(|value| !value.is_finite()).unwrap_or(usize::MAX);
                rows = rows.min(whole / quantity.width(modes).unwrap_or(1).max(1));
            }
        }
        let checkpoints = if complete { Vec::new() } else { source.checkpoints()? };
        let sums = |checkpoint: &Checkpoint| {
            let mut sums = Sums::new(columns.len());
            let widths = quantities.iter().map(|quantity| quantity.width(modes).unwrap_or(1));
            sums.add(columns.iter().zip(widths).map(|(column, width)| &column[..checkpoint.rows * width]));
            sums
        };
        let known = checkpoints.iter().map(|checkpoint| checkpoint.rows).max();
        let checkpoint = checkpoints.into_iter().filter(|checkpoint| checkpoint.rows <= rows).find_map(|checkpoint| {
            let sums = sums(&checkpoint);
            (sums.total() == checkpoint.sum_of_rows).then_some((checkpoint, sums))
        });
        if let (Some(known), None) = (known, &checkpoint) {
            let what = format!("its first {known} rows are not those that its checkpoint is for");
            return Err(FileError::Damaged { path: path.to_path_buf(), what });
        }
        let mut column = |quantity: Quantity| {
            let place = quantities.iter().position(|q| *q == quantity);
            let mut values = place.map(|place| std::mem::take(&mut columns[place])).unwrap_or_default();
            values.truncate(rows * quantity.width(modes).unwrap_or(1));
            values
        };

        let mut points = BTreeMap::new();
        for (i, name) in names.iter().enumerate() {
            let history = PointHistory {
                displacement: vectors(column(Quantity::Point(i, 0))),
                velocity: vectors(column(Quantity::Point(i, 1))),
                acceleration: vectors(column(Quantity::Point(i, 2))),
                rigid_acceleration: vectors(column(Quantity::Point(i, 3))),
            };
            points.insert(name.clone(), history);
        }
        let results = Self {
            complete,
            time: column(Quantity::Time),
            attitude: vectors(column(Quantity::Attitude)),
            position: vectors(column(Quantity::Position)),
            velocity: vectors(column(Quantity::Velocity)),
            angular_velocity: vectors(column(Quantity::AngularVelocity)),
            angular_acceleration: vectors(column(Quantity::AngularAcceleration)),
            modal_displacement: Table { rows, width: modes, values: column(Quantity::ModalDisplacement) },
            modal_velocity: Table { rows, width: modes, values: column(Quantity::ModalVelocity) },
            kinetic_energy: column(Quantity::KineticEnergy),
            strain_energy: column(Quantity::StrainEnergy),
            work: column(Quantity::Work),
            dissipation: column(Quantity::Dissipation),
            energy_balance: column(Quantity::EnergyBalance),
            linear_momentum: vectors(column(Quantity::LinearMomentum)),
            angular_momentum: vectors(column(Quantity::AngularMomentum)),
            linear_balance: vectors(column(Quantity::LinearBalance)),
            angular_balance: vectors(column(Quantity::AngularBalance)),
            points,
            metadata,
        };
        Ok((results, checkpoint))
    }

    /// Row `row`, if there is one; `points` is the room for its points.
    pub fn sample<'a>(&'a self, row: usize, points: &'a mut Vec<PointSample>) -> Option<Sample<'a>> {
        points.clear();
        for name in &self.metadata.point_names {
            let point = self.points.get(name)?;
            points.push(PointSample {
                displacement: *point.displacement.get(row)?,
                velocity: *point.velocity.get(row)?,
                acceleration: *point.acceleration.get(row)?,
                rigid_acceleration: *point.rigid_acceleration.get(row)?,
            });
        }
        Some(Sample {
            time: *self.time.get(row)?,
            attitude: *self.attitude.get(row)?,
            position: *self.position.get(row)?,
            velocity: *self.velocity.get(row)?,
            angular_velocity: *self.angular_velocity.get(row)?,
            angular_acceleration: *self.angular_acceleration.get(row)?,
            modal_displacement: self.modal_displacement.row(row)?,
            modal_velocity: self.modal_velocity.row(row)?,
            kinetic_energy: *self.kinetic_energy.get(row)?,
            strain_energy: *self.strain_energy.get(row)?,
            work: *self.work.get(row)?,
            dissipation: *self.dissipation.get(row)?,
            energy_balance: *self.energy_balance.get(row)?,
            linear_momentum: *self.linear_momentum.get(row)?,
            angular_momentum: *self.angular_momentum.get(row)?,
            linear_balance: *self.linear_balance.get(row)?,
            angular_balance: *self.angular_balance.get(row)?,
            points,
        })
    }

    /// Keeps the first `rows` rows only.
    pub(crate) fn truncate(&mut self, rows: usize) {
        let Self {
            metadata: _,
            complete: _,
            time,
            attitude,
            position,
            velocity,
            angular_velocity,
            angular_acceleration,
            modal_displacement,
            modal_velocity,
            kinetic_energy,
            strain_energy,
            work,
            dissipation,
            energy_balance,
            linear_momentum,
            angular_momentum,
            linear_balance,
            angular_balance,
            points,
        } = self;
        for column in [time, kinetic_energy, strain_energy, work, dissipation, energy_balance] {
            column.truncate(rows);
        }
        let vectors = [
            position,
            velocity,
            angular_velocity,
            angular_acceleration,
            linear_momentum,
            angular_momentum,
            linear_balance,
            angular_balance,
        ];
        let of_points = points.values_mut().flat_map(|point| {
            [&mut point.displacement, &mut point.velocity, &mut point.acceleration, &mut point.rigid_acceleration]
        });
        for column in vectors.into_iter().chain(of_points) {
            column.truncate(rows);
        }
        attitude.truncate(rows);
        for table in [modal_displacement, modal_velocity] {
            table.rows = table.rows.min(rows);
            table.values.truncate(table.rows * table.width);
        }
    }
}

/// Groups row-by-row values into rows of `N`.
fn vectors<const N: usize>(values: Vec<f64>) -> Vec<[f64; N]> {
    values.as_chunks().0.to_vec()
}

struct Source<'a> {
    path: &'a Path,
    file: &'a hdf5::File,
    /// Bytes of the file.
    length: u64,
}

impl Source<'_> {
    fn metadata(&self) -> Result<Metadata, FileError> {
        let frequencies = self.vector("body/frequencies", None)?;
        let modes = frequencies.len();
        let inertia = self.fixed("body/inertia", &[3, 3])?;
        let center_of_mass = self.fixed("body/center_of_mass", &[3])?;
        let body = BodyProperties {
            mass: self.fixed("body/mass", &[])?[0],
            center_of_mass: [center_of_mass[0], center_of_mass[1], center_of_mass[2]],
            inertia: [0, 3, 6].map(|i| [inertia[i], inertia[i + 1], inertia[i + 2]]),
            damping_ratios: self.vector("body/damping_ratios", Some(modes))?,
            frequencies,
        };
        Ok(Metadata {
            title: self.text("title")?,
            units: Units {
                length: self.text("units_length")?,
                mass: self.text("units_mass")?,
                time: self.text("units_time")?,
            },
            formulation: self.text("formulation")?,
            scheme: self.text("scheme")?,
            step: self.attribute_if_given("step")?,
            tolerance: self.attribute_if_given("tolerance")?,
            program_version: self.text("program_version")?,
            fingerprint: self.attribute::<i64>("fingerprint")? as u32,
            scene_text: self.text("scene")?,
            scene_file: self.attribute_if_given::<VarLenUnicode>("scene_file")?.unwrap_or_default().as_str().to_owned(),
            body,
            point_names: self.point_names()?,
        })
    }

    fn point_names(&self) -> Result<Vec<String>, FileError> {
        if !self.file.link_exists("points") {
            return Err(self.missing("points"));
        }
        let group = self.file.group("points").map_err(self.failed("open the group points"))?;
        group
            .member_names_by(IndexType::CreationOrder, IterationOrder::Increasing)
            .or_else(|_| group.member_names()) // a file from elsewhere need not keep the order
            .map_err(self.failed("list the points"))
    }

    /// Whole checkpoints, the last first.
    fn checkpoints(&self) -> Result<Vec<Checkpoint>, FileError> {
        let dataset = self.dataset("checkpoint")?;
        let &[2, words] = &dataset.shape()[..] else {
            return Err(self.wrong_shape("checkpoint", "[2, words]".into(), &dataset));
        };
        self.refuse_if_claimed(2 * words as u128)?;
        let places = dataset.read_raw::<u64>().map_err(self.failed("read dataset checkpoint"))?;
        let mut checkpoints: Vec<Checkpoint> = places.chunks(words.max(1)).filter_map(Checkpoint::read).collect();
        checkpoints.sort_unstable_by_key(|checkpoint| std::cmp::Reverse(checkpoint.serial));
        Ok(checkpoints)
    }

    fn dataset(&self, name: &str) -> Result<hdf5::Dataset, FileError> {
        // `link_exists` wants every group on the way to be there.
        let mut end = 0;
        for part in name.split('/') {
            end += part.len();
            if !self.file.link_exists(&name[..end]) {
                return Err(self.missing(name));
            }
            end += 1;
        }
        self.file.dataset(name).map_err(self.failed(format!("open dataset {name}")))
    }

    /// Refuses to make room for more numbers than the file has bytes for: a shape is only a claim.
    fn refuse_if_claimed(&self, numbers: u128) -> Result<(), FileError> {
        let claimed = numbers.saturating_mul(size_of::<f64>() as u128);
        if claimed <= u128::from(self.length) {
            return Ok(());
        }
        Err(FileError::ClaimsTooMuch { path: self.path.to_path_buf(), claimed, length: self.length })
    }

    fn read(&self, name: &str, dataset: &hdf5::Dataset) -> Result<Vec<f64>, FileError> {
        self.refuse_if_claimed(dataset.shape().iter().fold(1, |size, n| size.saturating_mul(*n as u128)))?;
        dataset.read_raw::<f64>().map_err(self.failed(format!("read dataset {name}")))
    }

    /// A dataset of known shape, row by row.
    fn fixed(&self, name: &str, shape: &[usize]) -> Result<Vec<f64>, FileError> {
        let dataset = self.dataset(name)?;
        if dataset.shape() != shape {
            return Err(self.wrong_shape(name, format!("{shape:?}"), &dataset));
        }
        self.read(name, &dataset)
    }

    /// A one-dimensional dataset, of known length or not.
    fn vector(&self, name: &str, length: Option<usize>) -> Result<Vec<f64>, FileError> {
        let dataset = self.dataset(name)?;
        match (&dataset.shape()[..], length) {
            ([_], None) => self.read(name, &dataset),
            ([found], Some(length)) if *found == length => self.read(name, &dataset),
            (_, None) => Err(self.wrong_shape(name, "[nf]".into(), &dataset)),
            (_, Some(length)) => Err(self.wrong_shape(name, format!("[{length}]"), &dataset)),
        }
    }

    fn rows_of(&self, name: &str, width: Option<usize>) -> Result<usize, FileError> {
        let dataset = self.dataset(name)?;
        match (&dataset.shape()[..], width) {
            ([rows], None) => Ok(*rows),
            ([rows, found], Some(width)) if *found == width => Ok(*rows),
            (_, None) => Err(self.wrong_shape(name, "[T]".into(), &dataset)),
            (_, Some(width)) => Err(self.wrong_shape(name, format!("[T, {width}]"), &dataset)),
        }
    }

    /// The first `rows` rows, row by row.
    fn column(&self, name: &str, width: Option<usize>, rows: usize) -> Result<Vec<f64>, FileError> {
        let dataset = self.dataset(name)?;
        match width {
            None => dataset.read_slice_1d(s![..rows]).map(|values| values.into_raw_vec_and_offset().0),
            Some(_) => dataset.read_slice_2d(s![..rows, ..]).map(|values| values.into_raw_vec_and_offset().0),
        }
        .map_err(self.failed(format!("read dataset {name}")))
    }

    fn attribute<T: hdf5::H5Type>(&self, name: &str) -> Result<T, FileError> {
        self.attribute_if_given(name)?
            .ok_or_else(|| FileError::MissingAttribute { path: self.path.to_path_buf(), attribute: name.into() })
    }

    fn attribute_if_given<T: hdf5::H5Type>(&self, name: &str) -> Result<Option<T>, FileError> {
        let names = self.file.attr_names().map_err(self.failed("list the attributes"))?;
        if !names.iter().any(|found| found == name) {
            return Ok(None);
        }
        self.file
            .attr(name)
            .and_then(|attribute| attribute.read_scalar())
            .map(Some)
            .map_err(self.failed(format!("read the attribute {name}")))
    }

    fn text(&self, name: &str) -> Result<String, FileError> {
        // The bytes are the file's: `as_str` would take them for UTF-8 unseen.
        let text = self.attribute::<VarLenUnicode>(name)?;
        String::from_utf8(text.as_bytes().to_vec())
            .map_err(|_| FileError::NotUtf8 { path: self.path.to_path_buf(), attribute: name.into() })
    }

    fn missing(&self, dataset: &str) -> FileError {
        FileError::MissingDataset { path: self.path.to_path_buf(), dataset: dataset.into() }
    }

    fn wrong_shape(&self, name: &str, expected: String, dataset: &hdf5::Dataset) -> FileError {
        let found = dataset.shape();
        FileError::WrongShape { path: self.path.to_path_buf(), dataset: name.into(), expected, found }
    }

    fn failed(&self, action: impl Into<String>) -> impl FnOnce(hdf5::Error) -> FileError {
        FileError::hdf5(self.path, action)
    }
}

#[cfg(test)]
#[path = "../tests/rows/mod.rs"]
#[allow(dead_code)] // no test needs all of it
mod rows;

/// Files that have a seal, but are not what a writer writes.
#[cfg(test)]
mod tests {
    use super::rows::{Row, folder, metadata};
    use super::*;
    use crate::{Expected, Writer};

    /// What the reader says of a file that another program has changed and sealed.
    fn refusal(change: impl Fn(&hdf5::File)) -> FileError {
        let (_folder, path) = folder();
        let mut writer = Writer::create(&path, &metadata(2, &["P1"]), Expected::default()).unwrap();
        (0..10).for_each(|i| writer.push(&Row::new(i, 2, 1).sample()).unwrap());
        writer.finish().unwrap();
        let file = hdf5::File::open_rw(&path).unwrap();
        change(&file);
        file.close().unwrap();
        assert!(matches!(Results::open(&path), Err(FileError::Damaged { .. })));
        seal::put(&path, &path, &[]).unwrap();
        Results::open(&path).unwrap_err()
    }

    #[test]
    fn errors_name_what_is_missing_or_of_another_shape() {
        match refusal(|file| file.unlink("points/P1/velocity").unwrap()) {
            FileError::MissingDataset { dataset, .. } => assert_eq!(dataset, "points/P1/velocity"),
            other => panic!("{other}"),
        }
        match refusal(|file| file.unlink("body").unwrap()) {
            FileError::MissingDataset { dataset, .. } => assert_eq!(dataset, "body/frequencies"),
            other => panic!("{other}"),
        }
        match refusal(|file| file.delete_attr("scheme").unwrap()) {
            FileError::MissingAttribute { attribute, .. } => assert_eq!(attribute, "scheme"),
            other => panic!("{other}"),
        }
        match refusal(|file| {
            file.unlink("attitude").unwrap();
            file.new_dataset::<f64>().shape((10, 3)).create("attitude").unwrap();
        }) {
            FileError::WrongShape { dataset, expected, found, .. } => {
                assert_eq!((dataset.as_str(), expected.as_str(), found), ("attitude", "[T, 4]", vec![10, 3]));
            }
            other => panic!("{other}"),
        }
    }

    #[test]
    fn a_shape_is_only_a_claim() {
        let vast = 1_000_000_000_000_usize;
        match refusal(|file| {
            file.unlink("body/frequencies").unwrap();
            file.new_dataset::<f64>().chunk(1000).shape(vast).create("body/frequencies").unwrap();
        }) {
            FileError::ClaimsTooMuch { claimed, length, .. } => {
                assert!(claimed == 8 * vast as u128 && length < 100_000_000)
            }
            other => panic!("{other}"),
        }
    }
}
