//! The shapes of a model that is at hand.

use dynamics::Manifold;
use faer::{Mat, MatRef};
use fem_tet10::{AssemblyError, Mesh, StressRecovery};
use model::{Meshed, Model, ProductStrains, stress_about};
use results::{Shapes, StressShapes};

use super::solid::solid;

/// Largest number of nodes that a body without elements is drawn by.
const MAX_NODES: usize = 20_000;
/// The least of the largest numbers of a shape that single precision has to its digits.
const SINGLE: f64 = 1e-30;

/// The shapes on the surface, with their stress; of a body without elements, on its nodes; of a rigid body without a mesh, the
/// solid that stands for it.
///
/// # Errors
/// [`AssemblyError`] where the stress cannot be computed, for want of memory.
pub(crate) fn surface_shapes_of(model: &Model) -> Result<Shapes, AssemblyError> {
    let mut shapes = shapes_of(model);
    if let Some(meshed) = &model.meshed
        && let Some(body) = &meshed.elements
    {
        let manifold = model.physics.large_deflection.as_ref();
        let recovery = StressRecovery::new(&meshed.mesh, &body.materials)?.at_nodes(&shapes.nodes);
        shapes.stress = Some(stress(&recovery, meshed, manifold, &shapes.nodes)?);
    }
    to_single(&mut shapes);
    Ok(shapes)
}

/// The same without the stress.
pub(crate) fn shapes_of(model: &Model) -> Shapes {
    let Some(meshed) = &model.meshed else { return solid(model) };
    let manifold = model.physics.large_deflection.as_ref();
    let mesh = &meshed.mesh;
    let (nodes, faces) = if mesh.has_elements() { surface(mesh) } else { (spread_nodes(mesh), Vec::new()) };
    // Nodes of matrices from elsewhere may have rotations, too.
    let dofs = meshed.modes.shapes.nrows() / mesh.positions().len().max(1);
    let at_nodes = |shape: faer::ColRef<'_, f64>| -> Vec<[f64; 3]> {
        nodes.iter().map(|node| [0, 1, 2].map(|axis| shape[dofs * *node as usize + axis])).collect()
    };
    let all = meshed.modes.shapes.col_iter().chain(meshed.following.col_iter());
    let displacements: Vec<_> = all.map(at_nodes).collect();
    let products = manifold.map_or(&[][..], Manifold::of_products).chunks_exact(displacements.len().max(1));
    let mut shapes = Shapes {
        positions: nodes.iter().map(|node| mesh.positions()[*node as usize]).collect(),
        faces,
        products: products.map(<[f64]>::to_vec).collect(),
        factors: manifold.map_or_else(Vec::new, factors),
        stress: None,
        displacements,
        nodes,
    };
    if let Some(reference) = &meshed.reference {
        let at = |node: &u32| [0, 1, 2].map(|axis| reference[(dofs * *node as usize + axis, 0)]);
        let at_nodes = shapes.nodes.iter().map(at).collect();
        add_reference(&mut shapes, at_nodes, meshed.modes.shapes.ncols());
    }
    to_single(&mut shapes);
    shapes
}

/// Rounds shapes that are drawn to single precision, as the results file has them; those beyond its range stay as they are.
pub(super) fn to_single(shapes: &mut Shapes) {
    let rounded = |list: &mut [f64]| {
        let largest = list.iter().fold(0.0_f64, |largest, x| x.abs().max(largest));
        if (SINGLE..1.0 / SINGLE).contains(&largest) {
            list.iter_mut().for_each(|x| *x = f64::from(*x as f32));
        }
    };
    shapes.displacements.iter_mut().for_each(|list| rounded(list.as_flattened_mut()));
    let stresses = shapes.stress.iter_mut().flat_map(|stress| &mut stress.shapes);
    stresses.for_each(|list| rounded(list.as_flattened_mut()));
}

/// A bent reference is a shape of its own, whose coordinate is the product without factors.
pub(super) fn add_reference(shapes: &mut Shapes, displacement: Vec<[f64; 3]>, modes: usize) {
    shapes.displacements.push(displacement);
    shapes.products.iter_mut().for_each(|adds| adds.push(0.0));
    let mut adds = vec![0.0; shapes.displacements.len()];
    adds[shapes.displacements.len() - 1] = 1.0;
    shapes.products.push(adds);
    shapes.factors.push([modes as u32; 3]);
}

/// The nodes of the surface, ascending, and its faces by their places among these.
pub(super) fn surface(mesh: &Mesh) -> (Vec<u32>, Vec<[u32; 6]>) {
    let on_mesh = mesh.outer_faces();
    let mut nodes: Vec<u32> = on_mesh.iter().flatten().copied().collect();
    nodes.sort_unstable();
    nodes.dedup();
    let place = |node: u32| nodes.partition_point(|n| *n < node) as u32;
    let faces = on_mesh.iter().map(|face| face.map(place)).collect();
    (nodes, faces)
}

/// As many nodes as are drawn, evenly among all.
fn spread_nodes(mesh: &Mesh) -> Vec<u32> {
    let count = mesh.positions().len();
    let kept = count.min(MAX_NODES);
    (0..kept).map(|i| (i * count / kept) as u32).collect()
}

/// Factors of each product: one more than the coordinates of the motion stands for a factor of 1.
fn factors(manifold: &Manifold) -> Vec<[u32; 3]> {
    let factor = |product: &Vec<usize>, i: usize| product.get(i).copied().unwrap_or(manifold.modes()) as u32;
    manifold.products().iter().map(|product| [0, 1, 2].map(|i| factor(product, i))).collect()
}

/// The stress in each coordinate, and in each product: Eq. (S2) of `docs/method/stress.md`.
fn stress(
    recovery: &StressRecovery<'_>,
    meshed: &Meshed,
    manifold: Option<&Manifold>,
    nodes: &[u32],
) -> Result<StressShapes, AssemblyError> {
    let (modes, following) = (meshed.modes.shapes.as_ref(), meshed.following.as_ref());
    let linear = |displacements: MatRef<'_, f64>| match &meshed.reference {
        Some(reference) => {
            let found = stress_about(recovery, reference.as_ref(), displacements)?;
            Ok::<_, AssemblyError>(found.get(.., ..displacements.ncols()).to_owned())
        }
        None => recovery.nodal_stress(displacements),
    };
    let mut shapes = lists(&linear(modes)?);
    if following.ncols() > 0 {
        shapes.extend(lists(&linear(following)?));
    }
    if let Some(reference) = &meshed.reference {
        shapes.extend(lists(&stress_about(recovery, reference.as_ref(), reference.get(.., ..0))?));
    }
    if let Some(manifold) = manifold {
        let count = modes.ncols();
        let extended = Mat::from_fn(modes.nrows(), count + following.ncols(), |i, j| match j.checked_sub(count) {
            None => modes[(i, j)],
            Some(k) => following[(i, k)],
        });
        let strains = ProductStrains::new(manifold, extended.as_ref());
        let of_pairs = recovery.second_order_nodal_stress(strains.fields.as_ref(), &strains.pairs)?;
        shapes.extend(lists(&strains.stress(of_pairs.as_ref())));
    }
    if meshed.reference.is_some() {
        // Of the product without factors.
        shapes.push(vec![[0.0; 6]; recovery.nodes().count()]);
    }
    let place = |node: u32| nodes.partition_point(|n| *n < node) as u32;
    Ok(StressShapes { nodes: recovery.nodes().map(place).collect(), shapes })
}

/// The columns of a nodal stress (6s×…).
fn lists(nodal: &Mat<f64>) -> Vec<Vec<[f64; 6]>> {
    let sites = nodal.nrows() / 6;
    let of_column = |k: usize| (0..sites).map(|site| [0, 1, 2, 3, 4, 5].map(|c| nodal[(6 * site + c, k)])).collect();
    (0..nodal.ncols()).map(of_column).collect()
}
