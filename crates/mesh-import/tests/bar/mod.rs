//! A box of 3 x 1 x 1 for decks, and numbers without order.

#![allow(dead_code)] // each test uses a part of it

use std::fs;
use std::process::Command;

use fem_tet10::{Material, Materials, Mesh, centroid_lumped_inertia};
use mesh_import::{ImportError, ImportSettings, Imported, read_mesh};
use tempfile::TempDir;

/// Nodes and lines of elements of the box.
pub struct Bar {
    pub folder: TempDir,
    pub nodes: Vec<(u64, [f64; 3])>,
    pub elements: Vec<Vec<u64>>,
}

impl Bar {
    pub fn new() -> Self {
        let folder = tempfile::tempdir().unwrap();
        let geometry = "SetFactory(\"OpenCASCADE\");\nBox(1) = {0, 0, 0, 3, 1, 1};\nPhysical Volume(\"bar\") = {1};\nMesh.MeshSizeMax = 1;\n";
        fs::write(folder.path().join("bar.geo"), geometry).unwrap();
        let mut gmsh = Command::new("gmsh");
        gmsh.args(["bar.geo", "-3", "-order", "2", "-v", "0", "-o", "bar.inp"]).current_dir(folder.path());
        assert!(gmsh.output().unwrap().status.success());
        let text = fs::read_to_string(folder.path().join("bar.inp")).unwrap();
        let (mut nodes, mut elements, mut keyword) = (Vec::new(), Vec::new(), String::new());
        for line in text.lines() {
            if line.starts_with('*') {
                keyword = line.to_owned();
            } else if keyword == "*NODE" {
                let words: Vec<f64> = line.split(',').map(|word| word.trim().parse().unwrap()).collect();
                nodes.push((words[0] as u64, [words[1], words[2], words[3]]));
            } else if keyword.contains("C3D10") {
                elements.push(line.split(',').map(|word| word.trim().parse().unwrap()).collect());
            }
        }
        Self { folder, nodes, elements }
    }

    pub fn read(&self, name: &str, text: &str) -> Result<Imported, ImportError> {
        fs::write(self.folder.path().join(name), text).unwrap();
        read_mesh(&self.folder.path().join(name), &ImportSettings::default())
    }

    pub fn node_lines(&self, of: impl Fn([f64; 3]) -> String) -> String {
        self.nodes.iter().map(|(label, x)| format!("{label}, {}\n", of(*x))).collect()
    }

    pub fn element_lines(&self) -> String {
        let line = |element: &Vec<u64>| element.iter().map(u64::to_string).collect::<Vec<_>>().join(", ") + "\n";
        self.elements.iter().map(line).collect()
    }

    /// Numbers of the nodes at this x.
    pub fn at(&self, x: f64) -> String {
        let numbers = self.nodes.iter().filter(|(_, at)| (at[0] - x).abs() < 1e-9).map(|(label, _)| label.to_string());
        numbers.collect::<Vec<_>>().join(",\n") + "\n"
    }
}

pub fn volume(mesh: &Mesh) -> f64 {
    let material = Material { young_modulus: 1.0, poisson_ratio: 0.3, density: 1.0 };
    centroid_lumped_inertia(mesh, &Materials::Uniform(material), &[]).unwrap().mass
}

pub fn mean_of(mesh: &Mesh, set: &str) -> [f64; 3] {
    let nodes = mesh.group_nodes(set).unwrap_or_else(|error| panic!("{error}"));
    std::array::from_fn(|i| nodes.iter().map(|n| mesh.positions()[*n as usize][i]).sum::<f64>() / nodes.len() as f64)
}

/// A recipe of numbers without order.
pub struct Dice(pub u64);

impl Dice {
    pub fn up_to(&mut self, count: usize) -> usize {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 33) as usize % count
    }

    pub fn spelled(&mut self, keyword: &str) -> String {
        let letters = keyword.chars();
        letters.map(|letter| if self.up_to(2) == 0 { letter.to_ascii_lowercase() } else { letter }).collect()
    }
}

/// Decks to be written at random.
pub fn of_environment() -> u64 {
    std::env::var("FLEXFRAME_DECKS").ok().and_then(|count| count.parse().ok()).unwrap_or(50)
}
