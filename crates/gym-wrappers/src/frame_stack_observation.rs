//! Stacks of the last observations.

use gym_core::{BoxEnv, Env, Result, Snapshot, Space, Value, registry::WrapperConfig};
use serde_json::Value as Json;

use crate::observing::{Observer, Observing};
use crate::ring::Ring;

/// Observes the last observations stacked along a new first axis, the newest last.
pub type FrameStackObservation<E = BoxEnv> = Observing<E, FrameStack>;

/// The observer of [`FrameStackObservation`].
#[derive(Clone, Debug)]
pub struct FrameStack {
    config: Config,
    inner_space: Space,
    /// The padding before the first observation; `None` for the first observation itself.
    padding: Option<Value>,
    stack: Ring<Value>,
}

gym_core::arguments! {
    /// The arguments of [`FrameStackObservation`].
    pub struct Config {
        /// The number of stacked observations, at least 1.
        pub stack_size: usize,
        /// The padding before the first observation: `"reset"` for the first observation, `"zero"`,
        /// or an element of the space, in the form of [`Space::to_json`].
        pub padding_type: Json = "reset".into(),
    }
}

impl From<usize> for Config {
    fn from(stack_size: usize) -> Self {
        Self {
            stack_size,
            ..Self::default()
        }
    }
}

gym_core::register_wrapper!(
    "FrameStackObservation", "stacks the last observations", Config,
    env: FrameStackObservation::new
);

impl<E: Env> FrameStackObservation<E> {
    /// Stacks the observations of `env`.
    ///
    /// # Errors
    /// [`Error::InvalidArgument`](gym_core::Error) for a size of 0, or a padding that is not an
    /// element of the space; [`Error::InvalidSpace`](gym_core::Error::InvalidSpace) if the space
    /// does not batch.
    pub fn new(env: E, config: impl Into<Config>) -> Result<Self> {
        let (config, inner_space) = (config.into(), env.observation_space());
        if config.stack_size == 0 {
            return Err(Config::refuse("stack_size is 0: it must be at least 1"));
        }
        let (space, zero) = (inner_space.batch(config.stack_size)?, inner_space.zero()?);
        let padding = match &config.padding_type {
            Json::String(name) if name == "reset" => None,
            Json::String(name) if name == "zero" => Some(zero.clone()),
            element => {
                let element = inner_space.from_json(element).and_then(|value| {
                    inner_space.check(&value)?;
                    Ok(value)
                });
                Some(element.map_err(|error| Config::refuse(format!("padding_type: {error}")))?)
            }
        };
        let stack = Ring::new(config.stack_size, &zero).ok_or_else(|| {
            Config::refuse(format!(
                "stack_size = {} observations do not fit in memory",
                config.stack_size
            ))
        })?;
        let observer = FrameStack {
            config,
            inner_space,
            padding,
            stack,
        };
        Ok(Self::with_observer(env, observer, space))
    }
}

impl Observer for FrameStack {
    type Config = Config;

    fn arguments(&self) -> Config {
        self.config.clone()
    }

    /// Adds the last observation to the stack, and observes the stack.
    fn observe<E: Env>(
        &mut self,
        _env: &mut E,
        _space: &Space,
        seen: &mut Value,
        is_reset: bool,
        out: &mut Value,
    ) -> Result<()> {
        if is_reset {
            self.stack.fill(self.padding.as_ref().unwrap_or(seen));
        }
        self.stack.exchange(seen);
        if !self.inner_space.is_batch(out, self.config.stack_size) {
            *out = self.inner_space.empty_batch(self.config.stack_size)?;
        }
        for (i, item) in self.stack.iter().enumerate() {
            self.inner_space.write_row(out, i, item)?;
        }
        Ok(())
    }

    fn snapshot<E: Env>(&self, env: &E) -> Result<Snapshot> {
        Snapshot::of(&(env.snapshot()?, self.stack.to_json(&self.inner_space)?))
    }

    fn restore<E: Env>(&mut self, env: &mut E, snapshot: &Snapshot) -> Result<()> {
        let (inner, stored): (_, Vec<Json>) = snapshot.get()?;
        let stack = self.stack.read(&self.inner_space, &stored)?;
        env.restore(&inner)?;
        self.stack = stack;
        Ok(())
    }
}
