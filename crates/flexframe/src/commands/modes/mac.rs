//! Modal assurance criterion of the modes of two bodies, Eq. (M16) of `docs/method/modes.md`: their shapes at the same places.

use std::path::Path;

use faer::{Col, Mat};
use fem_tet10::Location;
use model::{BuildError, BuildProgress, Builder, Meshed, Model, Needs};
use rayon::prelude::*;
use report::{Form, Report, Table};
use scene::{Body, BodySource, FileBody, MeshedBody};

use super::scenes::require_flexible;
use crate::files::given_file::GivenFile;

/// Nodes at which shapes are compared, at the most.
const PLACES: usize = 1000;
/// Farthest that a place may be from the other body, relative to the size of this one.
const APART: f64 = 0.02;
/// Two shapes that are the same, in words.
const SAME: f64 = 0.9;

/// The scene of the other body: a scene file's, or this scene with another mesh or body file.
fn scene_of(given: &Body, other: &Path) -> Result<Body, BuildError> {
    let body = match (GivenFile::of(other), &given.source) {
        (Some(GivenFile::Scene), _) => return Ok(Body::read(other)?),
        (Some(GivenFile::Body), _) => BodySource::File(FileBody {
            file: other.to_owned(),
            mesh: None,
            mesh_size: None,
            raise_order: false,
            materials: None,
            point_masses: None,
        }),
        (_, BodySource::Meshed(body)) => BodySource::Meshed(MeshedBody { mesh: other.to_owned(), ..body.clone() }),
        _ => {
            let found = format!("{}, a mesh for a body that has none to replace", other.display());
            return Err(given
                .refuse("body", found, "a scene or a body file", "give --mac a scene or a body file")
                .into());
        }
    };
    Ok(Body { source: body, ..given.clone() })
}

/// Compares the modes of a body with those of another one: of a scene file, or of this scene with another mesh or body file. The other
/// body has to lie where this one does. The report of the modes has then the criterion, 0 to 1, in a row for each mode of this body and a
/// column for each one of the other.
///
/// # Errors
/// [`BuildError`] of the other body, of bodies that lie apart, and of those without flexible modes.
pub fn mac(
    body: &Body,
    model: &Model,
    other: &Path,
    builder: &Builder,
    report: &mut Report,
    progress: impl FnMut(BuildProgress),
) -> Result<(), BuildError> {
    let own = require_flexible(body, model)?;
    let with = scene_of(body, other)?;
    let other_model = builder.needing(Needs::modes()).build(&with, progress)?;
    let others = require_flexible(&with, &other_model)?;
    let (own_shapes, other_shapes, distance) = at_places(own, others);
    let relative = distance / own.mesh.diagonal();
    if relative > APART {
        let found = format!("{}, whose body is {distance:.4} away from a node of this one", other.display());
        let expected = "a body that lies where this one does";
        return Err(body.refuse("body", found, expected, "compare bodies in the same place and units").into());
    }
    let norms = |shapes: &Mat<f64>| Col::from_iter(shapes.col_iter().map(|shape| shape.squared_norm_l2()));
    let (of_own, of_other) = (norms(&own_shapes), norms(&other_shapes));
    let products = own_shapes.transpose() * &other_shapes;
    let row = |j: usize| (0..products.ncols()).map(|k| products[(j, k)].powi(2) / (of_own[j] * of_other[k])).collect();
    let mac: Vec<Vec<f64>> = (0..products.nrows()).map(row).collect();
    let nearest = |row: &Vec<f64>| (0..row.len()).max_by(|a, b| row[*a].total_cmp(&row[*b])).unwrap_or(0);
    let nearest: Vec<usize> = mac.iter().map(nearest).collect();
    let (places, frequencies) = (own_shapes.nrows() / 3, other_model.natural_frequencies());
    report.put("mac.other", other.display().to_string());
    report.put("mac.places", places);
    report.put("mac.distance", relative);
    report.put("mac.frequencies", &frequencies[..]);
    report.put("mac.nearest", nearest.iter().map(|of| of + 1).collect::<Vec<_>>());
    report.put("mac.mac", &mac[..]);
    let likeness = || mac.iter().zip(&nearest).map(|(row, of)| row[*of]);
    let there = || nearest.iter().map(|of| frequencies[*of]);
    let change = there().zip(model.natural_frequencies()).map(|(there, here)| 100.0 * (there / here - 1.0));
    let doubt = likeness().map(|mac| if mac < SAME { "no mode there is the same" } else { "" });
    report.table(
        Table::new("mac", None)
            .titled(format!("beside {}, at {places} nodes", other.display()))
            .all()
            .text_only("mode", Form::Plain, 1..=mac.len())
            .text_only("most like", Form::Plain, nearest.iter().map(|of| of + 1))
            .text_only("MAC", Form::Fixed(4), likeness())
            .text_only("frequency there", Form::Fixed(6), there())
            .text_only("", Form::Plain, change.map(|change| format!("({change:+.3} %)")))
            .text_only("", Form::Plain, doubt),
    );
    Ok(())
}

/// Shapes of both bodies at nodes of the first (3n×modes), and the largest distance of these to the second.
fn at_places(own: &Meshed, other: &Meshed) -> (Mat<f64>, Mat<f64>, f64) {
    let count = own.mesh.positions().len();
    let nodes: Vec<usize> = (0..count).step_by(count.div_ceil(PLACES)).collect();
    let (dofs, other_dofs) = (dofs(own), dofs(other));
    let located: Vec<(Location, f64)> = nodes
        .par_iter()
        .map(|node| {
            let at = own.mesh.positions()[*node];
            match other.mesh.locate(at) {
                Ok(location) => (location, 0.0),
                Err(_) => {
                    let (nearest, distance) = other.mesh.nearest_node(at);
                    (Location { nodes: vec![nearest], weights: vec![1.0] }, distance)
                }
            }
        })
        .collect();
    let shapes = &own.modes.shapes;
    let of_own = Mat::from_fn(3 * nodes.len(), shapes.ncols(), |i, k| shapes[(dofs * nodes[i / 3] + i % 3, k)]);
    let shapes = &other.modes.shapes;
    let of_other = Mat::from_fn(3 * nodes.len(), shapes.ncols(), |i, k| {
        let Location { nodes, weights } = &located[i / 3].0;
        nodes.iter().zip(weights).map(|(node, w)| w * shapes[(other_dofs * *node as usize + i % 3, k)]).sum()
    });
    (of_own, of_other, located.iter().map(|(_, distance)| *distance).fold(0.0, f64::max))
}

/// Degrees of freedom of a node.
fn dofs(meshed: &Meshed) -> usize {
    meshed.checks.map_or(3, |checks| checks.dofs)
}
