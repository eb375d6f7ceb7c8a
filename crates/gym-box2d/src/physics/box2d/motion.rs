//! The state of a body while the solver works on its island.

use super::math::Vec2;

/// The position of the centre of mass, and the angle.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Position {
    pub(crate) c: Vec2,
    pub(crate) a: f32,
}

/// The velocity of the centre of mass, and the angular velocity.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Velocity {
    pub(crate) v: Vec2,
    pub(crate) w: f32,
}

/// The data that a constraint needs about one of its two bodies.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Side {
    /// Index of the body in the island.
    pub(crate) index: usize,
    pub(crate) inv_mass: f32,
    pub(crate) inv_inertia: f32,
    pub(crate) local_center: Vec2,
    /// Radius of the body's shape.
    pub(crate) radius: f32,
}
