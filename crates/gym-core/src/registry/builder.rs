//! From an id and arguments to an environment in its stack of wrappers.

use serde::de::DeserializeOwned;
use serde_json::Value as Json;

use super::{EnvSpec, Registration, WrapperSpec, find, resolve};
use crate::drawing::render::RenderMode;
use crate::env::BoxEnv;
use crate::spec::Kwargs;
use crate::value::{Error, Result};
use crate::wrappers::RenderCollection;

/// Makes an environment with its default arguments and wrappers, as Gymnasium's `make`.
///
/// The stack, from the inside: the environment, `PassiveEnvChecker`, `OrderEnforcing`, and
/// `TimeLimit` where its id has one.
///
/// # Errors
/// An error about the id, or [`Error::InvalidArgument`].
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
    let found = resolve(id).and_then(|(registration, note)| {
        if let Some(note) = note {
            log::warn!("{note}");
        }
        Ok((registration.spec()?, registration))
    });
    match found {
        Ok((spec, registration)) => EnvBuilder {
            spec: Ok(spec),
            registration: Some(registration),
        },
        Err(error) => EnvBuilder {
            spec: Err(error),
            registration: None,
        },
    }
}

/// An [`EnvSpec`] to change, and then make; see [`builder`]. Errors appear when it is made.
#[derive(Clone, Debug)]
pub struct EnvBuilder {
    spec: Result<EnvSpec>,
    /// The registration of the spec's id; `None` if the spec does not come from the registry.
    registration: Option<Registration>,
}

impl EnvBuilder {
    /// Starts from a spec: its arguments, render mode and wrappers.
    pub fn from_spec(spec: EnvSpec) -> Self {
        Self {
            spec: Ok(spec),
            registration: None,
        }
        .args(Kwargs::new())
    }

    fn change(mut self, change: impl FnOnce(&mut EnvSpec)) -> Self {
        if let Ok(spec) = &mut self.spec {
            change(spec);
        }
        self
    }

    /// Sets a constructor argument. As in Gymnasium, `render_mode`, `max_episode_steps` (-1 for no
    /// limit) and `disable_env_checker` count as arguments.
    #[must_use]
    pub fn arg(self, name: &str, value: impl Into<Json>) -> Self {
        self.args([(name.to_owned(), value.into())].into_iter().collect())
    }

    /// Sets some constructor arguments, as [`arg`](Self::arg) does.
    #[must_use]
    pub fn args(self, kwargs: Kwargs) -> Self {
        let spec = self.spec.and_then(|mut spec| {
            spec.kwargs.extend(kwargs);
            spec.take_arguments_of_make()?;
            Ok(spec)
        });
        Self { spec, ..self }
    }

    /// The mode of [`render`](crate::EnvExt::render).
    #[must_use]
    pub fn render_mode(self, mode: RenderMode) -> Self {
        self.change(|spec| spec.render_mode = Some(mode))
    }

    /// Width and height of rendered frames.
    #[must_use]
    pub fn render_size(self, width: u32, height: u32) -> Self {
        self.change(|spec| spec.render_size = Some((width, height)))
    }

    /// Truncates episodes after this number of steps instead of the registered one; `None` for no
    /// limit.
    #[must_use]
    pub fn max_episode_steps(self, steps: impl Into<Option<u32>>) -> Self {
        self.change(|spec| spec.max_episode_steps = steps.into())
    }

    /// Leaves out the passive checker.
    #[must_use]
    pub fn disable_env_checker(self, disable: bool) -> Self {
        self.change(|spec| spec.disable_env_checker = disable)
    }

    /// `false` leaves out the check for calls before `reset` and after `close`.
    #[must_use]
    pub fn order_enforce(self, enforce: bool) -> Self {
        self.change(|spec| spec.order_enforce = enforce)
    }

    /// Puts a wrapper around all others.
    #[must_use]
    pub fn wrap(self, wrapper: WrapperSpec) -> Self {
        self.change(|spec| spec.additional_wrappers.push(wrapper))
    }

    /// The spec with all options. An id without version, or with an outdated one, logs a warning
    /// through the `log` crate.
    ///
    /// # Errors
    /// An error about the id, or about an unknown render mode.
    pub fn spec(self) -> Result<EnvSpec> {
        self.spec
    }

    /// Makes the environment.
    ///
    /// # Errors
    /// An error about the id, an argument, or the render mode.
    pub fn build(self) -> Result<BoxEnv> {
        let spec = self.spec?;
        let registration = match self.registration {
            Some(registration) => registration,
            None => find(&spec.id)?,
        };
        let mut env = registration.construct(&spec)?;
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
    /// Makes the environment with its wrappers.
    ///
    /// # Errors
    /// The errors of [`make`](crate::make), and one for an unknown wrapper.
    pub fn make(&self) -> Result<BoxEnv> {
        EnvBuilder::from_spec(self.clone()).build()
    }

    /// Gymnasium passes the arguments of `make` and of the constructor together; this function
    /// takes the arguments of `make` out.
    fn take_arguments_of_make(&mut self) -> Result<()> {
        self.render_mode = self.take("render_mode")?.or(self.render_mode);
        self.disable_env_checker = self
            .take("disable_env_checker")?
            .unwrap_or(self.disable_env_checker);
        self.max_episode_steps = match self.take::<i64>("max_episode_steps")? {
            None => self.max_episode_steps,
            Some(-1) => None,
            Some(steps @ ..=0) => {
                let reason = format!(
                    "max_episode_steps is {steps}: it must be at least 1, or -1 for no limit"
                );
                return Err(Error::argument(format!("`{}`", self.id), reason));
            }
            Some(steps) => Some(u32::try_from(steps).unwrap_or(u32::MAX)),
        };
        Ok(())
    }

    /// Removes a constructor argument.
    fn take<T: DeserializeOwned>(&mut self, name: &str) -> Result<Option<T>> {
        let parse = |value| {
            serde_json::from_value(value).map_err(|error| {
                Error::argument(format!("`{}`: {name}", self.id), error.to_string())
            })
        };
        self.kwargs.remove(name).map(parse).transpose()
    }
}
