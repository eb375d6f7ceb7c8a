use std::ops::RangeInclusive;

use serde_json::Value as Json;

use crate::{BoxEnv, Element, Env, Error, Outcome, Reset, Result, Snapshot, WrapperSpec};

/// At random repeats the last action in place of the one that was asked for, by
/// [Machado et al., 2018](https://arxiv.org/abs/1709.06009), section 5.2.
///
/// The draws come from the environment's own [generator](Env::generator), as in Gymnasium, so they
/// shift what the environment draws.
#[derive(Clone, Debug)]
pub struct StickyAction<E: Env = BoxEnv> {
    env: E,
    probability: f64,
    duration: RangeInclusive<u32>,
    last: E::Action,
    state: Stickiness,
}

#[derive(Clone, Copy, Debug, Default, serde::Serialize, serde::Deserialize)]
struct Stickiness {
    has_last: bool,
    is_stuck: bool,
    /// How long the running series of repeats is to be; 0 if there is none.
    num_repeats: u32,
    repeats_taken: u32,
}

super::reach!(StickyAction<E: Env>);

impl<E: Env> StickyAction<E> {
    /// Repeats the last action with that probability, for one step.
    ///
    /// # Errors
    /// [`Error::InvalidArgument`] for a probability outside `[0, 1)`.
    pub fn new(env: E, repeat_action_probability: f64) -> Result<Self> {
        if !(0.0..1.0).contains(&repeat_action_probability) {
            return Err(Error::argument(
                "StickyAction",
                format!("repeat_action_probability is {repeat_action_probability}: it must be in [0, 1)"),
            ));
        }
        let state = Stickiness::default();
        Ok(Self {
            env,
            probability: repeat_action_probability,
            duration: 1..=1,
            last: E::Action::empty(),
            state,
        })
    }

    /// Repeats for a number of steps drawn from `duration` each time: `3..=3` for always three.
    ///
    /// # Errors
    /// [`Error::InvalidArgument`] for an empty range or one that contains 0.
    pub fn with_duration(self, duration: RangeInclusive<u32>) -> Result<Self> {
        if duration.is_empty() || *duration.start() == 0 {
            return Err(Error::argument(
                "StickyAction",
                format!("repeat_action_duration is {duration:?}: it must go from at least 1 to no less"),
            ));
        }
        Ok(Self { duration, ..self })
    }

    /// The probability that the last action is repeated.
    pub fn repeat_action_probability(&self) -> f64 {
        self.probability
    }

    /// For how many steps it is repeated.
    pub fn repeat_action_duration(&self) -> RangeInclusive<u32> {
        self.duration.clone()
    }

    /// Whether the next step repeats the last action, and the state after it.
    fn draw(&mut self) -> Result<(bool, Stickiness)> {
        let mut state = self.state;
        if !state.has_last {
            return Ok((false, Stickiness { has_last: true, ..state }));
        }
        let rng = super::lend(&mut self.env, "StickyAction")?;
        let repeats = state.is_stuck || rng.random() < self.probability;
        if repeats {
            if state.num_repeats == 0 {
                let (low, high) = (i64::from(*self.duration.start()), i64::from(*self.duration.end()));
                state.num_repeats = rng.integers(low, high + 1) as u32;
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

impl<E: Env> crate::Wrapper for StickyAction<E> {
    type Observation = E::Observation;
    type Action = E::Action;

    super::within!(E);

    fn reset_into(&mut self, reset: &Reset, observation: &mut E::Observation) -> Result<()> {
        self.env.reset_into(reset, observation)?;
        self.state = Stickiness::default();
        Ok(())
    }

    fn step_into(&mut self, action: &E::Action, observation: &mut E::Observation) -> Result<Outcome> {
        let before = self.env.generator().cloned();
        let (repeats, state) = self.draw()?;
        let outcome = self.env.step_into(if repeats { &self.last } else { action }, observation);
        match &outcome {
            Ok(_) => {
                self.state = state;
                if !repeats {
                    self.last.clone_from(action);
                }
            }
            // a step that was refused has drawn nothing
            Err(_) => {
                if let (Some(rng), Some(before)) = (self.env.generator(), before) {
                    *rng = before;
                }
            }
        }
        outcome
    }

    fn snapshot(&self) -> Result<Snapshot> {
        let last = match self.state.has_last {
            true => self.env.action_space().to_json(&self.last.to_value())?,
            false => Json::Null,
        };
        Snapshot::of(&(self.env.snapshot()?, last, self.state))
    }

    fn restore(&mut self, snapshot: &Snapshot) -> Result<()> {
        let (env, last, state): (_, Json, Stickiness) = snapshot.get()?;
        let last = match state.has_last {
            true => super::element(&self.env.action_space(), &last)?,
            false => E::Action::empty(),
        };
        if state.is_stuck != (state.repeats_taken < state.num_repeats) {
            return Err(Error::Snapshot("StickyAction: the repeats do not add up".into()));
        }
        self.env.restore(&env)?;
        (self.last, self.state) = (last, state);
        Ok(())
    }

    fn wrapper_spec(&self) -> Option<WrapperSpec> {
        let (low, high) = (*self.duration.start(), *self.duration.end());
        let duration = if low == high { Json::from(low) } else { Json::from(vec![low, high]) };
        Some(
            WrapperSpec::new("StickyAction")
                .arg("repeat_action_probability", self.probability)
                .arg("repeat_action_duration", duration),
        )
    }
}
