//! Rates of K and M with materials, point masses and shape.

use faer::Mat;
use fem_tet10::{BodyNumber, Material, Materials, MatrixRates, Mesh, PointMass, assemble};

use crate::fixtures::{ALUMINIUM, aluminium, data_mesh, parts, workspace_mesh};

fn fields(mesh: &Mesh) -> Mat<f64> {
    Mat::from_fn(3 * mesh.positions().len(), 2, |i, j| ((1 + i * (j + 3)) as f64 * 0.37).sin())
}

/// KU and MU.
fn products(mesh: &Mesh, materials: &Materials, masses: &[PointMass], fields: &Mat<f64>) -> [Mat<f64>; 2] {
    let matrices = assemble(mesh, materials, masses).unwrap();
    [matrices.stiffness() * fields, matrices.mass() * fields]
}

/// Central differences of fourth order of KU and MU, whose error is the fourth power of the step.
fn differences(step: f64, at: impl Fn(f64) -> [Mat<f64>; 2]) -> [Mat<f64>; 2] {
    let [a, b, c, d] = [-2.0, -1.0, 1.0, 2.0].map(|k| at(k * step));
    std::array::from_fn(|i| (&a[i] - &d[i] + (&c[i] - &b[i]) * faer::Scale(8.0)) * faer::Scale(1.0 / (12.0 * step)))
}

#[track_caller]
fn assert_same(found: &[Mat<f64>; 2], expected: &[Mat<f64>; 2]) {
    for (found, expected) in found.iter().zip(expected) {
        let (off, size) = ((found - expected).norm_max(), expected.norm_max());
        assert!(off <= 1e-8 * size, "{:.2e} of {size:.2e}", off / size);
    }
}

fn two() -> (Mesh, [Material; 2]) {
    let mesh = data_mesh("two_materials.msh");
    let steel = Material { young_modulus: 210e3, poisson_ratio: 0.3, density: 7.8e-9 };
    (mesh, [ALUMINIUM, steel])
}

fn by_group(mesh: &Mesh, materials: [Material; 2]) -> Materials {
    Materials::ByGroup(mesh.groups().iter().cloned().zip(materials).collect())
}

/// Independent reference: differences of matrices that are assembled anew.
#[test]
fn rates_with_constants_of_a_material_are_those_of_matrices_assembled_anew() {
    let (mesh, materials) = two();
    let fields = fields(&mesh);
    let name = Some(mesh.groups()[1].clone());
    type Change = fn(&mut Material, f64);
    let changes: [(BodyNumber, f64, Change); 3] = [
        (BodyNumber::YoungModulus(name.clone()), 1e3, |material, by| material.young_modulus += by),
        (BodyNumber::PoissonRatio(name.clone()), 1e-3, |material, by| material.poisson_ratio += by),
        (BodyNumber::Density(name), 1e-10, |material, by| material.density += by),
    ];
    for (number, step, change) in changes {
        let rates = MatrixRates::new(&mesh, &by_group(&mesh, materials), &[], &number).unwrap();
        let expected = differences(step, |by| {
            let mut changed = materials;
            change(&mut changed[1], by);
            products(&mesh, &by_group(&mesh, changed), &[], &fields)
        });
        assert_same(&rates.products(&mesh, fields.as_ref()).unwrap(), &expected);
        assert!(rates.velocities().is_none());
    }
}

/// Independent reference: differences of matrices that are assembled anew.
#[test]
fn the_rate_with_a_point_mass_is_that_of_matrices_assembled_anew() {
    let mesh = workspace_mesh("plate.msh");
    let fields = fields(&mesh);
    for spread in [None, Some(20.0)] {
        let mass = PointMass { at: [480.0, 20.0, 5.0], mass: 1e-3, spread };
        let rates = MatrixRates::new(&mesh, &aluminium(), &[mass], &BodyNumber::PointMass(0)).unwrap();
        let expected = differences(1e-4, |by| {
            products(&mesh, &aluminium(), &[PointMass { mass: mass.mass + by, ..mass }], &fields)
        });
        assert_same(&rates.products(&mesh, fields.as_ref()).unwrap(), &expected);
    }
}

/// Independent reference: differences of matrices of meshes whose nodes have moved; straight elements, curved ones, and a group whose
/// neighbours follow.
#[test]
fn rates_with_a_stretch_are_those_of_moved_meshes() {
    let (mesh, materials) = two();
    let both = by_group(&mesh, materials);
    let group = Some(mesh.groups()[1].clone());
    let cases = [
        (data_mesh("cylinder.msh"), aluminium(), BodyNumber::Stretch(None, 2)),
        (data_mesh("cylinder.msh"), aluminium(), BodyNumber::Stretch(None, 0)),
        (workspace_mesh("plate.msh"), aluminium(), BodyNumber::Stretch(None, 2)),
        (mesh, both, BodyNumber::Stretch(group, 1)),
    ];
    for (mesh, materials, number) in cases {
        let fields = fields(&mesh);
        let rates = MatrixRates::new(&mesh, &materials, &[], &number).unwrap();
        let velocities = rates.velocities().unwrap();
        let expected = differences(1e-3, |by| {
            let mut parts = parts(&mesh);
            for (x, v) in parts.positions.iter_mut().zip(velocities) {
                (0..3).for_each(|axis| x[axis] += by * v[axis]);
            }
            products(&Mesh::new(parts).unwrap(), &materials, &[], &fields)
        });
        assert_same(&rates.products(&mesh, fields.as_ref()).unwrap(), &expected);
    }
}

#[test]
fn a_group_whose_elements_are_in_another_with_a_material_is_refused() {
    let mesh = data_mesh("overlapping_groups.msh");
    let materials = Materials::ByGroup(mesh.groups().iter().map(|name| (name.clone(), ALUMINIUM)).collect());
    let refused = mesh.groups().iter().any(|name| {
        MatrixRates::new(&mesh, &materials, &[], &BodyNumber::YoungModulus(Some(name.clone())))
            .is_err_and(|error| error.to_string().contains(name))
    });
    assert!(refused);
    let unknown = BodyNumber::Density(Some("none".to_owned()));
    assert!(MatrixRates::new(&mesh, &materials, &[], &unknown).is_err());
}
