#![doc = include_str!("../README.md")]
#![forbid(unsafe_code)]
#![cfg_attr(not(test), warn(clippy::unwrap_used, clippy::expect_used, clippy::panic, clippy::unreachable))]

mod dofs;
mod entries;
mod error;
mod expanded;
mod matrix;
mod nodes;
mod source;

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use faer::sparse::SparseColMat;
use keys::{Digest, Hash};

use dofs::{Order, read_dofs};
use entries::{Form, Index, Rows};
use matrix::Symmetric;
use nodes::NodeFile;
use source::Source;

pub use error::{MatrixError, Which};

/// The files of a body.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct MatrixFiles {
    /// M: Matrix Market, `row column value` (CalculiX `.mas`), or `node, dof, node, dof, value` (Abaqus `_MASS1.mtx`).
    pub mass: PathBuf,
    /// K, written as M is.
    pub stiffness: PathBuf,
    /// Positions of the nodes: a table `node, x, y, z, groups`, or an .inp file.
    pub nodes: PathBuf,
    /// Node and degree of freedom of each row (CalculiX `.dof`); without it, rows are in the order of the nodes, 3 or 6 each.
    pub dofs: Option<PathBuf>,
}

/// The matrices of a body that nothing holds.
#[derive(Debug)]
pub struct BodyMatrices {
    /// Labels of the nodes; running numbers where one label stands for several nodes.
    pub labels: Vec<u64>,
    /// Positions of the nodes (n×3).
    pub positions: Vec<[f64; 3]>,
    /// Indices of nodes by the names of their groups.
    pub groups: BTreeMap<String, Vec<u32>>,
    /// Degrees of freedom of a node: 3 translations, or 3 translations and 3 rotations.
    pub dofs: usize,
    /// K (N×N, N = 3n or 6n), both triangles: degree of freedom `dofs·node + dof`, dof from 0.
    pub stiffness: SparseColMat<usize, f64>,
    /// M, likewise.
    pub mass: SparseColMat<usize, f64>,
    /// Largest difference of the triangles of K or M, relative to the diagonal; `None` where the files have one triangle.
    pub asymmetry: Option<f64>,
    /// Hash of all bytes that were read, and of how: the matrices follow from them.
    pub hash: Hash,
    /// Notes about them, in sentences.
    pub notes: Vec<String>,
}

impl MatrixFiles {
    /// All of them, with what they are.
    pub fn list(&self) -> impl Iterator<Item = (Which, &Path)> {
        let of_rows = self.dofs.iter().map(|path| (Which::Dofs, path.as_path()));
        let three = [(Which::Mass, &*self.mass), (Which::Stiffness, &*self.stiffness), (Which::Nodes, &*self.nodes)];
        three.into_iter().chain(of_rows)
    }

    /// The hash that [`BodyMatrices`] have of the files as they are now, which are looked at for nothing else.
    ///
    /// # Errors
    /// [`MatrixError`]: a file that cannot be read.
    pub fn hash(&self) -> Result<Hash, MatrixError> {
        let digest = self.list().try_fold(Digest::new(), |digest, (which, path)| {
            let source = Source::new(which, path);
            source.skim()?;
            Ok::<_, MatrixError>(source.identify(digest))
        });
        digest.map(Digest::finish)
    }

    /// Reads them.
    ///
    /// # Errors
    /// [`MatrixError`]: a file that cannot be read or is not what it should be, sizes that do not fit together, a matrix that is
    /// not symmetric. Whether K and M are those of a free body that has mass is not looked at.
    pub fn read(&self) -> Result<BodyMatrices, MatrixError> {
        let nodes_source = Source::new(Which::Nodes, &self.nodes);
        let nodes = NodeFile::read(&nodes_source)?;
        let dofs_source = self.dofs.as_ref().map(|path| Source::new(Which::Dofs, path));
        let rows_of_dofs = dofs_source.as_ref().map(read_dofs).transpose()?;
        let mass_source = Source::new(Which::Mass, &self.mass);
        let stiffness_source = Source::new(Which::Stiffness, &self.stiffness);
        let mut labelled = Rows::default();
        let most = rows_of_dofs.as_ref().map_or(6 * nodes.labels.len(), Vec::len);
        let mass = Symmetric::read(&mass_source, &mut labelled, most)?;
        let stiffness = Symmetric::read(&stiffness_source, &mut labelled, most)?;
        let order = match (mass.form, stiffness.form, &rows_of_dofs, &dofs_source) {
            (Form::Labelled, Form::Labelled, None, _) => Order::of_rows(&stiffness_source, &labelled.list, &nodes)?,
            (Form::Labelled, Form::Labelled, Some(_), Some(source)) => {
                return Err(source.refuse(
                    None,
                    "a list of rows beside matrices that name the node of each entry",
                    "matrices whose rows have numbers",
                    "remove `dofs`",
                ));
            }
            (Form::Labelled, ..) | (_, Form::Labelled, ..) => {
                return Err(mass_source.refuse(
                    None,
                    "a mass and a stiffness that are written in different forms",
                    "both with numbers of rows, or both with nodes",
                    "write them in one run of one program",
                ));
            }
            (_, _, Some(rows), Some(source)) => {
                of_dofs(source, rows, &[(&mass_source, &mass), (&stiffness_source, &stiffness)], &nodes)?
            }
            _ => self.of_nodes(&[(&mass_source, &mass), (&stiffness_source, &stiffness)], &nodes)?,
        };
        let asymmetry = [mass.asymmetry, stiffness.asymmetry].into_iter().flatten().reduce(f64::max);
        let (mass, stiffness) =
            (mass.permuted(&mass_source, &order.to)?, stiffness.permuted(&stiffness_source, &order.to)?);
        let given: Vec<[f64; 3]> = order.nodes.iter().map(|node| nodes.positions[*node as usize]).collect();
        let mut notes = Vec::new();
        let (labels, positions) = if order.is_expanded {
            if order.dofs == 6 {
                return Err(stiffness_source.refuse(
                    None,
                    "a degree of freedom a second time",
                    "each degree of freedom of a node once",
                    "write the matrices again",
                ));
            }
            let positions = expanded::positions(&stiffness_source, &stiffness, &order.nodes, &nodes.positions)?;
            let mut shell = order.nodes.clone();
            shell.sort_unstable();
            shell.dedup();
            notes.push(format!(
                "{} nodes of shells or beams stand for {} nodes of the solid elements that CalculiX computes with, numbered anew; where \
                 these are is found from the stiffness matrix, the nodes of the shell in the middle of its thickness (without OFFSET)",
                shell.len(),
                positions.len()
            ));
            ((1..=positions.len() as u64).collect(), positions)
        } else {
            (order.nodes.iter().map(|node| nodes.labels[*node as usize]).collect(), given)
        };
        let mut of_node: Vec<Vec<u32>> = vec![Vec::new(); nodes.labels.len()];
        (0..).zip(&order.nodes).for_each(|(copy, node)| of_node[*node as usize].push(copy));
        let unused = of_node.iter().filter(|copies| copies.is_empty()).count();
        if unused > 0 {
            notes.push(format!(
                "{unused} of {} nodes of {} have no degree of freedom and are left out",
                nodes.labels.len(),
                self.nodes.display()
            ));
        }
        let members = |group: &Vec<u32>| group.iter().flat_map(|node| &of_node[*node as usize]).copied().collect();
        let groups = nodes.groups.iter().map(|(name, group)| (name.clone(), members(group))).collect();
        let sources = [&mass_source, &stiffness_source, &nodes_source].into_iter().chain(&dofs_source);
        let hash = sources.fold(Digest::new(), |digest, source| source.identify(digest)).finish();
        let dofs = order.dofs;
        Ok(BodyMatrices { labels, positions, groups, dofs, stiffness, mass, asymmetry, hash, notes })
    }

    /// Rows in the order of the nodes, 3 or 6 each.
    fn of_nodes(&self, matrices: &[(&Source<'_>, &Symmetric); 2], nodes: &NodeFile) -> Result<Order, MatrixError> {
        let count = nodes.labels.len();
        let [(mass_source, mass), (_, stiffness)] = matrices;
        if mass.size != stiffness.size && matrices.iter().all(|(_, m)| matches!(m.form, Form::MatrixMarket { .. })) {
            return Err(mass_source.refuse(
                None,
                format!("{} rows", mass.size),
                format!("{}, as the stiffness has", stiffness.size),
                "write both matrices of one model",
            ));
        }
        let size = mass.size.max(stiffness.size);
        for dofs in [3, 6] {
            if size == dofs * count {
                return Ok(Order::of_nodes(count, dofs));
            }
        }
        let (source, _) = if mass.size == size { matrices[0] } else { matrices[1] };
        let is_calculix = [&self.mass, &self.stiffness].iter().any(|path| {
            path.extension()
                .is_some_and(|ending| ending.eq_ignore_ascii_case("mas") || ending.eq_ignore_ascii_case("sti"))
        });
        let help = if is_calculix {
            "name the .dof file that CalculiX writes beside the matrices: `dofs = \"JOB.dof\"`"
        } else {
            "give the nodes of the matrices in their order, or say which row is which by `dofs`: a file with a line `node, dof` for each \
             row"
        };
        Err(source.refuse(
            None,
            format!("{size} rows for {count} nodes"),
            format!("{} or {}: three degrees of freedom a node, or six with its rotations", 3 * count, 6 * count),
            help,
        ))
    }
}

/// Rows that a file names.
fn of_dofs(
    source: &Source<'_>,
    rows: &[Index],
    matrices: &[(&Source<'_>, &Symmetric)],
    nodes: &NodeFile,
) -> Result<Order, MatrixError> {
    for (of_matrix, matrix) in matrices {
        // Rows without entries at the end of a list of triplets are not seen there.
        let is_exact = matches!(matrix.form, Form::MatrixMarket { .. });
        if matrix.size > rows.len() || (is_exact && matrix.size < rows.len()) {
            return Err(of_matrix.refuse(
                None,
                format!("{} rows", matrix.size),
                format!("{}, as {} lists", rows.len(), source.path.display()),
                "name the list that was written with these matrices",
            ));
        }
    }
    Order::of_rows(source, rows, nodes)
}

#[cfg(test)]
mod tests {
    use std::fs;

    use super::*;

    /// A file may be replaced while others are read, or after: what is known is of the bytes that were read.
    #[test]
    fn matrices_are_known_by_what_was_read_of_their_files() {
        let folder = tempfile::tempdir().unwrap();
        let place = |name: &str| folder.path().join(name);
        let matrix = |value: f64| {
            let rows: Vec<String> = (1..=9).map(|i| format!("{i} {i} {value}\n")).collect();
            format!("%%MatrixMarket matrix coordinate real symmetric\n9 9 9\n{}", rows.concat())
        };
        fs::write(place("k.mtx"), matrix(2.0)).unwrap();
        fs::write(place("m.mtx"), matrix(1.0)).unwrap();
        fs::write(place("nodes.csv"), "1, 0, 0, 0\n2, 1, 0, 0\n3, 0, 1, 0\n").unwrap();
        let [stiffness, mass, nodes] = ["k.mtx", "m.mtx", "nodes.csv"].map(place);
        let files = MatrixFiles { mass, stiffness, nodes, dofs: None };
        let read = files.read().unwrap();
        assert_eq!(read.hash, files.hash().unwrap());
        for name in ["k.mtx", "m.mtx", "nodes.csv"] {
            let before = fs::read_to_string(place(name)).unwrap();
            fs::write(place(name), before.replace("9 9 ", "9 9 0") + "\n").unwrap();
            assert_ne!(files.hash().unwrap(), read.hash, "{name}");
            fs::write(place(name), before).unwrap();
            assert_eq!(files.read().unwrap().hash, read.hash, "{name}");
        }
        // A pipe gives its bytes once.
        let pipe = place("pipe.csv");
        assert!(std::process::Command::new("mkfifo").arg(&pipe).status().unwrap().success());
        assert!(MatrixFiles { nodes: pipe, ..files }.hash().is_err());
    }

    /// The hash is made while the lines are read, and not by another look at the file.
    #[test]
    fn a_file_that_is_replaced_while_it_is_read_is_known_by_what_was_read() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("nodes.csv");
        let lines: String = (1..5000).map(|i| format!("{i}, {i}, 0, 0\n")).collect();
        fs::write(&path, &lines).unwrap();
        let source = Source::new(Which::Nodes, &path);
        let mut count = 0;
        let read = source.each_line(|_, _| {
            count += 1;
            if count == 1 {
                // Another file of this name; the open one is what it was.
                fs::remove_file(&path).unwrap();
                fs::write(&path, "1, 9, 9, 9\n").unwrap();
            }
            Ok(source::Next::Go)
        });
        read.unwrap();
        let known = |bytes: &str| {
            Digest::new().text(Which::Nodes.name()).text("csv").hash(&Hash::of(bytes.as_bytes())).finish()
        };
        assert_eq!((count, source.identify(Digest::new()).finish()), (4999, known(&lines)));
    }
}
