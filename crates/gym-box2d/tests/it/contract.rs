//! The contract of every environment: a seed, a clone and a snapshot in mid-flight give the same
//! bits; errors instead of panics.

use gym_box2d as _;
use gym_core::{BoxEnv, Env, EnvExt, Value, builder, make};

const IDS: [&str; 8] = [
    "LunarLander-v2",
    "LunarLander-v3",
    "LunarLanderContinuous-v2",
    "LunarLanderContinuous-v3",
    "BipedalWalker-v3",
    "BipedalWalkerHardcore-v3",
    "CarRacing-v2",
    "CarRacing-v3",
];

/// Returns the observations and rewards of `steps` steps with random actions, over several
/// episodes.
fn run(env: &mut BoxEnv, seed: u64, steps: usize) -> Vec<(Value, f64)> {
    let mut actions = env.action_sampler(seed).unwrap();
    (0..steps)
        .map(|_| {
            let step = env.step(&actions.sample()).unwrap();
            if step.done() {
                env.reset(()).unwrap();
            }
            (step.observation, step.reward)
        })
        .collect()
}

#[test]
fn copies_snapshots_and_used_environments_agree() {
    for id in IDS {
        let steps = if id.starts_with("Car") { 40 } else { 250 };
        let mut env = make(id).unwrap();
        env.reset(7).unwrap();
        let first = run(&mut env, 1, steps);
        let (mut copy, snapshot) = (env.clone(), env.snapshot().unwrap());
        let mut restored = make(id).unwrap();
        restored.restore(&snapshot).unwrap();
        let next = run(&mut env, 2, steps);
        assert!(next == run(&mut copy, 2, steps), "{id}: a copy");
        assert!(next == run(&mut restored, 2, steps), "{id}: a snapshot");
        env.reset(7).unwrap();
        assert!(first == run(&mut env, 1, steps), "{id}: a used environment");
    }
}

#[test]
fn impossible_actions_are_errors() {
    let mut lander = builder("LunarLanderContinuous-v3")
        .disable_env_checker(true)
        .build()
        .unwrap();
    lander.reset(0).unwrap();
    let action = |x: f32| Value::Array([x, 0.0].to_vec().into());
    assert!(lander.step(&action(f32::NAN)).is_err());
    assert!(lander.step(&action(f32::INFINITY)).is_err());
    assert!(lander.step(&Value::Int(1)).is_err());
    assert!(lander.step(&action(1.0)).is_ok());
    assert!(
        builder("LunarLander-v3")
            .arg("gravity", -12.0)
            .build()
            .is_err()
    );
    assert!(
        builder("LunarLander-v3")
            .arg("gravity", 0.5)
            .build()
            .is_err()
    );
}

/// Each number of an action must be finite; a refused action changes nothing.
#[test]
fn actions_that_are_no_numbers_are_refused() {
    for (id, count) in [
        ("LunarLanderContinuous-v2", 2),
        ("LunarLanderContinuous-v3", 2),
        ("BipedalWalker-v3", 4),
        ("BipedalWalkerHardcore-v3", 4),
        ("CarRacing-v3", 3),
    ] {
        let mut env = builder(id).disable_env_checker(true).build().unwrap();
        env.reset(2).unwrap();
        let before = env.snapshot().unwrap();
        for at in 0..count {
            for number in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY] {
                let mut action = vec![0.1; count];
                action[at] = number;
                let error = env.step(&action.into()).unwrap_err();
                let is_named = matches!(error, gym_core::Error::InvalidAction { .. });
                assert!(is_named, "{id}: {error}");
                assert!(env.snapshot().unwrap() == before, "{id}: {number} at {at}");
            }
        }
        for count in [count - 1, count + 1] {
            assert!(env.step(&vec![0.1_f32; count].into()).is_err(), "{id}");
        }
        env.step(&vec![0.1_f32; count].into()).unwrap();
    }
}

/// A snapshot without the broad-phase box of a fixture is an error: a step would look up the box.
#[test]
fn snapshots_without_a_box_are_refused() {
    fn drop_a_box(json: &mut serde_json::Value) {
        match json {
            serde_json::Value::Object(entries) => {
                for (key, value) in entries {
                    match value {
                        serde_json::Value::Array(proxies) if key == "proxies" => {
                            drop(proxies.pop());
                        }
                        value => drop_a_box(value),
                    }
                }
            }
            serde_json::Value::Array(items) => items.iter_mut().for_each(drop_a_box),
            _ => {}
        }
    }

    for id in IDS {
        let mut env = make(id).unwrap();
        env.reset(0).unwrap();
        let mut json = serde_json::to_value(env.snapshot().unwrap()).unwrap();
        env.restore(&serde_json::from_value(json.clone()).unwrap())
            .unwrap();
        drop_a_box(&mut json);
        assert!(
            env.restore(&serde_json::from_value(json).unwrap()).is_err(),
            "{id}"
        );
    }
}

/// A car that drives straight ahead from the start of this track leaves the playfield, as in
/// Gymnasium.
#[test]
fn a_car_off_the_field_ends_the_episode() {
    let mut env = builder("CarRacing-v3")
        .max_episode_steps(None)
        .build()
        .unwrap();
    env.reset(0).unwrap();
    let gas = Value::from([0.0_f32, 0.3, 0.0]);
    let (mut total, mut steps) = (0.0, 0);
    loop {
        let step = env.step(&gas).unwrap();
        (total, steps) = (total + step.reward, steps + 1);
        if step.done() {
            assert_eq!(
                (step.reward, step.terminated, step.truncated),
                (-100.0, true, false)
            );
            break;
        }
    }
    assert_eq!((steps, total), (310, -68.204_075_235_110_1));
    assert_eq!(
        env.info_map().get("lap_finished"),
        Some(&Value::Bool(false))
    );
}

/// With a small `lap_complete_percent` the lap is complete at the start, as in Gymnasium.
#[test]
fn a_complete_lap_ends_the_episode_and_says_so() {
    for (percent, ends) in [(0.0, true), (0.003, true), (0.01, false)] {
        let mut env = builder("CarRacing-v3")
            .arg("lap_complete_percent", percent)
            .build()
            .unwrap();
        env.reset(0).unwrap();
        let step = env.step(&Value::from([0.0_f32, 0.3, 0.0])).unwrap();
        assert_eq!(
            (step.terminated, step.truncated),
            (ends, false),
            "{percent}"
        );
        let finished = env.info_map().get("lap_finished").cloned();
        assert_eq!(finished, ends.then_some(Value::Bool(true)), "{percent}");
        if ends {
            assert_eq!(step.reward, 6.169_592_476_489_028);
        }
    }
}
