//! Errors of a mesh or a model, with the file, the tag and help.

use std::fmt;

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

/// A mesh that cannot be read or used. `source_name` is the file's path (or what the caller named the mesh).
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum MeshError {
    /// Not enough memory.
    #[error("{source_name}: {source}")]
    Memory {
        /// The mesh.
        source_name: String,
        /// How much is wanted, and what is left.
        source: memory::OutOfMemory,
    },
    /// The file cannot be read.
    #[error("{source_name}: cannot read the mesh: {source}")]
    Io {
        /// The mesh.
        source_name: String,
        /// The reason.
        source: std::io::Error,
    },
    /// The file is not a MSH file of version 4.1.
    #[error(
        "{source_name}: not a MSH 4.1 file: found {found}; write it with `gmsh OLD.msh -save -format msh41 -o NEW.msh`, or mesh again with `gmsh -3 -order 2 -format msh41`"
    )]
    Version {
        /// The mesh.
        source_name: String,
        /// The version, or that there is none.
        found: String,
    },
    /// The text or bytes do not follow the format.
    #[error("{source_name}, {place}: in {section}: expected {expected}, found {found}")]
    Syntax {
        /// The mesh.
        source_name: String,
        /// Line or byte.
        place: FilePosition,
        /// The section of the file, such as `$Nodes`.
        section: String,
        /// The text or number that the format asks for.
        expected: String,
        /// The text or number that stands there.
        found: String,
    },
    /// The head of a section says that its blocks hold more or fewer than they do.
    #[error(
        "{source_name}, {place}: in {section}: found the number {claimed} for all {what}, expected {found}, as the blocks hold; the file has been edited or damaged: save the mesh again from gmsh"
    )]
    Total {
        /// The mesh.
        source_name: String,
        /// Line or byte.
        place: FilePosition,
        /// `$Nodes` or `$Elements`.
        section: String,
        /// "nodes" or "elements".
        what: &'static str,
        /// The number in the head.
        claimed: u64,
        /// The number in the blocks.
        found: usize,
    },
    /// A required section is not there.
    #[error(
        "{source_name}: there is no {section} section; mesh the volume and save it with `gmsh -3 -order 2 -format msh41`"
    )]
    MissingSection {
        /// The mesh.
        source_name: String,
        /// Name of the section.
        section: &'static str,
    },
    /// Volume elements of another kind than tet10.
    #[error("{source_name}: element {element} is {found}, not a ten-node tetrahedron; {help}")]
    ElementType {
        /// The mesh.
        source_name: String,
        /// Tag of the first such element.
        element: u64,
        /// Its kind.
        found: String,
        /// Help for the user.
        help: &'static str,
    },
    /// The file has no volume elements.
    #[error(
        "{source_name}: there are no tetrahedra; mesh the volume with `gmsh -3 -order 2`, and put the volume into a physical group if there are any"
    )]
    NoElements {
        /// The mesh.
        source_name: String,
    },
    /// An element refers to a node that is not there.
    #[error(
        "{source_name}: element {element} uses node {node}, which is not in the mesh; save the mesh again with all its nodes"
    )]
    UnknownNode {
        /// The mesh.
        source_name: String,
        /// Tag of the element.
        element: u64,
        /// Tag of the node.
        node: u64,
    },
    /// A tag is given twice.
    #[error(
        "{source_name}: {kind} tag {tag} is given twice; renumber the mesh (gmsh: `RenumberMeshNodes; RenumberMeshElements;`)"
    )]
    DuplicateTag {
        /// The mesh.
        source_name: String,
        /// "node" or "element".
        kind: &'static str,
        /// The tag.
        tag: u64,
    },
    /// Two elements have the same four corners.
    #[error(
        "{source_name}: elements {first} and {second} are the same tetrahedron, whose stiffness and mass would count twice; remove one of them (gmsh: `gmsh.model.mesh.removeDuplicateElements()`), or mesh the volume once"
    )]
    SameElement {
        /// The mesh.
        source_name: String,
        /// Tag of the one that comes first.
        first: u64,
        /// Tag of the other.
        second: u64,
    },
    /// A coordinate is not a finite number.
    #[error("{source_name}: node {node} is at {position:?}; every coordinate must be a finite number")]
    NotFinite {
        /// The mesh.
        source_name: String,
        /// Tag of the node.
        node: u64,
        /// Its position.
        position: [f64; 3],
    },
    /// Groups overlap so much that their lists would be far longer than the file.
    #[error(
        "{source_name}: the {kind} entity {entity} is in {groups} physical groups, and the lists of all groups together would be many times as long as the file; put each entity into a few groups"
    )]
    TooManyGroups {
        /// The mesh.
        source_name: String,
        /// "point", "curve" or "surface".
        kind: &'static str,
        /// Tag of the entity that is in most of them.
        entity: i32,
        /// How many it is in.
        groups: usize,
    },
    /// Two groups of one kind would go by one name: the number of one that has no name is the name of the other.
    #[error(
        "{source_name}: physical {kind} {name} has no name and would go by its number, but another one is named \"{name}\"; name the first (gmsh: `Physical ...(\"...\", {name})`), or rename the other"
    )]
    AmbiguousGroup {
        /// The mesh.
        source_name: String,
        /// "point", "curve", "surface" or "volume".
        kind: &'static str,
        /// Number of the one, name of the other.
        name: String,
    },
    /// An element is in a region that is not in the list, in a mesh given by a program.
    #[error(
        "{source_name}: element {element} is in region number {region} (counted from 0), but there are {count} regions; list the region, with its groups"
    )]
    UnknownRegion {
        /// The mesh.
        source_name: String,
        /// Tag of the element.
        element: u64,
        /// The index that is too large.
        region: usize,
        /// Length of the list of regions.
        count: usize,
    },
    /// A region is in a group that is not in the list, in a mesh given by a program.
    #[error(
        "{source_name}: region number {region} is in group number {group} (both counted from 0), but there are {count} groups; give the group's name"
    )]
    UnknownGroup {
        /// The mesh.
        source_name: String,
        /// Index of the region.
        region: usize,
        /// The index that is too large.
        group: usize,
        /// Length of the list of groups.
        count: usize,
    },
    /// An element of a physical surface that is not a face of the body.
    #[error(
        "{source_name}: element {element} of the physical surface \"{group}\" is not a face of a tetrahedron of the body; take surfaces of the meshed volume into the group, and mesh both at once with -order 2"
    )]
    NotAFace {
        /// The mesh.
        source_name: String,
        /// Name of the physical surface.
        group: String,
        /// Tag of the element.
        element: u64,
    },
    /// A pressure on a face inside the body.
    #[error(
        "{source_name}: element {element} of the physical surface \"{group}\" lies between two tetrahedra, where neither side is the outside, so that a pressure has no direction; take faces of the body's boundary only"
    )]
    InnerFace {
        /// The mesh.
        source_name: String,
        /// Name of the physical surface.
        group: String,
        /// Tag of the element.
        element: u64,
    },
    /// A physical group of points or curves has a node that is not there.
    #[error(
        "{source_name}: the physical {kind} \"{group}\" uses node {node}, which is not in the mesh; save the mesh again with all its nodes"
    )]
    UnknownGroupNode {
        /// The mesh.
        source_name: String,
        /// "point" or "curve".
        kind: &'static str,
        /// Name of the group.
        group: String,
        /// Tag of the node.
        node: u64,
    },
    /// A name that no physical group has.
    #[error(
        "{source_name}: there is no physical {kind} named \"{group}\"; the mesh has {present:?}; use one of these, or name it in the geometry and mesh again"
    )]
    NoGroup {
        /// The mesh.
        source_name: String,
        /// "surface", or "group" where any dimension would do.
        kind: &'static str,
        /// The name looked for.
        group: String,
        /// The names there are.
        present: Vec<String>,
    },
    /// A name that physical groups of several dimensions have.
    #[error(
        "{source_name}: \"{group}\" is the name of several physical groups, {kinds:?}; give each its own name in the geometry, and mesh again"
    )]
    SeveralGroups {
        /// The mesh.
        source_name: String,
        /// The name.
        group: String,
        /// The kinds of entities that have it: "point", "curve", "surface", "volume".
        kinds: Vec<&'static str>,
    },
    /// An element is turned inside out, or has no volume.
    #[error(
        "{source_name}: element {element} is {what}: its Jacobian determinant falls to {jacobian:.3e} (a good element of its size has about {expected:.3e}); improve the mesh there (gmsh: -optimize_ho, a smaller size, or straight edges with Mesh.SecondOrderLinear = 1)"
    )]
    Jacobian {
        /// The mesh.
        source_name: String,
        /// Tag of the element.
        element: u64,
        /// "inverted" or "degenerate".
        what: &'static str,
        /// Smallest determinant of the Jacobian over nodes and integration points.
        jacobian: f64,
        /// The determinant of a regular tetrahedron with the same longest edge.
        expected: f64,
    },
    /// Nodes that belong to no tetrahedron.
    #[error(
        "{source_name}: {count} node(s) belong to no tetrahedron, the first of them {tags:?}; remove the points from the geometry, or save the volume alone (gmsh: a physical volume, and Mesh.SaveAll = 0)"
    )]
    OrphanNodes {
        /// The mesh.
        source_name: String,
        /// How many.
        count: usize,
        /// Tags of the first few.
        tags: Vec<u64>,
    },
    /// The body is in several pieces.
    #[error("{source_name}: the mesh falls into {} pieces that share no node, of {} elements, one with element {} each; join them (gmsh: `Coherence;` or BooleanFragments before meshing) or mesh one body", sizes.len(), first_few(sizes), first_few(examples))]
    Pieces {
        /// The mesh.
        source_name: String,
        /// Elements in each piece, largest first.
        sizes: Vec<usize>,
        /// Tag of an element of each piece.
        examples: Vec<u64>,
    },
    /// Parts of a mesh that do not fit together, given by a program instead of a file.
    #[error("{source_name}: expected {expected} {what}, found {found}")]
    Lengths {
        /// The mesh.
        source_name: String,
        /// Which array.
        what: &'static str,
        /// Its length should be.
        expected: usize,
        /// Its length is.
        found: usize,
    },
}

impl MeshError {
    /// The mesh: its file, or what the caller named it.
    pub fn source_name(&self) -> &str {
        match self {
            Self::Io { source_name, .. }
            | Self::Memory { source_name, .. }
            | Self::Version { source_name, .. }
            | Self::Syntax { source_name, .. }
            | Self::Total { source_name, .. }
            | Self::MissingSection { source_name, .. }
            | Self::ElementType { source_name, .. }
            | Self::NoElements { source_name, .. }
            | Self::UnknownNode { source_name, .. }
            | Self::DuplicateTag { source_name, .. }
            | Self::SameElement { source_name, .. }
            | Self::NotFinite { source_name, .. }
            | Self::TooManyGroups { source_name, .. }
            | Self::AmbiguousGroup { source_name, .. }
            | Self::UnknownRegion { source_name, .. }
            | Self::UnknownGroup { source_name, .. }
            | Self::NotAFace { source_name, .. }
            | Self::InnerFace { source_name, .. }
            | Self::UnknownGroupNode { source_name, .. }
            | Self::NoGroup { source_name, .. }
            | Self::SeveralGroups { source_name, .. }
            | Self::Jacobian { source_name, .. }
            | Self::OrphanNodes { source_name, .. }
            | Self::Pieces { source_name, .. }
            | Self::Lengths { source_name, .. } => source_name,
        }
    }

    /// Line in its file, from 1, where the fault is in one.
    pub fn line(&self) -> Option<usize> {
        match self {
            Self::Syntax { place: FilePosition::Line(line), .. }
            | Self::Total { place: FilePosition::Line(line), .. } => Some(*line),
            _ => None,
        }
    }
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
#[non_exhaustive]
pub enum AssemblyError {
    /// Not enough memory.
    #[error(transparent)]
    Memory(#[from] memory::OutOfMemory),
    /// A material constant outside its range.
    #[error("material of {group}: {quantity} is {found}; expected {expected}")]
    MaterialConstant {
        /// The physical group, or "the whole mesh".
        group: String,
        /// Which constant.
        quantity: &'static str,
        /// Its value.
        found: f64,
        /// Its range.
        expected: &'static str,
    },
    /// A material names a physical group that the mesh does not have.
    #[error("{source_name}: there is no physical volume named \"{group}\"; the mesh has {present:?}")]
    MissingGroup {
        /// The mesh.
        source_name: String,
        /// The name looked for.
        group: String,
        /// The names there are.
        present: Vec<String>,
    },
    /// An element that no material covers.
    #[error("{source_name}: element {element} has no material: {}", match groups.as_slice() {
        [] => "it is in no named physical volume; name one in the geometry, or use one material for the whole mesh".to_owned(),
        [name] => format!("give one to its physical group \"{name}\""),
        several => format!("give one to one of its physical groups {several:?}"),
    })]
    NoMaterial {
        /// The mesh.
        source_name: String,
        /// Tag of the element.
        element: u64,
        /// Names of its physical groups.
        groups: Vec<String>,
    },
    /// An element that two groups give different materials.
    #[error(
        "{source_name}: element {element} is in both physical volumes {groups:?}, which are given different materials; give both the same one, leave one of them out, or make physical volumes that do not overlap"
    )]
    TwoMaterials {
        /// The mesh.
        source_name: String,
        /// Tag of the element.
        element: u64,
        /// Names of the two groups.
        groups: [String; 2],
    },
    /// A point mass that is not a positive number.
    #[error("the point mass at {at:?} is {found}; expected a positive number")]
    PointMass {
        /// Where.
        at: [f64; 3],
        /// The mass.
        found: f64,
    },
    /// A radius to spread a point mass over that is not a positive number.
    #[error(
        "the spread of the point mass at {at:?} is {found}; expected a positive radius (leave it out to put the mass on the point itself)"
    )]
    SpreadRadius {
        /// Where.
        at: [f64; 3],
        /// The radius.
        found: f64,
    },
    /// A point that lies outside the body, by more than [`Mesh::locate`](crate::Mesh::locate) allows.
    #[error(
        "{source_name}: the point {at:?} is not on the body: the nearest node is {node} at {position:?}, {distance:.6} away; use a point of the body"
    )]
    OffBody {
        /// The mesh.
        source_name: String,
        /// The point.
        at: [f64; 3],
        /// Tag of the nearest node.
        node: u64,
        /// Its position.
        position: [f64; 3],
        /// Its distance.
        distance: f64,
    },
    /// Too few nodes near a point to carry what is spread over them.
    #[error(
        "{source_name}: the {count} node(s) within {radius} of {at:?} cannot carry a mass spread about that point (the nearest node is {distance:.6} away); use a larger spread"
    )]
    Spread {
        /// The mesh.
        source_name: String,
        /// The point.
        at: [f64; 3],
        /// The radius asked for.
        radius: f64,
        /// Nodes found within it.
        count: usize,
        /// Distance of the nearest node of all.
        distance: f64,
    },
    /// More nodes near a point than can carry a spread mass: they would fill the matrices.
    #[error(
        "{source_name}: {count} nodes lie within {radius} of {at:?}, but a point mass is spread over {limit} at most, as each of them is coupled to all the others; use a smaller spread"
    )]
    SpreadTooWide {
        /// The mesh.
        source_name: String,
        /// The point.
        at: [f64; 3],
        /// The radius asked for.
        radius: f64,
        /// Nodes found within it.
        count: usize,
        /// Nodes allowed.
        limit: usize,
    },
    /// A radius to take a mean rotation over that is not a positive number.
    #[error("the radius of the patch at {at:?} is {found}; expected a positive number")]
    PatchRadius {
        /// Centre of the patch.
        at: [f64; 3],
        /// The radius.
        found: f64,
    },
    /// Too few nodes near a point to have a rotation, or all of them on a line.
    #[error(
        "{source_name}: the {count} node(s) within {radius} of {at:?} have no mean rotation, for which three are needed that are not on a line (the nearest node is {distance:.6} away); use a larger radius"
    )]
    Patch {
        /// The mesh.
        source_name: String,
        /// Centre of the patch.
        at: [f64; 3],
        /// The radius asked for.
        radius: f64,
        /// Nodes found within it.
        count: usize,
        /// Distance of the nearest node of all.
        distance: f64,
    },
    /// A matrix of displacement fields whose rows are not the degrees of freedom of the mesh.
    #[error("the {what} have {found} rows; expected {expected}, three for each node of the mesh")]
    FieldRows {
        /// "displacements" or "shapes".
        what: &'static str,
        /// Three times the number of nodes.
        expected: usize,
        /// Rows there are.
        found: usize,
    },
    /// A displacement that is not a number.
    #[error("the {what} have {found} in row {row}, column {column}; every displacement must be a finite number")]
    FieldNotFinite {
        /// "displacements" or "shapes".
        what: &'static str,
        /// Row, counted from 0: 3·node + axis.
        row: usize,
        /// Column, counted from 0.
        column: usize,
        /// The number that stands there.
        found: f64,
    },
}

impl AssemblyError {
    /// The mesh: its file, or what the caller named it; `None` where the fault is not in a mesh.
    pub fn source_name(&self) -> Option<&str> {
        match self {
            Self::MissingGroup { source_name, .. }
            | Self::NoMaterial { source_name, .. }
            | Self::TwoMaterials { source_name, .. }
            | Self::OffBody { source_name, .. }
            | Self::Spread { source_name, .. }
            | Self::SpreadTooWide { source_name, .. }
            | Self::Patch { source_name, .. } => Some(source_name),
            Self::Memory(_)
            | Self::MaterialConstant { .. }
            | Self::PointMass { .. }
            | Self::SpreadRadius { .. }
            | Self::PatchRadius { .. }
            | Self::FieldRows { .. }
            | Self::FieldNotFinite { .. } => None,
        }
    }
}
