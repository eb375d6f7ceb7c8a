//! The velocity iterations of an island, and a shortcut for iterations that repeat.
//!
//! The result of an iteration depends on the velocities and contact impulses at its start. It
//! depends on a joint's impulses only if the impulses reach a bound. After some iterations,
//! velocities and contact impulses stop changing, or alternate between two states that differ in
//! their last bits. From then on each iteration adds the same amounts to the joints' impulses as
//! the last iteration but one. As long as the impulses reach the same bounds, the shortcut makes
//! only these additions. The bits equal those of complete iterations.

use super::contact_solver::Constraint as Contact;
use super::joint::{Constraint as Joint, Increment};
use super::motion::Velocity;
use super::{BODIES, CONTACTS, JOINTS};

/// The state at the start of an iteration.
#[derive(Clone, Debug, Default)]
struct Start {
    velocities: Vec<Velocity>,
    impulses: Vec<[f32; 4]>,
}

/// The working memory of the velocity iterations.
#[derive(Clone, Debug, Default)]
pub(crate) struct VelocityIterations {
    /// The starts of the last two iterations.
    starts: [Start; 2],
    /// The changes of the joints' impulses in the last two iterations.
    increments: [Vec<Increment>; 2],
}

impl VelocityIterations {
    pub(crate) fn new() -> Self {
        let start = || Start {
            velocities: Vec::with_capacity(BODIES),
            impulses: Vec::with_capacity(CONTACTS),
        };
        Self {
            starts: [start(), start()],
            increments: [JOINTS; 2].map(Vec::with_capacity),
        }
    }
}

impl Start {
    fn clear(&mut self) {
        self.velocities.clear();
        self.impulses.clear();
    }

    fn set(&mut self, velocities: &[Velocity], contacts: &[Contact]) {
        self.clear();
        self.velocities.extend_from_slice(velocities);
        self.impulses.extend(contacts.iter().map(Contact::impulses));
    }

    fn is(&self, velocities: &[Velocity], contacts: &[Contact]) -> bool {
        let bits = |x: &Velocity| [x.v.x, x.v.y, x.w].map(f32::to_bits);
        self.velocities.len() == velocities.len()
            && self
                .velocities
                .iter()
                .zip(velocities)
                .all(|(a, b)| bits(a) == bits(b))
            && self.impulses.len() == contacts.len()
            && (self.impulses.iter().zip(contacts))
                .all(|(a, b)| a.map(f32::to_bits) == b.impulses().map(f32::to_bits))
    }
}

/// Makes one iteration: all joints, then all contacts.
pub(crate) fn iterate(joints: &mut [Joint], contacts: &mut [Contact], velocities: &mut [Velocity]) {
    for joint in joints {
        joint.solve_velocity(velocities);
    }
    for contact in contacts {
        contact.solve_velocity(velocities);
    }
}

impl VelocityIterations {
    /// Gives the result of `iterations` velocity iterations.
    pub(crate) fn run(
        &mut self,
        iterations: u32,
        joints: &mut [Joint],
        contacts: &mut [Contact],
        velocities: &mut [Velocity],
    ) {
        self.starts.iter_mut().for_each(Start::clear);
        let mut left = iterations;
        while left > 0 {
            let slot = (left % 2) as usize;
            self.starts[slot].set(velocities, contacts);
            self.increments[slot].clear();
            for joint in &mut *joints {
                self.increments[slot].push(joint.solve_velocity(velocities));
            }
            for contact in &mut *contacts {
                contact.solve_velocity(velocities);
            }
            left -= 1;
            // the other slot holds the start of the previous iteration
            if left > 0 && self.starts[1 - slot].is(velocities, contacts) {
                left = self.repeat(left, joints);
                let start = &self.starts[(left % 2) as usize];
                velocities.copy_from_slice(&start.velocities);
                for (contact, impulses) in contacts.iter_mut().zip(&start.impulses) {
                    contact.set_impulses(impulses);
                }
                self.starts.iter_mut().for_each(Start::clear);
            }
        }
    }

    /// Replaces up to `left` iterations by their impulse changes, as long as they repeat earlier
    /// iterations. Returns the number of iterations that remain.
    fn repeat(&self, mut left: u32, joints: &mut [Joint]) -> u32 {
        let mut unchanged = 0;
        while left > 0 {
            let increments = &self.increments[(left % 2) as usize];
            if !joints
                .iter()
                .zip(increments)
                .all(|(joint, increment)| joint.repeats(increment))
            {
                break;
            }
            let mut changed = false;
            for (joint, increment) in joints.iter_mut().zip(increments) {
                changed |= joint.repeat(increment);
            }
            left -= 1;
            unchanged = if changed { 0 } else { unchanged + 1 };
            if unchanged == 2 {
                return left % 2; // neither iteration of the cycle changes anything any more
            }
        }
        left
    }
}
