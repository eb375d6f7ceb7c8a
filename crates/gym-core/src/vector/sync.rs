use std::any::Any;
use std::fmt;

use super::lockstep::{SlotGroup, is_cached, serve_all};
use super::size;
use super::slot::{self, Request, Slot, Spaces, describe, make_envs, slots};
use super::{Autoreset, Columns, ObservationMode, VectorEnv, VectorKind, VectorReset, VectorSpec};
use crate::drawing::render::{Metadata, Rendered};
use crate::env::{BoxEnv, Env, EnvExt, Inspect};
use crate::spaces::Space;
use crate::spec::ResetOptions;
use crate::value::{Result, Snapshot, Value};

/// Steps its sub-environments one after the other, on the calling thread: Gymnasium's
/// `SyncVectorEnv`.
///
/// The results equal those of stepping each environment by itself. It is the fastest kind for
/// environments whose steps take well under a microsecond and have no native vector.
///
/// ```no_run
/// use gym_core::registry::{VectorKind, make_vec};
/// use gym_core::vector::SyncVectorEnv;
/// use gym_core::{Env, Result};
///
/// fn typed<E: Env + Default>() -> Result<SyncVectorEnv<E>> {
///     SyncVectorEnv::new((0..8).map(|_| E::default()))
/// }
///
/// # fn main() -> Result<()> {
/// let erased = make_vec("CartPole-v1", 8, VectorKind::Sync)?;
/// # Ok(())
/// # }
/// ```
pub struct SyncVectorEnv<E: Env = BoxEnv> {
    slots: Vec<Slot<E>>,
    spaces: Spaces,
    autoreset: Autoreset,
    spec: Option<VectorSpec>,
    /// The options that a native vector knows; the environments of another check their own.
    reset_options: ResetOptions,
    /// The joint step of a native vector.
    lockstep: Option<Box<dyn SlotGroup<E>>>,
}

impl<E: Env> SyncVectorEnv<E> {
    /// A vector of these environments, with autoreset on the next step.
    ///
    /// # Errors
    /// [`Error::InvalidArgument`](crate::Error::InvalidArgument) if there are none, or if their
    /// spaces differ.
    pub fn new(envs: impl IntoIterator<Item = E>) -> Result<Self> {
        Self::with_observation_mode(envs, ObservationMode::Same)
    }

    /// A vector of environments whose observation spaces may differ.
    ///
    /// # Errors
    /// The errors of [`new`](Self::new), and one if they differ by more than `mode` allows.
    pub fn with_observation_mode(
        envs: impl IntoIterator<Item = E>,
        mode: ObservationMode,
    ) -> Result<Self> {
        let (slots, spaces) = slots(envs, mode)?;
        Ok(Self {
            slots,
            spaces,
            autoreset: Autoreset::default(),
            spec: None,
            reset_options: ResetOptions::default(),
            lockstep: None,
        })
    }

    /// Resets sub-environments at another time.
    #[must_use]
    pub fn with_autoreset(self, autoreset: Autoreset) -> Self {
        Self { autoreset, ..self }
    }

    /// The native vector of a spec, for an
    /// [entry point](crate::registry::VectorEntryPoint): `make` gives the sub-environment of an
    /// index. They step one by one, without the cost of erased types. `options` are those of the
    /// [registration](crate::Registration::reset_options()): others are refused.
    ///
    /// # Errors
    /// Those of `make`, and [`Error::InvalidArgument`](crate::Error::InvalidArgument) for a number
    /// of environments that does not fit in memory, or arguments of each that it does not support.
    pub fn native(
        spec: &VectorSpec,
        options: ResetOptions,
        make: impl Fn(usize) -> Result<E>,
    ) -> Result<Self> {
        let envs = make_envs(spec, 0, make)?;
        let spec = VectorSpec {
            vectorization_mode: VectorKind::Native,
            ..spec.clone()
        };
        let vector = Self {
            reset_options: options,
            ..Self::new(envs)?
        };
        Ok(vector.with_autoreset(spec.autoreset_mode).with_spec(spec))
    }

    pub(crate) fn with_spec(self, spec: VectorSpec) -> Self {
        Self {
            spec: Some(spec),
            ..self
        }
    }

    pub(super) fn in_lockstep(self, lockstep: Box<dyn SlotGroup<E>>) -> Self {
        Self {
            lockstep: Some(lockstep),
            ..self
        }
    }

    /// Calls a function with each sub-environment and its index; the results are in the order of
    /// the indices.
    ///
    /// If the function resets, steps or restores a sub-environment, reset it with a mask before the
    /// next step, which is otherwise an error: the vector cannot know whether its episode has
    /// ended. (The vector detects this only for [`BoxEnv`](crate::BoxEnv)s.)
    pub fn call<R>(&mut self, mut f: impl FnMut(usize, &mut E) -> R) -> Vec<R> {
        self.slots
            .iter_mut()
            .enumerate()
            .map(|(index, slot)| slot.lend(|env| f(index, env)))
            .collect()
    }

    /// Resets or steps each sub-environment and writes its row. Returns the first error, after all
    /// have finished.
    fn gather(&mut self, columns: &mut Columns, request: impl Fn(usize) -> Request) -> Result<()> {
        let Self {
            slots,
            spaces,
            autoreset,
            lockstep,
            ..
        } = self;
        let is_cached = is_cached(slots.len());
        let mut result = Ok(());
        serve_all(
            slots,
            lockstep.as_deref_mut(),
            *autoreset,
            is_cached,
            request,
            |index, slot, answer| {
                let answer = answer.and(slot.write(spaces, columns, index));
                if let (Ok(()), Err(error)) = (&result, answer) {
                    result = Err(error.at_env(index));
                }
            },
        );
        result
    }
}

impl<E: Env> VectorEnv for SyncVectorEnv<E> {
    fn num_envs(&self) -> usize {
        self.slots.len()
    }

    fn single_observation_space(&self) -> Space {
        self.spaces.observation.clone()
    }

    fn single_action_space(&self) -> Space {
        self.spaces.action.clone()
    }

    fn observation_space(&self) -> Result<Space> {
        self.spaces.observations(self.slots.len())
    }

    fn autoreset(&self) -> Autoreset {
        self.autoreset
    }

    fn reset_into(&mut self, reset: &VectorReset, columns: &mut Columns) -> Result<()> {
        reset.check(self.slots.len())?;
        if let Some(spec) = &self.spec {
            self.reset_options.check(&spec.env.id, &reset.options)?;
        }
        columns.prepare(&self.spaces.observation, self.slots.len())?;
        self.gather(columns, |index| {
            reset.of(index).map_or(Request::Nothing, Request::Reset)
        })
    }

    fn step_into(&mut self, actions: &Value, columns: &mut Columns) -> Result<()> {
        self.spaces
            .action
            .check_actions(actions, self.slots.len())?;
        for (index, slot) in self.slots.iter_mut().enumerate() {
            slot.check(self.autoreset)
                .and_then(|()| slot.read_action(&self.spaces, actions, index))
                .map_err(|error| error.at_env(index))?;
        }
        columns.prepare(&self.spaces.observation, self.slots.len())?;
        self.gather(columns, |_| Request::Step)
    }

    fn info(&self, index: usize, visit: &mut dyn FnMut(&str, Value)) {
        if let Some(slot) = self.slots.get(index) {
            slot.info(visit);
        }
    }

    fn final_info(&self, index: usize, visit: &mut dyn FnMut(&str, Value)) {
        if let Some(slot) = self.slots.get(index) {
            slot.final_info(visit);
        }
    }

    fn visit_envs(&mut self, visit: &mut dyn FnMut(usize, &mut dyn Any)) -> Result<()> {
        if self.lockstep.is_some() {
            return Err(super::no_envs(&self.describe()));
        }
        self.call(|index, env| visit(index, env));
        Ok(())
    }

    fn inspect(&mut self, index: usize, visit: &mut dyn FnMut(&mut dyn Inspect)) -> Result<()> {
        let num_envs = self.num_envs();
        let slot = self.slots.get_mut(index);
        slot.ok_or_else(|| size::no_such_env(index, num_envs))?
            .inspect(visit)
    }

    fn render(&mut self) -> Result<Vec<Rendered>> {
        self.slots
            .iter_mut()
            .map(|slot| slot.env.render())
            .collect()
    }

    fn metadata(&self) -> Metadata {
        let metadata = self
            .slots
            .first()
            .map_or_else(Metadata::default, |slot| slot.env.metadata());
        match self.lockstep {
            Some(_) => Metadata {
                render_modes: &[],
                ..metadata
            },
            None => metadata,
        }
    }

    fn spec(&self) -> Option<VectorSpec> {
        self.spec.clone()
    }

    fn describe(&self) -> String {
        match &self.spec {
            Some(spec) if spec.vectorization_mode == VectorKind::Native => {
                describe("NativeVectorEnv", Some(spec.env.clone()), self.slots.len())
            }
            _ => {
                let env = self.slots.first().and_then(|slot| slot.env.spec());
                describe("SyncVectorEnv", env, self.slots.len())
            }
        }
    }

    fn snapshot(&self) -> Result<Snapshot> {
        slot::snapshot(self.autoreset, self.slots.iter())
    }

    fn restore(&mut self, snapshot: &Snapshot) -> Result<()> {
        let mut slots: Vec<_> = self.slots.iter_mut().collect();
        slot::restore(snapshot, self.autoreset, &self.spaces, &mut slots)
    }

    fn close(&mut self) {
        self.slots.iter_mut().for_each(Slot::close);
    }
}

impl<E: Env> fmt::Debug for SyncVectorEnv<E> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.describe())
    }
}
