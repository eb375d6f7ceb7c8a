//! The elementwise maximum of the last two observations of several steps.

use gym_core::{
    Array, BoxEnv, Element, Env, Outcome, Reset, Result, Snapshot, Space, Value, Wrapper,
    WrapperSpec, registry::WrapperConfig,
};
use serde_json::Value as Json;

use crate::within::element;

/// Repeats each action for several steps, adds up the rewards, and observes the elementwise maximum
/// of the last two observations, so that flickering objects are visible.
///
/// If an episode ends before the last step of a series, the maximum is over the last two stored
/// observations, as in Gymnasium. If a step of a series is refused, earlier ones have been taken:
/// reset or restore the environment after an error.
#[derive(Clone, Debug)]
pub struct MaxAndSkipObservation<E = BoxEnv> {
    inner: E,
    config: Config,
    /// The observations of the second-last and the last step of a series.
    last: [Value; 2],
    seen: Value,
}

gym_core::arguments! {
    /// The arguments of [`MaxAndSkipObservation`].
    #[derive(Copy)]
    pub struct Config {
        /// The number of steps for each action, at least 2.
        pub skip: u32 = 4,
    }
}

impl From<u32> for Config {
    fn from(skip: u32) -> Self {
        Self { skip }
    }
}

gym_core::register_wrapper!(
    "MaxAndSkipObservation", "repeats actions, and observes the larger of the last two observations", Config,
    env: MaxAndSkipObservation::new
);

gym_core::inner!(impl MaxAndSkipObservation<E>);

impl<E: Env> MaxAndSkipObservation<E> {
    /// Skips observations of `env`.
    ///
    /// # Errors
    /// [`Error::InvalidArgument`](gym_core::Error) for a skip below 2, or observations that are not
    /// arrays or integers.
    pub fn new(env: E, config: impl Into<Config>) -> Result<Self> {
        let (config, space) = (config.into(), env.observation_space());
        if config.skip < 2 {
            return Err(Config::refuse(format!(
                "skip is {}: it must be at least 2",
                config.skip
            )));
        }
        let zero = match (&space, space.dtype(), space.shape()) {
            (Space::Discrete(_), ..) => Value::Int(0),
            (_, Some(dtype), Some(shape)) => Value::Array(Array::zeros(dtype, shape)?),
            _ => {
                let reason =
                    format!("it needs observations with a shape, and the space is {space}");
                return Err(Config::refuse(reason));
            }
        };
        Ok(Self {
            inner: env,
            config,
            last: [zero.clone(), zero],
            seen: Value::Null,
        })
    }
}

impl<E: Env> Wrapper for MaxAndSkipObservation<E> {
    type Observation = Value;
    type Action = E::Action;

    gym_core::inner!(E);

    fn on_reset(&mut self, reset: &Reset, observation: &mut Value) -> Result<()> {
        E::Observation::fill(observation, |observation| {
            self.inner.reset_into(reset, observation)
        })
    }

    fn on_step(&mut self, action: &E::Action, observation: &mut Value) -> Result<Outcome> {
        let Self {
            inner,
            config,
            last,
            seen,
        } = self;
        let mut total = Outcome::default();
        for left in (0..config.skip).rev() {
            let outcome = E::Observation::fill(seen, |seen| inner.step_into(action, seen))?;
            if left < 2 {
                last[1 - left as usize].clone_from(seen);
            }
            total = Outcome {
                reward: total.reward + outcome.reward,
                ..outcome
            };
            if total.done() {
                break;
            }
        }
        observation.clone_from(&last[0]);
        match (observation, &last[1]) {
            (Value::Int(a), Value::Int(b)) => *a = (*a).max(*b),
            (Value::Array(a), Value::Array(b)) => a.maximum(b),
            _ => {}
        }
        Ok(total)
    }

    fn on_snapshot(&self) -> Result<Snapshot> {
        let space = self.inner.observation_space();
        let [earlier, later] = &self.last;
        Snapshot::of(&(
            self.inner.snapshot()?,
            space.to_json(earlier)?,
            space.to_json(later)?,
        ))
    }

    fn on_restore(&mut self, snapshot: &Snapshot) -> Result<()> {
        let (inner, earlier, later): (_, Json, Json) = snapshot.get()?;
        let space = self.inner.observation_space();
        let last = [element(&space, &earlier)?, element(&space, &later)?];
        self.inner.restore(&inner)?;
        self.last = last;
        Ok(())
    }

    fn wrapper_spec(&self) -> Option<WrapperSpec> {
        Some(self.config.spec())
    }
}
