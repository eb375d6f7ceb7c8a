//! Snapshots of wrappers. A restored wrapper continues with its whole state. A snapshot of a
//! wrapper of another size, or with impossible numbers, is refused and changes nothing.

use gym_core::spaces::BoxSpace;
use gym_core::vector::{Autoreset, SyncVectorEnv, VectorReset};
use gym_core::wrappers::TimeLimit;
use gym_core::{
    Array, BoxEnv, DType, Env, EnvExt, Error, Generator, Outcome, Reset, Result, Snapshot, Space,
    Step, Value, VectorEnv, VectorEnvExt,
};
use gym_wrappers::{
    Autoreset as AutoresetWrapper, DelayObservation, DiscretizeAction, FrameStackObservation,
    MaxAndSkipObservation, NormalizeObservation, NormalizeReward, RepeatAction, RunningMeanStd,
    StickyAction, TimeAwareObservation, normalize_observation, sticky_action,
    time_aware_observation,
};
use serde_json::{Value as Json, json};

/// An environment that observes the square of its step count, with alternating sign. An episode has
/// `length` steps. Actions above 4 are errors.
#[derive(Clone, Debug)]
struct Squares {
    length: i64,
    steps: i64,
    rng: Generator,
}

impl Squares {
    fn new(length: i64) -> Self {
        Self {
            length,
            steps: 0,
            rng: Generator::from(0),
        }
    }
}

impl Env for Squares {
    type Observation = Value;
    type Action = i64;

    fn observation_space(&self) -> Space {
        BoxSpace::uniform(-1e6, 1e6, [1], DType::F64)
            .unwrap()
            .into()
    }

    fn action_space(&self) -> Space {
        Space::discrete(5)
    }

    fn reset_into(&mut self, reset: &Reset, observation: &mut Value) -> Result<()> {
        (self.steps, self.rng) = (0, reset.generator(Some(&self.rng))?);
        *observation = Value::from([0.0]);
        Ok(())
    }

    fn step_into(&mut self, action: &i64, observation: &mut Value) -> Result<Outcome> {
        if *action > 4 {
            return Err(Error::custom("the action is refused"));
        }
        self.steps += 1;
        let sign = if self.steps % 2 == 0 { 1 } else { -1 };
        *observation = Value::from([(sign * self.steps * self.steps + action) as f64]);
        Ok(Outcome {
            reward: (self.steps + action) as f64,
            terminated: self.steps == self.length,
            truncated: false,
        })
    }

    fn generator(&mut self) -> Option<&mut Generator> {
        Some(&mut self.rng)
    }

    fn snapshot(&self) -> Result<Snapshot> {
        Snapshot::of(&(self.steps, &self.rng))
    }

    fn restore(&mut self, snapshot: &Snapshot) -> Result<()> {
        (self.steps, self.rng) = snapshot.get()?;
        Ok(())
    }
}

/// Plays an episode. From each state, restores a used wrapper and checks that it continues with the
/// same steps.
fn continues_everywhere<E: Env<Action = i64>>(make: impl Fn() -> E)
where
    Step<E::Observation>: PartialEq,
{
    let mut env = make();
    env.reset(3).unwrap();
    for step in 0.. {
        let snapshot = env.snapshot().unwrap();
        let mut other = make();
        other.reset(9).unwrap();
        for action in [4, 3, 4] {
            if other.step(&action).unwrap().done() {
                other.reset(()).unwrap();
            }
        }
        other.restore(&snapshot).unwrap();
        assert_eq!(other.snapshot().unwrap(), snapshot, "step {step}");
        let mut ahead = env.clone();
        for action in (0..12).map(|i| (i + step) % 5) {
            let [a, b] = [&mut ahead, &mut other].map(|env| env.step(&action).unwrap());
            assert_eq!(a, b, "from step {step}, {}", ahead.describe());
            if a.done() {
                assert_eq!(ahead.reset(()).unwrap(), other.reset(()).unwrap());
            }
        }
        if env.step(&(step % 3)).unwrap().done() {
            break;
        }
    }
}

fn normal() -> normalize_observation::Config {
    normalize_observation::Config::default()
}

/// 23 is not a multiple of the repeated steps, so an episode ends during a repetition.
#[test]
fn every_state_continues() {
    continues_everywhere(|| FrameStackObservation::new(Squares::new(23), 4).unwrap());
    continues_everywhere(|| DelayObservation::new(Squares::new(23), 3).unwrap());
    for skip in 2..6 {
        continues_everywhere(|| MaxAndSkipObservation::new(Squares::new(23), skip).unwrap());
    }
    continues_everywhere(|| NormalizeObservation::new(Squares::new(23), normal()).unwrap());
    continues_everywhere(|| NormalizeReward::new(Squares::new(23), 0.9).unwrap());
    continues_everywhere(|| RepeatAction::new(Squares::new(23), 3).unwrap());
    continues_everywhere(|| StickyAction::new(Squares::new(23), (0.6, 2..=4)).unwrap());
    let config = time_aware_observation::Config {
        max_timesteps: Some(30),
        ..Default::default()
    };
    continues_everywhere(|| TimeAwareObservation::new(Squares::new(23), config.clone()).unwrap());
}

/// If an episode ends during a repetition, the maximum uses earlier observations, even from before
/// a snapshot.
#[test]
fn the_last_observations_of_a_series_are_stored() {
    let make = || MaxAndSkipObservation::new(Squares::new(9), 4).unwrap();
    let mut env = make();
    env.reset(0).unwrap();
    env.step(&0).unwrap();
    let seen = env.step(&0).unwrap().observation;
    assert_eq!(seen, Value::from([64.0]));
    let mut fresh = make();
    fresh.restore(&env.snapshot().unwrap()).unwrap();
    // the ninth step, the first step of a repetition, ends the episode
    let last = fresh.step(&0).unwrap();
    assert!(last.terminated);
    assert_eq!(last.observation, Value::from([64.0]));
}

/// The observation of a step is the maximum of the last two inner observations, even if the last is
/// smaller.
#[test]
fn the_larger_of_the_last_two_observations_is_shown() {
    for (skip, largest) in [(2, 4.0), (3, 4.0), (4, 16.0), (5, 16.0)] {
        let mut env = MaxAndSkipObservation::new(Squares::new(9), skip).unwrap();
        env.reset(0).unwrap();
        assert_eq!(
            env.step(&0).unwrap().observation,
            Value::from([largest]),
            "{skip}"
        );
    }
}

/// A reset by the caller replaces the autoreset.
#[test]
fn a_reset_by_hand_leaves_no_reset_due() {
    let mut env = AutoresetWrapper::new(Squares::new(2));
    env.reset(0).unwrap();
    env.step(&0).unwrap();
    assert!(env.step(&0).unwrap().terminated);
    env.reset(0).unwrap();
    assert_eq!(env.step(&0).unwrap().observation, Value::from([-1.0]));
}

/// A step that the environment refuses draws nothing, so the next step is the same as without it.
#[test]
fn a_refused_step_draws_nothing() {
    let make = || {
        let mut env = StickyAction::new(Squares::new(80), 0.5).unwrap();
        env.reset(1).unwrap();
        env
    };
    let (mut plain, mut asked) = (make(), make());
    let mut refusals = 0;
    for step in 0..40 {
        let before = asked.snapshot().unwrap();
        match asked.step(&7) {
            Err(_) => {
                refusals += 1;
                assert_eq!(asked.snapshot().unwrap(), before, "step {step}");
            }
            // the wrapper has repeated the last action instead of the invalid action
            Ok(_) => asked.restore(&before).unwrap(),
        }
        let action = step % 4;
        assert_eq!(
            asked.step(&action).unwrap(),
            plain.step(&action).unwrap(),
            "step {step}"
        );
    }
    assert!((5..35).contains(&refusals), "{refusals}");
}

/// A snapshot contains whether the next step is an autoreset.
#[test]
fn a_due_reset_is_stored() {
    let mut env = AutoresetWrapper::new(Squares::new(2));
    env.reset(0).unwrap();
    let start = env.snapshot().unwrap();
    env.step(&0).unwrap();
    assert!(env.step(&0).unwrap().terminated);
    let end = env.snapshot().unwrap();
    let mut other = AutoresetWrapper::new(Squares::new(2));
    other.restore(&end).unwrap();
    assert_eq!(other.step(&0).unwrap().observation, Value::from([0.0]));
    env.restore(&start).unwrap();
    assert_eq!(env.step(&0).unwrap().observation, Value::from([-1.0]));
}

fn refused<E: Env>(env: &mut E, snapshot: &Snapshot, words: &str) {
    let before = env.snapshot().unwrap();
    let error = env.restore(snapshot).unwrap_err().to_string();
    assert!(error.contains(words), "{}: {error}", env.describe());
    assert_eq!(env.snapshot().unwrap(), before, "{}", env.describe());
}

/// Returns a vector of `n` environments.
fn vector(n: usize) -> NormalizeReward<SyncVectorEnv<Squares>> {
    let envs = SyncVectorEnv::new(vec![Squares::new(9); n]).unwrap();
    let mut envs = NormalizeReward::new(envs, 0.9).unwrap();
    envs.reset(0).unwrap();
    envs
}

#[test]
fn returns_of_another_number_of_environments_are_refused() {
    let json = |snapshot: Result<Snapshot>| json!(snapshot.unwrap());
    let (mut one, mut two) = (
        NormalizeReward::new(Squares::new(9), 0.9).unwrap(),
        vector(2),
    );
    one.reset(0).unwrap();
    let returns = [1, 2, 3].map(|n| json(vector(n).snapshot())[1][2].clone());
    for wrong in &returns[1..] {
        let mut snapshot = json(one.snapshot());
        snapshot[1][2] = wrong.clone();
        refused(
            &mut one,
            &serde_json::from_value(snapshot).unwrap(),
            "expected 1 numbers",
        );
    }
    for wrong in [&returns[0], &returns[2]] {
        let (before, mut snapshot) = (two.snapshot().unwrap(), json(two.snapshot()));
        snapshot[1][2] = wrong.clone();
        let result = two.restore(&serde_json::from_value(snapshot).unwrap());
        let error = result.unwrap_err().to_string();
        assert!(error.contains("expected 2 numbers"), "{error}");
        assert_eq!(two.snapshot().unwrap(), before);
    }
}

/// A wrapper refuses snapshots of larger and of smaller wrappers.
#[test]
fn snapshots_of_another_size_are_refused() {
    let stack = |n| {
        let mut env = FrameStackObservation::new(Squares::new(9), n).unwrap();
        env.reset(0).unwrap();
        env
    };
    let delay = |n| {
        let mut env = DelayObservation::new(Squares::new(9), n).unwrap();
        env.reset(0).unwrap();
        env
    };
    for (from, into) in [(4, 2), (2, 4), (1, 2), (2, 1)] {
        let words = format!("it has {from} observations, not {into}");
        refused(&mut stack(into), &stack(from).snapshot().unwrap(), &words);
        refused(&mut delay(into), &delay(from).snapshot().unwrap(), &words);
    }
    refused(
        &mut delay(0),
        &delay(1).snapshot().unwrap(),
        "it has 1 observations, not 0",
    );
    for (from, into) in [(3, 2), (2, 3)] {
        assert!(
            vector(into)
                .restore(&vector(from).snapshot().unwrap())
                .is_err()
        );
    }
}

/// Returns the first value of `key`, at any depth.
fn find<'a>(json: &'a mut Json, key: &str) -> Option<&'a mut Json> {
    if json.get(key).is_some() {
        return json.get_mut(key);
    }
    match json {
        Json::Object(entries) => entries.values_mut().find_map(|json| find(json, key)),
        Json::Array(items) => items.iter_mut().find_map(|json| find(json, key)),
        _ => None,
    }
}

/// Returns `snapshot` with the value of `key` replaced by `other`.
fn changed(snapshot: &Snapshot, key: &str, other: Json) -> Snapshot {
    let mut json: Json = serde_json::to_value(snapshot).unwrap();
    *find(&mut json, key).unwrap_or_else(|| panic!("{key} in {snapshot:?}")) = other;
    serde_json::from_value(json).unwrap()
}

/// Counts and repeats that no wrapper can reach are refused.
#[test]
fn numbers_that_no_wrapper_has_are_refused() {
    let mut env = NormalizeObservation::new(Squares::new(9), normal()).unwrap();
    env.reset(0).unwrap();
    let snapshot = env.snapshot().unwrap();
    for count in [
        json!(0.0),
        json!(-1.0),
        json!({"$float": "inf"}),
        json!({"$float": "nan"}),
    ] {
        refused(&mut env, &changed(&snapshot, "count", count), "");
    }
    let moments = |count| RunningMeanStd::from_moments(&[0.5].into(), &[1.0].into(), count);
    for count in [0.0, -1.0, f64::INFINITY, f64::NEG_INFINITY, f64::NAN] {
        let error = moments(count).unwrap_err();
        assert!(matches!(error, Error::InvalidArgument { .. }), "{count}");
    }
    for count in [1e-4, 1.0, 1e300] {
        assert_eq!(moments(count).unwrap().count(), count);
    }
    for variance in [-1e-300, f64::NAN, f64::NEG_INFINITY] {
        assert!(RunningMeanStd::from_moments(&[0.5].into(), &[variance].into(), 1.0).is_err());
    }

    let mut env = StickyAction::new(Squares::new(9), (0.999, 3..=3)).unwrap();
    env.reset(0).unwrap();
    env.step(&1).unwrap();
    env.step(&2).unwrap();
    let snapshot = env.snapshot().unwrap();
    for (key, other) in [
        ("is_stuck", json!(false)),
        ("repeats_taken", json!(3)),
        ("num_repeats", json!(1)),
    ] {
        let words = "the repeats do not add up";
        refused(&mut env, &changed(&snapshot, key, other), words);
    }
}

/// Checks both ends of each argument's range.
#[test]
fn the_ends_of_arguments() {
    let sticky = |probability: f64, low, high| {
        let config: sticky_action::Config = (probability, low..=high).into();
        StickyAction::new(Squares::new(9), config).is_ok()
    };
    assert!(sticky(0.0, 1, 1) && sticky(0.999, 1, 9) && sticky(0.5, 9, 9));
    assert!(!sticky(-1e-9, 1, 1) && !sticky(1.0, 1, 1) && !sticky(f64::NAN, 1, 1));
    assert!(!sticky(0.5, 0, 1) && !sticky(0.5, 3, 2));
    let gamma = |gamma: f64| NormalizeReward::new(Squares::new(9), gamma).is_ok();
    assert!(gamma(0.0) && gamma(1.0));
    assert!(!gamma(-1e-9) && !gamma(1.0 + 1e-9) && !gamma(f64::NAN));
    let limit = |max_timesteps: u32| {
        let config = time_aware_observation::Config {
            max_timesteps: Some(max_timesteps),
            ..Default::default()
        };
        TimeAwareObservation::new(Squares::new(9), config).is_ok()
    };
    assert!(limit(1) && limit(i32::MAX as u32));
    assert!(!limit(0) && !limit(i32::MAX as u32 + 1));
    assert!(MaxAndSkipObservation::new(Squares::new(9), 1).is_err());
    assert!(RepeatAction::new(Squares::new(9), 0).is_err());
    assert!(FrameStackObservation::new(Squares::new(9), 0).is_err());
}

/// A box whose width is the smallest positive number. The step between bins is then too small for
/// the type, and numpy's `linspace` divides before it multiplies.
#[test]
fn bins_of_the_narrowest_box_are_numpys() {
    #[derive(Clone, Debug)]
    struct Narrow(Space);

    impl Env for Narrow {
        type Observation = Value;
        type Action = Value;

        fn observation_space(&self) -> Space {
            self.0.clone()
        }

        fn action_space(&self) -> Space {
            self.0.clone()
        }

        fn reset_into(&mut self, _: &Reset, observation: &mut Value) -> Result<()> {
            *observation = self.0.zero()?;
            Ok(())
        }

        fn step_into(&mut self, action: &Value, observation: &mut Value) -> Result<Outcome> {
            observation.clone_from(action);
            Ok(Outcome::default())
        }
    }

    // np.linspace(0, tiny, 4) is [0, 0, tiny, tiny] in either type: its step, a third, is 0
    for (space, tiny) in [
        (Space::boxed([0.0_f32], [1e-45]), f64::from(1e-45_f32)),
        (
            BoxSpace::uniform(0.0, 5e-324, [1], DType::F64)
                .unwrap()
                .into(),
            5e-324,
        ),
    ] {
        let mut env = DiscretizeAction::new(BoxEnv::new(Narrow(space.clone())), 3).unwrap();
        env.reset(0).unwrap();
        let centers = [0, 1, 2].map(|bin| {
            let seen = env.step(&Value::Int(bin)).unwrap().observation;
            seen.as_array().unwrap().iter_f64().next().unwrap()
        });
        assert_eq!(centers, [0.0, 0.0, tiny], "{space}");
    }
}

/// In SameStep mode, the call that ends an episode begins the next episode, so the return restarts.
/// A masked reset restarts the selected returns.
#[test]
fn discounted_returns_start_anew() {
    let returns = |mode, length, mask: Option<[bool; 2]>| {
        let envs = SyncVectorEnv::new(vec![Squares::new(length); 2]).unwrap();
        let mut envs = NormalizeReward::new(envs.with_autoreset(mode), 1.0).unwrap();
        envs.reset(0).unwrap();
        for _ in 0..2 {
            envs.step(&Value::from([0_i64, 0])).unwrap();
        }
        if let Some(mask) = mask {
            envs.reset(VectorReset::default().mask(mask)).unwrap();
        }
        type Stored = (Snapshot, (RunningMeanStd, bool, Array));
        let (_, (_, _, returns)) = envs.snapshot().unwrap().get::<Stored>().unwrap();
        returns.iter_f64().collect::<Vec<_>>()
    };
    for mode in [
        Autoreset::NextStep,
        Autoreset::SameStep,
        Autoreset::Disabled,
    ] {
        assert_eq!(returns(mode, 9, None), [3.0, 3.0], "{mode:?}");
        assert_eq!(
            returns(mode, 9, Some([false, true])),
            [3.0, 0.0],
            "{mode:?}"
        );
        assert_eq!(returns(mode, 9, Some([true, true])), [0.0, 0.0], "{mode:?}");
    }
    // truncated episodes restart the return too, but only in SameStep mode
    let truncated = |mode| {
        let limited = || TimeLimit::new(Squares::new(9), 2).unwrap();
        let envs = SyncVectorEnv::new([limited(), limited()]).unwrap();
        let mut envs = NormalizeReward::new(envs.with_autoreset(mode), 1.0).unwrap();
        envs.reset(0).unwrap();
        for _ in 0..2 {
            envs.step(&Value::from([0_i64, 0])).unwrap();
        }
        type Stored = (Snapshot, (RunningMeanStd, bool, Array));
        let (_, (_, _, returns)) = envs.snapshot().unwrap().get::<Stored>().unwrap();
        returns.iter_f64().collect::<Vec<_>>()
    };
    assert_eq!(truncated(Autoreset::SameStep), [0.0, 0.0]);
    assert_eq!(truncated(Autoreset::NextStep), [3.0, 3.0]);
    assert_eq!(truncated(Autoreset::Disabled), [3.0, 3.0]);
    // a terminated step drops the earlier rewards; in SameStep mode, its own reward too
    assert_eq!(returns(Autoreset::NextStep, 2, None), [2.0, 2.0]);
    assert_eq!(returns(Autoreset::SameStep, 2, None), [0.0, 0.0]);
}

/// A restored estimate is frozen if the snapshot's estimate was frozen.
#[test]
fn a_frozen_estimate_stays_frozen() {
    for frozen in [true, false] {
        let mut env = NormalizeReward::new(Squares::new(23), 0.9).unwrap();
        env.reset(0).unwrap();
        env.step(&0).unwrap();
        env.update_running_mean(!frozen);
        let snapshot = env.snapshot().unwrap();
        env.update_running_mean(frozen);
        env.restore(&snapshot).unwrap();
        let before = env.statistics().clone();
        env.step(&0).unwrap();
        assert_eq!(*env.statistics() == before, frozen);
    }
}

/// A repetition ends when the episode ends, also by a time limit.
#[test]
fn a_limit_of_time_ends_a_repetition() {
    for (limit, ended) in [(3, 3), (4, 1), (5, 2)] {
        let inner = TimeLimit::new(Squares::new(23), limit).unwrap();
        let mut env = RepeatAction::new(inner, 3).unwrap();
        env.reset(0).unwrap();
        if limit > 3 {
            assert!(!env.step(&1).unwrap().done());
        }
        let last = env.step(&1).unwrap();
        assert!(last.truncated && !last.terminated, "{limit}");
        let single = |steps: u32| {
            let mut env = Squares::new(23);
            env.reset(0).unwrap();
            let rewards = (0..steps).map(|_| env.step(&1).unwrap().reward);
            rewards.sum::<f64>()
        };
        assert_eq!(
            last.reward,
            single(limit) - single(limit - ended),
            "{limit}"
        );
    }
}

/// The observed time is a fraction of the limit, even with the smallest limit.
#[test]
fn the_last_step_has_all_the_time() {
    for limit in [1, 2, 9] {
        let config = time_aware_observation::Config {
            max_timesteps: Some(limit),
            normalize_time: true,
            ..Default::default()
        };
        let mut env = TimeAwareObservation::new(Squares::new(23), config).unwrap();
        env.reset(0).unwrap();
        let times = (0..limit).map(|_| {
            let seen = env.step(&0).unwrap().observation;
            seen.as_array().unwrap().iter_f64().last().unwrap()
        });
        let expected = (1..=limit).map(|step| f64::from(step as f32 / limit as f32));
        assert!(times.eq(expected), "{limit}");
    }
}

#[test]
fn the_time_has_the_key_that_was_given() {
    let config = |key: &str| time_aware_observation::Config {
        max_timesteps: Some(9),
        flatten: false,
        dict_time_key: key.to_owned(),
        ..Default::default()
    };
    let inner = TimeAwareObservation::new(Squares::new(23), config("time")).unwrap();
    let mut env = TimeAwareObservation::new(inner, config("clock")).unwrap();
    env.reset(0).unwrap();
    let seen = env.step(&0).unwrap().observation;
    env.observation_space().check(&seen).unwrap();
    let time = |key| seen.get(key).and_then(gym_core::Value::as_array);
    assert!(
        time("clock").is_some() && time("clock") == time("time"),
        "{seen}"
    );
}
