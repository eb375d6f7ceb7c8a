//! The methods for callers of an environment.

use std::any::TypeId;

use gym_numerics::Seed;

use crate::drawing::render::Rendered;
use crate::env::{Env, Goals, Outcome, Step};
use crate::spaces::Sampler;
use crate::spec::Reset;
use crate::value::{Element, Info, Result};

/// The methods for callers. Every [`Env`] has them, and no implementation can override them.
pub trait EnvExt: Env {
    /// Starts an episode: `reset(42)` with a seed, `reset(())` without,
    /// `reset(Reset::seed(42).option("low", -0.1))` with options.
    ///
    /// # Errors
    /// The errors of [`reset_into`](Env::reset_into).
    fn reset(&mut self, reset: impl Into<Reset>) -> Result<Self::Observation> {
        let mut observation = Self::Observation::empty();
        self.reset_into(&reset.into(), &mut observation)?;
        Ok(observation)
    }

    /// Takes one step.
    ///
    /// # Errors
    /// The errors of [`step_into`](Env::step_into).
    fn step(&mut self, action: &Self::Action) -> Result<Step<Self::Observation>> {
        let mut observation = Self::Observation::empty();
        let Outcome {
            reward,
            terminated,
            truncated,
        } = self.step_into(action, &mut observation)?;
        Ok(Step {
            observation,
            reward,
            terminated,
            truncated,
        })
    }

    /// The frame or text of the render mode.
    ///
    /// # Errors
    /// The errors of [`render_into`](crate::Env::render_into).
    fn render(&mut self) -> Result<Rendered> {
        let mut rendered = Rendered::Shown;
        self.render_into(&mut rendered)?;
        Ok(rendered)
    }

    /// Random actions from the action space, of this environment's own action type.
    ///
    /// # Errors
    /// [`Error::InvalidArgument`](crate::Error) if that type cannot hold the space's elements,
    /// which is a mistake in the environment.
    fn action_sampler(&self, seed: impl Into<Seed>) -> Result<Sampler<Self::Action>> {
        self.action_space().sampler(seed).typed()
    }

    /// The entries of [`info`](Env::info) by name.
    fn info_map(&self) -> Info {
        let mut map = Info::new();
        self.info(&mut |key, value| {
            map.insert(key.to_owned(), value);
        });
        map
    }

    /// The environment inside all wrappers, if it is a `T`, or the outermost wrapper of type `T`,
    /// through any number of [`BoxEnv`](crate::BoxEnv)s: for methods beyond the interface.
    ///
    /// Name the full type: around an environment from [`make`](crate::make) a wrapper is
    /// `TimeLimit<BoxEnv>`, or `TimeLimit` for short.
    ///
    /// ```no_run
    /// use gym_core::wrappers::TimeLimit;
    /// use gym_core::{BoxEnv, Env, EnvExt, Result, make};
    ///
    /// fn main() -> Result<()> {
    ///     let env = BoxEnv::new(TimeLimit::new(make("CartPole-v1")?, 100)?);
    ///     assert_eq!(env.layer::<TimeLimit>().map(|limit| limit.max_episode_steps()), Some(100));
    ///     Ok(())
    /// }
    /// ```
    fn layer<T: 'static>(&self) -> Option<&T> {
        self.any_layer(TypeId::of::<T>())?.downcast_ref()
    }

    /// The rewards of goals, within any wrappers; `None` for a task without goals.
    fn goals(&self) -> Option<&dyn Goals> {
        self.inspect()?.goals()
    }

    /// As [`layer`](Self::layer), mutable.
    fn layer_mut<T: 'static>(&mut self) -> Option<&mut T> {
        self.any_layer_mut(TypeId::of::<T>())?.downcast_mut()
    }
}

impl<E: Env> EnvExt for E {}
