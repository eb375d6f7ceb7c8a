//! Vectors compared with sub-environments that are stepped by hand, and failures.

use gym::registry::VectorBuilder;
use gym::vector::{
    AsyncVectorEnv, Autoreset, Columns, ObservationMode, SyncVectorEnv, VectorKind, VectorReset,
};
use gym::wrappers::{ClipReward, TimeLimit};
use gym::{
    BoxEnv, Env, EnvExt, Error, Space, Value, VectorEnv, VectorEnvExt, WrapperSpec, builder,
    make_vec,
};

use super::by_hand::{ByHand, Row, rows};
use super::sample::one_per_module;
use super::vector_failures::{Fragile, actions, fragile, ints};

pub(crate) const MODES: [Autoreset; 3] = [
    Autoreset::NextStep,
    Autoreset::SameStep,
    Autoreset::Disabled,
];

/// Builds a vector of an id with short episodes, which end often.
fn short(id: &str, n: usize) -> VectorBuilder {
    builder(id).max_episode_steps(9).vector(n)
}

/// Returns one id of each module, except of the second engine, rapier, whose vectors behave in the
/// same way.
fn ids() -> Vec<String> {
    let ids = one_per_module()
        .into_iter()
        .map(|registration| registration.id().to_owned());
    ids.filter(|id| !id.starts_with("rapier/")).collect()
}

#[test]
fn a_sync_vector_is_its_environments_stepped_by_hand() {
    const N: usize = 3;
    for id in ids() {
        for autoreset in MODES {
            let mut envs = short(&id, N)
                .kind(VectorKind::Sync)
                .autoreset(autoreset)
                .build()
                .unwrap();
            let env = || builder(&id).max_episode_steps(9).build().unwrap();
            let mut hands: Vec<_> = (0..N).map(|_| ByHand::new(env())).collect();
            let mut columns = envs.columns().unwrap();
            let mut actions = envs.action_sampler(17).unwrap();
            envs.reset_into(&5.into(), &mut columns).unwrap();
            let expected: Vec<_> = hands
                .iter_mut()
                .zip(5u64..)
                .map(|(hand, seed)| hand.reset(seed))
                .collect();
            assert_eq!(rows(&envs, &columns), expected, "{id} {autoreset:?}");
            for step in 0..40 {
                let batch = actions.sample();
                envs.step_into(&batch, &mut columns).unwrap();
                let singles = envs.single_action_space().iterate(&batch).unwrap();
                let hands_and_actions = hands.iter_mut().zip(singles);
                let mut expected: Vec<_> = hands_and_actions
                    .map(|(hand, action)| hand.step(&action, autoreset))
                    .collect();
                assert_eq!(
                    rows(&envs, &columns),
                    expected,
                    "{id} {autoreset:?}, step {step}"
                );
                if autoreset == Autoreset::Disabled && hands.iter().any(|hand| hand.done) {
                    let mask: Vec<bool> = hands.iter().map(|hand| hand.done).collect();
                    envs.reset_into(&VectorReset::default().mask(mask.clone()), &mut columns)
                        .unwrap();
                    for ((hand, row), reset) in hands.iter_mut().zip(&mut expected).zip(mask) {
                        let kept = Row {
                            observation: row.observation.clone(),
                            ..Row::default()
                        };
                        *row = if reset { hand.reset(()) } else { kept };
                    }
                    assert_eq!(
                        rows(&envs, &columns),
                        expected,
                        "{id}, reset after step {step}"
                    );
                }
            }
        }
    }
}

#[test]
fn async_is_sync_for_any_number_of_threads() {
    for id in ids() {
        for (autoreset, threads) in MODES
            .into_iter()
            .flat_map(|mode| [1, 2, 5].map(|threads| (mode, threads)))
        {
            let vector = short(&id, 5).autoreset(autoreset);
            let mut sync = vector.clone().kind(VectorKind::Sync).build().unwrap();
            let mut other = vector
                .kind(VectorKind::Async)
                .threads(threads)
                .build()
                .unwrap();
            let (mut a, mut b) = (sync.columns().unwrap(), Columns::default());
            let mut actions = sync.action_sampler(3).unwrap();
            sync.reset_into(&8.into(), &mut a).unwrap();
            other.reset_into(&8.into(), &mut b).unwrap();
            for step in 0..20 {
                let what = format!("{id} {autoreset:?} on {threads} threads, step {step}");
                assert_eq!(rows(&sync, &a), rows(&other, &b), "{what}");
                assert_eq!(sync.infos(&a), other.infos(&b), "{what}");
                let done: Vec<_> = (0..5).map(|i| a.done(i)).collect();
                let partial = match autoreset {
                    Autoreset::Disabled => done.contains(&true),
                    _ => step == 12,
                };
                if partial {
                    let mask = if autoreset == Autoreset::Disabled {
                        done
                    } else {
                        vec![true, false, true, false, false]
                    };
                    let reset = VectorReset::seeds([1u64, 2, 3, 4, 5]).mask(mask);
                    sync.reset_into(&reset, &mut a).unwrap();
                    other.reset_into(&reset, &mut b).unwrap();
                } else {
                    let batch = actions.sample();
                    sync.step_into(&batch, &mut a).unwrap();
                    other.step_into(&batch, &mut b).unwrap();
                }
            }
        }
    }
}

/// Tests Gymnasium's `observation_mode="different"`.
#[test]
fn observations_may_have_other_bounds() {
    let lakes = || {
        ["4x4", "8x8"].map(|map| {
            builder("FrozenLake-v1")
                .arg("map_name", map)
                .build()
                .unwrap()
        })
    };
    let error = SyncVectorEnv::new(lakes())
        .map(drop)
        .unwrap_err()
        .to_string();
    assert!(
        error.contains("Discrete(64)") && error.contains("ObservationMode::Different"),
        "{error}"
    );
    let mode = ObservationMode::Different;
    let vectors: [Box<dyn VectorEnv>; 2] = [
        Box::new(SyncVectorEnv::with_observation_mode(lakes(), mode).unwrap()),
        Box::new(AsyncVectorEnv::with_observation_mode(lakes(), mode).unwrap()),
    ];
    for vector in vectors {
        let mut envs = ClipReward::new(vector, (None, 0.5)).unwrap();
        let space = envs.observation_space().unwrap();
        assert_eq!(space.to_string(), "MultiDiscrete([16 64])");
        assert_eq!(envs.single_observation_space(), Space::discrete(16));
        let mut columns = envs.reset(3).unwrap();
        let mut seen = 0;
        for _ in 0..200 {
            envs.step_into(&actions([1, 2]), &mut columns).unwrap();
            assert!(
                space.contains(&columns.observations),
                "{:?}",
                columns.observations
            );
            seen = seen.max(ints(&columns.observations)[1]);
        }
        assert!(seen > 16, "the larger lake's own bounds were never needed");
    }
    // spaces of different shapes are refused
    let mixed = ["Taxi-v3", "CartPole-v1"].map(|id| gym::make(id).unwrap());
    assert!(SyncVectorEnv::with_observation_mode(mixed, mode).is_err());
    let other_actions = ["FrozenLake-v1", "Taxi-v3"].map(|id| gym::make(id).unwrap());
    let error = SyncVectorEnv::with_observation_mode(other_actions, mode)
        .map(drop)
        .unwrap_err()
        .to_string();
    assert!(error.contains("action space"), "{error}");
}

#[test]
fn bad_input_is_refused() {
    for kind in [VectorKind::Sync, VectorKind::Async] {
        let mut envs = make_vec("CartPole-v1", 3, kind).unwrap();
        let mut columns = envs.columns().unwrap();
        let fresh = columns.clone();
        let error = envs
            .step_into(&actions([0, 0, 0]), &mut columns)
            .unwrap_err();
        assert!(
            matches!(&error, Error::SubEnvironment { index: 0, source } if matches!(**source, Error::ResetNeeded("step")))
        );
        for reset in [
            VectorReset::seeds([1u64, 2]),
            VectorReset::default().mask([true, false]),
            VectorReset::default().mask([false; 3]),
        ] {
            assert!(matches!(
                envs.reset_into(&reset, &mut columns),
                Err(Error::InvalidArgument { .. })
            ));
        }
        assert_eq!(columns, fresh);
        envs.reset_into(&7.into(), &mut columns).unwrap();
        let before = columns.clone();
        for batch in [
            actions([0, 0]),
            actions([0, 0, 0, 0]),
            Value::Int(0),
            Value::Null,
            Value::Array([0.0f32, 1.0, 0.0].into()),
            Value::Tuple(vec![Value::Int(0); 3]),
        ] {
            assert!(
                matches!(
                    envs.step_into(&batch, &mut columns),
                    Err(Error::NotInSpace { .. })
                ),
                "{batch}"
            );
            assert_eq!(columns, before);
        }
        let error = envs
            .step_into(&actions([0, 2, 1]), &mut columns)
            .unwrap_err();
        assert!(
            matches!(error, Error::SubEnvironment { index: 1, .. }),
            "{error}"
        );
        assert!(make_vec("CartPole-v1", 0, kind).is_err());
        assert!(builder("Nowhere-v0").vector(2).kind(kind).build().is_err());
    }
    assert!(
        builder("CartPole-v1")
            .vector(2)
            .kind(VectorKind::Async)
            .threads(0)
            .build()
            .is_err()
    );
    let mixed = ["CartPole-v1", "Taxi-v4"].map(|id| gym::make(id).unwrap());
    let error = SyncVectorEnv::new(mixed).unwrap_err().to_string();
    assert!(
        error.contains("sub-environment 1 is Discrete(500)"),
        "{error}"
    );
}

#[test]
fn a_done_environment_does_not_step_without_autoreset() {
    for kind in [VectorKind::Sync, VectorKind::Async] {
        let mut envs = builder("Pendulum-v1")
            .max_episode_steps(2)
            .vector(2)
            .kind(kind)
            .autoreset(Autoreset::Disabled)
            .build()
            .unwrap();
        let actions = envs.action_sampler(0).unwrap().sample();
        let mut columns = envs.reset(0).unwrap();
        envs.step_into(&actions, &mut columns).unwrap();
        envs.reset_into(&VectorReset::default().mask([true, false]), &mut columns)
            .unwrap();
        envs.step_into(&actions, &mut columns).unwrap();
        assert_eq!(columns.truncated, [false, true]);
        let error = envs.step_into(&actions, &mut columns).unwrap_err();
        assert!(
            matches!(error, Error::SubEnvironment { index: 1, .. }),
            "{error}"
        );
        assert_eq!(columns.truncated, [false, true], "nothing has stepped");
    }
}

#[test]
fn seeds_are_one_or_a_list() {
    let mut envs = make_vec("CartPole-v1", 3, VectorKind::Sync).unwrap();
    let from_one = envs.reset(42).unwrap();
    assert_eq!(
        envs.reset(VectorReset::seeds([42u64, 43, 44])).unwrap(),
        from_one
    );
    let hand = gym::make("CartPole-v1").unwrap().reset(44).unwrap();
    assert_eq!(
        from_one.observations.as_slice::<f32>().unwrap()[8..],
        *hand.as_slice::<f32>().unwrap()
    );
    let carried_on = envs.reset(()).unwrap();
    assert_ne!(carried_on, from_one);
}

#[test]
fn call_reaches_the_sub_environments() {
    for kind in [VectorKind::Sync, VectorKind::Async] {
        let mut envs = make_vec("CartPole-v1", 3, kind).unwrap();
        let ids = envs
            .call(|index, env: &mut BoxEnv| (index, env.spec().unwrap().id))
            .unwrap();
        assert_eq!(
            ids,
            [0, 1, 2].map(|index| (index, "CartPole-v1".to_owned()))
        );
        assert!(envs.call(|_, _: &mut Fragile| ()).is_err());
    }
    let mut sync = SyncVectorEnv::new(fragile(2)).unwrap();
    sync.reset(()).unwrap();
    sync.call(|index, env| env.steps = 5 * index as i64);
    assert_eq!(
        ints(&sync.step(&actions([0, 0])).unwrap().observations),
        [1, 6]
    );
}

#[test]
fn make_vec_says_which_kinds_there_are() {
    let error = make_vec("CarRacing-v3", 2, VectorKind::Native)
        .unwrap_err()
        .to_string();
    assert!(error.contains("sync or async"), "{error}");
    let envs = builder("CartPole-v1")
        .wrap(WrapperSpec::new("FlattenObservation"))
        .vector(2)
        .build()
        .unwrap();
    assert_eq!(envs.describe(), "SyncVectorEnv(CartPole-v1, num_envs=2)");
    assert!(
        "fast"
            .parse::<VectorKind>()
            .unwrap_err()
            .to_string()
            .contains("sync, async, native")
    );
}

#[test]
fn a_spec_makes_the_vector_again() {
    let wrapper = WrapperSpec::new("FrameStackObservation").arg("stack_size", 2);
    let env = builder("FrozenLake-v1")
        .arg("map_name", "8x8")
        .max_episode_steps(7)
        .wrap(wrapper);
    let vector = env
        .vector(4)
        .kind(VectorKind::Async)
        .autoreset(Autoreset::SameStep)
        .threads(3);
    let mut envs = vector.build().unwrap();
    let spec = envs.spec().unwrap();
    let json = serde_json::to_string(&spec).unwrap();
    let again: gym::vector::VectorSpec = serde_json::from_str(&json).unwrap();
    assert_eq!(again, spec, "{json}");
    let mut made = again.make().unwrap();
    assert_eq!(made.spec(), Some(spec));
    let mut actions = envs.action_sampler(0).unwrap();
    assert_eq!(envs.reset(3).unwrap(), made.reset(3).unwrap());
    for _ in 0..20 {
        let batch = actions.sample();
        assert_eq!(envs.step(&batch).unwrap(), made.step(&batch).unwrap());
    }
}

#[test]
fn typed_environments_and_time_limits_step_as_the_erased() {
    let config = gym::classic::cartpole::Config::default;
    let typed = || TimeLimit::new(gym::classic::CartPole::new(config()).unwrap(), 500).unwrap();
    let mut typed = SyncVectorEnv::new((0..4).map(|_| typed())).unwrap();
    let mut erased = make_vec("CartPole-v1", 4, VectorKind::Sync).unwrap();
    let mut actions = erased.action_sampler(1).unwrap();
    assert_eq!(typed.reset(0).unwrap(), erased.reset(0).unwrap());
    for _ in 0..100 {
        let batch = actions.sample();
        assert_eq!(typed.step(&batch).unwrap(), erased.step(&batch).unwrap());
    }
}

#[test]
fn columns_of_another_form_are_made_anew() {
    let mut envs = make_vec("Blackjack-v1", 3, VectorKind::Sync).unwrap();
    let expected = envs.reset(0).unwrap();
    let mut columns = make_vec("CartPole-v1", 7, VectorKind::Sync)
        .unwrap()
        .columns()
        .unwrap();
    envs.reset_into(&0.into(), &mut columns).unwrap();
    assert_eq!(columns, expected);
    assert_eq!(
        envs.observation_space()
            .unwrap()
            .check(&columns.observations)
            .map_err(|e| e.to_string()),
        Ok(())
    );
}
