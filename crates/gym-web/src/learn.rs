//! Learners. They train in slices, so that the page can show their progress.

use gym::{Error, Kwargs, Result, Seed, Value};
use serde::Deserialize;
use serde_json::{Value as Json, json};

use crate::episode::Episode;
use crate::linear::{self, CrossEntropy};
use crate::tabular::{self, Tabular};

/// A method of learning, with its parameters.
#[derive(Clone, Copy, Debug, Deserialize)]
#[serde(tag = "method", rename_all = "snake_case", deny_unknown_fields)]
pub(crate) enum Lesson {
    /// A table of action values.
    Tabular(tabular::Parameters),
    /// A linear policy, by the cross-entropy method.
    CrossEntropy(linear::Parameters),
}

/// A learner of one of the methods.
pub(crate) enum Learner {
    Tabular(Box<Tabular>),
    CrossEntropy(Box<CrossEntropy>),
}

impl Learner {
    /// Makes a new learner.
    pub(crate) fn new(id: &str, kwargs: Kwargs, seed: u64, lesson: Lesson) -> Result<Self> {
        // the learner needs no checks of its observations
        let env = gym::builder(id)
            .args(kwargs)
            .disable_env_checker(true)
            .build()?;
        let seed = Seed::from(seed);
        Ok(match lesson {
            Lesson::Tabular(parameters) => {
                Self::Tabular(Tabular::new(env, seed, parameters)?.into())
            }
            Lesson::CrossEntropy(parameters) => {
                Self::CrossEntropy(CrossEntropy::new(env, seed, parameters)?.into())
            }
        })
    }

    /// Changes the parameters.
    pub(crate) fn tune(&mut self, lesson: Lesson) -> Result<()> {
        match (self, lesson) {
            (Self::Tabular(learner), Lesson::Tabular(parameters)) => {
                learner.parameters = parameters;
            }
            (Self::CrossEntropy(learner), Lesson::CrossEntropy(parameters)) => {
                learner.tune(parameters);
            }
            _ => {
                return Err(Error::custom(
                    "a learner cannot change its method: open another",
                ));
            }
        }
        Ok(())
    }

    /// Trains until `episodes` episodes have ended or `steps` steps were taken. Returns the episodes
    /// that ended.
    pub(crate) fn train(&mut self, episodes: u32, steps: u32) -> Result<Vec<Episode>> {
        match self {
            Self::Tabular(learner) => learner.train(episodes, steps),
            Self::CrossEntropy(learner) => learner.train(episodes, steps),
        }
    }

    /// Returns the action with the highest value.
    pub(crate) fn act(&self, observation: &Value) -> Result<Value> {
        match self {
            Self::Tabular(learner) => learner.act(observation),
            Self::CrossEntropy(learner) => learner.act(observation),
        }
    }

    /// Returns the action values, or the weights.
    pub(crate) fn learned(&self) -> &[f64] {
        match self {
            Self::Tabular(learner) => learner.values(),
            Self::CrossEntropy(learner) => learner.weights(),
        }
    }

    /// Describes the numbers of [`learned`](Self::learned).
    pub(crate) fn describe(&self) -> Json {
        match self {
            Self::Tabular(learner) => {
                json!({"states": learner.states(), "actions": learner.actions(), "epsilon": learner.epsilon()})
            }
            Self::CrossEntropy(learner) => json!({
                "inputs": learner.inputs(),
                "outputs": learner.outputs(),
                "generation": learner.generation(),
                "spread": learner.spread(),
            }),
        }
    }
}
