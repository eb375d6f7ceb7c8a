//! Continuous collision: bodies that would tunnel through static ones stop at the time of impact.

use super::apart::stays_away;
use super::island::Island;
use super::math::min;
use super::settings::{MAX_SUB_STEPS, MAX_TOI_CONTACTS};
use super::time_of_impact::{Moving, TOLERANCE, target, time_of_impact};
use super::{Box2d, TimeStep};

impl Box2d {
    /// Solves the impacts within the step, the earliest first.
    pub(crate) fn solve_toi(&mut self, island: &mut Island, step: &TimeStep) {
        for &id in &self.dynamic {
            let body = &mut self.bodies[id];
            body.island = false;
            body.sweep.alpha0 = 0.0;
        }
        for contact in &mut self.contacts {
            contact.island = false;
            contact.toi = None;
            contact.toi_count = 0;
        }
        while let Some((contact, alpha)) = self.first_impact() {
            self.solve_impact(island, step, contact, alpha);
        }
        // static bodies begin the next step at time 0
        for contact in &self.contacts {
            for id in [contact.body_a, contact.body_b] {
                self.bodies[id].sweep.alpha0 = 0.0;
            }
        }
    }

    /// Returns the contact with the earliest impact within the step (the newest of several), and
    /// its time.
    fn first_impact(&mut self) -> Option<(usize, f32)> {
        let mut first = None;
        let mut min_alpha = 1.0;
        for i in (0..self.contacts.len()).rev() {
            let contact = &self.contacts[i];
            if !contact.enabled || contact.toi_count > MAX_SUB_STEPS {
                continue;
            }
            let alpha = if let Some(alpha) = contact.toi {
                alpha
            } else {
                let (a, b) = (contact.body_a, contact.body_b);
                if contact.sensor
                    || !(self.bodies[a].active() || self.bodies[b].active())
                    || (self.bodies[a].dynamic && self.bodies[b].dynamic)
                {
                    continue;
                }
                let alpha = self.impact(i);
                self.contacts[i].toi = Some(alpha);
                alpha
            };
            if alpha < min_alpha {
                first = Some(i);
                min_alpha = alpha;
            }
        }
        first
            .filter(|_| min_alpha <= 1.0 - 10.0 * f32::EPSILON)
            .map(|i| (i, min_alpha))
    }

    /// Returns the fraction of the step after which the contact's fixtures touch; 1 if they do not
    /// touch.
    fn impact(&mut self, index: usize) -> f32 {
        let contact = &self.contacts[index];
        let (a, b) = (contact.body_a, contact.body_b);
        let (alpha_a, alpha_b) = (self.bodies[a].sweep.alpha0, self.bodies[b].sweep.alpha0);
        let mut alpha0 = alpha_a;
        if alpha_a < alpha_b {
            alpha0 = alpha_b;
            self.bodies[a].sweep.advance(alpha0);
        } else if alpha_b < alpha_a {
            self.bodies[b].sweep.advance(alpha0);
        }
        let moving = |fixture: u32, body: u32| Moving {
            shape: &self.fixtures[fixture].shape,
            sweep: self.bodies[body].sweep,
        };
        let (a, b) = (moving(contact.fixture_a, a), moving(contact.fixture_b, b));
        let reach = target(&a, &b) + TOLERANCE;
        if stays_away(&a, &b, reach) || stays_away(&b, &a, reach) {
            debug_assert_eq!(time_of_impact(a, b), None, "{a:?} {b:?}");
            return 1.0;
        }
        time_of_impact(a, b).map_or(1.0, |t| min(alpha0 + (1.0 - alpha0) * t, 1.0))
    }

    /// Moves the two bodies of a contact to their time of impact `alpha`, and solves the rest of
    /// the step for them.
    fn solve_impact(&mut self, island: &mut Island, step: &TimeStep, index: usize, alpha: f32) {
        let (a, b) = (self.contacts[index].body_a, self.contacts[index].body_b);
        let backups = [a, b].map(|id| (id, self.bodies[id].sweep));
        self.bodies[a].advance(alpha);
        self.bodies[b].advance(alpha);
        let contact = &mut self.contacts[index];
        contact.update(&mut self.bodies, &self.fixtures, &mut self.events);
        contact.toi = None;
        contact.toi_count += 1;
        if !contact.touching {
            contact.enabled = false;
            for (id, sweep) in backups {
                self.bodies[id].sweep = sweep;
                self.bodies[id].synchronize();
            }
            return;
        }

        island.clear();
        island.contacts.push(index);
        contact.island = true;
        for id in [a, b] {
            self.bodies[id].wake();
            self.bodies[id].island = true;
            island.add_body(self, id);
        }
        for id in [a, b] {
            if self.bodies[id].dynamic {
                self.gather_touching(island, id, alpha);
            }
        }

        let rest = TimeStep {
            dt: (1.0 - alpha) * step.dt,
            ratio: 1.0,
            position_iterations: 20,
            velocity_iterations: step.velocity_iterations,
        };
        island.solve_toi(self, &rest);
        for &id in &island.bodies {
            let body = &mut self.bodies[id];
            body.island = false;
            if !body.dynamic {
                continue;
            }
            self.synchronize_fixtures(id);
            for contact in self
                .contacts
                .iter_mut()
                .filter(|contact| contact.other(id).is_some())
            {
                contact.toi = None;
                contact.island = false;
            }
        }
        self.find_new_contacts(&mut island.pairs);
    }

    /// Adds the static bodies that body `id` also touches at the time `alpha`.
    fn gather_touching(&mut self, island: &mut Island, id: u32, alpha: f32) {
        for i in (0..self.contacts.len()).rev() {
            if island.bodies.len() == 2 * MAX_TOI_CONTACTS
                || island.contacts.len() == MAX_TOI_CONTACTS
            {
                break;
            }
            let contact = &self.contacts[i];
            let Some(other) = contact.other(id) else {
                continue;
            };
            if contact.island || contact.sensor || self.bodies[other].dynamic {
                continue;
            }
            let backup = self.bodies[other].sweep;
            if !self.bodies[other].island {
                self.bodies[other].advance(alpha);
            }
            let contact = &mut self.contacts[i];
            contact.update(&mut self.bodies, &self.fixtures, &mut self.events);
            if !contact.touching {
                self.bodies[other].sweep = backup;
                self.bodies[other].synchronize();
                continue;
            }
            contact.island = true;
            island.contacts.push(i);
            if !std::mem::replace(&mut self.bodies[other].island, true) {
                island.add_body(self, other);
            }
        }
    }
}
