//! The stress of a body in its modal coordinates.
//!
//! ```text
//! σ = Σ_a ξ_a σ(ψ_a) + Σ_jk q_j q_k C:½ε₂(φ_j, φ_k)        j, k of the large modes
//! ```
//!
//! Without large modes ξ is q, and the second sum is not there. With them the strain of the displacement alone is wrong:
//! what draws a bent body in would count as compression, which the rotations of its parts balance. So the sum is the second
//! Piola–Kirchhoff stress, complete to second order in the large modes; as long as strains are small, it is the true stress
//! in axes that turn with the material.

use faer::Mat;
use fem_tet10::{StressRecovery, von_mises};
use frames_rk4::{Manifold, Observation};
use modal::{Modes, SecondOrderShapes};
use nalgebra::Vector3;

use super::error::{BuildError, refuse};
use super::mesh_model::MeshModel;
use super::site_stress::{SiteStress, combined};
use super::stress_left_out::LeftOut;

/// The stress of a body in its modal coordinates, force per area, body axes, in the order of [`fem_tet10::COMPONENTS`].
#[derive(Debug)]
pub struct BodyStress {
    manifold: Option<Manifold>,
    /// For each point of the output, for each material there, the stress of each coordinate; none if not asked for.
    points: Vec<Vec<Vec<[f64; 6]>>>,
    whole: Option<Whole>,
}

/// The stress of the whole mesh.
#[derive(Debug)]
struct Whole {
    /// Node of each site.
    nodes: Vec<u32>,
    shapes: SiteStress,
    left_out: LeftOut,
}

/// Where the von Mises stress is largest at some time.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct StressPeak {
    /// The stress, force per area.
    pub von_mises: f64,
    /// The node.
    pub node: u32,
    /// The von Mises stress, there, of what the modes leave out of the static answer to the loads and the spin.
    pub left_out: f64,
    /// Its largest one anywhere.
    pub most_left_out: f64,
}

impl BodyStress {
    /// What the scene asks for; nothing if it does not. `large` are the manifold of the large modes and its extended shapes.
    pub(super) fn new(
        model: &MeshModel<'_>,
        modes: &Modes,
        large: Option<(&Manifold, &Modes)>,
        origin: &Vector3<f64>,
        has_gravity: bool,
    ) -> Result<Option<Self>, BuildError> {
        let &MeshModel { scene, mesh, body, .. } = model;
        let output = &scene.output;
        if !output.stress && !output.peak_stress {
            return Ok(None);
        }
        let recovery = StressRecovery::new(mesh, &body.materials)?;
        let nodal = match large {
            Some((manifold, extended)) => {
                let linear = recovery.nodal_stress(extended.shapes.as_ref())?;
                let of_large = Mat::from_fn(modes.shapes.nrows(), manifold.large().len(), |i, j| {
                    modes.shapes[(i, manifold.large()[j])]
                });
                let pairs = SecondOrderShapes::pairs(manifold.large().len());
                let second = recovery.second_order_nodal_stress(of_large.as_ref(), &pairs)?;
                let first = linear.ncols();
                Mat::from_fn(linear.nrows(), first + second.ncols(), |i, j| {
                    if j < first { linear[(i, j)] } else { second[(i, j - first)] }
                })
            }
            None => recovery.nodal_stress(modes.shapes.as_ref())?,
        };
        let sites = recovery.sites();
        let mut points = Vec::new();
        for (name, at) in scene.output.points.iter().filter(|_| output.stress) {
            let location = mesh.locate(*at).map_err(|error| refuse(scene, &format!("output.points.{name}"), error))?;
            let of_material = |weights: Vec<(usize, f64)>| -> Vec<[f64; 6]> {
                let value = |k: usize, c: usize| weights.iter().map(|(site, w)| w * nodal[(6 * site + c, k)]).sum();
                (0..nodal.ncols()).map(|k| std::array::from_fn(|c| value(k, c))).collect()
            };
            points.push(sites.at(&location).into_iter().map(of_material).collect());
        }
        let whole = if output.peak_stress {
            Some(Whole {
                nodes: sites.nodes().to_vec(),
                shapes: SiteStress::new(&nodal),
                left_out: LeftOut::new(model, modes, &recovery, origin, has_gravity)?,
            })
        } else {
            None
        };
        Ok(Some(Self { manifold: large.map(|(manifold, _)| manifold.clone()), points, whole }))
    }

    /// Whether the peak over the whole body was asked for.
    pub fn has_peak(&self) -> bool {
        self.whole.is_some()
    }

    /// Number of points of the output whose stress is known.
    pub fn points(&self) -> usize {
        self.points.len()
    }

    /// The stress at all points; where materials meet, that of the material with the larger von Mises stress.
    pub fn at_points(&self, modal_displacement: &[f64]) -> impl Iterator<Item = [f64; 6]> + '_ {
        let coordinates = self.coordinates(modal_displacement);
        self.points.iter().map(move |materials| {
            let stresses = materials.iter().map(|shapes| combined(shapes, &coordinates));
            stresses.max_by(|a, b| von_mises(a).total_cmp(&von_mises(b))).unwrap_or_default()
        })
    }

    /// The largest von Mises stress of the body as it is now; none if it was not asked for. Its work goes with the mesh.
    pub fn peak(&self, now: &Observation) -> Option<StressPeak> {
        let Whole { nodes, shapes, left_out } = self.whole.as_ref()?;
        let coordinates = self.coordinates(&now.modal_displacement);
        let (site, peak) = shapes.largest(&coordinates)?;
        let missing = left_out.amplitudes(now);
        let most_left_out = left_out.stress.largest(&missing).map_or(0.0, |(_, largest)| largest);
        let node = nodes[site];
        Some(StressPeak { von_mises: peak, node, left_out: left_out.stress.at(site, &missing), most_left_out })
    }

    /// ξ, then the products of the large modes.
    fn coordinates(&self, q: &[f64]) -> Vec<f64> {
        let Some(manifold) = &self.manifold else { return q.to_vec() };
        let mut coordinates = manifold.coordinates(q);
        let large = manifold.large();
        let product = |[i, j]: [usize; 2]| if i == j { 1.0 } else { 2.0 } * q[large[i]] * q[large[j]];
        coordinates.extend(SecondOrderShapes::pairs(large.len()).into_iter().map(product));
        coordinates
    }
}
