//! Box2D's tuning constants (`b2Settings.h` of Box2D 2.3, as built by pybox2d 2.3.10), in metres,
//! kilograms, seconds and radians. They affect the bits: do not round or rearrange them.

use std::f32::consts::PI;

/// Tolerance of lengths: small enough to be invisible.
pub(crate) const LINEAR_SLOP: f32 = 0.005;
/// Tolerance of angles: small enough to be invisible.
pub(crate) const ANGULAR_SLOP: f32 = 2.0 / 180.0 * PI;
/// Radius of the skin around polygons and edges.
pub(crate) const POLYGON_RADIUS: f32 = 2.0 * LINEAR_SLOP;
/// Margin of a broad-phase box around its shape.
pub(crate) const AABB_EXTENSION: f32 = 0.1;
/// The number of steps whose motion a broad-phase box covers in advance.
pub(crate) const AABB_MULTIPLIER: f32 = 2.0;
/// The most impacts of one contact per step.
pub(crate) const MAX_SUB_STEPS: u32 = 8;
/// The most contacts that are solved with one impact.
pub(crate) const MAX_TOI_CONTACTS: usize = 32;
/// Relative speed below which a collision is inelastic.
pub(crate) const VELOCITY_THRESHOLD: f32 = 1.0;
/// Largest correction of a position per iteration.
pub(crate) const MAX_LINEAR_CORRECTION: f32 = 0.2;
/// Largest correction of an angle per iteration.
pub(crate) const MAX_ANGULAR_CORRECTION: f32 = 8.0 / 180.0 * PI;
/// Largest translation of a body per step.
pub(crate) const MAX_TRANSLATION: f32 = 2.0;
/// Largest rotation of a body per step.
pub(crate) const MAX_ROTATION: f32 = 0.5 * PI;
/// Fraction of an overlap that is resolved per iteration.
pub(crate) const BAUMGARTE: f32 = 0.2;
/// Fraction of an overlap that is resolved per iteration at a time of impact.
pub(crate) const TOI_BAUMGARTE: f32 = 0.75;
/// Seconds at rest after which a body sleeps.
pub(crate) const TIME_TO_SLEEP: f32 = 0.5;
/// Speed up to which a body counts as at rest.
pub(crate) const LINEAR_SLEEP_TOLERANCE: f32 = 0.01;
/// Angular speed up to which a body counts as at rest.
pub(crate) const ANGULAR_SLEEP_TOLERANCE: f32 = 2.0 / 180.0 * PI;
/// The most iterations of the inner loop of the time of impact: pybox2d's `b2_maxPolygonVertices`.
pub(crate) const MAX_PUSH_BACKS: u32 = 16;
