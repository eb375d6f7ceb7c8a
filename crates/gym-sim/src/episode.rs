//! An episode, and its stored form.

use std::collections::BTreeMap;

use gym_core::{Generator, RandomState, Result, Snapshot};
use mujoco_engine::Data;
use serde::{Deserialize, Serialize, Serializer};
use serde_json::Value as Json;

use crate::rng::Rng;
use crate::task::{Measured, Measures, Number, Stored};

#[derive(Clone, Debug)]
pub(crate) struct Episode {
    pub(crate) rng: Rng,
    /// The constants of the model that the task drew.
    pub(crate) constants: Vec<f64>,
    pub(crate) steps: u64,
    pub(crate) data: Data,
    /// The names of what a step measures.
    pub(crate) measures: Measures,
    /// What the last step measured; `None` after a reset.
    pub(crate) measured: Option<Measured>,
}

impl Episode {
    /// Reads the episode of a snapshot; `None` for a state before the first reset.
    ///
    /// # Errors
    /// [`Error::Snapshot`](gym_core::Error::Snapshot) if it is of another environment, or lacks a part.
    pub(crate) fn read(
        snapshot: &Snapshot,
        (name, config): (&str, &Json),
        measures: Measures,
        random_state: bool,
    ) -> Result<Option<Self>> {
        if random_state {
            let stored = snapshot.for_config(name, config, |_: &OfRandomState| true)?;
            return Ok(stored.map(|stored| Self {
                rng: Rng::RandomState(Box::new((stored.rng, stored.generator))),
                constants: stored.constants,
                steps: stored.steps,
                data: stored.data,
                measures,
                measured: None,
            }));
        }
        let read = |step: &Option<BTreeMap<String, Number>>| match step {
            Some(numbers) => Measured::read(measures, numbers).map(Some),
            None => Some(None),
        };
        let whole = |stored: &OfGenerator| read(&stored.step).is_some();
        let stored = snapshot.for_config(name, config, whole)?;
        Ok(stored.map(|stored| Self {
            rng: Rng::Generator(stored.rng),
            constants: stored.constants,
            steps: 0,
            data: stored.data,
            measures,
            measured: read(&stored.step).flatten(),
        }))
    }
}

#[derive(Deserialize)]
struct OfGenerator {
    rng: Generator,
    #[serde(default)]
    constants: Vec<f64>,
    data: Data,
    #[serde(deserialize_with = "Option::deserialize")]
    step: Option<BTreeMap<String, Number>>,
}

#[derive(Deserialize)]
struct OfRandomState {
    rng: RandomState,
    generator: Generator,
    constants: Vec<f64>,
    steps: u64,
    data: Data,
}

/// An episode stores what its kind of task has: a generator, drawn constants and measured numbers, or
/// two generators, constants and the number of steps.
impl Serialize for Episode {
    fn serialize<S: Serializer>(&self, serializer: S) -> std::result::Result<S::Ok, S::Error> {
        #[derive(Serialize)]
        struct WithGenerator<'a> {
            rng: &'a Generator,
            #[serde(skip_serializing_if = "<[f64]>::is_empty")]
            constants: &'a [f64],
            data: &'a Data,
            step: Option<Stored<'a>>,
        }
        #[derive(Serialize)]
        struct WithRandomState<'a> {
            rng: &'a RandomState,
            generator: &'a Generator,
            constants: &'a [f64],
            steps: u64,
            data: &'a Data,
        }
        let Self { data, measures, .. } = self;
        match &self.rng {
            Rng::Generator(rng) => WithGenerator {
                rng,
                constants: &self.constants,
                data,
                step: self.measured.as_ref().map(|step| Stored(measures, step)),
            }
            .serialize(serializer),
            Rng::RandomState(both) => WithRandomState {
                rng: &both.0,
                generator: &both.1,
                constants: &self.constants,
                steps: self.steps,
                data,
            }
            .serialize(serializer),
        }
    }
}
