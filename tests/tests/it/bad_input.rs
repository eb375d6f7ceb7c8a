//! Bad input gives an `Err` that says what to do.

use gym::render::RenderMode;
use gym::{Array, Env, EnvExt, Error, Kwargs, Reset, Value};
use serde_json::json;

/// Asserts that the error message contains `words`.
fn says<T>(result: Result<T, Error>, words: &[&str]) {
    let message = result.err().expect("an error").to_string();
    for word in words {
        assert!(message.contains(word), "`{word}` is missing in: {message}");
    }
}

#[test]
fn unknown_ids() {
    says(
        gym::make("CartPole v1"),
        &["malformed", "[namespace/]name[-vN]"],
    );
    says(gym::make(""), &["malformed"]);
    says(
        gym::make("CartPole-v9"),
        &["no version 9", "`CartPole-v0`", "`CartPole-v1`"],
    );
    says(
        gym::make("CartPoleee-v1"),
        &[
            "did you mean `CartPole-v1`?",
            "gym-classic",
            "use its_name as _;",
            "the crate `gym` with its feature",
        ],
    );
    says(gym::make("CartPoleee-v0"), &["did you mean `CartPole-v0`?"]);
    says(gym::make("cartpole-v0"), &["did you mean `CartPole-v0`?"]);
    says(
        gym::make("Pendulum-v0"),
        &["no longer provided", "use `Pendulum-v1`"],
    );
    says(
        gym::make("Foo/CartPole-v1"),
        &["namespace `Foo` not found", "linked crates"],
    );
    says(
        gym::make("Zzzzzzzzzzzzzz-v1"),
        &["unknown environment `Zzzzzzzzzzzzzz-v1`"],
    );
}

#[test]
fn ids_without_a_version_or_out_of_date_work() {
    assert_eq!(
        gym::make("CartPole").unwrap().spec().unwrap().id,
        "CartPole-v1"
    );
    assert_eq!(
        gym::make("CartPole-v01").unwrap().spec().unwrap().id,
        "CartPole-v1"
    );
    let note = |id: &str| gym::registry::resolve(id).unwrap().1;
    assert!(
        note("CartPole")
            .unwrap()
            .contains("latest version `CartPole-v1`")
    );
    assert!(
        note("CartPole-v0")
            .unwrap()
            .contains("out of date: consider upgrading to `CartPole-v1`")
    );
    assert_eq!(note("CartPole-v1"), None);
}

#[test]
fn unknown_and_bad_arguments() {
    let make = |id: &str, kwargs: serde_json::Value| {
        let kwargs: Kwargs = kwargs.as_object().cloned().unwrap();
        gym::builder(id).args(kwargs).build()
    };
    says(
        make("CartPole-v1", json!({"foo": 1})),
        &[
            "`CartPole-v1`",
            "unknown argument `foo`",
            "sutton_barto_reward",
        ],
    );
    says(
        make("CartPole-v1", json!({"sutton_barto_reward": 1})),
        &["expected a boolean"],
    );
    says(
        make("Acrobot-v1", json!({"g": 1})),
        &["unknown argument `g`", "known are"],
    );
    says(
        make("CliffWalking-v0", json!({"is_slippery": true})),
        &["takes no arguments"],
    );
    says(
        make("Taxi-v3", json!({"is_rainy": true})),
        &["takes no arguments"],
    );
    says(
        make("FrozenLake-v1", json!({"map_name": "5x5"})),
        &["4x4", "8x8"],
    );
    says(
        make("FrozenLake-v1", json!({"desc": ["SF", "G"]})),
        &["desc"],
    );
    says(make("FrozenLake-v1", json!({"desc": []})), &["desc"]);
    says(make("FrozenLake-v1", json!({"desc": ["FG"]})), &["S"]);
    says(
        make("FrozenLake-v1", json!({"success_rate": 1.5})),
        &["success_rate"],
    );
    says(
        make("CartPole-v1", json!({"render_mode": "nope"})),
        &["render_mode", "rgb_array"],
    );
    says(
        gym::builder("CartPole-v1").max_episode_steps(0).build(),
        &["at least 1"],
    );
    // numbers with which the state would overflow
    says(
        make("Pendulum-v1", json!({"g": 1e308})),
        &["g is", "1000000"],
    );
    says(
        make(
            "LunarLander-v3",
            json!({"enable_wind": true, "wind_power": -1e308}),
        ),
        &["wind_power", "1000000"],
    );
}

#[test]
fn render_modes_that_are_missing() {
    says(
        gym::builder("CartPole-v1")
            .render_mode(RenderMode::Ansi)
            .build(),
        &["ansi", "human, rgb_array"],
    );
    let mut env = gym::make("CartPole-v1").unwrap();
    env.reset(0).unwrap();
    says(
        env.render(),
        &["without a render mode", "RenderMode::RgbArray"],
    );
    let builder = gym::builder("CartPole-v1").render_mode(RenderMode::RgbArray);
    says(builder.render_size(0, 10).build(), &["between 1 and 16384"]);
}

#[test]
fn calls_out_of_order() {
    let mut env = gym::builder("CartPole-v1")
        .render_mode(RenderMode::RgbArray)
        .build()
        .unwrap();
    says(
        env.step(&Value::Int(0)),
        &["`step` before `reset`", "env.reset"],
    );
    says(env.render(), &["`render` before `reset`"]);
    env.reset(0).unwrap();
    env.close();
    says(env.step(&Value::Int(0)), &["closed", "make a new one"]);
    says(env.reset(0), &["closed"]);
}

#[test]
fn actions_outside_the_space() {
    for id in [
        "CartPole-v1",
        "Acrobot-v1",
        "Blackjack-v1",
        "FrozenLake-v1",
        "CliffWalking-v1",
        "Taxi-v4",
    ] {
        let mut env = gym::make(id).unwrap();
        env.reset(0).unwrap();
        let space = env.action_space().to_string();
        for action in [
            Value::Int(-1),
            Value::Int(6),
            Value::Float(0.0),
            Value::Null,
            Value::Bool(true),
        ] {
            says(
                env.step(&action),
                &["invalid action", &action.to_string(), &space],
            );
        }
        env.step(&Value::Int(0)).unwrap();
    }
    for id in ["Pendulum-v1", "MountainCarContinuous-v0"] {
        let mut env = gym::make(id).unwrap();
        env.reset(0).unwrap();
        let arrays: [Array; 5] = [
            [f32::NAN].into(),
            [f32::INFINITY].into(),
            [f64::NAN].into(),
            [0.0f32, 0.0].into(),
            [0i64; 2].into(),
        ];
        for array in arrays {
            says(env.step(&Value::Array(array)), &["invalid action", "Box("]);
        }
        // numbers beyond the bounds are clipped, as in Gymnasium
        env.step(&Value::Array([100.0f32].into())).unwrap();
    }
}

#[test]
fn reset_options() {
    let mut env = gym::make("CartPole-v1").unwrap();
    let reset = || Reset::seed(0);
    says(
        env.reset(reset().option("low", 1.0).option("high", 0.0)),
        &["lower bound (1.0)", "higher bound (0.0)"],
    );
    says(
        env.reset(reset().option("low", "a")),
        &["expected a number"],
    );
    says(
        env.reset(reset().option("low", f64::NAN)),
        &["expected a number"],
    );
    says(
        env.reset(reset().option("high", 1e300)),
        &["`high`", "must lie within"],
    );
    says(
        env.reset(reset().option("colour", "blue")),
        &["unknown option `colour`", "`low`, `high`"],
    );
    let mut env = gym::make("Pendulum-v1").unwrap();
    for name in ["x_init", "y_init"] {
        says(
            env.reset(reset().option(name, -0.5)),
            &[name, "is -0.5", "needs a positive number"],
        );
        assert!(env.reset(reset().option(name, 0.0)).is_ok());
    }
    says(
        "-1".parse::<gym::Seed>().map_err(Into::into),
        &["`-1`", "zero or greater"],
    );
    says("1.5".parse::<gym::Seed>().map_err(Into::into), &["`1.5`"]);
}

#[test]
fn files_that_cannot_be_written() {
    use gym::render::{Video, write_video};
    says(
        Video::create("/nonexistent/folder/x.gif", 30),
        &["/nonexistent/folder"],
    );
    says(
        write_video("/nonexistent/folder/x.gif", 30, &[]),
        &["/nonexistent/folder"],
    );
}

#[test]
fn damaged_snapshots() {
    let mut env = gym::make("FrozenLake-v1").unwrap();
    env.reset(0).unwrap();
    let good = serde_json::to_string(&env.snapshot().unwrap()).unwrap();
    for text in ["null", "3", "[]", "{}"] {
        says(
            env.restore(&serde_json::from_str(text).unwrap()),
            &["cannot restore"],
        );
    }
    // a state that does not exist in a lake of this size
    let mut other = gym::builder("FrozenLake-v1")
        .arg("map_name", "8x8")
        .build()
        .unwrap();
    other.reset(0).unwrap();
    let mut actions = other.action_sampler(0).unwrap();
    while other.step(&actions.sample()).unwrap().observation.as_int() < Some(16) {
        if other.step(&actions.sample()).unwrap().done() {
            other.reset(()).unwrap();
        }
    }
    says(
        env.restore(&other.snapshot().unwrap()),
        &["cannot restore", "other arguments"],
    );
    env.restore(&serde_json::from_str(&good).unwrap()).unwrap();
}

#[test]
fn snapshots_of_other_arguments() {
    for (id, name, value) in [
        ("LunarLander-v3", "gravity", json!(-5.0)),
        ("LunarLander-v3", "physics", json!("rapier")),
        ("BipedalWalker-v3", "hardcore", json!(true)),
        ("CarRacing-v3", "continuous", json!(false)),
    ] {
        let mut env = gym::make(id).unwrap();
        let mut other = gym::builder(id).arg(name, value).build().unwrap();
        other.reset(0).unwrap();
        says(
            env.restore(&other.snapshot().unwrap()),
            &["cannot restore", "other arguments"],
        );
    }
}

/// Sizes that do not fit in memory are refused before anything is allocated.
#[test]
fn sizes_beyond_any_memory() {
    use gym::spaces::TextSpace;
    let space = |json: serde_json::Value| serde_json::from_value::<gym::Space>(json);
    for shape in [
        json!([i64::MAX]),
        json!([1u64 << 40, 2]),
        json!([usize::MAX, 2]),
        json!([i64::MAX, 0]),
    ] {
        for low in [json!(0), json!([0])] {
            let described =
                json!({"type": "Box", "low": low, "high": 1, "shape": shape, "dtype": "float32"});
            assert!(
                space(described)
                    .unwrap_err()
                    .to_string()
                    .contains("too many elements"),
                "{shape}"
            );
        }
        assert!(
            space(json!({"type": "MultiBinary", "shape": shape})).is_err(),
            "{shape}"
        );
    }
    let deep = json!({"type": "MultiBinary", "shape": vec![1; 100_000]});
    assert!(
        space(deep)
            .unwrap_err()
            .to_string()
            .contains("has 100000 axes: at most 64")
    );
    says(
        Array::zeros(gym::DType::F32, vec![1; 65]),
        &["does not fit in memory"],
    );
    says(
        Array::zeros(gym::DType::F32, [1 << 40, 0]),
        &["does not fit in memory"],
    );
    says(TextSpace::new(0, 1 << 40), &["too long"]);
    let huge = gym::Space::discrete(i64::MAX);
    says(huge.flatten(&Value::Int(3)), &["too large to flatten"]);
    says(huge.flatten_space(), &["too large to flatten"]);
    let wrap = |id: &str, name: &str, kwargs: serde_json::Value| {
        let kwargs = kwargs.as_object().cloned().unwrap();
        gym::WrapperSpec {
            name: name.into(),
            kwargs,
        }
        .wrap(gym::make(id).unwrap())
    };
    let most = json!(u64::MAX);
    says(
        wrap("Acrobot-v1", "DelayObservation", json!({"delay": most})),
        &["do not fit in memory"],
    );
    says(
        wrap(
            "Acrobot-v1",
            "FrameStackObservation",
            json!({"stack_size": most}),
        ),
        &["too many elements"],
    );
    says(
        wrap(
            "Blackjack-v1",
            "FrameStackObservation",
            json!({"stack_size": most}),
        ),
        &["too many elements"],
    );
    says(
        wrap(
            "Taxi-v4",
            "RecordEpisodeStatistics",
            json!({"buffer_length": most}),
        ),
        &["do not fit in memory"],
    );
    let envs = gym::make_vec("Taxi-v4", 2, None).unwrap();
    let most = serde_json::from_value(
        json!({"name": "RecordEpisodeStatistics", "kwargs": {"buffer_length": most}}),
    );
    says(
        most.map(|wrapper: gym::WrapperSpec| wrapper.wrap_vector(envs))
            .unwrap(),
        &["do not fit in memory"],
    );
    says(
        wrap(
            "Acrobot-v1",
            "DiscretizeObservation",
            json!({"bins": u32::MAX}),
        ),
        &["at most"],
    );
}

/// A shape that does not fit in memory is an error and does not abort the process.
#[test]
fn what_fits_no_memory_is_refused() {
    for shape in [
        vec![1 << 60],
        vec![usize::MAX, 2],
        vec![1 << 40, 1 << 40, 1 << 40],
    ] {
        let error = gym::Array::zeros(gym::DType::F64, shape.clone())
            .unwrap_err()
            .to_string();
        assert!(
            error.contains("does not fit in memory") && error.contains(&format!("{shape:?}")),
            "{error}"
        );
    }
    assert_eq!(
        gym::Array::zeros(gym::DType::I16, [2, 0, 3]).unwrap().len(),
        0
    );
    assert!(gym::render::Frame::new(u32::MAX, u32::MAX).is_err());
}
