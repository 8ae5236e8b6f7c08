//! Boxes of elements, and bars that share lines of nodes.

use std::fmt::Write;
use std::path::{Path, PathBuf};

use fem_tet10::MeshParts;

use crate::stability::meshes::{box_mesh, cells_of};

/// A bar of a frame: a box with its lowest corner here, along x or upright along z.
#[derive(Debug, Clone, Copy)]
pub struct FrameBar {
    /// Its lowest corner.
    pub at: [f64; 3],
    /// True if its length is along z.
    pub upright: bool,
}

/// Bars of one size in one mesh, which share lines of nodes where edges of them meet.
#[derive(Debug, Clone)]
pub struct BarFrame {
    /// Length, breadth (along y) and height of a bar.
    pub size: [f64; 3],
    /// Cells along its length and its breadth; one along its height.
    pub cells: [usize; 2],
    /// The bars.
    pub bars: Vec<FrameBar>,
}

impl BarFrame {
    /// Two bars along x that share the line x = z = 0.
    pub fn pair(size: [f64; 3], cells: [usize; 2]) -> Self {
        let bar = |at| FrameBar { at, upright: false };
        Self { size, cells, bars: vec![bar([-size[0], 0.0, 0.0]), bar([0.0, 0.0, -size[2]])] }
    }

    /// Four bars around a square, each of which shares a line with the next.
    pub fn rhombus(size: [f64; 3], cells: [usize; 2]) -> Self {
        let [l, _, h] = size;
        let bar = |x: f64, z: f64, upright| FrameBar { at: [x, 0.0, z], upright };
        Self { size, cells, bars: vec![bar(0.0, -h, false), bar(l, 0.0, true), bar(0.0, l, false), bar(-h, 0.0, true)] }
    }

    /// The mesh of one bar, with its lowest corner at the origin.
    pub fn bar(&self, upright: bool) -> MeshParts {
        let ([l, b, h], [along, across]) = (self.size, self.cells);
        match upright {
            false => box_mesh([l, b, h], [along, across, 1]),
            true => box_mesh([h, b, l], [1, across, along]),
        }
    }

    /// The mesh of all bars: nodes at one place are one node.
    pub fn joined(&self) -> MeshParts {
        let ([l, b, h], [along, across]) = (self.size, self.cells);
        // Where bars begin and end along x and z cuts a grid of cells; those of the bars are kept.
        let cuts = |axis: usize| {
            let ends = |bar: &FrameBar| {
                let length = if (axis == 0) != bar.upright { l } else { h };
                [bar.at[axis], bar.at[axis] + length]
            };
            let mut all: Vec<f64> = self.bars.iter().flat_map(ends).collect();
            all.sort_by(f64::total_cmp);
            all.dedup_by(|x, y| (*x - *y).abs() < 1e-9 * l);
            let mut lines = vec![all[0]];
            for pair in all.windows(2) {
                let length = pair[1] - pair[0];
                let count = if length > 1.5 * h { along } else { 1 };
                lines.extend((1..=count).map(|k| pair[0] + length * k as f64 / count as f64));
            }
            lines
        };
        let [xs, zs] = [cuts(0), cuts(2)];
        let cells = [xs.len() - 1, across, zs.len() - 1];
        let is_in = |bar: &FrameBar, x: f64, z: f64| {
            let [length, height] = if bar.upright { [h, l] } else { [l, h] };
            (0.0..length).contains(&(x - bar.at[0])) && (0.0..height).contains(&(z - bar.at[2]))
        };
        let keep = |[i, _, k]: [usize; 3]| {
            let (x, z) = (0.5 * (xs[i] + xs[i + 1]), 0.5 * (zs[k] + zs[k + 1]));
            self.bars.iter().any(|bar| is_in(bar, x, z))
        };
        // In steps of one cell, then moved to the lines.
        let mut parts = cells_of(cells.map(|count| count as f64), cells, keep);
        let between = |lines: &[f64], s: f64| {
            let i = (s.floor() as usize).min(lines.len() - 2);
            lines[i] + (s - i as f64) * (lines[i + 1] - lines[i])
        };
        for x in &mut parts.positions {
            *x = [between(&xs, x[0]), b * x[1] / across as f64, between(&zs, x[2])];
        }
        parts
    }
}

/// A straight line of nodes with a name: the ends of its edges and their middles, in turn.
#[derive(Debug, Clone)]
pub struct NodeLine {
    /// Name of the physical curve.
    pub name: String,
    /// Tags of the nodes.
    pub nodes: Vec<u64>,
}

impl BarFrame {
    /// Places (x, z) of the four edges along y of a bar with its lowest corner at the origin.
    pub fn edges(&self, upright: bool) -> [[f64; 2]; 4] {
        let [l, _, h] = self.size;
        let [length, height] = if upright { [h, l] } else { [l, h] };
        [[0.0, 0.0], [length, 0.0], [0.0, height], [length, height]]
    }

    /// The same as lines `edge0` to `edge3` of its mesh.
    pub fn lines(&self, upright: bool, mesh: &MeshParts) -> Vec<NodeLine> {
        let near = |a: f64, b: f64| (a - b).abs() < 1e-9;
        let line = |(number, [x, z]): (usize, [f64; 2])| {
            let on = mesh.positions.iter().zip(1..).filter(|(at, _)| near(at[0], x) && near(at[2], z));
            let mut nodes: Vec<(f64, u64)> = on.map(|(at, tag)| (at[1], tag)).collect();
            nodes.sort_by(|a, b| a.0.total_cmp(&b.0));
            NodeLine { name: format!("edge{number}"), nodes: nodes.into_iter().map(|(_, tag)| tag).collect() }
        };
        self.edges(upright).into_iter().enumerate().map(line).collect()
    }
}

/// Writes a mesh as MSH 4.1 into a directory, with lines as physical curves; returns its path.
///
/// # Errors
/// Errors of the file.
pub fn write(directory: &Path, name: &str, parts: &MeshParts, lines: &[NodeLine]) -> std::io::Result<PathBuf> {
    let (nodes, elements) = (parts.positions.len(), parts.elements.len());
    let edges: usize = lines.iter().map(|line| line.nodes.len() / 2).sum();
    let mut text = String::from("$MeshFormat\n4.1 0 8\n$EndMeshFormat\n");
    let mut put = |words: String| {
        text.push_str(&words);
        text.push('\n');
    };
    if !lines.is_empty() {
        put(format!("$PhysicalNames\n{}", lines.len() + 1));
        (1..).zip(lines).for_each(|(tag, line)| put(format!("1 {tag} \"{}\"", line.name)));
        put(format!("3 {} \"body\"\n$EndPhysicalNames", lines.len() + 1));
    }
    put(format!("$Entities\n0 {} 0 1", lines.len()));
    (1..=lines.len()).for_each(|tag| put(format!("{tag} 0 0 0 1 1 1 1 {tag} 0")));
    let of_body = if lines.is_empty() { "0".to_owned() } else { format!("1 {}", lines.len() + 1) };
    put(format!("1 0 0 0 1 1 1 {of_body} 0\n$EndEntities"));
    put(format!("$Nodes\n1 {nodes} 1 {nodes}\n3 1 0 {nodes}"));
    (1..=nodes).for_each(|tag| put(tag.to_string()));
    parts.positions.iter().for_each(|[x, y, z]| put(format!("{x} {y} {z}")));
    put(format!("$EndNodes\n$Elements\n{} {} 1 {}", lines.len() + 1, edges + elements, edges + elements));
    let mut element = 0;
    for (tag, line) in (1..).zip(lines) {
        put(format!("1 {tag} 8 {}", line.nodes.len() / 2));
        for first in (0..line.nodes.len() - 1).step_by(2) {
            element += 1;
            put(format!("{element} {} {} {}", line.nodes[first], line.nodes[first + 2], line.nodes[first + 1]));
        }
    }
    put(format!("3 1 11 {elements}"));
    for (tag, nodes) in (element + 1..).zip(&parts.elements) {
        let mut words = format!("{tag}");
        nodes.iter().for_each(|node| {
            // Writing to a string does not fail.
            let _ = write!(words, " {node}");
        });
        put(words);
    }
    put("$EndElements".to_owned());
    let path = directory.join(format!("{name}.msh"));
    std::fs::write(&path, text)?;
    Ok(path)
}
