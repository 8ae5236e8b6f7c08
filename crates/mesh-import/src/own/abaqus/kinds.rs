//! Kinds of elements by the names that Abaqus and CalculiX give them.

/// A kind of element.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Kind {
    /// A tetrahedron with 4 or 10 nodes.
    Tetrahedron(usize),
    /// A triangle with 3 or 6 nodes: a place on the surface, or a shell if a section makes it one.
    Triangle(usize),
    /// A solid that is no tetrahedron, with the number of its nodes where that is known.
    Solid(Option<usize>),
    /// A mass on a node.
    Mass,
    /// Anything else: beams, springs, dampers, connectors, shells of four sides.
    Other,
}

/// Solids, by the beginnings of their names; a longer one stands before its own beginning.
const SOLIDS: [(&str, Option<usize>); 12] = [
    ("C3D27", Some(27)),
    ("C3D20", Some(20)),
    ("C3D15", Some(15)),
    ("C3D8", Some(8)),
    ("C3D6", Some(6)),
    ("C3D5", Some(5)),
    ("C3D", None),
    ("CSS8", Some(8)),
    ("SC8", Some(8)),
    ("SC6", Some(6)),
    ("COH3D", None),
    ("CIN3D", None),
];
/// Triangles of six nodes, and of three.
const TRIANGLES: [(&str, usize); 12] = [
    ("STRI65", 6),
    ("STRI3", 3),
    ("S6", 6),
    ("CPS6", 6),
    ("CPE6", 6),
    ("CAX6", 6),
    ("M3D6", 6),
    ("DS6", 6),
    ("SFM3D6", 6),
    ("SFM3D3", 3),
    ("M3D3", 3),
    ("CPS3", 3),
];

impl Kind {
    /// The kind of a name in capital letters.
    pub(crate) fn of(name: &str) -> Self {
        let is = |start: &str| name.starts_with(start);
        if is("C3D10") {
            return Self::Tetrahedron(10);
        }
        if name == "C3D4" || ["C3D4H", "C3D4T", "C3D4P"].contains(&name) {
            return Self::Tetrahedron(4);
        }
        if let Some((_, nodes)) = SOLIDS.iter().find(|(start, _)| is(start)) {
            return Self::Solid(*nodes);
        }
        if let Some((_, nodes)) = TRIANGLES.iter().find(|(start, _)| is(start)) {
            return Self::Triangle(*nodes);
        }
        // S3R and S3RS, but not other names with this beginning.
        match name {
            "S3" | "S3R" | "S3RS" | "S3T" | "DS3" | "CPE3" => Self::Triangle(3),
            "MASS" => Self::Mass,
            _ => Self::Other,
        }
    }

    /// Nodes of an element, where that is known.
    pub(crate) fn nodes(self) -> Option<usize> {
        match self {
            Self::Tetrahedron(nodes) | Self::Triangle(nodes) => Some(nodes),
            Self::Solid(nodes) => nodes,
            Self::Mass => Some(1),
            Self::Other => None,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::Kind;

    #[test]
    fn elements_are_known_by_their_names() {
        for (name, kind) in [
            ("C3D10M", Kind::Tetrahedron(10)),
            ("C3D10HS", Kind::Tetrahedron(10)),
            ("C3D4", Kind::Tetrahedron(4)),
            ("C3D8R", Kind::Solid(Some(8))),
            ("C3D20RH", Kind::Solid(Some(20))),
            ("SC8R", Kind::Solid(Some(8))),
            ("S6", Kind::Triangle(6)),
            ("STRI65", Kind::Triangle(6)),
            ("S3R", Kind::Triangle(3)),
            ("S4R", Kind::Other),
            ("SPRINGA", Kind::Other),
            ("MASS", Kind::Mass),
            ("B31", Kind::Other),
        ] {
            assert_eq!(Kind::of(name), kind, "{name}");
        }
    }
}
