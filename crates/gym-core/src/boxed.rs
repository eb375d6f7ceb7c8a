//! Any environment behind one type: what [`make`](crate::make) returns.

use std::any::{Any, TypeId};
use std::fmt;

use crate::canvas::Canvas;
use crate::render::{Metadata, RenderMode, Rendered};
use crate::wrapper::forward;
use crate::{Element, Env, EnvSpec, Generator, Outcome, Reset, Result, Snapshot, Space, Value};

/// An environment whose type is erased, with [`Value`]s for observations and actions.
///
/// It implements [`Env`] itself, so wrappers and generic code take it like any typed environment.
/// It accepts an action only if it has the kind, type and shape of the action space; a number
/// beyond the bounds of a `Box` reaches the environment, which clips it or not as Gymnasium's
/// does.
pub struct BoxEnv(Box<dyn Erased>);

impl BoxEnv {
    /// Erases the type of an environment.
    pub fn new<E: Env>(env: E) -> Self {
        Self(Box::new(Layer(env)))
    }
}

impl Clone for BoxEnv {
    fn clone(&self) -> Self {
        self.0.clone_box()
    }
}

/// The stack of wrappers and the environment.
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

/// [`Env`] without its types and generic methods, so that it can be a trait object.
trait Erased: Send {
    fn clone_box(&self) -> BoxEnv;
    fn observation_space(&self) -> Space;
    fn action_space(&self) -> Space;
    fn reset_into(&mut self, reset: &Reset, observation: &mut Value) -> Result<()>;
    fn step_into(&mut self, action: &Value, observation: &mut Value) -> Result<Outcome>;
    fn snapshot(&self) -> Result<Snapshot>;
    fn restore(&mut self, snapshot: &Snapshot) -> Result<()>;
    fn info(&self, visit: &mut dyn FnMut(&str, Value));
    fn metadata(&self) -> Metadata;
    fn draw(&self, canvas: &mut dyn Canvas);
    fn ansi(&self) -> Option<String>;
    fn render_mode(&self) -> Option<RenderMode>;
    fn render_into(&mut self, rendered: &mut Rendered) -> Result<()>;
    fn spec(&self) -> Option<EnvSpec>;
    fn describe(&self) -> String;
    fn layer(&self, layer: TypeId) -> Option<&dyn Any>;
    fn layer_mut(&mut self, layer: TypeId) -> Option<&mut dyn Any>;
    fn generator(&mut self) -> Option<&mut Generator>;
    fn close(&mut self);
}

/// An environment of its own type behind the trait object.
#[derive(Clone)]
struct Layer<E>(E);

impl<E: Env> Erased for Layer<E> {
    fn clone_box(&self) -> BoxEnv {
        BoxEnv(Box::new(self.clone()))
    }

    fn reset_into(&mut self, reset: &Reset, observation: &mut Value) -> Result<()> {
        E::Observation::fill(observation, |observation| self.0.reset_into(reset, observation))
    }

    fn step_into(&mut self, action: &Value, observation: &mut Value) -> Result<Outcome> {
        let env = &mut self.0;
        let outcome = E::Action::with(action, |action| {
            E::Observation::fill(observation, |observation| env.step_into(action, observation))
        });
        outcome.unwrap_or_else(|| Err(self.0.action_space().refuse_action(action)))
    }

    forward!(0);
}

impl Env for BoxEnv {
    type Observation = Value;
    type Action = Value;

    fn reset_into(&mut self, reset: &Reset, observation: &mut Value) -> Result<()> {
        self.0.reset_into(reset, observation)
    }

    fn step_into(&mut self, action: &Value, observation: &mut Value) -> Result<Outcome> {
        self.0.step_into(action, observation)
    }

    forward!(0);
}
