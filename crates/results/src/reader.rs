//! Reads a results file back, finished or not.

use crate::checkpoint::{Checkpoint, Sums};
use crate::layout::Quantity;
use crate::store::Store;
use crate::{FileError, Metadata, PointSample, Sample};
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
    /// [`FileError::NoSeal`] and [`FileError::Damaged`] if it is not what a [`Writer`](crate::Writer) wrote, or those of
    /// [`Writer::create`](crate::Writer::create) for its metadata; [`FileError::Busy`] if another process writes it;
    /// [`FileError::System`] if it cannot be read.
    pub fn open(path: impl AsRef<Path>) -> Result<Self, FileError> {
        let path = path.as_ref();
        Ok(Self::read_with_checkpoint(&Store::open(path)?, path)?.0)
    }

    /// With the last checkpoint of an unfinished file whose rows are as they were then, and their sums.
    pub(crate) fn read_with_checkpoint(
        store: &Store,
        path: &Path,
    ) -> Result<(Self, Option<(Checkpoint, Sums)>), FileError> {
        let metadata = store.metadata().clone();
        let complete = store.is_complete();
        let modes = metadata.body.frequencies.len();
        let names = &metadata.point_names;
        let quantities: Vec<Quantity> = Quantity::all(names.len()).collect();
        let mut rows = store.rows();
        let mut columns = store.read(path)?;
        if !complete {
            // What has not been written is NaN; no run writes what is not finite.
            for (quantity, column) in quantities.iter().zip(&columns) {
                let whole = column.iter().position(|value| !value.is_finite()).unwrap_or(usize::MAX);
                rows = rows.min(whole / quantity.width(modes).unwrap_or(1).max(1));
            }
        }
        // Whole ones, the last first.
        let places = store.read_checkpoints(path)?;
        let mut checkpoints: Vec<Checkpoint> =
            places.chunks(store.checkpoint_words().max(1)).filter_map(Checkpoint::read).collect();
        checkpoints.sort_unstable_by_key(|checkpoint| std::cmp::Reverse(checkpoint.serial));
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
        let widths = quantities.iter().map(|quantity| quantity.width(modes).unwrap_or(1));
        columns.iter_mut().zip(widths).for_each(|(column, width)| column.truncate(rows * width));
        let mut of_points = columns.split_off(Quantity::all(0).count()).into_iter();
        let mut points = BTreeMap::new();
        for name in names {
            let mut next = || vectors(of_points.next().unwrap_or_default());
            let history = PointHistory {
                displacement: next(),
                velocity: next(),
                acceleration: next(),
                rigid_acceleration: next(),
            };
            points.insert(name.clone(), history);
        }
        let mut column = |quantity: Quantity| {
            let place = quantities.iter().position(|q| *q == quantity);
            place.map(|place| std::mem::take(&mut columns[place])).unwrap_or_default()
        };

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
