//! Fields on a mesh that stays as it is, for ParaView: what both kinds of file have in common.

/// Cells of one kind over their own list of points.
#[derive(Debug, Clone, PartialEq)]
pub struct Grid {
    /// Points.
    pub points: Vec<[f64; 3]>,
    /// Points of the cells, one cell after another, in VTK's order.
    pub connectivity: Vec<u32>,
    /// Kind of the cells.
    pub cells: CellKind,
}

/// Kinds of cells.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum CellKind {
    /// Three points.
    Triangle,
    /// Corners 0 to 3 and the middles of the edges 01, 12, 02, 03, 13, 23.
    QuadraticTetrahedron,
}

impl CellKind {
    /// The number that VTK has for it.
    pub(crate) fn number(self) -> u8 {
        match self {
            Self::Triangle => 5,
            Self::QuadraticTetrahedron => 24,
        }
    }

    /// Points of a cell.
    pub(crate) fn points(self) -> usize {
        match self {
            Self::Triangle => 3,
            Self::QuadraticTetrahedron => 10,
        }
    }
}

impl Grid {
    /// Number of cells.
    pub fn cells(&self) -> usize {
        self.connectivity.len() / self.cells.points()
    }
}

/// A quantity at the points.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Field {
    /// Name in ParaView.
    pub name: String,
    /// Numbers of each point: 1 of a scalar, 3 of a vector, 6 of a symmetric tensor (xx, yy, zz, xy, yz, zx).
    pub components: usize,
}
