//! The entries of `info` about motion on the floor.

use gym_sim::Visit;
use gym_sim::numpy::norm;
use mujoco_engine::Data;

/// Passes position, distance and velocity in x and y to `visit`, as far as a version has them.
/// `step` has the position and the velocity that a step measured.
pub(crate) fn visit_motion(
    version: u32,
    data: &Data,
    step: Option<([f64; 2], [f64; 2])>,
    visit: Visit<'_>,
) {
    let position = match (version, step) {
        (5.., _) => Some([data.qpos[0], data.qpos[1]]),
        (3 | 4, Some((position, _))) => Some(position),
        _ => None,
    };
    if let Some(position) = position {
        visit("x_position", position[0]);
        visit("y_position", position[1]);
        visit("distance_from_origin", norm(version, &position));
    }
    if let (3.., Some((_, velocity))) = (version, step) {
        visit("x_velocity", velocity[0]);
        visit("y_velocity", velocity[1]);
    }
}
