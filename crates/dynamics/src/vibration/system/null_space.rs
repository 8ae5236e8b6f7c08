//! An M-orthonormal basis of the motions that the rows of joints leave, N of Eq. (L8) of `docs/method/systems.md`.
//!
//! Bodies are joined to parts, and parts to larger ones, the smallest first, so that few steps are as wide as the system: the cost of a chain grows with
//! the square of its bodies, which is the size of the basis.

use faer::{Mat, Side};

use crate::system::constraints::End;
use crate::system::description::System;
use crate::vibration::system::error::SteadyError;
use crate::vibration::system::terms::Terms;

/// Bodies that move together, with an orthonormal basis of their motions over z = Lᵀξ, M = L Lᵀ of each body.
struct Part {
    bodies: Vec<usize>,
    basis: Mat<f64>,
}

/// Rows that meet the same bodies: their entries over z, by row, then body.
struct Rows {
    bodies: Vec<usize>,
    entries: Vec<Vec<Vec<f64>>>,
}

/// An M-orthonormal basis of the motions that the rows leave (n×nη).
pub(super) fn null_space(system: &System, terms: &Terms) -> Result<Mat<f64>, SteadyError> {
    // Turns of point masses, which have none, are held.
    let masses = terms.masses.iter().zip(&system.bodies).map(|(mass, body)| {
        let turns = if body.is_point() { body.mass() } else { 0.0 };
        Mat::from_fn(mass.nrows(), mass.ncols(), |i, j| mass[(i, j)] + if i == j && i >= 3 { turns } else { 0.0 })
    });
    let factors = masses.map(|mass| mass.llt(Side::Lower).map(|llt| llt.L().to_owned()));
    let factors: Vec<Mat<f64>> = factors.collect::<Result<_, _>>().map_err(|_| SteadyError::Numbers)?;
    let mut parts: Vec<Option<Part>> = factors
        .iter()
        .enumerate()
        .map(|(body, factor)| Some(Part { bodies: vec![body], basis: Mat::identity(factor.nrows(), factor.nrows()) }))
        .collect();
    let mut part_of: Vec<usize> = (0..parts.len()).collect();
    let mut left = rows_by_bodies(system, terms, &factors);
    while let Some(next) = narrowest(&left, &parts, &part_of) {
        let rows = left.swap_remove(next);
        let met = parts_of(&rows.bodies, &part_of);
        let joined = join(&rows, met.iter().filter_map(|part| parts[*part].take()).collect(), &factors);
        joined.bodies.iter().for_each(|body| part_of[*body] = met[0]);
        parts[met[0]] = Some(joined);
    }
    let count = parts.iter().flatten().map(|part| part.basis.ncols()).sum();
    let mut basis = Mat::zeros(system.coordinates(), count);
    let mut column = 0;
    for Part { bodies, basis: of_part } in parts.iter().flatten() {
        let mut row = 0;
        for body in bodies {
            let (first, size) = (system.first[*body], factors[*body].nrows());
            let mut to = basis.get_mut(first..first + size, column..column + of_part.ncols());
            to.copy_from(of_part.get(row..row + size, ..));
            faer::linalg::triangular_solve::solve_upper_triangular_in_place(
                factors[*body].transpose(),
                to,
                faer::Par::Seq,
            );
            row += size;
        }
        column += of_part.ncols();
    }
    Ok(basis)
}

/// The rows that count, of unit length over z, and those that hold the turns of point masses.
fn rows_by_bodies(system: &System, terms: &Terms, factors: &[Mat<f64>]) -> Vec<Rows> {
    let mut all: Vec<Rows> = Vec::new();
    let mut add = |ends: &[End]| {
        let mut bodies: Vec<usize> = ends.iter().map(|end| end.body).collect();
        bodies.sort_unstable();
        bodies.dedup();
        let over_z = |body: &usize| {
            let size = factors[*body].nrows();
            let own = || ends.iter().filter(|end| end.body == *body);
            let mut entries =
                Mat::from_fn(size, 1, |k, _| own().map(|end| end.entries.get(k).copied().unwrap_or(0.0)).sum::<f64>());
            faer::linalg::triangular_solve::solve_lower_triangular_in_place(
                factors[*body].as_ref(),
                entries.as_mut(),
                faer::Par::Seq,
            );
            entries.col(0).iter().copied().collect::<Vec<f64>>()
        };
        let mut entries: Vec<Vec<f64>> = bodies.iter().map(over_z).collect();
        let norm = entries.iter().flatten().map(|x| x * x).sum::<f64>().sqrt();
        if norm > 0.0 {
            entries.iter_mut().flatten().for_each(|x| *x /= norm);
        }
        match all.last_mut().filter(|last| last.bodies == bodies) {
            Some(last) => last.entries.push(entries),
            None => all.push(Rows { bodies, entries: vec![entries] }),
        }
    };
    for (ends, _) in terms.rows.iter().zip(&terms.is_implied).filter(|(_, is_implied)| !**is_implied) {
        add(ends);
    }
    for (body, first) in system.first.iter().take(system.bodies.len()).enumerate() {
        for turn in (3..6).filter(|_| system.bodies[body].is_point()) {
            let entries = (0..6).map(|k| f64::from(u8::from(k == turn))).collect();
            add(&[End { body, first: *first, entries }]);
        }
    }
    all
}

/// The parts that bodies are in, each once.
fn parts_of(bodies: &[usize], part_of: &[usize]) -> Vec<usize> {
    let mut met: Vec<usize> = bodies.iter().map(|body| part_of[*body]).collect();
    met.sort_unstable();
    met.dedup();
    met
}

/// The rows whose parts have the fewest motions.
fn narrowest(left: &[Rows], parts: &[Option<Part>], part_of: &[usize]) -> Option<usize> {
    let width = |rows: &Rows| -> usize {
        let met = parts_of(&rows.bodies, part_of);
        met.iter().filter_map(|part| parts[*part].as_ref()).map(|part| part.basis.ncols()).sum()
    };
    (0..left.len()).min_by_key(|rows| width(&left[*rows]))
}

/// One part of several, whose motions keep the rows.
fn join(rows: &Rows, parts: Vec<Part>, factors: &[Mat<f64>]) -> Part {
    let [height, width] = [Mat::nrows, Mat::ncols].map(|of| parts.iter().map(|part| of(&part.basis)).sum());
    let mut basis = Mat::zeros(height, width);
    // The rows over the motions of the parts.
    let mut along = vec![vec![0.0; width]; rows.entries.len()];
    let (mut row, mut column) = (0, 0);
    let mut bodies = Vec::new();
    for Part { bodies: own, basis: of_part } in parts {
        let to = basis.get_mut(row..row + of_part.nrows(), column..column + of_part.ncols());
        { to }.copy_from(&of_part);
        for body in own {
            let size = factors[body].nrows();
            if let Some(place) = rows.bodies.iter().position(|other| *other == body) {
                for (along, entries) in along.iter_mut().zip(&rows.entries) {
                    for (k, sum) in along[column..column + of_part.ncols()].iter_mut().enumerate() {
                        let entries = entries[place].iter().enumerate();
                        *sum += entries.map(|(i, entry)| entry * basis[(row + i, column + k)]).sum::<f64>();
                    }
                }
            }
            bodies.push(body);
            row += size;
        }
        column += of_part.ncols();
    }
    // Householder's reflections of the motions, after which the rows have entries in the first ones alone.
    let taken = along.len().min(width);
    for first in 0..taken {
        let (here, others) = along[first..].split_at_mut(1);
        let mut mirror = here[0][first..].to_vec();
        let length = mirror.iter().map(|x| x * x).sum::<f64>().sqrt();
        if length == 0.0 {
            continue;
        }
        mirror[0] += length.copysign(mirror[0]);
        let factor = 2.0 / mirror.iter().map(|x| x * x).sum::<f64>();
        for other in others {
            let product = factor * mirror.iter().zip(&other[first..]).map(|(a, b)| a * b).sum::<f64>();
            other[first..].iter_mut().zip(&mirror).for_each(|(x, mirror)| *x -= product * mirror);
        }
        let mut products = vec![0.0; height];
        for (column, mirror) in basis.get(.., first..).col_iter().zip(&mirror) {
            products.iter_mut().zip(column.iter()).for_each(|(sum, x)| *sum += mirror * x);
        }
        for (column, mirror) in basis.get_mut(.., first..).col_iter_mut().zip(&mirror) {
            let times = factor * mirror;
            column.iter_mut().zip(&products).for_each(|(x, product)| *x -= times * product);
        }
    }
    Part { bodies, basis: basis.get(.., taken..).to_owned() }
}
