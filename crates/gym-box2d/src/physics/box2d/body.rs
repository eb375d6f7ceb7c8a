//! Bodies and fixtures.

use serde::{Deserialize, Serialize};

use super::math::{Pose, Sweep, Vec2, cross, dot, pose_about, transform};
use super::shape::{Geometry, MassData};
use crate::physics::Filter;

/// A rigid body.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(in crate::physics) struct Body {
    pub(in crate::physics) dynamic: bool,
    pub(in crate::physics) awake: bool,
    /// Whether an island of this step already contains the body.
    pub(in crate::physics) island: bool,
    /// Index of the body in the island that is being solved.
    pub(in crate::physics) island_index: u32,
    pub(in crate::physics) xf: Pose,
    pub(in crate::physics) sweep: Sweep,
    pub(in crate::physics) velocity: Vec2,
    pub(in crate::physics) angular_velocity: f32,
    pub(in crate::physics) force: Vec2,
    pub(in crate::physics) torque: f32,
    pub(in crate::physics) mass: f32,
    pub(in crate::physics) inv_mass: f32,
    /// Moment of inertia about the centre of mass.
    pub(in crate::physics) inertia: f32,
    pub(in crate::physics) inv_inertia: f32,
    /// How long the body has been at rest, in s.
    pub(in crate::physics) sleep_time: f32,
    /// The newest fixture of the body.
    #[serde(deserialize_with = "Option::deserialize")]
    pub(in crate::physics) fixtures: Option<u32>,
}

/// A shape on a body.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(in crate::physics) struct Fixture {
    pub(in crate::physics) body: u32,
    pub(in crate::physics) shape: Geometry,
    pub(in crate::physics) density: f32,
    pub(in crate::physics) friction: f32,
    pub(in crate::physics) restitution: f32,
    pub(in crate::physics) filter: Filter,
    pub(in crate::physics) sensor: bool,
    pub(in crate::physics) proxy: u32,
    /// The fixture that was added to the same body before this one.
    #[serde(deserialize_with = "Option::deserialize")]
    pub(in crate::physics) next: Option<u32>,
}

impl Body {
    pub(in crate::physics) fn new(dynamic: bool, position: Vec2, angle: f32) -> Self {
        let mass = if dynamic { 1.0 } else { 0.0 };
        Self {
            dynamic,
            awake: true,
            island: false,
            island_index: 0,
            xf: super::math::pose(position, super::math::rotation(angle)),
            sweep: Sweep {
                local_center: Vec2::zeros(),
                c0: position,
                c: position,
                a0: angle,
                a: angle,
                alpha0: 0.0,
            },
            velocity: Vec2::zeros(),
            angular_velocity: 0.0,
            force: Vec2::zeros(),
            torque: 0.0,
            mass,
            inv_mass: mass,
            inertia: 0.0,
            inv_inertia: 0.0,
            sleep_time: 0.0,
            fixtures: None,
        }
    }

    /// Sets mass, centre of mass and moment of inertia of a dynamic body to the sum of `parts`, the
    /// mass data of its fixtures, newest first.
    pub(in crate::physics) fn reset_mass(&mut self, parts: impl Iterator<Item = MassData>) {
        let (mut mass, mut center, mut inertia) = (0.0, Vec2::zeros(), 0.0);
        for part in parts {
            mass += part.mass;
            center += part.mass * part.center;
            inertia += part.inertia;
        }
        if mass > 0.0 {
            self.mass = mass;
            self.inv_mass = 1.0 / mass;
            center *= self.inv_mass;
        } else {
            self.mass = 1.0;
            self.inv_mass = 1.0;
        }
        if inertia > 0.0 {
            self.inertia = inertia - self.mass * dot(center, center);
            self.inv_inertia = 1.0 / self.inertia;
        } else {
            self.inertia = 0.0;
            self.inv_inertia = 0.0;
        }
        let before = self.sweep.c;
        self.sweep.local_center = center;
        self.sweep.c = transform(&self.xf, center);
        self.sweep.c0 = self.sweep.c;
        self.velocity += super::math::cross_scalar(self.angular_velocity, self.sweep.c - before);
    }

    pub(in crate::physics) fn wake(&mut self) {
        if !self.awake {
            self.awake = true;
            self.sleep_time = 0.0;
        }
    }

    pub(in crate::physics) fn sleep(&mut self) {
        self.awake = false;
        self.sleep_time = 0.0;
        self.velocity = Vec2::zeros();
        self.angular_velocity = 0.0;
        self.force = Vec2::zeros();
        self.torque = 0.0;
    }

    /// Whether the body is awake and dynamic.
    pub(in crate::physics) fn active(&self) -> bool {
        self.awake && self.dynamic
    }

    pub(in crate::physics) fn apply_force(&mut self, force: Vec2) {
        if self.dynamic {
            self.wake();
            self.force += force;
        }
    }

    pub(in crate::physics) fn apply_torque(&mut self, torque: f32) {
        if self.dynamic {
            self.wake();
            self.torque += torque;
        }
    }

    pub(in crate::physics) fn apply_impulse(&mut self, impulse: Vec2, point: Vec2) {
        if self.dynamic {
            self.wake();
            self.velocity += self.inv_mass * impulse;
            self.angular_velocity += self.inv_inertia * cross(point - self.sweep.c, impulse);
        }
    }

    /// Sets the pose to the end of the sweep.
    pub(in crate::physics) fn synchronize(&mut self) {
        self.xf = pose_about(self.sweep.c, self.sweep.a, self.sweep.local_center);
    }

    /// Moves the body to its position at the fraction `alpha` of the step.
    pub(in crate::physics) fn advance(&mut self, alpha: f32) {
        self.sweep.advance(alpha);
        self.sweep.c = self.sweep.c0;
        self.sweep.a = self.sweep.a0;
        self.synchronize();
    }
}
