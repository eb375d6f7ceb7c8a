//! What lies beyond Gymnasium's interface: an environment's state, arguments and table, by name.

use serde_json::Value as Json;

use crate::env::Goals;
use crate::value::{Error, Result};

/// An environment that shows more than observations, and that can be changed while it runs:
/// Gymnasium's attributes of `env.unwrapped`.
///
/// Everything is JSON, so that commands, traces and Python need not know the environment's type.
/// [`Env::inspect`](crate::Env::inspect) finds it within any wrappers:
///
/// ```no_run
/// use gym_core::{Env, EnvExt, make};
///
/// # fn main() -> gym_core::Result<()> {
/// let mut env = make("CartPole-v1")?;
/// env.reset(0)?;
/// if let Some(cart_pole) = env.inspect_mut() {
///     cart_pole.set_argument("gravity", 1.62.into())?; // on the Moon from now on
/// }
/// # Ok(())
/// # }
/// ```
pub trait Inspect {
    /// The state behind the observations; `None` before the first reset, and for an environment
    /// that shows none.
    fn state(&self) -> Option<Json> {
        None
    }

    /// Continues the episode from another state, of the form of [`state`](Self::state). The
    /// generator stays.
    ///
    /// # Errors
    /// [`Error::ResetNeeded`] before the first reset; [`Error::InvalidArgument`] for a state that
    /// does not fit, and if the state cannot be set (the default). Then nothing has changed.
    fn set_state(&mut self, state: Json) -> Result<()> {
        let _ = state;
        Err(fixed("state", "its state cannot be set"))
    }

    /// The constructor's arguments as they are now, by name.
    fn arguments(&self) -> Json;

    /// Sets one argument, as an assignment to Gymnasium's attribute does. The documentation of each
    /// environment says whether the current episode or the next reset uses it.
    ///
    /// # Errors
    /// [`Error::InvalidArgument`] for an unknown name, a value out of range, or an argument that is
    /// fixed (the default: all are). Then nothing has changed.
    fn set_argument(&mut self, name: &str, value: Json) -> Result<()> {
        let _ = value;
        Err(fixed(
            name,
            "the arguments of this environment are fixed: make a new one",
        ))
    }

    /// The dynamics as a table, if the task is one: `P`, for each state and action a list of
    /// outcomes `[probability, next state, reward, terminated]`, and `initial_state_distrib`, the
    /// probability of each state at the start.
    fn table(&self) -> Option<Json> {
        None
    }

    /// Replaces the table, of the form of [`table`](Self::table); the next step is drawn from it.
    ///
    /// # Errors
    /// [`Error::InvalidArgument`] for a table that does not fit, and if the task has none (the
    /// default). Then nothing has changed.
    fn set_table(&mut self, table: Json) -> Result<()> {
        let _ = table;
        Err(fixed("table", "its dynamics are not a table"))
    }

    /// The rewards of goals, if the task has goals.
    fn goals(&self) -> Option<&dyn Goals> {
        None
    }
}

fn fixed(name: &str, reason: &str) -> Error {
    Error::argument(name, reason)
}
