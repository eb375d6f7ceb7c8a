//! Statistics of episodes: partial masks, refused resets, buffers of another size.

use gym_core::vector::{AsyncVectorEnv, Autoreset, SyncVectorEnv, VectorReset};
use gym_core::{BoxEnv, Env, EnvExt, Value, VectorEnv, VectorEnvExt};
use gym_testing::Count;
use gym_wrappers::{RecordEpisodeStatistics, TimeLimit, record_episode_statistics};

const MODES: [Autoreset; 3] = [
    Autoreset::NextStep,
    Autoreset::SameStep,
    Autoreset::Disabled,
];

/// Returns a sync and an async vector of `n` environments.
fn vectors(n: usize, autoreset: Autoreset) -> [Box<dyn VectorEnv>; 2] {
    let envs = || vec![BoxEnv::new(Count::default()); n];
    [
        Box::new(
            SyncVectorEnv::new(envs())
                .unwrap()
                .with_autoreset(autoreset),
        ),
        Box::new(
            AsyncVectorEnv::new(envs())
                .unwrap()
                .with_autoreset(autoreset),
        ),
    ]
}

fn actions<const N: usize>(actions: [i64; N]) -> Value {
    Value::Array(actions.into())
}

fn flags<const N: usize>(flags: [bool; N]) -> Option<Value> {
    Some(Value::Tuple(flags.map(Value::Bool).into()))
}

/// Only the step that ends an episode has the entry `episode`. A reset of other sub-environments,
/// or the reset that starts the next episode, has no such entry.
#[test]
fn a_masked_reset_leaves_no_episode_of_those_left_out() {
    for mode in MODES {
        for envs in vectors(3, mode) {
            let mut envs = RecordEpisodeStatistics::new(envs);
            let mut columns = envs.columns().unwrap();
            envs.reset_into(&0.into(), &mut columns).unwrap();
            envs.step_into(&actions([9, 9, 1]), &mut columns).unwrap();
            let infos = envs.infos(&columns);
            assert_eq!(infos.get("_episode").cloned(), flags([true, true, false]));
            assert!(envs.ended(0).is_some() && envs.ended(2).is_none());
            // the mask skips the first sub-environment although its episode has ended, and selects
            // the second
            let mask = VectorReset::default().mask([false, true, true]);
            envs.reset_into(&mask, &mut columns).unwrap();
            let infos = envs.infos(&columns);
            assert!(!infos.contains_key("episode"), "{mode:?}: {infos:?}");
            assert!(!infos.contains_key("_episode"), "{mode:?}: {infos:?}");
            for index in 0..3 {
                assert!(envs.ended(index).is_none(), "{mode:?}: {index}");
                assert!(envs.info_map(index).is_empty(), "{mode:?}: {index}");
            }
            assert_eq!(envs.episode_count(), 2);
        }
    }
}

/// A masked reset restarts only the statistics of the selected sub-environments.
#[test]
fn a_masked_reset_restarts_the_statistics_of_the_selected() {
    for mode in MODES {
        for envs in vectors(2, mode) {
            let mut envs = RecordEpisodeStatistics::new(envs);
            let mut columns = envs.columns().unwrap();
            envs.reset_into(&0.into(), &mut columns).unwrap();
            envs.step_into(&actions([3, 3]), &mut columns).unwrap();
            let mask = VectorReset::default().mask([false, true]);
            envs.reset_into(&mask, &mut columns).unwrap();
            envs.step_into(&actions([9, 9]), &mut columns).unwrap();
            let ended = |i| {
                let episode = envs.ended(i).unwrap();
                (episode.episode_return, episode.length)
            };
            assert_eq!([ended(0), ended(1)], [(12.0, 2), (9.0, 1)], "{mode:?}");
        }
    }
}

/// A failed reset ends no episode.
#[test]
fn a_refused_reset_ends_no_episode() {
    for envs in vectors(2, Autoreset::NextStep) {
        let mut envs = RecordEpisodeStatistics::new(envs);
        let mut columns = envs.columns().unwrap();
        envs.reset_into(&0.into(), &mut columns).unwrap();
        envs.step_into(&actions([9, 1]), &mut columns).unwrap();
        let mask = VectorReset::default().mask([true]);
        assert!(envs.reset_into(&mask, &mut columns).is_err());
        assert!(envs.ended(0).is_none());
    }
}

#[test]
fn statistics_of_another_size_are_refused() {
    let [small, _] = vectors(2, Autoreset::NextStep);
    let [large, _] = vectors(3, Autoreset::NextStep);
    let mut small = RecordEpisodeStatistics::new(small);
    let mut large = RecordEpisodeStatistics::new(large);
    small.reset(0).unwrap();
    large.reset(0).unwrap();
    let [of_small, of_large] = [small.snapshot().unwrap(), large.snapshot().unwrap()];
    let refused = [
        (
            large.restore(&of_small),
            "it has 2 sub-environments, and this vector 3",
        ),
        (
            small.restore(&of_large),
            "it has 3 sub-environments, and this vector 2",
        ),
    ];
    for (result, words) in refused {
        let error = result.unwrap_err().to_string();
        assert!(error.contains(words), "{error}");
    }
    let none = record_episode_statistics::Config {
        buffer_length: 0,
        ..Default::default()
    };
    assert!(RecordEpisodeStatistics::with_config(Count::default(), none).is_err());
}

/// Plays `episodes` episodes of three steps.
fn play(env: &mut impl Env<Action = i64>, episodes: usize) {
    for _ in 0..episodes {
        env.reset(0).unwrap();
        while !env.step(&1).unwrap().done() {}
    }
}

#[test]
fn a_smaller_buffer_keeps_the_last_episodes() {
    let count = || TimeLimit::new(Count::default(), 3).unwrap();
    let mut env = RecordEpisodeStatistics::new(count());
    play(&mut env, 20);
    for (buffer_length, kept) in [(5, 5), (8, 5), (3, 3)] {
        let snapshot = Env::snapshot(&env).unwrap();
        let config = record_episode_statistics::Config {
            buffer_length,
            ..Default::default()
        };
        env = RecordEpisodeStatistics::with_config(count(), config).unwrap();
        Env::restore(&mut env, &snapshot).unwrap();
        assert_eq!(env.episodes().len(), kept);
    }
    play(&mut env, 40);
    assert_eq!((env.episodes().len(), env.episode_count()), (3, 60));
    // the newest episodes are kept
    for action in 2..6 {
        env.reset(0).unwrap();
        while !env.step(&action).unwrap().done() {}
    }
    let snapshot = Env::snapshot(&env).unwrap();
    let config = record_episode_statistics::Config {
        buffer_length: 2,
        ..Default::default()
    };
    let mut smaller = RecordEpisodeStatistics::with_config(count(), config).unwrap();
    Env::restore(&mut smaller, &snapshot).unwrap();
    let returns: Vec<f64> = smaller
        .episodes()
        .map(|episode| episode.episode_return)
        .collect();
    assert_eq!(returns, [12.0, 15.0]);
    assert!(env.episodes().all(|episode| episode.length == 3));
}
