//! From an id and arguments to an environment in its stack of wrappers.

use serde::de::DeserializeOwned;
use serde_json::Value as Json;

use super::{EnvSpec, WrapperSpec, find, resolve};
use crate::render::RenderMode;
use crate::wrappers::RenderCollection;
use crate::{BoxEnv, Error, Kwargs, Result};

/// Makes an environment with its default arguments and wrappers, as Gymnasium's `make`.
///
/// The stack, from the inside: the environment, `PassiveEnvChecker`, `OrderEnforcing`, and
/// `TimeLimit` where its id has one.
///
/// # Errors
/// What is wrong with the id, or [`Error::InvalidArgument`].
pub fn make(id: &str) -> Result<BoxEnv> {
    builder(id).build()
}

/// Makes an environment with arguments, a render mode or another stack of wrappers.
///
/// ```no_run
/// # fn main() -> gym_core::Result<()> {
/// use gym_core::{builder, render::RenderMode};
///
/// let env = builder("FrozenLake-v1").arg("map_name", "8x8").render_mode(RenderMode::RgbArrayList).build()?;
/// # Ok(())
/// # }
/// ```
pub fn builder(id: &str) -> EnvBuilder {
    EnvBuilder { source: Source::Id(id.to_owned()), ..EnvBuilder::default() }
}

/// Options for making an environment; see [`builder`].
#[derive(Clone, Debug, Default)]
pub struct EnvBuilder {
    source: Source,
    kwargs: Kwargs,
    render_mode: Option<RenderMode>,
    render_size: Option<(u32, u32)>,
    time_limit: Option<Option<u32>>,
    disable_env_checker: Option<bool>,
    order_enforce: Option<bool>,
    wrappers: Vec<WrapperSpec>,
}

#[derive(Clone, Debug)]
enum Source {
    Id(String),
    Spec(Box<EnvSpec>),
}

impl Default for Source {
    fn default() -> Self {
        Self::Id(String::new())
    }
}

impl EnvBuilder {
    /// Starts from a spec: its arguments, render mode and wrappers.
    pub fn from_spec(spec: EnvSpec) -> Self {
        Self { source: Source::Spec(Box::new(spec)), ..Self::default() }
    }

    /// Sets a constructor argument.
    #[must_use]
    pub fn arg(mut self, name: &str, value: impl Into<Json>) -> Self {
        self.kwargs.insert(name.to_owned(), value.into());
        self
    }

    /// Sets some constructor arguments. As in Gymnasium, `render_mode`, `max_episode_steps` (-1 for no
    /// limit) and `disable_env_checker` may be among them.
    #[must_use]
    pub fn args(mut self, kwargs: Kwargs) -> Self {
        self.kwargs.extend(kwargs);
        self
    }

    /// How [`render`](crate::Env::render) shows the environment.
    #[must_use]
    pub fn render_mode(mut self, mode: RenderMode) -> Self {
        self.render_mode = Some(mode);
        self
    }

    /// Width and height of rendered frames; drawings are vectors and scale.
    #[must_use]
    pub fn render_size(mut self, width: u32, height: u32) -> Self {
        self.render_size = Some((width, height));
        self
    }

    /// Truncates episodes after that many steps, instead of the number registered; `None` for
    /// never.
    #[must_use]
    pub fn max_episode_steps(mut self, steps: impl Into<Option<u32>>) -> Self {
        self.time_limit = Some(steps.into());
        self
    }

    /// Leaves out the passive checker.
    #[must_use]
    pub fn disable_env_checker(mut self, disable: bool) -> Self {
        self.disable_env_checker = Some(disable);
        self
    }

    /// Leaves out the check for calls before `reset` and after `close`, with `false`.
    #[must_use]
    pub fn order_enforce(mut self, enforce: bool) -> Self {
        self.order_enforce = Some(enforce);
        self
    }

    /// Puts a wrapper around all others.
    #[must_use]
    pub fn wrap(mut self, wrapper: WrapperSpec) -> Self {
        self.wrappers.push(wrapper);
        self
    }

    /// The spec that all options together make. An id without version, or with one that is out of
    /// date, gives a warning through the `log` crate.
    ///
    /// # Errors
    /// What is wrong with the id, or an unknown render mode among the arguments.
    pub fn spec(self) -> Result<EnvSpec> {
        let mut spec = match self.source {
            Source::Spec(spec) => *spec,
            Source::Id(id) => {
                let (registration, note) = resolve(&id)?;
                if let Some(note) = note {
                    log::warn!("{note}");
                }
                registration.spec()?
            }
        };
        spec.kwargs.extend(self.kwargs);
        spec.take_arguments_of_make()?;
        spec.render_mode = self.render_mode.or(spec.render_mode);
        spec.render_size = self.render_size.or(spec.render_size);
        spec.max_episode_steps = self.time_limit.unwrap_or(spec.max_episode_steps);
        spec.disable_env_checker = self.disable_env_checker.unwrap_or(spec.disable_env_checker);
        spec.order_enforce = self.order_enforce.unwrap_or(spec.order_enforce);
        spec.additional_wrappers.extend(self.wrappers);
        Ok(spec)
    }

    /// Makes the environment.
    ///
    /// # Errors
    /// What is wrong with the id, an argument, or the render mode.
    pub fn build(self) -> Result<BoxEnv> {
        let spec = self.spec()?;
        let mut env = find(&spec.id)?.construct(&spec)?;
        for wrapper in &spec.additional_wrappers {
            env = wrapper.wrap(env)?;
        }
        if spec.render_mode.is_some_and(RenderMode::is_list) {
            env = BoxEnv::new(RenderCollection::new(env));
        }
        Ok(env)
    }
}

impl EnvSpec {
    /// Gymnasium passes the arguments of `make` and those of the constructor together; this moves
    /// the former to where they belong.
    fn take_arguments_of_make(&mut self) -> Result<()> {
        self.render_mode = self.take("render_mode")?.or(self.render_mode);
        self.disable_env_checker = self.take("disable_env_checker")?.unwrap_or(self.disable_env_checker);
        self.max_episode_steps = match self.take::<i64>("max_episode_steps")? {
            None => self.max_episode_steps,
            Some(-1) => None,
            // a limit that is not positive is refused by the wrapper
            Some(steps) => Some(steps.clamp(0, u32::MAX.into()) as u32),
        };
        Ok(())
    }

    /// Removes a constructor argument.
    fn take<T: DeserializeOwned>(&mut self, name: &str) -> Result<Option<T>> {
        let parse = |value| {
            serde_json::from_value(value)
                .map_err(|error| Error::argument(format!("`{}`: {name}", self.id), error.to_string()))
        };
        self.kwargs.remove(name).map(parse).transpose()
    }
}
