//! Plane mechanisms of rigid bodies, with revolutes in space.

use dynamics::{
    ConservativeBody, Coordinate, Joint, JointForce, Marker, MotionState, Physics, SharedLoad, System, SystemMotion,
};
use nalgebra::{Matrix3, Vector3};
use reduced_body::{ReducedBody, RigidMotion};
use rigid_kin::Attitude;

/// A rigid body at rest, its axes along the global ones.
pub fn at_rest(origin_global: Vector3<f64>) -> MotionState {
    MotionState {
        time: 0.0,
        attitude: Attitude::identity(),
        origin_global,
        velocity_global: Vector3::zeros(),
        omega_body: Vector3::zeros(),
        modal_displacement: Vec::new(),
        modal_velocity: Vec::new(),
    }
}

/// A rigid body with its centre of mass at a place, turned by an angle about z.
pub struct Link {
    pub mass: f64,
    pub inertia: Vector3<f64>,
    pub center: [f64; 2],
    pub angle: f64,
    pub loads: Vec<SharedLoad>,
}

/// Links and the joints between them.
#[derive(Default)]
pub struct Mechanism {
    links: Vec<Link>,
    joints: Vec<Joint>,
}

impl Mechanism {
    /// Adds a link; returns its number.
    pub fn link(&mut self, link: Link) -> usize {
        self.links.push(link);
        self.links.len() - 1
    }

    fn turn(angle: f64) -> Attitude {
        Attitude::identity().advanced_by(&Vector3::new(0.0, 0.0, angle))
    }

    /// A marker at a place of the plane.
    pub fn marker(&self, body: Option<usize>, at: [f64; 2]) -> Marker {
        let at = Vector3::new(at[0], at[1], 0.0);
        let Some(body) = body else { return Marker::on_ground(at, Matrix3::identity()) };
        let Link { center, angle, .. } = &self.links[body];
        let arm = at - Vector3::new(center[0], center[1], 0.0);
        Marker::on_rigid(body, Self::turn(*angle).to_body(&arm), Matrix3::identity())
    }

    /// Adds a hinge about z at a place of the plane.
    pub fn hinge(&mut self, bodies: [Option<usize>; 2], at: [f64; 2]) {
        self.joint(Joint::revolute, bodies, at);
    }

    /// Adds a joint at a place of the plane.
    pub fn joint(&mut self, joint: impl Fn(&str, [Marker; 2]) -> Joint, bodies: [Option<usize>; 2], at: [f64; 2]) {
        let markers = bodies.map(|body| self.marker(body, at));
        self.joints.push(joint(&format!("joint {}", self.joints.len()), markers));
    }

    /// Adds a moment about the last hinge.
    pub fn with_force(&mut self, force: JointForce) {
        if let Some(joint) = self.joints.pop() {
            self.joints.push(joint.with_force(Coordinate::Turn, force));
        }
    }

    /// The mechanism at rest.
    pub fn rests(self) -> SystemMotion {
        let still = vec![([0.0; 2], 0.0); self.links.len()];
        self.starts(&still)
    }

    /// The mechanism in motion, from velocities (in the plane) and angular velocities of its links.
    pub fn starts(self, velocities: &[([f64; 2], f64)]) -> SystemMotion {
        let bodies = self.links.iter().map(|link| {
            let inertia = Matrix3::from_diagonal(&link.inertia);
            let reduced = ReducedBody::rigid(link.mass, Vector3::zeros(), inertia, RigidMotion::free()).unwrap();
            ConservativeBody::new(&reduced, &[], link.loads.clone(), &Physics::default()).unwrap()
        });
        let system = System::new(bodies.collect(), self.joints).unwrap();
        let states: Vec<MotionState> = self
            .links
            .iter()
            .zip(velocities)
            .map(|(link, ([vx, vy], spin))| MotionState {
                time: 0.0,
                attitude: Self::turn(link.angle),
                origin_global: Vector3::new(link.center[0], link.center[1], 0.0),
                velocity_global: Vector3::new(*vx, *vy, 0.0),
                omega_body: Vector3::new(0.0, 0.0, *spin),
                modal_displacement: Vec::new(),
                modal_velocity: Vec::new(),
            })
            .collect();
        SystemMotion::new(system, &states).unwrap()
    }
}

/// Angle of a body about z, from −π to π.
pub fn angle(motion: &SystemMotion, body: usize) -> f64 {
    let [w, _, _, z] = motion.state(body).unwrap().attitude.wxyz();
    2.0 * z.atan2(w)
}
