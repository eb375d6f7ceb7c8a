//! Environments made by id: older versions, and native vectors.

use gym_core::vector::{Autoreset, VectorKind, VectorReset};
use gym_core::{EnvExt, Value, VectorEnv, VectorEnvExt, builder};
use gym_testing::native_equals_sync;
use gym_toytext::{CliffWalking, Taxi};

/// Native vectors equal scalar environments, also after a snapshot. (100 is not a multiple of the
/// block size.)
#[test]
fn native_vectors_equal_scalar_environments() {
    for id in [
        "Blackjack-v1",
        "CliffWalking-v1",
        "FrozenLake-v1",
        "FrozenLake8x8-v1",
        "Taxi-v3",
    ] {
        for autoreset in [Autoreset::NextStep, Autoreset::SameStep] {
            native_equals_sync(&format!("{id}, {autoreset:?}"), 500, 7, |kind| {
                let vector = builder(id).vector(100).kind(kind).autoreset(autoreset);
                vector.build().unwrap()
            });
        }
    }
}

#[test]
fn older_versions_take_no_arguments() {
    let mut cliff = builder("CliffWalking-v0").build().unwrap();
    assert_eq!(cliff.reset(0).unwrap().as_int(), Some(36));
    assert!(cliff.layer::<CliffWalking>().is_some());
    assert!(
        builder("Taxi-v3")
            .build()
            .unwrap()
            .layer::<Taxi>()
            .is_some()
    );
    for (older, newer, argument) in [
        ("CliffWalking-v0", "CliffWalking-v1", "is_slippery"),
        ("Taxi-v3", "Taxi-v4", "is_rainy"),
    ] {
        let error = builder(older).arg(argument, false).build().unwrap_err();
        assert!(error.to_string().contains("takes no arguments"), "{error}");
        builder(newer).arg(argument, true).build().unwrap();
    }
}

/// The step counter has 16 bits, and stops below the number that means "no limit".
#[test]
fn episodes_without_a_limit_are_never_truncated() {
    let envs = builder("CliffWalking-v1").vector(3);
    let mut envs = envs.kind(VectorKind::Native).build().unwrap();
    let mut columns = envs.columns().unwrap();
    envs.reset_into(&0.into(), &mut columns).unwrap();
    let up = Value::from([0_i64; 3]);
    for step in 0..66_000 {
        envs.step_into(&up, &mut columns).unwrap();
        assert_eq!(columns.truncated, [false; 3], "step {step}");
    }
}

/// The final infos of an episode appear only in the step that ended the episode.
#[test]
fn a_reset_leaves_no_last_infos() {
    for kind in [VectorKind::Native, VectorKind::Sync, VectorKind::Async] {
        let envs = builder("FrozenLake-v1").vector(2).kind(kind);
        let mut envs = envs.autoreset(Autoreset::SameStep).build().unwrap();
        let mut columns = envs.columns().unwrap();
        envs.reset_into(&3.into(), &mut columns).unwrap();
        let last = |envs: &dyn VectorEnv, index: usize| {
            let mut entries = 0;
            envs.final_info(index, &mut |_, _| entries += 1);
            entries
        };
        let mut actions = envs.action_space().unwrap().sampler(0);
        while !columns.has_final[0] {
            envs.step_into(&actions.sample(), &mut columns).unwrap();
        }
        assert_eq!(last(&*envs, 0), 1, "{kind:?}");
        let other = VectorReset::default().mask([false, true]);
        envs.reset_into(&other, &mut columns).unwrap();
        assert_eq!(last(&*envs, 0), 0, "{kind:?}");
    }
}
