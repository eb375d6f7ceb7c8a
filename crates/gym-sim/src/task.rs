//! Tasks on a model.

use std::collections::BTreeMap;
use std::fmt;

use gym_core::{Array, Goals, Kwargs, Result, Value};
use mujoco_engine::lanes::Derived;
use mujoco_engine::{CompiledModel, Data, Model};
use serde::ser::SerializeMap;
use serde::{Deserialize, Serialize, Serializer};

use crate::{Naming, Observation, Rng, Simulation, Start};

/// Takes an entry of `info`.
pub type Visit<'a> = &'a mut dyn FnMut(&str, f64);

/// A task on a model: starts, steps, rewards and observations. [`SimEnv`](crate::SimEnv) is its
/// environment.
///
/// A task holds constants only: the state is the [`Data`], and what a step measured. What a task
/// remembers beside the model's state, such as a goal, is the data's `userdata`.
pub trait SimTask: fmt::Debug + Send + Sync + 'static {
    /// Checks the [options](field@gym_core::Reset::options) of a reset, before anything changes.
    ///
    /// # Errors
    /// [`Error::InvalidArgument`](gym_core::Error::InvalidArgument) for an option with a bad value.
    fn check_options(&self, options: &Kwargs) -> Result<()> {
        let _ = options;
        Ok(())
    }

    /// Sets the positions and velocities of a new episode. The data is in the model's initial
    /// configuration; what follows from the state is computed afterwards.
    ///
    /// # Errors
    /// [`Error::InvalidArgument`](gym_core::Error::InvalidArgument) if no valid state is found.
    fn start(&self, start: &mut Start<'_>) -> Result<()>;

    /// Whether an episode that is not seeded keeps what the last one left in the data, such as
    /// controls and the solver's starting point, instead of a cleared state.
    fn goes_on(&self) -> bool {
        false
    }

    /// Adds the parts of the observation, always the same in the same order.
    fn observe(&self, m: &Model, d: &Data, out: &mut Observation);

    /// Adds the names of the numbers that [`observe`](Self::observe) adds, part by part in the same
    /// order. By default, they have none.
    fn names(&self, names: &mut Naming<'_>) {
        let _ = names;
    }

    /// Takes a step with an action of any precision. By default it [steps](Simulation::step) the
    /// simulation, and measures [`reward`](Self::reward) and [`is_over`](Self::is_over).
    fn step(&self, simulation: &Simulation, d: &mut Data, action: &Array) -> Measured {
        simulation.step(d, action);
        Measured::new(self.reward(&simulation.model, d), self.is_over(d))
    }

    /// Changes the state before a step, such as by limiting velocities. To do so twice must equal
    /// doing it once.
    fn prepare(&self, d: &mut Data) {
        let _ = d;
    }

    /// Draws what the next observation needs beside the state, such as noise of sensors, after a
    /// start or a step.
    fn sense(&self, d: &mut Data, rng: &mut Rng) {
        let _ = (d, rng);
    }

    /// Follows a step that was observed: draws another goal, for instance. The reward can still
    /// change.
    fn follow(&self, d: &mut Data, rng: &mut Rng, measured: &mut Measured) {
        let _ = (d, rng, measured);
    }

    /// Sets derived arrays that do not follow from the model, such as the place of a site that
    /// shows a goal.
    fn show(&self, d: &mut Data) {
        let _ = d;
    }

    /// The number of numbers that the task remembers in `userdata`; they are 0 before
    /// [`start`](Self::start).
    fn remembers(&self) -> usize {
        0
    }

    /// The rewards of goals, for a task with goals.
    fn goals(&self) -> Option<&dyn Goals> {
        None
    }

    /// The reward of the step that led to this state, for tasks without a [`step`](Self::step) of
    /// their own.
    fn reward(&self, m: &Model, d: &Data) -> f64 {
        let _ = (m, d);
        0.0
    }

    /// Whether this state terminates the episode, for tasks without a [`step`](Self::step) of their
    /// own.
    fn is_over(&self, d: &Data) -> bool {
        let _ = d;
        false
    }

    /// Passes the entries of `info` to `visit`: after a step, or with `None` after a reset.
    fn info(
        &self,
        simulation: &Simulation,
        d: &Data,
        measured: Option<&Measured>,
        visit: Visit<'_>,
    ) {
        let _ = (simulation, d, measured, visit);
    }

    /// Passes the entries of `info` that are not numbers to `visit`: after a step, or with `None`
    /// after a reset.
    fn lists(&self, d: &Data, measured: Option<&Measured>, visit: &mut dyn FnMut(&str, Value)) {
        let _ = (d, measured, visit);
    }

    /// The last entry of `info`, `success`: after a step, or with `None` after a reset.
    fn success(&self, d: &Data, measured: Option<&Measured>) -> Option<bool> {
        let _ = (d, measured);
        None
    }

    /// The entry of `info` after which lengths and velocities of the tendons are inserted; `None`
    /// if `info` does not have them.
    fn tendons_follow(&self) -> Option<&'static str> {
        None
    }

    /// The names of the [numbers](Measured::with) that a step measures, as snapshots have them.
    fn measures(&self) -> Measures {
        &[]
    }

    /// The derived arrays that steps, observations and `info` read, beside time, positions,
    /// velocities and controls. Vectors then step several worlds together, and compute other arrays
    /// only on request. With `None`, worlds step one by one.
    fn reads(&self, m: &Model) -> Option<Vec<Derived>> {
        let _ = m;
        None
    }

    /// Writes the [constants](Start::constants) that [`start`](Self::start) drew to the model.
    fn apply(&self, constants: &[f64], model: &mut CompiledModel) {
        let _ = (constants, model);
    }

    /// Whether `constants` has the number of constants that [`start`](Self::start) draws.
    fn has(&self, constants: &[f64]) -> bool {
        constants.is_empty()
    }
}

/// Names of the numbers that a step measures, each with the length of its vector; 1 for a scalar.
pub type Measures = &'static [(&'static str, usize)];

/// The largest number of measured numbers.
const MOST: usize = 8;

/// What a step measured.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Measured {
    /// The reward.
    pub reward: f64,
    /// Whether the task ended.
    pub terminated: bool,
    numbers: [f64; MOST],
}

impl Measured {
    /// A reward, and whether the task ended.
    #[must_use]
    pub const fn new(reward: f64, terminated: bool) -> Self {
        Self {
            reward,
            terminated,
            numbers: [0.0; MOST],
        }
    }

    /// The same with numbers for `info`, at most 8, in the order of [`SimTask::measures`].
    #[must_use]
    pub fn with<const N: usize>(mut self, numbers: [f64; N]) -> Self {
        const { assert!(N <= MOST, "too many measured numbers") };
        self.numbers[..N].copy_from_slice(&numbers);
        self
    }

    /// The numbers that [`with`](Self::with) set.
    #[must_use]
    pub fn numbers<const N: usize>(&self) -> [f64; N] {
        const { assert!(N <= MOST, "too many measured numbers") };
        std::array::from_fn(|i| self.numbers[i])
    }

    /// Reads the form that [`Stored`] writes; `None` if a number is missing or not finite.
    pub(crate) fn read(measures: Measures, stored: &BTreeMap<String, Number>) -> Option<Self> {
        let mut measured = Self::new(0.0, false);
        let mut numbers = measured.numbers.iter_mut();
        for (name, length) in measures {
            let values = match stored.get(*name)? {
                Number::One(value) => std::slice::from_ref(value),
                Number::Several(values) => values,
            };
            if values.len() != *length || values.iter().any(|x| !x.is_finite()) {
                return None;
            }
            numbers.by_ref().zip(values).for_each(|(to, x)| *to = *x);
        }
        Some(measured)
    }
}

/// A stored number or vector.
#[derive(Deserialize)]
#[serde(untagged, expecting = "expected a number or a list of numbers")]
pub(crate) enum Number {
    One(f64),
    Several(Vec<f64>),
}

/// The stored form of measured numbers: a map by names.
pub(crate) struct Stored<'a>(pub(crate) Measures, pub(crate) &'a Measured);

impl Serialize for Stored<'_> {
    fn serialize<S: Serializer>(&self, serializer: S) -> std::result::Result<S::Ok, S::Error> {
        let Self(measures, measured) = self;
        let mut map = serializer.serialize_map(Some(measures.len()))?;
        let mut first = 0;
        for (name, length) in *measures {
            let numbers = &measured.numbers[first..first + length];
            match numbers {
                [number] => map.serialize_entry(name, number)?,
                numbers => map.serialize_entry(name, numbers)?,
            }
            first += length;
        }
        map.end()
    }
}
