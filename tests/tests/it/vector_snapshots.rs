//! A vector that is stored and restored continues identically: with every kind, autoreset mode and
//! wrapper, also in another process. A refused snapshot changes nothing.

use std::process::Command;

use gym::vector::{Autoreset, Columns, SyncVectorEnv, VectorKind, VectorReset, VectorSpec};
use gym::wrappers::{NormalizeObservation, RecordEpisodeStatistics};
use gym::{
    BoxEnv, BoxVector, EnvExt, Info, Sampler, Snapshot, Value, VectorEnv, VectorEnvExt, Wrap,
    WrapperSpec, builder, make_vec,
};
use serde_json::{Value as Json, json};

pub(crate) const MODES: [Autoreset; 3] = [
    Autoreset::NextStep,
    Autoreset::SameStep,
    Autoreset::Disabled,
];
pub(crate) const KINDS: [VectorKind; 3] = [VectorKind::Sync, VectorKind::Async, VectorKind::Native];
pub(crate) const N: usize = 5;

/// Returns the spec of a vector whose episodes end often.
pub(crate) fn spec(
    id: &str,
    kind: VectorKind,
    autoreset: Autoreset,
    wrappers: &Json,
) -> VectorSpec {
    let vector = builder(id)
        .max_episode_steps(9)
        .vector(N)
        .kind(kind)
        .autoreset(autoreset);
    let wrappers = wrappers.as_array().expect("a list").iter();
    wrappers.fold(vector.spec().unwrap(), |spec, wrapper| {
        spec.wrapped(serde_json::from_value(wrapper.clone()).unwrap())
    })
}

/// The results of a call: columns, and infos without wall-clock times.
pub(crate) type Seen = (Columns, Info);

pub(crate) fn seen(envs: &dyn VectorEnv, columns: &Columns) -> Seen {
    let mut infos = envs.infos(columns);
    let mut columns = columns.clone();
    // the contents of the other rows are unspecified
    let finals = envs
        .single_observation_space()
        .iterate(&columns.final_observations)
        .unwrap();
    let finals = finals
        .zip(&columns.has_final)
        .filter(|(_, there)| **there)
        .map(|(row, _)| row);
    columns.final_observations = Value::Tuple(finals.collect());
    if let Some(Value::Dict(entries)) = infos.get_mut("episode") {
        entries.retain(|(key, _)| key != "t");
    }
    (columns, infos)
}

/// Takes random steps. With disabled autoreset, resets by mask the environments whose episodes
/// ended; in other autoreset modes, sometimes resets one environment.
pub(crate) fn play(
    envs: &mut dyn VectorEnv,
    columns: &mut Columns,
    actions: &mut Sampler,
    steps: usize,
) -> Vec<Seen> {
    let mut history = Vec::new();
    for step in 0..steps {
        envs.step_into(&actions.sample(), columns).unwrap();
        history.push(seen(envs, columns));
        let mut mask: Vec<bool> = (0..N).map(|i| columns.done(i)).collect();
        if envs.autoreset() != Autoreset::Disabled {
            // a due autoreset stays due if a reset by mask excludes the environment
            mask = (0..N).map(|i| step % 7 == 3 && i == step % N).collect();
        }
        if mask.contains(&true) {
            envs.reset_into(&VectorReset::default().mask(mask), columns)
                .unwrap();
            history.push(seen(envs, columns));
        }
    }
    history
}

pub(crate) fn stored(envs: &dyn VectorEnv) -> Snapshot {
    let text = serde_json::to_string(&envs.snapshot().unwrap()).unwrap();
    serde_json::from_str(&text).unwrap()
}

/// Returns a snapshot without the wall-clock time of episodes.
fn without_clock(snapshot: &Snapshot) -> Json {
    fn clean(json: &mut Json) {
        match json {
            Json::Object(entries) => {
                entries.remove("t");
                entries.values_mut().for_each(clean);
            }
            Json::Array(items) => items.iter_mut().for_each(clean),
            _ => {}
        }
    }
    let mut json = json!(snapshot);
    clean(&mut json);
    json
}

fn continues(spec: &VectorSpec, steps: usize) {
    let what = json!(spec).to_string();
    let mut envs = spec.make().unwrap();
    let mut columns = envs.columns().unwrap();
    let mut actions = envs.action_sampler(3).unwrap();
    envs.reset_into(&11.into(), &mut columns).unwrap();
    play(&mut *envs, &mut columns, &mut actions, steps);

    let snapshot = stored(&*envs);
    let mut restored = spec.make().unwrap();
    restored
        .restore(&snapshot)
        .unwrap_or_else(|error| panic!("{what}: {error}"));
    assert_eq!(stored(&*restored), snapshot, "{what}");
    let mut own = restored.columns().unwrap();
    let mut same_actions = actions.clone();
    let expected = play(&mut *envs, &mut columns, &mut actions, 40);
    let answered = play(&mut *restored, &mut own, &mut same_actions, 40);
    for (step, (answered, expected)) in answered.iter().zip(&expected).enumerate() {
        assert_eq!(answered, expected, "{what}: {step}");
    }
    assert_eq!(
        without_clock(&stored(&*restored)),
        without_clock(&stored(&*envs)),
        "{what}"
    );
}

pub(crate) fn kinds_of(id: &str) -> impl Iterator<Item = VectorKind> {
    let has_native = gym::registry::find(id)
        .unwrap()
        .vector_entry_point
        .is_some();
    KINDS
        .into_iter()
        .filter(move |kind| *kind != VectorKind::Native || has_native)
}

#[test]
fn every_kind_continues_in_every_mode() {
    for id in [
        "CartPole-v1",
        "Pendulum-v1",
        "MountainCarContinuous-v0",
        "Blackjack-v1",
        "Taxi-v4",
        "FrozenLake-v1",
    ] {
        for (kind, mode) in kinds_of(id).flat_map(|kind| MODES.map(|mode| (kind, mode))) {
            for steps in [0, 9, 23] {
                continues(&spec(id, kind, mode, &json!([])), steps);
            }
        }
    }
    for (kind, mode) in KINDS
        .into_iter()
        .flat_map(|kind| MODES.map(|mode| (kind, mode)))
    {
        continues(&spec("LunarLander-v3", kind, mode, &json!([])), 17);
    }
    continues(
        &spec(
            "BipedalWalker-v3",
            VectorKind::Native,
            Autoreset::NextStep,
            &json!([]),
        ),
        17,
    );
}

#[test]
fn every_wrapper_continues() {
    let stacks = [
        json!([{"name": "RecordEpisodeStatistics", "kwargs": {"buffer_length": 3}}]),
        json!([
            {"name": "NormalizeObservation"},
            {"name": "NormalizeReward", "kwargs": {"gamma": 0.9}},
        ]),
        json!([
            {"name": "NormalizeReward"},
            {"name": "RecordEpisodeStatistics"},
            {"name": "NormalizeObservation"},
        ]),
        json!([
            {"name": "ClipAction"},
            {"name": "RescaleAction", "kwargs": {"min_action": "-inf", "max_action": "inf"}},
            {"name": "RescaleObservation", "kwargs": {"min_obs": -1.0, "max_obs": [1.0, 2.0, 3.0]}},
            {"name": "ClipReward", "kwargs": {"min_reward": -5.0}}
        ]),
    ];
    for stack in stacks {
        for (kind, mode) in KINDS
            .into_iter()
            .flat_map(|kind| MODES.map(|mode| (kind, mode)))
        {
            continues(&spec("Pendulum-v1", kind, mode, &stack), 23);
        }
    }
}

/// Wrappers of the sub-environments have their own statistics and queues.
#[test]
fn wrapped_environments_continue() {
    let env = ["NormalizeObservation", "NormalizeReward"]
        .map(WrapperSpec::new)
        .into_iter();
    let env = env.fold(
        builder("Pendulum-v1").max_episode_steps(9),
        gym::registry::EnvBuilder::wrap,
    );
    let env = env.wrap(WrapperSpec::new("FrameStackObservation").arg("stack_size", 3));
    for mode in MODES {
        let vector = env
            .clone()
            .vector(N)
            .kind(VectorKind::Async)
            .autoreset(mode)
            .threads(2);
        continues(&vector.spec().unwrap(), 14);
    }
}

/// Snapshots of sync vectors fit async vectors: threads make no difference.
#[test]
fn sync_and_async_are_interchangeable() {
    for mode in MODES {
        let [sync, pool] = [VectorKind::Sync, VectorKind::Async]
            .map(|kind| spec("CartPole-v1", kind, mode, &json!([])));
        let (mut a, mut b) = (sync.make().unwrap(), pool.make().unwrap());
        let mut columns = a.columns().unwrap();
        let mut actions = a.action_sampler(0).unwrap();
        a.reset_into(&3.into(), &mut columns).unwrap();
        play(&mut *a, &mut columns, &mut actions, 12);
        b.restore(&stored(&*a)).unwrap();
        let mut other = columns.clone();
        let mut same = actions.clone();
        assert_eq!(
            play(&mut *b, &mut other, &mut same, 30),
            play(&mut *a, &mut columns, &mut actions, 30)
        );
    }
}

const CHILD: &str = "GYM_TEST_SNAPSHOT_FOLDER";

/// The other process: reads spec, snapshot and actions, and prints the results.
#[test]
fn child() {
    let Some(folder) = std::env::var_os(CHILD).map(std::path::PathBuf::from) else {
        return;
    };
    let text = std::fs::read_to_string(folder.join("run.json")).unwrap();
    let runs: Vec<(VectorSpec, Snapshot)> = serde_json::from_str(&text).unwrap();
    let seen = runs.iter().map(|(spec, snapshot)| {
        let mut envs = spec.make().unwrap();
        envs.restore(snapshot).unwrap();
        let mut columns = envs.columns().unwrap();
        let mut actions = envs.action_sampler(8).unwrap();
        format!("{:?}", play(&mut *envs, &mut columns, &mut actions, 40))
    });
    std::fs::write(
        folder.join("seen.json"),
        serde_json::to_string(&seen.collect::<Vec<_>>()).unwrap(),
    )
    .unwrap();
}

#[test]
fn another_process_continues() {
    let folder = tempfile::tempdir().unwrap();
    let wrappers = json!([
        {"name": "RecordEpisodeStatistics"},
        {"name": "NormalizeObservation"},
        {"name": "NormalizeReward"},
    ]);
    let (mut runs, mut expected) = (Vec::new(), Vec::new());
    for (kind, mode) in KINDS
        .into_iter()
        .flat_map(|kind| MODES.map(|mode| (kind, mode)))
    {
        let spec = spec("CartPole-v1", kind, mode, &wrappers);
        let mut envs = spec.make().unwrap();
        let mut columns = envs.columns().unwrap();
        envs.reset_into(&1.into(), &mut columns).unwrap();
        let mut actions = envs.action_sampler(7).unwrap();
        play(&mut *envs, &mut columns, &mut actions, 31);
        let snapshot = envs.snapshot().unwrap();
        let mut actions = envs.action_sampler(8).unwrap();
        expected.push(format!(
            "{:?}",
            play(&mut *envs, &mut columns, &mut actions, 40)
        ));
        runs.push((spec, snapshot));
    }
    std::fs::write(
        folder.path().join("run.json"),
        serde_json::to_string(&runs).unwrap(),
    )
    .unwrap();
    let child = Command::new(std::env::current_exe().unwrap())
        .args(["--exact", "vector_snapshots::child"])
        .env(CHILD, folder.path())
        .output()
        .unwrap();
    assert!(
        child.status.success(),
        "{}",
        String::from_utf8_lossy(&child.stdout)
    );
    let seen = std::fs::read_to_string(folder.path().join("seen.json")).unwrap();
    let seen: Vec<String> = serde_json::from_str(&seen).unwrap();
    assert_eq!(seen, expected);
}

/// A due reset belongs to the vector: restoring the environments' own snapshots loses the due
/// reset, and restoring the vector's snapshot keeps it.
#[test]
fn a_reset_that_is_due_is_part_of_the_state() {
    for kind in KINDS {
        let mut envs = spec("CartPole-v1", kind, Autoreset::NextStep, &json!([]))
            .make()
            .unwrap();
        let mut columns = envs.reset(0).unwrap();
        let push = Value::Array([1i64; N].into());
        while !columns.done(0) {
            envs.step_into(&push, &mut columns).unwrap();
        }
        let mut restored = spec("CartPole-v1", kind, Autoreset::NextStep, &json!([]))
            .make()
            .unwrap();
        restored.restore(&stored(&*envs)).unwrap();
        let (a, b) = (envs.step(&push).unwrap(), restored.step(&push).unwrap());
        assert_eq!(a, b);
        assert_eq!(
            (a.rewards[0], a.done(0)),
            (0.0, false),
            "the step was a reset"
        );
    }
}

#[test]
fn a_million_cartpoles_are_stored_in_little() {
    const N: usize = 1_000_000;
    let make = || make_vec("CartPole-v1", N, VectorKind::Native).unwrap();
    let mut envs = make();
    let mut columns = envs.reset(0).unwrap();
    let actions = Value::Array(vec![1i64; N].into());
    for _ in 0..9 {
        envs.step_into(&actions, &mut columns).unwrap();
    }
    let text = serde_json::to_string(&envs.snapshot().unwrap()).unwrap();
    let bytes = text.len() as f64 / N as f64;
    let mut restored = make();
    restored
        .restore(&serde_json::from_str(&text).unwrap())
        .unwrap();
    assert!(bytes < 110.0, "{bytes} bytes for each environment");
    let mut other = columns.clone();
    envs.step_into(&actions, &mut columns).unwrap();
    restored.step_into(&actions, &mut other).unwrap();
    assert!(columns == other);
}

/// The statistics of a training vector can be copied to an evaluation environment, which does not
/// update them.
#[test]
fn statistics_are_reached_and_frozen() {
    let wrappers = json!([{"name": "NormalizeObservation"}, {"name": "RecordEpisodeStatistics"}]);
    let mut envs = spec(
        "Pendulum-v1",
        VectorKind::Native,
        Autoreset::NextStep,
        &wrappers,
    )
    .make()
    .unwrap();
    let mut actions = envs.action_sampler(0).unwrap();
    let mut columns = envs.reset(0).unwrap();
    play(&mut *envs, &mut columns, &mut actions, 50);
    assert!(
        envs.layer::<RecordEpisodeStatistics<BoxVector>>()
            .unwrap()
            .episode_count()
            > 10
    );
    let statistics = envs
        .layer::<NormalizeObservation<BoxVector>>()
        .unwrap()
        .statistics()
        .clone();
    assert!(statistics.count() > 200.0);
    envs.layer_mut::<NormalizeObservation<BoxVector>>()
        .unwrap()
        .update_running_mean(false);
    play(&mut *envs, &mut columns, &mut actions, 5);
    assert_eq!(
        envs.layer::<NormalizeObservation<BoxVector>>()
            .unwrap()
            .statistics(),
        &statistics
    );
    let spec = envs.spec().unwrap();
    assert_eq!(spec.vector_wrappers[0].kwargs["update_running_mean"], false);

    let mut single = gym::make("Pendulum-v1")
        .unwrap()
        .normalize_observation()
        .unwrap();
    single.set_statistics(statistics.clone()).unwrap();
    single.update_running_mean(false);
    let mut one = make_vec("Pendulum-v1", 1, VectorKind::Sync).unwrap();
    one = WrapperSpec::new("NormalizeObservation")
        .wrap_vector(one)
        .unwrap();
    let normalizer = one.layer_mut::<NormalizeObservation<BoxVector>>().unwrap();
    normalizer.set_statistics(statistics).unwrap();
    normalizer.update_running_mean(false);
    assert_eq!(
        one.reset(4).unwrap().observations.as_slice::<f32>(),
        single.reset(4).unwrap().as_slice::<f32>()
    );
    let other = gym::wrappers::RunningMeanStd::new(7);
    assert!(
        one.layer_mut::<NormalizeObservation<BoxVector>>()
            .unwrap()
            .set_statistics(other)
            .is_err()
    );
    assert!(one.layer::<SyncVectorEnv<BoxEnv>>().is_some());
}
