//! Environments that are built from arguments.

use crate::drawing::render::RenderMode;
use crate::env::{Dynamics, Env, Stateful};
use crate::spec::Arguments;
use crate::value::Result;

/// An environment that can be built from arguments; [`register!`](crate::register!) needs it.
/// [`Stateful`] implements it for every [`Dynamics`].
pub trait Configure: Env {
    /// The constructor's arguments, a struct of [`arguments!`](crate::arguments!).
    type Config: Arguments;

    /// The environment with these arguments, for an id of this version. Most environments have one
    /// version and ignore it; an id without a version counts as the newest.
    ///
    /// # Errors
    /// [`Error::InvalidArgument`](crate::Error::InvalidArgument) for an argument out of range.
    fn configure(config: Self::Config, version: u32) -> Result<Self>;

    /// The default arguments for an id of this version, if versions differ.
    fn defaults(version: u32) -> Self::Config {
        let _ = version;
        Self::Config::default()
    }

    /// The environment that `make` puts its wrappers around: by default this one. A type that only
    /// gives an environment its arguments returns that environment, so that the wrappers are
    /// compiled once for all such types.
    fn into_env(self) -> impl Env {
        self
    }

    /// The environment in a render mode, if it implements [`render_into`](Env::render_into): `make`
    /// then adds no [`Render`](crate::wrappers::Render). The default, `None`, is for environments
    /// that implement `draw`.
    ///
    /// # Errors
    /// The errors of [`configure`](Self::configure), and
    /// [`Error::UnsupportedMode`](crate::Error::UnsupportedMode).
    fn configure_to_render(config: Self::Config, mode: RenderMode) -> Result<Option<Self>> {
        let _ = (config, mode);
        Ok(None)
    }

    /// The arguments with every random choice filled in, such as a map that the constructor drew,
    /// so that the spec rebuilds this environment. `None` if nothing is random.
    fn config(&self) -> Option<&Self::Config> {
        None
    }
}

crate::arguments! {
    /// The [`Configure::Config`] or [`Task::Config`](crate::Task::Config) of an environment that
    /// takes no arguments.
    #[derive(Copy, Eq)]
    pub struct NoArguments {}
}

impl<D: Dynamics> Configure for Stateful<D> {
    type Config = D::Config;

    fn configure(config: D::Config, _version: u32) -> Result<Self> {
        Self::new(config)
    }

    fn config(&self) -> Option<&D::Config> {
        Some(self.dynamics().config())
    }
}
