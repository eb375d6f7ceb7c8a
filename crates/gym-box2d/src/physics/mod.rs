//! A small two-dimensional world of rigid bodies, in the manner of Box2D: bodies with fixtures,
//! revolute joints with motors and limits, contacts, ray casts, and sleep. It does not depend on
//! environments.
//!
//! ```
//! use gym_box2d::physics::{BodyDef, FixtureDef, Shape, Vec2, World};
//!
//! let mut world = World::new(Vec2::new(0.0, -10.0));
//! let ground = world.create_body(&BodyDef::fixed(Vec2::zeros(), 0.0));
//! world.create_fixture(ground, &FixtureDef::new(Shape::Edge(Vec2::new(-9.0, 0.0), Vec2::new(9.0, 0.0))));
//! let ball = world.create_body(&BodyDef::dynamic(Vec2::new(0.0, 3.0), 0.0));
//! let circle = Shape::Circle { center: Vec2::zeros(), radius: 0.5 };
//! world.create_fixture(ball, &FixtureDef { density: 1.0, ..FixtureDef::new(circle) });
//! while world.is_awake(ball) {
//!     world.step(0.02, 8, 3);
//! }
//! assert!((world.position(ball).y - 0.5).abs() < 0.02);
//! ```
//!
//! Lengths are in metres, masses in kilograms, angles in radians, counterclockwise. Numbers given
//! to a world must be finite. An id is valid in the world that returned it, until its body is
//! destroyed.
//!
//! One interface has two engines. The first repeats Box2D 2.3 in `f32`, including its order of
//! operations, so results do not depend on the platform. The second uses rapier2d to find contacts
//! and to solve velocities; islands, sleep, times of impact and position correction are the first
//! engine's. A world stores terrain as points; an edge has a body only while a dynamic body is
//! near.
//!
//! A step has three parts: before the velocity iterations, the iterations, and after them. In the
//! velocity iterations, each operation waits for the result of the previous one, so a single world
//! leaves most of a CPU idle. Vector environments therefore run the velocity iterations of up to 32
//! worlds at once, one world in each SIMD lane. A step of a single world calls the same three
//! parts.

mod box2d;
mod def;
#[cfg(feature = "rapier")]
mod rapier;
mod world;

pub(crate) use box2d::lanes::{Lanes, Place};
pub(crate) use box2d::wide::LANES;
pub use def::{
    BodyDef, BodyId, ContactEvent, Filter, FixtureDef, FixtureId, JointId, RayHit,
    RevoluteJointDef, Shape,
};
pub use world::{Physics, World};

/// A point or a vector.
pub type Vec2 = nalgebra::Vector2<f32>;
/// Position and rotation of a body.
pub type Pose = nalgebra::Isometry2<f32>;
