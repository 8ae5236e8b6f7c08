//! The reader on files as gmsh writes them.

use std::collections::BTreeMap;

use fem_tet10::{Material, Materials, Mesh, assemble, parse_msh};

use crate::fixtures::{ALUMINIUM, aluminium, assert_close, data, data_mesh, field, form, workspace_mesh};

/// The tetrahedra by tag, with the positions of their nodes: what two files of one mesh have in common.
fn geometry(mesh: &Mesh) -> BTreeMap<u64, Vec<[f64; 3]>> {
    (mesh.element_tags().iter().zip(mesh.elements()))
        .map(|(tag, nodes)| (*tag, nodes.iter().map(|n| mesh.positions()[*n as usize]).collect()))
        .collect()
}

fn assert_same(a: &Mesh, b: &Mesh) {
    assert_eq!(a.node_tags(), b.node_tags());
    assert_eq!(a.element_tags(), b.element_tags());
    assert_eq!(a.elements(), b.elements());
    assert_eq!(a.groups(), b.groups());
    for e in 0..a.elements().len() {
        assert_eq!(a.element_groups(e), b.element_groups(e), "groups of element {e}");
    }
    for (x, y) in a.positions().iter().zip(b.positions()) {
        for axis in 0..3 {
            // Text carries 16 digits, not 17.
            assert!((x[axis] - y[axis]).abs() <= 1e-15 * (1.0 + x[axis].abs()), "{x:?} {y:?}");
        }
    }
}

/// Closed form: the diagonal of the box.
#[test]
fn the_plate_is_the_one_of_the_paper() {
    let mesh = workspace_mesh("plate.msh");
    assert_eq!((mesh.positions().len(), mesh.elements().len()), (9437, 4502));
    assert_eq!(mesh.groups(), ["plate"]);
    assert_close("diagonal of the box", mesh.diagonal(), (1000.0_f64.powi(2) + 50.0 * 50.0 + 100.0).sqrt(), 1e-15);
}

#[test]
fn text_and_bytes_give_the_same_mesh() {
    assert_same(&data_mesh("cube.msh"), &data_mesh("cube_binary.msh"));
    assert_same(&data_mesh("two_materials.msh"), &data_mesh("two_materials_binary.msh"));
    assert_same(&data_mesh("quarter_everything.msh"), &data_mesh("quarter_everything_binary.msh"));
    assert_same(&data_mesh("overlapping_groups.msh"), &data_mesh("overlapping_groups_binary.msh"));
}

#[test]
fn line_ends_of_windows_are_read() {
    let text = std::fs::read_to_string(data("two_materials.msh")).unwrap();
    let mesh = parse_msh(text.replace('\n', "\r\n").as_bytes(), "windows.msh").unwrap();
    assert_same(&mesh, &data_mesh("two_materials.msh"));
}

#[test]
fn surface_elements_parameters_periodic_faces_and_partitions_are_passed_over() {
    let plain = data_mesh("quarter.msh");
    for name in ["quarter_everything.msh", "quarter_partitioned.msh"] {
        let text = std::fs::read_to_string(data(name)).unwrap();
        assert!(text.contains("$Periodic"), "{name} must hold what it is here for");
        let mesh = data_mesh(name);
        assert_eq!(mesh.positions().len(), plain.positions().len(), "{name}");
        // The tags differ; the set of tetrahedra may not.
        let mut found: Vec<_> = geometry(&mesh).into_values().map(|x| format!("{x:?}")).collect();
        let mut expected: Vec<_> = geometry(&plain).into_values().map(|x| format!("{x:?}")).collect();
        found.sort();
        expected.sort();
        assert_eq!(found, expected, "{name}");
    }
}

#[test]
fn sections_of_other_programs_are_passed_over() {
    let text = std::fs::read_to_string(data("cube.msh")).unwrap();
    let notes = "$Comments\n12 $ 3.4 \"anything\"\n$EndComments\n";
    let values = "$NodeData\n1\n\"t\"\n1\n0.0\n3\n0\n1\n1\n5 1.5\n$EndNodeData\n";
    let more = text.replace("$Nodes", &format!("{notes}$Nodes")) + values;
    assert_same(&parse_msh(more.as_bytes(), "more.msh").unwrap(), &data_mesh("cube.msh"));
}

/// Closed form: Σ ρV of the two blocks.
#[test]
fn groups_carry_materials_by_name() {
    for name in ["two_materials.msh", "two_materials_binary.msh"] {
        let mesh = data_mesh(name);
        assert_eq!(mesh.groups(), ["block", "tip"]);
        for (e, nodes) in mesh.elements().iter().enumerate() {
            let middle = nodes[..4].iter().map(|n| mesh.positions()[*n as usize][0]).sum::<f64>() / 4.0;
            assert_eq!(mesh.element_groups(e), [usize::from(middle > 20.0)], "element {e} at x = {middle}");
        }
        let materials = Materials::ByGroup(BTreeMap::from([
            ("block".to_owned(), Material { density: 7.85e-9, ..ALUMINIUM }),
            ("tip".to_owned(), ALUMINIUM),
        ]));
        let matrices = assemble(&mesh, &materials, &[]).unwrap();
        let along_x = field(&mesh, |_| [1.0, 0.0, 0.0]);
        let mass = form(&along_x, matrices.mass(), &along_x);
        assert_close("mass", mass, 7.85e-9 * 2000.0 + 2.7e-9 * 800.0, 1e-13);
    }
}

#[test]
fn one_material_given_to_every_group_is_that_material_for_the_whole_mesh() {
    let mesh = data_mesh("two_materials.msh");
    let by_group = BTreeMap::from([("block".to_owned(), ALUMINIUM), ("tip".to_owned(), ALUMINIUM)]);
    let a = assemble(&mesh, &Materials::ByGroup(by_group), &[]).unwrap();
    let b = assemble(&mesh, &aluminium(), &[]).unwrap();
    assert_eq!(a.stiffness().val(), b.stiffness().val());
    assert_eq!(a.mass().val(), b.mass().val());
}

#[test]
fn a_group_without_a_name_goes_by_its_number() {
    assert_eq!(data_mesh("quarter.msh").groups(), ["7"]);
    assert_eq!(data_mesh("quarter_everything_binary.msh").groups(), ["7"]);
}

/// The files of one body, whole and in two parts.
const OVERLAPPING: [&str; 4] = [
    "overlapping_groups.msh",
    "overlapping_groups_binary.msh",
    "overlapping_groups_partitioned.msh",
    "overlapping_groups_partitioned_binary.msh",
];

#[test]
fn an_element_is_in_every_group_of_its_volume_in_partitioned_meshes_too() {
    for name in OVERLAPPING {
        let bytes = std::fs::read(data(name)).unwrap();
        let has = |section: &[u8]| bytes.windows(section.len()).any(|window| window == section);
        assert_eq!(has(b"$PartitionedEntities"), name.contains("partitioned"));
        assert_eq!(has(b"$GhostElements"), name.contains("partitioned_binary"));
        let mesh = data_mesh(name);
        assert_eq!(mesh.elements().len(), 48, "{name}");
        for (e, nodes) in mesh.elements().iter().enumerate() {
            let middle = nodes[..4].iter().map(|n| mesh.positions()[*n as usize][0]).sum::<f64>() / 4.0;
            let mut found: Vec<&str> = mesh.element_groups(e).iter().map(|g| mesh.groups()[*g].as_str()).collect();
            found.sort_unstable();
            assert_eq!(found, if middle > 20.0 { ["all", "tip"] } else { ["7", "all"] }, "{name}: x = {middle}");
        }
        assert_eq!(mesh.groups().len(), 3, "{name}: {:?}", mesh.groups());
    }
}

/// Closed form: Σ ρV of the two blocks.
#[test]
fn every_group_of_a_volume_can_carry_its_material() {
    let other = Material { density: 7.85e-9, ..ALUMINIUM };
    let cases: [(&[(&str, Material)], f64); 4] = [
        (&[("all", ALUMINIUM)], 2.7e-9 * 2800.0),
        (&[("7", other), ("tip", ALUMINIUM)], 7.85e-9 * 2000.0 + 2.7e-9 * 800.0),
        (&[("7", ALUMINIUM), ("tip", other)], 2.7e-9 * 2000.0 + 7.85e-9 * 800.0),
        (&[("all", other), ("tip", other)], 7.85e-9 * 2800.0),
    ];
    for name in OVERLAPPING {
        let mesh = data_mesh(name);
        for (given, expected) in cases {
            let by_group = given.iter().map(|(group, material)| ((*group).to_owned(), *material)).collect();
            let matrices = assemble(&mesh, &Materials::ByGroup(by_group), &[]).unwrap();
            let along_x = field(&mesh, |_| [1.0, 0.0, 0.0]);
            // Measured: 1.6e-15.
            assert_close(name, form(&along_x, matrices.mass(), &along_x), expected, 1e-13);
        }
    }
}

#[test]
fn two_groups_of_one_name_are_one_group() {
    let text = std::fs::read_to_string(data("overlapping_groups.msh")).unwrap();
    let mesh = parse_msh(text.replace("3 2 \"tip\"", "3 2 \"all\"").as_bytes(), "all.msh").unwrap();
    assert_eq!(mesh.groups(), ["all", "7"]);
    assert!((0..mesh.elements().len()).all(|e| matches!(mesh.element_groups(e), [0] | [0, 1])));
}

#[test]
fn numbers_longer_than_usual_are_one_number() {
    let text = std::fs::read_to_string(data("cube.msh")).unwrap();
    let long = text.replace("\n10 10 10\n", &format!("\n10 10 10.{}\n", "0".repeat(200)));
    assert_ne!(long, text);
    assert_same(&parse_msh(long.as_bytes(), "long.msh").unwrap(), &data_mesh("cube.msh"));
}

#[test]
fn groups_of_fewer_dimensions_leave_the_body_as_it_is() {
    let plain = data_mesh("cube.msh");
    for name in ["cube_groups.msh", "cube_groups_binary.msh"] {
        let mesh = data_mesh(name);
        assert_eq!(mesh.surface_groups().collect::<Vec<_>>(), ["foot"], "{name}");
        let found: Vec<_> = geometry(&mesh).into_values().map(|x| format!("{x:?}")).collect();
        let expected: Vec<_> = geometry(&plain).into_values().map(|x| format!("{x:?}")).collect();
        assert_eq!(found, expected, "{name}");
    }
    assert_eq!(plain.surface_groups().count(), 0);
}
