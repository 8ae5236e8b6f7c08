//! Doubts about a scene and its mesh, before anything expensive is computed: mostly slips of units.

use std::fmt;

use fem_tet10::{Material, Materials, Mesh, centroid_lumped_inertia};
use scene::{Body, Load, LoadKind, MeshedBody};

/// Added mass over the mass of the mesh from which on it is told: a satellite's bus on its panels is below.
const HEAVY: f64 = 100.0;
/// Deflection over length from which on it is told.
const FAR: f64 = 5.0;

/// A sentence about a scene and its mesh, which can be computed with all the same.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub enum Doubt {
    /// The point masses outweigh the mesh by far.
    AddedMass {
        /// The keys of the scene that have them.
        keys: &'static str,
        /// Their sum.
        added: f64,
        /// The mass of the mesh.
        own: f64,
    },
    /// A load would bend a bar of the body's size by several times its length.
    Deflection {
        /// Number of the load in the scene, from 0.
        load: usize,
        /// Deflection of the bar over its length.
        deflection: f64,
    },
}

impl fmt::Display for Doubt {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::AddedMass { keys, added, own } => write!(
                f,
                "{keys}: they sum to {added:.4e}, {:.1e} times the mass of the mesh, {own:.4e}: check them, and the \
                 density, against the unit of mass of the scene",
                added / own
            ),
            Self::Deflection { load, deflection } => write!(
                f,
                "loads[{load}]: it would bend a solid bar of this size and material, held at one end, by {deflection:.1e} times its \
                 length: check its amplitude, Young's modulus and the density against the units of the scene"
            ),
        }
    }
}

/// Doubts about a scene whose body is made of these elements, and about loads of it.
pub fn doubts(body: &Body, loads: &[Load], meshed: &MeshedBody, mesh: &Mesh) -> Vec<Doubt> {
    added_mass(meshed, mesh).into_iter().chain(deflections(body, loads, meshed, mesh)).collect()
}

fn added_mass(meshed: &MeshedBody, mesh: &Mesh) -> Option<Doubt> {
    let keys = match (meshed.point_masses.is_empty(), meshed.tied_masses.is_empty()) {
        (false, true) => "body.point_masses",
        (true, _) => "body.tied_masses",
        (false, false) => "body.point_masses, body.tied_masses",
    };
    let on_body = meshed.point_masses.iter().map(|mass| mass.mass);
    let added: f64 = on_body.chain(meshed.tied_masses.iter().map(|mass| mass.mass)).sum();
    if added == 0.0 {
        return None;
    }
    // What is wrong with materials and groups is told by the assembly.
    let own = centroid_lumped_inertia(mesh, &meshed.materials, &[]).ok()?.mass;
    (added > HEAVY * own).then_some(Doubt::AddedMass { keys, added, own })
}

/// Loads of a held body that would bend a solid bar of the size of its mesh far, which is of its stiffest and its lightest
/// material and held at one end. A free body is bent by a part of that only.
fn deflections(body: &Body, loads: &[Load], meshed: &MeshedBody, mesh: &Mesh) -> Vec<Doubt> {
    if body.constraint.is_none() {
        return Vec::new();
    }
    let materials = |pick: fn(&Material) -> f64, better: fn(f64, f64) -> f64| match &meshed.materials {
        Materials::Uniform(material) => pick(material),
        Materials::ByGroup(each) => each.values().map(pick).reduce(better).unwrap_or(f64::NAN),
    };
    let young_modulus = materials(|material| material.young_modulus, f64::max);
    let density = materials(|material| material.density, f64::min);
    let bar = Bar::new(mesh.size(), young_modulus);
    let of_load = |load: &Load| match load.kind {
        LoadKind::Force => bar.under_force(load.direction, load.amplitude),
        // Its weight w, all along it: w L³/8EI, where a force at the end has w L³/3EI.
        LoadKind::Gravity | LoadKind::BaseAcceleration => {
            3.0 / 8.0 * bar.under_force(load.direction, density * load.amplitude * bar.volume)
        }
        LoadKind::Moment | LoadKind::Pressure | LoadKind::Traction => 0.0,
    };
    (loads.iter().enumerate())
        .map(|(load, acts)| Doubt::Deflection { load, deflection: of_load(acts) })
        .filter(|doubt| matches!(doubt, Doubt::Deflection { deflection, .. } if *deflection > FAR))
        .collect()
}

/// A solid bar that fills the box around the mesh.
struct Bar {
    volume: f64,
    /// Deflection over length of its end under a force along each axis: L²/3EI across it, 1/EA along it.
    compliance: [f64; 3],
}

impl Bar {
    fn new(size: [f64; 3], young_modulus: f64) -> Self {
        let along = (0..3).max_by(|&i, &j| size[i].total_cmp(&size[j])).unwrap_or(0);
        let (length, volume) = (size[along], size.iter().product::<f64>());
        let area = volume / length;
        let compliance = std::array::from_fn(|axis| {
            if axis == along {
                return 1.0 / (young_modulus * area);
            }
            // A h²/12.
            let second_moment = area * size[axis].powi(2) / 12.0;
            length.powi(2) / (3.0 * young_modulus * second_moment)
        });
        Self { volume, compliance }
    }

    /// Deflection over length under a force at its end in this direction, at the most along one of the axes.
    fn under_force(&self, direction: [f64; 3], force: f64) -> f64 {
        let parts = direction.iter().zip(self.compliance).map(|(part, compliance)| (part * force * compliance).abs());
        parts.fold(0.0, f64::max)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Closed form: FL²/(3EI) over the length, and F/(EA).
    #[test]
    fn a_bar_bends_as_in_closed_form() {
        let (length, width, height, young) = (200.0, 10.0, 4.0, 2e5);
        let bar = Bar::new([width, length, height], young);
        let inertia = width * height.powi(3) / 12.0;
        let exact = 3.0 * length.powi(3) / (3.0 * young * inertia) / length;
        assert!((bar.under_force([0.0, 0.0, 1.0], 3.0) / exact - 1.0).abs() < 1e-12);
        let along = 3.0 / (young * width * height);
        assert!((bar.under_force([0.0, -1.0, 0.0], 3.0) / along - 1.0).abs() < 1e-12);
    }
}
