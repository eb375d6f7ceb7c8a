//! Environments made by id: types of observations, arguments, snapshots, native vectors.

use std::collections::BTreeSet;
use std::ops::Range;

use gym_control as _;
use gym_core::keys::Idle;
use gym_core::registry::EnvBuilder;
use gym_core::{BoxEnv, Env, EnvExt, Value, builder, make, registry};
use gym_render as _;
use gym_testing::native_equals_sync;
use serde_json::json;

fn ids() -> Vec<String> {
    let own = registry::all();
    let own = own
        .iter()
        .filter(|entry| entry.source.package == "gym-control");
    own.map(|entry| entry.id().to_owned()).collect()
}

/// Returns the observations and rewards of `steps` steps.
fn play(env: &mut BoxEnv, steps: u32) -> Vec<(Value, f64)> {
    let mut actions = env.action_sampler(3).unwrap();
    let played = (0..steps).map(|_| {
        let step = env.step(&actions.sample()).unwrap();
        (step.observation, step.reward)
    });
    played.collect()
}

#[test]
fn the_suite_has_51_ids() {
    let ids = ids();
    assert_eq!(ids.len(), 51, "{ids:?}");
    assert!(ids.iter().all(|id| id.starts_with("dm_control/")));
}

/// Without a seed, the first episode is any of many.
#[test]
fn first_episodes_without_a_seed_differ() {
    for id in ["acrobot-swingup", "reacher-easy", "cartpole-swingup"] {
        let first = || {
            make(&format!("dm_control/{id}-v0"))
                .unwrap()
                .reset(())
                .unwrap()
        };
        assert_ne!(first(), first(), "{id}");
    }
}

#[test]
fn a_flat_observation_has_the_parts_in_the_packages_order() {
    let mut parts = make("dm_control/reacher-easy-v0").unwrap();
    let mut flat = builder("dm_control/reacher-easy-v0")
        .arg("flat", true)
        .arg("dtype", "float32")
        .build()
        .unwrap();
    let (seen, row) = (parts.reset(5).unwrap(), flat.reset(5).unwrap());
    let numbers = |key: &str| seen.get(key).unwrap().as_slice::<f64>().unwrap().to_vec();
    let joined = [
        numbers("position"),
        numbers("to_target"),
        numbers("velocity"),
    ]
    .concat();
    let joined: Vec<f32> = joined.into_iter().map(|x| x as f32).collect();
    assert_eq!(row.as_slice::<f32>().unwrap(), joined);
    assert_eq!(flat.observation_space().shape(), Some(&[6][..]));
    assert!(parts.observation_space().contains(&seen));
}

#[test]
fn pixels_are_a_picture_of_the_state() {
    let mut env = builder("dm_control/cheetah-run-v0")
        .arg("pixels", 84)
        .build()
        .unwrap();
    let first = env.reset(1).unwrap();
    assert!(env.observation_space().contains(&first));
    let bytes = first.as_slice::<u8>().unwrap();
    assert_eq!(bytes.len(), 84 * 84 * 3);
    assert!(bytes.iter().any(|byte| *byte != bytes[0]));
    let played = play(&mut env.clone(), 5);
    assert_ne!(played[4].0, first);
    assert_eq!(play(&mut env, 5), played);
}

#[test]
fn a_start_can_be_given() {
    let mut env = builder("dm_control/pendulum-swingup-v0")
        .arg("qpos", json!([0.0]))
        .arg("qvel", json!([0.5]))
        .build()
        .unwrap();
    let seen = env.reset(9).unwrap();
    let numbers = |key: &str| seen.get(key).unwrap().as_slice::<f64>().unwrap();
    assert_eq!(
        (numbers("orientation"), numbers("velocity")),
        (&[1.0, 0.0][..], &[0.5][..])
    );
}

#[test]
fn episodes_last_as_long_as_the_limit() {
    for (limit, steps) in [(json!(0.1), 10), (json!(null), 1200)] {
        let mut env = builder("dm_control/cartpole-balance-v0")
            .arg("time_limit", limit)
            .build()
            .unwrap();
        env.reset(0).unwrap();
        for step in 1..=steps {
            let outcome = env.step(&Value::from(vec![0.0])).unwrap();
            assert_eq!(outcome.truncated, step == 10 && steps == 10);
            assert!(!outcome.terminated);
        }
    }
}

#[test]
fn bad_arguments_are_refused() {
    for (id, name, value, reason) in [
        (
            "cartpole-balance",
            "poles",
            json!(0),
            "0 is not from 1 to 20",
        ),
        (
            "cartpole-balance",
            "time_limit",
            json!(-1.0),
            "-1 s: it is positive",
        ),
        (
            "cartpole-balance",
            "time_limit",
            json!(0.0),
            "0 s: it is positive",
        ),
        (
            "cartpole-balance",
            "dtype",
            json!("uint8"),
            "\"float64\" or \"float32\"",
        ),
        ("cartpole-balance", "pixels", json!(0), "from 1 to 1024"),
        (
            "cartpole-balance",
            "qpos",
            json!([0.0]),
            "1 numbers: the model has 2",
        ),
        (
            "cartpole-balance",
            "qpos",
            json!([0.0, 0.0, 0.0]),
            "3 numbers: the model has 2",
        ),
        (
            "cartpole-balance",
            "qvel",
            json!([0.0, 0.0, 0.0]),
            "3 numbers: the model has 2",
        ),
        ("cartpole-balance", "qvel", json!([0.0, 1e11]), "not within"),
        (
            "cartpole-balance",
            "camera_id",
            json!(7),
            "the model has 2 cameras",
        ),
        ("cartpole-balance", "width", json!(0), "from 1 to 16384"),
        ("lqr-lqr_2_1", "actuators", json!(3), "3 of 2 bodies"),
        ("stacker-stack_2", "boxes", json!(5), "5 is not from 1 to 4"),
        (
            "swimmer-swimmer6",
            "links",
            json!(2),
            "2 is not from 3 to 50",
        ),
        ("walker-walk", "speed", json!(-1.0), "-1 is not from 0"),
        ("dog-walk", "speed", json!(-1.0), "-1 is not from 0"),
        ("quadruped-run", "speed", json!(0.0), "0 is not from 0.01"),
        ("quadruped-run", "goal", json!("rest"), "`speed`, `escape`"),
        ("walker-walk", "mujoco", json!("2.0"), "no MuJoCo version"),
    ] {
        let made = builder(&format!("dm_control/{id}-v0"))
            .arg(name, value)
            .build();
        let error = made.unwrap_err().to_string();
        assert!(error.contains(reason), "{id} {name}: {error}");
    }
}

/// A snapshot continues in a new environment, even if the start of the episode changed the model.
#[test]
fn a_snapshot_continues_anywhere() {
    for id in [
        "point_mass-hard",
        "lqr-lqr_6_2",
        "hopper-hop",
        "manipulator-insert_peg",
        "acrobot-swingup",
        "quadruped-escape",
        "dog-fetch",
    ] {
        let id = format!("dm_control/{id}-v0");
        let mut env = make(&id).unwrap();
        env.reset(4).unwrap();
        play(&mut env, 7);
        let snapshot = env.snapshot().unwrap();
        let mut other = make(&id).unwrap();
        other.restore(&snapshot).unwrap();
        assert_eq!(play(&mut other, 20), play(&mut env, 20), "{id}");
        assert_eq!(other.reset(()).unwrap(), env.reset(()).unwrap(), "{id}");
        assert_eq!(play(&mut other, 5), play(&mut env, 5), "{id}");
    }
}

#[test]
fn native_vectors_equal_single_environments() {
    for id in ["dm_control/walker-walk-v0", "dm_control/point_mass-hard-v0"] {
        native_equals_sync(id, 30, 7, |kind| {
            builder(id).vector(5).kind(kind).build().unwrap()
        });
    }
}

#[test]
fn colours_show_the_reward_where_that_is_asked() {
    let draw = |shown: bool| {
        let env = builder("dm_control/pendulum-swingup-v0")
            .arg("qpos", json!([0.0]))
            .arg("visualize_reward", shown)
            .arg("pixels", 48);
        env.build().unwrap().reset(0).unwrap()
    };
    assert_ne!(draw(true), draw(false));
}

/// Whether a part of a square image of the first state has more than one colour.
fn shows(env: EnvBuilder, side: usize, rows: Range<usize>, columns: Range<usize>) -> bool {
    let made = env.arg("pixels", side).build();
    let picture = made.unwrap().reset(1).unwrap();
    let (pixels, _) = picture.as_slice::<u8>().unwrap().as_chunks::<3>();
    let part = rows.flat_map(|row| {
        columns
            .clone()
            .map(move |column| pixels[row * side + column])
    });
    part.collect::<BTreeSet<_>>().len() > 1
}

#[test]
fn the_camera_follows_the_fish_and_not_its_target() {
    // the fish has several colours, the floor would have one or two
    assert!(shows(
        builder("dm_control/fish-swim-v0"),
        84,
        41..43,
        41..43
    ));
}

#[test]
fn the_string_of_the_ball_is_shown() {
    // the ball hangs below the cup
    let env = builder("dm_control/ball_in_cup-catch-v0").arg("qpos", vec![0.0; 4]);
    assert!(shows(env, 240, 100..101, 110..130));
}

#[test]
fn pendulum_and_cartpole_are_played_with_the_arrows() {
    let mut played = 0;
    for id in ids() {
        let Some(keys) = registry::find(&id).unwrap().page.keys else {
            continue;
        };
        let mut env = make(&id).unwrap();
        let keys = keys(&env);
        assert!(matches!(keys.idle, Idle::Action(_)), "{id}");
        let speeds: Vec<(String, f64)> = keys
            .actions
            .iter()
            .map(|(key, action)| {
                env.reset(1).unwrap();
                let action = env.action_space().from_json(action).unwrap();
                let seen = env.step(&action).unwrap().observation;
                let velocities = seen.get("velocity").and_then(Value::as_array).unwrap();
                (key.clone(), velocities.iter_f64().next().unwrap())
            })
            .collect();
        let names: Vec<&str> = speeds.iter().map(|(key, _)| key.as_str()).collect();
        assert_eq!(names, ["Left", "Right"], "{id}");
        assert!(speeds[0].1 < speeds[1].1, "{id}: {speeds:?}");
        played += 1;
    }
    assert_eq!(played, 7, "pendulum's task and cartpole's six");
}

#[test]
fn masses_are_brought_to_rest_by_the_rule_of_lqr() {
    for id in ["dm_control/lqr-lqr_2_1-v0", "dm_control/lqr-lqr_6_2-v0"] {
        let policy = registry::find(id).unwrap().page.policy.unwrap();
        let mut env = make(id).unwrap();
        let energy = |seen: &Value| -> f64 {
            let parts = ["position", "velocity"].map(|part| seen.get(part).unwrap());
            let numbers = parts.map(|part| part.as_array().unwrap().iter_f64().collect::<Vec<_>>());
            numbers.iter().flatten().map(|x| x * x).sum()
        };
        let mut seen = env.reset(1).unwrap();
        let before = energy(&seen);
        let mut controller = policy.controller(&env).unwrap().unwrap();
        for _ in 0..3000 {
            let action = controller(&env, &seen).unwrap();
            seen = env.step(&action).unwrap().observation;
        }
        assert!(energy(&seen) < 0.5 * before, "{id}: {}", energy(&seen));
        let flat = builder(id).arg("flat", true).build().unwrap();
        assert!(policy.controller(&flat).unwrap().is_none(), "{id}");
    }
}

/// The last step before the time limit truncates the episode, even if the task would terminate it.
#[test]
fn a_limit_comes_before_the_end_of_a_task() {
    let first = |steps: f64| {
        let mut env = builder("dm_control/lqr-lqr_2_1-v0")
            .arg("qpos", json!([0.0, 0.0]))
            .arg("qvel", json!([0.0, 0.0]))
            .arg("time_limit", 0.03 * steps)
            .build()
            .unwrap();
        env.reset(0).unwrap();
        let step = env.step(&Value::from(vec![0.0])).unwrap();
        (step.terminated, step.truncated)
    };
    assert_eq!(first(1.0), (false, true));
    assert_eq!(first(2.0), (true, false));
}

/// A snapshot with more steps than the time limit is an error.
#[test]
fn states_beyond_the_limit_are_refused() {
    let make = || {
        let env = builder("dm_control/cartpole-balance-v0").arg("time_limit", 0.1);
        env.build().unwrap()
    };
    let mut env = make();
    env.reset(0).unwrap();
    play(&mut env, 10);
    let last = env.snapshot().unwrap();
    make().restore(&last).unwrap();
    // no episode has a state after the step that truncates it
    play(&mut env, 1);
    let beyond = env.snapshot().unwrap();
    let mut other = make();
    other.reset(3).unwrap();
    let before = other.snapshot().unwrap();
    assert!(other.restore(&beyond).is_err());
    assert_eq!(other.snapshot().unwrap(), before);
}

/// (JSON has no NaN, so these arguments come from Rust.)
#[test]
fn a_start_of_no_numbers_is_refused() {
    use gym_control::domains::pendulum::{Config, Pendulum};
    use gym_control::make;
    for (x, fits) in [
        (1e10, true),
        (-1e10, true),
        (1e10_f64.next_up(), false),
        (f64::NAN, false),
        (f64::NEG_INFINITY, false),
    ] {
        for velocity in [false, true] {
            let mut config = Config::default();
            let given = Some(vec![x]);
            if velocity {
                config.common.qvel = given;
            } else {
                config.common.qpos = given;
            }
            assert_eq!(make::<Pendulum>(&config).is_ok(), fits, "{x}");
        }
    }
}

/// A snapshot of a point mass whose directions are not numbers is an error.
#[test]
fn constants_of_a_start_are_checked() {
    let mut env = make("dm_control/point_mass-hard-v0").unwrap();
    env.reset(1).unwrap();
    let before = env.snapshot().unwrap();
    for (number, fits) in [(json!(0.5), true), (json!({"$float": "NaN"}), false)] {
        let mut stored = serde_json::to_value(&before).unwrap();
        // the snapshot of a wrapper is a list that begins with the inner snapshot
        let mut inner = &mut stored;
        while inner.is_array() {
            inner = &mut inner[0];
        }
        let constants = &mut inner["episode"]["constants"];
        assert_eq!(constants.as_array().map(Vec::len), Some(4));
        constants[2] = number.clone();
        let stored = serde_json::from_value(stored).unwrap();
        let mut other = make("dm_control/point_mass-hard-v0").unwrap();
        assert_eq!(other.restore(&stored).is_ok(), fits, "{number}");
    }
}

/// The old content of the observation's buffer does not matter, even if it has the same number of
/// parts with other names.
#[test]
fn an_observation_has_the_keys_of_its_task() {
    let mut seen = make("dm_control/pendulum-swingup-v0")
        .unwrap()
        .reset(1)
        .unwrap();
    let mut env = make("dm_control/point_mass-easy-v0").unwrap();
    let expected = env.reset(1).unwrap();
    let parts = |value: &Value| match value {
        Value::Dict(entries) => entries.len(),
        _ => 0,
    };
    assert_eq!((parts(&seen), parts(&expected)), (2, 2));
    env.reset_into(&1.into(), &mut seen).unwrap();
    assert_eq!(seen, expected);
}

#[test]
fn a_picture_is_as_wide_as_it_can_be() {
    for (side, fits) in [(1, true), (16_384, true), (16_385, false)] {
        for name in ["width", "height"] {
            let env = builder("dm_control/pendulum-swingup-v0").arg(name, side);
            assert_eq!(env.build().is_ok(), fits, "{name} {side}");
        }
    }
}

/// The two directions of a point mass's forces have the length 1, and are not too similar.
#[test]
fn directions_of_forces_differ() {
    let mut env = make("dm_control/point_mass-hard-v0").unwrap();
    for seed in 0..40 {
        env.reset(seed).unwrap();
        let stored = serde_json::to_value(env.snapshot().unwrap()).unwrap();
        let mut inner = &stored;
        while inner.is_array() {
            inner = &inner[0];
        }
        let constants = inner["episode"]["constants"].clone();
        let [a, b, c, d]: [f64; 4] = serde_json::from_value(constants).unwrap();
        assert!((a * a + b * b - 1.0).abs() < 1e-12, "{seed}");
        assert!((c * c + d * d - 1.0).abs() < 1e-12, "{seed}");
        assert!((a * c + b * d).abs() <= 0.9, "{seed}");
    }
}
