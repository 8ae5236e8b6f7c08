//! The rules on `[[loads]]`.

use dynamics::LoadFrame;

use super::Check;
use crate::body::constraint::Constraint;
use crate::document::join;
use crate::error::SceneError;
use crate::loads::load::{self, Load};
use crate::scene::Body;

impl Check<'_> {
    /// Checks the loads, normalises their directions and reads their tables.
    pub fn loads(&self, loads: &mut [Load], body: &Body, constraint: Option<&Constraint>) -> Result<(), SceneError> {
        let help = "put forces that go together into one traction or pressure on a physical surface";
        self.not_too_many("loads", loads.len(), help)?;
        for (i, load) in loads.iter_mut().enumerate() {
            let key = format!("loads[{i}]");
            if let Load::Pressure(_) | Load::Traction(_) = load {
                let key = join(&key, "group");
                self.needs_mesh(&key, body)?;
                if let Body::Matrices(_) = body {
                    return Err(self.document.place(&key).refuse(
                        "a surface of a body of matrices, which has no elements",
                        "loads at nodes",
                        "give the forces on nodes as loads `kind = \"force\"`, or give the body a mesh",
                    ));
                }
            }
            if let (Load::BaseAcceleration(_), None) = (&*load, constraint) {
                return Err(self.document.place(&join(&key, "kind")).refuse(
                    "the acceleration of the base of a free body",
                    "a body that something holds",
                    "add [[constraints]], or use `kind = \"gravity\"` for an acceleration of all of a free body",
                ));
            }
            if let Load::Moment(load::Moment { frame, .. }) | Load::Traction(load::Traction { frame, .. }) = load
                && *frame == LoadFrame::Material
            {
                return Err(self.document.place(&join(&key, "frame")).refuse(
                    "a moment or a traction that turns with the material",
                    "`global` or `body`",
                    "use a force for a direction that turns with the material at a point, or a pressure, which turns with its surface",
                ));
            }
            self.load(&key, load, body)?;
        }
        Ok(())
    }

    fn load(&self, key: &str, load: &mut Load, body: &Body) -> Result<(), SceneError> {
        let (direction, group, history) = match load {
            Load::Force(force) => (Some(&mut force.direction), None, &mut force.history),
            Load::Moment(moment) => {
                if let Some(radius) = moment.radius {
                    let key = join(key, "radius");
                    let help = "give the radius of the ball whose nodes take the moment, or remove `radius`";
                    self.positive(&key, radius, help)?;
                    self.needs_mesh(&key, body)?;
                }
                (Some(&mut moment.direction), None, &mut moment.history)
            }
            Load::Pressure(pressure) => (None, Some(&pressure.group), &mut pressure.history),
            Load::Traction(traction) => (Some(&mut traction.direction), Some(&traction.group), &mut traction.history),
            Load::Gravity(gravity) => (Some(&mut gravity.direction), None, &mut gravity.history),
            Load::BaseAcceleration(base) => (Some(&mut base.direction), None, &mut base.history),
        };
        if let Some(direction) = direction {
            let help = "give the direction of the load; its length does not matter";
            self.normalise(&join(key, "direction"), direction, help)?;
        }
        if let Some(group) = group {
            self.group(&join(key, "group"), group)?;
        }
        self.history(&join(key, "history"), history)
    }

    pub(super) fn group(&self, key: &str, group: &str) -> Result<(), SceneError> {
        let help = "give the name of a physical group of the mesh";
        self.require(!group.is_empty(), key, "a name that is not empty", help)
    }

    /// Refuses a key that speaks of nodes, on a body without a mesh.
    pub(super) fn needs_mesh(&self, key: &str, body: &Body) -> Result<(), SceneError> {
        match body {
            Body::Meshed(_) | Body::File(_) | Body::Matrices(_) => Ok(()),
            Body::Rigid(_) => Err(self.document.place(key).refuse(
                "a part of a mesh",
                "none, since `rigid` in [body] has no mesh",
                "use points (`at` alone) for loads, constraints and markers, or give `mesh` and `material` in [body] instead of `rigid`",
            )),
        }
    }
}
