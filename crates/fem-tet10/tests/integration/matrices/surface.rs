//! Physical surfaces: faces of the body, areas, pressures.

use std::collections::{HashMap, HashSet};

use faer::Col;
use fem_tet10::{Mesh, MeshError, MeshFault, MeshParts, SurfaceGroup, assemble, parse_msh};
use nalgebra::Vector3;

use crate::ball::ball;
use crate::fixtures::{
    ALUMINIUM, Random, aluminium, assert_close, data, data_mesh, form, parts, single, workspace_mesh,
};

const PI: f64 = std::f64::consts::PI;
/// Radius, height and foot of `cylinder.geo`.
const RADIUS: f64 = 4.0;
const HEIGHT: f64 = 8.0;
const FOOT: [f64; 3] = [3.0, 4.0, 5.0];

fn position(mesh: &Mesh, node: u32) -> Vector3<f64> {
    mesh.positions()[node as usize].into()
}

fn area(mesh: &Mesh, group: &str) -> f64 {
    mesh.surface_weights(group).unwrap().1.iter().sum()
}

/// Resultant and moment about the origin.
fn resultants(mesh: &Mesh, group: &str) -> (Vector3<f64>, Vector3<f64>) {
    let (nodes, forces) = mesh.surface_pressure(group).unwrap();
    let moment = nodes.iter().zip(&forces).map(|(node, f)| position(mesh, *node).cross(f)).sum();
    (forces.iter().sum(), moment)
}

/// The mesh with a surface "skin" of all faces that belong to one element only, turned and begun anyhow.
fn with_skin(mesh: &Mesh) -> Mesh {
    // Corners and mid-edges, as they come.
    const FACES: [[usize; 6]; 4] = [[0, 1, 2, 4, 5, 6], [0, 1, 3, 4, 9, 7], [1, 2, 3, 5, 8, 9], [2, 0, 3, 6, 7, 8]];
    let mut owners: HashMap<[u32; 3], Vec<[u32; 6]>> = HashMap::new();
    for nodes in mesh.elements() {
        for face in FACES.map(|face| face.map(|a| nodes[a])) {
            let mut key = [face[0], face[1], face[2]];
            key.sort_unstable();
            owners.entry(key).or_default().push(face);
        }
    }
    let mut random = Random(5);
    let mut faces: Vec<[u32; 6]> = owners.into_values().filter(|sides| sides.len() == 1).map(|s| s[0]).collect();
    faces.sort_unstable();
    for face in &mut faces {
        if random.index(2) == 0 {
            *face = [face[0], face[2], face[1], face[5], face[4], face[3]];
        }
        let turn = random.index(3);
        face[..3].rotate_left(turn);
        face[3..].rotate_left(turn);
    }
    let mut parts = parts(mesh);
    parts.surfaces = vec![SurfaceGroup {
        name: "skin".to_owned(),
        triangle_tags: (1..=faces.len() as u64).collect(),
        triangles: faces.iter().map(|face| face.map(|node| mesh.node_tags()[node as usize])).collect(),
    }];
    Mesh::new(parts).unwrap()
}

/// Closed form: a square of side 10.
#[test]
fn a_plane_surface_has_its_area_its_centroid_and_its_normal() {
    for name in ["two_materials.msh", "two_materials_binary.msh"] {
        let mesh = data_mesh(name);
        assert_eq!(mesh.surface_groups().collect::<Vec<_>>(), ["foot"]);
        let (nodes, weights) = mesh.surface_weights("foot").unwrap();
        assert!(nodes.is_sorted_by(|a, b| a < b));
        assert!(nodes.iter().all(|node| position(&mesh, *node).x == 0.0));
        assert_close("area", weights.iter().sum(), 100.0, 1e-14);
        let first: Vector3<f64> = nodes.iter().zip(&weights).map(|(node, w)| position(&mesh, *node) * *w).sum();
        // The square x = 0, 0 ≤ y, z ≤ 10. Measured: 1.7e-13.
        assert!((first - Vector3::new(0.0, 500.0, 500.0)).amax() < 2e-12, "{first:?}");
        // A pressure from −x pushes along +x, at the middle. Measured: 2.8e-14 and 1.7e-13.
        let (force, moment) = resultants(&mesh, "foot");
        assert!((force - Vector3::new(100.0, 0.0, 0.0)).amax() < 1e-12, "{force:?}");
        assert!((moment - Vector3::new(0.0, 500.0, -500.0)).amax() < 1e-11, "{moment:?}");
    }
}

/// Closed form: ∫∫ y² dy dz.
#[test]
fn a_quadratic_field_is_integrated_exactly_over_plane_faces() {
    let mesh = data_mesh("two_materials.msh");
    let (nodes, weights) = mesh.surface_weights("foot").unwrap();
    let integral: f64 = nodes.iter().zip(&weights).map(|(node, w)| w * position(&mesh, *node).y.powi(2)).sum();
    // ∫∫ y² dy dz. Measured: 2.2e-16.
    assert_close("second moment", integral, 1e4 / 3.0, 1e-13);
}

/// Closed form: areas of a cylinder.
#[test]
fn a_cylinder_has_its_ends_and_its_side() {
    let (disc, side) = (PI * RADIUS * RADIUS, 2.0 * PI * RADIUS * HEIGHT);
    let middle = Vector3::from(FOOT) + Vector3::z() * (0.5 * HEIGHT);
    let mut errors = Vec::new();
    for name in ["cylinder.msh", "cylinder_fine.msh"] {
        let mesh = data_mesh(name);
        errors.push([("head", disc), ("side", side)].map(|(group, exact)| (area(&mesh, group) / exact - 1.0).abs()));
        assert_close("foot against head", area(&mesh, "foot"), area(&mesh, "head"), 1e-14);
        let all = area(&mesh, "head") + area(&mesh, "foot") + area(&mesh, "side");
        assert_close("all round", area(&mesh, "all round"), all, 1e-14);

        // On the head, a pressure is its area downwards, on the axis but for the mesh.
        let (force, moment) = resultants(&mesh, "head");
        assert_close("force on the head", -force.z, area(&mesh, "head"), 1e-14);
        assert!(force.x.abs().max(force.y.abs()) < 1e-13 * disc, "{force:?}");
        let off_axis = (moment - middle.cross(&force)).norm() / (RADIUS * disc);
        // Measured: 6.3e-16: the disc's mesh is as round as itself.
        assert!(off_axis < 1e-13, "{off_axis:e}");
        // On the side every node is pushed towards the axis.
        let (nodes, forces) = mesh.surface_pressure("side").unwrap();
        let inward: f64 = nodes
            .iter()
            .zip(&forces)
            .map(|(node, f)| {
                let arm = position(&mesh, *node) - middle;
                -(f.x * arm.x + f.y * arm.y) / RADIUS
            })
            .sum();
        // Measured: 7.4e-4 and 6.1e-5.
        assert_close("radial force", inward, side, 2e-3);
        let (force, moment) = resultants(&mesh, "all round");
        // Measured: 1.4e-16 of the side's area, and 4.9e-17 with the arm.
        assert!(force.norm() < 1e-13 * side && moment.norm() < 1e-13 * side * middle.norm(), "{force:?} {moment:?}");
    }
    // Head and side, measured: 1.3e-3 and 3.6e-4, then 1.1e-4 and 3.0e-5 at half the size: by 12 both, fourth order is 16.
    for k in 0..2 {
        assert!(errors[0][k] < 2e-3 && errors[1][k] < errors[0][k] / 10.0, "{errors:?}");
    }
}

/// Conserved: order 4, against 4π.
#[test]
fn the_sphere_is_approached_with_fourth_order() {
    let errors: Vec<f64> =
        (0..4).map(|refinements| (area(&with_skin(&ball(refinements)), "skin") / (4.0 * PI) - 1.0).abs()).collect();
    let orders: Vec<f64> = errors.windows(2).map(|e| (e[0] / e[1]).log2()).collect();
    // Measured: 3.5, 3.5, 3.9 and 4.3e-5.
    assert!(orders[2] > 3.8 && errors[3] < 1e-4, "{errors:?}, orders {orders:.2?}");
}

/// Conserved: no resultant, and ∮ X·n dA = 3 V.
#[test]
fn a_pressure_all_round_has_no_resultant_and_does_the_work_of_the_volume() {
    for mesh in [ball(1), workspace_mesh("ring.msh"), data_mesh("quarter.msh")].map(|mesh| with_skin(&mesh)) {
        let size = mesh.diagonal();
        let (force, moment) = resultants(&mesh, "skin");
        let total = area(&mesh, "skin");
        // Measured: 2.1e-16 and 1.5e-17.
        assert!(force.norm() < 1e-13 * total, "{force:?}");
        assert!(moment.norm() < 1e-13 * total * size, "{moment:?}");
        // −Σ f·X = ∮ X·n dA = 3 V, and V by the mass matrix.
        let (nodes, forces) = mesh.surface_pressure("skin").unwrap();
        let work: f64 = nodes.iter().zip(&forces).map(|(node, f)| -f.dot(&position(&mesh, *node))).sum();
        let ones = vec![1.0; mesh.positions().len() * 3];
        let mass = assemble(&mesh, &aluminium(), &[]).unwrap();
        let volume = form(&ones, mass.mass(), &ones) / 3.0 / ALUMINIUM.density;
        // Measured: 7.3e-15.
        assert_close("volume", work / 3.0, volume, 1e-13);
    }
}

/// A displacement without any order, at every node.
fn random_displacement(mesh: &Mesh, size: f64) -> Col<f64> {
    let mut random = Random(8);
    Col::from_fn(3 * mesh.positions().len(), |_| size * (2.0 * random.unit() - 1.0))
}

fn at(displacement: &Col<f64>, node: u32) -> Vector3<f64> {
    Vector3::from_fn(|axis, _| displacement[3 * node as usize + axis])
}

/// Conserved: no resultant and no moment.
#[test]
fn a_pressure_all_round_has_no_resultant_on_the_deformed_body_either() {
    for mesh in [ball(1), workspace_mesh("ring.msh"), data_mesh("quarter.msh")].map(|mesh| with_skin(&mesh)) {
        let u = random_displacement(&mesh, 1.0);
        let (nodes, forces) = mesh.surface_pressure("skin").unwrap();
        let (same, changes) = mesh.surface_pressure_change("skin", u.as_ref()).unwrap();
        assert_eq!(nodes, same);
        let (mut force, mut moment, mut scale) = (Vector3::zeros(), Vector3::zeros(), 0.0);
        for ((node, f), change) in nodes.iter().zip(&forces).zip(&changes) {
            force += change;
            moment += at(&u, *node).cross(f) + position(&mesh, *node).cross(change);
            scale += change.norm();
        }
        // Measured: 6e-16 and 5e-16.
        assert!(force.norm() < 1e-13 * scale, "{force:?} of {scale}");
        assert!(moment.norm() < 1e-13 * scale * mesh.diagonal(), "{moment:?} of {scale}");
    }
}

/// Independent reference: central differences between moved meshes, exact for quadratic forces.
#[test]
fn the_change_of_a_pressure_is_that_on_the_moved_mesh() {
    let mesh = with_skin(&data_mesh("cylinder.msh"));
    let u = random_displacement(&mesh, 1e-3);
    let on = |factor: f64| {
        let mut moved = parts(&mesh);
        for (node, x) in moved.positions.iter_mut().enumerate() {
            *x = (Vector3::from(*x) + factor * at(&u, node as u32)).into();
        }
        with_skin(&Mesh::new(moved).unwrap()).surface_pressure("skin").unwrap().1
    };
    let (plus, minus) = (on(1.0), on(-1.0));
    let (_, changes) = mesh.surface_pressure_change("skin", u.as_ref()).unwrap();
    let largest = changes.iter().map(|f| f.amax()).fold(0.0, f64::max);
    for ((plus, minus), change) in plus.iter().zip(&minus).zip(&changes) {
        // The forces are quadratic in the displacements, so the central difference is exact. Measured: 5e-13.
        assert!((0.5 * (plus - minus) - change).amax() < 1e-11 * largest, "{change:?}");
    }
    // A rotation turns the forces.
    let theta = Vector3::new(0.3, -0.8, 0.5);
    let n = 3 * mesh.positions().len();
    let turn = Col::from_fn(n, |row| theta.cross(&position(&mesh, row as u32 / 3))[row % 3]);
    let (_, changes) = mesh.surface_pressure_change("skin", turn.as_ref()).unwrap();
    let (_, forces) = mesh.surface_pressure("skin").unwrap();
    for (f, change) in forces.iter().zip(&changes) {
        assert!((theta.cross(f) - change).amax() < 1e-13, "{change:?}");
    }
}

/// Conserved: the same weights from text and bytes.
#[test]
fn text_and_bytes_give_the_same_surfaces() {
    let (text, bytes) = (data_mesh("cylinder.msh"), data_mesh("cylinder_binary.msh"));
    for group in ["side", "head", "foot", "all round", "9"] {
        let ((nodes, weights), (same_nodes, same_weights)) =
            (text.surface_weights(group).unwrap(), bytes.surface_weights(group).unwrap());
        assert_eq!(nodes, same_nodes, "{group}");
        assert!(weights.iter().zip(&same_weights).all(|(a, b)| (a - b).abs() < 1e-13), "{group}");
    }
}

/// One element, with the surface "skin" of the given triangles, tagged 101 and so on.
fn single_with(triangles: Vec<[u64; 6]>) -> MeshParts {
    let mut parts = single([[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]);
    let triangle_tags = (101..).take(triangles.len()).collect();
    parts.surfaces = vec![SurfaceGroup { name: "skin".to_owned(), triangle_tags, triangles }];
    parts
}

/// Closed form: −n dA of each face, a third at each middle of an edge.
#[test]
fn every_face_of_an_element_either_way_round_is_pushed_inwards() {
    // Faces z = 0, y = 0, x + y + z = 1, x = 0; −n dA of each.
    let faces = [[1, 2, 3, 5, 6, 7], [1, 2, 4, 5, 10, 8], [2, 3, 4, 6, 9, 10], [3, 1, 4, 7, 8, 9]];
    let inward = [[0.0, 0.0, 0.5], [0.0, 0.5, 0.0], [-0.5, -0.5, -0.5], [0.5, 0.0, 0.0]];
    for (face, expected) in faces.into_iter().zip(inward) {
        let [a, b, c, ab, bc, ca] = face;
        for triangle in [face, [b, c, a, bc, ca, ab], [b, a, c, ab, ca, bc]] {
            let mesh = Mesh::new(single_with(vec![triangle])).unwrap();
            let (nodes, forces) = mesh.surface_pressure("skin").unwrap();
            assert_eq!(nodes.iter().map(|n| mesh.node_tags()[*n as usize]).collect::<HashSet<_>>(), face.into());
            assert!((forces.iter().sum::<Vector3<f64>>() - Vector3::from(expected)).amax() < 1e-15);
            // On a flat face a third goes to each mid-edge and nothing to a corner.
            for (node, f) in nodes.iter().zip(&forces) {
                let share = if *node < 4 { 0.0 } else { 1.0 / 3.0 };
                assert!((f - Vector3::from(expected) * share).amax() < 1e-15, "{node} {f:?}");
            }
        }
    }
}

/// Closed form: the area of the triangle, ½.
#[test]
fn a_face_that_a_group_has_twice_counts_once() {
    let mesh = Mesh::new(single_with(vec![[1, 2, 3, 5, 6, 7], [1, 3, 2, 7, 6, 5]])).unwrap();
    assert_close("area", area(&mesh, "skin"), 0.5, 1e-14);
}

#[test]
fn what_is_no_face_of_the_body_is_refused_with_group_and_element() {
    // A mid-edge of another face; corners of no face; a corner twice.
    for triangle in [[1, 2, 3, 5, 6, 8], [1, 2, 5, 5, 6, 8], [1, 1, 2, 5, 6, 7]] {
        let error = Mesh::new(single_with(vec![[1, 2, 3, 5, 6, 7], triangle])).unwrap_err();
        assert!(
            matches!(&error, MeshError { fault: MeshFault::NotAFace { group, element: 102, .. }, .. } if group == "skin"),
            "{error:?}"
        );
        let message = error.to_string();
        assert!(message.contains("element 102 of the physical surface \"skin\" is not a face"), "{message}");
    }
    let error = Mesh::new(single_with(vec![[1, 2, 99, 5, 6, 7]])).unwrap_err();
    assert!(
        matches!(error, MeshError { fault: MeshFault::UnknownNode { element: 101, node: 99, .. }, .. }),
        "{error:?}"
    );
    let mut short = single_with(vec![[1, 2, 3, 5, 6, 7]]);
    short.surfaces[0].triangle_tags.clear();
    let error = Mesh::new(short).unwrap_err();
    assert!(
        matches!(
            error,
            MeshError { fault: MeshFault::Lengths { what: "triangle tags", expected: 1, found: 0, .. }, .. }
        ),
        "{error:?}"
    );
}

#[test]
fn elements_of_another_order_in_a_group_are_refused() {
    let text = std::fs::read_to_string(data("cylinder.msh")).unwrap();
    // The head's triangles, as ones of three nodes.
    let elements = text.find("$Elements").unwrap();
    let block = elements + text[elements..].find("\n2 2 9 ").unwrap() + 1;
    let header = text[block..].lines().next().unwrap();
    let count: usize = header.split(' ').next_back().unwrap().parse().unwrap();
    let mut lines: Vec<String> = text[block..].lines().map(str::to_owned).collect();
    lines[0] = format!("2 2 2 {count}");
    let first = lines[1].split_whitespace().next().unwrap().to_owned();
    for line in &mut lines[1..=count] {
        *line = line.split_whitespace().take(4).collect::<Vec<_>>().join(" ");
    }
    let error = parse_msh((text[..block].to_owned() + &lines.join("\n")).as_bytes(), "flat.msh").unwrap_err();
    let message = error.to_string();
    assert!(
        matches!(error, MeshError { fault: MeshFault::NotAFace { .. }, .. })
            && message.contains(&format!("element {first} ")),
        "{message}"
    );
}

/// Closed form: the area of two triangles.
#[test]
fn a_face_inside_the_body_has_an_area_and_no_outside() {
    // Two elements on either side of x = 0.
    let mut parts = single_with(vec![[1, 2, 3, 5, 6, 7], [1, 3, 4, 7, 9, 8]]);
    parts.node_tags.extend(11..=14);
    parts.positions.extend([[-1.0, 0.0, 0.0], [-0.5, 0.0, 0.0], [-0.5, 0.5, 0.0], [-0.5, 0.0, 0.5]]);
    parts.elements.push([1, 3, 11, 4, 7, 13, 12, 8, 14, 9]);
    parts.element_tags.push(6);
    parts.element_regions.push(0);
    let mesh = Mesh::new(parts).unwrap();
    assert_close("area", area(&mesh, "skin"), 1.0, 1e-14);
    let error = mesh.surface_pressure("skin").unwrap_err();
    assert!(
        matches!(&error, MeshError { fault: MeshFault::InnerFace { group, element: 102, .. }, .. } if group == "skin"),
        "{error:?}"
    );
    assert!(error.to_string().contains("between two tetrahedra"), "{error}");
}

#[test]
fn a_missing_surface_is_told_with_those_there_are() {
    let mesh = data_mesh("cylinder.msh");
    for error in [mesh.surface_weights("body").unwrap_err(), mesh.surface_pressure("body").unwrap_err()] {
        let message = error.to_string();
        for part in ["no physical surface named \"body\"", "\"side\"", "\"head\"", "\"all round\"", "\"9\""] {
            assert!(message.contains(part), "\"{part}\" is missing in: {message}");
        }
    }
}

#[test]
fn an_unnamed_surface_may_not_go_by_the_name_of_another() {
    let text = std::fs::read_to_string(data("cylinder.msh")).unwrap();
    let error = parse_msh(text.replace("\"side\"", "\"9\"").as_bytes(), "nine.msh").unwrap_err();
    assert!(
        matches!(&error, MeshError { fault: MeshFault::AmbiguousGroup { kind: "surface", name, .. }, .. } if name == "9"),
        "{error:?}"
    );
    // The volume may.
    assert!(parse_msh(text.replace("\"body\"", "\"9\"").as_bytes(), "nine.msh").is_ok());
}
