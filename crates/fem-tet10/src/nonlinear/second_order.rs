//! Terms of a St. Venant–Kirchhoff body beyond the linear one: the strain of second order, its forces and its energy.
//!
//! ```text
//! E = ε(u) + ½ ε₂(u,u)        ε(a) = sym ∇a        ε₂(a,b) = sym(∇aᵀ ∇b)        W = ½ ∫ E : C : E dV
//!
//! v·g_ab = ∫ ε(v):C:ε₂(a,b) + ε(a):C:ε₂(v,b) + ε(b):C:ε₂(v,a) dV        g_ab = ∂²f_int/∂q_a∂q_b at rest
//! ```
//!
//! The forces are those of an [`Expansion`] whose fields have a coordinate each.

use faer::linalg::matmul::matmul;
use faer::{Accum, Mat, MatRef, Par};
use rayon::prelude::*;

use crate::element::deformation::check_field;
use crate::element::integration::Rules;
use crate::element::lanes::{Group, GroupPoint, LANES, PARTS, Rows};
use crate::element::vectorized::vectorized;
use crate::error::AssemblyError;
use crate::material::Materials;
use crate::mesh::checked::Mesh;
use crate::nonlinear::expansion::Expansion;

/// The forces g_ab (N×p, force per squared unit of the fields) of each pair (a, b) of columns of `fields` (N×k, length,
/// row `3·node + axis`): the second derivatives of the internal forces of a St. Venant–Kirchhoff body at rest.
///
/// `u·g_ab` is symmetric in u, a and b. With `r = ω × X`, `g_rb = ω × K b − K (ω × b)`.
///
/// # Errors
/// Materials that do not fit the mesh; fields whose rows are not the degrees of freedom, or with an entry that is not
/// finite.
///
/// # Panics
/// Where a pair names a column that `fields` does not have.
pub fn second_order_forces(
    mesh: &Mesh,
    materials: &Materials,
    fields: MatRef<'_, f64>,
    pairs: &[[usize; 2]],
) -> Result<Mat<f64>, AssemblyError> {
    assert!(pairs.as_flattened().iter().all(|column| *column < fields.ncols()), "the columns of pairs");
    let products: Vec<Vec<usize>> = (0..fields.ncols()).map(|column| vec![column]).collect();
    let wanted: Vec<Vec<usize>> = pairs.iter().map(|[a, b]| vec![*a.min(b), *a.max(b)]).collect();
    let expansion = Expansion { products: &products, fields, reference: None };
    let mut forces = expansion.forces(mesh, materials, &wanted)?;
    // The expansion has the coefficient of q_a².
    for (column, _) in pairs.iter().enumerate().filter(|(_, [a, b])| a == b) {
        forces.col_mut(column).iter_mut().for_each(|force| *force *= 2.0);
    }
    Ok(forces)
}

/// `∫ ε₂(a,b) : C : ε₂(c,d) dV` (energy, one for each of `quadruples`) of columns a, b, c, d of `fields` (N×k, length).
///
/// An eighth of it, with all four alike, is the strain energy of fourth order of `u`, before the body has found the
/// displacements of second order that relieve it.
///
/// # Errors
/// As [`second_order_forces`].
///
/// # Panics
/// Where a quadruple names a column that `fields` does not have.
pub fn second_order_energies(
    mesh: &Mesh,
    materials: &Materials,
    fields: MatRef<'_, f64>,
    quadruples: &[[usize; 4]],
) -> Result<Vec<f64>, AssemblyError> {
    check_field(mesh, "fields", fields)?;
    let materials = materials.of_elements(mesh)?;
    if quadruples.is_empty() {
        return Ok(Vec::new());
    }
    // The strain and the stress of a pair are found once at a point, in how many quadruples it may be.
    let mut pairs: Vec<[usize; 2]> = Vec::new();
    let mut number = |a: usize, b: usize| {
        let pair = [a.min(b), a.max(b)];
        pairs.iter().position(|other| *other == pair).unwrap_or_else(|| {
            pairs.push(pair);
            pairs.len() - 1
        })
    };
    let products: Vec<[usize; 2]> = quadruples.iter().map(|[a, b, c, d]| [number(*a, *b), number(*c, *d)]).collect();
    let (rules, fields, groups) = (Rules::new(), Rows::new(fields), Group::all(mesh));
    let points = rules.fine();
    let zero = || Mat::<f64>::zeros(pairs.len(), pairs.len());
    let of_part = |part: &[Group]| -> Mat<f64> {
        let mut sum = zero();
        let (mut relative, mut gradients) = (Vec::new(), Vec::new());
        // By pair, then point.
        let [mut strains, mut stresses] = [(); 2].map(|()| vec![[[0.0; LANES]; 6]; points.len() * pairs.len()]);
        for group in part {
            vectorized(
                #[inline(always)]
                || {
                    let (lame, positions) = (group.lame(&materials), group.positions(mesh));
                    fields.relative(mesh, group, &mut relative);
                    for (row, rule) in points.iter().enumerate() {
                        let point = GroupPoint::new(&positions, rule, group.count);
                        gradients.clear();
                        for relative in &relative {
                            gradients.push(point.gradient(relative));
                        }
                        for (pair, [a, b]) in pairs.iter().enumerate() {
                            let strain = gradients[*a].second_strain(&gradients[*b]);
                            let place = points.len() * pair + row;
                            strains[place] = strain.upper(1.0);
                            stresses[place] = strain.stress(&lame).scaled(&point.volume).upper(2.0);
                        }
                    }
                },
            );
            let [strains, stresses] = [&strains, &stresses].map(|numbers| {
                let numbers = numbers.as_flattened().as_flattened();
                MatRef::from_column_major_slice(numbers, 6 * LANES * points.len(), pairs.len())
            });
            matmul(sum.as_mut(), Accum::Add, stresses.transpose(), strains, 1.0, Par::Seq);
        }
        sum
    };
    let parts: Vec<Mat<f64>> = groups.par_chunks(groups.len().div_ceil(PARTS)).map(of_part).collect();
    let sum = parts.into_iter().fold(zero(), |sum, part| sum + part);
    Ok(products.iter().map(|[first, second]| sum[(*first, *second)]).collect())
}
