//! The arguments and results of a world's methods.

use serde::{Deserialize, Serialize};

use super::Vec2;

/// A body of a [`World`](super::World).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(transparent)]
pub struct BodyId(pub(super) u32);

impl BodyId {
    /// Returns the body's number. Bodies are numbered from 0 in the order of creation; a new body
    /// reuses the number of a destroyed one.
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

/// The arguments of a new body.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BodyDef {
    /// Whether the body moves. If not, it is static.
    pub dynamic: bool,
    /// The position of its origin.
    pub position: Vec2,
    /// Its angle.
    pub angle: f32,
}

impl BodyDef {
    /// Makes the arguments of a moving body.
    pub fn dynamic(position: Vec2, angle: f32) -> Self {
        Self {
            dynamic: true,
            position,
            angle,
        }
    }

    /// Makes the arguments of a static body.
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
        /// The centre of the disc.
        center: Vec2,
        /// The radius of the disc.
        radius: f32,
    },
    /// A line between two points, without mass; it collides from both sides.
    Edge(Vec2, Vec2),
    /// A rectangle about the origin.
    Rect {
        /// Half the width.
        half_width: f32,
        /// Half the height.
        half_height: f32,
    },
    /// The convex hull of three to eight points.
    Polygon(Vec<Vec2>),
}

/// Which fixtures collide.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Filter {
    /// The categories of the fixture, one bit each.
    pub category: u16,
    /// The categories that the fixture collides with.
    pub mask: u16,
}

impl Filter {
    /// Whether each filter's mask contains a category of the other.
    pub fn meets(&self, other: &Self) -> bool {
        self.mask & other.category != 0 && self.category & other.mask != 0
    }
}

impl Default for Filter {
    /// Category 1; collides with all categories.
    fn default() -> Self {
        Self {
            category: 0x0001,
            mask: 0xFFFF,
        }
    }
}

/// The arguments of a new fixture.
#[derive(Clone, Debug, PartialEq)]
pub struct FixtureDef {
    /// The shape of the fixture.
    pub shape: Shape,
    /// Mass per area; 0 adds no mass.
    pub density: f32,
    /// The coefficient of friction. A contact uses the geometric mean of its two fixtures'
    /// coefficients.
    pub friction: f32,
    /// The coefficient of restitution. A contact uses the larger of its two fixtures' coefficients.
    pub restitution: f32,
    /// Which fixtures this fixture collides with.
    pub filter: Filter,
    /// Whether the fixture only reports contacts, without forces.
    pub sensor: bool,
}

impl FixtureDef {
    /// Makes the arguments of a fixture with Box2D's defaults: friction 0.2, density 0, restitution
    /// 0.
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

/// The arguments of a revolute joint. The bodies' relative angle at its creation counts as 0.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RevoluteJointDef {
    /// The first body.
    pub body_a: BodyId,
    /// The second body, whose angle relative to the first is the joint's angle.
    pub body_b: BodyId,
    /// The anchor in the coordinates of the first body.
    pub local_anchor_a: Vec2,
    /// The anchor in the coordinates of the second body.
    pub local_anchor_b: Vec2,
    /// The least and the greatest angle.
    pub limits: Option<(f32, f32)>,
    /// Whether the joint has a motor.
    pub motor: bool,
    /// The target angular speed of the motor.
    pub motor_speed: f32,
    /// The largest torque of the motor.
    pub max_motor_torque: f32,
    /// Whether the two bodies may collide with each other.
    pub collide_connected: bool,
}

/// Two fixtures began or stopped touching.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ContactEvent {
    /// Whether they began to touch.
    pub begin: bool,
    /// The two fixtures.
    pub fixtures: [FixtureId; 2],
    /// The bodies of the two fixtures.
    pub bodies: [BodyId; 2],
}

/// A hit of a ray cast.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RayHit {
    /// The fixture that the ray hits; `None` for an edge of the
    /// [terrain](super::World::create_terrain).
    pub fixture: Option<FixtureId>,
    /// The point of the hit.
    pub point: Vec2,
    /// The fraction of the ray up to the hit, from 0 to 1.
    pub fraction: f32,
}
