//! Materials and point masses that do not fit the mesh.

use std::collections::BTreeMap;

use fem_tet10::{AssemblyError, AssemblyFault, Material, Materials, PointMass, assemble, centroid_lumped_inertia};

use crate::fixtures::{ALUMINIUM, aluminium, data_mesh, workspace_mesh};

/// The refusal, which must say all of `says`; the lumped mass properties must refuse the same.
#[track_caller]
fn refusal(materials: &Materials, masses: &[PointMass], says: &[&str]) -> AssemblyError {
    let mesh = data_mesh("two_materials.msh");
    let error = assemble(&mesh, materials, masses).unwrap_err();
    let message = error.to_string();
    for part in says {
        assert!(message.contains(part), "\"{part}\" is missing in: {message}");
    }
    assert_eq!(centroid_lumped_inertia(&mesh, materials, masses).unwrap_err().to_string(), message);
    error
}

fn by_group(materials: &[(&str, Material)]) -> Materials {
    Materials::ByGroup(materials.iter().map(|(name, m)| ((*name).to_owned(), *m)).collect::<BTreeMap<_, _>>())
}

#[test]
fn constants_outside_their_range_are_told_with_the_group() {
    for nu in [0.5, 0.7, -1.0, f64::NAN] {
        let bad = Material { poisson_ratio: nu, ..ALUMINIUM };
        refusal(&Materials::Uniform(bad), &[], &["the whole mesh", "Poisson's ratio is", "between -1 and 0.5"]);
        refusal(&by_group(&[("block", ALUMINIUM), ("tip", bad)]), &[], &["tip", &nu.to_string()]);
    }
    refusal(&Materials::Uniform(Material { young_modulus: -1.0, ..ALUMINIUM }), &[], &["Young's modulus is -1"]);
    refusal(&Materials::Uniform(Material { density: 0.0, ..ALUMINIUM }), &[], &["density is 0", "a positive number"]);
}

#[test]
fn ratios_just_inside_the_range_are_accepted() {
    let mesh = data_mesh("two_materials.msh");
    for nu in [0.499_999, -0.999_999] {
        let matrices = assemble(&mesh, &Materials::Uniform(Material { poisson_ratio: nu, ..ALUMINIUM }), &[]).unwrap();
        assert!(matrices.stiffness().val().iter().all(|v| v.is_finite()));
    }
}

#[test]
fn a_missing_group_is_told_with_those_there_are() {
    refusal(
        &by_group(&[("blok", ALUMINIUM)]),
        &[],
        &["two_materials.msh", "no physical volume named \"blok\"", "\"block\"", "\"tip\""],
    );
    // A surface group is no volume.
    refusal(&by_group(&[("foot", ALUMINIUM)]), &[], &["no physical volume named \"foot\""]);
}

#[test]
fn an_element_without_material_is_told_with_its_group() {
    let error = refusal(
        &by_group(&[("block", ALUMINIUM)]),
        &[],
        &["two_materials.msh", "has no material", "give one to its physical group \"tip\""],
    );
    let AssemblyError { fault: AssemblyFault::NoMaterial { element, .. }, .. } = error else { panic!("{error:?}") };
    let mesh = data_mesh("two_materials.msh");
    let index = mesh.element_tags().iter().position(|tag| *tag == element).unwrap();
    assert_eq!(mesh.element_groups(index), [1]);
    let message = assemble(&data_mesh("overlapping_groups.msh"), &by_group(&[("7", ALUMINIUM)]), &[]).unwrap_err();
    assert!(message.to_string().contains("one of its physical groups [\"all\", \"tip\"]"), "{message}");
}

#[test]
fn different_materials_for_one_element_are_told_with_both_groups() {
    let other = Material { density: 7.85e-9, ..ALUMINIUM };
    for name in ["overlapping_groups.msh", "overlapping_groups_partitioned.msh"] {
        let mesh = data_mesh(name);
        let materials = by_group(&[("all", ALUMINIUM), ("tip", other)]);
        let error = assemble(&mesh, &materials, &[]).unwrap_err();
        let message = error.to_string();
        for part in [name, "both physical volumes", "\"all\"", "\"tip\"", "different materials", "do not overlap"] {
            assert!(message.contains(part), "\"{part}\" is missing in: {message}");
        }
        assert_eq!(centroid_lumped_inertia(&mesh, &materials, &[]).unwrap_err().to_string(), message);
        let AssemblyError { fault: AssemblyFault::TwoMaterials { element, mut groups, .. }, .. } = error else {
            panic!("{error:?}")
        };
        groups.sort_unstable();
        assert_eq!(groups, ["all", "tip"]);
        // The first element of the tip, which alone is in both.
        let index = mesh.element_tags().iter().position(|tag| *tag == element).unwrap();
        let at_tip = |e: &usize| mesh.elements()[*e].iter().all(|n| mesh.positions()[*n as usize][0] > 19.9);
        assert_eq!((0..mesh.elements().len()).find(at_tip), Some(index));
    }
}

#[test]
fn an_element_in_no_group_is_told_so() {
    let mut parts = crate::fixtures::parts(&data_mesh("two_materials.msh"));
    parts.regions[11].clear();
    let tag = parts.element_tags[11];
    let mesh = fem_tet10::Mesh::new(parts).unwrap();
    let message = assemble(&mesh, &by_group(&[("block", ALUMINIUM), ("tip", ALUMINIUM)]), &[]).unwrap_err().to_string();
    assert!(
        message.contains(&format!("element {tag} has no material: it is in no named physical volume")),
        "{message}"
    );
    assert!(assemble(&mesh, &aluminium(), &[]).is_ok());
}

#[test]
fn masses_that_are_no_positive_numbers_are_refused() {
    for mass in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        let point = PointMass { at: [0.0, 0.0, 0.0], mass, spread: None };
        refusal(&aluminium(), &[point], &["point mass at [0.0, 0.0, 0.0]", "expected a positive number"]);
    }
}

/// Closed form: √(3² + 4² + 12²) = 13.
#[test]
fn a_mass_off_the_body_is_told_with_the_distance() {
    // The nearest point of the body is the corner (28, 10, 10), √(3² + 4² + 12²) = 13 away.
    let point = PointMass { at: [31.0, 14.0, 22.0], mass: 1.0, spread: None };
    let error = refusal(
        &aluminium(),
        &[point],
        &["two_materials.msh", "[31.0, 14.0, 22.0] is not on the body", "[28.0, 10.0, 10.0], 13.000000 away"],
    );
    let AssemblyError { fault: AssemblyFault::OffBody { distance, node, .. }, .. } = error else { panic!("{error:?}") };
    assert!((distance - 13.0).abs() < 1e-12);
    let mesh = data_mesh("two_materials.msh");
    let corner = mesh.positions().iter().position(|x| *x == [28.0, 10.0, 10.0]).unwrap();
    assert_eq!(node, mesh.node_tags()[corner]);
    for nowhere in [f64::NAN, f64::INFINITY] {
        refusal(&aluminium(), &[PointMass { at: [nowhere, 0.0, 0.0], ..point }], &["is not on the body"]);
    }
}

#[test]
fn a_spread_that_cannot_carry_the_mass_is_refused() {
    // Inside an element, away from all nodes.
    let inside = PointMass { at: [3.3, 4.1, 2.9], mass: 1.0, spread: Some(0.01) };
    refusal(&aluminium(), &[inside], &["the 0 node(s) within 0.01", "use a larger spread", "nearest node is"]);
    // One node is near enough, but not at the point: it cannot carry the first moment.
    let beside = PointMass { at: [0.1, 0.0, 0.0], mass: 1.0, spread: Some(0.2) };
    let error = refusal(&aluminium(), &[beside], &["the 1 node(s) within 0.2", "0.100000 away", "use a larger spread"]);
    assert!(matches!(error, AssemblyError { fault: AssemblyFault::Spread { count: 1, .. }, .. }));
}

#[test]
fn a_spread_over_more_nodes_than_can_be_coupled_is_refused() {
    let mesh = workspace_mesh("plate.msh");
    let at = [3.1, 4.7, 2.3];
    let mut distances: Vec<f64> =
        mesh.positions().iter().map(|x| (nalgebra::Vector3::from(*x) - nalgebra::Vector3::from(at)).norm()).collect();
    distances.sort_by(f64::total_cmp);
    assert!(distances[500] - distances[499] > 1e-6, "no radius has 500 nodes within it exactly");
    let spread = |radius| assemble(&mesh, &aluminium(), &[PointMass { at, mass: 1.0, spread: Some(radius) }]);
    let entries = |matrices: &fem_tet10::Matrices| matrices.mass().symbolic().row_idx().len();
    let bare = entries(&assemble(&mesh, &aluminium(), &[]).unwrap());
    let added = entries(&spread(distances[499]).unwrap()) - bare;
    assert!((1_500_000..=9 * 500 * 500).contains(&added), "{added} entries more");
    let radius = distances[500];
    let error = spread(radius).unwrap_err();
    let message = error.to_string();
    let says = format!("501 nodes lie within {radius} of [3.1, 4.7, 2.3]");
    for part in ["plate.msh", &says, "over 500 at most", "use a smaller spread"] {
        assert!(message.contains(part), "\"{part}\" is missing in: {message}");
    }
    assert!(
        matches!(error, AssemblyError { fault: AssemblyFault::SpreadTooWide { count: 501, limit: 500, .. }, .. }),
        "{error:?}"
    );
    assert!(matches!(spread(1e6), Err(AssemblyError { fault: AssemblyFault::SpreadTooWide { count: 9437, .. }, .. })));
}

#[test]
fn a_radius_that_is_no_positive_number_is_refused() {
    for radius in [0.0, -5.0, f64::NAN, f64::INFINITY] {
        let point = PointMass { at: [0.0; 3], mass: 1.0, spread: Some(radius) };
        refusal(&aluminium(), &[point], &["[0.0, 0.0, 0.0]", "expected a positive radius"]);
    }
}
