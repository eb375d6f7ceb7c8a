//! Good policies for the tasks that straight ways solve.

use gym_core::{Policy, Value};

/// Motions of the fingers. The box is 0.05 m wide.
const OPEN: f32 = 1.0;
const CLOSED: f32 = -1.0;

/// For FetchReach.
pub(super) const REACH: Policy = Policy::rules("moves the gripper straight to the goal", |_| {
    Some(Box::new(|_, seen| {
        let [place, goal] = ["achieved_goal", "desired_goal"].map(|key| numbers(seen, key));
        act(way(place?, goal?)?, OPEN)
    }))
});

/// For FetchPickAndPlace.
pub(super) const CARRY: Policy = Policy::rules(
    "moves the open gripper above the box and down, closes it, and moves it so that the box comes to the goal",
    |_| {
        Some(Box::new(|_, seen| {
            let (state, goal) = (
                numbers(seen, "observation")?,
                numbers(seen, "desired_goal")?,
            );
            let &[_, _, _, x, y, z, to_x, to_y, to_z, right, left, ..] = state else {
                return None;
            };
            let aside = f64::max(to_x.abs(), to_y.abs());
            if aside > 0.03 || aside > 0.01 && to_z < -0.01 {
                act([to_x, to_y, to_z + 0.08], OPEN)
            } else if to_z.abs() > 0.01 {
                act([to_x, to_y, to_z], OPEN)
            } else if right + left > 0.055 {
                act([0.0; 3], CLOSED)
            } else {
                act(way(&[x, y, z], goal)?, CLOSED)
            }
        }))
    },
);

fn numbers<'a>(seen: &'a Value, key: &str) -> Option<&'a [f64]> {
    seen.get(key)?.as_slice::<f64>()
}

fn way(from: &[f64], to: &[f64]) -> Option<[f64; 3]> {
    let (from, to): (&[f64; 3], &[f64; 3]) = (from.try_into().ok()?, to.try_into().ok()?);
    Some(std::array::from_fn(|k| to[k] - from[k]))
}

/// Moves along a way in m, at full speed from 0.05 m on.
fn act(way: [f64; 3], fingers: f32) -> Option<Value> {
    let [x, y, z] = way.map(|way| (way / 0.05).clamp(-1.0, 1.0) as f32);
    Some(Value::Array(vec![x, y, z, fingers].into()))
}
