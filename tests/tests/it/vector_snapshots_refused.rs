//! Snapshots that a vector refuses, which change nothing.

use gym::vector::{AsyncVectorEnv, Autoreset, Columns, VectorKind, VectorReset};
use gym::{BoxEnv, Env, EnvExt, Snapshot, Value, VectorEnv, VectorEnvExt, builder};
use serde_json::{Value as Json, json};

use crate::vector_snapshots::{KINDS, MODES, N, play, spec, stored};

/// Returns copies of `json`; in each copy, one string or number is damaged.
fn spoilt(json: &Json) -> Vec<Json> {
    let mut all = Vec::new();
    match json {
        Json::Array(items) => {
            all.push(Json::Array(Vec::new()));
            for (i, item) in items.iter().enumerate() {
                all.extend(spoilt(item).into_iter().map(|spoilt| {
                    let mut items = items.clone();
                    items[i] = spoilt;
                    Json::Array(items)
                }));
            }
        }
        Json::Object(entries) => {
            all.push(Json::Object(Default::default()));
            for (key, item) in entries {
                all.extend(spoilt(item).into_iter().map(|spoilt| {
                    let mut entries = entries.clone();
                    entries.insert(key.clone(), spoilt);
                    Json::Object(entries)
                }));
            }
        }
        Json::String(text) => {
            all.push(json!(text.get(..text.len() / 2).unwrap_or("")));
            all.push(json!(null));
        }
        Json::Number(_) => all.extend([json!("x"), json!(-1e300)]),
        Json::Bool(_) | Json::Null => all.push(json!("x")),
    }
    all
}

#[test]
fn a_refused_snapshot_changes_nothing() {
    let wrappers = json!([
        {"name": "RecordEpisodeStatistics"},
        {"name": "NormalizeObservation"},
        {"name": "NormalizeReward"},
    ]);
    let mut refused = 0;
    for (kind, mode) in KINDS
        .into_iter()
        .flat_map(|kind| MODES.map(|mode| (kind, mode)))
    {
        let own = spec("CartPole-v1", kind, mode, &wrappers);
        let mut envs = own.make().unwrap();
        let mut columns = envs.columns().unwrap();
        let mut actions = envs.action_sampler(0).unwrap();
        envs.reset_into(&5.into(), &mut columns).unwrap();
        play(&mut *envs, &mut columns, &mut actions, 13);
        let before = envs.snapshot().unwrap();
        play(&mut *envs, &mut columns, &mut actions, 4);
        let now = envs.snapshot().unwrap();

        let others = [
            spec("Pendulum-v1", kind, mode, &wrappers),
            spec("CartPole-v1", kind, mode, &json!([])),
            builder("CartPole-v1")
                .vector(N + 1)
                .kind(kind)
                .autoreset(mode)
                .spec()
                .unwrap(),
            builder("CartPole-v1")
                .arg("sutton_barto_reward", true)
                .max_episode_steps(9)
                .vector(N)
                .kind(kind)
                .autoreset(mode)
                .spec()
                .unwrap(),
            spec(
                "CartPole-v1",
                kind,
                MODES[(MODES.iter().position(|m| *m == mode).unwrap() + 1) % 3],
                &wrappers,
            ),
        ];
        for other in others {
            let mut vector = other.make().unwrap();
            vector
                .reset_into(&0.into(), &mut Columns::default())
                .unwrap();
            let error = envs
                .restore(&vector.snapshot().unwrap())
                .unwrap_err()
                .to_string();
            assert!(error.contains("cannot restore"), "{error}");
            assert_eq!(envs.snapshot().unwrap(), now, "{}: {error}", json!(other));
        }
        for spoilt in spoilt(&json!(before)) {
            let snapshot: Snapshot = serde_json::from_value(spoilt.clone()).unwrap();
            if envs.restore(&snapshot).is_err() {
                refused += 1;
                assert_eq!(envs.snapshot().unwrap(), now, "{spoilt}");
            } else {
                // the damaged state may still be valid, such as the state before the first reset:
                // continue, then restore the original
                for _ in 0..3 {
                    let _ = envs.step_into(&actions.clone().sample(), &mut columns);
                }
                envs.restore(&now).unwrap();
            }
        }
        envs.close();
        assert!(
            envs.restore(&before).is_err(),
            "a closed vector stays closed"
        );
        assert!(envs.step_into(&actions.sample(), &mut columns).is_err());
    }
    assert!(refused > 300, "{refused}");
}

/// A vector and its wrappers store one entry per sub-environment.
#[test]
fn statistics_of_fewer_environments_are_refused() {
    for kind in KINDS {
        let wrappers = json!([{"name": "RecordEpisodeStatistics"}]);
        let mut envs = spec("CartPole-v1", kind, Autoreset::NextStep, &wrappers)
            .make()
            .unwrap();
        envs.reset_into(&0.into(), &mut Columns::default()).unwrap();
        let now = envs.snapshot().unwrap();
        let mut fewer = json!(now);
        let running = fewer[1]["running"]
            .as_array_mut()
            .expect("one entry for each sub-environment");
        assert_eq!(running.len(), N);
        running.pop();
        let error = envs
            .restore(&serde_json::from_value(fewer).unwrap())
            .unwrap_err()
            .to_string();
        assert!(
            error.contains("it has 4 sub-environments, and this vector 5"),
            "{error}"
        );
        assert_eq!(envs.snapshot().unwrap(), now);
    }
}

#[test]
fn what_cannot_be_stored_says_so() {
    let mut pool = AsyncVectorEnv::new((0..3).map(|_| gym::make("CartPole-v1").unwrap())).unwrap();
    pool.reset(0).unwrap();
    let before = pool.snapshot().unwrap();
    pool.send(&Value::Array([0i64].into()), &[1]).unwrap();
    for error in [pool.snapshot().map(drop), pool.restore(&before)] {
        assert!(
            error
                .unwrap_err()
                .to_string()
                .contains("receive them first")
        );
    }
    assert_eq!(
        pool.describe(),
        "AsyncVectorEnv(CartPole-v1, num_envs=3)",
        "while one is away"
    );
    assert_eq!(pool.metadata().render_fps, 50, "while one is away");
}

/// The vector's data about a sub-environment, such as a due reset, is not part of the
/// sub-environment's own snapshot.
#[test]
fn snapshots_put_back_one_by_one_are_an_error_until_a_reset() {
    for (kind, autoreset) in [
        (VectorKind::Sync, Autoreset::NextStep),
        (VectorKind::Async, Autoreset::SameStep),
    ] {
        let envs = builder("CartPole-v1")
            .max_episode_steps(3)
            .vector(2)
            .kind(kind)
            .autoreset(autoreset);
        let mut envs = envs.build().unwrap();
        let mut columns = envs.columns().unwrap();
        let actions = envs.action_space().unwrap().sampler(0).sample();
        envs.reset_into(&VectorReset::from(1), &mut columns)
            .unwrap();
        for _ in 0..3 {
            envs.step_into(&actions, &mut columns).unwrap();
        }
        // reading changes nothing
        let taken = envs
            .call(|_, env: &mut BoxEnv| env.snapshot().unwrap())
            .unwrap();
        for _ in 0..2 {
            envs.step_into(&actions, &mut columns).unwrap();
        }
        envs.call(|index, env: &mut BoxEnv| env.restore(&taken[index]).unwrap())
            .unwrap();
        let error = envs
            .step_into(&actions, &mut columns)
            .unwrap_err()
            .to_string();
        assert!(
            error.contains("sub-environment 0") && error.contains("through `call`"),
            "{error}"
        );

        // neither a reset of the other sub-environment nor a snapshot of the vector hides the error
        envs.reset_into(&VectorReset::default().mask([true, false]), &mut columns)
            .unwrap();
        let stored = stored(&*envs);
        envs.restore(&stored).unwrap();
        let error = envs
            .step_into(&actions, &mut columns)
            .unwrap_err()
            .to_string();
        assert!(error.contains("sub-environment 1"), "{error}");
        envs.reset_into(&VectorReset::default().mask([false, true]), &mut columns)
            .unwrap();
        envs.step_into(&actions, &mut columns).unwrap();

        for call in [
            |env: &mut BoxEnv| drop(env.reset(0).unwrap()),
            |env: &mut BoxEnv| drop(env.step(&Value::Int(0))),
        ] {
            envs.call(|_, env: &mut BoxEnv| call(env)).unwrap();
            assert!(envs.step_into(&actions, &mut columns).is_err());
            envs.reset_into(&VectorReset::default(), &mut columns)
                .unwrap();
        }
    }
}
