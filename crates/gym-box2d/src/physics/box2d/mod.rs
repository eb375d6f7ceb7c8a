//! The exact engine: Box2D 2.3 in `f32`, to the last bit of pybox2d 2.3.10.
//!
//! The algorithms are Erin Catto's (sequential impulses with warm starting, islands, continuous
//! collision), written anew; see the notices. Everything iterates in Box2D's order, newest first,
//! because the order decides bits. What Gymnasium's environments do not need is left out: kinematic
//! bodies and bullets, damping, chains, other joints, filter groups.
//!
//! | file | idea | Box2D |
//! |---|---|---|
//! | `settings`, `math`, `trig`, `arena` | constants, vectors, sine and cosine, slots | `Common` |
//! | `shape` | mass, box and ray cast of a shape | `Collision/Shapes` |
//! | `broad_phase` | pairs of boxes | `b2BroadPhase`, `b2DynamicTree` |
//! | `manifold`, `collide*` | points of contact | `b2Collision`, `b2Collide*` |
//! | `distance`, `time_of_impact` | distance, first touch | `b2Distance`, `b2TimeOfImpact` |
//! | `body`, `contact`, `joint` | what the world consists of | `Dynamics` |
//! | `motion`, `contact_solver`, `joint`, `sweeps`, `island` | the solver | `b2ContactSolver`, `b2Island` |
//! | `step`, `continuous` | a step of the world | `b2World` |

mod arena;
pub(super) mod body;
mod broad_phase;
mod collide;
mod collide_edge;
mod collide_polygons;
mod contact;
mod contact_solver;
mod continuous;
mod distance;
pub(super) mod island;
pub(super) mod joint;
mod manifold;
pub(super) mod math;
pub(super) mod motion;
mod settings;
pub(super) mod shape;
mod step;
mod sweeps;
#[cfg(test)]
mod tests;
mod time_of_impact;
mod validate;

use serde::{Deserialize, Serialize};

use arena::Arena;
use body::{Body, Fixture};
use broad_phase::BroadPhase;
use contact::Contact;
use island::Island;
use joint::{Joint, LimitState};
use math::{Vec2, max2, min2};
use nalgebra::Vector3;
use shape::{Aabb, Geometry};

use super::{BodyDef, ContactEvent, FixtureDef, RayHit, RevoluteJointDef};

/// So many contacts, bodies and joints that change from step to step find room without allocating: more
/// than the environments ever have.
const CONTACTS: usize = 64;
const BODIES: usize = 32;
const JOINTS: usize = 8;

/// A world of Box2D's.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(super) struct Box2d {
    gravity: Vec2,
    pub(super) bodies: Arena<Body>,
    /// Dynamic bodies, oldest first.
    pub(super) dynamic: Vec<u32>,
    pub(super) fixtures: Arena<Fixture>,
    pub(super) joints: Arena<Joint>,
    /// Joints, oldest first.
    joint_order: Vec<u32>,
    /// Oldest first.
    pub(super) contacts: Vec<Contact>,
    broad_phase: BroadPhase,
    pub(super) new_fixture: bool,
    /// 1 / dt of the last step; 0 before the first.
    pub(super) inv_dt0: f32,
    #[serde(skip)]
    pub(super) events: Vec<ContactEvent>,
    #[serde(skip)]
    pub(super) island: Island,
    #[serde(skip)]
    pairs: Vec<(u32, u32)>,
}

/// Length and effort of a step.
#[derive(Clone, Copy, Debug)]
pub(super) struct TimeStep {
    pub(super) dt: f32,
    /// dt over that of the last step; 0 in the first.
    pub(super) ratio: f32,
    pub(super) velocity_iterations: u32,
    pub(super) position_iterations: u32,
}

impl Box2d {
    pub(crate) fn new(gravity: Vec2) -> Self {
        Self {
            gravity,
            bodies: Arena::default(),
            dynamic: Vec::new(),
            fixtures: Arena::default(),
            joints: Arena::default(),
            joint_order: Vec::new(),
            contacts: Vec::with_capacity(CONTACTS),
            broad_phase: BroadPhase::default(),
            new_fixture: false,
            inv_dt0: 0.0,
            events: Vec::with_capacity(CONTACTS),
            island: Island::new(),
            pairs: Vec::with_capacity(CONTACTS),
        }
    }

    pub(crate) fn create_body(&mut self, def: &BodyDef) -> u32 {
        let id = self.bodies.insert(Body::new(def.dynamic, def.position, def.angle));
        if def.dynamic {
            self.dynamic.push(id);
        }
        id
    }

    pub(crate) fn create_fixture(&mut self, body: u32, def: &FixtureDef) -> u32 {
        let shape = Geometry::from(&def.shape);
        let owner = &self.bodies[body];
        let (aabb, dynamic, next) = (shape.aabb(&owner.xf), owner.dynamic, owner.fixtures);
        let id = self.fixtures.insert(Fixture {
            body,
            shape,
            density: def.density,
            friction: def.friction,
            restitution: def.restitution,
            filter: def.filter,
            sensor: def.sensor,
            proxy: 0,
            next,
        });
        self.fixtures[id].proxy = self.broad_phase.insert(&aabb, id, dynamic);
        self.bodies[body].fixtures = Some(id);
        if def.density > 0.0 && dynamic {
            let fixtures = &self.fixtures;
            let newest_first = std::iter::successors(Some(id), |id| fixtures[*id].next);
            let massive = newest_first.map(|id| &fixtures[id]).filter(|fixture| fixture.density != 0.0);
            self.bodies[body].reset_mass(massive.map(|fixture| fixture.shape.mass(fixture.density)));
        }
        self.new_fixture = true;
        id
    }

    pub(crate) fn create_revolute_joint(&mut self, def: &RevoluteJointDef) -> u32 {
        let (a, b) = (def.body_a.0, def.body_b.0);
        let id = self.joints.insert(Joint {
            body_a: a,
            body_b: b,
            local_anchor_a: def.local_anchor_a,
            local_anchor_b: def.local_anchor_b,
            reference_angle: self.bodies[b].sweep.a - self.bodies[a].sweep.a,
            limits: def.limits,
            motor: def.motor,
            motor_speed: def.motor_speed,
            max_motor_torque: def.max_motor_torque,
            collide_connected: def.collide_connected,
            impulse: Vector3::zeros(),
            motor_impulse: 0.0,
            limit_state: LimitState::Inactive,
            island: false,
        });
        self.joint_order.push(id);
        self.refilter(a, b, def.collide_connected);
        id
    }

    /// Has contacts of two bodies checked again when a joint between them comes or goes.
    fn refilter(&mut self, a: u32, b: u32, collide_connected: bool) {
        if !collide_connected {
            for contact in self.contacts.iter_mut().filter(|contact| contact.other(a) == Some(b)) {
                contact.refilter = true;
            }
        }
    }

    fn destroy_joint(&mut self, id: u32) {
        let Joint { body_a, body_b, collide_connected, .. } = self.joints[id];
        self.joint_order.retain(|other| *other != id);
        self.joints.remove(id);
        self.bodies[body_a].wake();
        self.bodies[body_b].wake();
        self.refilter(body_a, body_b, collide_connected);
    }

    /// Destroys a body with its joints, contacts and fixtures.
    pub(crate) fn destroy_body(&mut self, id: u32) {
        for i in (0..self.joint_order.len()).rev() {
            let joint = self.joint_order[i];
            if self.joints[joint].other(id).is_some() {
                self.destroy_joint(joint);
            }
        }
        for i in (0..self.contacts.len()).rev() {
            if self.contacts[i].other(id).is_some() {
                self.destroy_contact(i);
            }
        }
        let mut next = self.bodies[id].fixtures;
        while let Some(fixture) = next {
            self.broad_phase.remove(self.fixtures[fixture].proxy);
            next = self.fixtures[fixture].next;
            self.fixtures.remove(fixture);
        }
        self.dynamic.retain(|other| *other != id);
        self.bodies.remove(id);
    }

    fn destroy_contact(&mut self, index: usize) {
        let contact = self.contacts.remove(index);
        if contact.touching {
            self.events.push(contact.event(false));
        }
        if !contact.manifold.points().is_empty() && !contact.sensor {
            self.bodies[contact.body_a].wake();
            self.bodies[contact.body_b].wake();
        }
    }

    pub(crate) fn body(&self, id: u32) -> &Body {
        &self.bodies[id]
    }

    pub(crate) fn body_mut(&mut self, id: u32) -> &mut Body {
        &mut self.bodies[id]
    }

    pub(crate) fn fixture(&self, id: u32) -> &Fixture {
        &self.fixtures[id]
    }

    pub(crate) fn joint_angle(&self, id: u32) -> f32 {
        let joint = &self.joints[id];
        self.bodies[joint.body_b].sweep.a - self.bodies[joint.body_a].sweep.a - joint.reference_angle
    }

    pub(crate) fn joint_speed(&self, id: u32) -> f32 {
        let joint = &self.joints[id];
        self.bodies[joint.body_b].angular_velocity - self.bodies[joint.body_a].angular_velocity
    }

    pub(crate) fn set_motor_speed(&mut self, id: u32, speed: f32) {
        self.joints[id].motor_speed = speed;
        self.wake_ends(id);
    }

    pub(crate) fn set_max_motor_torque(&mut self, id: u32, torque: f32) {
        self.joints[id].max_motor_torque = torque;
        self.wake_ends(id);
    }

    fn wake_ends(&mut self, joint: u32) {
        let Joint { body_a, body_b, .. } = self.joints[joint];
        self.bodies[body_a].wake();
        self.bodies[body_b].wake();
    }

    pub(crate) fn has_body(&self, id: u32) -> bool {
        self.bodies.get(id).is_some()
    }

    pub(crate) fn has_fixture(&self, id: u32) -> bool {
        self.fixtures.get(id).is_some()
    }

    pub(crate) fn has_joint(&self, id: u32) -> bool {
        self.joints.get(id).is_some()
    }

    pub(crate) fn events(&self) -> &[ContactEvent] {
        &self.events
    }

    /// The first fixture of one of the categories that a ray meets.
    pub(crate) fn ray_cast(&self, from: Vec2, to: Vec2, categories: u16) -> Option<RayHit> {
        let mut hit: Option<RayHit> = None;
        let ray = Aabb { lower: min2(from, to), upper: max2(from, to) };
        for id in self.broad_phase.query(ray) {
            let fixture = &self.fixtures[id];
            if fixture.filter.category & categories == 0 {
                continue;
            }
            let limit = hit.map_or(1.0, |hit| hit.fraction);
            let xf = &self.bodies[fixture.body].xf;
            if let Some(fraction) = fixture.shape.ray_cast(xf, from, to, limit) {
                let point = (1.0 - fraction) * from + fraction * to;
                hit = Some(RayHit { fixture: super::FixtureId(id), point, fraction });
            }
        }
        hit
    }
}
