//! The shapes in a body file: on the surface, or in the whole volume.

use results::{Shapes, StressShapes};
use sealed::{SealedError, SealedFile};

use super::of_model::{add_reference, to_single};

/// Displacement of the bent body that the modes are about.
const REFERENCE: &str = "reference/displacement";

/// The shapes on the surface of the body in a body file, and of its whole volume the elements, too; the stress where the file
/// has it.
///
/// # Errors
/// [`SealedError`].
pub(super) fn read(file: &SealedFile, volume: bool) -> Result<(Shapes, Vec<[u32; 10]>), SealedError> {
    let all: Vec<[f64; 3]> = vectors(file, "mesh/positions")?;
    let on_mesh: Vec<[u32; 6]> = file.read::<u32>("mesh/surface_triangles")?.values.as_chunks().0.to_vec();
    let nodes: Vec<u32> = if volume { (0..all.len() as u32).collect() } else { distinct(on_mesh.as_flattened()) };
    let places = Places::new(&nodes, all.len());
    let no_node = || damaged(file, "its mesh names a node that it has not");
    let at_nodes = |list: &[[f64; 3]]| -> Option<Vec<[f64; 3]>> {
        nodes.iter().map(|node| list.get(*node as usize).copied()).collect()
    };
    let faces = on_mesh.iter().map(|face| places.of(face)).collect::<Option<Vec<_>>>().ok_or_else(no_node)?;
    let mut displacements = Vec::new();
    let mut modes = 0;
    for dataset in ["modes/shapes", "static_shapes/shapes", "large_deflection/shapes"] {
        if dataset == "large_deflection/shapes" {
            modes = displacements.len();
        }
        if file.has(dataset) {
            let numbers: Vec<[f64; 3]> = vectors(file, dataset)?;
            for list in numbers.chunks_exact(all.len().max(1)) {
                displacements.push(at_nodes(list).ok_or_else(no_node)?);
            }
        }
    }
    let mut shapes =
        Shapes { positions: at_nodes(&all).ok_or_else(no_node)?, faces, displacements, ..Shapes::default() };
    if file.has("large_deflection/factors") {
        shapes.factors = file.read::<u32>("large_deflection/factors")?.values.as_chunks().0.to_vec();
        let products = file.read::<f64>("large_deflection/products")?.values;
        shapes.products = products.chunks_exact(shapes.displacements.len().max(1)).map(<[f64]>::to_vec).collect();
    }
    shapes.stress = stress(file, &places)?;
    if file.has(REFERENCE) {
        let displacement = at_nodes(&vectors(file, REFERENCE)?).ok_or_else(no_node)?;
        add_reference(&mut shapes, displacement, modes);
        if let Some(stress) = &mut shapes.stress {
            stress.shapes.push(vec![[0.0; 6]; stress.nodes.len()]);
        }
    }
    shapes.nodes = nodes;
    if !volume {
        to_single(&mut shapes);
    }
    let tetrahedra =
        if volume { file.read::<u32>("mesh/tetrahedra")?.values.as_chunks().0.to_vec() } else { Vec::new() };
    let is_whole = tetrahedra.as_flattened().iter().all(|node| (*node as usize) < all.len());
    if !is_whole || !shapes.fits() {
        return Err(damaged(file, "its datasets do not fit together"));
    }
    Ok((shapes, tetrahedra))
}

/// The stress at the nodes that are wanted.
fn stress(file: &SealedFile, places: &Places) -> Result<Option<StressShapes>, SealedError> {
    if !file.has("stress/nodes") {
        return Ok(None);
    }
    let of_mesh = file.read::<u32>("stress/nodes")?.values;
    let kept: Vec<(usize, u32)> =
        of_mesh.iter().enumerate().filter_map(|(site, node)| Some((site, places.place(*node)?))).collect();
    let mut shapes = Vec::new();
    for dataset in ["stress/shapes", "stress/products"] {
        if file.has(dataset) {
            let numbers: Vec<[f64; 6]> = vectors(file, dataset)?;
            shapes.extend(
                numbers
                    .chunks_exact(of_mesh.len().max(1))
                    .map(|list| kept.iter().map(|(site, _)| list[*site]).collect()),
            );
        }
    }
    Ok(Some(StressShapes { nodes: kept.into_iter().map(|(_, place)| place).collect(), shapes }))
}

/// Where the nodes of the mesh are in a list of some of them.
struct Places(Vec<Option<u32>>);

impl Places {
    fn new(nodes: &[u32], count: usize) -> Self {
        let mut places = vec![None; count];
        for (place, node) in (0..).zip(nodes) {
            if let Some(of_node) = places.get_mut(*node as usize) {
                *of_node = Some(place);
            }
        }
        Self(places)
    }

    fn place(&self, node: u32) -> Option<u32> {
        self.0.get(node as usize).copied().flatten()
    }

    fn of<const N: usize>(&self, nodes: &[u32; N]) -> Option<[u32; N]> {
        let mut places = [0; N];
        for (place, node) in places.iter_mut().zip(nodes) {
            *place = self.place(*node)?;
        }
        Some(places)
    }
}

/// The numbers of a list, ascending, each once.
fn distinct(numbers: &[u32]) -> Vec<u32> {
    let mut numbers = numbers.to_vec();
    numbers.sort_unstable();
    numbers.dedup();
    numbers
}

fn vectors<const N: usize>(file: &SealedFile, dataset: &str) -> Result<Vec<[f64; N]>, SealedError> {
    Ok(file.read::<f64>(dataset)?.values.as_chunks().0.to_vec())
}

fn damaged(file: &SealedFile, what: &str) -> SealedError {
    file.damaged(what)
}
