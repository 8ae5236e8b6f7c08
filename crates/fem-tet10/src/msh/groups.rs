//! Physical groups: which volume entities are in which, and what they are called.

use std::borrow::Cow;
use std::collections::HashMap;

use super::source::Source;
use crate::error::MeshError;
use crate::mesh::MeshParts;

/// The three-dimensional physical groups of a file.
#[derive(Default)]
pub(super) struct PhysicalGroups {
    /// Name of a group by its number. Not every group has one.
    names: HashMap<u32, String>,
    /// Numbers of the groups that a volume entity is in, by the entity's tag.
    of_volume: HashMap<i32, Vec<u32>>,
}

impl PhysicalGroups {
    /// Reads `$PhysicalNames`: always text, in binary files too.
    pub(super) fn read_names(&mut self, source: &mut Source) -> Result<(), MeshError> {
        let count: u64 = source.text_number("the number of names")?;
        for _ in 0..count {
            let dimension: i32 = source.text_number("a dimension")?;
            let number: u32 = source.text_number("the number of a physical group")?;
            let name = source.quoted()?;
            if dimension == 3 {
                self.names.insert(number, name);
            }
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
                    if dimension == 3 {
                        self.of_volume.entry(tag).or_default().push(number.unsigned_abs());
                    }
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

    /// Fills groups and regions of `parts`; the regions are the given volume entities. A group without a name goes
    /// by its number.
    pub(super) fn name_regions(&self, parts: &mut MeshParts, volumes: &[i32]) -> Result<(), MeshError> {
        // Name -> (index, whether it is a number for want of a name).
        let mut known: HashMap<Cow<str>, (usize, bool)> = HashMap::new();
        for volume in volumes {
            let mut region = Vec::new();
            for number in self.of_volume.get(volume).into_iter().flatten() {
                let (name, unnamed) = match self.names.get(number) {
                    Some(name) => (Cow::from(name), false),
                    None => (Cow::from(number.to_string()), true),
                };
                let (index, known_unnamed) = *known.entry(name).or_insert_with_key(|name| {
                    parts.groups.push(name.to_string());
                    (parts.groups.len() - 1, unnamed)
                });
                if unnamed != known_unnamed {
                    let name = parts.groups[index].clone();
                    return Err(MeshError::AmbiguousGroup { source_name: parts.source.clone(), name });
                }
                region.push(index);
            }
            region.sort_unstable();
            region.dedup();
            parts.regions.push(region);
        }
        Ok(())
    }
}
