//! The numbers of a reduced body that other programs ask for, Eq. (M17) of `docs/method/modes.md`.

use diagnostic::Failure;
use dynamics::{PointShapes, RotationShapes};
use faer::Mat;
use model::{BodyMarker, MarkerPart, Model, UnknownTurns};
use nalgebra::{Matrix3, Matrix6, Vector3};
use scene::{Body, key_path};

use super::interface::Place;
use crate::commands::modes::require_flexible;

/// Rigid shapes before the flexible ones.
const RIGID: usize = 6;

/// A body with flexible modes of modal mass 1. Positions are from its origin: the center of mass of a free body, the support of one that
/// is held.
pub struct Reduced<'a> {
    /// Title of the scene.
    pub title: &'a str,
    /// Its mass.
    pub mass: f64,
    /// Center of mass.
    pub center: Vector3<f64>,
    /// Inertia about the origin.
    pub inertia: Matrix3<f64>,
    /// Inertia about the center of mass.
    pub central_inertia: Matrix3<f64>,
    /// Mass matrix of the motions of the base.
    pub rigid_mass: Matrix6<f64>,
    /// Circular frequencies (n).
    pub omegas: &'a [f64],
    /// Damping ratios (n).
    pub damping_ratios: &'a [f64],
    /// ∫ φ_k dm.
    pub momenta: Vec<Vector3<f64>>,
    /// ∫ X × φ_k dm.
    pub angular_momenta: Vec<Vector3<f64>>,
    /// P_k = ∫ φ_k Xᵀ dm.
    pub with_position: Vec<Matrix3<f64>>,
    /// E_ab: entry (j, k) is ∫ φ_j,a φ_k,b dm.
    products: &'a [[Mat<f64>; 3]; 3],
    /// Stiffness by spins of rate 1 about 11, 22, 33, 23, 13, 12; none where the body is not stiffened.
    pub spin_stiffness: Option<&'a [Mat<f64>; 6]>,
    /// Points of the output in the order of the scene, then markers.
    pub nodes: Vec<Node>,
    /// Places of the markers of a free body: the interface. None where turns of a marker are unknown.
    pub interface: Vec<Place>,
    /// Names of the markers of a free body.
    pub markers: Vec<&'a str>,
    /// Names of those of them whose turns the nodes do not tell.
    pub without_turns: Vec<&'a str>,
    /// Names of points and markers whose turns the nodes do not tell: they turn as the base does.
    pub nodes_without_turns: Vec<&'a str>,
}

/// A place of the body.
pub struct Node {
    pub name: String,
    pub position: Vector3<f64>,
    /// Its displacement in each mode.
    pub shapes: Vec<Vector3<f64>>,
    /// Its rotation in each mode.
    pub turns: Vec<Vector3<f64>>,
}

impl<'a> Reduced<'a> {
    /// The numbers of a model, with points of the output and then markers as nodes.
    pub fn new(given: &'a Body, model: &'a Model) -> Result<Self, Failure> {
        require_flexible(given, model)?;
        if !model.large_modes().is_empty() {
            let help = "set `large_deflection = false` in [effects] for the linear body";
            let found = "a body with large modes, which none of these forms knows";
            return Err(given.refuse("modes.large", found, "a body whose modes are small", help).into());
        }
        let body = &model.body;
        let count = body.flexible();
        let turns = match model.has_point_rotations() {
            true => model.point_rotations(given)?,
            false => {
                let unknown = Mat::zeros(3, count);
                model.points.iter().map(|_| RotationShapes::new(body, unknown.as_ref())).collect()
            }
        };
        let node = |name: &str, position: Vector3<f64>, shapes: &[Vector3<f64>], turns: &[Vector3<f64>]| Node {
            name: name.to_owned(),
            position,
            shapes: shapes[RIGID..].to_vec(),
            turns: turns[RIGID..].to_vec(),
        };
        let mut points: Vec<_> = model.points.iter().zip(&turns).collect();
        points.sort_by_cached_key(|((name, _), _)| place_of_point(given, name));
        let of_points = points
            .iter()
            .map(|((name, point), turn)| node(name, point.position_body(), point.columns(), turn.columns()));
        let markers = model.markers.iter().map(|BodyMarker { name, point, turning, .. }| {
            node(name, point.position_body(), point.columns(), turning.columns())
        });
        let is_known = |marker: &&BodyMarker| marker.unknown_turns == UnknownTurns::None || marker.by_nodes;
        let free = model.markers.iter().filter(|_| body.motion.is_free());
        let name = |marker: &'a BodyMarker| &marker.name[..];
        let without_turns: Vec<&str> = free.clone().filter(|marker| !is_known(marker)).map(name).collect();
        let unknown_points: Vec<&str> = match model.has_point_rotations() {
            true => Vec::new(),
            false => points.iter().map(|((name, _), _)| &name[..]).collect(),
        };
        let unknown_markers = model.markers.iter().filter(|marker| !is_known(marker)).map(name);
        let nodes_without_turns = unknown_points.into_iter().chain(unknown_markers).collect();
        let interface = if without_turns.is_empty() { free.clone().flat_map(places).collect() } else { Vec::new() };
        let of = |parts: &'a [Vec<f64>; 3]| -> Vec<Vector3<f64>> {
            (0..count).map(|k| Vector3::from_fn(|i, _| parts[i][k])).collect()
        };
        Ok(Self {
            title: &given.title,
            mass: body.mass,
            center: body.center_of_mass - body.origin,
            inertia: body.inertia,
            central_inertia: body.inertia_about_center(),
            rigid_mass: body.rigid_mass(),
            omegas: &body.circular_frequencies,
            damping_ratios: model.damping_ratios(),
            momenta: of(&body.translation_first),
            angular_momenta: of(&body.rotation_first),
            with_position: (0..count)
                .map(|k| Matrix3::from_fn(|a, b| body.position_products[a][b][RIGID + k]))
                .collect(),
            products: &body.rotation_products,
            spin_stiffness: body.stress_stiffness.as_ref(),
            nodes: of_points.chain(markers).collect(),
            interface,
            markers: free.map(name).collect(),
            without_turns,
            nodes_without_turns,
        })
    }

    /// Number of modes.
    pub fn count(&self) -> usize {
        self.omegas.len()
    }

    /// ∫ φ_j φ_kᵀ dm.
    pub fn product(&self, j: usize, k: usize) -> Matrix3<f64> {
        Matrix3::from_fn(|a, b| self.products[a][b][(RIGID + j, RIGID + k)])
    }

    /// ∫ φ_j × φ_k dm.
    pub fn cross(&self, j: usize, k: usize) -> Vector3<f64> {
        let p = self.product(j, k);
        Vector3::new(p[(1, 2)] - p[(2, 1)], p[(2, 0)] - p[(0, 2)], p[(0, 1)] - p[(1, 0)])
    }

    /// `−∫ [X×][φ_k×] dm`.
    pub fn cross_with_position(&self, k: usize) -> Matrix3<f64> {
        let p = &self.with_position[k];
        Matrix3::identity() * p.trace() - p
    }

    /// `∫ [φ_j×][φ_k×] dm`.
    pub fn double_cross(&self, j: usize, k: usize) -> Matrix3<f64> {
        let p = self.product(j, k);
        p.transpose() - Matrix3::identity() * p.trace()
    }

    /// Viscous damping 2ζω of a mode.
    pub fn damping(&self, k: usize) -> f64 {
        2.0 * self.damping_ratios[k] * self.omegas[k]
    }
}

/// Line and column of a point of the output in the scene file.
fn place_of_point(body: &Body, name: &str) -> (usize, usize) {
    let place = body.place(&key_path("output.points", name));
    (place.line, place.column)
}

/// The places of a marker.
fn places(marker: &BodyMarker) -> Vec<Place> {
    let BodyMarker { point, turning, parts, by_nodes, .. } = marker;
    let place = |point: &PointShapes, turning: &RotationShapes| Place {
        position: point.position_body(),
        shapes: point.columns()[RIGID..].to_vec(),
        turns: (!by_nodes).then(|| turning.columns()[RIGID..].to_vec()),
    };
    match parts.is_empty() {
        true => vec![place(point, turning)],
        false => parts.iter().map(|MarkerPart { point, turning }| place(point, turning)).collect(),
    }
}
