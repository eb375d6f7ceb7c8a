use crate::{BoxEnv, Env, Outcome, Reset, Result, Snapshot, WrapperSpec};

/// Resets by itself: the step after one that ended an episode ignores its action, starts the next
/// episode and gives its first observation, with a reward of 0 and no flag set.
#[derive(Clone, Debug)]
pub struct Autoreset<E = BoxEnv> {
    env: E,
    reset_is_due: bool,
}

super::reach!(Autoreset<E>);

impl<E: Env> Autoreset<E> {
    /// Resets `env` where its episodes end.
    pub fn new(env: E) -> Self {
        Self { env, reset_is_due: false }
    }
}

impl<E: Env> crate::Wrapper for Autoreset<E> {
    type Observation = E::Observation;
    type Action = E::Action;

    super::within!(E);

    fn reset_into(&mut self, reset: &Reset, observation: &mut E::Observation) -> Result<()> {
        self.env.reset_into(reset, observation)?;
        self.reset_is_due = false;
        Ok(())
    }

    fn step_into(&mut self, action: &E::Action, observation: &mut E::Observation) -> Result<Outcome> {
        if self.reset_is_due {
            Env::reset_into(self, &Reset::default(), observation)?;
            return Ok(Outcome::default());
        }
        let outcome = self.env.step_into(action, observation)?;
        self.reset_is_due = outcome.done();
        Ok(outcome)
    }

    fn snapshot(&self) -> Result<Snapshot> {
        Snapshot::of(&(self.env.snapshot()?, self.reset_is_due))
    }

    fn restore(&mut self, snapshot: &Snapshot) -> Result<()> {
        let (env, reset_is_due) = snapshot.get()?;
        self.env.restore(&env)?;
        self.reset_is_due = reset_is_due;
        Ok(())
    }

    fn wrapper_spec(&self) -> Option<WrapperSpec> {
        Some(WrapperSpec::new("Autoreset"))
    }
}
