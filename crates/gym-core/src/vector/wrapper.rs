//! What every wrapper of vectors is made with.

use std::any::Any;

use super::{Autoreset, Columns, VectorEnv, VectorReset, VectorSpec};
use crate::render::{Metadata, Rendered};
use crate::{Result, Snapshot, Space, Value, WrapperSpec};

/// A vector around a vector: every `VectorWrapper` is a [`VectorEnv`].
///
/// Only [`inner`](Self::inner) and [`inner_mut`](Self::inner_mut) are needed. What a wrapper leaves out is
/// that of the vector within, but for [`wrapper_spec`](Self::wrapper_spec): a wrapper that does not say how
/// it is made again has no spec, rather than one that forgets it.
///
/// ```
/// use gym_core::vector::{Columns, Progress, VectorEnv};
/// use gym_core::{Result, Value};
///
/// /// Takes a little from the reward of each step.
/// struct Effort<V> {
///     envs: V,
/// }
///
/// // the full name: both traits have the same methods, and with one of them in scope a call is clear
/// impl<V: VectorEnv> gym_core::vector::VectorWrapper for Effort<V> {
///     fn inner(&self) -> &dyn VectorEnv {
///         &self.envs
///     }
///
///     fn inner_mut(&mut self) -> &mut dyn VectorEnv {
///         &mut self.envs
///     }
///
///     fn step_into(&mut self, actions: &Value, columns: &mut Columns) -> Result<()> {
///         columns.begin();
///         let result = self.envs.step_into(actions, columns);
///         // after an `Err` some sub-environments may have taken their step nevertheless
///         for (reward, progress) in columns.rewards.iter_mut().zip(&columns.progress) {
///             if *progress == Progress::Stepped {
///                 *reward -= 0.01;
///             }
///         }
///         result
///     }
/// }
/// ```
///
/// A wrapper with state of its own overrides [`snapshot`](Self::snapshot) and [`restore`](Self::restore).
/// One that adds entries to the infos overrides [`info`](Self::info), from which
/// [`VectorEnv::infos`] makes the columns.
pub trait VectorWrapper: Any + Send {
    /// The vector within.
    fn inner(&self) -> &dyn VectorEnv;

    /// The vector within, to be changed.
    fn inner_mut(&mut self) -> &mut dyn VectorEnv;

    /// The name and the arguments that [`VectorSpec::make`] makes this wrapper with again, if it can.
    fn wrapper_spec(&self) -> Option<WrapperSpec> {
        None
    }

    /// See [`VectorEnv::num_envs`].
    fn num_envs(&self) -> usize {
        self.inner().num_envs()
    }

    /// See [`VectorEnv::single_observation_space`].
    fn single_observation_space(&self) -> Space {
        self.inner().single_observation_space()
    }

    /// See [`VectorEnv::single_action_space`].
    fn single_action_space(&self) -> Space {
        self.inner().single_action_space()
    }

    /// See [`VectorEnv::observation_space`]. For a wrapper that changes the space of a single observation,
    /// the batch of that.
    fn observation_space(&self) -> Result<Space> {
        let single = self.single_observation_space();
        if single == self.inner().single_observation_space() {
            self.inner().observation_space()
        } else {
            single.batch(self.num_envs())
        }
    }

    /// See [`VectorEnv::action_space`]. For a wrapper that changes the space of a single action, the batch
    /// of that.
    fn action_space(&self) -> Result<Space> {
        let single = self.single_action_space();
        if single == self.inner().single_action_space() {
            self.inner().action_space()
        } else {
            single.batch(self.num_envs())
        }
    }

    /// See [`VectorEnv::autoreset`].
    fn autoreset(&self) -> Autoreset {
        self.inner().autoreset()
    }

    /// See [`VectorEnv::reset_into`].
    ///
    /// # Errors
    /// As there.
    fn reset_into(&mut self, reset: &VectorReset, columns: &mut Columns) -> Result<()> {
        self.inner_mut().reset_into(reset, columns)
    }

    /// See [`VectorEnv::step_into`].
    ///
    /// # Errors
    /// As there.
    fn step_into(&mut self, actions: &Value, columns: &mut Columns) -> Result<()> {
        self.inner_mut().step_into(actions, columns)
    }

    /// See [`VectorEnv::info`].
    fn info(&self, index: usize, visit: &mut dyn FnMut(&str, Value)) {
        self.inner().info(index, visit);
    }

    /// See [`VectorEnv::final_info`].
    fn final_info(&self, index: usize, visit: &mut dyn FnMut(&str, Value)) {
        self.inner().final_info(index, visit);
    }

    /// See [`VectorEnv::column_infos`].
    fn column_infos(&self, visit: &mut dyn FnMut(&str, Value)) {
        self.inner().column_infos(visit);
    }

    /// See [`VectorEnv::visit_envs`].
    ///
    /// # Errors
    /// As there.
    fn visit_envs(&mut self, visit: &mut dyn FnMut(usize, &mut dyn Any)) -> Result<()> {
        self.inner_mut().visit_envs(visit)
    }

    /// See [`VectorEnv::render`].
    ///
    /// # Errors
    /// As there.
    fn render(&mut self) -> Result<Vec<Rendered>> {
        self.inner_mut().render()
    }

    /// See [`VectorEnv::metadata`].
    fn metadata(&self) -> Metadata {
        self.inner().metadata()
    }

    /// See [`VectorEnv::spec`]: that of the vector within and [`wrapper_spec`](Self::wrapper_spec), if there
    /// are both.
    fn spec(&self) -> Option<VectorSpec> {
        let wrapper = self.wrapper_spec()?;
        self.inner().spec().map(|spec| spec.wrapped(wrapper))
    }

    /// The wrapper's own name: that of its type, if it does not say otherwise.
    fn name(&self) -> &'static str {
        crate::env::short_type_name::<Self>()
    }

    /// See [`VectorEnv::describe`]: `<Wrapper, inner>`, as Gymnasium prints a stack.
    fn describe(&self) -> String {
        format!("<{}, {}>", self.name(), self.inner().describe())
    }

    /// See [`VectorEnv::snapshot`].
    ///
    /// # Errors
    /// As there.
    fn snapshot(&self) -> Result<Snapshot> {
        self.inner().snapshot()
    }

    /// See [`VectorEnv::restore`].
    ///
    /// # Errors
    /// As there.
    fn restore(&mut self, snapshot: &Snapshot) -> Result<()> {
        self.inner_mut().restore(snapshot)
    }

    /// See [`VectorEnv::close`].
    fn close(&mut self) {
        self.inner_mut().close();
    }
}

/// The one place where wrappers become vectors. `infos`, `columns` and what takes generic arguments are made
/// of these.
impl<W: VectorWrapper> VectorEnv for W {
    fn num_envs(&self) -> usize {
        VectorWrapper::num_envs(self)
    }

    fn single_observation_space(&self) -> Space {
        VectorWrapper::single_observation_space(self)
    }

    fn single_action_space(&self) -> Space {
        VectorWrapper::single_action_space(self)
    }

    fn observation_space(&self) -> Result<Space> {
        VectorWrapper::observation_space(self)
    }

    fn action_space(&self) -> Result<Space> {
        VectorWrapper::action_space(self)
    }

    fn autoreset(&self) -> Autoreset {
        VectorWrapper::autoreset(self)
    }

    fn reset_into(&mut self, reset: &VectorReset, columns: &mut Columns) -> Result<()> {
        VectorWrapper::reset_into(self, reset, columns)
    }

    fn step_into(&mut self, actions: &Value, columns: &mut Columns) -> Result<()> {
        VectorWrapper::step_into(self, actions, columns)
    }

    fn info(&self, index: usize, visit: &mut dyn FnMut(&str, Value)) {
        VectorWrapper::info(self, index, visit);
    }

    fn final_info(&self, index: usize, visit: &mut dyn FnMut(&str, Value)) {
        VectorWrapper::final_info(self, index, visit);
    }

    fn column_infos(&self, visit: &mut dyn FnMut(&str, Value)) {
        VectorWrapper::column_infos(self, visit);
    }

    fn visit_envs(&mut self, visit: &mut dyn FnMut(usize, &mut dyn Any)) -> Result<()> {
        VectorWrapper::visit_envs(self, visit)
    }

    fn render(&mut self) -> Result<Vec<Rendered>> {
        VectorWrapper::render(self)
    }

    fn metadata(&self) -> Metadata {
        VectorWrapper::metadata(self)
    }

    fn spec(&self) -> Option<VectorSpec> {
        VectorWrapper::spec(self)
    }

    fn describe(&self) -> String {
        VectorWrapper::describe(self)
    }

    fn snapshot(&self) -> Result<Snapshot> {
        VectorWrapper::snapshot(self)
    }

    fn restore(&mut self, snapshot: &Snapshot) -> Result<()> {
        VectorWrapper::restore(self, snapshot)
    }

    fn within(&self) -> Option<&dyn VectorEnv> {
        Some(self.inner())
    }

    fn within_mut(&mut self) -> Option<&mut dyn VectorEnv> {
        Some(self.inner_mut())
    }

    fn close(&mut self) {
        VectorWrapper::close(self);
    }
}

/// A box changes nothing: not even the description.
impl VectorWrapper for Box<dyn VectorEnv> {
    fn inner(&self) -> &dyn VectorEnv {
        &**self
    }

    fn inner_mut(&mut self) -> &mut dyn VectorEnv {
        &mut **self
    }

    fn spec(&self) -> Option<VectorSpec> {
        self.inner().spec()
    }

    fn describe(&self) -> String {
        self.inner().describe()
    }
}
