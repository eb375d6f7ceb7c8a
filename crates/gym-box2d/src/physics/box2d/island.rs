//! Islands: bodies that touch or are joined, directly or through other bodies. The solver solves
//! all bodies of an island together.

use super::contact_solver::Constraint as ContactConstraint;
use super::joint::Constraint as JointConstraint;
use super::math::{dot, length, min};
use super::motion::{Position, Side, Velocity};
use super::settings::{
    ANGULAR_SLEEP_TOLERANCE, LINEAR_SLEEP_TOLERANCE, LINEAR_SLOP, MAX_ROTATION, MAX_TRANSLATION,
    TIME_TO_SLEEP,
};
use super::velocity_iterations::{VelocityIterations, iterate};
use super::{BODIES, Box2d, CONTACTS, JOINTS, TimeStep};

/// A step between [`Box2d::begin`] and [`Box2d::finish`].
#[derive(Clone, Copy, Debug)]
pub(super) struct Begun {
    pub(super) step: TimeStep,
    /// The dynamic body from which the first island was found, if there is an island.
    pub(super) seed: Option<usize>,
}

/// The members of an island in the order of solving, and the working memory of a step. Several
/// worlds may share one `Island`, because an `Island` has no state between steps.
#[derive(Clone, Debug, Default)]
pub(crate) struct Island {
    pub(crate) bodies: Vec<u32>,
    /// Indices in `Box2d::contacts`.
    pub(crate) contacts: Vec<usize>,
    pub(crate) joints: Vec<u32>,
    pub(crate) stack: Vec<u32>,
    positions: Vec<Position>,
    pub(crate) velocities: Vec<Velocity>,
    pub(super) contact_constraints: Vec<ContactConstraint>,
    pub(crate) joint_constraints: Vec<JointConstraint>,
    velocity_iterations: VelocityIterations,
    pub(crate) pairs: Vec<(u32, u32)>,
    /// The step between [`Box2d::begin`] and [`Box2d::finish`].
    pub(super) begun: Option<Begun>,
    /// Disables the shortcut of [`velocity_iterations`](super::velocity_iterations). Tests compare
    /// both ways.
    pub(crate) no_shortcut: bool,
}

impl Island {
    pub(crate) fn new() -> Self {
        Self {
            bodies: Vec::with_capacity(BODIES),
            contacts: Vec::with_capacity(CONTACTS),
            joints: Vec::with_capacity(JOINTS),
            stack: Vec::with_capacity(BODIES + CONTACTS),
            positions: Vec::with_capacity(BODIES),
            velocities: Vec::with_capacity(BODIES),
            contact_constraints: Vec::with_capacity(CONTACTS),
            joint_constraints: Vec::with_capacity(JOINTS),
            velocity_iterations: VelocityIterations::new(),
            pairs: Vec::with_capacity(CONTACTS),
            begun: None,
            no_shortcut: false,
        }
    }

    pub(crate) fn clear(&mut self) {
        self.bodies.clear();
        self.contacts.clear();
        self.joints.clear();
    }

    pub(crate) fn add_body(&mut self, world: &mut Box2d, body: u32) {
        world.bodies[body].island_index = self.bodies.len() as u32;
        self.bodies.push(body);
    }

    /// Returns the data about `body` that the constraints need.
    fn side(world: &Box2d, body: u32, radius: f32) -> Side {
        let body = &world.bodies[body];
        Side {
            index: body.island_index as usize,
            inv_mass: body.inv_mass,
            inv_inertia: body.inv_inertia,
            local_center: body.sweep.local_center,
            radius,
        }
    }

    pub(crate) fn build_contacts(&mut self, world: &Box2d, ratio: Option<f32>) {
        self.contact_constraints.clear();
        for &index in &self.contacts {
            let contact = &world.contacts[index];
            let a = Self::side(
                world,
                contact.body_a,
                world.fixtures[contact.fixture_a].shape.radius,
            );
            let b = Self::side(
                world,
                contact.body_b,
                world.fixtures[contact.fixture_b].shape.radius,
            );
            self.contact_constraints
                .push(ContactConstraint::new(index, contact, a, b, ratio));
        }
    }

    /// Prepares the velocity iterations: external forces, constraints, warm start.
    pub(crate) fn prepare(&mut self, world: &mut Box2d, step: &TimeStep) {
        self.enter(world, step);
        self.build_contacts(world, Some(step.ratio));
        for constraint in &mut self.contact_constraints {
            constraint.initialize(&self.positions, &self.velocities);
        }
        for constraint in &self.contact_constraints {
            constraint.warm_start(&mut self.velocities);
        }
        self.build_joints(world, step);
    }

    /// Finishes a step after its velocity iterations: integrates and corrects positions, updates
    /// sleep.
    pub(crate) fn conclude(&mut self, world: &mut Box2d, step: &TimeStep) {
        self.store_impulses(world);
        self.move_on(world, step);
    }

    /// Loads the bodies' positions and velocities. Adds gravity and external forces to the
    /// velocities.
    pub(crate) fn enter(&mut self, world: &mut Box2d, step: &TimeStep) {
        let h = step.dt;
        self.positions.clear();
        self.velocities.clear();
        for &id in &self.bodies {
            let body = &mut world.bodies[id];
            body.sweep.c0 = body.sweep.c;
            body.sweep.a0 = body.sweep.a;
            let (mut v, mut w) = (body.velocity, body.angular_velocity);
            if body.dynamic {
                v += h * (world.gravity + body.inv_mass * body.force);
                w += h * body.inv_inertia * body.torque;
            }
            self.positions.push(Position {
                c: body.sweep.c,
                a: body.sweep.a,
            });
            self.velocities.push(Velocity { v, w });
        }
    }

    /// Builds the joints' constraints and applies their initial impulses.
    pub(crate) fn build_joints(&mut self, world: &Box2d, step: &TimeStep) {
        self.joint_constraints.clear();
        for &id in &self.joints {
            let joint = &world.joints[id];
            let sides = (
                Self::side(world, joint.body_a, 0.0),
                Self::side(world, joint.body_b, 0.0),
            );
            let times = (step.dt, step.ratio);
            self.joint_constraints.push(JointConstraint::new(
                id,
                joint,
                sides,
                &self.positions,
                &mut self.velocities,
                times,
            ));
        }
    }

    /// Integrates positions, corrects the positions, and updates sleep.
    pub(crate) fn move_on(&mut self, world: &mut Box2d, step: &TimeStep) {
        self.integrate(step.dt);
        let solved = (0..step.position_iterations).any(|_| self.solve_positions());
        for (i, &id) in self.bodies.iter().enumerate() {
            self.write_back(world, i, id);
        }
        self.update_sleep(world, step.dt, solved);
    }

    /// Runs the velocity iterations of the step that [`Box2d::begin`] began.
    pub(in crate::physics) fn solve_velocities(&mut self) {
        if let Some(Begun {
            step,
            seed: Some(_),
        }) = self.begun
        {
            self.run_velocity_iterations(step.velocity_iterations);
        }
    }

    pub(crate) fn run_velocity_iterations(&mut self, iterations: u32) {
        let Self {
            joint_constraints: joints,
            contact_constraints: contacts,
            velocities,
            ..
        } = self;
        if self.no_shortcut {
            (0..iterations).for_each(|_| iterate(joints, contacts, velocities));
        } else {
            self.velocity_iterations
                .run(iterations, joints, contacts, velocities);
        }
    }

    fn store_impulses(&self, world: &mut Box2d) {
        for constraint in &self.contact_constraints {
            constraint.store_impulses(&mut world.contacts[constraint.contact].manifold);
        }
        for constraint in &self.joint_constraints {
            let joint = &mut world.joints[constraint.joint];
            joint.impulse = constraint.impulse;
            joint.motor_impulse = constraint.motor_impulse;
            joint.limit_state = constraint.limit_state;
        }
    }

    /// Integrates positions; limits translation and rotation per step.
    fn integrate(&mut self, h: f32) {
        for (position, velocity) in self.positions.iter_mut().zip(&mut self.velocities) {
            let translation = h * velocity.v;
            if dot(translation, translation) > MAX_TRANSLATION * MAX_TRANSLATION {
                velocity.v *= MAX_TRANSLATION / length(translation);
            }
            let rotation = h * velocity.w;
            if rotation * rotation > MAX_ROTATION * MAX_ROTATION {
                velocity.w *= MAX_ROTATION / rotation.abs();
            }
            position.c += h * velocity.v;
            position.a += h * velocity.w;
        }
    }

    /// Corrects the positions of all contacts, then of all joints; returns whether every error is
    /// within tolerance.
    fn solve_positions(&mut self) -> bool {
        let mut min_separation = 0.0;
        for contact in &self.contact_constraints {
            min_separation = min(min_separation, contact.solve_position(&mut self.positions));
        }
        let mut okay = min_separation >= -3.0 * LINEAR_SLOP;
        for joint in &self.joint_constraints {
            okay &= joint.solve_position(&mut self.positions);
        }
        okay
    }

    fn write_back(&self, world: &mut Box2d, index: usize, id: u32) {
        let body = &mut world.bodies[id];
        body.sweep.c = self.positions[index].c;
        body.sweep.a = self.positions[index].a;
        body.velocity = self.velocities[index].v;
        body.angular_velocity = self.velocities[index].w;
        body.synchronize();
    }

    /// Puts the island to sleep once every body has been at rest for [`TIME_TO_SLEEP`].
    fn update_sleep(&self, world: &mut Box2d, h: f32, solved: bool) {
        let mut min_sleep_time = f32::MAX;
        for &id in &self.bodies {
            let body = &mut world.bodies[id];
            if !body.dynamic {
                continue;
            }
            let w = body.angular_velocity;
            if w * w > ANGULAR_SLEEP_TOLERANCE * ANGULAR_SLEEP_TOLERANCE
                || dot(body.velocity, body.velocity)
                    > LINEAR_SLEEP_TOLERANCE * LINEAR_SLEEP_TOLERANCE
            {
                body.sleep_time = 0.0;
            } else {
                body.sleep_time += h;
            }
            min_sleep_time = min(min_sleep_time, body.sleep_time);
        }
        if min_sleep_time >= TIME_TO_SLEEP && solved {
            for &id in &self.bodies {
                world.bodies[id].sleep();
            }
        }
    }

    /// Solves the rest of a step after an impact of the island's first two bodies. Only contacts
    /// count: no joints, no warm start, no stored impulses.
    pub(crate) fn solve_toi(&mut self, world: &mut Box2d, step: &TimeStep) {
        self.positions.clear();
        self.velocities.clear();
        for &id in &self.bodies {
            let body = &world.bodies[id];
            self.positions.push(Position {
                c: body.sweep.c,
                a: body.sweep.a,
            });
            self.velocities.push(Velocity {
                v: body.velocity,
                w: body.angular_velocity,
            });
        }
        self.build_contacts(world, None);
        for _ in 0..step.position_iterations {
            let mut min_separation = 0.0;
            for contact in &self.contact_constraints {
                min_separation = min(
                    min_separation,
                    contact.solve_toi_position(&mut self.positions, [0, 1]),
                );
            }
            if min_separation >= -1.5 * LINEAR_SLOP {
                break;
            }
        }
        for (position, &id) in self.positions.iter().zip(&self.bodies).take(2) {
            world.bodies[id].sweep.c0 = position.c;
            world.bodies[id].sweep.a0 = position.a;
        }
        for constraint in &mut self.contact_constraints {
            constraint.initialize(&self.positions, &self.velocities);
        }
        self.joint_constraints.clear();
        self.run_velocity_iterations(step.velocity_iterations);
        self.integrate(step.dt);
        for (i, &id) in self.bodies.iter().enumerate() {
            self.write_back(world, i, id);
        }
    }
}
