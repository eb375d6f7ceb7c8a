//! The second engine: rapier2d instead of Box2D's solver.
//!
//! This crate manages bodies, fixtures, joints, ray casts, begin and end of contacts, islands and
//! sleep as its exact engine does. rapier finds the points of contact and solves the velocities:
//! forces of contacts, joints, motors and limits. The bodies then move along these velocities by
//! Box2D's rules. Where rapier's rules differ from Box2D's, this module adapts them:
//!
//! | Box2D | rapier2d | here |
//! |---|---|---|
//! | velocity iterations, then position iterations | one kind of iteration, with a bias that corrects positions | iterations without bias, then Box2D's position iterations |
//! | one step of 0.02 s, many iterations | substeps, few iterations | one substep, as many iterations as Box2D |
//! | warm start: all joints' last impulses are applied first | each constraint row is warm-started as it is solved, so the rows of a revolute joint cancel each other, and light legs under a heavy hull collapse | the impulses of revolute joints are applied before the step; motors and limits, which are bounded, use rapier's warm start |
//! | force and torque act for one step | until they are reset | added to the velocities |
//! | skins of 0.01 m, contact halfway between them | skins on one side of the contact | round shapes |
//! | friction is the geometric mean, restitution the larger | averages | the same rules |
//! | time of impact | motion clamped at fixed colliders | Box2D's |
//! | sleep by velocity, 0.5 s | by drift | Box2D's rule |
//!
//! From the same state a step in the air or on one foot gives Box2D's velocities to about 1e-4 m/s.
//! In landings Box2D's own iterations have not converged, so the order of constraints matters.
//! Trajectories therefore diverge within some seconds, as on Box2D itself if gravity is changed by
//! a ten-thousandth. Two differences remain: a collision's restitution has no threshold of 1 m/s,
//! and a step allocates, because rapier's does. The scene handles sensors; rapier does not see
//! them.
//!
//! Under Gymnasium's controllers the Kolmogorov-Smirnov distances of returns and lengths are below
//! the 95 % critical value: over 400 seeds of BipedalWalker 0.06 and 0.06 (critical 0.10), with 28
//! walks to the end on either engine; the result is similar on hardcore ground and for LunarLander.
//! Over 600 seeds, 96 % of landings end as on Box2D; with two throttles, 100 %; in wind, 92 % over
//! 800 seeds. For comparison: with gravity -10.001 instead of -10, 96 % of Box2D's own landings end
//! as before, and 92 % in wind.

use std::fmt;

use gym_core::exact::every_float;
use rapier2d::math::{Pose as RapierPose, Rotation, Vector};
use rapier2d::parry::mass_properties::MassProperties;
use rapier2d::prelude::{
    BroadPhaseBvh, CCDSolver, CoefficientCombineRule, ColliderBuilder, ColliderSet,
    GenericJointBuilder, Group, ImpulseJointHandle, ImpulseJointSet, IntegrationParameters,
    InteractionGroups, InteractionTestMode, IslandManager, JointAxesMask, JointAxis, MotorModel,
    MultibodyJointSet, NarrowPhase, PhysicsPipeline, RigidBodyBuilder, RigidBodyHandle,
    RigidBodySet, SoftBodySet, SpringCoefficients,
};
use serde::{Deserialize, Serialize};

use super::box2d::island::Island;
use super::box2d::joint::{Joint, LimitState};
use super::box2d::math::{Vec2, cross, dot, rotate, rotation, vec2};
use super::box2d::motion::Velocity;
use super::box2d::shape::{Geometry, Kind};
use super::box2d::{Box2d, TimeStep, body::Body};
use super::world::LARGEST;
use crate::physics::{BodyDef, ContactEvent, FixtureDef, RayHit, RevoluteJointDef};

/// The damping of a motor: so large that only the motor's torque limit matters.
const MOTOR_DAMPING: f32 = 1e10;

/// A world whose solver is rapier2d.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(super) struct Rapier {
    scene: Box2d,
    #[serde(with = "text")]
    sets: Box<Sets>,
    /// rapier's handles of bodies and joints, by their indices in the scene.
    bodies: Vec<RigidBodyHandle>,
    joints: Vec<ImpulseJointHandle>,
    #[serde(skip)]
    work: Box<Work>,
}

/// The state of rapier.
#[derive(Clone, Serialize, Deserialize)]
struct Sets {
    bodies: RigidBodySet,
    colliders: ColliderSet,
    joints: ImpulseJointSet,
    islands: IslandManager,
    broad_phase: BroadPhaseBvh,
    narrow_phase: NarrowPhase,
}

impl fmt::Debug for Sets {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Sets").finish_non_exhaustive()
    }
}

/// Working memory, without state between steps.
struct Work {
    pipeline: PhysicsPipeline,
    ccd: CCDSolver,
    multibodies: MultibodyJointSet,
    soft_bodies: SoftBodySet,
    /// The islands of a step, and unused islands for reuse.
    islands: Vec<Island>,
    spare: Vec<Island>,
}

impl Default for Work {
    fn default() -> Self {
        Self {
            pipeline: PhysicsPipeline::new(),
            ccd: CCDSolver::new(),
            multibodies: MultibodyJointSet::new(),
            soft_bodies: SoftBodySet::new(),
            islands: Vec::new(),
            spare: Vec::new(),
        }
    }
}

impl Clone for Work {
    fn clone(&self) -> Self {
        Self::default()
    }
}

impl fmt::Debug for Work {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Work").finish_non_exhaustive()
    }
}

fn vector(v: Vec2) -> Vector {
    Vector::new(v.x, v.y)
}

fn rapier_pose(xf: &super::box2d::math::Pose) -> RapierPose {
    RapierPose::from_parts(
        vector(xf.translation.vector),
        Rotation::from_cos_sin_unchecked(xf.rotation.re, xf.rotation.im),
    )
}

/// Returns the parameters of one substep without bias.
fn parameters(dt: f32, iterations: usize) -> IntegrationParameters {
    IntegrationParameters {
        dt,
        contact_softness: rigid(),
        static_contact_softness: rigid(),
        length_unit: 1.0,
        normalized_max_corrective_velocity: f32::MAX,
        normalized_prediction_distance: 0.0,
        normalized_max_linear_velocity: f32::MAX,
        num_solver_iterations: 1,
        num_internal_pgs_iterations: iterations,
        num_internal_stabilization_iterations: 0,
        max_ccd_substeps: 0,
        contact_recycling: false,
        warmstart_joints: true,
        ..IntegrationParameters::default()
    }
}

/// Full stiffness without position correction: the scene corrects positions itself.
fn rigid() -> SpringCoefficients<f32> {
    SpringCoefficients::new(8.0, 1e6)
}

impl Rapier {
    pub(super) fn new(gravity: Vec2) -> Self {
        let sets = Sets {
            bodies: RigidBodySet::new(),
            colliders: ColliderSet::new(),
            joints: ImpulseJointSet::new(),
            islands: IslandManager::new(),
            broad_phase: BroadPhaseBvh::new(),
            narrow_phase: NarrowPhase::new(),
        };
        Self {
            scene: Box2d::new(gravity),
            sets: Box::new(sets),
            bodies: Vec::new(),
            joints: Vec::new(),
            work: Box::default(),
        }
    }

    pub(super) fn create_body(&mut self, def: &BodyDef) -> u32 {
        let id = self.scene.create_body(def);
        let builder = if def.dynamic {
            RigidBodyBuilder::dynamic()
        } else {
            RigidBodyBuilder::fixed()
        };
        let pose = rapier_pose(&self.scene.bodies[id].xf);
        let handle = self.sets.bodies.insert(builder.pose(pose).can_sleep(false));
        place(&mut self.bodies, id, handle);
        id
    }

    pub(super) fn create_fixture(&mut self, body: u32, def: &FixtureDef) -> u32 {
        let id = self.scene.create_fixture(body, def);
        let handle = self.bodies[body as usize];
        if !def.sensor
            && let Some(collider) = collider(&self.scene.fixtures[id].shape)
        {
            let groups = InteractionGroups::new(
                Group::from_bits_truncate(def.filter.category.into()),
                Group::from_bits_truncate(def.filter.mask.into()),
                InteractionTestMode::And,
            );
            let collider = collider
                .density(0.0)
                .friction(def.friction)
                .friction_combine_rule(CoefficientCombineRule::GeometricMean)
                .restitution(def.restitution)
                .restitution_combine_rule(CoefficientCombineRule::Max)
                .collision_groups(groups);
            self.sets
                .colliders
                .insert_with_parent(collider, handle, &mut self.sets.bodies);
        }
        let owner = &self.scene.bodies[body];
        if owner.dynamic {
            let mass =
                MassProperties::new(vector(owner.sweep.local_center), owner.mass, owner.inertia);
            self.sets.bodies[handle].set_additional_mass_properties(mass, true);
        }
        id
    }

    pub(super) fn create_revolute_joint(&mut self, def: &RevoluteJointDef) -> u32 {
        let id = self.scene.create_revolute_joint(def);
        let joint = &self.scene.joints[id];
        let frame = |anchor: Vec2, angle: f32| RapierPose::new(vector(anchor), angle);
        let mut builder = GenericJointBuilder::new(JointAxesMask::LOCKED_REVOLUTE_AXES)
            .local_frame1(frame(def.local_anchor_a, joint.reference_angle))
            .local_frame2(frame(def.local_anchor_b, 0.0))
            .contacts_enabled(def.collide_connected)
            .softness(rigid());
        if let Some((lower, upper)) = def.limits {
            builder = builder.limits(JointAxis::AngX, [lower, upper]);
        }
        if def.motor {
            builder = builder
                .motor_model(JointAxis::AngX, MotorModel::AccelerationBased)
                .motor_velocity(JointAxis::AngX, def.motor_speed, MOTOR_DAMPING)
                .motor_max_force(JointAxis::AngX, def.max_motor_torque);
        }
        let [a, b] = [joint.body_a, joint.body_b].map(|body| self.bodies[body as usize]);
        let handle = self.sets.joints.insert(a, b, builder.build(), true);
        place(&mut self.joints, id, handle);
        id
    }

    pub(super) fn destroy_body(&mut self, id: u32) {
        let Work {
            multibodies,
            soft_bodies,
            ..
        } = &mut *self.work;
        let Sets {
            bodies,
            colliders,
            joints,
            islands,
            ..
        } = &mut *self.sets;
        bodies.remove(
            self.bodies[id as usize],
            islands,
            colliders,
            joints,
            multibodies,
            soft_bodies,
            true,
        );
        self.scene.destroy_body(id);
    }

    pub(super) fn step(&mut self, dt: f32, velocity_iterations: u32, position_iterations: u32) {
        self.scene.events.clear();
        if self.scene.new_fixture {
            self.scene.find_new_contacts(&mut Vec::new());
            self.scene.new_fixture = false;
        }
        self.scene.update_contacts();
        if dt > 0.0 {
            let ratio = self.scene.inv_dt0 * dt;
            let step = TimeStep {
                dt,
                ratio,
                velocity_iterations,
                position_iterations,
            };
            self.start(&step);
            self.advance(&step);
            self.finish(&step);
            self.scene.inv_dt0 = 1.0 / dt;
        }
        for &id in &self.scene.dynamic {
            let body = &mut self.scene.bodies[id];
            body.force.fill(0.0);
            body.torque = 0.0;
        }
    }

    /// Finds the islands, adds the effect of forces to the velocities, and applies the joints'
    /// impulses of the last step.
    fn start(&mut self, step: &TimeStep) {
        let Self {
            scene,
            sets,
            bodies,
            joints,
            work,
        } = self;
        work.spare.append(&mut work.islands);
        scene.forget_islands();
        for i in (0..scene.dynamic.len()).rev() {
            let mut island = work.spare.pop().unwrap_or_else(Island::new);
            if !scene.gather(&mut island, scene.dynamic[i]) {
                work.spare.push(island);
                continue;
            }
            island.enter(scene, step);
            island.build_contacts(scene, None);
            island.build_joints(scene, step);
            work.islands.push(island);
        }
        for id in &scene.dynamic {
            let rapier = &mut sets.bodies[bodies[*id as usize]];
            rapier.set_linvel(Vector::ZERO, false);
            rapier.set_angvel(0.0, false);
        }
        for island in &work.islands {
            for (id, Velocity { v, w }) in island.bodies.iter().zip(&island.velocities) {
                if scene.bodies[*id].dynamic {
                    let rapier = &mut sets.bodies[bodies[*id as usize]];
                    rapier.set_linvel(vector(*v), false);
                    rapier.set_angvel(*w, false);
                }
            }
        }
        for (id, joint) in scene.joints.iter() {
            let Some(rapier) = sets.joints.get_mut(joints[id as usize], false) else {
                continue;
            };
            rapier.impulses = Default::default();
            rapier.data.limits[2].impulse *= step.ratio;
            rapier.data.motors[2].impulse *= step.ratio;
            if joint.motor {
                rapier
                    .data
                    .set_motor_velocity(JointAxis::AngX, joint.motor_speed, MOTOR_DAMPING);
                rapier
                    .data
                    .set_motor_max_force(JointAxis::AngX, joint.max_motor_torque);
            }
        }
    }

    /// Returns the number of rapier's iterations: Box2D's number, or two fifths of it if nothing
    /// touches and every joint is at a limit, because the last impulses are then correct already.
    fn iterations(&self, step: &TimeStep) -> usize {
        let mut joints = self
            .work
            .islands
            .iter()
            .flat_map(|island| &island.joint_constraints);
        let loose = joints.any(|joint| joint.limit_state == LimitState::Inactive)
            || self
                .scene
                .contacts
                .iter()
                .any(|contact| contact.touching && !contact.sensor);
        let iterations = step.velocity_iterations as usize;
        if loose {
            iterations
        } else {
            iterations.div_ceil(5).saturating_mul(2)
        }
    }

    /// Makes a step of rapier.
    fn advance(&mut self, step: &TimeStep) {
        let parameters = parameters(step.dt, self.iterations(step));
        let Work {
            pipeline,
            ccd,
            multibodies,
            soft_bodies,
            ..
        } = &mut *self.work;
        let Sets {
            bodies,
            colliders,
            joints,
            islands,
            broad_phase,
            narrow_phase,
        } = &mut *self.sets;
        pipeline.step(
            Vector::ZERO, // gravity is part of the velocities already
            &parameters,
            islands,
            broad_phase,
            narrow_phase,
            bodies,
            colliders,
            joints,
            multibodies,
            soft_bodies,
            ccd,
            &(),
            &(),
        );
    }

    /// Copies impulses and velocities from rapier, and moves the bodies by Box2D's rules.
    fn finish(&mut self, step: &TimeStep) {
        let Self {
            scene,
            sets,
            bodies,
            joints,
            work,
        } = self;
        for island in &mut work.islands {
            for constraint in &island.joint_constraints {
                let Some(rapier) = sets.joints.get(joints[constraint.joint as usize]) else {
                    continue;
                };
                let joint = &mut scene.joints[constraint.joint];
                let rows = [rapier.impulses[0], rapier.impulses[1]];
                let added = joint_impulse(
                    joint,
                    &scene.bodies[joint.body_a],
                    &scene.bodies[joint.body_b],
                    rows,
                );
                joint.impulse = constraint.impulse;
                joint.impulse.x += added.x;
                joint.impulse.y += added.y;
                joint.limit_state = constraint.limit_state;
            }
            for (id, velocity) in island.bodies.iter().zip(&mut island.velocities) {
                if scene.bodies[*id].dynamic {
                    let rapier = &sets.bodies[bodies[*id as usize]];
                    let v = rapier.linvel();
                    *velocity = Velocity {
                        v: vec2(v.x, v.y),
                        w: rapier.angvel(),
                    };
                }
            }
            island.move_on(scene, step);
        }
        let mut island = work.spare.pop().unwrap_or_else(Island::new);
        scene.synchronize_islands(&mut island.pairs);
        scene.solve_toi(&mut island, step);
        work.spare.push(island);
        for id in &scene.dynamic {
            sets.bodies[bodies[*id as usize]]
                .set_position(rapier_pose(&scene.bodies[*id].xf), false);
        }
    }

    pub(super) fn body(&self, id: u32) -> &Body {
        self.scene.body(id)
    }

    pub(super) fn body_mut(&mut self, id: u32) -> &mut Body {
        self.scene.body_mut(id)
    }

    pub(super) fn fixture(&self, id: u32) -> &super::box2d::body::Fixture {
        self.scene.fixture(id)
    }

    pub(super) fn joint_angle(&self, id: u32) -> f32 {
        self.scene.joint_angle(id)
    }

    pub(super) fn joint_speed(&self, id: u32) -> f32 {
        self.scene.joint_speed(id)
    }

    pub(super) fn set_motor_speed(&mut self, id: u32, speed: f32) {
        self.scene.set_motor_speed(id, speed);
    }

    pub(super) fn set_max_motor_torque(&mut self, id: u32, torque: f32) {
        self.scene.set_max_motor_torque(id, torque);
    }

    pub(super) fn has_body(&self, id: u32) -> bool {
        self.scene.has_body(id)
    }

    pub(super) fn has_fixture(&self, id: u32) -> bool {
        self.scene.has_fixture(id)
    }

    pub(super) fn has_joint(&self, id: u32) -> bool {
        self.scene.has_joint(id)
    }

    pub(super) fn events(&self) -> &[ContactEvent] {
        self.scene.events()
    }

    pub(super) fn ray_casts<const N: usize>(
        &self,
        from: Vec2,
        to: &[Vec2; N],
        categories: u16,
    ) -> [Option<RayHit>; N] {
        self.scene.ray_casts(from, to, categories)
    }

    /// Whether the scene is consistent, and rapier knows its bodies and joints. Of rapier's own state
    /// only the size of its numbers is checked.
    pub(super) fn is_valid(&self) -> bool {
        let bodies = |id: u32| self.sets.bodies.get(*self.bodies.get(id as usize)?);
        let joints = |id: u32| self.sets.joints.get(*self.joints.get(id as usize)?);
        // constants of rapier are larger; the first is the frequency of a joint
        let own = [1e6, MOTOR_DAMPING, f32::MAX].map(f64::from);
        every_float(&*self.sets, |x| {
            x.abs() <= LARGEST || own.contains(&x.abs())
        }) && self.scene.is_valid()
            && self.scene.bodies.iter().all(|(id, _)| bodies(id).is_some())
            && self.scene.joints.iter().all(|(id, _)| joints(id).is_some())
    }
}

/// rapier's state is stored as text in a snapshot, because `serde_json::Value` cannot hold its
/// 128-bit numbers.
mod text {
    use serde::de::Error as _;
    use serde::ser::Error as _;
    use serde::{Deserialize, Deserializer, Serializer};

    use super::Sets;

    pub(super) fn serialize<S: Serializer>(sets: &Sets, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.serialize_str(&serde_json::to_string(sets).map_err(S::Error::custom)?)
    }

    pub(super) fn deserialize<'de, D: Deserializer<'de>>(
        deserializer: D,
    ) -> Result<Box<Sets>, D::Error> {
        let text = String::deserialize(deserializer)?;
        serde_json::from_str(&text)
            .map(Box::new)
            .map_err(D::Error::custom)
    }
}

/// Sets `list[slot]`, or appends `value` if `slot` is the length of `list`.
fn place<T: Copy>(list: &mut Vec<T>, slot: u32, value: T) {
    match list.get_mut(slot as usize) {
        Some(place) => *place = value,
        None => list.push(value), // slots are assigned in order
    }
}

/// Returns rapier's collider for `shape`, enlarged by Box2D's skin. With rapier's own skins, a
/// contact would not lie halfway between the two shapes, so a lever arm would have another length.
fn collider(shape: &Geometry) -> Option<ColliderBuilder> {
    let vertices = shape.vertices();
    match shape.kind {
        Kind::Circle => Some(
            ColliderBuilder::ball(shape.radius).position(RapierPose::new(vector(vertices[0]), 0.0)),
        ),
        Kind::Edge => {
            let [a, b] = [0, 1].map(|i| vector(vertices[i]));
            Some(ColliderBuilder::capsule_from_endpoints(a, b, shape.radius))
        }
        Kind::Polygon => {
            let corners = vertices.iter().copied().map(vector).collect();
            ColliderBuilder::round_convex_polyline(corners, shape.radius)
        }
    }
}

/// Returns the joint's impulse on the second body, computed from `rows`, the impulses of rapier's
/// two constraint rows along the first body's axes. rapier makes the second row independent of the
/// first (modified Gram-Schmidt), so the second row acts along the first axis too.
fn joint_impulse(joint: &Joint, a: &Body, b: &Body, rows: [f32; 2]) -> Vec2 {
    let (q_a, q_b) = (rotation(a.sweep.a0), rotation(b.sweep.a0));
    let r_a = rotate(q_a, joint.local_anchor_a - a.sweep.local_center);
    let r_b = rotate(q_b, joint.local_anchor_b - b.sweep.local_center);
    let q = rotation(a.sweep.a0 + joint.reference_angle);
    let (x, y) = (vec2(q.re, q.im), vec2(-q.im, q.re));
    let product = |u: Vec2, v: Vec2| {
        (a.inv_mass + b.inv_mass) * dot(u, v)
            + a.inv_inertia * cross(r_a, u) * cross(r_a, v)
            + b.inv_inertia * cross(r_b, u) * cross(r_b, v)
    };
    let y = y - product(y, x) / product(x, x) * x;
    -(rows[0] * x + rows[1] * y)
}
