//! Methods for callers of vectors.

use std::any::Any;

use gym_numerics::Seed;

use super::{Columns, VectorEnv, VectorReset, infos};
use crate::env::Env;
use crate::spaces::Sampler;
use crate::value::{Error, Info, Result, Value};

/// The methods for callers. Every [`VectorEnv`] has them, and no implementation can override them.
pub trait VectorEnvExt: VectorEnv {
    /// The entries of all [`info`](crate::vector::VectorEnv::info)s as Gymnasium's dict of columns,
    /// to go with the columns of the same step.
    ///
    /// Each key has a column of `n` values and, as `_key`, a tuple of flags for the values that are
    /// present. Missing values are zero in a column of numbers and `Null` in others. With
    /// [`Autoreset::SameStep`](crate::vector::Autoreset::SameStep), `final_obs` and `final_info`
    /// are about the episodes that ended.
    ///
    /// Made of [`info`](crate::vector::VectorEnv::info),
    /// [`final_info`](crate::vector::VectorEnv::final_info) and
    /// [`column_infos`](crate::vector::VectorEnv::column_infos), which a vector or a wrapper
    /// implements: so the order of wrappers makes no difference.
    fn infos(&self, columns: &Columns) -> Info {
        infos::batch(self, columns)
    }

    /// The entries of the [`info`](crate::vector::VectorEnv::info) of one sub-environment by name:
    /// an element of the list of Gymnasium's wrapper `DictInfoToList`.
    fn info_map(&self, index: usize) -> Info {
        let mut map = Info::new();
        self.info(index, &mut |key, value| {
            map.insert(key.to_owned(), value);
        });
        map
    }

    /// Random actions for all sub-environments, as Gymnasium's `envs.action_space` draws them.
    ///
    /// # Errors
    /// [`Error::InvalidSpace`] as [`Space::batch`](crate::Space::batch).
    fn action_sampler(&self, seed: impl Into<Seed>) -> Result<Sampler> {
        Ok(self.action_space()?.sampler(seed))
    }

    /// Columns for this vector, which `reset_into` fills.
    ///
    /// # Errors
    /// [`Error::InvalidSpace`] if the observation space has no buffers.
    fn columns(&self) -> Result<Columns> {
        Columns::new(&self.single_observation_space(), self.num_envs())
    }

    /// Starts episodes, with new columns: `reset(42)` seeds the sub-environments with 42, 43, ...,
    /// `reset(())` continues their generators.
    ///
    /// # Errors
    /// The errors of [`reset_into`](crate::vector::VectorEnv::reset_into).
    fn reset(&mut self, reset: impl Into<VectorReset>) -> Result<Columns> {
        let mut columns = self.columns()?;
        self.reset_into(&reset.into(), &mut columns)?;
        Ok(columns)
    }

    /// Takes a step, with new columns.
    ///
    /// # Errors
    /// The errors of [`step_into`](crate::vector::VectorEnv::step_into).
    fn step(&mut self, actions: &Value) -> Result<Columns> {
        let mut columns = self.columns()?;
        self.step_into(actions, &mut columns)?;
        Ok(columns)
    }
}

impl<V: VectorEnv + ?Sized> VectorEnvExt for V {}

impl dyn VectorEnv {
    /// Calls a function with each sub-environment and its index; the results are in the order of
    /// the indices. This is Gymnasium's `call`, `get_attr` and `set_attr`:
    ///
    /// ```no_run
    /// use gym_core::registry::VectorKind;
    /// use gym_core::{BoxEnv, Env};
    ///
    /// # fn main() -> gym_core::Result<()> {
    /// let mut envs = gym_core::make_vec("LunarLander-v3", 8, VectorKind::Sync)?;
    /// let specs = envs.call(|_, env: &mut BoxEnv| env.spec())?;
    /// # Ok(())
    /// # }
    /// ```
    ///
    /// # Errors
    /// The errors of [`visit_envs`](VectorEnv::visit_envs), and [`Error::Custom`] if the
    /// sub-environments are not of type `E`; those of the sync and async vectors of
    /// [`make_vec`](crate::make_vec) are [`BoxEnv`](crate::BoxEnv)s.
    pub fn call<E: Env, R>(&mut self, mut f: impl FnMut(usize, &mut E) -> R) -> Result<Vec<R>> {
        let mut results = Vec::with_capacity(self.num_envs());
        let mut fits = true;
        self.visit_envs(&mut |index, env| match env.downcast_mut() {
            Some(env) => results.push(f(index, env)),
            None => fits = false,
        })?;
        if !fits {
            let name = crate::env::short_type_name::<E>();
            return Err(Error::custom(format!(
                "the sub-environments of {} are not of type {name}",
                self.describe()
            )));
        }
        Ok(results)
    }
}

impl dyn VectorEnv {
    /// The wrapper of a type, the outermost if there are several, or the vector inside all wrappers
    /// if it is of that type.
    ///
    /// The type of a wrapper names the inner vector, by default `Box<dyn VectorEnv>`: so for
    /// wrappers made by a [`VectorSpec`](crate::vector::VectorSpec), and for the first wrapper
    /// around [`make_vec`](crate::make_vec):
    ///
    /// ```no_run
    /// use gym_core::vector::{AsyncVectorEnv, VectorEnv};
    ///
    /// fn look(envs: &dyn VectorEnv) {
    ///     let workers = envs.layer::<AsyncVectorEnv>();
    /// }
    /// ```
    pub fn layer<W: VectorEnv>(&self) -> Option<&W> {
        let mut layer = self;
        loop {
            let any: &dyn Any = layer;
            if let Some(found) = any.downcast_ref() {
                return Some(found);
            }
            layer = layer.within()?;
        }
    }

    /// As `layer`, mutable. Outer wrappers do not see resets and steps made through it.
    pub fn layer_mut<W: VectorEnv>(&mut self) -> Option<&mut W> {
        let mut layer = self;
        loop {
            let any: &dyn Any = layer;
            if any.is::<W>() {
                let any: &mut dyn Any = layer;
                return any.downcast_mut();
            }
            layer = layer.within_mut()?;
        }
    }
}
