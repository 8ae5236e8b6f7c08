//! The deck: its keywords, one after the other, taken into the scopes that they stand in.

use crate::error::ImportError;
use crate::own::abaqus::keywords::{is_known, is_silent, makes_mesh};
use crate::own::abaqus::kinds::Kind;
use crate::own::abaqus::lines::{Block, number};
use crate::own::abaqus::materials::Material;
use crate::own::abaqus::scope::{
    Element, Instance, Mass, Node, Part, Reference, Referred, Scope, Section, Surface, Tie,
};
use crate::own::notes::Left;
use crate::own::systems::{Placement, cylindrical};
use crate::own::texts::{Data, Place, Texts};

const CHECK: &str = "check this line";

/// The deck as it is written.
#[derive(Default)]
pub(super) struct Deck {
    pub(super) parts: Vec<Part>,
    pub(super) instances: Vec<Instance>,
    /// The assembly, or all of a deck without parts.
    pub(super) root: Scope,
    pub(super) materials: Vec<Material>,
    /// Names of element types, in capital letters.
    pub(super) types: Vec<String>,
    /// Keywords that are not used.
    pub(super) left: Left,
    /// Number and first place of keywords that are not known.
    pub(super) unknown: Option<(usize, Place)>,
}

/// Where a block stands.
enum Within {
    Root,
    Part(usize),
    Instance(usize),
}

struct Reader<'t, 'f> {
    texts: &'t Texts<'f>,
    deck: Deck,
    within: Within,
    system: Placement,
}

impl Deck {
    pub(super) fn read(texts: &Texts<'_>, blocks: &[Block<'_>]) -> Result<Self, ImportError> {
        let mut reader = Reader { texts, deck: Self::default(), within: Within::Root, system: Placement::NONE };
        let mut blocks = blocks.iter().peekable();
        while let Some(block) = blocks.next() {
            // The kind of a coupling is the keyword after it.
            reader.block(block, blocks.peek().copied())?;
        }
        Ok(reader.deck)
    }
}

impl Reader<'_, '_> {
    fn block(&mut self, block: &Block<'_>, next: Option<&Block<'_>>) -> Result<(), ImportError> {
        match block.keyword.as_str() {
            "PART" => {
                let name = self.name(block, "NAME")?;
                self.deck.parts.push(Part { name, scope: Scope::default() });
                self.enter(Within::Part(self.deck.parts.len() - 1));
            }
            "INSTANCE" => self.instance(block)?,
            "END PART" | "END INSTANCE" | "ASSEMBLY" | "END ASSEMBLY" => self.enter(Within::Root),
            "SYSTEM" => self.system = self.system(block)?,
            "NODE" => self.nodes(block)?,
            "ELEMENT" => self.elements(block)?,
            "NSET" | "ELSET" => self.set(block)?,
            "SURFACE" => self.surface(block)?,
            "MATERIAL" => {
                let name = self.name(block, "NAME")?;
                self.deck.materials.push(Material::new(name));
            }
            "ELASTIC" | "DENSITY" => {
                let texts = self.texts;
                let Some(material) = self.deck.materials.last_mut() else {
                    return Err(texts.refuse(block.place, format!("*{} before any *MATERIAL", block.keyword), CHECK));
                };
                material.take(texts, block)?;
            }
            "SOLID SECTION" => self.section(block)?,
            "SHELL SECTION" | "MEMBRANE SECTION" | "SHELL GENERAL SECTION" | "SURFACE SECTION" => {
                self.section(block)?;
                self.count(block);
            }
            "MASS" if !block.has("TYPE") || block.is("TYPE", "ISOTROPIC") => self.mass(block)?,
            "RIGID BODY" => self.tie(block, "RIGID BODY", true)?,
            "COUPLING" => match next {
                Some(kind) if !ties_all(kind) => self.deck.left.count("*COUPLING in some directions only"),
                _ => {
                    let mean = next.filter(|kind| kind.keyword == "DISTRIBUTING");
                    let has_weights = mean
                        .is_some_and(|kind| kind.has("WEIGHTING METHOD") && !kind.is("WEIGHTING METHOD", "UNIFORM"));
                    if has_weights {
                        self.deck.left.count("WEIGHTING METHOD of *DISTRIBUTING (the nodes count alike)");
                    }
                    if block.has("INFLUENCE RADIUS") {
                        self.deck.left.count("INFLUENCE RADIUS of *COUPLING (the whole surface is tied)");
                    }
                    self.tie(block, "COUPLING", mean.is_none())?;
                }
            },
            // They say of what kind the coupling is before them.
            "KINEMATIC" | "DISTRIBUTING" => {}
            // Contact is none of the mesh.
            "MODEL CHANGE" if block.is("TYPE", "CONTACT PAIR") => self.count(block),
            keyword if makes_mesh(keyword) => {
                let found = format!("*{keyword}, which makes or moves nodes and elements and is not read");
                let help = "write the deck with all its nodes and elements, as preprocessors do";
                return Err(self.texts.refuse(block.place, found, help));
            }
            keyword if is_silent(keyword) => {}
            _ => self.count(block),
        }
        Ok(())
    }

    fn enter(&mut self, within: Within) {
        self.within = within;
        self.system = Placement::NONE;
    }

    fn scope(&mut self) -> &mut Scope {
        match self.within {
            Within::Root => &mut self.deck.root,
            Within::Part(part) => &mut self.deck.parts[part].scope,
            Within::Instance(instance) => &mut self.deck.instances[instance].own,
        }
    }

    fn count(&mut self, block: &Block<'_>) {
        if is_known(&block.keyword) {
            self.deck.left.count(&format!("*{}", block.keyword));
        } else {
            self.deck.unknown.get_or_insert((0, block.place)).0 += 1;
        }
    }

    fn name(&self, block: &Block<'_>, parameter: &str) -> Result<String, ImportError> {
        match block.parameter(parameter) {
            Some(name) if !name.is_empty() => Ok(name.to_owned()),
            _ => Err(self.texts.refuse(block.place, format!("*{} without {parameter}", block.keyword), CHECK)),
        }
    }

    fn bad(&self, block: &Block<'_>, data: Data<'_>, expected: &str) -> ImportError {
        let found = format!("in *{}, found {}, expected {expected}", block.keyword, self.texts.shown(data));
        self.texts.refuse(data.place, found, CHECK)
    }

    /// Numbers of a line; fields that are left out are nought.
    fn numbers(&self, block: &Block<'_>, data: Data<'_>, most: usize) -> Result<Vec<f64>, ImportError> {
        let words = data.words();
        let numbers: Option<Vec<f64>> = words.iter().map(|word| number(word)).collect();
        numbers
            .filter(|numbers| numbers.len() <= most)
            .ok_or_else(|| self.bad(block, data, &format!("{most} numbers or fewer")))
    }

    fn instance(&mut self, block: &Block<'_>) -> Result<(), ImportError> {
        let name = self.name(block, "NAME")?;
        let part = self.name(block, "PART")?;
        let found = self.deck.parts.iter().position(|known| known.name.eq_ignore_ascii_case(&part));
        let Some(part) = found else {
            let found = format!("*INSTANCE {name} of a part that is not there before it");
            return Err(self.texts.refuse(block.place, found, "write the part into the deck, before the assembly"));
        };
        let mut placement = Placement::NONE;
        for (line, data) in block.data.iter().enumerate() {
            let numbers = self.numbers(block, *data, if line == 0 { 3 } else { 7 })?;
            let at = |i: usize| numbers.get(i).copied().unwrap_or(0.0);
            placement = match line {
                0 => Placement::to([at(0), at(1), at(2)]),
                1 if at(6) == 0.0 => placement,
                1 => placement
                    .then_turned([at(0), at(1), at(2)], [at(3), at(4), at(5)], at(6))
                    .ok_or_else(|| self.bad(block, *data, "two different points on the axis, and an angle"))?,
                _ => return Err(self.bad(block, *data, "two lines at the most")),
            };
        }
        let own = Scope::default();
        self.deck.instances.push(Instance { name, part, placement, own, place: block.place });
        self.enter(Within::Instance(self.deck.instances.len() - 1));
        Ok(())
    }

    fn system(&self, block: &Block<'_>) -> Result<Placement, ImportError> {
        let [first, rest @ ..] = &block.data[..] else { return Ok(Placement::NONE) };
        let numbers = self.numbers(block, *first, 6)?;
        let at = |i: usize| numbers.get(i).copied().unwrap_or(0.0);
        let a = [at(0), at(1), at(2)];
        if numbers.len() <= 3 {
            return Ok(Placement::to(a));
        }
        let b = [at(3), at(4), at(5)];
        let c = match rest.first() {
            Some(line) => {
                let numbers = self.numbers(block, *line, 3)?;
                std::array::from_fn(|i| numbers.get(i).copied().unwrap_or(0.0))
            }
            // Without it the z axis is that of the deck.
            None if a[2] == b[2] => [a[0] - (b[1] - a[1]), a[1] + (b[0] - a[0]), a[2]],
            None => return Err(self.bad(block, *first, "a second line with a point in the xy plane of the system")),
        };
        Placement::system(a, b, c).ok_or_else(|| self.bad(block, *first, "three points that are not on a line"))
    }

    fn nodes(&mut self, block: &Block<'_>) -> Result<(), ImportError> {
        let to_rectangular: fn([f64; 3]) -> [f64; 3] = match block.parameter("SYSTEM").map(str::to_uppercase).as_deref()
        {
            None | Some("R") => |x| x,
            Some("C") => cylindrical,
            Some(_) => {
                let found = "*NODE in a SYSTEM that is not read";
                let help = "write the nodes in rectangular (R) or cylindrical (C) coordinates";
                return Err(self.texts.refuse(block.place, found, help));
            }
        };
        let set = block.parameter("NSET").map(str::to_owned);
        for data in &block.data {
            let mut fields = data.fields();
            let label = fields.next().and_then(|field| field.parse::<u64>().ok());
            // Three coordinates, and perhaps a normal after them.
            let coordinates: Option<Vec<f64>> = fields.take(3).map(number).collect();
            let (Some(label), Some(coordinates)) = (label, coordinates) else {
                return Err(self.bad(block, *data, "the number of a node and its coordinates"));
            };
            let given = std::array::from_fn(|i| coordinates.get(i).copied().unwrap_or(0.0));
            let position = self.system.of(to_rectangular(given));
            let place = data.place;
            let scope = self.scope();
            scope.nodes.push(Node { label, position, place });
            if let Some(set) = &set {
                let member = Reference { instance: None, of: Referred::Label(label) };
                scope.node_sets.named(set, false).members.push((member, place));
            }
        }
        Ok(())
    }

    fn elements(&mut self, block: &Block<'_>) -> Result<(), ImportError> {
        let name = self.name(block, "TYPE")?.to_uppercase();
        let kind = Kind::of(&name);
        // The name of a type that is not known may be any text.
        let is_name = name.len() <= 12 && name.bytes().all(|byte| byte.is_ascii_alphanumeric() || byte == b'_');
        let name = if is_name { name } else { "elements".to_owned() };
        let of_type = self.deck.types.iter().position(|known| *known == name).unwrap_or_else(|| {
            self.deck.types.push(name);
            self.deck.types.len() - 1
        });
        let set = block.parameter("ELSET").map(str::to_owned);
        let count = kind.nodes();
        // Some write a comma after each element.
        let ends_in_commas = block.data.last().is_some_and(|data| data.text.ends_with(','));
        let mut waiting: Vec<&str> = Vec::new();
        let mut first = block.place;
        for (line, data) in block.data.iter().enumerate() {
            if waiting.is_empty() {
                first = data.place;
            }
            waiting.extend(data.fields().filter(|word| !word.is_empty()));
            // Where the number of nodes is not known, a line that ends in a comma goes on.
            let is_whole = match count {
                Some(count) => waiting.len() > count,
                None => ends_in_commas || !data.text.ends_with(','),
            };
            if !is_whole {
                if line + 1 == block.data.len() {
                    return Err(self.bad(block, Data { place: first, ..*data }, "all nodes of the element"));
                }
                continue;
            }
            let mut instance = None;
            let mut numbers = Vec::with_capacity(waiting.len());
            for word in std::mem::take(&mut waiting) {
                let (of, label) = word.rsplit_once('.').map_or((None, word), |(of, label)| (Some(of), label));
                instance = instance.or(of.map(str::to_uppercase));
                let Ok(label) = label.parse::<u64>() else {
                    return Err(self.bad(block, *data, "the number of an element and those of its nodes"));
                };
                numbers.push(label);
            }
            if count.is_some_and(|count| numbers.len() > count + 1) {
                return Err(self.bad(block, *data, "as many nodes as the type of the element has"));
            }
            let label = numbers.remove(0);
            let scope = self.scope();
            scope.elements.push(Element { label, of_type, kind, instance, nodes: numbers, place: first });
            if let Some(set) = &set {
                let member = Reference { instance: None, of: Referred::Label(label) };
                scope.element_sets.named(set, false).members.push((member, first));
            }
        }
        Ok(())
    }

    fn set(&mut self, block: &Block<'_>) -> Result<(), ImportError> {
        let name = self.name(block, &block.keyword)?;
        let is_of_nodes = block.keyword == "NSET";
        let instance = block.parameter("INSTANCE").map(str::to_uppercase);
        let mut members = Vec::new();
        if is_of_nodes && let Some(of) = block.parameter("ELSET") {
            members.push((
                Reference { instance: instance.clone(), of: Referred::NodesOf(of.to_uppercase()) },
                block.place,
            ));
        }
        for data in &block.data {
            if block.has("GENERATE") {
                let numbers: Option<Vec<u64>> = data.words().iter().map(|word| word.parse().ok()).collect();
                let range = match numbers.as_deref() {
                    Some(&[one]) => (one, one, 1),
                    Some(&[first, last]) => (first, last, 1),
                    Some(&[first, last, step]) if step > 0 => (first, last, step),
                    _ => return Err(self.bad(block, *data, "the first, the last and a step")),
                };
                let of = Referred::Range(range.0, range.1, range.2);
                members.push((Reference { instance: instance.clone(), of }, data.place));
                continue;
            }
            for word in data.fields().filter(|word| !word.is_empty()) {
                members.push((referred(word, instance.as_deref()), data.place));
            }
        }
        let internal = block.has("INTERNAL");
        let scope = self.scope();
        let sets = if is_of_nodes { &mut scope.node_sets } else { &mut scope.element_sets };
        sets.named(&name, internal).members.extend(members);
        Ok(())
    }

    fn surface(&mut self, block: &Block<'_>) -> Result<(), ImportError> {
        let name = self.name(block, "NAME")?;
        let of_nodes = block.is("TYPE", "NODE");
        if (block.has("TYPE") && !of_nodes && !block.is("TYPE", "ELEMENT")) || block.has("COMBINE") || block.has("CROP")
        {
            self.deck.left.count("*SURFACE of other kinds");
            return Ok(());
        }
        let mut faces = Vec::new();
        for data in &block.data {
            let words: Vec<&str> = data.fields().collect();
            let face = words.get(1).map(|face| face.to_uppercase()).unwrap_or_default();
            let is_face = of_nodes || face.bytes().all(|byte| byte.is_ascii_alphanumeric());
            if words[0].is_empty() || !is_face {
                return Err(self.bad(block, *data, "a set or an element, and its face"));
            }
            faces.push((referred(words[0], None), face, data.place));
        }
        self.scope().surfaces.push(Surface { name, of_nodes, faces });
        Ok(())
    }

    fn section(&mut self, block: &Block<'_>) -> Result<(), ImportError> {
        let set = block.parameter("ELSET").unwrap_or_default().to_owned();
        let material = block.parameter("MATERIAL").unwrap_or_default().to_owned();
        let is_solid = block.keyword == "SOLID SECTION";
        let layers = match &*block.keyword {
            "SHELL SECTION" | "MEMBRANE SECTION" if !block.has("NODAL THICKNESS") => layers(block, &material),
            _ => None,
        };
        self.scope().sections.push(Section { is_solid, set, material, layers });
        Ok(())
    }

    fn mass(&mut self, block: &Block<'_>) -> Result<(), ImportError> {
        let set = self.name(block, "ELSET")?;
        let first =
            block.data.first().ok_or_else(|| self.texts.refuse(block.place, "*MASS without its number", CHECK))?;
        let mass = first.words().first().and_then(|word| number(word)).filter(|mass| *mass >= 0.0);
        let mass = mass.ok_or_else(|| self.bad(block, *first, "a mass"))?;
        self.scope().masses.push(Mass { set, mass });
        Ok(())
    }

    fn tie(&mut self, block: &Block<'_>, keyword: &'static str, is_rigid: bool) -> Result<(), ImportError> {
        let region = ["SURFACE", "NSET", "TIE NSET", "PIN NSET", "ELSET"].iter().find_map(|key| block.parameter(key));
        let region = region.unwrap_or_default().to_owned();
        let point = block.parameter("REF NODE").unwrap_or_default().to_owned();
        let place = block.place;
        self.scope().ties.push(Tie { keyword, is_rigid, region, point, place });
        Ok(())
    }
}

/// Materials and thicknesses of the layers of a shell.
fn layers(block: &Block<'_>, material: &str) -> Option<Vec<(String, f64)>> {
    if !block.has("COMPOSITE") {
        let thickness = number(block.data.first()?.words().first()?)?;
        return Some(vec![(material.to_owned(), thickness)]);
    }
    // A thickness, a number of points of integration, a material and an angle in each line.
    let layer = |data: &Data<'_>| {
        let words: Vec<&str> = data.fields().collect();
        Some(((*words.get(2)?).trim_matches('"').to_owned(), number(words.first()?)?))
    };
    let mut layers = block.data.iter().map(layer).collect::<Option<Vec<_>>>()?;
    if block.has("SYMMETRIC") {
        layers.extend(layers.clone());
    }
    Some(layers)
}

/// True if a coupling of this kind ties the three displacements: all, or those from one to another in each line.
fn ties_all(kind: &Block<'_>) -> bool {
    let is_kind = matches!(kind.keyword.as_str(), "KINEMATIC" | "DISTRIBUTING");
    let ranges: Vec<(u64, u64)> = (kind.data.iter().filter(|_| is_kind))
        .filter_map(|data| {
            let numbers: Vec<u64> = data.words().iter().filter_map(|word| word.parse().ok()).collect();
            Some((*numbers.first()?, *numbers.last()?))
        })
        .collect();
    ranges.is_empty() || (1..=3).all(|dof| ranges.iter().any(|(first, last)| (*first..=*last).contains(&dof)))
}

/// A number or a set, perhaps of an instance.
pub(super) fn referred(word: &str, instance: Option<&str>) -> Reference {
    let word = word.trim_matches('"');
    let (of, rest) = word.split_once('.').map_or((None, word), |(of, rest)| (Some(of), rest));
    match (rest.parse(), of) {
        (Ok(label), of) => Reference { instance: of.or(instance).map(str::to_uppercase), of: Referred::Label(label) },
        (Err(_), of) => {
            Reference { instance: of.or(instance).map(str::to_uppercase), of: Referred::Set(rest.to_uppercase()) }
        }
    }
}
