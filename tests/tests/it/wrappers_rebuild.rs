//! Every wrapper is rebuilt from JSON, continues from a snapshot, and steps without allocating.

use gym::{
    BoxEnv, Element, Env, EnvExt, EnvSpec, Outcome, Reset, Result, Value, Wrap, WrapperSpec,
};
use serde_json::{Value as Json, json};

/// Returns ids with wrappers for them.
fn stacks() -> Vec<(&'static str, Json)> {
    vec![
        (
            "CartPole-v1",
            json!([["TimeLimit", {"max_episode_steps": 9}], ["Autoreset", {}]]),
        ),
        (
            "CartPole-v1",
            json!([["RecordEpisodeStatistics", {"buffer_length": 3, "stats_key": "stats"}]]),
        ),
        (
            "CartPole-v1",
            json!([
                ["FrameStackObservation", {"stack_size": 3, "padding_type": [1.0, 0.0, 0.25, 2.0]}],
            ]),
        ),
        (
            "Blackjack-v1",
            json!([["FrameStackObservation", {"stack_size": 2, "padding_type": "zero"}]]),
        ),
        (
            "Blackjack-v1",
            json!([["FilterObservation", {"filter_keys": [2, 0]}], ["FlattenObservation", {}]]),
        ),
        ("Blackjack-v1", json!([["DelayObservation", {"delay": 2}]])),
        (
            "CartPole-v1",
            json!([
                ["TimeAwareObservation", {"flatten": false}],
                ["FilterObservation", {"filter_keys": ["time"]}],
            ]),
        ),
        (
            "CartPole-v1",
            json!([
                ["TimeAwareObservation", {"normalize_time": true}],
                ["NormalizeObservation", {"epsilon": 0.1}],
            ]),
        ),
        (
            "CartPole-v1",
            json!([
                ["MaxAndSkipObservation", {"skip": 2}],
                ["ReshapeObservation", {"shape": [2, 2]}],
            ]),
        ),
        (
            "Taxi-v4",
            json!([["DtypeObservation", {"dtype": "float32"}], ["DelayObservation", {"delay": 1}]]),
        ),
        (
            "MountainCar-v0",
            json!([["RescaleObservation", {"min_obs": -1.0, "max_obs": [0.5, 1.0]}]]),
        ),
        (
            "MountainCar-v0",
            json!([["DiscretizeObservation", {"bins": [5, 9], "multidiscrete": true}]]),
        ),
        (
            "MountainCar-v0",
            json!([
                ["DiscretizeObservation", {"bins": 7}],
                [
                    "StickyAction",
                    {"repeat_action_probability": 0.5, "repeat_action_duration": [2, 4]},
                ],
            ]),
        ),
        (
            "Pendulum-v1",
            json!([["RescaleAction", {"min_action": -1.0, "max_action": 1.0}], ["ClipAction", {}]]),
        ),
        (
            "Pendulum-v1",
            json!([["DiscretizeAction", {"bins": 5}], ["RepeatAction", {"num_repeats": 2}]]),
        ),
        (
            "Pendulum-v1",
            json!([
                ["NormalizeReward", {"gamma": 0.9, "epsilon": 1e-4}],
                ["ClipReward", {"max_reward": -0.1}],
            ]),
        ),
    ]
}

pub(crate) fn wrap(id: &str, wrappers: &Json) -> BoxEnv {
    let wrappers = wrappers.as_array().expect("a list").iter();
    wrappers.fold(gym::make(id).unwrap(), |env, wrapper| {
        let kwargs = wrapper[1].as_object().expect("arguments").clone();
        WrapperSpec {
            name: wrapper[0].as_str().expect("a name").into(),
            kwargs,
        }
        .wrap(env)
        .unwrap()
    })
}

/// Returns the results of `n` steps, with resets where episodes end.
pub(crate) fn steps(env: &mut BoxEnv, n: usize) -> Vec<(Value, Option<Outcome>)> {
    let mut actions = env.action_sampler(3).unwrap();
    let mut answers = Vec::new();
    for _ in 0..n {
        let step = env.step(&actions.sample()).unwrap();
        let done = step.done();
        let outcome = Outcome {
            reward: step.reward,
            terminated: step.terminated,
            truncated: step.truncated,
        };
        answers.push((step.observation, Some(outcome)));
        if done && !env.describe().contains("Autoreset") {
            answers.push((env.reset(()).unwrap(), None));
        }
    }
    answers
}

#[test]
fn stacks_are_rebuilt_from_json() {
    for (id, wrappers) in stacks() {
        let mut env = wrap(id, &wrappers);
        let spec = env.spec().unwrap();
        let json = serde_json::to_string(&spec).unwrap();
        let parsed: EnvSpec = serde_json::from_str(&json).unwrap();
        let mut rebuilt = parsed.make().unwrap();
        assert_eq!(rebuilt.spec().unwrap(), spec, "{json}");
        assert_eq!(
            rebuilt.observation_space(),
            env.observation_space(),
            "{json}"
        );
        assert_eq!(rebuilt.action_space(), env.action_space(), "{json}");
        assert_eq!(rebuilt.reset(5).unwrap(), env.reset(5).unwrap(), "{json}");
        assert_eq!(steps(&mut rebuilt, 60), steps(&mut env, 60), "{json}");
    }
}

#[test]
fn observations_lie_in_their_space() {
    for (id, wrappers) in stacks() {
        let mut env = wrap(id, &wrappers);
        let space = env.observation_space();
        space.check(&env.reset(5).unwrap()).unwrap();
        for (observation, _) in steps(&mut env, 60) {
            space
                .check(&observation)
                .unwrap_or_else(|error| panic!("{env}: {error}"));
        }
    }
}

#[test]
fn stacks_continue_from_snapshots_and_clones() {
    for (id, wrappers) in stacks() {
        let mut env = wrap(id, &wrappers);
        env.reset(5).unwrap();
        steps(&mut env, 17);
        let text = serde_json::to_string(&env.snapshot().unwrap()).unwrap();
        let mut restored = wrap(id, &wrappers);
        restored
            .restore(&serde_json::from_str(&text).unwrap())
            .unwrap_or_else(|e| panic!("{env}: {e}"));
        let mut clone = env.clone();
        let answers = steps(&mut env, 60);
        assert_eq!(steps(&mut restored, 60), answers, "{env}");
        assert_eq!(steps(&mut clone, 60), answers, "{env}");
        // the state before the restore does not matter, such as rotated buffers or an ended episode
        for used in 0..14 {
            let mut restored = wrap(id, &wrappers);
            restored.reset(6).unwrap();
            steps(&mut restored, used);
            restored
                .restore(&serde_json::from_str(&text).unwrap())
                .unwrap();
            assert_eq!(
                steps(&mut restored, 60),
                answers,
                "{env}, used for {used} steps"
            );
        }
    }
}

/// Except for statistics, an episode with a seed does not depend on earlier episodes.
#[test]
fn stacks_forget_earlier_episodes() {
    for (id, wrappers) in stacks() {
        let mut new = wrap(id, &wrappers);
        let name = new.describe();
        if name.contains("Normalize") || name.contains("Statistics") {
            continue;
        }
        let first = (new.reset(5).unwrap(), steps(&mut new, 60));
        for used in 0..14 {
            let mut env = wrap(id, &wrappers);
            env.reset(6).unwrap();
            steps(&mut env, used);
            assert_eq!(
                (env.reset(5).unwrap(), steps(&mut env, 60)),
                first,
                "{name}, used for {used} steps"
            );
        }
    }
}

/// Each wrapper refuses arguments that it cannot satisfy.
#[test]
fn arguments_out_of_range_are_refused() {
    for (id, name, kwargs) in [
        (
            "CartPole-v1",
            "FrameStackObservation",
            json!({"stack_size": 2, "padding_type": [9.0, 0.0, 0.0, 0.0]}),
        ),
        (
            "CartPole-v1",
            "FrameStackObservation",
            json!({"stack_size": 2, "padding_type": [0.0, 0.0, 0.0]}),
        ),
        (
            "CartPole-v1",
            "FrameStackObservation",
            json!({"stack_size": 0}),
        ),
        (
            "CartPole-v1",
            "TimeAwareObservation",
            json!({"max_timesteps": 0}),
        ),
        (
            "CartPole-v1",
            "TimeAwareObservation",
            json!({"max_timesteps": 1u32 << 31}),
        ),
        (
            "CartPole-v1",
            "StickyAction",
            json!({"repeat_action_probability": 1.0}),
        ),
        (
            "CartPole-v1",
            "StickyAction",
            json!({"repeat_action_probability": 0.5, "repeat_action_duration": [3, 2]}),
        ),
        (
            "CartPole-v1",
            "StickyAction",
            json!({"repeat_action_probability": 0.5, "repeat_action_duration": 0}),
        ),
        ("CartPole-v1", "RepeatAction", json!({"num_repeats": 0})),
        ("CartPole-v1", "MaxAndSkipObservation", json!({"skip": 1})),
    ] {
        let wrapper = WrapperSpec {
            name: name.into(),
            kwargs: kwargs.as_object().unwrap().clone(),
        };
        assert!(
            wrapper.wrap(gym::make(id).unwrap()).is_err(),
            "{name} {kwargs}"
        );
    }
}

/// The time continues beyond the limit that scales it.
#[test]
fn time_goes_on_beyond_its_limit() {
    let wrappers = json!([["TimeAwareObservation", {"flatten": false, "max_timesteps": 3}]]);
    let mut env = wrap("Pendulum-v1", &wrappers);
    env.reset(0).unwrap();
    let times: Vec<_> = (0..6)
        .map(|_| {
            env.step(&[0.0f32].to_value())
                .unwrap()
                .observation
                .get("time")
                .unwrap()
                .to_string()
        })
        .collect();
    let expected: Vec<_> = (1..=6)
        .map(|time| Value::from([time]).to_string())
        .collect();
    assert_eq!(times, expected);
}

/// An action sticks for the drawn number of steps. The smallest and the largest duration of the
/// range occur, and no other durations.
#[test]
fn an_action_sticks_for_each_number_of_steps_of_its_range() {
    let wrappers = json!([
        ["StickyAction", {"repeat_action_probability": 0.3, "repeat_action_duration": [2, 4]}],
    ]);
    let mut env = wrap("Taxi-v4", &wrappers);
    let drawn = |env: &BoxEnv| {
        let stored: Json = env.snapshot().unwrap().get().unwrap();
        fn number(json: &Json) -> Option<u64> {
            match json {
                Json::Object(entries) => {
                    let own = entries.get("num_repeats").and_then(Json::as_u64);
                    own.or_else(|| entries.values().find_map(number))
                }
                Json::Array(items) => items.iter().find_map(number),
                _ => None,
            }
        }
        number(&stored).unwrap()
    };
    env.reset(1).unwrap();
    let mut seen = std::collections::BTreeSet::new();
    for _ in 0..400 {
        if env.step(&Value::Int(0)).unwrap().done() {
            env.reset(()).unwrap();
        }
        seen.insert(drawn(&env));
    }
    assert_eq!(seen.into_iter().collect::<Vec<_>>(), [0, 2, 3, 4]);
}

#[test]
fn steps_do_not_allocate() {
    for (id, wrappers) in stacks() {
        let mut env = wrap(id, &wrappers);
        let mut actions = env.action_sampler(0).unwrap();
        let actions: Vec<Value> = (0..300).map(|_| actions.sample()).collect();
        let mut observation = Value::empty();
        env.reset_into(&0.into(), &mut observation).unwrap();
        for (i, action) in actions.iter().enumerate() {
            let mut outcome = Outcome::default();
            let count = allocation_counter::measure(|| {
                outcome = env.step_into(action, &mut observation).unwrap();
            });
            // the wrapper's buffers get their shape in the first steps
            assert!(
                i < 100 || count.count_total == 0,
                "{env}: {} in step {i}",
                count.count_total
            );
            if outcome.done() && !env.describe().contains("Autoreset") {
                env.reset_into(&().into(), &mut observation).unwrap();
            }
        }
    }
}

#[test]
fn limits_are_rebuilt_where_they_were() {
    let env = gym::make("CartPole-v1")
        .unwrap()
        .max_and_skip(2)
        .unwrap()
        .time_limit(3)
        .unwrap();
    let spec = env.spec().unwrap();
    assert_eq!(
        (spec.max_episode_steps, spec.time_limit()),
        (Some(500), Some(3))
    );
    assert_eq!(spec.make().unwrap().spec(), Some(spec));
    let longer = gym::make("CartPole-v1").unwrap().time_limit(9000).unwrap();
    assert_eq!(
        longer.spec().unwrap().max_episode_steps,
        Some(500),
        "the inner limit stays"
    );
}

#[test]
fn unknown_wrappers_and_arguments_are_refused() {
    let wrap = |name: &str, kwargs: Json| -> Result<BoxEnv> {
        let kwargs = kwargs.as_object().expect("arguments").clone();
        WrapperSpec {
            name: name.into(),
            kwargs,
        }
        .wrap(gym::make("CartPole-v1")?)
    };
    for (name, kwargs, says) in [
        ("FrameStack", json!({}), "FrameStackObservation"),
        ("FrameStackObservation", json!({}), "stack_size"),
        (
            "FrameStackObservation",
            json!({"stack_size": 0}),
            "at least 1",
        ),
        (
            "FrameStackObservation",
            json!({"stack_size": 2, "padding_type": [1.0]}),
            "element",
        ),
        ("DelayObservation", json!({"delay": -1}), "-1"),
        ("DelayObservation", json!({"delay": 1, "dely": 1}), "dely"),
        ("MaxAndSkipObservation", json!({"skip": 1}), "at least 2"),
        (
            "StickyAction",
            json!({"repeat_action_probability": 1.0}),
            "[0, 1)",
        ),
        (
            "StickyAction",
            json!({"repeat_action_probability": 0.5, "repeat_action_duration": 0}),
            "at least 1",
        ),
        (
            "StickyAction",
            json!({"repeat_action_probability": 0.5, "repeat_action_duration": [3, 2]}),
            "3 to 2",
        ),
        ("RepeatAction", json!({"num_repeats": 0}), "at least 1"),
        ("ClipReward", json!({}), "at least one"),
        (
            "ClipReward",
            json!({"min_reward": 1.0, "max_reward": 0.0}),
            "above",
        ),
        ("NormalizeReward", json!({"gamma": 1.5}), "[0, 1]"),
        ("NormalizeReward", json!({"epsilon": 0.0}), "above 0"),
        ("NormalizeObservation", json!({"epsilon": -1.0}), "above 0"),
        ("ClipAction", json!({}), "Box"),
        (
            "RescaleAction",
            json!({"min_action": 0.0, "max_action": 1.0}),
            "Box",
        ),
        (
            "RescaleObservation",
            json!({"min_obs": -1.0, "max_obs": 1.0}),
            "infinite",
        ),
        ("DiscretizeObservation", json!({"bins": 3}), "finite"),
        ("DiscretizeAction", json!({"bins": 3}), "Box"),
        ("ReshapeObservation", json!({"shape": [3]}), "does not hold"),
        ("ResizeObservation", json!({"shape": [3, 3]}), "uint8"),
        ("GrayscaleObservation", json!({}), "uint8"),
        ("FilterObservation", json!({"filter_keys": [0]}), "Tuple"),
        ("AddRenderObservation", json!({}), "render"),
        (
            "AddWhiteNoise",
            json!({"probability_of_noise_per_pixel": 1.0}),
            "[0, 1)",
        ),
        (
            "ObstructView",
            json!({"obstructed_pixels_ratio": 0.5, "obstruction_width": 0}),
            "at least 1",
        ),
    ] {
        let error = wrap(name, kwargs.clone()).unwrap_err().to_string();
        assert!(error.contains(says), "{name} {kwargs}: {error}");
    }
    let pendulum = || gym::make("Pendulum-v1").unwrap();
    assert!(pendulum().rescale_action((1.0, 1.0)).is_err(), "no inverse");
    assert!(
        pendulum().discretize_action([3, 3]).is_err(),
        "bins for two elements of one"
    );
    let blackjack = || gym::make("Blackjack-v1").unwrap();
    assert!(
        blackjack().filter_observation([3usize]).is_err()
            && blackjack().filter_observation([1usize, 1]).is_err()
    );
    assert!(blackjack().filter_observation([0usize; 0]).is_err());
    assert!(
        blackjack().time_aware_observation().is_err(),
        "it has no time limit"
    );
}

#[test]
fn functions_wrap_typed_environments_and_have_no_spec() {
    use gym::classic::cartpole::{Action, CartPole, Config};
    let mut env = CartPole::new(Config::default())
        .unwrap()
        .transform_observation(
            |o: &[f32; 4]| f64::from(o[2]) as i64,
            gym::Space::discrete(1),
        )
        .transform_action(
            |right: &i64| {
                if *right == 1 {
                    Action::Right
                } else {
                    Action::Left
                }
            },
            None,
        )
        .transform_reward(|reward| 2.0 * reward);
    assert_eq!(env.reset(0).unwrap(), 0);
    assert_eq!(env.step(&1).unwrap().reward, 2.0);
    let env = gym::make("CartPole-v1")
        .unwrap()
        .transform_reward(|reward| -reward);
    assert!(env.spec().is_none(), "a function cannot be rebuilt");
}

#[test]
fn a_refused_action_draws_nothing() {
    let mut refused = 0;
    for seed in 0..20 {
        let mut env = gym::make("CartPole-v1")
            .unwrap()
            .sticky_action(0.5)
            .unwrap();
        env.reset(Reset::seed(seed)).unwrap();
        env.step(&Value::Int(0)).unwrap();
        let before = env.snapshot().unwrap();
        // an action that is replaced by the last action is not checked
        if env.step(&Value::Int(7)).is_err() {
            assert_eq!(env.snapshot().unwrap(), before);
            refused += 1;
        }
    }
    assert!((1..20).contains(&refused), "{refused}");
}

#[test]
fn a_recording_is_rebuilt() {
    use gym::render::{RecordVideo, RecordVideoConfig};
    let folder = std::env::temp_dir().join(format!("gym-rebuilt-video-{}", std::process::id()));
    let make = || {
        gym::builder("CartPole-v1")
            .render_mode(gym::render::RenderMode::RgbArray)
            .build()
            .unwrap()
    };
    let config = RecordVideoConfig {
        name_prefix: "try".into(),
        fps: Some(25),
        ..(&folder).into()
    };
    let env = RecordVideo::new(make(), config).unwrap();
    let spec = BoxEnv::new(env).spec().unwrap();
    let json = serde_json::to_string(&spec).unwrap();
    let mut rebuilt = serde_json::from_str::<EnvSpec>(&json)
        .unwrap()
        .make()
        .unwrap();
    assert_eq!(rebuilt.spec().unwrap(), spec);
    rebuilt.reset(0).unwrap();
    drop(rebuilt);
    assert!(folder.join("try-episode-0.gif").is_file());
    let own = || RecordVideo::new(make(), &folder).unwrap();
    assert!(own().spec().is_some());
    for own in [
        own().episode_trigger(|_| true),
        own().step_trigger(|_| true),
    ] {
        assert!(own.spec().is_none(), "a function cannot be rebuilt");
    }
    for (name, value) in [
        ("fps", json!(-1)),
        ("video_length", json!("long")),
        ("codec", json!("x")),
    ] {
        let wrapper = WrapperSpec::new("RecordVideo")
            .arg("video_folder", folder.to_str().unwrap())
            .arg(name, value);
        assert!(wrapper.wrap(make()).unwrap_err().to_string().contains(name));
    }
    std::fs::remove_dir_all(folder).unwrap();
}
