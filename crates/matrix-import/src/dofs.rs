//! Which degree of freedom of which node each row of a matrix is.

use crate::entries::Index;
use crate::error::MatrixError;
use crate::nodes::NodeFile;
use crate::source::{Next, Source, fields, shown};

const HELP: &str = "name the .dof file that CalculiX writes beside the matrices, or write a line `node, dof` for each row, dof from 1 to 6";

/// Reads `node.dof` (CalculiX) or `node, dof` for each row.
pub(crate) fn read_dofs(source: &Source<'_>) -> Result<Vec<Index>, MatrixError> {
    let mut rows = Vec::new();
    source.each_line(|line, text| {
        if text.starts_with('#') || (rows.is_empty() && text.starts_with(char::is_alphabetic)) {
            return Ok(Next::Go);
        }
        let fields = fields(text);
        let pair = match fields[..] {
            [both] => both.split_once('.'),
            [node, dof] => Some((node, dof)),
            _ => None,
        };
        match pair.and_then(|(node, dof)| Some((node.parse().ok()?, dof.parse().ok()?))) {
            Some((node, dof @ 1..=6)) => rows.push(Index::Of { node, dof }),
            Some((_, _)) => {
                let expected = "a degree of freedom from 1 to 6: translations, then rotations";
                let help = "write the matrices of a mechanical model, without temperatures";
                return Err(source.refuse(Some(line), shown(text), expected, help));
            }
            None => return Err(source.refuse(Some(line), shown(text), "`node.dof` or `node, dof`", HELP)),
        }
        Ok(Next::Go)
    })?;
    Ok(rows)
}

/// Where the rows of a matrix go.
pub(crate) struct Order {
    /// Degrees of freedom of a node: 3 or 6.
    pub dofs: usize,
    /// For each node of the body, its index in the file of nodes; one may be there several times.
    pub nodes: Vec<u32>,
    /// For each row of the file, that of the body.
    pub to: Vec<usize>,
    /// True if nodes are there several times.
    pub is_expanded: bool,
}

impl Order {
    /// The order of rows that follow the nodes.
    pub fn of_nodes(count: usize, dofs: usize) -> Self {
        let nodes = (0..count as u32).collect();
        Self { dofs, nodes, to: (0..count * dofs).collect(), is_expanded: false }
    }

    /// The order of rows that say their nodes. `source` is the file that says it.
    pub fn of_rows(source: &Source<'_>, rows: &[Index], nodes: &NodeFile) -> Result<Self, MatrixError> {
        let labelled = rows.iter().map(|row| match row {
            Index::Of { node, dof } => (*node, *dof),
            Index::Number(number) => (u64::from(*number), 0),
        });
        let dofs = if labelled.clone().any(|(_, dof)| dof > 3) { 6 } else { 3 };
        // The last place of each node, and a bit for each of its degrees of freedom that has been met.
        let mut order: Vec<u32> = Vec::new();
        let mut is_expanded = false;
        let mut open: Vec<Option<(usize, u8)>> = vec![None; nodes.labels.len()];
        let mut to = vec![0; rows.len()];
        for (row, (label, dof)) in labelled.enumerate() {
            let Some(node) = nodes.index_of(label) else {
                let help = "add the node to the file of nodes; a label that the model has not stands for an internal node or a \
                            multiplier: leave out of the model what makes it (hybrid elements, connectors, rigid bodies)";
                let found = format!("a degree of freedom of node {label}");
                return Err(source.refuse(None, found, "nodes that the file of nodes has", help));
            };
            let at = node as usize;
            let bit = 1_u8 << (dof - 1);
            let place = match &mut open[at] {
                Some((place, seen)) if *seen & bit == 0 => {
                    *seen |= bit;
                    *place
                }
                slot => {
                    let is_whole = slot.is_none_or(|(_, seen)| seen.count_ones() as usize == dofs);
                    is_expanded |= slot.is_some();
                    if !is_whole {
                        return Err(incomplete(source, label, slot.map_or(0, |(_, seen)| seen), dofs));
                    }
                    order.push(node);
                    *slot = Some((order.len() - 1, bit));
                    order.len() - 1
                }
            };
            to[row] = dofs * place + usize::from(dof - 1);
        }
        for (node, slot) in open.iter().enumerate() {
            if let Some((_, seen)) = slot
                && seen.count_ones() as usize != dofs
            {
                return Err(incomplete(source, nodes.labels[node], *seen, dofs));
            }
        }
        if !is_expanded {
            // In the order of the file of nodes.
            let mut sorted: Vec<usize> = (0..order.len()).collect();
            sorted.sort_unstable_by_key(|place| order[*place]);
            let mut moved = vec![0; order.len()];
            sorted.iter().enumerate().for_each(|(new, old)| moved[*old] = new);
            to.iter_mut().for_each(|row| *row = dofs * moved[*row / dofs] + *row % dofs);
            order.sort_unstable();
        }
        Ok(Self { dofs, nodes: order, to, is_expanded })
    }
}

fn incomplete(source: &Source<'_>, label: u64, seen: u8, dofs: usize) -> MatrixError {
    let listed: Vec<String> = (0..6).filter(|bit| seen & (1 << bit) != 0).map(|bit| (bit + 1).to_string()).collect();
    source.refuse(
        None,
        format!("node {label} with the degree(s) of freedom {} only", listed.join(", ")),
        format!("{dofs} for each node: nothing held, nothing eliminated"),
        "write the matrices without *BOUNDARY, *EQUATION, *MPC and rigid bodies, and hold the body by [[constraints]] in the scene; \
         solids (3 a node) and beams or shells (6) in one model are not read",
    )
}
