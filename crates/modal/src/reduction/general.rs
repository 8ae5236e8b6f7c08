//! The constants of a body whose mass is not a scalar for each pair of nodes.
//!
//! The velocities of a node, in body axes, are taken for
//!
//! ```text
//! translation   v + ω×(X + u) + u̇
//! rotation      ω + ω×θ + θ̇
//! ```
//!
//! and M for constant. With the unit motions `E_i = [e_i; 0]`, `H_i = [e_i × X; e_i]` and `A_i = I⊗[e_i×]`, which turns the
//! displacements and the rotations alike, the velocities are `E v + Σ ω_i (H_i + A_i Ψ q) + Ψ q̇`, and the kinetic energy gives
//! `J₀ = HᵀMH`, `c_ij = sym(H_iᵀ M A_j Ψ)`, `N_ij = sym((A_iΨ)ᵀ M A_jΨ)`, `G_i = Ψᵀ M A_i Ψ`.

use faer::sparse::SparseColMatRef;
use faer::{Mat, MatRef};
use nalgebra::Vector3;

use crate::error::ModalError;
use crate::matrix::mass_matrix::GeneralMass;
use crate::matrix::products::symmetric_product;
use crate::matrix::tall::inner;
use crate::memory_estimate::of_vectors;
use crate::reduction::inertia_products::{Products, set_translations};
use crate::reduction::parts::general_vectors;
use crate::reduction::turned::turned;
use crate::solve::Modes;
use crate::support::rigid_fields::{General, rigid_fields};
use reduced_body::ReducedBody;

/// The products of the modes, whose shapes and positions fit the mass.
pub(crate) fn general_products(
    modes: &Modes,
    mass: &GeneralMass<'_>,
    positions: &[[f64; 3]],
) -> Result<Products, ModalError> {
    let rigid = &modes.rigid;
    let (size, nf) = (modes.shapes.nrows(), modes.shapes.ncols());
    General::new(mass, positions, &rigid.center_of_mass).check_rigid_body()?;
    memory::check("the reduced body", of_vectors(size, general_vectors(nf)))?;
    let matrix: SparseColMatRef<'_, usize, f64> = mass.matrix;

    let all = Mat::from_fn(size, 6 + nf, |i, k| if k < 6 { rigid.shapes[(i, k)] } else { modes.shapes[(i, k - 6)] });
    let momenta = symmetric_product(matrix, all.as_ref());
    let flexible_momenta = momenta.subcols(6, nf);
    let fields = rigid_fields(positions, &rigid.origin, mass.dofs);
    let field_momenta = symmetric_product(matrix, fields.as_ref());
    let turned: [Mat<f64>; 3] = std::array::from_fn(|axis| turned(modes.shapes.as_ref(), axis));
    let turned_momenta = turned.each_ref().map(|shapes| symmetric_product(matrix, shapes.as_ref()));

    let is_free = rigid.motion.is_free();
    let turns_freely = rigid.motion.rotations().len() == 3;
    let on_axis = |matrix: &Mat<f64>, axis: usize| Mat::from_fn(size / 3, 6 + nf, |i, k| matrix[(3 * i + axis, k)]);
    let rows: [Mat<f64>; 3] = std::array::from_fn(|axis| on_axis(&all, axis));
    let momentum_rows: [Mat<f64>; 3] = std::array::from_fn(|axis| on_axis(&momenta, axis));
    let rotation_products = std::array::from_fn(|a| {
        std::array::from_fn(|b| {
            let mut product = inner(momentum_rows[a].as_ref(), rows[b].as_ref());
            if is_free {
                set_translations(&mut product, a, b);
            }
            product
        })
    });
    let offset = |node: usize| Vector3::from(positions[node]) - rigid.origin;
    let position_products = std::array::from_fn(|a| {
        std::array::from_fn(|b| {
            let of_node = |node: usize, k: usize| momenta[(mass.dofs * node + a, k)] * offset(node)[b];
            (0..6 + nf).map(|k| (0..positions.len()).map(|node| of_node(node, k)).sum()).collect()
        })
    });
    let rotation_momentum = |i: usize| field_momenta.subcols(3 + i, 1);
    let inertia_first = ReducedBody::PAIRS.map(|(i, j)| {
        let ij = inner(turned[j].as_ref(), rotation_momentum(i));
        let ji = inner(turned[i].as_ref(), rotation_momentum(j));
        (0..nf).map(|k| 0.5 * (ij[(k, 0)] + ji[(k, 0)])).collect()
    });
    let inertia_second =
        ReducedBody::PAIRS.map(|(i, j)| symmetric(inner(turned[i].as_ref(), turned_momenta[j].as_ref()).as_ref()));
    let gyroscopic = std::array::from_fn(|i| {
        let product = inner(flexible_momenta, turned[i].as_ref());
        Mat::from_fn(nf, nf, |k, l| 0.5 * (product[(k, l)] - product[(l, k)]))
    });
    // The modes are orthogonal to the rigid motions that the body has: what is left is rounding, and would leak momentum.
    let first = |is_zero: bool, field: usize| -> Vec<f64> {
        let products = inner(modes.shapes.as_ref(), field_momenta.subcols(field, 1));
        (0..nf).map(|k| if is_zero { 0.0 } else { products[(k, 0)] }).collect()
    };
    Ok(Products {
        rotation_products,
        position_products,
        inertia_first,
        inertia_second,
        gyroscopic,
        translation_first: std::array::from_fn(|i| first(is_free, i)),
        rotation_first: std::array::from_fn(|i| first(turns_freely, 3 + i)),
    })
}

fn symmetric(matrix: MatRef<'_, f64>) -> Mat<f64> {
    Mat::from_fn(matrix.nrows(), matrix.ncols(), |k, l| 0.5 * (matrix[(k, l)] + matrix[(l, k)]))
}
