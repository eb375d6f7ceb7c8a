//! Groups of sub-environments on threads: tests of the returned error and of the written rows.

use gym_core::vector::{AsyncVectorEnv, Autoreset, Columns};
use gym_core::{Array, Env, Error, Outcome, Reset, Result, Space, Value, VectorEnv, VectorEnvExt};

/// An environment that observes `100 * number + steps`. The action 9 terminates the episode, the
/// action 7 is an error.
#[derive(Clone, Debug)]
struct Numbered {
    number: i64,
    steps: i64,
}

impl Env for Numbered {
    type Observation = i64;
    type Action = i64;

    fn observation_space(&self) -> Space {
        Space::discrete(10_000)
    }

    fn action_space(&self) -> Space {
        Space::discrete(10)
    }

    fn reset_into(&mut self, _: &Reset, observation: &mut i64) -> Result<()> {
        self.steps = 0;
        *observation = 100 * self.number;
        Ok(())
    }

    fn step_into(&mut self, action: &i64, observation: &mut i64) -> Result<Outcome> {
        if *action == 7 {
            return Err(Error::custom("the action 7 fails"));
        }
        self.steps += 1;
        *observation = 100 * self.number + self.steps;
        Ok(Outcome {
            reward: *action as f64,
            terminated: *action == 9,
            truncated: false,
        })
    }
}

/// Returns a vector on two threads, each of which steps groups of two sub-environments.
fn vector(autoreset: Autoreset) -> AsyncVectorEnv<Numbered> {
    let envs = (0..12).map(|number| Numbered { number, steps: 0 });
    let envs = AsyncVectorEnv::new(envs).unwrap();
    let mut envs = envs.with_threads(2).unwrap().with_autoreset(autoreset);
    envs.reset(0).unwrap();
    envs
}

/// Returns the actions of a step: `action` for the sub-environments `at`, and 0 for the others.
fn actions(action: i64, at: &[usize]) -> Value {
    let actions: Vec<i64> = (0..12)
        .map(|i| if at.contains(&i) { action } else { 0 })
        .collect();
    Value::Array(Array::from(actions))
}

fn failed(result: Result<()>) -> usize {
    match result {
        Err(Error::SubEnvironment { index, .. }) => index,
        other => panic!("{other:?}"),
    }
}

/// Of several errors, a call returns the error with the lowest index, in one group or in several
/// groups.
#[test]
fn the_error_of_the_lowest_index_is_returned() {
    for at in [&[4, 5][..], &[5, 8], &[3, 4, 9, 11], &[1, 10, 11], &[11]] {
        for _ in 0..5 {
            let mut envs = vector(Autoreset::NextStep);
            let mut columns = envs.columns().unwrap();
            let result = envs.step_into(&actions(7, at), &mut columns);
            assert_eq!(failed(result), at[0], "{at:?}");
        }
    }
}

/// A final observation is in the row of its sub-environment, even in the middle of a group.
#[test]
fn last_observations_have_the_rows_of_their_sub_environments() {
    for at in 0..12 {
        let mut envs = vector(Autoreset::SameStep);
        let mut columns = envs.columns().unwrap();
        envs.step_into(&actions(9, &[at]), &mut columns).unwrap();
        let rows = |value: &Value| -> Vec<i64> {
            let array = value.as_array().unwrap();
            array.as_slice::<i64>().unwrap().to_vec()
        };
        let ended: Vec<usize> = (0..12).filter(|i| columns.has_final[*i]).collect();
        assert_eq!(ended, [at]);
        assert_eq!(rows(&columns.final_observations)[at], 100 * at as i64 + 1);
        assert_eq!(rows(&columns.observations)[at], 100 * at as i64);
    }
}

#[test]
fn none_and_more_than_are_pending_cannot_be_received() {
    let mut envs = vector(Autoreset::NextStep);
    let (mut ids, mut columns) = (vec![99], Columns::default());
    let mut refused = |envs: &mut AsyncVectorEnv<Numbered>, m| {
        let error = envs
            .recv_into(m, &mut ids, &mut columns)
            .unwrap_err()
            .to_string();
        assert!(
            error.contains(&format!("m is {m}: it must be from 1 to")),
            "{error}"
        );
    };
    refused(&mut envs, 0);
    refused(&mut envs, 1);
    envs.send(&Value::Array(Array::from(vec![1_i64, 2])), &[3, 8])
        .unwrap();
    refused(&mut envs, 0);
    refused(&mut envs, 3);
    let (mut ids, mut columns) = (Vec::new(), Columns::default());
    envs.recv_into(2, &mut ids, &mut columns).unwrap();
    ids.sort_unstable();
    assert_eq!(ids, [3, 8]);
}

/// Each option of a vector keeps the others and the sub-environments; there are no more threads than those.
#[test]
fn options_keep_one_another() {
    let actions = Value::Array(Array::from(vec![0_i64; 4]));
    for mode in [
        Autoreset::NextStep,
        Autoreset::SameStep,
        Autoreset::Disabled,
    ] {
        for (asked, threads) in [(1, 1), (3, 3), (4, 4), (5, 4), (1024, 4)] {
            let new = || {
                let envs = (0..4).map(|number| Numbered { number, steps: 0 });
                let mut envs = AsyncVectorEnv::new(envs).unwrap();
                envs.reset(0).unwrap();
                envs.step(&actions).unwrap();
                envs
            };
            let one = new().with_autoreset(mode).with_threads(asked).unwrap();
            let other = new().with_threads(asked).unwrap().with_autoreset(mode);
            for mut envs in [one, other] {
                assert_eq!((envs.autoreset(), envs.num_threads()), (mode, threads));
                let columns = envs.step(&actions).unwrap();
                let known = Array::from(vec![2_i64, 102, 202, 302]);
                assert_eq!(columns.observations, Value::Array(known));
            }
        }
    }
}
