//! Nodes by group and by place.

use fem_tet10::{Mesh, MeshError, MeshFault, NodeGroup, parse_msh};
use nalgebra::Vector3;

use crate::fixtures::{data, data_mesh, parts, workspace_mesh};

/// The nodes that a plain loop over the positions picks.
fn picked(mesh: &Mesh, chosen: impl Fn([f64; 3]) -> bool) -> Vec<u32> {
    (0..mesh.positions().len()).filter(|i| chosen(mesh.positions()[*i])).map(|i| i as u32).collect()
}

#[test]
fn groups_of_every_dimension_have_the_nodes_of_their_geometry() {
    for name in ["cylinder.msh", "cylinder_binary.msh", "cylinder_fine.msh"] {
        let mesh = data_mesh(name);
        let radius = |x: f64, y: f64| (x - 3.0).hypot(y - 4.0);
        let on_side = |[x, y, _]: [f64; 3]| (radius(x, y) - 4.0).abs() < 1e-9;
        let cases: [(&str, Vec<u32>); 6] = [
            ("body", picked(&mesh, |_| true)),
            ("side", picked(&mesh, on_side)),
            ("head", picked(&mesh, |x| x[2] == 13.0)),
            ("9", picked(&mesh, |x| x[2] == 13.0)),
            ("rim", picked(&mesh, |x| x[2] == 13.0 && on_side(x))),
            ("mark", picked(&mesh, |[x, y, z]| (x - 7.0).abs() < 1e-9 && (y - 4.0).abs() < 1e-9 && z == 13.0)),
        ];
        for (group, expected) in cases {
            assert!(!expected.is_empty());
            assert_eq!(mesh.group_nodes(group).unwrap(), expected, "{group} of {name}");
        }
    }
    let mesh = data_mesh("two_materials.msh");
    assert_eq!(mesh.group_nodes("tip").unwrap(), picked(&mesh, |x| x[0] >= 20.0));
    assert_eq!(mesh.group_nodes("block").unwrap(), picked(&mesh, |x| x[0] <= 20.0));
}

#[test]
fn an_unknown_group_is_told_with_all_there_are() {
    let message = data_mesh("cylinder.msh").group_nodes("top").unwrap_err().to_string();
    for part in ["cylinder.msh", "no physical group named \"top\"", "\"body\"", "\"head\"", "\"rim\"", "\"mark\""] {
        assert!(message.contains(part), "\"{part}\" is missing in: {message}");
    }
}

#[test]
fn a_name_in_several_dimensions_is_refused_where_it_is_asked_for() {
    let text = std::fs::read_to_string(data("cylinder.msh")).unwrap();
    let text = text.replace("\"rim\"", "\"head\"").replace("\"mark\"", "\"head\"");
    let mesh = parse_msh(text.as_bytes(), "heads.msh").unwrap();
    let error = mesh.group_nodes("head").unwrap_err();
    let MeshError { fault: MeshFault::SeveralGroups { kinds, .. }, .. } = &error else { panic!("{error:?}") };
    assert_eq!(kinds, &["surface", "point", "curve"]);
    assert!(mesh.surface_weights("head").is_ok());
}

#[test]
fn a_group_of_nodes_that_are_not_there_is_refused() {
    let mut parts = parts(&data_mesh("cube.msh"));
    parts.node_groups = vec![NodeGroup { name: "edge".to_owned(), dimension: 1, nodes: vec![1, 4711] }];
    let error = Mesh::new(parts).unwrap_err();
    assert!(
        matches!(&error, MeshError { fault: MeshFault::UnknownGroupNode { kind: "curve", node: 4711, .. }, .. }),
        "{error:?}"
    );
}

#[test]
fn places_pick_what_lies_in_them() {
    let mesh = workspace_mesh("plate.msh");
    let low_end = mesh.nodes_in_box([-501.0, -26.0, -1.0], [-500.0, 26.0, 11.0]);
    assert_eq!(low_end, picked(&mesh, |x| x[0] == -500.0));
    assert!(low_end.len() > 8);
    assert!(mesh.nodes_in_box([1.0, 0.0, 0.0], [-1.0, 10.0, 10.0]).is_empty());

    let ball = mesh.nodes_within([500.0, 25.0, 10.0], 20.0);
    assert_eq!(ball, picked(&mesh, |[x, y, z]| (x - 500.0).powi(2) + (y - 25.0).powi(2) + (z - 10.0).powi(2) <= 400.0));
    assert!(ball.len() > 3 && mesh.nodes_within([0.0; 3], f64::NAN).is_empty());

    // The edge y = 25, z = 10, by an axis of any length and either sign.
    let edge = picked(&mesh, |x| x[1] == 25.0 && x[2] == 10.0);
    assert!(edge.len() > 50);
    for axis in [[1.0, 0.0, 0.0], [-7e-9, 0.0, 0.0], [3e12, 0.0, 0.0]] {
        assert_eq!(mesh.nodes_on_line([7.0, 25.0, 10.0], axis, 1e-6), edge);
    }
    assert!(mesh.nodes_on_line([7.0, 25.0, 10.0], [0.0; 3], 1e-6).is_empty());
    // A slanting one, through two corners of the end.
    let diagonal = mesh.nodes_on_line([-500.0, -25.0, 0.0], [0.0, 50.0, 10.0], 1e-6);
    let corners = [[-500.0, -25.0, 0.0], [-500.0, 25.0, 10.0]].map(|x| mesh.nearest_node(x).0);
    assert!(corners.iter().all(|corner| diagonal.contains(corner)));
}

/// Independent reference: a plain search over all nodes.
#[test]
fn the_nearest_node_is_the_nearest() {
    let mesh = workspace_mesh("ring.msh");
    let (node, distance) = mesh.nearest_node([60.0, 70.0, 0.0]);
    let far = |x: &[f64; 3]| (Vector3::from(*x) - Vector3::new(60.0, 70.0, 0.0)).norm();
    assert!(mesh.positions().iter().all(|x| far(x) >= distance - 1e-12));
    assert!((far(&mesh.positions()[node as usize]) - distance).abs() < 1e-12);
}
