//! Clones and snapshots continue.

use gym_core::{BoxEnv, Env, EnvExt, Value};

use crate::{bridge, has, widens};

#[test]
fn clones_and_snapshots_continue() {
    if !has(&["gymnasium"]) {
        return;
    }
    let make = || {
        bridge("CartPole-v1")
            .arg("allow_pickle", true)
            .build()
            .unwrap()
    };
    let mut env = make();
    env.reset(7).unwrap();
    env.step(&Value::Int(1)).unwrap();
    let (mut clone, snapshot) = (env.clone(), env.snapshot().unwrap());
    let mut restored = make();
    restored.restore(&snapshot).unwrap();
    for action in [0, 1, 1, 0, 1] {
        let step = env.step(&Value::Int(action)).unwrap();
        assert_eq!(clone.step(&Value::Int(action)).unwrap(), step);
        assert_eq!(restored.step(&Value::Int(action)).unwrap(), step);
    }
    let refused = bridge("CartPole-v1")
        .build()
        .unwrap()
        .snapshot()
        .unwrap_err()
        .to_string();
    assert!(
        refused.contains("restoring runs code") && refused.contains("allow_pickle"),
        "{refused}"
    );
}

#[test]
fn clones_and_snapshots_tell_the_last_info() {
    if !has(&["gymnasium"]) {
        return;
    }
    let action = Value::from([0.5_f32, -0.5]);
    let steps = |env: &BoxEnv| env.info_map().get("steps").cloned();
    let mut env = widens(3).build().unwrap();
    assert!(
        matches!(
            env.clone().step(&action),
            Err(gym_core::Error::ResetNeeded(_))
        ),
        "nor does a clone"
    );
    env.reset(0).unwrap();
    env.step(&action).unwrap();
    assert_eq!(steps(&env), Some(Value::Int(4)));
    let snapshot = env.snapshot().unwrap();
    let mut restored = widens(3).build().unwrap();
    assert!(matches!(
        restored.step(&action),
        Err(gym_core::Error::ResetNeeded(_))
    ));
    restored.restore(&snapshot).unwrap();
    for mut env in [env.clone(), restored] {
        assert_eq!(steps(&env), Some(Value::Int(4)), "before a step of its own");
        env.step(&action).unwrap();
        assert_eq!(steps(&env), Some(Value::Int(5)));
    }
    let refused = widens(2)
        .build()
        .unwrap()
        .restore(&snapshot)
        .unwrap_err()
        .to_string();
    assert!(refused.contains("with other arguments"), "{refused}");
    env.close();
    assert!(matches!(
        env.restore(&snapshot),
        Err(gym_core::Error::Closed("restore"))
    ));
}
