use std::fmt;

use gym_core::registry::WrapperConfig;
use gym_core::vector::{Columns, Progress};
use gym_core::{
    Env, Outcome, Reset, Result, Value, VectorEnv, VectorWrapper, Wrapper, WrapperSpec,
};

/// A change of rewards, without state.
pub trait RewardMap: Clone + fmt::Debug + Send + 'static {
    /// The arguments.
    type Config: WrapperConfig + Clone + fmt::Debug + Send + 'static;

    /// Makes the map from its arguments.
    ///
    /// # Errors
    /// [`Error::InvalidArgument`](gym_core::Error::InvalidArgument) for invalid arguments.
    fn new(config: &Self::Config) -> Result<Self>;

    /// Maps a reward.
    fn map(&self, reward: f64) -> f64;
}

/// Maps the rewards of an environment, or of each sub-environment of a vector.
#[derive(Clone, Debug)]
pub struct MapReward<T, M: RewardMap> {
    inner: T,
    config: M::Config,
    map: M,
}

gym_core::inner!(impl MapReward<T, M: RewardMap>);

impl<T, M: RewardMap> MapReward<T, M> {
    /// Maps the rewards of `inner`.
    ///
    /// # Errors
    /// The errors of [`RewardMap::new`].
    pub fn new(inner: T, config: impl Into<M::Config>) -> Result<Self> {
        let config = config.into();
        Ok(Self {
            inner,
            map: M::new(&config)?,
            config,
        })
    }

    /// The arguments.
    pub fn config(&self) -> &M::Config {
        &self.config
    }
}

impl<E: Env, M: RewardMap> Wrapper for MapReward<E, M> {
    type Observation = E::Observation;
    type Action = E::Action;

    gym_core::inner!(E);

    fn on_reset(&mut self, reset: &Reset, observation: &mut E::Observation) -> Result<()> {
        self.inner.reset_into(reset, observation)
    }

    fn on_step(&mut self, action: &E::Action, observation: &mut E::Observation) -> Result<Outcome> {
        let outcome = self.inner.step_into(action, observation)?;
        Ok(Outcome {
            reward: self.map.map(outcome.reward),
            ..outcome
        })
    }

    fn name(&self) -> &'static str {
        <M::Config>::NAME
    }

    fn wrapper_spec(&self) -> Option<WrapperSpec> {
        Some(self.config.spec())
    }
}

impl<V: VectorEnv, M: RewardMap> VectorWrapper for MapReward<V, M> {
    gym_core::inner!(dyn);

    fn on_step(&mut self, actions: &Value, columns: &mut Columns) -> Result<()> {
        step_rewards(&mut self.inner, actions, columns, |reward| {
            self.map.map(reward)
        })
    }

    fn name(&self) -> &'static str {
        <M::Config>::NAME
    }

    fn wrapper_spec(&self) -> Option<WrapperSpec> {
        Some(self.config.spec())
    }
}

/// Steps the inner vector and maps the rewards of all sub-environments that stepped.
pub(crate) fn step_rewards(
    envs: &mut impl VectorEnv,
    actions: &Value,
    columns: &mut Columns,
    map: impl Fn(f64) -> f64,
) -> Result<()> {
    columns.begin();
    let result = envs.step_into(actions, columns);
    for (reward, progress) in columns.rewards.iter_mut().zip(&columns.progress) {
        if *progress != Progress::Unchanged {
            *reward = map(*reward);
        }
    }
    result
}
