//! A body while its island is solved: its position, velocity, mass and moment of inertia.

use super::math::Vec2;

/// Centre of mass and angle while an island is solved.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Position {
    pub(crate) c: Vec2,
    pub(crate) a: f32,
}

/// Velocities while an island is solved.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Velocity {
    pub(crate) v: Vec2,
    pub(crate) w: f32,
}

/// The solvers' data about one of two bodies.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Side {
    /// Place in the island.
    pub(crate) index: usize,
    pub(crate) inv_mass: f32,
    pub(crate) inv_inertia: f32,
    pub(crate) local_center: Vec2,
    /// Radius of its shape.
    pub(crate) radius: f32,
}
