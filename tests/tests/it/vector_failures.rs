//! Vectors whose sub-environments fail or are slow.

use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};

use gym::vector::{AsyncVectorEnv, Autoreset, SyncVectorEnv, VectorReset};
use gym::{
    Env, Error, Outcome, Reset, Result, Snapshot, Space, Value, VectorEnv, VectorEnvExt, builder,
};

/// An environment that counts its steps. Action 1 is an error, action 2 panics, and action 3 takes
/// long. An episode ends at the 10th step.
#[derive(Clone, Debug, Default)]
pub(crate) struct Fragile {
    pub(crate) steps: i64,
    /// The number of times that action 3 was taken, including by clones.
    slept: Arc<AtomicUsize>,
}

impl Env for Fragile {
    type Observation = i64;
    type Action = u8;

    fn observation_space(&self) -> Space {
        Space::discrete(1000)
    }

    fn action_space(&self) -> Space {
        Space::discrete(4)
    }

    fn reset_into(&mut self, reset: &Reset, observation: &mut i64) -> Result<()> {
        if reset.options.contains_key("panic") {
            panic!("a bad reset");
        }
        (self.steps, *observation) = (0, 0);
        Ok(())
    }

    fn step_into(&mut self, action: &u8, observation: &mut i64) -> Result<Outcome> {
        match action {
            1 => return Err(Error::custom("not now")),
            2 => panic!("a bad step"),
            3 => {
                std::thread::sleep(std::time::Duration::from_millis(30));
                self.slept.fetch_add(1, Ordering::Relaxed);
            }
            _ => {}
        }
        self.steps += 1;
        *observation = self.steps;
        Ok(Outcome {
            reward: 1.0,
            terminated: self.steps == 10,
            truncated: false,
        })
    }

    fn snapshot(&self) -> Result<Snapshot> {
        Snapshot::of(&self.steps)
    }

    fn restore(&mut self, snapshot: &Snapshot) -> Result<()> {
        snapshot.get().map(|steps| self.steps = steps)
    }
}

pub(crate) fn fragile(n: usize) -> Vec<Fragile> {
    vec![Fragile::default(); n]
}

pub(crate) fn both(n: usize) -> [Box<dyn VectorEnv>; 2] {
    [
        Box::new(SyncVectorEnv::new(fragile(n)).unwrap()),
        Box::new(
            AsyncVectorEnv::new(fragile(n))
                .and_then(|pool| pool.with_threads(2))
                .unwrap(),
        ),
    ]
}

pub(crate) fn actions<const N: usize>(actions: [i64; N]) -> Value {
    Value::Array(actions.into())
}

pub(crate) fn ints(value: &Value) -> &[i64] {
    value.as_slice().unwrap()
}

#[test]
fn an_error_names_the_sub_environment_and_the_others_step() {
    for mut envs in both(3) {
        let mut columns = envs.reset(()).unwrap();
        envs.step_into(&actions([0, 0, 0]), &mut columns).unwrap();
        let error = envs
            .step_into(&actions([0, 1, 0]), &mut columns)
            .unwrap_err();
        assert_eq!(error.to_string(), "sub-environment 1: not now", "{envs:?}");
        assert_eq!(ints(&columns.observations), [2, 1, 2]);
        assert_eq!(columns.rewards, [1.0, 0.0, 1.0]);
        envs.step_into(&actions([0, 0, 0]), &mut columns).unwrap();
        assert_eq!(ints(&columns.observations), [3, 2, 3]);
    }
}

#[test]
fn a_panic_names_the_sub_environment_which_must_then_be_reset() {
    for mut envs in both(3) {
        let mut columns = envs.reset(()).unwrap();
        let error = envs
            .step_into(&actions([0, 0, 2]), &mut columns)
            .unwrap_err()
            .to_string();
        assert!(
            error.starts_with("sub-environment 2:") && error.contains("a bad step"),
            "{error}"
        );
        assert_eq!(ints(&columns.observations), [1, 1, 0]);
        let error = envs
            .step_into(&actions([0, 0, 0]), &mut columns)
            .unwrap_err()
            .to_string();
        assert!(
            error.starts_with("sub-environment 2:") && error.contains("reset"),
            "{error}"
        );
        assert_eq!(
            ints(&columns.observations),
            [1, 1, 0],
            "nothing has stepped"
        );
        envs.reset_into(
            &VectorReset::default().mask([false, false, true]),
            &mut columns,
        )
        .unwrap();
        envs.step_into(&actions([0, 0, 0]), &mut columns).unwrap();
        assert_eq!(ints(&columns.observations), [2, 2, 1]);
        let reset = VectorReset::default()
            .option("panic", true)
            .mask([true, false, false]);
        let error = envs
            .reset_into(&reset, &mut columns)
            .unwrap_err()
            .to_string();
        assert!(
            error.starts_with("sub-environment 0:") && error.contains("a bad reset"),
            "{error}"
        );
    }
}

#[test]
fn the_first_ready_are_received_and_the_slow_come_later() {
    let mut envs = AsyncVectorEnv::new(fragile(4))
        .and_then(|pool| pool.with_threads(2))
        .unwrap();
    let mut columns = envs.reset(()).unwrap();
    let mut ids = Vec::new();
    envs.send(&actions([3, 0, 0, 0]), &[2, 0, 1, 3]).unwrap();
    assert_eq!(envs.num_pending(), 4);
    envs.recv_into(3, &mut ids, &mut columns).unwrap();
    ids.sort_unstable();
    assert_eq!(
        (ids.as_slice(), ints(&columns.observations)),
        (&[0, 1, 3][..], &[1, 1, 1][..])
    );
    assert_eq!(columns.len(), 3);
    // a pending sub-environment can neither be sent to again nor stepped with the others
    let error = envs.send(&actions([0]), &[2]).unwrap_err().to_string();
    assert_eq!(
        error,
        "sub-environment 2: it is still pending: receive it first"
    );
    for error in [
        envs.step_into(&actions([0; 4]), &mut columns).unwrap_err(),
        envs.reset_into(&().into(), &mut columns).unwrap_err(),
        envs.call(|_, env| env.steps).unwrap_err(),
    ] {
        assert_eq!(
            error.to_string(),
            "1 sub-environments are pending: receive them first"
        );
    }
    envs.send(&actions([0]), &[3]).unwrap();
    for m in [0, 3] {
        assert!(matches!(
            envs.recv_into(m, &mut ids, &mut columns),
            Err(Error::InvalidArgument { .. })
        ));
    }
    envs.recv_into(2, &mut ids, &mut columns).unwrap();
    envs.step_into(&actions([0; 4]), &mut columns).unwrap();
    assert_eq!(ints(&columns.observations), [2, 2, 2, 3]);
    for (ids, batch) in [
        (&[4][..], &actions([0])),
        (&[1, 1], &actions([0, 0])),
        (&[1], &actions([0, 0])),
    ] {
        assert!(envs.send(batch, ids).is_err(), "{ids:?}");
        assert_eq!(envs.num_pending(), 0);
    }
}

#[test]
fn a_failed_step_is_received_alone() {
    let mut envs = AsyncVectorEnv::new(fragile(3))
        .and_then(|pool| pool.with_threads(3))
        .unwrap();
    let mut columns = envs.reset(()).unwrap();
    let mut ids = Vec::new();
    envs.send(&actions([0, 1, 0]), &[0, 1, 2]).unwrap();
    let error = envs
        .recv_into(3, &mut ids, &mut columns)
        .unwrap_err()
        .to_string();
    assert_eq!(error, "sub-environment 1: not now");
    assert_eq!(envs.num_pending(), 2);
    envs.recv_into(2, &mut ids, &mut columns).unwrap();
    assert_eq!(ints(&columns.observations), [1, 1]);
    envs.step_into(&actions([0, 0, 0]), &mut columns).unwrap();
    assert_eq!(ints(&columns.observations), [2, 1, 2]);
}

#[test]
fn drop_and_close_in_mid_flight_do_not_hang() {
    for close in [false, true] {
        // clones share the counter
        let fragile = fragile(64);
        let slept = Arc::clone(&fragile[0].slept);
        let mut envs = AsyncVectorEnv::new(fragile)
            .and_then(|pool| pool.with_threads(2))
            .unwrap();
        envs.reset(()).unwrap();
        envs.send(
            &Value::Array(vec![3i64; 64].into()),
            &(0..64).collect::<Vec<_>>(),
        )
        .unwrap();
        if close {
            envs.close();
            assert!(matches!(
                envs.step(&Value::Array(vec![0i64; 64].into())),
                Err(Error::SubEnvironment { index: 0, source }) if matches!(*source, Error::Closed("step"))
            ));
        } else {
            let slept = Arc::clone(&slept);
            drop(envs);
            // two steps of 30 ms are running; the others are dropped
            assert!(slept.load(Ordering::Relaxed) < 64);
        }
    }
}

#[test]
fn results_of_envs_received_out_of_order_do_not_depend_on_it() {
    let env = || (0..6).map(|_| builder("CartPole-v1").build().unwrap());
    let mut sync = SyncVectorEnv::new(env()).unwrap();
    let mut pool = AsyncVectorEnv::new(env())
        .and_then(|pool| pool.with_threads(3))
        .unwrap();
    let (mut a, mut b) = (sync.reset(1).unwrap(), pool.reset(1).unwrap());
    let mut observed = vec![Vec::new(); 6];
    let mut taken = [0; 6];
    let mut ids = vec![0, 1, 2, 3, 4, 5];
    let action = |id: usize, step: usize| ((id * 7 + step * 3) % 4 / 2) as i64;
    while taken.iter().any(|steps| *steps < 60) {
        let batch: Vec<i64> = ids.iter().map(|id| action(*id, taken[*id])).collect();
        ids.iter().for_each(|id| taken[*id] += 1);
        pool.send(&Value::Array(batch.into()), &ids).unwrap();
        pool.recv_into(2, &mut ids, &mut b).unwrap();
        for (row, id) in ids.iter().enumerate() {
            observed[*id]
                .push(b.observations.as_slice::<f32>().unwrap()[4 * row..4 * row + 4].to_vec());
        }
    }
    for step in 0..60 {
        let batch: Vec<i64> = (0..6).map(|id| action(id, step)).collect();
        sync.step_into(&Value::Array(batch.into()), &mut a).unwrap();
        for (id, observed) in observed.iter().enumerate() {
            if let Some(observed) = observed.get(step) {
                assert_eq!(
                    &a.observations.as_slice::<f32>().unwrap()[4 * id..4 * id + 4],
                    observed
                );
            }
        }
    }
}

/// An environment whose episodes end with the second step; only its first reset succeeds.
#[derive(Clone, Debug, Default)]
struct Once {
    steps: i64,
    resets: i64,
}

impl Env for Once {
    type Observation = i64;
    type Action = u8;

    fn observation_space(&self) -> Space {
        Space::discrete(10)
    }

    fn action_space(&self) -> Space {
        Space::discrete(2)
    }

    fn reset_into(&mut self, _: &Reset, observation: &mut i64) -> Result<()> {
        if self.resets > 0 {
            return Err(Error::custom("not again"));
        }
        (self.steps, self.resets, *observation) = (0, 1, 0);
        Ok(())
    }

    fn step_into(&mut self, _: &u8, observation: &mut i64) -> Result<Outcome> {
        self.steps += 1;
        *observation = self.steps;
        Ok(Outcome {
            reward: 1.0,
            terminated: self.steps == 2,
            truncated: false,
        })
    }

    fn info(&self, visit: &mut dyn FnMut(&str, Value)) {
        visit("steps", Value::Int(self.steps));
    }

    fn snapshot(&self) -> Result<Snapshot> {
        Snapshot::of(&self.steps)
    }

    fn restore(&mut self, snapshot: &Snapshot) -> Result<()> {
        snapshot.get().map(|steps| self.steps = steps)
    }
}

/// If the reset after an episode's last step fails, the sub-environment returns no reward, flag or
/// info.
#[test]
fn a_sub_environment_that_fails_to_reset_answers_nothing() {
    let envs = || vec![Once::default(); 2];
    let vectors: [Box<dyn VectorEnv>; 2] = [
        Box::new(
            SyncVectorEnv::new(envs())
                .unwrap()
                .with_autoreset(Autoreset::SameStep),
        ),
        Box::new(
            AsyncVectorEnv::new(envs())
                .unwrap()
                .with_autoreset(Autoreset::SameStep),
        ),
    ];
    for mut envs in vectors {
        let mut columns = envs.reset(()).unwrap();
        envs.step_into(&actions([0, 0]), &mut columns).unwrap();
        let error = envs
            .step_into(&actions([0, 0]), &mut columns)
            .unwrap_err()
            .to_string();
        assert_eq!(error, "sub-environment 0: not again");
        let shown = (
            columns.rewards[0],
            columns.terminated[0],
            columns.has_final[0],
            columns.progress[0],
        );
        assert_eq!(shown, (0.0, false, false, gym::vector::Progress::Unchanged));
        assert!(envs.info_map(0).is_empty());
    }
}

/// An environment that panics in one of its functions, counted from the second sub-environment on.
#[derive(Clone, Debug, Default)]
struct Panics(&'static str);

impl Panics {
    fn maybe(&self, place: &str) {
        assert!(self.0 != place, "a bad {place}");
    }
}

impl Drop for Panics {
    fn drop(&mut self) {
        self.maybe("drop");
    }
}

impl Env for Panics {
    type Observation = i64;
    type Action = u8;

    fn observation_space(&self) -> Space {
        Space::discrete(2)
    }

    fn action_space(&self) -> Space {
        Space::discrete(2)
    }

    fn reset_into(&mut self, _: &Reset, observation: &mut i64) -> Result<()> {
        *observation = 0;
        Ok(())
    }

    fn step_into(&mut self, _: &u8, _: &mut i64) -> Result<Outcome> {
        Ok(Outcome::default())
    }

    fn snapshot(&self) -> Result<Snapshot> {
        self.maybe("snapshot");
        Snapshot::of(&1)
    }

    fn restore(&mut self, _: &Snapshot) -> Result<()> {
        self.maybe("restore");
        Ok(())
    }

    fn close(&mut self) {
        self.maybe("close");
    }
}

/// The panics of `reset` and `step` are errors; so are those of every other function.
#[test]
fn a_panic_anywhere_stays_within_the_vector() {
    let envs = |place| [Panics(""), Panics(place), Panics("")];
    type Make = fn([Panics; 3]) -> Box<dyn VectorEnv>;
    let kinds: [Make; 2] = [
        |envs| Box::new(SyncVectorEnv::new(envs).unwrap()),
        |envs| Box::new(AsyncVectorEnv::new(envs).unwrap()),
    ];
    for make in kinds {
        for place in ["snapshot", "restore", "close", "drop"] {
            let mut vector = make(envs(place));
            vector.reset(1).unwrap();
            let snapshot = vector.snapshot();
            let named = |error: Error| {
                let text = error.to_string();
                assert!(
                    text.contains("sub-environment 1") && text.contains(&format!("a bad {place}")),
                    "{text}"
                );
            };
            match (place, snapshot) {
                ("snapshot", snapshot) => named(snapshot.unwrap_err()),
                ("restore", snapshot) => {
                    named(vector.restore(&snapshot.unwrap()).unwrap_err());
                    // nothing has changed
                    vector.step(&Value::from(vec![0i64; 3])).unwrap();
                }
                _ => vector.close(),
            }
        }
    }
    let made = |index: usize| {
        assert!(index != 1, "a bad beginning");
        Ok(Panics(""))
    };
    let spec = builder("CartPole-v1").spec().unwrap();
    let spec = gym::vector::VectorSpec::new(spec, 3, gym::registry::VectorKind::Native);
    let error = SyncVectorEnv::native(&spec, Default::default(), made)
        .err()
        .unwrap()
        .to_string();
    assert!(
        error.contains("sub-environment 1") && error.contains("a bad beginning"),
        "{error}"
    );
}
