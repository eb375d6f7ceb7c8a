//! A vector's spec makes a vector that steps identically, or the vector has no spec. A vector of
//! any requested size is made, or refused before memory runs out.

use gym::vector::{Autoreset, VectorKind, VectorReset, VectorSpec};
use gym::wrappers::*;
use gym::{Error, Info, Result, Value, VectorEnv, VectorEnvExt, WrapperSpec, builder, make_vec};
use proptest::prelude::*;
use serde_json::{Value as Json, json};

const IDS: [&str; 6] = [
    "CartPole-v1",
    "Pendulum-v1",
    "MountainCarContinuous-v0",
    "MountainCar-v0",
    "Blackjack-v1",
    "Taxi-v4",
];

/// Wraps a vector in the wrapper number `which`, if the wrapper supports the vector.
fn wrap(envs: Box<dyn VectorEnv>, which: u32, x: f64) -> Result<Box<dyn VectorEnv>> {
    Ok(match which {
        0 => Box::new(RecordEpisodeStatistics::with_config(
            envs,
            record_episode_statistics::Config {
                buffer_length: 3,
                stats_key: "stats".into(),
            },
        )?),
        1 => Box::new(NormalizeObservation::new(
            envs,
            normalize_observation::Config {
                epsilon: x,
                ..Default::default()
            },
        )?),
        2 => Box::new(NormalizeReward::new(
            envs,
            normalize_reward::Config {
                gamma: x.min(1.0),
                epsilon: 1e-3,
                ..Default::default()
            },
        )?),
        3 => Box::new(ClipAction::new(envs, clip_action::Config::default())?),
        4 => Box::new(ClipReward::new(envs, (-x, f64::INFINITY))?),
        5 => Box::new(RescaleAction::new(envs, (-x, x))?),
        6 => Box::new(RescaleAction::new(envs, ([-x], [3.0 * x]))?),
        7 => Box::new(RescaleObservation::new(envs, (-1.0, x))?),
        8 => Box::new(RescaleObservation::new(
            envs,
            ([-1.0f32, -0.1], [x as f32, 0.3]),
        )?),
        9 => {
            let mut envs =
                NormalizeObservation::new(envs, normalize_observation::Config::default())?;
            envs.update_running_mean(false);
            Box::new(envs)
        }
        10 => Box::new(TransformReward::new(envs, move |reward| reward * x)),
        _ => Box::new(TransformObservation::new(envs, Value::clone, None)),
    })
}

/// Returns the environment wrapper number `which`; not all support every environment.
fn env_wrapper(which: u32, x: f64) -> WrapperSpec {
    let wrapper = |name: &str, kwargs: Json| {
        serde_json::from_value::<WrapperSpec>(json!({"name": name, "kwargs": kwargs})).unwrap()
    };
    match which {
        0 => wrapper("ClipReward", json!({"max_reward": x})),
        1 => wrapper("NormalizeReward", json!({"gamma": 0.5})),
        2 => wrapper("FrameStackObservation", json!({"stack_size": 2})),
        3 => wrapper("TimeAwareObservation", json!({})),
        4 => wrapper("RecordEpisodeStatistics", json!({})),
        5 => wrapper("StickyAction", json!({"repeat_action_probability": 0.25})),
        _ => wrapper("TimeLimit", json!({"max_episode_steps": 4})),
    }
}

/// Observations, rewards, flags and infos of a step.
type Seen = (Value, Vec<f64>, Vec<bool>, Vec<bool>, Info);

/// Returns the results of several steps and resets by mask, without wall-clock times.
fn play(envs: &mut dyn VectorEnv, steps: usize) -> Vec<Seen> {
    let mut columns = envs.columns().unwrap();
    let mut actions = envs.action_space().unwrap().sampler(5);
    let mut history = Vec::new();
    envs.reset_into(&9.into(), &mut columns).unwrap();
    for step in 0..steps {
        let ended: Vec<bool> = (0..columns.len()).map(|i| columns.done(i)).collect();
        if envs.autoreset() == Autoreset::Disabled && ended.contains(&true) {
            envs.reset_into(&VectorReset::default().mask(ended), &mut columns)
                .unwrap();
        } else if step % 5 == 4 {
            let mask: Vec<bool> = (0..columns.len()).map(|i| i == 0).collect();
            envs.reset_into(&VectorReset::default().mask(mask), &mut columns)
                .unwrap();
        } else {
            envs.step_into(&actions.sample(), &mut columns).unwrap();
        }
        let mut infos = envs.infos(&columns);
        remove_clock(&mut infos);
        let gym::vector::Columns {
            observations,
            rewards,
            terminated,
            truncated,
            ..
        } = columns.clone();
        history.push((observations, rewards, terminated, truncated, infos));
    }
    history
}

fn remove_clock(infos: &mut Info) {
    fn clean(value: &mut Value) {
        if let Value::Dict(entries) = value {
            entries.retain(|(key, _)| key != "t");
            entries.iter_mut().for_each(|(_, value)| clean(value));
        }
    }
    infos.values_mut().for_each(clean);
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 150, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn a_spec_rebuilds_its_vector_or_is_none(
        id in prop::sample::select(&IDS[..]),
        kind in prop::sample::select(vec![None, Some(VectorKind::Sync), Some(VectorKind::Async)]),
        autoreset in prop::sample::select(vec![Autoreset::NextStep, Autoreset::SameStep, Autoreset::Disabled]),
        within in prop::collection::vec((0u32..7, 0.1f64..3.0), 0..3),
        around in prop::collection::vec((0u32..12, 0.1f64..3.0), 0..5),
        limit in prop::option::of(3u32..100_000),
    ) {
        let mut env = builder(id);
        if let Some(limit) = limit {
            env = env.max_episode_steps(limit);
        }
        for (which, x) in within {
            let wrapped = env.clone().wrap(env_wrapper(which, x));
            if wrapped.clone().build().is_ok() {
                env = wrapped;
            }
        }
        let mut vector = env.vector(3).autoreset(autoreset);
        if let Some(kind) = kind {
            vector = vector.kind(kind);
        }
        let mut envs = vector.build().unwrap();
        let (mut count, mut functions) = (0, false);
        for (which, x) in around {
            // a wrapper that refuses a vector drops the vector
            let again = |envs: &dyn VectorEnv| envs.spec().map(|spec| spec.make().unwrap());
            if functions { break }
            let other = again(&*envs).unwrap();
            if let Ok(wrapped) = wrap(other, which, x) {
                envs = wrapped;
                count += 1;
                functions = which >= 10;
            }
        }
        let spec = envs.spec();
        prop_assert_eq!(spec.is_none(), functions);
        if let Some(spec) = spec {
            prop_assert_eq!(spec.vector_wrappers.len(), count);
            let json = serde_json::to_string(&spec).unwrap();
            let read: VectorSpec = serde_json::from_str(&json).unwrap();
            prop_assert_eq!(&read, &spec);
            let mut rebuilt = read.make().unwrap();
            prop_assert_eq!(rebuilt.spec(), Some(spec));
            prop_assert_eq!(rebuilt.describe(), envs.describe());
            prop_assert_eq!(rebuilt.single_observation_space(), envs.single_observation_space());
            prop_assert_eq!(rebuilt.single_action_space(), envs.single_action_space());
            prop_assert_eq!(play(&mut *rebuilt, 25), play(&mut *envs, 25), "{}", json);
        }
    }
}

/// Gymnasium's dict of columns does not depend on the order of wrappers.
#[test]
fn infos_do_not_depend_on_the_order_of_wrappers() {
    for autoreset in [
        Autoreset::NextStep,
        Autoreset::SameStep,
        Autoreset::Disabled,
    ] {
        let make = |wrappers: &[&str]| {
            let spec = builder("Pendulum-v1")
                .max_episode_steps(4)
                .vector(3)
                .autoreset(autoreset)
                .spec()
                .unwrap();
            let wrapped = wrappers.iter().fold(spec, |spec, name| {
                let bounds = *name == "RescaleObservation";
                let wrapper = WrapperSpec::new(name);
                spec.wrapped(if bounds {
                    wrapper.arg("min_obs", -1.0).arg("max_obs", 1.0)
                } else {
                    wrapper
                })
            });
            wrapped.make().unwrap()
        };
        let others = [
            "NormalizeObservation",
            "RescaleObservation",
            "NormalizeReward",
            "ClipAction",
        ];
        for other in others {
            let answers = [
                ["RecordEpisodeStatistics", other],
                [other, "RecordEpisodeStatistics"],
            ]
            .map(|wrappers| play(&mut *make(&wrappers), 20));
            let mut seen = 0;
            for (inside, outside) in answers[0].iter().zip(&answers[1]) {
                let form = |infos: &Info| {
                    infos
                        .iter()
                        .map(|(key, value)| (key.clone(), form(value)))
                        .collect::<Vec<_>>()
                };
                assert_eq!(form(&inside.4), form(&outside.4), "{other}, {autoreset:?}");
                seen += usize::from(inside.4.contains_key("episode"));
            }
            assert!(seen >= 3, "{other}, {autoreset:?}: {seen}");
        }
    }
    /// Returns the keys and types, without the numbers.
    fn form(value: &Value) -> String {
        match value {
            Value::Array(array) => format!("{} {:?}", array.dtype(), array.shape()),
            Value::Dict(entries) => {
                let entries = entries
                    .iter()
                    .map(|(key, value)| format!("{key}: {}", form(value)));
                entries.collect::<Vec<_>>().join(", ")
            }
            Value::Tuple(items) if items.iter().any(|item| matches!(item, Value::Bool(_))) => {
                value.to_string()
            }
            Value::Tuple(items) => items.iter().map(form).collect::<Vec<_>>().join("; "),
            other => other.to_string(),
        }
    }
}

/// A reset by mask keeps the other rows, under every wrapper.
#[test]
fn a_reset_by_mask_leaves_the_other_rows() {
    for wrapper in [
        "NormalizeObservation",
        "NormalizeReward",
        "RecordEpisodeStatistics",
        "ClipAction",
    ] {
        let spec = builder("Pendulum-v1")
            .vector(3)
            .spec()
            .unwrap()
            .wrapped(WrapperSpec::new(wrapper));
        let mut envs = spec.make().unwrap();
        let mut actions = envs.action_sampler(0).unwrap();
        let mut columns = envs.reset(0).unwrap();
        for _ in 0..3 {
            envs.step_into(&actions.sample(), &mut columns).unwrap();
        }
        let rows = |columns: &gym::vector::Columns| {
            columns.observations.as_slice::<f32>().unwrap()[3..].to_vec()
        };
        let before = rows(&columns);
        for _ in 0..2 {
            // the same with columns that did not contain the rows before
            let mut columns = gym::vector::Columns::default();
            envs.reset_into(
                &VectorReset::default().mask([true, false, false]),
                &mut columns,
            )
            .unwrap();
            assert_eq!(rows(&columns), before, "{wrapper}");
        }
    }
}

/// An autoreset does not count as a step, even if a reset by mask excluded the environment that is
/// due for a reset.
#[test]
fn a_due_reset_is_not_counted_as_a_step() {
    for kind in [VectorKind::Sync, VectorKind::Async, VectorKind::Native] {
        let vector = builder("CartPole-v1")
            .max_episode_steps(2)
            .vector(2)
            .kind(kind)
            .build()
            .unwrap();
        let mut envs = RecordEpisodeStatistics::new(vector);
        let actions = Value::Array([0i64, 1].into());
        let mut columns = envs.reset(0).unwrap();
        envs.step_into(&actions, &mut columns).unwrap();
        envs.step_into(&actions, &mut columns).unwrap();
        assert_eq!(columns.truncated, [true, true]);
        envs.reset_into(&VectorReset::default().mask([true, false]), &mut columns)
            .unwrap();
        let mut lengths = Vec::new();
        for _ in 0..3 {
            envs.step_into(&actions, &mut columns).unwrap();
            lengths.push([0, 1].map(|index| envs.ended(index).map(|episode| episode.length)));
        }
        assert_eq!(
            lengths,
            [[None, None], [Some(2), None], [None, Some(2)]],
            "{kind}"
        );
    }
}

/// The default kind works.
#[test]
fn without_a_kind_the_vector_is_one_that_works() {
    let native = |envs: Result<Box<dyn VectorEnv>>| envs.unwrap().describe().starts_with("Native");
    assert!(native(builder("CartPole-v1").vector(2).build()));
    assert!(native(
        builder("CartPole-v1")
            .max_episode_steps(65_534)
            .vector(2)
            .build()
    ));
    assert!(native(
        builder("LunarLander-v3")
            .arg("enable_wind", true)
            .max_episode_steps(None)
            .vector(2)
            .build()
    ));
    for vector in [
        builder("CartPole-v1").max_episode_steps(100_000).vector(2),
        builder("Taxi-v4").arg("fickle_passenger", true).vector(2),
        builder("FrozenLake-v1")
            .arg("map_name", Json::Null)
            .vector(2),
        builder("CartPole-v1")
            .render_mode(gym::render::RenderMode::RgbArray)
            .vector(2),
        builder("CartPole-v1")
            .wrap(WrapperSpec::new("FlattenObservation"))
            .vector(2),
        builder("CarRacing-v3").vector(2),
    ] {
        let spec = vector.clone().spec().unwrap();
        assert_eq!(spec.vectorization_mode, VectorKind::Sync);
        let mut envs = vector.clone().build().unwrap();
        assert_eq!(envs.spec(), Some(spec));
        envs.reset(0).unwrap();
        assert!(vector.kind(VectorKind::Native).build().is_err());
    }
    // a request that no kind supports is refused with its reason
    let error = builder("CartPole-v1")
        .arg("colour", 1)
        .vector(2)
        .build()
        .unwrap_err()
        .to_string();
    assert!(error.contains("sutton_barto_reward"), "{error}");
    assert!(
        builder("CartPole-v1")
            .max_episode_steps(0)
            .vector(2)
            .build()
            .is_err()
    );
    assert!(make_vec("Nowhere-v0", 2, None).is_err());
}

#[test]
fn a_number_that_cannot_be_is_refused_at_once() {
    for id in [
        "CartPole-v1",
        "Taxi-v4",
        "Blackjack-v1",
        "CarRacing-v3",
        "Pendulum-v1",
    ] {
        for kind in [
            None,
            Some(VectorKind::Sync),
            Some(VectorKind::Async),
            Some(VectorKind::Native),
        ] {
            for n in [0, 1 << 33, 1 << 40, 1 << 60, usize::MAX / 2, usize::MAX] {
                let error = make_vec(id, n, kind).map(drop).unwrap_err();
                assert!(
                    matches!(error, Error::InvalidArgument { .. }),
                    "{id} {kind:?} {n}: {error}"
                );
                let text = error.to_string();
                let says = ["at least one", "at most", "does not fit", "there is none"];
                assert!(
                    says.iter().any(|says| text.contains(says)),
                    "{id} {kind:?} {n}: {text}"
                );
            }
        }
        let space = gym::make(id)
            .map(|env| gym::Env::observation_space(&env))
            .unwrap();
        assert!(space.batch(1 << 40).is_err() && space.batch(usize::MAX).is_err());
        assert!(gym::vector::Columns::new(&space, 1 << 40).is_err());
        assert!(gym::vector::Columns::new(&space, usize::MAX).is_err());
    }
    for threads in [0, 1025, 20_000, usize::MAX] {
        let vector = builder("CartPole-v1")
            .vector(20_000)
            .kind(VectorKind::Async)
            .threads(threads);
        let error = vector.build().map(drop).unwrap_err().to_string();
        assert!(error.contains("from 1 to 1024"), "{error}");
    }
}

/// Sync and native vectors accept the same dtypes of actions, and refuse others with the same
/// message.
#[test]
fn every_kind_takes_the_same_forms_of_actions() {
    let narrow = gym::Array::new([2], gym::Data::I32(vec![1, 0])).unwrap();
    let f64s = gym::Array::from([0.5f64, -0.5]).reshape([2, 1]).unwrap();
    let ints = gym::Array::from([1i8, -1]).reshape([2, 1]).unwrap();
    let flags = gym::Array::from([0u8, 1]);
    for id in [
        "CartPole-v1",
        "Pendulum-v1",
        "Taxi-v4",
        "Blackjack-v1",
        "MountainCarContinuous-v0",
    ] {
        for actions in [
            Value::Array(narrow.clone()),
            Value::Array(f64s.clone()),
            Value::Array(ints.clone()),
            Value::Array(flags.clone()),
            Value::Array([1i64].into()),
            Value::Array([1.0f32, 0.0].into()),
            Value::Tuple(vec![Value::Int(0); 2]),
            Value::Null,
        ] {
            let answers = [VectorKind::Sync, VectorKind::Native].map(|kind| {
                let mut envs = make_vec(id, 2, kind).unwrap();
                let mut columns = envs.reset(0).unwrap();
                // two steps, because the second step reuses the buffer of the cast
                let first = envs.step_into(&actions, &mut columns);
                first
                    .and_then(|()| envs.step_into(&actions, &mut columns))
                    .map_err(|error| error.to_string())
            });
            assert_eq!(answers[0], answers[1], "{id}: {actions}");
        }
    }
}

#[test]
fn a_smaller_buffer_keeps_the_last_episodes() {
    let vector = || {
        builder("CartPole-v1")
            .max_episode_steps(2)
            .vector(2)
            .build()
            .unwrap()
    };
    let mut envs = RecordEpisodeStatistics::new(vector());
    let actions = Value::Array([0i64, 1].into());
    let mut columns = envs.reset(0).unwrap();
    for _ in 0..30 {
        envs.step_into(&actions, &mut columns).unwrap();
    }
    assert_eq!((envs.episode_count(), envs.episodes().len()), (20, 20));
    // without seconds, which a snapshot does not contain
    let told = |episode: &EpisodeStatistics| (episode.episode_return, episode.length);
    let last: Vec<_> = envs.episodes().skip(15).map(told).collect();
    let config = record_episode_statistics::Config {
        buffer_length: 5,
        ..Default::default()
    };
    let mut smaller = RecordEpisodeStatistics::with_config(vector(), config).unwrap();
    VectorEnv::restore(&mut smaller, &VectorEnv::snapshot(&envs).unwrap()).unwrap();
    assert!(smaller.episodes().map(told).eq(last));
    for _ in 0..30 {
        smaller.step_into(&actions, &mut columns).unwrap();
    }
    assert_eq!((smaller.episode_count(), smaller.episodes().len()), (40, 5));
}
