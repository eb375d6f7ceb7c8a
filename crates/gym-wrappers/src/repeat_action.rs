//! Repeated actions.

use gym_core::{
    BoxEnv, Env, Outcome, Reset, Result, Wrapper, WrapperSpec, registry::WrapperConfig,
};

/// Takes each action several times and adds up the rewards. The end of the episode ends the
/// repetition.
///
/// If a repeat is refused, earlier ones have been taken: reset or restore the environment after an
/// error.
#[derive(Clone, Debug)]
pub struct RepeatAction<E = BoxEnv> {
    inner: E,
    config: Config,
}

gym_core::arguments! {
    /// The arguments of [`RepeatAction`].
    #[derive(Copy)]
    pub struct Config {
        /// The number of times each action is taken, at least 1.
        pub num_repeats: u32,
    }
}

impl From<u32> for Config {
    fn from(num_repeats: u32) -> Self {
        Self { num_repeats }
    }
}

gym_core::register_wrapper!("RepeatAction", "repeats each action", Config, env: RepeatAction::new);

gym_core::inner!(impl RepeatAction<E>);

impl<E: Env> RepeatAction<E> {
    /// Repeats the actions for `env`.
    ///
    /// # Errors
    /// [`Error::InvalidArgument`](gym_core::Error) for 0 repeats.
    pub fn new(env: E, config: impl Into<Config>) -> Result<Self> {
        let config = config.into();
        match config.num_repeats {
            0 => Err(Config::refuse("num_repeats is 0: it must be at least 1")),
            _ => Ok(Self { inner: env, config }),
        }
    }
}

impl<E: Env> Wrapper for RepeatAction<E> {
    type Observation = E::Observation;
    type Action = E::Action;

    gym_core::inner!(E);

    fn on_reset(&mut self, reset: &Reset, observation: &mut E::Observation) -> Result<()> {
        self.inner.reset_into(reset, observation)
    }

    fn on_step(&mut self, action: &E::Action, observation: &mut E::Observation) -> Result<Outcome> {
        let mut total = Outcome::default();
        for _ in 0..self.config.num_repeats {
            let outcome = self.inner.step_into(action, observation)?;
            total = Outcome {
                reward: total.reward + outcome.reward,
                ..outcome
            };
            if total.done() {
                break;
            }
        }
        Ok(total)
    }

    fn wrapper_spec(&self) -> Option<WrapperSpec> {
        Some(self.config.spec())
    }
}
