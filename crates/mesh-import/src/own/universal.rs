//! Universal files of I-DEAS and Salome (`.unv`): nodes, tetrahedra and groups, and what of them is not used.

use std::collections::{BTreeMap, HashMap};
use std::path::Path;

use crate::beside::Beside;
use crate::contents::ReadFile;
use crate::error::ImportError;
use crate::imported::Imported;
use crate::own::notes::Left;
use crate::own::tetrahedra::Tetrahedra;
use crate::own::texts::{self, Data, Place, Texts};

/// Header, units and coordinate systems: nodes of 2411 and 781 are in the system of their part.
const SILENT: [u64; 3] = [151, 164, 2420];
/// Corners of a tetrahedron with ten nodes, and the nodes on its edges.
const OF_TETRAHEDRON: [usize; 10] = [0, 2, 4, 9, 1, 3, 5, 6, 7, 8];

/// Shape of an element.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Kind {
    Tetrahedron,
    Triangle,
    /// Another that fills a volume.
    Solid,
    Other(&'static str),
}

/// Shape of elements of this number.
fn kind(descriptor: u64) -> Kind {
    match descriptor {
        111 | 118 => Kind::Tetrahedron,
        41 | 42 | 51 | 52 | 61 | 62 | 72 | 74 | 81 | 82 | 91 | 92 => Kind::Triangle,
        112..=117 | 312 | 313 => Kind::Solid,
        11 => Kind::Other("rods"),
        21..=24 => Kind::Other("beams"),
        44..=46 | 54..=56 | 64..=66 | 71 | 75 | 76 | 84..=86 | 94..=96 => Kind::Other("quadrilaterals"),
        121 | 122 => Kind::Other("rigid elements"),
        136..=139 => Kind::Other("springs"),
        141..=142 => Kind::Other("dampers"),
        161 => Kind::Other("lumped masses"),
        _ => Kind::Other("elements of other kinds"),
    }
}

/// True if an element has a line on its section and orientation before its nodes.
fn is_beam(descriptor: u64) -> bool {
    matches!(descriptor, 11 | 21..=24)
}

/// Numbers of a member of a group: kind and label, and two more in the newer datasets.
fn numbers_of_member(dataset: u64) -> Option<usize> {
    match dataset {
        2429 | 2430 | 2432 => Some(2),
        2435 | 2452 | 2467 | 2477 => Some(4),
        _ => None,
    }
}

struct Element {
    place: Place,
    kind: Kind,
    nodes: Vec<u64>,
}

/// Members of a group by their labels.
struct Group {
    name: String,
    nodes: Vec<u64>,
    elements: Vec<u64>,
}

/// All that a file says of a mesh.
#[derive(Default)]
struct File {
    nodes: BTreeMap<u64, [f64; 3]>,
    elements: BTreeMap<u64, Element>,
    groups: Vec<Group>,
    left: Left,
}

/// The mesh of a file.
pub(crate) fn read(files: &[ReadFile], source: &Path, raise_order: bool) -> Result<Imported, ImportError> {
    let texts = Texts::new(files);
    let mut all = texts.lines()?;
    // Both ends of a line of Windows are ends.
    all.dedup_by(|next, before| next.text.is_empty() && next.place == before.place);
    let mut lines = Lines { texts: &texts, lines: all, at: 0 };
    let mut file = File::default();
    while let Some(dataset) = lines.dataset()? {
        file.take(dataset, &mut lines)?;
    }
    file.imported(&texts, source, raise_order)
}

/// The lines of a file, from the one that is read next.
struct Lines<'t> {
    texts: &'t Texts<'t>,
    lines: Vec<Data<'t>>,
    at: usize,
}

impl<'t> Lines<'t> {
    /// The number of the next dataset; none at the end of the file.
    fn dataset(&mut self) -> Result<Option<u64>, ImportError> {
        while let Some(data) = self.lines.get(self.at) {
            self.at += 1;
            match data.text.trim() {
                "" => {}
                "-1" => {
                    let Some(head) = self.lines.get(self.at) else { return Ok(None) };
                    self.at += 1;
                    let number = head.text.trim().trim_end_matches(['b', 'B']);
                    let number = number.split([' ', 'b']).next().and_then(|number| number.parse().ok());
                    return number.map(Some).ok_or_else(|| self.refuse(*head, "the number of a dataset"));
                }
                _ => return Err(self.refuse(*data, "a line with -1, which begins a dataset")),
            }
        }
        Ok(None)
    }

    /// The next line of a dataset that is not empty; none at its end.
    fn next(&mut self) -> Result<Option<Data<'t>>, ImportError> {
        while self.lines.get(self.at).is_some_and(|data| data.text.trim().is_empty()) {
            self.at += 1;
        }
        self.line()
    }

    /// The next line of a dataset; none at its end.
    fn line(&mut self) -> Result<Option<Data<'t>>, ImportError> {
        let Some(data) = self.lines.get(self.at) else {
            let place = self.lines.last().map(|data| data.place).unwrap_or(Place::FIRST);
            let help = "the file is cut off: write it anew";
            return Err(self.texts.refuse(place, "the file ends within a dataset, expected a line with -1", help));
        };
        self.at += 1;
        Ok((data.text.trim() != "-1").then_some(*data))
    }

    /// A line that a dataset must have.
    fn expected(&mut self, expected: &str) -> Result<Data<'t>, ImportError> {
        let before = self.lines[self.at.min(self.lines.len()) - 1];
        self.next()?.ok_or_else(|| self.refuse(before, &format!("{expected} after it")))
    }

    /// Whole numbers of a line, as many as these at the least.
    fn wholes(&self, data: Data<'_>, least: usize) -> Result<Vec<i64>, ImportError> {
        let words: Result<Vec<i64>, _> = data.text.split_whitespace().map(str::parse).collect();
        words
            .ok()
            .filter(|words| words.len() >= least)
            .ok_or_else(|| self.refuse(data, &format!("{least} whole numbers")))
    }

    /// Labels that go on over several lines.
    fn labels(&mut self, count: usize) -> Result<Vec<i64>, ImportError> {
        let mut labels = Vec::new();
        while labels.len() < count {
            let line = self.expected("whole numbers")?;
            labels.extend(self.wholes(line, 1)?);
        }
        Ok(labels)
    }

    /// Three coordinates.
    fn coordinates<'w>(&self, data: Data<'_>, words: impl Iterator<Item = &'w str>) -> Result<[f64; 3], ImportError> {
        let numbers: Option<Vec<f64>> = words.map(texts::number).collect();
        numbers.and_then(|numbers| numbers.try_into().ok()).ok_or_else(|| self.refuse(data, "three coordinates"))
    }

    fn label(&self, data: Data<'_>, number: i64) -> Result<u64, ImportError> {
        u64::try_from(number).map_err(|_| self.refuse(data, "a number above 0"))
    }

    fn refuse(&self, data: Data<'_>, expected: &str) -> ImportError {
        let found = format!("found {}, expected {expected}", self.texts.shown(data));
        self.texts.refuse(data.place, found, "check the file, or write it anew")
    }
}

impl File {
    fn take(&mut self, dataset: u64, lines: &mut Lines<'_>) -> Result<(), ImportError> {
        match dataset {
            15 | 781 | 2411 => {
                while let Some(head) = lines.next()? {
                    self.node(dataset, head, lines)?;
                }
            }
            71 | 780 | 2412 => {
                while let Some(head) = lines.next()? {
                    self.element(dataset, head, lines)?;
                }
            }
            _ => match numbers_of_member(dataset) {
                Some(width) => {
                    while let Some(head) = lines.next()? {
                        self.group(width, head, lines)?;
                    }
                }
                None => {
                    while lines.next()?.is_some() {}
                    if !SILENT.contains(&dataset) {
                        self.left.count(&format!("dataset {dataset}"));
                    }
                }
            },
        }
        Ok(())
    }

    fn node(&mut self, dataset: u64, head: Data<'_>, lines: &mut Lines<'_>) -> Result<(), ImportError> {
        let mut words = head.text.split_whitespace();
        let numbers: Option<Vec<i64>> = words.by_ref().take(4).map(|word| word.parse().ok()).collect();
        let Some([label, system, ..]) = numbers.as_deref().filter(|numbers| numbers.len() == 4) else {
            return Err(lines.refuse(head, "the four numbers of a node"));
        };
        let position = if dataset == 15 {
            if *system > 1 {
                let found = format!("node {label} in the coordinate system {system}");
                return Err(lines.texts.refuse(head.place, found, "write the nodes as dataset 2411"));
            }
            lines.coordinates(head, words)?
        } else {
            let line = lines.expected("three coordinates")?;
            lines.coordinates(line, line.text.split_whitespace())?
        };
        match self.nodes.insert(lines.label(head, *label)?, position) {
            Some(other) if other != position => {
                let found = format!("node {label} is there twice, at different places");
                Err(lines.texts.refuse(head.place, found, "number the nodes anew"))
            }
            _ => Ok(()),
        }
    }

    fn element(&mut self, dataset: u64, head: Data<'_>, lines: &mut Lines<'_>) -> Result<(), ImportError> {
        let of_count = if dataset == 780 { 7 } else { 5 };
        let numbers = lines.wholes(head, of_count + 1)?;
        let [label, descriptor, count] = [numbers[0], numbers[1], numbers[of_count]];
        let [label, descriptor, count] =
            [lines.label(head, label)?, lines.label(head, descriptor)?, lines.label(head, count)?];
        if is_beam(descriptor) {
            lines.expected("the orientation of a beam")?;
        }
        let count = count as usize;
        let labels = lines.labels(count)?;
        let nodes: Vec<u64> =
            labels.iter().take(count).map(|node| lines.label(head, *node)).collect::<Result<_, _>>()?;
        let kind = kind(descriptor);
        let nodes = match (kind, nodes.len()) {
            (Kind::Tetrahedron, 4) | (Kind::Triangle, 3) => nodes,
            (Kind::Tetrahedron, 10) => OF_TETRAHEDRON.iter().map(|place| nodes[*place]).collect(),
            (Kind::Triangle, 6) => [0, 2, 4].iter().map(|place| nodes[*place]).collect(),
            (Kind::Tetrahedron | Kind::Triangle, count) => {
                let found = format!("element {label} of kind {descriptor} has {count} nodes");
                return Err(lines.texts.refuse(head.place, found, "check the file, or write it anew"));
            }
            _ => Vec::new(),
        };
        if self.elements.insert(label, Element { place: head.place, kind, nodes }).is_some() {
            let found = format!("element {label} is there twice");
            return Err(lines.texts.refuse(head.place, found, "number the elements anew"));
        }
        Ok(())
    }

    fn group(&mut self, width: usize, head: Data<'_>, lines: &mut Lines<'_>) -> Result<(), ImportError> {
        let numbers = lines.wholes(head, 8)?;
        let count = lines.label(head, numbers[7])? as usize;
        let name = match lines.line()? {
            Some(name) => name.text,
            None => return Err(lines.refuse(head, "the name of a group after it")),
        };
        let name = name.replace('"', "'").split_whitespace().collect::<Vec<_>>().join(" ");
        let name = if name.is_empty() { format!("group_{}", numbers[0]) } else { name };
        let members = lines.labels(count.saturating_mul(width))?;
        let mut group = Group { name, nodes: Vec::new(), elements: Vec::new() };
        for member in members.chunks(width).take(count) {
            match member {
                [7, label, ..] => group.nodes.push(lines.label(head, *label)?),
                [8, label, ..] => group.elements.push(lines.label(head, *label)?),
                _ => self.left.count("members of groups that are neither nodes nor elements"),
            }
        }
        self.groups.push(group);
        Ok(())
    }

    fn imported(mut self, texts: &Texts<'_>, source: &Path, raise_order: bool) -> Result<Imported, ImportError> {
        let refused = |found: &str, help: &str| ImportError::Refused {
            source_name: source.display().to_string(),
            found: found.to_owned(),
            help: help.to_owned(),
        };
        if self.nodes.is_empty() {
            return Err(refused("it has no nodes", "check the file; its nodes are in a dataset 2411, 781 or 15"));
        }
        let rows: HashMap<u64, u32> = self.nodes.keys().copied().zip(0..).collect();
        let mut found = Tetrahedra {
            source: source.display().to_string(),
            node_tags: self.nodes.keys().copied().collect(),
            positions: self.nodes.values().copied().collect(),
            ..Tetrahedra::default()
        };
        let mut tetrahedron_of = HashMap::new();
        let mut triangle_of = HashMap::new();
        let (mut solids, mut first_solid) = (0, None);
        for (label, element) in &self.elements {
            let nodes = element.nodes.iter().map(|node| {
                rows.get(node).copied().ok_or_else(|| {
                    let found = format!("element {label} has node {node}, which is not there");
                    texts.refuse(element.place, found, "check the file, or write it anew")
                })
            });
            let nodes: Vec<u32> = nodes.collect::<Result<_, _>>()?;
            match (element.kind, &nodes[..]) {
                (Kind::Tetrahedron, _) => {
                    tetrahedron_of.insert(*label, found.elements.len() as u32);
                    found.elements.push(nodes);
                    found.element_tags.push(*label);
                }
                (Kind::Triangle, [a, b, c, ..]) => {
                    triangle_of.insert(*label, [*a, *b, *c]);
                }
                (Kind::Triangle, _) => {}
                (Kind::Solid, _) => {
                    solids += 1;
                    first_solid = first_solid.or(Some(element.place));
                }
                (Kind::Other(name), _) => self.left.count(name),
            }
        }
        if let Some(place) = first_solid {
            let found = format!("it has {solids} elements that fill a volume and are no tetrahedra");
            return Err(texts.refuse(place, found, "mesh with ten-node tetrahedra"));
        }
        let mut notes = Vec::new();
        let mut alone: HashMap<u64, [u32; 3]> = triangle_of.clone();
        for Group { name, nodes, elements } in self.groups {
            let tetrahedra: Vec<u32> = elements.iter().filter_map(|label| tetrahedron_of.get(label)).copied().collect();
            let triangles: Vec<[u32; 3]> =
                elements.iter().filter_map(|label| triangle_of.get(label)).copied().collect();
            let nodes: Vec<u32> = nodes.iter().filter_map(|label| rows.get(label)).copied().collect();
            elements.iter().for_each(|label| {
                alone.remove(label);
            });
            if tetrahedra.is_empty() && triangles.is_empty() && nodes.is_empty() {
                notes.push(format!("the group {name} has no tetrahedra, triangles or nodes"));
            }
            if !tetrahedra.is_empty() {
                found.groups.push((name.clone(), tetrahedra));
            }
            if !triangles.is_empty() {
                found.surfaces.push((name.clone(), triangles));
            }
            if !nodes.is_empty() {
                found.node_groups.push((name, nodes));
            }
        }
        alone.keys().for_each(|_| self.left.count("triangles in no group"));
        let count = found.elements.len();
        let (mesh, mut of_mesh) = found.mesh(raise_order)?;
        notes.append(&mut of_mesh);
        notes.extend(self.left.sentence(count));
        Ok(Imported { mesh, notes, materials: Vec::new(), beside: Beside::default() })
    }
}
