//! The nodes of a body: labels, positions and groups, from a table or from the `*NODE` blocks of an .inp file.

use std::collections::{BTreeMap, HashMap};

use crate::error::MatrixError;
use crate::source::{Next, Source, fields, number, shown};

/// The nodes of a file, in its order.
#[derive(Debug, Default)]
pub(crate) struct NodeFile {
    pub labels: Vec<u64>,
    pub positions: Vec<[f64; 3]>,
    /// Indices of nodes by the name of their group.
    pub groups: BTreeMap<String, Vec<u32>>,
    index: HashMap<u64, u32>,
}

const HELP: &str = "write a line `node, x, y, z` for each node (with a fifth field for its groups, separated by blanks), or name the \
                    .inp file that the matrices come from";

impl NodeFile {
    pub fn read(source: &Source<'_>) -> Result<Self, MatrixError> {
        let is_inp = source.path.extension().is_some_and(|ending| ending.eq_ignore_ascii_case("inp"));
        let nodes = if is_inp { read_inp(source)? } else { read_table(source)? };
        if nodes.labels.is_empty() {
            return Err(source.refuse(None, "a file without nodes", "the nodes of the body", HELP));
        }
        Ok(nodes)
    }

    pub fn index_of(&self, label: u64) -> Option<u32> {
        self.index.get(&label).copied()
    }

    fn add(&mut self, source: &Source<'_>, line: usize, label: u64, position: [f64; 3]) -> Result<u32, MatrixError> {
        let index = self.labels.len() as u32;
        if self.index.insert(label, index).is_some() {
            return Err(source.refuse(Some(line), format!("the node {label} a second time"), "each node once", HELP));
        }
        self.labels.push(label);
        self.positions.push(position);
        Ok(index)
    }
}

/// `node, x, y, z[, groups]`, or `x, y, z`; the first line may name the columns.
fn read_table(source: &Source<'_>) -> Result<NodeFile, MatrixError> {
    let mut nodes = NodeFile::default();
    let mut is_first = true;
    source.each_line(|line, text| {
        if text.starts_with('#') {
            return Ok(Next::Go);
        }
        let fields = fields(text);
        let was_first = std::mem::take(&mut is_first);
        if was_first && fields.first().is_some_and(|field| number(field).is_none()) {
            let names: Vec<String> = fields.iter().map(|name| name.trim_matches('"').to_lowercase()).collect();
            let names: Vec<&str> = names.iter().map(String::as_str).collect();
            let coordinates = if let [_, rest @ ..] = &names[..]
                && names.len() > 3
            {
                rest
            } else {
                &names[..]
            };
            if !matches!(coordinates, ["x", "y", "z"] | ["x", "y", "z", "groups"]) {
                let expected = "the columns `node, x, y, z`, or `node, x, y, z, groups`";
                return Err(source.refuse(Some(line), shown(text), expected, HELP));
            }
            return Ok(Next::Go);
        }
        let refuse = |expected: &str| source.refuse(Some(line), shown(text), expected, HELP);
        let (label, coordinates, groups) = match fields[..] {
            [x, y, z] => (None, [x, y, z], ""),
            [node, x, y, z] => (Some(node), [x, y, z], ""),
            [node, x, y, z, groups] => (Some(node), [x, y, z], groups),
            _ => return Err(refuse("`node, x, y, z`, with groups or without")),
        };
        let label = match label {
            None => Some(nodes.labels.len() as u64 + 1),
            Some(text) => text.parse().ok().or_else(|| whole(number(text)?)),
        };
        let label = label.ok_or_else(|| refuse("the label of a node, a whole number"))?;
        let node = nodes.add(source, line, label, position(source, line, text, coordinates)?)?;
        for group in groups.split_whitespace() {
            nodes.groups.entry(group.to_owned()).or_default().push(node);
        }
        Ok(Next::Go)
    })?;
    Ok(nodes)
}

/// A whole number that was written as any other, such as numpy does: 1.000000000000000000e+00.
fn whole(value: f64) -> Option<u64> {
    (value.fract() == 0.0 && (0.0..1e15).contains(&value)).then_some(value as u64)
}

fn position(source: &Source<'_>, line: usize, text: &str, fields: [&str; 3]) -> Result<[f64; 3], MatrixError> {
    let coordinates = fields.map(|field| if field.is_empty() { Some(0.0) } else { number(field) });
    match coordinates {
        [Some(x), Some(y), Some(z)] if [x, y, z].iter().all(|c| c.is_finite()) => Ok([x, y, z]),
        _ => Err(source.refuse(Some(line), shown(text), "three coordinates that are finite numbers", HELP)),
    }
}

/// The block that the reader of an .inp file is in.
enum Block {
    Nodes(Option<String>),
    Set { name: String, generate: bool },
    Other,
}

/// `*NODE` and `*NSET`; the rest of the file is left out.
fn read_inp(source: &Source<'_>) -> Result<NodeFile, MatrixError> {
    let mut nodes = NodeFile::default();
    let mut block = Block::Other;
    // Sets may name nodes that come later.
    let mut sets: Vec<(String, usize, Vec<String>, bool)> = Vec::new();
    source.each_line(|line, text| {
        if text.starts_with("**") {
            return Ok(Next::Go);
        }
        if let Some(keyword) = text.strip_prefix('*') {
            block = keyword_block(source, line, keyword)?;
            return Ok(Next::Go);
        }
        let fields = fields(text);
        match &block {
            Block::Nodes(set) => {
                let refuse = || source.refuse(Some(line), shown(text), "`node, x, y, z`", HELP);
                let (Some(label), 2..=4) = (fields[0].parse().ok(), fields.len()) else { return Err(refuse()) };
                let field = |i: usize| fields.get(i).copied().unwrap_or_default();
                let node =
                    nodes.add(source, line, label, position(source, line, text, [field(1), field(2), field(3)])?)?;
                if let Some(set) = set {
                    nodes.groups.entry(set.clone()).or_default().push(node);
                }
            }
            Block::Set { name, generate } => {
                let listed = fields.iter().filter(|field| !field.is_empty()).map(|field| (*field).to_owned()).collect();
                sets.push((name.clone(), line, listed, *generate));
            }
            Block::Other => {}
        }
        Ok(Next::Go)
    })?;
    for (name, line, listed, generate) in sets {
        let found = members(source, &nodes, line, &listed, generate)?;
        nodes.groups.entry(name).or_default().extend(found);
    }
    for group in nodes.groups.values_mut() {
        group.sort_unstable();
        group.dedup();
    }
    Ok(nodes)
}

fn keyword_block(source: &Source<'_>, line: usize, keyword: &str) -> Result<Block, MatrixError> {
    let mut parts = keyword.split(',').map(str::trim);
    let name = parts.next().unwrap_or_default().to_uppercase();
    let parameters: Vec<(String, String)> = parts
        .map(|part| {
            let (key, value) = part.split_once('=').unwrap_or((part, ""));
            (key.trim().to_uppercase(), value.trim().trim_matches('"').to_owned())
        })
        .collect();
    let value = |key: &str| parameters.iter().find(|(name, _)| name == key).map(|(_, value)| value.clone());
    match name.as_str() {
        "NODE" if value("INPUT").is_some() => Err(source.refuse(
            Some(line),
            "*NODE with INPUT",
            "the nodes in this file",
            "name a file that has them, or write a table of nodes",
        )),
        "NODE" if value("SYSTEM").is_some_and(|system| !system.eq_ignore_ascii_case("R")) => Err(source.refuse(
            Some(line),
            "*NODE in cylindrical or spherical coordinates",
            "x, y, z of each node",
            "write a table of nodes: `node, x, y, z`",
        )),
        "NODE" => Ok(Block::Nodes(value("NSET"))),
        "NSET" => Ok(match value("NSET") {
            Some(name) => Block::Set { name, generate: value("GENERATE").is_some() },
            None => Block::Other,
        }),
        "INCLUDE" | "INSTANCE" | "SYSTEM" => Err(source.refuse(
            Some(line),
            format!("*{name}"),
            "the positions of the nodes, as they are, in this one file",
            "write a table of nodes: `node, x, y, z` (from a file without parts and instances)",
        )),
        _ => Ok(Block::Other),
    }
}

/// The nodes that a line of a set lists: labels, names of sets before it, or first, last and increment.
fn members(
    source: &Source<'_>,
    nodes: &NodeFile,
    line: usize,
    listed: &[String],
    generate: bool,
) -> Result<Vec<u32>, MatrixError> {
    let refuse = || {
        let help = "list labels of nodes, or names of sets that come before; remove the set if nothing needs it";
        source.refuse(Some(line), shown(&listed.join(", ")), "nodes and sets of this file", help)
    };
    if generate {
        let numbers: Option<Vec<u64>> = listed.iter().map(|text| text.parse().ok()).collect();
        let (first, last, step) = match numbers.as_deref() {
            Some(&[first, last]) => (first, last, 1),
            Some(&[first, last, step]) if step > 0 => (first, last, step),
            _ => return Err(refuse()),
        };
        let is_in = |label: &u64| (first..=last).contains(label) && (label - first).is_multiple_of(step);
        return Ok((0..).zip(&nodes.labels).filter(|(_, label)| is_in(label)).map(|(node, _)| node).collect());
    }
    let mut found = Vec::new();
    for text in listed {
        match text.parse().ok().map(|label: u64| nodes.index_of(label)) {
            Some(Some(node)) => found.push(node),
            Some(None) => return Err(refuse()),
            // Names of sets are the same in capital letters.
            None => {
                let named = nodes.groups.iter().find(|(name, _)| name.eq_ignore_ascii_case(text));
                found.extend(named.ok_or_else(refuse)?.1);
            }
        }
    }
    Ok(found)
}
