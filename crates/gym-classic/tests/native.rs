//! Native vectors give the bits of scalar environments, step by step.

use gym_classic as _;
use gym_core::vector::{Autoreset, VectorKind};
use gym_core::{VectorEnv, builder};

const IDS: [&str; 6] =
    ["Acrobot-v1", "CartPole-v0", "CartPole-v1", "MountainCar-v0", "MountainCarContinuous-v0", "Pendulum-v1"];

/// Compares all that both kinds of vectors give, for as many steps of one environment.
fn compare(id: &str, num_envs: usize, steps: usize, seed: u64) {
    let [mut native, mut sync] = [VectorKind::Native, VectorKind::Sync].map(|kind| {
        builder(id).vector(num_envs).kind(kind).autoreset(Autoreset::NextStep).build().unwrap()
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
        assert_eq!(fast, exact, "{id}, {num_envs} environments, seed {seed}: step {step}");
    }
}

/// 100 is no multiple of the numbers that a register holds.
#[test]
fn native_vectors_equal_scalar_environments() {
    for id in IDS {
        compare(id, 1, 2000, 3);
        compare(id, 100, 100_000, 4);
    }
}

#[test]
#[ignore = "takes minutes: run it with --release"]
fn native_vectors_equal_scalar_environments_for_long() {
    for id in IDS {
        compare(id, 1000, 10_000_000, 5);
    }
}
