//! Episodes of dm_control, by checksum: `record.py` recorded them.

use gym_control as _;
use gym_core::{Env, EnvExt, RandomState, Space, Value, builder};

/// Adds the observation's arrays to `crc`, in the order of their keys.
fn observe(crc: &mut crc32fast::Hasher, observation: &Value) {
    let Value::Dict(entries) = observation else {
        panic!("{observation} is not a dict");
    };
    for (_, part) in entries {
        crc.update(&part.as_array().unwrap().to_bytes());
    }
}

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
    let mut crc = crc32fast::Hasher::new();
    let mut observation = env.reset(u64::from(seed)).unwrap();
    observe(&mut crc, &observation);
    let mut step = 0;
    for mark in words {
        let (at, expected) = mark.split_once(':').unwrap();
        while step < at.parse().unwrap() {
            step += 1;
            let bounds = low.iter().zip(&high);
            let action: Vec<f64> = bounds.map(|(low, high)| rng.uniform(*low, *high)).collect();
            let action = Value::from(action);
            let outcome = env.step_into(&action, &mut observation).unwrap();
            observe(&mut crc, &observation);
            crc.update(&outcome.reward.to_le_bytes());
            crc.update(&[outcome.terminated.into(), outcome.truncated.into()]);
            if outcome.done() {
                env.reset_into(&().into(), &mut observation).unwrap();
                observe(&mut crc, &observation);
            }
        }
        let found = format!("{:08x}", crc.clone().finalize());
        if found != expected {
            return Some(format!("{id}, seed {seed}, up to step {at}: {observation}"));
        }
    }
    None
}

#[test]
fn episodes_are_dm_controls() {
    let more =
        std::env::var_os("GYM_CONTROL_EPISODES").map(|path| std::fs::read_to_string(path).unwrap());
    let text = include_str!("episodes.txt");
    let lines = text
        .lines()
        .chain(more.as_deref().unwrap_or_default().lines());
    let lines: Vec<&str> = lines.collect();
    let unlike: Vec<String> = lines.iter().filter_map(|line| difference(line)).collect();
    assert_eq!(
        lines.len() - unlike.len(),
        lines.len(),
        "{}",
        unlike.join("\n")
    );
    assert!(lines.len() >= 79);
}
