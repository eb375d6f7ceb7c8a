//! The constant part of a simulation: bodies, joints, geoms and everything that follows from them.
//!
//! [`CompiledModel`] is plain data. Its fields, and its serialised form, have the names of MuJoCo's
//! `mjModel`, so that the two can be compared directly. [`Model`] is a checked [`CompiledModel`];
//! the engine accepts only this.

mod actuators;
pub(crate) mod bounds;
mod checked;
mod constraints;
mod frames;
mod hfields;
mod kinds;
mod layout;
mod lookup;
mod memory;
mod meshes;
mod mix;
mod pairs;
mod paths;
mod plan;
mod revision;
mod sensors;
mod serial;
mod shared;
mod softness;
mod textures;
mod triangles;
mod types;

use serde::{Deserialize, Serialize};

pub use checked::Model;
pub(crate) use constraints::{Equality, Scalar};
pub(crate) use frames::{Base, Mount, Pose, same, same_quat};
pub use hfields::Hfields;
pub use kinds::{
    BiasType, Cone, DynamicsType, EqualityType, GainType, GeomType, Integrator, JointType,
    ObjectType, Solver, TransmissionType, WrapType,
};
pub(crate) use layout::Hull;
pub use meshes::Meshes;
pub(crate) use pairs::{Pair, Polygons, Reach, signature};
pub(crate) use plan::{Bounds, Limit, Plan};
pub use revision::Revision;
pub use sensors::SensorType;
pub(crate) use sensors::{About, CONTACT, RAY, Stage};
pub use shared::Shared;
pub(crate) use softness::{SOLIMP, SOLREF, Softness};
pub use textures::{TextureType, Textures};
pub use types::{Disable, Fluid, Names, Options, Parameters, Statistics};
pub(crate) use types::{MAX_ITERATIONS, most_iterations, padded, sleep_policy};

/// A compiled model, with the field names of MuJoCo's `mjModel`.
///
/// Arrays named `body_*` have one element for each body, `jnt_*` for each joint, `dof_*` for each
/// degree of freedom, `geom_*` for each geom, and so on. Body 0 is the world. Ids that may be
/// absent are `-1`, as in MuJoCo. Lengths are metres, masses kilograms, angles radians, times
/// seconds. Quaternions are `w, x, y, z`.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default, remote = "Self")]
pub struct CompiledModel {
    /// The model's name; empty if it has none.
    pub model: String,
    /// The version of MuJoCo whose results the engine repeats.
    pub revision: Revision,
    /// The options of the simulation.
    pub opt: Options,
    /// Statistics of the model, which scale tolerances and pictures.
    pub stat: Statistics,
    /// Names of the objects of each kind.
    pub names: Names,

    /// Positions of the joints in the model's initial configuration (nq numbers).
    pub qpos0: Vec<f64>,
    /// Spring reference positions of the joints (nq numbers).
    pub qpos_spring: Vec<f64>,

    /// The body's parent, which has a smaller id; the world is its own parent.
    pub body_parentid: Vec<usize>,
    /// The ancestor that is a child of the world: the root of the kinematic tree whose centre of
    /// mass is the reference point of spatial vectors.
    pub body_rootid: Vec<usize>,
    /// The nearest ancestor with joints, or the body itself: bodies with the same value move as
    /// one.
    pub body_weldid: Vec<usize>,
    /// The tree of bodies that can move; -1 for static bodies.
    pub body_treeid: Vec<i32>,
    /// Number of joints.
    pub body_jntnum: Vec<usize>,
    /// First joint; -1 if there is none.
    pub body_jntadr: Vec<i32>,
    /// Number of degrees of freedom.
    pub body_dofnum: Vec<usize>,
    /// First degree of freedom; -1 if there is none.
    pub body_dofadr: Vec<i32>,
    /// Number of geoms.
    pub body_geomnum: Vec<usize>,
    /// First geom; -1 if there is none.
    pub body_geomadr: Vec<i32>,
    /// 1 if the body's part of the inertia matrix is diagonal, 2 if the body also has only slides,
    /// else 0.
    pub body_simple: Vec<u8>,
    /// Position in the parent's frame.
    pub body_pos: Vec<[f64; 3]>,
    /// Orientation in the parent's frame.
    pub body_quat: Vec<[f64; 4]>,
    /// Centre of mass in the body's frame.
    pub body_ipos: Vec<[f64; 3]>,
    /// Orientation of the principal axes of inertia in the body's frame.
    pub body_iquat: Vec<[f64; 4]>,
    /// Mass.
    pub body_mass: Vec<f64>,
    /// Mass of the body and all its descendants.
    pub body_subtreemass: Vec<f64>,
    /// Moments of inertia about the principal axes.
    pub body_inertia: Vec<[f64; 3]>,
    /// Mean inverse inertia at the centre of mass in the initial configuration: of translation, of
    /// rotation.
    pub body_invweight0: Vec<[f64; 2]>,
    /// The index of the mocap body in `mocap_pos`; -1 for other bodies.
    pub body_mocapid: Vec<i32>,
    /// Gravity compensation, as a fraction of the body's weight.
    pub body_gravcomp: Vec<f64>,

    /// When each tree of bodies falls asleep, as MuJoCo's `mjtSleepPolicy`: 1 and 3 never, 2 and 4
    /// where it rests, 5 from the start. Empty if the flag `sleep` is off.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub tree_sleep_policy: Vec<u8>,
    /// The length that makes the velocity of a degree of freedom one of translation. Empty if the
    /// flag `sleep` is off.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub dof_length: Vec<f64>,

    /// The joint's degrees of freedom.
    pub jnt_type: Vec<JointType>,
    /// First number of the joint in `qpos`.
    pub jnt_qposadr: Vec<usize>,
    /// First number of the joint in `qvel`.
    pub jnt_dofadr: Vec<usize>,
    /// The joint's body.
    pub jnt_bodyid: Vec<usize>,
    /// Whether `jnt_range` applies.
    pub jnt_limited: Vec<bool>,
    /// Anchor in the body's frame.
    pub jnt_pos: Vec<[f64; 3]>,
    /// Axis in the body's frame, of length 1.
    pub jnt_axis: Vec<[f64; 3]>,
    /// Lower and upper limit.
    pub jnt_range: Vec<[f64; 2]>,
    /// Distance at which a limit becomes active.
    pub jnt_margin: Vec<f64>,
    /// Stiffness of the joint's spring.
    pub jnt_stiffness: Vec<f64>,
    /// Factors of the square and the cube of the displacement in the force of the spring.
    #[serde(skip_serializing_if = "linear")]
    pub jnt_stiffnesspoly: Vec<[f64; 2]>,
    /// Reference of the limit: time constant, damping ratio.
    pub jnt_solref: Vec<[f64; 2]>,
    /// Impedance of the limit: dmin, dmax, width, midpoint, power.
    pub jnt_solimp: Vec<[f64; 5]>,
    /// Whether `jnt_actfrcrange` applies.
    pub jnt_actfrclimited: Vec<bool>,
    /// Lower and upper limit of the total actuator force.
    pub jnt_actfrcrange: Vec<[f64; 2]>,
    /// Whether gravity compensation is part of the actuator forces instead of the passive forces.
    pub jnt_actgravcomp: Vec<bool>,

    /// The degree of freedom's body.
    pub dof_bodyid: Vec<usize>,
    /// The degree of freedom's joint.
    pub dof_jntid: Vec<usize>,
    /// The previous degree of freedom on the path to the root; -1 at the root.
    pub dof_parentid: Vec<i32>,
    /// The kinematic tree.
    pub dof_treeid: Vec<usize>,
    /// The number of consecutive degrees of freedom from this one on whose bodies are simple
    /// (`body_simple`).
    pub dof_simplenum: Vec<usize>,
    /// Inertia added to the diagonal of the inertia matrix.
    pub dof_armature: Vec<f64>,
    /// Damping.
    pub dof_damping: Vec<f64>,
    /// Factors of the square and the cube of the velocity in the force of the damper.
    #[serde(skip_serializing_if = "linear")]
    pub dof_dampingpoly: Vec<[f64; 2]>,
    /// Friction loss.
    pub dof_frictionloss: Vec<f64>,
    /// Reference of dry friction: time constant, damping ratio.
    pub dof_solref: Vec<[f64; 2]>,
    /// Impedance of dry friction: dmin, dmax, width, midpoint, power.
    pub dof_solimp: Vec<[f64; 5]>,
    /// Diagonal of the inverse inertia matrix in the initial configuration; for a free joint,
    /// averaged over the three translations and over the three rotations.
    pub dof_invweight0: Vec<f64>,
    /// Diagonal of the inertia matrix in the initial configuration.
    #[serde(rename = "dof_M0")]
    pub dof_m0: Vec<f64>,

    /// Shape.
    pub geom_type: Vec<GeomType>,
    /// The geom's body.
    pub geom_bodyid: Vec<usize>,
    /// Two geoms collide if a bit of one's `geom_contype` is set in the other's `geom_conaffinity`.
    pub geom_contype: Vec<u32>,
    /// See `geom_contype`.
    pub geom_conaffinity: Vec<u32>,
    /// Dimension of the contact: 1 without friction, 3 with sliding friction.
    pub geom_condim: Vec<u8>,
    /// If priorities differ, the geom with the higher one determines friction and softness of a
    /// contact.
    pub geom_priority: Vec<i32>,
    /// Sizes: a sphere's radius; radius and half length of a capsule or cylinder; half lengths of a
    /// box and, for drawing, of a plane.
    pub geom_size: Vec<[f64; 3]>,
    /// Radius of the bounding sphere; 0 for a plane.
    pub geom_rbound: Vec<f64>,
    /// Position in the body's frame.
    pub geom_pos: Vec<[f64; 3]>,
    /// Orientation in the body's frame.
    pub geom_quat: Vec<[f64; 4]>,
    /// Friction: slide, spin, roll.
    pub geom_friction: Vec<[f64; 3]>,
    /// Weight of the geom when solref and solimp of a contact are averaged.
    pub geom_solmix: Vec<f64>,
    /// Reference of its contacts: time constant, damping ratio.
    pub geom_solref: Vec<[f64; 2]>,
    /// Impedance of its contacts: dmin, dmax, width, midpoint, power.
    pub geom_solimp: Vec<[f64; 5]>,
    /// Distance at which a contact becomes active; a pair's margins add up.
    pub geom_margin: Vec<f64>,
    /// Further distance within which a contact is listed, without force; a pair's gaps add up.
    pub geom_gap: Vec<f64>,
    /// Attraction where the geom touches another or is within the gap; those of a pair add up.
    #[serde(skip_serializing_if = "none_sticks")]
    pub geom_adhesion: Vec<f64>,
    /// Colour: red, green, blue, opacity.
    pub geom_rgba: Vec<[f64; 4]>,
    /// Group: pictures show groups 0 to 2.
    #[serde(skip_serializing_if = "zero")]
    pub geom_group: Vec<i32>,
    /// Material; -1 if there is none.
    pub geom_matid: Vec<i32>,
    /// Fluid coefficients: 1 for the ellipsoid model (else 0), five coefficients, virtual masses
    /// and moments.
    pub geom_fluid: Vec<Fluid>,
    /// Velocity of the surface in the geom's frame: linear, angular.
    #[serde(skip_serializing_if = "still")]
    pub geom_surfacevel: Vec<[f64; 6]>,
    /// The geom's mesh, the one that it was fitted to in 3.12, its height field, or -1.
    #[serde(skip_serializing_if = "none")]
    pub geom_dataid: Vec<i32>,
    /// The box around the geom in its frame: centre, half sizes. Of other shapes than meshes it
    /// follows from `geom_size`; empty in a model without geoms that are meshes.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub geom_aabb: Vec<[f64; 6]>,

    /// The meshes; copies of the model share them.
    #[serde(flatten)]
    pub meshes: Shared<Meshes>,
    /// The height fields; copies of the model share them.
    #[serde(flatten)]
    pub hfields: Shared<Hfields>,

    /// The site's body.
    pub site_bodyid: Vec<usize>,
    /// Position in the body's frame.
    pub site_pos: Vec<[f64; 3]>,
    /// Orientation in the body's frame.
    pub site_quat: Vec<[f64; 4]>,
    /// Shape, for drawing: 2 sphere, 3 capsule, 4 ellipsoid, 5 cylinder, 6 box.
    pub site_type: Vec<u8>,
    /// Half sizes.
    pub site_size: Vec<[f64; 3]>,
    /// Colour: red, green, blue, opacity.
    pub site_rgba: Vec<[f64; 4]>,
    /// Group: pictures show groups 0 to 2.
    #[serde(skip_serializing_if = "zero")]
    pub site_group: Vec<i32>,

    /// 0 fixed, 1 track, 2 trackcom, 3 targetbody, 4 targetbodycom.
    pub cam_mode: Vec<u8>,
    /// The camera's body.
    pub cam_bodyid: Vec<usize>,
    /// The target body of the modes targetbody and targetbodycom; -1 for none.
    pub cam_targetbodyid: Vec<i32>,
    /// Position in the body's frame.
    pub cam_pos: Vec<[f64; 3]>,
    /// Orientation in the body's frame.
    pub cam_quat: Vec<[f64; 4]>,
    /// Vertical field of view in degrees; the height of an orthographic camera's view.
    pub cam_fovy: Vec<f64>,
    /// 0 perspective, 1 orthographic.
    pub cam_projection: Vec<u8>,
    /// Width and height in pixels.
    pub cam_resolution: Vec<[i32; 2]>,
    /// Width and height of the sensor; 0 if the field of view is given instead.
    pub cam_sensorsize: Vec<[f64; 2]>,
    /// The focal lengths and the principal point on the sensor; 0 without a sensor.
    pub cam_intrinsic: Vec<[f64; 4]>,

    /// 0 spot, 1 directional, 2 point, 3 image.
    pub light_type: Vec<u8>,
    /// Position in the body's frame.
    pub light_pos: Vec<[f64; 3]>,
    /// Direction in the body's frame, of length 1.
    pub light_dir: Vec<[f64; 3]>,

    /// Colours of the materials: red, green, blue, opacity.
    pub mat_rgba: Vec<[f64; 4]>,
    /// Textures of the materials; -1 for none.
    pub mat_texid: Vec<i32>,
    /// How often a texture is repeated along a geom, or along 1 m if `mat_texuniform`.
    pub mat_texrepeat: Vec<[f64; 2]>,
    /// Whether the repetition is by lengths, not by geoms.
    pub mat_texuniform: Vec<bool>,
    /// Light that the material gives, as a part of its colour.
    pub mat_emission: Vec<f64>,
    /// Strength of the shine, 0 to 1.
    pub mat_specular: Vec<f64>,
    /// Sharpness of the shine, 0 to 1.
    pub mat_shininess: Vec<f64>,
    /// The textures; copies of the model share them.
    #[serde(flatten)]
    pub textures: Shared<Textures>,

    /// Type of the transmission.
    pub actuator_trntype: Vec<TransmissionType>,
    /// The joint, tendon, site or body, then the reference site, the slider's site, or -1.
    pub actuator_trnid: Vec<[i32; 2]>,
    /// Length of the rod of a slider-crank.
    pub actuator_cranklength: Vec<f64>,
    /// Gear: force or torque on each axis of the joint or site, per unit of actuator force.
    pub actuator_gear: Vec<[f64; 6]>,
    /// Type of the activation dynamics.
    pub actuator_dyntype: Vec<DynamicsType>,
    /// Type of the gain, which multiplies the control or activation.
    pub actuator_gaintype: Vec<GainType>,
    /// Type of the bias, which is added to the force.
    pub actuator_biastype: Vec<BiasType>,
    /// Parameters of the dynamics.
    pub actuator_dynprm: Vec<Parameters>,
    /// Parameters of the gain.
    pub actuator_gainprm: Vec<Parameters>,
    /// Parameters of the bias.
    pub actuator_biasprm: Vec<Parameters>,
    /// Whether `actuator_ctrlrange` applies.
    pub actuator_ctrllimited: Vec<bool>,
    /// Least and greatest control.
    pub actuator_ctrlrange: Vec<[f64; 2]>,
    /// Whether `actuator_forcerange` applies.
    pub actuator_forcelimited: Vec<bool>,
    /// Least and greatest force.
    pub actuator_forcerange: Vec<[f64; 2]>,
    /// Whether `actuator_actrange` applies.
    pub actuator_actlimited: Vec<bool>,
    /// Least and greatest activation.
    pub actuator_actrange: Vec<[f64; 2]>,
    /// Index of the activation in `act`; -1 if there is none.
    pub actuator_actadr: Vec<i32>,
    /// Whether the force uses the activation of the next timestep.
    pub actuator_actearly: Vec<bool>,
    /// Group; groups can be disabled.
    pub actuator_group: Vec<i32>,
    /// Least and greatest length, for muscles.
    pub actuator_lengthrange: Vec<[f64; 2]>,
    /// Length in the initial configuration.
    pub actuator_length0: Vec<f64>,
    /// Acceleration by a force of 1 in the initial configuration.
    pub actuator_acc0: Vec<f64>,

    /// First part of the tendon in the `wrap_*` arrays.
    pub tendon_adr: Vec<usize>,
    /// Number of parts.
    pub tendon_num: Vec<usize>,
    /// Whether `tendon_range` applies.
    pub tendon_limited: Vec<bool>,
    /// Least and greatest length.
    pub tendon_range: Vec<[f64; 2]>,
    /// Distance at which a limit becomes active.
    pub tendon_margin: Vec<f64>,
    /// Stiffness of the spring.
    pub tendon_stiffness: Vec<f64>,
    /// Factors of the square and the cube of the displacement in the force of the spring.
    #[serde(skip_serializing_if = "linear")]
    pub tendon_stiffnesspoly: Vec<[f64; 2]>,
    /// Damping.
    pub tendon_damping: Vec<f64>,
    /// Factors of the square and the cube of the velocity in the force of the damper.
    #[serde(skip_serializing_if = "linear")]
    pub tendon_dampingpoly: Vec<[f64; 2]>,
    /// Friction loss.
    pub tendon_frictionloss: Vec<f64>,
    /// Inertia along the tendon.
    pub tendon_armature: Vec<f64>,
    /// Lengths between which the spring is slack.
    pub tendon_lengthspring: Vec<[f64; 2]>,
    /// Length in the initial configuration.
    pub tendon_length0: Vec<f64>,
    /// Inverse inertia along the tendon in the initial configuration.
    pub tendon_invweight0: Vec<f64>,
    /// Whether `tendon_actfrcrange` applies.
    pub tendon_actfrclimited: Vec<bool>,
    /// Lower and upper limit of the total actuator force.
    pub tendon_actfrcrange: Vec<[f64; 2]>,
    /// Reference of the limit: time constant, damping ratio.
    pub tendon_solref_lim: Vec<[f64; 2]>,
    /// Impedance of the limit: dmin, dmax, width, midpoint, power.
    pub tendon_solimp_lim: Vec<[f64; 5]>,
    /// Reference of dry friction.
    pub tendon_solref_fri: Vec<[f64; 2]>,
    /// Impedance of dry friction.
    pub tendon_solimp_fri: Vec<[f64; 5]>,
    /// Kinds of the tendons' parts.
    pub wrap_type: Vec<WrapType>,
    /// Joints, sites and geoms of the tendons' parts; -1 for a pulley.
    pub wrap_objid: Vec<i32>,
    /// Coefficient of a joint, divisor of a pulley, or side site of a geom (-1 for none).
    pub wrap_prm: Vec<f64>,

    /// Kinds of the equality constraints.
    pub eq_type: Vec<EqualityType>,
    /// Types of the objects that they constrain.
    pub eq_objtype: Vec<ObjectType>,
    /// The first object.
    pub eq_obj1id: Vec<i32>,
    /// The second object; -1 if there is none.
    pub eq_obj2id: Vec<i32>,
    /// Whether the constraint is active initially.
    pub eq_active0: Vec<bool>,
    /// Reference: time constant, damping ratio.
    pub eq_solref: Vec<[f64; 2]>,
    /// Impedance: dmin, dmax, width, midpoint, power.
    pub eq_solimp: Vec<[f64; 5]>,
    /// Anchors, relative poses and polynomials.
    pub eq_data: Vec<[f64; 11]>,

    /// Kinds of the sensors.
    pub sensor_type: Vec<SensorType>,
    /// Type of the sensor's object.
    pub sensor_objtype: Vec<ObjectType>,
    /// The object; -1 if there is none.
    pub sensor_objid: Vec<i32>,
    /// Type of the reference object, in whose frame the sensor measures.
    pub sensor_reftype: Vec<ObjectType>,
    /// The reference object; -1 for the world.
    pub sensor_refid: Vec<i32>,
    /// For contacts: the values of each as bits, 0 all, 1 nearest, 2 strongest or 3 the sum, and the
    /// number of contacts. For rangefinders: the values as bits.
    pub sensor_intprm: Vec<[i32; 3]>,
    /// Number of values.
    pub sensor_dim: Vec<usize>,
    /// Index of the first value in `sensordata`.
    pub sensor_adr: Vec<usize>,
    /// Bound of the values; 0 for none.
    pub sensor_cutoff: Vec<f64>,
    /// Standard deviation of the noise, as declared; the engine adds no noise.
    pub sensor_noise: Vec<f64>,

    /// Dimension of the contacts of explicit pairs.
    pub pair_dim: Vec<u8>,
    /// The first geom.
    pub pair_geom1: Vec<usize>,
    /// The second geom.
    pub pair_geom2: Vec<usize>,
    /// Reference of the contacts.
    pub pair_solref: Vec<[f64; 2]>,
    /// Reference of the contacts' friction; 0 for the same as `pair_solref`.
    pub pair_solreffriction: Vec<[f64; 2]>,
    /// Impedance of the contacts.
    pub pair_solimp: Vec<[f64; 5]>,
    /// Distance at which a contact becomes active.
    pub pair_margin: Vec<f64>,
    /// Further distance within which a contact is listed, without force.
    pub pair_gap: Vec<f64>,
    /// Attraction of the geoms.
    #[serde(skip_serializing_if = "none_sticks")]
    pub pair_adhesion: Vec<f64>,
    /// Friction: slide twice, spin, roll twice.
    pub pair_friction: Vec<[f64; 5]>,

    /// Pairs of bodies whose geoms never collide: `(smaller id << 16) + greater id`.
    pub exclude_signature: Vec<u32>,

    /// Positions of the keyframes.
    pub key_qpos: Vec<Vec<f64>>,
    /// Velocities of the keyframes.
    pub key_qvel: Vec<Vec<f64>>,
    /// Times of the keyframes.
    pub key_time: Vec<f64>,
    /// Controls of the keyframes.
    pub key_ctrl: Vec<Vec<f64>>,
    /// Activations of the keyframes.
    pub key_act: Vec<Vec<f64>>,
    /// Positions of the mocap bodies in the keyframes.
    pub key_mpos: Vec<Vec<f64>>,
    /// Orientations of the mocap bodies in the keyframes.
    pub key_mquat: Vec<Vec<f64>>,
}

/// Whether all groups are 0.
fn zero(groups: &[i32]) -> bool {
    groups.iter().all(|group| *group == 0)
}

/// Whether no spring or damper has factors of higher powers.
fn linear(higher: &[[f64; 2]]) -> bool {
    higher.iter().all(|factors| *factors == [0.0; 2])
}

/// Whether there is no adhesion.
fn none_sticks(adhesion: &[f64]) -> bool {
    adhesion.iter().all(|force| *force == 0.0)
}

/// Whether no surface moves.
fn still(velocities: &[[f64; 6]]) -> bool {
    velocities.iter().all(|velocity| *velocity == [0.0; 6])
}

/// Whether no geom has a mesh.
fn none(ids: &[i32]) -> bool {
    ids.iter().all(|id| *id == -1)
}
