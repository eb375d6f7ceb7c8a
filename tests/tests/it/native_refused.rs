//! What native vectors refuse: environments that are not as registered, actions, options.

use gym::vector::{Autoreset, VectorEnv, VectorEnvExt, VectorReset};
use gym::{Array, Env, EnvSpec, Value, builder};
use serde_json::json;

use crate::native::{CLASSIC, TABLES, native, spec};

#[test]
fn what_only_scalar_environments_can_do_is_refused() {
    let plain = |id: &str| spec(id, json!({}));
    let wrapped = builder("CartPole-v1").build().unwrap();
    let wrapped = gym::Wrap::clip_reward(wrapped, (-1.0, 1.0))
        .unwrap()
        .spec()
        .unwrap();
    let rendered = EnvSpec {
        render_mode: Some(gym::render::RenderMode::RgbArray),
        ..plain("CartPole-v1")
    };
    for (spec, reason) in [
        (spec("Taxi-v4", json!({"fickle_passenger": true})), "fickle"),
        (
            spec("FrozenLake-v1", json!({"map_name": null})),
            "random maps",
        ),
        (
            EnvSpec {
                max_episode_steps: Some(70_000),
                ..plain("CartPole-v1")
            },
            "65534",
        ),
        (wrapped, "cannot be wrapped"),
        (rendered, "cannot render"),
    ] {
        let error = native(&spec, 2, Autoreset::NextStep)
            .unwrap_err()
            .to_string();
        assert!(
            error.contains(reason) && error.contains("make a sync or async"),
            "{error}"
        );
    }
    let unknown = native(
        &spec("CartPole-v1", json!({"wind": 1})),
        2,
        Autoreset::NextStep,
    )
    .unwrap_err();
    assert!(
        unknown.to_string().contains("sutton_barto_reward"),
        "{unknown}"
    );
    let none = native(
        &spec("CliffWalking-v0", json!({"is_slippery": true})),
        2,
        Autoreset::NextStep,
    );
    assert!(none.unwrap_err().to_string().contains("takes no arguments"));
    assert!(native(&plain("CartPole-v1"), 0, Autoreset::NextStep).is_err());
    assert!(
        native(
            &EnvSpec {
                max_episode_steps: Some(0),
                ..plain("CartPole-v1")
            },
            1,
            Autoreset::NextStep
        )
        .is_err()
    );
    let rebuilt = native(&plain("Taxi-v4"), 3, Autoreset::SameStep)
        .unwrap()
        .spec()
        .unwrap()
        .make()
        .unwrap();
    assert_eq!(rebuilt.describe(), "NativeVectorEnv(Taxi-v4, num_envs=3)");
    assert_eq!(rebuilt.autoreset(), Autoreset::SameStep);
    let endless = EnvSpec {
        max_episode_steps: None,
        ..plain("Pendulum-v1")
    };
    assert!(native(&endless, 1, Autoreset::NextStep).is_ok());
}

/// Takes a step with `actions` in a vector of three; asserts that it is refused and changes
/// nothing.
fn refused(id: &str, actions: &Value) -> String {
    let mut envs = native(&spec(id, json!({})), 3, Autoreset::NextStep).unwrap();
    let mut columns = envs.columns().unwrap();
    envs.reset_into(&0.into(), &mut columns).unwrap();
    let before = columns.clone();
    let error = envs
        .step_into(actions, &mut columns)
        .unwrap_err()
        .to_string();
    assert_eq!(columns, before, "{id}: {error}");
    let mut fresh = native(&spec(id, json!({})), 3, Autoreset::NextStep).unwrap();
    let mut expected = fresh.columns().unwrap();
    fresh.reset_into(&0.into(), &mut expected).unwrap();
    let good = envs.action_space().unwrap().sampler(1).sample();
    envs.step_into(&good, &mut columns).unwrap();
    fresh.step_into(&good, &mut expected).unwrap();
    assert_eq!(columns, expected, "{id}: after {error}");
    error
}

#[test]
fn bad_actions_are_refused_before_anything_is_stepped() {
    let boxed = |values: [f32; 3]| Value::Array(Array::from(values).reshape([3, 1]).unwrap());
    for id in TABLES.iter().chain(&CLASSIC) {
        for actions in [
            Value::Null,
            Value::Int(0),
            Value::Array([0i64, 0].into()),
            Value::Array([0.0f64; 3].into()),
        ] {
            assert!(
                refused(id, &actions).contains("is not an element of a batch of"),
                "{id}"
            );
        }
        let (bad, index) = if ["MountainCarContinuous-v0", "Pendulum-v1"].contains(id) {
            (
                vec![
                    boxed([0.0, 0.0, f32::NAN]),
                    boxed([0.0, 0.0, f32::INFINITY]),
                ],
                2,
            )
        } else {
            (
                vec![
                    Value::Array([0i64, -1, 0].into()),
                    Value::Array([0i64, 9, i64::MAX].into()),
                ],
                1,
            )
        };
        for bad in bad {
            let error = refused(id, &bad);
            assert!(
                error.starts_with(&format!("sub-environment {index}: invalid action")),
                "{error}"
            );
        }
    }
    // an environment whose step is a reset ignores its action, in any block
    let mut envs = native(&spec("FrozenLake-v1", json!({})), 70, Autoreset::NextStep).unwrap();
    let mut columns = envs.columns().unwrap();
    let mut actions = envs.action_space().unwrap().sampler(0);
    envs.reset_into(&0.into(), &mut columns).unwrap();
    for _ in 0..20 {
        let mut batch = actions.sample().as_slice::<i64>().unwrap().to_vec();
        let due: Vec<usize> = (0..70).filter(|i| columns.done(*i)).collect();
        due.iter().for_each(|i| batch[*i] = -1);
        for i in (0..70).filter(|i| !due.contains(i)).step_by(9) {
            let good = std::mem::replace(&mut batch[i], 7);
            let error = envs
                .step_into(&Value::Array(batch.clone().into()), &mut columns)
                .unwrap_err();
            assert!(
                error
                    .to_string()
                    .starts_with(&format!("sub-environment {i}: invalid action")),
                "{error}"
            );
            batch[i] = good;
        }
        envs.step_into(&Value::Array(batch.into()), &mut columns)
            .unwrap();
    }
    // a torque beyond the bounds is clipped, as in Gymnasium
    let mut envs = native(&spec("Pendulum-v1", json!({})), 3, Autoreset::NextStep).unwrap();
    let mut columns = envs.columns().unwrap();
    envs.reset_into(&0.into(), &mut columns).unwrap();
    envs.step_into(&boxed([9.0, -9.0, f32::MAX]), &mut columns)
        .unwrap();
    assert!(columns.rewards.iter().all(|reward| reward.is_finite()));
}

#[test]
fn environments_without_an_episode_are_named() {
    let spec = spec("FrozenLake-v1", json!({}));
    let mut envs = native(&spec, 40, Autoreset::Disabled).unwrap();
    let mut columns = envs.columns().unwrap();
    let actions = envs.action_space().unwrap().sampler(0).sample();
    let error = envs.step_into(&actions, &mut columns).unwrap_err();
    assert!(
        error
            .to_string()
            .starts_with("sub-environment 0: cannot call `step` before `reset`"),
        "{error}"
    );
    let all_but_35 = VectorReset::from(0).mask((0..40).map(|i| i != 35).collect::<Vec<_>>());
    envs.reset_into(&all_but_35, &mut columns).unwrap();
    let error = envs.step_into(&actions, &mut columns).unwrap_err();
    assert!(
        error.to_string().starts_with("sub-environment 35: "),
        "{error}"
    );
    envs.reset_into(&1.into(), &mut columns).unwrap();
    let over = loop {
        envs.step_into(&actions, &mut columns).unwrap();
        if let Some(over) = (0..40).find(|i| columns.done(*i)) {
            break over;
        }
    };
    let before = columns.clone();
    let error = envs.step_into(&actions, &mut columns).unwrap_err();
    assert!(
        error
            .to_string()
            .starts_with(&format!("sub-environment {over}: the episode has ended")),
        "{error}"
    );
    assert_eq!(columns, before);
    for bad in [
        VectorReset::seeds([1u64, 2]),
        VectorReset::default().mask([true]),
        VectorReset::default().mask([false; 40]),
    ] {
        assert!(envs.reset_into(&bad, &mut columns).is_err());
    }
    envs.close();
    assert!(
        envs.step_into(&actions, &mut columns).is_err()
            && envs.reset_into(&1.into(), &mut columns).is_err()
    );
}

#[test]
fn a_bad_reset_option_changes_nothing() {
    let mut envs = native(&spec("CartPole-v1", json!({})), 5, Autoreset::NextStep).unwrap();
    let mut columns = envs.columns().unwrap();
    envs.reset_into(&4.into(), &mut columns).unwrap();
    let actions = Value::Array([1i64; 5].into());
    let mut other = native(&spec("CartPole-v1", json!({})), 5, Autoreset::NextStep).unwrap();
    let mut expected = other.columns().unwrap();
    other.reset_into(&4.into(), &mut expected).unwrap();
    let bad = VectorReset::from(9).option("low", "far");
    let error = envs.reset_into(&bad, &mut columns).unwrap_err().to_string();
    assert!(
        error.starts_with("sub-environment 0: invalid argument for reset options"),
        "{error}"
    );
    envs.step_into(&actions, &mut columns).unwrap();
    other.step_into(&actions, &mut expected).unwrap();
    assert_eq!(columns, expected);
}
