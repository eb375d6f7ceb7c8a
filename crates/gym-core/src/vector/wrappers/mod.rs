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

use super::{Columns, VectorEnv};
use crate::spaces::array_of;
use crate::{Array, Error, Result, Space, Value};

/// Implements methods of [`VectorEnv`](crate::VectorEnv) by calling the same method of a field.
///
/// ```text
/// gym_core::forward_vector!(envs: num_envs, autoreset, info, final_info, infos, visit_envs, render, close);
/// ```
#[macro_export]
macro_rules! forward_vector {
    ($field:tt: $($method:ident),+ $(,)?) => { $($crate::forward_vector!(@ $field $method);)+ };
    (@ $field:tt num_envs) => {
        fn num_envs(&self) -> usize { self.$field.num_envs() }
    };
    (@ $field:tt single_observation_space) => {
        fn single_observation_space(&self) -> $crate::Space { self.$field.single_observation_space() }
    };
    (@ $field:tt single_action_space) => {
        fn single_action_space(&self) -> $crate::Space { self.$field.single_action_space() }
    };
    (@ $field:tt observation_space) => {
        fn observation_space(&self) -> $crate::Result<$crate::Space> { self.$field.observation_space() }
    };
    (@ $field:tt autoreset) => {
        fn autoreset(&self) -> $crate::vector::Autoreset { self.$field.autoreset() }
    };
    (@ $field:tt reset_into) => {
        fn reset_into(
            &mut self,
            reset: &$crate::vector::VectorReset,
            columns: &mut $crate::vector::Columns,
        ) -> $crate::Result<()> {
            self.$field.reset_into(reset, columns)
        }
    };
    (@ $field:tt step_into) => {
        fn step_into(
            &mut self,
            actions: &$crate::Value,
            columns: &mut $crate::vector::Columns,
        ) -> $crate::Result<()> {
            self.$field.step_into(actions, columns)
        }
    };
    (@ $field:tt info) => {
        fn info(&self, index: usize, visit: &mut dyn FnMut(&str, $crate::Value)) {
            self.$field.info(index, visit);
        }
    };
    (@ $field:tt final_info) => {
        fn final_info(&self, index: usize, visit: &mut dyn FnMut(&str, $crate::Value)) {
            self.$field.final_info(index, visit);
        }
    };
    (@ $field:tt infos) => {
        fn infos(&self, columns: &$crate::vector::Columns) -> $crate::Info { self.$field.infos(columns) }
    };
    (@ $field:tt visit_envs) => {
        fn visit_envs(
            &mut self,
            visit: &mut dyn FnMut(usize, &mut dyn ::std::any::Any),
        ) -> $crate::Result<()> {
            self.$field.visit_envs(visit)
        }
    };
    (@ $field:tt render) => {
        fn render(&mut self) -> $crate::Result<::std::vec::Vec<$crate::render::Rendered>> {
            self.$field.render()
        }
    };
    (@ $field:tt metadata) => {
        fn metadata(&self) -> $crate::render::Metadata { self.$field.metadata() }
    };
    (@ $field:tt spec) => {
        fn spec(&self) -> Option<$crate::vector::VectorSpec> { self.$field.spec() }
    };
    (@ $field:tt describe) => {
        fn describe(&self) -> String { $crate::vector::wrappers::describe(self, &self.$field) }
    };
    (@ $field:tt close) => {
        fn close(&mut self) { self.$field.close(); }
    };
}

/// `<Wrapper, inner>`, as Gymnasium prints a stack of vector wrappers.
#[doc(hidden)]
pub fn describe<W, V: VectorEnv>(_wrapper: &W, inner: &V) -> String {
    format!("<{}, {}>", crate::env::short_type_name::<W>(), inner.describe())
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
    /// Lets the vector within fill the columns, with its observations going here.
    fn fill(&mut self, columns: &mut Columns, fill: impl FnOnce(&mut Columns) -> Result<()>) -> Result<()> {
        self.swap(columns);
        let result = fill(columns);
        self.swap(columns);
        result
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

/// `VectorEnv` for a wrapper that changes observations by a function without state. The wrapper has the
/// fields `envs` and `inner`, and a method `observe(&self, columns: &mut Columns) -> Result<()>` that maps
/// from `inner`.
macro_rules! observation_methods {
    () => {
        fn reset_into(&mut self, reset: &$crate::vector::VectorReset, columns: &mut Columns) -> Result<()> {
            let Self { envs, inner, .. } = self;
            inner.fill(columns, |columns| envs.reset_into(reset, columns))?;
            self.observe(columns)
        }

        fn step_into(&mut self, actions: &Value, columns: &mut Columns) -> Result<()> {
            let Self { envs, inner, .. } = self;
            inner.fill(columns, |columns| envs.step_into(actions, columns))?;
            self.observe(columns)
        }
    };
}
use observation_methods;
