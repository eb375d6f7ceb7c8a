use crate::{BoxEnv, Env, Error, Outcome, Reset, Result, WrapperSpec};

/// Takes each action several times and adds up the rewards; an end of the episode ends the
/// repetition.
///
/// Where a step after the first is an `Err`, the steps before it were taken.
#[derive(Clone, Debug)]
pub struct RepeatAction<E = BoxEnv> {
    env: E,
    num_repeats: u32,
}

super::reach!(RepeatAction<E>);

impl<E: Env> RepeatAction<E> {
    /// Takes each action `num_repeats` times.
    ///
    /// # Errors
    /// [`Error::InvalidArgument`] for 0 repeats.
    pub fn new(env: E, num_repeats: u32) -> Result<Self> {
        if num_repeats == 0 {
            return Err(Error::argument("RepeatAction", "num_repeats is 0: it must be at least 1"));
        }
        Ok(Self { env, num_repeats })
    }

    /// How often each action is taken.
    pub fn num_repeats(&self) -> u32 {
        self.num_repeats
    }
}

impl<E: Env> crate::Wrapper for RepeatAction<E> {
    type Observation = E::Observation;
    type Action = E::Action;

    super::within!(E);

    fn reset_into(&mut self, reset: &Reset, observation: &mut E::Observation) -> Result<()> {
        self.env.reset_into(reset, observation)
    }

    fn step_into(&mut self, action: &E::Action, observation: &mut E::Observation) -> Result<Outcome> {
        let mut total = Outcome::default();
        for _ in 0..self.num_repeats {
            let outcome = self.env.step_into(action, observation)?;
            total = Outcome { reward: total.reward + outcome.reward, ..outcome };
            if total.done() {
                break;
            }
        }
        Ok(total)
    }

    fn wrapper_spec(&self) -> Option<WrapperSpec> {
        Some(WrapperSpec::new("RepeatAction").arg("num_repeats", self.num_repeats))
    }
}
