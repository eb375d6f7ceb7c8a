use crate::{Env, EnvSpec, Error, Outcome, Result, WrapperSpec};

/// Takes each action several times and adds up the rewards; an end of the episode ends the
/// repetition.
#[derive(Clone, Debug)]
pub struct RepeatAction<E> {
    env: E,
    num_repeats: u32,
}

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

    /// The environment within.
    pub fn into_inner(self) -> E {
        self.env
    }
}

impl<E: Env> Env for RepeatAction<E> {
    type Observation = E::Observation;
    type Action = E::Action;

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

    fn spec(&self) -> Option<EnvSpec> {
        let wrapper = WrapperSpec::new("RepeatAction").arg("num_repeats", self.num_repeats);
        self.env.spec().map(|spec| spec.wrapped(wrapper))
    }

    crate::forward!(
        env: reset_into, observation_space, action_space, snapshot, restore, info, metadata, draw, ansi, render, base,
        generator, close, describe
    );
}
