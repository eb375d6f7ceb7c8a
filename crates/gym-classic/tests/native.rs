//! Native vectors give the bits of single environments, step by step.

use gym_classic as _;
use gym_core::vector::{Autoreset, VectorKind, VectorReset};
use gym_core::{Error, Value, VectorEnv, VectorEnvExt, WrapperSpec, builder};
use gym_wrappers::RecordEpisodeStatistics;

const IDS: [&str; 6] = [
    "Acrobot-v1",
    "CartPole-v0",
    "CartPole-v1",
    "MountainCar-v0",
    "MountainCarContinuous-v0",
    "Pendulum-v1",
];

/// Compares native and sync vectors for `steps` steps.
fn compare(id: &str, num_envs: usize, steps: usize, seed: u64) {
    let [mut native, mut sync] = [VectorKind::Native, VectorKind::Sync].map(|kind| {
        builder(id)
            .vector(num_envs)
            .kind(kind)
            .autoreset(Autoreset::NextStep)
            .build()
            .unwrap()
    });
    let [mut fast, mut exact] = [native.columns().unwrap(), sync.columns().unwrap()];
    let mut actions = native.action_space().unwrap().sampler(seed);
    native.reset_into(&seed.into(), &mut fast).unwrap();
    sync.reset_into(&seed.into(), &mut exact).unwrap();
    assert_eq!(fast, exact, "{id}: reset");
    for step in 0..steps.div_ceil(num_envs) {
        let actions = actions.sample();
        native.step_into(&actions, &mut fast).unwrap();
        sync.step_into(&actions, &mut exact).unwrap();
        assert_eq!(
            fast, exact,
            "{id}, {num_envs} environments, seed {seed}: step {step}"
        );
    }
}

/// 100 is not a multiple of a register's length.
#[test]
fn native_vectors_equal_scalar_environments() {
    for id in IDS {
        compare(id, 1, 2000, 3);
        compare(id, 100, 100_000, 4);
    }
}

/// Returns FNV-1a of the results of 100 environments in 300 steps.
fn fingerprint(id: &str) -> u64 {
    let mut envs = builder(id)
        .vector(100)
        .kind(VectorKind::Native)
        .build()
        .unwrap();
    let mut columns = envs.columns().unwrap();
    let mut actions = envs.action_space().unwrap().sampler(6);
    envs.reset_into(&6.into(), &mut columns).unwrap();
    let mut hash = 0xcbf2_9ce4_8422_2325_u64;
    for _ in 0..300 {
        envs.step_into(&actions.sample(), &mut columns).unwrap();
        let seen = columns
            .observations
            .as_slice::<f32>()
            .unwrap()
            .iter()
            .map(|x| u64::from(x.to_bits()));
        for number in seen.chain(columns.rewards.iter().map(|x| x.to_bits())) {
            hash = (hash ^ number).wrapping_mul(0x0100_0000_01b3);
        }
    }
    hash
}

/// The fingerprints are equal on every platform, and with the feature `emulate-fma` of
/// gym-numerics.
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

/// After a reset by a mask, info has nothing of the environments that the mask leaves out, nor an
/// `episode`, whether their episodes are over or not. This holds in each autoreset mode, and with
/// the wrapper around the vector or around each sub-environment.
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
            // the mask has every second environment: some whose episode is over, and others
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

/// A list of actions is checked one by one, and the error names the first that does not fit.
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
