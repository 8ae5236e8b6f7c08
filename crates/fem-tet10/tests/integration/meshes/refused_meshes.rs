//! Meshes that can be read but not computed with.

use fem_tet10::{Mesh, MeshError, MeshFault, MeshParts};

use crate::fixtures::{data_mesh, parts, single};

/// The cube of twelve or so straight elements, spoiled by `change`; the message must have all of `says`.
#[track_caller]
fn refusal(change: impl FnOnce(&mut MeshParts), says: &[&str]) -> MeshError {
    let mut cube = parts(&data_mesh("cube.msh"));
    cube.source = "cube.msh".to_owned();
    change(&mut cube);
    let error = Mesh::new(cube).unwrap_err();
    let message = error.to_string();
    for part in ["cube.msh"].iter().chain(says) {
        assert!(message.contains(part), "\"{part}\" is missing in: {message}");
    }
    error
}

/// Index of a node by its tag.
fn node(parts: &MeshParts, tag: u64) -> usize {
    parts.node_tags.iter().position(|t| *t == tag).unwrap()
}

#[test]
fn the_parts_of_a_good_mesh_make_it_again() {
    let mesh = data_mesh("cube.msh");
    assert_eq!(Mesh::new(parts(&mesh)).unwrap().elements(), mesh.elements());
}

/// Closed form: six times the volume of the tetrahedron.
#[test]
fn an_inverted_element_is_told_with_its_jacobian() {
    // Corners 0 and 1 change places, and with them mid-edges 12–02 and 03–13.
    let error = refusal(
        |m| {
            for (a, b) in [(0, 1), (5, 6), (7, 9)] {
                m.elements[7].swap(a, b);
            }
            m.element_tags[7] = 4711;
        },
        &["element 4711 is inverted", "Jacobian determinant falls to -", "-optimize_ho"],
    );
    let MeshError { fault: MeshFault::Jacobian { element: 4711, jacobian, expected, .. }, .. } = error else {
        panic!("{error:?}")
    };
    // The determinant is six times the volume, and that is unchanged but for its sign.
    let mesh = data_mesh("cube.msh");
    let corner = |a: usize| nalgebra::Vector3::from(mesh.positions()[mesh.elements()[7][a] as usize]);
    let six_volumes = (corner(1) - corner(0)).cross(&(corner(2) - corner(0))).dot(&(corner(3) - corner(0)));
    assert!((jacobian / six_volumes + 1.0).abs() < 1e-12, "{jacobian} {six_volumes}");
    assert!(expected > six_volumes * 0.999, "no element of its size has more than a regular one: {expected}");
}

#[test]
fn an_element_numbered_as_in_vtk_is_refused() {
    refusal(|m| m.elements.iter_mut().for_each(|nodes| nodes.swap(8, 9)), &["is inverted"]);
}

#[test]
fn a_flat_element_is_called_degenerate() {
    // One element, its fourth corner in the plane of the others; far from the origin rounding makes it no flatter.
    for shift in [0.0, 1e3, 1e5] {
        let corners = [[0.1, 0.2, 0.3], [1.3, 0.1, 0.6], [0.4, 1.7, 0.9], [0.6, 2.0 / 3.0, 0.6]];
        let error = Mesh::new(single(corners.map(|x| x.map(|c| c + shift)))).unwrap_err();
        assert!(
            matches!(error, MeshError { fault: MeshFault::Jacobian { what: "degenerate", element: 5, .. }, .. }),
            "{shift}: {error}"
        );
    }
    let error = Mesh::new(single([[1.0; 3]; 4])).unwrap_err();
    assert!(matches!(error, MeshError { fault: MeshFault::Jacobian { what: "degenerate", .. }, .. }), "{error}");
}

#[test]
fn a_thin_element_is_accepted() {
    assert!(Mesh::new(single([[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1e-6]])).is_ok());
}

/// Closed form: det J = 4s − 1 at the corner.
#[test]
fn a_mid_node_pulled_beyond_the_quarter_point_inverts_its_element() {
    // With the node of edge 0–1 at a fraction s of the edge, det J at corner 0 is proportional to 4 s − 1.
    let pulled = |s: f64| {
        let mut parts = single([[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]);
        parts.positions[4][0] = s;
        Mesh::new(parts)
    };
    assert!(pulled(0.2501).is_ok() && pulled(0.7499).is_ok());
    let error = pulled(0.2499).unwrap_err();
    let MeshError { fault: MeshFault::Jacobian { element: 5, what: "inverted", jacobian, .. }, .. } = error else {
        panic!("{error:?}")
    };
    assert!((jacobian - (4.0 * 0.2499 - 1.0)).abs() < 1e-12, "{jacobian}");
    assert!(matches!(pulled(0.7501), Err(MeshError { fault: MeshFault::Jacobian { .. }, .. })));
    assert!(matches!(pulled(0.25), Err(MeshError { fault: MeshFault::Jacobian { what: "degenerate", .. }, .. })));
}

#[test]
fn a_mid_node_pulled_through_the_cube_is_refused() {
    refusal(
        |m| {
            let mid = node(m, m.elements[3][6]);
            m.positions[mid] = [30.0, -20.0, 25.0];
        },
        &["is inverted", "Jacobian"],
    );
}

#[test]
fn orphan_nodes_are_counted_and_named() {
    let error = refusal(
        |m| {
            for tag in 901..=907 {
                m.node_tags.push(tag);
                m.positions.push([5.0, 5.0, tag as f64]);
            }
        },
        &["7 node(s) belong to no tetrahedron", "[901, 902, 903, 904, 905]", "remove the points", "Mesh.SaveAll = 0"],
    );
    assert!(matches!(error, MeshError { fault: MeshFault::OrphanNodes { count: 7, .. }, .. }));
}

#[test]
fn pieces_are_counted_and_their_sizes_told() {
    // A second body: the first ten elements again, with nodes of their own, far away.
    let error = refusal(
        |m| {
            let copies: Vec<[u64; 10]> = m.elements[..10].to_vec();
            for (nodes, tag) in copies.into_iter().zip(501..) {
                let own = nodes.map(|n| n + 1000);
                for (old, new) in nodes.into_iter().zip(own) {
                    if !m.node_tags.contains(&new) {
                        let position = m.positions[node(m, old)];
                        m.node_tags.push(new);
                        m.positions.push(position.map(|c| c + 100.0));
                    }
                }
                m.elements.push(own);
                m.element_tags.push(tag);
                m.element_regions.push(0);
            }
        },
        &["pieces that share no node", "element [1, 501", "Coherence", "BooleanFragments"],
    );
    let MeshError { fault: MeshFault::Pieces { sizes, examples, .. }, .. } = error else { panic!("{error:?}") };
    assert_eq!(sizes[0], 24, "the cube, whole, comes first");
    assert_eq!(sizes.iter().sum::<usize>(), 34);
    assert_eq!(examples[0], 1);
}

#[test]
fn nodes_doubled_where_two_parts_meet_are_pieces() {
    // The elements of one half of the cube get nodes of their own, at the same places: as from two volumes that were
    // meshed without `Coherence`.
    let error = refusal(
        |m| {
            let doubled: Vec<usize> = (0..m.elements.len()).filter(|e| e % 2 == 1).collect();
            for e in doubled {
                for a in 0..10 {
                    let (old, new) = (m.elements[e][a], m.elements[e][a] + 1000);
                    if !m.node_tags.contains(&new) {
                        let position = m.positions[node(m, old)];
                        m.node_tags.push(new);
                        m.positions.push(position);
                    }
                    m.elements[e][a] = new;
                }
            }
            let used: std::collections::HashSet<u64> = m.elements.iter().flatten().copied().collect();
            let kept: Vec<usize> = (0..m.node_tags.len()).filter(|n| used.contains(&m.node_tags[*n])).collect();
            m.positions = kept.iter().map(|n| m.positions[*n]).collect();
            m.node_tags = kept.iter().map(|n| m.node_tags[*n]).collect();
            m.surfaces.clear();
            m.node_groups.clear();
        },
        &["pieces that share no node", "Coherence"],
    );
    let MeshError { fault: MeshFault::Pieces { sizes, .. }, .. } = error else { panic!("{error:?}") };
    assert_eq!(sizes.iter().sum::<usize>(), 24);
}

#[test]
fn a_thousand_pieces_are_no_long_message() {
    let one = single([[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]);
    let mut many = MeshParts { source: "many".into(), regions: vec![vec![]], ..MeshParts::default() };
    for k in 0..1000_u64 {
        many.node_tags.extend(one.node_tags.iter().map(|tag| tag + 10 * k));
        many.positions.extend(one.positions.iter().map(|[x, y, z]| [x + 2.0 * k as f64, *y, *z]));
        many.elements.push(one.elements[0].map(|tag| tag + 10 * k));
        many.element_tags.push(k + 1);
        many.element_regions.push(0);
    }
    let message = Mesh::new(many).unwrap_err().to_string();
    assert!(message.contains("falls into 1000 pieces") && message.contains("and 990 more"), "{message}");
    assert!(message.len() < 500, "{message}");
}

#[test]
fn unknown_nodes_and_tags_given_twice_are_told() {
    refusal(|m| m.elements[2][9] = 12_345, &["element 3 uses node 12345", "save the mesh again"]);
    refusal(|m| m.node_tags[4] = m.node_tags[9], &["node tag", "is given twice", "RenumberMeshNodes"]);
    refusal(|m| m.element_tags[4] = 2, &["element tag 2 is given twice", "RenumberMeshElements"]);
}

#[test]
fn the_same_element_under_two_tags_is_refused_with_both() {
    // As it is, and with its corners in another order.
    for order in [[0, 1, 2, 3, 4, 5, 6, 7, 8, 9], [1, 2, 0, 3, 5, 6, 4, 9, 7, 8]] {
        let error = refusal(
            |m| {
                m.elements.push(order.map(|a: usize| m.elements[7][a]));
                m.element_tags.push(4711);
                m.element_regions.push(m.element_regions[7]);
            },
            &["elements 8 and 4711 are the same tetrahedron", "count twice", "removeDuplicateElements"],
        );
        assert!(
            matches!(error, MeshError { fault: MeshFault::SameElement { first: 8, second: 4711, .. }, .. }),
            "{error:?}"
        );
    }
}

#[test]
fn coordinates_that_are_no_numbers_are_told() {
    for bad in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
        let error = refusal(|m| m.positions[3][1] = bad, &["finite number", "node "]);
        assert!(matches!(error, MeshError { fault: MeshFault::NotFinite { .. }, .. }), "{error:?}");
    }
}

#[test]
fn coordinates_beyond_what_can_be_multiplied_do_not_pass_as_nan() {
    for huge in [1e120, 1e200, 1e307] {
        refusal(|m| m.positions.iter_mut().flatten().for_each(|c| *c *= huge), &["Jacobian"]);
        refusal(|m| m.positions[40][0] = huge, &["Jacobian"]);
    }
}

#[test]
fn a_jacobian_that_overflows_at_some_points_only_is_refused() {
    // Pulled this way, edge 0–1 leaves det J positive everywhere; computed, it is inf − inf but at corners 2 and 3.
    let mut parts = single([[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]);
    parts.positions[4] = [1e200, -1e200, -1e200];
    let error = Mesh::new(parts).unwrap_err();
    assert!(
        matches!(error, MeshError { fault: MeshFault::Jacobian { jacobian, .. }, .. } if jacobian.is_nan()),
        "{error}"
    );
}

#[test]
fn a_mesh_without_tetrahedra_is_refused() {
    refusal(
        |m| {
            m.elements.clear();
            m.element_tags.clear();
            m.element_regions.clear();
        },
        &["there are no tetrahedra", "gmsh -3 -order 2"],
    );
}

/// `gmsh -2` of a body with named surfaces: its triangles have three nodes, which is not what is wrong with it.
#[test]
fn a_mesh_of_the_surface_alone_has_no_tetrahedra() {
    let text = "$MeshFormat\n4.1 0 8\n$EndMeshFormat\n$PhysicalNames\n1\n2 1 \"root\"\n$EndPhysicalNames\n\
                $Entities\n0 0 1 0\n1 0 0 0 1 1 0 1 1 0\n$EndEntities\n\
                $Nodes\n1 3 1 3\n2 1 0 3\n1\n2\n3\n0 0 0\n1 0 0\n0 1 0\n$EndNodes\n\
                $Elements\n1 1 1 1\n2 1 2 1\n1 1 2 3\n$EndElements\n";
    let error = fem_tet10::parse_msh(text.as_bytes(), "surface.msh").unwrap_err();
    assert!(matches!(error, MeshError { fault: MeshFault::NoElements, .. }), "{error}");
}

#[test]
fn parts_that_do_not_fit_together_are_refused() {
    refusal(|m| _ = m.node_tags.pop(), &["node tags, found"]);
    refusal(|m| _ = m.element_tags.pop(), &["expected 24 element tags, found 23"]);
    refusal(|m| _ = m.element_regions.pop(), &["expected 24 element regions, found 23"]);
    refusal(|m| m.element_regions[5] = 24, &["element 6 is in region number 24", "there are 24 regions"]);
    refusal(|m| m.regions[5] = vec![0, 1], &["region number 5 is in group number 1", "there are 1 groups"]);
}
