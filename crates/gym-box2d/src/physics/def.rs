//! The arguments and results of a world's methods.

use serde::{Deserialize, Serialize};

use super::Vec2;

/// A body of a [`World`](super::World).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(transparent)]
pub struct BodyId(pub(super) u32);

impl BodyId {
    /// Its number: bodies are numbered from 0 in the order of creation; a new body reuses the
    /// number of a destroyed one.
    pub fn index(&self) -> u32 {
        self.0
    }
}

/// A fixture of a [`World`](super::World).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(transparent)]
pub struct FixtureId(pub(super) u32);

/// A joint of a [`World`](super::World).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(transparent)]
pub struct JointId(pub(super) u32);

/// How to make a body.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BodyDef {
    /// Whether it moves; one that does not is static.
    pub dynamic: bool,
    /// Where its origin is.
    pub position: Vec2,
    /// How far it is turned.
    pub angle: f32,
}

impl BodyDef {
    /// A body that moves.
    pub fn dynamic(position: Vec2, angle: f32) -> Self {
        Self {
            dynamic: true,
            position,
            angle,
        }
    }

    /// A static body.
    pub fn fixed(position: Vec2, angle: f32) -> Self {
        Self {
            dynamic: false,
            position,
            angle,
        }
    }
}

/// The shape of a fixture, in the coordinates of its body.
#[derive(Clone, Debug, PartialEq)]
pub enum Shape {
    /// A disc.
    Circle {
        /// Its centre.
        center: Vec2,
        /// Its radius.
        radius: f32,
    },
    /// A line between two points, solid from both sides, without mass.
    Edge(Vec2, Vec2),
    /// A rectangle about the origin.
    Rect {
        /// Half its width.
        half_width: f32,
        /// Half its height.
        half_height: f32,
    },
    /// The convex hull of three to eight points.
    Polygon(Vec<Vec2>),
}

/// Which fixtures a fixture touches.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Filter {
    /// The categories it belongs to, one bit each.
    pub category: u16,
    /// The categories it touches.
    pub mask: u16,
}

impl Filter {
    /// Whether each belongs to a category that the other touches.
    pub fn meets(&self, other: &Self) -> bool {
        self.mask & other.category != 0 && self.category & other.mask != 0
    }
}

impl Default for Filter {
    /// Category 1, touches all.
    fn default() -> Self {
        Self {
            category: 0x0001,
            mask: 0xFFFF,
        }
    }
}

/// How to make a fixture.
#[derive(Clone, Debug, PartialEq)]
pub struct FixtureDef {
    /// Its shape.
    pub shape: Shape,
    /// Mass per area; 0 adds no mass.
    pub density: f32,
    /// Of two fixtures in contact, the geometric mean counts.
    pub friction: f32,
    /// The restitution of a hard collision; of two fixtures, the larger counts.
    pub restitution: f32,
    /// Which fixtures it touches.
    pub filter: Filter,
    /// Whether it only reports contacts, without resisting.
    pub sensor: bool,
}

impl FixtureDef {
    /// Box2D's defaults, as pybox2d has them: friction 0.2, no density, no restitution.
    pub fn new(shape: Shape) -> Self {
        Self {
            shape,
            density: 0.0,
            friction: 0.2,
            restitution: 0.0,
            filter: Filter::default(),
            sensor: false,
        }
    }
}

/// The hinge of two bodies; their angle is then 0.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RevoluteJointDef {
    /// The first body.
    pub body_a: BodyId,
    /// The second body, whose angle counts.
    pub body_b: BodyId,
    /// The hinge in the coordinates of the first.
    pub local_anchor_a: Vec2,
    /// The hinge in the coordinates of the second.
    pub local_anchor_b: Vec2,
    /// Least and greatest angle.
    pub limits: Option<(f32, f32)>,
    /// Whether a motor drives it.
    pub motor: bool,
    /// The angular speed that the motor strives for.
    pub motor_speed: f32,
    /// The most that the motor exerts.
    pub max_motor_torque: f32,
    /// Whether the two bodies can touch each other.
    pub collide_connected: bool,
}

/// Two fixtures began or ceased to touch.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ContactEvent {
    /// Whether they began to.
    pub begin: bool,
    /// The two.
    pub fixtures: [FixtureId; 2],
    /// Their bodies.
    pub bodies: [BodyId; 2],
}

/// Where a ray met a fixture.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RayHit {
    /// The fixture; `None` for an edge of the [terrain](super::World::create_terrain).
    pub fixture: Option<FixtureId>,
    /// Where.
    pub point: Vec2,
    /// At which part of its way, from 0 to 1.
    pub fraction: f32,
}
