//! Rare cases: other options than the default, calls that fail half-way, rejected draws.

use gym_core::spaces::{BoxSpace, Discrete, OneOfSpace};
use gym_core::vector::{AsyncVectorEnv, Autoreset, SyncVectorEnv, VectorReset};
use gym_core::wrappers::{OrderEnforcing, PassiveEnvChecker, TimeLimit};
use gym_core::{
    BoxEnv, DType, Env, EnvExt, Error, Generator, Outcome, Reset, Result, Space, Value, VectorEnv,
    VectorEnvExt,
};

/// An environment that counts its steps. An episode has two steps. After `resets_left` resets,
/// resets fail.
#[derive(Clone, Debug)]
struct Counter {
    rng: Generator,
    steps: i64,
    resets_left: u32,
    /// Whether the info is a text instead of a number.
    is_odd: bool,
    /// The step that observes one number instead of two.
    misfit: Option<i64>,
}

impl Counter {
    fn new(resets_left: u32) -> Self {
        Self {
            rng: Generator::from(0),
            steps: 0,
            resets_left,
            is_odd: false,
            misfit: None,
        }
    }

    fn observe(&self) -> Value {
        Value::from([self.steps as f32, 3.0 - self.steps as f32])
    }
}

impl Env for Counter {
    type Observation = Value;
    type Action = i64;

    fn observation_space(&self) -> Space {
        Space::boxed([-10.0; 2], [10.0; 2])
    }

    fn action_space(&self) -> Space {
        Space::discrete(5)
    }

    fn reset_into(&mut self, reset: &Reset, observation: &mut Value) -> Result<()> {
        let Some(left) = self.resets_left.checked_sub(1) else {
            return Err(Error::custom("no more episodes"));
        };
        self.rng = reset.generator(Some(&self.rng))?;
        (self.resets_left, self.steps) = (left, 0);
        *observation = self.observe();
        Ok(())
    }

    fn step_into(&mut self, _action: &i64, observation: &mut Value) -> Result<Outcome> {
        self.steps += 1;
        *observation = if self.misfit == Some(self.steps) {
            Value::from([0.0_f32])
        } else {
            self.observe()
        };
        Ok(Outcome {
            reward: 5.0,
            terminated: self.steps == 2,
            truncated: false,
        })
    }

    fn info(&self, visit: &mut dyn FnMut(&str, Value)) {
        visit(
            "steps",
            if self.is_odd {
                Value::Text("many".into())
            } else {
                Value::Int(self.steps)
            },
        );
    }

    fn generator(&mut self) -> Option<&mut Generator> {
        Some(&mut self.rng)
    }
}

/// A 16-bit draw accepts a remainder equal to the threshold, as numpy's does.
#[test]
fn numbers_of_sixteen_bits_are_drawn_as_numpy_draws_them() {
    use rand::Rng;

    for n in [3_u32, 40_000, 65_535] {
        let space: Space = Discrete::new(n.into())
            .unwrap()
            .with_dtype(DType::U16)
            .unwrap()
            .into();
        let (mut sampler, mut rng) = (space.sampler(7), Generator::from(7));
        let threshold = (0x1_0000 - n) % n;
        let mut met = 0;
        for _ in 0..30_000 {
            // the unused half of a word is dropped after a draw
            let mut halves = std::iter::repeat_with(|| rng.next_u32())
                .flat_map(|word| [word & 0xffff, word >> 16]);
            let product = halves
                .find(|half| half * n % 0x1_0000 >= threshold)
                .expect("endless")
                * n;
            met += u32::from(product % 0x1_0000 == threshold);
            assert_eq!(
                sampler.sample(),
                Value::Int(i64::from(product >> 16)),
                "{n}"
            );
        }
        assert!(met > 0 || n != 40_000, "the threshold is never met");
    }
}

#[test]
fn the_shorter_choice_is_padded_with_its_first_number() {
    let line = |n: usize| Space::from(BoxSpace::uniform(-1.0, 1.0, [n], DType::F64).unwrap());
    let space: Space = OneOfSpace::new([line(2), line(4)]).unwrap().into();
    let flat = space
        .flatten(&Value::OneOf(0, Box::new(Value::from([0.5, -0.25]))))
        .unwrap();
    assert_eq!(
        flat.as_array().unwrap().iter_f64().collect::<Vec<_>>(),
        [0.0, 0.5, -0.25, 0.5, 0.5]
    );
}

/// If the reset within a step in SameStep mode fails, the columns have neither a reward nor a flag.
#[test]
fn a_step_that_fails_half_way_answers_nothing() {
    for autoreset in [Autoreset::SameStep, Autoreset::NextStep] {
        let mut envs = SyncVectorEnv::new([Counter::new(1), Counter::new(9)])
            .unwrap()
            .with_autoreset(autoreset);
        let mut columns = envs.columns().unwrap();
        let actions = envs.action_space().unwrap().sampler(0).sample();
        envs.reset_into(&VectorReset::default(), &mut columns)
            .unwrap();
        let steps = if autoreset == Autoreset::SameStep {
            1
        } else {
            2
        };
        for _ in 0..steps {
            envs.step_into(&actions, &mut columns).unwrap();
        }
        let error = envs
            .step_into(&actions, &mut columns)
            .unwrap_err()
            .to_string();
        assert_eq!(error, "sub-environment 0: no more episodes");
        assert_eq!(
            (
                columns.rewards[0],
                columns.terminated[0],
                columns.has_final[0]
            ),
            (0.0, false, false)
        );
        assert!(envs.info_map(0).is_empty(), "{autoreset:?}");
        assert!(!envs.info_map(1).is_empty(), "{autoreset:?}");
    }
}

#[test]
fn an_observation_that_does_not_fit_is_an_error_of_its_environment() {
    let envs = || {
        [
            Counter::new(9),
            Counter {
                misfit: Some(1),
                ..Counter::new(9)
            },
            Counter::new(9),
        ]
    };
    let mut sync = SyncVectorEnv::new(envs()).unwrap();
    let mut pool = AsyncVectorEnv::new(envs())
        .and_then(|pool| pool.with_threads(2))
        .unwrap();
    let actions = sync.action_space().unwrap().sampler(0).sample();
    let mut columns = sync.reset(0).unwrap();
    let error = sync
        .step_into(&actions, &mut columns)
        .unwrap_err()
        .to_string();
    assert!(error.starts_with("sub-environment 1: "), "{error}");
    pool.reset_into(&0.into(), &mut columns).unwrap();
    assert_eq!(
        pool.step_into(&actions, &mut columns)
            .unwrap_err()
            .to_string(),
        error
    );
    pool.reset_into(&0.into(), &mut columns).unwrap();
    pool.send(&actions, &[0, 1, 2]).unwrap();
    assert_eq!(
        pool.recv_into(3, &mut Vec::new(), &mut columns)
            .unwrap_err()
            .to_string(),
        error
    );
    pool.recv_into(2, &mut Vec::new(), &mut columns).unwrap();
    assert_eq!(pool.num_pending(), 0);
}

#[test]
fn a_value_that_a_column_cannot_hold_is_marked_as_missing() {
    let odd = Counter {
        is_odd: true,
        ..Counter::new(9)
    };
    let mut envs = SyncVectorEnv::new([Counter::new(9), odd, Counter::new(9)]).unwrap();
    let mut columns = envs.columns().unwrap();
    envs.reset_into(&VectorReset::default(), &mut columns)
        .unwrap();
    let infos = envs.infos(&columns);
    let flags = [true, false, true].map(Value::Bool).to_vec();
    assert_eq!(infos["_steps"], Value::Tuple(flags), "{infos:?}");
}

/// A column of texts has each environment's own, whatever the others have.
#[test]
fn a_column_of_objects_has_each_value() {
    let [number, text] = [false, true].map(|is_odd| Counter {
        is_odd,
        ..Counter::new(9)
    });
    let envs = SyncVectorEnv::new([text.clone(), number, text]).unwrap();
    let mut envs = envs.with_autoreset(Autoreset::SameStep);
    let mut columns = envs.columns().unwrap();
    envs.reset_into(&0.into(), &mut columns).unwrap();
    envs.step_into(&Value::from([0_i64; 3]), &mut columns)
        .unwrap();
    let infos = envs.infos(&columns);
    let many = || Value::Text("many".into());
    assert_eq!(
        infos["steps"],
        Value::Tuple(vec![many(), Value::Int(1), many()])
    );
    assert_eq!(infos["_steps"], Value::Tuple(vec![Value::Bool(true); 3]));
    // the second has no last observation, since its episode began later
    let second = VectorReset::default().mask(vec![false, true, false]);
    envs.reset_into(&second, &mut columns).unwrap();
    envs.step_into(&Value::from([0_i64; 3]), &mut columns)
        .unwrap();
    let infos = envs.infos(&columns);
    let last = || Value::from([2.0_f32, 1.0]);
    assert_eq!(
        infos["final_obs"],
        Value::Tuple(vec![last(), Value::Null, last()])
    );
    let there = [true, false, true].map(Value::Bool).to_vec();
    assert_eq!(infos["_final_obs"], Value::Tuple(there));
}

/// An environment that returns given observations and rewards, one after the other. Its space has
/// two numbers.
#[derive(Clone, Debug)]
struct Told(std::vec::IntoIter<(i64, f64)>);

impl Told {
    fn next(&mut self, observation: &mut i64) -> Result<Outcome> {
        let (told, reward) = self.0.next().expect("an answer");
        *observation = told;
        Ok(Outcome {
            reward,
            ..Outcome::default()
        })
    }
}

impl Env for Told {
    type Observation = i64;
    type Action = i64;

    fn observation_space(&self) -> Space {
        Space::discrete(2)
    }

    fn action_space(&self) -> Space {
        Space::discrete(2)
    }

    fn reset_into(&mut self, _: &Reset, observation: &mut i64) -> Result<()> {
        self.next(observation).map(drop)
    }

    fn step_into(&mut self, _: &i64, observation: &mut i64) -> Result<Outcome> {
        self.next(observation)
    }
}

/// The checker checks resets until the first valid reset, and steps until the first valid step. The
/// checker skips episodes whose reset has options.
#[test]
fn the_passive_checker_looks_until_it_has_seen_a_sound_answer() {
    /// The calls: reset (`r`), reset with an option (`o`) or step (`s`). For each: the observation
    /// and reward, and whether the checker reports an error.
    const CALLS: [(char, i64, f64, bool); 18] = [
        ('r', 2, 0.0, true),
        ('r', -1, 0.0, true),
        // steps are checked independently of resets
        ('s', 2, 0.0, true),
        ('o', 2, 0.0, false),
        ('s', 2, f64::NAN, false),
        ('s', 7, 0.0, false),
        ('r', 2, 0.0, true),
        ('r', 1, 0.0, false),
        ('r', 2, 0.0, false),
        ('s', 1, f64::NAN, true),
        ('s', 0, f64::INFINITY, true),
        ('s', 2, 0.0, true),
        ('o', 1, 0.0, false),
        ('s', 2, 0.0, false),
        ('r', 1, 0.0, false),
        ('s', 2, 0.0, true),
        ('s', 1, 0.0, false),
        ('s', 2, f64::NAN, false),
    ];
    let answers: Vec<_> = CALLS
        .iter()
        .map(|(_, told, reward, _)| (*told, *reward))
        .collect();
    let mut env = PassiveEnvChecker::new(Told(answers.into_iter()));
    for (i, (call, told, reward, is_refused)) in CALLS.into_iter().enumerate() {
        let answer = match call {
            'r' => env.reset(()).map(drop),
            'o' => env.reset(Reset::default().option("far", true)).map(drop),
            _ => env.step(&0).map(drop),
        };
        let what = format!("call {i}, {call} of {told} with {reward}: {answer:?}");
        assert_eq!(
            matches!(answer, Err(Error::Contract(_))),
            is_refused,
            "{what}"
        );
        assert!(is_refused || answer.is_ok(), "{what}");
    }
}

/// Each wrapper names itself around what it wraps; a box does not.
#[test]
fn a_stack_describes_each_wrapper_once() {
    let env = || Counter::new(9);
    let limited = || TimeLimit::new(env(), 7).unwrap();
    for (described, expected) in [
        (env().describe(), "Counter"),
        (limited().describe(), "<TimeLimit<Counter>>"),
        (
            OrderEnforcing::new(env()).describe(),
            "<OrderEnforcing<Counter>>",
        ),
        (
            PassiveEnvChecker::new(env()).describe(),
            "<PassiveEnvChecker<Counter>>",
        ),
        (BoxEnv::new(limited()).describe(), "<TimeLimit<Counter>>"),
        (
            OrderEnforcing::new(limited()).describe(),
            "<OrderEnforcing<TimeLimit<Counter>>>",
        ),
    ] {
        assert_eq!(described, expected);
    }
}

/// An environment whose info has two entries of one name: a wrapper adds its entry after the inner ones.
#[derive(Clone, Debug)]
struct Twice(Counter);

impl Env for Twice {
    type Observation = Value;
    type Action = i64;

    fn observation_space(&self) -> Space {
        self.0.observation_space()
    }

    fn action_space(&self) -> Space {
        self.0.action_space()
    }

    fn reset_into(&mut self, reset: &Reset, observation: &mut Value) -> Result<()> {
        self.0.reset_into(reset, observation)
    }

    fn step_into(&mut self, action: &i64, observation: &mut Value) -> Result<Outcome> {
        self.0.step_into(action, observation)
    }

    fn info(&self, visit: &mut dyn FnMut(&str, Value)) {
        self.0.info(visit);
        visit("steps", Value::Int(self.0.steps + 100));
    }
}

#[test]
fn of_two_entries_of_one_name_the_last_is_kept() {
    let mut env = Twice(Counter::new(9));
    env.reset(0).unwrap();
    env.step(&0).unwrap();
    let info = env.info_map();
    assert_eq!((info.len(), &info["steps"]), (1, &Value::Int(101)));
    let envs = [Twice(Counter::new(9)), Twice(Counter::new(9))];
    let mut envs = SyncVectorEnv::new(envs).unwrap();
    envs.reset(0).unwrap();
    assert_eq!(envs.info_map(1)["steps"], Value::Int(100));
}
