//! Native vectors equal single environments that are stepped by hand, bit for bit.

use gym::classic::acrobot::AcrobotDynamics;
use gym::classic::cartpole::CartPoleDynamics;
use gym::classic::mountain_car::MountainCarDynamics;
use gym::classic::mountain_car_continuous::MountainCarContinuousDynamics;
use gym::classic::pendulum::PendulumDynamics;
use gym::vector::native::{ActionColumn, Native, NativeVectorEnv};
use gym::vector::{
    Autoreset, Columns, Seeds, VectorEnv, VectorEnvExt, VectorKind, VectorReset, VectorSpec,
};
use gym::{Array, Env, EnvExt, EnvSpec, Generator, Result, Seed, Task, Value, builder, registry};
use serde_json::{Value as Json, json};

use super::by_hand::{ByHand, rows};

const TABLES: [&str; 8] = [
    "Blackjack-v1",
    "CliffWalking-v0",
    "CliffWalking-v1",
    "CliffWalkingSlippery-v1",
    "FrozenLake-v1",
    "FrozenLake8x8-v1",
    "Taxi-v3",
    "Taxi-v4",
];
const CLASSIC: [&str; 6] = [
    "Acrobot-v1",
    "CartPole-v0",
    "CartPole-v1",
    "MountainCar-v0",
    "MountainCarContinuous-v0",
    "Pendulum-v1",
];
const MODES: [Autoreset; 3] = [
    Autoreset::NextStep,
    Autoreset::SameStep,
    Autoreset::Disabled,
];

fn spec(id: &str, arguments: impl Into<Json>) -> EnvSpec {
    let arguments = arguments.into();
    let mut spec = registry::find(id).unwrap().spec().unwrap();
    for (name, value) in arguments.as_object().unwrap() {
        spec.kwargs.insert(name.clone(), value.clone());
    }
    spec
}

fn native(spec: &EnvSpec, n: usize, autoreset: Autoreset) -> Result<Box<dyn VectorEnv>> {
    VectorSpec::new(spec.clone(), n, VectorKind::Native)
        .autoreset(autoreset)
        .make()
}

/// Returns the sub-environments of a vector.
fn by_hand(spec: &EnvSpec, n: usize) -> Vec<ByHand> {
    let env = || spec.make().unwrap();
    (0..n).map(|_| ByHand::new(env())).collect()
}

/// Returns the observations of those that a reset names.
fn starts(hands: &mut [ByHand], reset: &VectorReset) -> Vec<Option<Value>> {
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

/// Returns the number of steps to compare per environment: 200,000, or `NATIVE_STEPS`.
fn steps_to_compare() -> usize {
    std::env::var("NATIVE_STEPS")
        .ok()
        .and_then(|text| text.parse().ok())
        .unwrap_or(200_000)
}

/// Compares each step, bit by bit, with a step of the scalar dynamics from the same state.
/// `options` allow a start anywhere; episodes after an autoreset begin as usual.
fn compare_steps<D, const K: usize, const O: usize>(config: D::Config, options: [(&str, f64); 2])
where
    D: Native<Packed = [f64; K]> + Task<Observation = [f32; O]>,
{
    const N: usize = 1000;
    let dynamics = D::new(config).unwrap();
    let mut envs =
        NativeVectorEnv::new(dynamics.clone(), N, Some(150), Autoreset::NextStep).unwrap();
    let mut columns = envs.columns().unwrap();
    let mut actions = envs.action_sampler(3).unwrap();
    let mut rng = Generator::from(0);
    let (mut compared, mut ends) = (0, 0);
    for step in 0.. {
        if compared >= steps_to_compare() {
            break;
        }
        if step % 100 == 0 {
            let reset = VectorReset::from(step).option(options[0].0, options[0].1);
            envs.reset_into(&reset.option(options[1].0, options[1].1), &mut columns)
                .unwrap();
        }
        let before: Vec<D::State> = (0..N).map(|i| envs.state(i).unwrap()).collect();
        let due: Vec<bool> = (0..N).map(|i| columns.done(i)).collect();
        let batch = actions.sample();
        envs.step_into(&batch, &mut columns).unwrap();
        let items = D::Action::items(&batch, N).unwrap();
        let observations = columns
            .observations
            .as_slice::<f32>()
            .unwrap()
            .as_chunks::<O>()
            .0;
        for i in (0..N).filter(|i| !due[*i]) {
            let action = D::Action::from_item(D::Action::item(items, i));
            let one = dynamics.transition(&before[i], &action, &mut rng).unwrap();
            let place = || format!("{}: step {step} of {i}, from {:?}", D::NAME, before[i]);
            let bits = |state: &D::State| dynamics.pack(state).map(f64::to_bits);
            assert_eq!(
                bits(&envs.state(i).unwrap()),
                bits(&one.state),
                "{}",
                place()
            );
            let seen = dynamics.observe(&one.state).map(f32::to_bits);
            assert_eq!(observations[i].map(f32::to_bits), seen, "{}", place());
            assert_eq!(
                columns.rewards[i].to_bits(),
                one.reward.to_bits(),
                "{}",
                place()
            );
            assert_eq!(columns.terminated[i], one.terminated, "{}", place());
            ends += usize::from(one.terminated);
            compared += 1;
        }
    }
    println!("{}: {compared} steps, {ends} ends", D::NAME);
    assert!(
        ends > 0 || D::NAME == "Pendulum",
        "{}: no episode came to an end of its own",
        D::NAME
    );
}

#[test]
fn steps_from_anywhere_equal_those_of_scalar_environments() {
    use gym::classic::{cartpole, mountain_car, mountain_car_continuous, pendulum};
    let bounds = |low, high| [("low", low), ("high", high)];
    compare_steps::<CartPoleDynamics, 4, 4>(cartpole::Config::default(), bounds(-0.25, 0.25));
    compare_steps::<MountainCarDynamics, 2, 2>(mountain_car::Config::default(), bounds(-1.2, 0.55));
    let config = mountain_car_continuous::Config::default();
    compare_steps::<MountainCarContinuousDynamics, 3, 2>(config, bounds(-1.2, 0.55));
    compare_steps::<PendulumDynamics, 3, 3>(
        pendulum::Config::default(),
        [("x_init", 100.0), ("y_init", 8.0)],
    );
    compare_steps::<AcrobotDynamics, 4, 6>(
        gym::classic::acrobot::Config::default(),
        bounds(-3.0, 3.0),
    );
}

/// Steps from angles and positions far from any episode are equal, too.
#[test]
fn steps_from_extremes_equal_those_of_scalar_environments() {
    use gym::classic::{cartpole, mountain_car, mountain_car_continuous, pendulum};
    let bounds = [("low", -1e6), ("high", 1e6)];
    compare_steps::<CartPoleDynamics, 4, 4>(cartpole::Config::default(), bounds);
    compare_steps::<MountainCarDynamics, 2, 2>(
        mountain_car::Config {
            goal_velocity: -1.0,
            ..Default::default()
        },
        bounds,
    );
    let config = mountain_car_continuous::Config {
        goal_velocity: -1.0,
        ..Default::default()
    };
    compare_steps::<MountainCarContinuousDynamics, 3, 2>(config, bounds);
    compare_steps::<PendulumDynamics, 3, 3>(
        pendulum::Config {
            g: -3e5,
            ..Default::default()
        },
        [("x_init", 1e6), ("y_init", 1e6)],
    );
    compare_steps::<AcrobotDynamics, 4, 6>(gym::classic::acrobot::Config::default(), bounds);
}

#[test]
fn starts_equal_those_of_scalar_environments() {
    for id in CLASSIC {
        let spec = spec(id, json!({}));
        let mut envs = native(&spec, 40, Autoreset::NextStep).unwrap();
        let mut hands = by_hand(&spec, 40);
        let mut columns = envs.columns().unwrap();
        let options = if id == "Pendulum-v1" {
            ["x_init", "y_init"]
        } else {
            ["low", "high"]
        };
        let mask: Vec<bool> = (0..40).map(|i| i % 3 == 0).collect();
        for reset in [
            VectorReset::from(7),
            VectorReset::default(),
            VectorReset::seeds((0..40u64).map(|i| i * i)),
            VectorReset::default().mask(mask.clone()),
            VectorReset::from(1)
                .option(options[0], 0.01)
                .option(options[1], 0.02)
                .mask(mask),
        ] {
            envs.reset_into(&reset, &mut columns).unwrap();
            let shown = envs
                .single_observation_space()
                .iterate(&columns.observations)
                .unwrap();
            let mut shown: Vec<Value> = shown.collect();
            for (i, start) in starts(&mut hands, &reset).into_iter().enumerate() {
                if let Some(start) = start {
                    assert_eq!(shown[i], start, "{id}: {reset:?} of {i}");
                }
            }
            // environments outside of the mask keep their rows
            let left_out =
                VectorReset::default().mask((0..40).map(|i| i == 39).collect::<Vec<_>>());
            let mut other = Columns::default();
            envs.reset_into(&left_out, &mut other).unwrap();
            starts(&mut hands, &left_out);
            let again = envs
                .single_observation_space()
                .iterate(&other.observations)
                .unwrap();
            shown.truncate(39);
            assert!(again.take(39).eq(shown), "{id}");
        }
    }
}

/// Returns the columns of several steps, as bits.
fn bits<D: Native>(
    envs: &mut NativeVectorEnv<D>,
    seed: u64,
    actions: &[Value],
    row: usize,
) -> Vec<Value> {
    let mut columns = envs.reset(seed).unwrap();
    let space = envs.single_observation_space();
    let mut seen = Vec::new();
    for actions in actions {
        envs.step_into(actions, &mut columns).unwrap();
        let observation = space
            .iterate(&columns.observations)
            .unwrap()
            .nth(row)
            .unwrap();
        seen.extend([observation, Value::Float(columns.rewards[row])]);
    }
    seen
}

fn same_bits<D: Native>(dynamics: &D) {
    const N: usize = 1000;
    let vector =
        |n| NativeVectorEnv::new(dynamics.clone(), n, Some(60), Autoreset::SameStep).unwrap();
    let mut actions = vector(N).action_sampler(8).unwrap();
    let actions: Vec<Value> = (0..200).map(|_| actions.sample()).collect();
    for i in [0, 31, 32, 517, 999] {
        let many = bits(&mut vector(N), 50, &actions, i);
        assert_eq!(
            many,
            bits(&mut vector(N).baseline(), 50, &actions, i),
            "{}: without SIMD",
            D::NAME
        );
        let space = dynamics.action_space();
        let single = |batch: &Value| {
            let action = space.iterate(batch).unwrap().nth(i).unwrap();
            space.concatenate(&[action]).unwrap()
        };
        let actions: Vec<Value> = actions.iter().map(single).collect();
        let one = bits(&mut vector(1), 50 + i as u64, &actions, 0);
        assert_eq!(many, one, "{}: {i} alone", D::NAME);
    }
}

#[test]
fn bits_depend_on_neither_place_nor_cpu() {
    same_bits(&CartPoleDynamics::new(Default::default()).unwrap());
    same_bits(&MountainCarDynamics::new(Default::default()).unwrap());
    same_bits(&MountainCarContinuousDynamics::new(Default::default()).unwrap());
    same_bits(&PendulumDynamics::new(Default::default()).unwrap());
    same_bits(&AcrobotDynamics::new(Default::default()).unwrap());
    same_bits(&gym::toytext::frozen_lake::FrozenLakeDynamics::new(Default::default()).unwrap());
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
