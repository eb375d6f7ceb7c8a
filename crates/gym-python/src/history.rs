//! The calls since the start of an episode, from which another program can repeat the episode.

use gym::sim::SimEnv;
use gym::{BoxEnv, Env as _, EnvExt as _, Generator, Kwargs, RandomState, Reset, Seed, Value};
use serde::{Deserialize, Serialize};

/// The numbers of actions that a history has room for; a longer one is forgotten.
const ROOM: usize = 1 << 16;

/// What a reset draws from.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(crate) enum Source {
    /// A seed.
    Seed(Seed),
    /// numpy's generator.
    Generator(Generator),
    /// numpy's generator of dm_control.
    RandomState(Box<RandomState>),
}

impl Source {
    /// What `reset` of `env` draws from; `None` if the environment has no
    /// generator.
    pub(crate) fn of(env: &mut BoxEnv, reset: &Reset) -> Option<Self> {
        if let Some(seed) = &reset.seed {
            return Some(Self::Seed(seed.clone()));
        }
        if let Some(state) = env.layer::<SimEnv>().and_then(SimEnv::random_state) {
            return Some(Self::RandomState(Box::new(state.clone())));
        }
        env.generator().cloned().map(Self::Generator)
    }
}

/// An episode's reset and actions.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(crate) struct History {
    source: Source,
    options: Kwargs,
    /// The generators that replaced the environment's, each with the number of steps before it.
    generators: Vec<(usize, Generator)>,
    steps: usize,
    /// The numbers of all actions.
    actions: Vec<f64>,
}

impl History {
    /// The history of a new episode; it takes over the storage of `last`.
    pub(crate) fn new(source: Source, options: &Kwargs, last: Option<Self>) -> Self {
        let mut actions = last.map(|last| last.actions).unwrap_or_default();
        actions.clear();
        Self {
            source,
            options: options.clone(),
            generators: Vec::new(),
            steps: 0,
            actions,
        }
    }

    /// Adds a step. Returns whether the history is complete.
    #[expect(clippy::cast_precision_loss, reason = "actions are small numbers")]
    pub(crate) fn step(&mut self, action: &Value) -> bool {
        if self.actions.len() >= ROOM {
            return false;
        }
        self.steps += 1;
        match action {
            Value::Int(i) => self.actions.push(*i as f64),
            Value::Array(array) => self.actions.extend(array.iter_f64()),
            _ => return false,
        }
        true
    }

    /// Adds a generator that replaces the environment's.
    pub(crate) fn replace(&mut self, generator: Generator) {
        self.generators.retain(|(steps, _)| *steps < self.steps);
        self.generators.push((self.steps, generator));
    }
}
