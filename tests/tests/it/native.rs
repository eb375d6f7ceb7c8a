//! Native vectors equal single environments that are stepped by hand, bit for bit.

use gym::vector::{Autoreset, Seeds, VectorEnv, VectorEnvExt, VectorKind, VectorReset, VectorSpec};
use gym::{Array, EnvExt, EnvSpec, Result, Seed, Value, builder, registry};
use serde_json::{Value as Json, json};

use super::by_hand::{ByHand, rows};

pub(crate) const TABLES: [&str; 8] = [
    "Blackjack-v1",
    "CliffWalking-v0",
    "CliffWalking-v1",
    "CliffWalkingSlippery-v1",
    "FrozenLake-v1",
    "FrozenLake8x8-v1",
    "Taxi-v3",
    "Taxi-v4",
];
pub(crate) const CLASSIC: [&str; 6] = [
    "Acrobot-v1",
    "CartPole-v0",
    "CartPole-v1",
    "MountainCar-v0",
    "MountainCarContinuous-v0",
    "Pendulum-v1",
];
pub(crate) const MODES: [Autoreset; 3] = [
    Autoreset::NextStep,
    Autoreset::SameStep,
    Autoreset::Disabled,
];

pub(crate) fn spec(id: &str, arguments: impl Into<Json>) -> EnvSpec {
    let arguments = arguments.into();
    let mut spec = registry::find(id).unwrap().spec().unwrap();
    for (name, value) in arguments.as_object().unwrap() {
        spec.kwargs.insert(name.clone(), value.clone());
    }
    spec
}

pub(crate) fn native(spec: &EnvSpec, n: usize, autoreset: Autoreset) -> Result<Box<dyn VectorEnv>> {
    VectorSpec::new(spec.clone(), n, VectorKind::Native)
        .autoreset(autoreset)
        .make()
}

/// Returns the sub-environments of a vector.
pub(crate) fn by_hand(spec: &EnvSpec, n: usize) -> Vec<ByHand> {
    let env = || spec.make().unwrap();
    (0..n).map(|_| ByHand::new(env())).collect()
}

/// Returns the observations of those that a reset names.
pub(crate) fn starts(hands: &mut [ByHand], reset: &VectorReset) -> Vec<Option<Value>> {
    let hands = hands.iter_mut().enumerate();
    hands
        .map(|(i, hand)| Some(hand.reset(reset.of(i)?).observation))
        .collect()
}

/// Steps both with random actions; with `Autoreset::Disabled`, resets the environments that are
/// done.
fn compare(spec: &EnvSpec, n: usize, autoreset: Autoreset, steps: usize) {
    let name = format!("{} {:?}, {n}, {autoreset:?}", spec.id, spec.kwargs);
    let mut envs = native(spec, n, autoreset).unwrap();
    let mut hands = by_hand(spec, n);
    let mut columns = envs.columns().unwrap();
    let mut reset = VectorReset::from(123);
    let mut actions = envs.action_space().unwrap().sampler(5);
    for step in 0..steps {
        let over: Vec<bool> = hands.iter().map(|hand| hand.done).collect();
        if step == 0 || autoreset == Autoreset::Disabled && over.contains(&true) {
            if step > 0 {
                reset = VectorReset::default().mask(over.clone());
                // sometimes a list of seeds
                if step % 3 == 0 {
                    let seeds = (0..n as u64)
                        .map(|i| (i % 2 == 0).then(|| Seed::from(i * 7 + step as u64)));
                    reset.seeds = Seeds::Each(seeds.collect());
                }
            }
            envs.reset_into(&reset, &mut columns).unwrap();
            let starts = starts(&mut hands, &reset);
            let shown = envs
                .single_observation_space()
                .iterate(&columns.observations)
                .unwrap();
            for (i, (start, shown)) in starts.into_iter().zip(shown).enumerate() {
                assert!(
                    start.is_none_or(|start| start == shown),
                    "{name}: start {i} after step {step}"
                );
                assert!(over[i] || step == 0 || reset.of(i).is_none());
            }
            assert!(
                columns.rewards.iter().all(|reward| *reward == 0.0)
                    && !columns.terminated.contains(&true)
            );
        }
        let batch = actions.sample();
        envs.step_into(&batch, &mut columns).unwrap();
        let single: Vec<Value> = envs
            .single_action_space()
            .iterate(&batch)
            .unwrap()
            .collect();
        for (i, (got, (hand, action))) in rows(&*envs, &columns)
            .into_iter()
            .zip(hands.iter_mut().zip(&single))
            .enumerate()
        {
            let want = hand.step(action, autoreset);
            assert_eq!(got, want, "{name}: step {step} of {i}");
        }
    }
}

#[test]
fn native_vectors_equal_scalar_environments() {
    for id in TABLES.iter().chain(&CLASSIC) {
        for mode in MODES {
            for (n, steps) in [(1, 400), (7, 300), (1000, 12)] {
                compare(&spec(id, json!({})), n, mode, steps);
            }
        }
    }
}

/// Worlds that are solved together, in full groups and with unused lanes.
#[test]
fn native_vectors_of_box2d_equal_scalar_environments() {
    let wind = json!({"enable_wind": true, "gravity": -4.0, "wind_power": 19.0});
    for (id, arguments, n, steps) in [
        ("LunarLander-v2", wind.clone(), 17, 150),
        ("LunarLander-v3", json!({}), 1, 150),
        ("LunarLander-v3", json!({}), 33, 150),
        ("LunarLanderContinuous-v2", wind.clone(), 16, 100),
        ("LunarLanderContinuous-v3", wind, 35, 100),
        ("BipedalWalker-v3", json!({}), 5, 150),
        ("BipedalWalkerHardcore-v3", json!({}), 17, 90),
    ] {
        for mode in MODES {
            compare(&spec(id, arguments.clone()), n, mode, steps);
        }
    }
}

/// Each thread solves its worlds together.
#[test]
fn async_vectors_of_box2d_equal_native_ones() {
    for id in ["LunarLander-v3", "BipedalWalker-v3"] {
        for mode in [Autoreset::NextStep, Autoreset::SameStep] {
            let make = |kind| builder(id).vector(37).kind(kind).autoreset(mode);
            let mut native = make(VectorKind::Native).build().unwrap();
            let mut threads = make(VectorKind::Async).threads(3).build().unwrap();
            let [mut one, mut other] = [native.columns().unwrap(), threads.columns().unwrap()];
            native.reset_into(&5.into(), &mut one).unwrap();
            threads.reset_into(&5.into(), &mut other).unwrap();
            assert_eq!(one, other, "{id}");
            let mut actions = native.action_space().unwrap().sampler(2);
            for step in 0..120 {
                let actions = actions.sample();
                native.step_into(&actions, &mut one).unwrap();
                threads.step_into(&actions, &mut other).unwrap();
                assert_eq!(
                    one.observations, other.observations,
                    "{id}, {mode:?}: step {step}"
                );
                assert_eq!(one.rewards, other.rewards, "{id}, {mode:?}: step {step}");
                assert_eq!(one.progress, other.progress, "{id}, {mode:?}: step {step}");
            }
        }
    }
}

/// If one environment refuses its action, the other environments step as separate environments do,
/// and no step remains incomplete.
#[test]
fn a_refused_action_leaves_no_step_begun() {
    let spec = spec("LunarLanderContinuous-v3", json!({}));
    let mut envs = native(&spec, 6, Autoreset::NextStep).unwrap();
    let mut hands = by_hand(&spec, 6);
    let mut columns = envs.reset(3).unwrap();
    starts(&mut hands, &3.into());
    let batch = |x: f32| {
        let rows: Vec<f32> = (0..6)
            .flat_map(|i| [if i == 4 { x } else { 0.4 }, 0.9])
            .collect();
        Value::Array(Array::from(rows).reshape([6, 2]).unwrap())
    };
    for x in [0.2, f32::NAN, 0.7, 0.1, f32::INFINITY, -0.3] {
        let actions = batch(x);
        let result = envs.step_into(&actions, &mut columns);
        assert_eq!(result.is_err(), !x.is_finite());
        for (i, hand) in hands.iter_mut().enumerate() {
            if i == 4 && !x.is_finite() {
                continue;
            }
            let action = envs
                .single_action_space()
                .iterate(&actions)
                .unwrap()
                .nth(i)
                .unwrap();
            let step = hand.env.step(&action).unwrap();
            let shown = envs
                .single_observation_space()
                .iterate(&columns.observations)
                .unwrap()
                .nth(i);
            assert_eq!(shown, Some(step.observation), "{x}: {i}");
            assert_eq!(
                columns.rewards[i].to_bits(),
                step.reward.to_bits(),
                "{x}: {i}"
            );
        }
    }
}

#[test]
fn infos_of_tables_equal_those_of_sync() {
    for id in TABLES {
        for mode in MODES {
            let kinds = [VectorKind::Native, VectorKind::Sync];
            let make = |kind| {
                builder(id)
                    .vector(5)
                    .kind(kind)
                    .autoreset(mode)
                    .build()
                    .unwrap()
            };
            let [mut native, mut sync] = kinds.map(make);
            let [mut fast, mut exact] = [native.columns().unwrap(), sync.columns().unwrap()];
            let mut actions = native.action_space().unwrap().sampler(2);
            for step in 0..200 {
                let done: Vec<bool> = (0..5).map(|i| exact.done(i)).collect();
                if step == 0 || mode == Autoreset::Disabled && done.contains(&true) {
                    let reset = if step == 0 {
                        9.into()
                    } else {
                        VectorReset::default().mask(done)
                    };
                    native.reset_into(&reset, &mut fast).unwrap();
                    sync.reset_into(&reset, &mut exact).unwrap();
                    assert_eq!(
                        native.infos(&fast),
                        sync.infos(&exact),
                        "{id}, {mode:?}: reset {step}"
                    );
                }
                let actions = actions.sample();
                native.step_into(&actions, &mut fast).unwrap();
                sync.step_into(&actions, &mut exact).unwrap();
                assert_eq!(
                    fast.observations, exact.observations,
                    "{id}, {mode:?}: step {step}"
                );
                assert_eq!(
                    native.infos(&fast),
                    sync.infos(&exact),
                    "{id}, {mode:?}: step {step}"
                );
                for i in 0..5 {
                    // the info of an episode's end is returned once
                    let [last, expected] = [&native, &sync].map(|envs| {
                        let mut last = gym::Info::new();
                        envs.final_info(i, &mut |key, value| {
                            drop(last.insert(key.to_owned(), value));
                        });
                        last
                    });
                    assert_eq!(
                        last, expected,
                        "{id}, {mode:?}: step {step}, environment {i}"
                    );
                }
            }
        }
    }
}

#[test]
fn arguments_of_tables_work() {
    for (id, arguments) in [
        (
            "FrozenLake-v1",
            json!({"is_slippery": false, "reward_schedule": [2.0, -1.0, -0.5]}),
        ),
        (
            "FrozenLake-v1",
            json!({"desc": ["SFS", "FHF", "SFG"], "success_rate": 0.5}),
        ),
        ("CliffWalking-v1", json!({"is_slippery": true})),
        (
            "Taxi-v4",
            json!({"is_rainy": true, "rainy_probability": 0.4}),
        ),
        ("Blackjack-v1", json!({"sab": false, "natural": true})),
    ] {
        for mode in MODES {
            compare(&spec(id, arguments.clone()), 33, mode, 150);
        }
    }
}

#[test]
fn arguments_of_classic_environments_work() {
    let spec = spec("CartPole-v1", json!({"sutton_barto_reward": true}));
    let mut envs = native(&spec, 100, Autoreset::NextStep).unwrap();
    let mut columns = envs.columns().unwrap();
    envs.reset_into(&0.into(), &mut columns).unwrap();
    let mut actions = envs.action_space().unwrap().sampler(0);
    let mut fell = 0;
    for _ in 0..60 {
        envs.step_into(&actions.sample(), &mut columns).unwrap();
        for i in 0..100 {
            assert_eq!(
                columns.rewards[i],
                if columns.terminated[i] { -1.0 } else { 0.0 }
            );
            fell += usize::from(columns.terminated[i]);
        }
    }
    assert!(fell > 100);
}

#[test]
fn steps_do_not_allocate() {
    for id in TABLES.iter().chain(&CLASSIC) {
        for mode in [Autoreset::NextStep, Autoreset::SameStep] {
            let spec = EnvSpec {
                max_episode_steps: Some(20),
                ..spec(id, json!({}))
            };
            let mut envs = native(&spec, 100, mode).unwrap();
            let mut columns = envs.columns().unwrap();
            envs.reset_into(&0.into(), &mut columns).unwrap();
            let mut sampler = envs.action_space().unwrap().sampler(0);
            for _ in 0..50 {
                let actions = sampler.sample();
                let count =
                    allocation_counter::measure(|| envs.step_into(&actions, &mut columns).unwrap());
                assert_eq!(count.count_total, 0, "{id}, {mode:?}");
            }
        }
    }
}

#[test]
fn a_million_cartpoles_take_66_bytes_each() {
    const N: usize = 1_000_000;
    let mut envs = native(&spec("CartPole-v1", json!({})), N, Autoreset::NextStep).unwrap();
    let mut columns = envs.columns().unwrap();
    let memory = allocation_counter::measure(|| envs.reset_into(&0.into(), &mut columns).unwrap());
    let bytes = memory.bytes_current as f64 / N as f64;
    assert!(bytes < 66.6, "{bytes} bytes for each environment");
    let actions = Value::Array(vec![1i64; N].into());
    let mut ends = 0;
    for _ in 0..12 {
        envs.step_into(&actions, &mut columns).unwrap();
        ends += (0..N).filter(|i| columns.done(*i)).count();
    }
    assert_eq!(
        ends, N,
        "a pole that is always pushed falls once within 12 steps"
    );
}

#[test]
fn limits_of_episodes_are_kept_from_the_shortest_on() {
    for limit in [1, 2, 65_534] {
        let vector = builder("Pendulum-v1")
            .max_episode_steps(limit)
            .vector(3)
            .kind(VectorKind::Native);
        let mut envs = vector.build().unwrap();
        envs.reset(0).unwrap();
        let actions = envs.action_sampler(0).unwrap().sample();
        let mut columns = envs.columns().unwrap();
        for step in 1..=limit.min(2) {
            envs.step_into(&actions, &mut columns).unwrap();
            assert_eq!(
                columns.truncated,
                [step == limit; 3],
                "limit {limit}, step {step}"
            );
        }
    }
}
