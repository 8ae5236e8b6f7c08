//! The shapes of a body as the datasets of a file.

use super::{Shapes, StressShapes};
use crate::{BodyMetadata, Units};
use sealed::{Declared, Kind, SealedError};

/// A kind of dataset, of which a body has one or none.
#[derive(Debug)]
pub(crate) struct ShapeDataset {
    /// Path of the dataset in the group of its body.
    pub path: &'static str,
    /// Unit, as that of a column.
    pub unit: &'static str,
    /// Frame of the components.
    pub frame: &'static str,
    /// A sentence for people.
    pub description: &'static str,
}

const NODES: &str = "model/mesh/nodes";
const POSITIONS: &str = "model/mesh/positions";
const FACES: &str = "model/mesh/surface_triangles";
const SHAPES: &str = "model/shapes";
const FACTORS: &str = "model/large_deflection/factors";
const PRODUCTS: &str = "model/large_deflection/products";
const STRESS_NODES: &str = "model/stress/nodes";
const STRESS_SHAPES: &str = "model/stress/shapes";
const STRESS_PRODUCTS: &str = "model/stress/products";

/// All of them.
pub(crate) const DATASETS: [ShapeDataset; 9] = [
    whole(NODES, "number of each node of the surface in the mesh, from 0"),
    numbers(POSITIONS, "length", "mesh", "position of each node of the surface in the undeformed body"),
    whole(FACES, "nodes of each face, by their places in nodes, seen from outside: corners, then mid-edges 01 12 20"),
    numbers(
        SHAPES,
        "1/mass^(1/2)",
        "body",
        "displacement of each node in a unit of each coordinate: flexible modes, static shapes, shapes that follow large modes",
    ),
    whole(
        FACTORS,
        "coordinates of each product of large modes, from 0; one more than there are stands for a factor of 1",
    ),
    numbers(
        PRODUCTS,
        "1/(length mass^(1/2))",
        "none",
        "amount that a unit of each product adds to each coordinate of shapes; of three factors the unit is squared",
    ),
    whole(STRESS_NODES, "node of each stress, by its place in nodes; one between materials is there for each"),
    numbers(
        STRESS_SHAPES,
        "mass^(1/2)/(length^2 time^2)",
        "body",
        "stress in a unit of each coordinate of shapes: xx, yy, zz, xy, yz, zx",
    ),
    numbers(
        STRESS_PRODUCTS,
        "1/(length^3 time^2)",
        "body",
        "stress in a unit of each of the products of large_deflection/factors: xx, yy, zz, xy, yz, zx",
    ),
];

const fn whole(path: &'static str, description: &'static str) -> ShapeDataset {
    numbers(path, "1", "none", description)
}

const fn numbers(
    path: &'static str,
    unit: &'static str,
    frame: &'static str,
    description: &'static str,
) -> ShapeDataset {
    ShapeDataset { path, unit, frame, description }
}

impl ShapeDataset {
    /// It, of a body, with a shape.
    pub(crate) fn declared(&self, body: &BodyMetadata, (kind, shape): (Kind, &[usize]), units: &Units) -> Declared {
        Declared::new(body.path(self.path), kind, shape, [&units.in_labels(self.unit), self.frame, self.description])
    }
}

/// Numbers of a dataset, list by list.
#[derive(Debug)]
pub(crate) enum Lists<'a> {
    Whole(&'a [u32]),
    Numbers(Vec<&'a [f64]>),
}

impl Lists<'_> {
    /// The kind of numbers that a file has of them: where all are in single precision, they are written so.
    pub(crate) fn kind(&self) -> Kind {
        let is_single = |x: &f64| f64::from(*x as f32) == *x;
        match self {
            Self::Whole(_) => Kind::U32,
            Self::Numbers(lists) if lists.iter().copied().flatten().all(is_single) => Kind::F32,
            Self::Numbers(_) => Kind::F64,
        }
    }

    /// The list of integers, if it is one.
    pub(crate) fn whole(&self) -> Option<&[u32]> {
        match self {
            Self::Whole(list) => Some(list),
            Self::Numbers(_) => None,
        }
    }

    /// The lists of numbers.
    pub(crate) fn numbers(&self) -> &[&[f64]] {
        match self {
            Self::Whole(_) => &[],
            Self::Numbers(lists) => lists,
        }
    }
}

/// A reader of the datasets of a body: the numbers of one, list by list, each with as many numbers as its shape after the
/// first index says.
pub(crate) trait Datasets {
    /// The shape of a dataset; `None` if the body does not have it.
    fn shape(&self, path: &str) -> Option<&[usize]>;
    /// The lists of a dataset of integers, as one.
    fn whole(&self, path: &str) -> Result<Vec<u32>, SealedError>;
    /// The lists of a dataset of numbers.
    fn numbers(&self, path: &str) -> Result<Vec<Vec<f64>>, SealedError>;
}

impl Shapes {
    /// The datasets: their kinds, their shapes and their numbers.
    pub(crate) fn stored(&self) -> Vec<(&'static str, Vec<usize>, Lists<'_>)> {
        let Self { nodes, positions, faces, displacements, factors, products, stress } = self;
        let (n, c, p) = (nodes.len(), displacements.len(), factors.len());
        let mut stored = vec![
            (NODES, vec![n], Lists::Whole(nodes)),
            (POSITIONS, vec![n, 3], Lists::Numbers(vec![positions.as_flattened()])),
            (FACES, vec![faces.len(), 6], Lists::Whole(faces.as_flattened())),
            (SHAPES, vec![c, n, 3], Lists::Numbers(flat(displacements))),
        ];
        if p > 0 {
            stored.push((FACTORS, vec![p, 3], Lists::Whole(factors.as_flattened())));
            stored.push((PRODUCTS, vec![p, c], Lists::Numbers(products.iter().map(Vec::as_slice).collect())));
        }
        if let Some(StressShapes { nodes, shapes }) = stress {
            let s = nodes.len();
            let (of_shapes, of_products) = shapes.split_at(c.min(shapes.len()));
            stored.push((STRESS_NODES, vec![s], Lists::Whole(nodes)));
            stored.push((STRESS_SHAPES, vec![c, s, 6], Lists::Numbers(flat(of_shapes))));
            if p > 0 {
                stored.push((STRESS_PRODUCTS, vec![p, s, 6], Lists::Numbers(flat(of_products))));
            }
        }
        stored
    }

    /// The shapes in a file; `None` where one of the datasets lacks, or has a shape that none of its kind has.
    pub(crate) fn read(file: &impl Datasets) -> Result<Option<Self>, SealedError> {
        let last = |path: &str, last: &[usize]| file.shape(path).is_some_and(|shape| shape.ends_with(last));
        let lists = |path: &str, rank: usize| file.shape(path).is_some_and(|shape| shape.len() == rank);
        let has_large = file.shape(FACTORS).is_some();
        let has_stress = file.shape(STRESS_NODES).is_some();
        let fits = lists(NODES, 1)
            && (lists(POSITIONS, 2) && last(POSITIONS, &[3]))
            && (lists(FACES, 2) && last(FACES, &[6]))
            && (lists(SHAPES, 3) && last(SHAPES, &[3]))
            && (!has_large || (lists(FACTORS, 2) && last(FACTORS, &[3]) && lists(PRODUCTS, 2)))
            && (!has_stress || (lists(STRESS_NODES, 1) && lists(STRESS_SHAPES, 3) && last(STRESS_SHAPES, &[6])))
            && (!(has_stress && has_large) || (lists(STRESS_PRODUCTS, 3) && last(STRESS_PRODUCTS, &[6])));
        if !fits {
            return Ok(None);
        }
        let mut shapes = Self {
            nodes: file.whole(NODES)?,
            positions: file.numbers(POSITIONS)?.concat().as_chunks().0.to_vec(),
            faces: file.whole(FACES)?.as_chunks().0.to_vec(),
            displacements: vectors(file.numbers(SHAPES)?),
            ..Self::default()
        };
        if has_large {
            shapes.factors = file.whole(FACTORS)?.as_chunks().0.to_vec();
            shapes.products = file.numbers(PRODUCTS)?;
        }
        if has_stress {
            let mut of_shapes = vectors(file.numbers(STRESS_SHAPES)?);
            if has_large {
                of_shapes.extend(vectors(file.numbers(STRESS_PRODUCTS)?));
            }
            shapes.stress = Some(StressShapes { nodes: file.whole(STRESS_NODES)?, shapes: of_shapes });
        }
        Ok(Some(shapes))
    }
}

fn flat<const N: usize>(lists: &[Vec<[f64; N]>]) -> Vec<&[f64]> {
    lists.iter().map(|list| list.as_flattened()).collect()
}

fn vectors<const N: usize>(lists: Vec<Vec<f64>>) -> Vec<Vec<[f64; N]>> {
    lists.into_iter().map(|list| list.as_chunks().0.to_vec()).collect()
}
