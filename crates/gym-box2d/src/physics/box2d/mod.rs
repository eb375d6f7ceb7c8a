//! The exact engine: Box2D 2.3 in `f32`, to the last bit of pybox2d 2.3.10.
//!
//! The algorithms are Erin Catto's (sequential impulses with warm starting, islands, continuous
//! collision), reimplemented; see the notices. Every list is visited in Box2D's order, newest
//! first, because the order affects the bits. Features that Gymnasium's environments do not need
//! are missing: kinematic bodies and bullets, damping, chains, other joints, filter groups.
//!
//! | file | idea | Box2D |
//! |---|---|---|
//! | `settings`, `math`, `trig`, `arena` | constants, vectors, sine and cosine, slots | `Common` |
//! | `shape` | mass, box and ray cast of a shape | `Collision/Shapes` |
//! | `broad_phase`, `terrain` | pairs of boxes | `b2BroadPhase`, `b2DynamicTree` |
//! | `manifold`, `collide*` | points of contact | `b2Collision`, `b2Collide*` |
//! | `distance`, `time_of_impact`, `apart` | distance, time of impact | `b2Distance`, `b2TimeOfImpact` |
//! | `body`, `contact`, `joint` | the parts of the world | `Dynamics` |
//! | `motion`, `contact_solver`, `joint`, `velocity_iterations`, `island` | the solver | `b2ContactSolver`, `b2Island` |
//! | `lanes`, `lane_bodies`, `wide` | the velocity iterations of many worlds at once | |
//! | `step`, `continuous` | a step of the world | `b2World` |

mod apart;
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
#[cfg_attr(not(feature = "native-vectors"), allow(dead_code, unused_imports))]
mod lane_bodies;
#[cfg_attr(not(feature = "native-vectors"), allow(dead_code, unused_imports))]
pub(super) mod lanes;
mod manifold;
pub(super) mod math;
pub(super) mod motion;
mod settings;
pub(super) mod shape;
mod step;
mod terrain;
#[cfg(test)]
mod tests;
mod time_of_impact;
mod validate;
mod velocity_iterations;
#[cfg_attr(not(feature = "native-vectors"), allow(dead_code, unused_imports))]
pub(super) mod wide;

use serde::{Deserialize, Serialize};

use arena::Arena;
use body::{Body, Fixture};
use broad_phase::BroadPhase;
use contact::Contact;
use joint::{Joint, LimitState};
use math::{Vec2, max2, min2};
use nalgebra::Vector3;
use shape::{Aabb, Geometry, Segment};

use super::{
    BodyDef, ContactEvent, Filter, FixtureDef, FixtureId, RayHit, RevoluteJointDef, Shape,
};

/// The capacity of a step's working memory. The capacity exceeds the needs of the environments, so
/// that a step does not allocate.
const CONTACTS: usize = 64;
const BODIES: usize = 32;
const JOINTS: usize = 8;
/// The capacity for bodies in a world with terrain: the dynamic bodies, and the edges near them.
const NEAR: usize = 18;
/// The capacity of a world for contacts and events, per fixture of a dynamic body. Every world has
/// this memory of its own, so a small capacity saves cache.
const CONTACTS_EACH: usize = 8;
const EVENTS_EACH: usize = 4;

/// A Box2D world.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(super) struct Box2d {
    gravity: Vec2,
    pub(super) bodies: Arena<Body>,
    /// The dynamic bodies, oldest first.
    pub(super) dynamic: Vec<u32>,
    pub(super) fixtures: Arena<Fixture>,
    pub(super) joints: Arena<Joint>,
    /// The joints, oldest first.
    joint_order: Vec<u32>,
    /// The contacts, oldest first.
    pub(super) contacts: Vec<Contact>,
    broad_phase: BroadPhase,
    pub(super) new_fixture: bool,
    /// 1 / `dt` of the last step; 0 before the first step.
    pub(super) inv_dt0: f32,
    #[serde(skip)]
    pub(super) events: Vec<ContactEvent>,
}

/// The arguments of a step.
#[derive(Clone, Copy, Debug)]
pub(super) struct TimeStep {
    pub(super) dt: f32,
    /// `dt` divided by the last step's `dt`; 0 in the first step.
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
            contacts: Vec::new(),
            broad_phase: BroadPhase::default(),
            new_fixture: false,
            inv_dt0: 0.0,
            events: Vec::new(),
        }
    }

    /// Returns the allocated bytes.
    #[cfg(test)]
    pub(crate) fn bytes(&self) -> usize {
        let lists = size_of::<u32>() * (self.dynamic.capacity() + self.joint_order.capacity());
        let contacts = size_of::<Contact>() * self.contacts.capacity();
        let events = size_of::<ContactEvent>() * self.events.capacity();
        let arenas = self.bodies.bytes() + self.fixtures.bytes() + self.joints.bytes();
        size_of::<Self>() + lists + contacts + events + arenas + self.broad_phase.bytes()
    }

    pub(crate) fn create_body(&mut self, def: &BodyDef) -> u32 {
        let id = self
            .bodies
            .insert(Body::new(def.dynamic, def.position, def.angle));
        if def.dynamic {
            self.dynamic.push(id);
        }
        id
    }

    /// Adds terrain to a world without terrain.
    pub(crate) fn create_terrain(&mut self, points: &[Vec2], friction: f32) {
        self.broad_phase.insert_terrain(points, friction);
        self.bodies.reserve(NEAR);
        self.fixtures.reserve(NEAR);
        self.new_fixture = true;
    }

    /// Returns the fixture of an edge of the terrain. If the edge has none, creates a static body
    /// with the fixture.
    fn fixture_of_edge(&mut self, edge: usize, proxy: u32) -> u32 {
        for Contact {
            fixture_a,
            fixture_b,
            ..
        } in &self.contacts
        {
            for id in [*fixture_a, *fixture_b] {
                if self.fixtures[id].proxy == proxy {
                    return id;
                }
            }
        }
        let terrain = &self.broad_phase.terrain;
        let [a, b] = terrain.ends(edge);
        let def = FixtureDef {
            friction: terrain.friction,
            ..FixtureDef::new(Shape::Edge(a, b))
        };
        let body = self.bodies.insert(Body::new(false, Vec2::zeros(), 0.0));
        self.add_fixture(body, &def, proxy)
    }

    /// Destroys the body and fixture of an edge if no contact needs them.
    fn leave_edge(&mut self, fixture: u32, body: u32) {
        let of_terrain = self
            .broad_phase
            .terrain
            .edge_of(self.fixtures[fixture].proxy)
            .is_some();
        if of_terrain
            && !self
                .contacts
                .iter()
                .any(|contact| contact.other(body).is_some())
        {
            self.fixtures.remove(fixture);
            self.bodies.remove(body);
        }
    }

    fn add_fixture(&mut self, body: u32, def: &FixtureDef, proxy: u32) -> u32 {
        let id = self.fixtures.insert(Fixture {
            body,
            shape: Geometry::from(&def.shape),
            density: def.density,
            friction: def.friction,
            restitution: def.restitution,
            filter: def.filter,
            sensor: def.sensor,
            proxy,
            next: self.bodies[body].fixtures,
        });
        self.bodies[body].fixtures = Some(id);
        id
    }

    /// A dynamic body with the mass of its fixtures.
    fn weighed(&self, body: u32) -> Body {
        let mut body = self.bodies[body].clone();
        let newest_first = std::iter::successors(body.fixtures, |id| self.fixtures[*id].next);
        let massive = newest_first
            .map(|id| &self.fixtures[id])
            .filter(|fixture| fixture.density != 0.0);
        body.reset_mass(massive.map(|fixture| fixture.shape.mass(fixture.density)));
        body
    }

    pub(crate) fn create_fixture(&mut self, body: u32, def: &FixtureDef) -> u32 {
        let id = self.add_fixture(body, def, 0);
        let owner = &self.bodies[body];
        let (aabb, dynamic) = (self.fixtures[id].shape.aabb(&owner.xf), owner.dynamic);
        self.fixtures[id].proxy = self.broad_phase.insert(&aabb, id, dynamic);
        if def.density > 0.0 && dynamic {
            self.bodies[body] = self.weighed(body);
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

    /// Reserves space for the contacts of the existing fixtures, so that steps do not allocate.
    fn make_room(&mut self) {
        let moving = self
            .fixtures
            .iter()
            .filter(|(_, fixture)| self.bodies[fixture.body].dynamic)
            .count();
        let more = |each: usize, len: usize| (each * moving).saturating_sub(len);
        self.contacts
            .reserve_exact(more(CONTACTS_EACH, self.contacts.len()));
        self.events
            .reserve_exact(more(EVENTS_EACH, self.events.len()));
    }

    /// Reads one or two numbers of each object, to prefetch its cache lines. The function uses no
    /// index, so it works even if a panic left the world inconsistent.
    pub(crate) fn prefetch(&self) -> u32 {
        let joints = self
            .joints
            .iter()
            .map(|(_, joint)| joint.body_a ^ joint.motor_speed.to_bits());
        let bodies = self
            .bodies
            .iter()
            .map(|(_, body)| body.sweep.a.to_bits() ^ body.sleep_time.to_bits());
        let contacts = self
            .contacts
            .iter()
            .map(|contact| contact.fixture_a ^ contact.toi_count);
        let seen = joints
            .chain(bodies)
            .chain(contacts)
            .fold(self.broad_phase.prefetch(), |a, b| a ^ b);
        let newest = self
            .dynamic
            .iter()
            .filter_map(|id| self.bodies.get(*id)?.fixtures);
        let shapes = newest
            .filter_map(|id| self.fixtures.get(id))
            .map(|fixture| &fixture.shape);
        shapes.fold(seen, |seen, shape| seen ^ shape.prefetch())
    }

    /// Marks the contacts of two bodies to be checked again, because a joint between the bodies was
    /// added or removed.
    fn refilter(&mut self, a: u32, b: u32, collide_connected: bool) {
        if !collide_connected {
            for contact in self
                .contacts
                .iter_mut()
                .filter(|contact| contact.other(a) == Some(b))
            {
                contact.refilter = true;
            }
        }
    }

    fn destroy_joint(&mut self, id: u32) {
        let Joint {
            body_a,
            body_b,
            collide_connected,
            ..
        } = self.joints[id];
        self.joint_order.retain(|other| *other != id);
        self.joints.remove(id);
        self.bodies[body_a].wake();
        self.bodies[body_b].wake();
        self.refilter(body_a, body_b, collide_connected);
    }

    /// Destroys the body `id` with its joints, contacts and fixtures.
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
        self.leave_edge(contact.fixture_a, contact.body_a);
        self.leave_edge(contact.fixture_b, contact.body_b);
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
        self.bodies[joint.body_b].sweep.a
            - self.bodies[joint.body_a].sweep.a
            - joint.reference_angle
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

    /// Returns the first hit of each ray from `from`, among the fixtures in one of `categories`.
    pub(crate) fn ray_casts<const N: usize>(
        &self,
        from: Vec2,
        to: &[Vec2; N],
        categories: u16,
    ) -> [Option<RayHit>; N] {
        let mut hits = [None; N];
        let boxes = to.map(|to| Aabb {
            lower: min2(from, to),
            upper: max2(from, to),
        });
        let Some(all) = boxes.iter().copied().reduce(|a, b| a.union(&b)) else {
            return hits;
        };
        let mut meet = |fat: &Aabb, fixture, cast: &dyn Fn(usize, f32) -> Option<f32>| {
            for (i, hit) in hits
                .iter_mut()
                .enumerate()
                .filter(|(i, _)| fat.overlaps(&boxes[*i]))
            {
                let limit = hit.map_or(1.0, |hit: RayHit| hit.fraction);
                if let Some(fraction) = cast(i, limit) {
                    let point = (1.0 - fraction) * from + fraction * to[i];
                    *hit = Some(RayHit {
                        fixture,
                        point,
                        fraction,
                    });
                }
            }
        };
        for id in self.broad_phase.query(all) {
            let Fixture {
                body,
                shape,
                filter,
                proxy,
                ..
            } = &self.fixtures[id];
            if filter.category & categories != 0 {
                let xf = &self.bodies[*body].xf;
                meet(
                    &self.broad_phase.fat(*proxy),
                    Some(FixtureId(id)),
                    &|i, limit| shape.ray_cast(xf, from, to[i], limit),
                );
            }
        }
        if Filter::default().category & categories != 0 {
            let terrain = &self.broad_phase.terrain;
            terrain.query(&all, |edge| {
                let segment = Segment::new(terrain.ends(edge));
                meet(&terrain.edge_box(edge), None, &|i, limit| {
                    segment.ray_cast(from, to[i] - from, limit)
                });
            });
        }
        hits
    }
}
