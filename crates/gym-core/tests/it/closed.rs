//! A vector closes each of its sub-environments once, also those that are pending.

use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering::Relaxed};

use gym_core::vector::{AsyncVectorEnv, SyncVectorEnv};
use gym_core::{Env, Outcome, Reset, Result, Snapshot, Space, Value, VectorEnv, VectorEnvExt};

const N: usize = 5;

/// An environment that counts in its place how often it was closed.
#[derive(Clone, Debug)]
struct Doors {
    number: usize,
    closed: Arc<[AtomicUsize; N]>,
}

impl Env for Doors {
    type Observation = i64;
    type Action = i64;

    fn observation_space(&self) -> Space {
        Space::discrete(10)
    }

    fn action_space(&self) -> Space {
        Space::discrete(2)
    }

    fn reset_into(&mut self, _: &Reset, observation: &mut i64) -> Result<()> {
        *observation = self.number as i64;
        Ok(())
    }

    fn step_into(&mut self, _: &i64, observation: &mut i64) -> Result<Outcome> {
        *observation = self.number as i64;
        Ok(Outcome::default())
    }

    fn snapshot(&self) -> Result<Snapshot> {
        Snapshot::of(&self.number)
    }

    fn restore(&mut self, _: &Snapshot) -> Result<()> {
        Ok(())
    }

    fn close(&mut self) {
        self.closed[self.number].fetch_add(1, Relaxed);
    }
}

fn doors() -> (Vec<Doors>, Arc<[AtomicUsize; N]>) {
    let closed: Arc<[AtomicUsize; N]> = Arc::default();
    let one = |number| Doors {
        number,
        closed: closed.clone(),
    };
    ((0..N).map(one).collect(), closed)
}

/// Each sub-environment is closed once, and neither steps, resets nor is restored.
fn assert_closes(envs: &mut dyn VectorEnv, closed: &[AtomicUsize; N], snapshot: &Snapshot) {
    let count = || closed.each_ref().map(|one| one.load(Relaxed));
    assert_eq!(count(), [0; N]);
    envs.close();
    assert_eq!(count(), [1; N]);
    for (call, result) in [
        ("step", envs.step(&Value::from(vec![0_i64; N])).map(drop)),
        ("reset", envs.reset(0).map(drop)),
        ("restore", envs.restore(snapshot)),
    ] {
        assert_eq!(
            result.unwrap_err().to_string(),
            format!(
                "sub-environment 0: cannot call `{call}` on a closed environment: make a new one"
            )
        );
    }
}

#[test]
fn each_sub_environment_is_closed_once() {
    let (envs, closed) = doors();
    let mut envs = SyncVectorEnv::new(envs).unwrap();
    envs.reset(0).unwrap();
    let snapshot = envs.snapshot().unwrap();
    assert_closes(&mut envs, &closed, &snapshot);
}

/// Some are sent and received, some sent and not received, some were not sent.
#[test]
fn what_is_pending_is_closed_too() {
    for threads in [1, 2] {
        for (sent, received) in [(0, 0), (1, 0), (3, 0), (3, 1), (5, 0), (5, 4), (5, 5)] {
            let (envs, closed) = doors();
            let mut envs = AsyncVectorEnv::new(envs)
                .unwrap()
                .with_threads(threads)
                .unwrap();
            envs.reset(0).unwrap();
            let snapshot = envs.snapshot().unwrap();
            let ids: Vec<usize> = (N - sent..N).rev().collect();
            if sent > 0 {
                envs.send(&Value::from(vec![0_i64; sent]), &ids).unwrap();
            }
            if received > 0 {
                let (mut ids, mut columns) = (Vec::new(), envs.columns().unwrap());
                envs.recv_into(received, &mut ids, &mut columns).unwrap();
                assert_eq!(ids.len(), received);
            }
            assert_eq!(envs.num_pending(), sent - received);
            assert_closes(&mut envs, &closed, &snapshot);
            assert_eq!(envs.num_pending(), 0);
        }
    }
}
