//! Sticky actions.

use std::ops::RangeInclusive;

use gym_core::{
    BoxEnv, Element, Env, Error, Outcome, Reset, Result, Snapshot, Wrapper, WrapperSpec,
    registry::WrapperConfig,
};
use serde::{Deserialize, Serialize};
use serde_json::Value as Json;

use crate::within::{element, lend};

/// Repeats the last action at random, instead of taking the new one, after [Machado et al.,
/// 2018](https://arxiv.org/abs/1709.06009), section 5.2.
///
/// It draws from the environment's own [generator](Env::generator), as in Gymnasium, and so changes
/// the environment's later draws.
#[derive(Clone, Debug)]
pub struct StickyAction<E: Env = BoxEnv> {
    inner: E,
    config: Config,
    last: E::Action,
    state: Stickiness,
}

gym_core::arguments! {
    /// The arguments of [`StickyAction`].
    pub struct Config {
        /// The probability that the last action is repeated, in `[0, 1)`.
        pub repeat_action_probability: f64,
        /// The number of steps to repeat: a number, or a range `[low, high]` from which one is
        /// drawn each time.
        pub repeat_action_duration: Duration = Default::default(),
    }
}

impl From<f64> for Config {
    fn from(repeat_action_probability: f64) -> Self {
        Self {
            repeat_action_probability,
            ..Self::default()
        }
    }
}

impl<D: Into<Duration>> From<(f64, D)> for Config {
    fn from((repeat_action_probability, duration): (f64, D)) -> Self {
        Self {
            repeat_action_probability,
            repeat_action_duration: duration.into(),
        }
    }
}

/// One number, or the two ends of a range.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(
    untagged,
    expecting = "expected a number of steps, or a list of the least and the most"
)]
pub enum Duration {
    /// Always this number of steps.
    Steps(u32),
    /// The least and the most.
    Range(u32, u32),
}

impl gym_core::ArgumentType for Duration {
    fn kind() -> String {
        "integer or list of 2 integers".into()
    }
}

impl Default for Duration {
    fn default() -> Self {
        Self::Steps(1)
    }
}

impl From<RangeInclusive<u32>> for Duration {
    fn from(range: RangeInclusive<u32>) -> Self {
        Self::Range(*range.start(), *range.end())
    }
}

impl Duration {
    fn ends(self) -> (u32, u32) {
        match self {
            Self::Steps(steps) => (steps, steps),
            Self::Range(low, high) => (low, high),
        }
    }
}

#[derive(Clone, Copy, Debug, Default, Serialize, Deserialize)]
struct Stickiness {
    has_last: bool,
    is_stuck: bool,
    /// The length of the current series of repeats; 0 if there is none.
    num_repeats: u32,
    repeats_taken: u32,
}

gym_core::register_wrapper!(
    "StickyAction", "repeats the last action at random", Config, env: StickyAction::new
);

gym_core::inner!(impl StickyAction<E: Env>);

impl<E: Env> StickyAction<E> {
    /// Repeats actions for `env`.
    ///
    /// # Errors
    /// [`Error::InvalidArgument`] for a probability outside `[0, 1)`, an empty range or one that
    /// contains 0.
    pub fn new(env: E, config: impl Into<Config>) -> Result<Self> {
        let config = config.into();
        let Config {
            repeat_action_probability: probability,
            repeat_action_duration: duration,
        } = config;
        if !(0.0..1.0).contains(&probability) {
            let reason =
                format!("repeat_action_probability is {probability}: it must be in [0, 1)");
            return Err(Config::refuse(reason));
        }
        let (low, high) = duration.ends();
        if low == 0 || low > high {
            return Err(Config::refuse(format!(
                "repeat_action_duration is {low} to {high}: the first must be at least 1, the second no smaller"
            )));
        }
        Ok(Self {
            inner: env,
            config,
            last: E::Action::empty(),
            state: Stickiness::default(),
        })
    }

    /// Returns whether the next step repeats the last action, and the state after that step.
    fn draw(&mut self) -> Result<(bool, Stickiness)> {
        let mut state = self.state;
        if !state.has_last {
            return Ok((
                false,
                Stickiness {
                    has_last: true,
                    ..state
                },
            ));
        }
        let rng = lend::<Config>(&mut self.inner)?;
        let repeats = state.is_stuck || rng.random() < self.config.repeat_action_probability;
        if repeats {
            if state.num_repeats == 0 {
                let (low, high) = self.config.repeat_action_duration.ends();
                state.num_repeats = rng.integers(low.into(), i64::from(high) + 1) as u32;
            }
            state.repeats_taken = state.repeats_taken.saturating_add(1);
            state.is_stuck = state.repeats_taken < state.num_repeats;
            if !state.is_stuck {
                (state.num_repeats, state.repeats_taken) = (0, 0);
            }
        }
        Ok((repeats, state))
    }
}

impl<E: Env> Wrapper for StickyAction<E> {
    type Observation = E::Observation;
    type Action = E::Action;

    gym_core::inner!(E);

    fn on_reset(&mut self, reset: &Reset, observation: &mut E::Observation) -> Result<()> {
        self.inner.reset_into(reset, observation)?;
        self.state = Stickiness::default();
        Ok(())
    }

    fn on_step(&mut self, action: &E::Action, observation: &mut E::Observation) -> Result<Outcome> {
        let before = self.inner.generator().cloned();
        let (repeats, state) = self.draw()?;
        let outcome = self
            .inner
            .step_into(if repeats { &self.last } else { action }, observation);
        match &outcome {
            Ok(_) => {
                self.state = state;
                if !repeats {
                    self.last.clone_from(action);
                }
            }
            // the step was refused: undo the draw
            Err(_) => {
                if let (Some(rng), Some(before)) = (self.inner.generator(), before) {
                    *rng = before;
                }
            }
        }
        outcome
    }

    fn on_snapshot(&self) -> Result<Snapshot> {
        let last = match self.state.has_last {
            true => self.inner.action_space().to_json(&self.last.to_value())?,
            false => Json::Null,
        };
        Snapshot::of(&(self.inner.snapshot()?, last, self.state))
    }

    fn on_restore(&mut self, snapshot: &Snapshot) -> Result<()> {
        let (inner, last, state): (_, Json, Stickiness) = snapshot.get()?;
        let last = match state.has_last {
            true => element(&self.inner.action_space(), &last)?,
            false => E::Action::empty(),
        };
        if state.is_stuck != (state.repeats_taken < state.num_repeats) {
            return Err(Error::Snapshot(
                "StickyAction: the repeats do not add up".into(),
            ));
        }
        self.inner.restore(&inner)?;
        (self.last, self.state) = (last, state);
        Ok(())
    }

    fn wrapper_spec(&self) -> Option<WrapperSpec> {
        Some(self.config.spec())
    }
}
