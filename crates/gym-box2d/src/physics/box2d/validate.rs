//! Checks that a deserialized world can be stepped without a panic.

use super::math::{Vec2, length};
use super::{Box2d, arena::Arena, body::Body, body::Fixture, contact::Contact};

/// The largest distance of an anchor of a joint from its body, in m.
const FARTHEST: f32 = 100.0;

fn has<T>(arena: &Arena<T>, slots: &[u32]) -> bool {
    slots.iter().all(|slot| arena.get(*slot).is_some())
}

/// What follows from the mass of a body's fixtures.
fn masses(body: &Body) -> (f32, f32, Vec2) {
    (body.inv_mass, body.inv_inertia, body.sweep.local_center)
}

impl Box2d {
    /// Whether the fixture `id` has the shape and the body of its terrain edge, and a contact. True
    /// for every fixture outside the terrain.
    fn is_of_terrain_rightly(&self, id: u32) -> bool {
        let terrain = &self.broad_phase.terrain;
        let fixture = &self.fixtures[id];
        let Some(edge) = terrain.edge_of(fixture.proxy) else {
            return true;
        };
        let body = &self.bodies[fixture.body];
        let needed = |contact: &Contact| contact.fixture_a == id || contact.fixture_b == id;
        let same = |(other, fixture): (u32, &Fixture)| {
            other != id && fixture.proxy == self.fixtures[id].proxy
        };
        fixture.shape == terrain.shape(edge)
            && !body.dynamic
            && body.sweep.c == Vec2::zeros()
            && body.sweep.a == 0.0
            && self.contacts.iter().any(needed)
            && !self.fixtures.iter().any(same)
    }

    /// Whether every reference is valid, and every body has the mass of its fixtures.
    pub(in crate::physics) fn is_valid(&self) -> bool {
        let bodies = self.bodies.iter().all(|(id, body)| {
            has(&self.fixtures, body.fixtures.as_slice())
                && body.dynamic == self.dynamic.contains(&id)
                // between steps no island has a fixed body
                && (body.dynamic || !body.island)
        });
        let fixtures = self.fixtures.iter().all(|(id, fixture)| {
            // every list of fixtures ends: at most one fixture has `id` as its `next`
            has(&self.bodies, &[fixture.body])
                && has(&self.fixtures, fixture.next.as_slice())
                && self
                    .fixtures
                    .iter()
                    .filter(|(_, other)| other.next == Some(id))
                    .count()
                    + usize::from(self.bodies[fixture.body].fixtures == Some(id))
                    == 1
                && self.broad_phase.holds(fixture.proxy, id)
                && self.is_of_terrain_rightly(id)
                && fixture.shape.is_valid()
        });
        let joints = self.joints.iter().all(|(id, joint)| {
            let near = |anchor: Vec2| length(anchor) <= FARTHEST;
            near(joint.local_anchor_a)
                && near(joint.local_anchor_b)
                && has(&self.bodies, &[joint.body_a, joint.body_b])
                && self.joint_order.contains(&id)
        });
        let contacts = self.contacts.iter().all(|contact| {
            has(&self.fixtures, &[contact.fixture_a, contact.fixture_b])
                && self.fixtures[contact.fixture_a].body == contact.body_a
                && self.fixtures[contact.fixture_b].body == contact.body_b
                && has(&self.bodies, &[contact.body_a, contact.body_b])
        });
        self.bodies.is_valid()
            && self.fixtures.is_valid()
            && self.joints.is_valid()
            && bodies
            && fixtures
            && joints
            && contacts
            && has(&self.bodies, &self.dynamic)
            && has(&self.joints, &self.joint_order)
            && self
                .dynamic
                .iter()
                .all(|id| masses(&self.bodies[*id]) == masses(&self.weighed(*id)))
            && self.broad_phase.is_valid(|fixture, id| {
                self.fixtures
                    .get(fixture)
                    .is_some_and(|fixture| fixture.proxy == id)
            })
    }
}
