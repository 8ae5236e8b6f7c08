//! The reactions of several supports, each for itself.

use dynamics::{EffectMap, Manifold, Observation, SupportReactions};
use faer::Mat;
use modal::Modes;
use nalgebra::Vector3;
use scene::Constraint;

use crate::error::BuildError;
use crate::needs::Needed;
use crate::reduction::mesh_model::MeshModel;
use crate::structure::kept::Basis;
use crate::support::held_parts;

/// Reactions of several supports: for each a force on the body, and a moment about the mean of the nodes that it holds.
#[derive(Debug, Clone)]
pub struct SupportRows {
    names: Vec<String>,
    /// Support and component of each motion: 0 to 2 of the force, 3 to 5 of the moment.
    components: Vec<(usize, usize)>,
    reactions: SupportReactions,
}

impl SupportRows {
    /// None where there are not several supports, or nobody asks.
    pub(crate) fn new(
        model: &MeshModel<'_, '_>,
        modes: &Modes,
        manifold: Option<&Manifold>,
        effects: &EffectMap<bool>,
        has_gravity: bool,
    ) -> Result<Option<Self>, BuildError> {
        let &MeshModel { scene, mesh, structure, .. } = model;
        let Some(parts) = several(scene) else { return Ok(None) };
        if model.reference.is_some() {
            let found = "modes about a bent body, whose supports' shares of the reaction are not known";
            let help = "remove `about`, or hold the body by one support";
            return Err(scene.refuse("modes.about", found, "one support", help).into());
        }
        let parts = held_parts(scene, mesh, parts)?;
        let (size, shapes) = (modes.shapes.nrows(), modes.shapes.ncols());
        let mut components = Vec::new();
        let mut columns: Vec<Vec<(usize, f64)>> = Vec::new();
        for (support, dofs) in parts.iter().enumerate() {
            let position = |node: u32| Vector3::from(mesh.positions()[node as usize]);
            let mut nodes: Vec<u32> = dofs.iter().map(|(node, _)| *node).collect();
            nodes.dedup();
            let center = nodes.iter().map(|node| position(*node)).sum::<Vector3<f64>>() / nodes.len().max(1) as f64;
            for component in 0..6 {
                let axis = Vector3::from_fn(|i, _| f64::from(u8::from(i == component % 3)));
                let moved = |node: u32| if component < 3 { axis } else { axis.cross(&(position(node) - center)) };
                let column: Vec<(usize, f64)> = dofs
                    .iter()
                    .map(|(node, direction)| (model.dofs * *node as usize + direction, moved(*node)[*direction]))
                    .filter(|(_, moved)| *moved != 0.0)
                    .collect();
                if !column.is_empty() {
                    components.push((support, component));
                    columns.push(column);
                }
            }
        }
        // The supports move by themselves.
        let mut motions = Mat::zeros(size, columns.len());
        for (c, column) in columns.iter().enumerate() {
            column.iter().for_each(|(row, moved)| motions[(*row, c)] = *moved);
        }
        let Basis { modes: extended, body } = structure.with_motions(modes, motions.as_ref())?;
        let acting = model.loads.iter().filter(|load| has_gravity || !load.is_gravity());
        // No stress, but the turn of a pressure with its surface, which the reaction of all supports has, too.
        let loads = acting
            .map(|load| load.reduced(scene, (mesh, model.positions), &body, &extended, &[], true))
            .collect::<Result<Vec<_>, _>>()?;
        let reactions = SupportReactions::new(&body, shapes, loads, manifold.cloned(), effects);
        Ok(Some(Self { names: (1..=parts.len()).map(|i| i.to_string()).collect(), components, reactions }))
    }

    /// Their names: their numbers in the scene, from 1.
    pub fn names(&self) -> &[String] {
        &self.names
    }

    /// Force and moment of each on the body, body axes.
    pub fn at(&self, now: &Observation) -> Vec<[Vector3<f64>; 2]> {
        let mut of_supports = vec![[Vector3::zeros(); 2]; self.names.len()];
        for ((support, component), value) in self.components.iter().zip(self.reactions.at(now)) {
            of_supports[*support][component / 3][component % 3] = value;
        }
        of_supports
    }
}

/// The supports of a scene that has several and whose rows have reactions.
fn several<'a>(scene: &'a Needed<'_>) -> Option<&'a [scene::HeldDirections]> {
    match scene.reduced_constraint() {
        Some(Constraint::Support { parts }) if parts.len() > 1 => Some(parts),
        _ => None,
    }
    .filter(|_| scene.support_reactions && scene.method().abilities.reactions)
    .map(Vec::as_slice)
}
