//! Refusals, and their words.

use faer::Mat;
use faer::sparse::{SparseColMat, SparseColMatRef, Triplet};
use modal::{MassMatrix, ModalError, Modes, NodalMass, RigidModes, Solver, Support};
use nalgebra::Vector3;
use reduced_body::{BodyError, RigidMotion};

use crate::bodies::{Body, CORNER, block, free_modes, tetrahedra};

type Sparse = SparseColMat<usize, f64>;

/// The matrix with each entry replaced; `None` takes the entry out.
fn changed(matrix: SparseColMatRef<'_, usize, f64>, change: impl Fn(usize, usize, f64) -> Option<f64>) -> Sparse {
    let entries: Vec<_> = matrix
        .triplet_iter()
        .filter_map(|t| change(t.row, t.col, *t.val).map(|value| Triplet::new(t.row, t.col, value)))
        .collect();
    SparseColMat::try_new_from_triplets(matrix.nrows(), matrix.ncols(), &entries).unwrap()
}

fn small() -> Body {
    block([10.0, 8.0, 6.0], [1, 1, 1])
}

fn message(result: Result<Modes, ModalError>, words: &[&str]) -> ModalError {
    let error = result.unwrap_err();
    let message = error.to_string();
    assert!(words.iter().all(|word| message.contains(word)), "{message}");
    error
}

/// Solves the small block with its stiffness changed.
fn with_stiffness(change: impl Fn(usize, usize, f64) -> Option<f64>) -> Result<Modes, ModalError> {
    let body = small();
    free_modes(changed(body.matrices.stiffness(), change).as_ref(), body.matrices.mass(), &body.positions, 3)
}

/// Solves the small block with its mass changed.
fn with_mass(change: impl Fn(usize, usize, f64) -> Option<f64>) -> Result<Modes, ModalError> {
    let body = small();
    free_modes(body.matrices.stiffness(), changed(body.matrices.mass(), change).as_ref(), &body.positions, 3)
}

#[test]
fn a_grounded_body() {
    let error = message(
        with_stiffness(|i, j, k| Some(if i == 4 && j == 4 { 2.0 * k } else { k })),
        &["not free", "translation along y", "remove the supports"],
    );
    assert!(matches!(error, ModalError::NotFree { .. }));
}

#[test]
fn a_hinge_along_a_shared_edge() {
    // The second tetrahedron shares the edge from (0, 0, 0) to (10, 0, 0) only.
    let hinge = tetrahedra(&[CORNER, CORNER.map(|x| [x[0], -x[1], -x[2]])]);
    assert_eq!(hinge.positions.len(), 17);
    let error = message(hinge.try_modes(4), &["mechanism", "1 mode(s)", "moves most", "Join them by faces"]);
    match error {
        ModalError::Mechanism { count: 1, node, position, .. } => {
            assert_eq!(position, hinge.positions[node]);
            assert!(position[1] != 0.0 || position[2] != 0.0, "{position:?} is on the hinge");
        }
        other => panic!("{other:?}"),
    }
}

#[test]
fn tetrahedra_that_share_a_node() {
    let joint = tetrahedra(&[
        CORNER,
        CORNER.map(|x| x.map(|c| -c)).into_iter().enumerate().fold(CORNER, |mut t, (i, x)| {
            // Turned inside out by the reflection; two corners change places.
            t[[0, 2, 1, 3][i]] = x;
            t
        }),
    ]);
    assert_eq!(joint.positions.len(), 19);
    message(joint.try_modes(4), &["mechanism", "3 mode(s)"]);
}

/// Conserved: λ/t² of a thin strip does not depend on its thickness t.
#[test]
fn a_strip_so_thin_that_rounding_hides_its_stiffness() {
    // Eigenvalues of bending go with the square of the thickness, and rounding not at all.
    let lowest = |thickness: f64| {
        let strip = block([10.0, 0.1, thickness], [20, 1, 1]);
        strip.try_modes(1).map(|modes| modes.eigenvalues[0] / thickness.powi(2))
    };
    let expected = lowest(1e-2).unwrap();
    let (mut found, mut hidden) = (0, 0);
    for eighth in 20..34 {
        let thickness = 10.0_f64.powf(-0.125 * f64::from(eighth));
        match lowest(thickness) {
            Ok(eigenvalue) => {
                // 0.12 of the eigenvalue at 1e-3, below 0.02 at more
                found += 1;
                assert!((eigenvalue / expected - 1.0).abs() < 0.7, "{thickness:e}: {eigenvalue:e}, {expected:e}");
            }
            Err(ModalError::HiddenByRounding { eigenvalue, rounding, .. }) => {
                hidden += 1;
                assert!(rounding > 3.0 * eigenvalue, "{thickness:e}: {rounding:e} of {eigenvalue:e}");
            }
            Err(ModalError::Mechanism { .. } | ModalError::Indefinite { .. } | ModalError::NotConverged { .. }) => {}
            Err(error) => panic!("{thickness:e}: {error}"),
        }
    }
    // 5 and 3
    assert!(found >= 3 && hidden >= 1, "{found} {hidden}");
}

#[test]
fn a_negative_stiffness() {
    let error = message(with_stiffness(|_, _, k| Some(-k)), &["not positive semi-definite", "material"]);
    assert!(matches!(error, ModalError::Indefinite { .. }));
}

#[test]
fn no_stiffness_at_all() {
    message(with_stiffness(|_, _, _| Some(0.0)), &["not free"]);
}

#[test]
fn one_triangle() {
    message(with_stiffness(|i, j, k| (i >= j).then_some(k)), &["stiffness", "not symmetric", "both triangles"]);
    message(with_stiffness(|i, j, k| (i <= j).then_some(k)), &["stiffness", "not symmetric", "both triangles"]);
    message(with_mass(|i, j, m| (i >= j).then_some(m)), &["mass", "not symmetric", "both triangles"]);
}

#[test]
fn masses_that_no_rigid_body_has() {
    let error =
        message(with_mass(|i, _, m| Some(if i % 3 == 2 { 1.1 * m } else { m })), &["mass along the axes", "identity"]);
    match error {
        // √6 0.1/3 of the mean
        ModalError::NoRigidBodyMass { relative, .. } => assert!((relative - 0.0790).abs() < 1e-4, "{relative}"),
        other => panic!("{other:?}"),
    }
    let coupled = with_mass(|i, j, m| Some(if i / 3 == j / 3 && i != j { 1.0 } else { m }));
    assert!(matches!(message(coupled, &["negative kinetic energy"]), ModalError::IndefiniteMass { place: None }));
    let negative = with_mass(|i, j, m| Some(if i == 7 && j == 7 { -m } else { m }));
    let negative = message(negative, &["degree of freedom 1 of node 2"]);
    assert!(matches!(negative, ModalError::IndefiniteMass { place: Some([2, 1]) }));
}

#[test]
fn bodies_that_are_none() {
    let error = message(with_mass(|_, _, m| Some(-m)), &["mass", "all three moments"]);
    assert!(matches!(error, ModalError::Body(BodyError::NoInertia { .. })));
    // Mass at one place only.
    let point = with_mass(|i, j, _| Some(if i == j && i < 3 { 1.0 } else { 0.0 }));
    assert!(point.is_err());
}

#[test]
fn more_modes_than_there_are() {
    let one = tetrahedra(&[CORNER]);
    let error = message(one.try_modes(25), &["25 flexible modes", "only 24"]);
    assert!(matches!(error, ModalError::TooManyModes { requested: 25, available: 24 }));
    // A node without mass gives none.
    let k = one.matrices.stiffness();
    let m = changed(one.matrices.mass(), |i, j, m| Some(if i / 3 == 9 || j / 3 == 9 { 0.0 } else { m }));
    message(free_modes(k, m.as_ref(), &one.positions, 22), &["only 21"]);
    let all = free_modes(k, m.as_ref(), &one.positions, 21).unwrap();
    assert_eq!(all.eigenvalues.len(), 21);
}

#[test]
fn sizes_that_do_not_agree() {
    let body = small();
    let (k, m) = (body.matrices.stiffness(), body.matrices.mass());
    let fewer = &body.positions[1..];
    let error = message(free_modes(k, m, fewer, 3), &["stiffness has 81", "expected 78"]);
    assert!(matches!(error, ModalError::Size { .. }));
    let other = block([1.0; 3], [2, 1, 1]);
    message(free_modes(k, other.matrices.mass(), &body.positions, 3), &["mass has 135", "expected 81"]);
    let none: Sparse = SparseColMat::try_new_from_triplets(0, 0, &[]).unwrap();
    message(free_modes(none.as_ref(), none.as_ref(), &[], 0), &["stiffness has 0"]);
}

#[test]
fn numbers_that_are_none() {
    message(with_stiffness(|i, _, k| Some(if i == 5 { f64::NAN } else { k })), &["stiffness", "NaN", "finite"]);
    message(with_mass(|i, _, m| Some(if i == 5 { f64::INFINITY } else { m })), &["mass", "inf", "finite"]);
    let body = small();
    let mut positions = body.positions.clone();
    positions[7][1] = f64::NAN;
    let result = free_modes(body.matrices.stiffness(), body.matrices.mass(), &positions, 3);
    let error = message(result, &["positions", "node 7"]);
    assert!(matches!(error, ModalError::NotFinite { index: 7, .. }));
}

/// Conserved: the same eigenvalues with and without stored zeros.
#[test]
fn patterns_that_differ_are_no_reason_to_refuse() {
    let body = small();
    let (k, m) = (body.matrices.stiffness(), body.matrices.mass());
    // M without the zeros that it stores to share K's pattern, and a lumped M.
    let slim = changed(m, |i, j, m| (i % 3 == j % 3).then_some(m));
    let (full, slim) = (body.modes(9), free_modes(k, slim.as_ref(), &body.positions, 9).unwrap());
    for (a, b) in full.eigenvalues.iter().zip(&slim.eigenvalues) {
        assert!((a / b - 1.0).abs() < 1e-11);
    }
}

#[test]
fn no_flexible_modes_are_an_answer_too() {
    let modes = small().modes(0);
    assert_eq!((modes.eigenvalues.len(), modes.shapes.ncols(), modes.rigid.shapes.ncols()), (0, 0, 6));
}

/// The refusal of a support of the small block.
fn with_support(motion: RigidMotion, nodes: &[u32]) -> Option<ModalError> {
    let Body { positions, matrices } = small();
    let support = Support::new(motion, nodes.to_vec());
    Solver::new(matrices.stiffness(), matrices.mass(), &positions, &support).err()
}

#[test]
fn a_support_that_holds_too_little() {
    // The block has 3×3×3 nodes: 0, 1, 2 are in line along x, 3 is beside 0, 26 is opposite.
    let at = |node: usize| Vector3::from(small().positions[node]);
    let (pin, clamp) = (RigidMotion::pin(at(0)), RigidMotion::clamp(at(0)));
    let (hinge, slider) = (RigidMotion::hinge(at(0), Vector3::x()), RigidMotion::slider(Vector3::x()));
    let cases: [(RigidMotion, &[u32], usize); 10] = [
        (pin, &[], 6),
        // A node beside the point of a pin moves about it: only the distance is kept.
        (pin, &[26], 5),
        (hinge, &[], 6),
        (hinge, &[1], 3),
        (hinge, &[1, 1], 3),
        // Beside its own rotation the body can turn about the line through both nodes.
        (hinge, &[0, 3], 2),
        (clamp, &[0, 1, 2], 1),
        (clamp, &[0, 26], 1),
        (slider, &[0, 1, 2], 2),
        (slider, &[], 6),
    ];
    for (motion, nodes, rigid) in cases {
        match with_support(motion, nodes) {
            Some(error @ ModalError::Underheld { held, left, expected }) => {
                assert_eq!((left, expected), (rigid, motion.count()), "{motion:?} {nodes:?}: {error}");
                assert!(held <= nodes.len() && error.to_string().contains("hold more nodes"));
            }
            other => panic!("{motion:?} {nodes:?}: {other:?}"),
        }
    }
    let enough: [(RigidMotion, &[u32]); 6] = [
        (pin, &[0]),
        (pin, &[0, 26]),
        (hinge, &[0, 2]),
        (hinge, &[0, 1, 3]),
        (clamp, &[0, 1, 3]),
        (slider, &[3, 1, 0]),
    ];
    for (motion, nodes) in enough {
        assert!(with_support(motion, nodes).is_none(), "{motion:?} {nodes:?}");
    }
}

#[test]
fn a_support_that_is_not_there() {
    let clamp = RigidMotion::clamp(Vector3::zeros());
    let error = with_support(clamp, &[0, 1, 27]).unwrap();
    assert!(matches!(error, ModalError::HeldNode { node: 27, count: 27 }), "{error}");
    let error = with_support(RigidMotion::pin(Vector3::new(0.0, f64::NAN, 0.0)), &[0]).unwrap();
    assert!(
        matches!(error, ModalError::Body(BodyError::NotFinite { what: "the support's point", index: 1, .. })),
        "{error}"
    );
    for axis in [Vector3::new(1.0, 1.0, 0.0), Vector3::zeros(), Vector3::new(f64::NAN, 0.0, 0.0)] {
        for motion in [RigidMotion::hinge(Vector3::zeros(), axis), RigidMotion::slider(axis)] {
            let error = with_support(motion, &[0, 1, 3]).unwrap();
            assert!(matches!(error, ModalError::Body(BodyError::NotUnit { .. })), "{error}");
        }
    }
}

#[test]
fn what_does_not_fit_is_refused_wherever_it_is_given() {
    let body = small();
    let (nodes, positions) = (body.positions.len(), &body.positions[..]);
    let zeros = |rows: usize, columns: usize| Sparse::try_new_from_triplets(rows, columns, &[]).unwrap();
    for (rows, columns) in [(6, 3), (3, 6), (4, 4)] {
        let error = NodalMass::new(zeros(rows, columns).as_ref()).err().unwrap();
        assert!(matches!(error, ModalError::Size { what: "mass", .. }), "{error}");
    }
    assert!(matches!(MassMatrix::new(zeros(6, 3).as_ref(), 1), Err(ModalError::Size { expected: 3, found: 6, .. })));
    let nan = changed(body.matrices.mass(), |i, j, m| Some(if i == 7 && j == 7 { f64::NAN } else { m }));
    let error = MassMatrix::new(nan.as_ref(), nodes).unwrap_err();
    assert!(error.to_string().contains("mass: NaN in column 7 (counted from 0)"), "{error}");

    let mass = MassMatrix::new(body.matrices.mass(), nodes).unwrap();
    for few in [0, nodes - 1] {
        let error = RigidModes::new(&mass, &positions[..few], RigidMotion::free()).unwrap_err();
        assert!(matches!(error, ModalError::Length { what: "the list of positions", .. }), "{error}");
    }
    let solver = body.held(&Support::free());
    let modes = solver.modes(3, |_| ()).unwrap();
    let point = |weights: [f64; 2]| modes.point(positions, &[0, 1], &weights);
    assert!(matches!(point([1.0, 1.0]), Err(ModalError::Weights { sum: 2.0 })));
    assert!(point([-0.5, 1.5]).is_ok());

    let shapes = |large: &[usize], following: &[usize], rows: usize, count: usize, number: f64| {
        let fields = Mat::from_fn(rows, count, |_, _| number);
        solver.large_shapes(modes.clone(), large, following, fields.as_ref())
    };
    assert!(matches!(shapes(&[0], &[], 3 * nodes, 1, 0.0), Err(ModalError::Length { expected: 2, found: 1, .. })));
    assert!(matches!(shapes(&[0], &[], 3 * nodes + 1, 2, 0.0), Err(ModalError::Size { .. })));
    assert!(matches!(shapes(&[0], &[], 3 * nodes, 2, f64::NAN), Err(ModalError::NotFinite { place: "column", .. })));
    for [large, following] in [[90, 1], [1, 1], [0, 3]] {
        let found = shapes(&[large], &[following], 3 * nodes, 4, 0.0);
        assert!(matches!(found, Err(ModalError::LargeModes { count: 3, .. })), "{large:?}");
    }
    assert!(matches!(shapes(&[1, 0], &[], 3 * nodes, 7, 0.0), Err(ModalError::LargeModes { count: 3, .. })));
}
