//! The answers of the finite-element model that are kept in files, of parts that stay together.

use body_file::BodyFileError;
use faer::Mat;
use fem_tet10::faer::MatRef;
use modal::{Constants, ModalError, Modes, ReducedBody, RigidModes, RigidMotion, SecondOrderShapes, SolveStats};
use nalgebra::{Matrix3, Vector3};

use crate::cache::answer::{Answer, Kept, by_columns};

/// Fields (3n×k).
pub(crate) fn of_fields(fields: MatRef<'_, f64>) -> Answer {
    Answer::default().with_fields("fields", fields)
}

pub(crate) fn fields(kept: &Kept<'_>, rows: usize, columns: usize) -> Result<Mat<f64>, BodyFileError> {
    kept.fields("fields", rows, Some(columns))
}

/// Stress at the sites (6m×k), one after the other (k×m×6).
pub(crate) fn of_stress(stress: MatRef<'_, f64>) -> Answer {
    Answer::default().with_numbers("stress", &[stress.ncols(), stress.nrows() / 6, 6], by_columns(stress))
}

pub(crate) fn stress(kept: &Kept<'_>, sites: usize, columns: usize) -> Result<Mat<f64>, BodyFileError> {
    let values = kept.numbers("stress", &[Some(columns), Some(sites), Some(6)])?.values;
    Ok(MatRef::from_column_major_slice(&values, 6 * sites, columns).to_owned())
}

pub(crate) fn of_modes(modes: &Modes) -> Answer {
    let Modes { rigid, eigenvalues, shapes, residuals, force_residuals, stats } = modes;
    Answer::default()
        .with_numbers("mass", &[1], vec![rigid.mass])
        .with_list("center_of_mass", rigid.center_of_mass.as_slice())
        .with_list("origin", rigid.origin.as_slice())
        .with_list("inertia", rigid.inertia.as_slice())
        .with_list("translation_basis", rigid.translation_basis.as_slice())
        .with_list("rotation_basis", rigid.rotation_basis.as_slice())
        .with_fields("rigid_shapes", rigid.shapes.as_ref())
        .with_list("eigenvalues", eigenvalues)
        .with_fields("shapes", shapes.as_ref())
        .with_list("residuals", residuals)
        .with_list("force_residuals", force_residuals)
        .with_numbers("shift", &[1], vec![stats.shift])
        .with_counts(
            "counts",
            &[stats.unknowns, stats.factor_entries, stats.block_solves, stats.basis_size].map(|count| count as u64),
        )
}

pub(crate) fn modes(kept: &Kept<'_>, rows: usize, motion: RigidMotion) -> Result<Modes, BodyFileError> {
    let vector = |name| Ok::<_, BodyFileError>(Vector3::from(kept.array::<3>(name)?));
    let matrix = |name| Ok::<_, BodyFileError>(Matrix3::from_column_slice(&kept.array::<9>(name)?));
    let eigenvalues = kept.list("eigenvalues", None)?;
    let flexible = eigenvalues.len();
    let [unknowns, factor_entries, block_solves, basis_size] = kept.counts("counts")?.map(|count| count as usize);
    Ok(Modes {
        rigid: RigidModes {
            motion,
            mass: kept.array::<1>("mass")?[0],
            center_of_mass: vector("center_of_mass")?,
            origin: vector("origin")?,
            inertia: matrix("inertia")?,
            translation_basis: matrix("translation_basis")?,
            rotation_basis: matrix("rotation_basis")?,
            shapes: kept.fields("rigid_shapes", rows, Some(6))?,
        },
        shapes: kept.fields("shapes", rows, Some(flexible))?,
        residuals: kept.list("residuals", Some(flexible))?,
        force_residuals: kept.list("force_residuals", Some(flexible))?,
        eigenvalues,
        // No time was spent on it, and no memory, which goes with the number of threads.
        stats: SolveStats {
            shift: kept.array::<1>("shift")?[0],
            unknowns,
            factor_entries,
            block_solves,
            basis_size,
            ..SolveStats::default()
        },
    })
}

/// Answer with the shapes after the first `before`.
pub(crate) fn of_added_shapes(modes: &Modes, before: usize) -> Answer {
    let added = modes.shapes.ncols() - before;
    Answer::default()
        .with_list("eigenvalues", &modes.eigenvalues[before..])
        .with_fields("shapes", modes.shapes.subcols(before, added))
}

/// The first `before` shapes of `modes`, and those kept.
pub(crate) fn with_added_shapes(kept: &Kept<'_>, mut modes: Modes, before: usize) -> Result<Modes, BodyFileError> {
    let rows = modes.shapes.nrows();
    let eigenvalues = kept.list("eigenvalues", None)?;
    let shapes = kept.fields("shapes", rows, Some(eigenvalues.len()))?;
    modes.eigenvalues.truncate(before);
    modes.eigenvalues.extend(eigenvalues);
    let mut all = Mat::zeros(rows, before + shapes.ncols());
    all.as_mut().subcols_mut(0, before).copy_from(modes.shapes.subcols(0, before));
    all.as_mut().subcols_mut(before, shapes.ncols()).copy_from(&shapes);
    modes.shapes = all;
    Ok(modes)
}

pub(crate) fn of_second_order_shapes(shapes: &SecondOrderShapes) -> Answer {
    of_added_shapes(&shapes.modes, shapes.dynamic)
        .with_matrix("slopes", shapes.slopes.as_ref())
        .with_matrix("cubic", shapes.cubic.as_ref())
        .with_matrix("relief", shapes.relief.as_ref())
}

pub(crate) fn second_order_shapes(
    kept: &Kept<'_>,
    modes: Modes,
    large: &[usize],
) -> Result<SecondOrderShapes, BodyFileError> {
    let dynamic = modes.shapes.ncols();
    let pairs = Some(SecondOrderShapes::pairs(large.len()).len());
    let modes = with_added_shapes(kept, modes, dynamic)?;
    Ok(SecondOrderShapes {
        slopes: kept.matrix("slopes", Some(modes.shapes.ncols()), pairs)?,
        cubic: kept.matrix("cubic", Some(large.len()), pairs)?,
        relief: kept.matrix("relief", pairs, pairs)?,
        modes,
        dynamic,
        large: large.to_vec(),
    })
}

/// The constants that the mesh makes.
pub(crate) fn of_reduced_body(body: &ReducedBody) -> Answer {
    let vectors = |vectors: &[Vec<f64>]| vectors.concat();
    let (nf, all) = (body.flexible(), 6 + body.flexible());
    let positions: Vec<f64> = body.position_products.iter().flatten().flatten().copied().collect();
    Answer::default()
        .with_matrices("rotation_products", body.rotation_products.iter().flatten())
        .with_numbers("position_products", &[9, all], positions)
        .with_numbers("inertia_first", &[6, nf], vectors(&body.inertia_first))
        .with_matrices("inertia_second", &body.inertia_second)
        .with_matrices("gyroscopic", &body.gyroscopic)
        .with_numbers("translation_first", &[3, nf], vectors(&body.translation_first))
        .with_numbers("rotation_first", &[3, nf], vectors(&body.rotation_first))
}

/// The body whose constants these are, and the others those of its `modes`.
pub(crate) fn reduced_body(kept: &Kept<'_>, modes: &Modes) -> Result<ReducedBody, BodyFileError> {
    let rigid = &modes.rigid;
    let nf = modes.eigenvalues.len();
    let lists = |name: &str, count: usize, each: usize| -> Result<Vec<Vec<f64>>, BodyFileError> {
        let values = kept.numbers(name, &[Some(count), Some(each)])?.values;
        Ok((0..count).map(|i| values[i * each..(i + 1) * each].to_vec()).collect())
    };
    let matrices = |name: &str, count: usize, size: usize| kept.matrices(name, count, size);
    let unfit = || kept.damaged("its constants do not fit together".to_owned());
    let rotation_products = matrices("rotation_products", 9, 6 + nf)?;
    let position_products = lists("position_products", 9, 6 + nf)?;
    let constants = Constants {
        mass: rigid.mass,
        center_of_mass: rigid.center_of_mass,
        motion: rigid.motion,
        origin: rigid.origin,
        inertia: rigid.inertia,
        translation_basis: rigid.translation_basis,
        rotation_basis: rigid.rotation_basis,
        circular_frequencies: modes.eigenvalues.iter().map(|lambda| lambda.sqrt()).collect(),
        natural_modes: modes.natural(),
        rotation_products: std::array::from_fn(|a| std::array::from_fn(|b| rotation_products[3 * a + b].clone())),
        position_products: std::array::from_fn(|a| std::array::from_fn(|b| position_products[3 * a + b].clone())),
        inertia_first: lists("inertia_first", 6, nf)?.try_into().map_err(|_| unfit())?,
        inertia_second: matrices("inertia_second", 6, nf)?.try_into().map_err(|_| unfit())?,
        gyroscopic: matrices("gyroscopic", 3, nf)?.try_into().map_err(|_| unfit())?,
        translation_first: lists("translation_first", 3, nf)?.try_into().map_err(|_| unfit())?,
        rotation_first: lists("rotation_first", 3, nf)?.try_into().map_err(|_| unfit())?,
        stress_stiffness: None,
    };
    ReducedBody::from_constants(constants).map_err(|error: ModalError| kept.damaged(error.to_string()))
}
