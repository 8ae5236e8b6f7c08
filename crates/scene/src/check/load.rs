//! The rules on `[[loads]]`.

use dynamics::LoadFrame;

use super::Check;
use crate::body::BodySource;
use crate::body::constraint::Constraint;
use crate::document::join;
use crate::error::SceneError;
use crate::loads::load::{Load, LoadKind, LoadPlace};

impl Check<'_> {
    /// Checks the loads, normalises their directions and reads their tables.
    pub fn loads(
        &self,
        loads: &mut [Load],
        body: &BodySource,
        constraint: Option<&Constraint>,
    ) -> Result<(), SceneError> {
        let help = "put forces that go together into one traction or pressure on a physical surface";
        self.not_too_many("loads", loads.len(), help)?;
        for (i, load) in loads.iter_mut().enumerate() {
            let key = format!("loads[{i}]");
            if let LoadPlace::Surface(group) = &load.place {
                let key = join(&key, "group");
                self.needs_mesh(&key, body)?;
                self.group(&key, group)?;
                if let BodySource::Matrices(_) = body {
                    return Err(self.document.place(&key).refuse(
                        "a surface of a body of matrices, which has no elements",
                        "loads at nodes",
                        "give the forces on nodes as loads `kind = \"force\"`, or give the body a mesh",
                    ));
                }
            }
            if load.kind == LoadKind::BaseAcceleration && constraint.is_none() {
                return Err(self.document.place(&join(&key, "kind")).refuse(
                    "the acceleration of the base of a free body",
                    "a body that something holds",
                    "add [[constraints]], or use `kind = \"gravity\"` for an acceleration of all of a free body",
                ));
            }
            if load.frame == LoadFrame::Material && load.kind != LoadKind::Force {
                return Err(self.document.place(&join(&key, "frame")).refuse(
                    "a moment or a traction that turns with the material",
                    "`global` or `body`",
                    "use a force for a direction that turns with the material at a point, or a pressure, which turns with its surface",
                ));
            }
            if let LoadPlace::Ball { radius, .. } = load.place {
                let key = join(&key, "radius");
                let help = "give the radius of the ball whose nodes take the moment, or remove `radius`";
                self.positive(&key, radius, help)?;
                self.needs_mesh(&key, body)?;
            }
            if load.kind != LoadKind::Pressure {
                let help = "give the direction of the load; its length does not matter";
                self.normalise(&join(&key, "direction"), &mut load.direction, help)?;
            }
            self.history(&join(&key, "history"), &mut load.history)?;
        }
        Ok(())
    }

    pub(super) fn group(&self, key: &str, group: &str) -> Result<(), SceneError> {
        let help = "give the name of a physical group of the mesh";
        self.require(!group.is_empty(), key, "a name that is not empty", help)
    }

    /// Refuses a key that speaks of nodes, on a body without a mesh.
    pub(super) fn needs_mesh(&self, key: &str, body: &BodySource) -> Result<(), SceneError> {
        match body {
            BodySource::Meshed(_) | BodySource::File(_) | BodySource::Matrices(_) => Ok(()),
            BodySource::Rigid(_) => Err(self.document.place(key).refuse(
                "a part of a mesh",
                "none, since `rigid` in [body] has no mesh",
                "use points (`at` alone) for loads, constraints and markers, or give `mesh` and `material` in [body] instead of `rigid`",
            )),
        }
    }
}
