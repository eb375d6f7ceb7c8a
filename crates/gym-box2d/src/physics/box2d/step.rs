//! A step of the world: contacts, islands, times of impact.

use super::contact::Contact;
use super::island::{Begun, Island};
use super::math::pose_about;
use super::shape::Kind;
use super::{Box2d, TimeStep};
use crate::physics::Filter;

impl Box2d {
    /// Begins a step: updates contacts, and prepares the first island (if there is one) for the
    /// velocity iterations. The caller runs the velocity iterations, then calls
    /// [`finish`](Self::finish) with the same `island`.
    pub(in crate::physics) fn begin(
        &mut self,
        island: &mut Island,
        dt: f32,
        velocity_iterations: u32,
        position_iterations: u32,
    ) {
        self.events.clear();
        if self.new_fixture {
            self.make_room();
            self.find_new_contacts(&mut island.pairs);
            self.new_fixture = false;
        }
        let step = TimeStep {
            dt,
            ratio: self.inv_dt0 * dt,
            velocity_iterations,
            position_iterations,
        };
        self.update_contacts();
        let mut seed = None;
        if dt > 0.0 {
            self.forget_islands();
            seed = (0..self.dynamic.len())
                .rev()
                .find(|i| self.gather(island, self.dynamic[*i]));
            if seed.is_some() {
                island.prepare(self, &step);
            }
        }
        island.begun = Some(Begun { step, seed });
    }

    /// Finishes the step that [`begin`](Self::begin) began: positions, further islands, impacts.
    /// Without such a step, `finish` does nothing.
    pub(in crate::physics) fn finish(&mut self, island: &mut Island) {
        let Some(Begun { step, seed }) = island.begun.take() else {
            return;
        };
        if step.dt > 0.0 {
            if let Some(seed) = seed {
                island.conclude(self, &step);
                for i in (0..seed).rev() {
                    if self.gather(island, self.dynamic[i]) {
                        island.prepare(self, &step);
                        island.run_velocity_iterations(step.velocity_iterations);
                        island.conclude(self, &step);
                    }
                }
            }
            self.synchronize_islands(&mut island.pairs);
            self.solve_toi(island, &step);
            self.inv_dt0 = 1.0 / step.dt;
        }
        for &id in &self.dynamic {
            let body = &mut self.bodies[id];
            body.force.fill(0.0);
            body.torque = 0.0;
        }
    }

    /// Updates the contacts of awake bodies and destroys the contacts of fixtures whose broad-phase
    /// boxes no longer overlap.
    pub(crate) fn update_contacts(&mut self) {
        for i in (0..self.contacts.len()).rev() {
            let contact = &self.contacts[i];
            let Contact {
                fixture_a,
                fixture_b,
                body_a,
                body_b,
                refilter,
                ..
            } = *contact;
            if refilter {
                if !self.should_collide(fixture_a, fixture_b) {
                    self.destroy_contact(i);
                    continue;
                }
                self.contacts[i].refilter = false;
            }
            if !self.bodies[body_a].active() && !self.bodies[body_b].active() {
                continue;
            }
            if !self.broad_phase.overlap(
                self.fixtures[fixture_a].proxy,
                self.fixtures[fixture_b].proxy,
            ) {
                self.destroy_contact(i);
                continue;
            }
            self.contacts[i].update(&mut self.bodies, &self.fixtures, &mut self.events);
        }
    }

    /// Whether two fixtures belong to different bodies that may collide.
    fn should_collide(&self, a: u32, b: u32) -> bool {
        let (a, b) = (&self.fixtures[a], &self.fixtures[b]);
        let jointed = |id: &u32| {
            let joint = &self.joints[*id];
            joint.other(a.body) == Some(b.body) && !joint.collide_connected
        };
        a.body != b.body
            && (self.bodies[a.body].dynamic || self.bodies[b.body].dynamic)
            && a.filter.meets(&b.filter)
            && !self.joint_order.iter().any(jointed)
    }

    /// Returns the fixtures of proxies `a` and `b`, if they may collide. Creates the fixture of an
    /// edge of the terrain.
    fn fixtures_of(&mut self, a: u32, b: u32) -> Option<(u32, u32)> {
        let terrain = &self.broad_phase.terrain;
        let (edge, proxy, other) = match (terrain.edge_of(a), terrain.edge_of(b)) {
            (Some(edge), _) => (edge, a, self.broad_phase.fixture(b)),
            (None, Some(edge)) => (edge, b, self.broad_phase.fixture(a)),
            (None, None) => {
                let (a, b) = (self.broad_phase.fixture(a), self.broad_phase.fixture(b));
                return self.should_collide(a, b).then_some((a, b));
            }
        };
        let kind = self.fixtures[other].shape.kind;
        if kind == Kind::Edge || !self.fixtures[other].filter.meets(&Filter::default()) {
            return None;
        }
        Some((self.fixture_of_edge(edge, proxy), other))
    }

    /// Creates contacts for the fixtures whose broad-phase boxes began to overlap. `pairs` is
    /// working memory.
    pub(crate) fn find_new_contacts(&mut self, pairs: &mut Vec<(u32, u32)>) {
        if !self.broad_phase.has_moved() {
            return;
        }
        self.broad_phase.find_pairs(pairs);
        for &(a, b) in &*pairs {
            let known = |contact: &Contact| {
                let [x, y] =
                    [contact.fixture_a, contact.fixture_b].map(|id| self.fixtures[id].proxy);
                (x, y) == (a, b) || (x, y) == (b, a)
            };
            if self.contacts.iter().any(known) {
                continue;
            }
            let Some((a, b)) = self.fixtures_of(a, b) else {
                continue;
            };
            let Some(contact) = Contact::new(&self.fixtures, a, b) else {
                continue;
            };
            if !contact.sensor {
                self.bodies[contact.body_a].wake();
                self.bodies[contact.body_b].wake();
            }
            self.contacts.push(contact);
        }
    }

    pub(crate) fn forget_islands(&mut self) {
        for &id in &self.dynamic {
            self.bodies[id].island = false;
        }
        for contact in &mut self.contacts {
            contact.island = false;
        }
        for &id in &self.joint_order {
            self.joints[id].island = false;
        }
    }

    /// Updates the broad-phase boxes of the islands' bodies, and finds new contacts. `pairs` is
    /// working memory.
    pub(crate) fn synchronize_islands(&mut self, pairs: &mut Vec<(u32, u32)>) {
        for i in (0..self.dynamic.len()).rev() {
            let id = self.dynamic[i];
            if self.bodies[id].island {
                self.synchronize_fixtures(id);
            }
        }
        self.find_new_contacts(pairs);
    }

    /// Collects the island of `seed` by a depth-first search along contacts and joints. The search
    /// does not continue beyond static bodies. Returns false if `seed` sleeps or is part of another
    /// island.
    pub(crate) fn gather(&mut self, island: &mut Island, seed: u32) -> bool {
        if self.bodies[seed].island || !self.bodies[seed].awake {
            return false;
        }
        island.clear();
        let mut stack = std::mem::take(&mut island.stack);
        stack.push(seed);
        self.bodies[seed].island = true;
        while let Some(id) = stack.pop() {
            island.add_body(self, id);
            let body = &mut self.bodies[id];
            body.wake();
            if !body.dynamic {
                continue;
            }
            for (index, contact) in self.contacts.iter_mut().enumerate().rev() {
                let Some(other) = contact.other(id) else {
                    continue;
                };
                if contact.island || !contact.enabled || !contact.touching || contact.sensor {
                    continue;
                }
                contact.island = true;
                island.contacts.push(index);
                if !std::mem::replace(&mut self.bodies[other].island, true) {
                    stack.push(other);
                }
            }
            for &joint in self.joint_order.iter().rev() {
                let Some(other) = self.joints[joint].other(id) else {
                    continue;
                };
                if std::mem::replace(&mut self.joints[joint].island, true) {
                    continue;
                }
                island.joints.push(joint);
                if !std::mem::replace(&mut self.bodies[other].island, true) {
                    stack.push(other);
                }
            }
        }
        island.stack = stack;
        // several islands may contain the same static body
        for &id in &island.bodies {
            let body = &mut self.bodies[id];
            body.island &= body.dynamic;
        }
        true
    }

    /// Updates the broad-phase boxes of a body's fixtures.
    pub(crate) fn synchronize_fixtures(&mut self, id: u32) {
        let body = &self.bodies[id];
        let before = pose_about(body.sweep.c0, body.sweep.a0, body.sweep.local_center);
        let displacement = body.xf.translation.vector - before.translation.vector;
        let mut next = body.fixtures;
        while let Some(id) = next {
            let fixture = &self.fixtures[id];
            let swept = fixture
                .shape
                .aabb(&before)
                .union(&fixture.shape.aabb(&body.xf));
            self.broad_phase.update(fixture.proxy, &swept, displacement);
            next = fixture.next;
        }
    }
}
