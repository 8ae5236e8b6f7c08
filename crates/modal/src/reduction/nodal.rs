//! The constants of a body whose mass is a scalar for each pair of nodes: it commutes with rotations, and all are exact.

use faer::{Mat, MatRef};
use nalgebra::Vector3;
use rayon::prelude::*;

use crate::error::ModalError;
use crate::matrix::mass::NodalMass;
use crate::matrix::tall;
use crate::memory_estimate::of_vectors;
use crate::reduction::inertia_products::{Products, set_translations};
use crate::reduction::parts::{GEOMETRY, NODES, PIECES, nodal_vectors, products_bytes};
use crate::solve::Modes;
use reduced_body::ReducedBody;

/// The products of the modes, whose shapes and positions fit the mass.
pub(crate) fn nodal_products(
    modes: &Modes,
    nodal: &NodalMass<'_>,
    positions: &[[f64; 3]],
) -> Result<Products, ModalError> {
    let rigid = &modes.rigid;
    let (n, nf) = (positions.len(), modes.shapes.ncols());
    // Ψ, X and 1 side by side: all constants are products of their rows on one axis with M_s times those on another.
    let columns = 6 + nf + GEOMETRY;
    memory::check("the reduced body", of_vectors(3 * n, nodal_vectors(nf)) + products_bytes(n, nf))?;
    let mut geometry = Mat::zeros(3 * n, GEOMETRY);
    for (node, x) in positions.iter().enumerate() {
        let offset = Vector3::from(*x) - rigid.origin;
        for axis in 0..3 {
            geometry[(3 * node + axis, 0)] = offset[axis];
            geometry[(3 * node + axis, 1)] = 1.0;
        }
    }
    let parts = [rigid.shapes.as_ref(), modes.shapes.as_ref(), geometry.as_ref()];
    let m_parts = parts.map(|part| nodal.product(part));
    let m_parts = m_parts.each_ref().map(Mat::as_ref);
    let of_nodes = |first: usize| {
        let some = |fields: [MatRef<'_, f64>; 3]| {
            by_axis(&fields.map(|field| field.subrows(3 * first, 3 * NODES.min(n - first))))
        };
        let (rows, m_rows) = (some(parts), some(m_parts));
        // M_s is symmetric.
        [(0, 0), (1, 1), (2, 2), (0, 1), (1, 2), (2, 0)].map(|(a, b)| tall::inner(rows[a].as_ref(), m_rows[b].as_ref()))
    };
    let zeros = || std::array::from_fn(|_| Mat::zeros(columns, columns));
    let sum = |mut sums: [Mat<f64>; 6], products: [Mat<f64>; 6]| {
        sums.iter_mut().zip(products).for_each(|(sum, product)| *sum += product);
        sums
    };
    let of_task = |first: &usize| {
        let end = n.min(first + NODES * PIECES);
        (*first..end).step_by(NODES).map(of_nodes).fold(zeros(), sum)
    };
    let tasks: Vec<usize> = (0..n).step_by(NODES * PIECES).collect();
    let of_tasks: Vec<[Mat<f64>; 6]> = tasks.par_iter().map(of_task).collect();
    let [xx, yy, zz, xy, yz, zx] = of_tasks.into_iter().fold(zeros(), sum);
    let [yx, zy, xz] = [&xy, &yz, &zx].map(|product| product.transpose().to_owned());
    let products = [[xx, xy, xz], [yx, yy, yz], [zx, zy, zz]];

    let modal = 6 + nf;
    let is_free = rigid.motion.is_free();
    let rotation_products = std::array::from_fn(|a| {
        std::array::from_fn(|b| {
            let mut product = products[a][b].get(..modal, ..modal).to_owned();
            if is_free {
                set_translations(&mut product, a, b);
            }
            product
        })
    });
    let position_products = std::array::from_fn(|a| {
        std::array::from_fn(|b| (0..modal).map(|k| products[a][b][(k, modal)]).collect::<Vec<f64>>())
    });
    let flexible = |a: usize, b: usize| products[a][b].submatrix(6, 6, nf, nf);
    let flexible_x = |a: usize, b: usize, k: usize| products[a][b][(6 + k, modal)];
    // [e_i×]ᵀ[e_j×] = δ_ij I − e_j e_iᵀ
    let inertia_first = ReducedBody::PAIRS.map(|(i, j)| {
        (0..nf)
            .map(|k| {
                let trace: f64 = if i == j { (0..3).map(|a| flexible_x(a, a, k)).sum() } else { 0.0 };
                trace - 0.5 * (flexible_x(i, j, k) + flexible_x(j, i, k))
            })
            .collect()
    });
    let inertia_second = ReducedBody::PAIRS.map(|(i, j)| {
        let (ij, ji) = (flexible(i, j), flexible(j, i));
        Mat::from_fn(nf, nf, |k, l| {
            let trace: f64 = if i == j { (0..3).map(|a| flexible(a, a)[(k, l)]).sum() } else { 0.0 };
            trace - 0.5 * (ij[(k, l)] + ji[(k, l)])
        })
    });
    // [e_1×] = e_3 e_2ᵀ − e_2 e_3ᵀ and cyclic.
    let gyroscopic = [(2, 1), (0, 2), (1, 0)].map(|(a, b)| {
        let (ab, ba) = (flexible(a, b), flexible(b, a));
        Mat::from_fn(nf, nf, |k, l| ab[(k, l)] - ba[(k, l)])
    });
    // The modes are orthogonal to the rigid motions that the body has: what is left is rounding, and would leak momentum.
    let turns_freely = rigid.motion.rotations().len() == 3;
    let unless = |is_zero: bool, value: f64| if is_zero { 0.0 } else { value };
    let translation_first =
        std::array::from_fn(|i| (0..nf).map(|k| unless(is_free, products[i][i][(6 + k, modal + 1)])).collect());
    let rotation_first = [(2, 1), (0, 2), (1, 0)]
        .map(|(a, b)| (0..nf).map(|k| unless(turns_freely, flexible_x(a, b, k) - flexible_x(b, a, k))).collect());
    Ok(Products {
        rotation_products,
        position_products,
        inertia_first,
        inertia_second,
        gyroscopic,
        translation_first,
        rotation_first,
    })
}

/// Fields (3n×k) side by side, their rows on each axis (n×k).
fn by_axis(fields: &[MatRef<'_, f64>]) -> [Mat<f64>; 3] {
    let (n, columns) = (fields[0].nrows() / 3, fields.iter().map(|part| part.ncols()).sum());
    let mut rows: [Mat<f64>; 3] = std::array::from_fn(|_| Mat::zeros(n, columns));
    for (k, field) in fields.iter().flat_map(|part| part.col_iter()).enumerate() {
        for (axis, rows) in rows.iter_mut().enumerate() {
            for (row, value) in rows.col_mut(k).iter_mut().zip(field.iter().skip(axis).step_by(3)) {
                *row = *value;
            }
        }
    }
    rows
}
