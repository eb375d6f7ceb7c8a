//! Native vectors give the bits of single environments, step by step.

use gym_classic::cartpole::CartPoleDynamics;
use gym_core::vector::{Autoreset, Columns, VectorKind, VectorReset};
use gym_core::{
    Error, Inspect, Snapshot, Task, Value, VectorEnv, VectorEnvExt, WrapperSpec, builder,
};
use gym_native::NativeVectorEnv;
use gym_testing::{Sum, native_equals_sync};
use gym_wrappers::RecordEpisodeStatistics;
use serde_json::json;

const IDS: [&str; 6] = [
    "Acrobot-v1",
    "CartPole-v0",
    "CartPole-v1",
    "MountainCar-v0",
    "MountainCarContinuous-v0",
    "Pendulum-v1",
];

/// (100 is not a multiple of a register's length.)
#[test]
fn native_vectors_equal_scalar_environments() {
    for id in IDS {
        for (num_envs, steps, seed) in [(1, 2000, 3), (100, 1000, 4)] {
            native_equals_sync(&format!("{id}, {num_envs}"), steps, seed, |kind| {
                let vector = builder(id).vector(num_envs).kind(kind);
                vector.autoreset(Autoreset::NextStep).build().unwrap()
            });
        }
    }
}

/// Returns the FNV-1a hash of the results of 100 environments in 300 steps.
fn fingerprint(id: &str) -> u64 {
    let mut envs = builder(id)
        .vector(100)
        .kind(VectorKind::Native)
        .build()
        .unwrap();
    let mut columns = envs.columns().unwrap();
    let mut actions = envs.action_space().unwrap().sampler(6);
    envs.reset_into(&6.into(), &mut columns).unwrap();
    let mut sum = Sum::default();
    for _ in 0..300 {
        envs.step_into(&actions.sample(), &mut columns).unwrap();
        sum.observe(columns.observations.as_slice().unwrap());
        for reward in &columns.rewards {
            sum.word(reward.to_bits());
        }
    }
    sum.finish()
}

/// The fingerprints are equal on every platform.
#[test]
fn results_depend_on_no_machine() {
    let fingerprints = IDS.map(fingerprint);
    let expected = [
        13_916_363_913_685_948_145,
        6_135_544_227_799_461_774,
        6_135_544_227_799_461_774,
        8_804_461_551_199_745_785,
        18_413_136_723_738_118_349,
        10_315_836_550_077_561_870,
    ];
    assert_eq!(fingerprints, expected);
}

/// After a reset with a mask, the infos have no entries of the other environments and no `episode`,
/// whether or not the other environments' episodes are over. This holds in each autoreset mode, and
/// with the wrapper around the vector or around each sub-environment.
#[test]
fn a_masked_reset_tells_nothing_of_those_left_out() {
    const N: usize = 40;
    for mode in [
        Autoreset::NextStep,
        Autoreset::SameStep,
        Autoreset::Disabled,
    ] {
        for (kind, within) in [
            (VectorKind::Native, false),
            (VectorKind::Sync, false),
            (VectorKind::Sync, true),
            (VectorKind::Async, true),
        ] {
            let mut env = builder("CartPole-v1").max_episode_steps(4);
            if within {
                env = env.wrap(WrapperSpec::new("RecordEpisodeStatistics"));
            }
            let envs = env.vector(N).kind(kind).autoreset(mode).build().unwrap();
            let mut envs: Box<dyn VectorEnv> = if within {
                envs
            } else {
                Box::new(RecordEpisodeStatistics::new(envs))
            };
            let what = format!("{mode:?}, {}", envs.describe());
            let mut columns = envs.columns().unwrap();
            let actions = Value::from([1_i64; N]);
            envs.reset_into(&0.into(), &mut columns).unwrap();
            // the environments of the last block begin their episodes two steps later
            for step in 0..4 {
                if step == 2 {
                    let late: Vec<bool> = (0..N).map(|i| i >= 32).collect();
                    envs.reset_into(&VectorReset::default().mask(late), &mut columns)
                        .unwrap();
                }
                envs.step_into(&actions, &mut columns).unwrap();
            }
            let is_first = |i: usize| i < 32;
            let over: Vec<bool> = (0..N).map(|i| columns.done(i)).collect();
            assert_eq!(over, (0..N).map(is_first).collect::<Vec<_>>(), "{what}");
            let place = match (mode, within) {
                (Autoreset::SameStep, true) => "final_info",
                _ => "episode",
            };
            assert!(envs.infos(&columns).contains_key(place), "{what}");
            // the mask selects every second environment, of which some have ended their episode
            let mask: Vec<bool> = (0..N).map(|i| i % 2 == 1).collect();
            envs.reset_into(&VectorReset::default().mask(mask), &mut columns)
                .unwrap();
            let infos = envs.infos(&columns);
            assert!(infos.is_empty(), "{what}: {infos:?}");
            for i in 0..N {
                assert!(envs.info_map(i).is_empty(), "{what}: {i}");
                assert!(!columns.done(i) && !columns.has_final[i], "{what}: {i}");
            }
        }
    }
}

/// Each action of a list is checked. The error names the first invalid action.
#[test]
fn each_action_of_a_list_is_checked() {
    for kind in [VectorKind::Native, VectorKind::Sync] {
        let mut envs = builder("Pendulum-v1").vector(3).kind(kind).build().unwrap();
        envs.reset(0).unwrap();
        let fits = || Value::from([0.5_f64]);
        let list = |wrong: Value| Value::Tuple(vec![fits(), wrong, fits()]);
        envs.step(&list(fits())).unwrap();
        for wrong in [
            Value::from([0.5, 0.5]),
            Value::Text("0.5".into()),
            Value::Null,
        ] {
            let error = envs.step(&list(wrong)).map(drop).unwrap_err();
            assert!(
                matches!(error, Error::SubEnvironment { index: 1, .. }),
                "{kind:?}: {error}"
            );
        }
    }
}

fn cartpoles(n: usize, mode: Autoreset, limit: u32) -> Box<dyn VectorEnv> {
    let envs = builder("CartPole-v1").max_episode_steps(limit).vector(n);
    let envs = envs.kind(VectorKind::Native).autoreset(mode);
    envs.build().unwrap()
}

/// Restores `snapshot` into a vector in an episode. Returns whether the vector accepts it. Checks
/// that a refused snapshot changes nothing.
fn restored(envs: &mut dyn VectorEnv, snapshot: &Snapshot) -> bool {
    envs.reset_into(&3.into(), &mut Columns::default()).unwrap();
    let own = envs.snapshot().unwrap();
    assert_ne!(own, *snapshot);
    let fits = envs.restore(snapshot).is_ok();
    let expected = if fits { snapshot } else { &own };
    assert_eq!(envs.snapshot().unwrap(), *expected);
    fits
}

/// A snapshot, even from before the first reset, does not fit a vector with another size, mode or
/// limit.
#[test]
fn a_snapshot_fits_one_size_mode_and_limit() {
    use Autoreset::{Disabled, NextStep, SameStep};
    let mut envs = cartpoles(5, NextStep, 9);
    for _ in 0..2 {
        let snapshot = envs.snapshot().unwrap();
        for (n, mode, limit) in [
            (5, NextStep, 9),
            (4, NextStep, 9),
            (6, NextStep, 9),
            (33, NextStep, 9),
            (5, SameStep, 9),
            (5, Disabled, 9),
            (5, NextStep, 8),
            (5, NextStep, 10),
        ] {
            assert_eq!(
                restored(&mut *cartpoles(n, mode, limit), &snapshot),
                (n, mode, limit) == (5, NextStep, 9),
                "{n}, {mode:?}, {limit}"
            );
        }
        envs.reset(0).unwrap();
    }
}

/// A snapshot has flags only for existing environments, and with `SameStep` no flag `due`.
#[test]
fn flags_that_no_vector_has_are_refused() {
    use Autoreset::{Disabled, NextStep, SameStep};
    for (n, mode, name, flags, fits) in [
        (5, NextStep, "due", vec![1_u32 << 4], true),
        (5, NextStep, "due", vec![1 << 5], false),
        (5, NextStep, "due", vec![1 << 31], false),
        (5, Disabled, "unset", vec![1 << 4], true),
        (5, Disabled, "unset", vec![1 << 5], false),
        (32, Disabled, "due", vec![u32::MAX], true),
        (32, Disabled, "due", vec![0, 1], false),
        (33, Disabled, "due", vec![0, 1], true),
        (33, Disabled, "due", vec![0, 2], false),
        (33, Disabled, "unset", vec![1], false),
        (5, SameStep, "unset", vec![1], true),
        (5, SameStep, "due", vec![1], false),
    ] {
        let mut envs = cartpoles(n, mode, 9);
        envs.reset(0).unwrap();
        let mut state = json!(envs.snapshot().unwrap());
        assert_ne!(state["numbers"][name]["$uint32"], json!(flags));
        state["numbers"][name]["$uint32"] = json!(flags);
        let state = serde_json::from_value(state).unwrap();
        let what = format!("{n}, {mode:?}: {name} {flags:?}");
        assert_eq!(restored(&mut *envs, &state), fits, "{what}");
    }
}

/// With `Disabled`, a truncated episode needs a reset, like a terminated episode.
#[test]
fn a_truncated_episode_waits_for_a_reset() {
    let mut envs = cartpoles(34, Autoreset::Disabled, 2);
    let actions = Value::from([0_i64; 34]);
    let mut columns = envs.reset(0).unwrap();
    let late: Vec<bool> = (0..34).map(|i| i != 33).collect();
    envs.step_into(&actions, &mut columns).unwrap();
    let reset = VectorReset::default().mask(late.clone());
    envs.reset_into(&reset, &mut columns).unwrap();
    envs.step_into(&actions, &mut columns).unwrap();
    let expected: Vec<bool> = (0..34).map(|i| i == 33).collect();
    assert_eq!(columns.truncated, expected);
    let error = envs.step_into(&actions, &mut columns).unwrap_err();
    let error = error.to_string();
    let place = "sub-environment 33: the episode has ended";
    assert!(error.starts_with(place), "{error}");
    let reset = VectorReset::default().mask(expected);
    envs.reset_into(&reset, &mut columns).unwrap();
    envs.step_into(&actions, &mut columns).unwrap();
    assert_eq!(columns.truncated, late);
}

/// The last block of a vector has unused places.
#[test]
fn places_beyond_the_last_environment_have_no_state() {
    let dynamics = CartPoleDynamics::new(Default::default()).unwrap();
    let mut envs = NativeVectorEnv::new(dynamics, 3, None, Autoreset::NextStep).unwrap();
    assert_eq!(envs.state(0), None, "before the first reset");
    let mut told = String::new();
    let mut set = |env: &mut dyn Inspect| {
        told = env.set_state(0.into()).unwrap_err().to_string();
    };
    envs.inspect(2, &mut set).unwrap();
    assert!(
        told.starts_with("cannot call `set_state` before `reset`"),
        "{told}"
    );
    envs.reset(0).unwrap();
    let there = [0, 2, 3, 31, 32].map(|i| envs.state(i).is_some());
    assert_eq!(there, [true, true, false, false, false]);
    for (index, fits) in [(2, true), (3, false), (32, false)] {
        assert_eq!(envs.inspect(index, &mut |_| ()).is_ok(), fits, "{index}");
    }
}

/// If the step of an environment is a reset, its action is ignored, even if it is invalid.
#[test]
fn an_action_of_an_environment_that_is_due_is_ignored() {
    let mut envs = cartpoles(3, Autoreset::NextStep, 1);
    let mut columns = envs.reset(0).unwrap();
    let reset = VectorReset::default().mask([false, true, false]);
    let actions = |number: [i64; 3]| Value::from(number);
    envs.step_into(&actions([0, 0, 0]), &mut columns).unwrap();
    envs.reset_into(&reset, &mut columns).unwrap();
    let error = envs.step_into(&actions([-1, 2, 5]), &mut columns);
    let error = error.unwrap_err().to_string();
    assert!(
        error.starts_with("sub-environment 1: invalid action"),
        "{error}"
    );
    envs.step_into(&actions([-1, 1, 5]), &mut columns).unwrap();
    assert_eq!(columns.truncated, [false, true, false]);
}

/// Vectors without threads refuse to bind them to cores. Specs keep the core.
#[cfg(target_os = "linux")]
#[test]
fn threads_are_bound_where_there_are_threads() {
    let bound = |kind: Option<VectorKind>| {
        let vector = builder("CartPole-v1").vector(4).affinity(0);
        match kind {
            Some(kind) => vector.kind(kind),
            None => vector,
        }
    };
    for kind in [Some(VectorKind::Sync), Some(VectorKind::Native), None] {
        let error = bound(kind).build().map(drop).unwrap_err().to_string();
        assert!(error.contains("choose kind async"), "{error}");
    }
    let spec = bound(Some(VectorKind::Async)).spec().unwrap();
    let text = serde_json::to_string(&spec).unwrap();
    assert!(text.contains("\"affinity\":0"), "{text}");
    let read: gym_core::vector::VectorSpec = serde_json::from_str(&text).unwrap();
    assert_eq!(read, spec);
    read.make().unwrap();
}
