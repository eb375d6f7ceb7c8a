//! Boxes around bodies before 4.0: MuJoCo's `mj_broadphase`.
//!
//! Geoms of two moving bodies are compared only if the boxes around the bodies overlap along the
//! principal axes of the positions of all geoms, the first in single precision. Where geoms touch,
//! only rounding can separate the boxes. So the test runs only if all contacts of a pair are within
//! rounding of the margin.
//!
//! The rule of 4.0 is another one, and unknown. There, of 100,000 poses of meshes, 8 have a contact
//! here, less than 1e-8 deep, that libmujoco drops.

use super::Frame;
use crate::math::axes::Axes;
use crate::math::spatial::{InTurn, Mat3, Order, Vec3, add, column, dot, norm, rotate, scale, sub};
use crate::model::bounds::bounding_box;
use crate::{Contact, Model};

/// Whether boxes around two bodies can be apart although a contact of their geoms is so deep below
/// the margin.
pub(super) fn may_separate(contact: &Contact, margin: f64) -> bool {
    // single precision has 24 bits
    const ROUNDING: f64 = 1e-4;
    const RELATIVE: f64 = 1e-6;
    contact.dist > margin - ROUNDING - RELATIVE * norm(contact.pos)
}

/// The axes of the boxes, by rows. `frame` returns the frame of a geom.
pub(super) fn axes(m: &Model, frame: &impl Fn(usize) -> Frame) -> Mat3 {
    let moving = || (0..m.ngeom()).filter(|g| m.geom_bodyid[*g] != 0);
    let share = 1.0 / moving().count() as f64;
    let sum = moving().fold([0.0; 3], |sum, g| add(sum, frame(g).0));
    let centre = scale(sum, share);
    let mut covariance = [0.0; 9];
    for g in moving() {
        let away = sub(frame(g).0, centre);
        for (k, element) in covariance.iter_mut().enumerate() {
            *element += away[k / 3] * away[k % 3];
        }
    }
    let axes = Axes {
        half_tangents: false,
        rest: 0.0,
        unit: |quat| InTurn::normalize_quat((), quat),
        product: |a, b| InTurn::normalize_quat((), InTurn::mul_quat(a, b)),
    };
    let (_, quat) = axes.of(&covariance.map(|x| x * share));
    InTurn::quat_to_mat(quat)
}

/// Whether the boxes around two bodies are apart.
pub(super) fn apart(
    m: &Model,
    axes: &Mat3,
    mut bodies: [usize; 2],
    frame: &impl Fn(usize) -> Frame,
) -> bool {
    bodies.sort_unstable();
    let [[a_low, a_high], [b_low, b_high]] = bodies.map(|body| bounds(m, axes, body, frame));
    // bounds that are equal are in the order of the bodies, each lower bound before the upper
    let first = (a_high[0] as f32) > (b_low[0] as f32) && (b_high[0] as f32) >= (a_low[0] as f32);
    !first
        || [1, 2]
            .into_iter()
            .any(|k| a_low[k] > b_high[k] || b_low[k] > a_high[k])
}

/// The lower and upper bounds of a body's geoms along the axes: MuJoCo's `makeAAMM`.
fn bounds(m: &Model, axes: &Mat3, body: usize, frame: &impl Fn(usize) -> Frame) -> [Vec3; 2] {
    let (mut low, mut high) = ([f64::MAX; 3], [f64::MIN; 3]);
    for g in m.geoms_of(body) {
        let (pos, mat) = frame(g);
        let [centre, half] = bounding_box(m, g);
        let centre = add(rotate(&mat, centre), pos);
        let (radius, margin) = (m.geom_rbound[g], m.geom_margin[g] + m.geom_gap[g]);
        for k in 0..3 {
            let axis = [axes[3 * k], axes[3 * k + 1], axes[3 * k + 2]];
            let part = |i: usize| (half[i] * dot(column(&mat, i), axis)).abs();
            let (middle, reach) = (dot(centre, axis), part(0) + part(1) + part(2));
            let place = dot(pos, axis);
            low[k] = low[k].min(f64::max(place - radius, middle - reach) - margin);
            high[k] = high[k].max(f64::min(place + radius, middle + reach) + margin);
        }
    }
    [low, high]
}
