//! From the tags of a file to indices.

use std::collections::HashMap;

use crate::error::{MeshError, MeshFault};

fn duplicate(source: &str, kind: &'static str, tag: u64) -> MeshError {
    MeshFault::DuplicateTag { kind, tag }.of(source)
}

/// Index of a node by its tag.
pub(crate) fn index_nodes(source: &str, node_tags: &[u64]) -> Result<HashMap<u64, u32>, MeshError> {
    let mut index_of: HashMap<u64, u32> = HashMap::with_capacity(node_tags.len());
    for (index, tag) in node_tags.iter().enumerate() {
        if index_of.insert(*tag, index as u32).is_some() {
            return Err(duplicate(source, "node", *tag));
        }
    }
    Ok(index_of)
}

/// The nodes of an element, by index.
pub(crate) fn indices<const N: usize>(
    source: &str,
    index_of: &HashMap<u64, u32>,
    element: u64,
    nodes: &[u64; N],
) -> Result<[u32; N], MeshError> {
    let mut indices = [0; N];
    for (index, node) in indices.iter_mut().zip(nodes) {
        *index = *index_of.get(node).ok_or_else(|| MeshFault::UnknownNode { element, node: *node }.of(source))?;
    }
    Ok(indices)
}

/// Turns node tags into indices.
pub(crate) fn resolve_tags(
    source: &str,
    index_of: &HashMap<u64, u32>,
    element_tags: &[u64],
    elements: &[[u64; 10]],
) -> Result<Vec<[u32; 10]>, MeshError> {
    let mut sorted = element_tags.to_vec();
    sorted.sort_unstable();
    if let Some(pair) = sorted.windows(2).find(|pair| pair[0] == pair[1]) {
        return Err(duplicate(source, "element", pair[0]));
    }
    elements.iter().zip(element_tags).map(|(nodes, tag)| indices(source, index_of, *tag, nodes)).collect()
}
