//! Tests the results of wrappers for given observations and rewards, in steps and resets.

use gym_core::spaces::{
    BoxSpace, DictSpace, Discrete, GraphSpace, MultiBinary, MultiDiscrete, OneOfSpace, TextSpace,
    TupleSpace,
};
use gym_core::vector::{Autoreset, SyncVectorEnv};
use gym_core::{
    Array, BoxEnv, DType, Data, Env, EnvExt, Generator, GraphInstance, Outcome, Reset, Result,
    Space, Value, VectorEnv, VectorEnvExt, WrapperSpec,
};
use gym_wrappers::{
    ClipReward, FrameStackObservation, NormalizeObservation, NormalizeReward, RunningMeanStd,
    StickyAction, TransformObservation, VectorWrap, Wrap, frame_stack_observation,
    normalize_observation,
};
use serde_json::json;

/// An environment that returns given observations and rewards, one after the other. The last
/// observation ends the episode.
#[derive(Clone, Debug)]
struct Script {
    space: Space,
    observations: Vec<Value>,
    rewards: Vec<f64>,
    steps: usize,
    rng: Generator,
}

impl Script {
    fn new(space: impl Into<Space>, observations: Vec<Value>) -> Self {
        let rewards = vec![0.0; observations.len()];
        Self {
            space: space.into(),
            observations,
            rewards,
            steps: 0,
            rng: Generator::from(0),
        }
    }

    /// Makes an environment whose observations are `n` samples of a space.
    fn sampled(space: impl Into<Space>, n: usize) -> Self {
        let space = space.into();
        let mut sampler = space.sampler(3);
        let observations = (0..n).map(|_| sampler.sample()).collect();
        Self::new(space, observations)
    }

    fn rewarded(rewards: &[f64]) -> Self {
        let observations = vec![Value::Int(0); rewards.len() + 1];
        Self {
            rewards: rewards.to_vec(),
            ..Self::new(Space::discrete(2), observations)
        }
    }
}

impl Env for Script {
    type Observation = Value;
    type Action = i64;

    fn observation_space(&self) -> Space {
        self.space.clone()
    }

    fn action_space(&self) -> Space {
        Space::discrete(5)
    }

    fn reset_into(&mut self, reset: &Reset, observation: &mut Value) -> Result<()> {
        (self.steps, self.rng) = (0, reset.generator(Some(&self.rng))?);
        observation.clone_from(&self.observations[0]);
        Ok(())
    }

    fn step_into(&mut self, _action: &i64, observation: &mut Value) -> Result<Outcome> {
        let reward = self.rewards[self.steps];
        self.steps += 1;
        observation.clone_from(&self.observations[self.steps]);
        Ok(Outcome {
            reward,
            terminated: self.steps + 1 == self.observations.len(),
            truncated: false,
        })
    }

    fn generator(&mut self) -> Option<&mut Generator> {
        Some(&mut self.rng)
    }
}

/// Returns the observations of a reset and of all further steps.
fn shown<E: Env<Action = i64>>(mut env: E) -> Vec<E::Observation> {
    let mut observations = vec![env.reset(0).unwrap()];
    loop {
        let step = env.step(&0).unwrap();
        observations.push(step.observation);
        if step.terminated {
            return observations;
        }
    }
}

/// Returns a space of every kind. Composite spaces have several parts.
fn spaces() -> Vec<Space> {
    let line = |n: usize| Space::from(BoxSpace::uniform(-1.0, 1.0, [n], DType::F32).unwrap());
    let text = || Space::from(TextSpace::new(1, 5).unwrap());
    vec![
        line(3),
        Discrete::new(7).unwrap().into(),
        MultiDiscrete::new([3, 4]).unwrap().into(),
        MultiBinary::new([4]).unwrap().into(),
        text(),
        TupleSpace::new([line(2), Discrete::new(9).unwrap().into(), text()]).into(),
        DictSpace::new([
            ("position", line(2)),
            ("words", text()),
            ("gear", Discrete::new(4).unwrap().into()),
        ])
        .unwrap()
        .into(),
        OneOfSpace::new([line(2), Discrete::new(9).unwrap().into()])
            .unwrap()
            .into(),
        GraphSpace::new(line(2), Some(Discrete::new(3).unwrap().into()))
            .unwrap()
            .into(),
    ]
}

#[test]
fn a_stack_is_the_batch_of_the_last_observations() {
    for space in spaces() {
        let script = Script::sampled(space.clone(), 6);
        let mut padded = vec![script.observations[0].clone(); 2];
        padded.extend(script.observations.clone());
        let stacks = shown(FrameStackObservation::new(script.clone(), 3).unwrap());
        for (stack, last) in stacks.iter().zip(padded.windows(3)) {
            assert_eq!(*stack, space.concatenate(last).unwrap(), "{space}");
        }
        let padding = space.sampler(8).sample();
        padded[..2].fill(padding.clone());
        // these two texts are names of padding types
        if padding == Value::from("reset") || padding == Value::from("zero") {
            continue;
        }
        let padding_type = space.to_json(&padding).unwrap();
        let config = frame_stack_observation::Config {
            stack_size: 3,
            padding_type,
        };
        let env = FrameStackObservation::new(script, config).unwrap();
        assert_eq!(
            shown(env)[1],
            space.concatenate(&padded[1..4]).unwrap(),
            "{space}"
        );
    }
}

/// The check for finite numbers finds NaN and infinity in a value of any kind.
#[test]
fn what_is_not_finite_is_seen_anywhere() {
    let graph = |node: f64, edge: f64| {
        let links = Array::new([1, 2], Data::I64(vec![0, 0])).unwrap();
        Value::Graph(Box::new(GraphInstance {
            nodes: Value::from([1.0, node]),
            edges: Some(Value::from([edge])),
            edge_links: Some(links),
        }))
    };
    for number in [0.5, f64::NAN, f64::INFINITY] {
        for value in [
            Value::Float(number),
            Value::from([1.0, number]),
            Value::from([number, 1.0]),
            Value::from([1.0, number as f32]),
            Value::from([number as f32, 1.0]),
            Value::Tuple(vec![Value::Int(1), number.into()]),
            Value::Dict(vec![
                ("a".into(), Value::Int(1)),
                ("b".into(), number.into()),
            ]),
            Value::OneOf(1, Box::new(number.into())),
            graph(number, 1.0),
            graph(1.0, number),
        ] {
            assert_eq!(value.is_finite(), number.is_finite(), "{value}");
        }
    }
}

/// Spaces that differ in one property are not equal.
#[test]
fn one_part_makes_another_space() {
    let bounds = |low: [f64; 3]| Space::from(BoxSpace::new(low, [9.0; 3]).unwrap());
    let pair = |spaces: [Space; 2]| Space::from(TupleSpace::new(spaces));
    let number = || Space::discrete(3);
    for i in 0..3 {
        let mut low = [0.0; 3];
        low[i] = 0.5;
        assert_ne!(bounds(low), bounds([0.0; 3]));
        let json = serde_json::to_string(&bounds(low)).unwrap();
        assert_eq!(
            serde_json::from_str::<Space>(&json).unwrap(),
            bounds(low),
            "{json}"
        );
    }
    let form = pair([number(), bounds([0.0; 3])]);
    assert!(form.has_form_of(&pair([number(), bounds([0.5; 3])])));
    assert!(!form.has_form_of(&pair([number(), number()])));
    assert!(!form.has_form_of(&pair([bounds([0.0; 3]), bounds([0.0; 3])])));
}

#[test]
fn an_array_becomes_another_of_any_shape() {
    let square = Array::new([2, 2], Data::F32(vec![1.0, 2.0, 3.0, 4.0])).unwrap();
    for mut other in [
        Array::from([0.0_f32; 4]),
        Array::from([0_i64; 4]),
        Array::from([0.0_f32; 7]),
    ] {
        other.clone_from(&square);
        assert_eq!(other, square);
    }
}

#[test]
fn every_observation_is_transformed() {
    let script = Script::new(Space::discrete(100), (0..5).map(Value::Int).collect());
    let env = TransformObservation::new(script, |seen: &Value| 10 * seen.as_int().unwrap(), None);
    assert_eq!(shown(env), [0, 10, 20, 30, 40]);
}

#[test]
fn whole_numbers_are_normalized_too() {
    let numbers = [4, 9, 1, 6];
    let script = Script::new(Space::discrete(10), numbers.map(Value::Int).to_vec());
    let mut env = script.normalize_observation().unwrap();
    let mut expected = RunningMeanStd::new(1);
    for (i, number) in numbers.into_iter().enumerate() {
        let seen = if i == 0 {
            env.reset(0).unwrap()
        } else {
            env.step(&0).unwrap().observation
        };
        expected.update(&Array::from([number])).unwrap();
        assert_eq!(*env.statistics(), expected);
        let [mean, variance] =
            [expected.mean(), expected.variance()].map(|x| x.iter_f64().next().unwrap());
        let seen = seen.as_array().unwrap().iter_f64().next().unwrap();
        let right = (number as f64 - mean) / (variance + 1e-8).sqrt();
        assert!((seen - right).abs() < 1e-6, "{seen} for {right}");
    }
}

#[test]
fn statistics_count_each_row_once() {
    let rows: [Array; 4] = [
        [1.0_f32].into(),
        [2.0_f64].into(),
        [3.0_f32].into(),
        [4_i64].into(),
    ];
    let mut statistics = RunningMeanStd::new(1);
    let before = statistics.count();
    for (i, row) in rows.iter().enumerate() {
        statistics.update(row).unwrap();
        assert!(
            (statistics.count() - before - (i + 1) as f64).abs() < 1e-9,
            "{}",
            statistics.count()
        );
    }
    let mean = statistics.mean().iter_f64().next().unwrap();
    assert!((mean - 2.5).abs() < 1e-3, "{mean}");
}

/// With fixed statistics, rewards are divided by the square root of the variance.
#[test]
fn rewards_are_divided_by_a_deviation_that_was_set() {
    let mut env = NormalizeReward::new(Script::rewarded(&[1.0, -8.0, 3.0]), 0.9).unwrap();
    let known = RunningMeanStd::from_moments(&[5.0].into(), &[16.0].into(), 100.0).unwrap();
    env.set_statistics(known.clone()).unwrap();
    env.update_running_mean(false);
    env.reset(0).unwrap();
    for expected in [0.25, -2.0, 0.75] {
        let reward = env.step(&0).unwrap().reward;
        assert!((reward - expected).abs() < 1e-9, "{reward}");
    }
    assert_eq!(*env.statistics(), known);
    let error = env
        .set_statistics(RunningMeanStd::new_f64(2))
        .unwrap_err()
        .to_string();
    assert!(error.contains("the statistics are of 2 numbers"), "{error}");
    assert_eq!(*env.statistics(), known, "what is refused changes nothing");
}

#[test]
fn a_side_without_a_bound_lets_every_reward_through() {
    let rewards = [f64::NEG_INFINITY, -1e300, 0.5, 1e300, f64::INFINITY];
    for (bounds, expected) in [
        ((Some(-1.0), None), [-1.0, -1.0, 0.5, 1e300, f64::INFINITY]),
        (
            (None, Some(1.0)),
            [f64::NEG_INFINITY, -1e300, 0.5, 1.0, 1.0],
        ),
    ] {
        let mut env = ClipReward::new(Script::rewarded(&rewards), bounds).unwrap();
        env.reset(0).unwrap();
        assert_eq!(rewards.map(|_| env.step(&0).unwrap().reward), expected);
    }
}

#[test]
fn an_action_sticks_for_one_step_unless_told_otherwise() {
    let mut env = StickyAction::new(Script::sampled(Space::discrete(2), 8), 0.999_999).unwrap();
    env.reset(0).unwrap();
    let drawn = [(); 6].map(|()| {
        let before = env.generator().unwrap().clone();
        env.step(&1).unwrap();
        *env.generator().unwrap() != before
    });
    assert_eq!(drawn, [false, true, true, true, true, true]);
}

fn numbers(value: &Value) -> Vec<f64> {
    value.as_array().unwrap().iter_f64().collect()
}

/// An environment that observes `[0, 3]`, `[1, 2]`, `[2, 1]`.
fn counter() -> Script {
    let observations = (0..3)
        .map(|i| Value::from([i as f32, 3.0 - i as f32]))
        .collect();
    Script::new(Space::boxed([-10.0; 2], [10.0; 2]), observations)
}

#[test]
fn epsilon_keeps_small_variances_from_growing() {
    for epsilon in [1e-8, 0.5, 4.0] {
        let config = normalize_observation::Config {
            epsilon,
            ..Default::default()
        };
        let mut env = NormalizeObservation::new(counter(), config).unwrap();
        env.reset(0).unwrap();
        let seen = numbers(&env.step(&0).unwrap().observation);
        let statistics = env.statistics();
        let (means, variances) = (statistics.mean().into(), statistics.variance().into());
        let (means, variances) = (numbers(&means), numbers(&variances));
        for (i, x) in [1.0, 2.0].into_iter().enumerate() {
            let expected = (x - means[i]) / (variances[i] + epsilon).sqrt();
            assert!(
                (seen[i] - expected).abs() < 1e-6,
                "epsilon {epsilon}: {} for {expected}",
                seen[i]
            );
        }
    }
}

/// One random draw decides whether the action repeats. The repeated steps draw nothing.
#[test]
fn a_stuck_action_draws_nothing() {
    let script = Script::sampled(Space::discrete(2), 9);
    let mut env = StickyAction::new(script, (0.999_999, 3..=3)).unwrap();
    env.reset(0).unwrap();
    let drawn = [(); 7].map(|()| {
        let before = env.generator().unwrap().clone();
        env.step(&1).unwrap();
        *env.generator().unwrap() != before
    });
    assert_eq!(drawn, [false, true, false, false, true, false, false]);
}

/// A series of repeats has any length of the range, both ends included.
#[test]
fn a_series_has_every_length_of_its_range() {
    let script = Script::sampled(Space::discrete(2), 200);
    let mut env = StickyAction::new(script, (0.999_999, 2..=4)).unwrap();
    env.reset(0).unwrap();
    env.step(&1).unwrap();
    let mut rng = env.generator().unwrap().clone();
    let mut seen = [0; 3];
    for _ in 0..40 {
        assert!(rng.random() < 0.999_999);
        let length = rng.integers(2, 5);
        seen[length as usize - 2] += 1;
        for repeat in 0..length {
            env.step(&1).unwrap();
            assert_eq!(*env.generator().unwrap(), rng, "{repeat} of {length}");
        }
    }
    assert!(seen.iter().all(|times| *times > 3), "{seen:?}");
}

/// A vector's `final_obs` is on the same scale as its observations.
#[test]
fn final_observations_of_a_vector_are_normalized_too() {
    let vector = || {
        SyncVectorEnv::new([counter(), counter()])
            .unwrap()
            .with_autoreset(Autoreset::SameStep)
    };
    let (mut plain, mut normalized) = (vector(), vector().normalize_observation().unwrap());
    let actions = plain.action_space().unwrap().sampler(0).sample();
    let (mut raw, mut shown) = (plain.reset(0).unwrap(), normalized.reset(0).unwrap());
    for _ in 0..2 {
        plain.step_into(&actions, &mut raw).unwrap();
        normalized.step_into(&actions, &mut shown).unwrap();
    }
    assert_eq!(shown.has_final, [true, true]);
    let statistics = normalized.statistics();
    let (mean, variance) = (statistics.mean(), statistics.variance());
    let moments = mean.iter_f64().zip(variance.iter_f64()).collect::<Vec<_>>();
    let seen = numbers(&raw.final_observations)
        .into_iter()
        .zip(numbers(&shown.final_observations));
    for (i, (x, y)) in seen.enumerate() {
        let (mean, variance) = moments[i % 2];
        let expected = (x - mean) / (variance + 1e-8).sqrt();
        assert!(
            (y - expected).abs() < 1e-4,
            "number {i}: {y} for {expected}"
        );
    }
}

/// Before the first observation of each episode, paddings fill the stack.
#[test]
fn stacks_are_padded_to_their_size() {
    let observations: Vec<Value> = (1..9).map(Value::Int).collect();
    let script = Script::new(Space::discrete(9), observations.clone());
    for size in 1..=6 {
        for (name, padding) in [("reset", Value::Int(1)), ("zero", Value::Int(0))] {
            let config = frame_stack_observation::Config {
                stack_size: size,
                padding_type: name.into(),
            };
            let mut env = FrameStackObservation::new(script.clone(), config).unwrap();
            let padded = [vec![padding; size - 1], observations.clone()].concat();
            for episode in 0..2 {
                let mut shown = env.reset(()).unwrap();
                for (step, last) in padded.windows(size).enumerate().take(7) {
                    let expected = Space::discrete(9).concatenate(last).unwrap();
                    assert_eq!(
                        shown, expected,
                        "{size}, {name}, episode {episode}, step {step}"
                    );
                    shown = env.step(&0).unwrap().observation;
                }
            }
        }
    }
}

/// An argument of several types says which they are.
#[test]
fn arguments_of_another_type_are_refused_with_the_types() {
    for (name, kwargs, words) in [
        (
            "FilterObservation",
            json!({"filter_keys": [-1]}),
            "a list of indices from 0",
        ),
        (
            "DiscretizeAction",
            json!({"bins": -1}),
            "a number of bins, or a list",
        ),
        (
            "ClipReward",
            json!({"max_reward": "much"}),
            "expected a number",
        ),
        (
            "StickyAction",
            json!({"repeat_action_probability": 0.5, "repeat_action_duration": [1]}),
            "a list of the least and the most",
        ),
    ] {
        let spec = WrapperSpec {
            name: name.into(),
            kwargs: kwargs.as_object().unwrap().clone(),
        };
        let error = spec.wrap(BoxEnv::new(counter())).unwrap_err().to_string();
        assert!(error.contains(words), "{name}: {error}");
    }
}
