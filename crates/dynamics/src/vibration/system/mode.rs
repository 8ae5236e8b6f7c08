//! Vibrations of a linearised system: frequencies, damping, shapes, and who has their energy.

use faer::{Mat, Side, c64};

use crate::vibration::system::error::SteadyError;
use crate::vibration::system::graded::graded_modes;
use crate::vibration::system::linearization::Linearization;
use crate::vibration::system::refined::refined;
use crate::vibration::system::scaled::ScaledEquations;

/// Growth over the fastest frequency that is its rounding, and eigenvalues over it whose own growth may be less than that.
const ROUNDING_OF_FASTEST: f64 = 1e-12;
const SLOW: f64 = 1e-3;
/// A part of the terms of an equation that is more than their rounding.
const ROUNDING: f64 = 1e-10;

/// Small motions of a system that go on by themselves.
#[derive(Debug, Clone)]
pub struct Vibrations {
    /// Motions as a whole that nothing resists: without stiffness, damping or gyroscopic forces, or with an eigenvalue of zero.
    pub rigid: Mat<f64>,
    /// Eigenvalues that are zero beside those, each of them half a motion.
    pub zeros: usize,
    /// All others, slowest first, by the magnitude of the eigenvalue.
    pub modes: Vec<SystemMode>,
}

/// A small motion as `exp(eigenvalue t)`.
#[derive(Debug, Clone, PartialEq)]
pub struct SystemMode {
    /// Growth and circular frequency; the latter is not negative.
    pub eigenvalue: c64,
    /// Changes of place of all bodies: ρ and φ in body axes, and δq, of each.
    pub motion: Vec<c64>,
    /// The coordinates η.
    pub coordinates: Vec<c64>,
    /// Parts of the kinetic energy that the bodies have.
    pub kinetic: Vec<f64>,
    /// Parts of the elastic energy that the bodies have, then springs of joints and force elements; all zero where there is none.
    pub elastic: Vec<f64>,
}

impl SystemMode {
    /// Circular frequency of the motion, rad per time; zero where it only decays or grows.
    pub fn circular_frequency(&self) -> f64 {
        self.eigenvalue.im
    }

    /// Growth rate; negative where it decays.
    pub fn growth(&self) -> f64 {
        self.eigenvalue.re
    }

    /// Damping ratio: −growth over the magnitude of the eigenvalue.
    pub fn damping_ratio(&self) -> f64 {
        -self.eigenvalue.re / self.eigenvalue.re.hypot(self.eigenvalue.im)
    }
}

/// Motions apart from those that nothing resists.
struct Drifts {
    /// Orthonormal bases of the one and of the other.
    rest: Mat<f64>,
    rigid: Mat<f64>,
    /// The motions of the latter that others push.
    drifts: Vec<Vec<f64>>,
}

/// Right singular vectors of forces, and how many of the last have none.
fn null_vectors(forces: &Mat<f64>) -> Result<(Mat<f64>, usize), SteadyError> {
    let svd = forces.svd().map_err(|_| SteadyError::Numbers)?;
    let values = svd.S().column_vector();
    let loose = (0..forces.ncols()).filter(|k| *k >= values.nrows() || values[*k] <= ROUNDING).count();
    Ok((svd.V().to_owned(), loose))
}

/// Coordinates from which on a system is wide: it is asked first if it has a simpler answer, which costs a small part of the general one.
const WIDE: usize = 100;
/// Part of a matrix that is its rounding.
const UNEVEN: f64 = 1e-12;

/// The eigenvectors of the symmetric part of a wide matrix, if all that it does with a weight is to resist: no motion is then without its forces.
fn resisted(matrix: &Mat<f64>, weight: f64) -> Result<Option<Mat<f64>>, SteadyError> {
    let size = matrix.nrows();
    if size < WIDE {
        return Ok(None);
    }
    let symmetric = Mat::from_fn(size, size, |i, j| 0.5 * weight * (matrix[(i, j)] + matrix[(j, i)]));
    let eigen = symmetric.self_adjoint_eigen(Side::Lower).map_err(|_| SteadyError::Numbers)?;
    let resists = eigen.S().column_vector().iter().all(|value| *value > ROUNDING);
    Ok(resists.then(|| eigen.U().to_owned()))
}

/// K of wide equations that are without damping and gyroscopic forces, and symmetric.
fn symmetric(stiffness: &Mat<f64>, damping: &Mat<f64>) -> Option<Mat<f64>> {
    let size = stiffness.nrows();
    if size < WIDE || damping.norm_max() > 0.0 {
        return None;
    }
    let uneven = (stiffness - stiffness.transpose()).norm_max();
    let even = || Mat::from_fn(size, size, |i, j| 0.5 * (stiffness[(i, j)] + stiffness[(j, i)]));
    (uneven <= UNEVEN * stiffness.norm_max()).then(even)
}

/// Eigenvalues ±√−κ of symmetric equations with their shapes, of states x s and ẋ of unit length; of each pair that swings the one that turns forwards, and of zeros both.
fn of_symmetric(stiffness: &Mat<f64>, scales: &[f64]) -> Result<Vec<(c64, Vec<c64>)>, SteadyError> {
    let mut all = Vec::new();
    for (square, shape) in graded_modes(stiffness)? {
        let root = square.abs().sqrt();
        let length = shape.iter().zip(scales).map(|(x, s)| (x * s).powi(2)).sum::<f64>().sqrt().hypot(root);
        let shape: Vec<c64> = shape.iter().map(|x| c64::new(x / length, 0.0)).collect();
        let pair = if square > 0.0 {
            [c64::new(0.0, root), c64::new(0.0, -root)]
        } else {
            [c64::new(root, 0.0), c64::new(-root, 0.0)]
        };
        all.extend(pair.map(|eigenvalue| (eigenvalue, shape.clone())));
    }
    Ok(all)
}

/// N x of many lists x.
fn expanded(basis: &Mat<f64>, lists: &[Vec<c64>]) -> Vec<Vec<c64>> {
    let parts = [|x: &c64| x.re, |x: &c64| x.im].map(|part| {
        let of = Mat::from_fn(basis.ncols(), lists.len(), |i, k| part(&lists[k][i]));
        // Shapes of symmetric equations are real.
        (of.norm_max() > 0.0).then(|| basis * of)
    });
    let entry = |part: usize, i: usize, k: usize| parts[part].as_ref().map_or(0.0, |of| of[(i, k)]);
    (0..lists.len()).map(|k| (0..basis.nrows()).map(|i| c64::new(entry(0, i, k), entry(1, i, k))).collect()).collect()
}

impl Linearization {
    /// Its vibrations.
    ///
    /// # Errors
    /// [`SteadyError::Numbers`] where the eigenvalue problem has no answer.
    pub fn vibrations(&self) -> Result<Vibrations, SteadyError> {
        let (rest, rigid) = self.without_rigid()?;
        let Drifts { rest, rigid, drifts } = self.without_drifts(rest, rigid)?;
        let size = rest.ncols();
        let [stiffness, damping] = [&self.stiffness, &self.damping].map(|matrix| rest.transpose() * (matrix * &rest));
        if size == 0 {
            return Ok(Vibrations { rigid, zeros: 0, modes: Vec::new() });
        }
        let scaled = ScaledEquations::new(&stiffness, &damping);
        let ScaledEquations { matrix, scales } = &scaled;
        let largest = scaled.fastest();
        let slow = scales[..self.unsprung.saturating_sub(rigid.ncols())].iter().copied().fold(0.0, f64::max);
        let zero = scaled.zero(slow, 1e-13);
        let eigen = match symmetric(&stiffness, &damping) {
            Some(symmetric) => of_symmetric(&symmetric, scales)?,
            None => {
                let eigen = matrix.eigen().map_err(|_| SteadyError::Numbers)?;
                let shape = |k: usize| (0..size).map(|i| eigen.U()[(i, k)] / scales[i]).collect();
                eigen.S().column_vector().iter().enumerate().map(|(k, value)| (*value, shape(k))).collect()
            }
        };
        let (mut found, mut zeros) = (Vec::new(), 0);
        for (mut eigenvalue, of_rest) in eigen {
            if eigenvalue.norm() <= zero {
                zeros += 1;
                continue;
            }
            // Of each conjugate pair the one that turns forwards in time.
            let is_real = eigenvalue.im.abs() <= 1e-9 * eigenvalue.norm() && eigenvalue.re.abs() > zero;
            if eigenvalue.im < 0.0 && !is_real {
                continue;
            }
            if is_real {
                eigenvalue.im = 0.0;
            }
            let rounding = zero.max(ROUNDING_OF_FASTEST * largest);
            if eigenvalue.re.abs() <= rounding {
                let is_slow = eigenvalue.norm() < SLOW * largest;
                let refined =
                    if is_slow { refined([&stiffness, &damping], scales, eigenvalue, rounding) } else { None };
                eigenvalue = refined.unwrap_or(if is_real { eigenvalue } else { c64::new(0.0, eigenvalue.im) });
            }
            found.push((eigenvalue, of_rest));
        }
        let (eigenvalues, of_rest): (Vec<c64>, Vec<Vec<c64>>) = found.into_iter().unzip();
        let mut coordinates = expanded(&rest, &of_rest);
        for (eigenvalue, coordinates) in eigenvalues.iter().zip(&mut coordinates) {
            self.let_drift(&drifts, *eigenvalue, coordinates);
        }
        let motions = expanded(&self.basis, &coordinates);
        let each = eigenvalues.into_iter().zip(coordinates).zip(motions);
        let mut modes: Vec<SystemMode> =
            each.map(|((eigenvalue, coordinates), motion)| self.mode(eigenvalue, coordinates, motion)).collect();
        modes.sort_by(|a, b| {
            let (a, b) = (a.eigenvalue, b.eigenvalue);
            a.norm().total_cmp(&b.norm()).then(a.im.total_cmp(&b.im))
        });
        Ok(Vibrations { rigid: &self.basis * rigid, zeros, modes })
    }

    /// Takes out motions that nothing resists, but that others push, such as the path of a rocket that turns, or that push others and are pushed by none:
    /// zeros, too, which rounding would part by a root the higher the longer their chain is.
    fn without_drifts(&self, mut rest: Mat<f64>, mut rigid: Mat<f64>) -> Result<Drifts, SteadyError> {
        let weights = self.weights();
        let mut drifts = Vec::new();
        loop {
            let (size, count) = (rest.ncols(), self.unsprung - rigid.ncols());
            if count == 0 {
                break;
            }
            let all = [&self.stiffness, &self.damping].map(|matrix| rest.transpose() * (matrix * &rest));
            if resisted(&all[0].get(..count, ..count).to_owned(), weights[0])?.is_some() {
                break;
            }
            let sides = [false, true].map(|of_rows| {
                let forces = Mat::from_fn(2 * size, count, |row, k| {
                    let (which, i) = (row / size, row % size);
                    weights[which] * if of_rows { all[which][(k, i)] } else { all[which][(i, k)] }
                });
                null_vectors(&forces)
            });
            let [pushed, pushing] = sides;
            let (pushed, pushing) = (pushed?, pushing?);
            let (v, loose) = if pushed.1 > 0 { &pushed } else { &pushing };
            if *loose == 0 {
                break;
            }
            let tied = count - loose;
            let out = rest.get(.., ..count) * v.get(.., tied..);
            let first = rigid.ncols();
            if pushed.1 > 0 {
                drifts.extend((0..*loose).map(|k| out.col(k).iter().copied().collect::<Vec<f64>>()));
            }
            rigid =
                Mat::from_fn(
                    self.size(),
                    first + loose,
                    |i, j| {
                        if j < first { rigid[(i, j)] } else { out[(i, j - first)] }
                    },
                );
            let kept = rest.get(.., ..count) * v.get(.., ..tied);
            rest = Mat::from_fn(
                self.size(),
                size - loose,
                |i, j| {
                    if j < tied { kept[(i, j)] } else { rest[(i, j + loose)] }
                },
            );
        }
        Ok(Drifts { rest, rigid, drifts })
    }

    /// Adds to a motion what it pushes: x = −Xᵀ(sC + K)η/s² of each, the last taken out first.
    fn let_drift(&self, drifts: &[Vec<f64>], eigenvalue: c64, coordinates: &mut [c64]) {
        for drift in drifts.iter().rev() {
            let force = |i: usize| -> c64 {
                let of = |j: usize| eigenvalue * self.damping[(i, j)] + self.stiffness[(i, j)];
                coordinates.iter().enumerate().map(|(j, x)| of(j) * x).sum()
            };
            let along: c64 = drift.iter().enumerate().filter(|(_, x)| **x != 0.0).map(|(i, x)| force(i) * *x).sum();
            let moved = -along / (eigenvalue * eigenvalue);
            coordinates.iter_mut().zip(drift).for_each(|(sum, x)| *sum += moved * *x);
        }
    }

    /// The same equations with the motions that nothing resists as the first coordinates, and their number: their rows and columns of K and C
    /// are zero, and not rounding.
    ///
    /// # Errors
    /// As [`Self::vibrations`].
    pub fn with_loose_apart(&self) -> Result<(Self, usize), SteadyError> {
        let (rest, loose) = self.without_rigid()?;
        let (size, count) = (self.size(), loose.ncols());
        if count == 0 {
            return Ok((self.clone(), 0));
        }
        let turn = Mat::from_fn(size, size, |i, j| if j < count { loose[(i, j)] } else { rest[(i, j - count)] });
        let turned = |matrix: &Mat<f64>| {
            let whole = turn.transpose() * (matrix * &turn);
            Mat::from_fn(size, size, |i, j| if i < count || j < count { 0.0 } else { whole[(i, j)] })
        };
        let apart = Self {
            basis: &self.basis * &turn,
            stiffness: turned(&self.stiffness),
            damping: turned(&self.damping),
            ..self.clone()
        };
        Ok((apart, count))
    }

    /// Orthonormal bases of the coordinates that are not rigid motions without forces, and of those that are.
    pub(crate) fn without_rigid(&self) -> Result<(Mat<f64>, Mat<f64>), SteadyError> {
        let (size, count) = (self.size(), self.unsprung);
        if count == 0 {
            return Ok((Mat::identity(size, size), Mat::zeros(size, 0)));
        }
        let all = [&self.stiffness, &self.damping];
        let weights = self.weights();
        if let Some(v) = resisted(&self.stiffness.get(..count, ..count).to_owned(), weights[0])? {
            let rest = Mat::from_fn(size, size, |i, j| match (i < count, j < count) {
                (true, true) => v[(i, j)],
                (false, false) => f64::from(u8::from(i == j)),
                _ => 0.0,
            });
            return Ok((rest, Mat::zeros(size, 0)));
        }
        let forces = Mat::from_fn(4 * size, count, |row, k| {
            let (which, i) = (row / (2 * size), row % (2 * size));
            let matrix = all[which];
            weights[which] * if i < size { matrix[(i, k)] } else { matrix[(k, i - size)] }
        });
        let (v, loose) = null_vectors(&forces)?;
        let tied = count - loose;
        let rest = Mat::from_fn(size, size - loose, |i, j| match (i < count, j < tied) {
            (true, true) => v[(i, j)],
            (false, false) => f64::from(u8::from(i - count == j - tied)),
            _ => 0.0,
        });
        let rigid = Mat::from_fn(size, loose, |i, j| if i < count { v[(i, tied + j)] } else { 0.0 });
        Ok((rest, rigid))
    }

    /// Reciprocals of the magnitudes of K and C that rounding is in proportion to.
    fn weights(&self) -> [f64; 2] {
        let floors = [self.strain_floor, self.strain_floor.sqrt()];
        std::array::from_fn(|which| {
            let magnitude = self.magnitudes[which].max(f64::EPSILON / ROUNDING * floors[which]);
            if magnitude > 0.0 { 1.0 / magnitude } else { 0.0 }
        })
    }

    /// The rounding of K in the coordinates that deform no body.
    pub(crate) fn rounding_of_stiffness(&self) -> f64 {
        ROUNDING * self.magnitudes[0].max(f64::EPSILON / ROUNDING * self.strain_floor)
    }

    /// A mode with the energies of its bodies and springs, its largest velocity at unit kinetic energy.
    fn mode(&self, eigenvalue: c64, coordinates: Vec<c64>, motion: Vec<c64>) -> SystemMode {
        let [real, imaginary]: [Vec<f64>; 2] =
            [motion.iter().map(|x| x.re).collect(), motion.iter().map(|x| x.im).collect()];
        let mut kinetic: Vec<f64> = Vec::new();
        let mut elastic: Vec<f64> = Vec::new();
        for (b, mass) in self.masses.iter().enumerate() {
            let own = self.first[b]..self.first[b + 1];
            let twice = |x: &[f64]| {
                let n = x.len();
                (0..n).map(|i| x[i] * (0..n).map(|j| mass[(i, j)] * x[j]).sum::<f64>()).sum::<f64>()
            };
            kinetic.push(twice(&real[own.clone()]) + twice(&imaginary[own.clone()]));
            elastic.push(own.map(|k| self.strain[k] * motion[k].norm_sqr()).sum());
        }
        let of_springs = self.springs.iter().map(|(_, tie)| tie.twice_energy(&real) + tie.twice_energy(&imaginary));
        elastic.extend(of_springs);
        for energies in [&mut kinetic, &mut elastic] {
            let sum: f64 = energies.iter().map(|energy| energy.abs()).sum();
            if sum > 0.0 {
                energies.iter_mut().for_each(|energy| *energy /= sum);
            }
        }
        SystemMode { eigenvalue, motion, coordinates, kinetic, elastic }
    }
}
