//! Box2D's tuning constants (`b2Settings.h` of Box2D 2.3, as pybox2d 2.3.10 builds it), in metres,
//! kilograms, seconds and radians. They decide bits: none may be rounded or rearranged.

use std::f32::consts::PI;

/// Tolerance of lengths, too small to see.
pub(crate) const LINEAR_SLOP: f32 = 0.005;
/// Tolerance of angles.
pub(crate) const ANGULAR_SLOP: f32 = 2.0 / 180.0 * PI;
/// Skin around polygons and edges, in which contacts live.
pub(crate) const POLYGON_RADIUS: f32 = 2.0 * LINEAR_SLOP;
/// Margin by which a box in the broad phase exceeds its shape.
pub(crate) const AABB_EXTENSION: f32 = 0.1;
/// How many steps of motion ahead such a box reaches.
pub(crate) const AABB_MULTIPLIER: f32 = 2.0;
/// Times of impact that one contact may have in a step.
pub(crate) const MAX_SUB_STEPS: u32 = 8;
/// Contacts that take part in one time of impact.
pub(crate) const MAX_TOI_CONTACTS: usize = 32;
/// Approach speed below which a collision is inelastic.
pub(crate) const VELOCITY_THRESHOLD: f32 = 1.0;
/// Largest correction of a position in one iteration.
pub(crate) const MAX_LINEAR_CORRECTION: f32 = 0.2;
/// Largest correction of an angle in one iteration.
pub(crate) const MAX_ANGULAR_CORRECTION: f32 = 8.0 / 180.0 * PI;
/// Longest way of a body in one step.
pub(crate) const MAX_TRANSLATION: f32 = 2.0;
/// Largest turn of a body in one step.
pub(crate) const MAX_ROTATION: f32 = 0.5 * PI;
/// Share of an overlap that is resolved in one iteration.
pub(crate) const BAUMGARTE: f32 = 0.2;
/// The same, at a time of impact.
pub(crate) const TOI_BAUMGARTE: f32 = 0.75;
/// How long a body lies still before it sleeps.
pub(crate) const TIME_TO_SLEEP: f32 = 0.5;
/// Speed up to which a body counts as still.
pub(crate) const LINEAR_SLEEP_TOLERANCE: f32 = 0.01;
/// Angular speed up to which a body counts as still.
pub(crate) const ANGULAR_SLEEP_TOLERANCE: f32 = 2.0 / 180.0 * PI;
/// pybox2d's limit of a polygon's vertices; here it only bounds a loop of the time of impact.
pub(crate) const MAX_PUSH_BACKS: u32 = 16;
