//! Reader of gmsh's MSH 4.1, ASCII and binary.
//!
//! Both forms carry the same numbers in the same order, so one parser asks a [`Source`] for the next number
//! and the source knows how it is written. No count in a file is trusted: memory grows with what is read.

mod block;
mod groups;
mod source;

use std::collections::HashMap;
use std::io;
use std::path::Path;

use crate::error::{MeshError, MeshFault};
use crate::mesh::checked::Mesh;
use crate::mesh::parts::MeshParts;
use block::Block;
use groups::PhysicalGroups;
use source::Source;

/// Nodes of gmsh's element types by number, to fifth order; there is no type 0.
const NODES_OF_TYPE: [usize; 32] =
    [0, 2, 3, 4, 4, 8, 6, 5, 3, 6, 9, 10, 27, 18, 14, 1, 8, 20, 15, 13, 9, 10, 12, 15, 15, 21, 4, 5, 6, 20, 35, 56];
/// The largest number of an element type that gmsh uses.
const LAST_TYPE: i32 = 140;
const TET4: i32 = 4;
const TET10: i32 = 11;

/// Bytes that reading takes for each byte of the file, which is one of them: meshes of gmsh took 3.6.
const FACTOR: usize = 4;

const REMESH: &str = "mesh with -order 2 (or `Mesh.ElementOrder = 2;`), or set raise_order = true in [body] of the scene for \
                      straight edges with nodes in their middle";
const TETRAHEDRA_ONLY: &str = "mesh with tetrahedra (gmsh: no Recombine, no Transfinite Volume with Recombine) and -order 2, or give mass and stiffness of \
     any elements in place of the mesh: `matrices` in [body] (docs/reference/matrices.md)";

/// Reads a MSH 4.1 file and checks the mesh.
///
/// # Errors
/// See [`MeshError`]: unreadable file, wrong format, wrong elements, and all that [`Mesh::new`] refuses.
pub fn read_msh(path: impl AsRef<Path>) -> Result<Mesh, MeshError> {
    parse_msh(&msh_bytes(path.as_ref())?, &path.as_ref().display().to_string())
}

/// The contents of a MSH file, for [`parse_msh`].
///
/// # Errors
/// [`MeshFault::Io`], and [`MeshFault::Memory`] where its mesh would not fit into the memory.
pub fn msh_bytes(path: &Path) -> Result<Vec<u8>, MeshError> {
    let source_name = path.display().to_string();
    let size = std::fs::metadata(path).map_or(0, |found| usize::try_from(found.len()).unwrap_or(usize::MAX));
    memory::check("the mesh", size.saturating_mul(FACTOR)).map_err(|error| MeshFault::from(error).of(&source_name))?;
    read_ordinary(path).map_err(|error| MeshFault::Io(error).of(source_name))
}

/// A device or a pipe might never end, or never begin.
fn read_ordinary(path: &Path) -> io::Result<Vec<u8>> {
    match std::fs::metadata(path)? {
        found if found.is_file() => std::fs::read(path),
        found if found.is_dir() => Err(io::Error::other("this is a folder; name the mesh file in it")),
        _ => Err(io::Error::other("this is not an ordinary file but a device or a pipe; write the mesh into a file")),
    }
}

/// Reads a mesh from the contents of a MSH 4.1 file; `source_name` is what messages call it.
///
/// # Errors
/// As [`read_msh`].
pub fn parse_msh(bytes: &[u8], source_name: &str) -> Result<Mesh, MeshError> {
    Mesh::new(parse_parts(bytes, source_name)?)
}

fn parse_parts(bytes: &[u8], source_name: &str) -> Result<MeshParts, MeshError> {
    let mut source = Source::open(bytes, source_name)?;
    let mut parts = MeshParts { source: source_name.to_owned(), ..MeshParts::default() };
    let mut groups = PhysicalGroups::default();
    let (mut volumes, mut blocks) = (Vec::new(), Vec::new());
    let (mut nodes_seen, mut elements_seen) = (false, false);
    while let Some(section) = source.next_section()? {
        match section.as_str() {
            "$PhysicalNames" => groups.read_names(&mut source)?,
            "$Entities" => groups.read_entities(&mut source)?,
            "$PartitionedEntities" => groups.read_partitioned_entities(&mut source)?,
            "$Nodes" => {
                nodes(&mut source, &mut parts)?;
                nodes_seen = true;
            }
            "$Elements" => {
                elements(&mut source, &mut parts, &mut volumes, &mut blocks)?;
                elements_seen = true;
            }
            _ => {
                source.skip_section()?;
                continue;
            }
        }
        source.end_section()?;
    }
    let missing = |section| MeshFault::MissingSection { section }.of(source_name);
    if !nodes_seen {
        return Err(missing("$Nodes"));
    }
    if !elements_seen {
        return Err(missing("$Elements"));
    }
    groups.name_regions(&mut parts, &volumes)?;
    groups.name_boundary(&mut parts, &blocks, bytes.len())?;
    Ok(parts)
}

fn nodes(source: &mut Source, parts: &mut MeshParts) -> Result<(), MeshError> {
    let (blocks, total) = source.totals("nodes")?;
    let before = parts.node_tags.len();
    for _ in 0..blocks {
        let dimension = source.int("an entity's dimension")?;
        source.int("an entity's tag")?;
        let parametric = source.int("0 or 1 for parametric nodes")?;
        let count = source.size("the number of nodes of a block")?;
        for _ in 0..count {
            parts.node_tags.push(source.size("a node's tag")?);
        }
        let parameters = if parametric == 0 { 0 } else { dimension.clamp(0, 3) };
        for _ in 0..count {
            let mut position = [0.0; 3];
            for coordinate in &mut position {
                *coordinate = source.real("a node's coordinate")?;
            }
            parts.positions.push(position);
            for _ in 0..parameters {
                source.real("a node's parameter")?;
            }
        }
    }
    source.hold_to(total, parts.node_tags.len() - before)
}

/// Reads the elements. Each volume entity that has tetrahedra is a region; `volumes` gets their tags. What has fewer
/// dimensions goes into `boundary`.
fn elements(
    source: &mut Source,
    parts: &mut MeshParts,
    volumes: &mut Vec<i32>,
    boundary: &mut Vec<Block>,
) -> Result<(), MeshError> {
    let (blocks, total) = source.totals("elements")?;
    let mut found = 0;
    let mut region_of: HashMap<i32, usize> = HashMap::new();
    for _ in 0..blocks {
        let dimension = source.int("an entity's dimension")?;
        let entity = source.int("an entity's tag")?;
        let kind = source.int("an element type")?;
        let count = source.size("the number of elements of a block")?;
        if !(1..=LAST_TYPE).contains(&kind) {
            return Err(source.error("an element type of gmsh (1 to 140)", &kind.to_string()));
        }
        let nodes = NODES_OF_TYPE.get(kind as usize).copied();
        if (dimension == 3 && kind != TET10 || nodes.is_none()) && count > 0 {
            let element = source.size("an element's tag")?;
            let (found, help) = match kind {
                TET4 => ("a four-node tetrahedron".to_owned(), REMESH),
                29..=31 => (format!("a tetrahedron of order {}", kind - 26), REMESH),
                5 | 12 | 17 | 92..=98 => (format!("a hexahedron (gmsh's element type {kind})"), TETRAHEDRA_ONLY),
                6 | 13 | 18 => (format!("a prism (gmsh's element type {kind})"), TETRAHEDRA_ONLY),
                7 | 14 | 19 => (format!("a pyramid (gmsh's element type {kind})"), TETRAHEDRA_ONLY),
                _ => (format!("of gmsh's element type {kind}"), TETRAHEDRA_ONLY),
            };
            return Err(MeshFault::ElementType { element, found, help }.of(&parts.source));
        }
        if kind != TET10 {
            let mut block =
                Block { dimension: dimension.clamp(0, 3) as usize, entity, kind, tags: Vec::new(), nodes: Vec::new() };
            for _ in 0..count {
                block.tags.push(source.size("an element's tag")?);
                for _ in 0..nodes.unwrap_or(0) {
                    block.nodes.push(source.size("a node of an element")?);
                }
            }
            found += block.tags.len();
            if !block.tags.is_empty() {
                boundary.push(block);
            }
            continue;
        }
        let region = *region_of.entry(entity).or_insert_with(|| {
            volumes.push(entity);
            volumes.len() - 1
        });
        let before = parts.element_tags.len();
        for _ in 0..count {
            let tag = source.size("an element's tag")?;
            let mut element = [0; 10];
            for node in &mut element {
                *node = source.size("a node of an element")?;
            }
            parts.element_tags.push(tag);
            parts.elements.push(element);
            parts.element_regions.push(region);
        }
        found += parts.element_tags.len() - before;
    }
    source.hold_to(total, found)
}
