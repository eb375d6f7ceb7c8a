//! Wrappers around vectors, for what needs all sub-environments at once or is cheaper so.
//!
//! Each takes any [`VectorEnv`], also a `Box<dyn VectorEnv>`, and is a `VectorEnv` again. Wrappers of
//! single environments go around each sub-environment instead:
//! `builder(id).wrap(WrapperSpec::new("TimeAwareObservation")).vector(n)`.

mod clip_action;
mod clip_reward;
mod normalize_observation;
mod normalize_reward;
mod record_episode_statistics;
mod rescale_action;
mod rescale_observation;
mod transform_action;
mod transform_observation;
mod transform_reward;
mod wrap;

pub use clip_action::ClipAction;
pub use clip_reward::ClipReward;
pub use normalize_observation::NormalizeObservation;
pub use normalize_reward::NormalizeReward;
pub use record_episode_statistics::RecordEpisodeStatistics;
pub use rescale_action::RescaleAction;
pub use rescale_observation::RescaleObservation;
pub use transform_action::TransformAction;
pub use transform_observation::TransformObservation;
pub use transform_reward::TransformReward;
pub use wrap::VectorWrap;

use super::{Columns, Progress, VectorEnv};
use crate::spaces::array_of;
use crate::{Array, Error, Result, Space, Value};

/// The methods that lead to the vector within, of a wrapper with the field `envs`.
macro_rules! reach {
    ($name:ident $(, $parameter:ident)*) => {
        impl<V $(, $parameter)*> $name<V $(, $parameter)*> {
            /// The vector within.
            pub fn get_ref(&self) -> &V {
                &self.envs
            }

            /// The vector within, to be changed. What is reset or stepped past the wrapper, it does not
            /// see.
            pub fn get_mut(&mut self) -> &mut V {
                &mut self.envs
            }

            /// The vector within, without the wrapper.
            pub fn into_inner(self) -> V {
                self.envs
            }
        }
    };
}
use reach;

/// Steps the vector within and maps the rewards of all sub-environments that went on.
fn each_reward(
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

/// Leaves a batch of actions in `inner`, cast to the type of the space, if it has the form of one.
fn cast_actions<'a>(space: &Space, n: usize, actions: &Value, inner: &'a mut Value) -> Result<&'a mut Array> {
    space.check_batch(actions, n)?;
    let (Some(array), Some(dtype)) = (actions.as_array(), space.dtype()) else {
        return Err(Error::Contract(format!("{space} does not batch into an array")));
    };
    let inner = array_of(inner, dtype, array.shape());
    inner.assign_cast(array)?;
    Ok(inner)
}

/// The observations of the vector within, for a wrapper that gives others.
#[derive(Clone, Debug, Default)]
struct Inner {
    observations: Value,
    final_observations: Value,
}

impl Inner {
    /// Lets the vector within fill the columns, with its observations going here; then, if any
    /// sub-environment went on, the wrapper fills them.
    fn fill(
        &mut self,
        columns: &mut Columns,
        fill: impl FnOnce(&mut Columns) -> Result<()>,
    ) -> (Result<()>, bool) {
        columns.begin();
        self.swap(columns);
        let result = fill(columns);
        self.swap(columns);
        let goes_on = columns.any_progress();
        (result, goes_on)
    }

    fn swap(&mut self, columns: &mut Columns) {
        std::mem::swap(&mut self.observations, &mut columns.observations);
        std::mem::swap(&mut self.final_observations, &mut columns.final_observations);
    }

    /// Maps each column that counts.
    fn map(&self, columns: &mut Columns, map: impl Fn(&Value, &mut Value) -> Result<()>) -> Result<()> {
        map(&self.observations, &mut columns.observations)?;
        if columns.has_final.contains(&true) {
            map(&self.final_observations, &mut columns.final_observations)?;
        }
        Ok(())
    }
}

/// The methods of [`VectorWrapper`](crate::VectorWrapper) for a wrapper that changes observations by a function without state. The wrapper has the
/// fields `envs` and `inner`, and a method `observe(&self, columns: &mut Columns) -> Result<()>` that maps
/// from `inner`.
macro_rules! observation_methods {
    () => {
        fn reset_into(&mut self, reset: &$crate::vector::VectorReset, columns: &mut Columns) -> Result<()> {
            let Self { envs, inner, .. } = self;
            let (result, goes_on) = inner.fill(columns, |columns| envs.reset_into(reset, columns));
            if goes_on { result.and(self.observe(columns)) } else { result }
        }

        fn step_into(&mut self, actions: &Value, columns: &mut Columns) -> Result<()> {
            let Self { envs, inner, .. } = self;
            let (result, goes_on) = inner.fill(columns, |columns| envs.step_into(actions, columns));
            if goes_on { result.and(self.observe(columns)) } else { result }
        }
    };
}
use observation_methods;
