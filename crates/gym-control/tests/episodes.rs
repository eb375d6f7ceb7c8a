//! Episodes of dm_control, by checksum: `record.py` recorded them.

use gym_control as _;
use gym_core::{Env, RandomState, Reset, Space, Value, builder};
use gym_testing::{lines, replay};

/// Plays the episode of a line. Returns the first checksum of the line that differs, and the
/// observation of the step before.
fn difference(line: &str) -> Option<String> {
    let mut words = line.split(' ');
    let (id, seed) = (words.next()?, words.next()?.parse::<u32>().unwrap());
    let mut env = match builder(id).arg("mujoco", "3.12").build() {
        Ok(env) => env,
        Err(error) => return Some(format!("{id}: {error}")),
    };
    let Space::Box(actions) = env.action_space() else {
        panic!("{id} takes no vectors");
    };
    let bound = |bounds: &gym_core::Array| -> Vec<f64> {
        bounds.iter_f64().map(|x| x.clamp(-1.0, 1.0)).collect()
    };
    let (low, high) = (bound(actions.low()), bound(actions.high()));
    let mut rng = RandomState::new(seed);
    let action = || {
        let bounds = low.iter().zip(&high);
        let action: Vec<f64> = bounds.map(|(low, high)| rng.uniform(*low, *high)).collect();
        Value::from(action)
    };
    let reset = Reset::seed(u64::from(seed));
    let differs = replay(&mut env, reset, words, action, |at, _, _| panic!("{at}"));
    differs.map(|place| format!("{id}, seed {seed}, up to step {place}"))
}

#[test]
fn episodes_are_dm_controls() {
    let lines = lines(include_str!("episodes.txt"), "GYM_CONTROL_EPISODES");
    let unlike: Vec<String> = lines.iter().filter_map(|line| difference(line)).collect();
    assert_eq!(
        lines.len() - unlike.len(),
        lines.len(),
        "{}",
        unlike.join("\n")
    );
    assert!(lines.len() >= 103);
}
