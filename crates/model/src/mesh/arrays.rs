//! A mesh as arrays in a file.

use std::collections::BTreeMap;

use fem_tet10::{Mesh, MeshError, MeshParts, NodeGroup, SurfaceGroup};
use mesh_import::{Beside, DeckMaterial, Imported};
use sealed::{Array, Declared, Kind, SealedError, SealedFile, Writer};
use serde::{Deserialize, Serialize};

/// The text with the names of the groups.
const GROUPS: &str = "mesh_groups";
/// The text with the sentences on what of the mesh file was left out.
const NOTES: &str = "mesh_notes";
/// The text with the materials that the mesh file gives to groups; a body file has none, but what was made of them.
const MATERIALS: &str = "mesh_materials";

/// The text with what else a deck says; other meshes and body files have none.
const BESIDE: &str = "mesh_beside";

/// The part of a mesh that has no numbers.
#[derive(Serialize, Deserialize)]
struct Groups {
    /// Names of the groups of volumes.
    volumes: Vec<String>,
    /// For each region, the numbers of the groups that it is in.
    regions: Vec<Vec<usize>>,
    /// Names of the groups of surfaces.
    surfaces: Vec<String>,
    /// Dimension and name of each group of curves or points.
    nodes: Vec<(usize, String)>,
}

/// A mesh, ready to be written.
pub(crate) struct MeshArrays {
    groups: Groups,
    notes: Vec<String>,
    materials: Vec<DeckMaterial>,
    beside: Beside,
    positions: Vec<f64>,
    node_tags: Vec<u64>,
    tetrahedra: Vec<u32>,
    tetrahedron_tags: Vec<u64>,
    regions: Vec<u32>,
    /// Triangles of all groups, one after the other.
    triangles: Vec<u32>,
    triangle_tags: Vec<u64>,
    /// Where each group ends.
    triangle_ends: Vec<u64>,
    group_nodes: Vec<u32>,
    group_node_ends: Vec<u64>,
}

impl MeshArrays {
    /// `notes` say what of the mesh file was left out, `materials` are those that it gives to groups, `beside` is what else it says.
    pub fn new(mesh: &Mesh, notes: &[String], materials: &[DeckMaterial], beside: &Beside) -> Self {
        let parts = mesh.parts();
        let index_of: BTreeMap<u64, u32> = parts.node_tags.iter().copied().zip(0..).collect();
        let index = |tag: &u64| index_of.get(tag).copied().unwrap_or(u32::MAX);
        let ends = |lengths: &mut dyn Iterator<Item = usize>| {
            let mut end = 0;
            lengths
                .map(|length| {
                    end += length as u64;
                    end
                })
                .collect()
        };
        let MeshParts { surfaces, node_groups, .. } = &parts;
        Self {
            positions: parts.positions.as_flattened().to_vec(),
            tetrahedra: mesh.elements().as_flattened().to_vec(),
            regions: parts.element_regions.iter().map(|region| *region as u32).collect(),
            triangles: surfaces.iter().flat_map(|s| s.triangles.as_flattened()).map(index).collect(),
            triangle_tags: surfaces.iter().flat_map(|s| s.triangle_tags.iter().copied()).collect(),
            triangle_ends: ends(&mut surfaces.iter().map(|s| s.triangles.len())),
            group_nodes: node_groups.iter().flat_map(|group| &group.nodes).map(index).collect(),
            group_node_ends: ends(&mut node_groups.iter().map(|group| group.nodes.len())),
            groups: Groups {
                volumes: parts.groups.clone(),
                regions: parts.regions.clone(),
                surfaces: surfaces.iter().map(|s| s.name.clone()).collect(),
                nodes: node_groups.iter().map(|group| (group.dimension, group.name.clone())).collect(),
            },
            notes: notes.to_vec(),
            materials: materials.to_vec(),
            beside: beside.clone(),
            node_tags: parts.node_tags,
            tetrahedron_tags: parts.element_tags,
        }
    }

    /// The texts that go with the arrays, by name.
    pub fn texts(&self) -> [(String, String); 4] {
        // All their keys are texts: it cannot fail.
        let groups = serde_json::to_string(&self.groups).unwrap_or_default();
        let notes = serde_json::to_string(&self.notes).unwrap_or_default();
        let materials = serde_json::to_string(&self.materials).unwrap_or_default();
        let beside = serde_json::to_string(&self.beside).unwrap_or_default();
        [(GROUPS, groups), (NOTES, notes), (MATERIALS, materials), (BESIDE, beside)]
            .map(|(name, text)| (name.to_owned(), text))
    }

    /// The arrays; lengths in the `unit` of the scene.
    pub fn declared(&self, unit: &str) -> Vec<Declared> {
        let array = |name: &str, kind, shape: &[usize], unit: &str, description: &str| Declared {
            path: format!("mesh/{name}"),
            kind,
            shape: shape.to_vec(),
            attributes: vec![
                ("unit", unit.to_owned()),
                ("frame", if unit == "1" { "none" } else { "mesh" }.to_owned()),
                ("description", description.to_owned()),
            ],
            same_as: None,
        };
        let (n, m, t) = (self.node_tags.len(), self.tetrahedron_tags.len(), self.triangle_tags.len());
        vec![
            array("positions", Kind::F64, &[n, 3], unit, "positions of the nodes, undeformed"),
            array("node_tags", Kind::U64, &[n], "1", "numbers of the nodes in the mesh file"),
            array(
                "tetrahedra",
                Kind::U32,
                &[m, 10],
                "1",
                "nodes of the elements, from 0: corners, then mid-edges 01 12 02 03 23 13",
            ),
            array("tetrahedron_tags", Kind::U64, &[m], "1", "numbers of the elements in the mesh file"),
            array("tetrahedron_regions", Kind::U32, &[m], "1", "region of each element, from 0"),
            array(
                "group_triangles",
                Kind::U32,
                &[t, 6],
                "1",
                "nodes of the faces of all groups of surfaces, from 0, seen from outside: corners, then mid-edges 01 12 20",
            ),
            array("group_triangle_tags", Kind::U64, &[t], "1", "numbers of these faces in the mesh file"),
            array("group_triangle_ends", Kind::U64, &[self.triangle_ends.len()], "1", "end of each group of surfaces"),
            array("group_nodes", Kind::U32, &[self.group_nodes.len()], "1", "nodes of all groups of curves and points"),
            array(
                "group_node_ends",
                Kind::U64,
                &[self.group_node_ends.len()],
                "1",
                "end of each group of curves or points",
            ),
        ]
    }

    pub fn write(&self, writer: &mut Writer) -> Result<(), SealedError> {
        writer.write("mesh/positions", &self.positions)?;
        writer.write("mesh/node_tags", &self.node_tags)?;
        writer.write("mesh/tetrahedra", &self.tetrahedra)?;
        writer.write("mesh/tetrahedron_tags", &self.tetrahedron_tags)?;
        writer.write("mesh/tetrahedron_regions", &self.regions)?;
        writer.write("mesh/group_triangles", &self.triangles)?;
        writer.write("mesh/group_triangle_tags", &self.triangle_tags)?;
        writer.write("mesh/group_triangle_ends", &self.triangle_ends)?;
        writer.write("mesh/group_nodes", &self.group_nodes)?;
        writer.write("mesh/group_node_ends", &self.group_node_ends)
    }
}

/// The mesh in a file, called `source` in messages, checked as that of a mesh file is, and what was left out of it.
pub(crate) fn read(file: &SealedFile, source: String) -> Result<Imported, SealedError> {
    let damaged = |what: String| file.damaged(what);
    let groups: Groups = file
        .text(GROUPS)
        .and_then(|text| serde_json::from_str(text).ok())
        .ok_or_else(|| damaged("the names of the groups of its mesh cannot be read".to_owned()))?;
    let unread = |what: &str| damaged(format!("the {what} of its mesh cannot be read"));
    let notes = file.text(NOTES).and_then(|text| serde_json::from_str(text).ok()).ok_or_else(|| unread("notes"))?;
    let materials = file.text(MATERIALS).and_then(|text| serde_json::from_str(text).ok());
    let materials = materials.ok_or_else(|| unread("materials"))?;
    let beside = file.text(BESIDE).map(|text| serde_json::from_str(text).map_err(|_| unread("masses"))).transpose()?;
    let numbers = |name: &str| Ok::<_, SealedError>(file.read::<u64>(name)?.values);
    let node_tags = numbers("mesh/node_tags")?;
    let triangle_tags = numbers("mesh/group_triangle_tags")?;
    let no_node = || damaged("its mesh names a node that it has not".to_owned());
    let tag = |node: &u32| node_tags.get(*node as usize).copied().ok_or_else(no_node);
    let tags = |array: Array<u32>| array.values.iter().map(tag).collect::<Result<Vec<u64>, _>>();
    let triangles = tags(file.read("mesh/group_triangles")?)?;
    let triangles = triangles.as_chunks::<6>().0;
    let group_nodes = tags(file.read("mesh/group_nodes")?)?;
    let ranges = |name: &str, count: usize, length: usize| {
        let ends = numbers(name)?;
        let starts = std::iter::once(0).chain(ends.iter().copied());
        let ranges: Vec<_> = starts.zip(&ends).map(|(start, end)| start as usize..*end as usize).collect();
        let fit = ranges.iter().all(|range| range.start <= range.end && range.end <= length) && ranges.len() == count;
        if fit { Ok(ranges) } else { Err(damaged("the groups of its mesh do not fit together".to_owned())) }
    };
    let of_surfaces =
        ranges("mesh/group_triangle_ends", groups.surfaces.len(), triangles.len().min(triangle_tags.len()))?;
    let of_nodes = ranges("mesh/group_node_ends", groups.nodes.len(), group_nodes.len())?;
    let surface = |(name, range): (String, std::ops::Range<usize>)| SurfaceGroup {
        name,
        triangle_tags: triangle_tags[range.clone()].to_vec(),
        triangles: triangles[range].to_vec(),
    };
    let node_group = |((dimension, name), range): ((usize, String), std::ops::Range<usize>)| NodeGroup {
        name,
        dimension,
        nodes: group_nodes[range].to_vec(),
    };
    let parts = MeshParts {
        source,
        positions: file.read::<f64>("mesh/positions")?.values.as_chunks().0.to_vec(),
        element_tags: numbers("mesh/tetrahedron_tags")?,
        elements: tags(file.read("mesh/tetrahedra")?)?.as_chunks().0.to_vec(),
        groups: groups.volumes,
        regions: groups.regions,
        element_regions: file.read::<u32>("mesh/tetrahedron_regions")?.values.iter().map(|r| *r as usize).collect(),
        surfaces: groups.surfaces.into_iter().zip(of_surfaces).map(surface).collect(),
        node_groups: groups.nodes.into_iter().zip(of_nodes).map(node_group).collect(),
        node_tags,
    };
    let mesh = Mesh::new(parts).map_err(|error: MeshError| damaged(error.to_string()))?;
    Ok(Imported { mesh, notes, materials, beside: beside.unwrap_or_default() })
}
