//! The common interface of both engines.

use gym_core::exact::every_float;
use serde::{Deserialize, Serialize};

#[cfg(feature = "rapier")]
use super::Shape;
use super::box2d::Box2d;
use super::box2d::island::Island;
use super::box2d::lanes::{Lanes, Place};
#[cfg(feature = "rapier")]
use super::rapier::Rapier;
use super::{
    BodyDef, BodyId, ContactEvent, FixtureDef, FixtureId, JointId, Pose, RayHit, RevoluteJointDef,
    Vec2,
};

/// The largest number of a world that is restored. Episodes have up to 46,000, one divided by the
/// moment of inertia of LunarLander's exhaust, and a step multiplies masses, lengths and speeds in
/// `f32`.
pub(super) const LARGEST: f64 = 1e5;

/// The engine of a world.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(try_from = "String", into = "String")]
pub enum Physics {
    /// Box2D 2.3, to the last bit.
    #[default]
    Box2d,
    /// rapier2d, with the same rules for contacts, joints and sleep.
    #[cfg(feature = "rapier")]
    Rapier,
}

impl From<Physics> for String {
    fn from(physics: Physics) -> Self {
        match physics {
            Physics::Box2d => "box2d".into(),
            #[cfg(feature = "rapier")]
            Physics::Rapier => "rapier".into(),
        }
    }
}

impl TryFrom<String> for Physics {
    type Error = String;

    fn try_from(name: String) -> Result<Self, String> {
        match name.as_str() {
            "box2d" => Ok(Self::Box2d),
            #[cfg(feature = "rapier")]
            "rapier" => Ok(Self::Rapier),
            #[cfg(not(feature = "rapier"))]
            "rapier" => Err("this build lacks rapier2d: build with the feature `rapier`".into()),
            _ => Err(format!(
                "`{name}` is not an engine: choose `box2d` or `rapier`"
            )),
        }
    }
}

impl gym_core::ArgumentType for Physics {
    fn kind() -> String {
        String::kind()
    }
}

/// A world of rigid bodies. Its whole state is plain data: a clone, or a world that was stored and
/// loaded, continues identically.
///
/// # Panics
/// Methods that take an id panic, like indexing, if its object was destroyed.
#[derive(Debug, Serialize, Deserialize)]
pub struct World {
    engine: Engine,
    /// Working memory for [`step`](Self::step).
    #[serde(skip)]
    island: Option<Box<Island>>,
}

impl Clone for World {
    fn clone(&self) -> Self {
        Self {
            engine: self.engine.clone(),
            island: None,
        }
    }
}

#[derive(Clone, Debug, Serialize, Deserialize)]
enum Engine {
    Box2d(Box<Box2d>),
    #[cfg(feature = "rapier")]
    Rapier(Box<Rapier>),
}

/// Calls a method of the engine.
macro_rules! engine {
    ($world:expr, $engine:ident => $call:expr) => {
        match $world {
            Engine::Box2d($engine) => $call,
            #[cfg(feature = "rapier")]
            Engine::Rapier($engine) => $call,
        }
    };
}

impl World {
    /// Makes an empty world of the Box2D engine.
    pub fn new(gravity: Vec2) -> Self {
        Self::with(Physics::Box2d, gravity)
    }

    /// Makes an empty world of the engine `physics`.
    pub fn with(physics: Physics, gravity: Vec2) -> Self {
        let engine = match physics {
            Physics::Box2d => Engine::Box2d(Box::new(Box2d::new(gravity))),
            #[cfg(feature = "rapier")]
            Physics::Rapier => Engine::Rapier(Box::new(Rapier::new(gravity))),
        };
        Self {
            engine,
            island: None,
        }
    }

    /// Returns the allocated bytes of a Box2D world.
    #[cfg(test)]
    pub(crate) fn bytes(&self) -> usize {
        match &self.engine {
            Engine::Box2d(world) => world.bytes(),
            #[cfg(feature = "rapier")]
            Engine::Rapier(_) => 0,
        }
    }

    /// Adds a body.
    pub fn create_body(&mut self, def: &BodyDef) -> BodyId {
        BodyId(engine!(&mut self.engine, world => world.create_body(def)))
    }

    /// Adds a fixture to a body, and its mass.
    pub fn create_fixture(&mut self, body: BodyId, def: &FixtureDef) -> FixtureId {
        FixtureId(engine!(&mut self.engine, world => world.create_fixture(body.0, def)))
    }

    /// Adds terrain: an edge from each point to the next. Each edge is a static body with one
    /// fixture and Box2D's default filter. An edge takes little memory: it has an id only while a
    /// moving body is near, and ray casts report its hits without a fixture. A world has at most
    /// one terrain.
    pub fn create_terrain(&mut self, points: &[Vec2], friction: f32) {
        match &mut self.engine {
            Engine::Box2d(world) => world.create_terrain(points, friction),
            #[cfg(feature = "rapier")]
            Engine::Rapier(_) => {
                for pair in points.windows(2) {
                    let edge = FixtureDef {
                        friction,
                        ..FixtureDef::new(Shape::Edge(pair[0], pair[1]))
                    };
                    let body = self.create_body(&BodyDef::fixed(Vec2::zeros(), 0.0));
                    self.create_fixture(body, &edge);
                }
            }
        }
    }

    /// Joins two bodies by a revolute joint.
    pub fn create_revolute_joint(&mut self, def: &RevoluteJointDef) -> JointId {
        JointId(engine!(&mut self.engine, world => world.create_revolute_joint(def)))
    }

    /// Destroys a body with its fixtures and joints.
    pub fn destroy_body(&mut self, body: BodyId) {
        engine!(&mut self.engine, world => world.destroy_body(body.0));
    }

    /// Advances the world by `dt` seconds. More iterations make joints and contacts stiffer.
    pub fn step(&mut self, dt: f32, velocity_iterations: u32, position_iterations: u32) {
        match &mut self.engine {
            Engine::Box2d(world) => {
                let island = self.island.get_or_insert_with(|| Box::new(Island::new()));
                world.begin(island, dt, velocity_iterations, position_iterations);
                island.solve_velocities();
                world.finish(island);
            }
            #[cfg(feature = "rapier")]
            Engine::Rapier(world) => world.step(dt, velocity_iterations, position_iterations),
        }
    }

    /// Runs the first part of a step, up to the velocity iterations, which `lanes` runs for many
    /// worlds together. [`finish`](Self::finish) must follow.
    pub(crate) fn begin(
        &mut self,
        lanes: &mut Lanes,
        dt: f32,
        velocity_iterations: u32,
        position_iterations: u32,
    ) -> Place {
        self.island = None;
        match &mut self.engine {
            Engine::Box2d(world) => {
                lanes.begin(world, dt, velocity_iterations, position_iterations)
            }
            #[cfg(feature = "rapier")]
            Engine::Rapier(world) => {
                world.step(dt, velocity_iterations, position_iterations);
                Place::default()
            }
        }
    }

    /// Prefetches the memory that a step needs: see
    /// [`Lockstep::prefetch`](gym_core::vector::lockstep::Lockstep::prefetch).
    pub(crate) fn prefetch(&self) -> u32 {
        match &self.engine {
            Engine::Box2d(world) => world.prefetch(),
            #[cfg(feature = "rapier")]
            Engine::Rapier(_) => 0,
        }
    }

    /// Finishes the step that [`begin`](Self::begin) began. `place` is the result of `begin`;
    /// `lanes` has run the velocity iterations.
    pub(crate) fn finish(&mut self, lanes: &mut Lanes, place: Place) {
        match &mut self.engine {
            Engine::Box2d(world) => lanes.finish(place, world),
            #[cfg(feature = "rapier")]
            Engine::Rapier(_) => {}
        }
    }

    /// Returns the contacts that began or ended during the last step, in order.
    pub fn contact_events(&self) -> &[ContactEvent] {
        engine!(&self.engine, world => world.events())
    }

    /// Returns the first hit of a ray with a fixture in one of `categories`.
    pub fn ray_cast(&self, from: Vec2, to: Vec2, categories: u16) -> Option<RayHit> {
        let [hit] = self.ray_casts(from, &[to], categories);
        hit
    }

    /// Returns the first hit of each ray from `from`.
    pub fn ray_casts<const N: usize>(
        &self,
        from: Vec2,
        to: &[Vec2; N],
        categories: u16,
    ) -> [Option<RayHit>; N] {
        engine!(&self.engine, world => world.ray_casts(from, to, categories))
    }

    /// Applies `force`, in N, at a body's centre of mass during the next step, and wakes the body.
    pub fn apply_force_to_center(&mut self, body: BodyId, force: Vec2) {
        engine!(&mut self.engine, world => world.body_mut(body.0).apply_force(force));
    }

    /// Applies `torque`, in N m, during the next step, and wakes the body.
    pub fn apply_torque(&mut self, body: BodyId, torque: f32) {
        engine!(&mut self.engine, world => world.body_mut(body.0).apply_torque(torque));
    }

    /// Applies `impulse`, in N s, at the world's point `point`, and wakes the body.
    pub fn apply_linear_impulse(&mut self, body: BodyId, impulse: Vec2, point: Vec2) {
        engine!(&mut self.engine, world => world.body_mut(body.0).apply_impulse(impulse, point));
    }

    /// Returns the pose of a body.
    pub fn pose(&self, body: BodyId) -> Pose {
        engine!(&self.engine, world => world.body(body.0).xf)
    }

    /// Returns the position of a body's origin.
    pub fn position(&self, body: BodyId) -> Vec2 {
        self.pose(body).translation.vector
    }

    /// Returns the angle of a body, including full turns.
    pub fn angle(&self, body: BodyId) -> f32 {
        engine!(&self.engine, world => world.body(body.0).sweep.a)
    }

    /// Returns the velocity of a body's centre of mass.
    pub fn linear_velocity(&self, body: BodyId) -> Vec2 {
        engine!(&self.engine, world => world.body(body.0).velocity)
    }

    /// Returns the angular velocity of a body.
    pub fn angular_velocity(&self, body: BodyId) -> f32 {
        engine!(&self.engine, world => world.body(body.0).angular_velocity)
    }

    /// Returns the mass of a body.
    pub fn mass(&self, body: BodyId) -> f32 {
        engine!(&self.engine, world => world.body(body.0).mass)
    }

    /// Whether a body is awake.
    pub fn is_awake(&self, body: BodyId) -> bool {
        engine!(&self.engine, world => world.body(body.0).awake)
    }

    /// Returns the vertices of a fixture's shape in the coordinates of its body: one vertex for a
    /// circle, two for an edge.
    pub fn vertices(&self, fixture: FixtureId) -> &[Vec2] {
        engine!(&self.engine, world => world.fixture(fixture.0).shape.vertices())
    }

    /// Returns the body of a fixture.
    pub fn body_of(&self, fixture: FixtureId) -> BodyId {
        BodyId(engine!(&self.engine, world => world.fixture(fixture.0).body))
    }

    /// Returns the angle of a joint.
    pub fn joint_angle(&self, joint: JointId) -> f32 {
        engine!(&self.engine, world => world.joint_angle(joint.0))
    }

    /// Returns the angular speed of a joint.
    pub fn joint_speed(&self, joint: JointId) -> f32 {
        engine!(&self.engine, world => world.joint_speed(joint.0))
    }

    /// Sets the target speed of a joint's motor, and wakes both bodies.
    pub fn set_motor_speed(&mut self, joint: JointId, speed: f32) {
        engine!(&mut self.engine, world => world.set_motor_speed(joint.0, speed));
    }

    /// Sets the largest torque of a joint's motor, and wakes both bodies.
    pub fn set_max_motor_torque(&mut self, joint: JointId, torque: f32) {
        engine!(&mut self.engine, world => world.set_max_motor_torque(joint.0, torque));
    }

    /// Whether a deserialized world can be used without a panic, and a step of it gives numbers.
    pub fn is_valid(&self) -> bool {
        every_float(self, |x| x.abs() <= LARGEST)
            && engine!(&self.engine, world => world.is_valid())
    }

    /// Whether a deserialized id belongs to a body of this world.
    pub fn has_body(&self, body: BodyId) -> bool {
        engine!(&self.engine, world => world.has_body(body.0))
    }

    /// Whether a deserialized id belongs to a fixture of this world.
    pub fn has_fixture(&self, fixture: FixtureId) -> bool {
        engine!(&self.engine, world => world.has_fixture(fixture.0))
    }

    /// Whether a deserialized id belongs to a joint of this world.
    pub fn has_joint(&self, joint: JointId) -> bool {
        engine!(&self.engine, world => world.has_joint(joint.0))
    }
}
