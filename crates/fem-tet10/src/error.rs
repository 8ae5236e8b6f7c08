//! Errors of a mesh or a model, with the file, the tag and help.

use std::fmt;

use diagnostic::{Diagnosis, Diagnostic, Kind};

/// Where in a mesh file something was found.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum FilePosition {
    /// A line of the text, counted from 1.
    Line(usize),
    /// An offset in bytes: the binary parts of a file have no lines.
    Byte(usize),
}

impl fmt::Display for FilePosition {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Line(line) => write!(f, "line {line}"),
            Self::Byte(offset) => write!(f, "byte {offset}"),
        }
    }
}

/// A mesh that cannot be read or used.
#[derive(Debug, thiserror::Error)]
#[error("{mesh}{}: {fault}", place.map_or_else(String::new, |place| format!(", {place}")))]
pub struct MeshError {
    /// The path of its file, or what the caller named it.
    pub mesh: String,
    /// The place in the file, where the fault is in one.
    pub place: Option<FilePosition>,
    /// The fault.
    #[source]
    pub fault: MeshFault,
}

impl MeshError {
    /// Line in its file, from 1, where the fault is in one.
    pub fn line(&self) -> Option<usize> {
        match self.place? {
            FilePosition::Line(line) => Some(line),
            FilePosition::Byte(_) => None,
        }
    }
}

impl MeshFault {
    /// The error of a mesh.
    pub fn of(self, mesh: impl Into<String>) -> MeshError {
        MeshError { mesh: mesh.into(), place: None, fault: self }
    }

    /// The error at a place of its file.
    pub(crate) fn at(self, mesh: impl Into<String>, place: FilePosition) -> MeshError {
        MeshError { place: Some(place), ..self.of(mesh) }
    }
}

/// A fault of a mesh.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
#[allow(missing_docs)] // the message of a variant says what its fields are
pub enum MeshFault {
    /// Not enough memory.
    #[error("{0}")]
    Memory(#[from] memory::OutOfMemory),
    /// The file cannot be read.
    #[error("cannot read the mesh: {0}")]
    Io(#[source] std::io::Error),
    /// The file is not a MSH file of version 4.1.
    #[error(
        "not a MSH 4.1 file: found {found}; write it with `gmsh OLD.msh -save -format msh41 -o NEW.msh`, or mesh again with `gmsh -3 -order 2 -format msh41`"
    )]
    Version { found: String },
    /// The text or bytes do not follow the format. `section`: such as `$Nodes`.
    #[error("in {section}: expected {expected}, found {found}")]
    Syntax { section: String, expected: String, found: String },
    /// The head of a section says that its blocks hold more or fewer than they do.
    #[error(
        "in {section}: found the number {claimed} for all {what}, expected {found}, as the blocks hold; the file has been edited or damaged: save the mesh again from gmsh"
    )]
    Total { section: String, what: &'static str, claimed: u64, found: usize },
    /// A required section is not there.
    #[error("there is no {section} section; mesh the volume and save it with `gmsh -3 -order 2 -format msh41`")]
    MissingSection { section: &'static str },
    /// Volume elements of another kind than tet10. `element`: the first such.
    #[error("element {element} is {found}, not a ten-node tetrahedron; {help}")]
    ElementType { element: u64, found: String, help: &'static str },
    /// The file has no volume elements.
    #[error(
        "there are no tetrahedra; mesh the volume with `gmsh -3 -order 2`, and put the volume into a physical group if there are any"
    )]
    NoElements,
    /// An element refers to a node that is not there.
    #[error("element {element} uses node {node}, which is not in the mesh; save the mesh again with all its nodes")]
    UnknownNode { element: u64, node: u64 },
    /// A tag is given twice. `kind`: "node" or "element".
    #[error("{kind} tag {tag} is given twice; renumber the mesh (gmsh: `RenumberMeshNodes; RenumberMeshElements;`)")]
    DuplicateTag { kind: &'static str, tag: u64 },
    /// Two elements have the same four corners.
    #[error(
        "elements {first} and {second} are the same tetrahedron, whose stiffness and mass would count twice; remove one of them (gmsh: `gmsh.model.mesh.removeDuplicateElements()`), or mesh the volume once"
    )]
    SameElement { first: u64, second: u64 },
    /// A coordinate is not a finite number.
    #[error("node {node} is at {position:?}; every coordinate must be a finite number")]
    NotFinite { node: u64, position: [f64; 3] },
    /// Groups overlap so much that their lists would be far longer than the file. `kind`: "point", "curve" or
    /// "surface"; `entity`: the one that is in most of them.
    #[error(
        "the {kind} entity {entity} is in {groups} physical groups, and the lists of all groups together would be many times as long as the file; put each entity into a few groups"
    )]
    TooManyGroups { kind: &'static str, entity: i32, groups: usize },
    /// Two groups of one kind would go by one name: the number of one that has no name is the name of the other.
    /// `kind`: "point", "curve", "surface" or "volume".
    #[error(
        "physical {kind} {name} has no name and would go by its number, but another one is named \"{name}\"; name the first (gmsh: `Physical ...(\"...\", {name})`), or rename the other"
    )]
    AmbiguousGroup { kind: &'static str, name: String },
    /// An element is in a region that is not in the list, in a mesh given by a program.
    #[error(
        "element {element} is in region number {region} (counted from 0), but there are {count} regions; list the region, with its groups"
    )]
    UnknownRegion { element: u64, region: usize, count: usize },
    /// A region is in a group that is not in the list, in a mesh given by a program.
    #[error(
        "region number {region} is in group number {group} (both counted from 0), but there are {count} groups; give the group's name"
    )]
    UnknownGroup { region: usize, group: usize, count: usize },
    /// An element of a physical surface that is not a face of the body.
    #[error(
        "element {element} of the physical surface \"{group}\" is not a face of a tetrahedron of the body; take surfaces of the meshed volume into the group, and mesh both at once with -order 2"
    )]
    NotAFace { group: String, element: u64 },
    /// A pressure on a face inside the body.
    #[error(
        "element {element} of the physical surface \"{group}\" lies between two tetrahedra, where neither side is the outside, so that a pressure has no direction; take faces of the body's boundary only"
    )]
    InnerFace { group: String, element: u64 },
    /// A physical group of points or curves has a node that is not there. `kind`: "point" or "curve".
    #[error(
        "the physical {kind} \"{group}\" uses node {node}, which is not in the mesh; save the mesh again with all its nodes"
    )]
    UnknownGroupNode { kind: &'static str, group: String, node: u64 },
    /// A name that no physical group has. `kind`: "surface", or "group" where any dimension would do; `present`: the
    /// names there are.
    #[error(
        "there is no physical {kind} named \"{group}\"; the mesh has {present:?}; use one of these, or name it in the geometry and mesh again"
    )]
    NoGroup { kind: &'static str, group: String, present: Vec<String> },
    /// A name that physical groups of several dimensions have. `kinds`: of "point", "curve", "surface" and "volume".
    #[error(
        "\"{group}\" is the name of several physical groups, {kinds:?}; give each its own name in the geometry, and mesh again"
    )]
    SeveralGroups { group: String, kinds: Vec<&'static str> },
    /// An element is turned inside out, or has no volume. `jacobian`: the smallest over nodes and integration points;
    /// `expected`: that of a regular tetrahedron with the same longest edge.
    #[error(
        "element {element} is {what}: its Jacobian determinant falls to {jacobian:.3e} (a good element of its size has about {expected:.3e}); improve the mesh there (gmsh: -optimize_ho, a smaller size, or straight edges with Mesh.SecondOrderLinear = 1)"
    )]
    Jacobian { element: u64, what: &'static str, jacobian: f64, expected: f64 },
    /// Nodes that belong to no tetrahedron. `tags`: of the first few.
    #[error(
        "{count} node(s) belong to no tetrahedron, the first of them {tags:?}; remove the points from the geometry, or save the volume alone (gmsh: a physical volume, and Mesh.SaveAll = 0)"
    )]
    OrphanNodes { count: usize, tags: Vec<u64> },
    /// The body is in several pieces. `sizes`: elements in each, the largest first; `examples`: an element of each.
    #[error("the mesh falls into {} pieces that share no node, of {} elements, one with element {} each; join them (gmsh: `Coherence;` or BooleanFragments before meshing) or mesh one body", sizes.len(), first_few(sizes), first_few(examples))]
    Pieces { sizes: Vec<usize>, examples: Vec<u64> },
    /// Parts of a mesh that do not fit together, given by a program instead of a file.
    #[error("expected {expected} {what}, found {found}")]
    Lengths { what: &'static str, expected: usize, found: usize },
}

/// The beginning of a list, for a message.
fn first_few<T: std::fmt::Debug>(list: &[T]) -> String {
    const FEW: usize = 10;
    match list.get(..FEW) {
        Some(few) if list.len() > FEW => format!("{few:?} and {} more", list.len() - FEW),
        _ => format!("{list:?}"),
    }
}

/// A model that cannot be assembled.
#[derive(Debug, thiserror::Error)]
#[error("{}{fault}", mesh.as_ref().map_or_else(String::new, |mesh| format!("{mesh}: ")))]
pub struct AssemblyError {
    /// The mesh, where the fault is in one: its file, or what the caller named it.
    pub mesh: Option<String>,
    /// The fault.
    #[source]
    pub fault: AssemblyFault,
}

impl AssemblyFault {
    /// The error of a mesh.
    pub(crate) fn of(self, mesh: impl Into<String>) -> AssemblyError {
        AssemblyError { mesh: Some(mesh.into()), fault: self }
    }
}

impl From<AssemblyFault> for AssemblyError {
    fn from(fault: AssemblyFault) -> Self {
        Self { mesh: None, fault }
    }
}

impl From<memory::OutOfMemory> for AssemblyError {
    fn from(error: memory::OutOfMemory) -> Self {
        AssemblyFault::Memory(error).into()
    }
}

/// A fault of a model.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
#[allow(missing_docs)] // the message of a variant says what its fields are
pub enum AssemblyFault {
    /// Not enough memory.
    #[error("{0}")]
    Memory(#[from] memory::OutOfMemory),
    /// A material constant outside its range. `group`: or "the whole mesh".
    #[error("material of {group}: {quantity} is {found}; expected {expected}")]
    MaterialConstant { group: String, quantity: &'static str, found: f64, expected: &'static str },
    /// A material names a physical group that the mesh does not have.
    #[error("there is no physical volume named \"{group}\"; the mesh has {present:?}")]
    MissingGroup { group: String, present: Vec<String> },
    /// An element that no material covers.
    #[error("element {element} has no material: {}", match groups.as_slice() {
        [] => "it is in no named physical volume; name one in the geometry, or use one material for the whole mesh".to_owned(),
        [name] => format!("give one to its physical group \"{name}\""),
        several => format!("give one to one of its physical groups {several:?}"),
    })]
    NoMaterial { element: u64, groups: Vec<String> },
    /// An element that two groups give different materials.
    #[error(
        "element {element} is in both physical volumes {groups:?}, which are given different materials; give both the same one, leave one of them out, or make physical volumes that do not overlap"
    )]
    TwoMaterials { element: u64, groups: [String; 2] },
    /// A point mass that is not a positive number.
    #[error("the point mass at {at:?} is {found}; expected a positive number")]
    PointMass { at: [f64; 3], found: f64 },
    /// A radius to spread a point mass over that is not a positive number.
    #[error(
        "the spread of the point mass at {at:?} is {found}; expected a positive radius (leave it out to put the mass on the point itself)"
    )]
    SpreadRadius { at: [f64; 3], found: f64 },
    /// A point that lies outside the body, by more than [`Mesh::locate`](crate::Mesh::locate) allows.
    #[error(
        "the point {at:?} is not on the body: the nearest node is {node} at {position:?}, {distance:.6} away; use a point of the body"
    )]
    OffBody { at: [f64; 3], node: u64, position: [f64; 3], distance: f64 },
    /// Too few nodes near a point to carry what is spread over them.
    #[error(
        "the {count} node(s) within {radius} of {at:?} cannot carry a mass spread about that point (the nearest node is {distance:.6} away); use a larger spread"
    )]
    Spread { at: [f64; 3], radius: f64, count: usize, distance: f64 },
    /// More nodes near a point than can carry a spread mass: they would fill the matrices.
    #[error(
        "{count} nodes lie within {radius} of {at:?}, but a point mass is spread over {limit} at most, as each of them is coupled to all the others; use a smaller spread"
    )]
    SpreadTooWide { at: [f64; 3], radius: f64, count: usize, limit: usize },
    /// A radius to take a mean rotation over that is not a positive number.
    #[error("the radius of the patch at {at:?} is {found}; expected a positive number")]
    PatchRadius { at: [f64; 3], found: f64 },
    /// Too few nodes near a point to have a rotation, or all of them on a line.
    #[error(
        "the {count} node(s) within {radius} of {at:?} have no mean rotation, for which three are needed that are not on a line (the nearest node is {distance:.6} away); use a larger radius"
    )]
    Patch { at: [f64; 3], radius: f64, count: usize, distance: f64 },
    /// A matrix of displacement fields whose rows are not the degrees of freedom of the mesh. `expected`: three times
    /// the number of nodes.
    #[error("the {what} have {found} rows; expected {expected}, three for each node of the mesh")]
    FieldRows { what: &'static str, expected: usize, found: usize },
    /// A displacement that is not a number. `row`: 3·node + axis, from 0.
    #[error("the {what} have {found} in row {row}, column {column}; every displacement must be a finite number")]
    FieldNotFinite { what: &'static str, row: usize, column: usize, found: f64 },
}

impl Diagnostic for MeshError {
    fn diagnosis(&self) -> Diagnosis {
        let known = match &self.fault {
            MeshFault::Memory(_) | MeshFault::Io(_) => Kind::Io.alone(),
            MeshFault::Syntax { expected, found, .. } => {
                Kind::Input.alone().found(found.clone()).expected(expected.clone())
            }
            _ => Kind::Input.alone(),
        };
        Diagnosis { line: self.line(), ..known.in_file(&self.mesh) }
    }
}

impl Diagnostic for AssemblyError {
    fn diagnosis(&self) -> Diagnosis {
        let kind = if matches!(self.fault, AssemblyFault::Memory(_)) { Kind::Io } else { Kind::Input };
        self.mesh.as_ref().map_or_else(|| kind.alone(), |mesh| kind.of(mesh))
    }
}
