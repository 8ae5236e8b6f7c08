//! NAFEMS plates in solid elements.

use faer::linalg::solvers::Solve;
use faer::sparse::{SparseColMat, SparseColMatRef, Triplet};
use faer::{Mat, Side};
use flexframe::fem_tet10::{Material, Materials, assemble, read_msh};
use nalgebra::DMatrix;

use crate::examples::{build, scene};
use crate::program::root;

/// Independent reference: NAFEMS FV12, the lowest and the highest of the frequencies quoted, Hz.
#[test]
fn fv12_free_thin_plate() {
    let scene = scene("nafems_fv12");
    let found = build(&scene).natural_frequencies();
    for (found, quoted) in
        found.iter().zip([[1.622; 2], [2.360; 2], [2.922; 2], [4.19, 4.23], [4.19, 4.23], [7.36, 7.42]])
    {
        // Measured: 1.6246, 2.3620, 2.9268, 4.2056, 4.2496, 7.3889 Hz on 24 × 24 × 1 bricks of six tetrahedra.
        assert!((0.98 * quoted[0]..1.02 * quoted[1]).contains(found), "{found} {quoted:?}");
    }
}

/// Independent reference: NAFEMS FV52, and subspace iteration on K and M without the rows and columns that are held.
/// The plate stands on its lower edges and may slide on them: u_z = 0 there.
#[test]
fn fv52_simply_supported_thick_plate() {
    let scene = scene("nafems_fv52");
    let model = build(&scene);
    assert_eq!(model.body.motion.to_string(), "2 translations and 1 rotation");
    let found = model.natural_frequencies();
    assert_eq!(found.len(), 7);
    // Regression only: on 8 × 8 × 1 bricks of six tetrahedra.
    let golden = [44.609715, 108.342541, 108.941973, 165.816197, 193.637946, 206.136637, 206.171609];
    // What NAFEMS quotes; in the first mode what quadratic solids give elsewhere, below the 45.897 of plate theory.
    let quoted = [44.7, 109.44, 109.44, 167.89, 193.59, 206.19, 206.19];
    for ((found, golden), quoted) in found.iter().zip(golden).zip(quoted) {
        assert!((found / golden - 1.0).abs() < 1e-6, "{found} {golden}");
        assert!((found / quoted - 1.0).abs() < 0.013, "{found} {quoted}");
    }

    let mesh = read_msh(root().join("meshes/nafems_fv52.msh")).unwrap();
    let steel = Material { young_modulus: 200e9, poisson_ratio: 0.3, density: 8000.0 };
    let matrices = assemble(&mesh, &Materials::Uniform(steel), &[]).unwrap();
    let on_edge = |x: f64| x.abs() < 1e-9 || (x - 10.0).abs() < 1e-9;
    let held = |[x, y, z]: [f64; 3]| z.abs() < 1e-9 && (on_edge(x) || on_edge(y));
    let free: Vec<usize> =
        (0..3 * mesh.positions().len()).filter(|i| i % 3 != 2 || !held(mesh.positions()[i / 3])).collect();
    assert_eq!(3 * mesh.positions().len() - free.len(), 4 * 16);
    let eigenvalues =
        smallest(matrices.stiffness(), matrices.mass(), &free, 10, (std::f64::consts::TAU * 40.0).powi(2));
    assert!(eigenvalues[..3].iter().all(|lambda| lambda.abs() < 1e-6 * eigenvalues[3]), "{eigenvalues:?}");
    for (found, lambda) in found.iter().zip(&eigenvalues[3..]) {
        let expected = lambda.sqrt() / std::f64::consts::TAU;
        // 1e-9 at most
        assert!((found / expected - 1.0).abs() < 1e-7, "{found} {expected}");
    }

    let refusal = model.start(&scene).unwrap_err().to_string();
    assert!(refusal.contains("leaves it 2 translations and 1 rotation; a run needs"), "{refusal}");
}

/// The smallest eigenvalues of K φ = λ M φ in the degrees of freedom `free`, by subspace iteration with K + shift·M.
fn smallest(
    stiffness: SparseColMatRef<'_, usize, f64>,
    mass: SparseColMatRef<'_, usize, f64>,
    free: &[usize],
    count: usize,
    shift: f64,
) -> Vec<f64> {
    let mut place = vec![usize::MAX; stiffness.nrows()];
    free.iter().enumerate().for_each(|(i, row)| place[*row] = i);
    let kept = |matrix: SparseColMatRef<'_, usize, f64>, scale: f64| -> Vec<Triplet<usize, usize, f64>> {
        let entries =
            matrix.triplet_iter().map(|entry| Triplet::new(place[entry.row], place[entry.col], scale * entry.val));
        entries.filter(|entry| entry.row != usize::MAX && entry.col != usize::MAX).collect()
    };
    let matrix =
        |entries: Vec<_>| SparseColMat::<usize, f64>::try_new_from_triplets(free.len(), free.len(), &entries).unwrap();
    let m = matrix(kept(mass, 1.0));
    let shifted = matrix([kept(stiffness, 1.0), kept(mass, shift)].concat());
    let factor = shifted.sp_cholesky(Side::Lower).unwrap();
    let columns = 2 * count;
    let mut x =
        Mat::from_fn(free.len(), columns, |i, j| ((1 + i + 7919 * j) as f64 * 12.9898).sin() * 43758.5453 % 1.0);
    let mut eigenvalues = vec![f64::INFINITY; columns];
    for _ in 0..100 {
        let y = factor.solve(&m * &x);
        let small =
            |product: Mat<f64>| DMatrix::from_fn(columns, columns, |i, j| 0.5 * (product[(i, j)] + product[(j, i)]));
        let (a, b) = (small(y.transpose() * (&shifted * &y)), small(y.transpose() * (&m * &y)));
        let inverse = b.cholesky().unwrap().l().try_inverse().unwrap();
        let eigen = (&inverse * a * inverse.transpose()).symmetric_eigen();
        let mut order: Vec<usize> = (0..columns).collect();
        order.sort_by(|i, j| eigen.eigenvalues[*i].total_cmp(&eigen.eigenvalues[*j]));
        let turn = inverse.transpose() * &eigen.eigenvectors;
        x = y * Mat::from_fn(columns, columns, |i, j| turn[(i, order[j])]);
        let before = eigenvalues;
        eigenvalues = order.iter().map(|i| eigen.eigenvalues[*i] - shift).collect();
        let change = |(now, before): (&f64, &f64)| (now - before).abs() / (now.abs() + shift);
        if eigenvalues[..count].iter().zip(&before).map(change).fold(0.0, f64::max) < 1e-12 {
            eigenvalues.truncate(count);
            return eigenvalues;
        }
    }
    panic!("no convergence: {eigenvalues:?}");
}
