//! Threads of vectors that are bound to cores.

use gym_core::vector::AsyncVectorEnv;
use gym_core::{Env, Outcome, Reset, Result, Space, Value, VectorEnv, VectorEnvExt};

/// The observation of a thread that may run on several cores.
const FREE: i64 = 4095;

/// An environment that observes the core to which its thread is bound.
#[derive(Clone, Debug)]
struct Placed;

impl Env for Placed {
    type Observation = i64;
    type Action = i64;

    fn observation_space(&self) -> Space {
        Space::discrete(FREE + 1)
    }

    fn action_space(&self) -> Space {
        Space::discrete(2)
    }

    fn reset_into(&mut self, _: &Reset, observation: &mut i64) -> Result<()> {
        *observation = match core_affinity::get_core_ids().as_deref() {
            Some([core]) => core.id as i64,
            _ => FREE,
        };
        Ok(())
    }

    fn step_into(&mut self, _: &i64, observation: &mut i64) -> Result<Outcome> {
        self.reset_into(&Reset::default(), observation)?;
        Ok(Outcome::default())
    }
}

fn vector(threads: usize) -> AsyncVectorEnv<Placed> {
    let envs = AsyncVectorEnv::new((0..12).map(|_| Placed)).unwrap();
    envs.with_threads(threads).unwrap()
}

/// The cores on which the sub-environments step.
fn cores(envs: &mut AsyncVectorEnv<Placed>) -> Vec<usize> {
    let mut columns = envs.reset(0).unwrap();
    let actions = envs.action_sampler(0).unwrap().sample();
    envs.step_into(&actions, &mut columns).unwrap();
    let Value::Array(seen) = &columns.observations else {
        panic!("{:?}", columns.observations);
    };
    seen.iter_f64().map(|core| core as usize).collect()
}

#[test]
fn threads_are_bound_to_cores_one_after_the_other() {
    let all = core_affinity::get_core_ids().unwrap();
    let n = all.len();
    for first in [0, n - 1] {
        let [own, next] = [0, 1].map(|k| all[(first + k) % n].id);
        let mut envs = vector(1).with_affinity(first).unwrap();
        assert_eq!(cores(&mut envs), [own; 12]);
        // other threads are bound too
        let mut envs = envs.with_threads(2).unwrap();
        let seen = cores(&mut envs);
        assert!(
            seen.iter().all(|core| [own, next].contains(core)),
            "{seen:?}"
        );
        assert_eq!(cores(&mut envs.with_threads(1).unwrap()), [own; 12]);
    }
    if n > 1 {
        assert_eq!(cores(&mut vector(2)), [FREE as usize; 12]);
    }
}

#[test]
fn a_core_that_is_not_there_is_refused() {
    let n = core_affinity::get_core_ids().unwrap().len();
    for first in [n, usize::MAX] {
        let error = vector(1).with_affinity(first).unwrap_err().to_string();
        assert!(error.contains(&format!("affinity is {first}")), "{error}");
    }
}
