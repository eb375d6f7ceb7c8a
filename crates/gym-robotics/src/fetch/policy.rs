//! Good policies for the tasks that straight ways solve.

use gym_core::{Policy, Value};

/// Motions of the fingers. The box is 0.05 m wide.
const OPEN: f32 = 1.0;
const CLOSED: f32 = -1.0;

/// For FetchReach.
pub(super) const REACH: Policy = Policy::rules("moves the gripper straight to the goal", |_| {
    Some(Box::new(|_, seen| reach(seen)))
});

/// For FetchPickAndPlace.
pub(super) const CARRY: Policy = Policy::rules(
    "moves the open gripper above the box and down, closes it, and moves it so that the box comes to the goal",
    |_| Some(Box::new(|_, seen| carry(seen))),
);

fn reach(seen: &Value) -> Option<Value> {
    let [place, goal] = ["achieved_goal", "desired_goal"].map(|key| numbers(seen, key));
    act(way(place?, goal?)?, OPEN)
}

fn carry(seen: &Value) -> Option<Value> {
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
}

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

#[cfg(test)]
mod tests {
    use super::*;

    fn seen(parts: &[(&str, &[f64])]) -> Value {
        let part = |(key, numbers): &(&str, &[f64])| {
            let numbers = Value::Array(numbers.to_vec().into());
            ((*key).to_owned(), numbers)
        };
        Value::Dict(parts.iter().map(part).collect())
    }

    fn near(found: Option<Value>, expected: [f32; 4]) {
        let found = found.unwrap();
        let found = found.as_slice::<f32>().unwrap();
        let is_near = |(a, b): (&f32, &f32)| (a - b).abs() < 1e-6;
        assert!(
            found.len() == 4 && found.iter().zip(&expected).all(is_near),
            "{found:?} is not {expected:?}"
        );
    }

    #[test]
    fn a_gripper_goes_straight_to_its_goal_with_open_fingers() {
        let seen = seen(&[
            ("achieved_goal", &[1.0, 2.0, 3.0]),
            ("desired_goal", &[1.01, 1.0, 3.02]),
        ]);
        near(reach(&seen), [0.2, -1.0, 0.4, 1.0]);
    }

    /// The gripper is at a place relative to the box, with its fingers as far apart.
    #[test]
    fn a_box_is_taken_from_above_and_carried_to_its_goal() {
        let goal = ("desired_goal", &[1.0, 0.98, 0.5][..]);
        for (to_box, fingers, expected) in [
            // not above the box yet: to a place above it
            ([0.02, -0.04, -0.1], 0.1, [0.4, -0.8, -0.4, 1.0]),
            ([0.031, 0.0, 0.0], 0.1, [0.62, 0.0, 1.0, 1.0]),
            ([0.02, 0.0, -0.1], 0.1, [0.4, 0.0, -0.4, 1.0]),
            // above it: down
            ([0.01, 0.0, -0.1], 0.1, [0.2, 0.0, -1.0, 1.0]),
            ([0.0, 0.01, 0.02], 0.1, [0.0, 0.2, 0.4, 1.0]),
            // around it: closed, in one place until the fingers touch
            ([0.0, 0.0, -0.01], 0.056, [0.0, 0.0, 0.0, -1.0]),
            // around it, though a little aside: carried
            ([0.02, 0.0, 0.0], 0.054, [0.0, -0.4, 0.2, -1.0]),
        ] {
            let state: Vec<f64> = [0.0; 3]
                .into_iter()
                .chain([1.0, 1.0, 0.49])
                .chain(to_box)
                .chain([fingers / 2.0; 2])
                .chain([0.0; 14])
                .collect();
            near(carry(&seen(&[("observation", &state), goal])), expected);
        }
        assert!(carry(&seen(&[("observation", &[0.0; 10]), goal])).is_none());
        assert!(carry(&seen(&[goal])).is_none());
    }
}
