//! Automatic resets.

use gym_core::{
    BoxEnv, Env, Outcome, Reset, Result, Snapshot, Wrapper, WrapperSpec, registry::WrapperConfig,
};

/// Resets automatically: the step after the end of an episode ignores its action, starts the next
/// episode and returns its first observation, with a reward of 0 and no flag set.
#[derive(Clone, Debug)]
pub struct Autoreset<E = BoxEnv> {
    inner: E,
    reset_is_due: bool,
}

gym_core::arguments! {
    /// [`Autoreset`] has no arguments.
    pub struct Config {}
}

gym_core::register_wrapper!(
    "Autoreset", "resets in the step after the end of an episode", Config, env: |env, _| Ok(Autoreset::new(env))
);

gym_core::inner!(impl Autoreset<E>);

impl<E: Env> Autoreset<E> {
    /// Resets `env` automatically after the end of an episode.
    pub fn new(env: E) -> Self {
        Self {
            inner: env,
            reset_is_due: false,
        }
    }
}

impl<E: Env> Wrapper for Autoreset<E> {
    type Observation = E::Observation;
    type Action = E::Action;

    gym_core::inner!(E);

    fn on_reset(&mut self, reset: &Reset, observation: &mut E::Observation) -> Result<()> {
        self.inner.reset_into(reset, observation)?;
        self.reset_is_due = false;
        Ok(())
    }

    fn on_step(&mut self, action: &E::Action, observation: &mut E::Observation) -> Result<Outcome> {
        if self.reset_is_due {
            self.on_reset(&Reset::default(), observation)?;
            return Ok(Outcome::default());
        }
        let outcome = self.inner.step_into(action, observation)?;
        self.reset_is_due = outcome.done();
        Ok(outcome)
    }

    fn on_snapshot(&self) -> Result<Snapshot> {
        Snapshot::of(&(self.inner.snapshot()?, self.reset_is_due))
    }

    fn on_restore(&mut self, snapshot: &Snapshot) -> Result<()> {
        let (inner, reset_is_due) = snapshot.get()?;
        self.inner.restore(&inner)?;
        self.reset_is_due = reset_is_due;
        Ok(())
    }

    fn wrapper_spec(&self) -> Option<WrapperSpec> {
        Some(Config {}.spec())
    }
}
