//! What calls of several threads take turns with: the environment, and whether its episode runs.

use gym::render::Rendered;
use gym::{BoxEnv, Env as _, Error, Outcome, Reset, Value};
use pyo3::prelude::*;
use serde_json::Value as Json;

use crate::error::{OrRaise, guard};
use crate::history::{History, Source};

#[derive(Clone, Debug)]
pub(super) struct Core {
    pub(super) env: BoxEnv,
    pub(super) observation: Value,
    pub(super) frame: Rendered,
    /// Whether an episode has begun, and no call has panicked since.
    pub(super) is_running: bool,
    /// The episode's calls; `None` if other calls have changed its state.
    pub(super) history: Option<History>,
}

impl Core {
    pub(super) fn reset(&mut self, reset: &Reset) -> PyResult<()> {
        self.is_running = false;
        let (last, source) = (self.history.take(), Source::of(&mut self.env, reset));
        guard(|| self.env.reset_into(reset, &mut self.observation).or_raise())?;
        self.history = source.map(|source| History::new(source, &reset.options, last));
        self.is_running = true;
        Ok(())
    }

    pub(super) fn step(&mut self, action: &Value) -> PyResult<Outcome> {
        if !self.is_running {
            return Err(Error::ResetNeeded("step")).or_raise();
        }
        self.is_running = false;
        // a refused action changes nothing; only after a panic the episode cannot continue
        let outcome = guard(|| Ok(self.env.step_into(action, &mut self.observation)))?;
        self.is_running = true;
        let outcome = outcome.or_raise()?;
        let history = self.history.as_mut();
        if history.is_some_and(|history| !history.step(action)) {
            self.history = None;
        }
        Ok(outcome)
    }

    /// The whole state, as JSON.
    pub(super) fn snapshot(&self) -> PyResult<String> {
        guard(|| {
            let snapshot: Json = self
                .env
                .snapshot()
                .and_then(|snapshot| snapshot.get())
                .or_raise()?;
            Ok(snapshot.to_string())
        })
    }
}
