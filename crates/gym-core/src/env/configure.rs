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

/// What a registration builds its environments by. An environment that is [`Configure`] builds
/// itself. Another type serves where many tasks, with arguments of their own, share one type of
/// environment: the wrappers of `make` are then compiled once for all of them.
pub trait Build: 'static {
    /// The arguments.
    type Config: Arguments;

    /// The environment.
    type Env: Env;

    /// [`Configure::configure`].
    ///
    /// # Errors
    /// [`Error::InvalidArgument`](crate::Error::InvalidArgument) for an argument out of range.
    fn build(config: Self::Config, version: u32) -> Result<Self::Env>;

    /// [`Configure::defaults`].
    fn defaults(version: u32) -> Self::Config {
        let _ = version;
        Self::Config::default()
    }

    /// [`Configure::configure_to_render`].
    ///
    /// # Errors
    /// Those of [`Configure::configure_to_render`].
    fn build_to_render(config: Self::Config, mode: RenderMode) -> Result<Option<Self::Env>> {
        let _ = (config, mode);
        Ok(None)
    }

    /// [`Configure::config`].
    fn config(env: &Self::Env) -> Option<&Self::Config> {
        let _ = env;
        None
    }
}

impl<E: Configure> Build for E {
    type Config = E::Config;
    type Env = E;

    fn build(config: E::Config, version: u32) -> Result<E> {
        E::configure(config, version)
    }

    fn defaults(version: u32) -> E::Config {
        <E as Configure>::defaults(version)
    }

    fn build_to_render(config: E::Config, mode: RenderMode) -> Result<Option<E>> {
        E::configure_to_render(config, mode)
    }

    fn config(env: &E) -> Option<&E::Config> {
        <E as Configure>::config(env)
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
