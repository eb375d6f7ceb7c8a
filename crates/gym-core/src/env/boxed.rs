//! Any environment behind one type, as [`make`](crate::make) returns it.

use std::any::{Any, TypeId};
use std::fmt;

use gym_numerics::Generator;

use crate::drawing::canvas::Canvas;
use crate::drawing::render::{Metadata, RenderMode, Rendered};
use crate::env::wrapper::{forward, methods};
use crate::env::{Env, Inspect, Outcome};
use crate::spaces::Space;
use crate::spec::{EnvSpec, Reset};
use crate::value::{Element, Result, Snapshot, Value};

/// An environment whose type is erased, with [`Value`]s for observations and actions.
///
/// It implements [`Env`], so wrappers and generic code accept it. An action must have the kind,
/// type and shape of the action space. A number beyond the bounds of a `Box` reaches the
/// environment, which clips it if Gymnasium's does.
pub struct BoxEnv {
    env: Box<dyn Erased>,
    /// The number of resets, steps and restores.
    moves: u64,
}

impl BoxEnv {
    /// Erases the type of an environment.
    pub fn new<E: Env>(env: E) -> Self {
        Self {
            env: Box::new(Layer(env)),
            moves: 0,
        }
    }

    /// Replaces this environment by another. A vector that holds it keeps its own record of the
    /// episode, such as a pending reset.
    pub fn replace_with(&mut self, other: Self) {
        self.env = other.env;
    }

    /// A count that changes with every reset, step and restore. A vector compares counts to detect
    /// calls that the vector did not make.
    pub(crate) fn moves(&self) -> u64 {
        self.moves
    }
}

impl Clone for BoxEnv {
    fn clone(&self) -> Self {
        Self {
            env: self.env.clone_box(),
            moves: self.moves,
        }
    }
}

/// Prints the stack of wrappers and the environment.
impl fmt::Display for BoxEnv {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.describe())
    }
}

impl fmt::Debug for BoxEnv {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "BoxEnv({self})")
    }
}

/// [`Env`] without its types, so that it can be a trait object.
trait Erased: Send {
    fn clone_box(&self) -> Box<dyn Erased>;
    fn reset_into(&mut self, reset: &Reset, observation: &mut Value) -> Result<()>;
    fn step_into(&mut self, action: &Value, observation: &mut Value) -> Result<Outcome>;
    fn restore(&mut self, snapshot: &Snapshot) -> Result<()>;
    methods!(all forward! declared);
}

/// An environment of its own type behind the trait object.
#[derive(Clone)]
struct Layer<E>(E);

impl<E: Env> Erased for Layer<E> {
    fn clone_box(&self) -> Box<dyn Erased> {
        Box::new(self.clone())
    }

    fn reset_into(&mut self, reset: &Reset, observation: &mut Value) -> Result<()> {
        E::Observation::fill(observation, |observation| {
            self.0.reset_into(reset, observation)
        })
    }

    fn step_into(&mut self, action: &Value, observation: &mut Value) -> Result<Outcome> {
        let env = &mut self.0;
        // an error is returned through `failed`: copying a whole `Result` right after its reward
        // was written stalls the CPU, for 8 % of a step of CartPole
        let mut failed = None;
        let outcome = E::Action::with(action, |action| {
            E::Observation::fill(observation, |observation| {
                match env.step_into(action, observation) {
                    Ok(outcome) => outcome,
                    Err(error) => {
                        failed = Some(error);
                        Outcome::default()
                    }
                }
            })
        });
        match (failed, outcome) {
            (Some(error), _) => Err(error),
            (None, Some(outcome)) => Ok(outcome),
            (None, None) => Err(self.0.action_space().refuse_action(action)),
        }
    }

    fn restore(&mut self, snapshot: &Snapshot) -> Result<()> {
        self.0.restore(snapshot)
    }

    methods!(all forward! {.0} {.0});
}

impl Env for BoxEnv {
    type Observation = Value;
    type Action = Value;

    fn reset_into(&mut self, reset: &Reset, observation: &mut Value) -> Result<()> {
        self.moves += 1;
        self.env.reset_into(reset, observation)
    }

    fn step_into(&mut self, action: &Value, observation: &mut Value) -> Result<Outcome> {
        self.moves += 1;
        self.env.step_into(action, observation)
    }

    fn restore(&mut self, snapshot: &Snapshot) -> Result<()> {
        self.moves += 1;
        self.env.restore(snapshot)
    }

    methods!(all forward! {.env} {.env});
}
