//! Vectors of the tasks: the same bits on any number of threads.

use gym_core::vector::{Columns, VectorEnv, VectorEnvExt, VectorKind};
use gym_core::{builder, registry};
use gym_mujoco as _;

/// The bits of all that a step gives back.
fn bits(columns: &Columns) -> Vec<u64> {
    let observations = columns
        .observations
        .as_slice::<f64>()
        .expect("rows of float64");
    let flags = columns
        .terminated
        .iter()
        .chain(&columns.truncated)
        .map(|flag| u64::from(*flag));
    observations
        .iter()
        .chain(&columns.rewards)
        .map(|x| x.to_bits())
        .chain(flags)
        .collect()
}

#[test]
fn the_bits_are_the_same_on_any_number_of_threads() {
    const N: usize = 6;
    const STEPS: usize = 60;
    let ids = registry::all()
        .into_iter()
        .map(|entry| entry.id().to_owned());
    let ids: Vec<String> = ids.filter(|id| id.ends_with("-v5")).collect();
    assert_eq!(ids.len(), 11);
    for id in ids {
        let vector = builder(&id).max_episode_steps(25).vector(N);
        let mut sync = vector.clone().kind(VectorKind::Sync).build().unwrap();
        let mut actions = sync.action_sampler(3).unwrap();
        let batches: Vec<_> = (0..STEPS).map(|_| actions.sample()).collect();
        let mut columns = sync.reset(8).unwrap();
        let mut expected = vec![bits(&columns)];
        for batch in &batches {
            sync.step_into(batch, &mut columns).unwrap();
            expected.push(bits(&columns));
        }
        for threads in [1, 2, 4] {
            let mut pool = vector
                .clone()
                .kind(VectorKind::Async)
                .threads(threads)
                .build()
                .unwrap();
            let mut columns = pool.reset(8).unwrap();
            assert!(
                bits(&columns) == expected[0],
                "{id} on {threads} threads, reset"
            );
            for (step, (batch, expected)) in batches.iter().zip(&expected[1..]).enumerate() {
                pool.step_into(batch, &mut columns).unwrap();
                assert!(
                    bits(&columns) == *expected,
                    "{id} on {threads} threads, step {step}"
                );
            }
        }
    }
}
