//! A wrapper that makes the cheap checks of conformance.

use crate::env::{BoxEnv, Env, Outcome};
use crate::spaces::Space;
use crate::spec::{EnvSpec, Reset, WrapperConfig};
use crate::value::{Element, Error, Result};

/// Checks once, on the first reset and the first step, that the environment keeps its contract:
/// the observation lies in its space, and the reward is a finite number.
///
/// These are the cheap checks of the crate gym-conform; [`make`](crate::make) adds them by default,
/// so that a mistake in a new environment shows at once. Episodes started with options are not
/// checked, because options may lead beyond the space. Snapshots do not contain the checker's
/// state. An [`Error::Contract`] is about the result: the environment has been reset or has stepped
/// nevertheless.
#[derive(Clone, Debug)]
pub struct PassiveEnvChecker<E = BoxEnv> {
    inner: E,
    checked_reset: bool,
    checked_step: bool,
    /// Whether the running episode was started with options.
    has_options: bool,
}

crate::arguments! {
    /// [`PassiveEnvChecker`] has no arguments.
    pub struct Config {}
}

crate::register_wrapper!(
    "PassiveEnvChecker", "refuses observations outside their space, on the first reset and step", Config, env: |env, _| Ok(PassiveEnvChecker::new(env))
);

crate::inner!(impl PassiveEnvChecker<E>);

impl<E: Env> PassiveEnvChecker<E> {
    /// Watches over `env`.
    pub fn new(env: E) -> Self {
        Self {
            inner: env,
            checked_reset: false,
            checked_step: false,
            has_options: false,
        }
    }

    fn check_observation(&self, call: &str, observation: &E::Observation) -> Result<()> {
        let space: Space = self.inner.observation_space();
        space
            .check(&observation.to_value())
            .map_err(|error| Error::Contract(format!("the observation of `{call}`: {error}")))
    }
}

impl<E: Env> crate::env::Wrapper for PassiveEnvChecker<E> {
    type Observation = E::Observation;
    type Action = E::Action;

    crate::inner!(E);

    fn on_reset(&mut self, reset: &Reset, observation: &mut E::Observation) -> Result<()> {
        self.inner.reset_into(reset, observation)?;
        self.has_options = !reset.options.is_empty();
        if !self.checked_reset && !self.has_options {
            self.check_observation("reset", observation)?;
            self.checked_reset = true;
        }
        Ok(())
    }

    #[inline]
    fn on_step(&mut self, action: &E::Action, observation: &mut E::Observation) -> Result<Outcome> {
        let outcome = self.inner.step_into(action, observation)?;
        if !self.checked_step && !self.has_options {
            self.check_observation("step", observation)?;
            if !outcome.reward.is_finite() {
                return Err(Error::Contract(format!(
                    "the reward of `step` is {}",
                    outcome.reward
                )));
            }
            self.checked_step = true;
        }
        Ok(outcome)
    }

    fn on_spec(&self) -> Option<EnvSpec> {
        // directly around the environment, this wrapper counts as the one that `make` adds; outside
        // another wrapper, it is an additional wrapper
        self.inner
            .spec()
            .map(|spec| match spec.additional_wrappers.is_empty() {
                true => EnvSpec {
                    disable_env_checker: false,
                    ..spec
                },
                false => spec.wrapped(Config {}.spec()),
            })
    }
}
