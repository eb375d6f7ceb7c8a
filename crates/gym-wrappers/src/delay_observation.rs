//! Delayed observations.

use gym_core::{
    BoxEnv, Element, Env, Error, Outcome, Reset, Result, Snapshot, Wrapper, WrapperSpec,
    registry::WrapperConfig,
};
use serde_json::Value as Json;

use crate::ring::Ring;

/// Delays each observation by a number of steps. Before the first, observations are zeros (or the
/// element of the space nearest to zero).
#[derive(Clone, Debug)]
pub struct DelayObservation<E: Env = BoxEnv> {
    inner: E,
    config: Config,
    zero: E::Observation,
    /// The observations that are not yet returned.
    ring: Ring<E::Observation>,
}

gym_core::arguments! {
    /// The arguments of [`DelayObservation`].
    #[derive(Copy)]
    pub struct Config {
        /// The delay in steps.
        pub delay: usize,
    }
}

impl From<usize> for Config {
    fn from(delay: usize) -> Self {
        Self { delay }
    }
}

gym_core::register_wrapper!(
    "DelayObservation", "delays observations by a number of steps", Config, env: DelayObservation::new
);

gym_core::inner!(impl DelayObservation<E: Env>);

impl<E: Env> DelayObservation<E> {
    /// Delays the observations of `env`.
    ///
    /// # Errors
    /// [`Error::InvalidSpace`] if the observation space has no zero; [`Error::InvalidArgument`] for
    /// a delay beyond the memory.
    pub fn new(env: E, config: impl Into<Config>) -> Result<Self> {
        let (config, zero) = (config.into(), env.observation_space().zero()?);
        let zero = E::Observation::from_value(&zero).ok_or_else(|| {
            Error::Contract(format!("{zero} does not fit the type of the observations"))
        })?;
        let ring = Ring::new(config.delay, &zero).ok_or_else(|| {
            Config::refuse(format!(
                "delay = {} observations do not fit in memory",
                config.delay
            ))
        })?;
        Ok(Self {
            inner: env,
            config,
            zero,
            ring,
        })
    }
}

impl<E: Env> Wrapper for DelayObservation<E> {
    type Observation = E::Observation;
    type Action = E::Action;

    gym_core::inner!(E);

    fn on_reset(&mut self, reset: &Reset, observation: &mut E::Observation) -> Result<()> {
        self.inner.reset_into(reset, observation)?;
        self.ring.fill(&self.zero);
        self.ring.exchange(observation);
        Ok(())
    }

    fn on_step(&mut self, action: &E::Action, observation: &mut E::Observation) -> Result<Outcome> {
        let outcome = self.inner.step_into(action, observation)?;
        self.ring.exchange(observation);
        Ok(outcome)
    }

    fn on_snapshot(&self) -> Result<Snapshot> {
        Snapshot::of(&(
            self.inner.snapshot()?,
            self.ring.to_json(&self.inner.observation_space())?,
        ))
    }

    fn on_restore(&mut self, snapshot: &Snapshot) -> Result<()> {
        let (inner, stored): (_, Vec<Json>) = snapshot.get()?;
        let ring = self.ring.read(&self.inner.observation_space(), &stored)?;
        self.inner.restore(&inner)?;
        self.ring = ring;
        Ok(())
    }

    fn wrapper_spec(&self) -> Option<WrapperSpec> {
        Some(self.config.spec())
    }
}
