//! A wrapper that limits the length of episodes.

use std::any::{Any, TypeId};

use crate::env::{BoxEnv, Env, Outcome};
use crate::spec::{EnvSpec, Reset, WrapperConfig};
use crate::value::{Error, Result, Snapshot};

/// Sets `truncated` once an episode has lasted a number of steps. `terminated` is unchanged: one
/// step can set both. A snapshot taken with another limit is refused.
#[derive(Clone, Debug)]
pub struct TimeLimit<E = BoxEnv> {
    inner: E,
    count: StepCount,
}

/// The limit and the count of a [`TimeLimit`]. It is a layer of its own: `env.layer::<StepCount>()`
/// finds it whatever the `TimeLimit` wraps. Of several limits it is the one that is reached first.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub struct StepCount {
    /// The number of steps after which an episode is truncated.
    pub max_episode_steps: u32,
    /// The steps taken since the last reset.
    pub elapsed_steps: u32,
}

crate::arguments! {
    /// The arguments of [`TimeLimit`].
    pub struct Config {
        /// The number of steps after which an episode is truncated, at least 1.
        pub max_episode_steps: u32,
    }
}

crate::register_wrapper!(
    "TimeLimit", "truncates episodes after a number of steps", Config,
    env: |env, config: Config| TimeLimit::new(env, config.max_episode_steps)
);

crate::inner!(impl TimeLimit<E>);

impl<E: Env> TimeLimit<E> {
    /// Limits the episodes of `env`.
    ///
    /// # Errors
    /// [`Error::InvalidArgument`] for a limit of 0.
    pub fn new(env: E, max_episode_steps: u32) -> Result<Self> {
        if max_episode_steps == 0 {
            return Err(Error::argument(
                "TimeLimit",
                "max_episode_steps is 0: it must be at least 1",
            ));
        }
        Ok(Self {
            inner: env,
            count: StepCount {
                max_episode_steps,
                elapsed_steps: 0,
            },
        })
    }

    /// The limit.
    pub fn max_episode_steps(&self) -> u32 {
        self.count.max_episode_steps
    }

    /// The steps taken since the last reset.
    pub fn elapsed_steps(&self) -> u32 {
        self.count.elapsed_steps
    }
}

impl<E: Env> crate::env::Wrapper for TimeLimit<E> {
    type Observation = E::Observation;
    type Action = E::Action;

    crate::inner!(E);

    fn on_reset(&mut self, reset: &Reset, observation: &mut E::Observation) -> Result<()> {
        self.inner.reset_into(reset, observation)?;
        self.count.elapsed_steps = 0;
        Ok(())
    }

    #[inline]
    fn on_step(&mut self, action: &E::Action, observation: &mut E::Observation) -> Result<Outcome> {
        let mut outcome = self.inner.step_into(action, observation)?;
        let StepCount {
            max_episode_steps,
            elapsed_steps,
        } = &mut self.count;
        *elapsed_steps = elapsed_steps.saturating_add(1);
        outcome.truncated |= *elapsed_steps >= *max_episode_steps;
        Ok(outcome)
    }

    fn on_snapshot(&self) -> Result<Snapshot> {
        let StepCount {
            max_episode_steps,
            elapsed_steps,
        } = self.count;
        Snapshot::of(&(self.inner.snapshot()?, elapsed_steps, max_episode_steps))
    }

    fn on_restore(&mut self, snapshot: &Snapshot) -> Result<()> {
        let (env, elapsed_steps, limit): (_, _, u32) = snapshot.get()?;
        if limit != self.count.max_episode_steps {
            return Err(Error::Snapshot(format!(
                "it was taken with a limit of {limit} steps, not of {}",
                self.count.max_episode_steps
            )));
        }
        self.inner.restore(&env)?;
        self.count.elapsed_steps = elapsed_steps;
        Ok(())
    }

    fn on_any_layer(&self, layer: TypeId) -> Option<&dyn Any> {
        if layer == TypeId::of::<StepCount>() {
            let inner = self.inner.any_layer(layer);
            let left =
                |count: &StepCount| count.max_episode_steps.saturating_sub(count.elapsed_steps);
            let is_nearer = |inner: &&dyn Any| {
                let inner = inner.downcast_ref::<StepCount>();
                inner.is_some_and(|inner| left(inner) < left(&self.count))
            };
            inner.filter(is_nearer).or(Some(&self.count))
        } else if layer == TypeId::of::<Self>() {
            Some(self)
        } else {
            self.inner.any_layer(layer)
        }
    }

    fn on_spec(&self) -> Option<EnvSpec> {
        let limit = self.count.max_episode_steps;
        self.inner.spec().map(|spec| {
            // directly around the environment, this limit counts as the limit of `make`, and a
            // shorter one replaces that limit
            let replaces = spec.max_episode_steps.is_none_or(|inner| limit <= inner);
            if replaces && spec.additional_wrappers.is_empty() {
                EnvSpec {
                    max_episode_steps: Some(limit),
                    ..spec
                }
            } else {
                spec.wrapped(
                    Config {
                        max_episode_steps: limit,
                    }
                    .spec(),
                )
            }
        })
    }
}
