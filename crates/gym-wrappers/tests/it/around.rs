//! What each wrapper makes of spaces of each kind: the spaces around it, and the sum of all that it answers;
//! or its whole refusal. Around environments and vectors, clones and what was restored go on alike.
//!
//! After an intended change, read what differs, and store it with
//! `GYM_UPDATE_KEPT=1 cargo test --package gym-wrappers --test it around`.

use std::fmt::Write;
use std::path::Path;

use gym_core::spaces::{
    BoxSpace, DictSpace, Discrete, MultiBinary, MultiDiscrete, TextSpace, TupleSpace,
};
use gym_core::vector::{Autoreset, SyncVectorEnv};
use gym_core::{
    BoxEnv, DType, Env, EnvExt, Generator, Info, Outcome, Reset, Result, Snapshot, Space, Value,
    VectorEnv, VectorEnvExt, WrapperSpec,
};
use gym_testing::{Digest, kept};

/// An environment that observes samples of a space, and shows the last action in its infos.
#[derive(Clone, Debug)]
pub(crate) struct Echo {
    observed: Space,
    taken: Space,
    /// The space of which it observes samples, though it claims `observed`.
    shown: Space,
    length: u64,
    steps: u64,
    last: Value,
    rng: Generator,
}

impl Echo {
    pub(crate) fn new(observed: &Space, taken: &Space, length: u64) -> Self {
        Self {
            observed: observed.clone(),
            shown: observed.clone(),
            taken: taken.clone(),
            length,
            steps: 0,
            last: Value::Null,
            rng: Generator::from(0),
        }
    }

    /// The same, which observes samples of another space than the one it claims.
    pub(crate) fn showing(self, shown: &Space) -> Self {
        Self {
            shown: shown.clone(),
            ..self
        }
    }

    /// The last action that it received.
    pub(crate) fn last(&self) -> &Value {
        &self.last
    }

    fn observe(&self, observation: &mut Value) {
        self.shown
            .sampler(100 * self.length + self.steps)
            .sample_into(observation);
    }
}

impl Env for Echo {
    type Observation = Value;
    type Action = Value;

    fn observation_space(&self) -> Space {
        self.observed.clone()
    }

    fn action_space(&self) -> Space {
        self.taken.clone()
    }

    fn reset_into(&mut self, reset: &Reset, observation: &mut Value) -> Result<()> {
        self.rng = reset.generator(Some(&self.rng))?;
        (self.steps, self.last) = (0, Value::Null);
        self.observe(observation);
        Ok(())
    }

    fn step_into(&mut self, action: &Value, observation: &mut Value) -> Result<Outcome> {
        self.steps += 1;
        self.last = action.clone();
        self.observe(observation);
        Ok(Outcome {
            reward: 1.5 * self.steps as f64 - 4.0,
            terminated: self.steps == self.length,
            truncated: false,
        })
    }

    fn info(&self, visit: &mut dyn FnMut(&str, Value)) {
        visit("last", Value::Text(format!("{:?}", self.last)));
    }

    fn generator(&mut self) -> Option<&mut Generator> {
        Some(&mut self.rng)
    }

    fn snapshot(&self) -> Result<Snapshot> {
        Snapshot::of(&(self.steps, &self.last, &self.rng))
    }

    fn restore(&mut self, snapshot: &Snapshot) -> Result<()> {
        (self.steps, self.last, self.rng) = snapshot.get()?;
        Ok(())
    }
}

pub(crate) fn spaces() -> Vec<Space> {
    let boxed = |low: f64, high: f64, shape: &[usize], dtype| {
        Space::from(BoxSpace::uniform(low, high, shape, dtype).unwrap())
    };
    let open = BoxSpace::new([f32::NEG_INFINITY, 0.0], [1.0, f32::INFINITY]).unwrap();
    let line = || boxed(-1.0, 3.0, &[2], DType::F32);
    let from_minus_two = Discrete::new(4).unwrap().with_start(-2).unwrap();
    vec![
        line(),
        boxed(-1.0, 3.0, &[2, 3], DType::F64),
        boxed(0.0, 200.0, &[3], DType::U8),
        boxed(-5.0, 5.0, &[2], DType::I32),
        boxed(0.0, 255.0, &[6, 4, 3], DType::U8),
        boxed(0.0, 255.0, &[4, 6], DType::U8),
        boxed(0.0, 1.0, &[], DType::F32),
        open.into(),
        from_minus_two.into(),
        MultiDiscrete::new([3, 4]).unwrap().into(),
        MultiBinary::new([3]).unwrap().into(),
        Space::from(TextSpace::new(1, 3).unwrap()),
        TupleSpace::new([line(), Space::discrete(9)]).into(),
        DictSpace::new([("a", line()), ("b", Space::discrete(4)), ("time", line())])
            .unwrap()
            .into(),
    ]
}

/// Wrappers, each with arguments that fit some of the spaces.
pub(crate) const WRAPPERS: &[(&str, &[&str])] = &[
    ("Autoreset", &["{}"]),
    ("ClipAction", &["{}"]),
    (
        "ClipReward",
        &[
            r#"{"min_reward": -1, "max_reward": 2.5}"#,
            r#"{"max_reward": 0}"#,
            r#"{"min_reward": [0.5]}"#,
        ],
    ),
    ("DelayObservation", &[r#"{"delay": 0}"#, r#"{"delay": 2}"#]),
    (
        "DiscretizeAction",
        &[
            r#"{"bins": 3}"#,
            r#"{"bins": [2, 5], "multidiscrete": true}"#,
            r#"{"bins": 0}"#,
            r#"{"bins": [3, 1000000000]}"#,
        ],
    ),
    (
        "DiscretizeObservation",
        &[
            r#"{"bins": 3}"#,
            r#"{"bins": [2, 5], "multidiscrete": true}"#,
            r#"{"bins": 1}"#,
            r#"{"bins": [3, 1000000000]}"#,
        ],
    ),
    (
        "DtypeObservation",
        &[
            r#"{"dtype": "float64"}"#,
            r#"{"dtype": "int8"}"#,
            r#"{"dtype": "uint16"}"#,
        ],
    ),
    (
        "FilterObservation",
        &[
            r#"{"filter_keys": ["b"]}"#,
            r#"{"filter_keys": ["time", "a"]}"#,
            r#"{"filter_keys": [1]}"#,
        ],
    ),
    ("FlattenObservation", &["{}"]),
    (
        "FrameStackObservation",
        &[
            r#"{"stack_size": 3}"#,
            r#"{"stack_size": 2, "padding_type": "zero"}"#,
            r#"{"stack_size": 3, "padding_type": [0.5, 1]}"#,
            r#"{"stack_size": 2, "padding_type": [7, 1]}"#,
            r#"{"stack_size": 0}"#,
        ],
    ),
    ("GrayscaleObservation", &["{}", r#"{"keep_dim": true}"#]),
    (
        "MaxAndSkipObservation",
        &["{}", r#"{"skip": 2}"#, r#"{"skip": 1}"#],
    ),
    (
        "NormalizeObservation",
        &["{}", r#"{"epsilon": 0.5, "update_running_mean": false}"#],
    ),
    (
        "NormalizeReward",
        &[
            "{}",
            r#"{"gamma": 0.5, "epsilon": 0.25}"#,
            r#"{"update_running_mean": false}"#,
        ],
    ),
    ("OrderEnforcing", &["{}"]),
    ("PassiveEnvChecker", &["{}"]),
    (
        "RecordEpisodeStatistics",
        &["{}", r#"{"buffer_length": 1, "stats_key": "played"}"#],
    ),
    (
        "RepeatAction",
        &[r#"{"num_repeats": 2}"#, r#"{"num_repeats": 0}"#],
    ),
    (
        "RescaleAction",
        &[
            r#"{"min_action": -1, "max_action": 1}"#,
            r#"{"min_action": [0, 1], "max_action": [2, 4]}"#,
            r#"{"min_action": 1, "max_action": 0}"#,
        ],
    ),
    (
        "RescaleObservation",
        &[
            r#"{"min_obs": -1, "max_obs": 1}"#,
            r#"{"min_obs": [0, 1], "max_obs": [2, 4]}"#,
            r#"{"min_obs": 1, "max_obs": 0}"#,
        ],
    ),
    (
        "ReshapeObservation",
        &[
            r#"{"shape": [2, 1]}"#,
            r#"{"shape": [3, 8]}"#,
            r#"{"shape": []}"#,
        ],
    ),
    (
        "ResizeObservation",
        &[r#"{"shape": [2, 3]}"#, r#"{"shape": [9, 5]}"#],
    ),
    (
        "StickyAction",
        &[
            r#"{"repeat_action_probability": 0.5}"#,
            r#"{"repeat_action_probability": 0.75, "repeat_action_duration": [2, 3]}"#,
            r#"{"repeat_action_probability": 1.0}"#,
        ],
    ),
    (
        "TimeAwareObservation",
        &[
            "{}",
            r#"{"flatten": false, "normalize_time": true, "max_timesteps": 8}"#,
            r#"{"flatten": false, "dict_time_key": "clock"}"#,
        ],
    ),
    ("TimeLimit", &[r#"{"max_episode_steps": 3}"#]),
];

pub(crate) fn spec(name: &str, kwargs: &str) -> WrapperSpec {
    WrapperSpec {
        name: name.into(),
        kwargs: serde_json::from_str(kwargs).unwrap(),
    }
}

/// Without the seconds of an episode.
fn timeless(mut info: Info) -> Info {
    for key in ["episode", "played"] {
        if let Some(Value::Dict(entries)) = info.get_mut(key) {
            entries.retain(|(name, _)| name != "t");
        }
    }
    if let Some(Value::Dict(entries)) = info.get_mut("final_info") {
        for (_, entry) in entries {
            if let Value::Dict(entries) = entry {
                entries.retain(|(name, _)| name != "t" && name != "_t");
            }
        }
    }
    info
}

/// The answers of an environment to actions, with a reset after each end.
fn answers(env: &mut BoxEnv, actions: &[Value]) -> Vec<String> {
    let mut all = Vec::new();
    for action in actions {
        let step = env.step(action);
        let is_done = step.as_ref().is_ok_and(gym_core::Step::done);
        all.push(format!("{step:?} {:?}", timeless(env.info_map())));
        if is_done {
            all.push(format!(
                "{:?} {:?}",
                env.reset(()),
                timeless(env.info_map())
            ));
        }
    }
    all
}

/// A short sum of texts.
pub(crate) fn sum(texts: &[String]) -> String {
    let mut digest = Digest::default();
    texts.iter().for_each(|text| digest.bytes(text.as_bytes()));
    digest.finish()[..12].to_owned()
}

/// The spaces around, and sums of them and of all answers.
fn around_an_environment(inner: &Echo, spec: &WrapperSpec) -> Result<[String; 2]> {
    let mut env = spec.wrap(BoxEnv::new(inner.clone()))?;
    let mut samples = env.action_sampler(7)?;
    let actions: Vec<Value> = (0..14).map(|_| samples.sample()).collect();
    let start = format!("{:?} {:?}", env.reset(3), timeless(env.info_map()));
    let mut all = vec![start];
    all.extend(answers(&mut env, &actions[..4]));
    let (mut clone, mut used) = (env.clone(), spec.wrap(BoxEnv::new(inner.clone()))?);
    used.reset(9)?;
    answers(&mut used, &actions[5..10]);
    let stored = env.snapshot();
    let later = answers(&mut env, &actions[4..]);
    assert_eq!(
        answers(&mut clone, &actions[4..]),
        later,
        "a clone of {env}"
    );
    let stored = stored.and_then(|snapshot| used.restore(&snapshot));
    let kept = match stored {
        Ok(()) => {
            assert_eq!(answers(&mut used, &actions[4..]), later, "restored {env}");
            "stored"
        }
        Err(_) => "not stored",
    };
    all.extend(later);
    let [observed, taken] = [env.observation_space(), env.action_space()];
    let spaces = [&observed, &taken].map(|space| serde_json::to_string(space).unwrap());
    let sums = format!("{} {} {kept}", sum(&spaces), sum(&all));
    Ok([format!("{observed} {taken}"), sums])
}

fn around_a_vector(inner: &Echo, spec: &WrapperSpec, mode: Autoreset) -> Result<[String; 2]> {
    let envs = [3, 5, 4].map(|length| Echo {
        length,
        ..inner.clone()
    });
    let envs = SyncVectorEnv::new(envs)?.with_autoreset(mode);
    let mut envs = spec.wrap_vector(Box::new(envs))?;
    let mut columns = envs.columns()?;
    let mut samples = envs.action_sampler(7)?;
    envs.reset_into(&3.into(), &mut columns)?;
    let mut all = vec![format!(
        "{:?} {:?}",
        columns.observations,
        timeless(envs.infos(&columns))
    )];
    for _ in 0..9 {
        let result = envs.step_into(&samples.sample(), &mut columns);
        all.push(format!(
            "{result:?} {:?} {:?} {:?} {:?}",
            columns.observations, columns.rewards, columns.terminated, columns.truncated
        ));
        let infos = timeless(envs.infos(&columns));
        all.push(format!("{infos:?}"));
        if mode == Autoreset::Disabled {
            let over: Vec<bool> = (0..3).map(|i| columns.done(i)).collect();
            if over.contains(&true) {
                envs.reset_into(
                    &gym_core::vector::VectorReset::default().mask(over),
                    &mut columns,
                )?;
                all.push(format!("{:?}", columns.observations));
            }
        }
    }
    let [observed, taken] = [envs.single_observation_space(), envs.single_action_space()];
    let batches = [envs.observation_space()?, envs.action_space()?];
    let spaces = [&observed, &taken, &batches[0], &batches[1]]
        .map(|space| serde_json::to_string(space).unwrap());
    let sums = format!("{} {}", sum(&spaces), sum(&all));
    Ok([format!("{observed} {taken}"), sums])
}

#[test]
fn every_wrapper_makes_of_every_space_what_it_made() {
    let registered: Vec<_> = gym_core::registry::wrappers();
    let mut told = String::new();
    for (name, cases) in WRAPPERS {
        let wrapper = registered
            .iter()
            .find(|wrapper| wrapper.name == *name)
            .unwrap();
        let of_actions = [
            "ClipAction",
            "DiscretizeAction",
            "RescaleAction",
            "RepeatAction",
            "StickyAction",
        ]
        .contains(name);
        for kwargs in *cases {
            writeln!(told, "{name} {kwargs}").unwrap();
            let spec = spec(name, kwargs);
            for space in spaces() {
                let inner = match of_actions {
                    true => Echo::new(&Space::discrete(50), &space, 5),
                    false => Echo::new(&space, &Space::discrete(3), 5),
                };
                let told_of = |made: Result<_>| {
                    made.unwrap_or_else(|error| [error.to_string(), String::new()])
                };
                let [spaces, sums] = told_of(around_an_environment(&inner, &spec));
                write!(told, "  {space}: {spaces} {sums}").unwrap();
                if wrapper.wraps_vectors() {
                    for mode in [
                        Autoreset::NextStep,
                        Autoreset::SameStep,
                        Autoreset::Disabled,
                    ] {
                        let [around, sums] = told_of(around_a_vector(&inner, &spec, mode));
                        // a vector mostly has the spaces, or the refusal, of the environment
                        let around = if around == spaces { "" } else { &around };
                        write!(told, "; {mode:?} {around} {sums}").unwrap();
                    }
                }
                told.push('\n');
            }
        }
    }
    // what needs pictures is elsewhere
    let pictures = [
        "AddRenderObservation",
        "AddWhiteNoise",
        "ObstructView",
        "RenderCollection",
    ];
    let known =
        |name: &str| pictures.contains(&name) || WRAPPERS.iter().any(|(other, _)| *other == name);
    assert!(registered.iter().all(|wrapper| known(wrapper.name)));
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/it");
    kept(&folder.join("around.txt"), &told);
}

/// A restored wrapper goes on from what was stored, whatever it had done before.
#[test]
fn a_wrapper_that_is_restored_forgets_what_it_did() {
    let space = &spaces()[0];
    for (name, cases) in WRAPPERS {
        let Ok(made) = spec(name, cases[0]).wrap(BoxEnv::new(Echo::new(space, space, 5))) else {
            continue;
        };
        let mut samples = made.action_sampler(1).unwrap();
        let actions: Vec<Value> = (0..9).map(|_| samples.sample()).collect();
        let mut fresh = made.clone();
        fresh.reset(1).unwrap();
        let Ok(stored) = fresh.snapshot() else {
            continue;
        };
        let expected = answers(&mut fresh, &actions);
        // before each step of two episodes, and after their ends
        let mut used = made.clone();
        used.reset(2).unwrap();
        for action in [&actions[..], &actions[..]].concat() {
            let _ = used.step(&action);
            let mut restored = used.clone();
            restored.restore(&stored).unwrap();
            assert_eq!(answers(&mut restored, &actions), expected, "{name}");
        }
    }
}
