use gym_core::{Configure, Env, Outcome, Reset, Result, forward};
use serde::{Deserialize, Serialize};

/// An environment with its default arguments and no others: an older version, from before there
/// were any. It shows itself as the environment within.
#[derive(Clone, Debug)]
pub(crate) struct NoArguments<E>(E);

#[derive(Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Config {}

impl<E: Configure> Configure for NoArguments<E> {
    type Config = Config;

    fn configure(Config {}: Config) -> Result<Self> {
        E::configure(E::Config::default()).map(Self)
    }
}

impl<E: Configure> Env for NoArguments<E> {
    type Observation = E::Observation;
    type Action = E::Action;

    fn reset_into(&mut self, reset: &Reset, observation: &mut E::Observation) -> Result<()> {
        self.0.reset_into(reset, observation)
    }

    fn step_into(&mut self, action: &E::Action, observation: &mut E::Observation) -> Result<Outcome> {
        self.0.step_into(action, observation)
    }

    fn describe(&self) -> String {
        self.0.describe()
    }

    forward!(
        0: observation_space, action_space, snapshot, restore, info, metadata, draw, ansi, render, spec,
        base, close
    );
}
