//! Stress at the nodes, where it is known exactly.

use std::collections::BTreeMap;

use faer::Mat;
use fem_tet10::{Material, Materials, Mesh, StressError, StressRecovery, von_mises};
use nalgebra::{Matrix3, Rotation3, Vector3};

use crate::fixtures::{ALUMINIUM, aluminium, data_mesh, field, workspace_mesh};

/// Columns of fields.
fn columns(fields: &[Vec<f64>]) -> Mat<f64> {
    Mat::from_fn(fields[0].len(), fields.len(), |i, j| fields[j][i])
}

fn at(nodal: &Mat<f64>, site: usize, column: usize) -> [f64; 6] {
    std::array::from_fn(|c| nodal[(6 * site + c, column)])
}

/// C:ε of a displacement gradient.
fn stress(material: &Material, gradient: &Matrix3<f64>) -> [f64; 6] {
    let (lambda, mu) = material.lame();
    let strain = 0.5 * (gradient + gradient.transpose());
    let s = lambda * strain.trace() * Matrix3::identity() + 2.0 * mu * strain;
    [s[(0, 0)], s[(1, 1)], s[(2, 2)], s[(0, 1)], s[(1, 2)], s[(2, 0)]]
}

/// Closed form: C:ε of quadratic displacements.
#[test]
fn the_stress_of_quadratic_displacements_is_exact_on_straight_elements() {
    let mesh = workspace_mesh("plate.msh");
    // More fields than are computed at once.
    let fields: Vec<Vec<f64>> = (0..11)
        .map(|k| {
            let k = f64::from(k);
            field(&mesh, |[x, y, z]| [x * y + k * z, k * y * z - x * x, z * z + x * z + k * x])
        })
        .collect();
    let recovery = StressRecovery::new(&mesh, &aluminium()).unwrap();
    let nodal = recovery.nodal_stress(columns(&fields).as_ref()).unwrap();
    let scale = nodal.norm_max();
    for (node, [x, y, z]) in mesh.positions().iter().copied().enumerate() {
        for column in [0, 7, 8, 10] {
            let k = column as f64;
            let gradient = Matrix3::new(y, x, k, -2.0 * x, k * z, k * y, z + k, 0.0, 2.0 * z + x);
            let truth = stress(&ALUMINIUM, &gradient);
            for (found, truth) in at(&nodal, node, column).into_iter().zip(truth) {
                assert!((found - truth).abs() < 1e-10 * scale, "{found} {truth}");
            }
        }
    }
}

/// Conserved: a finite rotation has no stress.
#[test]
fn a_finite_rotation_has_no_stress_of_second_order() {
    let mesh = data_mesh("cylinder.msh");
    let turned = Rotation3::from_scaled_axis(Vector3::new(0.4, -0.9, 0.7)).into_inner() - Matrix3::identity();
    let rotation = field(&mesh, |x| (turned * Vector3::from(x)).into());
    let recovery = StressRecovery::new(&mesh, &aluminium()).unwrap();
    let fields = columns(&[rotation]);
    let first = recovery.nodal_stress(fields.as_ref()).unwrap();
    let second = recovery.second_order_nodal_stress(fields.as_ref(), &[[0, 0]]).unwrap();
    assert!(first.norm_max() > 1e4);
    assert!((&first + &second).norm_max() < 1e-10 * first.norm_max(), "{:e}", (&first + &second).norm_max());
}

/// Closed form: σ = E ε in each material.
#[test]
fn a_node_between_two_materials_has_the_stress_of_each() {
    let mesh = data_mesh("two_materials.msh");
    let soft = Material { young_modulus: 1e3, poisson_ratio: 0.0, density: 1.0 };
    let stiff = Material { young_modulus: 7e3, ..soft };
    let by_name: BTreeMap<String, Material> = mesh.groups().iter().cloned().zip([soft, stiff]).collect();
    assert_eq!(by_name.len(), 2);
    let recovery = StressRecovery::new(&mesh, &Materials::ByGroup(by_name)).unwrap();
    let strain = 1e-3;
    let nodal = recovery.nodal_stress(columns(&[field(&mesh, |[x, ..]| [strain * x, 0.0, 0.0])]).as_ref()).unwrap();
    let sites = recovery.sites();
    assert!(sites.len() > mesh.positions().len());
    let (mut between, mut found_at) = (0, [0, 0]);
    for node in 0..mesh.positions().len() as u32 {
        let here = sites.of_node(node);
        between += usize::from(here.len() == 2);
        let mut values: Vec<f64> = here.map(|site| von_mises(&at(&nodal, site, 0))).collect();
        values.sort_by(f64::total_cmp);
        for value in &values {
            let of_soft = (value - 1.0).abs() < 1e-9;
            assert!(of_soft || (value - 7.0).abs() < 1e-9, "{value}");
            found_at[usize::from(of_soft)] += 1;
        }
        if let [low, high] = values[..] {
            assert!(high > 6.0 * low);
            let location = mesh.locate(mesh.positions()[node as usize]).unwrap();
            assert_eq!(sites.at(&location).len(), 2);
        }
    }
    assert!(between > 3 && found_at.iter().all(|count| *count > between), "{between} {found_at:?}");
    assert_eq!(sites.len(), mesh.positions().len() + between);
}

fn two_materials(mesh: &Mesh) -> Materials {
    let soft = Material { young_modulus: 1e3, poisson_ratio: 0.3, density: 1.0 };
    let stiff = Material { young_modulus: 7e3, ..soft };
    Materials::ByGroup(mesh.groups().iter().cloned().zip([soft, stiff]).collect())
}

/// Conserved: the same numbers among all nodes and among some.
#[test]
fn the_stress_at_some_nodes_is_that_of_these_nodes_among_all() {
    let mesh = data_mesh("two_materials.msh");
    let materials = two_materials(&mesh);
    let fields = columns(&[field(&mesh, |[x, y, z]| [x * y, z * z, x]), field(&mesh, |[x, _, z]| [z, x * x, x * z])]);
    let recovery = StressRecovery::new(&mesh, &materials).unwrap();
    let all = [
        recovery.nodal_stress(fields.as_ref()).unwrap(),
        recovery.second_order_nodal_stress(fields.as_ref(), &[[0, 1]]).unwrap(),
    ];
    // Every third, backwards; some lie between the materials.
    let nodes: Vec<u32> = (0..mesh.positions().len() as u32).rev().step_by(3).collect();
    let sites: Vec<usize> = nodes.iter().flat_map(|node| recovery.sites().of_node(*node)).collect();
    assert!(sites.len() > nodes.len());
    let of_nodes: Vec<u32> = sites.iter().map(|site| recovery.sites().nodes()[*site]).collect();
    let some = recovery.at_nodes(&nodes);
    assert_eq!(some.nodes().collect::<Vec<_>>(), of_nodes);
    let found = [
        some.nodal_stress(fields.as_ref()).unwrap(),
        some.second_order_nodal_stress(fields.as_ref(), &[[0, 1]]).unwrap(),
    ];
    for (found, all) in found.iter().zip(&all) {
        assert_eq!(found.nrows(), 6 * sites.len());
        for (i, site) in sites.iter().enumerate() {
            (0..found.ncols()).for_each(|k| assert_eq!(at(found, i, k), at(all, *site, k)));
        }
    }
}

#[test]
fn the_estimate_is_zero_for_a_stress_that_the_elements_have_and_not_for_another() {
    let mesh = workspace_mesh("plate.msh");
    let recovery = StressRecovery::new(&mesh, &aluminium()).unwrap();
    let fields = columns(&[
        field(&mesh, |[x, y, z]| [x * y, y * z, z * x]),
        field(&mesh, |[x, y, z]| [x * x * x, y * z * x, 0.0]),
    ]);
    let relative = [0, 1].map(|k| {
        let of_elements = recovery.error_estimate(fields.subcols(k, 1)).unwrap();
        assert_eq!(of_elements.len(), mesh.elements().len());
        of_elements.into_iter().sum::<StressError>().relative()
    });
    assert!(relative[0] < 1e-7 && relative[1] > 1e-5 && relative[1] < 1e-4, "{relative:?}");
}

/// Conserved: the estimates of one field after the other, whatever their number and elements: straight, curved and of two materials.
#[test]
fn the_estimate_of_many_fields_is_that_of_each() {
    let [curved, parted] = ["cylinder.msh", "two_materials.msh"].map(data_mesh);
    for (materials, mesh) in [(aluminium(), curved), (two_materials(&parted), parted)] {
        let recovery = StressRecovery::new(&mesh, &materials).unwrap();
        let one = |k: f64| field(&mesh, move |[x, y, z]| [k * x * y * z, x * z + k * y * y, (k * x).sin()]);
        let fields = columns(&[0.5, 1.0, 1.5, 2.0, 2.5, 3.0].map(one));
        let all = recovery.error_estimate(fields.as_ref()).unwrap();
        for k in 0..6 {
            let alone = recovery.error_estimate(fields.subcols(k, 1)).unwrap();
            assert!(alone.iter().copied().eq(all.iter().skip(k).step_by(6).copied()), "{k}");
        }
        assert_eq!(recovery.error_estimate(fields.get(.., ..0)).unwrap(), []);
    }
}

/// Conserved: a body that is turned far has the errors of the one that is not, of displacements that are turned with it.
#[test]
fn the_estimate_about_a_bent_body_does_not_see_that_it_is_turned() {
    let mesh = workspace_mesh("plate.msh");
    let recovery = StressRecovery::new(&mesh, &aluminium()).unwrap();
    let turn = Rotation3::from_scaled_axis(Vector3::new(0.4, -0.9, 0.7)).into_inner();
    let bent = |[x, y, z]: [f64; 3]| Vector3::new(x * x * x, y * z * x, 0.0);
    let fields = columns(&[
        field(&mesh, |x| bent(x).into()),
        field(&mesh, |x| (turn * bent(x)).into()),
        field(&mesh, |x| ((turn - Matrix3::identity()) * Vector3::from(x)).into()),
    ]);
    let straight = recovery.error_estimate(fields.subcols(0, 1)).unwrap();
    let product = (fields.col(2), fields.subcols(1, 1));
    let turned = recovery.error_estimate_of_product(fields.subcols(1, 1), product).unwrap();
    let all = |list: &[StressError]| list.iter().copied().sum::<StressError>();
    let (straight, turned) = (all(&straight), all(&turned));
    for (straight, turned) in [(straight.energy, turned.energy), (straight.error, turned.error)] {
        assert!((turned / straight - 1.0).abs() < 1e-9, "{turned} {straight}");
    }
    // Without the product the turning counts as strain.
    let blind = all(&recovery.error_estimate(fields.subcols(1, 1)).unwrap());
    assert!((blind.energy / straight.energy - 1.0).abs() > 0.1, "{} {}", blind.energy, straight.energy);
}

/// Independent reference: ½ uᵀKu of the stiffness matrix.
#[test]
fn the_energy_of_the_estimate_is_that_of_the_stiffness_matrix() {
    // Curved elements, and straight ones.
    for mesh in [data_mesh("cylinder.msh"), workspace_mesh("plate.msh")] {
        let recovery = StressRecovery::new(&mesh, &aluminium()).unwrap();
        let displacements = [
            field(&mesh, |[x, y, z]| [1e-3 * x * y, 1e-3 * z * z, 1e-3 * (x - y)]),
            field(&mesh, |[x, y, z]| [1e-3 * z * z, 1e-3 * x, 1e-5 * x * y * z]),
        ];
        let fields = columns(&displacements);
        let both = recovery.error_estimate(fields.as_ref()).unwrap();
        let matrices = fem_tet10::assemble(&mesh, &aluminium(), &[]).unwrap();
        for (k, displacement) in displacements.iter().enumerate() {
            let all: StressError = both.iter().skip(k).step_by(2).copied().sum();
            let energy = 0.5 * crate::fixtures::form(displacement, matrices.stiffness(), displacement);
            assert!((all.energy / energy - 1.0).abs() < 1e-10, "{} {energy}", all.energy);
        }
    }
}
