//! Physical groups: which entities are in which, and what they are called.

use std::borrow::Cow;
use std::collections::HashMap;

use super::block::{Block, TRI6};
use super::source::Source;
use crate::error::{MeshError, MeshFault};
use crate::mesh::checked::KINDS;
use crate::mesh::parts::{MeshParts, NodeGroup, SurfaceGroup};

/// Entries of groups for a byte of the file, at most: a small file that has much in many groups would fill the memory.
/// Numbers of four digits may be in twenty groups at once.
const MAX_ENTRIES: usize = 4;

/// gmsh writes it for the dimension of names in MSH 2.0, which has none.
const WITHOUT_DIMENSION: i32 = -1;

/// The physical groups of a file.
#[derive(Default)]
pub(super) struct PhysicalGroups {
    /// Name of a group by its dimension and number. Not every group has one.
    names: HashMap<(i32, u32), String>,
    /// Numbers of the groups that an entity is in, by the entity's dimension and tag.
    of_entity: HashMap<(usize, i32), Vec<u32>>,
}

impl PhysicalGroups {
    /// Reads `$PhysicalNames`: always text, in binary files too.
    pub(super) fn read_names(&mut self, source: &mut Source) -> Result<(), MeshError> {
        let count: u64 = source.text_number("the number of names")?;
        for _ in 0..count {
            let dimension: i32 = source.text_number("a dimension")?;
            let number: u32 = source.text_number("the number of a physical group")?;
            self.names.insert((dimension, number), source.quoted()?);
        }
        Ok(())
    }

    /// Reads `$Entities`.
    pub(super) fn read_entities(&mut self, source: &mut Source) -> Result<(), MeshError> {
        self.read_by_dimension(source, |_| Ok(()))
    }

    /// Reads `$PartitionedEntities`: the parts that entities were cut into, each with a tag and the groups of its own.
    pub(super) fn read_partitioned_entities(&mut self, source: &mut Source) -> Result<(), MeshError> {
        source.size("the number of partitions")?;
        for _ in 0..source.size("the number of ghost entities")? {
            source.int("a ghost entity's tag")?;
            source.int("a ghost entity's partition")?;
        }
        self.read_by_dimension(source, |source| {
            source.int("the dimension of the entity that was cut")?;
            source.int("the tag of the entity that was cut")?;
            for _ in 0..source.size("a number of partitions")? {
                source.int("a partition")?;
            }
            Ok(())
        })
    }

    /// Reads points, curves, surfaces and volumes; `after_tag` passes over what stands behind their tags.
    fn read_by_dimension(
        &mut self,
        source: &mut Source,
        after_tag: impl Fn(&mut Source) -> Result<(), MeshError>,
    ) -> Result<(), MeshError> {
        let mut counts = [0; 4];
        for count in &mut counts {
            *count = source.size("a number of entities")?;
        }
        for (dimension, count) in counts.into_iter().enumerate() {
            for _ in 0..count {
                let tag = source.int("an entity's tag")?;
                after_tag(source)?;
                let coordinates = if dimension == 0 { 3 } else { 6 };
                for _ in 0..coordinates {
                    source.real("a coordinate of an entity")?;
                }
                for _ in 0..source.size("a number of physical groups")? {
                    let number = source.int("the number of a physical group")?;
                    self.of_entity.entry((dimension, tag)).or_default().push(number.unsigned_abs());
                }
                if dimension > 0 {
                    for _ in 0..source.size("a number of bounding entities")? {
                        source.int("a bounding entity")?;
                    }
                }
            }
        }
        Ok(())
    }

    /// Fills groups and regions of `parts`; the regions are the given volume entities.
    pub(super) fn name_regions(&self, parts: &mut MeshParts, volumes: &[i32]) -> Result<(), MeshError> {
        (parts.groups, parts.regions) = self.of_entities(3, volumes, &parts.source)?;
        Ok(())
    }

    /// Fills the groups of surfaces, curves and points of `parts` with the elements of their entities; `length` is that
    /// of the file.
    pub(super) fn name_boundary(
        &self,
        parts: &mut MeshParts,
        blocks: &[Block],
        length: usize,
    ) -> Result<(), MeshError> {
        let groups = |block: &Block| self.of_entity.get(&(block.dimension, block.entity)).map_or(0, Vec::len);
        let numbers = |block: &Block| 1 + block.tags.len() + block.nodes.len();
        let entries = blocks.iter().fold(0, |sum: usize, b| sum.saturating_add(groups(b).saturating_mul(numbers(b))));
        if let (true, Some(most)) =
            (entries > length.saturating_mul(MAX_ENTRIES), blocks.iter().max_by_key(|block| groups(block)))
        {
            return Err(MeshFault::TooManyGroups {
                kind: KINDS[most.dimension.min(2)],
                entity: most.entity,
                groups: groups(most),
            }
            .of(&parts.source));
        }
        for dimension in 0..=2 {
            let blocks = || blocks.iter().filter(|block| block.dimension == dimension);
            let entities: Vec<i32> = blocks().map(|block| block.entity).collect();
            let (names, of_blocks) = self.of_entities(dimension, &entities, &parts.source)?;
            if dimension < 2 {
                let mut groups: Vec<_> =
                    names.into_iter().map(|name| NodeGroup { name, dimension, nodes: Vec::new() }).collect();
                for (block, indices) in blocks().zip(&of_blocks) {
                    indices.iter().for_each(|group| groups[*group].nodes.extend(&block.nodes));
                }
                parts.node_groups.extend(groups);
                continue;
            }
            let mut groups: Vec<_> =
                names.into_iter().map(|name| SurfaceGroup { name, ..SurfaceGroup::default() }).collect();
            for (block, indices) in blocks().zip(&of_blocks) {
                for group in indices {
                    let group = &mut groups[*group];
                    if let (true, Some(element)) = (block.kind != TRI6, block.tags.first()) {
                        if parts.elements.is_empty() {
                            // A mesh of the surface alone: no order of its triangles would help.
                            return Err(MeshFault::NoElements.of(&parts.source));
                        }
                        return Err(
                            MeshFault::NotAFace { group: group.name.clone(), element: *element }.of(&parts.source)
                        );
                    }
                    group.triangle_tags.extend(&block.tags);
                    group.triangles.extend(block.nodes.chunks_exact(6).filter_map(|n| <[u64; 6]>::try_from(n).ok()));
                }
            }
            parts.surfaces = groups;
        }
        Ok(())
    }

    /// Names of the groups that entities of one dimension are in, and for each entity the indices of its groups,
    /// ascending. A group without a name goes by its number.
    fn of_entities(
        &self,
        dimension: usize,
        entities: &[i32],
        source_name: &str,
    ) -> Result<(Vec<String>, Vec<Vec<usize>>), MeshError> {
        let name = |dimension: i32, number: u32| self.names.get(&(dimension, number));
        let mut names = Vec::new();
        // Name -> (index, whether it is a number for want of a name).
        let mut known: HashMap<Cow<str>, (usize, bool)> = HashMap::new();
        let mut groups = Vec::new();
        for entity in entities {
            let mut of_entity = Vec::new();
            for number in self.of_entity.get(&(dimension, *entity)).into_iter().flatten() {
                let (name, unnamed) = match name(dimension as i32, *number).or_else(|| name(WITHOUT_DIMENSION, *number))
                {
                    Some(name) => (Cow::from(name), false),
                    None => (Cow::from(number.to_string()), true),
                };
                let (index, known_unnamed) = *known.entry(name).or_insert_with_key(|name| {
                    names.push(name.to_string());
                    (names.len() - 1, unnamed)
                });
                if unnamed != known_unnamed {
                    return Err(MeshFault::AmbiguousGroup { kind: KINDS[dimension], name: names.swap_remove(index) }
                        .of(source_name));
                }
                of_entity.push(index);
            }
            of_entity.sort_unstable();
            of_entity.dedup();
            groups.push(of_entity);
        }
        Ok((names, groups))
    }
}
