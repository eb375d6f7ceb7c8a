//! An environment that panics on request, to test the handling of panics.

use gym::{
    Dynamics, Error, Generator, NoArguments, Registration, Reset, Result, Space, Stateful, Task,
    Transition,
};

gym::discrete! {
    /// The request.
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
