//! Any order of calls gives the same results with every kind of vector: no call depends on
//! leftovers of earlier calls.

use gym::vector::{
    AsyncVectorEnv, Autoreset, Columns, Progress, Seeds, SyncVectorEnv, VectorEnv, VectorEnvExt,
    VectorKind, VectorReset, VectorSpec,
};
use gym::{Env, EnvSpec, Generator, Outcome, Reset, Result, Snapshot, Space, Value, registry};
use serde_json::{Value as Json, json};

const MODES: [Autoreset; 3] = [
    Autoreset::NextStep,
    Autoreset::SameStep,
    Autoreset::Disabled,
];

/// Returns specs with short episodes, which end often, also by a limit.
fn specs() -> Vec<EnvSpec> {
    [
        "CartPole-v1",
        "Pendulum-v1",
        "FrozenLake-v1",
        "Taxi-v4",
        "Blackjack-v1",
    ]
    .into_iter()
    .map(|id| {
        let spec = registry::find(id).unwrap().spec().unwrap();
        EnvSpec {
            max_episode_steps: Some(7),
            ..spec
        }
    })
    .collect()
}

/// Everything that a caller sees of one sub-environment.
#[derive(Debug, PartialEq)]
struct Row {
    observation: Value,
    outcome: (f64, bool, bool),
    progress: Progress,
    last: Option<(Value, Vec<(String, Value)>)>,
    info: Vec<(String, Value)>,
}

fn infos(visit: impl FnOnce(&mut dyn FnMut(&str, Value))) -> Vec<(String, Value)> {
    let mut entries = Vec::new();
    visit(&mut |key, value| entries.push((key.to_owned(), value)));
    entries.sort_by(|a, b| a.0.cmp(&b.0));
    entries
}

fn rows(envs: &dyn VectorEnv, columns: &Columns) -> Vec<Row> {
    let space = envs.single_observation_space();
    let observations = space.iterate(&columns.observations).unwrap();
    let finals: Vec<_> = space
        .iterate(&columns.final_observations)
        .unwrap()
        .collect();
    let row = |(i, observation)| {
        let last = infos(|visit| envs.final_info(i, visit));
        // without a final observation there is no final info either
        assert!(
            columns.has_final[i] || last.is_empty(),
            "{envs:?}: {last:?}",
            envs = envs.describe()
        );
        Row {
            observation,
            outcome: (
                columns.rewards[i],
                columns.terminated[i],
                columns.truncated[i],
            ),
            progress: columns.progress[i],
            last: columns.has_final[i].then(|| (finals[i].clone(), last)),
            info: infos(|visit| envs.info(i, visit)),
        }
    };
    observations.enumerate().map(row).collect()
}

/// A call; all kinds of vectors receive the same calls.
#[derive(Clone, Debug)]
enum Call {
    Reset(VectorReset),
    Step(u64),
    /// Takes a snapshot.
    Store,
    /// Restores the snapshot, in the used vector or in a new one.
    Restore {
        new: bool,
    },
}

fn calls(n: usize, seed: u64) -> Vec<Call> {
    let mut rng = Generator::from(seed);
    let mut calls = vec![Call::Reset(seed.into()), Call::Store];
    for _ in 0..120 {
        let seed = rng.integers(0, 1000) as u64;
        let mut mask: Vec<bool> = (0..n).map(|_| rng.integers(0, 3) == 0).collect();
        mask[rng.integers(0, n as i64) as usize] = true;
        calls.push(match rng.integers(0, 16) {
            0 => Call::Reset(seed.into()),
            1 => Call::Reset(().into()),
            2 | 3 => Call::Reset(VectorReset::default().mask(mask)),
            4 => {
                let seeds = mask
                    .iter()
                    .map(|selected| selected.then(|| seed.into()))
                    .collect();
                Call::Reset(
                    VectorReset {
                        seeds: Seeds::Each(seeds),
                        ..VectorReset::default()
                    }
                    .mask(mask),
                )
            }
            5 => Call::Store,
            6 => Call::Restore { new: false },
            7 => Call::Restore { new: true },
            _ => Call::Step(seed),
        });
    }
    calls
}

/// Returns the results of each call; after a refused step, ended sub-environments are reset.
fn answers(spec: &VectorSpec, calls: &[Call]) -> Vec<std::result::Result<Vec<Row>, String>> {
    let mut envs = spec.make().unwrap();
    let mut columns = envs.columns().unwrap();
    let mut stored = None;
    let mut over = vec![false; spec.num_envs];
    let mut answers = Vec::new();
    for call in calls {
        let result = match call {
            Call::Reset(reset) => envs.reset_into(reset, &mut columns),
            Call::Step(seed) => {
                let actions = envs.action_sampler(*seed).unwrap().sample();
                envs.step_into(&actions, &mut columns)
            }
            Call::Store => {
                let text = serde_json::to_string(&envs.snapshot().unwrap()).unwrap();
                stored = Some((text, columns.clone(), over.clone()));
                continue;
            }
            Call::Restore { new } => {
                let (text, then, were_over) = stored.as_ref().unwrap();
                if *new {
                    envs = spec.make().unwrap();
                }
                let snapshot: Snapshot = serde_json::from_str(text).unwrap();
                envs.restore(&snapshot).unwrap();
                (columns, over) = (then.clone(), were_over.clone());
                // final infos belong to the last step, which is not repeated
                columns.has_final.fill(false);
                Ok(())
            }
        };
        match result {
            Ok(()) => {
                let rows = rows(&*envs, &columns);
                for (over, row) in over.iter_mut().zip(&rows) {
                    *over = match row.progress {
                        Progress::Unchanged => *over,
                        _ => row.outcome.1 || row.outcome.2,
                    };
                }
                answers.push(Ok(rows));
            }
            Err(error) => {
                answers.push(Err(error.to_string()));
                envs.reset_into(&VectorReset::default().mask(over.clone()), &mut columns)
                    .unwrap();
                answers.push(Ok(rows(&*envs, &columns)));
                over.fill(false);
            }
        }
    }
    answers
}

#[test]
fn every_kind_answers_the_same_whatever_was_called_before() {
    for spec in specs() {
        for autoreset in MODES {
            for (n, seed) in [(1, 1), (3, 2), (35, 3)] {
                let vector = |kind| VectorSpec::new(spec.clone(), n, kind).autoreset(autoreset);
                let calls = calls(n, seed);
                let sync = answers(&vector(VectorKind::Sync), &calls);
                for kind in [VectorKind::Native, VectorKind::Async] {
                    let others = answers(&vector(kind), &calls);
                    for (i, (a, b)) in sync.iter().zip(&others).enumerate() {
                        assert_eq!(
                            a, b,
                            "{}, {n}, {autoreset:?}, {kind:?}: answer {i}",
                            spec.id
                        );
                    }
                    assert_eq!(sync.len(), others.len());
                }
            }
        }
    }
}

/// After restoring a snapshot from before the first reset, a used vector needs a reset.
#[test]
fn a_snapshot_of_a_new_vector_needs_a_reset() {
    for kind in [VectorKind::Native, VectorKind::Sync, VectorKind::Async] {
        let spec = VectorSpec::new(
            registry::find("CartPole-v1").unwrap().spec().unwrap(),
            3,
            kind,
        );
        let new = spec.make().unwrap().snapshot().unwrap();
        let mut envs = spec.make().unwrap();
        let actions = envs.action_sampler(0).unwrap().sample();
        envs.reset(0).unwrap();
        envs.step(&actions).unwrap();
        envs.restore(&new).unwrap();
        assert!(envs.step(&actions).is_err(), "{kind:?}");
        envs.reset(0).unwrap();
        envs.step(&actions).unwrap();
    }
}

/// Restoring a snapshot that no native vector can produce is an error and has no effect.
#[test]
fn flags_and_counts_that_cannot_be_are_refused() {
    for (autoreset, field, value) in [
        (Autoreset::NextStep, "due", json!(u32::MAX)),
        (Autoreset::NextStep, "due", json!(1 << 3)),
        (Autoreset::NextStep, "unset", json!(1 << 3)),
        (Autoreset::SameStep, "due", json!(1)),
        (Autoreset::Disabled, "steps", json!(u16::MAX)),
    ] {
        let spec = registry::find("CartPole-v1").unwrap().spec().unwrap();
        let spec = VectorSpec::new(spec, 3, VectorKind::Native).autoreset(autoreset);
        let mut envs = spec.make().unwrap();
        envs.reset(0).unwrap();
        let before = envs.snapshot().unwrap();
        let mut json: Json = before.get().unwrap();
        assert!(replace(&mut json, field, &value), "{json}");
        let error = envs
            .restore(&Snapshot::of(&json).unwrap())
            .unwrap_err()
            .to_string();
        assert!(error.contains("do not fit"), "{field} {value}: {error}");
        assert_eq!(envs.snapshot().unwrap(), before);
    }
}

/// Replaces the first number of the row `field`, wherever it is.
fn replace(json: &mut Json, field: &str, value: &Json) -> bool {
    match json {
        Json::Object(entries) => {
            if let Some(row) = entries.get_mut(field)
                && let Some(first) = first_number(row)
            {
                *first = value.clone();
                return true;
            }
            entries
                .values_mut()
                .any(|entry| replace(entry, field, value))
        }
        Json::Array(items) => items.iter_mut().any(|item| replace(item, field, value)),
        _ => false,
    }
}

fn first_number(json: &mut Json) -> Option<&mut Json> {
    match json {
        Json::Number(_) => Some(json),
        Json::Array(items) => items.iter_mut().find_map(first_number),
        Json::Object(entries) => entries.values_mut().find_map(first_number),
        _ => None,
    }
}

/// The step count stops at a number above every limit.
#[test]
fn an_episode_without_a_limit_goes_on_for_ever() {
    let spec = EnvSpec {
        max_episode_steps: None,
        ..registry::find("Pendulum-v1").unwrap().spec().unwrap()
    };
    let mut envs = VectorSpec::new(spec, 1, VectorKind::Native).make().unwrap();
    envs.reset(0).unwrap();
    let actions = envs.action_sampler(0).unwrap().sample();
    let mut columns = envs.columns().unwrap();
    for step in 0..66_000 {
        envs.step_into(&actions, &mut columns).unwrap();
        assert!(
            !columns.truncated[0] && columns.progress[0] == Progress::Stepped,
            "step {step}"
        );
    }
    let snapshot = envs.snapshot().unwrap();
    envs.restore(&snapshot).unwrap();
}

/// The seeds of sub-environments count up from the first, for any number of sub-environments.
#[test]
fn the_seeds_of_many_differ() {
    let reset = VectorReset::from(5);
    for index in [0usize, 1, 255, 256, 65_535, 65_536, 1 << 20] {
        assert_eq!(
            reset.of(index).unwrap().seed,
            Some((5 + index as u64).into())
        );
    }
}

#[test]
fn a_closed_vector_stays_closed() {
    for kind in [VectorKind::Sync, VectorKind::Async] {
        let spec = VectorSpec::new(
            registry::find("CartPole-v1").unwrap().spec().unwrap(),
            2,
            kind,
        );
        let (mut open, mut envs) = (spec.make().unwrap(), spec.make().unwrap());
        open.reset(0).unwrap();
        envs.reset(0).unwrap();
        let before = open.snapshot().unwrap();
        envs.close();
        // changing an environment of a closed vector does not reopen the vector
        let _ = envs.visit_envs(&mut |_, env| {
            if let Some(env) = env.downcast_mut::<gym::BoxEnv>() {
                let _ = gym::EnvExt::reset(env, 0);
            }
        });
        assert!(
            matches!(
                envs.reset(0),
                Err(gym::Error::SubEnvironment { .. } | gym::Error::Closed(_))
            ),
            "{kind:?}"
        );
        assert!(envs.restore(&before).is_err());
        // a snapshot of a closed vector cannot be restored either
        if let Ok(closed) = envs.snapshot() {
            assert!(open.restore(&closed).is_err(), "{kind:?}");
        }
        assert_eq!(open.snapshot().unwrap(), before);
    }
}

/// An environment whose info is an array of its own length.
#[derive(Clone, Debug)]
struct Lengths(usize);

impl Env for Lengths {
    type Observation = i64;
    type Action = i64;

    fn observation_space(&self) -> Space {
        Space::discrete(2)
    }

    fn action_space(&self) -> Space {
        Space::discrete(2)
    }

    fn reset_into(&mut self, _: &Reset, observation: &mut i64) -> Result<()> {
        *observation = 0;
        Ok(())
    }

    fn step_into(&mut self, _: &i64, observation: &mut i64) -> Result<Outcome> {
        *observation = 1;
        Ok(Outcome::default())
    }

    fn info(&self, visit: &mut dyn FnMut(&str, Value)) {
        visit("numbers", Value::Array(vec![7.0f64; self.0].into()));
    }
}

/// A column of infos has rows of one shape. An info of another shape is missing from the column.
#[test]
fn infos_of_another_shape_are_missing() {
    let mut envs = SyncVectorEnv::new([2, 3, 2, 1].map(Lengths)).unwrap();
    let mut columns = envs.columns().unwrap();
    envs.reset_into(&0.into(), &mut columns).unwrap();
    let infos = envs.infos(&columns);
    let flags = |flags: [bool; 4]| Value::Tuple(flags.map(Value::Bool).to_vec());
    assert_eq!(infos["_numbers"], flags([true, false, true, false]));
    let numbers: Vec<f64> = infos["numbers"].as_array().unwrap().iter_f64().collect();
    assert_eq!(numbers, [7.0, 7.0, 0.0, 0.0, 7.0, 7.0, 0.0, 0.0]);
}

/// A sub-environment with a pending step cannot move to other threads, and nothing can be received
/// from an empty set.
#[test]
fn what_is_pending_is_received_first() {
    let mut envs = AsyncVectorEnv::new([2, 2].map(Lengths)).unwrap();
    let mut columns = envs.columns().unwrap();
    envs.reset_into(&0.into(), &mut columns).unwrap();
    let actions = Value::Array(vec![0i64].into());
    envs.send(&actions, &[1]).unwrap();
    assert!(envs.send(&actions, &[1]).is_err());
    let mut ids = Vec::new();
    assert!(envs.recv_into(0, &mut ids, &mut columns).is_err());
    assert!(envs.recv_into(2, &mut ids, &mut columns).is_err());
    envs.recv_into(1, &mut ids, &mut columns).unwrap();
    assert_eq!(ids, [1]);
    envs.send(&actions, &[0]).unwrap();
    assert!(
        envs.with_threads(1)
            .unwrap_err()
            .to_string()
            .contains("pending")
    );
}
