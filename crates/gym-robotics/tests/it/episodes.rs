//! Episodes of Gymnasium-Robotics, by checksum: `record.py` recorded them.

use gym_core::{BoxEnv, Env, EnvExt, Kwargs, RandomState, Reset, Space, Value, builder};
use gym_robotics as _;
use gym_testing::{lines, replay};

/// The checksum of the rewards of eight goals near the desired one.
fn rewards(env: &impl EnvExt, seed: u32, observation: &Value) -> u32 {
    let goals = env.goals().unwrap();
    let goal = observation.get("desired_goal").unwrap();
    let goal = goal.as_slice::<f64>().unwrap().repeat(8);
    let mut noise = RandomState::new(seed + 1);
    let noisy = |x: &f64| x + 4.0 * (0.0 + 0.1 * noise.standard_normal());
    let near: Vec<f64> = goal.iter().map(noisy).collect();
    let mut rewards = [0.0; 8];
    goals.compute_rewards(&near, &goal, &mut rewards).unwrap();
    let mut crc = crc32fast::Hasher::new();
    rewards
        .iter()
        .for_each(|reward| crc.update(&reward.to_le_bytes()));
    crc.finalize()
}

/// Plays the episode of a line. Returns the first checksum of the line that differs, and the
/// observation of the step before.
fn difference(line: &str) -> Option<String> {
    let mut words = line.split(' ');
    let (id, kwargs, mujoco) = (words.next()?, words.next()?, words.next()?);
    let seed = words.next()?.parse::<u32>().unwrap();
    let mut kwargs: Kwargs = serde_json::from_str(kwargs).unwrap();
    let options = kwargs.remove("options").unwrap_or_default();
    let builder = builder(id).args(kwargs);
    let mut env = match builder.arg("mujoco", mujoco).build() {
        Ok(env) => env,
        Err(error) => return Some(format!("{id}: {error}")),
    };
    let Space::Box(actions) = env.action_space() else {
        panic!("{id} takes no vectors");
    };
    let bounds: Vec<(f64, f64)> = actions
        .low()
        .iter_f64()
        .zip(actions.high().iter_f64())
        .collect();
    let mut rng = RandomState::new(seed);
    let action = || {
        let drawn: Vec<f64> = bounds
            .iter()
            .map(|(low, high)| rng.uniform(*low, *high))
            .collect();
        match actions.low().as_slice::<f64>() {
            Some(_) => Value::from(drawn),
            None => drawn.iter().map(|x| *x as f32).collect::<Vec<f32>>().into(),
        }
    };
    let mut reset = Reset::seed(u64::from(seed));
    reset
        .options
        .extend(options.as_object().cloned().unwrap_or_default());
    let goals = |_: &str, env: &BoxEnv, observation: &Value| rewards(env, seed, observation);
    let differs = replay(&mut env, reset, words, action, goals);
    differs.map(|place| format!("{id}, MuJoCo {mujoco}, seed {seed}, {place}"))
}

#[test]
fn episodes_are_the_packages() {
    let lines = lines(include_str!("../episodes.txt"), "GYM_ROBOTICS_EPISODES");
    unlike(lines.iter().map(String::as_str));
}

/// Fails if an episode differs.
pub(crate) fn unlike<'a>(lines: impl Iterator<Item = &'a str>) {
    let lines: Vec<&str> = lines.collect();
    let unlike: Vec<String> = lines.iter().filter_map(|line| difference(line)).collect();
    assert!(
        unlike.is_empty(),
        "{} of {}:\n{}",
        unlike.len(),
        lines.len(),
        unlike.join("\n")
    );
}
