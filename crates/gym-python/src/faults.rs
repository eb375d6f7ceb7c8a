//! Environments for tests: one panics on request, the other returns its last action.

use gym::{
    Configure, Dynamics, Env, Error, Generator, NoArguments, Outcome, Registration, Reset, Result,
    Space, Stateful, Task, Transition, Value,
};

gym::discrete! {
    /// What the environment is asked to do.
    pub(crate) enum Action {
        /// Nothing.
        Wait,
        /// Panic.
        Panic,
        /// Refuse.
        Refuse,
    }
}

/// Panics at the action `Panic`, and at a reset with the option `panic`.
#[derive(Clone, Debug)]
pub(crate) struct Panics;

impl Task for Panics {
    type Config = NoArguments;
    type State = i64;
    type Observation = i64;
    type Action = Action;

    const NAME: &'static str = "Panics";

    fn new(_: NoArguments) -> Result<Self> {
        Ok(Self)
    }

    fn config(&self) -> &NoArguments {
        &NoArguments {}
    }

    fn observation_space(&self) -> Space {
        Space::discrete(1000)
    }

    fn action_space(&self) -> Space {
        Action::space()
    }

    fn start(&self, reset: &Reset, _rng: &mut Generator) -> Result<i64> {
        assert!(
            !reset.options.contains_key("panic"),
            "asked to panic at a reset"
        );
        Ok(0)
    }

    fn is_valid(&self, state: &i64) -> bool {
        (0..1000).contains(state)
    }
}

impl Dynamics for Panics {
    fn transition(
        &self,
        state: &i64,
        action: &Action,
        _rng: &mut Generator,
    ) -> Result<Transition<i64>> {
        match action {
            Action::Wait => Ok(Transition {
                state: state + 1,
                reward: 0.0,
                terminated: false,
            }),
            Action::Panic => panic!("asked to panic at step {state}"),
            Action::Refuse => Err(Error::custom("asked to refuse")),
        }
    }

    fn observe(&self, state: &i64) -> i64 {
        *state
    }
}

gym::register!(
    Registration::new::<Stateful<Panics>>("faults/Panics-v0")
        .description("Panics when told to.")
        .reset_options(&[("panic", "true")])
);

gym::arguments! {
    /// The arguments of [`Echo`].
    pub(crate) struct EchoConfig {
        /// The space of its actions and observations, as JSON.
        pub space: String = r#"{"type": "Discrete", "n": 2, "start": 0, "dtype": "int64"}"#.into(),
    }
}

/// Observes its last action; after a reset, the element of the space nearest to zero.
#[derive(Clone, Debug)]
pub(crate) struct Echo {
    space: Space,
}

impl Configure for Echo {
    type Config = EchoConfig;

    fn configure(config: EchoConfig, _version: u32) -> Result<Self> {
        let space = serde_json::from_str(&config.space);
        let space = space.map_err(|error| Error::argument("space", error.to_string()))?;
        Ok(Self { space })
    }
}

impl Env for Echo {
    type Observation = Value;
    type Action = Value;

    fn observation_space(&self) -> Space {
        self.space.clone()
    }

    fn action_space(&self) -> Space {
        self.space.clone()
    }

    fn reset_into(&mut self, _reset: &Reset, observation: &mut Value) -> Result<()> {
        *observation = self.space.zero()?;
        Ok(())
    }

    fn step_into(&mut self, action: &Value, observation: &mut Value) -> Result<Outcome> {
        *observation = action.clone();
        Ok(Outcome::default())
    }
}

gym::register!(
    Registration::new::<Echo>("faults/Echo-v0").description("Observes its last action.")
);
