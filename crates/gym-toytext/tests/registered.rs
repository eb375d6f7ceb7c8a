//! Environments made by id: older versions, and native vectors.

use gym_core::vector::{Autoreset, VectorKind, VectorReset};
use gym_core::{Env, EnvExt, Value, VectorEnv, VectorEnvExt, builder};
use gym_testing::native_equals_sync;
use gym_toytext::{CliffWalking, Taxi};
use serde_json::{Value as Json, json};

/// Native vectors equal scalar environments, also after a snapshot. (100 is not a multiple of the
/// block size.)
#[test]
fn native_vectors_equal_scalar_environments() {
    for id in [
        "Blackjack-v1",
        "CliffWalking-v1",
        "FrozenLake-v1",
        "FrozenLake8x8-v1",
        "Taxi-v3",
    ] {
        for autoreset in [Autoreset::NextStep, Autoreset::SameStep] {
            native_equals_sync(&format!("{id}, {autoreset:?}"), 500, 7, |kind| {
                let vector = builder(id).vector(100).kind(kind).autoreset(autoreset);
                vector.build().unwrap()
            });
        }
    }
}

/// Both ends of a probability are possible, and the next numbers beyond them are refused by name.
#[test]
fn probabilities_are_from_0_to_1() {
    for (id, class, name, switch) in [
        ("FrozenLake-v1", "FrozenLake", "success_rate", "is_slippery"),
        ("Taxi-v4", "Taxi", "rainy_probability", "is_rainy"),
        ("Taxi-v4", "Taxi", "fickle_probability", "fickle_passenger"),
    ] {
        for probability in [-1.0, -1e-9, 0.0, 5e-324, 1.0, 1.0 + f64::EPSILON, 2.0] {
            for is_used in [false, true] {
                let made = builder(id)
                    .arg(switch, is_used)
                    .arg(name, probability)
                    .build();
                if (0.0..=1.0).contains(&probability) {
                    let mut env = made.unwrap();
                    env.reset(3).unwrap();
                    env.step(&Value::Int(1)).unwrap();
                    continue;
                }
                assert_eq!(
                    made.unwrap_err().to_string(),
                    format!(
                        "invalid argument for {class}: {name} is {probability}: a probability is between 0 and 1"
                    )
                );
            }
        }
    }
}

#[test]
fn older_versions_take_no_arguments() {
    let mut cliff = builder("CliffWalking-v0").build().unwrap();
    assert_eq!(cliff.reset(0).unwrap().as_int(), Some(36));
    assert!(cliff.layer::<CliffWalking>().is_some());
    assert!(
        builder("Taxi-v3")
            .build()
            .unwrap()
            .layer::<Taxi>()
            .is_some()
    );
    for (older, newer, argument) in [
        ("CliffWalking-v0", "CliffWalking-v1", "is_slippery"),
        ("Taxi-v3", "Taxi-v4", "is_rainy"),
    ] {
        let error = builder(older).arg(argument, false).build().unwrap_err();
        assert!(error.to_string().contains("takes no arguments"), "{error}");
        builder(newer).arg(argument, true).build().unwrap();
    }
}

/// The step counter has 16 bits, and stops below the number that means "no limit".
#[test]
fn episodes_without_a_limit_are_never_truncated() {
    let envs = builder("CliffWalking-v1").vector(3);
    let mut envs = envs.kind(VectorKind::Native).build().unwrap();
    let mut columns = envs.columns().unwrap();
    envs.reset_into(&0.into(), &mut columns).unwrap();
    let up = Value::from([0_i64; 3]);
    for step in 0..66_000 {
        envs.step_into(&up, &mut columns).unwrap();
        assert_eq!(columns.truncated, [false; 3], "step {step}");
    }
}

/// The final infos of an episode appear only in the step that ended the episode.
#[test]
fn a_reset_leaves_no_last_infos() {
    for kind in [VectorKind::Native, VectorKind::Sync, VectorKind::Async] {
        let envs = builder("FrozenLake-v1").vector(2).kind(kind);
        let mut envs = envs.autoreset(Autoreset::SameStep).build().unwrap();
        let mut columns = envs.columns().unwrap();
        envs.reset_into(&3.into(), &mut columns).unwrap();
        let last = |envs: &dyn VectorEnv, index: usize| {
            let mut entries = 0;
            envs.final_info(index, &mut |_, _| entries += 1);
            entries
        };
        let mut actions = envs.action_space().unwrap().sampler(0);
        while !columns.has_final[0] {
            envs.step_into(&actions.sample(), &mut columns).unwrap();
        }
        assert_eq!(last(&*envs, 0), 1, "{kind:?}");
        let other = VectorReset::default().mask([false, true]);
        envs.reset_into(&other, &mut columns).unwrap();
        assert_eq!(last(&*envs, 0), 0, "{kind:?}");
    }
}

/// A stored state is one that the environment can be in; both ends of each range.
#[test]
fn states_that_cannot_be_are_not_restored() {
    for (id, name, possible, impossible) in [
        (
            "CliffWalking-v1",
            "cell",
            json!([0, 36, 47]),
            json!([37, 46, 48, -1, 0.5]),
        ),
        (
            "CliffWalking-v1",
            "probability",
            json!([0.0, 1.0]),
            json!([-0.1, 1.1, null]),
        ),
        (
            "CliffWalking-v1",
            "last_action",
            json!([null, "Left"]),
            json!(["Stay", 0]),
        ),
        ("FrozenLake-v1", "cell", json!([0, 15]), json!([16, -1])),
        (
            "FrozenLake-v1",
            "probability",
            json!([0.0, 1.0]),
            json!([-0.1, 1.1]),
        ),
        (
            "FrozenLake-v1",
            "last_action",
            json!([null, "Up"]),
            json!(["Stay", 0]),
        ),
        ("Taxi-v4", "encoded", json!([0, 499]), json!([500, -1])),
        ("Taxi-v4", "fickle_step", json!([false]), json!([true, 0])),
        (
            "Taxi-v4",
            "heading",
            json!(["South", "West"]),
            json!(["Pickup", "Dropoff", "Up"]),
        ),
        (
            "Taxi-v4",
            "last_action",
            json!([null, "Dropoff"]),
            json!(["Up", 0]),
        ),
        (
            "Taxi-v4",
            "probability",
            json!([0.0, 1.0]),
            json!([-0.1, 1.1]),
        ),
        (
            "Blackjack-v1",
            "dealer",
            json!([[9, 1]]),
            json!([[10, 1], [9], [9, 11]]),
        ),
        (
            "Blackjack-v1",
            "player",
            json!([[10, 10, 10]]),
            json!([[10, 10, 2, 1], [0, 1]]),
        ),
        (
            "Blackjack-v1",
            "suit",
            json!(["Clubs", "Spades"]),
            json!(["Stars", null]),
        ),
        (
            "Blackjack-v1",
            "face",
            json!([null]),
            json!(["King", "Ace"]),
        ),
    ] {
        let mut env = builder(id).build().unwrap();
        let mut stored = |value: &Json| {
            env.reset(1).unwrap(); // the dealer's first card is no ten
            let mut whole = serde_json::to_value(env.snapshot().unwrap()).unwrap();
            let state = find(&mut whole, name).unwrap_or_else(|| panic!("{id} has no {name}"));
            state.clone_from(value);
            env.restore(&serde_json::from_value(whole).unwrap())
        };
        for value in possible.as_array().unwrap() {
            stored(value).unwrap_or_else(|error| panic!("{id}, {name} = {value}: {error}"));
        }
        for value in impossible.as_array().unwrap() {
            assert!(stored(value).is_err(), "{id}: {name} = {value}");
        }
    }
}

/// The first value of `key`, at any depth.
fn find<'a>(json: &'a mut Json, key: &str) -> Option<&'a mut Json> {
    match json {
        Json::Object(entries) => {
            let (found, others): (Vec<_>, Vec<_>) =
                entries.iter_mut().partition(|(own, _)| *own == key);
            let mut found = found.into_iter().map(|(_, value)| value);
            let within = |(_, value)| find(value, key);
            found.next().or_else(|| others.into_iter().find_map(within))
        }
        Json::Array(items) => items.iter_mut().find_map(|item| find(item, key)),
        _ => None,
    }
}
