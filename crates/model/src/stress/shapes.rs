//! The stress of a body in its modal coordinates.
//!
//! ```text
//! σ = Σ_a ξ_a σ(ψ_a) + Σ_α q^α Σ_{β+γ=α} C:½ε₂(u_β, u_γ)        α: products of large modes and of those that follow
//! ```
//!
//! Without large modes ξ is q, and the second sum is not there. About a bent reference its stress is added ([`stress_about`](super::about::stress_about)). With them the strain of the displacement alone is wrong:
//! what draws a bent body in would count as compression, which the rotations of its parts balance. So the sum is the second
//! Piola–Kirchhoff stress, complete to third order in the large modes; as long as strains are small, it is the true stress
//! in axes that turn with the material.

use dynamics::{Manifold, Observation};
use faer::Mat;
use fem_tet10::{StressSites, von_mises};
use modal::{Modes, side_by_side};
use nalgebra::Vector3;

use crate::error::{BuildError, refuse};
use crate::needs::Needed;
use crate::reduction::mesh_model::MeshModel;
use crate::stress::left_out::LeftOut;
use crate::stress::products::ProductStrains;
use crate::stress::site::{SiteStress, combined};
use crate::structure::Structure;

/// The stress of a body in its coordinates ([`BodyStress::coordinates`]), force per area, body axes, in the order of
/// [`fem_tet10::COMPONENTS`]: Eq. (S2) of `docs/method/stress.md`.
#[derive(Debug)]
pub struct BodyStress {
    manifold: Option<Manifold>,
    /// True if the stress of a bent reference is that of a coordinate of 1, after those of the shapes.
    has_reference: bool,
    /// For each point of the output, for each material there, the stress of each coordinate; none if not asked for.
    points: Vec<Vec<Vec<[f64; 6]>>>,
    field: Option<Field>,
    left_out: Option<LeftOut>,
}

/// The stress of the whole mesh.
#[derive(Debug)]
struct Field {
    sites: StressSites,
    shapes: SiteStress,
}

/// Where the von Mises stress is largest at some time.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct StressPeak {
    /// The stress, force per area.
    pub von_mises: f64,
    /// The node.
    pub node: u32,
    /// The von Mises stress, there, of what the modes leave out of the static response to the loads and the spin.
    pub left_out: f64,
    /// Its largest one anywhere.
    pub max_left_out: f64,
}

impl BodyStress {
    /// The stress that the scene asks for, if any. `large` are the manifold of the large modes and its extended shapes.
    pub(crate) fn new(
        model: &MeshModel<'_, '_>,
        modes: &Modes,
        large: Option<(&Manifold, &Modes)>,
        origin: &Vector3<f64>,
        has_gravity: bool,
    ) -> Result<Option<Self>, BuildError> {
        let &MeshModel { scene, mesh, structure, .. } = model;
        let &Needed { stress, peak_stress, stress_field, .. } = scene;
        if !scene.any_stress() {
            return Ok(None);
        }
        let nodal = of_coordinates(structure, modes, large)?;
        let has_reference = model.reference.is_some();
        let sites = structure.stress_sites()?;
        let mut points = Vec::new();
        for (name, at) in scene.output.points.iter().filter(|_| stress) {
            let location = mesh.locate(*at).map_err(|error| refuse(scene, &format!("output.points.{name}"), error))?;
            let of_material = |weights: Vec<(usize, f64)>| -> Vec<[f64; 6]> {
                let value = |k: usize, c: usize| weights.iter().map(|(site, w)| w * nodal[(6 * site + c, k)]).sum();
                (0..nodal.ncols()).map(|k| std::array::from_fn(|c| value(k, c))).collect()
            };
            points.push(sites.at(&location).into_iter().map(of_material).collect());
        }
        let field =
            (peak_stress || stress_field).then(|| Field { sites: sites.clone(), shapes: SiteStress::new(&nodal) });
        let left_out = if peak_stress { Some(LeftOut::new(model, modes, origin, has_gravity)?) } else { None };
        Ok(Some(Self { manifold: large.map(|(manifold, _)| manifold.clone()), has_reference, points, field, left_out }))
    }

    /// Number of points of the output whose stress is known.
    pub fn points(&self) -> usize {
        self.points.len()
    }

    /// The stress of a unit of each coordinate at the points of the output, for each material there.
    pub fn of_points(&self) -> &[Vec<Vec<[f64; 6]>>] {
        &self.points
    }

    /// The stress at all points; where materials meet, that of the material with the larger von Mises stress.
    pub fn at_points(&self, modal_displacement: &[f64]) -> impl Iterator<Item = [f64; 6]> + '_ {
        let coordinates = self.coordinates(modal_displacement);
        self.points.iter().map(move |materials| larger(materials.iter().map(|shapes| combined(shapes, &coordinates))))
    }

    /// The largest von Mises stress of the body as it is now; none if it was not asked for. Its work goes with the mesh.
    pub fn peak(&self, now: &Observation) -> Option<StressPeak> {
        let (Field { sites, shapes }, left_out) = (self.field.as_ref()?, self.left_out.as_ref()?);
        let coordinates = self.coordinates(&now.modal_displacement);
        let (site, peak) = shapes.largest(&coordinates)?;
        let missing = left_out.amplitudes(now);
        let max_left_out = left_out.stress.largest(&missing).map_or(0.0, |(_, largest)| largest);
        let node = sites.nodes()[site];
        Some(StressPeak { von_mises: peak, node, left_out: left_out.stress.at(site, &missing), max_left_out })
    }

    /// The stress at all sites at some modal displacements; none where that of the whole body was not asked for.
    pub(crate) fn at_sites(&self, modal_displacement: &[f64]) -> Option<Vec<[f64; 6]>> {
        let Field { sites, shapes } = self.field.as_ref()?;
        let coordinates = self.coordinates(modal_displacement);
        Some((0..sites.len()).map(|site| combined(shapes.of_site(site), &coordinates)).collect())
    }

    /// The nodes that stress is known at (m), once for each material there, and the stress of a unit of each coordinate, one
    /// after the other (each m × 6); none without [`Needs::stress_field`](crate::Needs::stress_field).
    pub(crate) fn field(&self) -> Option<(&[u32], Vec<Vec<f64>>)> {
        let Field { sites, shapes } = self.field.as_ref()?;
        let of_coordinate = |k: usize| (0..sites.len()).flat_map(|site| shapes.of_site(site)[k]).collect();
        Some((sites.nodes(), (0..shapes.coordinates()).map(of_coordinate).collect()))
    }

    /// The stress of a unit of each coordinate at a node, once for each material there.
    fn at_node(&self, node: u32) -> impl Iterator<Item = &[[f64; 6]]> {
        let of_field = |field: &'_ Field| field.sites.of_node(node);
        let sites = self.field.as_ref().map_or(0..0, of_field);
        sites.filter_map(|site| Some(self.field.as_ref()?.shapes.of_site(site)))
    }

    /// The stress at a node in these [`coordinates`](Self::coordinates), of the material with the larger von Mises stress; zero
    /// without [`Needs::stress_field`](crate::Needs::stress_field).
    ///
    /// # Panics
    /// Where there is no such node.
    pub fn in_coordinates(&self, node: u32, coordinates: &[f64]) -> [f64; 6] {
        larger(self.at_node(node).map(|shapes| combined(shapes, coordinates)))
    }

    /// The coordinates of the stress: those of the modes and of the shapes that follow them
    /// ([`Model::coordinates`](crate::Model::coordinates)), a one for a bent reference that the modes are about, then the products of
    /// the modes that bend the body.
    pub fn coordinates(&self, modal_displacement: &[f64]) -> Vec<f64> {
        let q = modal_displacement;
        let one = self.has_reference.then_some(1.0);
        let Some(manifold) = &self.manifold else { return q.iter().copied().chain(one).collect() };
        let mut coordinates = vec![0.0; manifold.body().flexible()];
        manifold.coordinates(q, &mut coordinates);
        coordinates.extend(one);
        coordinates.extend(manifold.products().iter().map(|product| product.iter().map(|k| q[*k]).product::<f64>()));
        coordinates
    }
}

/// The one with the larger von Mises stress.
pub(crate) fn larger(stresses: impl Iterator<Item = [f64; 6]>) -> [f64; 6] {
    stresses.max_by(|a, b| von_mises(a).total_cmp(&von_mises(b))).unwrap_or_default()
}

/// The stress (6m × …) of each coordinate at the sites.
fn of_coordinates(
    structure: &Structure<'_>,
    modes: &Modes,
    large: Option<(&Manifold, &Modes)>,
) -> Result<Mat<f64>, BuildError> {
    let of_reference = structure.reference_stress()?;
    let Some((manifold, extended)) = large else {
        let found = structure.nodal_stress(modes.shapes.as_ref(), modes.shapes.get(.., ..0), &[])?;
        return Ok(match &of_reference {
            Some(of_reference) => side_by_side(&[found.as_ref(), of_reference.as_ref()]),
            None => found,
        });
    };
    let strains = ProductStrains::new(manifold, extended.shapes.as_ref());
    let found = structure.nodal_stress(extended.shapes.as_ref(), strains.fields.as_ref(), &strains.pairs)?;
    let shapes = extended.shapes.ncols();
    let of_products = strains.stress(found.get(.., shapes..));
    let of_reference = of_reference.as_ref().map(Mat::as_ref);
    let all = [Some(found.get(.., ..shapes)), of_reference, Some(of_products.as_ref())];
    Ok(side_by_side(&all.into_iter().flatten().collect::<Vec<_>>()))
}
