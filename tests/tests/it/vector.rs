//! Vectors compared with sub-environments that are stepped by hand, and failures.

use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};

use gym::registry::VectorBuilder;
use gym::vector::{
    AsyncVectorEnv, Autoreset, Columns, ObservationMode, SyncVectorEnv, VectorKind, VectorReset,
};
use gym::wrappers::{ClipReward, TimeLimit};
use gym::{
    BoxEnv, Env, EnvExt, Error, Outcome, Reset, Result, Snapshot, Space, Value, VectorEnv,
    VectorEnvExt, WrapperSpec, builder, make_vec, registry,
};

use super::by_hand::{ByHand, Row, rows};

const MODES: [Autoreset; 3] = [
    Autoreset::NextStep,
    Autoreset::SameStep,
    Autoreset::Disabled,
];

/// Builds a vector of an id with short episodes, which end often.
fn short(id: &str, n: usize) -> VectorBuilder {
    builder(id).max_episode_steps(9).vector(n)
}

/// Returns every id except the ids of the second engine, rapier, whose vectors behave in the same
/// way.
fn ids() -> Vec<String> {
    let ids = registry::self_contained()
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

/// An environment that counts its steps. Action 1 is an error, action 2 panics, and action 3 takes
/// long. An episode ends at the 10th step.
#[derive(Clone, Debug, Default)]
struct Fragile {
    steps: i64,
    /// The number of times that action 3 was taken, including by clones.
    slept: Arc<AtomicUsize>,
}

impl Env for Fragile {
    type Observation = i64;
    type Action = u8;

    fn observation_space(&self) -> Space {
        Space::discrete(1000)
    }

    fn action_space(&self) -> Space {
        Space::discrete(4)
    }

    fn reset_into(&mut self, reset: &Reset, observation: &mut i64) -> Result<()> {
        if reset.options.contains_key("panic") {
            panic!("a bad reset");
        }
        (self.steps, *observation) = (0, 0);
        Ok(())
    }

    fn step_into(&mut self, action: &u8, observation: &mut i64) -> Result<Outcome> {
        match action {
            1 => return Err(Error::custom("not now")),
            2 => panic!("a bad step"),
            3 => {
                std::thread::sleep(std::time::Duration::from_millis(30));
                self.slept.fetch_add(1, Ordering::Relaxed);
            }
            _ => {}
        }
        self.steps += 1;
        *observation = self.steps;
        Ok(Outcome {
            reward: 1.0,
            terminated: self.steps == 10,
            truncated: false,
        })
    }

    fn snapshot(&self) -> Result<Snapshot> {
        Snapshot::of(&self.steps)
    }

    fn restore(&mut self, snapshot: &Snapshot) -> Result<()> {
        snapshot.get().map(|steps| self.steps = steps)
    }
}

fn fragile(n: usize) -> Vec<Fragile> {
    vec![Fragile::default(); n]
}

fn both(n: usize) -> [Box<dyn VectorEnv>; 2] {
    [
        Box::new(SyncVectorEnv::new(fragile(n)).unwrap()),
        Box::new(
            AsyncVectorEnv::new(fragile(n))
                .and_then(|pool| pool.with_threads(2))
                .unwrap(),
        ),
    ]
}

fn actions<const N: usize>(actions: [i64; N]) -> Value {
    Value::Array(actions.into())
}

fn ints(value: &Value) -> &[i64] {
    value.as_slice().unwrap()
}

#[test]
fn an_error_names_the_sub_environment_and_the_others_step() {
    for mut envs in both(3) {
        let mut columns = envs.reset(()).unwrap();
        envs.step_into(&actions([0, 0, 0]), &mut columns).unwrap();
        let error = envs
            .step_into(&actions([0, 1, 0]), &mut columns)
            .unwrap_err();
        assert_eq!(error.to_string(), "sub-environment 1: not now", "{envs:?}");
        assert_eq!(ints(&columns.observations), [2, 1, 2]);
        assert_eq!(columns.rewards, [1.0, 0.0, 1.0]);
        envs.step_into(&actions([0, 0, 0]), &mut columns).unwrap();
        assert_eq!(ints(&columns.observations), [3, 2, 3]);
    }
}

#[test]
fn a_panic_names_the_sub_environment_which_must_then_be_reset() {
    for mut envs in both(3) {
        let mut columns = envs.reset(()).unwrap();
        let error = envs
            .step_into(&actions([0, 0, 2]), &mut columns)
            .unwrap_err()
            .to_string();
        assert!(
            error.starts_with("sub-environment 2:") && error.contains("a bad step"),
            "{error}"
        );
        assert_eq!(ints(&columns.observations), [1, 1, 0]);
        let error = envs
            .step_into(&actions([0, 0, 0]), &mut columns)
            .unwrap_err()
            .to_string();
        assert!(
            error.starts_with("sub-environment 2:") && error.contains("reset"),
            "{error}"
        );
        assert_eq!(
            ints(&columns.observations),
            [1, 1, 0],
            "nothing has stepped"
        );
        envs.reset_into(
            &VectorReset::default().mask([false, false, true]),
            &mut columns,
        )
        .unwrap();
        envs.step_into(&actions([0, 0, 0]), &mut columns).unwrap();
        assert_eq!(ints(&columns.observations), [2, 2, 1]);
        let reset = VectorReset::default()
            .option("panic", true)
            .mask([true, false, false]);
        let error = envs
            .reset_into(&reset, &mut columns)
            .unwrap_err()
            .to_string();
        assert!(
            error.starts_with("sub-environment 0:") && error.contains("a bad reset"),
            "{error}"
        );
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
fn the_first_ready_are_received_and_the_slow_come_later() {
    let mut envs = AsyncVectorEnv::new(fragile(4))
        .and_then(|pool| pool.with_threads(2))
        .unwrap();
    let mut columns = envs.reset(()).unwrap();
    let mut ids = Vec::new();
    envs.send(&actions([3, 0, 0, 0]), &[2, 0, 1, 3]).unwrap();
    assert_eq!(envs.num_pending(), 4);
    envs.recv_into(3, &mut ids, &mut columns).unwrap();
    ids.sort_unstable();
    assert_eq!(
        (ids.as_slice(), ints(&columns.observations)),
        (&[0, 1, 3][..], &[1, 1, 1][..])
    );
    assert_eq!(columns.len(), 3);
    // a pending sub-environment can neither be sent to again nor stepped with the others
    let error = envs.send(&actions([0]), &[2]).unwrap_err().to_string();
    assert_eq!(
        error,
        "sub-environment 2: it is still pending: receive it first"
    );
    for error in [
        envs.step_into(&actions([0; 4]), &mut columns).unwrap_err(),
        envs.reset_into(&().into(), &mut columns).unwrap_err(),
        envs.call(|_, env| env.steps).unwrap_err(),
    ] {
        assert_eq!(
            error.to_string(),
            "1 sub-environments are pending: receive them first"
        );
    }
    envs.send(&actions([0]), &[3]).unwrap();
    for m in [0, 3] {
        assert!(matches!(
            envs.recv_into(m, &mut ids, &mut columns),
            Err(Error::InvalidArgument { .. })
        ));
    }
    envs.recv_into(2, &mut ids, &mut columns).unwrap();
    envs.step_into(&actions([0; 4]), &mut columns).unwrap();
    assert_eq!(ints(&columns.observations), [2, 2, 2, 3]);
    for (ids, batch) in [
        (&[4][..], &actions([0])),
        (&[1, 1], &actions([0, 0])),
        (&[1], &actions([0, 0])),
    ] {
        assert!(envs.send(batch, ids).is_err(), "{ids:?}");
        assert_eq!(envs.num_pending(), 0);
    }
}

#[test]
fn a_failed_step_is_received_alone() {
    let mut envs = AsyncVectorEnv::new(fragile(3))
        .and_then(|pool| pool.with_threads(3))
        .unwrap();
    let mut columns = envs.reset(()).unwrap();
    let mut ids = Vec::new();
    envs.send(&actions([0, 1, 0]), &[0, 1, 2]).unwrap();
    let error = envs
        .recv_into(3, &mut ids, &mut columns)
        .unwrap_err()
        .to_string();
    assert_eq!(error, "sub-environment 1: not now");
    assert_eq!(envs.num_pending(), 2);
    envs.recv_into(2, &mut ids, &mut columns).unwrap();
    assert_eq!(ints(&columns.observations), [1, 1]);
    envs.step_into(&actions([0, 0, 0]), &mut columns).unwrap();
    assert_eq!(ints(&columns.observations), [2, 1, 2]);
}

#[test]
fn drop_and_close_in_mid_flight_do_not_hang() {
    for close in [false, true] {
        // clones share the counter
        let fragile = fragile(64);
        let slept = Arc::clone(&fragile[0].slept);
        let mut envs = AsyncVectorEnv::new(fragile)
            .and_then(|pool| pool.with_threads(2))
            .unwrap();
        envs.reset(()).unwrap();
        envs.send(
            &Value::Array(vec![3i64; 64].into()),
            &(0..64).collect::<Vec<_>>(),
        )
        .unwrap();
        if close {
            envs.close();
            assert!(matches!(
                envs.step(&Value::Array(vec![0i64; 64].into())),
                Err(Error::SubEnvironment { index: 0, source }) if matches!(*source, Error::Closed("step"))
            ));
        } else {
            let slept = Arc::clone(&slept);
            drop(envs);
            // two steps of 30 ms are running; the others are dropped
            assert!(slept.load(Ordering::Relaxed) < 64);
        }
    }
}

#[test]
fn results_of_envs_received_out_of_order_do_not_depend_on_it() {
    let env = || (0..6).map(|_| builder("CartPole-v1").build().unwrap());
    let mut sync = SyncVectorEnv::new(env()).unwrap();
    let mut pool = AsyncVectorEnv::new(env())
        .and_then(|pool| pool.with_threads(3))
        .unwrap();
    let (mut a, mut b) = (sync.reset(1).unwrap(), pool.reset(1).unwrap());
    let mut observed = vec![Vec::new(); 6];
    let mut taken = [0; 6];
    let mut ids = vec![0, 1, 2, 3, 4, 5];
    let action = |id: usize, step: usize| ((id * 7 + step * 3) % 4 / 2) as i64;
    while taken.iter().any(|steps| *steps < 60) {
        let batch: Vec<i64> = ids.iter().map(|id| action(*id, taken[*id])).collect();
        ids.iter().for_each(|id| taken[*id] += 1);
        pool.send(&Value::Array(batch.into()), &ids).unwrap();
        pool.recv_into(2, &mut ids, &mut b).unwrap();
        for (row, id) in ids.iter().enumerate() {
            observed[*id]
                .push(b.observations.as_slice::<f32>().unwrap()[4 * row..4 * row + 4].to_vec());
        }
    }
    for step in 0..60 {
        let batch: Vec<i64> = (0..6).map(|id| action(id, step)).collect();
        sync.step_into(&Value::Array(batch.into()), &mut a).unwrap();
        for (id, observed) in observed.iter().enumerate() {
            if let Some(observed) = observed.get(step) {
                assert_eq!(
                    &a.observations.as_slice::<f32>().unwrap()[4 * id..4 * id + 4],
                    observed
                );
            }
        }
    }
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

/// An environment whose episodes end with the second step; only its first reset succeeds.
#[derive(Clone, Debug, Default)]
struct Once {
    steps: i64,
    resets: i64,
}

impl Env for Once {
    type Observation = i64;
    type Action = u8;

    fn observation_space(&self) -> Space {
        Space::discrete(10)
    }

    fn action_space(&self) -> Space {
        Space::discrete(2)
    }

    fn reset_into(&mut self, _: &Reset, observation: &mut i64) -> Result<()> {
        if self.resets > 0 {
            return Err(Error::custom("not again"));
        }
        (self.steps, self.resets, *observation) = (0, 1, 0);
        Ok(())
    }

    fn step_into(&mut self, _: &u8, observation: &mut i64) -> Result<Outcome> {
        self.steps += 1;
        *observation = self.steps;
        Ok(Outcome {
            reward: 1.0,
            terminated: self.steps == 2,
            truncated: false,
        })
    }

    fn info(&self, visit: &mut dyn FnMut(&str, Value)) {
        visit("steps", Value::Int(self.steps));
    }

    fn snapshot(&self) -> Result<Snapshot> {
        Snapshot::of(&self.steps)
    }

    fn restore(&mut self, snapshot: &Snapshot) -> Result<()> {
        snapshot.get().map(|steps| self.steps = steps)
    }
}

/// If the reset after an episode's last step fails, the sub-environment returns no reward, flag or
/// info.
#[test]
fn a_sub_environment_that_fails_to_reset_answers_nothing() {
    let envs = || vec![Once::default(); 2];
    let vectors: [Box<dyn VectorEnv>; 2] = [
        Box::new(
            SyncVectorEnv::new(envs())
                .unwrap()
                .with_autoreset(Autoreset::SameStep),
        ),
        Box::new(
            AsyncVectorEnv::new(envs())
                .unwrap()
                .with_autoreset(Autoreset::SameStep),
        ),
    ];
    for mut envs in vectors {
        let mut columns = envs.reset(()).unwrap();
        envs.step_into(&actions([0, 0]), &mut columns).unwrap();
        let error = envs
            .step_into(&actions([0, 0]), &mut columns)
            .unwrap_err()
            .to_string();
        assert_eq!(error, "sub-environment 0: not again");
        let shown = (
            columns.rewards[0],
            columns.terminated[0],
            columns.has_final[0],
            columns.progress[0],
        );
        assert_eq!(shown, (0.0, false, false, gym::vector::Progress::Unchanged));
        assert!(envs.info_map(0).is_empty());
    }
}
