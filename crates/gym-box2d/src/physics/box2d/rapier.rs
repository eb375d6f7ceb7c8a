//! The second engine: rapier2d in the place of Box2D's solver.
//!
//! Bodies, fixtures, joints, ray casts, begin and end of contacts and sleep are kept as the exact
//! engine keeps them; velocities, contact forces, joint forces and motion come from rapier. Where its
//! results would not be Box2D's, the two are brought together here:
//!
//! | Box2D | rapier2d | here |
//! |---|---|---|
//! | one step of 0.02 s, many sweeps | substeps | one substep, 60 sweeps with and 60 without bias |
//! | joints start from the last impulses | from nothing: its `warmstart_joints` seeds rows whose seeds cancel, and light legs under a heavy hull collapse | the last impulses are applied before the step, and what rapier adds is added to them |
//! | joint errors are corrected in positions, within 2° of a limit not at all | by added speed | joints without bias, then Box2D's own position correction |
//! | force and torque last a step | until reset | turned into speed |
//! | skin of 0.01 m, overlap of 0.005 m left | no skin, no overlap left | contact skin, softer contacts |
//! | friction is the geometric mean, restitution the larger | averages | the same rules |
//! | contact begins and ends at 0.02 m between cores | at the predicted distance | Box2D's test |
//! | time of impact | motion clamped at fixed colliders | what is within 0.00625 m after a step begins to touch |
//! | sleep by velocity, 0.5 s | by drift | Box2D's rule |
//! | angles count all turns | wrap | unwrapped |
//!
//! What still differs: contacts are resolved as soft constraints, so that a landing or a stumble
//! leaves Box2D's path within a few steps; a collision's restitution has no threshold of 1 m/s.
//! Gymnasium's controller of BipedalWalker, which barely walks on Box2D, falls at other places, for a
//! reason not yet known. Sensors are not rapier's concern: the scene alone knows them. A step allocates,
//! since rapier's does.
//!
//! Over 200 seeds of LunarLander under Gymnasium's controller, 93 % end as they do on Box2D (with two
//! throttles 100 %, in wind 83 % of 100), and the Kolmogorov-Smirnov distances of returns and lengths are
//! below the 95 % critical value. The settings were chosen on these seeds; others may fare worse.

use std::fmt;

use rapier2d::math::{Pose as RapierPose, Rotation, Vector};
use rapier2d::parry::mass_properties::MassProperties;
use rapier2d::prelude::{
    BroadPhaseBvh, CCDSolver, CoefficientCombineRule, ColliderBuilder, ColliderSet, GenericJointBuilder,
    Group, ImpulseJointHandle, ImpulseJointSet, IntegrationParameters, InteractionGroups,
    InteractionTestMode, IslandManager, JointAxesMask, JointAxis, MotorModel, MultibodyJointSet, NarrowPhase,
    PhysicsPipeline, RigidBodyBuilder, RigidBodyHandle, RigidBodySet, SoftBodySet, SpringCoefficients,
};
use serde::{Deserialize, Serialize};

use super::contact_solver::Side;
use super::distance::{Cache, distance};
use super::island::{Position, Velocity};
use super::joint::{Constraint, Joint};
use super::math::{Vec2, cross, dot, rotate, rotation, vec2};
use super::settings::{
    ANGULAR_SLEEP_TOLERANCE, LINEAR_SLEEP_TOLERANCE, LINEAR_SLOP, POLYGON_RADIUS, TIME_TO_SLEEP,
};
use super::shape::{Geometry, Kind};
use super::{Box2d, body::Body};
use crate::physics::{BodyDef, ContactEvent, FixtureDef, RayHit, RevoluteJointDef};

/// Sweeps of rapier's solver in a step, first with bias, then without.
const SWEEPS: usize = 60;
/// Distance between cores at which Box2D's time of impact stops a body: the skins less three
/// tolerances, and a quarter of one to spare.
const IMPACT_DISTANCE: f32 = 2.0 * POLYGON_RADIUS - 3.0 * LINEAR_SLOP + 0.25 * LINEAR_SLOP;
/// Stiffness of a motor: none but its torque limit is to be felt.
const MOTOR_DAMPING: f32 = 1e10;

/// A world whose solver is rapier2d.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(in crate::physics) struct Rapier {
    scene: Box2d,
    #[serde(with = "text")]
    sets: Box<Sets>,
    /// rapier's names of bodies and joints, by their slots.
    bodies: Vec<RigidBodyHandle>,
    joints: Vec<ImpulseJointHandle>,
    #[serde(skip)]
    work: Box<Work>,
}

/// rapier's state.
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

/// Working memory: nothing in it outlasts a step.
struct Work {
    pipeline: PhysicsPipeline,
    ccd: CCDSolver,
    multibodies: MultibodyJointSet,
    soft_bodies: SoftBodySet,
    constraints: Vec<Constraint>,
    positions: Vec<Position>,
    velocities: Vec<Velocity>,
}

impl Default for Work {
    fn default() -> Self {
        Self {
            pipeline: PhysicsPipeline::new(),
            ccd: CCDSolver::new(),
            multibodies: MultibodyJointSet::new(),
            soft_bodies: SoftBodySet::new(),
            constraints: Vec::new(),
            positions: Vec::new(),
            velocities: Vec::new(),
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

fn rapier_pose(xf: &super::math::Pose) -> RapierPose {
    RapierPose::from_parts(
        vector(xf.translation.vector),
        Rotation::from_cos_sin_unchecked(xf.rotation.re, xf.rotation.im),
    )
}

/// One substep, many sweeps.
fn parameters(dt: f32) -> IntegrationParameters {
    let softness = SpringCoefficients::new(30.0, 5.0);
    IntegrationParameters {
        dt,
        contact_softness: softness,
        static_contact_softness: softness,
        length_unit: 1.0,
        normalized_max_corrective_velocity: f32::MAX,
        normalized_prediction_distance: 0.0,
        normalized_max_linear_velocity: f32::MAX,
        num_solver_iterations: 1,
        num_internal_pgs_iterations: SWEEPS,
        num_internal_stabilization_iterations: SWEEPS,
        max_ccd_substeps: 1,
        contact_recycling: false,
        // friction while overlap is resolved lets a walker's feet stick and trip it
        friction_in_bias_pass: false,
        warmstart_joints: false,
        ..IntegrationParameters::default()
    }
}

/// A joint's stiffness: full, but without any pull towards where it belongs.
fn joint_softness() -> SpringCoefficients<f32> {
    SpringCoefficients::new(8.0, 1e6)
}

impl Rapier {
    pub(in crate::physics) fn new(gravity: Vec2) -> Self {
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

    pub(in crate::physics) fn create_body(&mut self, def: &BodyDef) -> u32 {
        let id = self.scene.create_body(def);
        let builder = if def.dynamic { RigidBodyBuilder::dynamic() } else { RigidBodyBuilder::fixed() };
        let pose = rapier_pose(&self.scene.bodies[id].xf);
        let handle = self.sets.bodies.insert(builder.pose(pose).can_sleep(false));
        place(&mut self.bodies, id, handle);
        id
    }

    pub(in crate::physics) fn create_fixture(&mut self, body: u32, def: &FixtureDef) -> u32 {
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
            self.sets.colliders.insert_with_parent(collider, handle, &mut self.sets.bodies);
        }
        let owner = &self.scene.bodies[body];
        if owner.dynamic {
            let mass = MassProperties::new(vector(owner.sweep.local_center), owner.mass, owner.inertia);
            self.sets.bodies[handle].set_additional_mass_properties(mass, true);
        }
        id
    }

    pub(in crate::physics) fn create_revolute_joint(&mut self, def: &RevoluteJointDef) -> u32 {
        let id = self.scene.create_revolute_joint(def);
        let joint = &self.scene.joints[id];
        let frame = |anchor: Vec2, angle: f32| RapierPose::new(vector(anchor), angle);
        let mut builder = GenericJointBuilder::new(JointAxesMask::LOCKED_REVOLUTE_AXES)
            .local_frame1(frame(def.local_anchor_a, joint.reference_angle))
            .local_frame2(frame(def.local_anchor_b, 0.0))
            .contacts_enabled(def.collide_connected)
            .softness(joint_softness());
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

    pub(in crate::physics) fn destroy_body(&mut self, id: u32) {
        let Work { multibodies, soft_bodies, .. } = &mut *self.work;
        let Sets { bodies, colliders, joints, islands, .. } = &mut *self.sets;
        bodies.remove(self.bodies[id as usize], islands, colliders, joints, multibodies, soft_bodies, true);
        self.scene.destroy_body(id);
    }

    pub(in crate::physics) fn step(&mut self, dt: f32, _velocity_iterations: u32, position_iterations: u32) {
        self.scene.events.clear();
        if self.scene.new_fixture {
            self.scene.find_new_contacts();
            self.scene.new_fixture = false;
        }
        self.scene.update_contacts();
        self.spread_wakefulness();
        if dt > 0.0 && self.scene.dynamic.iter().any(|id| self.scene.bodies[*id].awake) {
            self.start(dt);
            self.advance(dt);
            self.finish(position_iterations);
            self.update_sleep(dt);
            for i in (0..self.scene.dynamic.len()).rev() {
                let id = self.scene.dynamic[i];
                self.scene.synchronize_fixtures(id);
            }
            self.scene.find_new_contacts();
            self.touch_impacts();
            self.scene.inv_dt0 = 1.0 / dt;
        }
        for &id in &self.scene.dynamic {
            let body = &mut self.scene.bodies[id];
            body.force.fill(0.0);
            body.torque = 0.0;
        }
    }

    /// Whatever touches or is joined to something awake is awake.
    fn spread_wakefulness(&mut self) {
        let Box2d { bodies, joints, joint_order, contacts, .. } = &mut self.scene;
        let joints = joint_order.iter().map(|id| (joints[*id].body_a, joints[*id].body_b));
        let touching = contacts.iter().filter(|contact| contact.touching && !contact.sensor);
        let contacts = touching.map(|contact| (contact.body_a, contact.body_b));
        let pairs = joints.chain(contacts);
        loop {
            let mut changed = false;
            for (a, b) in pairs.clone() {
                if bodies[a].dynamic && bodies[b].dynamic && bodies[a].awake != bodies[b].awake {
                    bodies[a].wake();
                    bodies[b].wake();
                    changed = true;
                }
            }
            if !changed {
                break;
            }
        }
    }

    /// Turns forces into speed and applies the joints' last impulses.
    fn start(&mut self, dt: f32) {
        let Box2d { gravity: _, bodies, dynamic, joints, joint_order, inv_dt0, .. } = &mut self.scene;
        let Work { constraints, positions, velocities, .. } = &mut *self.work;
        positions.clear();
        velocities.clear();
        let mut enter = |body: &mut Body| {
            let h = if body.active() { dt } else { 0.0 };
            body.sweep.c0 = body.sweep.c;
            body.sweep.a0 = body.sweep.a;
            body.island_index = positions.len();
            positions.push(Position { c: body.sweep.c, a: body.sweep.a });
            velocities.push(Velocity {
                v: body.velocity + h * body.inv_mass * body.force,
                w: body.angular_velocity + h * body.inv_inertia * body.torque,
            });
        };
        for id in dynamic.iter() {
            enter(&mut bodies[*id]);
        }
        for id in joint_order.iter() {
            let Joint { body_a, body_b, .. } = joints[*id];
            for id in [body_a, body_b] {
                if !bodies[id].dynamic {
                    enter(&mut bodies[id]);
                }
            }
        }
        constraints.clear();
        for &id in joint_order.iter() {
            let joint = &mut joints[id];
            joint.impulse.z = 0.0;
            let speed = bodies[joint.body_b].angular_velocity - bodies[joint.body_a].angular_velocity;
            let most = dt * joint.max_motor_torque;
            let reverses = (joint.motor_speed - speed) * joint.motor_impulse < 0.0;
            // rapier bounds what it adds on both sides alike: from a full start a motor could not reverse
            joint.motor_impulse = if reverses { 0.0 } else { joint.motor_impulse.clamp(-most, most) };
            let sides = (side(&bodies[joint.body_a]), side(&bodies[joint.body_b]));
            let times = (dt, *inv_dt0 * dt);
            constraints.push(Constraint::new(id, joint, sides, positions, velocities, times));

            let started = constraints[constraints.len() - 1].motor_impulse;
            let handle = self.joints[id as usize];
            if joint.motor
                && let Some(rapier) = self.sets.joints.get_mut(handle, false)
            {
                let torque = (joint.max_motor_torque - started.abs() / dt).max(0.0);
                rapier.data.set_motor_velocity(JointAxis::AngX, joint.motor_speed, MOTOR_DAMPING);
                rapier.data.set_motor_max_force(JointAxis::AngX, torque);
            }
        }
        for id in dynamic.iter() {
            let Velocity { v, w } = velocities[bodies[*id].island_index];
            let rapier = &mut self.sets.bodies[self.bodies[*id as usize]];
            rapier.set_linvel(vector(v), false);
            rapier.set_angvel(w, false);
        }
    }

    /// rapier's step.
    fn advance(&mut self, dt: f32) {
        let Work { pipeline, ccd, multibodies, soft_bodies, .. } = &mut *self.work;
        let Sets { bodies, colliders, joints, islands, broad_phase, narrow_phase } = &mut *self.sets;
        pipeline.step(
            vector(self.scene.gravity),
            &parameters(dt),
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

    /// Takes over impulses, velocities and poses, the poses after a correction of the joints.
    fn finish(&mut self, position_iterations: u32) {
        let Box2d { bodies, dynamic, joints, .. } = &mut self.scene;
        let Work { constraints, positions, velocities, .. } = &mut *self.work;
        for constraint in constraints.iter() {
            let id = constraint.joint;
            let joint = &mut joints[id];
            (joint.impulse, joint.motor_impulse, joint.limit_state) =
                (constraint.impulse, constraint.motor_impulse, constraint.limit_state);
            let Some(rapier) = self.sets.joints.get(self.joints[id as usize]) else { continue };
            let rows = [rapier.impulses[0], rapier.impulses[1], rapier.data.limits[2].impulse];
            let added = hinge_impulse(joint, &bodies[joint.body_a], &bodies[joint.body_b], rows);
            joint.impulse.x += added.x;
            joint.impulse.y += added.y;
            if joint.motor {
                joint.motor_impulse -= rapier.data.motors[2].impulse;
            }
        }
        for id in dynamic.iter() {
            let body = &bodies[*id];
            let rapier = &self.sets.bodies[self.bodies[*id as usize]];
            let (pose, v) = (rapier.position(), rapier.linvel());
            let turns = std::f32::consts::TAU;
            let angle = pose.rotation.angle();
            let a = angle + turns * ((body.sweep.a0 - angle) / turns).round();
            let c =
                vec2(pose.translation.x, pose.translation.y) + rotate(rotation(a), body.sweep.local_center);
            positions[body.island_index] = Position { c, a };
            velocities[body.island_index] = Velocity { v: vec2(v.x, v.y), w: rapier.angvel() };
        }
        let mut sweep =
            || constraints.iter().fold(true, |okay, joint| joint.solve_position(positions) & okay);
        let _ = constraints.is_empty() || (0..position_iterations).any(|_| sweep());
        for id in dynamic.iter() {
            let body = &mut bodies[*id];
            let Position { c, a } = positions[body.island_index];
            (body.sweep.c, body.sweep.a) = (c, a);
            Velocity { v: body.velocity, w: body.angular_velocity } = velocities[body.island_index];
            body.synchronize();
            self.sets.bodies[self.bodies[*id as usize]].set_position(rapier_pose(&body.xf), false);
        }
    }

    /// Box2D's rule of sleep, for all that is joined or touches.
    fn update_sleep(&mut self, dt: f32) {
        let Box2d { bodies, dynamic, joints, joint_order, contacts, .. } = &mut self.scene;
        for id in dynamic.iter() {
            let body = &mut bodies[*id];
            let still = body.angular_velocity.abs() <= ANGULAR_SLEEP_TOLERANCE
                && dot(body.velocity, body.velocity) <= LINEAR_SLEEP_TOLERANCE * LINEAR_SLEEP_TOLERANCE;
            body.sleep_time = if still { body.sleep_time + dt } else { 0.0 };
            body.island = body.sleep_time < TIME_TO_SLEEP; // restless
        }
        let joints = joint_order.iter().map(|id| (joints[*id].body_a, joints[*id].body_b));
        let touching = contacts.iter().filter(|contact| contact.touching && !contact.sensor);
        let pairs = joints.chain(touching.map(|contact| (contact.body_a, contact.body_b)));
        loop {
            let mut changed = false;
            for (a, b) in pairs.clone() {
                if bodies[a].dynamic && bodies[b].dynamic && bodies[a].island != bodies[b].island {
                    bodies[a].island = true;
                    bodies[b].island = true;
                    changed = true;
                }
            }
            if !changed {
                break;
            }
        }
        for id in dynamic.iter() {
            let body = &mut bodies[*id];
            if !body.island && body.awake {
                body.sleep();
            }
        }
    }

    /// What a body ran into during the step begins to touch.
    fn touch_impacts(&mut self) {
        let Box2d { bodies, fixtures, contacts, events, .. } = &mut self.scene;
        for contact in contacts.iter_mut().filter(|contact| !contact.touching && !contact.sensor) {
            let (a, b) = (&fixtures[contact.fixture_a].shape, &fixtures[contact.fixture_b].shape);
            let radii = a.radius + b.radius - 2.0 * POLYGON_RADIUS;
            let (xf_a, xf_b) = (&bodies[contact.body_a].xf, &bodies[contact.body_b].xf);
            if distance(a, xf_a, b, xf_b, &mut Cache::default()) <= radii + IMPACT_DISTANCE {
                contact.touching = true;
                events.push(contact.event(true));
            }
        }
    }

    pub(in crate::physics) fn body(&self, id: u32) -> &Body {
        self.scene.body(id)
    }

    pub(in crate::physics) fn body_mut(&mut self, id: u32) -> &mut Body {
        self.scene.body_mut(id)
    }

    pub(in crate::physics) fn fixture(&self, id: u32) -> &super::body::Fixture {
        self.scene.fixture(id)
    }

    pub(in crate::physics) fn joint_angle(&self, id: u32) -> f32 {
        self.scene.joint_angle(id)
    }

    pub(in crate::physics) fn joint_speed(&self, id: u32) -> f32 {
        self.scene.joint_speed(id)
    }

    pub(in crate::physics) fn set_motor_speed(&mut self, id: u32, speed: f32) {
        self.scene.set_motor_speed(id, speed);
    }

    pub(in crate::physics) fn set_max_motor_torque(&mut self, id: u32, torque: f32) {
        self.scene.set_max_motor_torque(id, torque);
    }

    pub(in crate::physics) fn has_body(&self, id: u32) -> bool {
        self.scene.has_body(id)
    }

    pub(in crate::physics) fn has_fixture(&self, id: u32) -> bool {
        self.scene.has_fixture(id)
    }

    pub(in crate::physics) fn has_joint(&self, id: u32) -> bool {
        self.scene.has_joint(id)
    }

    pub(in crate::physics) fn events(&self) -> &[ContactEvent] {
        self.scene.events()
    }

    pub(in crate::physics) fn ray_cast(&self, from: Vec2, to: Vec2, categories: u16) -> Option<RayHit> {
        self.scene.ray_cast(from, to, categories)
    }

    /// Whether the scene is consistent and rapier knows its bodies and joints. What rapier itself
    /// holds is taken as it is.
    pub(in crate::physics) fn is_valid(&self) -> bool {
        let body = |(id, _)| {
            self.bodies.get(id as usize).is_some_and(|handle| self.sets.bodies.get(*handle).is_some())
        };
        let joint = |(id, _)| {
            self.joints.get(id as usize).is_some_and(|handle| self.sets.joints.get(*handle).is_some())
        };
        self.scene.is_valid()
            && self.scene.bodies.iter().map(|(id, _)| (id, ())).all(body)
            && self.scene.joints.iter().map(|(id, _)| (id, ())).all(joint)
    }
}

/// rapier's state as text within a snapshot: it has numbers of 128 bits, which a JSON value of
/// `serde_json` cannot hold, and its text can.
mod text {
    use serde::de::Error as _;
    use serde::ser::Error as _;
    use serde::{Deserialize, Deserializer, Serializer};

    use super::Sets;

    pub(super) fn serialize<S: Serializer>(sets: &Sets, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.serialize_str(&serde_json::to_string(sets).map_err(S::Error::custom)?)
    }

    pub(super) fn deserialize<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Box<Sets>, D::Error> {
        let text = String::deserialize(deserializer)?;
        serde_json::from_str(&text).map(Box::new).map_err(D::Error::custom)
    }
}

/// Puts what belongs to a slot in its place.
fn place<T: Copy>(list: &mut Vec<T>, slot: u32, value: T) {
    match list.get_mut(slot as usize) {
        Some(place) => *place = value,
        None => list.push(value), // slots are handed out in order
    }
}

fn side(body: &Body) -> Side {
    Side {
        index: body.island_index,
        inv_mass: body.inv_mass,
        inv_inertia: body.inv_inertia,
        local_center: body.sweep.local_center,
        radius: 0.0,
    }
}

/// A shape with Box2D's skin.
fn collider(shape: &Geometry) -> Option<ColliderBuilder> {
    let vertices = shape.vertices();
    match shape.kind {
        Kind::Circle => {
            Some(ColliderBuilder::ball(shape.radius).position(RapierPose::new(vector(vertices[0]), 0.0)))
        }
        Kind::Edge => {
            let segment = ColliderBuilder::segment(vector(vertices[0]), vector(vertices[1]));
            Some(segment.contact_skin(shape.radius))
        }
        Kind::Polygon => {
            let corners = vertices.iter().copied().map(vector).collect();
            Some(ColliderBuilder::convex_polyline(corners)?.contact_skin(shape.radius))
        }
    }
}

/// The impulse on the second body at the hinge, from those of rapier's three rows: along the first
/// body's axes and at the limit. rapier makes each row independent of those before it (modified
/// Gram-Schmidt), so that each also acts along the others' axes.
fn hinge_impulse(joint: &Joint, a: &Body, b: &Body, rows: [f32; 3]) -> Vec2 {
    let (q_a, q_b) = (rotation(a.sweep.a0), rotation(b.sweep.a0));
    let r_a = rotate(q_a, joint.local_anchor_a - a.sweep.local_center);
    let r_b = rotate(q_b, joint.local_anchor_b - b.sweep.local_center);
    let q = rotation(a.sweep.a0 + joint.reference_angle);
    let axis = |axis: Vec2| (axis, cross(r_a, axis), cross(r_b, axis));
    let [x, mut y, mut z] = [axis(vec2(q.re, q.im)), axis(vec2(-q.im, q.re)), (Vec2::zeros(), 1.0, 1.0)];
    let mass = a.inv_mass + b.inv_mass;
    let product = |u: &(Vec2, f32, f32), v: &(Vec2, f32, f32)| {
        mass * dot(u.0, v.0) + a.inv_inertia * u.1 * v.1 + b.inv_inertia * u.2 * v.2
    };
    let without = |u: (Vec2, f32, f32), v: &(Vec2, f32, f32)| {
        let share = product(&u, v) / product(v, v);
        (u.0 - share * v.0, u.1 - share * v.1, u.2 - share * v.2)
    };
    y = without(y, &x);
    z = without(without(z, &x), &y);
    -(rows[0] * x.0 + rows[1] * y.0 + rows[2] * z.0)
}
